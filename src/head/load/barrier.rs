//! A last barrier around the readers of foreign files.
//!
//! Everything that is known to make a reader panic is refused beforehand, with its place. Should something get
//! through all the same, the user gets an error and not a trace.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use super::LoadError;

thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a reader; a panic in it becomes [`LoadError::Reader`] and prints nothing.
pub(super) fn guarded<T>(format: &'static str, read: impl FnOnce() -> Result<T, LoadError>) -> Result<T, LoadError> {
    static HOOK: Once = Once::new();
    // The hook belongs to the whole process: ours passes on every panic but those of a thread that is in here.
    HOOK.call_once(|| {
        let outer = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_QUIET.get() {
                outer(info);
            }
        }));
    });
    let was_quiet = IS_QUIET.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(read));
    IS_QUIET.set(was_quiet);
    result.unwrap_or_else(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("it broke");
        Err(LoadError::Reader { format, problem: said.lines().next().unwrap_or_default().to_owned() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error() {
        let result = guarded::<()>("glTF", || panic!("index out of bounds: {}", 7));
        assert_eq!(result.unwrap_err().to_string(), "the glTF reader gave up: index out of bounds: 7");
        assert!(!IS_QUIET.get());
        assert_eq!(guarded("glTF", || Ok(3)), Ok(3));
    }
}
