//! The outline of a specimen and the walls of the vessel it is packed in, in the plane and in the solid.
//!
//! The origin is the specimen's centre: x across the axis of loading, y along it, z the second axis across (solid only).
//! Every outline is a product of two kinds of walls: pairs of flat ones at ± half an extent, and one round one about
//! an axis. Lengths in metres.

use crate::space::{Space, Tuple, Vector};
use serde::{Deserialize, Serialize};

/// A point or vector in the plane (m).
pub type Point = [f64; 2];

/// Outline of a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Region {
    /// Plane: |x| ≤ width / 2, |y| ≤ height / 2.
    Rectangle {
        /// Extent across the axis of loading (m).
        width: f64,
        /// Extent along the axis of loading (m).
        height: f64,
    },
    /// Plane: x² + y² ≤ diameter² / 4.
    Disc {
        /// Diameter (m).
        diameter: f64,
    },
    /// Solid: |x| ≤ width / 2, |y| ≤ height / 2, |z| ≤ depth / 2.
    Box {
        /// Extent across the axis of loading (m).
        width: f64,
        /// Extent along the axis of loading (m).
        height: f64,
        /// Second extent across (m).
        depth: f64,
    },
    /// Solid, its axis along the load: x² + z² ≤ diameter² / 4, |y| ≤ height / 2.
    Cylinder {
        /// Diameter (m).
        diameter: f64,
        /// Length along the axis of loading (m).
        height: f64,
    },
    /// Solid, its axis across the load, as in a Brazilian test: x² + y² ≤ diameter² / 4, |z| ≤ depth / 2.
    ThickDisc {
        /// Diameter (m).
        diameter: f64,
        /// Thickness (m).
        depth: f64,
    },
}

/// A wall of the vessel that is near a body.
#[derive(Clone, Copy, Debug)]
pub struct WallTouch<S: Space> {
    /// Distance from the wall to the body's centre (m).
    pub distance: f64,
    /// Unit vector from the wall into the region.
    pub normal: Vector<S>,
}

/// The walls of a vessel: half the distance of each pair of flat ones, and the two axes and the radius of a round one.
#[derive(Clone, Copy, Debug)]
struct Walls {
    flat: [Option<f64>; 3],
    round: Option<([usize; 2], f64)>,
}

impl Region {
    /// Number of dimensions, 2 or 3.
    pub fn dimension(&self) -> usize {
        match self {
            Self::Rectangle { .. } | Self::Disc { .. } => 2,
            Self::Box { .. } | Self::Cylinder { .. } | Self::ThickDisc { .. } => 3,
        }
    }

    /// Name of the shape.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Rectangle { .. } => "rectangle",
            Self::Disc { .. } => "disc",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::ThickDisc { .. } => "thick-disc",
        }
    }

    /// The outline of a shape with these edges along x, y and z (m); none of another name.
    pub fn named(name: &str, [x, y, z]: [f64; 3]) -> Option<Self> {
        let all = [
            Self::Rectangle { width: x, height: y },
            Self::Disc { diameter: x },
            Self::Box { width: x, height: y, depth: z },
            Self::Cylinder { diameter: x, height: y },
            Self::ThickDisc { diameter: x, depth: z },
        ];
        all.into_iter().find(|region| region.name() == name)
    }

    /// Volume (m³), or area in the plane (m²).
    pub fn volume(&self) -> f64 {
        let circle = |diameter: f64| std::f64::consts::FRAC_PI_4 * diameter * diameter;
        match *self {
            Self::Rectangle { width, height } => width * height,
            Self::Disc { diameter } => circle(diameter),
            Self::Box { width, height, depth } => width * height * depth,
            Self::Cylinder { diameter, height } => circle(diameter) * height,
            Self::ThickDisc { diameter, depth } => circle(diameter) * depth,
        }
    }

    /// Edges of the box around the outline along x, y and z (m); z is 0 in the plane.
    pub fn edges(&self) -> [f64; 3] {
        match *self {
            Self::Rectangle { width, height } => [width, height, 0.0],
            Self::Disc { diameter } => [diameter, diameter, 0.0],
            Self::Box { width, height, depth } => [width, height, depth],
            Self::Cylinder { diameter, height } => [diameter, height, diameter],
            Self::ThickDisc { diameter, depth } => [diameter, diameter, depth],
        }
    }

    /// Extents across and along the axis of loading (m).
    pub fn extent(&self) -> Point {
        let [x, y, _] = self.edges();
        [x, y]
    }

    /// The smallest extent (m).
    pub fn narrowest(&self) -> f64 {
        self.edges()[..self.dimension()].iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn walls(&self) -> Walls {
        let edges = self.edges();
        let flat = |axes: &[usize]| std::array::from_fn(|k| axes.contains(&k).then_some(0.5 * edges[k]));
        match *self {
            Self::Rectangle { .. } => Walls { flat: flat(&[0, 1]), round: None },
            Self::Box { .. } => Walls { flat: flat(&[0, 1, 2]), round: None },
            Self::Disc { diameter } => Walls { flat: flat(&[]), round: Some(([0, 1], 0.5 * diameter)) },
            Self::Cylinder { diameter, .. } => Walls { flat: flat(&[1]), round: Some(([0, 2], 0.5 * diameter)) },
            Self::ThickDisc { diameter, .. } => Walls { flat: flat(&[2]), round: Some(([0, 1], 0.5 * diameter)) },
        }
    }

    /// Distance from `point` to the nearest wall (m); negative outside.
    pub fn depth<S: Space>(&self, point: Vector<S>) -> f64 {
        let Walls { flat, round } = self.walls();
        let sides = flat.iter().enumerate().filter_map(|(k, half)| half.map(|half| half - point.at(k).abs()));
        let nearest = sides.fold(f64::INFINITY, f64::min);
        round.map_or(nearest, |([a, b], radius)| nearest.min(radius - norm([point.at(a), point.at(b)])))
    }

    /// Calls `touch` for every wall nearer to `point` than `reach` (m), always in the same order.
    pub fn walls_within<S: Space>(&self, point: Vector<S>, reach: f64, mut touch: impl FnMut(WallTouch<S>)) {
        let Walls { flat, round } = self.walls();
        for (axis, half) in flat.iter().enumerate() {
            let Some(half) = half else { continue };
            for (distance, inward) in [(half + point.at(axis), 1.0), (half - point.at(axis), -1.0)] {
                if distance < reach {
                    let normal = Vector::<S>::build(|k| if k == axis { inward } else { 0.0 });
                    touch(WallTouch { distance, normal });
                }
            }
        }
        let Some(([a, b], radius)) = round else { return };
        let from_axis = norm([point.at(a), point.at(b)]);
        let distance = radius - from_axis;
        if distance < reach && from_axis > 0.0 {
            let inward = |k: usize| if k == a || k == b { -point.at(k) / from_axis } else { 0.0 };
            touch(WallTouch { distance, normal: Vector::<S>::build(inward) });
        }
    }
}

/// Length of a vector of the plane.
pub fn norm(v: Point) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{D2, D3};
    use math::random::Stream;

    #[test]
    fn a_corner_touches_two_walls_and_a_disc_one() {
        let mut seen = Vec::new();
        let rectangle = Region::Rectangle { width: 2.0, height: 4.0 };
        rectangle.walls_within::<D2>([0.9, -1.8], 0.3, |touch| seen.push(touch));
        assert_eq!(seen.iter().map(|t| t.normal).collect::<Vec<_>>(), [[-1.0, 0.0], [0.0, 1.0]]);
        assert!((seen[0].distance - 0.1).abs() < 1e-15 && (seen[1].distance - 0.2).abs() < 1e-15);
        seen.clear();
        Region::Disc { diameter: 2.0 }.walls_within::<D2>([0.6, 0.8 - 1e-9], 0.3, |touch| seen.push(touch));
        assert_eq!(seen.len(), 1);
        assert!((seen[0].normal[0] + 0.6).abs() < 1e-8 && (seen[0].normal[1] + 0.8).abs() < 1e-8);
    }

    #[test]
    fn depth_is_the_distance_to_the_nearest_wall() {
        let rectangle = Region::Rectangle { width: 2.0, height: 4.0 };
        assert_eq!(rectangle.depth::<D2>([0.5, 0.0]), 0.5);
        assert_eq!(rectangle.depth::<D2>([0.0, 2.5]), -0.5);
        assert_eq!(Region::Disc { diameter: 10.0 }.depth::<D2>([3.0, 4.0]), 0.0);
        let cylinder = Region::Cylinder { diameter: 10.0, height: 6.0 };
        assert_eq!(cylinder.depth::<D3>([3.0, 0.0, -4.0]), 0.0);
        assert_eq!(cylinder.depth::<D3>([0.0, 2.5, 0.0]), 0.5);
    }

    /// In every outline: the nearest wall touched is at the depth, its foot lies on the outline, and the share of random
    /// points of the box around it that lie inside is its volume's.
    #[test]
    fn walls_depth_and_volume_agree() {
        let solids = [
            Region::Box { width: 1.0, height: 2.0, depth: 0.7 },
            Region::Cylinder { diameter: 1.0, height: 2.0 },
            Region::ThickDisc { diameter: 1.0, depth: 0.4 },
        ];
        let mut stream = Stream::new(1, "outline", 0);
        for region in solids {
            let edges = region.edges();
            let mut inside = 0.0;
            for _ in 0..20_000 {
                let x: [f64; 3] = std::array::from_fn(|k| edges[k] * (stream.uniform() - 0.5));
                let depth = region.depth::<D3>(x);
                inside += if depth > 0.0 { 1.0 } else { 0.0 };
                let mut nearest = f64::INFINITY;
                region.walls_within::<D3>(x, f64::INFINITY, |touch| {
                    nearest = nearest.min(touch.distance);
                    let foot: [f64; 3] = std::array::from_fn(|k| x[k] - touch.distance * touch.normal[k]);
                    assert!(region.depth::<D3>(foot) < 1e-12);
                });
                assert!((nearest - depth).abs() < 1e-12);
            }
            let share = region.volume() / edges.iter().product::<f64>();
            assert!((inside / 20_000.0 - share).abs() < 0.01, "{region:?}");
        }
    }
}
