//! What can be wrong with tufts.

use glam::Vec3;

use crate::task::Cancelled;

/// Why a tuft, a fill, a cap, a bun or a ring cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuftError {
    /// A stroke or a border with too few control points.
    #[error("{what} needs at least {least} control points, got {count}")]
    TooFewPoints {
        /// "a stroke", "a cap's border".
        what: &'static str,
        /// The fewest that make one.
        least: usize,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("control point {number} is not finite: `{point}`")]
    NotFinite {
        /// Counted from 1.
        number: usize,
        /// Its value.
        point: Vec3,
    },
    /// Two neighbouring control points coincide.
    #[error("control points {} and {number} are the same: `{point}`", number - 1)]
    RepeatedPoint {
        /// The second of the two, counted from 1.
        number: usize,
        /// Where both are.
        point: Vec3,
    },
    /// The stroke starts at the head's reference point, so nothing says which way is out.
    #[error("the stroke starts at the head's reference point `{point}`")]
    NoOutside {
        /// The point.
        point: Vec3,
    },
    /// A number outside its range.
    #[error("{what} is `{value}`, it takes {lo} to {hi}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f32,
        /// Least value allowed.
        lo: f32,
        /// Greatest value allowed.
        hi: f32,
    },
    /// A profile whose points do not run from root to tip.
    #[error("profile point {number} lies at `{t}`: places must rise from 0 to 1, with at least two points")]
    ProfileOrder {
        /// Counted from 1.
        number: usize,
        /// Its place along the stroke.
        t: f32,
    },
    /// A section that has no width anywhere.
    #[error("the section has no {what} anywhere along the stroke")]
    NoSize {
        /// "width" or "thickness".
        what: &'static str,
    },
    /// Options that exclude one another.
    #[error("`{first}` and `{second}` exclude one another")]
    Exclusive {
        /// One of them.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A number of rings without a number of sides.
    #[error("`rings` without `sides`")]
    RingsWithoutSides,
    /// Tufts to fill between with different numbers of control points.
    #[error("tuft {number} has {count} control points, the one before it {before}")]
    PointCounts {
        /// The later tuft, counted from 1.
        number: usize,
        /// Its number of control points.
        count: usize,
        /// That of the tuft before it.
        before: usize,
    },
    /// Tufts to fill between whose sections are of different kinds.
    #[error("tuft {number} has another kind of section (`{kind}`) than the one before it (`{before}`)")]
    SectionKinds {
        /// The later tuft, counted from 1.
        number: usize,
        /// Its kind of profile.
        kind: &'static str,
        /// The other's.
        before: &'static str,
    },
    /// Nothing to fill between.
    #[error("a fill needs at least one tuft")]
    NoTufts,
    /// Every root a fill would have made lies where no hair grows.
    #[error("none of {candidates} roots lies in the region where hair grows")]
    NoRoot {
        /// How many roots were tried.
        candidates: usize,
    },
    /// A triangle budget that not even the coarsest meshes meet.
    #[error("{budget} triangles are too few: the coarsest meshes need {least}")]
    Budget {
        /// The budget.
        budget: usize,
        /// What the coarsest meshes need.
        least: usize,
    },
    /// Stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl TuftError {
    /// `value`, if it lies within `lo..=hi`.
    pub(super) fn check(what: &'static str, value: f32, lo: f32, hi: f32) -> Result<f32, Self> {
        // Written so that NaN is refused too.
        if value >= lo && value <= hi { Ok(value) } else { Err(Self::OutOfRange { what, value, lo, hi }) }
    }
}
