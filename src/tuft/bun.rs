//! Buns, and rings around locks.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::{Tuft, TuftError};
use crate::geometry::Mesh;
use crate::math::trig;
use crate::params::{Angle, Direction};

crate::params! {
    /// A bun: a closed ball of hair, with grooves where its locks lie side by side.
    pub struct BunOptions("coif.bun") {
        /// Its middle.
        position: Vec3;
        /// From the head outward through its middle.
        axis: Direction = Direction(Vec3::Y);
        /// Radius across the axis.
        radius: f32 = 3.0, unit("cm"), range(0.1, 30.0);
        /// Length along the axis; as long as wide when left out.
        length: Option<f32>, unit("cm"), range(0.1, 60.0);
        /// Number of grooves; 0 for a smooth bun.
        grooves: u32 = 0, range(0.0, 60.0);
        /// Depth of the grooves as a fraction of the radius.
        groove_depth: f32 = 0.18, range(0.0, 0.5);
        /// How far the grooves wind about the axis from pole to pole.
        swirl: Angle = Angle::degrees(120.0), range(-3600.0, 3600.0);
        /// Greatest distance of the mesh from the true surface.
        tolerance: f32 = 0.03, unit("cm"), range(0.001, 5.0);
    }
}

impl BunOptions {
    /// A smooth bun with the defaults.
    pub fn at(position: Vec3) -> Self {
        Self {
            position,
            axis: Direction(Vec3::Y),
            radius: 3.0,
            length: None,
            grooves: 0,
            groove_depth: 0.18,
            swirl: Angle::degrees(120.0),
            tolerance: 0.03,
        }
    }

    /// The bun as a closed mesh that faces outward; v of its uv runs along the axis.
    ///
    /// # Errors
    /// Numbers that are not finite or out of range.
    pub fn build(&self) -> Result<Mesh, TuftError> {
        if !self.position.is_finite() {
            return Err(TuftError::NotFinite { number: 1, point: self.position });
        }
        TuftError::check("radius", self.radius, 1e-3, 1000.0)?;
        let half = 0.5 * self.length.unwrap_or(2.0 * self.radius);
        TuftError::check("length", half, 1e-3, 1000.0)?;
        TuftError::check("groove_depth", self.groove_depth, 0.0, 0.9)?;
        TuftError::check("tolerance", self.tolerance, 1e-4, 1000.0)?;
        TuftError::check("grooves", self.grooves as f32, 0.0, 1000.0)?;

        // Chords of the circle, and four vertices to a groove at least
        let greatest = self.radius.max(half);
        let step = trig::acos(1.0 - (self.tolerance / greatest).min(0.5));
        let around = ((PI / step).ceil() as usize).clamp(8, 512);
        let grooves = self.grooves as usize;
        let sides = if grooves == 0 { around } else { grooves * around.div_ceil(grooves).max(4) };
        let turns = if grooves == 0 { 0.0 } else { self.swirl.radians.abs() };
        let rings = around.div_ceil(2).max((turns / 0.2) as usize).min(512);

        let axis = self.axis.0;
        // Seen from the front the seam lies at the back.
        let back = [Vec3::NEG_Z, Vec3::NEG_Y].map(|v| v - axis * v.dot(axis));
        let u = if back[0].length_squared() > 0.01 { back[0] } else { back[1] }.normalize_or_zero();
        let w = axis.cross(u);
        let rows: Vec<Vec<Vec3>> = (1..rings)
            .map(|i| {
                let latitude = PI * i as f32 / rings as f32;
                let (ring, along) = (trig::sin(latitude), -half * trig::cos(latitude));
                let wind = self.swirl.radians * (i as f32 / rings as f32 - 0.5);
                (0..sides)
                    .map(|j| {
                        let angle = TAU * j as f32 / sides as f32;
                        // A row of round locks: |cos| has its creases where two of them meet. They fade at the poles.
                        let lock = trig::cos(0.5 * grooves as f32 * (angle - wind)).abs();
                        let crease = if grooves == 0 { 0.0 } else { self.groove_depth * (1.0 - lock) * ring };
                        let r = self.radius * ring * (1.0 - crease);
                        self.position + axis * along + (u * trig::cos(angle) + w * trig::sin(angle)) * r
                    })
                    .collect()
            })
            .collect();
        Ok(ball(&rows, self.position - axis * half, self.position + axis * half))
    }
}

/// A closed mesh over rings that turn counter-clockwise about the way from `start` to `end`.
fn ball(rows: &[Vec<Vec3>], start: Vec3, end: Vec3) -> Mesh {
    let (rings, n) = (rows.len(), rows[0].len());
    let mut mesh = Mesh::default();
    for (i, row) in rows.iter().enumerate() {
        for j in 0..=n {
            mesh.positions.push(row[j % n]);
            mesh.uvs.push(Vec2::new(j as f32 / n as f32, (i + 1) as f32 / (rings + 1) as f32));
        }
    }
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let poles = mesh.positions.len() as u32;
    for (v, p) in [(0.0, start), (1.0, end)] {
        for j in 0..n {
            mesh.positions.push(p);
            mesh.uvs.push(Vec2::new((j as f32 + 0.5) / n as f32, v));
        }
    }
    for j in 0..n {
        mesh.triangles.push([poles + j as u32, at(0, j + 1), at(0, j)]);
        for i in 0..rings - 1 {
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
        mesh.triangles.push([poles + (n + j) as u32, at(rings - 1, j), at(rings - 1, j + 1)]);
    }
    mesh.compute_normals();
    mesh
}

crate::choices! {
    /// The shape of a ring around a lock.
    pub enum RingShape {
        /// A cord: round across.
        Round = "round",
        /// A ribbon: flat across.
        Flat = "flat",
    }
}

crate::params! {
    /// A ring or ribbon around a lock.
    pub struct RingOptions("coif.ring") {
        /// Place along the stroke: 0 root, 1 tip.
        at: f32, range(0.0, 1.0);
        /// Length along the stroke.
        width: f32 = 0.8, unit("cm"), range(0.02, 20.0);
        /// How far it stands off the lock.
        thickness: f32 = 0.25, unit("cm"), range(0.01, 5.0);
        /// A round cord or a flat ribbon.
        shape: RingShape = RingShape::Round;
        /// Vertices around the lock.
        sides: u32 = 32, range(3.0, 400.0);
    }
}

impl RingOptions {
    /// A round ring at a place, otherwise with the defaults.
    pub fn at(at: f32) -> Self {
        Self { at, width: 0.8, thickness: 0.25, shape: RingShape::Round, sides: 32 }
    }

    /// The ring around `tuft` as a closed mesh that faces outward; u of its uv runs around the lock.
    ///
    /// # Errors
    /// Numbers out of range; a place where the lock has no thickness or its tips are apart.
    pub fn build(&self, tuft: &Tuft) -> Result<Mesh, TuftError> {
        TuftError::check("at", self.at, 0.0, 1.0)?;
        TuftError::check("width", self.width, 1e-3, 1000.0)?;
        TuftError::check("thickness", self.thickness, 1e-3, 1000.0)?;
        TuftError::check("sides", self.sides as f32, 3.0, 1024.0)?;
        if let Some(split) = tuft.section.split {
            TuftError::check("at (the tips part here)", self.at, 0.0, split.from)?;
        }
        let surface = tuft.surface();
        let middle = surface.cut(self.at);
        if middle.w.min(middle.h) < 0.02 {
            return Err(TuftError::NoSize { what: "thickness to put a ring around" });
        }
        let inner = (0.5 * middle.w.min(middle.h)).min(0.5 * self.thickness);
        let n = self.sides as usize;
        // The band's own section: (along the stroke, off the lock), counter-clockwise with the stroke to the right and
        // outward up. A superellipse: exponent 1 is round, less is squarer.
        let (steps, exponent) = match self.shape {
            RingShape::Round => (12, 1.0),
            RingShape::Flat => (16, 0.35),
        };
        let band: Vec<Vec2> = (0..steps)
            .map(|k| {
                let angle = TAU * k as f32 / steps as f32;
                let power = |x: f32| x.signum() * trig::pow(x.abs(), exponent);
                let (x, y) = (power(trig::cos(angle)), power(trig::sin(angle)));
                let (middle, half) = (0.5 * (self.thickness - inner), 0.5 * (self.thickness + inner));
                Vec2::new(0.5 * self.width * x, middle + half * y)
            })
            .collect();

        let unit = super::skin::outline(n);
        let corners: Vec<Vec3> = unit.iter().map(|o| middle.place(o.x, o.y)).collect();
        let mut mesh = Mesh::default();
        for j in 0..=n {
            let here = corners[j % n];
            let around = corners[(j + 1) % n] - corners[(j + n - 1) % n];
            // The band stands square to the stroke.
            let off = middle.frame.tangent.cross(around).try_normalize().unwrap_or(middle.frame.normal);
            for k in 0..=steps {
                let b = band[k % steps];
                mesh.positions.push(here + middle.frame.tangent * b.x + off * b.y);
                mesh.uvs.push(Vec2::new(j as f32 / n as f32, k as f32 / steps as f32));
            }
        }
        let at = |j: usize, k: usize| (j * (steps + 1) + k) as u32;
        for j in 0..n {
            for k in 0..steps {
                mesh.triangles.push([at(j, k), at(j + 1, k + 1), at(j, k + 1)]);
                mesh.triangles.push([at(j, k), at(j + 1, k), at(j + 1, k + 1)]);
            }
        }
        mesh.compute_normals();
        Ok(mesh)
    }
}
