//! When to compare, to run, to cancel: a state machine over signs of change and a clock.
//!
//! It knows no files and no threads. The shell tells it what happened and asks [`Logic::next`] what to do; time is a
//! [`Duration`] since the watch began, so that tests make their own.

use std::time::Duration;

/// Quiet time after the last sign of change before anything is read: longer than an editor takes between truncating,
/// writing and renaming (a few milliseconds), shorter than one notices.
pub const QUIET: Duration = Duration::from_millis(30);

/// Longest time that a barrage of changes can put off a run: a program that writes all the time (an export from
/// another tool, a synchronised folder) must not starve the picture.
pub const STARVE: Duration = Duration::from_millis(250);

/// What the shell has to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Nothing before this time; `None`: before something happens.
    Wait(Option<Duration>),
    /// Compare the touched files with what the run has read, then call [`Logic::compared`].
    Compare,
    /// Start a run.
    Start,
    /// Cancel the run; [`Logic::finished`] follows once it has ended.
    Cancel,
}

/// Signs of change that belong together.
#[derive(Clone, Copy, Debug)]
struct Burst {
    first: Duration,
    last: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Running,
    Cancelling,
}

/// The decisions of a watch.
#[derive(Debug)]
pub struct Logic {
    phase: Phase,
    /// Signs since the last run began or the last comparison found nothing.
    burst: Option<Burst>,
    /// A sign came that no comparison has looked at.
    is_unseen: bool,
    /// What the last run read is known to be out of date.
    is_outdated: bool,
}

impl Default for Logic {
    fn default() -> Self {
        Self::new()
    }
}

impl Logic {
    /// A watch that has not run yet: the first step is to start.
    pub fn new() -> Self {
        Self { phase: Phase::Idle, burst: None, is_unseen: false, is_outdated: true }
    }

    /// Something that the run depends on may have changed.
    pub fn touched(&mut self, now: Duration) {
        let first = self.burst.map_or(now, |b| b.first);
        self.burst = Some(Burst { first, last: now });
        self.is_unseen = true;
    }

    /// The answer to [`Step::Compare`].
    pub fn compared(&mut self, is_changed: bool) {
        self.is_unseen = false;
        self.is_outdated |= is_changed;
        if !self.is_outdated {
            self.burst = None;
        }
    }

    /// The run has ended, by itself or cancelled.
    pub fn finished(&mut self) {
        // A run that ends before its cancelling is noticed is out of date all the same.
        self.phase = Phase::Idle;
    }

    /// True between [`Step::Start`] and [`Logic::finished`].
    pub fn is_running(&self) -> bool {
        self.phase != Phase::Idle
    }

    /// What to do at the time `now`. `Start` and `Cancel` are taken as done.
    pub fn next(&mut self, now: Duration) -> Step {
        match self.phase {
            // A run in progress is compared at the first sign, without waiting for quiet: work on what is out of
            // date is cancelled at once, and only the new run waits for the editor to finish.
            Phase::Running if self.is_outdated => {
                self.phase = Phase::Cancelling;
                Step::Cancel
            }
            Phase::Running if self.is_unseen => Step::Compare,
            Phase::Running | Phase::Cancelling => Step::Wait(None),
            Phase::Idle => match self.burst {
                None if !self.is_outdated => Step::Wait(None),
                Some(Burst { first, last }) if now < (last + QUIET).min(first + STARVE) => {
                    Step::Wait(Some((last + QUIET).min(first + STARVE)))
                }
                Some(_) if !self.is_outdated => Step::Compare,
                Some(_) | None => {
                    *self = Self { phase: Phase::Running, burst: None, is_unseen: false, is_outdated: false };
                    Step::Start
                }
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A watch with a clock of its own. Files are a number; a run reads it when it starts.
    struct Play {
        logic: Logic,
        now: Duration,
        file: u32,
        read: u32,
        log: Vec<(u64, &'static str)>,
    }

    impl Play {
        fn new() -> Self {
            let mut play = Self { logic: Logic::new(), now: Duration::ZERO, file: 0, read: 0, log: vec![] };
            play.settle();
            play
        }

        /// A play whose first run is over.
        fn idle() -> Self {
            let mut play = Self::new();
            play.finish();
            play.log.clear();
            play
        }

        fn settle(&mut self) -> Step {
            loop {
                let at = self.now.as_millis() as u64;
                match self.logic.next(self.now) {
                    Step::Compare => {
                        self.log.push((at, "compare"));
                        self.logic.compared(self.file != self.read);
                    }
                    Step::Start => {
                        self.log.push((at, "start"));
                        self.read = self.file;
                    }
                    Step::Cancel => self.log.push((at, "cancel")),
                    wait @ Step::Wait(_) => return wait,
                }
            }
        }

        /// Lets time pass up to `ms`, doing what is due on the way.
        fn until(&mut self, ms: u64) {
            let end = Duration::from_millis(ms);
            while let Step::Wait(Some(due)) = self.settle() {
                if due > end {
                    break;
                }
                self.now = due;
            }
            self.now = end;
            self.settle();
        }

        fn save(&mut self, content: u32) {
            self.file = content;
            self.touch();
        }

        fn touch(&mut self) {
            self.logic.touched(self.now);
            self.settle();
        }

        fn finish(&mut self) {
            self.logic.finished();
            self.settle();
        }

        fn starts(&self) -> Vec<u64> {
            self.log.iter().filter(|l| l.1 == "start").map(|l| l.0).collect()
        }
    }

    #[test]
    fn the_first_run_does_not_wait() {
        assert_eq!(Play::new().log, [(0, "start")]);
    }

    #[test]
    fn a_save_runs_after_the_quiet_period() {
        let mut play = Play::idle();
        play.until(1000);
        play.save(1);
        play.until(1029);
        assert_eq!(play.log, []);
        play.until(2000);
        assert_eq!(play.log, [(1030, "compare"), (1030, "start")]);
        play.finish();
        play.until(9000);
        assert_eq!(play.starts(), [1030]);
    }

    #[test]
    fn a_burst_runs_once() {
        let mut play = Play::idle();
        for i in 0..1000 {
            play.save(i);
            play.until(1 + u64::from(i) / 10);
        }
        play.until(5000);
        // The last save came at 100 ms.
        assert_eq!(play.starts(), [130]);
    }

    #[test]
    fn a_barrage_does_not_starve_the_picture() {
        let mut play = Play::idle();
        for i in 1..=200 {
            play.until(i * 10);
            play.save(i as u32);
            // Each run takes no time at all.
            if play.logic.is_running() {
                play.finish();
            }
        }
        let starts = play.starts();
        assert_eq!(starts[0], 10 + 250);
        assert!(starts.windows(2).all(|w| w[1] - w[0] <= 250 + 10 + 30), "{starts:?}");
        assert!(starts.len() >= 6, "{starts:?}");
    }

    #[test]
    fn a_save_of_the_same_content_does_nothing() {
        let mut play = Play::idle();
        play.touch();
        play.until(1000);
        assert_eq!(play.log, [(30, "compare")]);
        // And leaves nothing behind that could shorten the next burst.
        play.save(1);
        play.until(2000);
        assert_eq!(play.starts(), [1030]);
    }

    #[test]
    fn a_save_during_a_run_cancels_at_once_and_runs_again_after_quiet() {
        let mut play = Play::new();
        play.until(500);
        play.save(1);
        assert_eq!(play.log[1..], [(500, "compare"), (500, "cancel")]);
        play.until(510);
        play.finish();
        play.until(1000);
        assert_eq!(play.starts(), [0, 530]);
    }

    #[test]
    fn a_run_that_ends_late_is_followed_at_once() {
        let mut play = Play::new();
        play.until(500);
        play.save(1);
        play.until(900);
        play.save(2);
        play.until(1500);
        play.finish();
        assert_eq!(play.starts(), [0, 1500]);
        assert_eq!(play.read, 2);
    }

    #[test]
    fn a_truncation_during_a_run_is_made_good_though_the_content_comes_back() {
        let mut play = Play::new();
        play.save(7);
        play.save(0);
        play.finish();
        play.until(100);
        assert_eq!(play.starts(), [0, 30], "the cancelled run left nothing, so there must be another");
    }

    #[test]
    fn the_same_content_during_a_run_cancels_nothing() {
        let mut play = Play::new();
        play.until(10);
        play.touch();
        play.until(500);
        play.finish();
        play.until(1000);
        assert!(play.log.iter().all(|l| l.1 != "cancel"), "{:?}", play.log);
        assert_eq!(play.starts(), [0]);
    }

    #[test]
    fn many_saves_during_a_run_cancel_it_once() {
        let mut play = Play::new();
        for i in 1..100 {
            play.until(i);
            play.save(i as u32);
        }
        assert_eq!(play.log.iter().filter(|l| l.1 == "cancel").count(), 1);
        play.finish();
        play.until(1000);
        assert_eq!(play.starts(), [0, 129]);
    }
}
