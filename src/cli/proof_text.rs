//! What tests and comparisons say.

use std::fmt::Write;
use std::time::Duration;

use serde_json::json;

use super::text::{milliseconds, size};
use crate::render::sheet::grouped;
use crate::script::show_all;
use crate::workbench::Written;
use crate::workbench::diff::{Change, Changes, PartChange};
use crate::workbench::test::{TestReport, TestResult, Verdict};

/// The files that were written.
pub fn wrote(written: &[Written]) -> String {
    written.iter().map(|f| format!("{:>8}  {} ({})\n", "wrote", f.path.display(), size(f.bytes))).collect()
}

/// A test that has ended.
pub fn result(result: &TestResult, quiet: bool, styled: bool) -> String {
    let mut out = String::new();
    let word = match result.verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "FAILED",
        Verdict::Accepted => "accepted",
    };
    let is_silent = quiet && result.verdict == Verdict::Passed;
    if !is_silent {
        let name = if result.name.is_empty() { "the file" } else { &result.name };
        let file = result.file.display();
        let _ = writeln!(out, "{word:>8}  {file}: {name} ({})", milliseconds(result.time));
    }
    if !quiet || result.verdict == Verdict::Failed {
        for line in &result.log {
            let _ = writeln!(out, "{line}");
        }
    }
    out.push_str(&show_all(&result.warnings, &result.sources, styled));
    out.push_str(&show_all(&result.failures, &result.sources, styled));
    out
}

/// The last lines of a test run.
pub fn test_summary(report: &TestReport) -> String {
    let mut out = String::new();
    for written in &report.accepted {
        let _ = writeln!(out, "{:>8}  {} ({})", "accepted", written.path.display(), size(written.bytes));
    }
    out.push_str(&wrote(&report.differences));
    for path in &report.unused {
        let _ = writeln!(out, "{:>8}  {}: no test refers to this golden picture", "unused", path.display());
    }
    let checks: usize = report.results.iter().map(|r| r.checks).sum();
    let time: Duration = report.results.iter().map(|r| r.time).sum();
    let mut parts = vec![format!("{} passed", report.count(Verdict::Passed))];
    let counts = [
        ("failed", report.count(Verdict::Failed)),
        ("accepted", report.count(Verdict::Accepted)),
        ("golden pictures unused", report.unused.len()),
        ("left out", report.left_out),
    ];
    parts.extend(counts.iter().filter(|(_, n)| *n > 0).map(|(what, n)| format!("{n} {what}")));
    let _ = writeln!(
        out,
        "{:>8}  {} tests: {}; {} expectations in {}",
        if report.is_passed() { "ok" } else { "not ok" },
        report.results.len(),
        parts.join(", "),
        grouped(checks),
        milliseconds(time)
    );
    if !report.accepted.is_empty() {
        out.push_str("          golden pictures were accepted: look at them, then run the tests again\n");
    }
    out
}

/// What changed, for people.
pub fn changes(changes: &Changes) -> String {
    if changes.is_empty() {
        return "nothing changed\n".to_owned();
    }
    let mut out = String::new();
    for (what, list) in [("parameters", &changes.parameters), ("scene", &changes.scene)] {
        if !list.is_empty() {
            let _ = writeln!(out, "{what}");
            list.iter().for_each(|c| out.push_str(&change(c)));
        }
    }
    for part in &changes.parts {
        out.push_str(&part_change(part));
    }
    out
}

fn change(change: &Change) -> String {
    match (&change.before, &change.after) {
        (Some(a), Some(b)) => format!("  {}: {a} -> {b}\n", change.what),
        (Some(a), None) => format!("  {}: {a} -> gone\n", change.what),
        (None, Some(b)) => format!("  {}: new, {b}\n", change.what),
        (None, None) => format!("  {}\n", change.what),
    }
}

fn part_change(part: &PartChange) -> String {
    let mut out = format!("{}: {}\n", part.part, part.state);
    if part.added + part.removed + part.moved > 0 {
        let all = [("added", part.added), ("removed", part.removed), ("moved", part.moved)];
        let all: Vec<String> =
            all.iter().filter(|(_, n)| *n > 0).map(|(what, n)| format!("{} {what}", grouped(*n))).collect();
        let is_strands = part.strands_before + part.strands_after > 0;
        let (what, a, b) = if is_strands {
            ("strands", part.strands_before, part.strands_after)
        } else {
            ("locks", part.locks_before, part.locks_after)
        };
        let _ = writeln!(out, "  {what}: {} -> {}; {}", grouped(a), grouped(b), all.join(", "));
    }
    if part.moved > 0 {
        let _ = write!(out, "  moved by {:.3} cm on average, {:.3} cm at most", part.mean_distance, part.max_distance);
        if let Some([x, y, z]) = part.farthest {
            let _ = write!(out, " (root at {{ {x:.2}, {y:.2}, {z:.2} }})");
        }
        out.push('\n');
    }
    part.material.iter().chain(&part.other).for_each(|c| out.push_str(&change(c)));
    out
}

/// What changed, as one JSON object.
pub fn changes_json(changes: &Changes, written: &[Written]) -> String {
    let files: Vec<_> = written.iter().map(|f| json!({ "path": f.path.to_string_lossy(), "bytes": f.bytes })).collect();
    let object = json!({
        "same": changes.is_empty(),
        "parameters": changes.parameters,
        "scene": changes.scene,
        "parts": changes.parts,
        "files": files,
    });
    format!("{object}\n")
}
