//! Fissures: fractures laid into a test piece before it is bonded, with smooth joints on them.
//!
//! x is the width, y the axis of loading, z the depth; the origin is the middle of the piece. The dip is the angle of the fissure
//! below the horizontal, its direction the azimuth of the steepest descent from x towards z: the normal is
//! (sin δ cos α, cos δ, sin δ sin α). In the plane a fissure is a straight line that descends towards x, in space a disc.

use super::material::Material;
use super::piece::Piece;
use crate::genesis::network::{Drawn, Network};
use crate::space::Tuple;
use crate::{BondStiffness, Engine, Faults, Fracture, Group, JointBond, SmoothJoint, Space, Vector};
use math::elementary::{cos, sin};
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// One fissure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fissure {
    /// Its middle (m).
    pub centre: [f64; 3],
    /// Dip (rad).
    pub dip: f64,
    /// Azimuth of the dip (rad); 0 in the plane.
    #[serde(default)]
    pub direction: f64,
    /// Length, or diameter of the disc (m); none for one that cuts through the piece.
    pub length: Option<f64>,
}

/// All fissures of a piece, and what acts on them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fissures {
    /// Fissures one by one.
    pub list: Vec<Fissure>,
    /// Fissures by their statistics, each specimen with its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<Network>,
    /// Normal and shear stiffness per area (Pa/m); those of the contacts of the first group when none are given.
    pub stiffness: Option<[f64; 2]>,
    /// Friction.
    pub friction: f64,
    /// Dilation angle (rad).
    pub dilation: f64,
    /// Tensile strength, cohesion (Pa) and friction angle (rad) of bonded ones.
    pub bond: Option<[f64; 3]>,
}

impl Fissures {
    /// The joint that acts on them, in a piece of this mean radius (m).
    fn joint<S: Space>(&self, material: &Material, radius: f64) -> SmoothJoint {
        let own = || BondStiffness::Modulus {
            modulus: material.modulus::<S>(radius),
            ratio: material
                .table(0.0)
                .get(Group(0), Group(0))
                .map_or(f64::NAN, |law| 1.0 / law.linear.stiffness.shear_share()),
        };
        let stiffness = self.stiffness.map_or_else(own, |[kn, ks]| BondStiffness::PerArea { kn, ks });
        let bond = self.bond.map(|[tensile_strength, cohesion, friction_angle]| JointBond {
            tensile_strength,
            cohesion,
            friction_angle,
        });
        SmoothJoint { radius_multiplier: 1.0, stiffness, friction: self.friction, dilation: self.dilation, bond }
    }

    /// Lays them into the engine of a piece, before its bonds are installed at gaps up to `gap` (m). A network comes from the
    /// stream "network" of `seed`.
    ///
    /// # Errors
    /// All numbers outside their range.
    pub(super) fn lay<S: Space>(
        &self,
        engine: &mut Engine<S>,
        material: &Material,
        piece: &Piece<S>,
        (gap, seed): (f64, u64),
    ) -> Result<(), Faults> {
        let fracture = |fissure: &Fissure| {
            let (down, flat) = (sin(fissure.dip), cos(fissure.dip));
            let normal = [down * cos(fissure.direction), flat, down * sin(fissure.direction)];
            let radius = fissure.length.map_or(f64::INFINITY, |length| 0.5 * length);
            let vector = |x: [f64; 3]| Vector::<S>::build(|k| x[k]);
            Fracture { centre: vector(fissure.centre), normal: vector(normal), radius, set: 0 }
        };
        let mut fractures: Vec<Fracture<S>> = self.list.iter().map(fracture).collect();
        if let Some(network) = &self.network {
            let drawn = network.draw(piece.outline.extents(), S::DIMENSION, &mut Stream::new(seed, "network", 0));
            let vector = |x: [f64; 3]| Vector::<S>::build(|k| x[k]);
            let fracture = |one: Drawn| Fracture {
                centre: vector(one.centre),
                normal: vector(one.normal),
                radius: 0.5 * one.size,
                set: 0,
            };
            fractures.extend(drawn.into_iter().map(fracture));
        }
        engine.lay_joints(&fractures, &[self.joint::<S>(material, piece.mean_radius())], gap).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loading::material::Contact;
    use crate::loading::piece::Outline;
    use crate::{D2, Model, Particle, Settings};

    /// A square lattice of 20 × 20 discs of radius 0.5 with its middle at the origin.
    fn laid(dip: f64, length: Option<f64>) -> Vec<[f64; 2]> {
        let contact = Contact::bonded("rock", 20e9, 2.5, [10e6, 15e6], 0.5);
        let material = Material::of_one(contact);
        let at = |k: usize| [(k % 20) as f64 - 9.5, (k / 20) as f64 - 9.5];
        let piece = Piece {
            outline: Outline::Block { width: 20.0, height: 20.0, depth: 1.0 },
            centres: (0..400).map(at).collect(),
            radii: vec![0.5; 400],
            groups: vec![Group(0); 400],
            density: 2000.0,
            clumps: vec![],
        };
        let particles = piece.centres.iter().map(|&x| Particle::ball(x, 0.5, 2000.0, Group(0))).collect();
        let contacts = material.table(0.0);
        let model = Model { particles, clumps: vec![], walls: vec![], contacts, settings: Settings::<D2>::default() };
        let mut engine = Engine::new(&model).unwrap();
        let list = vec![Fissure { centre: [0.0; 3], dip, direction: 0.0, length }];
        let fissures = Fissures { list, network: None, stiffness: None, friction: 0.3, dilation: 0.0, bond: None };
        fissures.lay(&mut engine, &material, &piece, (1e-9, 1)).unwrap();
        engine.install_bonds(1e-9, 1).unwrap();
        engine.contacts().filter(|c| c.interface.is_some()).map(|c| c.point).collect()
    }

    #[test]
    fn a_fissure_takes_the_contacts_that_it_crosses_and_no_others() {
        // Level: the 20 upright contacts between the two middle rows; 6 of them within three diameters of the middle.
        assert_eq!(laid(0.0, None).len(), 20);
        assert_eq!(laid(0.0, Some(6.0)).len(), 6);
        // Steep: the level contacts between the two middle columns.
        assert_eq!(laid(std::f64::consts::FRAC_PI_2, None).len(), 20);
        // It descends towards x, and all lie within a radius of it and within its length.
        let (dip, length) = (0.6, 9.0);
        let points = laid(dip, Some(length));
        assert!(points.len() > 8);
        for x in points {
            let away = x.dot([sin(dip), cos(dip)]);
            assert!(away.abs() <= 0.5 && x.norm() <= 0.5 * length + 0.5, "{x:?}");
            assert!(x[0] * x[1] <= 0.5, "{x:?}");
        }
    }
}
