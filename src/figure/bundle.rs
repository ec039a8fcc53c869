//! Curves of many runs in one plot: each run as a thin line, the mean of a group as a thick line with its band, measured
//! curves on top.
//!
//! A group of one curve has no mean. Curves have the colour of their group; those of a single group of more than three are
//! drawn grey, so that mean and measured curves stand out.

use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::marks::{self, Band, Span};
use super::palette::{INK, PAPER};
use super::panel::{Panel, draw_marker};
use super::scene::{Color, Rect, Scene, Stroke};
use super::xy::{Rows, capital};
use super::{Figure, Quantity, Style};

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Name, for the numbers; measured curves have it in the legend.
    pub name: String,
    /// Values along the page.
    pub x: Vec<f64>,
    /// Values up the page.
    pub y: Vec<f64>,
}

/// Curves that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Name in the legend.
    pub name: String,
    /// Its curves.
    pub curves: Vec<Line>,
    /// Mean of the curves with its band; `None` for a single one.
    pub mean: Option<Band>,
}

/// Many curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bundle {
    /// Along the page.
    pub x: Quantity,
    /// Up the page.
    pub y: Quantity,
    /// Groups of curves.
    pub groups: Vec<Group>,
    /// What the band of a mean is, such as "one standard deviation".
    pub band: String,
    /// Measured curves.
    pub measured: Vec<Line>,
    /// Ends of the axes along and up the page, where they are asked for; what lies outside is not drawn.
    pub limits: [Option<[f64; 2]>; 2],
}

/// Curves of a lone group.
const GREY: Color = Color(0xa8, 0xae, 0xb5);
/// Markers along a measured curve.
const MARKS: usize = 14;

impl Figure for Bundle {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.7 * style.width);
        scene.title = format!("{} against {}", capital(&self.y.words()), self.x.words());
        scene.description = self.describe();
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width(), style);
        scene.height += top;
        let outer = Rect { top: page.top + top, bottom: page.bottom + top, ..page };
        let values = |pick: fn(&Line) -> &Vec<f64>| self.lines().flat_map(move |l| pick(l).iter().copied());
        let (linear, band) = (super::axis::Scale::Linear, self.groups.iter().flat_map(|g| &g.mean));
        let x = Span::of(&self.x, linear, values(|l| &l.x)).within(self.limits[0]);
        let y = Span::of(&self.y, linear, values(|l| &l.y).chain(band.flat_map(Band::values))).within(self.limits[1]);
        let panel = marks::panel(outer, &x, &y, style);
        legend::draw(&mut scene, &entries, page, style);
        panel.draw_grid(&mut scene);
        let first = scene.items.len();
        self.draw_groups(&mut scene, &panel);
        for (i, line) in self.measured.iter().enumerate() {
            draw_measured(&mut scene, &panel, i, line);
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let mut rows = Rows::default();
        let mut add = |name: &str, kind: &str, line: &Line| {
            for (x, y) in line.x.iter().zip(&line.y) {
                rows.add(name, kind, [*x, *y, f64::NAN, f64::NAN]);
            }
        };
        for group in &self.groups {
            group.curves.iter().for_each(|c| add(&c.name, "curve", c));
        }
        self.measured.iter().for_each(|c| add(&c.name, "measured", c));
        for group in &self.groups {
            if let Some(mean) = &group.mean {
                rows.add_line(&group.name, mean);
            }
        }
        rows.columns(&self.x, &self.y)
    }
}

impl Bundle {
    fn lines(&self) -> impl Iterator<Item = &Line> {
        self.groups.iter().flat_map(|g| &g.curves).chain(&self.measured)
    }

    fn color(&self, i: usize) -> Color {
        marks::color(i, self.groups.len())
    }

    fn thin(&self, i: usize) -> Stroke {
        let lone = self.groups.len() == 1 && self.groups[0].mean.is_some();
        let color = if lone { GREY } else { self.color(i) };
        let single = self.groups[i].mean.is_none();
        if single { marks::line(i, self.groups.len(), 0.4) } else { Stroke::new(color, 0.18).with_opacity(0.75) }
    }

    fn entries(&self) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (i, group) in self.groups.iter().enumerate() {
            let n = group.curves.len();
            let lone = self.groups.len() == 1;
            let name = if group.name.is_empty() { "runs" } else { &group.name };
            if group.mean.is_none() {
                if !(lone && group.name.is_empty()) {
                    entries.push(Entry::new(name, Swatch::Line(self.thin(i), None)));
                }
                continue;
            }
            if lone {
                let runs = if group.name.is_empty() { format!("{n} runs") } else { format!("{n} runs of {name}") };
                entries.push(Entry::new(runs, Swatch::Line(self.thin(i), None)));
            }
            let mean = if lone { "mean".to_owned() } else { format!("{name}: mean of {n}") };
            entries.push(Entry::new(mean, Swatch::Line(marks::line(i, self.groups.len(), 0.55), None)));
        }
        if let Some(i) = self.groups.iter().position(|g| g.mean.as_ref().is_some_and(|m| !m.low.is_empty())) {
            entries.push(Entry::new(&self.band, Swatch::Band(self.color(i), 0.18)));
        }
        for (i, line) in self.measured.iter().enumerate() {
            let stroke = measured_stroke(i);
            entries.push(Entry::new(&line.name, Swatch::Line(stroke, Some(super::palette::marker(i)))));
        }
        entries
    }

    fn draw_groups(&self, scene: &mut Scene, panel: &Panel) {
        for (i, group) in self.groups.iter().enumerate() {
            if let Some(mean) = &group.mean {
                mean.draw_ground(scene, panel, self.color(i));
            }
        }
        for (i, group) in self.groups.iter().enumerate() {
            for curve in &group.curves {
                marks::draw_series(scene, panel, &curve.x, &curve.y, &self.thin(i));
            }
        }
        for (i, group) in self.groups.iter().enumerate() {
            if let Some(mean) = &group.mean {
                // a rim of paper keeps the mean apart from the curves below it
                mean.draw_line(scene, panel, &Stroke::new(PAPER, 0.95));
                mean.draw_line(scene, panel, &marks::line(i, self.groups.len(), 0.55));
            }
        }
    }

    fn describe(&self) -> String {
        let runs: usize = self.groups.iter().map(|g| g.curves.len()).sum();
        let means = self.groups.iter().filter(|g| g.mean.is_some()).count();
        let mean = if means > 0 { format!(", the mean with a band of {}", self.band) } else { String::new() };
        let over = match self.measured.len() {
            0 => String::new(),
            1 => ", one measured curve over them".to_owned(),
            n => format!(", {n} measured curves over them"),
        };
        format!("{runs} curves of {} over {}{mean}{over}.", self.y.words(), self.x.words())
    }
}

fn measured_stroke(i: usize) -> Stroke {
    Stroke::new(INK, 0.4).dashed(super::palette::dash(i))
}

/// The curve, with some markers along it that distinguish it from computed ones in print.
fn draw_measured(scene: &mut Scene, panel: &Panel, i: usize, line: &Line) {
    marks::draw_series(scene, panel, &line.x, &line.y, &measured_stroke(i));
    let every = line.x.len().div_ceil(MARKS).max(1);
    for (x, y) in line.x.iter().zip(&line.y).step_by(every) {
        if marks::can_show(&panel.x, *x) && marks::can_show(&panel.y, *y) {
            draw_marker(scene, super::palette::marker(i), panel.place(*x, *y), 1.7, INK);
        }
    }
}
