//! Units, axes and the size a head should have.

use glam::{Mat3, Vec3};

use super::LoadError;
use crate::geometry::Bounds;

crate::choices! {
    /// What one unit of a file is.
    pub enum Unit {
        /// Millimetre.
        Mm = "mm",
        /// Centimetre.
        Cm = "cm",
        /// Decimetre.
        Dm = "dm",
        /// Metre.
        M = "m",
        /// Inch.
        In = "in",
        /// Foot.
        Ft = "ft",
    }
}

crate::choices! {
    /// A direction along an axis of a file.
    pub enum Axis {
        /// Along +X.
        X = "x",
        /// Along +Y.
        Y = "y",
        /// Along +Z.
        Z = "z",
        /// Along -X.
        MinusX = "-x",
        /// Along -Y.
        MinusY = "-y",
        /// Along -Z.
        MinusZ = "-z",
    }
}

crate::params! {
    /// How a file with a head or another mesh is to be read.
    #[derive(Default, PartialEq)]
    pub struct LoadOptions("coif.head") {
        /// What one unit of the file is; left out: metres for glTF, as that format says, centimetres for OBJ.
        unit: Option<Unit>;
        /// The axis of the file that points up; left out: "y".
        up: Option<Axis>;
        /// The axis of the file that the face looks along; left out: "z", or "-y" when z is up.
        forward: Option<Axis>;
        /// Only these groups (of OBJ: g, o and usemtl; of glTF: nodes, meshes and materials); left out: everything.
        groups: Vec<String> = vec![];
    }
}

impl Unit {
    const ALL: [Self; 6] = [Self::M, Self::Cm, Self::Mm, Self::Dm, Self::In, Self::Ft];

    /// Its length in cm.
    pub fn centimetres(self) -> f64 {
        match self {
            Self::Mm => 0.1,
            Self::Cm => 1.0,
            Self::Dm => 10.0,
            Self::M => 100.0,
            Self::In => 2.54,
            Self::Ft => 30.48,
        }
    }
}

impl Axis {
    /// The unit vector.
    pub fn vector(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
            Self::MinusX => Vec3::NEG_X,
            Self::MinusY => Vec3::NEG_Y,
            Self::MinusZ => Vec3::NEG_Z,
        }
    }
}

impl LoadOptions {
    /// The rotation from the file's axes to Y up and the face to +Z.
    ///
    /// # Errors
    /// [`LoadError::Axes`] when `up` and `forward` lie on one line.
    pub fn rotation(&self) -> Result<Mat3, LoadError> {
        let up = self.up.unwrap_or(Axis::Y);
        let forward = self.forward.unwrap_or(match up {
            Axis::Z | Axis::MinusZ => Axis::MinusY,
            Axis::X | Axis::Y | Axis::MinusX | Axis::MinusY => Axis::Z,
        });
        let (u, f) = (up.vector(), forward.vector());
        if u.dot(f) != 0.0 {
            return Err(LoadError::Axes { up: up.text(), forward: forward.text() });
        }
        Ok(Mat3::from_cols(u.cross(f), u, f).transpose())
    }
}

/// Heights in cm that a head or a bust has: from a baby's, cut at the chin, to a large one with shoulders and chest.
const HEAD: (f32, f32) = (10.0, 75.0);
/// Heights in cm that a whole figure has: from a child or a cartoon's to a giant's.
const BODY: (f32, f32) = (50.0, 260.0);
/// Height over depth: a bust stays below 2, a standing figure is above 2.5; between them it may be either.
const SLENDER: (f32, f32) = (1.75, 2.5);
/// Height over depth under which a head or a figure lies down.
const LYING: f32 = 0.4;

/// Width over height from which a mesh is a figure with spread arms or with things about it; a bust is narrower.
const SPREAD: f32 = 1.2;

/// Whether a mesh of that size can hold a head in life size, and how far (as a ratio of heights) it is from the
/// usual: 30 cm, between a bare head and a bust, or 170 cm for a figure.
fn plausible(size: Vec3, scale: f32) -> Option<f32> {
    let (height, slender) = (size.y * scale, slenderness(size));
    let within = |(lo, hi): (f32, f32)| height >= lo && height <= hi;
    let far = |usual: f32| (height / usual).max(usual / height);
    let head = ((LYING..=SLENDER.1).contains(&slender) && within(HEAD)).then(|| far(30.0));
    let body = ((slender >= SLENDER.0 || size.x >= SPREAD * size.y) && within(BODY)).then(|| far(170.0));
    match (head, body) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Checks that a mesh which was read in `unit` has the size of a head or of a figure that wears one.
///
/// A mesh up to 2.5 times as tall as it is deep may be a head or a bust of 10 to 75 cm; one at least 1.75 times as
/// tall as deep, or far wider than tall, a figure of 50 to 260 cm; everything else was most likely read in the wrong
/// unit. What a file holds beside its head counts too, so choose groups first.
///
/// # Errors
/// [`LoadError::Size`], whose hint names the unit that would give a likely size.
pub fn check_head_size(bounds: Bounds, unit: Unit) -> Result<(), LoadError> {
    let size = if bounds.is_empty() { Vec3::ZERO } else { bounds.size() };
    let height = size.y;
    if plausible(size, 1.0).is_some() {
        return Ok(());
    }
    let mut best: Option<(f32, Unit, f32)> = None;
    for other in Unit::ALL.into_iter().filter(|&u| u != unit) {
        let scale = (other.centimetres() / unit.centimetres()) as f32;
        // Hardly anybody models in inches or feet.
        let rarity = if matches!(other, Unit::In | Unit::Ft) { 1.5 } else { 1.0 };
        if let Some(far) =
            plausible(size, scale).map(|far| far * rarity).filter(|&far| best.is_none_or(|(b, ..)| far < b))
        {
            best = Some((far, other, height * scale));
        }
    }
    let advice = match best {
        _ if slenderness(size) < LYING && height > 0.0 => "is it lying down? `up = \"z\"` would set it upright".into(),
        Some((_, other, tall)) => format!("with `unit = \"{}\"` it would be {}", other.text(), show_length(tall)),
        None => "a head is about 23 cm tall, a figure 170 cm; scale the file to life size".into(),
    };
    Err(LoadError::Size { height, advice })
}

/// Height over depth.
fn slenderness(size: Vec3) -> f32 {
    size.y / size.z.max(1e-6)
}

/// A length in cm as people write it, with two or three digits.
pub(super) fn show_length(cm: f32) -> String {
    let (value, unit) = match cm {
        0.0 => return "0 cm".into(),
        c if c < 0.001 => return format!("{:.0e} mm", c * 10.0),
        c if c < 1.0 => (c * 10.0, "mm"),
        c if c < 100.0 => (c, "cm"),
        c if c < 1e5 => (c / 100.0, "m"),
        c => return format!("{:.0} m", c / 100.0),
    };
    let digits = if value < 0.1 {
        3
    } else if value < 10.0 {
        1
    } else {
        0
    };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(height: f32, depth: f32, unit: Unit) -> String {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(height * 0.7, height, depth) };
        match check_head_size(bounds, unit) {
            Ok(()) => "fine".into(),
            Err(e) => format!("{e}; {}", e.hint().unwrap_or_default()),
        }
    }

    #[test]
    fn heads_busts_and_figures_pass() {
        for (height, depth) in
            [(23.0, 19.0), (15.0, 12.0), (45.0, 28.0), (60.0, 30.0), (110.0, 20.0), (175.0, 35.0), (220.0, 90.0)]
        {
            assert_eq!(error(height, depth, Unit::Cm), "fine", "{height}");
        }
        // A figure with a spear and a cloak, arms spread.
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(300.0, 240.0, 185.0) };
        assert_eq!(check_head_size(bounds, Unit::M), Ok(()));
    }

    #[test]
    fn a_wrong_unit_is_named() {
        assert_eq!(error(0.23, 0.2, Unit::Cm), "the head is `2.3 mm` tall; with `unit = \"m\"` it would be 23 cm");
        assert_eq!(error(230.0, 200.0, Unit::Cm), "the head is `2.3 m` tall; with `unit = \"mm\"` it would be 23 cm");
        assert_eq!(error(2300.0, 2000.0, Unit::M), "the head is `23 m` tall; with `unit = \"cm\"` it would be 23 cm");
        assert_eq!(error(0.42, 0.27, Unit::Cm), "the head is `4.2 mm` tall; with `unit = \"m\"` it would be 42 cm");
        // A figure in decimetres that was read in centimetres is no tall head.
        assert_eq!(error(17.0, 4.0, Unit::Cm), "the head is `17 cm` tall; with `unit = \"dm\"` it would be 1.7 m");
        assert_eq!(error(9.0, 8.0, Unit::Cm), "the head is `9 cm` tall; with `unit = \"in\"` it would be 23 cm");
    }

    #[test]
    fn what_no_unit_cures_is_told_too() {
        let scale = "; a head is about 23 cm tall, a figure 170 cm; scale the file to life size";
        assert_eq!(error(1e9, 1e9, Unit::Cm), format!("the head is `10000000 m` tall{scale}"));
        assert_eq!(error(0.0, 20.0, Unit::Cm), format!("the head is `0 cm` tall{scale}"));
        assert_eq!(error(1e-5, 1e-5, Unit::Cm), format!("the head is `1e-4 mm` tall{scale}"));
        assert_eq!(
            error(30.0, 170.0, Unit::Cm),
            "the head is `30 cm` tall; is it lying down? `up = \"z\"` would set it upright"
        );
    }

    #[test]
    fn every_choice_of_axes_is_a_rotation() {
        let axes = [Axis::X, Axis::Y, Axis::Z, Axis::MinusX, Axis::MinusY, Axis::MinusZ];
        let mut good = 0;
        for up in axes {
            for forward in axes {
                let options = LoadOptions { up: Some(up), forward: Some(forward), ..LoadOptions::default() };
                let Ok(rotation) = options.rotation() else { continue };
                good += 1;
                assert_eq!(rotation.determinant(), 1.0);
                assert_eq!((rotation * up.vector(), rotation * forward.vector()), (Vec3::Y, Vec3::Z));
            }
        }
        assert_eq!(good, 24);
        let options = LoadOptions { up: Some(Axis::Z), forward: Some(Axis::MinusZ), ..LoadOptions::default() };
        assert_eq!(options.rotation().unwrap_err().to_string(), "`forward = \"-z\"` lies along `up = \"z\"`");
    }
}
