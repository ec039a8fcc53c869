//! Sets of parameters as lines over parallel axes, one axis per factor from its lower to its upper bound.
//!
//! Each line is a solution; its colour is its misfit (good ones dark and drawn last), or, for several targets, the
//! target's. The best of each target is heavy.

use super::axis::{Axis, Scale, extent, fixed, significant};
use super::column::Column;
use super::contour::Bands;
use super::legend::{self, Entry, Swatch};
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

impl Figure for Solutions {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let several = !self.graded();
        let mut scene = Scene::new(style.width, (0.42 * style.width).max(52.0));
        scene.title = "Calibrated parameter sets".into();
        scene.description = self.describe();
        let entries = if self.sets.len() > 1 { self.entries() } else { Vec::new() };
        let top = legend::height(&entries, style.width - 10.0, style);
        legend::draw(&mut scene, &entries, Rect::new(4.0, 0.8, style.width - 8.0, 0.0), style);
        let misfits = || self.sets.iter().flat_map(|s| s.misfit.iter().copied());
        let (low, high) = extent(misfits());
        let bands = Bands::of(low, high, &Quantity::new("Misfit", "f", ""));
        let bar_width = if several { 0.0 } else { bands.width(style) + 3.0 };
        let area = Rect {
            left: 9.0,
            right: style.width - 9.0 - bar_width,
            top: top + 3.6 * size + if several { 2.0 } else { 1.0 },
            bottom: scene.height - 2.2 * size,
        };
        self.draw_lines(&mut scene, area, style, (low, high));
        self.draw_axes(&mut scene, area, style);
        if !several {
            let bar = Rect::new(style.width - 0.8 - bands.width(style), area.top, 3.0, area.height());
            bands.draw_smooth_bar(&mut scene, bar, style);
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
    /// One set whose misfits are known: they give the colours.
    fn graded(&self) -> bool {
        self.sets.len() == 1 && self.sets.iter().all(|s| s.misfit.len() == s.rows.len())
    }

    fn describe(&self) -> String {
        let tell = |s: &SolutionSet| {
            let best = s.rows.first().cloned().unwrap_or_default();
            let pairs =
                self.factors.iter().zip(best).map(|(f, v)| format!("{} {} {}", f.id(), significant(v, 3), f.unit));
            format!("{}: {} solutions, best {}.", s.name, s.rows.len(), pairs.collect::<Vec<_>>().join(", "))
        };
        self.sets.iter().map(tell).collect::<Vec<_>>().join(" ")
    }

    fn entries(&self) -> Vec<Entry> {
        let line = |i| Swatch::Line(heavy(i), Some(palette::marker(i)));
        self.sets.iter().enumerate().map(|(i, s)| Entry::new(s.name.clone(), line(i))).collect()
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

    fn draw_lines(&self, scene: &mut Scene, area: Rect, style: &Style, (low, high): (f64, f64)) {
        let several = !self.graded();
        for (i, set) in self.sets.iter().enumerate() {
            for (k, row) in set.rows.iter().enumerate().rev() {
                let misfit = set.misfit.get(k).copied().unwrap_or(low);
                let t = if high > low { (misfit - low) / (high - low) } else { 0.0 };
                let color = if several { palette::category(i) } else { style.map.at(t) };
                let stroke = Stroke::new(color, 0.2).with_opacity(if several { 0.25 } else { 0.8 });
                scene.stroke(Path::polyline(&self.points(row, area)), stroke);
            }
        }
        for (i, set) in self.sets.iter().enumerate() {
            let Some(best) = set.rows.first() else { continue };
            let points = self.points(best, area);
            let stroke = if self.graded() { Stroke::new(INK, 0.6) } else { heavy(i) };
            let color = stroke.color;
            scene.stroke(Path::polyline(&points), stroke);
            for p in points {
                draw_marker(scene, palette::marker(i), p, 1.9, color);
            }
        }
    }

    fn draw_axes(&self, scene: &mut Scene, area: Rect, style: &Style) {
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
            scene.text(Line::new(&end(low), 0.9 * size), [x, area.bottom + 1.25 * size], Anchor::Middle, 0.0, SOFT);
            scene.text(Line::new(&end(high), 0.9 * size), [x, area.top - 0.6 * size], Anchor::Middle, 0.0, SOFT);
            scene.text(Line::new(&factor.sign(), size), [x, area.top - 2.9 * size], Anchor::Middle, 0.0, INK);
            let unit = if factor.unit.is_empty() { "–".into() } else { super::text::unit_markup(&factor.unit) };
            scene.text(Line::new(&unit, 0.9 * size), [x, area.top - 1.75 * size], Anchor::Middle, 0.0, SOFT);
        }
    }
}

fn heavy(i: usize) -> Stroke {
    Stroke::new(palette::category(i), 0.55).dashed(palette::dash(i))
}

/// A bound as short as it can be told.
fn significant_short(v: f64) -> String {
    (0..4)
        .map(|d| fixed(v, d))
        .find(|t| t.replace('−', "-").parse::<f64>().is_ok_and(|r| (r - v).abs() < 1e-9))
        .unwrap_or_else(|| significant(v, 3))
}
