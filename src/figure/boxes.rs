//! Box plots: median, quartiles, whiskers and single values of groups side by side; every run is shown as a point.

use super::axis::{Axis, Scale};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::marks::{self, Span, can_show};
use super::palette::{BLUE, INK, Marker, PAPER, SKY, VERMILION};
use super::panel::{Panel, marker};
use super::scene::{Fill, Item, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::xy::capital;
use super::{Figure, Quantity, Style};

/// One group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Name below it.
    pub name: String,
    /// Ends of the whiskers and quartiles: low, first, median, third, high.
    pub five: [f64; 5],
    /// Mean.
    pub mean: f64,
    /// Every value, those beyond the whiskers too.
    pub values: Vec<f64>,
}

/// Groups side by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoxPlot {
    /// The quantity that defines the groups; may be empty.
    pub by: Quantity,
    /// The quantity.
    pub y: Quantity,
    /// Spread of the values.
    pub scale: Scale,
    /// Groups from left to right.
    pub groups: Vec<Group>,
    /// Ends of the axis up the page, where they are asked for; what lies outside is not drawn.
    pub limits: Option<[f64; 2]>,
}

/// Fewer values than this have no box: quartiles of three runs mean nothing.
const LEAST: usize = 4;
/// More groups than this have no room for the number of values beside their name.
const MOST_COUNTED: usize = 4;
/// Golden ratio: points of a group never fall into columns.
const GOLDEN: f64 = 0.618_033_988_749_895;

impl Figure for BoxPlot {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.7 * style.width);
        let by = if self.by.words().is_empty() { String::new() } else { format!(" by {}", self.by.words()) };
        scene.title = format!("{}{by}", capital(&self.y.words()));
        scene.description = self.describe();
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width(), style);
        scene.height += top;
        let outer = Rect { top: page.top + top, bottom: page.bottom + top, ..page };
        let names: Vec<String> = self.groups.iter().map(|group| self.named(group)).collect();
        let x = Axis::categories(self.by.title(), &names);
        let y = Span::of(&self.y, self.scale, self.groups.iter().flat_map(|g| g.values.iter().copied()))
            .within(self.limits);
        let panel = marks::category_panel(outer, &x, &y, style);
        legend::draw(&mut scene, &entries, page, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        for (i, group) in self.groups.iter().enumerate() {
            draw_group(&mut scene, &panel, i as f64, group);
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let plain = |g: &Group| Line::new(&g.name, 1.0).plain;
        let mut columns = vec![
            Column::words("group", self.groups.iter().map(plain).collect()),
            Column::whole("n", self.groups.iter().map(|g| g.values.len() as i64).collect()),
        ];
        let five = ["low", "first_quartile", "median", "third_quartile", "high"].into_iter().enumerate();
        let five = five.map(|(k, key)| (key, self.groups.iter().map(|g| g.five[k]).collect::<Vec<_>>()));
        let mean = ("mean", self.groups.iter().map(|g| g.mean).collect());
        let numbers = five.chain([mean]).map(|(key, values)| Column::reals(key, values).with_unit(&self.y.unit));
        columns.extend(numbers);
        columns
    }
}

impl BoxPlot {
    /// The name of a group with the number of its values, where there is room for it.
    fn named(&self, group: &Group) -> String {
        let count = format!("n = {}", group.values.len());
        match (self.groups.len() <= MOST_COUNTED, group.name.is_empty()) {
            (false, _) => group.name.clone(),
            (true, true) => count,
            (true, false) => format!("{} ({count})", group.name),
        }
    }

    fn entries(&self) -> Vec<Entry> {
        let point = Swatch::Point(Marker::Disc, BLUE);
        let mut entries =
            vec![Entry::new("single value", point), Entry::new("mean", Swatch::Point(Marker::Diamond, VERMILION))];
        if self.groups.iter().any(|g| g.values.len() >= LEAST) {
            entries.insert(0, Entry::new("box: quartiles, median; whiskers: to 1.5 box heights", Swatch::Box(SKY)));
        }
        entries
    }

    fn describe(&self) -> String {
        let tell = |g: &Group| {
            let name = if g.name.is_empty() { String::new() } else { format!("{}: ", g.name) };
            format!("{name}median {} of {}", self.y.in_words(g.five[2]), g.values.len())
        };
        let all = self.groups.iter().map(tell).collect::<Vec<_>>().join("; ");
        Line::new(&format!("{all}."), 1.0).plain
    }
}

fn draw_group(scene: &mut Scene, panel: &Panel, at: f64, group: &Group) {
    let pitch = panel.area.width() / (panel.x.high - panel.x.low);
    let half = (0.3 * pitch).min(6.0);
    let middle = panel.place_x(at);
    let y = |v: f64| panel.place_y(if can_show(&panel.y, v) { v } else { panel.y.low });
    let [low, first, median, third, high] = group.five.map(y);
    let boxed = group.values.len() >= LEAST;
    if boxed {
        let ink = || Stroke::new(INK, 0.25);
        let mut whiskers = Path::polyline(&[[middle, third], [middle, high]]);
        whiskers.add_polyline(&[[middle, first], [middle, low]]);
        for end in [low, high] {
            whiskers.add_polyline(&[[middle - 0.4 * half, end], [middle + 0.4 * half, end]]);
        }
        scene.stroke(whiskers, ink());
        let body = Rect { left: middle - half, right: middle + half, top: third, bottom: first };
        scene.shape(Path::rect(body), Fill { color: SKY, opacity: 0.55 }, ink());
        scene.stroke(Path::polyline(&[[middle - half, median], [middle + half, median]]), Stroke::new(INK, 0.5));
    }
    let spread = |i: usize| ((i as f64 + 1.0) * GOLDEN).fract() - 0.5;
    let shown = group.values.iter().enumerate().filter(|(_, v)| panel.y.holds(**v));
    let size = if group.values.len() > 200 { 0.25 } else { 0.45 };
    let discs = shown.map(|(i, &v)| ([middle + 1.1 * half * spread(i), panel.place_y(v)], size)).collect();
    scene.items.push(Item::Discs { discs, color: BLUE });
    if panel.y.holds(group.mean) {
        let diamond = marker(Marker::Diamond, [middle, panel.place_y(group.mean)], 1.9);
        scene.shape(diamond, VERMILION, Stroke::new(PAPER, 0.2));
    }
}
