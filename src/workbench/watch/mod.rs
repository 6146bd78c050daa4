//! Watching: runs a script again whenever something changes that its last run asked for.
//!
//! [`Logic`] decides when, over signs of change and a clock, and knows no files; [`Witness`] notes what a run has read,
//! so that a save is judged by its content; `places` says where to listen, `listen` does; [`Watch`] ties them to a run
//! on a thread of its own.

mod content;
mod listen;
mod logic;
mod places;
mod session;

pub use content::{Fingerprint, Witness};
pub use logic::{Logic, QUIET, STARVE, Step};
pub use places::Places;
pub use session::{Ended, Notice, POLL, Stop, Watch, WatchOptions};
