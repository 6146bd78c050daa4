//! A tuft as a script describes it.

use glam::Vec3;

use super::{Detail, Ground, Profile, ProfilePoint, Section, Split, Stroke, Tuft, TuftError};
use crate::params::{Angle, Direction};
use crate::task::Warned;

crate::params! {
    /// The radii of an elliptic tuft.
    #[derive(PartialEq)]
    pub struct Ellipse("coif.ellipse") {
        /// Greatest radius across, along the head.
        horizontal: f32, unit("cm"), range(0.05, 20.0);
        /// Greatest radius through, away from the head.
        vertical: f32, unit("cm"), range(0.05, 20.0);
        /// Opens the root: 0 starts in a point.
        alpha: f32 = 0.0, range(0.0, 10.0);
        /// Opens the tip: 0 ends in a point.
        beta: f32 = 0.0, range(0.0, 10.0);
    }
}

crate::params! {
    /// A tuft of stylised hair along a stroke.
    pub struct TuftOptions("coif.tuft") {
        /// Control points that the stroke runs through, the first on the head, in head space.
        stroke: Vec<Vec3>, takes("(Point|Head.point.fields)[]");
        /// Greatest diameter.
        diameter: f32 = 30.0, unit("mm"), range(1.0, 100.0);
        /// Where along the stroke the greatest diameter is.
        peak: f32 = 30.0, unit("%"), range(1.0, 100.0);
        /// An elliptic tuft instead of a round one; then `diameter` and `peak` do nothing.
        ellipse: Option<Ellipse>;
        /// Sizes along the stroke instead of a round tuft: { place 0 to 1, width, thickness } each, in cm.
        profile: Option<Vec<Vec3>>, takes("Point[]|fun(t: number): number, number?");
        /// 0 leaves the thickness as it is, towards 1 makes the tuft flat.
        flatten: f32 = 0.0, range(0.0, 0.95);
        /// Turn about the stroke from root to tip.
        twist: Angle = Angle::degrees(0.0), range(-3600.0, 3600.0);
        /// Bends the width into an arc of this angle, edges towards the head.
        bend: Angle = Angle::degrees(0.0), range(-330.0, 330.0);
        /// Number of tips.
        tips: u32 = 1, range(1.0, 8.0);
        /// How much of the stroke the tips are apart.
        split: f32 = 0.3, range(0.05, 0.9);
        /// How far the tips spread: 0 go side by side, 1 end twice as far apart.
        spread: f32 = 0.5, range(-0.9, 10.0);
        /// Where the thickness points; away from the head when left out.
        up: Option<Direction>;
        /// Keeps the stroke in the plane through its root with this normal.
        plane: Option<Direction>;
        /// How deep the start is buried in the head.
        depth: f32 = 1.0, unit("cm"), range(0.05, 10.0);
        /// Greatest distance of the mesh from the true surface.
        tolerance: f32 = 0.05, unit("cm"), range(0.001, 10.0);
        /// Number of rings along the stroke instead of `tolerance`; needs `sides`.
        rings: Option<u32>, range(1.0, 1000.0);
        /// Number of vertices around the tuft instead of `tolerance`; alone, rings stand at the control points.
        sides: Option<u32>, range(3.0, 400.0);
        /// Lets the tuft run through the head without a warning.
        bury: bool = false;
    }
}

impl TuftOptions {
    /// The section described.
    ///
    /// # Errors
    /// A profile together with an ellipse, or one that is out of order.
    pub fn section(&self) -> Result<Section, TuftError> {
        let profile = match (&self.ellipse, &self.profile) {
            (Some(_), Some(_)) => return Err(TuftError::Exclusive { first: "ellipse", second: "profile" }),
            (Some(e), None) => {
                Profile::Elliptic { horizontal: e.horizontal, vertical: e.vertical, alpha: e.alpha, beta: e.beta }
            }
            (None, Some(points)) => {
                Profile::Points(points.iter().map(|p| ProfilePoint { t: p.x, width: p.y, thickness: p.z }).collect())
            }
            // d of the paper, 1 to 100, counts millimetres; p is a percentage.
            (None, None) => {
                TuftError::check("diameter", self.diameter, 1.0, 100.0)?;
                TuftError::check("peak", self.peak, 1.0, 100.0)?;
                Profile::Round { diameter: self.diameter / 10.0, peak: self.peak / 100.0 }
            }
        };
        let split = (self.tips > 1).then_some(Split { tips: self.tips, from: 1.0 - self.split, spread: self.spread });
        let (twist, bend) = (self.twist.radians, self.bend.radians);
        let section = Section { profile, flatten: self.flatten, twist, bend, split };
        section.validate()?;
        Ok(section)
    }

    /// The detail described.
    ///
    /// # Errors
    /// Counts out of range, rings without sides.
    pub fn detail(&self) -> Result<Detail, TuftError> {
        let detail = match (self.rings, self.sides) {
            (Some(rings), Some(sides)) => Detail::Counts { rings, sides },
            (Some(_), None) => return Err(TuftError::RingsWithoutSides),
            (None, Some(sides)) => Detail::ControlPoints { sides },
            (None, None) => Detail::Tolerance(self.tolerance),
        };
        detail.validate()?;
        Ok(detail)
    }

    /// The tuft, its root on the head, with a warning when the stroke did not start there.
    ///
    /// # Errors
    /// Bad control points, sections or counts.
    pub fn build(&self, ground: &Ground) -> Result<Warned<Tuft>, TuftError> {
        let grounded = Stroke::grounded(self.stroke.clone(), self.depth, ground)?;
        let stroke = match self.plane {
            Some(Direction(normal)) => grounded.value.planar(normal)?,
            None => grounded.value,
        };
        let tuft = Tuft {
            up: self.up.map(|d| d.0),
            detail: self.detail()?,
            bury: self.bury,
            ..Tuft::new(stroke, self.section()?)?
        };
        Ok(Warned { value: tuft, warnings: grounded.warnings })
    }
}
