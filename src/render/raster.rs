//! Lines and surfaces into pixels: tile by tile, the nearest segment first.
//!
//! Each tile sorts its segments by depth and lays them over each other from front to back: every pixel keeps how much
//! light still passes, a strand thinner than a pixel takes only its part of that, and what can no longer be seen is
//! not drawn. Surfaces come in between as one layer with its own depth per pixel. Hair behind the depth that [`Veil`]
//! guesses is drawn in a second round, and only where the first has left something open.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::task::{Cancelled, Task};

use super::camera::Camera;
use super::fast;
use super::shade::Studio;
use super::strands::{Bundle, gather};
use super::surface::Layer;
use super::tiles::{Binned, Segment, Tiles, Vertex, behind};
use super::veil::{Holes, Sieve, Veil};

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
    let ss = canvas.supersample.max(1);
    // A whole number of pixels and of blocks.
    let tiles = Tiles::new(canvas.camera.width, canvas.camera.height, if ss == 3 { 24 } else { 32 });
    let veil = Veil::new(bundles, canvas.camera, canvas.layer, canvas.solid, ON_SURFACE, task)?;
    rounds(bundles, canvas, tiles, &veil, task)
}

/// Two rounds: in front of the veil, and behind it where it has holes.
fn rounds(bundles: &[Bundle], canvas: &Canvas, tiles: Tiles, veil: &Veil, task: &Task) -> Result<Vec<u8>, Cancelled> {
    let camera = canvas.camera;
    let front = gather(bundles, camera, tiles, Sieve { veil, holes: None }, canvas.studio, task)?;
    let touched = |chunks: &[Binned], tile: usize| chunks.iter().any(|c| !c.of(tile).is_empty());
    // Most of a picture is free of hair: a tile without any is made at the very end.
    let drawn = (0..tiles.count())
        .into_par_iter()
        .map(|tile| {
            task.check()?;
            Ok(touched(&front, tile).then(|| {
                let mut pixels = Tile::new(canvas, tiles, tile);
                pixels.lines(&front, canvas, tile);
                pixels
            }))
        })
        .collect::<Result<Vec<Option<Tile>>, Cancelled>>()?;
    let mut holes = Holes::new(camera.width, camera.height);
    drawn.iter().flatten().for_each(|tile| tile.tell(&mut holes));
    let behind = gather(bundles, camera, tiles, Sieve { veil, holes: Some(&holes) }, canvas.studio, task)?;
    let drawn = drawn
        .into_par_iter()
        .enumerate()
        .map(|(tile, pixels)| {
            task.check()?;
            let mut pixels = pixels.unwrap_or_else(|| Tile::new(canvas, tiles, tile));
            if touched(&behind, tile) {
                pixels.lines(&behind, canvas, tile);
            }
            Ok(pixels.resolve(canvas))
        })
        .collect::<Result<Vec<Vec<[u8; 3]>>, Cancelled>>()?;
    let ss = canvas.supersample.max(1);
    let (width, height, edge) = (camera.width / ss, camera.height / ss, tiles.edge / ss);
    let mut picture = vec![0; width * height * 3];
    for (tile, pixels) in drawn.iter().enumerate() {
        let (x0, y0) = (tile % tiles.columns * edge, tile / tiles.columns * edge);
        let columns = edge.min(width.saturating_sub(x0));
        for y in y0..(y0 + edge).min(height) {
            let row = &pixels[(y - y0) * edge..][..columns];
            picture[(y * width + x0) * 3..][..columns * 3].copy_from_slice(row.as_flattened());
        }
    }
    Ok(picture)
}

/// Pixels along the longest tile.
const EDGE: usize = 32;
/// Edge in pixels of the blocks whose finished ones are known, and how many there are along a tile.
const BLOCK: usize = 8;
const BLOCKS: usize = EDGE / BLOCK;

/// One tile while it is drawn.
struct Tile {
    edge: usize,
    x0: usize,
    y0: usize,
    width: usize,
    height: usize,
    /// Light gathered so far, linear; and how much of what lies behind is still seen.
    pixels: Vec<Vec4>,
    /// Depth of the surface that still has to come; negative infinity afterwards.
    surface: Vec<f32>,
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
        let mut surface = vec![f32::NEG_INFINITY; EDGE * EDGE];
        for y in 0..height {
            let from = (y0 + y) * canvas.layer.width + x0;
            surface[y * EDGE..][..width].copy_from_slice(&canvas.layer.depth[from..from + width]);
        }
        let mut left = [0; BLOCKS * BLOCKS];
        for y in 0..height {
            for x in 0..width {
                left[y / BLOCK * BLOCKS + x / BLOCK] += 1;
            }
        }
        // Blocks beyond the picture's border have nothing to finish.
        let finished = (0..BLOCKS * BLOCKS).filter(|&b| left[b] == 0).fold(0, |bits, b| bits | 1 << b);
        let pixels = vec![Vec4::W; EDGE * EDGE];
        Self { edge, x0, y0, width, height, pixels, surface, closed: 0, left, finished }
    }

    /// Tells which pixels are open.
    fn tell(&self, holes: &mut Holes) {
        for y in 0..self.height {
            for x in 0..self.width {
                if self.pixels[y * EDGE + x].w >= CLOSED {
                    holes.add(self.x0 + x, self.y0 + y);
                }
            }
        }
    }

    /// Lays all segments of the tile over each other, nearest first.
    fn lines(&mut self, chunks: &[Binned], canvas: &Canvas, tile: usize) {
        let count = chunks.iter().map(|c| c.of(tile).len()).sum();
        let mut order = Vec::<u64>::with_capacity(count);
        // Side by side, for in the order of depth they are scattered over all chunks.
        let mut pieces = Vec::<(Segment, bool)>::with_capacity(count);
        for chunk in chunks {
            for segment in chunk.of(tile) {
                order.push(u64::from(behind(segment)) << 32 | pieces.len() as u64);
                pieces.push((*segment, chunk.shaded));
            }
        }
        // Nearest first, and only as much in order as it takes: once the nearest hair has closed the tile, the rest
        // does not matter.
        let mut rest = &mut order[..];
        while !rest.is_empty() && self.closed < self.width * self.height {
            let count = (rest.len() / 3).max(2048).min(rest.len());
            if count < rest.len() {
                rest.select_nth_unstable(count);
            }
            let (near, beyond) = rest.split_at_mut(count);
            near.sort_unstable();
            for &key in near.iter() {
                let (segment, shaded) = &pieces[(key & u64::from(u32::MAX)) as usize];
                if !self.is_hidden(segment) {
                    self.segment(segment, *shaded, canvas);
                }
            }
            rest = beyond;
        }
    }

    /// True when every block of pixels that a line may touch is finished.
    fn is_hidden(&self, ends: &Segment) -> bool {
        let (a, b) = (ends[0].at, ends[1].at);
        let margin = 0.75 * ends[0].width.max(ends[1].width) + 1.0;
        let range = |a: f32, b: f32, origin: usize| {
            let block = |x: f32| ((x * (1.0 / BLOCK as f32)).max(0.0) as u32).min(BLOCKS as u32 - 1);
            (block(a.min(b) - margin - origin as f32), block(a.max(b) + margin - origin as f32))
        };
        let ((x0, x1), (y0, y1)) = (range(a.x, b.x, self.x0), range(a.y, b.y, self.y0));
        // Bits x0..=x1 of each of the rows y0..=y1.
        let across = ((2_u32 << x1) - (1 << x0)) as u16;
        let down = ((1_u32 << (4 * (y1 + 1))) - (1 << (4 * y0))) as u16;
        let touched = (across * 0x1111) & down;
        self.finished & touched == touched
    }

    /// Notes that pixel `i` is finished.
    fn close(&mut self, i: usize) {
        self.closed += 1;
        self.left[block(i)] -= 1;
        if self.left[block(i)] == 0 {
            self.finished |= 1 << block(i);
        }
    }

    /// Draws one segment: per step along its longer axis, the part of each pixel that its width covers across. Summed
    /// over the pixels of a step that is exactly the width, wherever between them the line runs.
    fn segment(&mut self, [e0, e1]: &Segment, shaded: bool, canvas: &Canvas) {
        let origin = Vec3::new(self.x0 as f32 + 0.5, self.y0 as f32 + 0.5, 0.0);
        let d = e1.at - e0.at;
        let steep = d.y.abs() > d.x.abs();
        // Along the longer axis there is one row of pixels per step; `u` runs along it.
        let turn = |v: &Vertex| {
            let p = v.at - origin;
            if steep { Vec3::new(p.y, p.x, p.z) } else { p }
        };
        let [va, vb] = if (if steep { d.y } else { d.x }) < 0.0 { [e1, e0] } else { [e0, e1] };
        let (a, b) = (turn(va), turn(vb));
        let d = b - a;
        let length = d.truncate().length();
        // Both ends on one pixel, or not a number.
        if d.x <= 1e-6 || !length.is_finite() {
            return;
        }
        let (wa, wb) = (va.width, vb.width);
        // Broad lines are lengthened a little, or their outer bends would gape.
        let more = if wa.max(wb) > 1.5 { 0.3 * wa.max(wb) * d.x / length } else { 0.0 };
        let per_step = 1.0 / d.x;
        let slope = d * per_step;
        let wider = length * per_step;
        let (nu, nv) = if steep { (self.height, self.width) } else { (self.width, self.height) };
        let (across, along) = if steep { (1, EDGE) } else { (EDGE, 1) };
        let (first, end) = (fast::ceil(a.x - more), fast::ceil(b.x + more).min(nu));
        let (ca, cb) = (va.colour().extend(0.0), vb.colour().extend(0.0));
        // What is seen through gaps between other strands lies in their shadow, finer than any grid shows.
        let (lit0, lit1) = if shaded { (0.45, 0.80) } else { (1.0, 0.0) };
        for u in first..end {
            let step = u as f32 - a.x;
            let t = (step * per_step).clamp(0.0, 1.0);
            let w = (wa + (wb - wa) * t) * wider;
            let middle = a.y + slope.y * step;
            let z = a.z + slope.z * step;
            let reach = 0.5 * (w + 1.0);
            let most = w.min(1.0);
            let colour = ca + (cb - ca) * t;
            for v in fast::ceil(middle - reach)..fast::ceil(middle + reach).min(nv) {
                let i = v * across + u * along;
                let pixel = self.pixels[i];
                if pixel.w < CLOSED {
                    continue;
                }
                if z + ON_SURFACE < self.surface[i] && self.is_behind_surface(i, canvas) {
                    continue;
                }
                let pixel = self.pixels[i];
                let cover = (reach - (v as f32 - middle).abs()).clamp(0.0, most);
                let part = pixel.w * cover;
                let mut now = pixel + colour * (part * (lit0 + lit1 * pixel.w));
                now.w = pixel.w - part;
                self.pixels[i] = now;
                if now.w < CLOSED {
                    self.close(i);
                }
            }
        }
    }

    /// True when nothing shows behind the surface of pixel `i`; otherwise the surface is put behind what is there. A
    /// whole surface waits for the end: hair in front of it may still come in the second round.
    fn is_behind_surface(&mut self, i: usize, canvas: &Canvas) -> bool {
        let at = (self.y0 + i / EDGE) * canvas.layer.width + self.x0 + i % EDGE;
        if canvas.layer.cover[at] * canvas.solid > 1.0 - CLOSED {
            return true;
        }
        self.lay_surface(i, canvas);
        self.pixels[i].w < CLOSED
    }

    /// Puts the surface of pixel `i` behind what is there.
    fn lay_surface(&mut self, i: usize, canvas: &Canvas) {
        let at = (self.y0 + i / EDGE) * canvas.layer.width + self.x0 + i % EDGE;
        let before = self.pixels[i];
        if self.surface[i] == f32::NEG_INFINITY || before.w < CLOSED {
            return;
        }
        let cover = canvas.layer.cover[at] * canvas.solid;
        // Skin under hair lies in the same fine shadow as the strands around it.
        let lit = 0.35 + 0.65 * before.w;
        let mut now = before + (canvas.layer.colour[at] * (before.w * cover * lit)).extend(0.0);
        now.w = before.w * (1.0 - cover);
        self.pixels[i] = now;
        self.surface[i] = f32::NEG_INFINITY;
        if now.w < CLOSED {
            self.close(i);
        }
    }

    /// Surfaces and background behind the lines, the mean over supersamples, sRGB.
    fn resolve(mut self, canvas: &Canvas) -> Vec<[u8; 3]> {
        for y in 0..self.height {
            for x in 0..self.width {
                self.lay_surface(y * EDGE + x, canvas);
            }
        }
        let ss = canvas.supersample.max(1);
        let edge = self.edge / ss;
        let height = canvas.camera.height as f32;
        let mut out = Vec::with_capacity(edge * edge);
        for y in 0..edge {
            let above = (height - (self.y0 + y * ss) as f32 - 0.5 * ss as f32) / height;
            let keep = if canvas.fade > 0.0 { crate::math::trig::smoothstep(0.0, canvas.fade, above) } else { 1.0 };
            for x in 0..edge {
                let mut sum = Vec3::ZERO;
                for k in 0..ss * ss {
                    let p = self.pixels[(y * ss + k / ss) * EDGE + x * ss + k % ss];
                    let light = p.truncate();
                    sum += if p.w < CLOSED { light / (1.0 - p.w) } else { light + canvas.background * p.w };
                }
                let mean = sum / (ss * ss) as f32;
                out.push(fast::encode(canvas.background + (mean - canvas.background) * keep));
            }
        }
        out
    }
}

/// The block of a tile that pixel `i` is in.
fn block(i: usize) -> usize {
    i / EDGE / BLOCK * BLOCKS + i % EDGE / BLOCK
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Colour, rng::Key};
    use crate::render::camera::axes;
    use crate::render::shade::{Coat, Skin, Sky};
    use crate::render::shadow::density;
    use crate::render::strands::Ink;
    use crate::render::surface::{self, Shell};
    use crate::scene::{HairMaterial, MeshMaterial, View};

    /// Lines that hang down from `from` to `to`, about `depth`.
    fn curtain(from: f32, to: f32, depth: f32, count: u64) -> (Vec<Vec3>, Vec<u32>) {
        let key = Key::new(9, "curtain").with((depth + 50.0) as u64);
        let strand = |i: u64| {
            let key = key.with(i);
            let (x, z) = (key.range(from, to), depth + key.with(1).range(-1.5, 1.5));
            (0..=30).map(move |k| Vec3::new(x + 0.3 * key.with(k + 2).unit(), 6.0 - 0.4 * k as f32, z))
        };
        ((0..count).flat_map(strand).collect(), (0..=count as u32).map(|i| i * 31).collect())
    }

    #[test]
    fn hair_left_out_as_hidden_is_not_missed() {
        // Two curtains with a slit between them, a surface behind the right one, and behind the left one hair of quite
        // another colour: in the dense parts, at their borders and in the slit the picture is that of all the hair.
        let mut mesh = crate::geometry::Mesh {
            positions: [(0.0, -4.0), (6.0, -4.0), (6.0, 4.0), (0.0, 4.0)].map(|(x, y)| Vec3::new(x, y, 4.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Default::default()
        };
        mesh.compute_normals();
        let task = Task::new();
        let density = density(&[], &[&mesh], &task).unwrap();
        let sky = Sky::new(&density, &task).unwrap();
        let coat = |colour: u32| {
            let colour = Colour::hex(colour);
            Coat::new(&HairMaterial { root_colour: colour, tip_colour: colour, ..HairMaterial::default() })
        };
        let lines = [curtain(-5.0, -0.2, 7.0, 4000), curtain(0.2, 5.0, 7.0, 4000), curtain(-6.0, 0.0, -7.0, 2000)];
        for (view, ss) in [(View::Front, 1), (View::ThreeQuarter, 2), (View::Back, 3)] {
            let m = axes(view);
            let camera = Camera {
                right: m.x_axis,
                up: m.y_axis,
                toward: m.z_axis,
                centre: Vec3::ZERO,
                scale: 10.0,
                width: 150,
                height: 150,
            }
            .enlarged(ss);
            let studio = Studio::new(&camera, &density, &[&mesh], &sky);
            let shell = Shell { mesh: &mesh, skin: Skin::new(&MeshMaterial::default()), tints: None };
            let layer = surface::draw(&[shell], &camera, &studio, &task).unwrap();
            let canvas = Canvas {
                camera: &camera,
                supersample: ss,
                studio: &studio,
                layer: &layer,
                solid: 1.0,
                background: Vec3::ONE,
                fade: 0.0,
            };
            let width = 0.03 * camera.scale;
            let bundles: Vec<Bundle> = lines
                .iter()
                .zip([0x6b_43_2b, 0x6b_43_2b, 0x20_ff_20])
                .map(|((points, offsets), colour)| Bundle {
                    points,
                    offsets,
                    width: [width, 0.5 * width],
                    ink: Ink::Hair(coat(colour), &[]),
                })
                .collect();
            let tiles = Tiles::new(camera.width, camera.height, if ss == 3 { 24 } else { 32 });
            let swift = draw(&bundles, &canvas, &task).unwrap();
            let slow = rounds(&bundles, &canvas, tiles, &Veil::none(&camera), &task).unwrap();
            let off: Vec<u8> = swift.iter().zip(&slow).map(|(a, b)| a.abs_diff(*b)).collect();
            let mean = off.iter().map(|&d| f64::from(d)).sum::<f64>() / off.len() as f64;
            let far = off.iter().filter(|&&d| d > 8).count() as f64 / off.len() as f64;
            assert!(mean < 0.25 && far < 2e-3, "{view:?}: {mean} off, {far} of all by more than 8");
            let veil = Veil::new(&bundles, &camera, &layer, 1.0, ON_SURFACE, &task).unwrap();
            let sieve = |veil| gather(&bundles, &camera, tiles, Sieve { veil, holes: None }, &studio, &task).unwrap();
            let count = |chunks: &[Binned]| {
                chunks.iter().map(|c| (0..tiles.count()).map(|t| c.of(t).len()).sum::<usize>()).sum::<usize>()
            };
            let (some, all) = (count(&sieve(&veil)), count(&sieve(&Veil::none(&camera))));
            assert!(some * 3 < all * 2, "{view:?}: {some} of {all} are drawn at once");
        }
    }
}
