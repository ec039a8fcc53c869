//! Any two columns against each other: points by groups, error bars, fitted lines with bands, measured points on top.
//!
//! Up to six groups differ by colour, marker and dash; more of them by colour from dark to light, in the order of their
//! values, and by marker, without bands. Measured values are hollow and black.

use super::axis::{Scale, extent, significant};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::marks::{self, Band, Span};
use super::palette::{INK, Marker, PAPER};
use super::panel::{Panel, draw_marker, marker};
use super::scene::{Item, Rect, Scene, Stroke};
use super::{Figure, Quantity, Style};

/// Points of one group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Name in the legend; empty for the only one.
    pub name: String,
    /// Values along the page.
    pub x: Vec<f64>,
    /// Values up the page.
    pub y: Vec<f64>,
    /// Half lengths of the error bars along the page; empty or NaN for none.
    pub x_error: Vec<f64>,
    /// Half lengths of the error bars up the page; empty or NaN for none.
    pub y_error: Vec<f64>,
    /// A line through them, with its band.
    pub line: Option<Band>,
    /// Text beside the line, in label markup, such as a slope with its standard error; may be empty.
    pub note: String,
}

/// One quantity over another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Xy {
    /// Along the page.
    pub x: Quantity,
    /// Up the page.
    pub y: Quantity,
    /// Spread of the values along the page.
    pub x_scale: Scale,
    /// Spread of the values up the page.
    pub y_scale: Scale,
    /// The quantity that defines the groups; its title stands before their names.
    pub by: Quantity,
    /// Points by group.
    pub clouds: Vec<Cloud>,
    /// Whether the points of a group are joined in the order of x.
    pub joined: bool,
    /// Measured points, drawn over the others.
    pub measured: Vec<Cloud>,
    /// What the bands of the lines are, such as "95 % confidence of the line"; empty without bands.
    pub band: String,
    /// What the error bars are, such as "one standard deviation"; empty without bars.
    pub bars: String,
    /// Ends of the axes along and up the page, where they are asked for; what lies outside is not drawn.
    pub limits: [Option<[f64; 2]>; 2],
}

/// Largest factor by which the axes grow to show the bands.
const WIDEST_BAND: f64 = 1.8;
/// Most groups that have bands; more bands would cover each other.
const MOST_BANDS: usize = 4;
/// Half a marker, in mm.
const MARKER: f64 = 1.1;
/// More points than this are drawn as plain discs.
const MANY: usize = 4000;

impl Figure for Xy {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.74 * style.width);
        scene.title = format!("{} against {}", capital(&self.y.words()), self.x.words());
        scene.description = self.describe();
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width(), style);
        scene.height += top;
        let outer = Rect { top: page.top + top, bottom: page.bottom + top, ..page };
        let panel =
            marks::panel(outer, &self.span_x().within(self.limits[0]), &self.span_y().within(self.limits[1]), style);
        legend::draw(&mut scene, &entries, page, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        self.draw_lines(&mut scene, &panel);
        scene.group_from(first, Some(panel.area), panel.facts());
        // a point on an axis is drawn whole
        let points = scene.items.len();
        for (i, cloud) in self.clouds.iter().enumerate() {
            self.draw_cloud(&mut scene, &panel, i, cloud);
        }
        for (i, cloud) in self.measured.iter().enumerate() {
            draw_measured(&mut scene, &panel, i, cloud);
        }
        scene.group_from(points, Some(panel.area.inset(-MARKER, -MARKER, -MARKER, -MARKER)), Vec::new());
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let mut rows = Rows::default();
        for cloud in &self.clouds {
            rows.add_points(cloud, "point");
            if let Some(line) = &cloud.line {
                rows.add_line(&cloud.name, line);
            }
        }
        for cloud in &self.measured {
            rows.add_points(cloud, "measured");
        }
        rows.columns(&self.x, &self.y)
    }
}

impl Xy {
    fn all(&self) -> impl Iterator<Item = &Cloud> {
        self.clouds.iter().chain(&self.measured)
    }

    fn span_x(&self) -> Span {
        let line = |c: &Cloud| c.line.iter().flat_map(|l| l.x.clone()).collect::<Vec<_>>();
        Span::of(&self.x, self.x_scale, self.all().flat_map(|c| with_errors(&c.x, &c.x_error).chain(line(c))))
    }

    fn span_y(&self) -> Span {
        let line = |c: &Cloud| c.line.iter().flat_map(|l| l.y.clone()).collect::<Vec<_>>();
        let values = || self.all().flat_map(|c| with_errors(&c.y, &c.y_error).chain(line(c)));
        let bare = Span::of(&self.y, self.y_scale, values());
        let bands = self.clouds.iter().filter(|_| self.clouds.len() <= MOST_BANDS).flat_map(|c| &c.line);
        let full = Span::of(&self.y, self.y_scale, values().chain(bands.flat_map(Band::values)));
        // the wide band of a line through few points would compress the points themselves
        if full.high - full.low <= WIDEST_BAND * (bare.high - bare.low) { full } else { bare }
    }

    fn entries(&self) -> Vec<Entry> {
        let n = self.clouds.len();
        let mut entries = Vec::new();
        if n > 1 && !self.by.short().is_empty() {
            entries.push(Entry::new(format!("{}:", self.by.short()), Swatch::Nothing));
        }
        for (i, cloud) in self.clouds.iter().enumerate().filter(|(_, c)| !c.name.is_empty() || !c.note.is_empty()) {
            let lined = cloud.line.is_some() || self.joined;
            let swatch = match lined {
                true => Swatch::Line(marks::line(i, n, 0.4), (!cloud.x.is_empty()).then(|| marks::marker(i))),
                false => Swatch::Point(marks::marker(i), marks::color(i, n)),
            };
            let both = [cloud.name.as_str(), cloud.note.as_str()].into_iter().filter(|t| !t.is_empty());
            entries.push(Entry::new(both.collect::<Vec<_>>().join(": "), swatch));
        }
        for (i, cloud) in self.measured.iter().enumerate() {
            entries.push(Entry::new(&cloud.name, Swatch::Hollow(hollow(i))));
        }
        let has_band = |cloud: &Cloud| cloud.line.as_ref().is_some_and(|line| line.low.iter().any(|l| l.is_finite()));
        if n <= MOST_BANDS && !self.band.is_empty() && self.clouds.iter().any(has_band) {
            entries.push(Entry::new(&self.band, Swatch::Band(marks::color(0, n), 0.18)));
        }
        if !self.bars.is_empty() {
            entries.push(Entry::new(format!("bars: {}", self.bars), Swatch::Nothing));
        }
        entries
    }

    fn draw_lines(&self, scene: &mut Scene, panel: &Panel) {
        let n = self.clouds.len();
        let lines = self.clouds.iter().enumerate().filter_map(|(i, c)| Some((i, c.line.as_ref()?)));
        for (i, line) in lines.filter(|_| n <= MOST_BANDS) {
            line.draw_ground(scene, panel, marks::color(i, n));
        }
        for (i, cloud) in self.clouds.iter().enumerate() {
            if let Some(line) = &cloud.line {
                line.draw_line(scene, panel, &marks::line(i, n, 0.35));
            }
            if self.joined {
                let mut order: Vec<usize> = (0..cloud.x.len()).collect();
                order.sort_by(|&a, &b| cloud.x[a].total_cmp(&cloud.x[b]));
                let pick = |v: &[f64]| order.iter().map(|&i| v[i]).collect::<Vec<_>>();
                marks::draw_series(scene, panel, &pick(&cloud.x), &pick(&cloud.y), &marks::line(i, n, 0.35));
            }
        }
    }

    fn draw_cloud(&self, scene: &mut Scene, panel: &Panel, i: usize, cloud: &Cloud) {
        let (n, many) = (self.clouds.len(), self.clouds.iter().map(|c| c.x.len()).sum::<usize>() > MANY);
        let color = marks::color(i, n);
        marks::draw_errors(scene, panel, &cloud.bars(), color);
        let shown = cloud.shown(panel);
        if many {
            let discs = shown.into_iter().map(|[x, y]| (panel.place(x, y), 0.35)).collect();
            scene.items.push(Item::Discs { discs, color });
            return;
        }
        for [x, y] in shown {
            draw_marker(scene, marks::marker(i), panel.place(x, y), 1.8, color);
        }
    }

    fn describe(&self) -> String {
        let points: usize = self.clouds.iter().map(|c| c.x.len()).sum();
        let groups = match self.clouds.len() {
            0 | 1 => String::new(),
            n => format!(" in {n} groups of {}", self.by.words()),
        };
        // what the points reach, without the bars and bands about them
        let span = |q: &Quantity, pick: fn(&Cloud) -> &Vec<f64>| {
            let (low, high) = extent(self.clouds.iter().flat_map(|c| pick(c).iter().copied()));
            format!("{} {} to {}", q.words(), significant(low, 3), q.in_words(high))
        };
        let reach = format!("{}, {}", span(&self.x, |c| &c.x), span(&self.y, |c| &c.y));
        let measured: usize = self.measured.iter().map(|c| c.x.len()).sum();
        let over = if measured > 0 { format!("; {measured} measured points over them") } else { String::new() };
        super::text::Line::new(&format!("{points} points{groups}: {reach}{over}."), 1.0).plain
    }
}

impl Cloud {
    /// Points that the axes can show.
    fn shown(&self, panel: &Panel) -> Vec<[f64; 2]> {
        let pairs = self.x.iter().zip(&self.y).map(|(x, y)| [*x, *y]);
        pairs.filter(|[x, y]| panel.x.holds(*x) && panel.y.holds(*y)).collect()
    }

    /// Centres and half lengths of the error bars.
    fn bars(&self) -> Vec<([f64; 2], [f64; 2])> {
        let half = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
        let bar = |i: usize| ([self.x[i], self.y[i]], [half(&self.x_error, i), half(&self.y_error, i)]);
        (0..self.x.len().min(self.y.len())).map(bar).collect()
    }
}

/// The values, and the ends of their error bars.
fn with_errors<'a>(values: &'a [f64], errors: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let ends = values.iter().zip(errors).flat_map(|(v, e)| [v - e, v + e]);
    values.iter().copied().chain(ends)
}

fn hollow(i: usize) -> Marker {
    [Marker::Disc, Marker::Square, Marker::Triangle, Marker::Diamond][i % 4]
}

fn draw_measured(scene: &mut Scene, panel: &Panel, i: usize, cloud: &Cloud) {
    marks::draw_errors(scene, panel, &cloud.bars(), INK);
    for [x, y] in cloud.shown(panel) {
        scene.shape(marker(hollow(i), panel.place(x, y), 1.8), PAPER, Stroke::new(INK, 0.28));
    }
    if let Some(line) = &cloud.line {
        line.draw_line(scene, panel, &Stroke::new(INK, 0.35));
    }
}

/// Makes the first letter of a sentence a capital, where it begins a word.
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next();
    match first {
        Some(c) if letters.clone().next().is_some_and(|n| n.is_ascii_lowercase()) => {
            c.to_uppercase().chain(letters).collect()
        }
        _ => words.to_owned(),
    }
}

/// Points and lines below one another, as the CSV of a plot lists them.
#[derive(Default)]
pub(crate) struct Rows {
    series: Vec<String>,
    kind: Vec<String>,
    numbers: [Vec<f64>; 4],
}

impl Rows {
    pub(crate) fn add(&mut self, series: &str, kind: &str, numbers: [f64; 4]) {
        self.series.push(series.to_owned());
        self.kind.push(kind.to_owned());
        for (list, value) in self.numbers.iter_mut().zip(numbers) {
            list.push(value);
        }
    }

    fn add_points(&mut self, cloud: &Cloud, kind: &str) {
        for ([x, y], [_, dy]) in cloud.bars() {
            self.add(&cloud.name, kind, [x, y, y - dy, y + dy]);
        }
    }

    pub(crate) fn add_line(&mut self, series: &str, line: &Band) {
        let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(f64::NAN);
        for i in 0..line.x.len() {
            self.add(series, "line", [line.x[i], line.y[i], at(&line.low, i), at(&line.high, i)]);
        }
    }

    pub(crate) fn columns(self, x: &Quantity, y: &Quantity) -> Vec<Column> {
        let name = |q: &Quantity, other: &str| if q.id().is_empty() { other.to_owned() } else { q.id().to_owned() };
        let plain = |text: &String| super::text::Line::new(text, 1.0).plain;
        let (mut first, mut second) = (name(x, "x"), name(y, "y"));
        for taken in ["series", "kind", "low", "high"] {
            if first == taken {
                first = format!("x_{first}");
            }
            if second == taken {
                second = format!("y_{second}");
            }
        }
        if first == second {
            second = format!("y_{second}");
        }
        let [a, b, low, high] = self.numbers;
        vec![
            Column::words("series", self.series.iter().map(plain).collect()),
            Column::words("kind", self.kind),
            x.column(&first, a),
            y.column(&second, b),
            Column::reals("low", low).with_unit(&y.unit),
            Column::reals("high", high).with_unit(&y.unit),
        ]
    }
}
