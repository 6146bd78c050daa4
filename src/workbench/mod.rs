//! The workbench: runs a script, makes its picture and files, and puts them in place.
//!
//! Everything is made in memory first, written beside its place and renamed into it: a reader never sees half a file,
//! and after an error the folder is as it was before.

mod budget;
mod figures;
mod output;
mod run;

pub use budget::{Budget, keep_within};
pub use figures::{PartFigures, figures};
pub use output::{Output, WriteError, Written, write_all};
pub use run::{Report, RunError, RunOptions, Stage, run};
