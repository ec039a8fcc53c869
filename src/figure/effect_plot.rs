//! Probability plots of effects (Daniel 1959, doi:10.1080/00401706.1959.10489866): noise lies on a line through the
//! origin, active effects lie off to the side and are named. The half-normal plot has absolute effects, the normal
//! plot keeps their signs; effects of several degrees of freedom each take the quantiles of the χ distribution (Wilk &
//! Gnanadesikan 1968, doi:10.1093/biomet/55.1.1).

use super::axis::{Axis, Scale};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{BLUE, INK, Marker, SOFT, VERMILION};
use super::panel::{Panel, draw_marker};
use super::scene::{Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style, scatter};

/// Column of the data: name of the effect in label markup.
pub const EFFECT: &str = "effect";
/// Column of the data: quantile of its rank.
pub const QUANTILE: &str = "quantile";

/// What the effects are plotted against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coordinates {
    /// Absolute effects over half-normal quantiles.
    #[default]
    HalfNormal,
    /// Effects with their signs over normal quantiles.
    Normal,
    /// Roots of the sums of squares of effects with that many degrees of freedom, over quantiles of χ.
    Chi(usize),
}

/// One effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Name in label markup.
    pub name: String,
    /// Effect, absolute except in the normal plot.
    pub size: f64,
    /// Quantile of its rank.
    pub quantile: f64,
    /// Whether it counts as active.
    pub active: bool,
}

/// Effects on one response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectPlot {
    /// The response.
    pub response: Quantity,
    /// What the effects are plotted against.
    pub coordinates: Coordinates,
    /// Effects in any order.
    pub effects: Vec<Effect>,
    /// Standard error that the line shows: Lenth's pseudo standard error, or that of the model.
    pub error: f64,
    /// Whether the effects are divided by their standard errors, and so are pure numbers.
    pub standardized: bool,
    /// Margin of error to mark, and its name; `None` to leave out.
    pub margin: Option<(String, f64)>,
}

impl Figure for EffectPlot {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.8 * style.width);
        scene.title = format!("{} plot of the effects on {}", self.word(), self.response.words());
        let plain = |e: &Effect| Line::new(&e.name, 1.0).plain;
        let active: Vec<String> = self.effects.iter().filter(|e| e.active).map(plain).collect();
        scene.description = format!("{} effects; active: {}.", self.effects.len(), active.join(", "));
        let entries = self.entries();
        let [x, y] = self.axes();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width() - 10.0, style);
        let panel = Panel::fit(Rect { top: page.top + top, ..page }, x, y, style);
        legend::draw(&mut scene, &entries, Rect { left: panel.area.left, ..page }, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        let ends = [panel.y.low, panel.y.high].map(|end| panel.place(self.error * end, end));
        scene.stroke(Path::polyline(&ends), line_style());
        for at in self.margins() {
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
            Column::words(EFFECT, self.effects.iter().map(|e| e.name.clone()).collect()),
            self.response.column("size", self.effects.iter().map(|e| e.size).collect()),
            Column::reals(QUANTILE, self.effects.iter().map(|e| e.quantile).collect()),
            Column::whole("active", self.effects.iter().map(|e| i64::from(e.active)).collect()),
        ]
    }
}

impl EffectPlot {
    fn word(&self) -> &'static str {
        match self.coordinates {
            Coordinates::Normal => "Normal",
            Coordinates::HalfNormal => "Half-normal",
            Coordinates::Chi(_) => "χ",
        }
    }

    /// Positions of the margin's lines.
    fn margins(&self) -> Vec<f64> {
        match (&self.margin, self.coordinates) {
            (None, _) => Vec::new(),
            (Some((_, at)), Coordinates::Normal) => vec![-at, *at],
            (Some((_, at)), _) => vec![*at],
        }
    }

    /// Effects along, quantiles up; the signed plot reaches as far to both sides of zero upwards.
    fn axes(&self) -> [Axis; 2] {
        let (word, quantile) = match self.coordinates {
            Coordinates::Normal if self.standardized => {
                ("Standardized effect on", "Normal quantile $z$ / –".to_owned())
            }
            Coordinates::Normal => ("Effect on", "Normal quantile $z$ / –".to_owned()),
            Coordinates::HalfNormal if self.standardized => {
                ("Standardized absolute effect on", "Half-normal quantile $z$ / –".to_owned())
            }
            Coordinates::HalfNormal => ("Absolute effect on", "Half-normal quantile $z$ / –".to_owned()),
            Coordinates::Chi(degrees) => ("Root sum of squares of", format!("Quantile of $\\chi_{{{degrees}}}$ / –")),
        };
        let unit = if self.standardized { String::new() } else { self.response.unit.clone() };
        let title = Quantity { unit, ..self.response.worded(word) }.title();
        let sizes = self.effects.iter().map(|e| 1.04 * e.size).chain(self.margins());
        let quantiles = self.effects.iter().map(|e| e.quantile);
        if self.coordinates == Coordinates::Normal {
            let both = quantiles.flat_map(|q| [-q, q]);
            return [Axis::around(title, Scale::Linear, sizes, 5), Axis::around(quantile, Scale::Linear, both, 5)];
        }
        [Axis::from_zero(title, sizes, 5), Axis::from_zero(quantile, quantiles, 5)]
    }

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
