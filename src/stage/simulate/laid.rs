//! The fissures that were laid into the specimen of a run, and how much of it they cut.

use crate::artifact::run::Fissures;
use dem::Space;
use dem::loading::fissure::{Placed, placed};
use dem::loading::material::Material;
use dem::loading::piece::Piece;
use ndarray::Array2;

/// The fissures of a run.
pub(super) struct Laid {
    /// As they are stored.
    pub(super) table: Fissures,
    /// Number of dimensions of the specimen.
    dimension: usize,
    /// Volume of the specimen (m³); in the plane its area (m²).
    volume: f64,
}

impl Laid {
    /// The fissures of a piece with the networks that `seed` draws, and the closed contacts on each; nothing without fissures.
    pub(super) fn of<S: Space>(piece: &Piece<S>, material: &Material, seed: u64, contacts: &[usize]) -> Option<Self> {
        let all = placed(&material.fissures, &piece.outline, S::DIMENSION, seed);
        if material.fissures.is_empty() {
            return None;
        }
        let vectors = |pick: fn(&Placed) -> [f64; 3]| {
            Array2::from_shape_fn((all.len(), S::DIMENSION), |(row, axis)| pick(&all[row])[axis])
        };
        let table = Fissures {
            set: all.iter().map(|one| one.set + 1).collect(),
            position: vectors(|one| one.centre),
            normal: vectors(|one| one.normal),
            size: all.iter().map(|one| if one.size.is_finite() { one.size } else { f64::NAN }).collect(),
            inside: all.iter().map(|one| one.inside(&piece.outline, S::DIMENSION)).collect(),
            contacts: contacts.to_vec(),
        };
        Some(Self { table, dimension: S::DIMENSION, volume: piece.outline.volume() })
    }

    /// Their number and intensity, and the contacts on them.
    pub(super) fn quantities(&self) -> Vec<(&'static str, f64, &'static str)> {
        let Fissures { inside, contacts, .. } = &self.table;
        let sum: f64 = inside.iter().sum();
        let name = if self.dimension == 2 { "fissure length per area (P21)" } else { "fissure area per volume (P32)" };
        vec![
            ("fissures", inside.iter().filter(|&&inside| inside > 0.0).count() as f64, ""),
            (name, sum / self.volume, "1/m"),
            ("contacts on fissures", contacts.iter().sum::<usize>() as f64, ""),
        ]
    }

    /// A sentence on fissures that lie on no contact.
    pub(super) fn idle(&self) -> Option<String> {
        let contacts = &self.table.contacts;
        let idle: Vec<usize> = (0..contacts.len()).filter(|&k| contacts[k] == 0).collect();
        let first = idle.first()?;
        Some(format!(
            "{} of {} fissures cross no contact and have no effect, the first of them number {}: they are shorter than the \
             particles, outside the specimen, or wholly on contacts of fissures before them",
            idle.len(),
            contacts.len(),
            first + 1
        ))
    }
}
