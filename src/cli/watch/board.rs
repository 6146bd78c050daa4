//! The status of a watch, as one block of text.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::Shown;

/// Lines of a block besides summary and notes, at most.
pub const LINES: usize = 7;

/// How things stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The first run is on.
    Waiting,
    /// A draft is in place, the picture is being made.
    Drafted,
    /// The picture is in place, the other files are being made.
    Exporting,
    /// Everything is in place.
    Done,
    /// The last run ended with an error.
    Failed,
}

/// The last that is known of everything.
pub struct Board {
    script: String,
    has_hint: bool,
    run: u64,
    good_run: Option<u64>,
    /// What is in place is a draft.
    is_draft: bool,
    state: State,
    cause: String,
    polling: Option<String>,
    summary: String,
    exported: String,
    notes: String,
    picture: Vec<u8>,
    /// The picture that is in place.
    file: Option<Box<Path>>,
    is_news: bool,
}

impl Board {
    /// Before the first run. `has_hint`: say that `--show` exists.
    pub fn new(script: &Path, has_hint: bool) -> Self {
        Self {
            script: script.display().to_string(),
            has_hint,
            run: 0,
            good_run: None,
            is_draft: false,
            state: State::Waiting,
            cause: String::new(),
            polling: None,
            summary: String::new(),
            exported: String::new(),
            notes: String::new(),
            picture: vec![],
            file: None,
            is_news: false,
        }
    }

    /// The script, as it was named.
    pub fn script(&self) -> &str {
        &self.script
    }

    /// The run in progress or the last one; 0 before the first.
    pub fn run(&self) -> u64 {
        self.run
    }

    /// The run whose picture is in place.
    pub fn good_run(&self) -> Option<u64> {
        self.good_run
    }

    /// True when the picture in place is a draft.
    pub fn is_draft(&self) -> bool {
        self.is_draft
    }

    /// True once after every change that is worth a new block.
    pub fn is_news(&mut self) -> bool {
        std::mem::take(&mut self.is_news)
    }

    /// A run begins. This and the following give the lines for a pipe.
    pub fn started(&mut self, run: u64, changed: &BTreeSet<PathBuf>) -> String {
        self.run = run;
        let names: Vec<String> = changed.iter().map(|p| p.display().to_string()).collect();
        self.cause = if names.is_empty() { String::new() } else { format!("{} changed", names.join(", ")) };
        format!("run {run}: {}\n", if names.is_empty() { "started" } else { &self.cause })
    }

    /// A draft of the picture is in place.
    pub fn draft(&mut self, shown: Shown) -> String {
        (self.state, self.good_run, self.is_draft, self.is_news) = (State::Drafted, Some(self.run), true, true);
        self.exported.clear();
        (self.summary, self.notes, self.picture, self.file) = (shown.summary, shown.notes, shown.picture, shown.file);
        format!("run {}: draft\n{}", self.run, self.summary)
    }

    /// The picture is in place.
    pub fn picture(&mut self, shown: Shown) -> String {
        (self.state, self.good_run, self.is_draft, self.is_news) = (State::Exporting, Some(self.run), false, true);
        self.exported.clear();
        (self.summary, self.notes, self.picture, self.file) = (shown.summary, shown.notes, shown.picture, shown.file);
        format!("run {}: picture\n{}{}", self.run, self.summary, self.notes)
    }

    /// Everything is in place.
    pub fn exported(&mut self, shown: Shown) -> String {
        (self.state, self.is_news) = (State::Done, true);
        self.exported = shown.summary;
        format!("run {}: exported\n{}", self.run, self.exported)
    }

    /// An error.
    pub fn failed(&mut self, shown: Shown) -> String {
        (self.state, self.is_news) = (State::Failed, true);
        self.notes = shown.notes;
        format!("run {}: {}\n{}", self.run, self.state_text(), self.notes)
    }

    /// There are no events.
    pub fn polling(&mut self, reason: &str) -> String {
        self.is_news = true;
        let line = format!("no events here ({reason}): looking regularly instead");
        self.polling = Some(line.clone());
        format!("{line}\n")
    }

    /// Has the picture drawn anew below an error, which takes room that was the picture's.
    pub fn fit_picture(&mut self, draw: impl FnOnce(&Path, &str) -> Vec<u8>) {
        if let (State::Failed, Some(file)) = (self.state, &self.file) {
            self.picture = draw(file, &self.block(false));
        }
    }

    /// The bytes of the picture; they are kept for the next block if `is_kept`.
    pub fn take_picture(&mut self, is_kept: bool) -> Vec<u8> {
        if is_kept { self.picture.clone() } else { std::mem::take(&mut self.picture) }
    }

    /// The whole block.
    pub fn block(&self, is_styled: bool) -> String {
        let mut out = String::new();
        let colour = match self.state {
            State::Waiting | State::Drafted | State::Exporting => "36",
            State::Done => "32",
            State::Failed => "31",
        };
        let (on, off) = if is_styled { (format!("\x1b[1;{colour}m"), "\x1b[0m") } else { (String::new(), "") };
        let _ = writeln!(out, "{:>8}  {}", "watching", self.script);
        if let Some(line) = &self.polling {
            let _ = writeln!(out, "{:>8}  {line}", "");
        }
        let run = if self.run > 0 { format!("run {}: ", self.run) } else { String::new() };
        let cause = if self.cause.is_empty() { String::new() } else { format!(" ({})", self.cause) };
        let _ = writeln!(out, "{:>8}  {on}{run}{}{off}{cause}", "state", self.state_text());
        out += &self.summary;
        out += &self.exported;
        if self.has_hint {
            let _ = writeln!(out, "{:>8}  `--show` draws the picture in this terminal; Ctrl-C ends", "hint");
        }
        if !self.notes.is_empty() {
            let _ = write!(out, "\n{}", self.notes);
        }
        out
    }

    fn state_text(&self) -> String {
        match (self.state, self.good_run) {
            (State::Waiting, _) => "running".to_owned(),
            (State::Drafted, _) => "a draft is in place, the whole picture follows".to_owned(),
            (State::Exporting, _) => "the picture is up to date, the other files follow".to_owned(),
            (State::Done, _) => "up to date".to_owned(),
            (State::Failed, Some(good)) if self.is_draft => {
                format!("error; the picture is stale, a draft from run {good}")
            }
            (State::Failed, Some(good)) => format!("error; the picture is stale, from run {good}"),
            (State::Failed, None) => "error; there is no picture yet".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(summary: &str, notes: &str) -> Shown {
        let file = Some(Path::new("bob.png").into());
        Shown { summary: summary.into(), notes: notes.into(), picture: vec![1], file, event: serde_json::Value::Null }
    }

    #[test]
    fn an_error_keeps_the_picture_and_calls_it_stale() {
        let mut board = Board::new(Path::new("bob.lua"), true);
        assert!(board.block(false).contains("running") && board.block(false).contains("--show"));
        board.started(1, &BTreeSet::new());
        board.failed(shown("", "error: first\n"));
        assert!(board.block(false).contains("no picture yet"));
        board.started(2, &[PathBuf::from("bob.lua")].into());
        board.picture(shown("    hair  12 strands\n", ""));
        let block = board.block(false);
        assert!(block.contains("12 strands") && block.contains("bob.lua changed") && !block.contains("first"));
        board.exported(shown("   wrote  bob.glb\n", ""));
        board.started(3, &BTreeSet::new());
        let failed = board.failed(shown("", "error: again\n"));
        for text in [failed, board.block(false)] {
            assert!(text.contains("stale, from run 2") && text.contains("error: again"), "{text}");
        }
        assert!(board.block(false).contains("12 strands"), "what is known of the stale picture stays");
        assert_eq!(board.take_picture(true), [1]);
        board.fit_picture(|file, block| {
            assert!(file == Path::new("bob.png") && block.contains("error: again"));
            vec![2]
        });
        assert_eq!(board.take_picture(true), [2], "the stale picture is drawn anew where there is room");
        board.started(4, &BTreeSet::new());
        board.picture(shown("", ""));
        board.fit_picture(|_, _| vec![3]);
        assert_eq!(board.take_picture(true), [1], "without an error it stays as it is");
    }

    #[test]
    fn a_draft_is_called_one_until_the_picture_is_there() {
        let mut board = Board::new(Path::new("bob.lua"), false);
        board.started(1, &BTreeSet::new());
        assert!(board.draft(shown("    hair  6 strands\n", "")).starts_with("run 1: draft\n"));
        assert!(board.block(false).contains("a draft is in place") && board.is_draft() && board.is_news());
        board.started(2, &BTreeSet::new());
        board.failed(shown("", "error: again\n"));
        assert!(board.block(false).contains("stale, a draft from run 1"), "{}", board.block(false));
        board.started(3, &BTreeSet::new());
        board.draft(shown("", ""));
        board.picture(shown("    hair  12 strands\n", ""));
        assert!(!board.block(false).contains("draft") && !board.is_draft());
        board.started(4, &BTreeSet::new());
        board.failed(shown("", "error: again\n"));
        assert!(board.block(false).contains("stale, from run 3"));
    }

    #[test]
    fn a_block_has_as_many_lines_as_promised() {
        let mut board = Board::new(Path::new("bob.lua"), true);
        board.polling("none");
        board.started(1, &BTreeSet::new());
        board.picture(shown("a\nb\n", "c\nd\n"));
        board.exported(shown("e\nf\n", ""));
        assert!(board.block(true).lines().count() <= 4 + LINES);
        assert!(!board.block(false).contains('\x1b'));
    }
}
