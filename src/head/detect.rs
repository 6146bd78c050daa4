//! Finds landmarks from a head's shape alone.
//!
//! The head is cropped at the neck, its plane of symmetry found, and then everything is read off depth profiles taken
//! by rays: the front and the back profile in the plane of symmetry (nose, chin, occiput, nape) and a depth map from
//! each side (ears). What has no shape, the hairline, is placed by proportion (a face is three equal thirds, chin to
//! nose, nose to brow, brow to hairline; Vitruvius) and laid on the surface.

use glam::{Affine3A, Vec3};

use super::HeadError;
use super::crop::Crop;
use super::ear::Ear;
use super::landmarks::Landmarks;
use super::symmetry::Search;
use crate::geometry::{Bvh, Mesh};

/// Heights at which profiles are taken.
const ROWS: usize = 200;

/// A mesh seen in the frame of its plane of symmetry.
pub(super) struct Shape<'a> {
    pub bvh: &'a Bvh,
    /// From the frame to the mesh.
    pub frame: Affine3A,
    /// How far outside the head rays start, cm.
    pub reach: f32,
}

impl Shape<'_> {
    /// First surface on the way, in the frame.
    pub fn ray(&self, origin: Vec3, direction: Vec3, max: f32) -> Option<Vec3> {
        let hit =
            self.bvh.first_hit(self.frame.transform_point3(origin), self.frame.transform_vector3(direction), max)?;
        Some(origin + direction * hit.t)
    }

    /// The foremost (`sign` 1) or hindmost (-1) z at (x, y), seen from the reach.
    pub fn depth(&self, x: f32, y: f32, sign: f32) -> Option<f32> {
        let reach = self.reach;
        self.ray(Vec3::new(x, y, sign * reach), Vec3::new(0.0, 0.0, -sign), 2.0 * reach).map(|p| p.z)
    }

    /// The outermost x at (y, z) on the left (`sign` 1) or right (-1).
    pub fn side(&self, y: f32, z: f32, sign: f32) -> Option<f32> {
        let reach = self.reach;
        self.ray(Vec3::new(sign * reach, y, z), Vec3::new(-sign, 0.0, 0.0), reach).map(|p| p.x)
    }
}

/// A profile in the plane of symmetry: depth by height, from the bottom up.
struct Profile {
    low: f32,
    step: f32,
    /// Distance forward (front) or backward (back); where rays miss, the least that was seen.
    depth: Vec<f32>,
    /// How far the middle stands out over the places beside it.
    ridge: Vec<f32>,
}

impl Profile {
    fn take(shape: &Shape, low: f32, high: f32, sign: f32, beside: f32) -> Option<Self> {
        let step = (high - low) / ROWS as f32;
        let rows = (0..ROWS).map(|i| low + step * (i as f32 + 0.5));
        let raw: Vec<Option<f32>> = rows.clone().map(|y| shape.depth(0.0, y, sign).map(|z| z * sign)).collect();
        let least = raw.iter().flatten().copied().reduce(f32::min)?;
        let depth: Vec<f32> = raw.into_iter().map(|d| d.unwrap_or(least)).collect();
        let ridge = rows
            .zip(&depth)
            .map(|(y, d)| {
                let [l, r] = [-beside, beside].map(|x| shape.depth(x, y, sign).map_or(*d - beside, |z| z * sign));
                // The less prominent side counts: a chin seen askew is no ridge.
                d - l.max(r)
            })
            .collect();
        Some(Self { low, step, depth, ridge })
    }

    fn y(&self, i: usize) -> f32 {
        self.low + self.step * (i as f32 + 0.5)
    }

    /// Rows between two heights, at least one.
    fn rows(&self, low: f32, high: f32) -> std::ops::Range<usize> {
        let row = |y: f32| (((y - self.low) / self.step) as usize).min(ROWS - 1);
        row(low)..(row(high) + 1).max(row(low) + 1)
    }

    fn at(&self, y: f32) -> f32 {
        self.depth[self.rows(y, y).start]
    }

    /// The row where `score` is greatest.
    fn best(&self, rows: std::ops::Range<usize>, score: impl Fn(usize) -> f32) -> usize {
        rows.clone().max_by(|&a, &b| score(a).total_cmp(&score(b))).unwrap_or(rows.start)
    }

    /// How far row `i` stands out over the deepest places within `window` above and below.
    fn prominence(&self, i: usize, window: f32) -> f32 {
        let n = (window / self.step) as usize;
        let least = |r: &[f32]| r.iter().copied().fold(f32::INFINITY, f32::min);
        let below = least(&self.depth[i.saturating_sub(n)..=i]);
        let above = least(&self.depth[i..(i + n + 1).min(ROWS)]);
        self.depth[i] - below.max(above)
    }

    /// (row of the nose's tip, how sure): a nose stands out both over what is above and below and over its sides.
    fn nose(&self, low: f32, high: f32, size: f32) -> (usize, f32) {
        let score = |i: usize| self.prominence(i, 0.16 * size).min(self.ridge[i].max(0.0));
        let i = self.best(self.rows(low, high), |i| score(i) + 0.25 * self.depth[i] / size);
        (i, score(i))
    }
}

/// Reads the landmarks of an upright head that looks to +Z, give or take 45 degrees, in the mesh's own space.
pub(super) fn detect(mesh: &Mesh, bvh: &Bvh) -> Result<Landmarks, HeadError> {
    let crop = Crop::find(mesh).ok_or(HeadError::NoHead)?;
    let search = Search::new(mesh, bvh, &crop).ok_or(HeadError::NoHead)?;
    let plane = search.best();
    let size = crop.height();
    let shape = Shape { bvh, frame: search.frame(&plane), reach: 0.75 * crop.bounds.size().length() };

    let (low, high) = (crop.neck - 0.05 * size, crop.bounds.max.y);
    let (low, high) = (low - crop.middle.y, high - crop.middle.y);
    let neck = crop.neck - crop.middle.y;
    let no_profile = HeadError::NoHead;
    let front = Profile::take(&shape, low, high, 1.0, 0.08 * size).ok_or(no_profile.clone())?;
    let back = Profile::take(&shape, low, high, -1.0, 0.08 * size).ok_or(no_profile)?;

    let range = (neck + 0.12 * size, neck + 0.72 * size);
    let (nose, sure) = front.nose(range.0, range.1, size);
    let (_, behind) = back.nose(range.0, range.1, size);
    let has_nose = sure > 0.008 * size;
    if behind > 0.025 * size && behind > 2.0 * sure {
        return Err(HeadError::Backwards);
    }
    // Seen from the side an ear may pass for a nose; but then there is one on the other side too.
    let is_clear = sure > 0.03 * size && behind < 0.5 * sure;
    if !is_clear && plane.residual > 4.0 * search.across().residual + (0.01 * size) * (0.01 * size) {
        return Err(HeadError::Sideways);
    }

    let top = if has_nose { front.y(nose) - 0.10 * size } else { neck + 0.45 * size };
    let chin = chin(&front, neck, top);
    let vertex = vertex(&shape, high, size);
    let height = vertex.y - chin.y;
    if !(height > 0.3 * size && chin.is_finite() && vertex.is_finite()) {
        return Err(HeadError::NoHead);
    }
    // A head without a nose has it where a third of the face ends.
    let nose_y = if has_nose { front.y(nose) } else { chin.y + 0.31 * height };

    let hind = back.rows(chin.y + 0.4 * height, chin.y + 0.85 * height);
    let occiput = back.best(hind, |i| back.depth[i]);
    let occiput = Vec3::new(0.0, back.y(occiput), -back.depth[occiput]);
    let forehead_y = chin.y + 0.82 * height;
    let forehead = Vec3::new(0.0, forehead_y, front.at(forehead_y));
    let ear_y = nose_y + 0.08 * height;
    let ear_z = (occiput.z + front.at(nose_y + 0.2 * height)) * 0.5 - 0.03 * height;
    // The neck's deepest hollow within the heights where hairlines end, behind the ears; a head without a neck has it
    // where it turns under.
    let is_behind = |i: &usize| -back.depth[*i] < ear_z;
    let under = |i: usize| back.depth[i] - back.y(i);
    let usual = chin.y + 0.08 * height;
    let hollow = |i: usize| back.depth[i] + 0.1 * (back.y(i) - usual).abs();
    let nape = back
        .rows(chin.y - 0.02 * height, chin.y + 0.16 * height)
        .filter(is_behind)
        .min_by(|&a, &b| hollow(a).total_cmp(&hollow(b)))
        .or_else(|| (0..ROWS).filter(is_behind).max_by(|&a, &b| under(a).total_cmp(&under(b))))
        .ok_or(HeadError::NoHead)?;
    let nape = Vec3::new(0.0, back.y(nape), -back.depth[nape]);

    let ears = [1.0, -1.0].map(|sign| Ear::measure(&shape, Vec3::new(0.0, ear_y, ear_z), height, sign));
    let [left_ear, right_ear] = Ear::pair(&shape, ears, Vec3::new(0.0, ear_y, ear_z), height)?;

    let temple = |sign: f32, ear: Vec3| {
        let (y, z) = (chin.y + 0.66 * height, ear.z + 0.60 * (forehead.z - ear.z));
        let x = shape.side(y, z, sign).unwrap_or(sign * 0.3 * height);
        Vec3::new(x, y, z)
    };
    let landmarks = Landmarks {
        vertex,
        forehead,
        left_temple: temple(1.0, left_ear),
        right_temple: temple(-1.0, right_ear),
        left_ear,
        right_ear,
        occiput,
        nape,
        chin,
    };
    Ok(landmarks.transformed(&shape.frame))
}

/// Where the front profile turns under: the extreme place at 45 degrees forward and down, on the foremost half of
/// what stands over the throat.
fn chin(front: &Profile, neck: f32, top: f32) -> Vec3 {
    let rows = front.rows(neck, top);
    let forward = front.best(rows.clone(), |i| 0.87 * front.depth[i] - 0.5 * front.y(i));
    let throat = front.at(neck);
    let half = throat + 0.5 * (front.depth[forward] - throat);
    let under =
        front.best(rows, |i| if front.depth[i] < half { f32::NEG_INFINITY } else { front.depth[i] - front.y(i) });
    Vec3::new(0.0, front.y(under), front.depth[under])
}

/// The highest place in the plane of symmetry.
fn vertex(shape: &Shape, high: f32, size: f32) -> Vec3 {
    let z = (0..=64).map(|i| (i as f32 / 32.0 - 1.0) * 0.45 * size);
    z.filter_map(|z| shape.ray(Vec3::new(0.0, high + size, z), Vec3::NEG_Y, 2.0 * size))
        .reduce(|a, b| if b.y > a.y { b } else { a })
        .unwrap_or(Vec3::new(0.0, high, 0.0))
}
