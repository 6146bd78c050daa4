//! Triangles: four samples per pixel for the outline, shading once per pixel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::shade::{Reach, Skin, Studio};

/// Rows of pixels that one task draws.
const BAND: usize = 16;
/// Rotated grid of samples within a pixel.
const SAMPLES: [Vec2; 4] =
    [Vec2::new(0.375, 0.125), Vec2::new(0.875, 0.375), Vec2::new(0.125, 0.625), Vec2::new(0.625, 0.875)];

/// A surface and its material, ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Shell<'a> {
    /// The mesh; with normals.
    pub mesh: &'a Mesh,
    /// How it looks.
    pub skin: Skin,
    /// Linear colours per vertex instead of the skin's own.
    pub tints: Option<&'a [Vec3]>,
}

/// The surfaces of a view: one layer that strands pass in front of or behind.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Pixels per row.
    pub width: usize,
    /// Depth per pixel, negative infinity where there is nothing.
    pub depth: Vec<f32>,
    /// Covered part of the pixel, 0..=1.
    pub cover: Vec<f32>,
    /// Linear colour of the covered part.
    pub colour: Vec<Vec3>,
}

/// A triangle in the picture.
struct Face {
    /// In pixels, with depth.
    pub corners: [Vec3; 3],
    /// Index of its mesh.
    pub shell: u32,
    /// Index within the mesh.
    pub triangle: u32,
}

/// All triangles that can be seen, and those of each band of rows.
struct Faces {
    /// In the order of the meshes.
    pub faces: Vec<Face>,
    /// Per band of [`BAND`] rows: indices into `faces`.
    pub of_band: Vec<Vec<u32>>,
}

/// Projects the triangles of all `meshes`.
fn faces<'a>(meshes: impl Iterator<Item = &'a Mesh>, camera: &Camera, task: &Task) -> Result<Faces, Cancelled> {
    let (width, height) = (camera.width, camera.height);
    let mut all = Faces { faces: Vec::new(), of_band: vec![Vec::new(); height.div_ceil(BAND)] };
    for (shell, mesh) in meshes.enumerate() {
        task.check()?;
        let projected: Vec<Vec3> = mesh.positions.iter().map(|&p| camera.project(p)).collect();
        for (triangle, t) in mesh.triangles.iter().enumerate() {
            let corners = t.map(|v| projected[v as usize]);
            let lo = corners[0].min(corners[1]).min(corners[2]);
            let hi = corners[0].max(corners[1]).max(corners[2]);
            let seen = lo.x < width as f32 && lo.y < height as f32 && hi.x > 0.0 && hi.y > 0.0;
            if !(seen && lo.is_finite() && hi.is_finite()) {
                continue;
            }
            let (first, last) = (lo.y.max(0.0) as usize / BAND, hi.y.min(height as f32 - 1.0) as usize / BAND);
            for band in &mut all.of_band[first..=last] {
                band.push(all.faces.len() as u32);
            }
            all.faces.push(Face { corners, shell: shell as u32, triangle: triangle as u32 });
        }
    }
    Ok(all)
}

/// What is nearest in each sample of `rows` rows from `top` on, [`SAMPLES`] per pixel: depths and indices into `faces`.
fn nearest(faces: &[Face], list: &[u32], width: usize, top: usize, rows: usize) -> (Vec<f32>, Vec<u32>) {
    let n = SAMPLES.len();
    let mut depth = vec![f32::NEG_INFINITY; width * rows * n];
    let mut owner = vec![u32::MAX; width * rows * n];
    for &f in list {
        let c = &faces[f as usize].corners;
        let Some(weights) = Weights::of(c) else { continue };
        let depths = Vec3::new(c[0].z, c[1].z, c[2].z);
        let lo = c[0].min(c[1]).min(c[2]);
        let hi = c[0].max(c[1]).max(c[2]);
        let (x0, x1) = (lo.x.max(0.0) as usize, (hi.x.min(width as f32 - 1.0)) as usize);
        let y0 = (lo.y.max(top as f32) as usize).max(top);
        let y1 = (hi.y.max(0.0) as usize).min(top + rows - 1);
        for y in y0..=y1 {
            for x in x0..=x1 {
                for (s, offset) in SAMPLES.iter().enumerate() {
                    let w = weights.at(Vec2::new(x as f32, y as f32) + *offset);
                    if w.min_element() < 0.0 {
                        continue;
                    }
                    let z = depths.dot(w);
                    let i = ((y - top) * width + x) * n + s;
                    if z > depth[i] {
                        depth[i] = z;
                        owner[i] = f;
                    }
                }
            }
        }
    }
    (depth, owner)
}

/// Draws all `shells`.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(shells: &[Shell], camera: &Camera, studio: &Studio, task: &Task) -> Result<Layer, Cancelled> {
    let (width, height) = (camera.width, camera.height);
    let faces = faces(shells.iter().map(|s| s.mesh), camera, task)?;
    let drawn: Result<Vec<Layer>, Cancelled> = (0..faces.of_band.len())
        .into_par_iter()
        .map(|band| {
            task.check()?;
            let top = band * BAND;
            Ok(draw_band(shells, &faces, band, camera, studio, top, BAND.min(height - top)))
        })
        .collect();
    let mut layer = Layer { width, depth: Vec::new(), cover: Vec::new(), colour: Vec::new() };
    for band in drawn? {
        layer.depth.extend(band.depth);
        layer.cover.extend(band.cover);
        layer.colour.extend(band.colour);
    }
    Ok(layer)
}

/// Barycentric weights as linear functions of the place.
#[derive(Clone, Copy)]
struct Weights {
    origin: Vec2,
    /// Change per pixel to the right and downward.
    by: [Vec3; 2],
}

impl Weights {
    /// None for a triangle seen edge on.
    fn of(c: &[Vec3; 3]) -> Option<Self> {
        let (a, b) = ((c[1] - c[0]).truncate(), (c[2] - c[0]).truncate());
        let area = a.perp_dot(b);
        if area.abs() < 1e-12 || area.is_nan() {
            return None;
        }
        let (x, y) = (Vec2::new(b.y, -a.y) / area, Vec2::new(-b.x, a.x) / area);
        let by = [Vec3::new(-x.x - x.y, x.x, x.y), Vec3::new(-y.x - y.y, y.x, y.y)];
        Some(Self { origin: c[0].truncate(), by })
    }

    fn at(&self, p: Vec2) -> Vec3 {
        let q = p - self.origin;
        Vec3::X + self.by[0] * q.x + self.by[1] * q.y
    }
}

/// What a pixel shows of the surfaces.
#[derive(Clone, Copy)]
struct Spot {
    skin: Skin,
    tint: Vec3,
    point: Vec3,
    normal: Vec3,
    depth: f32,
    cover: f32,
}

/// Finds what the pixels of a row show.
struct Row<'a> {
    shells: &'a [Shell<'a>],
    faces: &'a [Face],
    camera: &'a Camera,
}

impl Row<'_> {
    /// At pixel (`x`, `y`), whose samples have these depths and faces.
    fn spot(&self, x: usize, y: usize, depth: &[f32], owner: &[u32]) -> Option<Spot> {
        let n = SAMPLES.len();
        let pixel = Vec2::new(x as f32, y as f32);
        if owner.iter().all(|&f| f == owner[0]) {
            // The mean over the samples is what lies in the middle between them.
            let face = self.faces.get(owner[0] as usize)?;
            let (point, normal, tint, skin) = self.course(face, pixel + Vec2::splat(0.5));
            let depth = depth.iter().sum::<f32>() / n as f32;
            return Some(Spot { skin, tint, point, normal: self.unit(normal), depth, cover: 1.0 });
        }
        let (mut hits, mut z, mut point, mut normal, mut tint) = (0.0, 0.0, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
        let mut skin = None;
        for (s, offset) in SAMPLES.iter().enumerate() {
            let Some(face) = self.faces.get(owner[s] as usize) else { continue };
            let (p, n, t, own) = self.course(face, pixel + *offset);
            hits += 1.0;
            z += depth[s];
            point += p;
            normal += n;
            tint += t;
            skin = Some(own);
        }
        let normal = self.unit(normal);
        Some(Spot {
            skin: skin?,
            tint: tint / hits,
            point: point / hits,
            normal,
            depth: z / hits,
            cover: hits / n as f32,
        })
    }

    fn unit(&self, normal: Vec3) -> Vec3 {
        normal.try_normalize().unwrap_or(self.camera.toward)
    }

    /// Point, normal turned to the viewer, tint and skin of a face at a place in the picture.
    fn course(&self, face: &Face, at: Vec2) -> (Vec3, Vec3, Vec3, Skin) {
        let shell = &self.shells[face.shell as usize];
        let w = Weights::of(&face.corners).map_or(Vec3::splat(1.0 / 3.0), |w| w.at(at));
        let t = shell.mesh.triangles[face.triangle as usize].map(|v| v as usize);
        let mix = |v: &[Vec3]| v[t[0]] * w.x + v[t[1]] * w.y + v[t[2]] * w.z;
        let facing = mix(&shell.mesh.normals);
        let normal = if facing.dot(self.camera.toward) < -0.25 { -facing } else { facing };
        (mix(&shell.mesh.positions), normal, shell.tints.map_or_else(|| shell.skin.albedo(), mix), shell.skin)
    }
}

/// Light is looked up at every so many pixels, and between them where the surface is smooth.
const GRID: usize = 2;

fn draw_band(
    shells: &[Shell],
    Faces { faces, of_band }: &Faces,
    band: usize,
    camera: &Camera,
    studio: &Studio,
    top: usize,
    rows: usize,
) -> Layer {
    let (width, n) = (camera.width, SAMPLES.len());
    let row = Row { shells, faces, camera };
    let spots_of = |list: &[u32], top: usize, rows: usize| -> Vec<Option<Spot>> {
        if list.is_empty() {
            return vec![None; width * rows];
        }
        let (depth, owner) = nearest(faces, list, width, top, rows);
        let samples = depth.chunks_exact(n).zip(owner.chunks_exact(n)).enumerate();
        samples.map(|(i, (depth, owner))| row.spot(i % width, top + i / width, depth, owner)).collect()
    };
    let mut spots = spots_of(&of_band[band], top, rows);
    if let Some(list) = of_band.get(band + 1) {
        spots.extend(spots_of(list, top + rows, 1));
    }
    let columns = width.div_ceil(GRID);
    let lights: Vec<Option<Reach>> = (0..spots.len().div_ceil(width).div_ceil(GRID) * columns)
        .map(|i| spots[i / columns * GRID * width + i % columns * GRID])
        .map(|spot| spot.map(|s| studio.reach(s.point, s.normal)))
        .collect();
    let mut layer = Layer {
        width,
        depth: vec![f32::NEG_INFINITY; width * rows],
        cover: vec![0.0; width * rows],
        colour: vec![Vec3::ZERO; width * rows],
    };
    // Farther apart than this, in depth, two neighbours are not of one smooth surface.
    let near = 3.0 * GRID as f32 / camera.scale;
    for i in 0..width * rows {
        let Some(spot) = &spots[i] else { continue };
        let (x, y) = (i % width, i / width);
        let (fx, fy) = ((x % GRID) as f32 / GRID as f32, (y % GRID) as f32 / GRID as f32);
        let between = || {
            let mut sum = Reach::NONE;
            for (dx, dy, weight) in
                [(0, 0, (1.0 - fx) * (1.0 - fy)), (1, 0, fx * (1.0 - fy)), (0, 1, (1.0 - fx) * fy), (1, 1, fx * fy)]
            {
                if weight > 0.0 {
                    let (gx, gy) = (x / GRID + dx, y / GRID + dy);
                    if gx >= columns {
                        return None;
                    }
                    let other = spots.get(gy * GRID * width + gx * GRID)?.as_ref()?;
                    if (other.depth - spot.depth).abs() > near || other.normal.dot(spot.normal) < 0.9 {
                        return None;
                    }
                    sum = sum.plus(lights.get(gy * columns + gx)?.as_ref()?, weight);
                }
            }
            Some(sum)
        };
        let reach = between().unwrap_or_else(|| studio.reach(spot.point, spot.normal));
        layer.depth[i] = spot.depth;
        layer.cover[i] = spot.cover;
        layer.colour[i] = studio.surface(&spot.skin.tinted(spot.tint), spot.normal, &reach);
    }
    layer
}
