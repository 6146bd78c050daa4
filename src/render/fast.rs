//! Exponential and sRGB coding for inner loops: polynomials and tables instead of calls, the same bits everywhere.

use std::sync::LazyLock;

use glam::Vec3;

use crate::math::Colour;

/// e to the power of `x` with a relative error under 2e-5; 0 below -87.
pub fn exp(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let y = x.min(88.0) * std::f32::consts::LOG2_E;
    // `floor` would be a call where the processor at hand is not known to have the instruction.
    let whole = (y + 128.0) as i32 - 128;
    let f = (y - whole as f32) * std::f32::consts::LN_2;
    // Taylor's series about 0, over 0..ln 2.
    let p = 1.0 + f * (1.0 + f * (1.0 / 2.0 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f / 720.0)))));
    p * f32::from_bits(((whole + 127) << 23) as u32)
}

/// The least whole number not under `x`, which is at least 0; 0 for NaN and below.
pub fn ceil(x: f32) -> usize {
    let whole = x as usize;
    whole + usize::from((whole as f32) < x)
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
    linear.to_array().map(|c| ENCODE[(c.clamp(0.0, 1.0).sqrt() * 4095.0 + 0.5) as usize])
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
        assert_eq!(exp(-1e9), 0.0);
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
