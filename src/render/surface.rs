//! Triangles: four samples per pixel for the outline, shading once per pixel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::shade::{Skin, Studio};

/// Rows of pixels that one task draws.
pub(super) const BAND: usize = 16;
/// Rotated grid of samples within a pixel.
pub(super) const SAMPLES: [Vec2; 4] =
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
pub(super) struct Face {
    /// In pixels, with depth.
    pub corners: [Vec3; 3],
    /// Index of its mesh.
    pub shell: u32,
    /// Index within the mesh.
    pub triangle: u32,
}

/// All triangles that can be seen, and those of each band of rows.
pub(super) struct Faces {
    /// In the order of the meshes.
    pub faces: Vec<Face>,
    /// Per band of [`BAND`] rows: indices into `faces`.
    pub of_band: Vec<Vec<u32>>,
}

/// Projects the triangles of all `meshes`.
pub(super) fn faces<'a>(
    meshes: impl Iterator<Item = &'a Mesh>,
    camera: &Camera,
    task: &Task,
) -> Result<Faces, Cancelled> {
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
pub(super) fn nearest(faces: &[Face], list: &[u32], width: usize, top: usize, rows: usize) -> (Vec<f32>, Vec<u32>) {
    let n = SAMPLES.len();
    let mut depth = vec![f32::NEG_INFINITY; width * rows * n];
    let mut owner = vec![u32::MAX; width * rows * n];
    for &f in list {
        let c = &faces[f as usize].corners;
        let lo = c[0].min(c[1]).min(c[2]);
        let hi = c[0].max(c[1]).max(c[2]);
        let (x0, x1) = (lo.x.max(0.0) as usize, (hi.x.min(width as f32 - 1.0)) as usize);
        let y0 = (lo.y.max(top as f32) as usize).max(top);
        let y1 = (hi.y.max(0.0) as usize).min(top + rows - 1);
        for y in y0..=y1 {
            for x in x0..=x1 {
                for (s, offset) in SAMPLES.iter().enumerate() {
                    let Some(w) = weights(c, Vec2::new(x as f32, y as f32) + *offset) else { continue };
                    let z = c[0].z * w[0] + c[1].z * w[1] + c[2].z * w[2];
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
    let Faces { faces, of_band } = faces(shells.iter().map(|s| s.mesh), camera, task)?;
    let drawn: Result<Vec<Layer>, Cancelled> = of_band
        .par_iter()
        .enumerate()
        .map(|(band, list)| {
            task.check()?;
            let top = band * BAND;
            Ok(draw_band(shells, &faces, list, camera, studio, top, BAND.min(height - top)))
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

/// Barycentric weights of `p` in the triangle; all at least 0 inside.
pub(super) fn weights(c: &[Vec3; 3], p: Vec2) -> Option<[f32; 3]> {
    let edge = |a: Vec3, b: Vec3| (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    let w = [edge(c[1], c[2]), edge(c[2], c[0]), edge(c[0], c[1])];
    let area = w[0] + w[1] + w[2];
    if area.abs() < 1e-12 {
        return None;
    }
    let w = w.map(|w| w / area);
    (w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0).then_some(w)
}

fn draw_band(
    shells: &[Shell],
    faces: &[Face],
    list: &[u32],
    camera: &Camera,
    studio: &Studio,
    top: usize,
    rows: usize,
) -> Layer {
    let width = camera.width;
    let n = SAMPLES.len();
    let (depth, owner) = nearest(faces, list, width, top, rows);
    let mut layer = Layer {
        width,
        depth: vec![f32::NEG_INFINITY; width * rows],
        cover: vec![0.0; width * rows],
        colour: vec![Vec3::ZERO; width * rows],
    };
    for i in 0..width * rows {
        let pixel = Vec2::new((i % width) as f32, (top + i / width) as f32);
        let (mut hits, mut z, mut point, mut normal) = (0.0, 0.0, Vec3::ZERO, Vec3::ZERO);
        let (mut skin, mut tint) = (None, Vec3::ZERO);
        for (s, offset) in SAMPLES.iter().enumerate() {
            let Some(face) = faces.get(owner[i * n + s] as usize) else { continue };
            let Some(w) = weights(&face.corners, pixel + *offset) else { continue };
            let shell = &shells[face.shell as usize];
            let t = shell.mesh.triangles[face.triangle as usize].map(|v| v as usize);
            let mix = |v: &[Vec3]| v[t[0]] * w[0] + v[t[1]] * w[1] + v[t[2]] * w[2];
            hits += 1.0;
            z += depth[i * n + s];
            point += mix(&shell.mesh.positions);
            let facing = mix(&shell.mesh.normals);
            normal += if facing.dot(camera.toward) < -0.25 { -facing } else { facing };
            tint += shell.tints.map_or_else(|| shell.skin.albedo(), mix);
            skin = Some(shell.skin);
        }
        if let Some(skin) = skin {
            layer.depth[i] = z / hits;
            layer.cover[i] = hits / n as f32;
            let n = normal.try_normalize().unwrap_or(camera.toward);
            layer.colour[i] = studio.surface(&skin.tinted(tint / hits), point / hits, n);
        }
    }
    layer
}
