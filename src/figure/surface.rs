//! A response surface in space: painter's algorithm from the far corner to the near one, with a colour bar.

use super::axis::{Axis, Scale, extent, significant};
use super::column::Column;
use super::contour::{Bands, Contour};
use super::isoline::Field;
use super::palette::{GRID, INK, PAPER, SOFT, WASH};
use super::scene::{Anchor, Path, Point, Rect, Scene, Stroke};
use super::text::Line;
use super::view::View;
use super::{Figure, Style};

/// The surface of a [`Contour`], seen obliquely from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Values and titles; its design points are not drawn.
    pub field: Contour,
    /// Direction of view around the vertical in degrees from the x axis; −60 shows x to the right, y to the back.
    pub azimuth: f64,
    /// Height of the view in degrees.
    pub elevation: f64,
}

/// Facets along one side, at most.
const FACETS: usize = 36;
/// Half height of the box where its half width is 1.
const HEIGHT: f64 = 0.72;

/// The projection of values onto the page.
struct Box3 {
    view: View,
    axes: [Axis; 3],
    scale: f64,
    centre: Point,
}

impl Box3 {
    /// A corner of the box (−1 … 1 along each axis) on the page.
    fn corner(&self, p: [f64; 3]) -> Point {
        let [x, y] = self.view.project([p[0], p[1], HEIGHT * p[2]]);
        [self.centre[0] + self.scale * x, self.centre[1] - self.scale * y]
    }

    fn unit(&self, axis: usize, value: f64) -> f64 {
        2.0 * self.axes[axis].fraction(value) - 1.0
    }

    fn place(&self, v: [f64; 3]) -> Point {
        self.corner([self.unit(0, v[0]), self.unit(1, v[1]), self.unit(2, v[2])])
    }

    /// Attributes from which a script computes values under a pointer: the ends of the three axes, then the points on the page
    /// of their common low corner and of the high end of each.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let ends = self.axes.iter().flat_map(|axis| [axis.low, axis.high]).map(|end| end.to_string());
        let low = [-1.0; 3];
        let high = |axis: usize| std::array::from_fn(|k| if k == axis { 1.0 } else { -1.0 });
        let places = [low, high(0), high(1), high(2)].into_iter().flat_map(|corner| self.corner(corner));
        let places = places.map(|length| format!("{length:.3}"));
        vec![("space", ends.chain(places).collect::<Vec<_>>().join(" "))]
    }
}

impl Figure for Surface {
    fn scene(&self, style: &Style) -> Scene {
        let f = &self.field;
        let size = style.size();
        let mut scene = Scene::new(style.width, 0.74 * style.width);
        scene.title = format!("The response {} over {} and {}", f.z.words(), f.x.words(), f.y.words());
        let (low, high) = extent(f.values.iter().copied());
        scene.description = format!("A surface from {} to {}.", significant(low, 3), f.z.in_words(high));
        let bands = Bands::of(low, high, &f.z);
        let page = scene.page().inset(0.8, 0.8, 0.8, 0.8);
        let note = if f.note.is_empty() { 0.3 * size } else { 1.8 * size };
        let right = page.right - bands.width(style) - 3.0;
        let area = Rect { right, ..page }.inset(5.0 * size, note, 1.6 * size, 3.6 * size);
        let space = self.space(area, (low, high));
        draw_walls(&mut scene, &space);
        self.draw_floor(&mut scene, &space, &bands, style);
        let first = scene.items.len();
        self.draw_facets(&mut scene, &space, &bands, style);
        scene.group_from(first, None, space.facts());
        draw_titles(&mut scene, &space, [&f.x.short(), &f.y.short(), &f.z.short()], style);
        if !f.note.is_empty() {
            let at = [page.left, page.top + 0.8 * size];
            scene.text(Line::new(&f.note, 0.95 * size), at, Anchor::Start, 0.0, SOFT);
        }
        let height = 0.72 * page.height();
        let bar = Rect::new(page.right - bands.width(style), page.top + 0.14 * page.height(), 3.0, height);
        bands.draw_smooth_bar(&mut scene, bar, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        self.field.data()
    }
}

impl Surface {
    fn space(&self, area: Rect, (low, high): (f64, f64)) -> Box3 {
        let f = &self.field;
        let axis = |v: &[f64], scale: Scale| {
            let (low, high) = extent(v.iter().copied());
            Axis::between("", scale, low, high, 4)
        };
        let z = Axis::between("", Scale::Linear, low, high, 4);
        let step = if z.ticks.len() > 1 { z.ticks[1].at - z.ticks[0].at } else { high - low };
        let (z_low, z_high) = ((low / step).floor() * step, (high / step).ceil() * step);
        let axes =
            [axis(&f.xs, f.scales[0]), axis(&f.ys, f.scales[1]), Axis::between("", Scale::Linear, z_low, z_high, 4)];
        let mut space = Box3 { view: View::new(self.azimuth, self.elevation), axes, scale: 1.0, centre: [0.0, 0.0] };
        let bounds = Rect::around(corners().map(|c| space.corner(c))).unwrap_or(area);
        space.scale = (area.width() / bounds.width()).min(area.height() / bounds.height());
        let (middle, place) = (bounds.centre(), area.centre());
        space.centre = [place[0] - space.scale * middle[0], place[1] - space.scale * middle[1]];
        space
    }

    /// Indices along one axis, thinned to [`FACETS`], from far to near.
    fn indices(n: usize, from_low: bool) -> Vec<usize> {
        let parts = (n.max(2) - 1).min(FACETS);
        let mut out: Vec<usize> = (0..=parts).map(|k| k * (n.max(2) - 1) / parts).collect();
        if !from_low {
            out.reverse();
        }
        out
    }

    fn draw_facets(&self, scene: &mut Scene, space: &Box3, bands: &Bands, style: &Style) {
        let f = &self.field;
        let nx = f.xs.len();
        let back = space.view.back();
        let (columns, rows) = (Self::indices(nx, back[0] < 0.0), Self::indices(f.ys.len(), back[1] < 0.0));
        let at = |i: usize, j: usize| [f.xs[i], f.ys[j], f.values[j * nx + i]];
        let line = |scene: &mut Scene, a, b| {
            scene
                .stroke(Path::polyline(&[space.place(a), space.place(b)]), Stroke::new(PAPER, 0.14).with_opacity(0.65));
        };
        for (m, w) in columns.windows(2).enumerate() {
            for (n, v) in rows.windows(2).enumerate() {
                let corners = [at(w[0], v[0]), at(w[1], v[0]), at(w[1], v[1]), at(w[0], v[1])];
                if corners.iter().any(|c| !c[2].is_finite()) {
                    continue;
                }
                let mean = corners.iter().map(|c| c[2]).sum::<f64>() / 4.0;
                let color = style.map.at(bands.axis.fraction(mean));
                // A rim of the same colour closes the hairline that antialiasing leaves between neighbours.
                scene.shape(Path::polygon(&corners.map(|c| space.place(c))), color, Stroke::new(color, 0.12));
                if m % 3 == 0 {
                    line(scene, corners[0], corners[3]);
                }
                if n % 3 == 0 {
                    line(scene, corners[0], corners[1]);
                }
            }
        }
    }

    /// The contours of the surface on the floor of the box.
    fn draw_floor(&self, scene: &mut Scene, space: &Box3, bands: &Bands, style: &Style) {
        let f = &self.field;
        let field = Field { columns: f.xs.len(), values: &f.values };
        let unit = |p: [f64; 2]| {
            let part = |v: f64, n: usize| 2.0 * v / (n.max(2) - 1) as f64 - 1.0;
            space.corner([part(p[0], f.xs.len()), part(p[1], f.ys.len()), -1.0])
        };
        for &level in &bands.levels {
            let color = style.map.at(bands.axis.fraction(level));
            for line in field.lines(level) {
                let points: Vec<Point> = line.into_iter().map(unit).collect();
                scene.stroke(Path::polyline(&points), Stroke::new(color, 0.3));
            }
        }
    }
}

fn corners() -> impl Iterator<Item = [f64; 3]> {
    (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 1 { 1.0 } else { -1.0 }))
}

/// Floor and the two far walls with their grid lines.
fn draw_walls(scene: &mut Scene, space: &Box3) {
    let back = space.view.back();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let point = |a: f64, b: f64| {
            let mut p = [0.0; 3];
            (p[axis], p[u], p[v]) = (back[axis], a, b);
            space.corner(p)
        };
        let wall = Path::polygon(&[point(-1.0, -1.0), point(1.0, -1.0), point(1.0, 1.0), point(-1.0, 1.0)]);
        scene.shape(wall, if axis == 2 { PAPER } else { WASH }, Stroke::new(GRID, 0.2));
        let mut lines = Path::default();
        for tick in &space.axes[u].ticks {
            let a = space.unit(u, tick.at);
            lines.add_polyline(&[point(a, -1.0), point(a, 1.0)]);
        }
        for tick in &space.axes[v].ticks {
            let b = space.unit(v, tick.at);
            lines.add_polyline(&[point(-1.0, b), point(1.0, b)]);
        }
        scene.stroke(lines, Stroke::new(GRID, 0.15));
    }
}

/// Axes along the two near edges of the floor and the outermost edge on the left, with numbers and titles.
fn draw_titles(scene: &mut Scene, space: &Box3, titles: [&str; 3], style: &Style) {
    let back = space.view.back();
    let edges = [
        ([-1.0, -back[1], -1.0], [1.0, -back[1], -1.0]),
        ([-back[0], -1.0, -1.0], [-back[0], 1.0, -1.0]),
        left_edge(space),
    ];
    let middle = space.corner([0.0, 0.0, -1.0]);
    let mut taken: Vec<[Point; 4]> = Vec::new();
    for (axis, (from, to)) in edges.into_iter().enumerate() {
        let (a, b) = (space.corner(from), space.corner(to));
        let mid = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
        let away = if axis == 2 { [-1.0, 0.0] } else { outward(a, b, mid, middle) };
        let reach = draw_edge(scene, space, axis, (from, to), away, &mut taken, style);
        let size = style.size();
        let line = Line::new(titles[axis], size);
        if axis == 2 {
            scene.text(line, [mid[0] - reach - 0.9 * size, mid[1]], Anchor::Middle, 90.0, INK);
            continue;
        }
        let slope = math::elementary::atan2(a[1] - b[1], b[0] - a[0]).to_degrees();
        let angle = if slope.abs() > 90.0 { slope - 180.0 * slope.signum() } else { slope };
        let gap = reach + 0.9 * size;
        scene.text(line, [mid[0] + gap * away[0], mid[1] + gap * away[1] + 0.25 * size], Anchor::Middle, angle, INK);
    }
}

/// The vertical edge that is farthest to the left on the page.
fn left_edge(space: &Box3) -> ([f64; 3], [f64; 3]) {
    let all = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let x = |c: &[f64; 2]| space.corner([c[0], c[1], -1.0])[0];
    let best = all.into_iter().min_by(|a, b| x(a).total_cmp(&x(b))).unwrap_or([-1.0, -1.0]);
    ([best[0], best[1], -1.0], [best[0], best[1], 1.0])
}

/// Unit vector on the page across the edge a–b, away from `middle`.
fn outward(a: Point, b: Point, mid: Point, middle: Point) -> Point {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = (dx * dx + dy * dy).sqrt().max(1e-9);
    let normal = [-dy / length, dx / length];
    let side = normal[0] * (mid[0] - middle[0]) + normal[1] * (mid[1] - middle[1]);
    if side < 0.0 { [-normal[0], -normal[1]] } else { normal }
}

/// Draws an axis with the labels that have room; returns how far the labels reach from the edge, mm.
fn draw_edge(
    scene: &mut Scene,
    space: &Box3,
    axis: usize,
    (from, to): ([f64; 3], [f64; 3]),
    away: Point,
    taken: &mut Vec<[Point; 4]>,
    style: &Style,
) -> f64 {
    let size = style.size();
    let mut path = Path::polyline(&[space.corner(from), space.corner(to)]);
    let mut farthest = 0.0_f64;
    for tick in &space.axes[axis].ticks {
        let mut p = from;
        p[axis] = space.unit(axis, tick.at);
        let [x, y] = space.corner(p);
        path.add_polyline(&[[x, y], [x + 0.9 * away[0], y + 0.9 * away[1]]]);
        let line = Line::new(&tick.label, size);
        // The box of the label must not touch the edge: half its extent along the outward direction.
        let reach = 1.5 + (line.width / 2.0 * away[0]).abs() + (0.33 * size * away[1]).abs();
        let at = [x + reach * away[0], y + reach * away[1]];
        let corner = [at[0] - line.width / 2.0, at[1] + 0.33 * size];
        let place = line.corners(corner, 0.0);
        // Numbers at the common corner of two edges are at least the width of a digit apart.
        let near = Line::new(&format!("0{}0", tick.label), size);
        let apart = near.corners([at[0] - near.width / 2.0, corner[1]], 0.0);
        if taken.iter().any(|t| super::scene::meet(t, &apart)) {
            continue;
        }
        taken.push(place);
        farthest = farthest.max(2.0 * reach - 1.5);
        scene.text_centred(line, at, Anchor::Middle, INK);
    }
    scene.stroke(path, Stroke::new(SOFT, 0.22));
    farthest
}
