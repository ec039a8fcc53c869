//! A specimen and a run on it as other programs want them: balls (discs in the plane, spheres in space), groups, contacts.

use dem::Space;
use dem::genesis::heap::{Heap, Still};
use dem::genesis::specimen::Specimen;
use dem::space::Tuple;

/// A contact of the packing as it stands, free of force.
pub(super) struct Contact {
    /// The two balls, from 0.
    pub(super) ends: [usize; 2],
    /// Indices of the two balls' groups, the smaller first.
    pub(super) groups: [usize; 2],
    /// Distance of the surfaces, m; negative where they overlap.
    pub(super) gap: f64,
}

/// The contacts of the balls that are nearer than `margin` (m) and not of one clump, in the order of their ends.
pub(super) fn contacts<S: Space>(specimen: &Specimen<S>, margin: f64) -> Vec<Contact> {
    let (centres, radii) = (&specimen.centres, &specimen.radii);
    let still = Still::default();
    let heap = Heap::<S> { region: specimen.region, centres: centres.clone(), radii: radii.clone(), still };
    let clump = specimen.clump_of_balls();
    let contact = |(i, j): (usize, usize)| {
        let gap = centres[j].minus(centres[i]).norm() - radii[i] - radii[j];
        let [a, b] = [i, j].map(|ball| usize::from(specimen.groups[ball].0));
        let apart = clump[i].is_none() || clump[i] != clump[j];
        apart.then_some(Contact { ends: [i, j], groups: [a.min(b), a.max(b)], gap })
    };
    heap.pairs(margin).into_iter().filter_map(contact).collect()
}
