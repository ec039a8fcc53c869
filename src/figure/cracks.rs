//! Cracks by mode over the specimen, or damaged interfaces by how much of each is broken, one panel per moment of the test.

use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, SOFT};
use super::scene::{Anchor, Color, Path, Point, Rect, Scene, Stroke};
use super::specimen::{Frame, Outline, thousands};
use super::text::Line;
use super::{Figure, Style};
use math::elementary::sin_cos;

/// One broken bond or damaged interface; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crack {
    /// Middle.
    pub at: Point,
    /// Direction of the crack line in radians from the x axis.
    pub angle: f64,
    /// Length.
    pub length: f64,
    /// Mode or class of damage, an index into [`Cracks::modes`].
    pub mode: usize,
}

/// The cracks at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// Its name: "80 % before the peak".
    pub title: String,
    /// Cracks so far.
    pub cracks: Vec<Crack>,
}

/// What tells the lines of a picture of cracks apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum By {
    /// Lines are cracks, their classes modes.
    #[default]
    Mode,
    /// Lines are interfaces, their classes how much of each is broken, from little to all.
    Damage,
}

impl By {
    /// Title of a picture, and what its lines are called: one and many.
    pub(super) fn words(self) -> [&'static str; 3] {
        match self {
            By::Mode => ["Cracks by mode", "crack", "cracks"],
            By::Damage => ["Damage of the interfaces", "damaged interface", "damaged interfaces"],
        }
    }

    /// Colour of a class.
    pub(super) fn color(self, class: usize) -> Color {
        match self {
            By::Mode => palette::mode(class),
            By::Damage => palette::damage(class),
        }
    }

    /// Name of the column of the classes in the numbers of a picture.
    pub(super) fn column(self) -> &'static str {
        match self {
            By::Mode => "mode",
            By::Damage => "broken",
        }
    }
}

/// Growth of the crack pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cracks {
    /// Shape of the specimen.
    pub outline: Outline,
    /// Lower left corner of the domain in mm.
    pub low: Point,
    /// Upper right corner in mm.
    pub high: Point,
    /// What its classes are.
    pub by: By,
    /// Names of the modes or classes.
    pub modes: Vec<String>,
    /// Moments in order of time.
    pub moments: Vec<Moment>,
    /// Outlines of the aggregate; may be empty.
    pub outlines: Vec<Vec<Point>>,
    /// Ends of the fissures that were there before; may be empty.
    pub fissures: Vec<[Point; 2]>,
}

const BETWEEN: f64 = 2.6;

/// Line of a fissure.
pub(super) fn fissure() -> Stroke {
    Stroke::new(Color(0x8a, 0x91, 0x99), 0.7)
}

impl Figure for Cracks {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let n = self.moments.len().max(1);
        let columns = n.min(if style.width > 130.0 { 6 } else { 2 });
        let rows = n.div_ceil(columns);
        let width = (style.width - 1.6 + BETWEEN) / columns as f64 - BETWEEN;
        let height = width * (self.high[1] - self.low[1]) / (self.high[0] - self.low[0]);
        let row_height = height + 3.0 * size + 1.4;
        let (entries, room) = (self.entries(), style.width - 1.6);
        // Below the rows of the legend.
        let more =
            legend::height(&entries, room, style) - legend::height(&entries[..entries.len().min(1)], room, style);
        let top = 1.7 * size + more;
        let mut scene = Scene::new(style.width, top + rows as f64 * row_height + 2.0 * size);
        let [title, one, many] = self.by.words();
        scene.title = title.into();
        scene.description = self.describe();
        legend::draw(&mut scene, &entries, Rect::new(0.8, 0.8, room, 0.0), style);
        for (i, moment) in self.moments.iter().enumerate() {
            let left = 0.8 + (i % columns) as f64 * (width + BETWEEN);
            let y = top + (i / columns) as f64 * row_height;
            let frame = Frame::fit(self.low, self.high, Rect::new(left, y + 1.55 * size, width, height));
            let frame = frame.shaped(self.outline);
            let [x, _] = frame.area.centre();
            scene.text(Line::new(&moment.title, size), [x, y + 1.1 * size], Anchor::Middle, 0.0, INK);
            self.draw_moment(&mut scene, &frame, moment);
            let count = moment.cracks.len();
            let counts = format!("{} {}", thousands(count), if count == 1 { one } else { many });
            let at = [x, frame.area.bottom + 1.2 * size];
            scene.text(Line::new(&counts, 0.9 * size), at, Anchor::Middle, 0.0, SOFT);
            if i == 0 {
                let y = scene.height - 1.1 * size;
                frame.draw_scale(&mut scene, [left + 0.3, y], style);
            }
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let all = || self.moments.iter().flat_map(|m| m.cracks.iter().map(move |c| (m, c)));
        let reals = |f: fn(&Crack) -> f64| all().map(|(_, c)| f(c)).collect::<Vec<_>>();
        vec![
            Column::words("moment", all().map(|(m, _)| m.title.clone()).collect()),
            Column::reals("x", reals(|c| c.at[0])).with_unit("mm"),
            Column::reals("y", reals(|c| c.at[1])).with_unit("mm"),
            Column::reals("angle", reals(|c| c.angle.to_degrees())).with_unit("deg"),
            Column::reals("length", reals(|c| c.length)).with_unit("mm"),
            Column::words(
                self.by.column(),
                all().map(|(_, c)| self.modes.get(c.mode).cloned().unwrap_or_default()).collect(),
            ),
        ]
    }
}

impl Cracks {
    /// Entries of the legend.
    fn entries(&self) -> Vec<Entry> {
        let there = (!self.fissures.is_empty()).then(|| Entry::new("fissure", Swatch::Line(fissure(), None)));
        let class = |(i, name): (usize, &String)| {
            Entry::new(name.clone(), Swatch::Line(Stroke::new(self.by.color(i), 0.5), None))
        };
        there.into_iter().chain(self.modes.iter().enumerate().map(class)).collect()
    }

    fn describe(&self) -> String {
        let tell = |m: &Moment| {
            let count = |i: usize| m.cracks.iter().filter(|c| c.mode == i).count();
            let parts = self.modes.iter().enumerate().map(|(i, name)| format!("{} {name}", count(i)));
            format!("{}: {}.", m.title, parts.collect::<Vec<_>>().join(", "))
        };
        self.moments.iter().map(tell).collect::<Vec<_>>().join(" ")
    }

    fn draw_moment(&self, scene: &mut Scene, frame: &Frame, moment: &Moment) {
        let mut outlines = Path::default();
        for outline in &self.outlines {
            outlines.add_polygon(&outline.iter().map(|p| frame.place(*p)).collect::<Vec<_>>());
        }
        if !outlines.0.is_empty() {
            scene.shape(outlines, Color(0xea, 0xec, 0xee), Stroke::new(Color(0xc9, 0xcd, 0xd2), 0.12));
        }
        let first = scene.items.len();
        let mut fissures = Path::default();
        self.fissures.iter().for_each(|ends| fissures.add_polyline(&ends.map(|end| frame.place(end))));
        if !fissures.0.is_empty() {
            scene.stroke(fissures, fissure());
        }
        for mode in 0..self.modes.len() {
            let mut path = Path::default();
            for c in moment.cracks.iter().filter(|c| c.mode == mode) {
                let (s, k) = sin_cos(c.angle);
                let (dx, dy) = (k * c.length / 2.0, s * c.length / 2.0);
                path.add_polyline(&[
                    frame.place([c.at[0] - dx, c.at[1] - dy]),
                    frame.place([c.at[0] + dx, c.at[1] + dy]),
                ]);
            }
            if !path.0.is_empty() {
                scene.stroke(path, Stroke::new(self.by.color(mode), 0.28));
            }
        }
        scene.group_from(first, Some(frame.area), Vec::new());
        frame.draw_border(scene);
    }
}
