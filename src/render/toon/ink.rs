//! Lines of ink: where they run, which are left out, and how they cover samples.

use glam::Vec2;
use rayon::prelude::*;

use super::raster::{self, NONE, Nearest, Screen};
use super::shade::{NO_TILT, Shaded, Weights};
use super::{Camera, Lock, Toon};
use crate::math::trig;
use crate::render::scan;

/// Width of a full line in pixels of a picture 640 pixels wide.
const LINE: f32 = 2.1;
/// A step in depth within one body that draws a line, cm.
const STEP: f32 = 0.45;
/// Height of a fold of the skin that draws a line, cm.
const FOLD: f32 = 0.42;
/// How much the skin must tilt in a fold that draws a line, as the kept tilts count.
const DIP: i32 = 3200;
/// Lines on skin that are shorter than this are left out, as a fraction of the picture's width.
const SHORT: f32 = 0.014;
/// Greatest slope of a surface that is told from a step: seen this squarely, as a cosine.
const STEEP: f32 = 0.12;
/// Bits of a wet sample that hold the lock.
const LOCK_BITS: u32 = 22;

/// Width of a full line in samples.
pub(super) fn pen(width: usize, per_pixel: usize) -> f32 {
    LINE * (width as f32 / 640.0).max(0.55 * per_pixel as f32)
}

/// A drop of ink: middle and radius in samples, lock, depth.
#[derive(Clone, Copy)]
pub(super) struct Drop {
    at: Vec2,
    radius: f32,
    z: f32,
    lock: u32,
    /// Within one body of skin: left out when it stands alone.
    fine: bool,
}

/// A sample on a border.
#[derive(Clone, Copy)]
struct Side {
    owner: u32,
    lock: u32,
    z: f32,
    at: Vec2,
}

/// Samples that are looked at together for any border among them.
const STRIDE: usize = 32;

/// Lines that cross the borders between a band's samples and their neighbours to the right and below. `locks` has the
/// lock of every sample.
pub(super) fn edges(toon: &Toon, screen: &Screen, nearest: &Nearest, locks: &[u32], scale: f32, pen: f32) -> Vec<Drop> {
    let mut drops = Vec::new();
    let width = screen.width;
    let tracer = Tracer { toon, screen, pen, steepest: (1.0 / (STEEP * STEEP) - 1.0).sqrt() / scale };
    let side = |i: usize| {
        let at = Vec2::new((i % width) as f32 + 0.5, (nearest.top + i / width) as f32 + 0.5);
        Side { owner: nearest.owner[i], lock: locks[i], z: nearest.depth[i], at }
    };
    // From each sample of a range to the one `step` farther.
    let mut trace = |range: std::ops::Range<usize>, step: usize| {
        let mut from = range.start;
        while from < range.end {
            let count = STRIDE.min(range.end - from);
            let (a, b) = (&locks[from..from + count], &locks[from + step..from + step + count]);
            let (p, q) = (&nearest.depth[from..from + count], &nearest.depth[from + step..from + step + count]);
            let mut any = false;
            for k in 0..count {
                any |= (a[k] != b[k]) | ((p[k] - q[k]).abs() > STEP);
            }
            if any {
                for k in 0..count {
                    if a[k] != b[k] || (p[k] - q[k]).abs() > STEP {
                        drops.extend(tracer.line(side(from + k), side(from + k + step)));
                    }
                }
            }
            from += count;
        }
    };
    for y in 0..nearest.rows {
        let row = y * width..(y + 1) * width;
        trace(row.start..row.end - 1, 1);
        if y + 1 < nearest.all {
            trace(row, width);
        }
    }
    drops
}

struct Tracer<'a> {
    toon: &'a Toon,
    screen: &'a Screen<'a>,
    pen: f32,
    /// Greatest depth per sample of a surface's own slope.
    steepest: f32,
}

impl Tracer<'_> {
    /// The line between two neighbouring samples.
    fn line(&self, a: Side, b: Side) -> Option<Drop> {
        let (front, back) = if b.owner == NONE || a.owner != NONE && a.z >= b.z { (a, b) } else { (b, a) };
        let lock = &self.toon.locks[front.lock as usize];
        let step = b.at - a.at;
        // What the surfaces' own slopes do not explain of the step.
        let gap = || front.z - back.z - 1.2 * self.slope(a, step).max(self.slope(b, step));
        let mut weight = if back.owner == NONE {
            1.0
        } else if front.lock != back.lock {
            // Locks that touch are parted by a thin line, locks that hang before others by a bold one.
            0.42 + 0.48 * trig::smoothstep(0.0, 0.8, gap())
        } else if gap() > STEP {
            0.75
        } else {
            return None;
        };
        if lock.tapers {
            let along = self.along(front);
            weight *= 1.0 - 0.72 * trig::smoothstep(0.55, 1.0, along);
            // Where a lock comes out of other hair, no line closes it off.
            if back.owner != NONE && !self.toon.locks[back.lock as usize].skin {
                weight *= trig::smoothstep(0.04, 0.30, along);
            }
        }
        let fine = lock.skin && front.lock == back.lock;
        (weight > 0.08).then_some(Drop {
            at: 0.5 * (a.at + b.at),
            radius: 0.5 * self.pen * weight,
            z: front.z,
            lock: front.lock,
            fine,
        })
    }

    fn slope(&self, side: Side, step: Vec2) -> f32 {
        if side.owner == NONE {
            return 0.0;
        }
        let [a, b, c] = raster::corners(&self.screen.points, &self.toon.triangles[side.owner as usize]);
        scan::gradient(a, b, c).map_or(0.0, |(x, y)| (x * step.x + y * step.y).abs()).min(self.steepest)
    }

    fn along(&self, side: Side) -> f32 {
        let t = self.toon.triangles[side.owner as usize];
        let vertex = |i: usize| self.toon.vertices[t[i] as usize].along;
        Weights::new(raster::corners(&self.screen.points, &t)).at(side.at, [vertex(0), vertex(1), vertex(2)])
    }
}

/// Adds lines along folds of the skin that look down: lids, lips, the wings of the nose. The surface turns down and up
/// again within [`FOLD`].
pub(super) fn folds(toon: &Toon, bands: &[Shaded], drops: &mut [Vec<Drop>], camera: &Camera, rows: usize, pen: f32) {
    let Some(lock) = toon.locks.iter().position(|l: &Lock| l.skin) else { return };
    let (width, height) = (camera.width, camera.height);
    let reach = (FOLD * camera.scale).round().max(1.0) as usize;
    let row = |y: usize| {
        let tilts = &bands[y / rows].tilts;
        (!tilts.is_empty()).then(|| &tilts[y % rows * width..(y % rows + 1) * width])
    };
    drops.par_iter_mut().enumerate().for_each(|(band, drops)| {
        for y in (band * rows).max(reach)..(band * rows + bands[band].rows).min(height.saturating_sub(reach)) {
            let lines = (row(y), row(y - 1), row(y + 1), row(y - reach), row(y + reach));
            let (Some(here), Some(up), Some(down), Some(above), Some(below)) = lines else { continue };
            for x in 0..width {
                // Only the bottom of the fold.
                let tilt = here[x];
                if tilt == NO_TILT || tilt > up[x] || tilt > down[x] || above[x] == NO_TILT || below[x] == NO_TILT {
                    continue;
                }
                let dip = i32::from(above[x].min(below[x])) - i32::from(tilt);
                if dip > DIP {
                    let weight = 1.25 * trig::smoothstep(0.02, 0.40, dip as f32 / 32000.0);
                    let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let (radius, z) = (0.5 * pen * weight, f32::NEG_INFINITY);
                    drops.push(Drop { at, radius, z, lock: lock as u32, fine: true });
                }
            }
        }
    });
}

/// Leaves out lines within the skin that are mere specks: they come from a mesh's own unevenness.
pub(super) fn tidy(toon: &Toon, drops: &mut [Vec<Drop>], width: usize) {
    if !toon.locks.iter().any(|l| l.skin) {
        return;
    }
    // Cells of a few samples; lines are connected when their cells touch.
    let cell = (width as f32 / 512.0).max(1.0);
    let place = |d: &Drop| ((d.at.y / cell) as u32, (d.at.x / cell) as u32);
    let mut cells: Vec<(u32, u32)> = drops.iter().flatten().filter(|d| d.fine).map(place).collect();
    cells.sort_unstable();
    cells.dedup();
    let mut leader: Vec<usize> = (0..cells.len()).collect();
    fn find(leader: &mut [usize], mut i: usize) -> usize {
        while leader[i] != i {
            leader[i] = leader[leader[i]];
            i = leader[i];
        }
        i
    }
    for i in 0..cells.len() {
        let (y, x) = cells[i];
        for next in [(y, x + 1), (y + 1, x.wrapping_sub(1)), (y + 1, x), (y + 1, x + 1)] {
            if let Ok(j) = cells.binary_search(&next) {
                let (a, b) = (find(&mut leader, i), find(&mut leader, j));
                leader[a.max(b)] = a.min(b);
            }
        }
    }
    let mut bounds: Vec<[u32; 4]> = cells.iter().map(|&(y, x)| [y, x, y, x]).collect();
    for (i, &(y, x)) in cells.iter().enumerate() {
        let b = &mut bounds[find(&mut leader, i)];
        *b = [b[0].min(y), b[1].min(x), b[2].max(y), b[3].max(x)];
    }
    let short = SHORT * width as f32 / cell;
    let kept: Vec<bool> = (0..cells.len())
        .map(|i| {
            let b = bounds[find(&mut leader, i)];
            (b[2] - b[0]).max(b[3] - b[1]) as f32 + 1.0 >= short
        })
        .collect();
    for drops in drops {
        drops.retain(|d| !d.fine || cells.binary_search(&place(d)).is_ok_and(|i| kept[i]));
    }
}

/// All drops of a view, by band.
pub(super) struct Ink {
    rows: usize,
    drops: Vec<Vec<Drop>>,
    /// Farthest that a drop reaches, in samples.
    reach: usize,
}

impl Ink {
    pub(super) fn new(drops: Vec<Vec<Drop>>, rows: usize) -> Self {
        let widest = drops.iter().flatten().map(|d| d.radius).fold(0.0, f32::max);
        Self { rows, drops, reach: widest as usize + 2 }
    }

    /// The ink on a band: per sample a word, see [`split`], the wettest of all drops; and the drops' depths, if wanted.
    pub(super) fn laid(&self, band: usize, width: usize, rows: usize, depths: bool) -> (Vec<u32>, Vec<f32>) {
        let mut wet = vec![0_u32; width * rows];
        let mut depth = vec![f32::NEG_INFINITY; if depths { width * rows } else { 0 }];
        let top = band * self.rows;
        let near = self.reach.div_ceil(self.rows);
        let bands = band.saturating_sub(near)..(band + near + 1).min(self.drops.len());
        for drop in self.drops[bands].iter().flatten() {
            let reach = drop.radius + 0.5;
            let (low, high) = (drop.at.y - reach - top as f32, drop.at.y + reach - top as f32);
            if high < 0.0 || low >= rows as f32 {
                continue;
            }
            let (x0, x1) = ((drop.at.x - reach).max(0.0) as usize, ((drop.at.x + reach) as usize).min(width - 1));
            let (y0, y1) = (low.max(0.0) as usize, (high as usize).min(rows - 1));
            // A line thinner than a sample covers only a part of it.
            let most = (2.0 * drop.radius).min(1.0);
            for y in y0..=y1 {
                let up = (top + y) as f32 + 0.5 - drop.at.y;
                let line = &mut wet[y * width + x0..=y * width + x1];
                let mut right = x0 as f32 - 0.5 - drop.at.x;
                for word in line.iter_mut() {
                    right += 1.0;
                    let cover = (reach - (right * right + up * up).sqrt()).clamp(0.0, most);
                    *word = (*word).max(((cover * 1023.0) as u32) << LOCK_BITS | drop.lock);
                }
                if depths {
                    for (i, z) in depth[y * width + x0..=y * width + x1].iter_mut().enumerate() {
                        let right = (x0 + i) as f32 + 0.5 - drop.at.x;
                        if right * right + up * up < reach * reach {
                            *z = z.max(drop.z);
                        }
                    }
                }
            }
        }
        (wet, depth)
    }
}

/// How much of a sample is covered, and the lock whose ink it is.
pub(super) fn split(word: u32) -> (f32, u32) {
    ((word >> LOCK_BITS) as f32 / 1023.0, word & ((1 << LOCK_BITS) - 1))
}
