//! What a finished run says.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};

use crate::export::PartMotion;
use crate::render::sheet::grouped;
use crate::script::{Origin, Outcome, Rest};
use crate::workbench::{Report, Stage, Written};

/// For people: parts, times, files.
pub fn summary(report: &Report, written: &[Written], timings: bool) -> String {
    let mut out = String::new();
    for part in &report.figures {
        let name = &part.part;
        let _ = match part.triangles {
            0 => writeln!(
                out,
                "{name:>8}  {} strands, {} points, {} guides; {:.1} cm long on average, {:.1} cm at most",
                grouped(part.strands),
                grouped(part.points),
                grouped(part.guides),
                part.mean_length,
                part.longest,
            ),
            triangles if part.tufts > 0 => writeln!(
                out,
                "{name:>8}  {} tufts, {} triangles; {:.1} cm long on average, {:.1} cm at most",
                grouped(part.tufts),
                grouped(triangles),
                part.mean_length,
                part.longest,
            ),
            triangles => writeln!(out, "{name:>8}  {} triangles", grouped(triangles)),
        };
    }
    if let Some(budget) = &report.budget {
        let (before, after) = (grouped(budget.before), grouped(budget.after));
        let _ = match budget.tolerance {
            Some(tolerance) => {
                let also = match budget.pieces {
                    0 => String::new(),
                    1 => " and a cap, bun or ring".to_owned(),
                    n => format!(" and {n} caps, buns and rings"),
                };
                writeln!(
                    out,
                    "{:>8}  {before} triangles became {after}: {} of {} tufts{also}, by {tolerance:.3} cm at most",
                    "budget", budget.lowered, budget.tufts
                )
            }
            None => writeln!(out, "{:>8}  {before} triangles are within it", "budget"),
        };
    }
    for motion in &report.motions {
        let _ = writeln!(out, "{:>8}  {}: {}", "moves", motion.part, moved(motion));
    }
    for rest in &report.outcome.rests {
        let Rest { source, strands, moving, seconds, steps } = rest;
        let (strands, steps) = (grouped(*strands), grouped(*steps));
        let _ = match moving {
            0 => writeln!(out, "{:>8}  all {strands} strands after {seconds:.1} s, {steps} steps, at {source}", "rest"),
            _ => writeln!(
                out,
                "{:>8}  {} of {strands} strands still moved at the limit of {seconds:.1} s, {steps} steps, at {source}",
                "rest",
                grouped(*moving)
            ),
        };
    }
    let stage = |s: &Stage| match s.origin {
        Some(Origin::Hit) => format!("{} {} (hit)", s.what, milliseconds(s.time)),
        Some(Origin::Computed) | None => format!("{} {}", s.what, milliseconds(s.time)),
    };
    let stages: Vec<String> = report.stages.iter().map(stage).collect();
    let all: Duration = report.stages.iter().map(|s| s.time).sum();
    let _ = writeln!(out, "{:>8}  {}: {}", "time", milliseconds(all), stages.join(", "));
    if timings {
        for timing in &report.outcome.timings {
            let origin = timing.origin.map_or_else(String::new, |o| format!(", {}", o.text()));
            let (time, what) = (milliseconds(timing.time), &timing.what);
            let _ = writeln!(out, "{:>8}  {time} {what} at {}{origin}", "", timing.source);
        }
    }
    for file in written {
        let _ = writeln!(out, "{:>8}  {} ({})", "wrote", file.path.display(), size(file.bytes));
    }
    out
}

/// How a part of the GLB moves, how near and at what cost.
fn moved(motion: &PartMotion) -> String {
    let s = |n: usize| if n == 1 { "" } else { "s" };
    let what = match motion.form.as_str() {
        "joints" => {
            let (joints, chains) = (grouped(motion.joints), grouped(motion.chains));
            format!("{joints} joints in {chains} chain{}", s(motion.chains))
        }
        "shapes" => format!("{} shape{}", motion.shapes, s(motion.shapes)),
        _ => "as a whole".to_owned(),
    };
    format!(
        "{what}, {} frames with {} keys at most, within {:.2} cm, {}",
        motion.frames,
        motion.keys,
        motion.error_cm,
        size(motion.bytes)
    )
}

/// What `coif new` made, and how to go on.
pub fn made(folder: &Path, files: &[PathBuf]) -> String {
    let mut out = String::new();
    for file in files {
        let _ = writeln!(out, "{:>8}  {}", "wrote", file.display());
    }
    let style = files.first().and_then(|f| f.file_name()).map(|f| f.to_string_lossy()).unwrap_or_default();
    let _ = writeln!(out, "{:>8}  cd {} && coif run {style}", "next", folder.display());
    out
}

/// For programs: one JSON object.
pub fn stats(report: &Report, written: &[Written]) -> String {
    let stages: serde_json::Map<String, Value> =
        report.stages.iter().map(|s| (s.what.to_owned(), json!(ms(s.time)))).collect();
    let calls: Vec<Value> = report
        .outcome
        .timings
        .iter()
        .map(|t| json!({ "call": t.what, "source": t.source, "ms": ms(t.time), "origin": t.origin.map(Origin::text) }))
        .collect();
    let files: Vec<Value> =
        written.iter().map(|f| json!({ "path": f.path.to_string_lossy(), "bytes": f.bytes })).collect();
    let object = json!({
        "parts": report.figures,
        "ms": stages,
        "calls": calls,
        "rests": rests(&report.outcome),
        "files": files,
        "budget": report.budget.map(|b| json!({
            "before": b.before, "after": b.after, "lowered": b.lowered, "tufts": b.tufts, "pieces": b.pieces, "tolerance_cm": b.tolerance,
        })),
        "motions": report.motions.iter().map(|m| json!({
            "part": m.part, "form": m.form, "frames": m.frames, "shapes": m.shapes, "joints": m.joints, "chains": m.chains,
            "keys": m.keys, "bytes": m.bytes, "error_cm": m.error_cm,
        })).collect::<Vec<_>>(),
        "warnings": report.outcome.diagnostics.len(),
    });
    format!("{object}\n")
}

/// How strands came to rest, for programs.
pub fn rests(outcome: &Outcome) -> Value {
    let rest = |r: &Rest| {
        json!({
            "source": r.source, "strands": r.strands, "moving": r.moving, "seconds": (f64::from(r.seconds) * 1e3).round() / 1e3,
            "steps": r.steps,
        })
    };
    outcome.rests.iter().map(rest).collect()
}

/// Milliseconds with two decimals.
pub fn ms(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e5).round() / 100.0
}

/// The parameters of a script, one line each.
pub fn parameters(outcome: &Outcome) -> String {
    let mut out = String::new();
    let width = outcome.parameters.iter().map(|p| p.name.chars().count()).max().unwrap_or(0);
    for p in &outcome.parameters {
        let mut takes = p.kind.text().to_owned();
        match (p.min, p.max) {
            (Some(min), Some(max)) => takes = format!("{takes} {min} to {max}"),
            (Some(min), None) => takes = format!("{takes}, {min} or more"),
            (None, Some(max)) => takes = format!("{takes}, {max} or less"),
            (None, None) => {}
        }
        if !p.choices.is_empty() {
            takes = p.choices.iter().map(|c| format!("\"{c}\"")).collect::<Vec<_>>().join(" or ");
        }
        if let Some(unit) = &p.unit {
            takes = format!("{takes} {unit}");
        }
        let mut value = p.value.to_string();
        let default = p.default.to_string();
        if value != default {
            value = format!("{value} (default {default})");
        }
        let doc = if p.doc.is_empty() { String::new() } else { format!(": {}", p.doc) };
        let _ = writeln!(out, "{:width$} = {value}  [{takes}]{doc}", p.name);
    }
    out
}

/// The parameters of a script, as a JSON list.
pub fn parameters_json(outcome: &Outcome) -> String {
    let list: Vec<Value> = outcome
        .parameters
        .iter()
        .map(|p| {
            json!({
                "name": p.name,
                "kind": p.kind.text(),
                "value": plain(&p.value),
                "default": plain(&p.default),
                "min": p.min,
                "max": p.max,
                "unit": p.unit,
                "doc": p.doc,
                "choices": p.choices,
            })
        })
        .collect();
    format!("{}\n", Value::Array(list))
}

fn plain(value: &crate::params::Value) -> Value {
    use crate::params::Value as V;
    match value {
        V::Bool(b) => json!(b),
        V::Number(n) => json!(n),
        V::Text(t) => json!(t),
        V::Vector(v) => json!([v.x, v.y, v.z]),
        V::Nil | V::Table(_) | V::Handle(_) | V::Function(_) => Value::Null,
    }
}

/// `412 ms`, `3.2 s`.
pub(super) fn milliseconds(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 0.01 {
        format!("{:.1} ms", seconds * 1e3)
    } else if seconds < 10.0 {
        format!("{:.0} ms", seconds * 1e3)
    } else {
        format!("{seconds:.1} s")
    }
}

/// `812 kB`, `41.2 MB`.
pub(super) fn size(bytes: usize) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_read_well() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(2_560_000), "2,560,000");
        assert_eq!(milliseconds(Duration::from_micros(2_340)), "2.3 ms");
        assert_eq!(milliseconds(Duration::from_millis(1_234)), "1234 ms");
        assert_eq!(size(41_234_567), "41.2 MB");
    }
}
