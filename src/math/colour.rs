//! Colours.

use glam::Vec3;

use super::trig;

/// An opaque colour in sRGB, each channel 0..=1, as artists write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

impl Colour {
    /// From three sRGB channels, 0..=1.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// From `0xrrggbb`.
    pub const fn hex(rgb: u32) -> Self {
        Self::new(((rgb >> 16) & 255) as f32 / 255.0, ((rgb >> 8) & 255) as f32 / 255.0, (rgb & 255) as f32 / 255.0)
    }

    /// Reads `#rgb` or `#rrggbb`.
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?;
        if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        let n = u32::from_str_radix(digits, 16).ok()?;
        match digits.len() {
            3 => Some(Self::hex(((n >> 8) & 15) * 0x11_0000 + ((n >> 4) & 15) * 0x1100 + (n & 15) * 0x11)),
            6 => Some(Self::hex(n)),
            _ => None,
        }
    }

    /// The same colour with linear channels (IEC 61966-2-1), for shading and glTF factors.
    pub fn to_linear(self) -> Vec3 {
        let f = |c: f32| if c <= 0.04045 { c / 12.92 } else { trig::pow((c + 0.055) / 1.055, 2.4) };
        Vec3::new(f(self.r), f(self.g), f(self.b))
    }

    /// From linear channels; values outside 0..=1 are clamped.
    pub fn from_linear(linear: Vec3) -> Self {
        let f = |c: f32| {
            let c = c.clamp(0.0, 1.0);
            if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * trig::pow(c, 1.0 / 2.4) - 0.055 }
        };
        Self::new(f(linear.x), f(linear.y), f(linear.z))
    }
}

impl std::fmt::Display for Colour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let byte = |c: f32| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
        write!(f, "#{:02x}{:02x}{:02x}", byte(self.r), byte(self.g), byte(self.b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_back() {
        assert_eq!(Colour::parse("#3b2417").map(|c| c.to_string()).as_deref(), Some("#3b2417"));
        assert_eq!(Colour::parse("#f80"), Colour::parse("#ff8800"));
        for bad in ["", "#", "3b2417", "#3b241", "#3b241g", "#+12345"] {
            assert_eq!(Colour::parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn linear_and_back() {
        let c = Colour::new(0.02, 0.5, 1.0);
        let back = Colour::from_linear(c.to_linear());
        assert!((back.r - c.r).abs() < 1e-6 && (back.g - c.g).abs() < 1e-6 && (back.b - c.b).abs() < 1e-6);
    }
}
