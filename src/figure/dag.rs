//! The graph of a campaign: stages as boxes from left to right, arrows along which results flow.

use super::column::Column;
use super::font::Face;
use super::layers::{self, Layers};
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, PAPER, SOFT};
use super::scene::{Anchor, Color, Path, Point, Rect, Scene, Step, Stroke};
use super::text::{CAP_HEIGHT, Line};
use super::{Figure, Style};

/// A stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// A second line: its kind, or how many runs it has. May be empty.
    pub note: String,
    /// Its class, an index into [`Dag::classes`].
    pub class: usize,
}

/// Stages and the results that they take from one another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dag {
    /// Stages in the order of the workflow.
    pub stages: Vec<Stage>,
    /// (source, target) as indices of stages.
    pub edges: Vec<(usize, usize)>,
    /// Names of the classes, for the legend.
    pub classes: Vec<String>,
}

const PAD: f64 = 1.6;
const HEAD: f64 = 1.3;

impl Figure for Dag {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let box_height = if self.stages.iter().any(|s| !s.note.is_empty()) { 2.75 * size } else { 1.8 * size };
        let layout = layers::place(self.stages.len(), &self.edges, box_height + 2.2);
        let widths: Vec<f64> = layout.order.iter().map(|l| self.width_of(l, style)).collect();
        let gaps = widths.len().max(2) as f64 - 1.0;
        let free = style.width - 1.6 - widths.iter().sum::<f64>();
        let gap = (free / gaps).clamp(5.0, 14.0);
        let width = (widths.iter().sum::<f64>() + gap * gaps + 1.6).max(style.width);
        let entries: Vec<Entry> =
            self.classes.iter().enumerate().map(|(i, c)| Entry::new(c.clone(), Swatch::Box(tint(i)))).collect();
        let top = legend::height(&entries, width - 1.6, style) + 1.2;
        // Blank nodes need half a box only.
        let reach = |(p, h): (usize, &f64)| h + if p < layout.nodes { box_height } else { 0.6 * box_height };
        let tallest = layout.height.iter().enumerate().map(reach).fold(0.0, f64::max);
        let mut scene = Scene::new(width, top + tallest + 1.6);
        scene.title = "Stages of the campaign".into();
        scene.description = self.describe();
        legend::draw(&mut scene, &entries, Rect::new(0.8, 0.8, width - 1.6, 0.0), style);
        let mut boxes: Vec<Rect> = vec![Rect::new(0.0, 0.0, 0.0, 0.0); layout.height.len()];
        let mut left = 0.8 + ((width - 1.6) - widths.iter().sum::<f64>() - gap * gaps).max(0.0) / 2.0;
        for (layer, w) in layout.order.iter().zip(&widths) {
            for &p in layer {
                boxes[p] = Rect::new(left, top + layout.height[p], *w, box_height);
            }
            left += w + gap;
        }
        for route in &layout.routes {
            draw_arrow(&mut scene, route, &boxes, &layout);
        }
        for (stage, &place) in self.stages.iter().zip(&boxes) {
            draw_stage(&mut scene, stage, place, style);
        }
        scene
    }

    fn data(&self) -> Vec<Column> {
        let name = |i: usize| self.stages.get(i).map(|s| s.name.clone()).unwrap_or_default();
        vec![
            Column::words("from", self.edges.iter().map(|e| name(e.0)).collect()),
            Column::words("to", self.edges.iter().map(|e| name(e.1)).collect()),
        ]
    }
}

impl Dag {
    fn width_of(&self, layer: &[usize], style: &Style) -> f64 {
        let size = style.size();
        let text = |s: &Stage| {
            let name = Line::with_face(&s.name, size, Face::Semibold).width;
            name.max(Line::new(&s.note, 0.85 * size).width)
        };
        let widest = layer.iter().filter_map(|&p| self.stages.get(p)).map(text).fold(0.0, f64::max);
        widest + 2.0 * PAD
    }

    fn describe(&self) -> String {
        let reads = |i: usize| {
            let from: Vec<&str> =
                self.edges.iter().filter(|e| e.1 == i).map(|e| self.stages[e.0].name.as_str()).collect();
            if from.is_empty() { String::new() } else { format!(" reads {}", from.join(", ")) }
        };
        let lines = self.stages.iter().enumerate().map(|(i, s)| format!("{}{}.", s.name, reads(i)));
        lines.collect::<Vec<_>>().join(" ")
    }
}

fn hue(i: usize) -> Color {
    [palette::BLUE, palette::ORANGE, palette::GREEN, palette::PURPLE, palette::SKY, SOFT][i % 6]
}

/// A light tint of a category, on which ink reads well.
fn tint(i: usize) -> Color {
    hue(i).mix(PAPER, 0.72)
}

fn draw_stage(scene: &mut Scene, stage: &Stage, place: Rect, style: &Style) {
    let size = style.size();
    let rim = hue(stage.class).mix(INK, 0.25);
    scene.shape(rounded(place, 1.1), tint(stage.class), Stroke::new(rim, 0.22));
    let [x, y] = place.centre();
    let name = Line::with_face(&stage.name, size, Face::Semibold);
    if stage.note.is_empty() {
        return scene.text_centred(name, [x, y], Anchor::Middle, INK);
    }
    scene.text(name, [x, y - 0.12 * size], Anchor::Middle, 0.0, INK);
    let note = Line::new(&stage.note, 0.85 * size);
    scene.text(note, [x, y + 0.3 * size + CAP_HEIGHT * 0.85 * size], Anchor::Middle, 0.0, SOFT);
}

/// A rectangle with round corners.
fn rounded(r: Rect, radius: f64) -> Path {
    let k = radius * (1.0 - 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0));
    let Rect { left, top, right, bottom } = r;
    Path(vec![
        Step::Move([left + radius, top]),
        Step::Line([right - radius, top]),
        Step::Cubic([right - k, top], [right, top + k], [right, top + radius]),
        Step::Line([right, bottom - radius]),
        Step::Cubic([right, bottom - k], [right - k, bottom], [right - radius, bottom]),
        Step::Line([left + radius, bottom]),
        Step::Cubic([left + k, bottom], [left, bottom - k], [left, bottom - radius]),
        Step::Line([left, top + radius]),
        Step::Cubic([left, top + k], [left + k, top], [left + radius, top]),
        Step::Close,
    ])
}

/// A smooth line through the blank nodes of a route, with a head at its end.
fn draw_arrow(scene: &mut Scene, route: &[usize], boxes: &[Rect], layout: &Layers) {
    let mut steps = Vec::new();
    let mut tip: Point = [0.0; 2];
    for w in route.windows(2) {
        let (a, b) = (boxes[w[0]], boxes[w[1]]);
        let from = [a.right, a.centre()[1]];
        let is_end = w[1] < layout.nodes;
        let to = [b.left - if is_end { HEAD } else { 0.0 }, b.centre()[1]];
        if steps.is_empty() {
            steps.push(Step::Move(from));
        } else {
            // Straight across the layer that it passes.
            steps.push(Step::Line(from));
        }
        let bend = 0.5 * (to[0] - from[0]);
        steps.push(Step::Cubic([from[0] + bend, from[1]], [to[0] - bend, to[1]], to));
        tip = [b.left, b.centre()[1]];
    }
    let line = SOFT.mix(PAPER, 0.15);
    scene.stroke(Path(steps), Stroke::new(line, 0.25));
    let [x, y] = tip;
    scene.fill(Path::polygon(&[[x - 0.1, y], [x - HEAD - 0.2, y - 0.62], [x - HEAD - 0.2, y + 0.62]]), line);
}
