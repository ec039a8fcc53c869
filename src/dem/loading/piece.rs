//! The test piece: what a loading test needs to know of a specimen, in the plane or in the solid.
//!
//! The origin is the centre of the piece and y the axis of loading. In the plane the piece has unit thickness along z.
//! Lengths in metres.

use crate::genesis::network::length_inside;
use crate::genesis::region::Region;
use crate::genesis::specimen::Specimen;
use crate::space::Tuple;
use crate::{Clump, Group, Space, Spin, Vector};
use std::f64::consts::FRAC_PI_4;

/// Outline of a test piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// Rectangle (unit depth) or box along the axes.
    Block {
        /// Extent along x.
        width: f64,
        /// Extent along y, the axis of loading.
        height: f64,
        /// Extent along z; 1 in the plane.
        depth: f64,
    },
    /// Disc (unit thickness), or a cylinder that lies along z.
    Disc {
        /// Diameter.
        diameter: f64,
        /// Extent along z; 1 in the plane.
        thickness: f64,
    },
    /// A cylinder along y; solid only.
    Column {
        /// Diameter.
        diameter: f64,
        /// Extent along y.
        height: f64,
    },
}

impl Outline {
    /// Extents along x, y and z; z is 1 in the plane.
    pub fn extents(&self) -> [f64; 3] {
        match *self {
            Self::Block { width, height, depth } => [width, height, depth],
            Self::Disc { diameter, thickness } => [diameter, diameter, thickness],
            Self::Column { diameter, height } => [diameter, height, diameter],
        }
    }

    /// Extent along the axis of loading.
    pub fn height(&self) -> f64 {
        self.extents()[1]
    }

    /// Section across the axis of loading of a block or column (m²); of a disc, that of its box.
    pub fn section(&self) -> f64 {
        match *self {
            Self::Block { width, depth, .. } => width * depth,
            Self::Disc { diameter, thickness } => diameter * thickness,
            Self::Column { diameter, .. } => FRAC_PI_4 * diameter * diameter,
        }
    }

    /// Volume (m³); in the plane the area times the unit thickness.
    pub fn volume(&self) -> f64 {
        match *self {
            Self::Block { width, height, depth } => width * height * depth,
            Self::Disc { diameter, thickness } => FRAC_PI_4 * diameter * diameter * thickness,
            Self::Column { diameter, height } => FRAC_PI_4 * diameter * diameter * height,
        }
    }

    /// Whether a point of space lies in it.
    pub fn holds(&self, point: [f64; 3]) -> bool {
        let within = |k: usize| point[k].abs() <= 0.5 * self.extents()[k];
        let round =
            |a: usize, b: usize, diameter: f64| point[a] * point[a] + point[b] * point[b] <= 0.25 * diameter * diameter;
        match *self {
            Self::Block { .. } => (0..3).all(within),
            Self::Disc { diameter, .. } => round(0, 1, diameter) && within(2),
            Self::Column { diameter, .. } => round(0, 2, diameter) && within(1),
        }
    }

    /// Length of a line of the plane in it (m), from its middle, its unit normal and half its length.
    pub fn chord(&self, [middle, normal]: [[f64; 3]; 2], reach: f64) -> f64 {
        let Self::Disc { diameter, .. } = *self else {
            return length_inside([middle, normal], reach, self.extents());
        };
        let foot = middle[1] * normal[0] - middle[0] * normal[1];
        let off = middle[0] * normal[0] + middle[1] * normal[1];
        let half = (0.25 * diameter * diameter - off * off).max(0.0).sqrt();
        (reach.min(foot + half) - (foot - half).max(-reach)).max(0.0)
    }

    /// The field's word for it.
    pub fn name(&self, dimension: usize) -> &'static str {
        match (self, dimension) {
            (Self::Block { .. }, 2) => "rectangle",
            (Self::Block { .. }, _) => "box",
            (Self::Disc { .. }, 2) => "disc",
            (Self::Disc { .. }, _) => "lying cylinder",
            (Self::Column { .. }, _) => "standing cylinder",
        }
    }
}

/// A test piece, free of force.
#[derive(Clone, Debug)]
pub struct Piece<S: Space> {
    /// Outline.
    pub outline: Outline,
    /// Centres of the balls (m).
    pub centres: Vec<Vector<S>>,
    /// Their radii (m).
    pub radii: Vec<f64>,
    /// Their contact groups.
    pub groups: Vec<Group>,
    /// Density of balls that belong to no clump (kg/m³).
    pub density: f64,
    /// Rigid clumps of some of the balls.
    pub clumps: Vec<Clump<S>>,
}

impl<S: Space> Piece<S> {
    /// Mean radius (m).
    pub fn mean_radius(&self) -> f64 {
        self.radii.iter().sum::<f64>() / self.radii.len() as f64
    }

    /// Whether each ball is a pebble of a clump.
    pub fn clumped(&self) -> Vec<bool> {
        let mut clumped = vec![false; self.radii.len()];
        self.clumps.iter().flat_map(|clump| &clump.pebbles).for_each(|&pebble| clumped[pebble] = true);
        clumped
    }

    /// Mean diameters across the narrowest extent.
    pub fn particles_across(&self) -> f64 {
        let narrowest = self.outline.extents()[..S::DIMENSION].iter().copied().fold(f64::INFINITY, f64::min);
        narrowest / (2.0 * self.mean_radius())
    }
}

impl From<Region> for Outline {
    fn from(region: Region) -> Self {
        match region {
            Region::Rectangle { width, height } => Self::Block { width, height, depth: 1.0 },
            Region::Box { width, height, depth } => Self::Block { width, height, depth },
            Region::Disc { diameter } => Self::Disc { diameter, thickness: 1.0 },
            Region::ThickDisc { diameter, depth } => Self::Disc { diameter, thickness: depth },
            Region::Cylinder { diameter, height } => Self::Column { diameter, height },
        }
    }
}

impl<S: Space> From<&Specimen<S>> for Piece<S> {
    fn from(specimen: &Specimen<S>) -> Self {
        Self {
            outline: specimen.region.into(),
            centres: specimen.centres.clone(),
            radii: specimen.radii.clone(),
            groups: specimen.groups.clone(),
            density: specimen.density,
            clumps: specimen.clumps.iter().map(rigid).collect(),
        }
    }
}

fn rigid<S: Space>(clump: &crate::genesis::clump::Clump<S>) -> Clump<S> {
    Clump {
        pebbles: clump.pebbles.clone(),
        centre: clump.centre,
        velocity: Vector::<S>::zero(),
        spin: Spin::<S>::zero(),
        mass: clump.mass,
        inertia: clump.inertia,
    }
}
