//! The energy balance of a run: what is stored, dissipated and supplied.

use super::{EnergySums, Engine};
use crate::law::{BOUNDARY, BROKEN, DASHPOT, ENERGIES, SLIP};
use crate::measure::{Energy, stored};
use crate::space::Space;

/// Energy sums and open accounts in the order of the list and of the bodies, which no number of threads changes.
pub(super) struct Accounts {
    sums: EnergySums,
    contacts: Vec<[f64; ENERGIES]>,
    bodies: Vec<[f64; 2]>,
    clumps: Vec<f64>,
}

impl<S: Space> Engine<S> {
    /// Begins to track the energy, which takes time in every step (`cargo bench --bench engine -- energy`); see [`crate::measure::energy`].
    ///
    /// Changes between runs (radii, tables, bonds, prescribed velocities) are not booked: begin anew after one.
    pub fn track_energy(&mut self) {
        let now = stored(self);
        let initial = now.kinetic + now.spring + now.bond + now.potential;
        self.energy_sums = Some(EnergySums { initial, ..EnergySums::default() });
        self.domains.iter_mut().for_each(super::domain::Domain::track_energy);
    }

    /// Energy now; spent and given energy since tracking began.
    pub(crate) fn account(&self) -> Energy {
        let mut energy = stored(self);
        let Some(sums) = self.energy_sums else { return energy };
        let (contacts, bodies) = self.spent();
        let contact = |row: usize| sums.contacts[row] + contacts[row];
        energy.slip = contact(SLIP);
        energy.dashpot = contact(DASHPOT);
        energy.broken = contact(BROKEN);
        energy.damping = sums.bodies[0] + bodies[0];
        energy.boundary = contact(BOUNDARY) + sums.bodies[1] + bodies[1];
        energy.initial = sums.initial;
        energy
    }

    /// Spent since the accounts were opened, in the order of the list and of the bodies.
    fn spent(&self) -> ([f64; ENERGIES], [f64; 2]) {
        let mut contacts = [0.0; ENERGIES];
        for (section, own) in self.stretches() {
            for (row, sum) in contacts.iter_mut().enumerate() {
                section.add_spent(row, own.clone(), sum);
            }
        }
        let mut bodies = [0.0; 2];
        for domain in &self.domains {
            for [damping, boundary] in &domain.spent {
                bodies[0] += damping;
                bodies[1] += boundary;
            }
        }
        let clumps: f64 = self.domains.iter().flat_map(|d| &d.clump_spent).sum();
        bodies[0] += clumps;
        (contacts, bodies)
    }

    /// What is in the open accounts, when a run tracks its energy.
    pub(super) fn accounts(&self) -> Option<Accounts> {
        let sums = self.energy_sums?;
        let contacts = self.stretches().flat_map(|(section, own)| own.map(|c| section.spent(c))).collect();
        let bodies = self.domains.iter().flat_map(|domain| domain.spent.iter().copied()).collect();
        let clumps = self.domains.iter().flat_map(|domain| domain.clump_spent.iter().copied()).collect();
        Some(Accounts { sums, contacts, bodies, clumps })
    }

    /// Puts back the sums and accounts after the same contacts and bodies were dealt anew: the sums keep their order, and
    /// with it their bits.
    pub(super) fn reopen(&mut self, accounts: Accounts) {
        self.energy_sums = Some(accounts.sums);
        let mut sections: Vec<_> = self.domains.iter_mut().flat_map(|domain| domain.sections.iter_mut()).collect();
        sections.sort_by_key(|section| section.rank);
        let mut contacts = accounts.contacts.into_iter();
        for section in sections {
            for c in section.own_from..section.count {
                let Some(spent) = contacts.next() else { panic!("BUG: a contact came while the list was dealt anew") };
                section.set_spent(c, spent);
            }
        }
        let (mut bodies, mut clumps) = (accounts.bodies.into_iter(), accounts.clumps.into_iter());
        for domain in &mut self.domains {
            domain.spent.iter_mut().zip(&mut bodies).for_each(|(own, spent)| *own = spent);
            domain.clump_spent.iter_mut().zip(&mut clumps).for_each(|(own, spent)| *own = spent);
        }
    }

    /// Takes the accounts into the sums before the list is written anew.
    pub(super) fn close_accounts(&mut self) {
        if self.energy_sums.is_none() {
            return;
        }
        let (contacts, bodies) = self.spent();
        if let Some(sums) = &mut self.energy_sums {
            sums.contacts.iter_mut().zip(contacts).for_each(|(sum, x)| *sum += x);
            sums.bodies.iter_mut().zip(bodies).for_each(|(sum, x)| *sum += x);
        }
    }
}
