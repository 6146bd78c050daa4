//! The shell around the logic: threads, events, and the run itself.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Scope;
use std::time::{Duration, Instant};

use super::content::Witness;
use super::listen::{Ears, Heard};
use super::logic::{Logic, Step};
use super::places::Places;
use crate::script::Files;
use crate::task::Task;

/// Time between two looks where the file system gives no events: an edit is seen in a quarter of a second on average,
/// and reading a few scripts that often costs nothing.
pub const POLL: Duration = Duration::from_millis(400);

/// What a watch is to do.
#[derive(Clone, Debug, Default)]
pub struct WatchOptions {
    /// Look regularly instead of listening for events.
    pub poll: bool,
    /// Files that the runs write: never a reason to run again.
    pub outputs: BTreeSet<PathBuf>,
}

/// What a watch has to tell. `E` is what a run tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice<E> {
    /// A run begins.
    Started {
        /// Its number, from 1.
        run: u64,
        /// What changed since the last one; empty for the first.
        changed: BTreeSet<PathBuf>,
    },
    /// From the run.
    Told(E),
    /// The run was cancelled because of a save; another follows.
    Cancelled {
        /// Its number.
        run: u64,
    },
    /// The run broke down, which it should never do.
    Broken {
        /// Its number.
        run: u64,
    },
    /// There are no events; the files are looked at regularly from now on.
    Polling {
        /// What the system says.
        reason: String,
    },
}

/// How a run ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ended {
    /// Every file that it asked for, missing ones too.
    pub depends: BTreeSet<PathBuf>,
    /// True when it was cancelled before it had told everything.
    pub is_cut_short: bool,
}

enum Message<E> {
    Heard(Heard),
    /// The run reads a file for the first time.
    Asked(PathBuf),
    Told(E),
    /// The run has ended, or has broken down.
    Finished(Option<Ended>),
    Stop,
}

/// Runs again whenever a file changes that the last run asked for.
pub struct Watch<E> {
    sender: Sender<Message<E>>,
    receiver: Receiver<Message<E>>,
    options: WatchOptions,
}

/// Ends a watch from another thread.
pub struct Stop<E>(Sender<Message<E>>);

impl<E> Stop<E> {
    /// Cancels the run and ends the watch.
    pub fn stop(&self) {
        let _ = self.0.send(Message::Stop);
    }
}

/// The run in progress.
struct Current {
    number: u64,
    task: Task,
}

impl<E: Send + 'static> Watch<E> {
    /// A watch that has not begun.
    pub fn new(options: WatchOptions) -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver, options }
    }

    /// The way to end it.
    pub fn stop(&self) -> Stop<E> {
        Stop(self.sender.clone())
    }

    /// Runs at once and after every change, until it is stopped.
    ///
    /// `run` gets a task that is cancelled when its work is out of date, the files to read from, and a way to tell
    /// something before it has ended. `notice` is called on this thread.
    pub fn watch<R>(self, files: &Arc<dyn Files>, run: R, mut notice: impl FnMut(Notice<E>))
    where
        R: Fn(&Task, Arc<dyn Files>, &(dyn Fn(E) + Sync)) -> Ended + Sync,
    {
        let heard = self.sender.clone();
        let ears = if self.options.poll {
            None
        } else {
            Ears::new(move |h| {
                let _ = heard.send(Message::Heard(h));
            })
            .map_err(|e| notice(Notice::Polling { reason: e.to_string() }))
            .ok()
        };
        let mut state = State {
            ears,
            outputs: self.options.outputs,
            depends: BTreeSet::new(),
            places: Places::default(),
            touched: BTreeSet::new(),
            changed: BTreeSet::new(),
            witness: Arc::new(Witness::new(Arc::clone(files), |_| {})),
            current: None,
            runs: 0,
            is_stopped: false,
            is_displaced: false,
            logic: Logic::new(),
            began: Instant::now(),
            looked: Instant::now(),
        };
        std::thread::scope(|scope| {
            while !(state.is_stopped && state.current.is_none()) {
                match state.next() {
                    Step::Start => {
                        notice(Notice::Started { run: state.runs + 1, changed: std::mem::take(&mut state.changed) });
                        state.start(scope, files, &self.sender, &run);
                    }
                    Step::Cancel => {
                        if let Some(current) = &state.current {
                            current.task.cancel();
                        }
                    }
                    Step::Compare => state.compare(),
                    Step::Wait(until) => state.wait(until, &self.receiver, &mut notice),
                }
            }
        });
    }
}

struct State {
    ears: Option<Ears>,
    outputs: BTreeSet<PathBuf>,
    /// What the last run asked for, and what the run in progress has asked for so far.
    depends: BTreeSet<PathBuf>,
    places: Places,
    /// Dependencies that a sign of change was about.
    touched: BTreeSet<PathBuf>,
    /// Dependencies that have changed since the last run began.
    changed: BTreeSet<PathBuf>,
    /// What the last run has read.
    witness: Arc<Witness>,
    current: Option<Current>,
    runs: u64,
    is_stopped: bool,
    /// The places have to be found anew.
    is_displaced: bool,
    logic: Logic,
    began: Instant,
    looked: Instant,
}

impl State {
    fn now(&self) -> Duration {
        self.began.elapsed()
    }

    fn next(&mut self) -> Step {
        if self.is_stopped { Step::Wait(None) } else { self.logic.next(self.began.elapsed()) }
    }

    fn start<'s, E: Send + 'static, R>(
        &mut self,
        scope: &'s Scope<'s, '_>,
        files: &Arc<dyn Files>,
        sender: &Sender<Message<E>>,
        run: &'s R,
    ) where
        R: Fn(&Task, Arc<dyn Files>, &(dyn Fn(E) + Sync)) -> Ended + Sync,
    {
        self.runs += 1;
        self.touched.clear();
        let asked = sender.clone();
        let witness = Arc::new(Witness::new(Arc::clone(files), move |path: &Path| {
            let _ = asked.send(Message::Asked(path.to_path_buf()));
        }));
        self.witness = Arc::clone(&witness);
        let task = Task::new();
        self.current = Some(Current { number: self.runs, task: task.clone() });
        let sender = sender.clone();
        scope.spawn(move || {
            let tell = |what: E| {
                let _ = sender.send(Message::Told(what));
            };
            let files: Arc<dyn Files> = witness.clone();
            let ended = catch_unwind(AssertUnwindSafe(|| run(&task, files, &tell))).ok();
            if let Some(ended) = &ended {
                witness.complete(&ended.depends);
            }
            let _ = sender.send(Message::Finished(ended));
        });
    }

    fn compare(&mut self) {
        let changed = self.witness.changed(&self.touched);
        self.touched.clear();
        self.logic.compared(!changed.is_empty());
        self.changed.extend(changed);
    }

    fn wait<E>(
        &mut self,
        until: Option<Duration>,
        receiver: &Receiver<Message<E>>,
        notice: &mut impl FnMut(Notice<E>),
    ) {
        let mut left = until.map(|u| u.saturating_sub(self.now()));
        if self.ears.is_none() {
            let look = POLL.saturating_sub(self.looked.elapsed());
            left = Some(left.map_or(look, |l| l.min(look)));
        }
        let first = match left {
            Some(left) => receiver.recv_timeout(left),
            // This thread holds a sender itself, so that there is always someone to wait for.
            None => receiver.recv().map_err(|_| RecvTimeoutError::Disconnected),
        };
        let mut message = first.ok();
        while let Some(m) = message {
            self.handle(m, notice);
            message = receiver.try_recv().ok();
        }
        if self.is_displaced {
            self.find_places(notice);
        }
        if self.ears.is_none() && self.looked.elapsed() >= POLL {
            self.looked = Instant::now();
            let changed = self.witness.changed(&self.depends);
            self.touch(changed);
        }
    }

    fn handle<E>(&mut self, message: Message<E>, notice: &mut impl FnMut(Notice<E>)) {
        match message {
            Message::Heard(Heard::Anything) => {
                self.is_displaced = true;
                self.touch(self.depends.clone());
            }
            Message::Heard(Heard::Paths(paths)) => {
                for path in paths {
                    if let Some(concerned) = self.places.concerned(&path) {
                        self.touch(concerned.clone());
                        // A folder or a link: the way to the file may be another now.
                        if !self.depends.contains(&path) || path.is_symlink() || !path.exists() {
                            self.is_displaced = true;
                        }
                    }
                    if let Some(ears) = self.ears.as_mut()
                        && self.places.folders.contains(&path)
                    {
                        ears.forget(&path);
                        self.is_displaced = true;
                    }
                }
            }
            Message::Asked(path) => {
                // It may have been saved since it was read, and the sign of that was about a path not yet known.
                if !self.own().contains(&location(&path)) && self.depends.insert(path.clone()) {
                    self.is_displaced = true;
                    self.touch(BTreeSet::from([path]));
                }
            }
            Message::Told(what) => {
                if !self.is_stopped {
                    notice(Notice::Told(what));
                }
            }
            Message::Finished(ended) => {
                let Some(current) = self.current.take() else { return };
                match ended {
                    None => notice(Notice::Broken { run: current.number }),
                    // It has not asked for everything yet.
                    Some(ended) if ended.is_cut_short => {
                        self.depends.extend(ended.depends);
                        if !self.is_stopped {
                            notice(Notice::Cancelled { run: current.number });
                        }
                    }
                    Some(ended) => self.depends = ended.depends,
                }
                self.is_displaced = true;
                self.logic.finished();
            }
            Message::Stop => {
                self.is_stopped = true;
                if let Some(current) = &self.current {
                    current.task.cancel();
                }
            }
        }
    }

    fn touch(&mut self, paths: BTreeSet<PathBuf>) {
        if !paths.is_empty() {
            self.touched.extend(paths);
            self.logic.touched(self.now());
        }
    }

    /// Where the runs write.
    fn own(&self) -> BTreeSet<PathBuf> {
        self.outputs.iter().map(|o| location(o)).collect()
    }

    /// Finds out where to listen and listens there.
    fn find_places<E>(&mut self, notice: &mut impl FnMut(Notice<E>)) {
        self.is_displaced = false;
        let own = self.own();
        self.depends.retain(|d| !own.contains(&location(d)));
        self.places = Places::of(&self.depends);
        let Some(ears) = self.ears.as_mut() else { return };
        match ears.listen(&self.places.folders) {
            // Between the reading and the listening nobody heard anything.
            Ok(true) => self.touch(self.depends.clone()),
            Ok(false) => {}
            Err(e) => {
                notice(Notice::Polling { reason: e.to_string() });
                self.ears = None;
            }
        }
    }
}

/// Where a file is or would be, free of symbolic links.
fn location(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        match (absolute.parent().and_then(|p| p.canonicalize().ok()), absolute.file_name()) {
            (Some(folder), Some(name)) => folder.join(name),
            _ => absolute,
        }
    })
}
