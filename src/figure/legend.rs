//! The key of a picture: rows of swatches and names above the plot, so that it never covers data.

use super::Style;
use super::palette::{INK, Marker, PAPER};
use super::panel::{draw_marker, marker};
use super::scene::{Anchor, Color, Path, Point, Rect, Scene, Stroke};
use super::text::Line;

/// The symbol before a name.
#[derive(Clone, Debug)]
pub enum Swatch {
    /// None: the name is a heading for the entries after it.
    Nothing,
    /// A line, with a marker on it when given.
    Line(Stroke, Option<Marker>),
    /// A marker.
    Point(Marker, Color),
    /// A marker with a line around it and nothing inside.
    Hollow(Marker),
    /// A filled box.
    Box(Color),
    /// A filled box that lets the ground through.
    Band(Color, f64),
}

/// One name with its swatch.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name in the markup of [`super::text`].
    pub name: String,
    /// Swatch.
    pub swatch: Swatch,
}

impl Entry {
    /// A name with its swatch.
    pub fn new(name: impl Into<String>, swatch: Swatch) -> Self {
        Self { name: name.into(), swatch }
    }
}

const LINE: f64 = 6.0;
const BOX: f64 = 2.6;
const GAP: f64 = 1.2;
const BETWEEN: f64 = 4.2;

fn swatch_width(swatch: &Swatch) -> f64 {
    match swatch {
        Swatch::Nothing => -GAP,
        Swatch::Line(..) => LINE,
        Swatch::Point(..) | Swatch::Hollow(_) => 2.0,
        Swatch::Box(_) | Swatch::Band(..) => BOX,
    }
}

/// Entries broken into rows that fit the width: (entry, x) per row.
fn rows(entries: &[Entry], width: f64, size: f64) -> Vec<Vec<(&Entry, f64)>> {
    let mut rows: Vec<Vec<(&Entry, f64)>> = vec![Vec::new()];
    let mut x = 0.0;
    for entry in entries {
        let need = swatch_width(&entry.swatch) + GAP + Line::new(&entry.name, size).width;
        if x > 0.0 && x + need > width {
            rows.push(Vec::new());
            x = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((entry, x));
        }
        x += need + BETWEEN;
    }
    rows.retain(|r| !r.is_empty());
    rows
}

/// Height in mm of the legend when set into this width.
pub fn height(entries: &[Entry], width: f64, style: &Style) -> f64 {
    rows(entries, width, style.size()).len() as f64 * 1.45 * style.size()
}

/// Draws the legend with its upper left corner at the corner of `place`.
pub fn draw(scene: &mut Scene, entries: &[Entry], place: Rect, style: &Style) {
    let size = style.size();
    for (i, row) in rows(entries, place.width(), size).into_iter().enumerate() {
        let y = place.top + (i as f64 + 0.5) * 1.45 * size;
        for (entry, dx) in row {
            let x = place.left + dx;
            draw_swatch(scene, &entry.swatch, [x, y]);
            let at = [x + swatch_width(&entry.swatch) + GAP, y];
            scene.text_centred(Line::new(&entry.name, size), at, Anchor::Start, INK);
        }
    }
}

/// Draws the entries one below the other, from the upper left corner of `place` down.
pub fn draw_stacked(scene: &mut Scene, entries: &[Entry], [x, y]: Point, style: &Style) {
    for (i, entry) in entries.iter().enumerate() {
        let place = Rect::new(x, y + i as f64 * 1.45 * style.size(), f64::INFINITY, 0.0);
        draw(scene, std::slice::from_ref(entry), place, style);
    }
}

fn draw_swatch(scene: &mut Scene, swatch: &Swatch, [x, y]: Point) {
    let patch = Rect::new(x, y - BOX / 2.0, BOX, BOX);
    match swatch {
        Swatch::Nothing => {}
        Swatch::Line(stroke, mark) => {
            scene.stroke(Path::polyline(&[[x + 0.2, y], [x + LINE - 0.2, y]]), stroke.clone());
            if let Some(kind) = mark {
                draw_marker(scene, *kind, [x + LINE / 2.0, y], 1.7, stroke.color);
            }
        }
        Swatch::Point(kind, color) => draw_marker(scene, *kind, [x + 1.0, y], 1.9, *color),
        Swatch::Hollow(kind) => scene.shape(marker(*kind, [x + 1.0, y], 1.6), PAPER, Stroke::new(INK, 0.22)),
        Swatch::Box(color) => scene.fill(Path::rect(patch), *color),
        Swatch::Band(color, opacity) => {
            scene.fill(Path::rect(patch), super::scene::Fill { color: *color, opacity: *opacity });
        }
    }
}
