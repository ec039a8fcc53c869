//! Letting a stored picture into the page: only what [`figure::svg`] writes gets through.
//!
//! A store may come from anywhere, and SVG in a page could carry scripts, styles and addresses. This reads the few
//! elements and attributes that our own writer uses, checks every value against the characters it can hold, and refuses
//! the whole picture at anything else. On the way it takes out what a page needs once or not at all: outlines of glyphs
//! are shared by all pictures, labels inside give way to the one description of the whole, the white ground to the
//! page's own.

use std::collections::BTreeMap;
use std::fmt::Write;

/// A picture that can stand in the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawing {
    /// Width and height, mm.
    pub(super) size: [f64; 2],
    /// What is inside of its `svg` element.
    pub(super) body: String,
    /// Outlines of the glyphs it uses, by id.
    pub(super) glyphs: BTreeMap<String, String>,
}

/// Deepest nesting.
const DEEPEST: usize = 24;

/// The picture, or nothing when it holds anything that ours do not.
pub(super) fn read(text: &str) -> Option<Drawing> {
    let mut drawing = Drawing::default();
    let mut open: Vec<Name> = Vec::new();
    let mut rest = text.trim();
    let mut began = false;
    while let Some(at) = rest.find('<') {
        let words = matches!(open.last(), Some(Name::Title | Name::Desc));
        if !words && !rest[..at].trim().is_empty() {
            return None;
        }
        let end = rest[at..].find('>')? + at;
        let tag = &rest[at + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            let closed = open.pop()?;
            if closed != Name::of(name)? {
                return None;
            }
            if !open.is_empty() && matches!(closed, Name::G | Name::Svg) {
                let _ = write!(drawing.body, "</{name}>");
            }
            continue;
        }
        let (tag, empty) = tag.strip_suffix('/').map_or((tag, false), |tag| (tag, true));
        let tag = Tag::read(tag)?;
        if open.is_empty() {
            if std::mem::replace(&mut began, true) || tag.name != Name::Svg || empty {
                return None;
            }
            drawing.size = tag.page()?;
        } else {
            drawing.take(&tag, empty, &open)?;
        }
        if !empty {
            open.push(tag.name);
        }
        if open.len() > DEEPEST {
            return None;
        }
    }
    (began && open.is_empty() && rest.trim().is_empty()).then_some(drawing)
}

impl Drawing {
    fn take(&mut self, tag: &Tag, empty: bool, open: &[Name]) -> Option<()> {
        let in_defs = open.last() == Some(&Name::Defs);
        match tag.name {
            Name::Title | Name::Desc | Name::Defs => return (!empty).then_some(()),
            Name::Path if in_defs => {
                let (id, outline) = (tag.get("id")?, tag.get("d")?);
                self.glyphs.insert(id.to_owned(), outline.to_owned());
                return empty.then_some(());
            }
            Name::Path | Name::Use if !empty => return None,
            Name::Path if self.is_ground(tag) => return Some(()),
            Name::Svg | Name::G | Name::Path | Name::Use if !in_defs => {}
            Name::Svg | Name::G | Name::Path | Name::Use => return None,
        }
        self.body.push('<');
        self.body += tag.name.word();
        for (name, value) in &tag.attributes {
            // Labels of parts: the picture is one image with one description.
            if *name != "role" && *name != "aria-label" {
                let _ = write!(self.body, " {name}=\"{value}\"");
            }
        }
        self.body += if empty { "/>" } else { ">" };
        Some(())
    }

    /// Whether this paints the whole page white.
    fn is_ground(&self, tag: &Tag) -> bool {
        self.body.is_empty() && tag.get("fill") == Some("#fff") && tag.get("d").is_some_and(|d| d.starts_with("M0 0H"))
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Name {
    Svg,
    G,
    Path,
    Use,
    Title,
    Desc,
    Defs,
}

impl Name {
    const ALL: [Self; 7] = [Self::Svg, Self::G, Self::Path, Self::Use, Self::Title, Self::Desc, Self::Defs];

    fn word(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::G => "g",
            Self::Path => "path",
            Self::Use => "use",
            Self::Title => "title",
            Self::Desc => "desc",
            Self::Defs => "defs",
        }
    }

    fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|name| name.word() == word)
    }
}

/// A start tag.
struct Tag<'a> {
    name: Name,
    attributes: Vec<(&'a str, &'a str)>,
}

impl<'a> Tag<'a> {
    fn read(text: &'a str) -> Option<Self> {
        let (name, mut rest) = text.split_once(' ').unwrap_or((text, ""));
        let name = Name::of(name)?;
        let mut attributes = Vec::new();
        while !rest.trim_start().is_empty() {
            let (attribute, after) = rest.trim_start().split_once("=\"")?;
            let (value, after) = after.split_once('"')?;
            if attribute != "xmlns" {
                allowed(attribute, value).then(|| attributes.push((attribute, value)))?;
            }
            rest = after;
        }
        Some(Self { name, attributes })
    }

    fn get(&self, name: &str) -> Option<&'a str> {
        self.attributes.iter().find(|(n, _)| *n == name).map(|(_, value)| *value)
    }

    /// Width and height of the page, from its view.
    fn page(&self) -> Option<[f64; 2]> {
        let view = self.get("viewBox")?.strip_prefix("0 0 ")?;
        let (width, height) = view.split_once(' ')?;
        let length = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
        Some([length(width)?, length(height)?])
    }
}

/// Whether our writer has this attribute, and the value is of the characters it can have.
fn allowed(name: &str, value: &str) -> bool {
    let of = |more: &str| value.chars().all(|c| c.is_ascii_alphanumeric() || more.contains(c));
    let glyph = |id: &str| {
        id.strip_prefix(['r', 'i', 'b'])
            .is_some_and(|n| !n.is_empty() && n.len() < 6 && n.bytes().all(|b| b.is_ascii_digit()))
    };
    match name {
        "href" => value.strip_prefix('#').is_some_and(glyph),
        "id" => glyph(value),
        "role" | "aria-label" => true,
        "fill" | "stroke" => of("#"),
        "d" | "viewBox" | "data-x" | "data-y" | "data-space" => of(" .-"),
        "transform" => of(" .-()"),
        "x" | "y" | "width" | "height" | "fill-opacity" | "stroke-width" | "stroke-opacity" => of(".-"),
        "stroke-dasharray" => of(" ."),
        "fill-rule" | "stroke-linecap" | "stroke-linejoin" => of(""),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use figure::dag::{Dag, Stage};
    use figure::{Figure, Style, svg::svg};

    fn ours() -> String {
        let stage = |name: &str| Stage { name: name.to_owned(), note: "<b>&\"".to_owned(), class: 0 };
        let dag = Dag { stages: vec![stage("a"), stage("b")], edges: vec![(0, 1)], classes: vec!["done".to_owned()] };
        svg(&dag.scene(&Style::wide(90.0)))
    }

    #[test]
    fn a_picture_of_ours_passes_and_keeps_its_shapes() {
        let text = ours();
        let drawing = read(&text).unwrap();
        assert_eq!(drawing.size[0], 90.0);
        let count = |text: &str, what: &str| text.matches(what).count();
        assert_eq!(count(&text, "<use "), count(&drawing.body, "<use "));
        // The outlines of glyphs and the ground are apart.
        assert_eq!(count(&text, "<path "), count(&drawing.body, "<path ") + drawing.glyphs.len() + 1);
        assert_eq!(count(&drawing.body, "<g"), count(&drawing.body, "</g>"));
        assert!(!drawing.body.contains("aria-label") && !drawing.body.contains("&quot;"));
    }

    #[test]
    fn anything_else_is_refused() {
        let with =
            |inside: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\">{inside}</svg>");
        assert!(read(&with("<g fill=\"#fff\"></g><path d=\"M1 1\"/>")).is_some());
        for bad in [
            "<script>alert(1)</script>",
            "<g onclick=\"alert(1)\"></g>",
            "<g style=\"background:url(x)\"></g>",
            "<path fill=\"url(http://x)\" d=\"M1 1\"/>",
            "<use href=\"http://x#r1\"/>",
            "<use href=\"#page\"/>",
            "<image href=\"#r1\"/>",
            "<foreignObject></foreignObject>",
            "<g>text</g>",
            "<g><path d=\"M1 1\"/>",
            "</svg><img src=\"x\">",
            "<path d=\"M1 1\"></path>",
            "<!-- --><g></g>",
            "<defs><g></g></defs>",
            "<defs><path id=\"top\" d=\"M1 1\"/></defs>",
            "<g fill=#fff></g>",
        ] {
            assert_eq!(read(&with(bad)), None, "{bad}");
        }
        assert_eq!(read(&with("<title><img src=\"x\"></title>")), None);
        assert_eq!(read(&(with("") + "<svg></svg>")), None);
        assert_eq!(read(&with(&("<g>".repeat(99) + &"</g>".repeat(99)))), None);
        assert_eq!(read(""), None);
    }
}
