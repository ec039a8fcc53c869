//! The points of a design: a square for two factors, a cube for three.
//!
//! Kinds of points (cube, edge, axial, centre) differ by colour and marker; replicated points show their number of runs.

use super::axis::{Axis, Scale, extent, fixed};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, GRID, INK, PAPER, SOFT, WASH};
use super::panel::{Panel, draw_marker};
use super::scene::{Anchor, Path, Point, Rect, Scene, Stroke};
use super::text::Line;
use super::view::View;
use super::{Figure, Quantity, Style};

/// Points of a design in two or three of its factors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignPoints {
    /// Name of the design.
    pub title: String,
    /// Two or three factors.
    pub factors: Vec<Quantity>,
    /// Low and high level of each factor: the sides of the square or cube.
    pub sides: Vec<[f64; 2]>,
    /// Points in natural units, one row each.
    pub points: Vec<Vec<f64>>,
    /// Kind of each point: "cube", "axial", "centre".
    pub kinds: Vec<String>,
}

/// A point of the design: position, kind, number of kinds that were drawn at this position before (several may coincide in
/// a projection), and number of runs at this position, which the first kind shows.
struct Spot {
    at: [f64; 3],
    kind: usize,
    rank: usize,
    count: usize,
}

impl Figure for DesignPoints {
    fn scene(&self, style: &Style) -> Scene {
        let mut scene = Scene::new(style.width, 0.86 * style.width);
        scene.title = format!("Points of the {}", self.title);
        let spots = self.spots();
        scene.description = format!(
            "{} runs at {} places in {} factors.",
            self.points.len(),
            spots.iter().filter(|s| s.rank == 0).count(),
            self.factors.len()
        );
        let entries = self.entries();
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let top = legend::height(&entries, page.width() - 8.0, style);
        legend::draw(&mut scene, &entries, Rect { left: 8.0, ..page }, style);
        let rest = Rect { top: page.top + top, ..page };
        if self.factors.len() > 2 {
            self.draw_cube(&mut scene, rest, &spots, style);
        } else {
            self.draw_square(&mut scene, rest, &spots, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        for (k, factor) in self.factors.iter().enumerate() {
            let values = self.points.iter().map(|p| p.get(k).copied().unwrap_or(f64::NAN)).collect();
            columns.push(factor.column(factor.id(), values));
        }
        columns.push(Column::words("point_type", self.kinds.clone()));
        columns
    }
}

impl DesignPoints {
    fn kind_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for kind in &self.kinds {
            if !names.contains(&kind.as_str()) {
                names.push(kind);
            }
        }
        names
    }

    fn entries(&self) -> Vec<Entry> {
        let names = self.kind_names();
        let entry = |(i, name): (usize, &&str)| {
            let count = self.kinds.iter().filter(|k| k == name).count();
            let runs = if count == 1 { "run" } else { "runs" };
            Entry::new(format!("{name} ({count} {runs})"), Swatch::Point(palette::marker(i), palette::category(i)))
        };
        names.iter().enumerate().map(entry).collect()
    }

    /// Merges equal points, in coded units (−1 and 1 are the sides).
    fn spots(&self) -> Vec<Spot> {
        let names = self.kind_names();
        let mut spots: Vec<Spot> = Vec::new();
        for (point, kind) in self.points.iter().zip(&self.kinds) {
            let mut at = [0.0; 3];
            for ((a, v), [low, high]) in at.iter_mut().zip(point).zip(&self.sides) {
                *a = (2.0 * v - low - high) / (high - low);
            }
            let kind = names.iter().position(|n| n == kind).unwrap_or(0);
            let near = |s: &&mut Spot| s.at.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-9);
            let mut here: Vec<&mut Spot> = spots.iter_mut().filter(near).collect();
            if let Some(first) = here.first_mut() {
                first.count += 1;
            }
            let (rank, known) = (here.len(), here.iter().any(|s| s.kind == kind));
            if !known {
                spots.push(Spot { at, kind, rank, count: usize::from(rank == 0) });
            }
        }
        spots
    }

    fn draw_square(&self, scene: &mut Scene, outer: Rect, spots: &[Spot], style: &Style) {
        let axis = |k: usize| {
            let (low, high) = extent(self.points.iter().filter_map(|p| p.get(k).copied()));
            let margin = 0.14 * (high - low);
            let title = self.factors.get(k).map(Quantity::title).unwrap_or_default();
            Axis::between(title, Scale::Linear, low - margin, high + margin, 5)
        };
        let panel = Panel::fit(outer, axis(0), axis(1), style);
        panel.draw_grid(scene);
        let [[x0, x1], [y0, y1]] = [0, 1].map(|k| self.sides.get(k).copied().unwrap_or([-1.0, 1.0]));
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| panel.place(x, y));
        scene.shape(Path::polygon(&corners), WASH, Stroke::new(SOFT, 0.3));
        let natural = |s: &Spot| {
            let part = |k: usize, [low, high]: [f64; 2]| (low + high + s.at[k] * (high - low)) / 2.0;
            panel.place(part(0, [x0, x1]), part(1, [y0, y1]))
        };
        let middle = panel.place((x0 + x1) / 2.0, (y0 + y1) / 2.0);
        for s in spots.iter().filter(|s| s.at.iter().any(|a| a.abs() > 1.0 + 1e-9)) {
            scene.stroke(Path::polyline(&[middle, natural(s)]), Stroke::new(SOFT, 0.25).dashed(&[1.0, 0.8]));
        }
        for s in spots {
            draw_spot(scene, s, natural(s), 0.0, style);
        }
        panel.draw_axes(scene, style);
    }

    fn draw_cube(&self, scene: &mut Scene, outer: Rect, spots: &[Spot], style: &Style) {
        let size = style.size();
        let view = View::new(-61.0, 14.0);
        let area = outer.inset(9.0, 1.5 * size, 6.0, 4.0 * size);
        let flat = |p: [f64; 3]| view.project(p);
        let all = corners().into_iter().chain(spots.iter().map(|s| s.at));
        let bounds = Rect::around(all.map(flat)).unwrap_or(area);
        let scale = (area.width() / bounds.width()).min(area.height() / bounds.height());
        let (from, to) = (bounds.centre(), area.centre());
        let place = |p: [f64; 3]| {
            let [x, y] = flat(p);
            [to[0] + scale * (x - from[0]), to[1] - scale * (y - from[1])]
        };
        let back = view.back();
        draw_edges(scene, &place, back);
        let mut order: Vec<&Spot> = spots.iter().collect();
        order.sort_by(|a, b| view.depth(a.at).total_cmp(&view.depth(b.at)));
        for s in &order {
            if s.at.iter().any(|a| a.abs() > 1.0 + 1e-9) {
                let line = [place([0.0; 3]), place(s.at)];
                scene.stroke(Path::polyline(&line), Stroke::new(SOFT, 0.25).dashed(&[1.0, 0.8]));
            }
        }
        for s in order {
            draw_spot(scene, s, place(s.at), 0.5 - 0.5 * view.depth(s.at) / 3.0_f64.sqrt(), style);
        }
        self.draw_edge_titles(scene, &place, back, style);
    }

    fn draw_edge_titles(&self, scene: &mut Scene, place: &dyn Fn([f64; 3]) -> Point, back: [f64; 3], style: &Style) {
        let size = style.size();
        let edges: [([f64; 3], [f64; 3], Point); 3] = [
            ([-1.0, -back[1], -1.0], [1.0, -back[1], -1.0], [0.0, 1.0]),
            ([-back[0], -1.0, -1.0], [-back[0], 1.0, -1.0], [0.75, 0.66]),
            ([back[0], -back[1], -1.0], [back[0], -back[1], 1.0], [-1.0, 0.0]),
        ];
        for (k, (low, high, away)) in edges.into_iter().enumerate() {
            let (Some(factor), Some(&[a, b])) = (self.factors.get(k), self.sides.get(k)) else { continue };
            let ends = [(a, place(low)), (b, place(high))];
            let mid = [(ends[0].1[0] + ends[1].1[0]) / 2.0, (ends[0].1[1] + ends[1].1[1]) / 2.0];
            for (value, at) in ends {
                let line = Line::new(&level(value), 0.9 * size);
                // Moved a little inwards, so that the numbers at the common corner of two edges do not touch.
                let at = [at[0] + 0.14 * (mid[0] - at[0]), at[1] + 0.14 * (mid[1] - at[1])];
                let reach = 1.8 + line.width / 2.0 * away[0].abs() + 0.33 * size * away[1];
                scene.text_centred(line, [at[0] + reach * away[0], at[1] + reach * away[1]], Anchor::Middle, SOFT);
            }
            let line = Line::new(&factor.short(), size);
            if k == 2 {
                scene.text(line, [mid[0] - 2.0 * size, mid[1]], Anchor::Middle, 90.0, INK);
            } else {
                let reach = 3.4 + line.width / 2.0 * away[0].abs() + 0.6 * size * away[1];
                scene.text_centred(line, [mid[0] + reach * away[0], mid[1] + reach * away[1]], Anchor::Middle, INK);
            }
        }
    }
}

fn level(value: f64) -> String {
    let exact = |d: &usize| {
        (format!("{value:.d$}").parse::<f64>().unwrap_or(f64::NAN) - value).abs() < 1e-9 * value.abs().max(1.0)
    };
    fixed(value, (0..4).find(exact).unwrap_or(4))
}

fn corners() -> Vec<[f64; 3]> {
    (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 1 { 1.0 } else { -1.0 })).collect()
}

/// The twelve edges; those behind are dashed. Lines through the middle of each face help the eye.
fn draw_edges(scene: &mut Scene, place: &dyn Fn([f64; 3]) -> Point, back: [f64; 3]) {
    let (mut near, mut far) = (Path::default(), Path::default());
    for a in corners() {
        for axis in 0..3 {
            if a[axis] > 0.0 {
                continue;
            }
            let mut b = a;
            b[axis] = 1.0;
            let hidden = (0..3).filter(|&k| k != axis).all(|k| a[k] == back[k]);
            let path = if hidden { &mut far } else { &mut near };
            path.add_polyline(&[place(a), place(b)]);
        }
    }
    let mut faces = Path::default();
    for axis in 0..3 {
        for along in (0..3).filter(|&k| k != axis) {
            let across = 3 - axis - along;
            let mut ends = [[0.0; 3]; 2];
            for (end, v) in ends.iter_mut().zip([-1.0, 1.0]) {
                (end[axis], end[along], end[across]) = (back[axis], v, 0.0);
            }
            faces.add_polyline(&ends.map(place));
        }
    }
    scene.stroke(faces, Stroke::new(GRID, 0.2));
    scene.stroke(far, Stroke::new(SOFT, 0.2).dashed(&[1.2, 1.0]));
    scene.stroke(near, Stroke::new(SOFT, 0.3));
}

/// `away` is 0 at the eye and 1 at the far corner: distant points are smaller and paler.
fn draw_spot(scene: &mut Scene, spot: &Spot, at: Point, away: f64, style: &Style) {
    let color = palette::category(spot.kind).mix(PAPER, 0.45 * away);
    let size = (2.9 - 0.8 * away) * [1.0, 0.55, 0.35][spot.rank.min(2)];
    draw_marker(scene, palette::marker(spot.kind), at, size, color);
    if spot.count > 1 {
        let line = Line::new(&format!("×{}", spot.count), 0.9 * style.size());
        // A white background separates the number from the edges behind it.
        let ground = Rect::new(at[0] + 1.7, at[1] - 2.9, line.width + 0.6, 2.6);
        scene.fill(Path::rect(ground), PAPER);
        scene.text_centred(line, [at[0] + 2.0, at[1] - 1.6], Anchor::Start, INK);
    }
}
