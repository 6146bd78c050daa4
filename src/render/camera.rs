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
    let mut points: Vec<Vec3> = Vec::new();
    for part in &scene.parts {
        match &part.body {
            Body::Mesh(mesh, _) if !part.is_head() => points.extend(mesh.positions.iter().filter(|p| p.is_finite())),
            Body::Mesh(mesh, _) => {
                let top = mesh.positions.iter().filter(|p| p.is_finite()).map(|p| p.y).fold(0.0, f32::max);
                let (floor, neck) = (-1.5 * top, -0.9 * top);
                let kept = |p: &&Vec3| p.is_finite() && (top <= 0.0 || p.y >= neck);
                points.extend(mesh.positions.iter().filter(kept));
                // The cut through the bust counts for the height alone.
                let low = mesh.positions.iter().map(|p| p.y).filter(|y| y.is_finite()).fold(f32::INFINITY, f32::min);
                if low.is_finite() && top > 0.0 {
                    points.push(Vec3::new(0.0, low.max(floor), 0.0));
                }
            }
            Body::Locks(locks) => points.extend(locks.mesh.mesh.positions.iter().filter(|p| p.is_finite())),
            Body::Hair(hair) => {
                let shown = if scene.look.debug { &hair.guides } else { &hair.strands };
                points.extend(shown.points.iter().filter(|p| p.is_finite()));
                if scene.look.debug {
                    points.extend(hair.overlay.lines.iter().flat_map(|l| &l.points).filter(|p| p.is_finite()));
                }
            }
        }
    }
    if scene.look.debug {
        let overlay = &scene.overlay;
        points.extend(overlay.lines.iter().chain(&overlay.thin).flat_map(|l| &l.points).filter(|p| p.is_finite()));
    }
    if points.is_empty() {
        points.extend([Vec3::splat(-10.0), Vec3::splat(10.0)]);
    }
    let mut size = Vec2::splat(1e-3);
    let centres = views
        .iter()
        .map(|&turn| {
            let b = points
                .par_chunks(1 << 14)
                .map(|some| Bounds::of(some.iter().map(|&p| turn.transpose() * p)))
                .reduce(|| Bounds::EMPTY, Bounds::union);
            size = size.max(b.size().truncate());
            turn * b.centre()
        })
        .collect();
    Framing { centres, size }
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
        let p = Vec3::new(0.5, -3.0, 7.0);
        assert!(camera.unproject(camera.project(p)).distance(p) < 1e-5);
        assert_eq!(camera.enlarged(2).project(Vec3::new(2.0, 3.0, 5.0)), Vec3::new(220.0, 80.0, 2.0));
    }
}
