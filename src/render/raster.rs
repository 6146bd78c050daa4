//! Lines and surfaces into pixels: tile by tile, the nearest segment first.
//!
//! Each tile sorts its segments by depth and lays them over each other from front to back: every pixel keeps how much
//! light still passes, a strand thinner than a pixel takes only its part of that, and what can no longer be seen is
//! neither shaded nor drawn. Surfaces come in between as one layer with its own depth per pixel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::fast;
use super::shade::Studio;
use super::strands::{Bundle, Chunk, Ink, Tiles, Vertex, gather};
use super::surface::Layer;

/// A pixel through which less than this passes is finished: half of what 8 bits can show.
const CLOSED: f32 = 1.0 / 512.0;
/// Strands this far (cm) under a surface still count as on it: roots lie in the skin.
const ON_SURFACE: f32 = 0.05;

/// What belongs to a picture besides its lines.
#[derive(Clone, Copy, Debug)]
pub struct Canvas<'a> {
    /// Where from; with `supersample` times the pixels of the picture.
    pub camera: &'a Camera,
    /// Pixels of the camera per pixel of the picture, on each side.
    pub supersample: usize,
    /// Lamps.
    pub studio: &'a Studio<'a>,
    /// Surfaces.
    pub layer: &'a Layer,
    /// How much of the surfaces is there: 1, or less to see through them.
    pub solid: f32,
    /// Linear colour behind everything.
    pub background: Vec3,
    /// Height above the lower border, as a fraction of the picture's, over which all fades into the background.
    pub fade: f32,
}

/// Draws `bundles` over `canvas`: sRGB bytes, row by row.
///
/// # Errors
/// [`Cancelled`].
pub fn draw(bundles: &[Bundle], canvas: &Canvas, task: &Task) -> Result<Vec<u8>, Cancelled> {
    let (camera, ss) = (canvas.camera, canvas.supersample.max(1));
    let (width, height) = (camera.width / ss, camera.height / ss);
    let edge = (32 / ss).max(1);
    let tiles = Tiles::new(camera.width, camera.height, edge * ss);
    let chunks = gather(bundles, camera, tiles, task)?;
    let far = depth_range(&chunks);
    let drawn: Result<Vec<Vec<[u8; 3]>>, Cancelled> = (0..tiles.count())
        .into_par_iter()
        .map(|tile| {
            task.check()?;
            let mut pixels = Tile::new(canvas, tiles, tile);
            pixels.lines(bundles, &chunks, canvas, tile, far);
            Ok(pixels.resolve(canvas, edge, ss))
        })
        .collect();
    let mut picture = vec![0; width * height * 3];
    for (tile, pixels) in drawn?.iter().enumerate() {
        let (x0, y0) = (tile % tiles.columns * edge, tile / tiles.columns * edge);
        for y in y0..(y0 + edge).min(height) {
            for x in x0..(x0 + edge).min(width) {
                let i = (y * width + x) * 3;
                picture[i..i + 3].copy_from_slice(&pixels[(y - y0) * edge + x - x0]);
            }
        }
    }
    Ok(picture)
}

/// Nearest depth, and depth steps of the sorting key per cm.
fn depth_range(chunks: &[Chunk]) -> (f32, f32) {
    let (far, near) = chunks
        .par_iter()
        .map(|c| c.vertices.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), v| (a.min(v.at.z), b.max(v.at.z))))
        .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    (near, DEPTHS / (near - far).max(1e-3))
}

/// Steps of depth in a sorting key: 20 bits.
const DEPTHS: f32 = 1_048_575.0;

#[derive(Clone, Copy)]
struct Pixel {
    /// Light gathered so far, linear.
    light: Vec3,
    /// Part of what lies behind that is still seen.
    open: f32,
    /// Depth of the surface that still has to come; negative infinity afterwards.
    surface: f32,
}

/// One tile while it is drawn.
struct Tile {
    edge: usize,
    x0: usize,
    y0: usize,
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
    closed: usize,
}

impl Tile {
    fn new(canvas: &Canvas, tiles: Tiles, tile: usize) -> Self {
        let edge = tiles.edge;
        let (x0, y0) = (tile % tiles.columns * edge, tile / tiles.columns * edge);
        let (width, height) = (edge.min(canvas.camera.width - x0), edge.min(canvas.camera.height - y0));
        let mut pixels = vec![Pixel { light: Vec3::ZERO, open: 1.0, surface: f32::NEG_INFINITY }; edge * edge];
        for y in 0..height {
            for x in 0..width {
                pixels[y * edge + x].surface = canvas.layer.depth[(y0 + y) * canvas.layer.width + x0 + x];
            }
        }
        Self { edge, x0, y0, width, height, pixels, closed: 0 }
    }

    /// Lays all segments of the tile over each other, nearest first.
    fn lines(&mut self, bundles: &[Bundle], chunks: &[Chunk], canvas: &Canvas, tile: usize, far: (f32, f32)) {
        let mut order: Vec<u64> = Vec::new();
        for (c, chunk) in chunks.iter().enumerate() {
            for &s in chunk.segments(tile) {
                let (a, b) = (&chunk.vertices[s as usize], &chunk.vertices[s as usize + 1]);
                let behind = ((far.0 - 0.5 * (a.at.z + b.at.z)) * far.1).clamp(0.0, DEPTHS) as u64;
                order.push(behind << 44 | (c as u64) << 24 | u64::from(s));
            }
        }
        order.sort_unstable();
        for key in order {
            let chunk = &chunks[(key >> 24 & 0xf_ffff) as usize];
            let s = (key & 0xff_ffff) as usize;
            let bundle = &bundles[chunk.bundle as usize];
            self.segment(bundle, &chunk.vertices[s], &chunk.vertices[s + 1], canvas);
            if self.closed == self.width * self.height {
                break;
            }
        }
    }

    /// Draws one segment: per step along its longer axis, the part of each pixel that its width covers across. Summed
    /// over the pixels of a step that is exactly the width, wherever between them the line runs.
    fn segment(&mut self, bundle: &Bundle, va: &Vertex, vb: &Vertex, canvas: &Canvas) {
        let origin = Vec2::new(self.x0 as f32 + 0.5, self.y0 as f32 + 0.5);
        let steep = (vb.at.y - va.at.y).abs() > (vb.at.x - va.at.x).abs();
        // Along the longer axis there is one row of pixels per step; `u` runs along it.
        let turn = |v: Vec3| {
            let p = v.truncate() - origin;
            if steep { Vec3::new(p.y, p.x, v.z) } else { Vec3::new(p.x, p.y, v.z) }
        };
        let (mut a, mut b) = (turn(va.at), turn(vb.at));
        let (mut wa, mut wb) = (width(bundle, va), width(bundle, vb));
        let swapped = a.x > b.x;
        if swapped {
            (a, b, wa, wb) = (b, a, wb, wa);
        }
        let d = b - a;
        let length = d.truncate().length();
        if !(d.x > 1e-6) {
            return;
        }
        // Broad lines are lengthened a little, or their outer bends would gape.
        let more = if wa.max(wb) > 1.5 { 0.3 * wa.max(wb) * d.x / length } else { 0.0 };
        let slope = Vec3::new(1.0, d.y / d.x, d.z / d.x);
        let cosine = d.x / length;
        let (nu, nv) = if steep { (self.height, self.width) } else { (self.width, self.height) };
        let first = (a.x - more).ceil().max(0.0) as usize;
        let end = (b.x + more).ceil().clamp(0.0, nu as f32) as usize;
        let mut colours: Option<(Vec3, Vec3)> = None;
        for u in first..end {
            let step = u as f32 - a.x;
            let t = (step / d.x).clamp(0.0, 1.0);
            let w = (wa + (wb - wa) * t) / cosine;
            let middle = a.y + slope.y * step;
            let z = a.z + slope.z * step;
            let reach = 0.5 * (w + 1.0);
            let v0 = (middle - reach).ceil().max(0.0) as usize;
            let v1 = (middle + reach).floor().min(nv as f32 - 1.0);
            if v1 < 0.0 {
                continue;
            }
            for v in v0..=v1 as usize {
                let i = if steep { u * self.edge + v } else { v * self.edge + u };
                if self.pixels[i].open < CLOSED {
                    continue;
                }
                if z + ON_SURFACE < self.pixels[i].surface {
                    self.lay_surface(i, canvas);
                    if self.pixels[i].open < CLOSED {
                        continue;
                    }
                }
                let cover = (reach - (v as f32 - middle).abs()).clamp(0.0, w.min(1.0));
                let (ca, cb) = *colours.get_or_insert_with(|| {
                    let (ca, cb) = (colour(bundle, va, canvas.studio), colour(bundle, vb, canvas.studio));
                    if swapped { (cb, ca) } else { (ca, cb) }
                });
                let pixel = &mut self.pixels[i];
                pixel.light += (ca + (cb - ca) * t) * (pixel.open * cover);
                pixel.open *= 1.0 - cover;
                self.closed += usize::from(pixel.open < CLOSED);
            }
        }
    }

    /// Puts the surface of pixel `i` behind what is there.
    fn lay_surface(&mut self, i: usize, canvas: &Canvas) {
        let at = (self.y0 + i / self.edge) * canvas.layer.width + self.x0 + i % self.edge;
        let pixel = &mut self.pixels[i];
        if pixel.surface == f32::NEG_INFINITY {
            return;
        }
        let cover = canvas.layer.cover[at] * canvas.solid;
        pixel.light += canvas.layer.colour[at] * (pixel.open * cover);
        let before = pixel.open;
        pixel.open *= 1.0 - cover;
        pixel.surface = f32::NEG_INFINITY;
        self.closed += usize::from(pixel.open < CLOSED && before >= CLOSED);
    }

    /// Surfaces and background behind the lines, the mean over supersamples, sRGB.
    fn resolve(mut self, canvas: &Canvas, edge: usize, ss: usize) -> Vec<[u8; 3]> {
        for y in 0..self.height {
            for x in 0..self.width {
                self.lay_surface(y * self.edge + x, canvas);
            }
        }
        let height = canvas.camera.height as f32;
        let mut out = Vec::with_capacity(edge * edge);
        for y in 0..edge {
            let above = (height - (self.y0 + y * ss) as f32 - 0.5 * ss as f32) / height;
            let keep = if canvas.fade > 0.0 { crate::math::trig::smoothstep(0.0, canvas.fade, above) } else { 1.0 };
            for x in 0..edge {
                let mut sum = Vec3::ZERO;
                for k in 0..ss * ss {
                    let p = self.pixels[(y * ss + k / ss) * self.edge + x * ss + k % ss];
                    sum += p.light + canvas.background * p.open;
                }
                let mean = sum / (ss * ss) as f32;
                out.push(fast::encode(canvas.background + (mean - canvas.background) * keep));
            }
        }
        out
    }
}

/// Where along its line a vertex is, 0 first node to 1 last.
fn along(bundle: &Bundle, v: &Vertex) -> f32 {
    let (first, end) = (bundle.offsets[v.line as usize], bundle.offsets[v.line as usize + 1]);
    ((v.node - first) as f32 + v.part) / ((end - first) as f32 - 1.0).max(1.0)
}

fn width(bundle: &Bundle, v: &Vertex) -> f32 {
    bundle.width[0] + (bundle.width[1] - bundle.width[0]) * along(bundle, v)
}

fn colour(bundle: &Bundle, v: &Vertex, studio: &Studio) -> Vec3 {
    let (first, end) = (bundle.offsets[v.line as usize] as usize, bundle.offsets[v.line as usize + 1] as usize);
    let node = v.node as usize;
    let next = (node + 1).min(end - 1);
    match bundle.ink {
        Ink::Flat(colours) => colours[node] + (colours[next] - colours[node]) * v.part,
        Ink::Hair(coat, roots) => {
            let points = bundle.points;
            let p = points[node] + (points[next] - points[node]) * v.part;
            let before = if v.part > 0.0 { node } else { node.saturating_sub(1).max(first) };
            let tangent = (points[next] - points[before]).normalize_or_zero();
            let strand = coat.strand(roots.get(v.line as usize).map_or(0, |r| r.id));
            studio.hair(&coat, &strand, p, tangent, along(bundle, v))
        }
    }
}
