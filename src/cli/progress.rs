//! A progress bar for what takes longer than half a second.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::task::Task;

/// Nobody needs a bar for what is done before one has read it.
const PATIENCE: Duration = Duration::from_millis(500);

/// Steps of a whole bar.
const STEPS: f32 = 1000.0;

/// Bars on standard error, if that is a terminal; nothing otherwise.
pub struct Progress {
    is_on: bool,
    state: Mutex<State>,
}

struct State {
    began: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// No bar yet; with `is_on` false there never will be one.
    pub fn new(is_on: bool) -> Self {
        let state = State { began: Instant::now(), bar: None };
        Self { is_on: is_on && std::io::stderr().is_terminal(), state: Mutex::new(state) }
    }

    /// Begins to count the time.
    pub fn begin(&self) {
        self.end();
        if let Ok(mut state) = self.state.lock() {
            state.began = Instant::now();
        }
    }

    /// The same task, telling its progress here.
    pub fn listen(self: &std::sync::Arc<Self>, task: &Task) -> Task {
        if !self.is_on {
            return task.clone();
        }
        let progress = std::sync::Arc::clone(self);
        task.clone().with_progress(move |what, fraction| progress.at(what, fraction))
    }

    /// Takes the bar off the terminal.
    pub fn end(&self) {
        let bar = self.state.lock().ok().and_then(|mut s| s.bar.take());
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
    }

    fn at(&self, what: &str, fraction: f32) {
        // Whoever computes does not wait for whoever draws.
        let Ok(mut state) = self.state.try_lock() else { return };
        if state.began.elapsed() < PATIENCE {
            return;
        }
        let bar = state.bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{msg:>14} {bar:40} {percent:>3} %") {
                bar.set_style(style);
            }
            bar
        });
        if bar.message() != what {
            bar.set_message(what.to_owned());
        }
        bar.set_position((fraction.clamp(0.0, 1.0) * STEPS) as u64);
    }
}
