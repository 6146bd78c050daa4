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
use super::strands::{Bundle, Chunk, Ink, Tiles, gather};
use super::surface::Layer;

/// A pixel through which less than this passes is finished: what is there is scaled up to fill it.
const CLOSED: f32 = 1.0 / 64.0;
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
    task.progress("hair: tiles", 0.6);
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

/// A segment as a tile draws it.
struct Piece<'a> {
    ends: [Vec3; 2],
    /// Pixels, at either end.
    width: [f32; 2],
    bundle: &'a Bundle<'a>,
    chunk: &'a Chunk,
    segment: usize,
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
        // Copied once in the order of memory: by depth they lie scattered over all strands.
        let (mut order, mut pieces) = (Vec::<u64>::new(), Vec::new());
        for chunk in chunks {
            let bundle = &bundles[chunk.bundle as usize];
            for &s in chunk.segments(tile) {
                let (a, b) = (&chunk.vertices[s as usize], &chunk.vertices[s as usize + 1]);
                let behind = ((far.0 - 0.5 * (a.at.z + b.at.z)) * far.1).clamp(0.0, DEPTHS) as u64;
                order.push(behind << 32 | pieces.len() as u64);
                let width = [a, b].map(|v| bundle.width[0] + (bundle.width[1] - bundle.width[0]) * v.along());
                pieces.push(Piece { ends: [a.at, b.at], width, bundle, chunk, segment: s as usize });
            }
        }
        order.sort_unstable();
        for key in order {
            self.segment(&pieces[(key & 0xffff_ffff) as usize], canvas);
            if self.closed == self.width * self.height {
                break;
            }
        }
    }

    /// Draws one segment: per step along its longer axis, the part of each pixel that its width covers across. Summed
    /// over the pixels of a step that is exactly the width, wherever between them the line runs.
    fn segment(&mut self, piece: &Piece, canvas: &Canvas) {
        let &Piece { ends: [va, vb], width: [mut wa, mut wb], bundle, chunk, segment } = piece;
        let origin = Vec2::new(self.x0 as f32 + 0.5, self.y0 as f32 + 0.5);
        let steep = (vb.y - va.y).abs() > (vb.x - va.x).abs();
        // Along the longer axis there is one row of pixels per step; `u` runs along it.
        let turn = |v: Vec3| {
            let p = v.truncate() - origin;
            if steep { Vec3::new(p.y, p.x, v.z) } else { Vec3::new(p.x, p.y, v.z) }
        };
        let (mut a, mut b) = (turn(va), turn(vb));
        let swapped = a.x > b.x;
        if swapped {
            (a, b, wa, wb) = (b, a, wb, wa);
        }
        let d = b - a;
        let length = d.truncate().length();
        // Both ends on one pixel, or not a number.
        if d.x <= 1e-6 || !length.is_finite() {
            return;
        }
        // Broad lines are lengthened a little, or their outer bends would gape.
        let more = if wa.max(wb) > 1.5 { 0.3 * wa.max(wb) * d.x / length } else { 0.0 };
        let slope = Vec3::new(1.0, d.y / d.x, d.z / d.x);
        let cosine = d.x / length;
        let (nu, nv) = if steep { (self.height, self.width) } else { (self.width, self.height) };
        let (first, end) = (fast::ceil(a.x - more), fast::ceil(b.x + more).min(nu));
        let mut colours: Option<(Vec3, Vec3)> = None;
        let shaded = matches!(bundle.ink, Ink::Hair(..));
        for u in first..end {
            let step = u as f32 - a.x;
            let t = (step / d.x).clamp(0.0, 1.0);
            let w = (wa + (wb - wa) * t) / cosine;
            let middle = a.y + slope.y * step;
            let z = a.z + slope.z * step;
            let reach = 0.5 * (w + 1.0);
            for v in fast::ceil(middle - reach)..fast::ceil(middle + reach).min(nv) {
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
                    let [ca, cb] = [segment, segment + 1].map(|v| chunk.colour(v, || colour(bundle, chunk, v, canvas)));
                    if swapped { (cb, ca) } else { (ca, cb) }
                });
                let pixel = &mut self.pixels[i];
                // What is seen through gaps between other strands lies in their shadow, finer than any grid shows.
                let lit = if shaded { 0.45 + 0.80 * pixel.open } else { 1.0 };
                pixel.light += (ca + (cb - ca) * t) * (pixel.open * cover * lit);
                pixel.open *= 1.0 - cover;
                self.closed += usize::from(pixel.open < CLOSED);
            }
        }
    }

    /// Puts the surface of pixel `i` behind what is there.
    fn lay_surface(&mut self, i: usize, canvas: &Canvas) {
        let at = (self.y0 + i / self.edge) * canvas.layer.width + self.x0 + i % self.edge;
        let pixel = &mut self.pixels[i];
        if pixel.surface == f32::NEG_INFINITY || pixel.open < CLOSED {
            return;
        }
        let cover = canvas.layer.cover[at] * canvas.solid;
        // Skin under hair lies in the same fine shadow as the strands around it.
        let lit = 0.35 + 0.65 * pixel.open;
        pixel.light += canvas.layer.colour[at] * (pixel.open * cover * lit);
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
                    sum +=
                        if p.open < CLOSED { p.light / (1.0 - p.open) } else { p.light + canvas.background * p.open };
                }
                let mean = sum / (ss * ss) as f32;
                out.push(fast::encode(canvas.background + (mean - canvas.background) * keep));
            }
        }
        out
    }
}

fn colour(bundle: &Bundle, chunk: &Chunk, vertex: usize, canvas: &Canvas) -> Vec3 {
    let v = &chunk.vertices[vertex];
    match bundle.ink {
        Ink::Flat(colours) => colours[bundle.node(chunk.line(v), v.along())],
        Ink::Hair(coat, roots) => {
            let d = chunk.direction(vertex);
            let d = Vec3::new(d.x, -d.y, d.z * canvas.camera.scale);
            let tangent = canvas.camera.to_world(d).normalize_or_zero();
            let strand = coat.strand(roots.get(chunk.line(v)).map_or(0, |r| r.id));
            canvas.studio.hair(&coat, &strand, canvas.camera.unproject(v.at), tangent, v.along())
        }
    }
}
