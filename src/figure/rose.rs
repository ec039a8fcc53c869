//! Orientation of cracks as a rose: petals whose area is the number of cracks, stacked by mode.
//!
//! A crack line has no direction, so the rose is symmetric; angles run anticlockwise from the horizontal.

use super::axis::fixed;
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, GRID, INK, PAPER, SOFT};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Style};
use math::elementary::sin_cos;
use std::f64::consts::PI;

/// Angles of crack lines by mode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rose {
    /// Mode and the angles of its cracks in radians; any angle is taken modulo π.
    pub modes: Vec<(String, Vec<f64>)>,
    /// Number of petals in half a turn; 18 makes them 10° wide.
    pub petals: usize,
}

impl Figure for Rose {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let mut scene = Scene::new(style.width, style.width);
        scene.title = "Orientation of cracks".into();
        scene.description = self.describe();
        let swatch = |i: usize| Swatch::Box(palette::mode(i));
        let entries: Vec<Entry> =
            self.modes.iter().enumerate().map(|(i, m)| Entry::new(m.0.clone(), swatch(i))).collect();
        let top = legend::height(&entries, style.width - 4.0, style);
        legend::draw(&mut scene, &entries, Rect::new(2.0, 0.8, style.width - 4.0, 0.0), style);
        let radius = (style.width - top) / 2.0 - 2.6 * size;
        let centre = [style.width / 2.0, top + (style.width - top) / 2.0];
        let counts = self.counts();
        let most = (0..self.petals).map(|k| counts.iter().map(|c| c[k]).sum::<f64>()).fold(1.0, f64::max);
        let rings = rings(most);
        let full = rings.last().copied().unwrap_or(most).max(most);
        let reach = |count: f64| radius * (count / full).sqrt();
        for &ring in &rings {
            scene.stroke(Path::circle(centre, reach(ring)), Stroke::new(GRID, 0.2));
        }
        draw_spokes(&mut scene, centre, radius, style);
        let width = PI / self.petals.max(1) as f64;
        for k in 0..self.petals {
            let mut inner = 0.0;
            for (i, mode) in counts.iter().enumerate().filter(|(_, m)| m[k] > 0.0) {
                for half in [0.0, PI] {
                    let from = half + k as f64 * width;
                    let petal = Path::sector(centre, reach(inner), reach(inner + mode[k]), from, from + width);
                    scene.shape(petal, palette::mode(i), Stroke::new(PAPER, 0.15));
                }
                inner += mode[k];
            }
        }
        for &ring in &rings {
            let (s, c) = sin_cos(PI / 4.0);
            let at = [centre[0] + reach(ring) * c, centre[1] - reach(ring) * s];
            let line = Line::new(&fixed(ring, 0), 0.85 * size);
            let ground = Rect::new(at[0] - line.width / 2.0 - 0.4, at[1] - 0.45 * size, line.width + 0.8, 0.9 * size);
            scene.fill(Path::rect(ground), super::scene::Fill { color: PAPER, opacity: 0.8 });
            scene.text_centred(line, at, Anchor::Middle, INK);
        }
        let unit = Line::new(&format!("rings: cracks in {}°", fixed(180.0 / self.petals.max(1) as f64, 0)), 0.9 * size);
        scene.text(unit, [2.0, style.width - 0.4 * size - 0.8], Anchor::Start, 0.0, SOFT);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let width = 180.0 / self.petals.max(1) as f64;
        let from: Vec<f64> = (0..self.petals).map(|k| k as f64 * width).collect();
        let mut columns = vec![
            Column::reals("from", from.clone()).with_unit("deg"),
            Column::reals("to", from.iter().map(|a| a + width).collect()).with_unit("deg"),
        ];
        for ((name, _), counts) in self.modes.iter().zip(self.counts()) {
            columns.push(Column::whole(name, counts.iter().map(|&c| c as i64).collect()));
        }
        columns
    }
}

impl Rose {
    /// Number of cracks per mode and petal.
    fn counts(&self) -> Vec<Vec<f64>> {
        let count = |angles: &Vec<f64>| {
            let mut bins = vec![0.0; self.petals];
            for a in angles.iter().filter(|a| a.is_finite()) {
                let share = (a / PI).rem_euclid(1.0);
                let k = ((share * self.petals as f64) as usize).min(self.petals.max(1) - 1);
                if let Some(bin) = bins.get_mut(k) {
                    *bin += 1.0;
                }
            }
            bins
        };
        self.modes.iter().map(|(_, angles)| count(angles)).collect()
    }

    fn describe(&self) -> String {
        let tell = |(name, angles): &(String, Vec<f64>)| {
            let (s, c) = angles.iter().map(|a| sin_cos(2.0 * a)).fold((0.0, 0.0), |t, v| (t.0 + v.0, t.1 + v.1));
            let mean = math::elementary::atan2(s, c).to_degrees() / 2.0;
            format!("{name}: {} cracks, mean direction {}°.", angles.len(), fixed(mean.rem_euclid(180.0), 0))
        };
        self.modes.iter().map(tell).collect::<Vec<_>>().join(" ")
    }
}

/// Three or four round counts up to the largest.
fn rings(most: f64) -> Vec<f64> {
    let axis = super::axis::Axis::between("", super::axis::Scale::Linear, 0.0, most, 3);
    axis.ticks.iter().map(|t| t.at).filter(|&v| v >= 1.0).collect()
}

fn draw_spokes(scene: &mut Scene, centre: [f64; 2], radius: f64, style: &Style) {
    let mut path = Path::default();
    for k in 0..12 {
        let degrees = 30.0 * f64::from(k);
        let (s, c) = sin_cos(degrees.to_radians());
        path.add_polyline(&[centre, [centre[0] + radius * c, centre[1] - radius * s]]);
        let line = Line::new(&format!("{degrees}°"), 0.9 * style.size());
        let reach = radius + 1.2 + line.width / 2.0 * c.abs() + 0.33 * style.size() * s.abs();
        scene.text_centred(line, [centre[0] + reach * c, centre[1] - reach * s], Anchor::Middle, SOFT);
    }
    scene.stroke(path, Stroke::new(GRID, 0.15));
}
