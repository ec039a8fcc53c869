//! Stones as solids with their clumps beside them: for each a shaded surface above and its pebbles below, on one scale.
//!
//! Facets are shaded by the angle of their normal to the light (upper left) and drawn from the far ones to the near ones;
//! those that face away are left out, which is exact for a convex stone. Pebbles are shaded like the balls of a specimen.

use super::column::Column;
use super::palette::{INK, ORANGE, PAPER, SOFT};
use super::scene::{Anchor, Item, Path, Point, Scene, Stroke};
use super::text::Line;
use super::view::View;
use super::{Figure, Style};

/// A stone; lengths in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stone {
    /// Its name.
    pub name: String,
    /// A few words below it, such as its number of pebbles.
    pub note: String,
    /// Corners of the triangles of its surface, anticlockwise from outside.
    pub facets: Vec<[[f64; 3]; 3]>,
    /// Centre and radius of its pebbles.
    pub pebbles: Vec<([f64; 3], f64)>,
}

/// Several stones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stones {
    /// The stones, from left to right.
    pub stones: Vec<Stone>,
}

/// Stones beside one another.
const ACROSS: usize = 5;
/// Rings of a ball: fraction of the radius, and position between dark (0) and light (1).
const RINGS: [(f64, f64); 4] = [(1.0, 0.0), (0.82, 0.4), (0.56, 0.75), (0.26, 1.0)];

impl Figure for Stones {
    fn scene(&self, style: &Style) -> Scene {
        let view = View::new(-60.0, 26.0);
        let size = style.size();
        let across = self.stones.len().clamp(1, ACROSS);
        let cell = style.width / across as f64;
        let reach = self.stones.iter().map(Stone::reach).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let scale = 0.46 * cell / reach;
        let block = 2.0 * cell * 0.92 + 3.4 * size;
        let rows = self.stones.len().div_ceil(across).max(1);
        let mut scene = Scene::new(style.width, rows as f64 * block + 2.4 * size);
        scene.title = "Stones and their clumps".into();
        let told =
            self.stones.iter().map(|s| format!("{}: {} facets, {} pebbles", s.name, s.facets.len(), s.pebbles.len()));
        scene.description = format!("{}.", told.collect::<Vec<_>>().join("; "));
        for (index, stone) in self.stones.iter().enumerate() {
            let x = (index % across) as f64 * cell + 0.5 * cell;
            let top = (index / across) as f64 * block;
            let place = |y: f64| move |p: [f64; 2]| [x + scale * p[0], y - scale * p[1]];
            stone.draw_solid(&mut scene, &view, &place(top + 0.46 * cell));
            stone.draw_clump(&mut scene, &view, &place(top + 1.38 * cell), scale);
            let names = [(&stone.name, INK), (&stone.note, SOFT)];
            for (line, (text, color)) in names.into_iter().enumerate() {
                let at = [x, top + 1.84 * cell + (1.1 + 1.25 * line as f64) * size];
                scene.text(Line::new(text, size), at, Anchor::Middle, 0.0, color);
            }
        }
        draw_scale(&mut scene, reach, scale, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let rows = || self.stones.iter().flat_map(|stone| stone.pebbles.iter().map(move |pebble| (stone, pebble)));
        let axis = |k: usize| rows().map(|(_, (centre, _))| centre[k]).collect();
        vec![
            Column::words("shape", rows().map(|(stone, _)| stone.name.clone()).collect()),
            Column::reals("x", axis(0)).with_unit("mm"),
            Column::reals("y", axis(1)).with_unit("mm"),
            Column::reals("z", axis(2)).with_unit("mm"),
            Column::reals("radius", rows().map(|(_, (_, radius))| *radius).collect()).with_unit("mm"),
        ]
    }
}

/// A bar of a round length.
fn draw_scale(scene: &mut Scene, reach: f64, scale: f64, style: &Style) {
    let size = style.size();
    let decade = math::elementary::pow(10.0, math::elementary::log10(reach).floor());
    let bar = [5.0, 2.0, 1.0].into_iter().map(|step| step * decade).find(|bar| *bar <= reach).unwrap_or(decade);
    let (y, left) = (scene.height - 0.7 * size, 1.2);
    let right = left + bar * scale;
    scene.stroke(Path::polyline(&[[left, y], [right, y]]), Stroke::new(INK, 0.4));
    let label = Line::new(&format!("{} mm", super::axis::significant(bar, 1)), size);
    scene.text_centred(label, [right + 0.5 * size, y], Anchor::Start, INK);
}

impl Stone {
    /// Half the largest extent about the origin.
    fn reach(&self) -> f64 {
        let surface = self.facets.iter().flatten().map(|&p| norm(p));
        surface.chain(self.pebbles.iter().map(|&(centre, radius)| norm(centre) + radius)).fold(0.0, f64::max)
    }

    fn draw_solid(&self, scene: &mut Scene, view: &View, place: &dyn Fn([f64; 2]) -> Point) {
        let mut seen: Vec<(f64, f64, &[[f64; 3]; 3])> = Vec::new();
        for facet in &self.facets {
            let normal = unit(cross(minus(facet[1], facet[0]), minus(facet[2], facet[0])));
            let toward = view.depth(normal);
            if toward > 0.0 {
                let [right, up] = view.project(normal);
                // The light comes from the upper left, in front of the page.
                let light = (0.72 * toward + 0.42 * up - 0.55 * right).clamp(0.0, 1.0);
                seen.push((facet.iter().map(|&p| view.depth(p)).sum(), light, facet));
            }
        }
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, light, facet) in seen {
            let color = SOFT.mix(INK, 0.35).mix(PAPER, 0.12 + 0.74 * light);
            let path = Path::polygon(&facet.map(|p| place(view.project(p))));
            // A line of the same colour closes the seams.
            scene.shape(path, color, Stroke::new(color, 0.06));
        }
    }

    fn draw_clump(&self, scene: &mut Scene, view: &View, place: &dyn Fn([f64; 2]) -> Point, scale: f64) {
        let mut order: Vec<&([f64; 3], f64)> = self.pebbles.iter().collect();
        order.sort_by(|a, b| view.depth(a.0).total_cmp(&view.depth(b.0)));
        let (dark, light) = (ORANGE.mix(INK, 0.5), ORANGE.mix(PAPER, 0.6));
        for &&(centre, radius) in &order {
            let ([x, y], r) = (place(view.project(centre)), radius * scale);
            for (share, tone) in RINGS {
                let shift = 0.36 * (1.0 - share) * r;
                let discs = vec![([x - shift, y - shift], share * r)];
                scene.items.push(Item::Discs { discs, color: dark.mix(light, tone) });
            }
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: [f64; 3]) -> f64 {
    (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    if length > 0.0 { a.map(|x| x / length) } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a tetrahedron only the facets that face the eye are drawn, and every pebble with its rings.
    #[test]
    fn facets_that_face_away_are_left_out() {
        let p = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
        let facets = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|f| f.map(|k: usize| p[k])).to_vec();
        let stone = Stone { name: "t".into(), note: String::new(), facets, pebbles: vec![([1.0; 3], 2.0)] };
        let scene = Stones { stones: vec![stone] }.scene(&Style::wide(90.0));
        let shapes = scene.items.iter().filter(|i| matches!(i, Item::Shape { fill: Some(_), .. })).count();
        let discs = scene.items.iter().filter(|i| matches!(i, Item::Discs { .. })).count();
        assert_eq!((shapes, discs), (2, RINGS.len()));
    }
}
