//! A specimen and a run on it as other programs want them: discs, groups, contacts.

use crate::artifact::Artifact;
use dem::genesis::heap::Heap;
use dem::genesis::specimen::Specimen;

/// Words of the groups of contacts, by number.
pub(super) const GROUPS: [&str; 3] = ["mortar", "interface", "aggregate"];

/// A contact of the packing as it stands, free of force.
pub(super) struct Contact {
    /// The two discs, from 0.
    pub(super) ends: [usize; 2],
    /// Place in [`GROUPS`].
    pub(super) group: usize,
    /// Distance of the surfaces, m; negative where they overlap.
    pub(super) gap: f64,
}

/// The contacts of the discs that are nearer than `margin` (m) and not of one clump, in the order of their ends.
pub(super) fn contacts(specimen: &Specimen, margin: f64) -> Vec<Contact> {
    let (centres, radii) = (&specimen.centres, &specimen.radii);
    let heap = Heap::<dem::D2> { region: specimen.region, centres: centres.clone(), radii: radii.clone() };
    let clump = specimen.clump_of_balls();
    let contact = |(i, j): (usize, usize)| {
        let [dx, dy] = [0, 1].map(|k| centres[j][k] - centres[i][k]);
        let gap = (dx * dx + dy * dy).sqrt() - radii[i] - radii[j];
        let group = usize::from(clump[i].is_some()) + usize::from(clump[j].is_some());
        let apart = clump[i].is_none() || clump[i] != clump[j];
        apart.then_some(Contact { ends: [i, j], group, gap })
    };
    heap.pairs(margin).into_iter().filter_map(contact).collect()
}

/// The column of a table of an artifact, or what is missing.
pub(super) fn column(artifact: &Artifact, table: &str, name: &str) -> Result<Vec<f64>, String> {
    let found = artifact.table(table).and_then(|table| table.reals(name));
    found.ok_or_else(|| format!("the result holds no column `{name}` in a table `{table}`"))
}
