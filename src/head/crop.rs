//! Where a mesh has its head: horizontal slices from the top down to the neck.

use glam::Vec3;

use crate::geometry::{Bounds, Mesh};

/// Slices over the mesh's whole height; on a standing body one is 0.7 cm high.
const SLICES: usize = 256;

/// The part of a mesh that is a head.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crop {
    /// Height of the narrowest place of the neck, or the lower end of a head without one.
    pub neck: f32,
    /// Bounds of the head from the neck up.
    pub bounds: Bounds,
    /// Middle of the slice with the greatest extent.
    pub middle: Vec3,
}

/// One horizontal slice: what of it belongs to the head's column.
#[derive(Clone, Copy, Debug)]
struct Slice {
    y: f32,
    /// (x, z) of the least and of the greatest corner.
    lo: [f32; 2],
    hi: [f32; 2],
}

impl Slice {
    fn area(&self) -> f32 {
        (self.hi[0] - self.lo[0]) * (self.hi[1] - self.lo[1])
    }
}

impl Crop {
    /// Scans the mesh from its highest point down. `None` when there is nothing with an extent.
    pub fn find(mesh: &Mesh) -> Option<Self> {
        let slices = slices(mesh);
        let (mut widest, mut narrowest) = (0, 0);
        for (k, slice) in slices.iter().enumerate() {
            let area = slice.area();
            if area > slices[widest].area() {
                (widest, narrowest) = (k, k);
            }
            if area < slices[narrowest].area() {
                narrowest = k;
            }
            // A neck is clearly narrower than what is above it, and clearly narrower than what is below.
            let above = slices[0].y - slices[narrowest].y;
            let broad = slices[widest].hi[0] - slices[widest].lo[0];
            let is_neck = slices[narrowest].area() < 0.72 * slices[widest].area() && above > 0.5 * broad;
            if is_neck && area > 1.25 * slices[narrowest].area() {
                break;
            }
        }
        let widest = *slices.get(widest)?;
        if widest.area() <= 0.0 {
            return None;
        }
        // A neck like a cylinder begins where it is first that narrow.
        let least = slices[narrowest].area();
        while narrowest > 0 && slices[narrowest - 1].area() <= 1.12 * least {
            narrowest -= 1;
        }
        let neck = slices[narrowest].y;
        let mut bounds = Bounds::EMPTY;
        for s in slices.iter().take_while(|s| s.y >= neck) {
            let corners = [Vec3::new(s.lo[0], s.y, s.lo[1]), Vec3::new(s.hi[0], s.y, s.hi[1])];
            bounds = bounds.union(Bounds::of(corners));
        }
        bounds.max.y = mesh.bounds().max.y;
        let middle = Vec3::new((widest.lo[0] + widest.hi[0]) * 0.5, widest.y, (widest.lo[1] + widest.hi[1]) * 0.5);
        Some(Self { neck, bounds, middle })
    }

    /// Height from the neck to the top, cm.
    pub fn height(&self) -> f32 {
        self.bounds.max.y - self.neck
    }

    /// Triangles that lie wholly or partly in the head, down to `below` under the neck.
    pub fn triangles(&self, mesh: &Mesh, below: f32) -> Vec<u32> {
        let margin = self.height() * 0.15;
        let mut bounds = self.bounds.grown(margin);
        bounds.min.y = self.neck - below;
        (0..mesh.triangles.len() as u32)
            .filter(|&t| {
                let [a, b, c] = mesh.corners(t as usize);
                bounds.contains((a + b + c) / 3.0)
            })
            .collect()
    }
}

/// From the top down; slices that meet nothing are left out.
fn slices(mesh: &Mesh) -> Vec<Slice> {
    let all = mesh.bounds();
    let height = all.size().y;
    let y = |k: usize| all.max.y - height * (k as f32 + 0.5) / SLICES as f32;
    // Per slice, the extents of every triangle's cut.
    let mut cuts: Vec<Vec<([f32; 2], [f32; 2])>> = vec![Vec::new(); SLICES];
    for t in 0..mesh.triangles.len() {
        let p = mesh.corners(t);
        let (top, bottom) = (p[0].y.max(p[1].y).max(p[2].y), p[0].y.min(p[1].y).min(p[2].y));
        let index = |h: f32| ((all.max.y - h) / height * SLICES as f32 - 0.5).max(0.0);
        for (k, cuts) in cuts.iter_mut().enumerate().take(SLICES).skip(index(top).floor() as usize) {
            let h = y(k);
            if h < bottom {
                break;
            }
            if let Some(cut) = cut(&p, h) {
                cuts.push(cut);
            }
        }
    }
    let mut column: Option<(f32, f32)> = None;
    let mut slices = Vec::new();
    for (k, cuts) in cuts.iter_mut().enumerate() {
        // The stretch of x that hangs together with the slice above: arms beside the head are left out.
        cuts.sort_unstable_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let gap = height * 0.004;
        let mut stretches: Vec<(f32, f32)> = Vec::new();
        for (lo, hi) in cuts.iter() {
            match stretches.last_mut() {
                Some(last) if lo[0] <= last.1 + gap => last.1 = last.1.max(hi[0]),
                _ => stretches.push((lo[0], hi[0])),
            }
        }
        let overlap = |s: &(f32, f32)| column.map_or(s.1 - s.0, |c| s.1.min(c.1) - s.0.max(c.0));
        let Some(&(left, right)) = stretches.iter().max_by(|a, b| overlap(a).total_cmp(&overlap(b))) else { continue };
        column = Some((left, right));
        let mut slice = Slice { y: y(k), lo: [left, f32::INFINITY], hi: [right, f32::NEG_INFINITY] };
        for (lo, hi) in cuts.iter().filter(|c| c.1[0] >= left && c.0[0] <= right) {
            slice.lo[1] = slice.lo[1].min(lo[1]);
            slice.hi[1] = slice.hi[1].max(hi[1]);
        }
        slices.push(slice);
    }
    slices
}

/// Extents in x and z of the cut of a triangle with the plane at height `h`.
fn cut(p: &[Vec3; 3], h: f32) -> Option<([f32; 2], [f32; 2])> {
    let mut found: Option<([f32; 2], [f32; 2])> = None;
    for i in 0..3 {
        let (a, b) = (p[i], p[(i + 1) % 3]);
        if (a.y < h) == (b.y < h) {
            continue;
        }
        let q = a.lerp(b, (h - a.y) / (b.y - a.y));
        let q = [q.x, q.z];
        found = Some(
            found.map_or((q, q), |(lo, hi)| ([lo[0].min(q[0]), lo[1].min(q[1])], [hi[0].max(q[0]), hi[1].max(q[1])])),
        );
    }
    found
}
