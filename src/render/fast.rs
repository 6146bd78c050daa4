//! Exponential and sRGB coding for inner loops: polynomials and tables instead of calls, the same bits everywhere.

use std::sync::LazyLock;

use glam::Vec3;

use crate::math::Colour;

/// Added to a number of moderate size, it leaves no room for a fraction: the whole part stands in the lowest bits.
const WHOLE: f32 = 12_582_912.0;

/// e to the power of `x` with a relative error under 2e-5, for `x` between -87 and 88; what is beyond counts as that.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let y = x.clamp(-87.0, 88.0) * std::f32::consts::LOG2_E;
    let whole = y + WHOLE;
    let f = (y - (whole - WHOLE)) * std::f32::consts::LN_2;
    // Taylor's series about 0, over half of ln 2 on either side.
    let p = 1.0 + f * (1.0 + f * (1.0 / 2.0 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f / 120.0))));
    p * f32::from_bits((whole.to_bits() << 23).wrapping_add(127 << 23))
}

/// The whole part of `x` between 0 and 4 million, or one less when `x` is whole: without a branch, for vectors.
#[inline(always)]
pub fn floor(x: f32) -> u32 {
    (x - 0.5 + WHOLE).to_bits() & 0x3f_ffff
}

/// The least whole number not under `x`, which is at least 0; 0 for NaN and below. Up to 2 thousand million.
pub fn ceil(x: f32) -> usize {
    let whole = x as i32;
    (whole + i32::from((whole as f32) < x)).max(0) as usize
}

/// sRGB bytes of 4096 linear values 0..=1, denser towards black: index is the square root.
static ENCODE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    (0..4096)
        .map(|i| {
            let root = i as f32 / 4095.0;
            (Colour::from_linear(Vec3::splat(root * root)).r * 255.0).round() as u8
        })
        .collect()
});

/// sRGB bytes of a linear colour, clamped to 0..=1; NaN becomes 0.
pub fn encode(linear: Vec3) -> [u8; 3] {
    let table: &[u8] = &ENCODE;
    let byte = |c: f32| table[(c.clamp(0.0, 1.0).sqrt() * 4095.0 + 0.5) as usize];
    [byte(linear.x), byte(linear.y), byte(linear.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_is_close() {
        for i in -860..600 {
            let x = i as f32 * 0.1;
            let (got, want) = (exp(x), crate::math::trig::exp(x));
            assert!((got - want).abs() <= 4e-5 * want, "{x}: {got} {want}");
        }
        assert!(exp(-1e9) < 1e-37 && exp(1e9).is_finite());
    }

    #[test]
    fn rounding_down() {
        for i in 0..4000 {
            let (x, n) = (i as f32 * 0.37 + 0.01, (i as f32 * 0.37 + 0.01) as u32);
            assert!(floor(x) == n || (floor(x) + 1 == n && x.fract() < 1e-3), "{x}: {}", floor(x));
        }
        assert_eq!((floor(0.0), floor(0.3), floor(3_999_998.5)), (0, 0, 3_999_998));
    }

    #[test]
    fn rounding_up() {
        for (x, want) in [(0.0, 0), (0.25, 1), (1.0, 1), (1.001, 2), (-3.5, 0), (f32::NAN, 0)] {
            assert_eq!(ceil(x), want, "{x}");
        }
    }

    #[test]
    fn coding_is_that_of_colour() {
        for i in 0..=255_u32 {
            let c = Colour::hex(i * 0x1_0101);
            assert_eq!(encode(c.to_linear()), [i as u8; 3]);
        }
        assert_eq!(encode(Vec3::new(f32::NAN, 2.0, -1.0)), [0, 255, 0]);
    }
}
