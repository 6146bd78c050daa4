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
    let drawn: Result<Vec<Vec<[u8; 3]>>, Cancelled> = (0..tiles.count())
        .into_par_iter()
        .map(|tile| {
            task.check()?;
            let mut pixels = Tile::new(canvas, tiles, tile);
            pixels.lines(bundles, &chunks, canvas, tile);
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

/// Bits of a sorting key for the segment within its chunk: 256 lines of up to 4096 nodes, cut a few times. The chunk has
/// the other 20.
const SEGMENT_BITS: u32 = 24;
/// Edge in pixels of the blocks whose finished ones are known, and how many there are along a tile.
const BLOCK: usize = 8;
const BLOCKS: usize = 4;

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
    /// Per block: pixels that are not finished.
    left: [u16; BLOCKS * BLOCKS],
    /// One bit per finished block.
    finished: u16,
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
        let mut tile = Self { edge, x0, y0, width, height, pixels, closed: 0, left: [0; BLOCKS * BLOCKS], finished: 0 };
        for y in 0..height {
            for x in 0..width {
                tile.left[(y / BLOCK).min(BLOCKS - 1) * BLOCKS + (x / BLOCK).min(BLOCKS - 1)] += 1;
            }
        }
        // Blocks beyond the picture's border have nothing to finish.
        tile.finished = (0..BLOCKS * BLOCKS).filter(|&b| tile.left[b] == 0).fold(0, |bits, b| bits | 1 << b);
        tile
    }

    /// Lays all segments of the tile over each other, nearest first.
    fn lines(&mut self, bundles: &[Bundle], chunks: &[Chunk], canvas: &Canvas, tile: usize) {
        let mut order = Vec::<u64>::new();
        for (c, chunk) in chunks.iter().enumerate() {
            order.extend(
                chunk.segments(tile).iter().map(|&s| (s >> 32) << 44 | (c as u64) << SEGMENT_BITS | s & 0xffff_ffff),
            );
        }
        // Nearest first, and only as much in order as it takes: once the nearest hair has closed the tile, the rest
        // does not matter.
        let mut rest = &mut order[..];
        while !rest.is_empty() && self.closed < self.width * self.height {
            let count = (rest.len() / 6).max(1024).min(rest.len());
            if count < rest.len() {
                rest.select_nth_unstable(count);
            }
            let (near, beyond) = rest.split_at_mut(count);
            near.sort_unstable();
            for &key in near.iter() {
                let chunk = &chunks[(key >> SEGMENT_BITS) as usize & ((1 << (44 - SEGMENT_BITS)) - 1)];
                let segment = (key & ((1 << SEGMENT_BITS) - 1)) as usize;
                let ends = [&chunk.vertices[segment], &chunk.vertices[segment + 1]];
                let bundle = &bundles[chunk.bundle as usize];
                if self.is_hidden(ends[0].at, ends[1].at, bundle.width[0].max(bundle.width[1])) {
                    continue;
                }
                let width = ends.map(|v| bundle.width[0] + (bundle.width[1] - bundle.width[0]) * v.along());
                let ends = ends.map(|v| v.at);
                self.segment(&Piece { ends, width, bundle, chunk, segment }, canvas);
            }
            rest = beyond;
        }
    }

    /// True when every block of pixels that a line may touch is finished.
    fn is_hidden(&self, a: Vec3, b: Vec3, width: f32) -> bool {
        let margin = 0.5 * width + 1.5;
        let range = |a: f32, b: f32, origin: usize| {
            let block = |x: f32| (((x - origin as f32) / BLOCK as f32).max(0.0) as usize).min(BLOCKS - 1);
            block(a.min(b) - margin)..=block(a.max(b) + margin)
        };
        let (columns, mut rows) = (range(a.x, b.x, self.x0), range(a.y, b.y, self.y0));
        let across = columns.fold(0_u16, |bits, x| bits | 1 << x);
        rows.all(|y| (self.finished >> (y * BLOCKS)) & across == across)
    }

    /// Notes that pixel `i` is finished.
    fn close(&mut self, i: usize) {
        self.closed += 1;
        let block = (i / self.edge / BLOCK).min(BLOCKS - 1) * BLOCKS + (i % self.edge / BLOCK).min(BLOCKS - 1);
        self.left[block] -= 1;
        if self.left[block] == 0 {
            self.finished |= 1 << block;
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
                if pixel.open < CLOSED {
                    self.close(i);
                }
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
        if pixel.open < CLOSED && before >= CLOSED {
            self.close(i);
        }
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
