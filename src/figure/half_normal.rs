//! Half-normal plot of effects (Daniel 1959, doi:10.1080/00401706.1959.10489866): noise lies on a line through the
//! origin, active effects stand off to the right and are named. Effects of several degrees of freedom each take the
//! quantiles of the χ distribution (Wilk & Gnanadesikan 1968, doi:10.1093/biomet/55.1.1).

use super::axis::Axis;
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{BLUE, INK, Marker, SOFT, VERMILION};
use super::panel::{Panel, draw_marker};
use super::scene::{Path, Rect, Scene, Stroke};
use super::{Figure, Quantity, Style, scatter};

/// One effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Name in label markup.
    pub name: String,
    /// Absolute size.
    pub size: f64,
    /// Half-normal quantile of its rank.
    pub quantile: f64,
    /// Whether it counts as active.
    pub active: bool,
}

/// Effects on one response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HalfNormal {
    /// The response.
    pub response: Quantity,
    /// Effects in any order.
    pub effects: Vec<Effect>,
    /// Standard error that the line shows: Lenth's pseudo standard error, or that of the model.
    pub error: f64,
    /// Margin of error to mark, and its name; `None` to leave out.
    pub margin: Option<(String, f64)>,
    /// Degrees of freedom of each effect, 1 or more: with more, sizes are roots of sums of squares, and quantiles are those
    /// of the χ distribution, which for one degree of freedom is the half-normal one.
    pub degrees: usize,
}

impl Figure for HalfNormal {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.8 * style.width);
        scene.title = format!("Half-normal plot of the effects on {}", self.response.words());
        let active: Vec<&str> = self.effects.iter().filter(|e| e.active).map(|e| e.name.as_str()).collect();
        scene.description = format!("{} effects; active: {}.", self.effects.len(), active.join(", "));
        let entries = self.entries();
        let several = self.degrees > 1;
        let title = self.response.worded(if several { "Root sum of squares of" } else { "Absolute effect on" }).title();
        let margin = self.margin.iter().map(|m| m.1);
        let x = Axis::from_zero(title, self.effects.iter().map(|e| 1.04 * e.size).chain(margin), 5);
        let quantile = format!("Quantile of $\\chi_{{{}}}$ / –", self.degrees);
        let quantile = if several { quantile } else { "Half-normal quantile $z$ / –".to_owned() };
        let y = Axis::from_zero(quantile, self.effects.iter().map(|e| e.quantile), 5);
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width() - 10.0, style);
        let panel = Panel::fit(Rect { top: page.top + top, ..page }, x, y, style);
        legend::draw(&mut scene, &entries, Rect { left: panel.area.left, ..page }, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        let end = panel.y.high;
        scene.stroke(Path::polyline(&[panel.place(0.0, 0.0), panel.place(self.error * end, end)]), line_style());
        if let Some((_, at)) = self.margin {
            let x = panel.place_x(at);
            scene.stroke(Path::polyline(&[[x, panel.area.top], [x, panel.area.bottom]]), margin_style());
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        for e in &self.effects {
            let (kind, color) = if e.active { (Marker::Square, VERMILION) } else { (Marker::Disc, BLUE) };
            draw_marker(&mut scene, kind, panel.place(e.size, e.quantile), 1.8, color);
        }
        let at = |e: &Effect| [e.size, e.quantile];
        let named: Vec<_> = self.effects.iter().filter(|e| e.active).map(|e| (e.name.clone(), at(e))).collect();
        let all: Vec<_> = self.effects.iter().map(at).collect();
        scatter::name(&mut scene, &panel, &named, &all, style);
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        vec![
            Column::words("effect", self.effects.iter().map(|e| e.name.clone()).collect()),
            self.response.column("size", self.effects.iter().map(|e| e.size).collect()),
            Column::reals("half_normal_quantile", self.effects.iter().map(|e| e.quantile).collect()),
            Column::whole("active", self.effects.iter().map(|e| i64::from(e.active)).collect()),
        ]
    }
}

impl HalfNormal {
    fn entries(&self) -> Vec<Entry> {
        let mut entries = vec![
            Entry::new("active", Swatch::Point(Marker::Square, VERMILION)),
            Entry::new("noise", Swatch::Point(Marker::Disc, BLUE)),
            Entry::new("standard error", Swatch::Line(line_style(), None)),
        ];
        if let Some((name, _)) = &self.margin {
            entries.push(Entry::new(name.clone(), Swatch::Line(margin_style(), None)));
        }
        entries
    }
}

fn line_style() -> Stroke {
    Stroke::new(SOFT, 0.3)
}

fn margin_style() -> Stroke {
    Stroke::new(INK, 0.3).dashed(&[1.4, 1.0])
}
