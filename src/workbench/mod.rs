//! The workbench: runs a script, makes its picture and files, and puts them in place.
//!
//! Everything is made in memory first, written beside its place and renamed into it: a reader never sees half a file,
//! and after an error the folder is as it was before.

mod budget;
pub mod diff;
pub mod draft;
mod figures;
mod film;
mod keep;
mod new;
mod output;
mod run;
pub mod sheet;
pub mod terminal;
pub mod test;
pub mod variations;
pub mod watch;

pub use budget::{Budget, keep_within};
pub use figures::{PartFigures, figures};
pub use film::Films;
pub use new::{DEFINITIONS, NewError, api, new};
pub use output::{Output, Unwritten, WriteError, Written, write_all, write_until};
pub use run::{Report, RunError, RunOptions, Stage, exports, preview, run};
