//! A plane specimen: every particle in the colour of its group, aggregate outlines, a scale bar.

use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, SOFT};
use super::scene::{Anchor, Color, Item, Path, Point, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Style};

/// Shape of a specimen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outline {
    /// A rectangle, loaded over its upper and lower side.
    #[default]
    Rectangle,
    /// A disc between two platens, as in the Brazilian test.
    Disc,
}

/// The outline of a specimen on the page: mm of the model → mm of the page.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Position on the page.
    pub area: Rect,
    outline: Outline,
    low: Point,
    scale: f64,
}

impl Frame {
    /// Fits a domain (lower left and upper right corner) into an area of the page, in its upper left corner.
    pub fn fit(low: Point, high: Point, place: Rect) -> Self {
        let (w, h) = (high[0] - low[0], high[1] - low[1]);
        let scale = (place.width() / w).min(place.height() / h);
        Self { area: Rect::new(place.left, place.top, w * scale, h * scale), outline: Outline::Rectangle, low, scale }
    }

    /// The same with the shape of the specimen.
    #[must_use]
    pub fn shaped(self, outline: Outline) -> Self {
        Self { outline, ..self }
    }

    /// A point of the model on the page.
    pub fn place(&self, p: Point) -> Point {
        [self.area.left + (p[0] - self.low[0]) * self.scale, self.area.bottom - (p[1] - self.low[1]) * self.scale]
    }

    /// A length of the model on the page.
    pub fn length(&self, mm: f64) -> f64 {
        mm * self.scale
    }

    /// A scale bar of a round length, its left end at `at`.
    pub fn draw_scale(&self, scene: &mut Scene, at: Point, style: &Style) {
        let model = self.area.width() / self.scale;
        let round = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0];
        let length = round.into_iter().rev().find(|l| *l <= 0.34 * model).unwrap_or(round[0]);
        let end = at[0] + length * self.scale;
        let mut path = Path::polyline(&[at, [end, at[1]]]);
        for x in [at[0], end] {
            path.add_polyline(&[[x, at[1] - 0.7], [x, at[1] + 0.7]]);
        }
        scene.stroke(path, Stroke::new(INK, 0.3));
        let line = Line::new(&format!("{length} mm"), style.size());
        scene.text_centred(line, [end + 1.4, at[1]], Anchor::Start, INK);
    }

    /// The border of the specimen; of a disc also the platens above and below.
    pub fn draw_border(&self, scene: &mut Scene) {
        match self.outline {
            Outline::Rectangle => scene.stroke(Path::rect(self.area), Stroke::new(INK, 0.25)),
            Outline::Disc => {
                let (centre, radius) = (self.area.centre(), self.area.width().min(self.area.height()) / 2.0);
                scene.stroke(Path::circle(centre, radius), Stroke::new(INK, 0.25));
                let half = PLATEN * radius;
                for y in [centre[1] - radius, centre[1] + radius] {
                    let platen = [[centre[0] - half, y], [centre[0] + half, y]];
                    scene.stroke(Path::polyline(&platen), Stroke::new(SOFT, 0.6));
                }
            }
        }
    }
}

/// Half the length of a drawn platen as a share of the radius of the disc.
const PLATEN: f64 = 0.28;

/// Particles of one specimen; lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Specimen {
    /// Its shape.
    pub outline: Outline,
    /// Lower left corner of the domain.
    pub low: Point,
    /// Upper right corner of the domain.
    pub high: Point,
    /// Centre of each particle.
    pub centres: Vec<Point>,
    /// Radius of each particle.
    pub radii: Vec<f64>,
    /// Group of each particle, an index into `groups`.
    pub group: Vec<usize>,
    /// Names of the groups.
    pub groups: Vec<String>,
    /// Outlines of the aggregate; may be empty.
    pub outlines: Vec<Vec<Point>>,
}

/// Sand for the matrix, slate for the aggregate, then the categories.
pub fn group_color(i: usize) -> Color {
    match i {
        0 => Color(0xdd, 0xd3, 0xbf),
        1 => Color(0x4a, 0x63, 0x7d),
        _ => palette::category(i - 1),
    }
}

impl Figure for Specimen {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let aspect = (self.high[1] - self.low[1]) / (self.high[0] - self.low[0]);
        let tall = aspect > 1.2;
        let picture_width = if tall { 0.62 * style.width } else { style.width - 1.6 };
        let height = picture_width * aspect;
        let below = if tall { 0.0 } else { 3.6 * size };
        let mut scene = Scene::new(style.width, height + below + 1.6);
        scene.title = "Specimen".into();
        scene.description = self.describe();
        let frame = Frame::fit(self.low, self.high, Rect::new(0.8, 0.8, picture_width, height));
        let frame = frame.shaped(self.outline);
        for (i, _) in self.groups.iter().enumerate() {
            let discs = self.members(i).map(|k| (frame.place(self.centres[k]), frame.length(self.radii[k]))).collect();
            scene.items.push(Item::Discs { discs, color: group_color(i) });
        }
        let mut outlines = Path::default();
        for outline in &self.outlines {
            outlines.add_polygon(&outline.iter().map(|p| frame.place(*p)).collect::<Vec<_>>());
        }
        if !outlines.0.is_empty() {
            scene.stroke(outlines, Stroke::new(INK, 0.22));
        }
        frame.draw_border(&mut scene);
        let entry = |(i, name): (usize, &String)| {
            Entry::new(format!("{name} ({})", thousands(self.members(i).count())), Swatch::Box(group_color(i)))
        };
        let entries: Vec<Entry> = self.groups.iter().enumerate().map(entry).collect();
        if tall {
            let left = frame.area.right + 4.0;
            legend::draw_stacked(&mut scene, &entries, [left, 1.2], style);
            frame.draw_scale(&mut scene, [left, frame.area.bottom - 1.0], style);
        } else {
            let y = frame.area.bottom + 1.2 * size;
            frame.draw_scale(&mut scene, [1.6, y], style);
            let place = Rect::new(style.width * 0.4, y - 0.72 * size, style.width * 0.6, 0.0);
            legend::draw(&mut scene, &entries, place, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let name = |g: &usize| self.groups.get(*g).cloned().unwrap_or_default();
        vec![
            Column::reals("x", self.centres.iter().map(|c| c[0]).collect()).with_unit("mm"),
            Column::reals("y", self.centres.iter().map(|c| c[1]).collect()).with_unit("mm"),
            Column::reals("radius", self.radii.clone()).with_unit("mm"),
            Column::words("group", self.group.iter().map(name).collect()),
        ]
    }
}

impl Specimen {
    fn members(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.centres.len()).filter(move |&k| self.group.get(k).copied().unwrap_or(0) == group)
    }

    fn describe(&self) -> String {
        let part = |(i, name): (usize, &String)| format!("{} {name}", self.members(i).count());
        let parts: Vec<String> = self.groups.iter().enumerate().map(part).collect();
        let size = [self.high[0] - self.low[0], self.high[1] - self.low[1]];
        format!("{} particles in {} mm × {} mm: {}.", self.centres.len(), size[0], size[1], parts.join(", "))
    }
}

/// 22409 → "22 409" with a thin space.
pub fn thousands(n: usize) -> String {
    if n < 10_000 {
        return n.to_string();
    }
    format!("{}\u{2009}{:03}", n / 1000, n % 1000)
}
