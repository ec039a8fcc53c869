//! Two estimates of the same thing against one another, with the line of equality and a band of relative deviation:
//! observed against predicted, computed against published.

use super::axis::{Axis, Scale, extent};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, SOFT, WASH};
use super::panel::{Margins, Panel};
use super::scatter;
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style};

/// Column of the data: key of the response.
pub const RESPONSE: &str = "response";
/// Column of the data: unit of both values.
pub const UNIT: &str = "unit";
/// Column of the data: name of the group.
pub const ORIGIN: &str = "origin";
/// Column of the data: name of the point.
pub const ROW: &str = "row";

/// Points of one origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Name in the legend: "orthogonal table".
    pub name: String,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Vertical values.
    pub y: Vec<f64>,
    /// Names of the points in the data table; may be empty.
    pub rows: Vec<String>,
}

/// One response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pair {
    /// What is compared.
    pub quantity: Quantity,
    /// Points by origin.
    pub clouds: Vec<Cloud>,
    /// A line for the upper left corner: "$R^2$ = 0.988". May be empty.
    pub note: String,
}

/// Square panels, one per response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Word before the horizontal quantity: "Published".
    pub x_word: String,
    /// Word before the vertical quantity: "Computed".
    pub y_word: String,
    /// Responses.
    pub pairs: Vec<Pair>,
    /// Half width of the band as a fraction of the horizontal value: 0.1 for ±10 %.
    pub band: Option<f64>,
}

const BETWEEN: f64 = 3.0;

impl Figure for Agreement {
    fn scene(&self, style: &Style) -> Scene {
        let entries = self.entries();
        let n = self.pairs.len().max(1);
        let columns = n.min(((style.width / 48.0) as usize).max(1));
        let rows = n.div_ceil(columns);
        let legend_height = legend::height(&entries, style.width - 14.0, style);
        let axes: Vec<(Axis, Axis)> = self.pairs.iter().map(|p| self.axes(p)).collect();
        let none = Margins { left: 0.0, top: 0.0, right: 0.0, bottom: 0.0 };
        let margins = axes.iter().fold(none, |m, (x, y)| m.max(Margins::of(x, y, style)));
        let pitch = (style.width - 1.6 + BETWEEN) / columns as f64;
        let side = pitch - BETWEEN - margins.left - margins.right;
        let row_height = side + margins.top + margins.bottom + 1.0;
        let mut scene = Scene::new(style.width, rows as f64 * row_height + legend_height + 1.8);
        scene.title = format!("{} against {} values", self.y_word, self.x_word.to_lowercase());
        scene.description = self.describe();
        legend::draw(&mut scene, &entries, Rect::new(0.8 + margins.left, 0.8, style.width - 14.0, 0.0), style);
        for (i, (pair, (x, y))) in self.pairs.iter().zip(axes).enumerate() {
            let corner = [0.8 + (i % columns) as f64 * pitch, 0.8 + legend_height + (i / columns) as f64 * row_height];
            let outer = Rect::new(corner[0], corner[1], pitch - BETWEEN, row_height - 1.0);
            let left = Margins::of(&x, &y, style).left;
            let panel = Panel { left, ..Panel::with_margins(outer, margins, x, y) };
            self.draw_pair(&mut scene, &panel, pair, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let all = || self.pairs.iter().flat_map(|p| p.clouds.iter().map(move |c| (p, c)));
        let words = |f: &dyn Fn(&Pair, &Cloud, usize) -> String| {
            all()
                .flat_map(|(p, c)| (0..c.x.len()).map(move |i| (p, c, i)))
                .map(|(p, c, i)| f(p, c, i))
                .collect::<Vec<_>>()
        };
        vec![
            Column::words(RESPONSE, words(&|p, _, _| p.quantity.id().to_string())),
            Column::words(UNIT, words(&|p, _, _| p.quantity.unit.clone())),
            Column::words(ORIGIN, words(&|_, c, _| c.name.clone())),
            Column::words(ROW, words(&|_, c, i| c.rows.get(i).cloned().unwrap_or_default())),
            Column::reals(&self.x_word.to_lowercase(), all().flat_map(|(_, c)| c.x.iter().copied()).collect()),
            Column::reals(&self.y_word.to_lowercase(), all().flat_map(|(_, c)| c.y.iter().copied()).collect()),
        ]
    }
}

impl Agreement {
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for cloud in self.pairs.iter().flat_map(|p| &p.clouds) {
            if !names.contains(&cloud.name.as_str()) {
                names.push(&cloud.name);
            }
        }
        names
    }

    fn entries(&self) -> Vec<Entry> {
        let names = self.names();
        let mut entries = Vec::new();
        if names.len() > 1 {
            for (i, name) in names.iter().enumerate() {
                entries.push(Entry::new(*name, Swatch::Point(palette::marker(i), palette::category(i))));
            }
        }
        entries.push(Entry::new("equality", Swatch::Line(Stroke::new(INK, 0.3), None)));
        if let Some(band) = self.band {
            entries.push(Entry::new(format!("±{} %", (band * 1000.0).round() / 10.0), Swatch::Box(palette::BAND)));
        }
        entries
    }

    fn describe(&self) -> String {
        let tell = |p: &Pair| {
            let points: usize = p.clouds.iter().map(|c| c.x.len()).sum();
            let inside = self.band.map(|band| {
                let close = |(x, y): (&f64, &f64)| (y - x).abs() <= band * x.abs();
                let hits = p.clouds.iter().flat_map(|c| c.x.iter().zip(&c.y)).filter(|&p| close(p)).count();
                format!(", {hits} within the band")
            });
            format!("{}: {points} points{}.", p.quantity.words(), inside.unwrap_or_default())
        };
        self.pairs.iter().map(tell).collect::<Vec<_>>().join(" ")
    }

    /// Both axes with the same range and ticks.
    fn axes(&self, pair: &Pair) -> (Axis, Axis) {
        let values = || pair.clouds.iter().flat_map(|c| c.x.iter().chain(&c.y).copied());
        let (low, high) = extent(values());
        let margin = 0.06 * (high - low).max(1e-12 * high.abs());
        let axis = |word: &str| {
            Axis::between(pair.quantity.worded(word).title(), Scale::Linear, low - margin, high + margin, 4)
        };
        (axis(&self.x_word), axis(&self.y_word))
    }

    fn draw_pair(&self, scene: &mut Scene, panel: &Panel, pair: &Pair, style: &Style) {
        panel.draw_grid(scene);
        let first = scene.items.len();
        let ends = [panel.x.low, panel.x.high];
        if let Some(band) = self.band {
            let at = |k: usize, sign: f64| panel.place(ends[k], ends[k] + sign * band * ends[k].abs());
            scene.fill(Path::polygon(&[at(0, 1.0), at(1, 1.0), at(1, -1.0), at(0, -1.0)]), palette::BAND);
        }
        let line = ends.map(|v| panel.place(v, v));
        scene.stroke(Path::polyline(&line), Stroke::new(INK, 0.3));
        let names = self.names();
        for cloud in &pair.clouds {
            let i = names.iter().position(|n| *n == cloud.name).unwrap_or(0);
            let points: Vec<[f64; 2]> = cloud.x.iter().zip(&cloud.y).map(|(&x, &y)| [x, y]).collect();
            scatter::draw(scene, panel, &points, palette::marker(i), 1.5, palette::category(i));
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(scene, style);
        if !pair.note.is_empty() {
            let line = Line::new(&pair.note, 0.9 * style.size());
            let at = [panel.area.left + 1.4, panel.area.top + 1.2 + 0.7 * line.size];
            let ground = line.bounds(at, 0.0).inset(-0.5, -0.5, -0.5, -0.5);
            scene.fill(Path::rect(ground), super::scene::Fill { color: WASH, opacity: 0.85 });
            scene.text(line, at, Anchor::Start, 0.0, SOFT);
        }
    }
}
