//! A response surface of two factors as filled contours with labelled lines and a colour bar.

use super::axis::{Axis, Scale, extent, significant};
use super::column::Column;
use super::isoline::Field;
use super::palette::{INK, Map, Marker, PAPER, SOFT};
use super::panel::{Margins, Panel, RIM, marker, on_page, within};
use super::scene::{Anchor, Color, Path, Point, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Quantity, Style};
use math::elementary::atan2;

/// A response over two factors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contour {
    /// Factor along the page.
    pub x: Quantity,
    /// Factor up the page.
    pub y: Quantity,
    /// The response.
    pub z: Quantity,
    /// Grid values of `x`, equally spaced, ascending.
    pub xs: Vec<f64>,
    /// Grid values of `y`, equally spaced, ascending.
    pub ys: Vec<f64>,
    /// Response at (`xs[i]`, `ys[j]`) at index `j * xs.len() + i`.
    pub values: Vec<f64>,
    /// Design points to mark.
    pub points: Vec<[f64; 2]>,
    /// The factors that are held constant, in label markup; drawn above the plot. May be empty.
    pub note: String,
    /// Scales of the axes of the two factors; the grid nodes are equally spaced on them.
    pub scales: [Scale; 2],
}

const BAR: f64 = 3.0;

impl Figure for Contour {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let mut scene = Scene::new(style.width, 0.78 * style.width);
        scene.title = format!("The response {} over {} and {}", self.z.words(), self.x.words(), self.y.words());
        let (low, high) = extent(self.values.iter().copied());
        scene.description = format!("Contours from {} to {}.", significant(low, 3), self.z.in_words(high));
        let bands = Bands::of(low, high, &self.z);
        let note = if self.note.is_empty() { 0.0 } else { 1.5 * size };
        let page = scene.page().inset(0.8, 0.8 + note, 0.8, 0.8);
        let bar_width = bands.width(style);
        let x = Axis::between(self.x.title(), self.scales[0], first(&self.xs), last(&self.xs), 5);
        let y = Axis::between(self.y.title(), self.scales[1], first(&self.ys), last(&self.ys), 5);
        let mut margins = Margins::of(&x, &y, style);
        margins.right = margins.right.max(bar_width + 2.4);
        let panel = Panel::with_margins(page, margins, x, y).boxed();
        if note > 0.0 {
            let at = [panel.area.left, page.top - 0.35 * size];
            scene.text(Line::new(&self.note, 0.95 * size), at, Anchor::Start, 0.0, SOFT);
        }
        self.draw_field(&mut scene, &panel, &bands, style);
        panel.draw_axes(&mut scene, style);
        let bar = Rect::new(panel.area.right + 2.4, panel.area.top, BAR, panel.area.height());
        bands.draw_bar(&mut scene, bar, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let pairs = || self.ys.iter().flat_map(|y| self.xs.iter().map(move |x| (*x, *y)));
        let name = |q: &Quantity, other: &str| if q.id().is_empty() { other.to_string() } else { q.id().to_string() };
        vec![
            self.x.column(&name(&self.x, "x"), pairs().map(|p| p.0).collect()),
            self.y.column(&name(&self.y, "y"), pairs().map(|p| p.1).collect()),
            self.z.column(&name(&self.z, "z"), self.values.clone()),
        ]
    }
}

fn first(v: &[f64]) -> f64 {
    v.first().copied().unwrap_or(0.0)
}

fn last(v: &[f64]) -> f64 {
    v.last().copied().unwrap_or(1.0)
}

/// The values of a surface cut into bands of one colour, with the colour bar that explains them.
#[derive(Clone, Debug)]
pub struct Bands {
    /// Axis along the bar.
    pub axis: Axis,
    /// Values between the bands.
    pub levels: Vec<f64>,
    low: f64,
    high: f64,
}

impl Bands {
    /// About eleven bands between two values, cut at round numbers.
    pub fn of(low: f64, high: f64, quantity: &Quantity) -> Self {
        let fine = Axis::between("", Scale::Linear, low, high, 11);
        let axis = Axis::between(quantity.title(), Scale::Linear, low, high, 6).without_grid();
        let levels = fine.ticks.iter().map(|t| t.at).filter(|&v| v > low && v < high).collect();
        Self { levels, low: axis.low, high: axis.high, axis: Axis { minor: Vec::new(), ..axis } }
    }

    /// Colour of band number `k`: 0 lies below the first level.
    pub fn color(&self, k: usize, map: Map) -> Color {
        let end = |i: Option<&f64>, other: f64| i.copied().unwrap_or(other);
        let from = if k == 0 { self.low } else { self.levels[k - 1] };
        let to = end(self.levels.get(k), self.high);
        map.at(((from + to) / 2.0 - self.low) / (self.high - self.low))
    }

    /// Room for bar, numbers and title in mm.
    pub fn width(&self, style: &Style) -> f64 {
        let size = style.size();
        let widest = self.axis.ticks.iter().map(|t| Line::new(&t.label, size).width).fold(0.0, f64::max);
        BAR + 1.6 + widest + 1.4 + size
    }

    /// The bar of the bands, its numbers on the right.
    pub fn draw_bar(&self, scene: &mut Scene, bar: Rect, style: &Style) {
        scene.fill(Path::rect(bar), self.color(0, style.map));
        for (k, &level) in self.levels.iter().enumerate() {
            let bottom = bar.bottom - self.axis.fraction(level) * bar.height();
            scene.fill(Path::rect(Rect { bottom, ..bar }), self.color(k + 1, style.map));
        }
        self.draw_numbers(scene, bar, style);
    }

    /// The bar of all colours, for surfaces that are not cut into bands.
    pub fn draw_smooth_bar(&self, scene: &mut Scene, bar: Rect, style: &Style) {
        const STEPS: usize = 64;
        for k in 0..STEPS {
            let bottom = bar.bottom - k as f64 / STEPS as f64 * bar.height();
            scene.fill(Path::rect(Rect { bottom, ..bar }), style.map.at((k as f64 + 0.5) / STEPS as f64));
        }
        self.draw_numbers(scene, bar, style);
    }

    fn draw_numbers(&self, scene: &mut Scene, bar: Rect, style: &Style) {
        let size = style.size();
        let place = |v: f64| bar.bottom - self.axis.fraction(v) * bar.height();
        scene.stroke(Path::rect(bar), Stroke::new(SOFT, 0.2));
        let mut widest = 0.0_f64;
        let mut ticks = Path::default();
        for tick in &self.axis.ticks {
            let y = place(tick.at);
            ticks.add_polyline(&[[bar.right, y], [bar.right + 0.7, y]]);
            let line = Line::new(&tick.label, size);
            widest = widest.max(line.width);
            scene.text_centred(line, [bar.right + 1.5, y], Anchor::Start, INK);
        }
        scene.stroke(ticks, Stroke::new(SOFT, 0.2));
        let title = within(&self.axis.title(), size, (bar.height() + 4.0 * size).min(scene.height - RIM));
        let y = on_page(bar.centre()[1], title.width, scene.height);
        scene.text(title, [bar.right + 1.6 + widest + 1.2 + 0.8 * size, y], Anchor::Middle, 90.0, INK);
    }
}

impl Contour {
    fn draw_field(&self, scene: &mut Scene, panel: &Panel, bands: &Bands, style: &Style) {
        let field = Field { columns: self.xs.len(), values: &self.values };
        let (nx, ny) = ((self.xs.len().max(2) - 1) as f64, (self.ys.len().max(2) - 1) as f64);
        let area = panel.area;
        let place = |p: [f64; 2]| [area.left + p[0] / nx * area.width(), area.bottom - p[1] / ny * area.height()];
        let start = scene.items.len();
        scene.fill(Path::rect(area), bands.color(0, style.map));
        for (k, &level) in bands.levels.iter().enumerate() {
            let mut path = Path::default();
            for outline in field.region(level) {
                path.add_polygon(&outline.iter().map(|c| place(c.at)).collect::<Vec<_>>());
            }
            scene.fill(path, bands.color(k + 1, style.map));
        }
        let size = 0.85 * style.size();
        let mut taken: Vec<Rect> = self
            .points
            .iter()
            .map(|p| panel.place(p[0], p[1]))
            .map(|[x, y]| Rect::new(x - 1.4, y - 1.4, 2.8, 2.8))
            .collect();
        for (k, &level) in bands.levels.iter().enumerate() {
            let below = bands.color(k, style.map);
            let ink = if below.luminance() < 0.3 { PAPER } else { INK };
            let label = label_of(level, bands, size);
            let mut named = false;
            for line in field.lines(level) {
                let line: Vec<Point> = line.into_iter().map(place).collect();
                named |= draw_line(scene, &line, if named { None } else { Some(&label) }, area, &mut taken, ink);
            }
        }
        scene.group_from(start, Some(area), panel.facts());
        for p in &self.points {
            let disc = marker(Marker::Disc, panel.place(p[0], p[1]), 1.9);
            scene.shape(disc, PAPER, Stroke::new(INK, 0.3));
        }
    }
}

fn label_of(level: f64, bands: &Bands, size: f64) -> Line {
    let step = bands.levels.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    // As on the colour bar: the part that all numbers share stands in its title, and not on every line.
    let fine = Axis::between(bands.axis.label.as_str(), Scale::Linear, bands.low, bands.high, 11);
    let axis = if fine.common == bands.axis.common { &fine } else { &bands.axis };
    let known = axis.ticks.iter().find(|t| (t.at - level).abs() < 1e-6 * step);
    Line::new(known.map_or("", |t| &t.label), size)
}

/// Draws a contour line, interrupted by its label where there is room. Returns true if the label was drawn.
fn draw_line(
    scene: &mut Scene,
    line: &[Point],
    label: Option<&Line>,
    area: Rect,
    taken: &mut Vec<Rect>,
    ink: Color,
) -> bool {
    let stroke = Stroke::new(ink, 0.18).with_opacity(0.75);
    let along = lengths(line);
    let total = along.last().copied().unwrap_or(0.0);
    let found = label.and_then(|label| {
        let gap = label.width / 2.0 + 0.6;
        if total < 3.5 * gap {
            return None;
        }
        [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8].into_iter().find_map(|share| {
            let s = share * total;
            let (p, q) = (at_length(line, &along, s - gap), at_length(line, &along, s + gap));
            let mut angle = atan2(p[1] - q[1], q[0] - p[0]).to_degrees();
            if angle.abs() > 90.0 {
                angle -= 180.0 * angle.signum();
            }
            let (sin, cos) = math::elementary::sin_cos(angle.to_radians());
            let middle = [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0];
            let drop = label.size * super::text::CAP_HEIGHT / 2.0;
            let at =
                [middle[0] - label.width / 2.0 * cos + drop * sin, middle[1] + label.width / 2.0 * sin + drop * cos];
            let bounds = label.bounds(at, angle);
            let free = area.holds(&bounds.inset(-0.5, -0.5, -0.5, -0.5)) && !taken.iter().any(|t| t.meets(&bounds));
            free.then_some((label, at, angle, s - gap, s + gap, bounds))
        })
    });
    let Some((label, at, angle, from, to, bounds)) = found else {
        scene.stroke(Path::polyline(line), stroke);
        return false;
    };
    scene.stroke(Path::polyline(&part(line, &along, 0.0, from)), stroke.clone());
    scene.stroke(Path::polyline(&part(line, &along, to, total)), stroke);
    scene.text(label.clone(), at, Anchor::Start, angle, ink);
    taken.push(bounds.inset(-0.6, -0.6, -0.6, -0.6));
    true
}

/// Length from the start to each point.
fn lengths(line: &[Point]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = vec![0.0];
    for w in line.windows(2) {
        let (dx, dy) = (w[1][0] - w[0][0], w[1][1] - w[0][1]);
        sum += (dx * dx + dy * dy).sqrt();
        out.push(sum);
    }
    out
}

fn at_length(line: &[Point], along: &[f64], s: f64) -> Point {
    let k = along.partition_point(|&a| a < s).clamp(1, line.len() - 1);
    let t = ((s - along[k - 1]) / (along[k] - along[k - 1]).max(1e-12)).clamp(0.0, 1.0);
    [0, 1].map(|d| line[k - 1][d] + t * (line[k][d] - line[k - 1][d]))
}

fn part(line: &[Point], along: &[f64], from: f64, to: f64) -> Vec<Point> {
    let mut out = vec![at_length(line, along, from)];
    out.extend(line.iter().zip(along).filter(|(_, a)| from < **a && **a < to).map(|(p, _)| *p));
    out.push(at_length(line, along, to));
    out
}
