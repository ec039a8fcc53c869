//! A figure of the page: the picture, the words for those who cannot see it, and its values.

use super::paper::{Paper, Part, State, sentence};
use super::{svg, symbol, values};
use crate::artifact::presentation::Picture;
use maud::{Markup, PreEscaped, html};
use std::collections::BTreeMap;

/// Outlines of glyphs that the pictures of a page share.
#[derive(Default)]
pub(super) struct Glyphs(BTreeMap<String, String>);

impl Glyphs {
    /// The outlines, once, out of sight.
    pub(super) fn markup(&self) -> Markup {
        let paths = self.0.iter().map(|(id, outline)| format!("<path id=\"{id}\" d=\"{outline}\"/>"));
        html! {
            svg.glyphs width="0" height="0" aria-hidden="true" focusable="false" {
                defs { (PreEscaped(paths.collect::<String>())) }
            }
        }
    }

    /// A picture of ours in the page; nothing when it is not one.
    pub(super) fn inline(&mut self, text: &str, label: &str) -> Option<(Markup, [f64; 2])> {
        let drawing = svg::read(text)?;
        // A page has one outline per id: of two that differ the first is used.
        for (id, outline) in drawing.glyphs {
            self.0.entry(id).or_insert(outline);
        }
        let [width, height] = drawing.size;
        let markup = html! {
            svg role="img" aria-label=(label) viewBox={ "0 0 " (width) " " (height) } width={ (width) "mm" } height={ (height) "mm" } {
                (PreEscaped(drawing.body))
            }
        };
        Some((markup, drawing.size))
    }
}

/// Pictures wider than this, in mm, take the width of the page.
const SINGLE: f64 = 120.0;

/// SVG larger than this many bytes gives way to PNG when that is smaller.
const LARGE: usize = 600_000;

/// A note in place of a missing result, with the command that computes it.
pub(super) fn missing(paper: &Paper, part: &Part) -> Markup {
    // A section of its own bears the id; a table or figure bears it here.
    let id = part.is_shown_elsewhere().then(|| format!("stage-{}", part.name));
    html! {
        div.missing id=[id] role="note" {
            p {
                b { @if part.is_shown_elsewhere() { (part.words()) ": no result" } @else { "No result" } }
                @match &part.state {
                    State::Broken(why) => { ": " (why) },
                    State::Missing | State::Done { .. } => { " yet." },
                }
            }
            p { code { (paper.command("run", &part.name)) } }
        }
    }
}

/// A figure in the section of the stage that it shows.
pub(super) fn figure(paper: &Paper, part: &Part, glyphs: &mut Glyphs) -> Markup {
    let Some(artifact) = part.artifact() else { return missing(paper, part) };
    let Ok(drawn) = Picture::from_artifact(artifact) else { return unshown(part) };
    let title = &drawn.title;
    let description = sentence(drawn.description.trim_start_matches([':', ' ']));
    let label = if description.is_empty() { title.clone() } else { format!("{title}. {description}") };
    let show = part.settings["show"].as_str().unwrap_or_default();
    // Fields of colour with labels in them are shown on paper in both themes.
    let ground = if matches!(show, "contour" | "surface") { "paper" } else { "ink" };
    let Some((picture, width, vector)) = picture(&drawn, &label, glyphs) else { return unshown(part) };
    let numbers = Some(&drawn.data).filter(|_| vector).and_then(|data| values::of(show, data, &paper.context));
    let set = |words: &str| symbol::typeset(&paper.context, words);
    html! {
        figure id={ "stage-" (part.name) } class=(if width > SINGLE { "double" } else { "single" }) {
            div class={ "plot " (ground) } { (picture) }
            @if let Some(moving) = &drawn.moving { (in_motion(moving, title)) }
            @if let Some(numbers) = numbers {
                script.values type="application/json" { (PreEscaped(values::in_script(&numbers))) }
            }
            figcaption {
                b { (part.words()) "." } " "
                @if let Some(caption) = part.settings["caption"].as_str() { (symbol::label(caption)) } @else { (set(title)) "." }
                @if !description.is_empty() { " " span { (set(&description)) } }
            }
        }
    }
}

/// The picture that moves, which is seen while its element is open: as an image, in which no script runs.
fn in_motion(moving: &str, title: &str) -> Markup {
    let data = format!("data:image/svg+xml;base64,{}", base64(moving.as_bytes()));
    html! {
        details.motion {
            summary { "In motion" }
            img src=(data) alt={ (title) ", in motion" } loading="lazy";
        }
    }
}

fn unshown(part: &Part) -> Markup {
    html! { p.missing { "The picture of " code { (part.name) } " cannot be shown." } }
}

/// The picture, its width in mm, and whether it is drawn in lines.
fn picture(drawn: &Picture, label: &str, glyphs: &mut Glyphs) -> Option<(Markup, f64, bool)> {
    let (svg, png) = (drawn.svg.as_str(), drawn.png.as_slice());
    let small = svg.len() <= LARGE || png.is_empty() || png.len() / 3 * 4 >= svg.len();
    if let Some((markup, [width, _])) = Some(svg).filter(|_| small).and_then(|svg| glyphs.inline(svg, label)) {
        return Some((markup, width, true));
    }
    let [width, height] = png_size(png)?;
    // Written at 300 dots per inch.
    let millimetres = f64::from(width) / 300.0 * 25.4;
    let data = format!("data:image/png;base64,{}", base64(png));
    Some((html! { img src=(data) alt=(label) width=(width) height=(height) loading="lazy"; }, millimetres, false))
}

/// Width and height of a PNG, in pixels.
fn png_size(png: &[u8]) -> Option<[u32; 2]> {
    let head = png.strip_prefix(b"\x89PNG\r\n\x1a\n")?.get(4..16)?.strip_prefix(b"IHDR")?;
    let number = |at: usize| Some(u32::from_be_bytes(head.get(at..at + 4)?.try_into().ok()?));
    Some([number(0)?, number(4)?])
}

/// Bytes in the 64 letters of RFC 4648.
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= three.len() { letter } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        // RFC 4648, section 10.
        let known =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in known {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xff, 0xfe, 0xfd]), "//79");
    }

    #[test]
    fn the_size_of_a_png_is_in_its_head() {
        let scene = figure::scene::Scene::new(25.4, 50.8);
        let png = figure::png::png(&scene, 300.0).unwrap();
        assert_eq!(png_size(&png), Some([300, 600]));
        assert_eq!(png_size(b"GIF89a"), None);
        assert_eq!(png_size(&png[..20]), None);
    }
}
