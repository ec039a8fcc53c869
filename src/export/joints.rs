//! Flat and smooth joints of a run before it is loaded, contact by contact: which law acts, in which state, with which drawn
//! strengths. They are those of the run, bond by bond, because its specimen is mounted and bonded as the run did it.

use crate::artifact::Table;
use dem::genesis::specimen::Specimen;
use dem::loading::fissure::{Placed, placed};
use dem::loading::material::{BondKind, Material};
use dem::loading::piece::Piece;
use dem::loading::rig::{Machine, Platens, mount};
use dem::parameter::Parameter;
use dem::{Other, Space};
use std::collections::BTreeMap;

/// A joint before loading.
struct Joint {
    bonded: bool,
    /// Opening of its faces (m).
    opening: f64,
    /// Tensile strength and cohesion (Pa); none where it is not bonded.
    strengths: [f64; 2],
    /// Its fissure, from 0; none for a flat joint.
    fissure: Option<usize>,
}

/// All joints of a run before loading.
pub(super) struct Joints {
    of: BTreeMap<[usize; 2], Joint>,
    fissures: Vec<Placed>,
}

/// Openings below this share of the mean radius are those of faces that touch.
const CLOSED: f64 = 1e-6;

impl Joints {
    /// The joints of a material in a specimen with the run's seed; none for a material without any.
    ///
    /// # Errors
    /// The specimen cannot be mounted with this material.
    pub(super) fn of<S: Space>(specimen: &Specimen<S>, material: &Material, seed: u64) -> Result<Option<Self>, String> {
        let flat = material.contacts.values().any(|contact| contact.bond == BondKind::FlatJoint);
        if !flat && material.fissures.is_empty() {
            return Ok(None);
        }
        let piece = Piece::from(specimen);
        let machine = (&Platens::default(), &Machine::default());
        let mounted =
            mount(&piece, material, Vec::new(), Vec::new(), machine, seed).map_err(|faults| faults.to_string())?;
        let mut of = BTreeMap::new();
        for contact in mounted.engine.contacts() {
            let (Some(interface), Other::Particle(other)) = (contact.interface, contact.other) else { continue };
            let [a, b] = [contact.particle, other];
            let multiplier = match interface.fracture {
                Some(_) => 1.0,
                None => multiplier(material, [a, b].map(|ball| usize::from(piece.groups[ball].0))),
            };
            let section = S::section(multiplier * piece.radii[a].min(piece.radii[b]));
            let bonded = contact.bonded;
            let strengths = contact.capacity.map(|force| if bonded { force / section } else { f64::NAN });
            let closed = interface.opening.abs() < CLOSED * piece.mean_radius();
            let opening = if closed { 0.0 } else { interface.opening };
            of.insert([a.min(b), a.max(b)], Joint { bonded, opening, strengths, fissure: interface.fracture });
        }
        let fissures = placed(&material.fissures, &piece.outline, S::DIMENSION, seed);
        Ok(Some(Self { of, fissures }))
    }

    /// Whether a joint is bonded; nothing for a contact without one.
    pub(super) fn bonded(&self, ends: [usize; 2]) -> Option<bool> {
        self.of.get(&ends).map(|joint| joint.bonded)
    }

    /// Adds the columns of joints to the table of contacts with these ends.
    pub(super) fn columns(&self, table: Table, ends: &[[usize; 2]]) -> Table {
        let all: Vec<Option<&Joint>> = ends.iter().map(|ends| self.of.get(ends)).collect();
        let reals =
            |pick: &dyn Fn(&Joint) -> f64| all.iter().map(|joint| joint.map_or(f64::NAN, pick)).collect::<Vec<f64>>();
        let state = |joint: &Option<&Joint>| match joint {
            None => "",
            Some(Joint { bonded: true, .. }) => "bonded",
            Some(Joint { opening, .. }) if *opening > 0.0 => "gapped",
            Some(_) => "slit",
        };
        let joint = |joint: &Option<&Joint>| match joint {
            None => "",
            Some(Joint { fissure: Some(_), .. }) => "smooth",
            Some(_) => "flat",
        };
        let fissure = |joint: &Option<&Joint>| joint.and_then(|joint| joint.fissure).map_or(-1, |k| k as i64);
        table
            .texts_column(
                "joint",
                "flat or smooth joint in place of the contact",
                all.iter().map(joint).map(str::to_owned).collect(),
            )
            .texts_column(
                "state",
                "bonded, slit (unbonded, closed) or gapped (unbonded, open)",
                all.iter().map(state).map(str::to_owned).collect(),
            )
            .reals_column("opening", "m", "of the faces before loading: the initial gap", reals(&|joint| joint.opening))
            .reals_column("tensile_strength", "Pa", "as drawn for this joint", reals(&|joint| joint.strengths[0]))
            .reals_column("cohesion", "Pa", "as drawn for this joint", reals(&|joint| joint.strengths[1]))
            .ints_column("fissure", "its fissure, -1 for none", all.iter().map(fissure).collect())
    }

    /// The fissures, a row for each; nothing where there are none.
    pub(super) fn fissures(&self, dimension: usize) -> Option<Table> {
        let all = &self.fissures;
        if all.is_empty() {
            return None;
        }
        let reals = |pick: &dyn Fn(&Placed) -> f64| all.iter().map(pick).collect::<Vec<f64>>();
        let axes = || ["x", "y", "z"].into_iter().take(dimension).enumerate();
        let mut table = Table::default()
            .ints_column("id", "index of the fissure", (0..all.len() as i64).collect())
            .ints_column("set", "its set, from 1", all.iter().map(|one| one.set as i64 + 1).collect());
        for (axis, name) in axes() {
            table = table.reals_column(name, "m", "middle, from that of the specimen", reals(&|one| one.centre[axis]));
        }
        for (axis, name) in axes() {
            table = table.reals_column(&format!("normal_{name}"), "", "unit normal", reals(&|one| one.normal[axis]));
        }
        let size = reals(&|one| if one.size.is_finite() { one.size } else { f64::NAN });
        Some(table.reals_column("size", "m", "length, or diameter of the disc; none for one that cuts through", size))
    }
}

/// Radius multiplier of the contacts of two groups.
fn multiplier(material: &Material, [a, b]: [usize; 2]) -> f64 {
    let own = material.contact(a, b).and_then(|(_, contact)| contact.values.get(&Parameter::RadiusMultiplier));
    own.copied().unwrap_or(Parameter::RadiusMultiplier.declaration().default)
}
