//! Ranked horizontal bars: the ranges of a range analysis, or the standardized effects of a screening (Pareto).

use super::axis::{Axis, fixed, significant};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, Marker, PAPER, SOFT};
use super::panel::{Panel, marker};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style};
use math::elementary::log10;

/// One bar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bar {
    /// The factor or effect that it shows.
    pub factor: Quantity,
    /// Group that gives the colour; may be empty.
    pub group: String,
    /// Length, not negative.
    pub value: f64,
    /// Published value to compare with.
    pub published: Option<f64>,
}

/// Ranked bars with reference lines: figures 8–10 of Su et al. 2021 (doi:10.3390/ma14071627), and Pareto charts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RankedBars {
    /// Title of the picture.
    pub title: String,
    /// The quantity that the length shows.
    pub quantity: Quantity,
    /// Bars in any order; they are drawn from the longest to the shortest.
    pub bars: Vec<Bar>,
    /// Labelled vertical lines: critical values, the range of an empty column.
    pub references: Vec<(String, f64)>,
}

impl Figure for RankedBars {
    fn scene(&self, style: &Style) -> Scene {
        let order = self.order();
        let size = style.size();
        let pitch = 1.72 * size;
        let entries = self.entries();
        let legend_height = legend::height(&entries, style.width - 16.0, style);
        let names: Vec<String> = order.iter().map(|&i| self.bars[i].factor.sign()).collect();
        let values = self.bars.iter().flat_map(|b| [b.value, b.published.unwrap_or(0.0)]);
        let values = values.chain(self.references.iter().map(|r| r.1));
        let mut x = Axis::from_zero(self.quantity.title(), values, 5);
        // Room for the numbers behind the bars.
        let largest = order.first().map_or(1.0, |&i| self.bars[i].value);
        let number = |bar: &Bar| Line::new(&number(bar.value, largest), 0.9 * size).width;
        let room = self.bars.iter().map(number).fold(0.0, f64::max) + 2.5;
        let beside =
            names.iter().map(|name| Line::new(name, size).width).fold(8.0, |widest: f64, w| widest.max(w + 8.0));
        let left = (style.width - beside - room).max(0.2 * style.width);
        let share = if room > 9.0 { room / left } else { 9.0 / style.width };
        x = Axis::between(x.label, x.scale, 0.0, x.high * (1.0 + share), 5);
        let mut y = Axis::categories("", &names);
        (y.low, y.high) = (y.high, y.low);
        let height = pitch * names.len() as f64 + legend_height + 12.5;
        let mut scene = Scene::new(style.width, height);
        scene.title = self.title.clone();
        scene.description = self.describe(&order);
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let panel = Panel::fit(Rect { top: page.top + legend_height, ..page }, x, y, style);
        legend::draw(&mut scene, &entries, Rect { left: panel.area.left, ..page }, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        for (row, &i) in order.iter().enumerate() {
            self.draw_bar(&mut scene, &panel, row as f64, &self.bars[i]);
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        for (k, (_, at)) in self.references.iter().enumerate() {
            let x = panel.place_x(*at);
            scene.stroke(Path::polyline(&[[x, panel.area.top], [x, panel.area.bottom]]), reference_style(k));
        }
        for (row, &i) in order.iter().enumerate() {
            self.draw_value(&mut scene, &panel, row as f64, &self.bars[i], largest, style);
        }
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let order = self.order();
        let pick = |f: &dyn Fn(&Bar) -> f64| order.iter().map(|&i| f(&self.bars[i])).collect::<Vec<_>>();
        let words = |f: &dyn Fn(&Bar) -> String| order.iter().map(|&i| f(&self.bars[i])).collect::<Vec<_>>();
        let mut columns = vec![
            Column::words("factor", words(&|b| b.factor.id().to_string())),
            Column::words("group", words(&|b| b.group.clone())),
            self.quantity.column("value", pick(&|b| b.value)),
        ];
        if self.bars.iter().any(|b| b.published.is_some()) {
            columns.push(self.quantity.column("published", pick(&|b| b.published.unwrap_or(f64::NAN))));
        }
        for (name, value) in &self.references {
            columns.push(self.quantity.column(name, vec![*value; order.len()]));
        }
        columns
    }
}

impl RankedBars {
    /// Numbers of the bars from the longest to the shortest; equal ones keep their order.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.bars.len()).collect();
        order.sort_by(|&a, &b| self.bars[b].value.total_cmp(&self.bars[a].value));
        order
    }

    fn groups(&self) -> Vec<&str> {
        let mut groups: Vec<&str> = Vec::new();
        for bar in &self.bars {
            if !groups.contains(&bar.group.as_str()) {
                groups.push(&bar.group);
            }
        }
        groups
    }

    fn describe(&self, order: &[usize]) -> String {
        let top = order.iter().take(4).map(|&i| {
            let bar = &self.bars[i];
            let name = Line::new(&bar.factor.sign(), 1.0).plain;
            format!("{name} {}", self.quantity.in_words(bar.value))
        });
        format!("Bars in descending order: {}.", top.collect::<Vec<_>>().join(", "))
    }

    fn entries(&self) -> Vec<Entry> {
        let named = self.groups();
        let groups = named.iter().enumerate().filter(|(_, g)| !g.is_empty());
        let mut entries: Vec<Entry> = groups.map(|(i, g)| Entry::new(*g, Swatch::Box(palette::area(i)))).collect();
        for (k, (name, _)) in self.references.iter().enumerate() {
            entries.push(Entry::new(name.clone(), Swatch::Line(reference_style(k), None)));
        }
        if self.bars.iter().any(|b| b.published.is_some()) {
            entries.push(Entry::new("published", Swatch::Hollow(Marker::Diamond)));
        }
        entries
    }

    fn draw_bar(&self, scene: &mut Scene, panel: &Panel, row: f64, bar: &Bar) {
        let group = self.groups().iter().position(|g| *g == bar.group).unwrap_or(0);
        let (top, bottom) = (panel.place_y(row - 0.33), panel.place_y(row + 0.33));
        let right = panel.place_x(bar.value);
        let patch = Rect { left: panel.area.left, top, right, bottom };
        let color = palette::area(group);
        scene.shape(Path::rect(patch), color, Stroke::new(color.mix(INK, 0.35), 0.15));
    }

    /// The number behind a bar, on a white ground where a reference line passes.
    fn draw_value(&self, scene: &mut Scene, panel: &Panel, row: f64, bar: &Bar, largest: f64, style: &Style) {
        let mut text_from = panel.place_x(bar.value);
        if let Some(published) = bar.published {
            let at = panel.place(published, row);
            scene.shape(marker(Marker::Diamond, at, 1.7), PAPER, Stroke::new(INK, 0.25));
            text_from = text_from.max(at[0] + 0.9);
        }
        let line = Line::new(&number(bar.value, largest), 0.9 * style.size());
        let y = panel.place_y(row);
        scene.fill(Path::rect(Rect::new(text_from + 0.7, y - 1.3, line.width + 0.6, 2.6)), PAPER);
        scene.text_centred(line, [text_from + 1.0, y], Anchor::Start, SOFT);
    }
}

/// The number behind a bar: three digits of the largest one, with a power of ten where that would be long.
fn number(value: f64, largest: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&largest) {
        return significant(value, 3);
    }
    fixed(value, (2.0 - log10(largest.max(1e-300)).floor()).clamp(0.0, 9.0) as usize)
}

fn reference_style(k: usize) -> Stroke {
    let dash: &[f64] = if k == 0 { &[1.4, 1.0] } else { &[0.01, 0.9] };
    Stroke::new(INK, 0.3).dashed(dash)
}
