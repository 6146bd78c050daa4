//! Pictures over texture coordinates.

use glam::Vec2;

/// A picture of one channel, laid over the uv square.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row after row from the top, 0..=1 each.
    pub values: Vec<f32>,
}

impl Mask {
    /// True when there is one value per pixel and at least one pixel.
    pub fn is_valid(&self) -> bool {
        self.width > 0
            && self.height > 0
            && self.width.checked_mul(self.height) == Some(self.values.len())
            && self.values.iter().all(|v| v.is_finite())
    }

    /// The value at a texture coordinate (v up), bilinear between the pixels' middles. The picture repeats.
    pub fn value(&self, uv: Vec2) -> f32 {
        if !uv.is_finite() {
            return 0.0;
        }
        let x = (uv.x - uv.x.floor()) * self.width as f32 - 0.5;
        let y = (1.0 - (uv.y - uv.y.floor())) * self.height as f32 - 0.5;
        let (column, row) = (x.floor(), y.floor());
        let at = |dx: i64, dy: i64| {
            let i = (column as i64 + dx).rem_euclid(self.width as i64) as usize;
            let j = (row as i64 + dy).rem_euclid(self.height as i64) as usize;
            self.values[j * self.width + i]
        };
        let (s, t) = (x - column, y - row);
        let (top, bottom) = (at(0, 0) + (at(1, 0) - at(0, 0)) * s, at(0, 1) + (at(1, 1) - at(0, 1)) * s);
        top + (bottom - top) * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_where_they_should() {
        let mask = Mask { width: 2, height: 2, values: vec![0.1, 0.2, 0.3, 0.4] };
        assert!(mask.is_valid());
        let near = |uv: [f32; 2], v: f32| assert!((mask.value(uv.into()) - v).abs() < 1e-6, "{uv:?}");
        near([0.25, 0.75], 0.1);
        near([0.75, 0.75], 0.2);
        near([0.25, 0.25], 0.3);
        near([0.5, 0.5], 0.25);
        near([3.25, -0.25], 0.1);
        assert_eq!(mask.value(Vec2::NAN), 0.0);
        assert!(!Mask { width: 2, height: 2, values: vec![0.0] }.is_valid());
        assert!(!Mask { width: 0, height: 0, values: vec![] }.is_valid());
    }
}
