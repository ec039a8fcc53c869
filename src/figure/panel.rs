//! One pair of axes on the page: frame, grid, ticks, titles; values → points on the page.

use super::Style;
use super::axis::{Axis, Scale, Tick};
use super::palette::{GRID, INK, Marker, SOFT};
use super::scene::{Anchor, Color, Path, Point, Rect, Scene, Stroke};
use super::text::{CAP_HEIGHT, Line, plain_text};

/// Length of a tick in mm.
const TICK: f64 = 0.8;
const GAP: f64 = 0.9;
const TITLE_GAP: f64 = 1.5;
/// Margin on the page beside the longest title, mm.
pub(super) const RIM: f64 = 1.0;

/// A plot area with its axes.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The area between the axes.
    pub area: Rect,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Distance of the vertical axis' title from the area in mm.
    pub left: f64,
    /// Whether lines close the area above and on the right.
    pub boxed: bool,
}

/// Room that tick labels and titles take outside the plot area: left, top, right, bottom in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Left of the area.
    pub left: f64,
    /// Above it.
    pub top: f64,
    /// Right of it.
    pub right: f64,
    /// Below it.
    pub bottom: f64,
}

impl Margins {
    /// The margins that the two axes need.
    pub fn of(x: &Axis, y: &Axis, style: &Style) -> Self {
        let size = style.size();
        let line = |label: &str| Line::new(label, size);
        let widest = y.ticks.iter().map(|t| line(&t.label).width).fold(0.0, f64::max);
        let below = x.ticks.iter().map(|t| line(&t.label).below).fold(0.0, f64::max);
        let has_labels = x.ticks.iter().any(|t| !t.label.is_empty());
        let title = |axis: &Axis| if axis.label.is_empty() { 0.0 } else { TITLE_GAP + 0.95 * size };
        let last = x.ticks.iter().rev().take(1).map(|t| line(&t.label).width / 2.0).fold(0.0, f64::max);
        let tick_row = if has_labels { GAP + CAP_HEIGHT * size + below } else { 0.0 };
        Self {
            left: TICK + GAP + widest + title(y),
            top: 0.4 * size,
            right: (0.6 * last).max(0.25 * size),
            bottom: TICK + tick_row + title(x) + 0.12 * size,
        }
    }

    /// The larger of each, so that panels of a grid line up.
    pub fn max(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

impl Panel {
    /// Fits the axes into `outer`, which takes their labels too.
    pub fn fit(outer: Rect, x: Axis, y: Axis, style: &Style) -> Self {
        let margins = Margins::of(&x, &y, style);
        Self::with_margins(outer, margins, x, y)
    }

    /// Fits the axes into `outer` with given margins.
    pub fn with_margins(outer: Rect, m: Margins, x: Axis, y: Axis) -> Self {
        Self { area: outer.inset(m.left, m.top, m.right, m.bottom), x, y, left: m.left, boxed: false }
    }

    /// Draws lines on all four sides.
    pub fn boxed(mut self) -> Self {
        self.boxed = true;
        self
    }

    /// Point of a pair of values.
    pub fn place(&self, x: f64, y: f64) -> Point {
        [self.place_x(x), self.place_y(y)]
    }

    /// Horizontal position of a value.
    pub fn place_x(&self, x: f64) -> f64 {
        self.area.left + self.x.fraction(x) * self.area.width()
    }

    /// Vertical position of a value.
    pub fn place_y(&self, y: f64) -> f64 {
        self.area.bottom - self.y.fraction(y) * self.area.height()
    }

    /// Points of a series on the page; a value that is not finite splits the series.
    pub fn places(&self, x: &[f64], y: &[f64]) -> Vec<Vec<Point>> {
        let mut parts: Vec<Vec<Point>> = vec![Vec::new()];
        for (&x, &y) in x.iter().zip(y) {
            if x.is_finite() && y.is_finite() {
                if let Some(part) = parts.last_mut() {
                    part.push(self.place(x, y));
                }
            } else if parts.last().is_some_and(|p| !p.is_empty()) {
                parts.push(Vec::new());
            }
        }
        parts.retain(|p| !p.is_empty());
        parts
    }

    /// Draws grid lines at the ticks; call it before the data are drawn.
    pub fn draw_grid(&self, scene: &mut Scene) {
        let mut path = Path::default();
        if self.x.grid {
            for tick in &self.x.ticks {
                let x = self.place_x(tick.at);
                path.add_polyline(&[[x, self.area.top], [x, self.area.bottom]]);
            }
        }
        if self.y.grid {
            for tick in &self.y.ticks {
                let y = self.place_y(tick.at);
                path.add_polyline(&[[self.area.left, y], [self.area.right, y]]);
            }
        }
        if !path.0.is_empty() {
            scene.stroke(path, Stroke::new(GRID, 0.15));
        }
    }

    /// Draws axis lines, ticks, labels and titles; call it after the data are drawn.
    pub fn draw_axes(&self, scene: &mut Scene, style: &Style) {
        self.draw_lines(scene);
        let size = style.size();
        let (x0, y0) = (self.area.left, self.area.bottom);
        let below = |tick: &Tick| {
            let line = Line::new(&tick.label, size);
            (self.place_x(tick.at), line.width + 0.35 * size, line)
        };
        for (x, _, line) in apart(labelled(&self.x).map(below).collect()) {
            scene.text(line, [x, y0 + TICK + GAP + CAP_HEIGHT * size], Anchor::Middle, 0.0, INK);
        }
        let beside = |tick: &Tick| (self.place_y(tick.at), 1.05 * CAP_HEIGHT * size, Line::new(&tick.label, size));
        for (y, _, line) in apart(labelled(&self.y).map(beside).collect()) {
            scene.text_centred(line, [x0 - TICK - GAP, y], Anchor::End, INK);
        }
        let [cx, cy] = self.area.centre();
        if !self.x.label.is_empty() {
            let below = self.x.ticks.iter().map(|t| Line::new(&t.label, size).below).fold(0.0, f64::max);
            let labels =
                if self.x.ticks.iter().any(|t| !t.label.is_empty()) { GAP + CAP_HEIGHT * size + below } else { 0.0 };
            let baseline = y0 + TICK + labels + TITLE_GAP + 0.72 * size;
            let room = (self.area.width() + 1.6 * self.left.min(self.area.width() / 3.0)).min(scene.width - RIM);
            let title = within(&self.x.title(), size, room);
            let x = on_page(cx, title.width, scene.width);
            scene.text(title, [x, baseline], Anchor::Middle, 0.0, INK);
        }
        if !self.y.label.is_empty() {
            let title = within(&self.y.title(), size, (self.area.height() + 4.0 * size).min(scene.height - RIM));
            let y = on_page(cy, title.width, scene.height);
            scene.text(title, [x0 - self.left + 0.75 * size, y], Anchor::Middle, 90.0, INK);
        }
    }

    fn draw_lines(&self, scene: &mut Scene) {
        let Rect { left, right, top, bottom } = self.area;
        let mut frame = Path::polyline(&[[left, top], [left, bottom], [right, bottom]]);
        if self.boxed {
            frame = Path::rect(self.area);
        }
        // A tick without a label is a grid line only.
        for tick in self.x.ticks.iter().filter(|t| !t.label.is_empty()) {
            let x = self.place_x(tick.at);
            frame.add_polyline(&[[x, bottom], [x, bottom + TICK]]);
        }
        for tick in self.y.ticks.iter().filter(|t| !t.label.is_empty()) {
            let y = self.place_y(tick.at);
            frame.add_polyline(&[[left, y], [left - TICK, y]]);
        }
        scene.stroke(frame, Stroke::new(SOFT, 0.2));
        let mut minor = Path::default();
        for &m in &self.x.minor {
            let x = self.place_x(m);
            minor.add_polyline(&[[x, bottom], [x, bottom + 0.5 * TICK]]);
        }
        for &m in &self.y.minor {
            let y = self.place_y(m);
            minor.add_polyline(&[[left, y], [left - 0.5 * TICK, y]]);
        }
        if !minor.0.is_empty() {
            scene.stroke(minor, Stroke::new(SOFT, 0.15));
        }
    }

    /// Attributes from which a script computes values under a pointer: ends of both axes and the plot area.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let scale = |a: &Axis| if a.scale == Scale::Log { "log" } else { "linear" };
        let r = self.area;
        let x = format!("{} {} {:.3} {:.3} {}", self.x.low, self.x.high, r.left, r.right, scale(&self.x));
        let y = format!("{} {} {:.3} {:.3} {}", self.y.low, self.y.high, r.bottom, r.top, scale(&self.y));
        vec![("x", x), ("y", y)]
    }
}

/// The middle of a text of a given length, moved by the least distance that puts it on a page of a given extent.
pub(super) fn on_page(middle: f64, length: f64, extent: f64) -> f64 {
    let half = (length + RIM / 2.0) / 2.0;
    if 2.0 * half < extent { middle.clamp(half, extent - half) } else { extent / 2.0 }
}

fn labelled(axis: &Axis) -> impl Iterator<Item = &Tick> {
    axis.ticks.iter().filter(|tick| !tick.label.is_empty())
}

/// The labels that do not touch: all of them, or every second, third, … from the first on. `labels` are positions, lengths
/// along the axis and texts.
fn apart<T>(labels: Vec<(f64, f64, T)>) -> Vec<(f64, f64, T)> {
    let touch = |every: usize| {
        let shown: Vec<&(f64, f64, T)> = labels.iter().step_by(every).collect();
        shown.windows(2).any(|pair| (pair[1].0 - pair[0].0).abs() < (pair[0].1 + pair[1].1) / 2.0)
    };
    let every = (1..labels.len().max(2)).find(|every| !touch(*every)).unwrap_or(labels.len().max(1));
    labels.into_iter().step_by(every).collect()
}

/// A title that fits into `room`: smaller, down to two thirds, or else cut.
pub(super) fn within(title: &str, size: f64, room: f64) -> Line {
    const SMALLEST: f64 = 0.66;
    let line = Line::new(title, size);
    if line.width <= room || room <= 0.0 {
        return line;
    }
    let smaller = Line::new(title, size * (room / line.width).max(SMALLEST));
    if smaller.width <= 1.001 * room {
        return smaller;
    }
    // Mathematics is not cut in its middle.
    let plain: Vec<char> = line.plain.chars().collect();
    let cut = |length: usize| {
        let text: String = plain[..length].iter().collect();
        Line::new(&format!("{}…", plain_text(&text)), size * SMALLEST)
    };
    (0..plain.len()).rev().map(cut).find(|line| line.width <= room).unwrap_or(smaller)
}

/// Outline of a marker of a given size (its width) around a point.
pub fn marker(kind: Marker, at: Point, size: f64) -> Path {
    let [x, y] = at;
    let r = size / 2.0;
    let polygon =
        |points: &[[f64; 2]]| Path::polygon(&points.iter().map(|p| [x + p[0] * r, y + p[1] * r]).collect::<Vec<_>>());
    let arm = 0.32;
    let plus = [
        [-arm, -1.1],
        [arm, -1.1],
        [arm, -arm],
        [1.1, -arm],
        [1.1, arm],
        [arm, arm],
        [arm, 1.1],
        [-arm, 1.1],
        [-arm, arm],
        [-1.1, arm],
        [-1.1, -arm],
        [-arm, -arm],
    ];
    match kind {
        Marker::Disc => Path::circle(at, r),
        Marker::Square => polygon(&[[-0.88, -0.88], [0.88, -0.88], [0.88, 0.88], [-0.88, 0.88]]),
        Marker::Triangle => polygon(&[[0.0, -1.2], [1.08, 0.72], [-1.08, 0.72]]),
        Marker::Down => polygon(&[[0.0, 1.2], [1.08, -0.72], [-1.08, -0.72]]),
        Marker::Diamond => polygon(&[[0.0, -1.25], [1.1, 0.0], [0.0, 1.25], [-1.1, 0.0]]),
        Marker::Plus => polygon(&plus),
        Marker::Cross => {
            let h = 0.5_f64.sqrt();
            polygon(&plus.map(|[a, b]| [h * (a - b), h * (a + b)]))
        }
    }
}

/// A filled marker with a thin white rim, so that neighbours stay apart.
pub fn draw_marker(scene: &mut Scene, kind: Marker, at: Point, size: f64, color: Color) {
    scene.shape(marker(kind, at, size), color, Stroke::new(super::palette::PAPER, 0.12));
}
