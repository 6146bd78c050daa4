//! Gaussian noise along strands.

use glam::Vec3;

use crate::math::rng::Key;

/// About normal with mean 0 and deviation 1 in each coordinate: the sum of four uniform numbers (Irwin and Hall), whose
/// moments agree with the normal law up to the third and which never exceeds 3.5. A tenth of the cost of the exact
/// one, which matters where every node of every member asks.
pub fn gaussian3(key: Key) -> Vec3 {
    // Four numbers of 16 bits each: the sum has mean 2 * 65535 and variance 4 * 65536^2 / 12.
    const SCALE: f32 = 1.732_050_8 / 65536.0;
    let one = |n: u64| {
        let bits = key.with(n).bits();
        let sum = (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
        (sum as f32 - 131_070.0) * SCALE
    };
    Vec3::new(one(1), one(2), one(3))
}

/// Noise that runs smoothly in `x`: normal at whole numbers, cubic (Catmull-Rom) between.
pub fn smooth(key: Key, x: f32) -> Vec3 {
    let base = x.floor();
    let u = x - base;
    let at = |k: i64| gaussian3(key.with((base as i64 + k) as u64));
    let (a, b, c, d) = (at(-1), at(0), at(1), at(2));
    b + (c - a) * (0.5 * u)
        + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (0.5 * u * u)
        + (b * 3.0 - a - c * 3.0 + d) * (0.5 * u * u * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_noise_has_the_moments_of_the_normal_law() {
        let key = Key::new(5, "moments");
        let n = 40_000;
        let (mut mean, mut square, mut cross) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for i in 0..n {
            let g = gaussian3(key.with(i));
            mean += g / n as f32;
            square += g * g / n as f32;
            cross += g.x * g.y / n as f32;
        }
        assert!(mean.abs().max_element() < 0.02, "{mean}");
        assert!((square - Vec3::ONE).abs().max_element() < 0.03, "{square}");
        assert!(cross.abs() < 0.02, "{cross}");
    }

    #[test]
    fn smooth_noise_passes_through_its_knots_without_jumps() {
        let key = Key::new(5, "smooth");
        for k in 1..20_u64 {
            assert!(smooth(key, k as f32).distance(gaussian3(key.with(k))) < 1e-5);
            assert!(smooth(key, k as f32 - 1e-3).distance(smooth(key, k as f32 + 1e-3)) < 0.02);
        }
    }
}
