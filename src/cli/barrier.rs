//! Between the program and the process: threads, Ctrl-C, and errors of Coif itself.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

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
    std::panic::set_hook(Box::new(|info| {
        if let Ok(mut last) = PANIC.lock() {
            last.get_or_insert(info.to_string());
        }
    }));
    let threads = threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    let pool = pool.map_err(|e| {
        say(&format!("error: cannot start threads: {e}\n"));
        INTERNAL
    })?;
    catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&task)))).map_err(|_| {
        let what = PANIC.lock().ok().and_then(|mut p| p.take()).unwrap_or_default();
        say(&format!(
            "error: this is an error in Coif {} itself, not in your script; please report it with the script\n{what}\n",
            env!("CARGO_PKG_VERSION")
        ));
        INTERNAL
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
