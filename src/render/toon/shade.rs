//! Flat tones for the samples of a band.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::raster::{self, NONE, Nearest, Screen};
use super::{Camera, LAMP, Lock, Tones, Toon};
use crate::render::depths::Depths;
use crate::render::scan;
use crate::task::{Cancelled, Task};

/// Cosine to the lamp below which the third tone begins.
const DEEP: f32 = 0.42;
/// Tilts are kept in steps of this.
const TILT: f32 = 1.0 / 32000.0;
/// No skin.
pub(super) const NO_TILT: i16 = i16::MIN;
/// Edges of skin longer than this many cm are shaded sample by sample.
const COARSE: f32 = 0.8;

/// What the lamp does to a vertex, as one view sees it.
#[derive(Clone, Copy, Default)]
struct Lit {
    /// Cosine to the lamp, counted from the border of the shade.
    lamp: f32,
    /// Free of shadow: above 0.
    free: f32,
    /// Cosine of the lock's direction to the half vector, counted from the middle of the band of light.
    off: f32,
    /// How squarely the surface faces the half vector, counted from where the band ends.
    facing: f32,
    /// How much the surface faces up in the picture.
    tilt: f32,
    /// Place along the lock.
    along: f32,
    /// From the middle of the lock's side that is seen (0) to its edges (1).
    across: f32,
}

/// The lamp of one view.
pub(super) struct Light {
    shadow: Depths,
    lit: Vec<Lit>,
}

impl Light {
    pub(super) fn new(toon: &Toon, camera: &Camera, task: &Task) -> Result<Self, Cancelled> {
        let lamp = camera.to_world(LAMP.normalize());
        let half = (lamp + camera.toward).normalize_or(lamp);
        let shadow = shadow(toon, lamp);
        task.check()?;
        // The figure of a vertex decides how it is lit.
        let mut skin = vec![false; toon.vertices.len()];
        for (t, &lock) in toon.triangles.iter().zip(&toon.lock_of) {
            if toon.locks[lock as usize].skin {
                t.iter().for_each(|&v| skin[v as usize] = true);
            }
        }
        let lit = toon
            .vertices
            .par_iter()
            .zip(&skin)
            .with_min_len(1 << 10)
            .map(|(v, &skin)| {
                let out = (v.position - toon.centre).normalize_or(v.normal);
                let tilt = v.normal.dot(camera.up);
                let (along, across) = (v.along, v.across);
                if skin {
                    // Features are drawn by lines; the lamp sees the head's large form.
                    let n = (v.normal * 0.55 + out * 0.45).normalize_or(v.normal);
                    let cosine = n.dot(lamp) + 0.06;
                    // What faces away far enough is dark in any case, or not seen.
                    let near = cosine > -0.3 && v.normal.dot(camera.toward) > -0.5;
                    let free = if near { shadow.sample(v.position + v.normal * 0.25 + lamp * 0.15) - 0.5 } else { 0.5 };
                    Lit { lamp: cosine, free, off: 0.0, facing: -1.0, tilt, along, across }
                } else {
                    // Locks that lie on the head share its light; what each of them adds keeps them apart.
                    let n = (v.normal * 0.68 + out * 0.32).normalize_or(v.normal);
                    let facing = n.dot(half) - 0.80;
                    let off = v.grain.dot(half) - 0.10;
                    Lit { lamp: n.dot(lamp) - 0.02, free: 1.0, off, facing, tilt, along, across }
                }
            })
            .collect();
        Ok(Self { shadow, lit })
    }
}

/// A band of samples with their colours.
pub(super) struct Shaded {
    pub(super) rows: usize,
    /// Colours, see [`pack`].
    pub(super) samples: Vec<u32>,
    /// Depths, when they are wanted.
    pub(super) depths: Vec<f32>,
    /// How much skin faces up, in 32,000ths; [`NO_TILT`] where there is none. Empty for a band without skin.
    pub(super) tilts: Vec<i16>,
    /// Per sample its lock, with the row that follows; [`NONE`] where there is nothing.
    pub(super) locks: Vec<u32>,
}

/// Nothing there.
const EMPTY: u32 = 0;
/// The bit of a sample that is covered.
const COVERED: u32 = 1 << 30;

/// A covered sample: ten bits for the square root of each part of a linear colour.
#[inline]
pub(super) fn pack(colour: Vec3) -> u32 {
    let part = |c: f32| (c.clamp(0.0, 1.0).sqrt() * 1023.0 + 0.5) as u32;
    COVERED | part(colour.x) << 20 | part(colour.y) << 10 | part(colour.z)
}

/// The linear colour of a sample and 1, or black and 0 where there is nothing.
#[inline]
pub(super) fn unpack(sample: u32) -> (Vec3, f32) {
    let part = |shift: u32| {
        let root = ((sample >> shift) & 1023) as f32 * (1.0 / 1023.0);
        root * root
    };
    (Vec3::new(part(20), part(10), part(0)), f32::from(sample != EMPTY))
}

/// A number that is linear over a triangle: at a place, and its growth to the right and downward.
#[derive(Clone, Copy)]
struct Linear {
    at: f32,
    right: f32,
    down: f32,
}

impl Linear {
    /// 0 to 1 across the place where the number crosses `level`, one sample wide.
    #[inline]
    fn step(&self, value: f32, level: f32) -> f32 {
        (0.5 + (value - level) / (self.right.abs() + self.down.abs()).max(1e-5)).clamp(0.0, 1.0)
    }
}

/// Barycentric weights over a triangle in the picture.
pub(super) struct Weights {
    origin: Vec2,
    right: [f32; 2],
    down: [f32; 2],
}

impl Weights {
    #[inline]
    pub(super) fn new([a, b, c]: [Vec3; 3]) -> Self {
        let share = 1.0 / scan::area(a, b, c);
        let (p, q) = (b - a, c - a);
        Self { origin: a.truncate(), right: [q.y * share, -p.y * share], down: [-q.x * share, p.x * share] }
    }

    #[inline]
    fn linear(&self, at: Vec2, v: [f32; 3]) -> Linear {
        let (b, c) = (v[1] - v[0], v[2] - v[0]);
        let (right, down) = (b * self.right[0] + c * self.right[1], b * self.down[0] + c * self.down[1]);
        let off = at - self.origin;
        Linear { at: v[0] + right * off.x + down * off.y, right, down }
    }

    /// The number at a place.
    pub(super) fn at(&self, at: Vec2, v: [f32; 3]) -> f32 {
        let (lo, hi) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
        self.linear(at, v).at.clamp(lo, hi)
    }
}

/// How a triangle is shaded.
#[derive(Clone, Copy)]
struct Setup {
    owner: u32,
    lock: u32,
    /// The colour of all its samples; [`EMPTY`] when they differ.
    flat: u32,
    skin: bool,
    /// Tilt at the origin of the picture, and its growth.
    tilt: Linear,
}

/// Triangles whose setup is kept: neighbouring rows show the same ones.
const KEPT: usize = 1024;

/// Colours of a lock where nothing changes: in the light, in the shade, in the depth.
type Words = [u32; 3];

/// The colours of all locks.
pub(super) fn words(toon: &Toon) -> Vec<Words> {
    let word = |tones: &Tones, lit, raised| pack(tones.at(0.0, lit, raised, 0.0));
    toon.locks.iter().map(|l| [word(&l.tones, 1.0, 1.0), word(&l.tones, 0.0, 1.0), word(&l.tones, 0.0, 0.0)]).collect()
}

/// The tones of a band.
pub(super) fn band(
    toon: &Toon,
    screen: &Screen,
    nearest: &Nearest,
    light: &Light,
    words: &[Words],
    depths: bool,
) -> Shaded {
    let (width, rows) = (screen.width, nearest.rows);
    let mut shaded = Shaded {
        rows,
        samples: vec![EMPTY; width * rows],
        depths: if depths { nearest.depth[..width * rows].to_vec() } else { vec![] },
        tilts: vec![],
        locks: vec![NONE; width * nearest.all],
    };
    let none = Linear { at: 0.0, right: 0.0, down: 0.0 };
    let mut kept = vec![Setup { owner: NONE, lock: 0, flat: EMPTY, skin: false, tilt: none }; KEPT];
    for y in 0..nearest.all {
        let owners = &nearest.owner[y * width..(y + 1) * width];
        let mut x = 0;
        while x < width {
            let owner = owners[x];
            let mut end = x + 1;
            while end < width && owners[end] == owner {
                end += 1;
            }
            if owner != NONE {
                let slot = &mut kept[owner as usize % KEPT];
                if slot.owner != owner {
                    *slot = setup(toon, screen, light, words, owner);
                }
                let range = y * width + x..y * width + end;
                shaded.locks[range.clone()].fill(slot.lock);
                if y < rows {
                    let run = Run { toon, screen, light, owner, x, y: nearest.top + y };
                    let lock = &toon.locks[slot.lock as usize];
                    let out = &mut shaded.samples[range.clone()];
                    match (slot.flat, slot.skin) {
                        (EMPTY, true) => run.skin(lock, out),
                        (EMPTY, false) => run.hair(lock, out),
                        (flat, _) => out.fill(flat),
                    }
                    if slot.skin {
                        if shaded.tilts.is_empty() {
                            shaded.tilts = vec![NO_TILT; width * rows];
                        }
                        let tilt = &slot.tilt;
                        let first = tilt.at + tilt.down * (nearest.top + y) as f32;
                        for (k, turned) in (x..end).zip(&mut shaded.tilts[range]) {
                            *turned = ((first + tilt.right * k as f32) / TILT).clamp(-32000.0, 32000.0) as i16;
                        }
                    }
                }
            }
            x = end;
        }
    }
    shaded
}

/// A triangle whose corners all lie on one side of every border, by a margin, has one colour.
fn setup(toon: &Toon, screen: &Screen, light: &Light, words: &[Words], owner: u32) -> Setup {
    const MARGIN: f32 = 0.02;
    let t = toon.triangles[owner as usize];
    let index = toon.lock_of[owner as usize];
    let lock = &toon.locks[index as usize];
    let tones = &lock.tones;
    let lit = |i: usize| &light.lit[t[i] as usize];
    let (a, b, c) = (lit(0), lit(1), lit(2));
    let low = |x: f32, y: f32, z: f32| x.min(y).min(z);
    let high = |x: f32, y: f32, z: f32| x.max(y).max(z);
    let (dark, bright) = (high(a.lamp, b.lamp, c.lamp), low(a.lamp, b.lamp, c.lamp));
    let words = &words[index as usize];
    let mut tilt = Linear { at: 0.0, right: 0.0, down: 0.0 };
    let flat = if lock.skin {
        let corners = raster::corners(&screen.points, &t);
        let w = Weights::new(corners);
        tilt = w.linear(Vec2::splat(0.5), [a.tilt, b.tilt, c.tilt]);
        let free = low(a.free, b.free, c.free) > 2.0 * MARGIN;
        let p = |i: usize| toon.vertices[t[i] as usize].position;
        let coarse = high(p(0).distance_squared(p(1)), p(1).distance_squared(p(2)), p(2).distance_squared(p(0)))
            > COARSE * COARSE;
        let back = scan::area(corners[0], corners[1], corners[2]) > 0.0;
        if back || dark < -MARGIN || high(a.free, b.free, c.free) < -2.0 * MARGIN && !coarse {
            words[1]
        } else if bright > MARGIN && free && !coarse {
            words[0]
        } else {
            EMPTY
        }
    } else if tones.lit[0] != tones.lit[1] {
        EMPTY
    } else if dark < -MARGIN {
        match tones.deep {
            true if dark < -DEEP - MARGIN => words[2],
            true if bright < -DEEP + MARGIN => EMPTY,
            _ => words[1],
        }
    } else if bright > MARGIN {
        let reach = 0.55 * tones.band + MARGIN;
        let dull = tones.band == 0.0
            || high(a.facing, b.facing, c.facing) < -0.25 * tones.band - MARGIN
            || low(a.off, b.off, c.off) > reach
            || high(a.off, b.off, c.off) < -reach;
        if dull { words[0] } else { EMPTY }
    } else {
        EMPTY
    };
    Setup { owner, lock: index, flat, skin: lock.skin, tilt }
}

/// Neighbouring samples of one triangle.
struct Run<'a> {
    toon: &'a Toon,
    screen: &'a Screen<'a>,
    light: &'a Light,
    owner: u32,
    x: usize,
    y: usize,
}

impl Run<'_> {
    fn weights(&self) -> ([u32; 3], Vec2, Weights) {
        let t = self.toon.triangles[self.owner as usize];
        let at = Vec2::new(self.x as f32 + 0.5, self.y as f32 + 0.5);
        (t, at, Weights::new(raster::corners(&self.screen.points, &t)))
    }

    fn numbers(&self, t: [u32; 3], of: impl Fn(&Lit) -> f32) -> [f32; 3] {
        let lit = &self.light.lit;
        [of(&lit[t[0] as usize]), of(&lit[t[1] as usize]), of(&lit[t[2] as usize])]
    }

    fn hair(&self, lock: &Lock, out: &mut [u32]) {
        let (t, at, w) = self.weights();
        let tones = &lock.tones;
        let lamp = w.linear(at, self.numbers(t, |l| l.lamp));
        let along = w.linear(at, self.numbers(t, |l| l.along));
        let band = (tones.band > 0.0).then(|| {
            let off = w.linear(at, self.numbers(t, |l| l.off));
            let facing = w.linear(at, self.numbers(t, |l| l.facing));
            let across = w.linear(at, self.numbers(t, |l| l.across));
            (off, facing, across)
        });
        let graded = tones.lit[0] != tones.lit[1];
        // Flat tones repeat: most samples are as the one before.
        let (mut before, mut word) = ((f32::NAN, 0.0, 0.0), EMPTY);
        for (k, sample) in out.iter_mut().enumerate() {
            let k = k as f32;
            let value = lamp.at + lamp.right * k;
            let lit = lamp.step(value, 0.0);
            let raised = if tones.deep { lamp.step(value, -DEEP) } else { 1.0 };
            let bright = match &band {
                Some((off, facing, across)) if lit > 0.0 => {
                    let place = along.at + along.right * k;
                    let half = half_band(tones, place, across.at + across.right * k);
                    let miss = off.step(half - (off.at + off.right * k).abs(), 0.0);
                    let seen = facing.step(facing.at + facing.right * k, -0.25 * tones.band);
                    miss.min(seen).min(lit)
                }
                _ => 0.0,
            };
            if graded || lit != before.0 || raised != before.1 || bright != before.2 {
                word = pack(tones.at(along.at + along.right * k, lit, raised, bright));
                before = (lit, raised, bright);
            }
            *sample = word;
        }
    }

    fn skin(&self, lock: &Lock, out: &mut [u32]) {
        let (t, at, w) = self.weights();
        let tones = &lock.tones;
        let lamp = w.linear(at, self.numbers(t, |l| l.lamp));
        let free = w.linear(at, self.numbers(t, |l| l.free));
        let vertex = |i: usize| &self.toon.vertices[t[i] as usize];
        let p = [vertex(0).position, vertex(1).position, vertex(2).position];
        let far = p[0].distance_squared(p[1]).max(p[1].distance_squared(p[2])).max(p[2].distance_squared(p[0]));
        let of = |k: usize| w.linear(at, [p[0][k], p[1][k], p[2][k]]);
        let coarse = (far > COARSE * COARSE).then(|| (of(0), of(1), of(2)));
        let (mut before, mut word) = (f32::NAN, EMPTY);
        for (k, sample) in out.iter_mut().enumerate() {
            let k = k as f32;
            let mut lit = lamp.step(lamp.at + lamp.right * k, 0.0);
            match &coarse {
                Some((x, y, z)) if lit > 0.0 => {
                    let place = Vec3::new(x.at + x.right * k, y.at + y.right * k, z.at + z.right * k);
                    let lamp = self.light.shadow.lamp();
                    let free = self.light.shadow.sample(place + vertex(0).normal * 0.25 + lamp * 0.15);
                    lit = lit.min((0.5 + 4.0 * (free - 0.5)).clamp(0.0, 1.0));
                }
                Some(_) => {}
                None => lit = lit.min(free.step(free.at + free.right * k, 0.0)),
            }
            if lit != before {
                word = pack(tones.at(0.0, lit, 1.0, 0.0));
                before = lit;
            }
            *sample = word;
        }
    }
}

/// Half the width of the band of light as a cosine: narrower towards the lock's edges, none at root and tip.
#[inline]
fn half_band(tones: &Tones, along: f32, across: f32) -> f32 {
    let round = 1.0 - 0.62 * across * across;
    let ends = (12.0 * along - 0.6).min(6.0 * (0.94 - along)).clamp(0.0, 1.0);
    tones.band * 0.55 * round * ends - 0.02 * (1.0 - ends)
}

/// The surfaces as the lamp sees them.
fn shadow(toon: &Toon, lamp: Vec3) -> Depths {
    const MAP: usize = Depths::CELLS;
    Depths::drawn(toon.vertices.iter().map(|v| v.position), lamp, |cell| {
        // Downward, so that what faces the lamp has the sign of what faces a viewer.
        let project = |p: Vec3| {
            let q = cell(p);
            Vec3::new(q.x, MAP as f32 - q.y, q.z)
        };
        let screen = Screen::new(toon, MAP, MAP, MAP / 8, project);
        let bands: Vec<Vec<f32>> =
            (0..screen.bands()).into_par_iter().map(|band| screen.nearest(band, 0).depth).collect();
        bands.concat().chunks_exact(MAP).rev().flatten().copied().collect()
    })
}
