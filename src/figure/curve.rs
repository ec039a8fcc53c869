//! Stress–strain curves, with the growth of cracks by mode below on the same strain axis.
//!
//! Axial strain is positive to the right; lateral strain, if there is any, lies to the left of zero, as is usual for rock
//! and concrete. The peak is marked; a secant through the origin shows the modulus.

use super::axis::{Axis, Scale, extent, significant};
use super::column::Column;
use super::legend::{self, Entry, Swatch};
use super::palette::{self, INK, SOFT};
use super::panel::{Margins, Panel, draw_marker};
use super::scene::{Anchor, Path, Rect, Scene, Stroke};
use super::text::Line;
use super::{Figure, Style};

/// Column of the data: number of the curve, from 1.
pub const CURVE: &str = "curve";
/// Column of the data: axial strain.
pub const AXIAL_STRAIN: &str = "axial_strain";
/// Column of the data: axial stress.
pub const AXIAL_STRESS: &str = "axial_stress";
/// Column of the data: lateral strain.
pub const LATERAL_STRAIN: &str = "lateral_strain";

/// One test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// Axial strain, compression positive.
    pub axial: Vec<f64>,
    /// Lateral strain (negative when the specimen widens); empty to leave out.
    pub lateral: Vec<f64>,
    /// Axial stress in MPa.
    pub stress: Vec<f64>,
    /// Number of cracks so far by mode: (name, counts).
    pub cracks: Vec<(String, Vec<f64>)>,
    /// Secant modulus in GPa to draw as a line; `None` to leave out.
    pub modulus: Option<f64>,
}

/// Figure of one or more tests.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StressStrain {
    /// Tests.
    pub curves: Vec<Curve>,
}

const PERCENT: f64 = 100.0;

impl Figure for StressStrain {
    fn scene(&self, style: &Style) -> Scene {
        let with_cracks = self.curves.iter().any(|c| !c.cracks.is_empty());
        let height = style.width * if with_cracks { 0.95 } else { 0.66 };
        let mut scene = Scene::new(style.width, height);
        scene.title = "Stress against strain".into();
        scene.description = self.describe();
        let entries = self.names();
        let page = scene.page().inset(0.8, 1.0, 0.8, 0.8);
        let top = legend::height(&entries, page.width() - 10.0, style);
        let strain = self.strain_axis(if with_cracks { "" } else { self.strain_label() });
        // Room above the peak of a single curve for its value.
        let room = if self.curves.len() == 1 { 1.13 } else { 1.0 };
        let stress = Axis::from_zero("Axial stress $\\sigma$ / MPa", self.stress().map(|s| room * s), 5);
        let below = self.crack_axis();
        let lower_x = self.strain_axis(self.strain_label());
        let margins = Margins::of(&lower_x, &stress, style).max(Margins::of(&lower_x, &below, style));
        let rest = Rect { top: page.top + top, ..page };
        let upper_bottom = if with_cracks { rest.top + 0.6 * rest.height() } else { rest.bottom };
        let mut upper_margins = margins;
        let mut upper_x = strain;
        if with_cracks {
            upper_margins.bottom = 2.2;
            upper_x.ticks.iter_mut().for_each(|t| t.label.clear());
        }
        let upper = Panel::with_margins(Rect { bottom: upper_bottom, ..rest }, upper_margins, upper_x, stress);
        self.draw_stress(&mut scene, &upper, style);
        if with_cracks {
            let outer = Rect { top: upper_bottom, ..rest };
            self.draw_cracks(&mut scene, &Panel::with_margins(outer, margins, lower_x, below), style);
        }
        let left = upper.area.left;
        legend::draw(&mut scene, &entries, Rect { left, ..page }, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let all = |pick: &dyn Fn(&Curve) -> Vec<f64>| self.curves.iter().flat_map(pick).collect::<Vec<f64>>();
        let padded =
            |values: &[f64], rows: usize| (0..rows).map(|i| values.get(i).copied().unwrap_or(f64::NAN)).collect();
        let number = |(i, c): (usize, &Curve)| vec![i as i64 + 1; c.axial.len()];
        let mut columns = vec![
            Column::whole(CURVE, self.curves.iter().enumerate().flat_map(number).collect()),
            Column::reals(AXIAL_STRAIN, all(&|c| c.axial.clone())),
            Column::reals(AXIAL_STRESS, all(&|c| padded(&c.stress, c.axial.len()))).with_unit("MPa"),
        ];
        if self.has_lateral() {
            columns.push(Column::reals(LATERAL_STRAIN, all(&|c| padded(&c.lateral, c.axial.len()))));
        }
        let mut modes: Vec<&String> = Vec::new();
        for (mode, _) in self.curves.iter().flat_map(|c| &c.cracks) {
            if !modes.contains(&mode) {
                modes.push(mode);
            }
        }
        // A column of counts has the name of its mode.
        for mode in modes {
            let counts = |c: &Curve| {
                let own = c.cracks.iter().find(|(own, _)| own == mode).map_or(&[][..], |(_, counts)| counts);
                padded(own, c.axial.len())
            };
            columns.push(Column::reals(mode, all(&counts)));
        }
        columns
    }
}

impl StressStrain {
    fn stress(&self) -> impl Iterator<Item = f64> + '_ {
        self.curves.iter().flat_map(|c| c.stress.iter().copied())
    }

    fn has_lateral(&self) -> bool {
        self.curves.iter().any(|c| !c.lateral.is_empty())
    }

    fn strain_label(&self) -> &'static str {
        if self.has_lateral() {
            "Lateral strain $\\varepsilon_l$   |   axial strain $\\varepsilon_a$ / %"
        } else {
            "Axial strain $\\varepsilon_a$ / %"
        }
    }

    fn strain_axis(&self, label: &str) -> Axis {
        let strains = self.curves.iter().flat_map(|c| c.axial.iter().chain(&c.lateral).map(|e| e * PERCENT));
        let (low, high) = extent(strains.chain([0.0]));
        let low = if low < 0.0 && self.has_lateral() { low - 0.04 * (high - low) } else { 0.0 };
        Axis::between(label, Scale::Linear, low, high + 0.04 * (high - low), 6)
    }

    fn crack_axis(&self) -> Axis {
        let counts = self.curves.iter().flat_map(|c| c.cracks.iter().flat_map(|(_, n)| n.iter().copied()));
        Axis::from_zero("Number of cracks", counts, 3)
    }

    fn modes(&self) -> Vec<&str> {
        let mut modes: Vec<&str> = Vec::new();
        for (mode, _) in self.curves.iter().flat_map(|c| &c.cracks) {
            if !modes.contains(&mode.as_str()) {
                modes.push(mode);
            }
        }
        modes
    }

    fn describe(&self) -> String {
        let tell = |c: &Curve| {
            let (i, peak) = peak(c)?;
            Some(format!(
                "{}: peak {} MPa at {} % axial strain.",
                c.name,
                significant(peak, 4),
                significant(c.axial[i] * PERCENT, 3)
            ))
        };
        self.curves.iter().filter_map(tell).collect::<Vec<_>>().join(" ")
    }

    /// Only several tests have their names in the legend; with one test the caption names it.
    fn names(&self) -> Vec<Entry> {
        let several = self.curves.len() > 1;
        let named = self.curves.iter().enumerate().filter(|_| several);
        named.map(|(i, c)| Entry::new(c.name.clone(), Swatch::Line(line_style(i), Some(palette::marker(i))))).collect()
    }

    /// With one curve the modes have colours of their own; with several the colour names the curve, the dash the mode.
    fn crack_style(&self, curve: usize, mode: usize) -> Stroke {
        let color = if self.curves.len() == 1 { palette::mode(mode) } else { palette::category(curve) };
        Stroke::new(color, 0.42).dashed(palette::dash(mode))
    }

    fn draw_stress(&self, scene: &mut Scene, panel: &Panel, style: &Style) {
        panel.draw_grid(scene);
        let first = scene.items.len();
        if self.has_lateral() {
            let x = panel.place_x(0.0);
            scene.stroke(Path::polyline(&[[x, panel.area.top], [x, panel.area.bottom]]), Stroke::new(SOFT, 0.2));
        }
        for (i, curve) in self.curves.iter().enumerate() {
            draw_secant(scene, panel, curve);
            for strain in [&curve.lateral, &curve.axial] {
                let percent: Vec<f64> = strain.iter().map(|e| e * PERCENT).collect();
                for part in panel.places(&percent, &curve.stress) {
                    scene.stroke(Path::polyline(&part), line_style(i));
                }
            }
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(scene, style);
        for (i, curve) in self.curves.iter().enumerate() {
            if let Some((at, stress)) = peak(curve) {
                let [x, y] = panel.place(curve.axial[at] * PERCENT, stress);
                draw_marker(scene, palette::marker(i), [x, y], 1.8, palette::category(i));
                if self.curves.len() == 1 {
                    let label = format!("$\\sigma_u$ = {} MPa", significant(stress, 3));
                    let line = Line::new(&label, style.size());
                    let middle = x.min(panel.area.right - 0.5 - line.width / 2.0);
                    let above = (y - 1.2 - 0.6 * style.size()).max(panel.area.top + 0.6 * style.size());
                    scene.text_centred(line, [middle, above], Anchor::Middle, INK);
                }
            }
        }
    }

    fn draw_cracks(&self, scene: &mut Scene, panel: &Panel, style: &Style) {
        panel.draw_grid(scene);
        let first = scene.items.len();
        let modes = self.modes();
        for (i, curve) in self.curves.iter().enumerate() {
            let percent: Vec<f64> = curve.axial.iter().map(|e| e * PERCENT).collect();
            for (mode, counts) in &curve.cracks {
                let k = modes.iter().position(|m| m == mode).unwrap_or(0);
                for part in panel.places(&percent, counts) {
                    scene.stroke(Path::polyline(&part), self.crack_style(i, k));
                    // Halfway up the curves are apart; a marker tells them in grey too.
                    let half = part.last().map_or(0.0, |end| (end[1] + panel.area.bottom) / 2.0);
                    let middle = part.iter().find(|p| p[1] <= half).filter(|_| self.curves.len() > 1);
                    if let Some(&at) = middle {
                        draw_marker(scene, palette::marker(i), at, 1.6, palette::category(i));
                    }
                }
            }
        }
        scene.group_from(first, Some(panel.area), panel.facts());
        panel.draw_axes(scene, style);
        // Counts only grow, so the upper left corner is free.
        let one = self.curves.len() == 1;
        let entry = |(k, mode): (usize, &&str)| {
            let stroke = self.crack_style(0, k);
            let stroke = if one { stroke } else { Stroke { color: SOFT, ..stroke } };
            Entry::new(*mode, Swatch::Line(stroke, None))
        };
        let entries: Vec<Entry> = modes.iter().enumerate().map(entry).collect();
        legend::draw_stacked(scene, &entries, [panel.area.left + 2.0, panel.area.top + 0.6], style);
    }
}

/// Index and value of the largest stress.
fn peak(curve: &Curve) -> Option<(usize, f64)> {
    let pairs = curve.stress.iter().copied().take(curve.axial.len()).enumerate();
    pairs.filter(|p| p.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))
}

fn line_style(i: usize) -> Stroke {
    Stroke::new(palette::category(i), 0.42).dashed(palette::dash(i))
}

fn draw_secant(scene: &mut Scene, panel: &Panel, curve: &Curve) {
    if let (Some(modulus), Some((_, peak))) = (curve.modulus, peak(curve)) {
        let strain = 0.98 * peak / (modulus * 1e3) * PERCENT;
        let line = [panel.place(0.0, 0.0), panel.place(strain, 0.98 * peak)];
        scene.stroke(Path::polyline(&line), Stroke::new(SOFT, 0.2).dashed(&[0.9, 0.8]));
    }
}
