//! The frame of a specimen in space: the edges of a box, or the circles of a cylinder or thick disc. What lies behind the
//! content is dashed. Of a specimen that is cut open, the edges in front of the cut give way to the outline of the cut.

use super::{Page, Solid, circle};
use crate::palette::{INK, SOFT};
use crate::scene::{Path, Point, Scene, Stroke};

/// Points along a circle.
const AROUND: usize = 72;
/// Half the width of a drawn platen as a share of the radius of the disc.
const PLATEN: f64 = 0.28;

impl Solid {
    /// The edges of the domain: those behind before the content, those in front after it.
    pub(super) fn draw_frame(&self, scene: &mut Scene, page: &Page, front: bool) {
        match self.round.filter(|axis| *axis < 3) {
            Some(axis) => self.draw_round(scene, page, axis, front),
            None => self.draw_box(scene, page, front),
        }
    }

    /// Both circles and the two lines between them; of a disc that lies on its side also the platens.
    fn draw_round(&self, scene: &mut Scene, page: &Page, axis: usize, front: bool) {
        let centre = [0, 1, 2].map(|k| (self.low[k] + self.high[k]) / 2.0);
        let across = (axis + 1) % 3;
        let radius = (self.high[across] - self.low[across]) / 2.0;
        // The direction to the eye.
        let unit = |k: usize| [0, 1, 2].map(|i| f64::from(u8::from(i == k)));
        let eye = [0, 1, 2].map(|k| page.view.depth(unit(k)) - page.view.depth([0.0; 3]));
        let facing = |v: [f64; 3]| v.iter().zip(eye).map(|(a, b)| a * b).sum::<f64>();
        let ends = [self.low[axis], self.high[axis]].map(|end| {
            let mut at = centre;
            at[axis] = end;
            at
        });
        let around: Vec<[f64; 3]> = circle([0.0; 3], unit(axis), radius, AROUND).collect();
        let point = |end: usize, i: usize| [0, 1, 2].map(|k| ends[end][k] + around[i % AROUND][k]);
        let mut path = Path::default();
        for end in 0..2 {
            let seen = (eye[axis] > 0.0) == (end == 1);
            for i in 0..AROUND {
                let middle = [0, 1, 2].map(|k| around[i][k] + around[(i + 1) % AROUND][k]);
                if (seen || facing(middle) > 0.0) == front && !self.is_cut_away(page, point(end, i)) {
                    path.add_polyline(&[point(end, i), point(end, i + 1)].map(page.place));
                }
            }
        }
        if front {
            // The outline of the mantle: where it turns away from the eye.
            let turns = |i: &usize| (facing(around[*i]) > 0.0) != (facing(around[(i + 1) % AROUND]) > 0.0);
            for i in (0..AROUND).filter(turns) {
                let along = [point(0, i), point(1, i)];
                if !along.iter().any(|end| self.is_cut_away(page, *end)) {
                    path.add_polyline(&along.map(page.place));
                }
            }
            if let Some(section) = self.section(axis, radius) {
                path.add_polygon(&section.iter().map(|corner| (page.place)(*corner)).collect::<Vec<_>>());
            }
        }
        stroke(scene, path, front);
        if axis == 1 && self.cut.is_none() {
            self.draw_platen(scene, page, radius, front);
        }
    }

    /// Whether a point lies in front of the cut.
    fn is_cut_away(&self, page: &Page, at: [f64; 3]) -> bool {
        self.cut.is_some_and(|cut| (at[cut.axis.min(2)] - cut.at) * self.before(page.view, cut) > 0.0)
    }

    /// The outline of the cut through a cylinder: a rectangle along its axis, or a circle across it.
    fn section(&self, axis: usize, radius: f64) -> Option<Vec<[f64; 3]>> {
        let cut = self.cut?;
        let across = cut.axis.min(2);
        let mut centre = [0, 1, 2].map(|k| (self.low[k] + self.high[k]) / 2.0);
        let off = cut.at - centre[across];
        centre[across] = cut.at;
        if across == axis {
            let normal = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
            return Some(circle(centre, normal, radius, AROUND).collect());
        }
        let half = (radius * radius - off * off).max(0.0).sqrt();
        let side = 3 - across - axis;
        let corner = |(side_by, end): (f64, f64)| {
            let mut at = centre;
            (at[side], at[axis]) = (centre[side] + side_by, end);
            at
        };
        let (low, high) = (self.low[axis], self.high[axis]);
        Some([(-half, low), (half, low), (half, high), (-half, high)].map(corner).to_vec())
    }

    /// The upper platen in front, the lower one behind.
    fn draw_platen(&self, scene: &mut Scene, page: &Page, radius: f64, front: bool) {
        let middle = (self.low[0] + self.high[0]) / 2.0;
        let level = if front { self.high[2] } else { self.low[2] };
        let half = PLATEN * radius;
        let corners = [[-half, self.low[1]], [half, self.low[1]], [half, self.high[1]], [-half, self.high[1]]];
        let corners: Vec<Point> = corners.iter().map(|[x, y]| (page.place)([middle + x, *y, level])).collect();
        scene.stroke(Path::polygon(&corners), Stroke::new(SOFT, 0.35));
    }

    /// The edges of a box.
    fn draw_box(&self, scene: &mut Scene, page: &Page, front: bool) {
        let back = page.view.back();
        let place = |signs: [f64; 3]| {
            let at = |k: usize| if signs[k] > 0.0 { self.high[k] } else { self.low[k] };
            (page.place)([at(0), at(1), at(2)])
        };
        let mut path = Path::default();
        for corner in (0..8).map(|k| [0, 1, 2].map(|b| if k >> b & 1 == 1 { 1.0 } else { -1.0 })) {
            for axis in (0..3).filter(|&axis| corner[axis] < 0.0) {
                let mut other = corner;
                other[axis] = 1.0;
                let hidden = (0..3).filter(|&k| k != axis).all(|k| corner[k] == back[k]);
                let cut_away = self.cut.is_some_and(|c| {
                    front && {
                        let k = c.axis.min(2);
                        k == axis || corner[k] != back[k]
                    }
                });
                if hidden != front && !cut_away {
                    path.add_polyline(&[place(corner), place(other)]);
                }
            }
        }
        stroke(scene, path, front);
    }
}

fn stroke(scene: &mut Scene, path: Path, front: bool) {
    if !path.0.is_empty() {
        scene.stroke(path, if front { Stroke::new(INK, 0.2) } else { Stroke::new(SOFT, 0.15).dashed(&[1.2, 1.0]) });
    }
}
