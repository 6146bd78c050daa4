//! `--show`: the picture inside the terminal.

use std::io::IsTerminal;
use std::path::Path;

use crate::workbench::Written;
use crate::workbench::terminal::{Protocol, Window, XTERM_MOST, draw};

/// What `--show` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// As well as the terminal can; nothing where there is none.
    Auto,
    /// In this way, wherever the output goes.
    Forced(Protocol),
}

impl Show {
    /// What a value may be.
    pub const TEXTS: &[&str] = &["auto", "kitty", "iterm", "sixel", "half"];

    /// The meaning of a value.
    pub fn parse(text: &str) -> Option<Self> {
        if text == "auto" { Some(Self::Auto) } else { Protocol::parse(text).map(Self::Forced) }
    }

    /// How to draw on standard error; `None`: not at all.
    pub fn protocol(self) -> Option<Protocol> {
        match self {
            Self::Forced(protocol) => Some(protocol),
            Self::Auto => is_capable().then(|| Protocol::detect(|name| std::env::var(name).ok())),
        }
    }
}

/// True when standard error is a terminal that pictures can be drawn on.
pub fn is_capable() -> bool {
    std::io::stderr().is_terminal() && std::env::var("TERM").is_ok_and(|t| !t.is_empty() && t != "dumb")
}

/// The first picture among some files.
pub fn first(written: &[Written]) -> Option<&Path> {
    written.iter().map(|w| w.path.as_path()).find(|p| p.extension().is_some_and(|e| e == "png"))
}

/// The bytes that show a picture below `taken` lines of text; empty when it cannot be shown.
pub fn picture(file: &Path, protocol: Protocol, taken: usize) -> Vec<u8> {
    let taken = u32::try_from(taken).unwrap_or(u32::MAX - 1);
    let drawn = std::fs::read(file).ok().and_then(|png| draw(&png, protocol, &window(), taken).ok());
    drawn.unwrap_or_default()
}

/// Lines of the window that a text takes: a long one goes on in the next.
pub fn lines(text: &str) -> usize {
    lines_in(text, window().columns as usize)
}

fn lines_in(text: &str, columns: usize) -> usize {
    text.lines().map(|line| width(line).div_ceil(columns).max(1)).sum()
}

/// Characters of a line, without what sets its colours.
fn width(line: &str) -> usize {
    let mut pieces = line.split("\x1b[");
    let first = pieces.next().map_or(0, |p| p.chars().count());
    first + pieces.map(|p| p.split_once('m').map_or(0, |(_, text)| text.chars().count())).sum::<usize>()
}

/// The window of standard error.
fn window() -> Window {
    let mut window = Window {
        // Apple's own terminal is the last one without.
        is_true_colour: std::env::var("COLORTERM").is_ok_and(|c| c == "truecolor" || c == "24bit")
            || std::env::var("TERM").is_ok_and(|t| t.contains("direct") || t.contains("kitty") || t.contains("foot")),
        most: std::env::var_os("XTERM_VERSION").map(|_| XTERM_MOST),
        ..Window::default()
    };
    #[cfg(unix)]
    if let Ok(size) = rustix::termios::tcgetwinsize(std::io::stderr())
        && size.ws_col > 0
        && size.ws_row > 0
    {
        (window.columns, window.rows) = (u32::from(size.ws_col), u32::from(size.ws_row));
        let cell = (u32::from(size.ws_xpixel) / window.columns, u32::from(size.ws_ypixel) / window.rows);
        window.cell = (cell.0 > 0 && cell.1 > 0).then_some(cell);
    }
    window
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_takes_several() {
        assert_eq!(lines_in("", 10), 0);
        assert_eq!(lines_in("\n12345\n1234567890\n", 10), 3);
        assert_eq!(lines_in("12345678901", 10), 2);
        assert_eq!(lines_in("\x1b[1;31merror\x1b[0m: 123", 10), 1, "colours take no room");
        assert_eq!(lines_in("╰ hint: ä", 9), 1);
    }
}
