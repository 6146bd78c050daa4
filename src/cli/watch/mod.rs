//! `coif watch`: runs, shows, waits.

mod board;
mod events;

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::ThreadPool;
use serde_json::Value;

use super::args::WatchArguments;
use super::progress::Progress;
use super::{CANCELLED, barrier, is_styled, print, run_options, say, show, text};
use crate::script::{Disk, Files, show_all};
use crate::task::Task;
use crate::workbench::terminal::Protocol;
use crate::workbench::watch::{Ended, Notice, Watch, WatchOptions};
use crate::workbench::{self, Report, RunError, RunOptions, draft};

use board::Board;

/// What a run tells while it goes on.
enum Told {
    /// A draft of the picture is in place.
    Draft(Shown),
    /// The picture is in place.
    Picture(Shown),
    /// The other files are in place too.
    Exported(Shown),
    /// There is an error; what was in place stays.
    Failed(Shown),
}

/// Something to print.
#[derive(Default)]
struct Shown {
    /// Counts, times, files.
    summary: String,
    /// What the script printed, errors and warnings.
    notes: String,
    /// Bytes that draw the picture.
    picture: Vec<u8>,
    /// The picture.
    file: Option<Box<Path>>,
    /// The same for programs, without the number of the run.
    event: Value,
}

/// Watches until Ctrl-C.
pub fn watch(arguments: &WatchArguments) -> u8 {
    // Strands are smooth at one sample too; what is kept is drawn by `coif run`.
    let options = run_options(&arguments.run, 1);
    let pool = match barrier::pool(arguments.run.script.threads) {
        Ok(pool) => pool,
        Err(code) => return code,
    };
    let name = options.script.name();
    let endings = ["png", "debug.png", "strip.png", "anim.png", "turntable.png", "glb", "guides.glb", "usda", "hair"];
    let outputs = endings.map(|e| options.out.join(format!("{name}.{e}")));
    let watch = Watch::new(WatchOptions { poll: arguments.poll, outputs: outputs.into_iter().collect() });
    let stop = watch.stop();
    let is_stopping = AtomicBool::new(false);
    let _ = ctrlc::set_handler(move || {
        if is_stopping.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(CANCELLED));
        }
        stop.stop();
    });
    let progress = Arc::new(Progress::new(!arguments.json && !arguments.run.quiet));
    let runner = Runner {
        options: &options,
        pool: &pool,
        progress: Arc::clone(&progress),
        protocol: arguments.run.show.filter(|_| !arguments.json).and_then(show::Show::protocol),
        timings: arguments.run.timings,
        members: (!arguments.no_draft).then_some(draft::MEMBERS),
    };
    let mut out = Out {
        board: Board::new(&options.script.script, arguments.run.show.is_none() && show::is_capable()),
        progress: Arc::clone(&progress),
        is_json: arguments.json,
        is_terminal: std::io::stderr().is_terminal(),
        protocol: runner.protocol,
    };
    out.begin(arguments.poll);
    let files: Arc<dyn Files> = Arc::new(Disk);
    watch.watch(&files, |task, files, tell| runner.run(task, files, tell), |notice| out.notice(notice));
    out.end();
    CANCELLED
}

/// Runs once, on the threads of the pool.
struct Runner<'a> {
    options: &'a RunOptions,
    pool: &'a ThreadPool,
    progress: Arc<Progress>,
    protocol: Option<Protocol>,
    timings: bool,
    /// Members of a fill in a draft; none for no draft.
    members: Option<usize>,
}

impl Runner<'_> {
    fn run(&self, task: &Task, files: Arc<dyn Files>, tell: &(dyn Fn(Told) + Sync)) -> Ended {
        let task = self.progress.listen(task);
        self.progress.begin();
        let done = barrier::caught(|| self.pool.install(|| self.halves(&task, files, tell)));
        self.progress.end();
        let mut ended = done.unwrap_or_else(|message| {
            tell(Told::Failed(Shown::message(message)));
            Ended::default()
        });
        // Whatever happened, a save of the script is worth another try.
        ended.depends.insert(self.options.script.script.clone());
        ended
    }

    /// The picture first, perhaps after a draft, then the rest.
    fn halves(&self, task: &Task, files: Arc<dyn Files>, tell: &(dyn Fn(Told) + Sync)) -> Ended {
        let mut report = match self.members {
            None => workbench::preview(self.options, files, task),
            Some(members) => draft::preview_drafted(self.options, members, files, task, |sketch| {
                if let Ok(shown) = self.shown(sketch, "draft") {
                    tell(Told::Draft(shown));
                    self.progress.begin();
                }
            }),
        };
        let depends = report.outcome.dependencies.clone();
        let is_cut_short = match self.shown(&report, "finished") {
            Ok(shown) => {
                tell(Told::Picture(shown));
                self.progress.begin();
                report.figures.clear();
                workbench::exports(self.options, &mut report, task);
                match self.shown(&report, "exported") {
                    Ok(shown) => tell(Told::Exported(shown)),
                    Err(Some(failed)) => tell(Told::Failed(failed)),
                    Err(None) => return Ended { depends, is_cut_short: true },
                }
                false
            }
            Err(Some(failed)) => {
                tell(Told::Failed(failed));
                false
            }
            Err(None) => true,
        };
        Ended { depends, is_cut_short }
    }

    /// What a half of a run has to tell; nothing when it was cancelled.
    fn shown(&self, report: &Report, event: &'static str) -> Result<Shown, Option<Shown>> {
        let outcome = &report.outcome;
        let mut notes: String = outcome.log.iter().map(|line| format!("{line}\n")).collect();
        notes += &show_all(&outcome.diagnostics, &outcome.sources, is_styled());
        if event == "draft" {
            // The whole run says all of this again, of all of the hair.
            notes.clear();
        }
        match &report.written {
            Ok(written) => {
                let summary = text::summary(report, written, self.timings && event == "finished");
                let file: Option<Box<Path>> = show::first(written).filter(|_| event != "exported").map(Into::into);
                let picture = self.picture(file.as_deref(), &summary, &notes);
                Ok(Shown { summary, notes, picture, file, event: events::good(event, report, written) })
            }
            Err(RunError::Cancelled) => Err(None),
            Err(RunError::Script) => Err(Some(Shown { notes, event: events::bad(outcome), ..Shown::default() })),
            Err(
                error @ (RunError::Render(_)
                | RunError::Png(_)
                | RunError::Export(_)
                | RunError::Budget(_)
                | RunError::Write(_)),
            ) => Err(Some(Shown::message(error.to_string()))),
        }
    }

    fn picture(&self, file: Option<&Path>, summary: &str, notes: &str) -> Vec<u8> {
        let Some((protocol, file)) = self.protocol.zip(file) else { return vec![] };
        show::picture(file, protocol, show::lines(summary) + show::lines(notes) + board::LINES)
    }
}

impl Shown {
    /// An error that is not about a place in the script.
    fn message(message: String) -> Self {
        let notes = format!("error: {message}\n");
        Self { notes, event: events::message(&message), ..Self::default() }
    }
}

/// Prints what there is to tell: one block on a terminal, lines elsewhere, objects for programs.
struct Out {
    board: Board,
    progress: Arc<Progress>,
    is_json: bool,
    is_terminal: bool,
    protocol: Option<Protocol>,
}

impl Out {
    fn begin(&mut self, is_polling: bool) {
        if self.is_json {
            print(&events::line(events::watching(self.board.script(), is_polling), 0));
        } else if self.is_terminal {
            self.draw();
        } else {
            say(&format!("watching {}\n", self.board.script()));
        }
    }

    fn end(&mut self) {
        self.progress.end();
        if !self.is_json {
            say("stopped\n");
        }
    }

    fn notice(&mut self, notice: Notice<Told>) {
        if self.is_json {
            return self.objects(notice);
        }
        // The block is drawn when there is something to see: a run that begins changes nothing yet.
        let lines = match notice {
            Notice::Started { run, changed } => self.board.started(run, &changed),
            Notice::Told(Told::Draft(shown)) => self.board.draft(shown),
            Notice::Told(Told::Picture(shown)) => self.board.picture(shown),
            Notice::Told(Told::Exported(shown)) => self.board.exported(shown),
            Notice::Told(Told::Failed(shown)) => self.board.failed(shown),
            Notice::Cancelled { run } => format!("run {run}: cancelled by a save\n"),
            Notice::Broken { .. } => String::new(),
            Notice::Polling { reason } => self.board.polling(&reason),
        };
        if !self.is_terminal {
            say(&lines);
            self.paint();
        } else if self.board.is_news() {
            if let Some(protocol) = self.protocol {
                self.board.fit_picture(|file, block| show::picture(file, protocol, show::lines(block)));
            }
            self.draw();
        }
    }

    fn objects(&mut self, notice: Notice<Told>) {
        let run = self.board.run();
        let events = match notice {
            Notice::Started { run, changed } => {
                self.board.started(run, &changed);
                return print(&events::line(events::started(&changed), run));
            }
            Notice::Told(Told::Draft(shown)) => {
                let event = shown.event.clone();
                self.board.draft(shown);
                vec![event]
            }
            Notice::Told(Told::Picture(shown)) => {
                let event = shown.event.clone();
                self.board.picture(shown);
                vec![event]
            }
            Notice::Told(Told::Exported(shown)) => vec![shown.event],
            Notice::Told(Told::Failed(shown)) => {
                let mut all = vec![shown.event.clone()];
                self.board.failed(shown);
                all.extend(self.board.good_run().map(|run| events::stale(run, self.board.is_draft())));
                all
            }
            Notice::Cancelled { .. } => vec![events::plain("cancelled")],
            Notice::Broken { .. } => vec![],
            Notice::Polling { reason } => vec![events::polling(&reason)],
        };
        for event in events {
            print(&events::line(event, run));
        }
    }

    /// The whole block anew.
    fn draw(&mut self) {
        self.progress.end();
        // Home, and clear from there: nothing of what was scrolled away is lost.
        say(&format!("\x1b[H\x1b[2J{}", self.board.block(is_styled())));
        self.paint();
    }

    /// The picture, below the block or, where it was forced, after the lines.
    fn paint(&mut self) {
        let picture = self.board.take_picture(self.is_terminal);
        let _ = std::io::stderr().write_all(&picture);
    }
}
