//! A histogram: how often values fall into equal bins, with the mean and the normal curve of the same scatter.

use super::axis::{Axis, Scale, significant};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::marks::{self, Span};
use super::palette::{INK, PAPER, SKY, VERMILION};
use super::panel::Panel;
use super::scene::{Path, Rect, Scene, Stroke};
use super::xy::capital;
use super::{Figure, Quantity, Style};
use math::elementary::exp;

/// Bins of one quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram {
    /// The quantity.
    pub quantity: Quantity,
    /// Ends of the bins, ascending, one more than counts.
    pub edges: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<usize>,
    /// Mean of the values.
    pub mean: f64,
    /// Their standard deviation; NaN with fewer than two.
    pub deviation: f64,
}

impl Figure for Histogram {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.62 * style.width);
        scene.title = format!("Distribution of {}", self.quantity.words());
        scene.description = self.describe();
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width(), style);
        scene.height += top;
        let outer = Rect { top: page.top + top, bottom: page.bottom + top, ..page };
        let curve = self.normal();
        let most = self.counts.iter().map(|&c| c as f64).chain(curve.iter().map(|p| p[1])).fold(1.0, f64::max);
        let x = Span::of(&self.quantity, Scale::Linear, self.edges.iter().copied().filter(|e| e.is_finite()));
        let count = Quantity::new("Number of runs", "", "");
        let y = Span { quantity: count, scale: Scale::Linear, low: 0.0, high: most, is_fixed: false };
        let mut panel = marks::panel(outer, &x, &y, style);
        panel.x.grid = false;
        whole(&mut panel.y);
        legend::draw(&mut scene, &entries, page, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        self.draw_bars(&mut scene, &panel);
        let (cx, cy): (Vec<f64>, Vec<f64>) = curve.iter().map(|p| (p[0], p[1])).unzip();
        marks::draw_series(&mut scene, &panel, &cx, &cy, &normal_stroke());
        if self.mean.is_finite() {
            let at = [panel.place(self.mean, 0.0), panel.place(self.mean, panel.y.high)];
            scene.stroke(Path::polyline(&at), mean_stroke());
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let key = self.quantity.id();
        let n = self.counts.len();
        vec![
            self.quantity.column(&format!("{key}_from"), self.edges.iter().copied().take(n).collect()),
            self.quantity.column(&format!("{key}_to"), self.edges.iter().copied().skip(1).collect()),
            Column::whole("count", self.counts.iter().map(|&c| c as i64).collect()),
        ]
    }
}

fn normal_stroke() -> Stroke {
    Stroke::new(VERMILION, 0.4).dashed(&[1.6, 1.1])
}

fn mean_stroke() -> Stroke {
    Stroke::new(INK, 0.35)
}

/// The axis of counts has whole numbers at its ticks.
fn whole(axis: &mut Axis) {
    axis.ticks.retain(|t| t.at.fract() == 0.0);
    axis.minor.clear();
    axis.ticks.iter_mut().filter(|t| t.at < 1e5).for_each(|t| t.label = format!("{}", t.at));
}

impl Histogram {
    fn total(&self) -> usize {
        self.counts.iter().sum()
    }

    /// The normal curve of the same mean, deviation and area; empty without a deviation.
    fn normal(&self) -> Vec<[f64; 2]> {
        let (Some(&low), Some(&high)) = (self.edges.first(), self.edges.last()) else { return Vec::new() };
        if !(self.deviation > 0.0) || self.edges.len() < 2 {
            return Vec::new();
        }
        let area = self.total() as f64 * (high - low) / self.counts.len() as f64;
        let peak = area / (self.deviation * (2.0 * std::f64::consts::PI).sqrt());
        let at = |i: usize| {
            let x = low + (high - low) * i as f64 / 120.0;
            let z = (x - self.mean) / self.deviation;
            [x, peak * exp(-0.5 * z * z)]
        };
        (0..=120).map(at).collect()
    }

    fn entries(&self) -> Vec<Entry> {
        let n = self.total();
        let unit = super::text::unit_markup(&self.quantity.unit);
        let value_text = |v: f64| format!("{} {unit}", significant(v, 3)).trim_end().to_owned();
        let mut entries = vec![Entry::new(format!("{n} {}", if n == 1 { "run" } else { "runs" }), Swatch::Box(SKY))];
        if self.mean.is_finite() {
            entries.push(Entry::new(format!("mean {}", value_text(self.mean)), Swatch::Line(mean_stroke(), None)));
        }
        if self.deviation > 0.0 {
            let name = format!("normal, deviation {}", value_text(self.deviation));
            entries.push(Entry::new(name, Swatch::Line(normal_stroke(), None)));
        }
        entries
    }

    fn draw_bars(&self, scene: &mut Scene, panel: &Panel) {
        for (i, &count) in self.counts.iter().enumerate().filter(|(_, c)| **c > 0) {
            let Some([from, to]) = self.edges.get(i).zip(self.edges.get(i + 1)).map(|(a, b)| [*a, *b]) else {
                continue;
            };
            let (a, b) = (panel.place(from, count as f64), panel.place(to, 0.0));
            let bar = Rect { left: a[0], right: b[0], top: a[1], bottom: b[1] };
            scene.shape(Path::rect(bar), SKY, Stroke::new(PAPER, 0.2));
        }
    }

    fn describe(&self) -> String {
        let q = &self.quantity;
        let plain = |text: String| super::text::Line::new(&text, 1.0).plain;
        plain(format!(
            "{} has {} values in {} bins, mean {}, standard deviation {}.",
            capital(&q.words()),
            self.total(),
            self.counts.len(),
            q.in_words(self.mean),
            if self.deviation.is_finite() { q.in_words(self.deviation) } else { "unknown".into() }
        ))
    }
}
