//! What went wrong, where, and what to do about it.

use std::fmt;
use std::ops::Range;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The run goes on.
    Warning,
    /// The run ends without a scene.
    Error,
}

/// A stretch of text in a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The script, as it was named to Coif.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
    /// Bytes of the file's text that are at fault.
    pub span: Range<usize>,
}

/// One level of the calls that led to a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The script, as it was named to Coif.
    pub file: String,
    /// From 1.
    pub line: usize,
    /// The function that was running there; `None` in the body of a file.
    pub function: Option<String>,
}

/// A message with its place.
///
/// Style: lower case, no full stop, the offending value in backticks, hints that name the fix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// Text at the mark: what the marked thing is (`in coif.domain.gather`).
    pub label: Option<String>,
    /// Where; `None` when it is not about a place in a script.
    pub place: Option<Place>,
    /// Who called, innermost first, without the place itself.
    pub trace: Vec<Frame>,
    /// What to do.
    pub hints: Vec<String>,
}

impl Diagnostic {
    /// An error without a place.
    pub fn error(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            label: None,
            place: None,
            trace: vec![],
            hints: vec![],
        }
    }

    /// A warning without a place.
    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    /// The same with one more hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }

    /// The same with one more hint, if there is one.
    #[must_use]
    pub fn hint_opt(mut self, hint: Option<String>) -> Self {
        self.hints.extend(hint);
        self
    }
}

/// One line: `style.lua:3:7: error: unknown field ...`.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(p) = &self.place {
            write!(f, "{}:{}:{}: ", p.file, p.line, p.column)?;
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}: {}", self.message)
    }
}
