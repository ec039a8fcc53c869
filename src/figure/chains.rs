//! Force chains: every contact as a line whose width is its normal force; compression and tension in two colours.

use super::axis::significant;
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{BLUE, VERMILION};
use super::scene::{Path, Point, Rect, Scene, Stroke};
use super::specimen::{Frame, Outline};
use super::{Figure, Style};

/// The force in one contact or bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Centre of one particle in mm.
    pub from: Point,
    /// Centre of the other in mm.
    pub to: Point,
    /// Normal force, compression positive.
    pub force: f64,
}

/// Forces in a specimen at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chains {
    /// Shape of the specimen.
    pub outline: Outline,
    /// Lower left corner of the domain in mm.
    pub low: Point,
    /// Upper right corner in mm.
    pub high: Point,
    /// Contacts and bonds.
    pub links: Vec<Link>,
    /// When these forces act, such as "at the peak"; may be empty.
    pub when: String,
    /// Unit of the forces.
    pub unit: String,
    /// Forces below this share of the mean are left out; 0 draws all.
    pub least: f64,
}

/// Number of widths of lines.
const WIDTHS: usize = 14;
/// Greatest width of a line on the page in mm.
const WIDEST: f64 = 0.7;
/// Greatest width of a line as a share of the mean length on the page, so that chains side by side stay apart.
const SLENDER: f64 = 0.7;

impl Figure for Chains {
    fn scene(&self, style: &Style) -> Scene {
        let aspect = (self.high[1] - self.low[1]) / (self.high[0] - self.low[0]);
        let width = if aspect > 1.2 { 0.62 * style.width } else { style.width - 1.6 };
        let below = if aspect > 1.2 { 0.0 } else { 7.5 * style.size() };
        let mut scene = Scene::new(style.width, width * aspect + below + 1.6);
        scene.title = format!("Force chains {}", self.when).trim_end().to_owned();
        let (mean, most) = self.scale();
        let unit = &self.unit;
        scene.description =
            format!("{} contacts, mean normal force {} {unit}.", self.links.len(), significant(mean, 3));
        let frame = Frame::fit(self.low, self.high, Rect::new(0.8, 0.8, width, width * aspect));
        let frame = frame.shaped(self.outline);
        let widest = self.widest(&frame);
        let first = scene.items.len();
        for (color, sign) in [(BLUE, 1.0), (VERMILION, -1.0)] {
            for class in 1..=WIDTHS {
                let mut path = Path::default();
                for l in self.links.iter().filter(|l| l.force * sign > 0.0 && l.force.abs() >= self.least * mean) {
                    if class_of(l.force.abs() / most) == class {
                        path.add_polyline(&[frame.place(l.from), frame.place(l.to)]);
                    }
                }
                if !path.0.is_empty() {
                    scene.stroke(path, Stroke::new(color, class_width(class, widest)));
                }
            }
        }
        scene.group_from(first, Some(frame.area), Vec::new());
        frame.draw_border(&mut scene);
        let tall = aspect > 1.2;
        let corner = if tall { [frame.area.right + 4.0, 1.2] } else { [1.6, frame.area.bottom + 1.5] };
        legend::draw_stacked(&mut scene, &self.entries([mean, most], widest), corner, style);
        let at = if tall { [corner[0], frame.area.bottom - 1.0] } else { [style.width * 0.55, corner[1] + 1.2] };
        frame.draw_scale(&mut scene, at, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let reals = |f: fn(&Link) -> f64| self.links.iter().map(f).collect::<Vec<_>>();
        vec![
            Column::reals("x1", reals(|l| l.from[0])).with_unit("mm"),
            Column::reals("y1", reals(|l| l.from[1])).with_unit("mm"),
            Column::reals("x2", reals(|l| l.to[0])).with_unit("mm"),
            Column::reals("y2", reals(|l| l.to[1])).with_unit("mm"),
            Column::reals("normal_force", reals(|l| l.force)).with_unit(&self.unit),
        ]
    }
}

impl Chains {
    /// Mean absolute force, and the force that has the widest line: the one that a thousandth exceeds.
    fn scale(&self) -> (f64, f64) {
        let mut sizes: Vec<f64> = self.links.iter().map(|l| l.force.abs()).filter(|f| f.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        let mean = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
        let most = sizes.get(sizes.len().saturating_sub(1 + sizes.len() / 1000)).copied().unwrap_or(1.0);
        (mean, most.max(f64::MIN_POSITIVE))
    }

    /// Width of the widest line in mm.
    fn widest(&self, frame: &Frame) -> f64 {
        let length = |l: &Link| {
            let (a, b) = (frame.place(l.from), frame.place(l.to));
            ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])).sqrt()
        };
        let mean = self.links.iter().map(length).sum::<f64>() / self.links.len().max(1) as f64;
        if mean > 0.0 { WIDEST.min(SLENDER * mean) } else { WIDEST }
    }

    fn entries(&self, [mean, most]: [f64; 2], widest: f64) -> Vec<Entry> {
        let unit = &self.unit;
        let mut entries = Vec::new();
        for (color, sign, name) in [(BLUE, 1.0, "compression"), (VERMILION, -1.0, "tension")] {
            if self.links.iter().any(|l| l.force * sign > 0.0) {
                entries.push(Entry::new(name, Swatch::Line(Stroke::new(color, 0.6), None)));
            }
        }
        for (word, force) in [("", most), ("", 0.5 * most), ("mean ", mean)] {
            let stroke = Stroke::new(super::palette::INK, class_width(class_of(force / most), widest));
            entries.push(Entry::new(format!("{word}{} {unit}", significant(force, 2)), Swatch::Line(stroke, None)));
        }
        entries
    }
}

fn class_of(share: f64) -> usize {
    ((share.min(1.0) * WIDTHS as f64).ceil() as usize).clamp(1, WIDTHS)
}

fn class_width(class: usize, widest: f64) -> f64 {
    widest * class as f64 / WIDTHS as f64
}
