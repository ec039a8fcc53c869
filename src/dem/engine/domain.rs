//! One thread's share of the bodies: a stretch of the engine's order, with every contact that touches it.
//!
//! A contact across two stretches is computed by both, with the same bits. Each particle sums its contacts in the order
//! of the list, so the number of stretches does not change a sum.

use super::Engine;
use super::list::Found;
use crate::contact::{Break, Section};
use crate::simd::Table;
use crate::space::Space;
use std::ops::Range;

/// A stretch of bodies and what is needed to move it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Domain {
    /// Its particles.
    pub(crate) particles: Range<usize>,
    /// Its clumps.
    pub(crate) clumps: Range<usize>,
    /// Runs of particles that belong to no clump.
    pub(crate) singles: Vec<Range<usize>>,
    /// Contacts that touch it.
    pub(crate) sections: Vec<Section>,
    /// Loads on all particles; only the own ones are complete.
    pub(crate) loads: Table,
    /// Bonds that broke, with the step; the owner of its first particle stores it.
    pub(crate) breaks: Vec<(u64, Break)>,
    /// Work of local damping and of prescribed motion on each particle, J; empty unless a run tracks its energy.
    pub(crate) spent: Vec<[f64; 2]>,
    /// The same for its clumps.
    pub(crate) clump_spent: Vec<f64>,
}

impl Domain {
    /// Begins to track the energy.
    pub(super) fn track_energy(&mut self) {
        self.sections.iter_mut().for_each(Section::open_ledger);
        self.spent = vec![[0.0; 2]; self.particles.len()];
        self.clump_spent = vec![0.0; self.clumps.len()];
    }
}

/// Fewer particles than this are not worth another thread.
const SMALLEST: usize = 64;

impl<S: Space> Engine<S> {
    /// The stretches between `cuts`, without contacts; `loads` are tables that may be used again.
    pub(super) fn divide(&self, cuts: &[usize], mut loads: Vec<Table>) -> Vec<Domain> {
        let rows = (self.caller.len() + 2) * S::LOADS;
        loads.retain(|table| table.len() == rows);
        let stretch = |cut: &[usize]| {
            let particles = cut[0]..cut[1];
            let mut loads = loads.pop().unwrap_or_else(|| Table::new(rows));
            loads.fill(crate::simd::Quad::default());
            let clumps = self.clumps.partition_point(|c| c.pebbles.start < cut[0])
                ..self.clumps.partition_point(|c| c.pebbles.start < cut[1]);
            Domain { singles: self.singles(&particles, &clumps), particles, clumps, loads, ..Domain::default() }
        };
        cuts.windows(2).map(stretch).collect()
    }

    /// Where stretches of about equal work begin, and the end of the last.
    pub(super) fn cuts(&self, found: &Found) -> Vec<usize> {
        let n = self.caller.len();
        let parts = self.threads.min(n / SMALLEST).max(1);
        // A contact costs about twice what moving a particle does.
        let mut work = vec![1_u32; n];
        for (rank, ends) in found {
            for [i, j] in ends {
                work[*i as usize] += 1;
                if !rank.at_wall {
                    work[*j as usize] += 1;
                }
            }
        }
        let total: u64 = work.iter().map(|&w| u64::from(w)).sum();
        let mut cuts = vec![0];
        let mut sum = 0;
        for p in 0..n {
            let next = total * cuts.len() as u64 / parts as u64;
            if sum >= next && cuts.len() < parts && self.begins_body(p) {
                cuts.push(p);
            }
            sum += u64::from(work[p]);
        }
        cuts.push(n);
        cuts
    }

    fn begins_body(&self, p: usize) -> bool {
        p == 0 || self.bodies[p] != self.bodies[p - 1]
    }

    fn singles(&self, particles: &Range<usize>, clumps: &Range<usize>) -> Vec<Range<usize>> {
        let mut runs = Vec::new();
        let mut start = particles.start;
        for clump in &self.clumps[clumps.clone()] {
            runs.push(start..clump.pebbles.start);
            start = clump.pebbles.end;
        }
        runs.push(start..particles.end);
        runs.retain(|run| !run.is_empty());
        runs
    }

    /// Sections that hold the contacts of one class (and wall), in the order of the list, with the own ones of each.
    pub(crate) fn stretches(&self) -> impl Iterator<Item = (&Section, Range<usize>)> + '_ {
        let mut found: Vec<_> = self.domains.iter().flat_map(|d| d.sections.iter()).collect();
        found.sort_by_key(|section| section.rank);
        found.into_iter().map(|section| (section, section.own_from..section.count))
    }

    /// Forces on the wall of a section, lane by lane, with `visit`.
    pub(super) fn visit_reactions(section: &Section, mut visit: impl FnMut([f64; 3])) {
        for c in 0..section.count {
            visit(section.reaction::<S>(c));
        }
    }
}
