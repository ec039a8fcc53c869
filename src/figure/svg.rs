//! Scene → SVG: small, deterministic, no font needed by the reader.
//!
//! Every glyph is defined once as an outline in font units and placed by `<use>`; its id names face and glyph, so
//! pictures may share a page. Text carries its words as an `aria-label`. Clips are nested `<svg>` views and need no
//! id. Discs are zero-length lines with round ends, one path per radius class of 0.01 mm.

use super::escape::xml;
use super::font::{Face, UNITS_PER_EM};
use super::scene::{Color, Fill, Item, Path, Point, Rect, Scene, Step, Stroke};
use super::text::Line;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The picture as SVG text.
pub fn svg(scene: &Scene) -> String {
    let mut body = String::new();
    let mut glyphs = BTreeSet::new();
    for item in &scene.items {
        write_item(&mut body, &mut glyphs, item);
    }
    document(scene, "", &body, glyphs)
}

/// The items as a picture with the page, title and words of `scene`, and a style sheet; an item may have a class of it.
pub(super) fn moving(scene: &Scene, style: &str, items: &[(&Item, Option<String>)]) -> String {
    let mut body = String::new();
    let mut glyphs = BTreeSet::new();
    for (item, class) in items {
        if let Some(class) = class {
            put(&mut body, format_args!("<g class=\"{class}\">\n"));
        }
        write_item(&mut body, &mut glyphs, item);
        if class.is_some() {
            body += "</g>\n";
        }
    }
    document(scene, style, &body, glyphs)
}

fn document(scene: &Scene, style: &str, body: &str, glyphs: BTreeSet<(Face, u16)>) -> String {
    let (w, h) = (number(scene.width), number(scene.height));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" role=\"img\">\n"
    );
    put(&mut out, format_args!("<title>{}</title>\n", xml(&scene.title)));
    if !scene.description.is_empty() {
        put(&mut out, format_args!("<desc>{}</desc>\n", xml(&scene.description)));
    }
    if !style.is_empty() {
        put(&mut out, format_args!("<style>\n{style}</style>\n"));
    }
    if !glyphs.is_empty() {
        out += "<defs>\n";
        for (face, id) in glyphs {
            let (letter, outline) = (face.letter(), outline(face, id));
            put(&mut out, format_args!("<path id=\"{letter}{id}\" fill-rule=\"nonzero\" d=\"{outline}\"/>\n"));
        }
        out += "</defs>\n";
    }
    put(&mut out, format_args!("<path fill=\"#fff\" d=\"M0 0H{w}V{h}H0Z\"/>\n"));
    out += "<g fill-rule=\"evenodd\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n";
    out += body;
    out += "</g>\n</svg>\n";
    out
}

/// Writing to a `String` cannot fail.
fn put(out: &mut String, what: std::fmt::Arguments) {
    let _ = out.write_fmt(what);
}

fn write_item(out: &mut String, glyphs: &mut BTreeSet<(Face, u16)>, item: &Item) {
    match item {
        Item::Shape { path, fill, stroke } => shape(out, path, fill.as_ref(), stroke.as_ref()),
        Item::Discs { discs, color } => write_discs(out, discs, *color),
        Item::Text { line, at, angle, color } => text(out, glyphs, line, *at, *angle, *color),
        Item::Group { clip, facts, items } => {
            let facts: String = facts.iter().map(|(k, v)| format!(" data-{k}=\"{}\"", xml(v))).collect();
            if !facts.is_empty() || clip.is_none() {
                put(out, format_args!("<g{facts}>\n"));
            }
            if let Some(Rect { left, top, .. }) = clip {
                let c = clip.unwrap_or(Rect::new(0.0, 0.0, 0.0, 0.0));
                let (x, y, w, h) = (number(*left), number(*top), number(c.width()), number(c.height()));
                put(
                    out,
                    format_args!(
                        "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\">\n"
                    ),
                );
            }
            for item in items {
                write_item(out, glyphs, item);
            }
            if clip.is_some() {
                *out += "</svg>\n";
            }
            if !facts.is_empty() || clip.is_none() {
                *out += "</g>\n";
            }
        }
    }
}

fn shape(out: &mut String, path: &Path, fill: Option<&Fill>, stroke: Option<&Stroke>) {
    if path.0.is_empty() {
        return;
    }
    *out += "<path";
    match fill {
        None => *out += " fill=\"none\"",
        Some(fill) => {
            put(out, format_args!(" fill=\"{}\"", hex(fill.color)));
            if fill.opacity < 1.0 {
                put(out, format_args!(" fill-opacity=\"{}\"", number(fill.opacity)));
            }
        }
    }
    if let Some(stroke) = stroke {
        put(out, format_args!(" stroke=\"{}\" stroke-width=\"{}\"", hex(stroke.color), number(stroke.width)));
        if stroke.opacity < 1.0 {
            put(out, format_args!(" stroke-opacity=\"{}\"", number(stroke.opacity)));
        }
        if !stroke.dash.is_empty() {
            let dash: Vec<String> = stroke.dash.iter().map(|&d| number(d)).collect();
            put(out, format_args!(" stroke-dasharray=\"{}\"", dash.join(" ")));
        }
    }
    put(out, format_args!(" d=\"{}\"/>\n", path_data(path)));
}

/// Relative steps on a grid of 0.01 mm: short, and rounding does not add up.
fn path_data(path: &Path) -> String {
    let mut d = String::new();
    let (mut here, mut start) = ([0_i64; 2], [0_i64; 2]);
    // Nothing that far off the page is seen.
    const FAR: f64 = 1e9;
    let grid = |p: Point| p.map(|v| 10 * (v.clamp(-FAR, FAR) * 100.0).round() as i64);
    let mut last = ' ';
    for step in &path.0 {
        match *step {
            Step::Move(p) => {
                let p = grid(p);
                put(&mut d, format_args!("M{}{}", thousandth(p[0]), joined(p[1])));
                (here, start, last) = (p, p, 'M');
            }
            Step::Line(p) => {
                let p = grid(p);
                let (dx, dy) = (p[0] - here[0], p[1] - here[1]);
                match (dx, dy) {
                    (0, 0) if last != 'M' => continue,
                    (_, 0) => put(&mut d, format_args!("h{}", thousandth(dx))),
                    (0, _) => put(&mut d, format_args!("v{}", thousandth(dy))),
                    _ if last == 'l' => put(&mut d, format_args!("{}{}", joined(dx), joined(dy))),
                    _ => put(&mut d, format_args!("l{}{}", thousandth(dx), joined(dy))),
                }
                last = if dx == 0 || dy == 0 { 'h' } else { 'l' };
                here = p;
            }
            Step::Cubic(a, b, p) => {
                let points = [grid(a), grid(b), grid(p)];
                d.push('c');
                for (i, q) in points.iter().enumerate() {
                    let x = if i == 0 { thousandth(q[0] - here[0]) } else { joined(q[0] - here[0]) };
                    put(&mut d, format_args!("{x}{}", joined(q[1] - here[1])));
                }
                (here, last) = (points[2], 'c');
            }
            Step::Close => {
                d.push('z');
                (here, last) = (start, 'z');
            }
        }
    }
    d
}

/// A whole number of thousandths as a decimal without needless signs.
fn thousandth(n: i64) -> String {
    let (sign, a) = (if n < 0 { "-" } else { "" }, n.unsigned_abs());
    let (whole, part) = (a / 1000, a % 1000);
    if part == 0 {
        return format!("{sign}{whole}");
    }
    let fraction = format!("{part:03}");
    let fraction = fraction.trim_end_matches('0');
    if whole == 0 { format!("{sign}.{fraction}") } else { format!("{sign}{whole}.{fraction}") }
}

/// The same after another number: with a blank unless a minus sign separates the two.
fn joined(n: i64) -> String {
    let text = thousandth(n);
    if text.starts_with('-') { text } else { format!(" {text}") }
}

/// A length with three decimals at most.
pub(super) fn number(x: f64) -> String {
    thousandth((x * 1e3).round() as i64)
}

fn write_discs(out: &mut String, discs: &[(Point, f64)], color: Color) {
    let mut classes: BTreeMap<i64, Vec<[i64; 2]>> = BTreeMap::new();
    for (p, r) in discs {
        let key = ((2.0 * r * 100.0).round() as i64).max(1);
        classes.entry(key).or_default().push([(p[0] * 100.0).round() as i64, (p[1] * 100.0).round() as i64]);
    }
    put(out, format_args!("<g fill=\"none\" stroke=\"{}\" transform=\"scale(.01)\">\n", hex(color)));
    for (width, centres) in classes {
        put(out, format_args!("<path stroke-width=\"{width}\" d=\"M"));
        let mut last = [0, 0];
        for (i, c) in centres.iter().enumerate() {
            let (dx, dy) = (c[0] - last[0], c[1] - last[1]);
            let gap = if dy < 0 { "" } else { " " };
            put(out, format_args!("{}{dx}{gap}{dy}h0", if i == 0 { "" } else { "m" }));
            last = *c;
        }
        *out += "\"/>\n";
    }
    *out += "</g>\n";
}

fn text(out: &mut String, glyphs: &mut BTreeSet<(Face, u16)>, line: &Line, at: Point, angle: f64, color: Color) {
    let turn = if angle == 0.0 { String::new() } else { format!(" rotate({})", number(-angle)) };
    put(
        out,
        format_args!(
            "<g role=\"text\" aria-label=\"{}\" fill=\"{}\" transform=\"translate({} {}){turn}\">",
            xml(&line.plain),
            hex(color),
            number(at[0]),
            number(at[1])
        ),
    );
    let mut open: Option<f64> = None;
    for g in line.glyphs.iter().filter(|g| g.face.extent(g.id) != [0.0; 4]) {
        let scale = g.size / UNITS_PER_EM;
        if open != Some(g.size) {
            if open.is_some() {
                *out += "</g>";
            }
            put(out, format_args!("<g transform=\"scale({scale:.6} -{scale:.6})\">"));
            open = Some(g.size);
        }
        glyphs.insert((g.face, g.id));
        let (x, y) = ((g.at[0] / scale).round(), (-g.at[1] / scale).round());
        put(out, format_args!("<use href=\"#{}{}\"", g.face.letter(), g.id));
        for (name, v) in [("x", x), ("y", y)] {
            if v != 0.0 {
                put(out, format_args!(" {name}=\"{v}\""));
            }
        }
        *out += "/>";
    }
    if open.is_some() {
        *out += "</g>";
    }
    for &rule in &line.rules {
        put(out, format_args!("<path d=\"{}\"/>", path_data(&Path::rect(rule))));
    }
    *out += "</g>\n";
}

/// Absolute steps in whole font units.
struct Outline(String);

impl ttf_parser::OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        put(&mut self.0, format_args!("M{x} {y}"));
    }
    fn line_to(&mut self, x: f32, y: f32) {
        put(&mut self.0, format_args!("L{x} {y}"));
    }
    fn quad_to(&mut self, a: f32, b: f32, x: f32, y: f32) {
        put(&mut self.0, format_args!("Q{a} {b} {x} {y}"));
    }
    fn curve_to(&mut self, a: f32, b: f32, c: f32, d: f32, x: f32, y: f32) {
        put(&mut self.0, format_args!("C{a} {b} {c} {d} {x} {y}"));
    }
    fn close(&mut self) {
        self.0.push('Z');
    }
}

fn outline(face: Face, id: u16) -> String {
    let mut builder = Outline(String::new());
    face.outline(id, &mut builder);
    builder.0
}

fn hex(Color(r, g, b): Color) -> String {
    if [r, g, b].iter().all(|c| c % 17 == 0) {
        return format!("#{:x}{:x}{:x}", r / 17, g / 17, b / 17);
    }
    format!("#{r:02x}{g:02x}{b:02x}")
}
