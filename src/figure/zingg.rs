//! Zingg's diagram: elongation over flatness of stones, divided at two thirds into disc, equant, blade and rod.
//!
//! Thin curves are those of equal sphericity of ellipsoids after Krumbein (1941), ψ = ((S/I) (I/L)²)^⅓.

use super::axis::{Axis, Scale};
use super::column::Column;
use super::palette::{BLUE, GRID, INK, PAPER, SOFT};
use super::panel::Panel;
use super::scene::{Anchor, Path, Scene, Stroke};
use super::text::{Line, plain_text};
use super::{Figure, Style};
use math::elementary::cbrt;

/// Stones by their proportions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zingg {
    /// Names.
    pub names: Vec<String>,
    /// Short over intermediate extent S/I.
    pub flatness: Vec<f64>,
    /// Intermediate over long extent I/L.
    pub elongation: Vec<f64>,
    /// Share of each stone, shown by the area of its disc.
    pub share: Vec<f64>,
}

const PART: f64 = 2.0 / 3.0;

impl Figure for Zingg {
    fn scene(&self, style: &Style) -> Scene {
        let size = style.size();
        let mut scene = Scene::new(style.width, style.width);
        scene.title = "Zingg's diagram".into();
        let labels = self.names.iter().zip(self.flatness.iter().zip(&self.elongation));
        let labels: Vec<String> = labels.map(|(name, (s, l))| format!("{name} {s:.2}, {l:.2}")).collect();
        scene.description = format!("Stones by S/I and I/L: {}.", labels.join("; "));
        let axis = |label: &str| Axis::between(label, Scale::Linear, 0.0, 1.05, 5);
        let (x, y) = (axis("Flatness S/I"), axis("Elongation I/L"));
        let panel = Panel::fit(scene.page().inset(0.8, 0.8, 1.6, 0.8), x, y, style).boxed();
        for sphericity in [0.3, 0.5, 0.7, 0.9] {
            let points = (0..=100).map(|k| 0.01 * f64::from(k) + 1e-6);
            let curve = points.map(|s| [s, (sphericity * sphericity * sphericity / s).sqrt()]);
            let curve: Vec<_> = curve.filter(|p| p[0] <= 1.0 && p[1] <= 1.0).map(|p| panel.place(p[0], p[1])).collect();
            scene.stroke(Path::polyline(&curve), Stroke::new(GRID, 0.25));
            let end = sphericity * sphericity * sphericity;
            let at = panel.place(1.0, end.sqrt());
            scene.text_centred(
                Line::new(&format!("ψ {sphericity}"), 0.8 * size),
                [at[0] - 0.4, at[1] + 0.5 * size],
                Anchor::End,
                SOFT,
            );
        }
        let lines =
            [[panel.place(PART, 0.0), panel.place(PART, 1.0)], [panel.place(0.0, PART), panel.place(1.0, PART)]];
        lines.iter().for_each(|line| scene.stroke(Path::polyline(line), Stroke::new(SOFT, 0.25).dashed(&[1.4, 1.0])));
        for (name, at) in
            [("disc", [0.02, 0.97]), ("equant", [0.70, 0.97]), ("blade", [0.02, 0.03]), ("rod", [0.70, 0.03])]
        {
            scene.text_centred(Line::new(name, size), panel.place(at[0], at[1]), Anchor::Start, SOFT);
        }
        let most = self.share.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        for k in 0..self.names.len() {
            let [cx, cy] = panel.place(self.flatness[k], self.elongation[k]);
            let r = 0.7 + 0.9 * (self.share[k] / most).sqrt();
            scene.items.push(super::scene::Item::Discs { discs: vec![([cx, cy], r + 0.25)], color: PAPER });
            scene.items.push(super::scene::Item::Discs { discs: vec![([cx, cy], r)], color: BLUE });
            let line = Line::new(&plain_text(&self.names[k]), size);
            let right = cx + r + 0.8 + line.width < panel.area.right;
            let (x, anchor) = if right { (cx + r + 0.8, Anchor::Start) } else { (cx - r - 0.8, Anchor::End) };
            scene.text_centred(line, [x, cy], anchor, INK);
        }
        panel.draw_axes(&mut scene, style);
        scene
    }

    fn data(&self) -> Vec<Column> {
        let sphericity = self.flatness.iter().zip(&self.elongation).map(|(s, l)| cbrt(s * l * l)).collect();
        vec![
            Column::words("shape", self.names.clone()),
            Column::reals("flatness", self.flatness.clone()),
            Column::reals("elongation", self.elongation.clone()),
            Column::reals("krumbein_sphericity", sphericity),
            Column::reals("share", self.share.clone()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_has_the_sphericity_one_and_the_picture_every_name() {
        let zingg = Zingg {
            names: vec!["ball".into(), "slab".into()],
            flatness: vec![1.0, 0.4],
            elongation: vec![1.0, 0.9],
            share: vec![0.5, 0.5],
        };
        let data = zingg.data();
        assert!(matches!(&data[3].values, super::super::column::Values::Reals(v) if v[0] == 1.0));
        let texts: Vec<String> = zingg.scene(&Style::wide(90.0)).texts().into_iter().map(|t| t.0).collect();
        assert!(
            ["ball", "slab", "equant", "blade"].iter().all(|name| texts.iter().any(|text| text == name)),
            "{texts:?}"
        );
    }
}
