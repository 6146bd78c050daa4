//! `--show`: the picture inside the terminal.

use std::io::IsTerminal;

use crate::workbench::Written;
use crate::workbench::terminal::{Protocol, Window, draw};

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

/// The bytes that show the first picture among some files, below `taken` lines of text; empty when there is none.
pub fn picture(written: &[Written], protocol: Protocol, taken: usize) -> Vec<u8> {
    let Some(file) = written.iter().find(|w| w.path.extension().is_some_and(|e| e == "png")) else { return vec![] };
    let taken = u32::try_from(taken).unwrap_or(u32::MAX - 1);
    let drawn = std::fs::read(&file.path).ok().and_then(|png| draw(&png, protocol, &window(), taken).ok());
    drawn.unwrap_or_default()
}

/// The window of standard error.
fn window() -> Window {
    let mut window = Window {
        // Apple's own terminal is the last one without.
        is_true_colour: std::env::var("COLORTERM").is_ok_and(|c| c == "truecolor" || c == "24bit")
            || std::env::var("TERM").is_ok_and(|t| t.contains("direct") || t.contains("kitty") || t.contains("foot")),
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
