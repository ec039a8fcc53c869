//! Sets of parameters as lines over parallel axes, one axis per factor from its lower to its upper bound.
//!
//! Each line is a solution. For one target its colour is its misfit (good ones dark and drawn last); several targets
//! stand one below the other on the same axes, each in its own colour. The best of each target is heavy.

use super::axis::{Axis, Scale, extent, fixed, significant};
use super::column::Column;
use super::contour::Bands;
use super::palette::{self, INK, SOFT};
use super::panel::draw_marker;
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style};

/// Solutions for one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolutionSet {
    /// Name in the legend.
    pub name: String,
    /// Values of all factors, one row per solution, the best first.
    pub rows: Vec<Vec<f64>>,
    /// Misfit of each solution; empty when it is not known.
    pub misfit: Vec<f64>,
}

/// Calibrated parameter sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solutions {
    /// Factors.
    pub factors: Vec<Quantity>,
    /// Lower and upper bound of each factor.
    pub bounds: Vec<[f64; 2]>,
    /// Sets, one per target.
    pub sets: Vec<SolutionSet>,
}

/// Gap between the panels of two targets.
const BETWEEN: f64 = 3.0;

impl Figure for Solutions {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let (head, foot) = (3.6 * size + 1.5, 2.2 * size);
        let count = self.sets.len().max(1);
        let panel = self.panel_height(style);
        let height = head + count as f64 * panel + (count - 1) as f64 * BETWEEN + foot;
        let mut scene = Scene::new(style.width, height);
        scene.title = "Calibrated parameter sets".into();
        scene.description = self.describe();
        let (low, high) = extent(self.sets.iter().flat_map(|s| s.misfit.iter().copied()));
        let bands = Bands::of(low, high, &Quantity::new("Misfit", "f", ""));
        let bar_width = if self.graded() { bands.width(style) + 3.0 } else { 0.0 };
        let left = if count > 1 { 9.0 + 1.5 * size } else { 9.0 };
        for (i, set) in self.sets.iter().enumerate() {
            let top = head + i as f64 * (panel + BETWEEN);
            let area = Rect { left, right: style.width - 9.0 - bar_width, top, bottom: top + panel };
            self.draw_lines(&mut scene, area, style, (i, set), (low, high));
            self.draw_axes(&mut scene, area, style, [i == 0, i + 1 == count]);
            self.draw_best(&mut scene, area, (i, set));
            if count > 1 {
                let at = [0.6 + 0.75 * size, 0.5 * (area.top + area.bottom)];
                scene.text(Line::new(&set.name, size), at, Anchor::Middle, 90.0, INK);
            }
            if self.graded() {
                let bar = Rect::new(style.width - 0.8 - bands.width(style), area.top, 3.0, area.height());
                bands.draw_smooth_bar(&mut scene, bar, style);
            }
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let names = self.sets.iter().flat_map(|s| vec![s.name.clone(); s.rows.len()]).collect();
        let mut columns = vec![Column::words("target", names)];
        for (k, factor) in self.factors.iter().enumerate() {
            let cell = |r: &Vec<f64>| r.get(k).copied().unwrap_or(f64::NAN);
            let values = self.sets.iter().flat_map(|s| s.rows.iter().map(cell)).collect();
            columns.push(factor.column(factor.id(), values));
        }
        let misfit = |s: &SolutionSet, k: usize| s.misfit.get(k).copied().unwrap_or(f64::NAN);
        let misfits = self.sets.iter().flat_map(|s| (0..s.rows.len()).map(move |k| misfit(s, k))).collect();
        columns.push(Column::reals("misfit", misfits));
        columns
    }
}

impl Solutions {
    /// Whether there is one set with known misfits, which give the colours.
    fn graded(&self) -> bool {
        self.sets.len() == 1 && self.sets.iter().all(|s| s.misfit.len() == s.rows.len())
    }

    fn describe(&self) -> String {
        let tell = |s: &SolutionSet| {
            let best = s.rows.first().cloned().unwrap_or_default();
            let value = |(f, v): (&Quantity, f64)| format!("{} {}", f.words(), f.in_words(v));
            let pairs = self.factors.iter().zip(best).map(value);
            format!("{}: {} solutions, best {}.", s.name, s.rows.len(), pairs.collect::<Vec<_>>().join(", "))
        };
        self.sets.iter().map(tell).collect::<Vec<_>>().join(" ")
    }

    /// One high panel, or a low one for each target, high enough for its name.
    fn panel_height(&self, style: &Style) -> f64 {
        let size = style.size();
        if self.sets.len() < 2 {
            return (0.42 * style.width).max(52.0) - 5.8 * size - 1.5;
        }
        let names = self.sets.iter().map(|set| Line::new(&set.name, size).width);
        names.fold((0.12 * style.width).max(18.0), f64::max)
    }

    fn place_x(&self, k: usize, area: Rect) -> f64 {
        area.left + k as f64 / (self.factors.len().max(2) - 1) as f64 * area.width()
    }

    fn points(&self, row: &[f64], area: Rect) -> Vec<[f64; 2]> {
        let at = |(k, (v, [low, high])): (usize, (&f64, &[f64; 2]))| {
            [self.place_x(k, area), area.bottom - (v - low) / (high - low) * area.height()]
        };
        row.iter().zip(&self.bounds).enumerate().map(at).collect()
    }

    fn draw_lines(
        &self,
        scene: &mut Scene,
        area: Rect,
        style: &Style,
        (i, set): (usize, &SolutionSet),
        (low, high): (f64, f64),
    ) {
        for (k, row) in set.rows.iter().enumerate().rev() {
            let misfit = set.misfit.get(k).copied().unwrap_or(low);
            let t = if high > low { (misfit - low) / (high - low) } else { 0.0 };
            let (color, opacity) = if self.graded() { (style.map.at(t), 0.8) } else { (palette::category(i), 0.45) };
            let stroke = Stroke::new(color, 0.2).with_opacity(opacity);
            scene.stroke(Path::polyline(&self.points(row, area)), stroke);
        }
    }

    /// The recommended set, above the axes.
    fn draw_best(&self, scene: &mut Scene, area: Rect, (i, set): (usize, &SolutionSet)) {
        let Some(best) = set.rows.first() else { return };
        let points = self.points(best, area);
        let color = if self.graded() { INK } else { palette::category(i) };
        scene.stroke(Path::polyline(&points), Stroke::new(color, 0.6));
        for p in points {
            draw_marker(scene, palette::marker(i), p, 1.9, color);
        }
    }

    /// The axes; their names and upper bounds above the first panel, their lower bounds below the last.
    fn draw_axes(&self, scene: &mut Scene, area: Rect, style: &Style, [first, last]: [bool; 2]) {
        let size = style.size();
        for (k, (factor, &[low, high])) in self.factors.iter().zip(&self.bounds).enumerate() {
            let x = self.place_x(k, area);
            let axis = Axis::between("", Scale::Linear, low, high, 4);
            let mut path = Path::polyline(&[[x, area.top], [x, area.bottom]]);
            for tick in &axis.ticks {
                let y = area.bottom - axis.fraction(tick.at) * area.height();
                path.add_polyline(&[[x, y], [x - 0.8, y]]);
            }
            scene.stroke(path, Stroke::new(SOFT, 0.25));
            let end = |v: f64| significant_short(v);
            if last {
                scene.text(Line::new(&end(low), 0.9 * size), [x, area.bottom + 1.25 * size], Anchor::Middle, 0.0, SOFT);
            }
            if !first {
                continue;
            }
            scene.text(Line::new(&end(high), 0.9 * size), [x, area.top - 0.6 * size], Anchor::Middle, 0.0, SOFT);
            scene.text(Line::new(&factor.sign(), size), [x, area.top - 2.9 * size], Anchor::Middle, 0.0, INK);
            let unit = if factor.unit.is_empty() { "–".into() } else { super::text::unit_markup(&factor.unit) };
            scene.text(Line::new(&unit, 0.9 * size), [x, area.top - 1.75 * size], Anchor::Middle, 0.0, SOFT);
        }
    }
}

/// The short text of a bound.
fn significant_short(v: f64) -> String {
    (0..4)
        .map(|d| fixed(v, d))
        .find(|t| t.replace('−', "-").parse::<f64>().is_ok_and(|r| (r - v).abs() < 1e-9))
        .unwrap_or_else(|| significant(v, 3))
}
