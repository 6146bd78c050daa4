//! `coif watch` as a real process, in a pseudo-terminal and in a pipe.
#![expect(unsafe_code, reason = "there is no safe way in std to a pseudo-terminal and to a signal")]

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::fd::{FromRawFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Longest wait for something that must happen.
const PATIENCE: Duration = Duration::from_secs(60);

const GOOD: &str = "return coif.scene { coif.head() }";

/// A process that is ended with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Process {
    fn exit_code(&mut self) -> Option<i32> {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                return status.code();
            }
            assert!(Instant::now() < end, "the process does not end");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

fn coif(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_coif"));
    command.args(arguments).current_dir(folder).env("TERM", "xterm-256color");
    for name in ["KITTY_WINDOW_ID", "TERM_PROGRAM", "LC_TERMINAL", "TMUX", "NO_COLOR", "COLORTERM"] {
        command.env_remove(name);
    }
    command
}

fn folder(script: &str) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("style.lua");
    std::fs::write(&path, script).unwrap();
    (dir, path)
}

/// A pseudo-terminal of 100 x 40 characters: what is typed, and what is shown.
struct Terminal {
    typed: File,
    shown: Arc<Mutex<Vec<u8>>>,
    process: Process,
}

impl Terminal {
    fn new(mut command: Command) -> Self {
        let size = libc::winsize { ws_row: 40, ws_col: 100, ws_xpixel: 1000, ws_ypixel: 800 };
        let (mut ours, mut theirs) = (-1, -1);
        // SAFETY: both numbers are ours to write to; name and settings may be null.
        let made = unsafe { libc::openpty(&mut ours, &mut theirs, std::ptr::null_mut(), std::ptr::null(), &size) };
        assert_eq!(made, 0, "{}", std::io::Error::last_os_error());
        // SAFETY: open, and owned by nobody else.
        let (ours, theirs) = unsafe { (File::from_raw_fd(ours), OwnedFd::from_raw_fd(theirs)) };
        command.stdin(theirs.try_clone().unwrap()).stdout(theirs.try_clone().unwrap()).stderr(theirs);
        // SAFETY: both calls are allowed between fork and exec.
        unsafe {
            command.pre_exec(|| {
                // A session of its own, so that Ctrl-C in this terminal reaches it and nobody else.
                if libc::setsid() < 0 || libc::ioctl(0, libc::TIOCSCTTY, 0) < 0 {
                    return Err(std::io::Error::last_os_error());
                }
                Ok(())
            });
        }
        let process = Process(command.spawn().unwrap());
        // The command holds the far end open.
        drop(command);
        let shown = Arc::new(Mutex::new(vec![]));
        let (mut reader, all) = (ours.try_clone().unwrap(), Arc::clone(&shown));
        std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(n @ 1..) = reader.read(&mut buffer) {
                all.lock().unwrap().extend_from_slice(&buffer[..n]);
            }
        });
        Self { typed: ours, shown, process }
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned()
    }

    /// Waits for a text in what was shown since `from`; gives where the shown text ends.
    fn shows(&self, text: &str, from: usize) -> usize {
        let end = Instant::now() + PATIENCE;
        loop {
            let all = self.text();
            if all.get(from..).is_some_and(|t| t.contains(text)) {
                return all.len();
            }
            assert!(Instant::now() < end, "waited in vain for `{text}` in\n{all}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_terminal_shows_status_error_recovery_and_is_left_clean() {
    let (dir, script) = folder(GOOD);
    let mut terminal = Terminal::new(coif(dir.path(), &["watch", "style.lua", "--size", "64"]));
    let at = terminal.shows("up to date", 0);
    let first = terminal.text();
    assert!(first.contains("watching  style.lua") && first.contains("`--show`"), "{first}");
    assert!(first.contains("\x1b[H\x1b[2J"), "a terminal is cleared");
    let picture = std::fs::read(dir.path().join("out/style.png")).unwrap();

    std::fs::write(&script, "return coif.scenery {}").unwrap();
    let at = terminal.shows("stale, from run 1", at);
    terminal.shows("scenery", 0);
    assert_eq!(std::fs::read(dir.path().join("out/style.png")).unwrap(), picture, "the last good picture stays");

    std::fs::write(&script, "return coif.scene { coif.head(), background = \"dark\" }").unwrap();
    terminal.shows("up to date", at);
    assert_ne!(std::fs::read(dir.path().join("out/style.png")).unwrap(), picture);

    terminal.typed.write_all(b"\x03").unwrap();
    assert_eq!(terminal.process.exit_code(), Some(130));
    assert_eq!(names(&dir.path().join("out")), ["style.glb", "style.png"]);
    assert_eq!(names(dir.path()), ["out", "style.lua"]);
    let all = terminal.text();
    // The cursor is visible, colours are off, and we are on the main screen.
    assert_eq!(all.matches("\x1b[?25l").count(), all.matches("\x1b[?25h").count());
    assert!(!all.contains("\x1b[?1049h"));
    let last = all.rfind("\x1b[0m").unwrap_or(0);
    assert!(!all[last + 4..].contains("\x1b[1;"), "a colour is left on");
}

#[test]
fn a_terminal_shows_the_picture() {
    let (dir, _) = folder(GOOD);
    let mut terminal = Terminal::new(coif(dir.path(), &["watch", "style.lua", "--size", "64", "--show"]));
    terminal.shows("up to date", 0);
    terminal.shows("▀", 0);
    assert!(!terminal.text().contains("hint"));
    terminal.typed.write_all(b"\x03").unwrap();
    assert_eq!(terminal.process.exit_code(), Some(130));
}

/// The rows of a picture in half blocks that is last in what was shown, and the lines of text above it.
fn last_block(shown: &str) -> (usize, usize) {
    let block = shown.rsplit("\x1b[2J").next().unwrap();
    let (text, picture): (Vec<&str>, Vec<&str>) = block.lines().partition(|l| !l.contains('▀'));
    (picture.len(), text.len())
}

#[test]
fn below_an_error_the_picture_leaves_room_for_the_state() {
    let (dir, script) = folder("return coif.scene { coif.head(), views = { 'front' } }");
    let ended = |wrong: Option<&str>| {
        let terminal = Terminal::new(coif(dir.path(), &["watch", "style.lua", "--size", "160", "--show"]));
        terminal.shows("style.glb", 0);
        if let Some(wrong) = wrong {
            std::fs::write(&script, wrong).unwrap();
            terminal.shows("stale, from run 1", 0);
        }
        // Not by Ctrl-C, for which a terminal throws away what it has not shown yet.
        interrupt(&terminal.process);
        terminal.shows("stopped", 0);
        last_block(&terminal.text())
    };
    let (rows, lines) = ended(None);
    assert!(rows > 20 && rows + lines <= 40, "{rows} of the picture, {lines} of text");
    let (fewer, lines) = ended(Some("return coif.scene { coif.head(), veiws = { 'front' } }"));
    assert!(fewer < rows && fewer + lines <= 40, "{fewer} of the picture, {lines} of text");
}

/// A running process whose lines arrive one by one.
fn piped(mut command: Command, is_stdout: bool) -> (Process, Receiver<String>) {
    let (out, err) = if is_stdout { (Stdio::piped(), Stdio::null()) } else { (Stdio::null(), Stdio::piped()) };
    let mut process = Process(command.stdin(Stdio::null()).stdout(out).stderr(err).spawn().unwrap());
    let stream: Box<dyn Read + Send> =
        if is_stdout { Box::new(process.0.stdout.take().unwrap()) } else { Box::new(process.0.stderr.take().unwrap()) };
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    (process, receiver)
}

fn interrupt(process: &Process) {
    // SAFETY: a signal to our own child, which has not been waited for.
    let sent = unsafe { libc::kill(process.0.id() as i32, libc::SIGINT) };
    assert_eq!(sent, 0);
}

#[test]
fn a_pipe_gets_plain_lines() {
    let (dir, script) = folder(GOOD);
    let (mut process, lines) = piped(coif(dir.path(), &["watch", "style.lua", "--size", "64", "--show"]), false);
    let mut all = vec![];
    let mut until = |text: &str| {
        while !all.last().is_some_and(|l: &String| l.contains(text)) {
            all.push(lines.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("no `{text}` in {all:#?}")));
        }
    };
    until("run 1: exported");
    std::fs::write(&script, "return 1").unwrap();
    until("run 2: error; the picture is stale, from run 1");
    interrupt(&process);
    until("stopped");
    assert_eq!(process.exit_code(), Some(130));
    assert!(all.iter().all(|l| !l.contains('\x1b')), "{all:#?}");
}

#[test]
fn programs_get_one_object_per_event() {
    let (dir, script) = folder(GOOD);
    let (mut process, lines) = piped(coif(dir.path(), &["watch", "style.lua", "--size", "64", "--json"]), true);
    let next = || -> serde_json::Value {
        let line = lines.recv_timeout(PATIENCE).expect("an event");
        serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"))
    };
    let expect = |name: &str, run: u64| {
        let event = next();
        assert_eq!(event["event"], name, "{event}");
        assert_eq!(event["run"].as_u64().unwrap_or(0), run, "{event}");
        event
    };
    let event = expect("watching", 0);
    assert_eq!((event["version"].as_u64(), event["script"].as_str()), (Some(1), Some("style.lua")));
    expect("started", 1);
    let event = expect("finished", 1);
    assert!(event["files"][0]["path"].as_str().unwrap().ends_with("style.png"));
    assert_eq!(event["stages"][0]["stage"], "script");
    assert_eq!(event["warnings"], serde_json::json!([]));
    let event = expect("exported", 1);
    assert!(event["files"][0]["path"].as_str().unwrap().ends_with("style.glb"));

    std::fs::write(&script, "return coif.scenery {}").unwrap();
    let event = expect("started", 2);
    assert!(event["changed"][0].as_str().unwrap().ends_with("style.lua"));
    let event = expect("failed", 2);
    assert_eq!(
        (event["diagnostics"][0]["line"].as_u64(), &event["diagnostics"][0]["severity"]),
        (Some(1), &"error".into())
    );
    assert_eq!(expect("stale", 2)["good_run"], 1);

    // A module that is not there yet, and comes.
    std::fs::write(&script, "return coif.scene { coif.head(), background = require('tone') }").unwrap();
    expect("started", 3);
    expect("failed", 3);
    expect("stale", 3);
    std::fs::write(dir.path().join("tone.lua"), "return 'dark'").unwrap();
    expect("started", 4);
    expect("finished", 4);
    expect("exported", 4);

    interrupt(&process);
    assert_eq!(process.exit_code(), Some(130));
}

#[test]
fn a_draft_comes_first_where_there_is_much_hair() {
    let hairy = "local head = coif.head()\nlocal hair = head:scalp():guides { count = 10, length = 2, step = 1 }:grow {}\n\
                 :fill { strands = 6500, nodes = 3 }\nreturn coif.scene { head, hair, views = { 'front' } }";
    let (dir, script) = folder(hairy);
    for (more, wanted) in [
        (&[][..], &["started", "draft", "finished", "exported"][..]),
        (&["--no-draft"], &["started", "finished", "exported"]),
    ] {
        let arguments = ["watch", "style.lua", "--size", "64", "--strands", "none", "--json"];
        let (mut process, lines) = piped(coif(dir.path(), &[&arguments[..], more].concat()), true);
        let next = || -> serde_json::Value {
            serde_json::from_str(&lines.recv_timeout(PATIENCE).expect("an event")).expect("an object")
        };
        assert_eq!(next()["event"], "watching");
        for name in wanted {
            let event = next();
            assert_eq!(event["event"], *name, "{event}");
            if *name == "draft" {
                assert_eq!((event["members"].as_u64(), event["of"].as_u64()), (Some(4000), Some(6500)));
                assert!(event["files"][0]["path"].as_str().unwrap().ends_with("style.png"));
            }
        }
        // An error after it: the whole picture is what is stale.
        std::fs::write(&script, "return 1").unwrap();
        assert_eq!((next()["event"].clone(), next()["event"].clone()), ("started".into(), "failed".into()));
        let stale = next();
        assert_eq!((&stale["event"], &stale["draft"]), (&"stale".into(), &false.into()));
        std::fs::write(&script, hairy).unwrap();
        interrupt(&process);
        assert_eq!(process.exit_code(), Some(130));
    }
}

#[test]
fn a_run_shows_its_picture_only_where_it_is_wanted() {
    let (dir, _script) = folder(GOOD);
    let shown = |arguments: &[&str]| {
        let output = coif(dir.path(), &[&["run", "style.lua", "--size", "64"], arguments].concat()).output().unwrap();
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(!shown(&["--show"]).contains('\x1b'), "a pipe is no terminal");
    assert!(shown(&["--show=half"]).contains('▀'));
    assert!(shown(&["--show=kitty"]).contains("\x1b_Ga=T"));
    assert!(shown(&["--show=sixel"]).contains("\x1bP0;1;0q"));
    assert!(shown(&["--show=iterm"]).contains("\x1b]1337;File=inline=1"));
}
