//! A picture as plain data: paths, discs, text and clipped groups on a page.
//!
//! Units are millimetres on the page, origin in the upper left corner, y down. Colours are opaque or carry one
//! opacity. The writers ([`super::svg`], [`super::png`], [`super::pdf`]) draw a scene without choices of their own, so
//! equal scenes give equal bytes.

pub use super::geometry::{Path, Point, Rect, Step, meet};
use super::text::Line;
use math::elementary::sin_cos;
use std::fmt;

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Color(pub u8, pub u8, pub u8);

impl Color {
    /// The colour between `self` (0) and `other` (1), mixed in sRGB.
    pub fn mix(self, other: Self, t: f64) -> Self {
        let part = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).round().clamp(0.0, 255.0) as u8;
        Self(part(self.0, other.0), part(self.1, other.1), part(self.2, other.2))
    }

    /// Relative luminance after WCAG 2 (0 black, 1 white): the grey of the colour in print.
    pub fn luminance(self) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { math::elementary::pow((c + 0.055) / 1.055, 2.4) }
        };
        0.2126 * linear(self.0) + 0.7152 * linear(self.1) + 0.0722 * linear(self.2)
    }

    /// The grey of equal luminance.
    pub fn grey(self) -> Self {
        let y = self.luminance();
        let c = if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * math::elementary::pow(y, 1.0 / 2.4) - 0.055 };
        let c = (c * 255.0).round() as u8;
        Self(c, c, c)
    }
}

/// How a path is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fill {
    /// Colour.
    pub color: Color,
    /// 1 is opaque.
    pub opacity: f64,
}

impl From<Color> for Fill {
    fn from(color: Color) -> Self {
        Self { color, opacity: 1.0 }
    }
}

/// How a path is drawn along its line; ends and corners are round.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width in mm.
    pub width: f64,
    /// Lengths of dashes and gaps in turn, mm; empty is solid.
    pub dash: Vec<f64>,
    /// 1 is opaque.
    pub opacity: f64,
}

impl Stroke {
    /// A solid line.
    pub fn new(color: Color, width: f64) -> Self {
        Self { color, width, dash: Vec::new(), opacity: 1.0 }
    }

    /// Sets the dashes.
    pub fn dashed(mut self, dash: &[f64]) -> Self {
        self.dash = dash.to_vec();
        self
    }

    /// Sets the opacity.
    pub fn with_opacity(mut self, opacity: f64) -> Self {
        self.opacity = opacity;
        self
    }
}

/// One thing on the page; later ones cover earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A filled and stroked path.
    Shape {
        /// Outline.
        path: Path,
        /// Inside.
        fill: Option<Fill>,
        /// Line.
        stroke: Option<Stroke>,
    },
    /// Many discs of one colour; cheap in every format.
    Discs {
        /// Centre and radius of each.
        discs: Vec<(Point, f64)>,
        /// Colour.
        color: Color,
    },
    /// A set line of text.
    Text {
        /// Glyphs relative to the start of the baseline.
        line: Line,
        /// Start of the baseline.
        at: Point,
        /// Degrees anticlockwise.
        angle: f64,
        /// Colour.
        color: Color,
    },
    /// Items drawn together.
    Group {
        /// Nothing is drawn outside.
        clip: Option<Rect>,
        /// Attributes of the group in SVG, `data-…`, for scripts.
        facts: Vec<(&'static str, String)>,
        /// Content.
        items: Vec<Item>,
    },
}

/// A page with its items.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Width in mm.
    pub width: f64,
    /// Height in mm.
    pub height: f64,
    /// Short title, for screen readers and file properties.
    pub title: String,
    /// One or two sentences that describe the picture, for those who cannot see it.
    pub description: String,
    /// Content.
    pub items: Vec<Item>,
}

/// Where a text is placed relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text starts there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

impl Scene {
    /// An empty white page.
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, title: String::new(), description: String::new(), items: Vec::new() }
    }

    /// The whole page.
    pub fn page(&self) -> Rect {
        Rect::new(0.0, 0.0, self.width, self.height)
    }

    /// Fills a path.
    pub fn fill(&mut self, path: Path, fill: impl Into<Fill>) {
        self.items.push(Item::Shape { path, fill: Some(fill.into()), stroke: None });
    }

    /// Draws along a path.
    pub fn stroke(&mut self, path: Path, stroke: Stroke) {
        self.items.push(Item::Shape { path, fill: None, stroke: Some(stroke) });
    }

    /// Fills a path and draws along it.
    pub fn shape(&mut self, path: Path, fill: impl Into<Fill>, stroke: Stroke) {
        self.items.push(Item::Shape { path, fill: Some(fill.into()), stroke: Some(stroke) });
    }

    /// Sets a line of text on its baseline at `at`, turned by `angle` degrees anticlockwise around that point.
    pub fn text(&mut self, line: Line, at: Point, anchor: Anchor, angle: f64, color: Color) {
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => line.width / 2.0,
            Anchor::End => line.width,
        };
        let (s, c) = sin_cos(angle.to_radians());
        let at = [at[0] - shift * c, at[1] + shift * s];
        self.items.push(Item::Text { line, at, angle, color });
    }

    /// Sets a text whose middle line of capitals is at `at`: labels beside ticks and markers.
    pub fn text_centred(&mut self, line: Line, at: Point, anchor: Anchor, color: Color) {
        let drop = line.size * super::text::CAP_HEIGHT / 2.0;
        self.text(line, [at[0], at[1] + drop], anchor, 0.0, color);
    }

    /// Puts all items from number `first` on into one group.
    pub fn group_from(&mut self, first: usize, clip: Option<Rect>, facts: Vec<(&'static str, String)>) {
        let items = self.items.split_off(first);
        self.items.push(Item::Group { clip, facts, items });
    }

    /// Every text with the corners of its area, groups included.
    pub fn texts(&self) -> Vec<(String, [Point; 4])> {
        fn walk(items: &[Item], out: &mut Vec<(String, [Point; 4])>) {
            for item in items {
                match item {
                    Item::Text { line, at, angle, .. } => out.push((line.plain.clone(), line.corners(*at, *angle))),
                    Item::Group { items, .. } => walk(items, out),
                    Item::Shape { .. } | Item::Discs { .. } => {}
                }
            }
        }
        let mut out = Vec::new();
        walk(&self.items, &mut out);
        out
    }

    /// Faults of the layout: text beyond the page, text over text. Empty when there are none.
    pub fn faults(&self) -> Vec<String> {
        let texts = self.texts();
        let page = self.page();
        let mut faults = Vec::new();
        for (i, (text, place)) in texts.iter().enumerate() {
            if Rect::around(*place).is_some_and(|r| !page.holds(&r)) {
                faults.push(format!("“{text}” leaves the page: {place:.1?}"));
            }
            let over = texts[..i].iter().filter(|(_, other)| meet(place, other));
            faults.extend(over.map(|(other, _)| format!("“{text}” covers “{other}”")));
        }
        faults
    }
}

/// One line per item with its position, to compare and to read.
impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "page {:.2} x {:.2} mm: {}", self.width, self.height, self.title)?;
        self.items.iter().try_for_each(|item| show(f, item, 1))
    }
}

fn show(f: &mut fmt::Formatter<'_>, item: &Item, depth: usize) -> fmt::Result {
    write!(f, "{:1$}", "", 2 * depth)?;
    let place = |r: Rect| format!("{:.2} {:.2} .. {:.2} {:.2}", r.left, r.top, r.right, r.bottom);
    match item {
        Item::Shape { path, fill, stroke } => {
            let bounds = path.bounds().map(place).unwrap_or_default();
            write!(f, "path {bounds} steps {}", path.0.len())?;
            if let Some(Fill { color: Color(r, g, b), opacity }) = fill {
                write!(f, " fill {r:02x}{g:02x}{b:02x} {opacity:.2}")?;
            }
            if let Some(Stroke { color: Color(r, g, b), width, dash, opacity }) = stroke {
                write!(f, " stroke {r:02x}{g:02x}{b:02x} {width:.2} {dash:?} {opacity:.2}")?;
            }
            writeln!(f)
        }
        Item::Discs { discs, color: Color(r, g, b) } => writeln!(f, "discs {} {r:02x}{g:02x}{b:02x}", discs.len()),
        Item::Text { line, at, angle, .. } => {
            writeln!(f, "text {:.2} {:.2} angle {angle:.0} size {:.2} “{}”", at[0], at[1], line.size, line.plain)
        }
        Item::Group { clip, items, .. } => {
            writeln!(f, "group {}", clip.map(place).unwrap_or_default())?;
            items.iter().try_for_each(|item| show(f, item, depth + 1))
        }
    }
}
