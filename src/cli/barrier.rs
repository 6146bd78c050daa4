//! Between the program and the process: threads, Ctrl-C, and errors of Coif itself.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

use rayon::ThreadPool;

use super::args::ScriptArguments;
use super::{CANCELLED, INTERNAL, say};
use crate::task::Task;

/// Where the last panic happened and what it said.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Stack of a worker: Luau recurses on it while parsing and calling.
const STACK: usize = 16 << 20;

/// Runs `work` on as many threads as were asked for, with a task that Ctrl-C cancels.
///
/// # Errors
/// An exit code, after having said why.
pub fn run<R: Send>(arguments: &ScriptArguments, work: impl FnOnce(&Task) -> R + Send) -> Result<R, u8> {
    on(arguments.threads, work)
}

/// The same on so many threads; all of the machine's when not given.
///
/// # Errors
/// An exit code, after having said why.
pub fn on<R: Send>(threads: Option<u16>, work: impl FnOnce(&Task) -> R + Send) -> Result<R, u8> {
    let task = Task::new();
    listen(&task);
    let pool = pool(threads)?;
    caught(|| pool.install(|| work(&task))).map_err(|message| {
        say(&format!("error: {message}\n"));
        INTERNAL
    })
}

/// As many threads as were asked for. From here on panics are kept for [`caught`] instead of being printed.
///
/// # Errors
/// An exit code, after having said why.
pub fn pool(threads: Option<u16>) -> Result<ThreadPool, u8> {
    std::panic::set_hook(Box::new(|info| {
        if let Ok(mut last) = PANIC.lock() {
            last.get_or_insert(info.to_string());
        }
    }));
    let threads = threads.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build().map_err(|e| {
        say(&format!("error: cannot start threads: {e}\n"));
        INTERNAL
    })
}

/// What `work` gives.
///
/// # Errors
/// A message to the user when it panics.
pub fn caught<R>(work: impl FnOnce() -> R) -> Result<R, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| {
        let what = PANIC.lock().ok().and_then(|mut p| p.take()).unwrap_or_default();
        format!(
            "this is an error in Coif {} itself, not in your script; please report it with the script\n{what}",
            env!("CARGO_PKG_VERSION")
        )
    })
}

/// Cancels the task on the first Ctrl-C; the second ends the process at once.
fn listen(task: &Task) {
    let task = task.clone();
    // Without a handler Ctrl-C simply ends the process, which leaves no half file either.
    let _ = ctrlc::set_handler(move || {
        if task.is_cancelled() {
            std::process::exit(i32::from(CANCELLED));
        }
        task.cancel();
    });
}
