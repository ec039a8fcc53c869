//! A matrix of values over two columns: each cell shows its number on the colour of its value.
//!
//! Cells follow the order of their heads, not the distances between them. A cell without a value is crossed out. Numbers
//! that would be too small to print are left out; the colour bar remains.

use super::axis::{Axis, extent, fixed, significant};
use super::column::{Column, Values};
use super::contour::Bands;
use super::palette::{GRID, INK, PAPER, SOFT};
use super::panel::{Margins, Panel};
use super::scene::{Anchor, Path, Point, Rect, Scene, Stroke};
use super::text::Line;
use super::xy::capital;
use super::{Figure, Quantity, Style};
use math::elementary::log10;

/// A matrix.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatMap {
    /// The quantity of the rows.
    pub down: Quantity,
    /// The quantity of the columns.
    pub across: Quantity,
    /// The values in the cells.
    pub value: Quantity,
    /// Heads of the rows, from the top.
    pub rows: Vec<String>,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Values row by row; NaN where there is none.
    pub cells: Vec<f64>,
    /// Scatter in each cell, shown below its value; empty to leave out.
    pub scatter: Vec<f64>,
}

const BAR: f64 = 3.0;
const DIGITS: usize = 3;

impl Figure for HeatMap {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let (rows, columns) = (self.rows.len().max(1) as f64, self.columns.len().max(1) as f64);
        let (low, high) = extent(self.cells.iter().copied());
        let bands = Bands::of(low, high, &self.value);
        let mut x = Axis::categories(self.across.title(), &self.columns);
        let mut y = Axis::categories(self.down.title(), &self.rows);
        // the first row stands at the top
        y.ticks.iter_mut().for_each(|t| t.at = rows - 1.0 - t.at);
        let mut margins = Margins::of(&x, &y, style);
        margins.right = bands.width(style) + 2.4;
        let width = style.width - 1.6 - margins.left - margins.right;
        let cell = [width / columns, (0.62 * width / columns).clamp(1.9 * size, 9.0)];
        let mut scene = Scene::new(style.width, (rows * cell[1]).max(30.0) + margins.top + margins.bottom + 1.6);
        shorten(&mut x, &mut y, [width, rows * cell[1]], style);
        thin_out(&mut x, cell[0], size);
        scene.title =
            format!("{} over {} and {}", capital(&self.value.words()), self.down.words(), self.across.words());
        scene.description = self.describe([low, high]);
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let panel = Panel::with_margins(page, margins, x, y);
        let first = scene.items.len();
        self.draw_cells(&mut scene, &panel, [low, high], style);
        scene.group_from(first, None, panel.facts());
        panel.draw_axes(&mut scene, style);
        let bar = Rect::new(panel.area.right + 2.4, panel.area.top, BAR, panel.area.height());
        bands.draw_smooth_bar(&mut scene, bar, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let across = self.columns.len();
        let plain = |text: &String| Line::new(text, 1.0).plain;
        let pairs = || (0..self.cells.len()).map(move |i| (i / across, i % across));
        let name = |q: &Quantity, other: &str| if q.id().is_empty() { other.to_owned() } else { q.id().to_owned() };
        let mut found = vec![
            numbers(&name(&self.down, "row"), pairs().map(|(r, _)| plain(&self.rows[r])).collect(), &self.down),
            numbers(
                &name(&self.across, "column"),
                pairs().map(|(_, c)| plain(&self.columns[c])).collect(),
                &self.across,
            ),
            self.value.column(&name(&self.value, "value"), self.cells.clone()),
        ];
        if !self.scatter.is_empty() {
            found.push(Column::reals("scatter", self.scatter.clone()).with_unit(&self.value.unit));
        }
        found
    }
}

/// Heads as numbers where all of them are numbers.
fn numbers(key: &str, heads: Vec<String>, quantity: &Quantity) -> Column {
    let read: Option<Vec<f64>> = heads.iter().map(|h| h.replace('−', "-").parse().ok()).collect();
    match read {
        Some(values) => quantity.column(key, values),
        None => Column { values: Values::Words(heads), ..Column::reals(key, Vec::new()) },
    }
}

/// Titles that are longer than their side become symbols.
fn shorten(x: &mut Axis, y: &mut Axis, [width, height]: [f64; 2], style: &Style) {
    for (axis, room) in [(x, width), (y, height)] {
        if Line::new(&axis.label, style.size()).width > room
            && let Some((_, short)) = axis.label.split_once('$')
        {
            axis.label = format!("${short}");
        }
    }
}

/// Thins heads of columns that would touch: every second one stays, and so on.
fn thin_out(axis: &mut Axis, pitch: f64, size: f64) {
    let widest = axis.ticks.iter().map(|t| Line::new(&t.label, size).width).fold(0.0, f64::max) + 0.5 * size;
    let every = ((widest / pitch).ceil() as usize).max(1);
    axis.ticks.iter_mut().enumerate().filter(|(i, _)| i % every != 0).for_each(|(_, t)| t.label.clear());
}

impl HeatMap {
    fn draw_cells(&self, scene: &mut Scene, panel: &Panel, [low, high]: [f64; 2], style: &Style) {
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let (w, h) = (panel.area.width() / columns.max(1) as f64, panel.area.height() / rows.max(1) as f64);
        let size = self.number_size([w, h], style);
        for (i, &value) in self.cells.iter().enumerate() {
            let corner = [panel.area.left + (i % columns) as f64 * w, panel.area.top + (i / columns) as f64 * h];
            let place = Rect::new(corner[0], corner[1], w, h);
            if !value.is_finite() {
                scene.shape(Path::rect(place), PAPER, Stroke::new(GRID, 0.2));
                let cross = [[place.left, place.top], [place.right, place.bottom]];
                scene.stroke(Path::polyline(&cross), Stroke::new(GRID, 0.3));
                continue;
            }
            let share = if high > low { (value - low) / (high - low) } else { 0.5 };
            let color = style.map.at(share);
            scene.shape(Path::rect(place), color, Stroke::new(PAPER, 0.25));
            let Some(size) = size else { continue };
            let ink = if color.luminance() < 0.22 { PAPER } else { INK };
            self.draw_number(scene, i, place.centre(), size, ink);
        }
        scene.stroke(Path::rect(panel.area), Stroke::new(SOFT, 0.2));
    }

    fn draw_number(&self, scene: &mut Scene, i: usize, [x, y]: Point, size: f64, ink: super::scene::Color) {
        let (value, scatter) = self.texts(i);
        let up = if scatter.is_some() { 0.55 * size } else { 0.0 };
        scene.text_centred(Line::new(&value, size), [x, y - up], Anchor::Middle, ink);
        if let Some(scatter) = scatter {
            scene.text_centred(Line::new(&scatter, 0.82 * size), [x, y + 0.62 * size], Anchor::Middle, ink);
        }
    }

    /// Value and scatter of a cell as they are printed.
    fn texts(&self, i: usize) -> (String, Option<String>) {
        let scatter = self.scatter.get(i).filter(|s| s.is_finite());
        let (low, high) = extent(self.cells.iter().map(|v| v.abs()).filter(|v| *v > 0.0));
        // all cells have the same number of decimals, unless their magnitudes are far apart
        let decimals = DIGITS as i32 - 1 - log10(high).floor() as i32;
        match usize::try_from(decimals) {
            Ok(d) if d <= 5 && high <= 100.0 * low => {
                (fixed(self.cells[i], d), scatter.map(|s| format!("±{}", fixed(*s, d + 1))))
            }
            _ => (significant(self.cells[i], DIGITS), scatter.map(|s| format!("±{}", significant(*s, 2)))),
        }
    }

    /// Size of the numbers that fits every cell; `None` when that is too small to print.
    fn number_size(&self, [w, h]: [f64; 2], style: &Style) -> Option<f64> {
        let shown = (0..self.cells.len()).filter(|&i| self.cells[i].is_finite());
        let lines = if self.scatter.iter().any(|s| s.is_finite()) { 2.3 } else { 1.2 };
        let width = |i: usize| {
            let (value, scatter) = self.texts(i);
            let below = scatter.map_or(0.0, |s| 0.82 * Line::new(&s, 1.0).width);
            Line::new(&value, 1.0).width.max(below)
        };
        let widest = shown.map(width).fold(0.0, f64::max);
        let size = (0.9 * w / widest).min(h / lines).min(0.95 * style.size());
        // five points
        (size >= 5.0 * super::text::POINT).then_some(size)
    }

    fn describe(&self, [low, high]: [f64; 2]) -> String {
        let empty = self.cells.iter().filter(|v| !v.is_finite()).count();
        let gaps = match empty {
            0 => String::new(),
            1 => "; one cell has no value".to_owned(),
            n => format!("; {n} cells have no value"),
        };
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let text =
            format!("{rows} × {columns} cells from {} to {}{gaps}.", significant(low, 3), self.value.in_words(high));
        Line::new(&text, 1.0).plain
    }
}
