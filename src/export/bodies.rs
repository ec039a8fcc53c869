//! A specimen and a run on it as other programs want them: discs, groups, contacts.

use dem::genesis::heap::{Heap, Still};
use dem::genesis::specimen::Specimen;

/// A contact of the packing as it stands, free of force.
pub(super) struct Contact {
    /// The two discs, from 0.
    pub(super) ends: [usize; 2],
    /// Numbers of the two discs' groups, the smaller first.
    pub(super) groups: [usize; 2],
    /// Distance of the surfaces, m; negative where they overlap.
    pub(super) gap: f64,
}

/// The contacts of the discs that are nearer than `margin` (m) and not of one clump, in the order of their ends.
pub(super) fn contacts(specimen: &Specimen, margin: f64) -> Vec<Contact> {
    let (centres, radii) = (&specimen.centres, &specimen.radii);
    let heap = Heap::<dem::D2> {
        region: specimen.region,
        centres: centres.clone(),
        radii: radii.clone(),
        still: Still::default(),
    };
    let clump = specimen.clump_of_balls();
    let contact = |(i, j): (usize, usize)| {
        let [dx, dy] = [0, 1].map(|k| centres[j][k] - centres[i][k]);
        let gap = (dx * dx + dy * dy).sqrt() - radii[i] - radii[j];
        let [a, b] = [i, j].map(|disc| usize::from(specimen.groups[disc].0));
        let apart = clump[i].is_none() || clump[i] != clump[j];
        apart.then_some(Contact { ends: [i, j], groups: [a.min(b), a.max(b)], gap })
    };
    heap.pairs(margin).into_iter().filter_map(contact).collect()
}
