//! Targets against the responses of the calibrated parameters over several seeds: each run, mean ± standard deviation. The
//! scatter of a single run is unknown: it has no bar, which a footnote says.

use super::axis::{Axis, extent, fixed};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{BLUE, Marker, SOFT, VERMILION};
use super::panel::{Margins, Panel, draw_marker, marker};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style};
use math::sample::Moments;

/// One response over all target sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Check {
    /// The response.
    pub response: Quantity,
    /// Target of each set.
    pub target: Vec<f64>,
    /// Values of the runs of each set.
    pub runs: Vec<Vec<f64>>,
}

/// Verification of a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verification {
    /// Names of the target sets.
    pub sets: Vec<String>,
    /// Responses.
    pub checks: Vec<Check>,
}

const BETWEEN: f64 = 3.0;

impl Figure for Verification {
    fn scene(&self, style: &Style) -> Scene {
        let n = self.checks.len().max(1);
        let columns = n.min(((style.width / 45.0) as usize).max(1));
        let rows = n.div_ceil(columns);
        let entries = self.entries();
        let top = legend::height(&entries, style.width - 12.0, style);
        let height = 52.0;
        let mut scene = Scene::new(style.width, rows as f64 * height + top + 1.6);
        scene.title = "Verification of the calibrated parameters".into();
        scene.description = self.describe();
        let axes: Vec<(Axis, Axis)> = self.checks.iter().map(|c| self.axes(c)).collect();
        let none = Margins { left: 0.0, top: 0.0, right: 0.0, bottom: 0.0 };
        let margins = axes.iter().fold(none, |m, (x, y)| m.max(Margins::of(x, y, style)));
        let margins = Margins { top: 1.3 * style.size(), ..margins };
        legend::draw(&mut scene, &entries, Rect::new(0.8 + margins.left, 0.8, style.width - 12.0, 0.0), style);
        let pitch = (style.width - 1.6 + BETWEEN) / columns as f64;
        for (i, (check, (x, y))) in self.checks.iter().zip(axes).enumerate() {
            let corner = [0.8 + (i % columns) as f64 * pitch, 0.8 + top + (i / columns) as f64 * height];
            let outer = Rect::new(corner[0], corner[1], pitch - BETWEEN, height - 0.6);
            let left = Margins::of(&x, &y, style).left;
            let panel = Panel { left, ..Panel::with_margins(outer, margins, x, y) };
            draw_check(&mut scene, &panel, check, style);
        }
        scene.footnotes(&self.gaps(), style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let mut words: [Vec<String>; 3] = Default::default();
        let (mut target, mut run, mut value) = (Vec::new(), Vec::new(), Vec::new());
        for check in &self.checks {
            for (k, runs) in check.runs.iter().enumerate() {
                for (j, &v) in runs.iter().enumerate() {
                    words[0].push(check.response.id().to_string());
                    words[1].push(check.response.unit.clone());
                    words[2].push(self.sets.get(k).cloned().unwrap_or_default());
                    target.push(check.target.get(k).copied().unwrap_or(f64::NAN));
                    run.push(j as i64 + 1);
                    value.push(v);
                }
            }
        }
        let [response, unit, set] = words;
        vec![
            Column::words("response", response),
            Column::words("unit", unit),
            Column::words("set", set),
            Column::whole("run", run),
            Column::reals("target", target),
            Column::reals("value", value),
        ]
    }
}

impl Verification {
    fn describe(&self) -> String {
        let tell = |c: &Check| {
            let errors: Vec<f64> =
                c.runs.iter().zip(&c.target).filter_map(|(r, t)| error(r, *t)).map(f64::abs).collect();
            let response = c.response.words();
            match errors.is_empty() {
                true => format!("{response}: no mean has a relative error."),
                false => {
                    format!("{response}: largest relative error of a mean {} %.", fixed(100.0 * extent(errors).1, 2))
                }
            }
        };
        self.checks.iter().map(tell).collect::<Vec<_>>().join(" ")
    }

    /// What the picture cannot show, in sentences.
    fn gaps(&self) -> Vec<String> {
        let sets = |count: usize| -> Vec<&str> {
            let has =
                |k: usize| self.checks.iter().any(|check| check.runs.get(k).is_some_and(|runs| runs.len() == count));
            self.sets.iter().enumerate().filter(|(k, _)| has(*k)).map(|(_, name)| name.as_str()).collect()
        };
        let word = |sets: &[&str]| format!("target set{} {}", if sets.len() == 1 { "" } else { "s" }, sets.join(", "));
        let mut found = Vec::new();
        let (single, none) = (sets(1), sets(0));
        if !single.is_empty() {
            found.push(format!("A single run does not show its scatter: {}.", word(&single)));
        }
        if !none.is_empty() {
            found.push(format!("A response without a run: {}.", word(&none)));
        }
        found
    }

    fn entries(&self) -> Vec<Entry> {
        let scatter = self.checks.iter().flat_map(|check| &check.runs).any(|runs| runs.len() > 1);
        vec![
            Entry::new("target", Swatch::Line(Stroke::new(VERMILION, 0.6), None)),
            Entry::new(if scatter { "mean ± standard deviation" } else { "mean" }, Swatch::Point(Marker::Disc, BLUE)),
            Entry::new("single run", Swatch::Hollow(Marker::Disc)),
        ]
    }

    fn axes(&self, check: &Check) -> (Axis, Axis) {
        let values = check.runs.iter().flatten().chain(&check.target).copied();
        let (low, high) = extent(values);
        let margin = 0.12 * (high - low);
        let y = Axis::between(check.response.title(), super::axis::Scale::Linear, low - margin, high + margin, 5);
        (Axis::categories("Target set", &self.sets), y)
    }
}

/// Relative error of the mean; `None` without a value, or of a target of 0.
fn error(values: &[f64], target: f64) -> Option<f64> {
    Some(Moments::of(values).mean / target - 1.0).filter(|error| error.is_finite())
}

fn draw_check(scene: &mut Scene, panel: &Panel, check: &Check, style: &Style) {
    panel.draw_grid(scene);
    let first = scene.items.len();
    let step = panel.area.width() / check.runs.len().max(1) as f64;
    let half = (0.34 * step).min(4.0);
    for (k, runs) in check.runs.iter().enumerate() {
        let x = panel.place_x(k as f64);
        if let Some(&target) = check.target.get(k) {
            let y = panel.place_y(target);
            scene.stroke(Path::polyline(&[[x - half, y], [x + half, y]]), Stroke::new(VERMILION, 0.6));
        }
        for (j, &v) in runs.iter().enumerate() {
            let spread = (j as f64 + 0.5) / runs.len() as f64 - 0.5;
            let at = [x + half * (0.55 + 0.5 * spread), panel.place_y(v)];
            scene.shape(marker(Marker::Disc, at, 1.0), super::palette::PAPER, Stroke::new(SOFT, 0.2));
        }
        if runs.is_empty() {
            continue;
        }
        let Moments { mean, deviation, .. } = Moments::of(runs);
        let x = x - 0.25 * half;
        if let Some(deviation) = deviation {
            let [low, high] = [mean - deviation, mean + deviation].map(|y| panel.place_y(y));
            let mut bar = Path::polyline(&[[x, low], [x, high]]);
            for y in [low, high] {
                bar.add_polyline(&[[x - 0.7, y], [x + 0.7, y]]);
            }
            scene.stroke(bar, Stroke::new(BLUE, 0.3));
        }
        draw_marker(scene, Marker::Disc, [x, panel.place_y(mean)], 1.9, BLUE);
    }
    scene.group_from(first, Some(panel.area), panel.facts());
    panel.draw_axes(scene, style);
    for (k, (runs, target)) in check.runs.iter().zip(&check.target).enumerate() {
        let Some(error) = error(runs, *target).map(|error| 100.0 * error) else { continue };
        let sign = if error > 0.0 { "+" } else { "" };
        let line = Line::new(&format!("{sign}{} %", fixed(error, 1)), 0.8 * style.size());
        let at = [panel.place_x(k as f64), panel.area.top - 0.35 * style.size()];
        if line.width < 1.02 * step {
            scene.text(line, at, Anchor::Middle, 0.0, SOFT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene::Item;
    use super::*;

    fn drawn(runs: Vec<Vec<f64>>) -> Scene {
        let sets = (1..=runs.len()).map(|set| set.to_string()).collect();
        let target = vec![30.0; runs.len()];
        let response = Quantity::new("UCS", "", "MPa");
        Verification { sets, checks: vec![Check { response, target, runs }] }.scene(&Style::wide(84.0))
    }

    /// Lines of the width and colour of a bar, but for those around a marker.
    fn bars(items: &[Item]) -> usize {
        let count = |item: &Item| match item {
            Item::Shape { fill: None, stroke: Some(stroke), .. } => usize::from(*stroke == Stroke::new(BLUE, 0.3)),
            Item::Group { items, .. } => bars(items),
            _ => 0,
        };
        items.iter().map(count).sum()
    }

    /// A bar of length 0 would say that runs do not scatter.
    #[test]
    fn the_scatter_of_a_single_run_is_not_drawn_as_none() {
        let (many, one) = (drawn(vec![vec![29.0, 31.0], vec![30.0, 30.5]]), drawn(vec![vec![29.0, 31.0], vec![30.0]]));
        assert_eq!((bars(&many.items), bars(&one.items)), (2, 1));
        assert!(
            one.description.contains("A single run does not show its scatter: target set 2."),
            "{}",
            one.description
        );
        assert!(!many.description.contains("scatter"), "{}", many.description);
        let words = |scene: &Scene| scene.texts().into_iter().map(|(text, _)| text).collect::<Vec<_>>().join(" ");
        assert!(words(&many).contains("standard deviation") && words(&one).contains("standard deviation"));
        let single = drawn(vec![vec![29.0], vec![30.0]]);
        assert!(!words(&single).contains("standard deviation"), "{}", words(&single));
    }

    #[test]
    fn a_set_without_a_run_and_a_target_of_zero_are_drawn_without_numbers_that_are_none() {
        let none = drawn(vec![vec![29.0, 31.0], vec![]]);
        assert!(none.description.contains("A response without a run: target set 2."), "{}", none.description);
        let text = crate::svg::svg(&none);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let response = Quantity::new("dx", "", "mm");
        let check = Check { response, target: vec![0.0], runs: vec![vec![0.1, -0.1]] };
        let zero = Verification { sets: vec!["1".into()], checks: vec![check] }.scene(&Style::wide(84.0));
        assert!(zero.description.contains("no mean has a relative error"), "{}", zero.description);
    }
}
