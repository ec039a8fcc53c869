//! Books of energy: what a run stores, spends and is given.

use super::{Books, Engine};
use crate::law::{BOUNDARY, BROKEN, DASHPOT, LEDGER, SLIP};
use crate::measure::{Energy, stored};
use crate::space::Space;

/// The books and the open ledgers in the order of the list and of the bodies, which no number of threads changes.
pub(super) struct Ledgers {
    books: Books,
    contacts: Vec<[f64; LEDGER]>,
    bodies: Vec<[f64; 2]>,
    clumps: Vec<f64>,
}

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

    /// What is in the open ledgers, when a run keeps the books.
    pub(super) fn ledgers(&self) -> Option<Ledgers> {
        let books = self.books?;
        let contacts = self.stretches().flat_map(|(section, own)| own.map(|c| section.spent(c))).collect();
        let bodies = self.domains.iter().flat_map(|domain| domain.spent.iter().copied()).collect();
        let clumps = self.domains.iter().flat_map(|domain| domain.clump_spent.iter().copied()).collect();
        Some(Ledgers { books, contacts, bodies, clumps })
    }

    /// Puts back the books and ledgers after the same contacts and bodies were dealt anew: the sums keep their order, and
    /// with it their bits.
    pub(super) fn reopen(&mut self, ledgers: Ledgers) {
        self.books = Some(ledgers.books);
        let mut sections: Vec<_> = self.domains.iter_mut().flat_map(|domain| domain.sections.iter_mut()).collect();
        sections.sort_by_key(|section| section.rank);
        let mut contacts = ledgers.contacts.into_iter();
        for section in sections {
            for c in section.own_from..section.count {
                let Some(spent) = contacts.next() else { panic!("BUG: a contact came while the list was dealt anew") };
                section.book(c, spent);
            }
        }
        let (mut bodies, mut clumps) = (ledgers.bodies.into_iter(), ledgers.clumps.into_iter());
        for domain in &mut self.domains {
            domain.spent.iter_mut().zip(&mut bodies).for_each(|(own, spent)| *own = spent);
            domain.clump_spent.iter_mut().zip(&mut clumps).for_each(|(own, spent)| *own = spent);
        }
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
