//! The cap: hair that lies on the scalp, as a closed shell.
//!
//! Ren, Zhao, Geng 2010, section 2.1: control points on the head are joined to the crown and to each other; each
//! triangle is refined by linear interpolation, and what lies inside the head is pushed out to its surface.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::stroke::{SAME_POINT, closed_beziers, position};
use super::{Ground, TuftError};
use crate::geometry::Mesh;
use crate::math::trig;
use crate::task::{Warned, Warning};

crate::params! {
    /// A cap of hair that lies on the scalp.
    pub struct CapOptions("coif.cap") {
        /// Control points of the border on the head, in order around it; the natural hairline when left out.
        border: Vec<Vec3> = vec![], takes("(Point|Head.point.fields)[]");
        /// Where the hair parts to all sides; the top of the head when left out.
        crown: Option<Vec3>;
        /// Thickness of the hair on the head.
        thickness: f32 = 0.5, unit("cm"), range(0.02, 5.0);
        /// Over how much of the way from the border to the crown the thickness grows.
        rim: f32 = 0.25, range(0.01, 1.0);
        /// Rounds of halving each triangle; the method's own number is 2.
        refine: u32 = 4, range(1.0, 6.0);
        /// Rounds the border off; a polygon between the control points when false.
        smooth: bool = true;
    }
}

impl CapOptions {
    /// A cap with that border and otherwise the defaults.
    pub fn new(border: Vec<Vec3>) -> Self {
        Self { border, crown: None, thickness: 0.5, rim: 0.25, refine: 4, smooth: true }
    }

    /// The cap as a closed mesh that faces outward. Its inner side lies a little below the head's surface, its outer
    /// side `thickness` above it, thinner towards the border. uv: the crown in the middle, the border a circle.
    ///
    /// # Errors
    /// Fewer than three border points, repeated ones, numbers that are not finite or out of range.
    pub fn build(&self, ground: &Ground) -> Result<Warned<Mesh>, TuftError> {
        let mut warnings = Vec::new();
        let crown = self.crown.unwrap_or_else(|| ground.surface(Vec3::Y));
        let border = self.check(ground, crown, &mut warnings)?;
        let crown = ground.below(crown);
        let (sectors, rows) = (border.len(), 1_usize << self.refine);

        // The refined triangles: row r of a sector runs from the way to one control point to the way to the next
        let spans: Vec<[Vec3; 4]> = if self.smooth {
            closed_beziers(&border)
        } else {
            let third = |a: Vec3, b: Vec3| [a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b];
            (0..sectors).map(|i| third(border[i], border[(i + 1) % sectors])).collect()
        };
        let mut places = Vec::with_capacity(sectors * rows * (rows + 1) / 2);
        for r in 1..=rows {
            for s in 0..sectors {
                places.extend((0..r).map(|j| (r, s, j)));
            }
        }
        let found: Vec<Vec3> = places
            .par_iter()
            .with_min_len(32)
            .map(|&(r, s, j)| {
                let edge = position(&spans[s], j as f32 / r as f32);
                if r == rows { ground.below(edge) } else { halved(crown, edge, r, rows, ground) }
            })
            .collect();
        let mut sheet = vec![crown];
        let mut uvs = vec![Vec2::splat(0.5)];
        let mut rims = vec![1.0_f32];
        for (&(r, s, j), place) in places.iter().zip(found) {
            sheet.push(place);
            let fraction = r as f32 / rows as f32;
            let angle = std::f32::consts::TAU * (s as f32 + j as f32 / r as f32) / sectors as f32;
            uvs.push(Vec2::splat(0.5) + 0.5 * fraction * Vec2::new(trig::cos(angle), trig::sin(angle)));
            rims.push(((1.0 - fraction) / self.rim).min(1.0));
        }
        let triangles = fan(sectors, rows);
        Ok(Warned { value: self.shell(&sheet, &uvs, &rims, triangles, sectors * rows, ground), warnings })
    }

    fn check(&self, ground: &Ground, crown: Vec3, warnings: &mut Vec<Warning>) -> Result<Vec<Vec3>, TuftError> {
        let n = self.border.len();
        if n < 3 {
            return Err(TuftError::TooFewPoints { what: "a cap's border", least: 3, count: n });
        }
        TuftError::check("thickness", self.thickness, 1e-3, 100.0)?;
        TuftError::check("rim", self.rim, 0.001, 1.0)?;
        TuftError::check("refine", self.refine as f32, 1.0, 6.0)?;
        let mut on_head = Vec::with_capacity(n);
        for (i, &p) in self.border.iter().chain([&crown]).enumerate() {
            if !p.is_finite() {
                return Err(TuftError::NotFinite { number: i + 1, point: p });
            }
            let on = ground.solid.closest(p);
            if on.distance.abs() > 0.1 * ground.scale {
                let what = if i < n { format!("border point {}", i + 1) } else { "the crown".into() };
                let far = on.distance.abs();
                warnings
                    .push(Warning::new(format!("{what} lies `{far:.2}` cm off the head; it was moved to the skin")));
            }
            on_head.push(on.position);
        }
        on_head.truncate(n);
        match (0..n).find(|&i| on_head[i].distance(on_head[(i + n - 1) % n]) < SAME_POINT) {
            Some(i) => Err(TuftError::RepeatedPoint { number: i + 1, point: on_head[i] }),
            None => Ok(on_head),
        }
    }

    /// Inner and outer side of a sheet, joined along its border: the last `border` vertices, in order.
    fn shell(
        &self,
        sheet: &[Vec3],
        uvs: &[Vec2],
        rims: &[f32],
        mut triangles: Vec<[u32; 3]>,
        border: usize,
        ground: &Ground,
    ) -> Mesh {
        let mut outer = Mesh { positions: sheet.to_vec(), triangles, ..Mesh::default() };
        // A border given the other way around is as good.
        let facing: f32 =
            (0..outer.triangles.len()).map(|t| outer.area_vector(t).dot(outer.corners(t)[0] - ground.reference)).sum();
        let turned = facing < 0.0;
        if turned {
            for t in &mut outer.triangles {
                t.swap(1, 2);
            }
        }
        outer.compute_normals();

        // Below the skin by enough to hide the chords between the vertices, above it by the thickness
        let sunk = (0.15 * ground.scale).min(self.thickness);
        let count = sheet.len() as u32;
        let mut mesh = Mesh::default();
        for (i, (p, n)) in sheet.iter().zip(&outer.normals).enumerate() {
            // A quarter circle at the rim, with a fifth of the thickness left at the very border.
            let round = (rims[i] * (2.0 - rims[i])).max(0.0).sqrt();
            mesh.positions.push(*p + *n * (self.thickness * (0.2 + 0.8 * round)));
        }
        mesh.positions.extend(sheet.iter().zip(&outer.normals).map(|(p, n)| *p - *n * sunk));
        mesh.uvs = uvs.iter().chain(uvs).copied().collect();
        triangles = outer.triangles;
        mesh.triangles.extend(triangles.iter().map(|t| [t[0] + count, t[2] + count, t[1] + count]));
        mesh.triangles.append(&mut triangles);
        let first = count - border as u32;
        for j in 0..border as u32 {
            let (a, b) = (first + j, first + (j + 1) % border as u32);
            let (a, b) = if turned { (b, a) } else { (a, b) };
            mesh.triangles.push([a, a + count, b + count]);
            mesh.triangles.push([a, b + count, b]);
        }
        mesh.compute_normals();
        mesh
    }
}

/// Triangles over rows of growing length: row r has r vertices per sector, the crown is vertex 0.
fn fan(sectors: usize, rows: usize) -> Vec<[u32; 3]> {
    let start = |r: usize| if r == 0 { 0 } else { 1 + sectors * r * (r - 1) / 2 };
    let at = |r: usize, s: usize, j: usize| match r {
        0 => 0,
        _ => (start(r) + (s * r + j) % (sectors * r)) as u32,
    };
    let mut triangles = Vec::with_capacity(sectors * rows * rows);
    for r in 1..=rows {
        for s in 0..sectors {
            for j in 0..r {
                triangles.push([at(r - 1, s, j), at(r, s, j), at(r, s, j + 1)]);
                if j + 1 < r {
                    triangles.push([at(r - 1, s, j), at(r, s, j + 1), at(r - 1, s, j + 1)]);
                }
            }
        }
    }
    triangles
}

/// The place `r` of `rows` (a power of two) on the way from `a` to `b`: the way is halved again and again, and each middle
/// that lies inside the head is pushed out before it is halved further. So the steps stay alike also where the chord
/// passes near the reference point.
fn halved(mut a: Vec3, mut b: Vec3, r: usize, rows: usize, ground: &Ground) -> Vec3 {
    let (mut lo, mut hi) = (0, rows);
    loop {
        let middle = 0.5 * (a + b);
        let middle = if ground.solid.signed_distance(middle) < 0.0 { ground.below(middle) } else { middle };
        let at = (lo + hi) / 2;
        match r.cmp(&at) {
            std::cmp::Ordering::Equal => return middle,
            std::cmp::Ordering::Less => (b, hi) = (middle, at),
            std::cmp::Ordering::Greater => (a, lo) = (middle, at),
        }
        if hi - lo < 2 {
            return if r == lo { a } else { b };
        }
    }
}
