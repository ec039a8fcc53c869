//! Books of energy: what a run stores, spends and is given.

use super::{Books, Engine};
use crate::law::{BOUNDARY, BROKEN, DASHPOT, LEDGER, SLIP};
use crate::measure::{Energy, stored};
use crate::space::Space;

impl<S: Space> Engine<S> {
    /// Begins to keep the books of energy, which takes time in every step (`cargo bench --bench engine -- books`); see [`crate::measure::energy`].
    ///
    /// Changes between runs (radii, tables, bonds, prescribed velocities) are not booked: begin anew after one.
    pub fn keep_books(&mut self) {
        let now = stored(self);
        let initial = now.kinetic + now.spring + now.bond + now.potential;
        self.books = Some(Books { initial, ..Books::default() });
        self.domains.iter_mut().for_each(super::domain::Domain::open_books);
    }

    /// Energy now; spent and given energy since the books were opened.
    pub(crate) fn account(&self) -> Energy {
        let mut energy = stored(self);
        let Some(books) = self.books else { return energy };
        let (contacts, bodies) = self.spent();
        let contact = |row: usize| books.contacts[row] + contacts[row];
        energy.slip = contact(SLIP);
        energy.dashpot = contact(DASHPOT);
        energy.broken = contact(BROKEN);
        energy.damping = books.bodies[0] + bodies[0];
        energy.boundary = contact(BOUNDARY) + books.bodies[1] + bodies[1];
        energy.initial = books.initial;
        energy
    }

    /// Spent since the ledgers were opened, in the order of the list and of the bodies.
    fn spent(&self) -> ([f64; LEDGER], [f64; 2]) {
        let mut contacts = [0.0; LEDGER];
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

    /// Takes the ledgers into the books before the list is written anew.
    pub(super) fn close_ledgers(&mut self) {
        if self.books.is_none() {
            return;
        }
        let (contacts, bodies) = self.spent();
        if let Some(books) = &mut self.books {
            books.contacts.iter_mut().zip(contacts).for_each(|(sum, x)| *sum += x);
            books.bodies.iter_mut().zip(bodies).for_each(|(sum, x)| *sum += x);
        }
    }
}
