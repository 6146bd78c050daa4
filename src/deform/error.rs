//! What can be wrong with a deformation.

use glam::Vec3;

use crate::task::Cancelled;

/// Why points could not be moved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// The run was stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A number is NaN or infinite.
    #[error("{what} is not finite: `{value}`")]
    NotFinite {
        /// What it is of.
        what: String,
        /// Its value.
        value: Vec3,
    },
    /// A number lies outside what it may be.
    #[error("{what} is `{value}`, but takes {low} to {high}")]
    OutOfRange {
        /// What it is of.
        what: String,
        /// The number.
        value: f64,
        /// The least allowed.
        low: f64,
        /// The greatest allowed.
        high: f64,
    },
    /// The edges of a lattice lie in a plane.
    #[error("the lattice is flat: its edges {s}, {t} and {u} enclose no volume")]
    Flat {
        /// First edge, cm.
        s: Vec3,
        /// Second edge, cm.
        t: Vec3,
        /// Third edge, cm.
        u: Vec3,
    },
    /// The edges of a lattice are left-handed.
    #[error("the lattice is inside out: its edges {s}, {t} and {u} are left-handed")]
    Inverted {
        /// First edge, cm.
        s: Vec3,
        /// Second edge, cm.
        t: Vec3,
        /// Third edge, cm.
        u: Vec3,
    },
    /// An index names no control point.
    #[error("there is no control point `{index}` along {axis}: they go from 0 to {last}")]
    NoControlPoint {
        /// `i`, `j` or `k`.
        axis: char,
        /// The index.
        index: i64,
        /// The last one.
        last: usize,
    },
    /// A group of control points, or a point, that nobody named.
    #[error("there is no {what} `{name}`")]
    Unknown {
        /// "group", "point".
        what: &'static str,
        /// The name asked for.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// Every control point that a move speaks of is fixed.
    #[error("all {count} control points of this move are fixed")]
    AllFixed {
        /// How many there are.
        count: usize,
    },
    /// There is nothing of what is needed.
    #[error("there are no {what}")]
    Nothing {
        /// "fixed points".
        what: &'static str,
    },
    /// Two control points stand at one place.
    #[error("{first} and {second} stand at the same place `{place}`")]
    SamePlace {
        /// "point 1", a name.
        first: String,
        /// "point 2", a name.
        second: String,
        /// Where.
        place: Vec3,
    },
    /// An operated point would land on a fixed one: all space around that would shrink to a point.
    #[error("{operated} would land on {fixed}")]
    OntoFixed {
        /// The operated point.
        operated: String,
        /// The fixed point.
        fixed: String,
    },
    /// Scattered control points that do not fill space.
    #[error("the {count} points lie in a plane, on a line or too close together")]
    Degenerate {
        /// How many there are.
        count: usize,
    },
    /// Scattered control points that leave a side of their middle open.
    #[error("the control points do not lie around their middle `{middle}`")]
    NotAround {
        /// Their middle, cm.
        middle: Vec3,
    },
    /// A control point in the middle of the others.
    #[error("{which} lies in the middle of all of them, at `{place}`")]
    InTheMiddle {
        /// "control point 3", a name.
        which: String,
        /// Where, cm.
        place: Vec3,
    },
    /// Two control points in one direction from the middle.
    #[error("{first} and {second} lie in the same direction from the middle `{middle}`")]
    SameDirection {
        /// "control point 1", a name.
        first: String,
        /// "control point 2", a name.
        second: String,
        /// The middle, cm.
        middle: Vec3,
    },
    /// Two control points with one name.
    #[error("{first} and {second} are both called `{name}`")]
    SameName {
        /// "point 1".
        first: String,
        /// "point 2".
        second: String,
        /// The name.
        name: String,
    },
    /// A cage that is no closed surface.
    #[error("the cage is not closed: its edge from {from} to {to} borders {count} triangles, not two")]
    Open {
        /// One end of the edge, cm.
        from: Vec3,
        /// The other end, cm.
        to: Vec3,
        /// How many triangles there are.
        count: usize,
    },
    /// Neighbouring triangles of a cage that face different ways.
    #[error("the triangles of the cage on both sides of the edge from {from} to {to} face different ways")]
    WrongWay {
        /// One end of the edge, cm.
        from: Vec3,
        /// The other end, cm.
        to: Vec3,
    },
    /// A triangle of a cage that has no area.
    #[error("the cage has a triangle without an area, from {a} to {b} and {c}")]
    NoArea {
        /// A corner, cm.
        a: Vec3,
        /// A corner, cm.
        b: Vec3,
        /// A corner, cm.
        c: Vec3,
    },
    /// No surface at the height of a tape.
    #[error("there is nothing to measure at the height `{height:.2}` cm: it goes from {low:.2} to {high:.2} cm")]
    NoCut {
        /// Where it was tried, cm.
        height: f32,
        /// Lowest point, cm.
        low: f32,
        /// Highest point, cm.
        high: f32,
    },
    /// Two outlines beside each other, as of legs, and no word which one.
    #[error("two outlines lie side by side at the height of `{tape}`")]
    Sides {
        /// The tape.
        tape: String,
    },
    /// A girth that no admissible motion of the control points gives.
    #[error(
        "a girth of `{wanted:.1}` cm is out of reach for `{tape}`: it is {now:.1} cm and can become {low:.1} to {high:.1} cm"
    )]
    OutOfReach {
        /// The tape.
        tape: String,
        /// What was asked for, cm.
        wanted: f32,
        /// What it is before, cm.
        now: f32,
        /// The least that can be, cm.
        low: f32,
        /// The most that can be, cm.
        high: f32,
    },
    /// Girths that pull against each other.
    #[error("the girths pull against each other: `{tape}` stays {off:.2} cm away from {wanted:.1} cm")]
    Contradiction {
        /// The tape that is farthest off.
        tape: String,
        /// What was asked for, cm.
        wanted: f32,
        /// By how much, cm.
        off: f32,
    },
}

impl DeformError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Flat { .. } => Some("give it three edges that do not lie in one plane".into()),
            Self::Inverted { .. } => Some("exchange two of the edges".into()),
            Self::Unknown { name, known, .. } => match crate::params::nearest(name, known.iter().map(String::as_str)) {
                Some(near) => Some(format!("did you mean `{near}`?")),
                None if known.is_empty() => Some("none has a name yet".into()),
                None => Some(format!("there are {}", known.join(", "))),
            },
            Self::AllFixed { .. } => Some("mark some of them `feature` or `overall` before".into()),
            Self::Nothing { what: "fixed points" } => {
                Some("give a point without a target: `{ at = { 0, 0, 0 } }` stays where it is".into())
            }
            Self::SamePlace { .. } => Some("leave one of them out, or move it".into()),
            Self::OntoFixed { .. } => Some("choose another target, or do not fix that point".into()),
            Self::Degenerate { .. } => Some("give four points or more that enclose space".into()),
            Self::OutOfRange { what, value, high, .. } if what == "the number of control points" => {
                Some(if value > high {
                    "a cage is coarse: give fewer points, or a simpler mesh".into()
                } else {
                    "give some on every side".into()
                })
            }
            Self::NotAround { .. } => {
                Some("give some on every side: left, right, above, below, in front, behind".into())
            }
            Self::InTheMiddle { .. } => {
                Some("a cage goes around what it moves: move the point outwards, or use `coif.pins`".into())
            }
            Self::SameDirection { .. } => Some("leave one of them out, or move it sideways".into()),
            Self::SameName { .. } => Some("give each its own name".into()),
            Self::Open { count: 1, .. } => Some("close the hole there, in the program that the mesh is from".into()),
            Self::Open { .. } => Some("a cage is one surface: take away what meets there beside it".into()),
            Self::WrongWay { .. } => Some("turn all faces outwards, in the program that the mesh is from".into()),
            Self::NoArea { .. } => Some("take it away, in the program that the mesh is from".into()),
            Self::OutOfReach { .. } => {
                Some("choose a girth between these, let go of held points, or widen the band with `reach`".into())
            }
            Self::Sides { .. } => Some("say which: `side = \"left\"` or `side = \"right\"`".into()),
            Self::Contradiction { .. } => Some("fit fewer tapes at once, or set tapes farther apart".into()),
            _ => None,
        }
    }
}
