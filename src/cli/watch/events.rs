//! The events of `coif watch --json`: one object per line. `docs/how-to/watch.md` describes them.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::cli::text;
use crate::script::{Diagnostic, Frame, Outcome, Severity};
use crate::workbench::{Report, Stage, Written};

/// Number of this description of events; raised when a reader would have to change.
const VERSION: u32 = 1;

/// One line, with the number of the run after the name of the event.
pub fn line(event: Value, run: u64) -> String {
    let mut event = event;
    if run > 0 {
        event["run"] = json!(run);
    }
    format!("{event}\n")
}

/// The watch begins.
pub fn watching(script: &str, is_polling: bool) -> Value {
    json!({ "event": "watching", "version": VERSION, "script": script, "polling": is_polling })
}

/// There are no events from the file system.
pub fn polling(reason: &str) -> Value {
    json!({ "event": "polling", "reason": reason })
}

/// A run begins.
pub fn started(changed: &BTreeSet<PathBuf>) -> Value {
    json!({ "event": "started", "changed": changed.iter().map(|p| p.to_string_lossy()).collect::<Vec<_>>() })
}

/// An event that has nothing to add.
pub fn plain(event: &str) -> Value {
    json!({ "event": event })
}

/// The files in place are those of an earlier run.
pub fn stale(good_run: u64, is_draft: bool) -> Value {
    json!({ "event": "stale", "good_run": good_run, "draft": is_draft })
}

/// A half of a run is done.
pub fn good(event: &str, report: &Report, written: &[Written]) -> Value {
    let stage = |s: &Stage| match s.origin {
        Some(origin) => json!({ "stage": s.what, "ms": text::ms(s.time), "origin": origin.text() }),
        None => json!({ "stage": s.what, "ms": text::ms(s.time) }),
    };
    let stages: Vec<Value> = report.stages.iter().map(stage).collect();
    let files: Vec<Value> =
        written.iter().map(|f| json!({ "path": f.path.to_string_lossy(), "bytes": f.bytes })).collect();
    let mut object = json!({ "event": event, "stages": stages, "files": files });
    if event == "draft" {
        let thinned = report.outcome.thinned;
        object["members"] = json!(thinned.members);
        object["of"] = json!(thinned.of);
    }
    if event == "finished" {
        object["parts"] = json!(report.figures);
        object["rests"] = text::rests(&report.outcome);
        object["warnings"] = diagnostics(&report.outcome.diagnostics);
        object["log"] = json!(report.outcome.log);
    }
    object
}

/// The script is at fault.
pub fn bad(outcome: &Outcome) -> Value {
    json!({ "event": "failed", "diagnostics": diagnostics(&outcome.diagnostics), "log": outcome.log })
}

/// Something else is at fault.
pub fn message(message: &str) -> Value {
    json!({ "event": "failed", "diagnostics": diagnostics(&[Diagnostic::error(message)]), "log": [] })
}

fn diagnostics(list: &[Diagnostic]) -> Value {
    list.iter().map(diagnostic).collect()
}

fn diagnostic(d: &Diagnostic) -> Value {
    let severity = match d.severity {
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let frame = |f: &Frame| json!({ "file": f.file, "line": f.line, "function": f.function });
    json!({
        "severity": severity,
        "message": d.message,
        "label": d.label,
        "file": d.place.as_ref().map(|p| &p.file),
        "line": d.place.as_ref().map(|p| p.line),
        "column": d.place.as_ref().map(|p| p.column),
        "trace": d.trace.iter().map(frame).collect::<Vec<_>>(),
        "hints": d.hints,
    })
}
