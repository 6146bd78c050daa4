//! What a long computation needs from outside: a way to be stopped, a way to tell how far it is, and a way to warn.
//!
//! The core knows no terminal: it polls [`Task::check`], reports through [`Task::progress`] and puts [`Warning`]s
//! beside its value.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The run was cancelled from outside (a new save, Ctrl-C, a time budget).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

type Progress = dyn Fn(&str, f32) + Send + Sync;
type Polled = dyn Fn() + Send + Sync;

/// A cancel flag and a progress listener, cheap to clone and to poll from many threads.
#[derive(Clone, Default)]
pub struct Task {
    cancel: Arc<AtomicBool>,
    parent: Option<Arc<Task>>,
    progress: Option<Arc<Progress>>,
    polled: Option<Arc<Polled>>,
}

impl Task {
    /// A task that nobody listens to; [`Task::cancel`] still works.
    pub fn new() -> Self {
        Self::default()
    }

    /// A part of this task: cancelled with it, but cancelling the part leaves the whole running.
    #[must_use]
    pub fn child(&self) -> Self {
        let progress = self.progress.clone();
        Self { cancel: Arc::default(), parent: Some(Arc::new(self.clone())), progress, polled: None }
    }

    /// The same task, reporting progress to `listener` as (what is done, fraction 0..=1).
    #[must_use]
    pub fn with_progress(mut self, listener: impl Fn(&str, f32) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(listener));
        self
    }

    /// The same task, calling `listener` whenever it is asked whether it was cancelled: a test counts by it how often a
    /// computation looks up.
    #[must_use]
    pub fn with_polls(mut self, listener: impl Fn() + Send + Sync + 'static) -> Self {
        self.polled = Some(Arc::new(listener));
        self
    }

    /// Asks every computation that holds this task to stop.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// True once [`Task::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        if let Some(polled) = &self.polled {
            polled();
        }
        self.cancel.load(Ordering::Relaxed) || self.parent.as_ref().is_some_and(|p| p.is_cancelled())
    }

    /// To be called every few thousand steps of a loop.
    ///
    /// # Errors
    /// [`Cancelled`] once the task was cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Tells the listener that `what` is `fraction` (0..=1) done.
    pub fn progress(&self, what: &str, fraction: f32) {
        if let Some(listener) = &self.progress {
            listener(what, fraction);
        }
    }
}

/// Something the user should know that did not stop the computation.
///
/// Style: lower case, no full stop, values in backticks; `hint` names what to change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What is odd.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Warning {
    /// A warning without a hint.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None }
    }

    /// The same warning with a hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// A value and the warnings met on the way to it.
#[derive(Clone, Debug)]
pub struct Warned<T> {
    /// The value.
    pub value: T,
    /// In the order they were met.
    pub warnings: Vec<Warning>,
}

impl<T> Warned<T> {
    /// A value without warnings.
    pub fn clean(value: T) -> Self {
        Self { value, warnings: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelling_goes_down_and_not_up() {
        let whole = Task::new();
        let (part, other) = (whole.child(), whole.child());
        let deep = part.child();
        part.cancel();
        assert!(part.is_cancelled() && deep.is_cancelled());
        assert!(!whole.is_cancelled() && !other.is_cancelled());
        whole.cancel();
        assert!(other.check().is_err());
    }
}
