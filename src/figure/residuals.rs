//! Four views of the residuals of a fitted model: normal quantiles, against the fit, in run order, and against leverage.
//!
//! Residuals are externally studentized; beyond ±`limit` a point is named by its run.

use super::axis::{Axis, Scale};
use super::column::Column;
use super::palette::{self, BLUE, INK, Marker, SOFT, VERMILION};
use super::panel::{Margins, Panel, draw_marker};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style, scatter};

/// Column of the data: name of the run.
pub const RUN: &str = "run";
/// Column of the data: fitted value.
pub const FITTED: &str = "fitted";
/// Column of the data: externally studentized residual.
pub const STUDENTIZED: &str = "studentized_residual";
/// Column of the data: normal quantile of the rank.
pub const QUANTILE: &str = "normal_quantile";
/// Column of the data: diagonal of the hat matrix.
pub const LEVERAGE: &str = "leverage";

/// Residuals of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// The response.
    pub response: Quantity,
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Fitted values.
    pub fitted: Vec<f64>,
    /// Externally studentized residuals.
    pub studentized: Vec<f64>,
    /// Standard normal quantile of each residual's rank.
    pub quantiles: Vec<f64>,
    /// Diagonal of the hat matrix.
    pub leverage: Vec<f64>,
    /// Number of coefficients of the model.
    pub coefficients: usize,
    /// Residuals beyond ± this are named.
    pub limit: f64,
}

impl Figure for Residuals {
    fn scene(&self, style: &Style) -> Scene {
        let columns = if style.width > 130.0 { 4 } else { 2 };
        let rows = 4 / columns;
        let panel_height = if columns == 4 { 0.30 * style.width } else { 0.44 * style.width };
        let mut scene = Scene::new(style.width, rows as f64 * panel_height + 1.6);
        scene.title = format!("Residuals of {}", self.response.words());
        scene.description = self.describe();
        let views = self.views();
        let none = Margins { left: 0.0, top: 0.0, right: 0.0, bottom: 0.0 };
        let margins = views.iter().fold(none, |m, v| m.max(Margins::of(&v.x, &v.y, style)));
        let margins = Margins { top: 1.5 * style.size(), ..margins };
        let pitch = (style.width - 1.6 + 2.0) / columns as f64;
        for (i, view) in views.into_iter().enumerate() {
            let corner = [0.8 + (i % columns) as f64 * pitch, 0.8 + (i / columns) as f64 * panel_height];
            let outer = Rect::new(corner[0], corner[1], pitch - 2.0, panel_height - 0.5);
            let panel = Panel::with_margins(outer, margins, view.x.clone(), view.y.clone());
            self.draw_view(&mut scene, &panel, i, &view, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        vec![
            Column::words(RUN, self.runs.clone()),
            self.response.column(FITTED, self.fitted.clone()),
            Column::reals(STUDENTIZED, self.studentized.clone()),
            Column::reals(QUANTILE, self.quantiles.clone()),
            Column::reals(LEVERAGE, self.leverage.clone()),
        ]
    }
}

/// One of the four panels.
struct View {
    title: &'static str,
    x: Axis,
    y: Axis,
    points: Vec<[f64; 2]>,
}

impl Residuals {
    fn describe(&self) -> String {
        let out: Vec<&str> =
            (0..self.runs.len()).filter(|&i| self.suspicious(i)).map(|i| self.runs[i].as_str()).collect();
        let names = if out.is_empty() { "none".to_string() } else { out.join(", ") };
        format!("{} runs; beyond ±{}: {names}.", self.runs.len(), self.limit)
    }

    fn suspicious(&self, i: usize) -> bool {
        self.studentized.get(i).is_some_and(|t| t.abs() > self.limit)
    }

    fn views(&self) -> [View; 4] {
        let t = "Studentized residual $t$ / –";
        let (low, high) = super::axis::extent(self.studentized.iter().copied().chain([-self.limit, self.limit]));
        let margin = 0.08 * (high - low);
        let y = |label: &str| Axis::between(label, Scale::Linear, low - margin, high + margin, 5);
        let pairs = |xs: &[f64]| xs.iter().zip(&self.studentized).map(|(&x, &y)| [x, y]).collect::<Vec<_>>();
        let order: Vec<f64> = (1..=self.studentized.len()).map(|i| i as f64).collect();
        let around = |label: &str, v: &[f64]| Axis::around(label, Scale::Linear, v.iter().copied(), 4);
        let fitted = self.response.worded("Fitted").title();
        let critical = 2.0 * self.coefficients as f64 / self.studentized.len().max(1) as f64;
        let leverage = Axis::from_zero("Leverage $h$ / –", self.leverage.iter().copied().chain([critical]), 4);
        [
            View {
                title: "normal quantiles",
                x: around("Normal quantile $z$ / –", &self.quantiles),
                y: y(t),
                points: pairs(&self.quantiles),
            },
            View { title: "against the fit", x: around(&fitted, &self.fitted), y: y(t), points: pairs(&self.fitted) },
            View { title: "in run order", x: around("Run / –", &order), y: y(t), points: pairs(&order) },
            View { title: "against leverage", x: leverage, y: y(t), points: pairs(&self.leverage) },
        ]
    }

    fn draw_view(&self, scene: &mut Scene, panel: &Panel, i: usize, view: &View, style: &Style) {
        panel.draw_grid(scene);
        let first = scene.items.len();
        let across = |y: f64| Path::polyline(&[panel.place(panel.x.low, y), panel.place(panel.x.high, y)]);
        let dashed = Stroke::new(VERMILION, 0.25).dashed(&[1.2, 0.9]);
        for sign in [-1.0, 1.0] {
            scene.stroke(across(sign * self.limit), dashed.clone());
        }
        if i == 0 {
            let ends = [panel.x.low, panel.x.high];
            scene.stroke(Path::polyline(&ends.map(|v| panel.place(v, v))), Stroke::new(INK, 0.3));
        } else {
            scene.stroke(across(0.0), Stroke::new(INK, 0.25));
        }
        if i == 3 {
            let x = 2.0 * self.coefficients as f64 / self.studentized.len().max(1) as f64;
            scene.stroke(Path::polyline(&[panel.place(x, panel.y.low), panel.place(x, panel.y.high)]), dashed);
        }
        if i == 2 {
            for part in panel.places(&view.points.iter().map(|p| p[0]).collect::<Vec<_>>(), &self.studentized) {
                scene.stroke(Path::polyline(&part), Stroke::new(SOFT, 0.15));
            }
        }
        let mut named = Vec::new();
        for (k, p) in view.points.iter().enumerate().filter(|(_, p)| p[0].is_finite() && p[1].is_finite()) {
            let odd = self.suspicious(k);
            let (kind, color) = if odd { (Marker::Square, VERMILION) } else { (Marker::Disc, BLUE) };
            draw_marker(scene, kind, panel.place(p[0], p[1]), 1.4, color);
            if odd {
                named.push((self.runs.get(k).cloned().unwrap_or_default(), *p));
            }
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        scatter::name(scene, panel, &named, &view.points, style);
        panel.draw_axes(scene, style);
        draw_panel_title(scene, panel, i, view.title, style);
    }
}

/// "(a) title" above a panel, flush with its left edge.
pub fn draw_panel_title(scene: &mut Scene, panel: &Panel, number: usize, title: &str, style: &Style) {
    let letter = char::from(b'a' + (number % 26) as u8);
    let bold = Line::with_face(&format!("{letter}"), style.size(), super::font::Face::Semibold);
    let at = [panel.area.left, panel.area.top - 0.55 * style.size()];
    let shift = bold.width + 1.2;
    scene.text(bold, at, Anchor::Start, 0.0, INK);
    scene.text(Line::new(title, style.size()), [at[0] + shift, at[1]], Anchor::Start, 0.0, palette::INK);
}
