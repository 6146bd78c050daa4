//! Partings: lines on the scalp that no strand's interpolation crosses.

use glam::Vec3;

use super::Head;
use crate::geometry::Curtain;
use crate::params::Object;

/// Distance between the points of a parting's line, in cm of an adult's head.
const STEP: f32 = 0.4;

/// How far a parting's curtain reaches into the skull, in cm of an adult's head: chords between roots 12 cm apart dip
/// 2 cm below the skin.
const INWARD: f32 = 4.0;

/// How far it reaches out of the skin, in cm of an adult's head.
const OUTWARD: f32 = 2.0;

/// A line on the scalp.
#[derive(Clone, Debug)]
pub struct Parting {
    /// Its curtain, whose line lies on the skin.
    pub curtain: Curtain,
}

impl Object for Parting {
    const NAME: &'static str = "Parting";
}

/// Why there is no such parting.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PartingError {
    /// One point is no line.
    #[error("a parting needs at least 2 different points, got `{count}`")]
    TooFewPoints {
        /// How many there are.
        count: usize,
    },
    /// A point is NaN or infinite.
    #[error("point {index} is not finite: `{point}`")]
    PointNotFinite {
        /// From 1.
        index: usize,
        /// The point.
        point: Vec3,
    },
}

impl Parting {
    /// Through `points` (head space), which are laid on the skin; between them it runs along the skin, over great
    /// circles about [`Head::centre`].
    ///
    /// # Errors
    /// Too few points, or a bad one.
    pub fn new(head: &Head, points: &[Vec3]) -> Result<Self, PartingError> {
        if let Some(i) = points.iter().position(|p| !p.is_finite()) {
            return Err(PartingError::PointNotFinite { index: i + 1, point: points[i] });
        }
        let centre = head.centre();
        let laid: Vec<_> = points.iter().map(|&p| head.closest(p)).collect();
        let (mut line, mut normals) = (Vec::new(), Vec::new());
        let mut push = |at| {
            let root = head.root(&at);
            line.push(root.position);
            normals.push(root.normal);
        };
        for pair in laid.windows(2) {
            let (a, b) = (pair[0].position - centre, pair[1].position - centre);
            let steps = ((b - a).length() / (STEP * head.scale)).ceil().clamp(1.0, 400.0) as usize;
            push(pair[0]);
            for k in 1..steps {
                let t = k as f32 / steps as f32;
                let arm = a.lerp(b, t);
                // The chord dips below the skin; the ray starts a little over the higher end.
                let reach = 1.35 * a.length().max(b.length());
                if let Some(skin) = head.skin(arm, reach) {
                    push(skin);
                }
            }
        }
        if let Some(&end) = laid.last() {
            push(end);
        }
        let s = head.scale;
        Curtain::new(&line, &normals, INWARD * s, OUTWARD * s)
            .map(|curtain| Self { curtain })
            .ok_or(PartingError::TooFewPoints { count: points.len() })
    }

    /// True when no strand at `a` may be blended with one at `b`.
    pub fn separates(&self, a: Vec3, b: Vec3) -> bool {
        self.curtain.separates(a, b)
    }

    /// 1, -1 or 0: see [`Curtain::side`]. For a parting drawn from the forehead backward 1 is the head's left.
    pub fn side(&self, p: Vec3) -> f32 {
        self.curtain.side(p)
    }
}
