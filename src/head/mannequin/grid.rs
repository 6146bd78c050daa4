//! The grid of quads around a mannequin: its topology, its cage, and the finished mesh.
//!
//! A tube of rings, closed by a square patch of quads above (the top of the head) and one below (the cut of the bust).
//! Apart from the eight corners of the patches every vertex has four neighbours. Only the half with `x >= 0` exists
//! here: column 0 runs down the middle of the front, column `2 n` down the middle of the back.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::Form;
use crate::geometry::{Group, Mesh};
use crate::math::trig;

/// Part of the mannequin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Zone {
    /// The head without face and ears.
    Head,
    /// From brow to chin, between the ears.
    Face,
    /// An ear.
    Ear,
    /// The neck.
    Neck,
    /// All below the neck.
    Shoulders,
}

/// A known ring of the cage: its foremost, outermost and hindmost points.
pub struct Ring {
    /// Rows from the ring above to this one.
    pub rows: usize,
    /// Height and depth of the front.
    pub front: [f32; 2],
    /// Breadth, height and depth of the side.
    pub side: [f32; 3],
    /// Height and depth of the back.
    pub back: [f32; 2],
}

impl Ring {
    /// The point `turn` radians from the front.
    fn at(&self, turn: f32) -> Vec3 {
        let (s, c) = (trig::sin(turn).max(0.0), trig::cos(turn));
        let [x, y, z] = self.side;
        let [to_y, to_z] = if c > 0.0 { self.front } else { self.back };
        let c = c.abs();
        let bend = c * c.sqrt();
        Vec3::new(x * s, y + (to_y - y) * bend, z + (to_z - z) * c)
    }
}

/// One corner of a triangle: which vertex, and its uv.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    uv: Vec2,
}

/// The half of the grid with `x >= 0`.
pub struct Half {
    /// The cage: where vertices start.
    pub cage: Vec<Vec3>,
    /// For every vertex a direction that leads out of the form.
    pub outward: Vec<Vec3>,
    /// Neighbours of every vertex; a vertex in the middle has each neighbour off it twice.
    pub neighbours: Vec<Vec<u32>>,
    /// True for vertices in the plane `x = 0`.
    pub middle: Vec<bool>,
    /// Corners of the quads, counter-clockwise from outside.
    quads: Vec<[Corner; 4]>,
}

/// Share of the height of the texture for each of the two caps.
const CAP_SHARE: f32 = 0.14;

impl Half {
    /// Lays out the grid and its cage.
    pub fn new(form: &Form) -> Self {
        let across: usize = form.columns.iter().map(|c| c.0).sum();
        let turns = turns(form.columns);
        let mut rings: Vec<Vec<Vec3>> = vec![];
        for pair in form.rings.windows(2) {
            for k in 0..pair[1].rows {
                let t = k as f32 / pair[1].rows as f32;
                rings.push(turns.iter().map(|&a| pair[0].at(a).lerp(pair[1].at(a), t)).collect());
            }
        }
        rings.extend(form.rings.last().map(|last| turns.iter().map(|&a| last.at(a)).collect()));

        let mut half = Self { cage: vec![], outward: vec![], neighbours: vec![], middle: vec![], quads: vec![] };
        let columns = across + 1;
        let ids: Vec<Vec<u32>> = rings
            .iter()
            .map(|ring| {
                ring.iter()
                    .enumerate()
                    .map(|(j, &p)| {
                        half.add(p, Vec3::new(trig::sin(turns[j]), 0.0, trig::cos(turns[j])), j == 0 || j == across)
                    })
                    .collect()
            })
            .collect();
        let last = rings.len() - 1;
        for i in 0..last {
            for j in 0..across {
                let v = |i: usize| 1.0 - CAP_SHARE - (1.0 - 2.0 * CAP_SHARE) * i as f32 / last as f32;
                let u = |j: usize| 0.5 + 0.5 * j as f32 / across as f32;
                let corner = |i: usize, j: usize| Corner { vertex: ids[i][j], uv: Vec2::new(u(j), v(i)) };
                half.quads.push([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
            }
        }
        debug_assert_eq!(turns.len(), columns);
        half.cap(&rings[0], &ids[0], true);
        half.cap(&rings[last], &ids[last], false);
        half.link();
        half
    }

    fn add(&mut self, p: Vec3, outward: Vec3, middle: bool) -> u32 {
        self.outward.push(outward);
        self.cage.push(if middle { Vec3::new(0.0, p.y, p.z) } else { p });
        self.middle.push(middle);
        (self.cage.len() - 1) as u32
    }

    /// Closes a ring by a square patch, whose half is `n / 2` by `n` quads: a Coons patch over the ring.
    fn cap(&mut self, ring: &[Vec3], ids: &[u32], top: bool) {
        let n = (ring.len() - 1) / 2;
        let h = n / 2;
        // Column of the ring at a place (a, b) on the border of the patch; a from the middle to the left, b from the
        // back to the front.
        let column = |a: usize, b: usize| {
            if b == n {
                a
            } else if a == h {
                h + (n - b)
            } else {
                2 * n - a
            }
        };
        let border = |a: i32, b: usize| {
            let p = ring[column(a.unsigned_abs() as usize, b)];
            Vec3::new(if a < 0 { -p.x } else { p.x }, p.y, p.z)
        };
        let mut grid = vec![vec![0_u32; n + 1]; h + 1];
        let hi = h as i32;
        let (nw, ne, sw, se) = (border(-hi, n), border(hi, n), border(-hi, 0), border(hi, 0));
        for a in 0..=h {
            for b in 0..=n {
                grid[a][b] = if a == h || b == 0 || b == n {
                    ids[column(a, b)]
                } else {
                    let (s, t) = (0.5 + a as f32 / n as f32, b as f32 / n as f32);
                    let across = border(-hi, b).lerp(border(hi, b), s);
                    let along = border(a as i32, 0).lerp(border(a as i32, n), t);
                    let mut p = across + along - sw.lerp(se, s).lerp(nw.lerp(ne, s), t);
                    if top {
                        p.y += 40.0 * s * (1.0 - s) * t * (1.0 - t);
                    }
                    self.add(p, if top { Vec3::Y } else { Vec3::NEG_Y }, a == 0)
                };
            }
        }
        let corner = |a: usize, b: usize| {
            // Squares around the centre, unrolled.
            let (x, z) = (a as f32, b as f32 - h as f32);
            let m = x.max(z.abs());
            let at = if m == 0.0 {
                0.5
            } else if z == m {
                0.25 * x / m
            } else if x == m {
                0.25 + 0.25 * (1.0 - z / m)
            } else {
                0.75 + 0.25 * (1.0 - x / m)
            };
            let rise = CAP_SHARE * (1.0 - m / h as f32);
            let v = if top { 1.0 - CAP_SHARE + rise } else { CAP_SHARE - rise };
            Corner { vertex: grid[a][b], uv: Vec2::new(0.5 + 0.5 * at, v) }
        };
        for a in 0..h {
            for b in 0..n {
                let mut quad = [corner(a, b), corner(a, b + 1), corner(a + 1, b + 1), corner(a + 1, b)];
                if !top {
                    quad.reverse();
                }
                self.quads.push(quad);
            }
        }
    }

    fn link(&mut self) {
        let mut links: Vec<Vec<u32>> = vec![vec![]; self.cage.len()];
        for quad in &self.quads {
            for k in 0..4 {
                let (a, b) = (quad[k].vertex, quad[(k + 1) % 4].vertex);
                for (a, b) in [(a, b), (b, a)] {
                    if !links[a as usize].contains(&b) {
                        links[a as usize].push(b);
                    }
                }
            }
        }
        for (v, list) in links.iter_mut().enumerate() {
            if self.middle[v] {
                let off: Vec<u32> = list.iter().copied().filter(|&w| !self.middle[w as usize]).collect();
                list.extend(off);
            }
        }
        self.neighbours = links;
    }
}

/// The angles of the columns in radians. Their steps change gently where the density does.
fn turns(columns: &[(usize, f32)]) -> Vec<f32> {
    let mut steps: Vec<f32> = columns.iter().flat_map(|&(n, degrees)| vec![degrees / n as f32; n]).collect();
    for _ in 0..6 {
        let old = steps.clone();
        for i in 0..old.len() {
            let (a, b) = (old[i.saturating_sub(1)], old[(i + 1).min(old.len() - 1)]);
            steps[i] = (a + 2.0 * old[i] + b) / 4.0;
        }
    }
    let total: f32 = steps.iter().sum();
    let mut turns = vec![0.0];
    let mut sum = 0.0;
    for step in steps {
        sum += step;
        turns.push(sum / total * std::f32::consts::PI);
    }
    turns
}

/// Triangulates the wrapped half, mirrors it, and names its parts.
pub fn assemble(form: &Form, half: &Half, positions: &[Vec3]) -> Mesh {
    let mut corners: Vec<[Corner; 3]> = vec![];
    for &[a, b, c, d] in &half.quads {
        let p = |c: Corner| positions[c.vertex as usize];
        // The shorter diagonal; in a fold it follows the fold.
        if p(a).distance_squared(p(c)) <= p(b).distance_squared(p(d)) {
            corners.extend([[a, b, c], [a, c, d]]);
        } else {
            corners.extend([[a, b, d], [b, c, d]]);
        }
    }

    let mut mesh = Mesh::default();
    // For every vertex of the half: under which u it is known, and as which vertex on the left and on the right.
    let mut known: Vec<Vec<(u32, [Option<u32>; 2])>> = vec![vec![]; positions.len()];
    let mut zones: BTreeMap<&'static str, Vec<u32>> = BTreeMap::new();
    for side in [0, 1] {
        for triangle in &corners {
            let mut out = triangle.map(|c| {
                let (vertex, u) = (c.vertex as usize, c.uv.x.to_bits());
                let entry = known[vertex].iter().position(|k| k.0 == u).unwrap_or_else(|| {
                    known[vertex].push((u, [None; 2]));
                    known[vertex].len() - 1
                });
                // Left and right share the vertices of the middle, except where the texture has its seam.
                let shared = half.middle[vertex] && c.uv.x == 0.5;
                *known[vertex][entry].1[if shared { 0 } else { side }].get_or_insert_with(|| {
                    let p = positions[vertex];
                    let flip = side == 1 && !half.middle[vertex];
                    mesh.positions.push(if flip { Vec3::new(-p.x, p.y, p.z) } else { p });
                    mesh.uvs.push(Vec2::new(if side == 1 { 1.0 - c.uv.x } else { c.uv.x }, c.uv.y));
                    (mesh.positions.len() - 1) as u32
                })
            });
            if side == 1 {
                out.swap(1, 2);
            }
            let centre = triangle.iter().map(|c| positions[c.vertex as usize]).sum::<Vec3>() / 3.0;
            let name = match ((form.zone)(centre), side) {
                (Zone::Head, _) => "head",
                (Zone::Face, _) => "face",
                (Zone::Ear, 0) => "ear_left",
                (Zone::Ear, _) => "ear_right",
                (Zone::Neck, _) => "neck",
                (Zone::Shoulders, _) => "shoulders",
            };
            zones.entry(name).or_default().push(mesh.triangles.len() as u32);
            mesh.triangles.push(out);
        }
    }
    mesh.groups = zones.into_iter().map(|(name, triangles)| Group { name: name.into(), triangles }).collect();
    mesh.compute_normals();
    // Sums differ in their last bits between the sides: the left one is mirrored.
    for (vertex, known) in known.iter().enumerate() {
        for &(_, sides) in known {
            let Some(left) = sides[0] else { continue };
            let n = mesh.normals[left as usize];
            let flat = Vec3::new(0.0, n.y, n.z).try_normalize().unwrap_or(Vec3::Y);
            if half.middle[vertex] {
                mesh.normals[left as usize] = flat;
            }
            if let Some(right) = sides[1] {
                mesh.normals[right as usize] = if half.middle[vertex] { flat } else { Vec3::new(-n.x, n.y, n.z) };
            }
        }
    }
    mesh
}
