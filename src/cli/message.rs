//! Faults as a person reads them: the line, a caret under the location, what is known, what to do.

use super::color::Color;
use super::output::{on_screen, steers, width};
use crate::plan::{Fault, Location, Source};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use std::ops::Range;
use std::sync::Arc;

/// Prints all faults on standard error.
pub(super) fn print(found: &[Fault], color: Color) {
    super::output::print_raw(&faults(found, color.on()));
}

/// Prints warnings on standard error.
pub(super) fn warnings(found: &[Fault], color: Color) {
    let renderer = renderer(color.on());
    for fault in found.iter().map(clean) {
        super::output::print_raw(&format!("{}\n\n", renderer.render(&[group(&fault, Level::WARNING)])));
    }
}

fn renderer(colour: bool) -> Renderer {
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    match width(&std::io::stderr()) {
        Some(width) => renderer.term_width(width),
        None => renderer,
    }
}

/// All faults, one under the other, and how many there are.
fn faults(faults: &[Fault], colour: bool) -> String {
    let renderer = renderer(colour);
    let mut text = String::new();
    for fault in faults.iter().map(clean) {
        text.push_str(&renderer.render(&[group(&fault, Level::ERROR)]));
        text.push_str("\n\n");
    }
    let what = if faults.len() == 1 { "1 fault".to_owned() } else { format!("{} faults", faults.len()) };
    text.push_str(
        &renderer.render(&[Group::with_title(Level::ERROR.primary_title(format!("{what}; nothing was run")))]),
    );
    text.push('\n');
    text
}

/// A fault without what steers a terminal. Spans stay where they are: each sign takes as many bytes as what it stands for.
fn clean(fault: &Fault) -> Fault {
    let words = |text: &String| on_screen(text);
    let sign =
        |c: char| if steers(c) && !matches!(c, '\n' | '\t' | '\r') { "?".repeat(c.len_utf8()) } else { c.to_string() };
    let location = |location: &Location| {
        let Source { name, text } = &*location.source;
        let (name, text) = (on_screen(&name.replace(['\n', '\r'], "?")), text.chars().map(sign).collect());
        Location { source: Arc::new(Source { name, text }), span: location.span.clone() }
    };
    Fault {
        location: fault.location.as_ref().map(location),
        message: on_screen(&fault.message),
        label: fault.label.as_ref().map(words),
        hint: fault.hint.as_ref().map(words),
        also: fault.also.iter().map(|(own, label)| (location(own), on_screen(label))).collect(),
        missing: fault.missing.clone(),
    }
}

fn group<'f>(fault: &'f Fault, level: Level<'f>) -> Group<'f> {
    let mut group = Group::with_title(level.primary_title(fault.message.as_str()));
    if let Some(location) = &fault.location {
        let mut shown = vec![(location, AnnotationKind::Primary, fault.label.as_deref())];
        shown.extend(
            fault.also.iter().map(|(location, words)| (location, AnnotationKind::Context, Some(words.as_str()))),
        );
        while !shown.is_empty() {
            group = group.element(snippet(&mut shown));
        }
    }
    match &fault.hint {
        Some(hint) => group.element(Level::HELP.message(hint.as_str())),
        None => group,
    }
}

type Shown<'f> = (&'f Location, AnnotationKind, Option<&'f str>);

/// Takes the first location and those near it out of the list.
fn snippet<'f>(shown: &mut Vec<Shown<'f>>) -> Snippet<'f, Annotation<'f>> {
    const NEAR: usize = 2000;
    let first = shown[0].0;
    let near =
        |location: &Location| location.source == first.source && location.span.start.abs_diff(first.span.start) < NEAR;
    let mut taken: Vec<Shown<'f>> = shown.extract_if(.., |(location, ..)| near(location)).collect();
    taken.sort_by_key(|(location, ..)| location.span.start);
    let text = first.source.text.as_str();
    let (top, bottom) = (taken[0].0, taken[taken.len() - 1].0);
    let begin = text[..top.span.start].rfind('\n').map_or(0, |at| at + 1);
    let end = text[bottom.span.start..].find('\n').map_or(text.len(), |at| bottom.span.start + at);
    let (line, _) = top.line_column();
    let annotations = taken.into_iter().map(|(location, kind, label)| {
        let span = first_line(text, location.span.clone());
        kind.span(span.start - begin..span.end - begin).label(label)
    });
    Snippet::source(&text[begin..end]).line_start(line).path(first.source.name.as_str()).annotations(annotations)
}

/// The part of a span that lies in its first line.
fn first_line(text: &str, span: Range<usize>) -> Range<usize> {
    let length = text[span.clone()].find(['\n', '\r']).unwrap_or(span.len());
    span.start..span.start + length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Overrides, parse};

    fn drawn(text: &str, overrides: &Overrides) -> String {
        parse("w.toml", text, overrides).map_or_else(|found| faults(&found, false), |_| String::new())
    }

    #[test]
    fn a_fault_is_drawn_with_its_line_and_caret() {
        let text = "[workflow]\nseed = 1\n\n[stage.runs]\nkind = \"data\"\nfil = \"a.csv\"\nfile = \"b.csv\"\n";
        let expected = "error: unknown key `fil`
 --> w.toml:6:1
  |
6 | fil = \"a.csv\"
  | ^^^ did you mean `file`?
  |
  = help: known keys: `file`, `delimiter`, `decimal`, `encoding`, `missing`, `sheet`, `first_line`, `rename`

error: 1 fault; nothing was run
";
        assert_eq!(drawn(text, &Overrides::default()), expected);
    }

    #[test]
    fn a_fault_of_an_option_shows_the_option() {
        let text = "[workflow]\nseed = 1\n[stage.runs]\nkind = \"data\"\nfile = \"b.csv\"\n";
        let sets = vec!["stage.runs.file=3".to_owned()];
        let expected = "error: wanted a text in quotes, found the number 3
 --> --set:1:17
  |
1 | stage.runs.file=3
  |                 ^

error: 1 fault; nothing was run
";
        assert_eq!(drawn(text, &Overrides { sets, ..Overrides::default() }), expected);
    }

    #[test]
    fn places_far_apart_and_lines_without_end_are_drawn_too() {
        let many = "9999999, ".repeat(100_000);
        let text = format!("a = [{many}]\n[workflow]\nseed = [1,\n2]\n[stage.A]\n{}[stage.a]\n", "\n".repeat(5000));
        let drawn = drawn(&text, &Overrides::default());
        let expected = "error: stages `A` and `a` differ only by upper and lower case
    --> w.toml:5006:8
     |
5006 | [stage.a]
     |        ^
     |
    ::: w.toml:5:8
     |
   5 | [stage.A]
     |        - the other one
";
        assert!(drawn.contains(expected), "{drawn}");
        assert!(drawn.len() < 10_000, "{drawn}");
    }
}
