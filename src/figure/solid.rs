//! A specimen in space: shaded balls in the colours of their groups, optionally cut open, or its cracks as thin discs.
//!
//! The view is a parallel projection. Balls are shaded by four discs each, from a dark rim to a light spot on the side of
//! the light (upper left); balls that are farther away are paler, so that depth shows in print. Only balls that a ray from the
//! eye meets first are drawn: a cube of 67,000 balls shows some thousand of them, and its file stays small.
//! A cut plane removes all balls in front of it along one axis; balls that it intersects show a flat section.

mod frame;
pub mod growth;

use super::Figure;
use super::Style;
use super::column::Column;
use super::cracks::{By, fissure};
use super::legend::{self, Entry, Swatch};
use super::palette::{INK, PAPER};
use super::scene::{Anchor, Fill, Item, Path, Point, Rect, Scene, Stroke};
use super::specimen::{group_color, thousands};
use super::text::Line;
use super::view::View;
use math::elementary::sin_cos;

/// One broken bond in space; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penny {
    /// Middle.
    pub at: [f64; 3],
    /// Normal of the crack.
    pub normal: [f64; 3],
    /// Radius.
    pub radius: f64,
    /// Mode, an index into [`Solid::modes`].
    pub mode: usize,
}

/// A fissure in space, a disc; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Middle.
    pub at: [f64; 3],
    /// Normal.
    pub normal: [f64; 3],
    /// Radius.
    pub radius: f64,
}

/// A plane across one axis that opens the specimen to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Position on that axis in mm.
    pub at: f64,
}

/// A specimen in space; lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Corner of the domain with the least coordinates.
    pub low: [f64; 3],
    /// The opposite corner.
    pub high: [f64; 3],
    /// Centre of each ball.
    pub centres: Vec<[f64; 3]>,
    /// Radius of each ball.
    pub radii: Vec<f64>,
    /// Group of each ball, an index into `groups`.
    pub group: Vec<usize>,
    /// Names of the groups.
    pub groups: Vec<String>,
    /// Cracks; with any, balls are left out and only the frame shows the specimen.
    pub cracks: Vec<Penny>,
    /// Names of the modes, or classes of damage.
    pub modes: Vec<String>,
    /// Whether cracks are shown even where there is none yet.
    pub only_cracks: bool,
    /// What these are.
    pub by: By,
    /// Fissures that were there before, drawn as rims with the cracks.
    pub fissures: Vec<Rim>,
    /// Where the specimen is cut open.
    pub cut: Option<Cut>,
    /// The axis of a cylinder or thick disc, which has a round frame; none of a box.
    pub round: Option<usize>,
    /// Whether the vertical of the picture is the y of the numbers, as of specimens that are loaded along y; the axis
    /// into the depth of the picture is then their −z. Otherwise the vertical is z.
    pub y_up: bool,
    /// Direction of the view: azimuth and elevation in degrees.
    pub view: Option<[f64; 2]>,
}

/// Default azimuth and elevation, degrees.
const FROM: [f64; 2] = [-52.0, 24.0];
/// Shades of a ball from its rim inwards: fraction of the radius, and position between dark (0) and light (1).
const SHADES: [(f64, f64); 4] = [(1.0, 0.0), (0.84, 0.38), (0.6, 0.7), (0.3, 1.0)];
/// Cells along the longer side of the picture in the search for visible balls.
const CELLS: f64 = 700.0;

impl Figure for Solid {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let [azimuth, elevation] = self.view.unwrap_or(FROM);
        let view = View::new(azimuth, elevation);
        let bounds = Rect::around(self.corners().map(|c| view.project(c))).unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0));
        let width = 0.72 * style.width;
        let scale = (width / bounds.width()).min(1.1 * style.width / bounds.height());
        let entries = self.entries();
        let top = 1.0 + legend::height(&entries, style.width - 1.6, style);
        let height = bounds.height() * scale;
        let mut scene = Scene::new(style.width, top + height + 5.2 * size);
        let cracks = match self.by {
            By::Mode => "Cracks in space",
            By::Damage => "Damage of the interfaces in space",
        };
        scene.title = if self.shows_balls() { "Specimen in space".into() } else { cracks.into() };
        scene.description = self.describe();
        legend::draw(&mut scene, &entries, Rect::new(0.8, 0.8, style.width - 1.6, 0.0), style);
        let left = (style.width - bounds.width() * scale) / 2.0;
        let place = |p: [f64; 3]| {
            let [x, y] = view.project(p);
            [left + (x - bounds.left) * scale, top + 0.6 * size + height - (y - bounds.top) * scale]
        };
        let page = Page { view: &view, place: &place, scale };
        self.draw_frame(&mut scene, &page, false);
        if self.shows_balls() {
            self.draw_balls(&mut scene, &page)
        } else {
            self.draw_cracks(&mut scene, &page)
        }
        self.draw_frame(&mut scene, &page, true);
        self.draw_sizes(&mut scene, &page, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        if self.shows_balls() {
            let axis = |k: usize| self.centres.iter().map(|c| self.named(*c)[k]).collect();
            let name = |g: &usize| self.groups.get(*g).cloned().unwrap_or_default();
            return vec![
                Column::reals("x", axis(0)).with_unit("mm"),
                Column::reals("y", axis(1)).with_unit("mm"),
                Column::reals("z", axis(2)).with_unit("mm"),
                Column::reals("radius", self.radii.clone()).with_unit("mm"),
                Column::words("group", self.group.iter().map(name).collect()),
            ];
        }
        let reals = |pick: &dyn Fn(&Penny) -> f64| self.cracks.iter().map(pick).collect::<Vec<f64>>();
        let mode = |c: &Penny| self.modes.get(c.mode).cloned().unwrap_or_default();
        let mut columns = Vec::new();
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            columns.push(Column::reals(axis, reals(&|c| self.named(c.at)[k])).with_unit("mm"));
        }
        for (k, axis) in ["normal_x", "normal_y", "normal_z"].into_iter().enumerate() {
            columns.push(Column::reals(axis, reals(&|c| self.named(c.normal)[k])));
        }
        columns.push(Column::reals("radius", reals(&|c| c.radius)).with_unit("mm"));
        columns.push(Column::words(self.by.column(), self.cracks.iter().map(mode).collect()));
        columns
    }
}

/// The projection of points of the model.
struct Page<'a> {
    view: &'a View,
    place: &'a dyn Fn([f64; 3]) -> Point,
    scale: f64,
}

/// One item to be drawn, ordered by its distance from the eye.
enum Part {
    Ball(usize),
    Section(usize, f64),
}

impl Solid {
    fn shows_balls(&self) -> bool {
        self.cracks.is_empty() && !self.only_cracks
    }

    fn corners(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 1 { self.high[b] } else { self.low[b] }))
    }

    fn entries(&self) -> Vec<Entry> {
        if self.shows_balls() {
            let count = |i: usize| self.group.iter().filter(|g| **g == i).count();
            let entry = |(i, name): (usize, &String)| {
                Entry::new(format!("{name} ({})", thousands(count(i))), Swatch::Box(group_color(i)))
            };
            return self.groups.iter().enumerate().map(entry).collect();
        }
        let count = |i: usize| self.cracks.iter().filter(|c| c.mode == i).count();
        let entry = |(i, name): (usize, &String)| {
            Entry::new(format!("{name} ({})", thousands(count(i))), Swatch::Box(self.by.color(i)))
        };
        let modes = self.modes.iter().enumerate().map(entry);
        let there = Entry::new(format!("fissure ({})", self.fissures.len()), Swatch::Line(fissure(), None));
        (!self.fissures.is_empty()).then_some(there).into_iter().chain(modes).collect()
    }

    /// Names of the axes of the picture; the third is its vertical.
    fn names(&self) -> [&'static str; 3] {
        if self.y_up { ["x", "z", "y"] } else { ["x", "y", "z"] }
    }

    /// A position or direction of the picture as x, y and z of the numbers.
    fn named(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.y_up { [x, z, 0.0 - y] } else { [x, y, z] }
    }

    fn describe(&self) -> String {
        let size: Vec<String> = (0..3).map(|k| format!("{} mm", round(self.high[k] - self.low[k]))).collect();
        let what = if self.shows_balls() {
            format!("{} balls", self.centres.len())
        } else {
            format!("{} {}", self.cracks.len(), self.by.words()[2])
        };
        let cut = match self.cut {
            Some(cut) => {
                let axis = cut.axis.min(2);
                let at = if self.y_up && axis == 1 { 0.0 - cut.at } else { cut.at };
                format!(", cut open at {} = {} mm", self.names()[axis], round(at))
            }
            None => String::new(),
        };
        format!("{what} in {}{cut}.", size.join(" × "))
    }

    /// Sign of the side of the cut that is removed: the one in front of the plane as seen from the eye.
    fn before(&self, view: &View, cut: Cut) -> f64 {
        -view.back()[cut.axis.min(2)]
    }

    /// Balls behind the cut with the depth at which they are drawn, and the sections of those that it intersects.
    fn parts(&self, view: &View) -> Vec<(f64, Part)> {
        let mut parts = Vec::new();
        for (i, (&centre, &radius)) in self.centres.iter().zip(&self.radii).enumerate() {
            let depth = view.depth(centre);
            let Some(cut) = self.cut else {
                parts.push((depth, Part::Ball(i)));
                continue;
            };
            let beyond = (centre[cut.axis.min(2)] - cut.at) * self.before(view, cut);
            if beyond < radius {
                parts.push((depth, Part::Ball(i)));
            }
            if beyond.abs() < radius {
                // the plane is nearer to the eye than all balls that remain
                parts.push((f64::INFINITY, Part::Section(i, (radius * radius - beyond * beyond).sqrt())));
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        parts
    }

    fn draw_balls(&self, scene: &mut Scene, page: &Page) {
        let parts = self.parts(page.view);
        let seen = self.seen(page, &parts);
        let depths: Vec<f64> = self.corners().map(|c| page.view.depth(c)).collect();
        let (far, near) = super::axis::extent(depths);
        for (depth, part) in &parts {
            match part {
                Part::Ball(i) if seen[*i] => {
                    let away = 0.34 * (near - depth) / (near - far).max(f64::MIN_POSITIVE);
                    self.draw_ball(scene, page, *i, away);
                }
                Part::Ball(_) => {}
                Part::Section(i, radius) => self.draw_section(scene, page, *i, *radius),
            }
        }
    }

    /// The balls that are nearest to the eye somewhere on the page.
    fn seen(&self, page: &Page, parts: &[(f64, Part)]) -> Vec<bool> {
        let extent = self.corners().map(page.place);
        let bounds = Rect::around(extent).unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0)).inset(-4.0, -4.0, -4.0, -4.0);
        let cell = bounds.width().max(bounds.height()) / CELLS;
        let (columns, rows) = ((bounds.width() / cell) as usize + 1, (bounds.height() / cell) as usize + 1);
        let mut owner = vec![usize::MAX; columns * rows];
        for (_, part) in parts {
            let Part::Ball(i) = part else { continue };
            let ([x, y], r) = ((page.place)(self.centres[*i]), self.radii[*i] * page.scale);
            let cells = |v: f64, most: usize| ((v / cell).max(0.0) as usize).min(most - 1);
            for row in cells(y - r - bounds.top, rows)..=cells(y + r - bounds.top, rows) {
                for column in cells(x - r - bounds.left, columns)..=cells(x + r - bounds.left, columns) {
                    let (dx, dy) =
                        (bounds.left + (column as f64 + 0.5) * cell - x, bounds.top + (row as f64 + 0.5) * cell - y);
                    // a ball smaller than a cell still owns the cell that it lies in
                    if dx * dx + dy * dy <= (r + 0.5 * cell) * (r + 0.5 * cell) {
                        owner[row * columns + column] = *i;
                    }
                }
            }
        }
        let mut seen = vec![false; self.centres.len()];
        owner.into_iter().filter(|&i| i != usize::MAX).for_each(|i| seen[i] = true);
        seen
    }

    fn draw_ball(&self, scene: &mut Scene, page: &Page, i: usize, away: f64) {
        let ([x, y], r) = ((page.place)(self.centres[i]), self.radii[i] * page.scale);
        let base = group_color(self.group.get(i).copied().unwrap_or(0));
        let (dark, light) = (base.mix(INK, 0.52), base.mix(PAPER, 0.55));
        for (share, tone) in SHADES {
            // two discs are enough for a small ball
            if r < 0.35 && share < 0.8 {
                continue;
            }
            let shift = 0.36 * (1.0 - share) * r;
            let color = dark.mix(light, tone).mix(PAPER, away);
            scene.items.push(Item::Discs { discs: vec![([x - shift, y - shift], share * r)], color });
        }
    }

    /// The flat section of a ball that the cut intersects.
    fn draw_section(&self, scene: &mut Scene, page: &Page, i: usize, radius: f64) {
        let Some(cut) = self.cut else { return };
        let mut centre = self.centres[i];
        centre[cut.axis.min(2)] = cut.at;
        let mut normal = [0.0; 3];
        normal[cut.axis.min(2)] = 1.0;
        let base = group_color(self.group.get(i).copied().unwrap_or(0));
        let path = Path::polygon(&circle(centre, normal, radius, 24).map(page.place).collect::<Vec<_>>());
        scene.shape(path, base.mix(PAPER, 0.25), Stroke::new(base.mix(INK, 0.6), 0.1));
    }

    fn draw_cracks(&self, scene: &mut Scene, page: &Page) {
        let mut order: Vec<&Penny> = self.cracks.iter().collect();
        order.sort_by(|a, b| page.view.depth(a.at).total_cmp(&page.view.depth(b.at)));
        let (far, near) = super::axis::extent(self.corners().map(|c| page.view.depth(c)));
        self.draw_rims(scene, page);
        for crack in order {
            let away = 0.62 * (near - page.view.depth(crack.at)) / (near - far).max(f64::MIN_POSITIVE);
            // a disc seen edge on is a line
            let color = self.by.color(crack.mode).mix(PAPER, away);
            let points: Vec<Point> = circle(crack.at, crack.normal, crack.radius, 12).map(page.place).collect();
            scene.shape(Path::polygon(&points), Fill { color, opacity: 0.85 }, Stroke::new(color.mix(INK, 0.3), 0.08));
        }
    }

    /// The rims of the fissures where they lie in the domain.
    fn draw_rims(&self, scene: &mut Scene, page: &Page) {
        let within = |p: &[f64; 3]| (0..3).all(|k| (self.low[k]..=self.high[k]).contains(&p[k]));
        let mut path = Path::default();
        for one in &self.fissures {
            let mut rim: Vec<[f64; 3]> = circle(one.at, one.normal, one.radius, 180).collect();
            rim.extend(rim.first().copied());
            for part in rim.chunk_by(|a, b| within(a) && within(b)).filter(|part| part.len() > 1) {
                path.add_polyline(&part.iter().map(|p| (page.place)(*p)).collect::<Vec<Point>>());
            }
        }
        if !path.0.is_empty() {
            scene.stroke(path, Stroke { width: 0.3, ..fissure() });
        }
    }

    /// The lengths of the three edges below the picture.
    fn draw_sizes(&self, scene: &mut Scene, page: &Page, style: &Style) {
        let size = style.size();
        let back = page.view.back();
        let bottom = |x: f64, y: f64| (page.place)([x, y, self.low[2]]);
        let front = [0, 1].map(|k| if back[k] > 0.0 { self.low[k] } else { self.high[k] });
        let far = [0, 1].map(|k| if back[k] > 0.0 { self.high[k] } else { self.low[k] });
        let names = self.names();
        for k in 0..2 {
            let ends = match k {
                0 => [bottom(far[0], front[1]), bottom(front[0], front[1])],
                _ => [bottom(front[0], far[1]), bottom(front[0], front[1])],
            };
            let middle = [(ends[0][0] + ends[1][0]) / 2.0, (ends[0][1] + ends[1][1]) / 2.0];
            let anchor = if ends[0][0] < ends[1][0] { Anchor::End } else { Anchor::Start };
            let line = Line::new(&format!("{} {} mm", names[k], round(self.high[k] - self.low[k])), size);
            scene.text_centred(line, [middle[0], middle[1] + 1.6 * size], anchor, INK);
        }
        let edge = (page.place)([far[0], front[1], (self.low[2] + self.high[2]) / 2.0]);
        let other = (page.place)([front[0], far[1], (self.low[2] + self.high[2]) / 2.0]);
        let [x, y] = if edge[0] < other[0] { edge } else { other };
        let line = Line::new(&format!("{} {} mm", names[2], round(self.high[2] - self.low[2])), size);
        scene.text(line, [x - 0.8 * size, y], Anchor::Middle, 90.0, INK);
    }
}

/// A length with at most two decimals.
fn round(mm: f64) -> f64 {
    (100.0 * mm).round() / 100.0
}

/// Points around a circle in space.
fn circle(centre: [f64; 3], normal: [f64; 3], radius: f64, points: usize) -> impl Iterator<Item = [f64; 3]> {
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length > 0.0 { v.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
    };
    let n = unit(normal);
    // the axis that is least along the normal
    let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = unit(cross(n, axis));
    let v = cross(n, u);
    (0..points).map(move |i| {
        let (s, c) = sin_cos(2.0 * std::f64::consts::PI * i as f64 / points as f64);
        [0, 1, 2].map(|k| centre[k] + radius * (c * u[k] + s * v[k]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_lies_in_its_plane_at_its_radius() {
        let (centre, normal) = ([1.0, -2.0, 3.0], [0.3, 0.5, -0.8]);
        for p in circle(centre, normal, 2.5, 17) {
            let d = [0, 1, 2].map(|k| p[k] - centre[k]);
            let along: f64 = d.iter().zip(normal).map(|(a, b)| a * b).sum();
            let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!(along.abs() < 1e-12 && (length - 2.5).abs() < 1e-12, "{p:?}");
        }
    }

    /// Two balls one behind the other: the farther one is not drawn, unless the cut takes the nearer one away.
    #[test]
    fn hidden_balls_are_left_out_and_a_cut_uncovers_them() {
        let [azimuth, elevation] = [0.0, 0.0];
        let mut solid = Solid {
            low: [-2.0; 3],
            high: [2.0; 3],
            centres: vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
            radii: vec![0.5, 0.5],
            group: vec![0, 1],
            groups: vec!["mortar".into(), "aggregate".into()],
            view: Some([azimuth, elevation]),
            ..Solid::default()
        };
        let drawn = |solid: &Solid| {
            let scene = solid.scene(&Style::wide(90.0));
            scene.items.iter().filter(|item| matches!(item, Item::Discs { .. })).count()
        };
        assert_eq!(drawn(&solid), SHADES.len());
        solid.centres[0][1] = 1.2;
        assert_eq!(drawn(&solid), 2 * SHADES.len());
        solid.centres[0][1] = 0.0;
        solid.cut = Some(Cut { axis: 0, at: 0.0 });
        assert_eq!(drawn(&solid), SHADES.len());
    }
}
