//! Transcendental functions with the same bits on every platform (from the `libm` crate).

/// Sine of `x` radians.
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of `x` radians.
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Tangent of `x` radians.
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Arc cosine in radians, `x` clamped to -1..1 first, so rounding never makes NaN.
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Arc sine in radians, `x` clamped to -1..1 first, so rounding never makes NaN.
pub fn asin(x: f32) -> f32 {
    libm::asinf(x.clamp(-1.0, 1.0))
}

/// Angle of (`x`, `y`) in radians, -pi..pi.
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// e to the power of `x`.
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// `x` to the power of `y`.
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Length of the vector (`x`, `y`).
pub fn hypot(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

/// Smooth step from 0 at `lo` to 1 at `hi`, with zero slope at both ends.
pub fn smoothstep(lo: f32, hi: f32, x: f32) -> f32 {
    let t = ((x - lo) / (hi - lo)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
