//! Easing: how speed changes on the way from one place to the next.

crate::choices! {
    /// How a motion goes from one place, pose or state to the next.
    pub enum Ease {
        /// Starts and ends softly.
        Smooth = "smooth",
        /// At one speed.
        Linear = "linear",
        /// Starts softly.
        In = "in",
        /// Ends softly.
        Out = "out",
        /// Stays, and jumps at the end.
        Hold = "hold",
    }
}

impl Ease {
    /// How much of the way is done when the part `t` (0 to 1) of the time is over.
    pub fn at(self, t: f32) -> f32 {
        match self {
            Self::Smooth => t * t * (3.0 - 2.0 * t),
            Self::Linear => t,
            Self::In => t * t,
            Self::Out => t * (2.0 - t),
            Self::Hold => {
                if t < 1.0 {
                    0.0
                } else {
                    1.0
                }
            }
        }
    }
}
