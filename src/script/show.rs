//! Diagnostics as text for people: source line, mark, trace, hints.

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::{Diagnostic, Severity, Sources};

/// Levels of a call trace that are worth a line each.
const LONGEST_TRACE: usize = 8;

/// Renders one diagnostic; `styled` adds terminal colours.
pub fn show(diagnostic: &Diagnostic, sources: &Sources, styled: bool) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.clone());
    let mut group = match &diagnostic.place {
        None => Group::with_title(title),
        Some(place) => match sources.text(&place.file) {
            Some(text) => {
                let mark = AnnotationKind::Primary.span(place.span.clone()).label(diagnostic.label.clone());
                title.element(Snippet::source(text.to_owned()).path(place.file.clone()).annotation(mark))
            }
            None => title.element(Origin::path(place.file.clone()).line(place.line)),
        },
    };
    let trace = &diagnostic.trace;
    for frame in trace.iter().take(LONGEST_TRACE) {
        let what = match &frame.function {
            Some(name) => format!("in function `{name}`"),
            None => "in the body of the file".to_owned(),
        };
        group = group
            .element(Level::NOTE.with_name("called from").message(format!("{}:{} {what}", frame.file, frame.line)));
    }
    if trace.len() > LONGEST_TRACE {
        let more = trace.len() - LONGEST_TRACE;
        group = group.element(Level::NOTE.with_name("called from").message(format!("{more} more levels")));
    }
    for hint in &diagnostic.hints {
        group = group.element(Level::HELP.with_name("hint").message(hint.clone()));
    }
    let renderer = if styled { Renderer::styled() } else { Renderer::plain() };
    let style = if styled { DecorStyle::Unicode } else { DecorStyle::Ascii };
    renderer.decor_style(style).render(&[group])
}

/// Renders all of them, each followed by an empty line.
pub fn show_all(diagnostics: &[Diagnostic], sources: &Sources, styled: bool) -> String {
    diagnostics.iter().map(|d| show(d, sources, styled) + "\n\n").collect()
}
