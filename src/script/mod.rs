//! The Lua host: runs a hairstyle script in a sandbox and gives its scene.
//!
//! Scripts run on Luau, each in a fresh VM without files, clock or processes. Every function that a script can call is
//! an entry of the [`registry`]; bindings ([`bind`](self)) see plain data and the core, hardly any Lua. Whatever goes
//! wrong becomes [`Diagnostic`]s with place, mark, trace and hint.

pub mod api;
mod bind;
mod call;
mod convert;
mod diagnostic;
mod files;
mod host;
mod lexer;
pub mod limits;
mod memo;
mod module;
mod object;
mod protect;
pub mod registry;
mod sandbox;
mod session;
mod show;
mod source;
mod strict;
mod testing;
mod trace;

#[cfg(test)]
mod tests;

pub use bind::Parameter;
pub use diagnostic::{Diagnostic, Frame, Place, Severity};
pub use files::{Access, AccessError, Disk, Files, Memory};
pub use host::{Ending, Options, Outcome, SetBy, run};
pub use limits::Limits;
pub use memo::{Kept, Memo, Origin};
pub use session::{Rest, Thinned, Timing};
pub use show::{show, show_all};
pub use source::Sources;
pub use testing::{Declared, Preview, TestOutcome, run_test};
