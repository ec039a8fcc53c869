//! Fissures: fractures laid into a test piece before it is bonded, with smooth joints on them.
//!
//! x is the width, y the axis of loading, z the depth; the origin is the middle of the piece. The dip is the angle of the fissure
//! below the horizontal, its direction the azimuth of the steepest descent from x towards z: the normal is
//! (sin δ cos α, cos δ, sin δ sin α). In the plane a fissure is a straight line that descends towards x, in space a disc.
//!
//! A piece has sets of fissures, each with its own law. Where fissures cross, the first one has the contact: sets in their
//! order, in a set the listed ones before those of the network.

use super::material::Material;
use super::piece::{Outline, Piece};
use crate::genesis::network::{Drawn, Network};
use crate::space::Tuple;
use crate::{BondStiffness, Engine, Faults, Fracture, Group, JointBond, SmoothJoint, Space, Vector};
use math::elementary::{cos, sin};
use math::random::Stream;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

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

/// A set of fissures, and what acts on them.
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

impl Fissure {
    /// Its unit normal.
    pub fn normal(&self) -> [f64; 3] {
        let (down, flat) = (sin(self.dip), cos(self.dip));
        [down * cos(self.direction), flat, down * sin(self.direction)]
    }
}

/// A fissure in its place in a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its set, from 0.
    pub set: usize,
    /// Its middle (m).
    pub centre: [f64; 3],
    /// Its unit normal; without z in the plane.
    pub normal: [f64; 3],
    /// Length, or diameter of the disc (m); infinite for one that cuts through the piece.
    pub size: f64,
}

/// All fissures of a piece of this outline: those of the lists, and the networks, each from its seed and the `seed` of the
/// piece.
pub fn placed(sets: &[Fissures], outline: &Outline, dimension: usize, seed: u64) -> Vec<Placed> {
    let mut all = Vec::new();
    for (set, fissures) in sets.iter().enumerate() {
        let listed = |one: &Fissure| Placed {
            set,
            centre: one.centre,
            normal: one.normal(),
            size: one.length.unwrap_or(f64::INFINITY),
        };
        all.extend(fissures.list.iter().map(listed));
        let Some(network) = &fissures.network else { continue };
        let own = Stream::new(network.seed, "network", seed).bits();
        let drawn = network.draw(outline.extents(), dimension, &mut Stream::new(own, "fractures", set as u64));
        all.extend(drawn.into_iter().map(|Drawn { centre, normal, size }| Placed { set, centre, normal, size }));
    }
    all
}

/// Points at which a disc is sampled, along its radius and around.
const SAMPLES: [usize; 2] = [32, 96];

impl Placed {
    /// How much of it lies in an outline: length in the plane (m), area of the disc in space (m², by sampling at points of equal
    /// area).
    pub fn inside(&self, outline: &Outline, dimension: usize) -> f64 {
        let reach = outline.extents()[..dimension].iter().map(|edge| edge * edge).sum::<f64>().sqrt();
        let away = self.centre.norm();
        let radius = (0.5 * self.size).min(away + reach);
        if dimension == 2 {
            return outline.chord([self.centre, self.normal], radius);
        }
        let axis = if self.normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let first = crate::space::D3::moment(self.normal, axis);
        let first = first.times(1.0 / first.norm());
        let second = crate::space::D3::moment(self.normal, first);
        let [rings, sectors] = SAMPLES;
        let point = |k: usize| {
            let r = radius * (((k / sectors) as f64 + 0.5) / rings as f64).sqrt();
            let angle = TAU * ((k % sectors) as f64 + 0.5) / sectors as f64;
            self.centre.plus(first.times(r * cos(angle))).plus(second.times(r * sin(angle)))
        };
        let within = (0..rings * sectors).filter(|&k| outline.holds(point(k))).count();
        PI * radius * radius * within as f64 / (rings * sectors) as f64
    }
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
}

/// Lays the fissures of a material into the engine of a piece, before its bonds are installed at gaps up to `gap` (m).
///
/// # Errors
/// All numbers outside their range.
pub(super) fn lay<S: Space>(
    engine: &mut Engine<S>,
    material: &Material,
    piece: &Piece<S>,
    (gap, seed): (f64, u64),
) -> Result<(), Faults> {
    if material.fissures.is_empty() {
        return Ok(());
    }
    let vector = |x: [f64; 3]| Vector::<S>::build(|k| x[k]);
    let fracture = |one: Placed| Fracture {
        centre: vector(one.centre),
        normal: vector(one.normal),
        radius: 0.5 * one.size,
        set: one.set,
    };
    let placed = placed(&material.fissures, &piece.outline, S::DIMENSION, seed);
    let fractures: Vec<Fracture<S>> = placed.into_iter().map(fracture).collect();
    let joint = |set: &Fissures| set.joint::<S>(material, piece.mean_radius());
    let joints: Vec<SmoothJoint> = material.fissures.iter().map(joint).collect();
    engine.lay_joints(&fractures, &joints, gap).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loading::material::Contact;
    use crate::loading::piece::Outline;
    use crate::{D2, Model, Particle, Settings};

    fn set(dip: f64, length: Option<f64>) -> Fissures {
        let list = vec![Fissure { centre: [0.0; 3], dip, direction: 0.0, length }];
        Fissures { list, network: None, stiffness: None, friction: 0.3, dilation: 0.0, bond: None }
    }

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
        let material = Material { fissures: vec![set(dip, length)], ..material };
        lay(&mut engine, &material, &piece, (1e-9, 1)).unwrap();
        engine.install_bonds(1e-9, 1).unwrap();
        let [laid] = engine.fractures().map(|(_, contacts)| contacts).collect::<Vec<_>>()[..] else { panic!() };
        assert_eq!(laid, engine.contacts().filter(|c| c.interface.is_some()).count());
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

    fn one(centre: [f64; 3], dip: f64, size: f64) -> Placed {
        Placed { set: 0, centre, normal: Fissure { centre, dip, direction: 0.0, length: None }.normal(), size }
    }

    #[test]
    fn length_and_area_inside_are_those_of_geometry() {
        let block = Outline::Block { width: 4.0, height: 6.0, depth: 1.0 };
        // Wholly inside; half outside; through, at 45 degrees; beside the block.
        for (fissure, length) in [
            (one([0.0; 3], 0.3, 1.5), 1.5),
            (one([2.0, 0.0, 0.0], 0.0, 1.5), 0.75),
            (one([0.0; 3], std::f64::consts::FRAC_PI_4, f64::INFINITY), 4.0 * std::f64::consts::SQRT_2),
            (one([3.0, 0.0, 0.0], 0.0, 1.5), 0.0),
        ] {
            assert!((fissure.inside(&block, 2) - length).abs() < 1e-12, "{fissure:?}");
        }
        // A chord of a disc at a distance of 0.6 radii is 1.6 radii long.
        let disc = Outline::Disc { diameter: 2.0, thickness: 1.0 };
        let chord = one([0.0, 0.6, 0.0], 0.0, f64::INFINITY).inside(&disc, 2);
        assert!((chord - 1.6).abs() < 1e-12, "{chord}");
        let block = Outline::Block { width: 4.0, height: 6.0, depth: 4.0 };
        let share = |fissure: Placed, area: f64| (fissure.inside(&block, 3) / area - 1.0).abs();
        assert!(share(one([0.0; 3], 0.4, 2.0), PI) < 1e-12);
        assert!(share(one([2.0, 0.0, 0.0], 0.0, 2.0), 0.5 * PI) < 1e-12);
        assert!(share(one([0.0; 3], 0.0, f64::INFINITY), 16.0) < 0.01);
    }

    #[test]
    fn sets_are_laid_in_their_order_and_drawn_from_streams_of_their_own() {
        let network =
            Network { intensity: 4.0, exponent: 2.0, sizes: [1.0, 3.0], mean: [0.5, 0.0], concentration: 5.0, seed: 1 };
        let drawn = Fissures { list: vec![], network: Some(network.clone()), ..set(0.0, None) };
        let block = Outline::Block { width: 20.0, height: 20.0, depth: 1.0 };
        let all = placed(&[drawn.clone(), set(0.2, None), drawn], &block, 2, 7);
        assert!(all.windows(2).all(|pair| pair[0].set <= pair[1].set));
        let of = |set: usize| all.iter().filter(|one| one.set == set).map(|one| one.centre).collect::<Vec<_>>();
        assert_eq!(of(1).len(), 1);
        assert!(of(0).len() > 100 && of(2).len() > 100 && of(0)[0] != of(2)[0]);
        // Another piece has another network, and so has another campaign.
        let first = |network: Network, piece: u64| {
            let sets = [Fissures { list: vec![], network: Some(network), ..set(0.0, None) }];
            placed(&sets, &block, 2, piece)[0].centre
        };
        let other = Network { seed: 2, ..network.clone() };
        assert_eq!(first(network.clone(), 7), of(0)[0]);
        assert!(first(network.clone(), 8) != of(0)[0] && first(other, 7) != of(0)[0]);
    }
}
