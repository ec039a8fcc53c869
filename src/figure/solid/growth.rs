//! Cracks in space one after another: the picture shows all of them, the moving one how they open.

use super::{Penny, Solid};
use crate::axis::significant;
use crate::column::Column;
use crate::palette::INK;
use crate::scene::{Anchor, Scene};
use crate::text::Line;
use crate::{Figure, Style};

/// A specimen in space with the strain at which each crack opened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Growth {
    /// The specimen with all cracks.
    pub solid: Solid,
    /// Axial strain at which each crack opened.
    pub strains: Vec<f64>,
    /// Axial strain at the end of the test.
    pub end: f64,
}

/// Scenes of the moving picture.
const FRAMES: usize = 40;

impl Figure for Growth {
    fn scene(&self, style: &Style) -> Scene {
        self.solid.scene(style)
    }

    fn data(&self) -> Vec<Column> {
        let mut columns = vec![Column::reals("axial_strain", self.strains.clone())];
        columns.extend(self.solid.data());
        columns
    }

    fn frames(&self, style: &Style) -> Vec<Scene> {
        if !(self.end > 0.0) {
            return Vec::new();
        }
        let frame = |number: usize| {
            let strain = self.end * number as f64 / (FRAMES - 1) as f64;
            let open = |(crack, at): (&Penny, &f64)| (*at <= strain).then_some(*crack);
            let cracks = self.solid.cracks.iter().zip(&self.strains).filter_map(open).collect();
            let mut scene = Solid { cracks, only_cracks: true, ..self.solid.clone() }.scene(style);
            let words = format!("strain {} %", significant(100.0 * strain, 3));
            let at = [scene.width - 0.8, scene.height - 0.8];
            scene.text(Line::new(&words, style.size()), at, Anchor::End, 0.0, INK);
            scene
        };
        (0..FRAMES).map(frame).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cracks_open_at_their_strain() {
        let penny = |z| Penny { at: [5.0, 5.0, z], normal: [0.0, 0.0, 1.0], radius: 1.0, mode: 0 };
        let solid = Solid {
            high: [10.0; 3],
            cracks: vec![penny(2.0), penny(8.0)],
            modes: vec!["tension".into()],
            ..Solid::default()
        };
        let growth = Growth { solid, strains: vec![5e-4, 1e-3], end: 1e-3 };
        let frames = growth.frames(&Style::wide(90.0));
        let said = |frame: usize, what: &str| frames[frame].texts().iter().any(|(text, _)| text == what);
        assert_eq!(frames.len(), FRAMES);
        // Half of the strain is frame 19.5 of 39.
        assert!(said(0, "tension (0)") && said(19, "tension (0)") && said(20, "tension (1)"));
        assert!(said(39, "tension (2)") && said(39, "strain 0.100 %"));
        assert!(frames.iter().all(|frame| frame.height == frames[0].height && frame.faults().is_empty()));
    }
}
