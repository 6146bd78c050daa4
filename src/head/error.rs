//! Why something is no head.

use glam::Vec3;

use super::Landmarks;
use crate::geometry::SolidError;

/// Why a mesh could not be made a head, or a place on it not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HeadError {
    /// It has no inside.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// Stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] crate::task::Cancelled),
    /// Nothing in it has a head's shape.
    #[error("no head was found in the mesh")]
    NoHead,
    /// The nose is on the other side.
    #[error("the head looks to -Z")]
    Backwards,
    /// It is symmetric about the wrong plane.
    #[error("the face's direction is unclear: the head is not symmetric about a plane x = const")]
    Sideways,
    /// No surface where an ear should be.
    #[error("there is no surface on the {side} side of the head where an ear should be")]
    NoSide {
        /// "left" or "right".
        side: &'static str,
    },
    /// A landmark that does not exist.
    #[error("unknown landmark `{name}`")]
    UnknownLandmark {
        /// What was asked for.
        name: String,
        /// The nearest name, if any is near.
        nearest: Option<&'static str>,
    },
    /// A landmark's place is NaN or infinite.
    #[error("landmark `{name}` is not finite: `{place}`")]
    PlaceNotFinite {
        /// The landmark.
        name: String,
        /// Its place.
        place: Vec3,
    },
    /// The landmarks do not fit together.
    #[error("the landmarks cannot be a head's: {what}")]
    BadLandmarks {
        /// What is wrong, with values.
        what: String,
    },
    /// A box that does not exist.
    #[error("unknown box `{name}`")]
    UnknownBox {
        /// What was asked for.
        name: String,
        /// The nearest name, if any is near.
        nearest: Option<&'static str>,
    },
}

impl HeadError {
    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        let list = |names: &[&str]| format!("there are {}", names.join(", "));
        match self {
            Self::Solid(SolidError::NoVolume { .. }) => {
                Some("a head must be a surface with an inside; is it a single sheet, or only a face?".into())
            }
            Self::Solid(_) | Self::Cancelled(_) => None,
            Self::NoHead | Self::NoSide { .. } => {
                let names = Landmarks::NAMES.join(", ");
                Some(format!("it must stand upright (Y up) and look to +Z; or give all landmarks yourself: {names}"))
            }
            Self::Backwards => Some("turn it by 180 degrees about Y".into()),
            Self::Sideways => Some("turn it about Y until it looks to +Z, or give all landmarks yourself".into()),
            Self::UnknownLandmark { nearest: Some(near), .. } | Self::UnknownBox { nearest: Some(near), .. } => {
                Some(format!("did you mean `{near}`?"))
            }
            Self::UnknownLandmark { nearest: None, .. } => Some(list(&Landmarks::NAMES)),
            Self::UnknownBox { nearest: None, .. } => Some(list(&super::Head::BOXES)),
            Self::PlaceNotFinite { .. } => Some("give three finite numbers in cm".into()),
            Self::BadLandmarks { .. } => Some("place the landmarks in the head's own file space, in cm".into()),
        }
    }
}
