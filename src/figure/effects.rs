//! Main effects: the mean response at each level of each factor, one small panel per factor, one common scale.

use super::axis::{Axis, Scale, extent, fixed};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, Marker, PAPER, SOFT, WASH};
use super::panel::{Margins, Panel, draw_marker, marker, within};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::{Figure, Quantity, Style};

/// Column of the data: key of the factor.
pub const FACTOR: &str = "factor";
/// Column of the data: level in natural units.
pub const LEVEL: &str = "level";
/// Column of the data: unit of the level.
pub const LEVEL_UNIT: &str = "level_unit";
/// Column of the data: mean response at the level.
pub const MEAN: &str = "mean";

/// Means of one factor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FactorMeans {
    /// The factor.
    pub factor: Quantity,
    /// Group that gives the colour, such as "mortar"; may be empty.
    pub group: String,
    /// Levels in natural units, ascending.
    pub levels: Vec<f64>,
    /// Mean response at each level.
    pub means: Vec<f64>,
    /// Half width of an interval around each mean; empty for none.
    pub half_width: Vec<f64>,
    /// Published means to compare with; empty for none.
    pub published: Vec<f64>,
}

/// Main-effects figure of one response (figures 5–7 of Su et al. 2021, doi:10.3390/ma14071627).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MainEffects {
    /// The response.
    pub response: Quantity,
    /// Its mean over all runs.
    pub grand_mean: f64,
    /// Factors in the order of the design.
    pub factors: Vec<FactorMeans>,
}

const ROW: f64 = 44.0;
const BETWEEN: f64 = 1.6;

impl Figure for MainEffects {
    fn scene(&self, style: &Style) -> Scene {
        let n = self.factors.len().max(1);
        let per_row_most = ((style.width / 23.0) as usize).max(1);
        let rows = n.div_ceil(per_row_most);
        let per_row = n.div_ceil(rows);
        let entries = self.entries();
        let legend_height = legend::height(&entries, style.width - 14.0, style);
        let mut scene = Scene::new(style.width, rows as f64 * ROW + legend_height + 2.2);
        scene.title = format!("Main effects on {}", self.response.words());
        scene.description = self.describe();
        let page = scene.page().inset(0.8, 1.2, 0.8, 0.6);
        let y = self.y_axis();
        let margins = Margins::of(&self.x_axis(0), &y, style);
        let left = page.left + margins.left;
        legend::draw(&mut scene, &entries, Rect { left, ..page }, style);
        let pitch = (page.right - left + BETWEEN) / per_row as f64;
        for (i, means) in self.factors.iter().enumerate() {
            let (row, col) = (i / per_row, i % per_row);
            let x0 = left + col as f64 * pitch;
            let top = page.top + legend_height + row as f64 * ROW;
            let header = Rect::new(x0, top, pitch - BETWEEN, 1.75 * style.size());
            let area =
                Rect { left: x0, top: header.bottom, right: header.right, bottom: top + ROW - margins.bottom - 0.8 };
            let mut axis = y.clone();
            if col > 0 {
                axis.label.clear();
                axis.ticks.iter_mut().for_each(|t| t.label.clear());
                axis.minor.clear();
            }
            let panel = Panel { area, x: self.x_axis(i), y: axis, left: margins.left, boxed: false };
            draw_header(&mut scene, &means.factor.sign(), header, style);
            self.draw_factor(&mut scene, &panel, means, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let rows = || self.factors.iter().flat_map(|f| (0..f.levels.len()).map(move |i| (f, i)));
        let pick = |values: fn(&FactorMeans) -> &Vec<f64>| {
            rows().map(|(f, i)| values(f).get(i).copied().unwrap_or(f64::NAN)).collect::<Vec<_>>()
        };
        let mut columns = vec![
            Column::words(FACTOR, rows().map(|(f, _)| f.factor.id().to_string()).collect()),
            Column::words("group", rows().map(|(f, _)| f.group.clone()).collect()),
            Column::reals(LEVEL, pick(|f| &f.levels)),
            Column::words(LEVEL_UNIT, rows().map(|(f, _)| f.factor.unit.clone()).collect()),
            self.response.column(MEAN, pick(|f| &f.means)),
        ];
        if self.factors.iter().any(|f| !f.half_width.is_empty()) {
            columns.push(self.response.column("half_width", pick(|f| &f.half_width)));
        }
        if self.factors.iter().any(|f| !f.published.is_empty()) {
            columns.push(self.response.column("published", pick(|f| &f.published)));
        }
        columns
    }
}

impl MainEffects {
    fn groups(&self) -> Vec<&str> {
        let mut groups: Vec<&str> = Vec::new();
        for f in &self.factors {
            if !groups.contains(&f.group.as_str()) {
                groups.push(&f.group);
            }
        }
        groups
    }

    fn entries(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (i, group) in self.groups().iter().enumerate().filter(|(_, g)| !g.is_empty()) {
            let swatch = Swatch::Line(Stroke::new(palette::group(i), 0.4), Some(palette::marker(i)));
            entries.push(Entry::new(*group, swatch));
        }
        let mean = Stroke::new(SOFT, 0.25).dashed(&[0.9, 0.8]);
        entries.push(Entry::new("mean of all runs", Swatch::Line(mean, None)));
        if self.factors.iter().any(|f| !f.published.is_empty()) {
            entries.push(Entry::new("published", Swatch::Hollow(Marker::Diamond)));
        }
        entries
    }

    fn describe(&self) -> String {
        let mut spans: Vec<(f64, String)> = Vec::new();
        for f in &self.factors {
            let (low, high) = extent(f.means.iter().copied());
            spans.push((high - low, f.factor.words()));
        }
        spans.sort_by(|a, b| b.0.total_cmp(&a.0));
        let value = |span: f64| format!("{} {}", fixed(span, 3), self.response.unit).trim_end().to_owned();
        let most: Vec<String> = spans.iter().take(3).map(|(span, name)| format!("{name} ({})", value(*span))).collect();
        format!(
            "Mean response per level of {} factors. The means differ most for {}.",
            self.factors.len(),
            most.join(", ")
        )
    }

    fn y_axis(&self) -> Axis {
        let values = self.factors.iter().flat_map(|f| {
            let width = |i: usize| f.half_width.get(i).copied().unwrap_or(0.0);
            let ends = f.means.iter().enumerate().flat_map(move |(i, m)| [m - width(i), m + width(i)]);
            ends.chain(f.published.iter().copied())
        });
        Axis::around(self.response.title(), Scale::Linear, values.chain([self.grand_mean]), 4)
    }

    fn x_axis(&self, i: usize) -> Axis {
        let Some(f) = self.factors.get(i) else { return Axis::between("", Scale::Linear, 0.0, 1.0, 2) };
        let (low, high) = extent(f.levels.iter().copied());
        let room = if high > low { 0.22 * (high - low) } else { 1.0 };
        let label = if f.factor.unit.is_empty() { "–".into() } else { super::text::unit_markup(&f.factor.unit) };
        Axis::between(label, Scale::Linear, low - room, high + room, 3).with_ticks_at(&f.levels).without_grid()
    }

    fn draw_factor(&self, scene: &mut Scene, panel: &Panel, f: &FactorMeans, style: &Style) {
        let group = self.groups().iter().position(|g| *g == f.group).unwrap_or(0);
        let color = palette::group(group);
        panel.draw_grid(scene);
        let y = panel.place_y(self.grand_mean);
        let mean = Stroke::new(SOFT, 0.25).dashed(&[0.9, 0.8]);
        scene.stroke(Path::polyline(&[[panel.area.left, y], [panel.area.right, y]]), mean);
        for (i, &half) in f.half_width.iter().enumerate() {
            let ends = [panel.place(f.levels[i], f.means[i] - half), panel.place(f.levels[i], f.means[i] + half)];
            scene.stroke(Path::polyline(&ends), Stroke::new(color, 0.9).with_opacity(0.3));
        }
        let first = scene.items.len();
        for part in panel.places(&f.levels, &f.means) {
            scene.stroke(Path::polyline(&part), Stroke::new(color, 0.4));
            for at in part {
                draw_marker(scene, palette::marker(group), at, 1.9, color);
            }
        }
        scene.group_from(first, None, panel.facts());
        for part in panel.places(&f.levels, &f.published) {
            for [x, y] in part {
                scene.shape(marker(Marker::Diamond, [x + 1.7, y], 1.4), PAPER, Stroke::new(INK, 0.22));
            }
        }
        panel.draw_axes(scene, style);
    }
}

/// The strip above a small panel.
fn draw_header(scene: &mut Scene, label: &str, place: Rect, style: &Style) {
    scene.fill(Path::rect(place), WASH);
    let [x, y] = place.centre();
    scene.text_centred(within(label, style.size(), place.width() - 1.0), [x, y], Anchor::Middle, INK);
}
