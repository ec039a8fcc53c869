//! Parts of the plots of a user's own columns: colours of groups, bands, error bars, axes whose labels never touch.

use super::axis::{Axis, Scale, extent};
use super::palette::{self, Map, Marker};
use super::panel::Panel;
use super::scene::{Color, Fill, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Quantity, Style};

/// Most categories with colours of their own; more of them take colours from a map in their order.
const MOST_CATEGORIES: usize = 6;

/// Colour of group `i` of `n`.
pub fn color(i: usize, n: usize) -> Color {
    if n <= MOST_CATEGORIES { palette::category(i) } else { Map::Viridis.at(0.9 * i as f64 / (n - 1) as f64) }
}

/// Marker of group `i`.
pub fn marker(i: usize) -> Marker {
    palette::marker(i)
}

/// Line of group `i` of `n`.
pub fn line(i: usize, n: usize, width: f64) -> Stroke {
    let stroke = Stroke::new(color(i, n), width);
    if n <= MOST_CATEGORIES { stroke.dashed(palette::dash(i)) } else { stroke }
}

/// A line with its band on the page, in values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Positions along the page, ascending.
    pub x: Vec<f64>,
    /// The line.
    pub y: Vec<f64>,
    /// Lower end of the band; empty without a band.
    pub low: Vec<f64>,
    /// Upper end of the band; empty without a band.
    pub high: Vec<f64>,
}

impl Band {
    /// Every value that the line and the band reach.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.y.iter().chain(&self.low).chain(&self.high).copied()
    }

    /// Draws the area of the band; call it before points and lines are drawn.
    pub fn draw_ground(&self, scene: &mut Scene, panel: &Panel, color: Color) {
        let both = |i: usize| self.low.get(i).zip(self.high.get(i)).map(|(l, h)| [*l, *h]);
        let ends: Vec<(f64, [f64; 2])> = (0..self.x.len())
            .filter_map(|i| Some((self.x[i], both(i)?)))
            .filter(|(x, [l, h])| can_show(&panel.x, *x) && l.is_finite() && can_show(&panel.y, *h))
            .collect();
        // On a logarithmic axis a band that reaches zero ends at the lower end of the axis.
        let foot = |l: f64| if can_show(&panel.y, l) { l } else { panel.y.low };
        let mut outline: Vec<_> = ends.iter().map(|(x, [_, h])| panel.place(*x, *h)).collect();
        outline.extend(ends.iter().rev().map(|(x, [l, _])| panel.place(*x, foot(*l))));
        if outline.len() > 3 {
            scene.fill(Path::polygon(&outline), Fill { color, opacity: 0.18 });
        }
    }

    /// The line.
    pub fn draw_line(&self, scene: &mut Scene, panel: &Panel, stroke: &Stroke) {
        draw_series(scene, panel, &self.x, &self.y, stroke);
    }
}

/// A value that an axis of this scale can show.
pub fn can_show(axis: &Axis, value: f64) -> bool {
    value.is_finite() && (axis.scale == Scale::Linear || value > 0.0)
}

/// A line through the values, interrupted where a value cannot be shown.
pub fn draw_series(scene: &mut Scene, panel: &Panel, x: &[f64], y: &[f64], stroke: &Stroke) {
    let clean = |axis: &Axis, v: &[f64]| -> Vec<f64> {
        v.iter().map(|&v| if can_show(axis, v) { v } else { f64::NAN }).collect()
    };
    for part in panel.places(&clean(&panel.x, x), &clean(&panel.y, y)) {
        scene.stroke(Path::polyline(&part), stroke.clone());
    }
}

/// Half the width of the cap of an error bar in mm.
const CAP: f64 = 0.55;

/// Error bars: centre and half length in x and y; a half length that is no number has no bar.
pub fn draw_errors(scene: &mut Scene, panel: &Panel, bars: &[([f64; 2], [f64; 2])], color: Color) {
    let mut path = Path::default();
    for &([x, y], [dx, dy]) in bars.iter().filter(|(p, _)| can_show(&panel.x, p[0]) && can_show(&panel.y, p[1])) {
        let end = |axis: &Axis, v: f64| if can_show(axis, v) { v } else { axis.low };
        if dy > 0.0 {
            let (a, b) = (panel.place(x, end(&panel.y, y - dy)), panel.place(x, y + dy));
            path.add_polyline(&[a, b]);
            for p in [a, b] {
                path.add_polyline(&[[p[0] - CAP, p[1]], [p[0] + CAP, p[1]]]);
            }
        }
        if dx > 0.0 {
            let (a, b) = (panel.place(end(&panel.x, x - dx), y), panel.place(x + dx, y));
            path.add_polyline(&[a, b]);
            for p in [a, b] {
                path.add_polyline(&[[p[0], p[1] - CAP], [p[0], p[1] + CAP]]);
            }
        }
    }
    if !path.0.is_empty() {
        scene.stroke(path, Stroke::new(color, 0.22));
    }
}

/// The data of one axis of a plot, before its length on the page is known.
#[derive(Clone, Debug)]
pub struct Span {
    /// The quantity that it shows.
    pub quantity: Quantity,
    /// Spread of the values.
    pub scale: Scale,
    /// The values it holds.
    pub low: f64,
    /// The values it holds.
    pub high: f64,
    /// Whether the ends are those that were asked for.
    pub is_fixed: bool,
}

impl Span {
    /// Around all values that the scale can show.
    pub fn of(quantity: &Quantity, scale: Scale, values: impl IntoIterator<Item = f64>) -> Self {
        let shown = values.into_iter().filter(|v| scale == Scale::Linear || *v > 0.0);
        let (low, high) = extent(shown);
        Self { quantity: quantity.clone(), scale, low, high, is_fixed: false }
    }

    /// With these ends, where some are asked for.
    #[must_use]
    pub fn within(self, limits: Option<[f64; 2]>) -> Self {
        match limits {
            Some([low, high]) => Self { low, high, is_fixed: true, ..self },
            None => self,
        }
    }

    fn axis(&self, want: usize, long: bool) -> Axis {
        let title = if long { self.quantity.title() } else { self.quantity.short() };
        if self.is_fixed {
            return Axis::between(title, self.scale, self.low, self.high, want);
        }
        // an axis that starts at zero has no margin below zero
        if self.scale == Scale::Linear && self.low == 0.0 && self.high > 0.0 {
            return Axis::from_zero(title, [self.high], want);
        }
        Axis::around(title, self.scale, [self.low, self.high], want)
    }
}

/// Greatest number of labels that an axis is given.
const MOST_LABELS: usize = 6;

/// A panel in `outer` with as many labels on each axis as do not touch, and titles that fit.
pub fn panel(outer: Rect, x: &Span, y: &Span, style: &Style) -> Panel {
    fit(outer, |want, long| x.axis(want, long), |want, long| y.axis(want, long), style)
}

/// The same over categories along the page.
pub fn category_panel(outer: Rect, x: &Axis, y: &Span, style: &Style) -> Panel {
    fit(outer, |_, _| x.clone(), |want, long| y.axis(want, long), style)
}

fn fit(outer: Rect, x: impl Fn(usize, bool) -> Axis, y: impl Fn(usize, bool) -> Axis, style: &Style) -> Panel {
    let size = style.size();
    let width = |text: &str| Line::new(text, size).width;
    let at = |want: [usize; 2], long: [bool; 2]| Panel::fit(outer, x(want[0], long[0]), y(want[1], long[1]), style);
    let mut want = [MOST_LABELS; 2];
    let mut best = at(want, [true; 2]);
    while want[0] > 2 && !stand_apart(&best, size) {
        want[0] -= 1;
        best = at(want, [true; 2]);
    }
    while want[1] > 2 && !stacked_apart(&best, size) {
        want[1] -= 1;
        best = at(want, [true; 2]);
    }
    let long = [width(&best.x.label) <= best.area.width(), width(&best.y.label) <= best.area.height()];
    best = at(want, long);
    thin_out(&mut best, size);
    best
}

/// Room between two labels in shares of the size of the text.
const APART: f64 = 0.5;

fn stand_apart(panel: &Panel, size: f64) -> bool {
    let ends = |t: &super::axis::Tick| {
        let half = Line::new(&t.label, size).width / 2.0;
        (panel.place_x(t.at) - half, panel.place_x(t.at) + half)
    };
    let all: Vec<(f64, f64)> = panel.x.ticks.iter().filter(|t| !t.label.is_empty()).map(ends).collect();
    all.windows(2).all(|w| w[1].0 - w[0].1 >= APART * size)
}

fn stacked_apart(panel: &Panel, size: f64) -> bool {
    let all: Vec<f64> = panel.y.ticks.iter().map(|t| panel.place_y(t.at)).collect();
    all.windows(2).all(|w| (w[0] - w[1]).abs() >= 1.2 * size)
}

/// Leaves out every other label until they do not touch: for categories and powers of ten, whose number is fixed.
fn thin_out(panel: &mut Panel, size: f64) {
    let mut every = 1;
    while every < panel.x.ticks.len() && !stand_apart(panel, size) {
        every *= 2;
        let dropped = panel.x.ticks.iter_mut().enumerate().filter(|(i, _)| i % every != 0);
        dropped.for_each(|(_, tick)| tick.label.clear());
    }
    while panel.y.ticks.len() > 2 && !stacked_apart(panel, size) {
        let shown = panel.y.ticks.iter().step_by(2).cloned().collect();
        panel.y.ticks = shown;
    }
}
