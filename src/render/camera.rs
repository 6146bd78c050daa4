//! Where a view looks from, and what part of the scene it shows.

use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

use crate::geometry::Bounds;
use crate::math::trig;
use crate::scene::{Body, Scene, View};

/// An orthographic camera over a picture of `width` x `height` pixels.
///
/// A point projects to (x in pixels to the right, y in pixels downward, depth in cm): the greater the depth, the
/// nearer the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Unit vector to the upper border.
    pub up: Vec3,
    /// Unit vector from the scene to the viewer.
    pub toward: Vec3,
    /// What is seen in the middle of the picture.
    pub centre: Vec3,
    /// Pixels per cm.
    pub scale: f32,
    /// Picture width in pixels.
    pub width: usize,
    /// Picture height in pixels.
    pub height: usize,
}

impl Camera {
    /// Pixel position and depth of `p`.
    pub fn project(&self, p: Vec3) -> Vec3 {
        let d = p - self.centre;
        Vec3::new(
            self.width as f32 * 0.5 + d.dot(self.right) * self.scale,
            self.height as f32 * 0.5 - d.dot(self.up) * self.scale,
            d.dot(self.toward),
        )
    }

    /// [`project`](Self::project) as three rows of an affine matrix: x, y and depth are the products with (p, 1).
    pub fn rows(&self) -> [[f32; 4]; 3] {
        let row = |axis: Vec3, offset: f32| [axis.x, axis.y, axis.z, offset - axis.dot(self.centre)];
        [
            row(self.right * self.scale, self.width as f32 * 0.5),
            row(-self.up * self.scale, self.height as f32 * 0.5),
            row(self.toward, 0.0),
        ]
    }

    /// The point that projects to these pixels and this depth.
    pub fn unproject(&self, at: Vec3) -> Vec3 {
        let x = (at.x - self.width as f32 * 0.5) / self.scale;
        let y = (self.height as f32 * 0.5 - at.y) / self.scale;
        self.centre + self.to_world(Vec3::new(x, y, at.z))
    }

    /// The vector in head space with these components to the right, up and toward the viewer.
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.toward * v.z
    }

    /// The same camera for a picture with `factor` times the pixels on each side.
    #[must_use]
    pub fn enlarged(self, factor: usize) -> Self {
        Self { scale: self.scale * factor as f32, width: self.width * factor, height: self.height * factor, ..self }
    }

    /// The same camera for a picture with `factor` times fewer pixels on each side, the last of them perhaps in part.
    #[must_use]
    pub fn reduced(self, factor: usize) -> Self {
        let (width, height) = (self.width.div_ceil(factor), self.height.div_ceil(factor));
        // What is in the middle of the one is in the middle of the other's whole part.
        let scale = self.scale / factor as f32;
        let beyond = |count: usize, small: usize| 0.5 * (small * factor - count) as f32 / self.scale;
        let centre = self.centre + self.right * beyond(self.width, width) - self.up * beyond(self.height, height);
        Self { scale, width, height, centre, ..self }
    }
}

fn upright(toward: Vec3) -> Mat3 {
    let toward = toward.normalize();
    let right = Vec3::Y.cross(toward).normalize();
    Mat3::from_cols(right, toward.cross(right), toward)
}

/// The axes of a level view, as [`axes`]: `azimuth` radians from the front towards the head's left. The quarters are
/// exactly front, left, back and right.
pub fn turned(azimuth: f32) -> Mat3 {
    let quarters = azimuth / std::f32::consts::FRAC_PI_2;
    if (quarters - quarters.round()).abs() < 1e-5 {
        return axes([View::Front, View::Left, View::Back, View::Right][quarters.round().rem_euclid(4.0) as usize]);
    }
    upright(Vec3::new(trig::sin(azimuth), 0.0, trig::cos(azimuth)))
}

/// The axes of a view as columns: right, up, toward the viewer.
pub fn axes(view: View) -> Mat3 {
    match view {
        View::Front => upright(Vec3::Z),
        View::Back => upright(Vec3::NEG_Z),
        View::Left => upright(Vec3::X),
        View::Right => upright(Vec3::NEG_X),
        View::Top => Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y),
        View::ThreeQuarter => upright(Vec3::new(0.62, 0.20, 0.76)),
        View::BackThreeQuarter => upright(Vec3::new(0.62, 0.20, -0.76)),
    }
}

/// What every view of a sheet shows: the middle of a view and the size in cm that the largest one needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Framing {
    /// Middle of each view, in the order given.
    pub centres: Vec<Vec3>,
    /// Width and height in cm that hold every view.
    pub size: Vec2,
}

impl Framing {
    /// One framing that holds all of these, of the same directions; none of none.
    pub fn around(framings: &[Self], views: &[Mat3]) -> Option<Self> {
        let (first, more) = framings.split_first()?;
        if more.is_empty() {
            return Some(first.clone());
        }
        let mut size = first.size;
        let centres = views
            .iter()
            .enumerate()
            .map(|(i, &turn)| {
                let corners = framings.iter().flat_map(|f| {
                    let middle = turn.transpose() * f.centres[i];
                    let half = (0.5 * f.size).extend(0.0);
                    [middle - half, middle + half]
                });
                let b = Bounds::of(corners);
                size = size.max(b.size().truncate());
                turn * b.centre()
            })
            .collect();
        Some(Self { centres, size })
    }
}

/// Frames hair and head; of a bust only the neck and the tops of the shoulders need to fit.
///
/// Landmarks are not part of a scene, so "head" is what lies above 1.5 times the height of the vertex over the origin
/// (the middle between the ears), measured downward: that is a hand's breadth under the chin.
pub fn frame(scene: &Scene, views: &[Mat3]) -> Framing {
    let mut few: Vec<Vec3> = Vec::new();
    let mut many: Vec<&[Vec3]> = Vec::new();
    for part in &scene.parts {
        match &part.body {
            Body::Mesh(mesh, _) if part.is_garment() => many.push(&mesh.positions),
            Body::Mesh(mesh, _) => {
                let top = mesh.positions.iter().filter(|p| p.is_finite()).map(|p| p.y).fold(0.0, f32::max);
                let (floor, neck) = (-1.5 * top, -0.9 * top);
                few.extend(mesh.positions.iter().filter(|p| top <= 0.0 || p.y >= neck));
                // The cut through the bust counts for the height alone.
                let low = mesh.positions.iter().map(|p| p.y).filter(|y| y.is_finite()).fold(f32::INFINITY, f32::min);
                if low.is_finite() && top > 0.0 {
                    few.push(Vec3::new(0.0, low.max(floor), 0.0));
                }
            }
            Body::Locks(locks) => many.push(&locks.mesh.mesh.positions),
            Body::Hair(hair) => {
                let shown = if scene.look.debug { &hair.guides } else { &hair.strands };
                many.push(&shown.points);
                if scene.look.debug {
                    many.extend(hair.overlay.lines.iter().map(|l| l.points.as_slice()));
                }
            }
        }
    }
    if scene.look.debug {
        let overlay = &scene.overlay;
        few.extend(overlay.lines.iter().chain(&overlay.thin).flat_map(|l| &l.points));
    }
    many.push(&few);
    let turns: Vec<Mat3> = views.iter().map(Mat3::transpose).collect();
    let none = || vec![Bounds::EMPTY; views.len()];
    let union = |a: Vec<Bounds>, b: Vec<Bounds>| a.into_iter().zip(b).map(|(a, b)| a.union(b)).collect();
    let mut bounds = many
        .par_iter()
        .flat_map(|points| points.par_chunks(1 << 12))
        .map(|some| turns.iter().map(|&turn| extent(some, turn)).collect())
        .reduce(none, union);
    if bounds.iter().any(|b| b.is_empty()) {
        bounds.fill(Bounds::of([Vec3::splat(-10.0), Vec3::splat(10.0)]));
    }
    let size = bounds.iter().fold(Vec2::splat(1e-3), |size, b| size.max(b.size().truncate()));
    let centres = views.iter().zip(&bounds).map(|(&turn, b)| turn * b.centre()).collect();
    Framing { centres, size }
}

/// Bounds of the turned points; those that are not finite do not count.
fn extent(points: &[Vec3], turn: Mat3) -> Bounds {
    let (lo, hi) = corners(points, turn.to_cols_array());
    let bounds = Bounds { min: Vec3::from(lo), max: Vec3::from(hi) };
    if bounds.min.is_finite() && bounds.max.is_finite() {
        return bounds;
    }
    Bounds::of(points.iter().filter(|p| p.is_finite()).map(|&p| turn * p))
}

/// Least and greatest coordinates after the turn `m` (by columns): many at a time, without a branch.
#[multiversion::multiversion(targets("x86_64+avx2"))]
fn corners(points: &[Vec3], m: [f32; 9]) -> ([f32; 3], [f32; 3]) {
    const LANES: usize = 8;
    let (mut lo, mut hi) = ([[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]);
    let mut add = |p: Vec3, lane: usize| {
        for k in 0..3 {
            let v = p.x * m[k] + p.y * m[k + 3] + p.z * m[k + 6];
            lo[k][lane] = if v < lo[k][lane] { v } else { lo[k][lane] };
            hi[k][lane] = if v > hi[k][lane] { v } else { hi[k][lane] };
        }
    };
    let mut rows = points.chunks_exact(LANES);
    for row in &mut rows {
        for (lane, &p) in row.iter().enumerate() {
            add(p, lane);
        }
    }
    rows.remainder().iter().for_each(|&p| add(p, 0));
    let least = |lanes: [f32; LANES]| lanes.into_iter().fold(f32::INFINITY, f32::min);
    let greatest = |lanes: [f32; LANES]| lanes.into_iter().fold(f32::NEG_INFINITY, f32::max);
    (lo.map(least), hi.map(greatest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_and_see_the_right_side() {
        for view in View::TEXTS.iter().filter_map(|t| View::parse(t)) {
            let m = axes(view);
            assert!((m.determinant() - 1.0).abs() < 1e-5, "{view:?}");
            assert!((m.transpose() * m - Mat3::IDENTITY).abs_diff_eq(Mat3::ZERO, 1e-5), "{view:?}");
        }
        // From the left the face looks to the left border; from the top to the lower one.
        assert!(axes(View::Left).x_axis.dot(Vec3::Z) < -0.99);
        assert!(axes(View::Right).x_axis.dot(Vec3::Z) > 0.99);
        assert!(axes(View::Top).y_axis.dot(Vec3::Z) < -0.99);
        assert!(axes(View::Back).x_axis.dot(Vec3::X) < -0.99);
    }

    #[test]
    fn the_extent_is_that_of_every_point() {
        let key = crate::math::rng::Key::new(1, "extent");
        for n in [0, 1, 7, 8, 9, 100] {
            let mut points: Vec<Vec3> = (0..n).map(|i| key.with(i).gaussian3()).collect();
            let turn = axes(View::ThreeQuarter).transpose();
            let want = Bounds::of(points.iter().map(|&p| turn * p));
            for odd in [Vec3::splat(f32::NAN), Vec3::new(f32::INFINITY, 0.0, 0.0)] {
                let got = extent(&points, turn);
                assert_eq!(got.is_empty(), n == 0);
                assert!(n == 0 || (got.min.abs_diff_eq(want.min, 1e-5) && got.max.abs_diff_eq(want.max, 1e-5)), "{n}");
                points.insert(0, odd);
            }
        }
    }

    #[test]
    fn a_turn_passes_the_named_views() {
        for (degrees, view) in [(0.0, View::Front), (90.0, View::Left), (180.0, View::Back), (270.0, View::Right)] {
            for whole in [0.0_f32, 360.0, -360.0] {
                assert_eq!(turned((degrees + whole).to_radians()), axes(view), "{degrees} {whole}");
            }
        }
        let m = turned(45.0_f32.to_radians());
        assert!((m.transpose() * m - Mat3::IDENTITY).abs_diff_eq(Mat3::ZERO, 1e-5) && m.determinant() > 0.0);
        assert!(m.z_axis.x > 0.7 && m.z_axis.z > 0.7 && m.y_axis.abs_diff_eq(Vec3::Y, 1e-6));
    }

    #[test]
    fn projection_scales_and_orders() {
        let m = axes(View::Front);
        let camera = Camera {
            right: m.x_axis,
            up: m.y_axis,
            toward: m.z_axis,
            centre: Vec3::new(1.0, 2.0, 3.0),
            scale: 10.0,
            width: 200,
            height: 100,
        };
        assert_eq!(camera.project(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(100.0, 50.0, 0.0));
        assert_eq!(camera.project(Vec3::new(2.0, 3.0, 5.0)), Vec3::new(110.0, 40.0, 2.0));
        assert_eq!(camera.unproject(Vec3::new(110.0, 40.0, 2.0)), Vec3::new(2.0, 3.0, 5.0));
        let p = Vec3::new(0.5, -3.0, 7.0);
        let rows = camera.rows().map(|r| Vec3::from_slice(&r[..3]).dot(p) + r[3]);
        assert!(Vec3::from(rows).distance(camera.project(p)) < 1e-4);
        assert!(camera.unproject(camera.project(p)).distance(p) < 1e-5);
        assert_eq!(camera.enlarged(2).project(Vec3::new(2.0, 3.0, 5.0)), Vec3::new(220.0, 80.0, 2.0));
    }
}
