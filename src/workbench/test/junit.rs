//! The report of a test run as JUnit XML, which build servers read.

use std::fmt::Write;

use super::{TestReport, TestResult, Verdict};

/// The report as JUnit XML: one suite per file, one case per test.
pub fn junit(report: &TestReport) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let failed = |results: &[TestResult]| results.iter().filter(|r| r.verdict != Verdict::Passed).count();
    let seconds = |results: &[TestResult]| results.iter().map(|r| r.time.as_secs_f64()).sum::<f64>();
    let all = &report.results;
    let unused = report.unused.len();
    let (tests, failures) = (all.len() + unused, failed(all) + unused);
    let _ = writeln!(
        out,
        "<testsuites name=\"coif\" tests=\"{tests}\" failures=\"{failures}\" time=\"{:.3}\">",
        seconds(all)
    );
    for suite in all.chunk_by(|a, b| a.file == b.file) {
        let file = suite.first().map(|r| r.file.display().to_string()).unwrap_or_default();
        let (tests, failures, time) = (suite.len(), failed(suite), seconds(suite));
        let _ = writeln!(
            out,
            "  <testsuite name=\"{}\" tests=\"{tests}\" failures=\"{failures}\" time=\"{time:.3}\">",
            escape(&file)
        );
        for result in suite {
            case(&mut out, &file, result);
        }
        out.push_str("  </testsuite>\n");
    }
    if unused > 0 {
        let _ = writeln!(out, "  <testsuite name=\"golden pictures\" tests=\"{unused}\" failures=\"{unused}\">");
        for path in &report.unused {
            let path = escape(&path.display().to_string());
            let _ = writeln!(
                out,
                "    <testcase classname=\"golden pictures\" name=\"{path}\"><failure message=\"no test refers to it\"/></testcase>"
            );
        }
        out.push_str("  </testsuite>\n");
    }
    out.push_str("</testsuites>\n");
    out
}

fn case(out: &mut String, file: &str, result: &TestResult) {
    let name = if result.name.is_empty() { "the file" } else { &result.name };
    let _ = write!(
        out,
        "    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3}\"",
        escape(file),
        escape(name),
        result.time.as_secs_f64()
    );
    if result.verdict == Verdict::Passed {
        out.push_str("/>\n");
        return;
    }
    out.push_str(">\n");
    for failure in &result.failures {
        let kind = if result.verdict == Verdict::Accepted { "accepted" } else { "failure" };
        let text: Vec<String> =
            std::iter::once(failure.to_string()).chain(failure.hints.iter().map(|h| format!("hint: {h}"))).collect();
        let _ = writeln!(
            out,
            "      <failure type=\"{kind}\" message=\"{}\">{}</failure>",
            escape(&failure.message),
            escape(&text.join("\n"))
        );
    }
    out.push_str("    </testcase>\n");
}

/// Text that may stand in XML, in attributes too; what XML 1.0 cannot hold becomes a question mark.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            '\t' => out.push_str("&#9;"),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('?'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_may_be_named() {
        assert_eq!(escape("a < b & \"c\"\n\u{1}é"), "a &lt; b &amp; &quot;c&quot;&#10;?é");
    }
}
