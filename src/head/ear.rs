//! Ears: what stands out from the side of a head.

use glam::Vec3;

use super::HeadError;
use super::detect::Shape;

/// Rays per direction over the window that is searched.
const GRID: usize = 32;

/// The outline of an ear, in the frame it was measured in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ear {
    /// 1 for the left ear, -1 for the right one.
    pub sign: f32,
    /// Height of its lower end, cm.
    pub bottom: f32,
    /// Height of its upper end.
    pub top: f32,
    /// z of its hind end.
    pub back: f32,
    /// z of its front end.
    pub front: f32,
    /// The head's side without the ear: |x| = c0 + c1 v + c2 w + c3 v^2 + c4 v w + c5 w^2 with
    /// (v, w) = ((y, z) - centre) / window.
    skull: [f32; 6],
    centre: [f32; 2],
    window: f32,
}

impl Ear {
    /// Looks for an ear on one side, near `near`; `height` is the head's from chin to vertex. `None`: nothing stands
    /// out there.
    pub(super) fn measure(shape: &Shape, near: Vec3, height: f32, sign: f32) -> Option<Self> {
        let window = 0.26 * height;
        let place = |i: usize| (i as f32 + 0.5) / GRID as f32 * 2.0 - 1.0;
        let mut map = vec![None; GRID * GRID];
        for (k, cell) in map.iter_mut().enumerate() {
            let (v, w) = (place(k / GRID), place(k % GRID));
            *cell = shape.side(near.y + v * window, near.z + w * window, sign).map(|x| x * sign);
        }
        // The skull below the ear: a quadratic through what does not stand out of it.
        let mut skull = [0.0; 6];
        let mut limit = f32::INFINITY;
        for round in 0..8 {
            let kept = map.iter().enumerate().filter_map(|(k, x)| {
                let (v, w) = (place(k / GRID), place(k % GRID));
                x.filter(|x| (x - surface(&skull, v, w)).abs() < limit || round == 0).map(|x| (v, w, x))
            });
            skull = fit(kept)?;
            limit = height * [0.06, 0.05, 0.04, 0.03, 0.025, 0.02, 0.02, 0.02][round];
        }
        let stands_out = |k: usize| {
            let (v, w) = (place(k / GRID), place(k % GRID));
            map[k].is_some_and(|x: f32| x - surface(&skull, v, w) > 0.022 * height)
        };
        // The largest connected piece whose middle is well inside the window.
        let mut seen = vec![false; GRID * GRID];
        let mut best: Option<(usize, [usize; 4])> = None;
        for start in 0..GRID * GRID {
            if seen[start] || !stands_out(start) {
                continue;
            }
            let (mut stack, mut count, mut extent) = (vec![start], 0, [GRID, 0, GRID, 0]);
            seen[start] = true;
            while let Some(k) = stack.pop() {
                let (r, c) = (k / GRID, k % GRID);
                count += 1;
                extent = [extent[0].min(r), extent[1].max(r), extent[2].min(c), extent[3].max(c)];
                let around = [
                    (r > 0, k.wrapping_sub(GRID)),
                    (r + 1 < GRID, k + GRID),
                    (c > 0, k.wrapping_sub(1)),
                    (c + 1 < GRID, k + 1),
                ];
                for (_, n) in around.into_iter().filter(|a| a.0) {
                    if !seen[n] && stands_out(n) {
                        seen[n] = true;
                        stack.push(n);
                    }
                }
            }
            let middle = [(extent[0] + extent[1]) / 2, (extent[2] + extent[3]) / 2];
            let central = middle.iter().all(|m| (GRID / 6..GRID - GRID / 6).contains(m));
            if central && count > GRID * GRID / 100 && best.is_none_or(|b| count > b.0) {
                best = Some((count, extent));
            }
        }
        let (_, [bottom, top, back, front]) = best?;
        let edge = |i: usize| i as f32 / GRID as f32 * 2.0 - 1.0;
        Some(Self {
            sign,
            bottom: near.y + edge(bottom) * window,
            top: near.y + edge(top + 1) * window,
            back: near.z + edge(back) * window,
            front: near.z + edge(front + 1) * window,
            skull,
            centre: [near.y, near.z],
            window,
        })
    }

    /// How far a point stands out of the skull's side, cm; `None` outside the ear's outline and a margin around it.
    pub fn stands_out(&self, p: Vec3, margin: f32) -> Option<f32> {
        let inside = p.x * self.sign > 0.0
            && (self.bottom - margin..self.top + margin).contains(&p.y)
            && (self.back - margin..self.front + margin).contains(&p.z);
        let (v, w) = ((p.y - self.centre[0]) / self.window, (p.z - self.centre[1]) / self.window);
        inside.then(|| p.x * self.sign - surface(&self.skull, v, w))
    }

    /// Both ear landmarks on the surface; a missing ear is where the other one's mirror image is, two missing ones
    /// are where ears usually are.
    pub(super) fn pair(
        shape: &Shape,
        ears: [Option<Self>; 2],
        near: Vec3,
        height: f32,
    ) -> Result<[Vec3; 2], HeadError> {
        let place = |ear: &Self| {
            let z = ear.front - 0.3 * (ear.front - ear.back);
            [(ear.bottom + ear.top) * 0.5, z]
        };
        let [left, right] = ears.map(|e| e.as_ref().map(place));
        let other = left.or(right).unwrap_or([near.y, near.z]);
        let at = |found: Option<[f32; 2]>, sign: f32| {
            let [y, z] = found.unwrap_or(other);
            // A ray may slip through an open mesh's gap: a little lower or higher there is a surface.
            [0.0, -0.03, 0.03, -0.08, 0.08]
                .iter()
                .find_map(|d| shape.side(y + d * height, z, sign).map(|x| Vec3::new(x, y + d * height, z)))
                .filter(|p| p.x * sign > 0.02 * height)
                .ok_or(HeadError::NoSide { side: if sign > 0.0 { "left" } else { "right" } })
        };
        Ok([at(left, 1.0)?, at(right, -1.0)?])
    }
}

fn surface(c: &[f32; 6], v: f32, w: f32) -> f32 {
    c[0] + c[1] * v + c[2] * w + c[3] * v * v + c[4] * v * w + c[5] * w * w
}

/// Least squares by the normal equations, solved by Gauss with pivots; `None` when too few places define it.
fn fit(places: impl Iterator<Item = (f32, f32, f32)>) -> Option<[f32; 6]> {
    let mut m = [[0.0_f64; 7]; 6];
    let mut count = 0;
    for (v, w, x) in places {
        let (v, w, x) = (f64::from(v), f64::from(w), f64::from(x));
        let row = [1.0, v, w, v * v, v * w, w * w, x];
        for i in 0..6 {
            for j in 0..7 {
                m[i][j] += row[i] * row[j];
            }
        }
        count += 1;
    }
    if count < 60 {
        return None;
    }
    for i in 0..6 {
        let pivot = (i..6).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        if m[i][i].abs() < 1e-9 {
            return None;
        }
        for r in 0..6 {
            if r != i {
                let f = m[r][i] / m[i][i];
                let row = m[i];
                for (a, b) in m[r].iter_mut().zip(row).skip(i) {
                    *a -= f * b;
                }
            }
        }
    }
    Some(std::array::from_fn(|i| (m[i][6] / m[i][i]) as f32))
}
