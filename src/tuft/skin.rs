//! From a stroke and a section to triangles.
//!
//! Along the stroke stand rings of `sides` vertices; a pointed end is one place (the apex), an open end a ring closed by
//! a fan about its middle. Either way a tuft with R rings of n sides has n + 2 n (R - 1) + n = 2 n R triangles. The
//! stations of 20 control points are these 20 and the buried start: start and tip are apexes, 19 rings stand between,
//! and with 40 sides that is 2 * 40 * 19 = 1,520 triangles, the count of Ren, Zhao, Geng 2010.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::detail::Plan;
use super::section::Section;
use super::sweep::{Frame, Sweep};
use super::{Island, Stroke};
use crate::geometry::Mesh;
use crate::math::trig;

/// The true surface of a tuft: a section swept along a stroke.
pub(super) struct Surface<'a> {
    pub(super) sweep: Sweep,
    pub(super) section: &'a Section,
}

/// One cross-section of the surface, with all that depends on `t` alone.
pub(super) struct Cut {
    pub(super) frame: Frame,
    /// Half width and half thickness.
    pub(super) w: f32,
    pub(super) h: f32,
    /// Radius of the bend, signed; infinite when straight.
    bend: f32,
    /// Half width where the prongs part, and 0..1 from there to the tip.
    split: Option<(f32, f32)>,
}

impl<'a> Surface<'a> {
    pub(super) fn new(stroke: &Stroke, section: &'a Section, up: Option<Vec3>) -> Self {
        Self { sweep: Sweep::new(stroke, up), section }
    }

    pub(super) fn cut(&self, t: f32) -> Cut {
        let section = self.section;
        let mut frame = self.sweep.at(t);
        if section.twist != 0.0 {
            let angle = section.twist * t;
            let (sin, cos) = (trig::sin(angle), trig::cos(angle));
            let normal = frame.normal * cos + frame.binormal * sin;
            frame.binormal = frame.binormal * cos - frame.normal * sin;
            frame.normal = normal;
        }
        let (w, h) = section.radii(t);
        let split =
            section.split.filter(|s| t > s.from).map(|s| (section.radii(s.from).0, (t - s.from) / (1.0 - s.from)));
        let widest = split.map_or(w, |(w, _)| w);
        let bend = if section.bend == 0.0 || widest == 0.0 {
            f32::INFINITY
        } else {
            // A bend tighter than the section is thick would turn its inner side inside out.
            let radius = (2.0 * widest / section.bend.abs()).max(h / 0.9);
            radius * section.bend.signum()
        };
        Cut { frame, w, h, bend, split }
    }
}

impl Cut {
    /// The place of a point of the unit disc (x along the width, y along the thickness).
    pub(super) fn place(&self, x: f32, y: f32) -> Vec3 {
        self.bent(x * self.w, y * self.h)
    }

    fn bent(&self, x: f32, y: f32) -> Vec3 {
        let (x, y) = if self.bend.is_finite() {
            let angle = x / self.bend;
            let (sin, cos) = (trig::sin(angle), trig::cos(angle));
            ((self.bend + y) * sin, (self.bend + y) * cos - self.bend)
        } else {
            (x, y)
        };
        self.frame.centre + self.frame.binormal * x + self.frame.normal * y
    }

    /// The place of a point of prong `i` of `k`, whose slice of the unit disc turns round towards the tip.
    pub(super) fn prong(&self, section: &Section, (i, k): (usize, usize), x: f32, y: f32) -> Vec3 {
        let (Some(split), Some((whole, u))) = (section.split, self.split) else { return self.place(x, y) };
        let (middle, half) = slice(i, k);
        let tallest = tallest(i, k);
        let towards = Vec2::new((x - middle) / half, y / tallest).normalize_or_zero();
        let blend = trig::smoothstep(0.0, 1.0, u);
        let local = Vec2::new(x - middle, y).lerp(towards * Vec2::new(half, tallest), blend);
        self.bent(middle * whole * (1.0 + split.spread * u) + local.x * self.w, local.y * self.h)
    }
}

/// Middle and half width of prong `i` of `k` in the unit disc.
fn slice(i: usize, k: usize) -> (f32, f32) {
    let half = 1.0 / k as f32;
    ((2 * i + 1) as f32 * half - 1.0, half)
}

/// Greatest height of prong `i` of `k` in the unit disc.
fn tallest(i: usize, k: usize) -> f32 {
    let (middle, half) = slice(i, k);
    let nearest = (middle.abs() - half).max(0.0);
    (1.0 - nearest * nearest).sqrt()
}

/// The unit outline with `sides` corners, from the side that faces the head over the binormal's side.
pub(super) fn outline(sides: usize) -> Vec<Vec2> {
    let angle = |j: usize| TAU * j as f32 / sides as f32;
    (0..sides).map(|j| Vec2::new(trig::sin(angle(j)), -trig::cos(angle(j)))).collect()
}

/// What one tuft's mesh is written into: as long as [`size`] says.
pub(super) struct Out<'a> {
    pub(super) positions: &'a mut [Vec3],
    pub(super) normals: &'a mut [Vec3],
    pub(super) uvs: &'a mut [Vec2],
    pub(super) triangles: &'a mut [[u32; 3]],
    /// Index of the first vertex in the whole mesh.
    pub(super) first: u32,
}

/// Numbers of vertices and triangles of a tuft without split tips.
pub(super) fn size(rings: usize, sides: usize) -> (usize, usize) {
    (rings * (sides + 1) + 2 * sides, 2 * rings * sides)
}

/// Writes a tuft without split tips. Each ring's first vertex is repeated at its end for the uv seam, which runs along
/// the side that faces the head; each apex is repeated per side, with one normal, so that an outline drawn by pushing
/// vertices along their normals stays whole.
pub(super) fn write(surface: &Surface, plan: &Plan, unit: &[Vec2], island: Island, out: &mut Out) {
    let (n, r) = (plan.sides, plan.rings.len());
    let apexes = r * (n + 1);

    // Positions
    for (ring, &t) in out.positions[..apexes].chunks_exact_mut(n + 1).zip(&plan.rings) {
        let cut = surface.cut(t);
        for (p, o) in ring.iter_mut().zip(unit) {
            *p = cut.place(o.x, o.y);
        }
        ring[n] = ring[0];
    }
    let ends = [surface.sweep.at(0.0), surface.sweep.at(1.0)];
    out.positions[apexes..apexes + n].fill(ends[0].centre);
    out.positions[apexes + n..].fill(ends[1].centre);

    // Normals: slopes along and around, weighted for uneven steps so that parabolas come out exactly
    let (positions, last) = (&*out.positions, r - 1);
    for i in 0..r {
        for j in 0..n {
            let at = i * (n + 1) + j;
            let here = positions[at];
            let before = if i > 0 { positions[at - n - 1] } else { ends[0].centre };
            let after = if i < last { positions[at + n + 1] } else { ends[1].centre };
            let (a, b) = (here - before, after - here);
            let (la, lb) = (a.length_squared(), b.length_squared());
            let along = if i == 0 && plan.open_root {
                b
            } else if i == last && plan.open_tip {
                a
            } else {
                // Slopes a / |a| and b / |b|, weighted by |b| and |a|, times |a| |b|.
                a * lb + b * la
            };
            let around = positions[i * (n + 1) + j + 1] - positions[i * (n + 1) + if j == 0 { n - 1 } else { j - 1 }];
            let normal = along.cross(around);
            let scale = normal.abs().max_element();
            out.normals[at] = if scale > 0.0 {
                (normal / scale).normalize()
            } else {
                // A ring without size: straight out.
                let axis = ends[0].tangent;
                (here - 0.5 * (before + after)).try_normalize().unwrap_or(axis)
            };
        }
        out.normals[i * (n + 1) + n] = out.normals[i * (n + 1)];
    }
    out.normals[apexes..apexes + n].fill(-ends[0].tangent);
    out.normals[apexes + n..].fill(ends[1].tangent);

    // Texture coordinates: v from root to tip
    for (ring, &t) in out.uvs[..apexes].chunks_exact_mut(n + 1).zip(&plan.rings) {
        for (j, uv) in ring.iter_mut().enumerate() {
            *uv = island.place(j as f32 / n as f32, t);
        }
    }
    for j in 0..n {
        let u = (j as f32 + 0.5) / n as f32;
        out.uvs[apexes + j] = island.place(u, 0.0);
        out.uvs[apexes + n + j] = island.place(u, 1.0);
    }

    // Triangles
    let vertex = |i: usize, j: usize| out.first + (i * (n + 1) + j) as u32;
    let apex = out.first + apexes as u32;
    let mut triangles = out.triangles.iter_mut();
    let mut push = |t: [u32; 3]| {
        if let Some(slot) = triangles.next() {
            *slot = t;
        }
    };
    for j in 0..n {
        push([apex + j as u32, vertex(0, j), vertex(0, j + 1)]);
    }
    for i in 0..last {
        for j in 0..n {
            let (a, b, c, d) = (vertex(i, j), vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1));
            let corners = [a, b, c, d].map(|v| positions[(v - out.first) as usize]);
            let pair = quad([a, b, c, d], corners, 2 * j < n);
            push(pair[0]);
            push(pair[1]);
        }
    }
    for j in 0..n {
        push([vertex(last, j), apex + (n + j) as u32, vertex(last, j + 1)]);
    }
}

/// Corners per arc of a middle prong for a wanted number of sides.
pub(super) fn arc_steps(sides: usize, tips: usize) -> usize {
    sides.div_ceil(2 * tips).max(1)
}

/// Number of triangles of a tuft with split tips.
pub(super) fn split_triangles(plan: &Plan, from: f32, tips: usize) -> usize {
    let s = arc_steps(plan.sides, tips);
    let body = plan.rings.iter().filter(|&&t| t <= from).count();
    let prong = plan.rings.len() - body;
    let loops = 2 * 3 * s + (tips - 2) * 4 * s;
    2 * s * tips * (2 * body - 1) + loops * (2 * prong + 1)
}

/// The mesh of a tuft with split tips: one body, and prongs that share the ring where they part, so that the whole is
/// one closed surface.
pub(super) fn split_mesh(surface: &Surface, plan: &Plan, island: Island) -> Mesh {
    let section = surface.section;
    let (from, k) = section.split.map_or((1.0, 2), |s| (s.from, s.tips as usize));
    let s = arc_steps(plan.sides, k);
    let mut mesh = Mesh::default();
    let ends = [surface.sweep.at(0.0), surface.sweep.at(1.0)];

    // Outline of the body, from the bottom of the first cut to the right, over the top, round the left end
    let cut_x = |c: usize| 2.0 * c as f32 / k as f32 - 1.0;
    let bottom = |c: usize| trig::asin(cut_x(c));
    let arc = |a: f32, b: f32, steps: usize| {
        (0..steps).map(move |i| {
            let angle = a + (b - a) * i as f32 / steps as f32;
            Vec2::new(trig::sin(angle), -trig::cos(angle))
        })
    };
    let mut unit: Vec<Vec2> = Vec::with_capacity(2 * s * k);
    for c in 1..k - 1 {
        unit.extend(arc(bottom(c), bottom(c + 1), s));
    }
    unit.extend(arc(bottom(k - 1), PI - bottom(k - 1), 2 * s));
    for c in (1..k - 1).rev() {
        unit.extend(arc(PI - bottom(c + 1), PI - bottom(c), s));
    }
    unit.extend(arc(PI - bottom(1), TAU + bottom(1), 2 * s));
    let n = unit.len();

    // Body
    let body: Vec<f32> = plan.rings.iter().copied().filter(|&t| t <= from).collect();
    let rest: Vec<f32> = plan.rings.iter().copied().filter(|&t| t > from).collect();
    let start = add_apex(&mut mesh, ends[0].centre, 0.0, n, island, (0.0, 1.0));
    let mut before = None;
    for &t in &body {
        let cut = surface.cut(t);
        let first = mesh.positions.len() as u32;
        for j in 0..=n {
            mesh.positions.push(cut.place(unit[j % n].x, unit[j % n].y));
            mesh.uvs.push(island.place(j as f32 / n as f32, t));
        }
        join(&mut mesh, before.unwrap_or((start, true)), (first, false), n);
        before = Some((first, false));
    }
    let ring = (mesh.positions.len() - n - 1) as u32;

    // Prongs
    let cut = surface.cut(from);
    let low = |c: usize| (c - 1) * s;
    let high = |c: usize| k * s + (k - 1 - c) * s;
    let on_ring = |j: usize| (unit[j % n], mesh.positions[ring as usize + j % n]);
    let chord = |c: usize, upward: bool| {
        (0..s).map(move |i| if upward { i } else { s - i }).map(move |i| (c, i)).collect::<Vec<_>>()
    };
    let mut loops: Vec<(Vec<Vec2>, Vec<Vec3>)> = Vec::with_capacity(k);
    for i in 0..k {
        let mut points: Vec<(Vec2, Vec3)> = Vec::new();
        let chord_points = |c: usize, upward: bool| {
            chord(c, upward).into_iter().map(|(c, i)| match i {
                0 => on_ring(low(c)),
                i if i == s => on_ring(high(c)),
                i => {
                    let (a, b) = (on_ring(low(c)).0, on_ring(high(c)).0);
                    let at = a.lerp(b, i as f32 / s as f32);
                    (at, cut.place(at.x, at.y))
                }
            })
        };
        if i == 0 {
            points.extend(chord_points(1, true));
            points.extend((high(1)..n).map(on_ring));
        } else if i == k - 1 {
            points.extend((low(i)..high(i)).map(on_ring));
            points.extend(chord_points(i, false));
        } else {
            points.extend((low(i)..low(i + 1)).map(on_ring));
            points.extend(chord_points(i + 1, true));
            points.extend((high(i + 1)..high(i)).map(on_ring));
            points.extend(chord_points(i, false));
        }
        loops.push(points.into_iter().unzip());
    }
    let mut tips = Vec::new();
    for (i, (unit, base)) in loops.iter().enumerate() {
        let m = unit.len();
        let span = (i as f32 / k as f32, (i + 1) as f32 / k as f32);
        let u = |j: usize| span.0 + (span.1 - span.0) * j as f32 / m as f32;
        let mut before = (mesh.positions.len() as u32, false);
        for j in 0..=m {
            mesh.positions.push(base[j % m]);
            mesh.uvs.push(island.place(u(j), from));
        }
        for &t in &rest {
            let cut = surface.cut(t);
            let first = mesh.positions.len() as u32;
            for j in 0..=m {
                let o = unit[j % m];
                mesh.positions.push(cut.prong(section, (i, k), o.x, o.y));
                mesh.uvs.push(island.place(u(j), t));
            }
            join(&mut mesh, before, (first, false), m);
            before = (first, false);
        }
        let (middle, _) = slice(i, k);
        let tip = surface.cut(1.0).prong(section, (i, k), middle, 0.0);
        let apex = add_apex(&mut mesh, tip, 1.0, m, island, span);
        join(&mut mesh, before, (apex, true), m);
        tips.push((apex as usize, m, (tip - base_middle(base)).try_normalize().unwrap_or(ends[1].tangent)));
    }

    mesh.compute_normals();
    mesh.normals[start as usize..start as usize + n].fill(-ends[0].tangent);
    for (apex, m, axis) in tips {
        mesh.normals[apex..apex + m].fill(axis);
    }
    mesh
}

fn base_middle(base: &[Vec3]) -> Vec3 {
    base.iter().sum::<Vec3>() / base.len() as f32
}

fn add_apex(mesh: &mut Mesh, at: Vec3, v: f32, n: usize, island: Island, span: (f32, f32)) -> u32 {
    let first = mesh.positions.len() as u32;
    for j in 0..n {
        mesh.positions.push(at);
        mesh.uvs.push(island.place(span.0 + (span.1 - span.0) * (j as f32 + 0.5) / n as f32, v));
    }
    first
}

/// The triangles of a quad (a, b on one ring, c, d above them on the next): over the shorter diagonal, of two nearly
/// equal ones over a-d when `first`, so that a mirrored tuft's mesh is the mirror image.
fn quad([a, b, c, d]: [u32; 4], at: [Vec3; 4], first: bool) -> [[u32; 3]; 2] {
    let (ad, bc) = (at[0].distance_squared(at[3]), at[1].distance_squared(at[2]));
    let over_ad = if (ad - bc).abs() < 0.02 * ad { first } else { ad < bc };
    if over_ad { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
}

/// Joins two loops of `n` sides, given by their first vertex and whether they are an apex.
fn join(mesh: &mut Mesh, (a, a_apex): (u32, bool), (b, b_apex): (u32, bool), n: usize) {
    for j in 0..n as u32 {
        match (a_apex, b_apex) {
            (true, _) => mesh.triangles.push([a + j, b + j, b + j + 1]),
            (_, true) => mesh.triangles.push([a + j, b + j, a + j + 1]),
            _ => {
                let corners = [a + j, a + j + 1, b + j, b + j + 1];
                let at = corners.map(|v| mesh.positions[v as usize]);
                mesh.triangles.extend(quad(corners, at, 2 * j < n as u32));
            }
        }
    }
}
