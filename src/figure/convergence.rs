//! Misfit against effort of a calibration: best so far of each run, with the spread of its population.

use super::axis::{Axis, Scale, extent};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette;
use super::panel::{Panel, draw_marker};
use super::scene::{Fill, Path, Rect, Scene, Stroke};
use super::{Figure, Style};

/// Column of the data: name of the run.
pub const RUN: &str = "run";
/// Column of the data: best misfit so far.
pub const BEST: &str = "best";

/// One optimiser run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Descent {
    /// Name in the legend.
    pub name: String,
    /// Effort so far: generations or simulations.
    pub effort: Vec<f64>,
    /// Best misfit so far.
    pub best: Vec<f64>,
    /// Median misfit of the population; empty to leave out. Drawn as the upper end of a band from the best.
    pub median: Vec<f64>,
}

/// Convergence of a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Convergence {
    /// What the effort counts: "Generation".
    pub effort: String,
    /// What the misfit is, with symbol: "Misfit $f$ / –".
    pub misfit: String,
    /// Runs.
    pub runs: Vec<Descent>,
}

impl Figure for Convergence {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.72 * style.width);
        scene.title = "Convergence of the calibration".into();
        let last = |r: &Descent| format!("{} ends at {:.1e}.", r.name, r.best.last().copied().unwrap_or(f64::NAN));
        scene.description = self.runs.iter().map(last).collect::<Vec<_>>().join(" ");
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width() - 14.0, style);
        let panel = Panel::fit(Rect { top: page.top + top, ..page }, self.x_axis(), self.y_axis(), style);
        legend::draw(&mut scene, &entries, Rect { left: panel.area.left, ..page }, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        for (i, run) in self.runs.iter().enumerate() {
            self.draw_band(&mut scene, &panel, i, run);
        }
        for (i, run) in self.runs.iter().enumerate() {
            for part in panel.places(&run.effort, &floored(&run.best, panel.y.low)) {
                scene.stroke(Path::polyline(&steps(&part)), style_of(i));
                if let Some(&end) = part.last() {
                    draw_marker(&mut scene, palette::marker(i), end, 1.8, palette::category(i));
                }
            }
        }
        scene.group_from(first, None, panel.facts());
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let all = |f: fn(&Descent) -> &Vec<f64>| {
            let cell = move |r: &Descent, k: usize| f(r).get(k).copied().unwrap_or(f64::NAN);
            self.runs.iter().flat_map(|r| (0..r.effort.len()).map(move |k| cell(r, k))).collect::<Vec<_>>()
        };
        let names = self.runs.iter().flat_map(|r| vec![r.name.clone(); r.effort.len()]).collect();
        let mut columns = vec![
            Column::words(RUN, names),
            Column::reals(&self.effort.to_lowercase(), all(|r| &r.effort)),
            Column::reals(BEST, all(|r| &r.best)),
        ];
        if self.runs.iter().any(|r| !r.median.is_empty()) {
            columns.push(Column::reals("median", all(|r| &r.median)));
        }
        columns
    }
}

impl Convergence {
    fn entries(&self) -> Vec<Entry> {
        let line =
            |(i, r): (usize, &Descent)| Entry::new(r.name.clone(), Swatch::Line(style_of(i), Some(palette::marker(i))));
        let mut entries: Vec<Entry> = self.runs.iter().enumerate().map(line).collect();
        if self.runs.iter().any(|r| !r.median.is_empty()) {
            entries.push(Entry::new("best to median", Swatch::Band(palette::SOFT, 0.25)));
        }
        entries
    }

    fn x_axis(&self) -> Axis {
        let (low, high) = extent(self.runs.iter().flat_map(|r| r.effort.iter().copied()));
        Axis::between(self.effort.clone(), Scale::Linear, low.min(0.0), high + 0.03 * (high - low), 5)
    }

    /// A logarithmic axis; a misfit of zero is drawn at its lower end.
    fn y_axis(&self) -> Axis {
        let values = self.runs.iter().flat_map(|r| r.best.iter().chain(&r.median).copied());
        let (low, high) = extent(values.filter(|v| *v > 0.0));
        let low = low.max(1e-12 * high);
        Axis::around(self.misfit.clone(), Scale::Log, [low, high], 6)
    }

    fn draw_band(&self, scene: &mut Scene, panel: &Panel, i: usize, run: &Descent) {
        if run.median.len() != run.effort.len() {
            return;
        }
        let low = floored(&run.best, panel.y.low);
        let high = floored(&run.median, panel.y.low);
        let mut outline: Vec<_> = run.effort.iter().zip(&high).map(|(&x, &y)| panel.place(x, y)).collect();
        outline.extend(run.effort.iter().zip(&low).rev().map(|(&x, &y)| panel.place(x, y)));
        scene.fill(Path::polygon(&outline), Fill { color: palette::category(i), opacity: 0.12 });
    }
}

fn style_of(i: usize) -> Stroke {
    Stroke::new(palette::category(i), 0.4).dashed(palette::dash(i))
}

fn floored(values: &[f64], low: f64) -> Vec<f64> {
    values.iter().map(|v| v.max(low)).collect()
}

/// A step line: the best misfit so far holds until the next improvement.
fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(2 * points.len());
    for &[x, y] in points {
        if let Some(&[_, before]) = out.last().filter(|last| last[1] != y) {
            out.push([x, before]);
        }
        out.push([x, y]);
    }
    out
}
