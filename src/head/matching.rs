//! Places of two heads that belong together.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;

use super::Head;
use crate::math::trig;

/// Pairs (place on `from`, the same place on `to`): all landmarks, and the skull over the hairline seen from its middle in
/// directions that follow the landmarks. Enough of them, and far enough apart, to fit a smooth motion through.
pub fn matching(from: &Head, to: &Head) -> Vec<(Vec3, Vec3)> {
    let mut pairs: Vec<(Vec3, Vec3)> = from.landmarks.all().into_iter().zip(to.landmarks.all()).collect();
    let skin = |head: &Head, direction: Vec3| {
        head.skin(direction, 3.0 * crate::head::ADULT_HEIGHT * head.scale).map(|s| s.position)
    };
    // Rows from the crown down; on the face nothing below the hairline, behind down to the nape.
    for (row, count) in [(70.0_f32, 5), (45.0, 9), (20.0, 11), (0.0, 11)] {
        for i in 0..count {
            let azimuth = PI * (2 * i) as f32 / count as f32 + if count % 2 == 1 { PI } else { 0.0 };
            let is_face = trig::cos(azimuth) > 0.3;
            if is_face && row < 40.0 {
                continue;
            }
            let elevation = row.to_radians().min(FRAC_PI_2);
            let level = trig::cos(elevation);
            let direction = Vec3::new(level * trig::sin(azimuth), trig::sin(elevation), level * trig::cos(azimuth));
            let (Some(a), Some(b)) = (skin(from, direction), skin(to, direction)) else { continue };
            if pairs.iter().all(|(p, _)| p.distance(a) > 1.2 * from.scale) {
                pairs.push((a, b));
            }
        }
    }
    pairs
}
