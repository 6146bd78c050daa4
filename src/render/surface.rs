//! Triangles: four samples per pixel for the outline, shading once per pixel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::scan::{cover, scan};
use super::shade::{Panes, Reach, Skin, Studio};

/// Rows of pixels that one task draws; even, for light is looked up in every other row.
const BAND: usize = 16;
/// Rows of samples in one of pixels, each with one sample: a rotated grid.
const LINES: usize = 4;
/// How far right of its pixel's left border the sample of each row lies, in pixels.
const SAMPLES: [f32; LINES] = [0.375, 0.875, 0.125, 0.625];
/// No triangle.
const NONE: u32 = u32::MAX;

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
    corners: [Vec3; 3],
    weights: Weights,
    /// Index of its mesh.
    shell: u32,
    /// Index within the mesh.
    triangle: u32,
}

/// All triangles that can be seen, and those of each band of rows.
struct Faces {
    /// In the order of the meshes.
    faces: Vec<Face>,
    /// Per band of [`BAND`] rows, and the row after: indices into `faces`.
    of_band: Vec<Vec<u32>>,
}

/// Projects the triangles of all `meshes`.
fn faces<'a>(meshes: impl Iterator<Item = &'a Mesh>, camera: &Camera, task: &Task) -> Result<Faces, Cancelled> {
    let (width, height) = (camera.width as f32, camera.height as f32);
    let mut all = Faces { faces: Vec::new(), of_band: vec![Vec::new(); camera.height.div_ceil(BAND)] };
    for (shell, mesh) in meshes.enumerate() {
        task.check()?;
        let projected: Vec<Vec3> = mesh.positions.iter().map(|&p| camera.project(p)).collect();
        for (triangle, t) in mesh.triangles.iter().enumerate() {
            let corners = t.map(|v| projected[v as usize]);
            let lo = corners[0].min(corners[1]).min(corners[2]);
            let hi = corners[0].max(corners[1]).max(corners[2]);
            let seen = lo.x < width && lo.y < height && hi.x > 0.0 && hi.y > 0.0;
            let (true, Some(weights)) = (seen && lo.is_finite() && hi.is_finite(), Weights::of(&corners)) else {
                continue;
            };
            let (first, last) = ((lo.y - 1.0).max(0.0) as usize / BAND, hi.y.min(height - 1.0) as usize / BAND);
            for band in &mut all.of_band[first..=last] {
                band.push(all.faces.len() as u32);
            }
            all.faces.push(Face { corners, weights, shell: shell as u32, triangle: triangle as u32 });
        }
    }
    Ok(all)
}

/// Rows of samples with what is nearest in each.
struct Nearest {
    width: usize,
    depth: Vec<f32>,
    /// Indices of faces.
    owner: Vec<u32>,
}

impl Nearest {
    /// In `rows` rows of pixels from `top` on, [`LINES`] of samples for each.
    fn new(faces: &[Face], list: &[u32], width: usize, top: usize, rows: usize) -> Self {
        let count = width * rows * LINES;
        let mut all = Self { width, depth: vec![f32::NEG_INFINITY; count], owner: vec![NONE; count] };
        let first = top * LINES;
        let squeezed = Vec3::new(1.0, LINES as f32, 1.0);
        for &f in list {
            let corners = faces[f as usize].corners.map(|c| c * squeezed);
            let lines = first..first + rows * LINES;
            scan(
                corners,
                lines,
                width,
                |y| SAMPLES[y % LINES] - 0.5,
                |y, range, z, step| {
                    let row = (y - first) * width;
                    let range = row + range.start..row + range.end;
                    cover(&mut all.depth[range.clone()], &mut all.owner[range], z, step, f);
                },
            );
        }
        all
    }

    /// The samples of pixel `x` in row `y`: depths and faces.
    fn at(&self, x: usize, y: usize) -> ([f32; LINES], [u32; LINES]) {
        let place = |line: usize| (y * LINES + line) * self.width + x;
        (std::array::from_fn(|i| self.depth[place(i)]), std::array::from_fn(|i| self.owner[place(i)]))
    }
}

/// Draws all `shells`.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(shells: &[Shell], camera: &Camera, studio: &Studio, task: &Task) -> Result<Layer, Cancelled> {
    let (width, height) = (camera.width, camera.height);
    let faces = faces(shells.iter().map(|s| s.mesh), camera, task)?;
    let blank = |value: f32| vec![value; width * height];
    let mut layer =
        Layer { width, depth: blank(f32::NEG_INFINITY), cover: blank(0.0), colour: vec![Vec3::ZERO; width * height] };
    let bands = layer
        .depth
        .par_chunks_mut(BAND * width)
        .zip(layer.cover.par_chunks_mut(BAND * width))
        .zip(layer.colour.par_chunks_mut(BAND * width));
    bands.enumerate().try_for_each(|(band, ((depth, cover), colour))| {
        task.check()?;
        if !faces.of_band[band].is_empty() {
            let pixels = Pixels { depth, cover, colour };
            draw_band(&Row { shells, faces: &faces.faces, camera }, &faces.of_band[band], studio, band * BAND, pixels);
        }
        Ok(())
    })?;
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
    /// Index of the mesh whose material is seen.
    shell: u32,
    tint: Vec3,
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
    fn spot(&self, x: usize, y: usize, depth: [f32; LINES], owner: [u32; LINES]) -> Option<Spot> {
        let pixel = Vec2::new(x as f32, y as f32);
        if owner == [owner[0]; LINES] {
            // The mean over the samples is what lies in the middle between them.
            let face = self.faces.get(owner[0] as usize)?;
            let (normal, tint) = self.course(face, pixel + Vec2::splat(0.5));
            let depth = (depth[0] + depth[1] + depth[2] + depth[3]) * 0.25;
            return Some(Spot { shell: face.shell, tint, normal: self.unit(normal), depth, cover: 1.0 });
        }
        let (mut hits, mut z, mut normal, mut tint, mut shell) = (0.0, 0.0, Vec3::ZERO, Vec3::ZERO, None);
        for s in 0..LINES {
            let Some(face) = self.faces.get(owner[s] as usize) else { continue };
            let at = pixel + Vec2::new(SAMPLES[s], (s as f32 + 0.5) / LINES as f32);
            let (n, t) = self.course(face, at);
            hits += 1.0;
            z += depth[s];
            normal += n;
            tint += t;
            shell = Some(face.shell);
        }
        let (normal, cover) = (self.unit(normal), hits / LINES as f32);
        Some(Spot { shell: shell?, tint: tint / hits, normal, depth: z / hits, cover })
    }

    fn unit(&self, normal: Vec3) -> Vec3 {
        normal.try_normalize().unwrap_or(self.camera.toward)
    }

    /// Normal turned to the viewer and tint of a face at a place in the picture.
    fn course(&self, face: &Face, at: Vec2) -> (Vec3, Vec3) {
        let shell = &self.shells[face.shell as usize];
        let w = face.weights.at(at);
        let t = shell.mesh.triangles[face.triangle as usize].map(|v| v as usize);
        let mix = |v: &[Vec3]| v[t[0]] * w.x + v[t[1]] * w.y + v[t[2]] * w.z;
        let facing = mix(&shell.mesh.normals);
        let normal = if facing.dot(self.camera.toward) < -0.25 { -facing } else { facing };
        (normal, shell.tints.map_or_else(|| shell.skin.albedo(), mix))
    }

    /// The light on what the middle of a pixel shows.
    fn reach(&self, studio: &Studio, x: usize, y: usize, spot: &Spot) -> Reach {
        studio.reach(self.camera.unproject(Vec3::new(x as f32 + 0.5, y as f32 + 0.5, spot.depth)), spot.normal)
    }
}

/// A band of a [`Layer`].
struct Pixels<'a> {
    depth: &'a mut [f32],
    cover: &'a mut [f32],
    colour: &'a mut [Vec3],
}

/// Light is looked up at every so many pixels, and between them where the surface is smooth.
const GRID: usize = 2;

/// Draws the faces in `list` into a band of pixels that begins at row `top`.
fn draw_band(row: &Row, list: &[u32], studio: &Studio, top: usize, pixels: Pixels) {
    let camera = row.camera;
    let width = camera.width;
    let rows = pixels.depth.len() / width;
    // The row after has the light that the last one lies under.
    let all = (rows + 1).min(camera.height - top);
    let nearest = Nearest::new(row.faces, list, width, top, all);
    let spots: Vec<Option<Spot>> = (0..width * all)
        .map(|i| {
            let (depth, owner) = nearest.at(i % width, i / width);
            row.spot(i % width, top + i / width, depth, owner)
        })
        .collect();
    let columns = width.div_ceil(GRID);
    let lights: Vec<Option<Reach>> = (0..all.div_ceil(GRID) * columns)
        .map(|i| {
            let (x, y) = (i % columns * GRID, i / columns * GRID);
            spots[y * width + x].as_ref().map(|spot| row.reach(studio, x, top + y, spot))
        })
        .collect();
    // Farther apart than this, in depth, two neighbours are not of one smooth surface.
    let near = 3.0 * GRID as f32 / camera.scale;
    let mut panes = Panes::default();
    let mut filled = [0; Panes::COUNT];
    let mut count = 0;
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
        let reach = between().unwrap_or_else(|| row.reach(studio, x, top + y, spot));
        pixels.depth[i] = spot.depth;
        pixels.cover[i] = spot.cover;
        panes.set(count, &row.shells[spot.shell as usize].skin, spot.tint, spot.normal, &reach);
        filled[count] = i;
        count += 1;
        if count == Panes::COUNT {
            studio.surface(&mut panes);
            filled.iter().enumerate().for_each(|(lane, &i)| pixels.colour[i] = panes.colour(lane));
            count = 0;
        }
    }
    studio.surface(&mut panes);
    filled[..count].iter().enumerate().for_each(|(lane, &i)| pixels.colour[i] = panes.colour(lane));
}
