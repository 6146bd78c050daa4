//! The promises of watching, kept in a real folder with a stand-in for the run that counts.

#[cfg(unix)]
#[path = "watch/terminal.rs"]
mod terminal;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use coif::script::{Disk, Files};
use coif::task::Task;
use coif::workbench::watch::{Ended, Stop, Watch, WatchOptions};

/// Longest wait for something that must happen.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long we look that something does not happen: several times the quiet period.
const CALM: Duration = Duration::from_millis(400);

/// What the stand-in does and has done.
#[derive(Default)]
struct Tally {
    /// Files to read, in order; what is missing is asked for all the same.
    reads: Mutex<Vec<PathBuf>>,
    /// Written at the end of every run, with ever new content.
    writes: Mutex<Vec<PathBuf>>,
    /// Runs go on until they are cancelled.
    is_endless: AtomicBool,
    started: AtomicUsize,
    finished: AtomicUsize,
    cancelled: AtomicUsize,
    /// What the last whole run has read, files joined with `|`; `-` for a missing one.
    seen: Mutex<String>,
    notices: Mutex<Vec<String>>,
}

struct Bench {
    dir: tempfile::TempDir,
    tally: Arc<Tally>,
    stop: Stop<()>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Bench {
    /// A watch over files of a fresh folder, after its first run.
    fn new(setup: impl FnOnce(&Path, &Tally), poll: bool) -> Self {
        Self::with(Arc::new(Disk), setup, poll)
    }

    /// The same, with files that are read in another way.
    fn with(files: Arc<dyn Files>, setup: impl FnOnce(&Path, &Tally), poll: bool) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let tally = Arc::new(Tally::default());
        setup(dir.path(), &tally);
        let outputs = tally.writes.lock().unwrap().iter().cloned().collect();
        let watch = Watch::new(WatchOptions { poll, outputs });
        let stop = watch.stop();
        let thread = std::thread::spawn({
            let tally = Arc::clone(&tally);
            move || {
                let run = |task: &Task, files: Arc<dyn Files>, _: &(dyn Fn(()) + Sync)| stand_in(&tally, task, &*files);
                watch.watch(&files, run, |notice| tally.notices.lock().unwrap().push(format!("{notice:?}")));
            }
        });
        let bench = Self { dir, tally, stop, thread: Some(thread) };
        if !bench.tally.is_endless.load(Ordering::SeqCst) {
            bench.until("the first run", |t| t.finished.load(Ordering::SeqCst) == 1);
            bench.calm();
        }
        bench
    }

    /// One file `style.lua` with the content `1`.
    fn one() -> Self {
        Self::new(
            |dir, tally| {
                std::fs::write(dir.join("style.lua"), "1").unwrap();
                tally.reads.lock().unwrap().push(dir.join("style.lua"));
            },
            false,
        )
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn write(&self, name: &str, content: &str) {
        std::fs::write(self.path(name), content).unwrap();
    }

    fn runs(&self) -> usize {
        self.tally.finished.load(Ordering::SeqCst)
    }

    fn until(&self, what: &str, is: impl Fn(&Tally) -> bool) {
        let end = Instant::now() + PATIENCE;
        while !is(&self.tally) {
            assert!(Instant::now() < end, "waited in vain for {what}; {}", self.story());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn sees(&self, content: &str) {
        self.until(&format!("`{content}`"), |t| *t.seen.lock().unwrap() == content);
    }

    /// Waits long enough for anything that might still happen.
    fn calm(&self) {
        std::thread::sleep(CALM);
    }

    fn story(&self) -> String {
        format!("saw `{}`; {:#?}", self.tally.seen.lock().unwrap(), self.tally.notices.lock().unwrap())
    }
}

fn stand_in(tally: &Tally, task: &Task, files: &dyn Files) -> Ended {
    let run = tally.started.fetch_add(1, Ordering::SeqCst);
    let reads = tally.reads.lock().unwrap().clone();
    let read = |path: &PathBuf| files.read(path).map_or("-".to_owned(), |b| String::from_utf8(b).unwrap());
    let seen: Vec<String> = reads.iter().map(read).collect();
    while tally.is_endless.load(Ordering::SeqCst) && !task.is_cancelled() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let is_cut_short = task.is_cancelled();
    if is_cut_short {
        tally.cancelled.fetch_add(1, Ordering::SeqCst);
    } else {
        for path in tally.writes.lock().unwrap().iter() {
            let beside = path.with_extension("part");
            std::fs::write(&beside, format!("output {run}")).unwrap();
            std::fs::rename(&beside, path).unwrap();
        }
        *tally.seen.lock().unwrap() = seen.join("|");
        tally.finished.fetch_add(1, Ordering::SeqCst);
    }
    Ended { depends: reads.into_iter().collect(), is_cut_short }
}

#[test]
fn a_file_rewritten_in_place() {
    let bench = Bench::one();
    for content in ["2", "3", "22", "4"] {
        bench.write("style.lua", content);
        bench.sees(content);
    }
    // Written through an open file, without truncation and without closing it.
    let mut file = std::fs::OpenOptions::new().write(true).open(bench.path("style.lua")).unwrap();
    std::io::Write::write_all(&mut file, b"5").unwrap();
    bench.sees("5");
}

#[test]
fn a_file_written_beside_and_renamed_again_and_again() {
    let bench = Bench::one();
    for content in ["2", "3", "4"] {
        bench.write("style.lua.new", content);
        std::fs::rename(bench.path("style.lua.new"), bench.path("style.lua")).unwrap();
        bench.sees(content);
    }
}

#[test]
fn a_file_renamed_to_a_backup_and_made_anew() {
    let bench = Bench::one();
    for content in ["2", "3"] {
        std::fs::rename(bench.path("style.lua"), bench.path("style.lua~")).unwrap();
        bench.write("style.lua", content);
        bench.sees(content);
    }
}

#[test]
fn a_file_deleted_and_made_again() {
    let bench = Bench::one();
    std::fs::remove_file(bench.path("style.lua")).unwrap();
    bench.sees("-");
    bench.write("style.lua", "2");
    bench.sees("2");
    std::fs::remove_file(bench.path("style.lua")).unwrap();
    bench.write("style.lua", "3");
    bench.sees("3");
}

#[test]
fn a_folder_deleted_and_made_again() {
    let bench = Bench::new(
        |dir, tally| {
            std::fs::create_dir_all(dir.join("a/b")).unwrap();
            std::fs::write(dir.join("a/b/style.lua"), "1").unwrap();
            tally.reads.lock().unwrap().push(dir.join("a/b/style.lua"));
        },
        false,
    );
    for content in ["2", "3"] {
        std::fs::remove_dir_all(bench.path("a")).unwrap();
        bench.sees("-");
        std::fs::create_dir_all(bench.path("a/b")).unwrap();
        bench.write("a/b/style.lua", content);
        bench.sees(content);
    }
    // All at once, and then a save in the new folder.
    std::fs::remove_dir_all(bench.path("a")).unwrap();
    std::fs::create_dir_all(bench.path("a/b")).unwrap();
    bench.write("a/b/style.lua", "4");
    bench.sees("4");
    bench.write("a/b/style.lua", "5");
    bench.sees("5");
    // Renamed away and another put in its place: what happens in the old one is no concern any more.
    std::fs::rename(bench.path("a/b"), bench.path("a/old")).unwrap();
    std::fs::create_dir(bench.path("a/b")).unwrap();
    bench.write("a/b/style.lua", "6");
    bench.sees("6");
    bench.write("a/b/style.lua", "7");
    bench.sees("7");
}

#[test]
fn a_file_that_is_missing_and_appears() {
    let bench = Bench::new(
        |dir, tally| {
            std::fs::write(dir.join("style.lua"), "1").unwrap();
            *tally.reads.lock().unwrap() = vec![dir.join("style.lua"), dir.join("lib/bun.lua")];
        },
        false,
    );
    bench.sees("1|-");
    std::fs::create_dir(bench.path("lib")).unwrap();
    bench.write("lib/bun.lua", "bun");
    bench.sees("1|bun");
}

#[test]
fn only_what_the_last_run_asked_for() {
    let bench = Bench::one();
    bench.write("other.lua", "x");
    bench.calm();
    assert_eq!(bench.runs(), 1, "{}", bench.story());
    // The next run asks for it.
    bench.tally.reads.lock().unwrap().push(bench.path("other.lua"));
    bench.write("style.lua", "2");
    bench.sees("2|x");
    bench.write("other.lua", "y");
    bench.sees("2|y");
    // The next one does not any more.
    bench.tally.reads.lock().unwrap().pop();
    bench.write("style.lua", "3");
    bench.sees("3");
    bench.calm();
    let runs = bench.runs();
    bench.write("other.lua", "z");
    bench.calm();
    assert_eq!(bench.runs(), runs, "{}", bench.story());
}

/// A disk on which `other.lua` is saved just after it was read, before the watch can be told of it.
struct Hasty(AtomicBool);

impl Files for Hasty {
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        let read = Disk.read(path);
        if path.ends_with("other.lua") && !self.0.swap(true, Ordering::SeqCst) {
            std::fs::write(path, "y")?;
            std::thread::sleep(Duration::from_millis(100));
        }
        read
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        Disk.list(folder)
    }

    fn resolve(&self, path: &Path) -> std::io::Result<PathBuf> {
        Disk.resolve(path)
    }
}

#[test]
fn a_file_saved_between_its_first_reading_and_the_watch_hearing_of_it() {
    let setup = |dir: &Path, tally: &Tally| {
        std::fs::write(dir.join("style.lua"), "1").unwrap();
        std::fs::write(dir.join("other.lua"), "x").unwrap();
        tally.reads.lock().unwrap().push(dir.join("style.lua"));
    };
    let bench = Bench::with(Arc::new(Hasty(AtomicBool::new(false))), setup, false);
    bench.tally.reads.lock().unwrap().push(bench.path("other.lua"));
    bench.write("style.lua", "2");
    bench.sees("2|y");
}

#[cfg(unix)]
#[test]
fn a_link_turned_elsewhere() {
    use std::os::unix::fs::symlink;
    let bench = Bench::new(
        |dir, tally| {
            for name in ["one", "two"] {
                std::fs::create_dir(dir.join(name)).unwrap();
                std::fs::write(dir.join(name).join("style.lua"), name).unwrap();
            }
            symlink("one", dir.join("now")).unwrap();
            tally.reads.lock().unwrap().push(dir.join("now/style.lua"));
        },
        false,
    );
    bench.write("one/style.lua", "1");
    bench.sees("1");
    std::fs::remove_file(bench.path("now")).unwrap();
    symlink("two", bench.path("now")).unwrap();
    bench.sees("two");
    bench.write("two/style.lua", "2");
    bench.sees("2");
    bench.calm();
    let runs = bench.runs();
    bench.write("one/style.lua", "not any more");
    bench.calm();
    assert_eq!(bench.runs(), runs, "{}", bench.story());
}

#[test]
fn a_thousand_saves() {
    let bench = Bench::one();
    for i in 0..1000 {
        bench.write("style.lua", &format!("save {i}"));
    }
    bench.sees("save 999");
    bench.calm();
    assert!(bench.runs() < 100, "{} runs", bench.runs());
    assert_eq!(*bench.tally.seen.lock().unwrap(), "save 999");
}

#[test]
fn the_same_content_again() {
    let bench = Bench::one();
    bench.write("style.lua", "1");
    bench.write("style.lua.new", "1");
    std::fs::rename(bench.path("style.lua.new"), bench.path("style.lua")).unwrap();
    bench.calm();
    assert_eq!(bench.tally.started.load(Ordering::SeqCst), 1, "{}", bench.story());
    bench.write("style.lua", "2");
    bench.sees("2");
}

#[test]
fn own_outputs_are_no_reason_even_where_they_are_read() {
    let bench = Bench::new(
        |dir, tally| {
            std::fs::write(dir.join("style.lua"), "1").unwrap();
            // In the script's own folder, and one of them read by the script too.
            *tally.writes.lock().unwrap() = vec![dir.join("style.png"), dir.join("style.glb")];
            *tally.reads.lock().unwrap() = vec![dir.join("style.lua"), dir.join("style.png")];
        },
        false,
    );
    bench.calm();
    assert_eq!(bench.tally.started.load(Ordering::SeqCst), 1, "{}", bench.story());
    bench.write("style.lua", "2");
    bench.until("the second run", |t| t.finished.load(Ordering::SeqCst) == 2);
    bench.calm();
    assert_eq!(bench.tally.started.load(Ordering::SeqCst), 2, "{}", bench.story());
}

#[test]
fn a_save_in_the_middle_of_a_run_cancels_it() {
    let bench = Bench::new(
        |dir, tally| {
            std::fs::write(dir.join("style.lua"), "1").unwrap();
            tally.reads.lock().unwrap().push(dir.join("style.lua"));
            tally.is_endless.store(true, Ordering::SeqCst);
        },
        false,
    );
    bench.until("the first run", |t| t.started.load(Ordering::SeqCst) == 1);
    // The run has read its file: what is saved now is news.
    bench.calm();
    // Renamed into place: on a slow machine a run may see a file that is written in place while it is still empty, which
    // is one cancelling more.
    let save = |content| {
        bench.write("style.lua.new", content);
        std::fs::rename(bench.path("style.lua.new"), bench.path("style.lua")).unwrap();
    };
    save("2");
    bench.until("the cancelling", |t| t.cancelled.load(Ordering::SeqCst) == 1);
    bench.until("the second run", |t| t.started.load(Ordering::SeqCst) == 2);
    bench.calm();
    // The same content again is no reason to cancel.
    save("2");
    bench.calm();
    assert_eq!(bench.tally.cancelled.load(Ordering::SeqCst), 1, "{}", bench.story());
    bench.tally.is_endless.store(false, Ordering::SeqCst);
    bench.sees("2");
    assert_eq!(bench.runs(), 1);
}

#[test]
fn stopping_cancels_the_run() {
    let mut bench = Bench::new(
        |dir, tally| {
            tally.reads.lock().unwrap().push(dir.join("style.lua"));
            tally.is_endless.store(true, Ordering::SeqCst);
        },
        false,
    );
    bench.until("the first run", |t| t.started.load(Ordering::SeqCst) == 1);
    bench.stop.stop();
    bench.thread.take().unwrap().join().unwrap();
    assert_eq!(bench.tally.cancelled.load(Ordering::SeqCst), 1);
}

#[test]
fn polling_sees_what_events_would_tell() {
    let bench = Bench::new(
        |dir, tally| {
            std::fs::write(dir.join("style.lua"), "1").unwrap();
            *tally.reads.lock().unwrap() = vec![dir.join("style.lua"), dir.join("lib/bun.lua")];
        },
        true,
    );
    bench.write("style.lua", "2");
    bench.sees("2|-");
    std::fs::create_dir(bench.path("lib")).unwrap();
    bench.write("lib/bun.lua", "bun");
    bench.sees("2|bun");
    std::fs::remove_dir_all(bench.path("lib")).unwrap();
    bench.sees("2|-");
    let runs = bench.runs();
    bench.write("style.lua", "2");
    bench.calm();
    bench.calm();
    assert_eq!(bench.runs(), runs, "{}", bench.story());
}
