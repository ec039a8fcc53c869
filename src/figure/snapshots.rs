//! A test as it goes on: the specimen at its stored states, displaced and with the cracks so far. As a moving picture, the
//! cracks open one by one beside the stress–strain curve.
//!
//! Displacements are magnified by a round number, which is printed: those of concrete and rock at the peak are a thousandth of
//! the specimen. A crack goes with the disc that was nearest to it. Discs stand still between two states; cracks have a strain
//! of their own, and do not.

use super::axis::{Axis, Scale, significant};
use super::column::Column;
use super::cracks::Crack;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, Marker, SOFT, VERMILION};
use super::panel::{Panel, draw_marker};
use super::scene::{Anchor, Item, Path, Point, Rect, Scene, Stroke};
use super::specimen::{Frame, Specimen, group_color, thousands};
use super::text::Line;
use super::{Figure, Style};
use math::elementary::sin_cos;

/// The specimen at one moment; lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Axial strain.
    pub strain: f64,
    /// Its name: "80 % of the peak".
    pub title: String,
    /// Centre of each disc.
    pub centres: Vec<Point>,
}

/// A test in the plane; lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshots {
    /// The specimen before loading; outlines of the aggregate are not drawn.
    pub specimen: Specimen,
    /// States in the order of time.
    pub states: Vec<State>,
    /// Names of the modes of cracks.
    pub modes: Vec<String>,
    /// Cracks in the order of breaking, with the axial strain at which they opened.
    pub cracks: Vec<(f64, Crack)>,
    /// The curve: axial strain and stress in MPa.
    pub curve: Vec<Point>,
}

/// Scenes of the moving picture.
const FRAMES: usize = 60;
/// The largest displacement of a state on the page, as a share of the height.
const SHOWN: f64 = 0.04;
/// Space around a specimen into which displaced discs may reach, as a share of its width.
const AROUND: f64 = 0.05;
const BETWEEN: f64 = 2.0;

/// What is drawn of a specimen.
struct Drawn {
    frame: Frame,
    clip: Rect,
    magnified: f64,
    /// The disc that goes with each crack.
    nearest: Vec<usize>,
}

impl Figure for Snapshots {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let n = self.states.len().max(1);
        let columns = n.min(if style.width > 130.0 { 4 } else { 2 });
        let width = (style.width - 1.6 + BETWEEN) / columns as f64 - BETWEEN;
        let height =
            width * (self.specimen.high[1] - self.specimen.low[1]) / (self.specimen.high[0] - self.specimen.low[0]);
        let entries = self.entries();
        let top = 1.0 + legend::height(&entries, style.width - 1.6, style);
        let row = height + 3.2 * size;
        let mut scene = Scene::new(style.width, top + n.div_ceil(columns) as f64 * row + 2.2 * size);
        self.head(&mut scene);
        legend::draw(&mut scene, &entries, Rect::new(0.8, 0.8, style.width - 1.6, 0.0), style);
        let (magnified, nearest) = (self.magnification(), self.nearest());
        for (i, state) in self.states.iter().enumerate() {
            let (left, y) = (0.8 + (i % columns) as f64 * (width + BETWEEN), top + (i / columns) as f64 * row);
            let place = Rect::new(left, y + 1.6 * size, width, height);
            let drawn = self.drawn(place, magnified, nearest.clone());
            let x = drawn.clip.centre()[0];
            scene.text(Line::new(&state.title, size), [x, y + 1.1 * size], Anchor::Middle, 0.0, INK);
            let item = self.discs(&drawn, Some(i));
            scene.items.extend(item);
            let until = self.cracks.partition_point(|(strain, _)| *strain <= state.strain);
            scene.items.extend(self.opened(&drawn, 0..until, Some(i)));
            let count = format!("{} {}", thousands(until), if until == 1 { "crack" } else { "cracks" });
            let at = [x, drawn.clip.bottom + 1.2 * size];
            scene.text(Line::new(&count, 0.9 * size), at, Anchor::Middle, 0.0, SOFT);
            if i == 0 {
                let foot = bottom(&scene, size);
                drawn.frame.draw_scale(&mut scene, [left + 0.3, foot], style);
            }
        }
        self.note(&mut scene, magnified, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let all = || {
            self.states
                .iter()
                .flat_map(|s| s.centres.iter().zip(&self.specimen.centres).map(move |(c, from)| (s, c, from)))
        };
        let each =
            |pick: &dyn Fn(&Point, &Point) -> f64| all().map(|(_, now, from)| pick(now, from)).collect::<Vec<f64>>();
        let disc = self.states.iter().flat_map(|state| (1..=state.centres.len()).map(|i| i as i64));
        vec![
            Column::words("state", all().map(|(state, ..)| state.title.clone()).collect()),
            Column::reals("axial_strain", all().map(|(state, ..)| state.strain).collect()),
            Column::whole("disc", disc.collect()),
            Column::reals("x", each(&|now, _| now[0])).with_unit("mm"),
            Column::reals("y", each(&|now, _| now[1])).with_unit("mm"),
            Column::reals("dx", each(&|now, from| now[0] - from[0])).with_unit("mm"),
            Column::reals("dy", each(&|now, from| now[1] - from[1])).with_unit("mm"),
        ]
    }

    fn frames(&self, style: &Style) -> Vec<Scene> {
        let end = self.curve.iter().map(|p| p[0]).fold(0.0, f64::max);
        if !(end > 0.0) || self.states.is_empty() {
            return Vec::new();
        }
        let width = 0.5 * (style.width - 1.6) - BETWEEN;
        let height =
            width * (self.specimen.high[1] - self.specimen.low[1]) / (self.specimen.high[0] - self.specimen.low[0]);
        let entries = self.entries();
        let top = 1.0 + legend::height(&entries, style.width - 1.6, style);
        // Below the curve stand three lines with its numbers.
        let tall = height.max(0.9 * width + 5.0 * style.size());
        let drawn = self.drawn(Rect::new(0.8, top, width, height), self.magnification(), self.nearest());
        let mut ground = Scene::new(style.width, top + tall + 3.2 * style.size());
        self.head(&mut ground);
        legend::draw(&mut ground, &entries, Rect::new(0.8, 0.8, style.width - 1.6, 0.0), style);
        let foot = bottom(&ground, style.size());
        drawn.frame.draw_scale(&mut ground, [1.1, foot], style);
        self.note(&mut ground, drawn.magnified, style);
        let outer = Rect::new(0.8 + width + 2.0 * BETWEEN, top, style.width - width - 2.0 * BETWEEN - 3.6, 0.9 * width);
        let panel = self.curve_panel(&mut ground, outer, style);
        let discs: Vec<Option<Item>> = (0..self.states.len()).map(|state| self.discs(&drawn, Some(state))).collect();
        let (start, mut cracks, mut opened, mut before) = (self.discs(&drawn, None), Vec::new(), 0, None);
        let mut frames = Vec::new();
        for number in 0..FRAMES {
            let strain = end * number as f64 / (FRAMES - 1) as f64;
            let state = self.states.iter().rposition(|state| state.strain <= strain * (1.0 + 1e-9));
            let until = self.cracks.partition_point(|(own, _)| *own <= strain);
            // An item for the cracks of each scene, which the later scenes share until the discs move on.
            if state != before {
                cracks.clear();
                (before, opened) = (state, 0);
            }
            cracks.extend(self.opened(&drawn, opened..until, state));
            opened = until;
            let mut scene = ground.clone();
            scene.items.extend(state.map_or(&start, |state| &discs[state]).clone());
            scene.items.extend(cracks.iter().cloned());
            self.draw_now(&mut scene, &panel, strain, until, style);
            frames.push(scene);
        }
        frames
    }
}

/// Where scale and note stand.
fn bottom(scene: &Scene, size: f64) -> f64 {
    scene.height - 1.1 * size
}

impl Snapshots {
    fn head(&self, scene: &mut Scene) {
        scene.title = "The specimen during the test".into();
        let tell = |state: &State| {
            let until = self.cracks.partition_point(|(strain, _)| *strain <= state.strain);
            format!("{}: {until} cracks.", state.title)
        };
        scene.description = self.states.iter().map(tell).collect::<Vec<_>>().join(" ");
    }

    fn entries(&self) -> Vec<Entry> {
        let group = |(i, name): (usize, &String)| Entry::new(name.clone(), Swatch::Box(group_color(i)));
        let mode = |(i, name): (usize, &String)| {
            Entry::new(name.clone(), Swatch::Line(Stroke::new(palette::mode(i), 0.5), None))
        };
        self.specimen.groups.iter().enumerate().map(group).chain(self.modes.iter().enumerate().map(mode)).collect()
    }

    /// The round number, one at least, by which displacements are multiplied: 98 of 100 discs of the last state stay within
    /// the share of the height that is meant for them. A disc that has come loose counts as little as it should.
    fn magnification(&self) -> f64 {
        let Some(last) = self.states.last() else { return 1.0 };
        let moved = |(now, from): (&Point, &Point)| (now[0] - from[0]).abs().max((now[1] - from[1]).abs());
        let mut moved: Vec<f64> = last.centres.iter().zip(&self.specimen.centres).map(moved).collect();
        moved.sort_by(f64::total_cmp);
        let most = moved.get(moved.len() * 98 / 100).copied().unwrap_or(0.0);
        let room = SHOWN * (self.specimen.high[1] - self.specimen.low[1]);
        let steps = [1000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0];
        steps.into_iter().find(|by| most > 0.0 && by * most <= room).unwrap_or(1.0)
    }

    /// The disc nearest to each crack before loading.
    fn nearest(&self) -> Vec<usize> {
        let apart = |a: &Point, b: &Point| (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
        let nearest = |(_, crack): &(f64, Crack)| {
            let distance = |i: &usize| apart(&self.specimen.centres[*i], &crack.at);
            (0..self.specimen.centres.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        self.cracks.iter().map(nearest).collect()
    }

    fn drawn(&self, place: Rect, magnified: f64, nearest: Vec<usize>) -> Drawn {
        let margin = AROUND * (self.specimen.high[0] - self.specimen.low[0]);
        let (low, high) = (self.specimen.low.map(|v| v - margin), self.specimen.high.map(|v| v + margin));
        let frame = Frame::fit(low, high, place);
        Drawn { frame, clip: frame.area, magnified, nearest }
    }

    /// A point that goes with a disc, on the page.
    fn moved(&self, drawn: &Drawn, at: Point, disc: usize, state: Option<usize>) -> Point {
        let Some(now) = state.and_then(|state| self.states[state].centres.get(disc)) else {
            return drawn.frame.place(at);
        };
        let from = self.specimen.centres[disc];
        drawn.frame.place([0, 1].map(|k| at[k] + drawn.magnified * (now[k] - from[k])))
    }

    /// All discs in a state, or before loading.
    fn discs(&self, drawn: &Drawn, state: Option<usize>) -> Option<Item> {
        let of = |group: usize| {
            let members =
                (0..self.specimen.centres.len()).filter(|&i| self.specimen.group.get(i).copied().unwrap_or(0) == group);
            let disc = |i: usize| {
                (self.moved(drawn, self.specimen.centres[i], i, state), drawn.frame.length(self.specimen.radii[i]))
            };
            Item::Discs { discs: members.map(disc).collect(), color: group_color(group) }
        };
        let items: Vec<Item> = (0..self.specimen.groups.len()).map(of).collect();
        (!items.is_empty()).then(|| Item::Group { clip: Some(drawn.clip), facts: Vec::new(), items })
    }

    /// The cracks of these numbers, where their discs are in a state.
    fn opened(&self, drawn: &Drawn, which: std::ops::Range<usize>, state: Option<usize>) -> Option<Item> {
        let mut page = Scene::new(0.0, 0.0);
        for mode in 0..self.modes.len() {
            let mut path = Path::default();
            for i in which.clone().filter(|&i| self.cracks[i].1.mode == mode) {
                let crack = &self.cracks[i].1;
                let (s, c) = sin_cos(crack.angle);
                let [x, y] = self.moved(drawn, crack.at, drawn.nearest[i], state);
                let half = 0.5 * drawn.frame.length(crack.length);
                path.add_polyline(&[[x - c * half, y + s * half], [x + c * half, y - s * half]]);
            }
            if !path.0.is_empty() {
                page.stroke(path, Stroke::new(palette::mode(mode), 0.3));
            }
        }
        let items = page.items;
        (!items.is_empty()).then(|| Item::Group { clip: Some(drawn.clip), facts: Vec::new(), items })
    }

    fn note(&self, scene: &mut Scene, magnified: f64, style: &Style) {
        let text =
            if magnified > 1.0 { format!("displacements × {magnified}") } else { "displacements to scale".to_owned() };
        let at = [scene.width - 0.8, bottom(scene, style.size())];
        scene.text_centred(Line::new(&text, 0.9 * style.size()), at, Anchor::End, SOFT);
    }

    /// The curve, which all scenes share.
    fn curve_panel(&self, scene: &mut Scene, outer: Rect, style: &Style) -> Panel {
        let x =
            Axis::between("Axial strain / %", Scale::Linear, 0.0, 100.0 * self.curve.last().map_or(1.0, |p| p[0]), 3);
        let y = Axis::from_zero("Stress $\\sigma$ / MPa", self.curve.iter().map(|p| p[1]), 4);
        let panel = Panel::fit(outer, x, y, style);
        panel.draw_grid(scene);
        let line: Vec<Point> = self.curve.iter().map(|p| panel.place(100.0 * p[0], p[1])).collect();
        scene.stroke(Path::polyline(&line), Stroke::new(SOFT, 0.3));
        panel.draw_axes(scene, style);
        panel
    }

    /// The moment on the curve, and in numbers below it.
    fn draw_now(&self, scene: &mut Scene, panel: &Panel, strain: f64, cracks: usize, style: &Style) {
        let size = style.size();
        let here = self.curve.partition_point(|p| p[0] < strain).min(self.curve.len() - 1);
        let stress = self.curve[here][1];
        draw_marker(scene, Marker::Disc, panel.place(100.0 * strain, stress), 2.2, VERMILION);
        let lines = [
            format!("strain {} %", significant(100.0 * strain, 3)),
            format!("stress {} MPa", significant(stress, 3)),
            format!("{} {}", thousands(cracks), if cracks == 1 { "crack" } else { "cracks" }),
        ];
        for (k, line) in lines.iter().enumerate() {
            let at = [panel.area.left, panel.area.bottom + (5.2 + 1.5 * k as f64) * size];
            scene.text(Line::new(line, size), at, Anchor::Start, 0.0, INK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four discs in a square of 40 mm; in the second state the upper ones are 0.02 mm lower.
    fn square() -> Snapshots {
        let centres = vec![[10.0, 10.0], [30.0, 10.0], [10.0, 30.0], [30.0, 30.0]];
        let down =
            |by: f64| centres.iter().map(|c: &Point| [c[0], if c[1] > 20.0 { c[1] - by } else { c[1] }]).collect();
        let state = |strain, title: &str, by| State { strain, title: title.into(), centres: down(by) };
        let crack = |mode| Crack { at: [20.0, 29.0], angle: 0.0, length: 2.0, mode };
        let states = vec![state(2e-4, "half", 0.008), state(1e-3, "end", 0.02)];
        let specimen = Specimen {
            low: [0.0, 0.0],
            high: [40.0, 40.0],
            centres,
            radii: vec![10.0; 4],
            group: vec![0, 0, 1, 1],
            groups: vec!["mortar".into(), "aggregate".into()],
            ..Specimen::default()
        };
        Snapshots {
            specimen,
            states,
            modes: vec!["tension".into(), "shear".into()],
            cracks: vec![(2e-4, crack(0)), (9e-4, crack(1)), (9e-4, crack(1))],
            curve: vec![[0.0, 0.0], [5e-4, 10.0], [1e-3, 4.0]],
        }
    }

    #[test]
    fn displacements_are_magnified_by_a_round_number_that_is_printed() {
        let square = square();
        // 4 % of 40 mm is 1.6 mm, so 0.02 mm may be multiplied by 80 at most.
        assert_eq!(square.magnification(), 50.0);
        assert!(square.scene(&Style::wide(90.0)).texts().iter().any(|(text, _)| text == "displacements × 50"));
        let drawn = square.drawn(Rect::new(0.0, 0.0, 44.0, 44.0), 50.0, square.nearest());
        // One millimetre on a page of one millimetre for each; the domain has a margin of 2 mm.
        assert_eq!(square.moved(&drawn, [10.0, 30.0], 2, None), [12.0, 12.0]);
        assert!((square.moved(&drawn, [10.0, 30.0], 2, Some(1))[1] - 13.0).abs() < 1e-9);
        assert_eq!(square.nearest(), [2, 2, 2]);
    }

    #[test]
    fn cracks_open_at_their_strain_and_stay() {
        let square = square();
        let frames = square.frames(&Style::wide(90.0));
        let said = |frame: &Scene, what: &str| frame.texts().iter().any(|(text, _)| text == what);
        assert_eq!(frames.len(), FRAMES);
        assert!(said(&frames[0], "0 cracks") && said(&frames[0], "strain 0 %"), "{}", frames[0]);
        assert!(said(&frames[FRAMES - 1], "3 cracks") && said(&frames[FRAMES - 1], "stress 4.00 MPa"));
        // 1/5 of the strain is frame 11.8 of 59.
        assert!(said(&frames[11], "0 cracks") && said(&frames[12], "1 crack"));
        assert!(frames.iter().all(|frame| frame.faults().is_empty()), "{:?}", frames[0].faults());
        assert!(super::super::film::film(&frames, 0.1).is_some());
    }
}
