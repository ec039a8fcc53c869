//! Symbols of factors and responses as HTML: italics, subscripts, superscripts, bars.
//!
//! The label is set by [`figure::text`], and the positions of its glyphs say what each of them is, so pages and
//! pictures read the same notation.

use crate::stage::Context;
use crate::stage::units::symbol_of_test;
use figure::font::Face;
use figure::text::{self, Line};
use maud::{Markup, PreEscaped, html};

/// How a glyph stands.
#[derive(Clone, Copy, Default, PartialEq)]
struct Manner {
    italic: bool,
    /// −1 below the line, 1 above it.
    level: i8,
    bar: bool,
}

/// A label with mathematics between dollar signs.
pub(super) fn label(label: &str) -> Markup {
    let line = Line::new(label, 1.0);
    let mut parts: Vec<(Manner, String)> = Vec::new();
    let mut end = 0.0;
    for glyph in &line.glyphs {
        let level = if glyph.at[1] > 0.0 { -1 } else { i8::from(glyph.at[1] < 0.0) };
        let middle = glyph.at[0] + glyph.face.advance(glyph.id) * glyph.size / 2.0;
        let bar = line.rules.iter().any(|rule| rule.left <= middle && middle <= rule.right);
        let manner = Manner { italic: glyph.face == Face::Italic, level, bar };
        let apart = glyph.at[0] - end > 0.12 && !parts.is_empty();
        end = glyph.at[0] + glyph.face.advance(glyph.id) * glyph.size;
        if apart {
            push(&mut parts, Manner::default(), '\u{202f}');
        }
        push(&mut parts, manner, glyph.character);
    }
    html! { @for (manner, text) in &parts { (part(*manner, text)) } }
}

fn push(parts: &mut Vec<(Manner, String)>, manner: Manner, character: char) {
    match parts.last_mut() {
        Some((last, text)) if *last == manner => text.push(character),
        _ => parts.push((manner, character.to_string())),
    }
}

fn part(manner: Manner, text: &str) -> Markup {
    let barred = if manner.bar {
        html! { span.bar { (text) } }
    } else {
        html! { (text) }
    };
    let sloped = if manner.italic {
        html! { i { (barred) } }
    } else {
        barred
    };
    match manner.level {
        -1 => html! { sub { (sloped) } },
        1 => html! { sup { (sloped) } },
        _ => sloped,
    }
}

/// A unit: superscripts, dots between factors.
pub(super) fn unit(unit: &str) -> Markup {
    label(&text::unit_markup(unit))
}

/// The symbol of a factor or response; nothing when it has none.
pub(super) fn of(context: &Context, name: &str) -> Option<Markup> {
    let symbol = raw(context, name)?;
    Some(label(&format!("${symbol}$")))
}

/// The symbol of a factor or response in the notation of labels; of a name that the workflow does not declare, the one that a
/// test or a fit has for it.
pub(super) fn raw<'a>(context: &'a Context, name: &str) -> Option<&'a str> {
    let factor = context.factors.get(name).map(|factor| factor.symbol.as_str());
    let response = || context.responses.get(name).map(|response| response.symbol.as_str());
    factor
        .or_else(response)
        .map_or_else(|| symbol_of_test(name).or((name == "r2").then_some("R^2")), Some)
        .filter(|symbol| !symbol.is_empty())
}

/// A term such as `Ec*mu^2` with the symbols of its factors; nothing when none of its parts has one.
pub(super) fn term(context: &Context, term: &str) -> Option<Markup> {
    let parts: Vec<(&str, Option<&str>)> = term
        .split('*')
        .map(|part| part.trim().split_once('^').map_or((part.trim(), None), |(f, p)| (f, Some(p))))
        .collect();
    parts.iter().any(|(factor, _)| raw(context, factor).is_some()).then(|| {
        html! {
            @for (i, (factor, power)) in parts.iter().enumerate() {
                @if i > 0 { (PreEscaped("\u{202f}·\u{202f}")) }
                @if let Some(symbol) = of(context, factor) {
                    @if power.is_some() && raw(context, factor).is_some_and(text::is_compound) { "(" (symbol) ")" } @else { (symbol) }
                } @else { (factor) }
                @if let Some(power) = power { sup { (power) } }
            }
        }
    })
}

/// Symbols that are words of their own, and stay as they are among words.
const WORDS: [&str; 3] = ["a", "A", "I"];

/// The symbols of a workflow as they stand in plain words, such as `σ_u`, and the names that have one, with their markup;
/// longer ones first. A symbol that is the same in both is left out.
pub(super) fn known(context: &Context) -> Vec<(String, Markup)> {
    let pairs = context.symbols().into_iter().flat_map(|(name, symbol)| {
        let markup = format!("${symbol}$");
        let set = label(&markup);
        [Line::new(&markup, 1.0).plain, name].map(|plain| (plain, html! { span.sign { (set) } }))
    });
    let mut found: Vec<(String, Markup)> =
        pairs.filter(|(plain, _)| !plain.is_empty() && !WORDS.contains(&plain.as_str())).collect();
    found.sort_by(|a, b| b.0.len().cmp(&a.0.len()).then_with(|| a.0.cmp(&b.0)));
    found.dedup_by(|a, b| a.0 == b.0);
    found
}

/// Plain words with the symbols of the workflow in them as they are set.
pub(super) fn typeset(context: &Context, words: &str) -> Markup {
    let known = known(context);
    let mut parts: Vec<Markup> = Vec::new();
    let (mut rest, mut from, mut before) = (words, 0, None);
    while let Some(letter) = rest[from..].chars().next() {
        let here = &rest[from..];
        let found = known.iter().filter(|_| !before.is_some_and(is_of_a_word)).find(|(plain, _)| {
            here.strip_prefix(plain.as_str()).is_some_and(|after| !after.chars().next().is_some_and(is_of_a_word))
        });
        if let Some((plain, set)) = found {
            parts.push(html! { (&rest[..from]) (set) });
            before = plain.chars().last();
            (rest, from) = (&here[plain.len()..], 0);
        } else {
            (before, from) = (Some(letter), from + letter.len_utf8());
        }
    }
    html! { @for part in &parts { (part) } (rest) }
}

/// Whether a letter beside a symbol makes it a part of a longer word.
fn is_of_a_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || ('\u{300}'..='\u{36f}').contains(&letter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::Factor;

    #[test]
    fn the_notation_of_labels_becomes_markup() {
        let set = |text: &str| label(text).into_string();
        assert_eq!(set(r"$\bar\sigma_c$"), "<i><span class=\"bar\">σ</span></i><sub>c</sub>");
        assert_eq!(set(r"$R^2$"), "<i>R</i><sup>2</sup>");
        assert_eq!(set("a < b & c"), "a &lt; b &amp; c");
        assert_eq!(unit("kg/m^3").into_string(), "kg/m<sup>3</sup>");
    }

    #[test]
    fn what_a_test_gives_has_its_symbol_without_a_declaration() {
        let context = Context::default();
        assert_eq!(raw(&context, "sigma_ci"), Some(r"\sigma_{ci}"));
        assert_eq!(raw(&context, "r2"), Some("R^2"));
        assert_eq!(raw(&context, "cement"), None);
    }

    #[test]
    fn symbols_in_words_are_set_and_words_that_hold_their_letters_are_not() {
        let factor = |symbol: &str| Factor { symbol: symbol.to_owned(), ..Factor::default() };
        let factors = [("Ec", r"E_c"), ("sigma", r"\bar\sigma_c"), ("j", r"(\bar\sigma_c)_j"), ("E", "E")];
        let factors = factors.map(|(name, symbol)| (name.to_owned(), factor(symbol)));
        let context = Context { factors: factors.into(), ..Context::default() };
        let set = |text: &str| typeset(&context, text).into_string();
        let bar = "<i><span class=\"bar\">σ</span></i><sub>c</sub>";
        assert_eq!(
            set("σ\u{304}_c over E_c, <Even E_cx>"),
            format!(
                "<span class=\"sign\">{bar}</span> over <span class=\"sign\"><i>E</i><sub>c</sub></span>, &lt;Even E_cx&gt;"
            )
        );
        assert_eq!(set("E = 3 GPa"), "<span class=\"sign\"><i>E</i></span> = 3 GPa");
        // The longer symbol, and not the one that it holds.
        let plain = Line::new(r"$(\bar\sigma_c)_j$", 1.0).plain;
        assert!(set(&plain).ends_with("<sub>j</sub></span>") && set("").is_empty(), "{plain}: {}", set(&plain));
    }

    #[test]
    fn terms_are_named_by_the_symbols_of_their_factors() {
        let factor = Factor { symbol: "E_c".to_owned(), ..Factor::default() };
        let context = Context { factors: [("Ec".to_owned(), factor)].into(), ..Context::default() };
        let set = |text: &str| term(&context, text).map(maud::PreEscaped::into_string);
        assert_eq!(set("Ec^2").unwrap(), "<i>E</i><sub>c</sub><sup>2</sup>");
        assert!(set("Ec*mu").unwrap().ends_with("·\u{202f}mu"));
        assert_eq!(set("residual"), None);
    }
}
