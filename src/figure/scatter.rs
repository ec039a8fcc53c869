//! Points in a panel, with names beside the outlying ones: shared by the plots of residuals and agreement.

use super::Style;
use super::palette::{INK, Marker};
use super::panel::{Panel, draw_marker};
use super::scene::{Anchor, Color, Point, Rect, Scene};
use super::text::Line;

/// Draws a marker at every pair of finite values.
pub fn draw(scene: &mut Scene, panel: &Panel, points: &[[f64; 2]], kind: Marker, size: f64, color: Color) {
    for &[x, y] in points.iter().filter(|p| panel.x.holds(p[0]) && panel.y.holds(p[1])) {
        draw_marker(scene, kind, panel.place(x, y), size, color);
    }
}

/// Writes names beside points, on the first of four sides that has room; a name without room is left out.
pub fn name(scene: &mut Scene, panel: &Panel, names: &[(String, [f64; 2])], others: &[[f64; 2]], style: &Style) {
    let spot = |[x, y]: Point, r: f64| Rect { left: x - r, right: x + r, top: y - r, bottom: y + r };
    let mut taken: Vec<Rect> = others.iter().map(|p| spot(panel.place(p[0], p[1]), 0.5)).collect();
    let room = panel.area.inset(-1.0, -1.0, -1.0, -1.0);
    for (label, p) in names {
        let line = Line::new(label, 0.9 * style.size());
        let [x, y] = panel.place(p[0], p[1]);
        let half = line.size * super::text::CAP_HEIGHT / 2.0;
        let (w, gap) = (line.width, 1.3);
        let tries =
            [[x + gap, y + half], [x - gap - w, y + half], [x - w / 2.0, y - gap], [x - w / 2.0, y + gap + 2.0 * half]];
        let free = tries.into_iter().find(|&at| {
            let bounds = line.bounds(at, 0.0);
            room.holds(&bounds) && !taken.iter().any(|t| t.meets(&bounds))
        });
        if let Some(at) = free {
            taken.push(line.bounds(at, 0.0));
            scene.text(line, at, Anchor::Start, 0.0, INK);
        }
    }
}
