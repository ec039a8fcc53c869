//! The loop that every loading test shares: advance, sample, note cracks and snapshots, stop after the peak.
//!
//! Samples are taken every `sample_strain` of axial strain. The run stops when the stress has fallen to `stop_fraction`
//! of the largest one so far and stays below it for a while (`lasting`), armed only after the largest has passed the
//! seating stress; when the test itself ends it; or at the strain limit or the bound on steps, which are
//! failures, as are faults of the engine. Failures are data: the record up to that point is stored.
//!
//! The watcher is asked after at most some hundredths of a second of work, however long a sample takes.

use super::crack::{CrackEvent, note_cracks};
use super::curve::{Sample, peak};
use super::pace::Governor;
use super::settings::{Rule, Schedule};
use super::snapshot::{Ladder, Snapshot, State};
use crate::measure::{Energy, energy, links};
use crate::{Engine, Failure, Space, Watch};
use math::text::{Amount, Number};

/// Why a test has no complete result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TestFailure {
    /// Nothing broke it.
    #[error(
        "no peak up to a strain of {}: the largest stress is {}; raise strain_limit, or check the strengths of the bonds",
        Number(*.strain_limit), Amount(*.stress, "Pa")
    )]
    NoPeak {
        /// Strain limit.
        strain_limit: f64,
        /// Largest stress (Pa).
        stress: f64,
    },
    /// The bound on steps was reached.
    #[error(
        "no end within max_steps = {steps}: the strain is {} and the largest stress {}; load faster or raise max_steps",
        Number(*.strain), Amount(*.stress, "Pa")
    )]
    OutOfSteps {
        /// Bound on steps.
        steps: u64,
        /// Strain reached.
        strain: f64,
        /// Largest stress (Pa).
        stress: f64,
    },
    /// The side walls did not come to their stress.
    #[error(
        "the confining stress of {} was not reached within {steps} steps: it is off by {} of it, the unbalanced ratio {}; check the packing or lower the stress",
        Amount(*.wanted, "Pa"), Number(*.off), Number(*.ratio)
    )]
    Confinement {
        /// Confining stress asked for (Pa).
        wanted: f64,
        /// Largest relative deviation of a wall.
        off: f64,
        /// Unbalanced ratio.
        ratio: f64,
        /// Steps made.
        steps: u64,
    },
    /// The engine gave up.
    #[error("{0}")]
    Engine(#[from] Failure),
}

/// All that a loading test leaves.
#[derive(Clone, Debug)]
pub struct Run<S: Space> {
    /// Every sample.
    pub samples: Vec<Sample>,
    /// Every crack, in the order of breaking.
    pub cracks: Vec<CrackEvent<S>>,
    /// Closed contacts on each fissure at the start, in the order in which they are [placed](super::fissure::placed).
    pub on_fissures: Vec<usize>,
    /// States at the wanted shares of the peak, and the last.
    pub snapshots: Vec<Snapshot<S>>,
    /// Energies at some axial strains, from the start of loading on.
    pub energies: Vec<(f64, Energy)>,
    /// What else the test read at its largest stress.
    pub at_peak: Reading,
    /// Why it is not complete, if so.
    pub failure: Option<TestFailure>,
    /// Whether the watcher stopped it.
    pub interrupted: bool,
    /// Steps made.
    pub steps: u64,
    /// First time step (s).
    pub time_step: f64,
}

/// What a test reads at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Axial strain.
    pub axial: f64,
    /// Lateral strain.
    pub lateral: f64,
    /// Stress (Pa).
    pub stress: f64,
    /// Confining stress (Pa); 0 without one.
    pub confinement: f64,
    /// Difference of the two platen forces over their mean.
    pub asymmetry: f64,
}

/// A test under way: how it is read, and when it is done besides the common rule.
pub trait Bench<S: Space> {
    /// Moves what follows the piece; asked before each sample.
    fn follow(&mut self, _engine: &mut Engine<S>) {}

    /// Reads the engine.
    fn read(&self, engine: &Engine<S>) -> Reading;

    /// Whether the piece is broken beyond doubt, given the cracks so far and the stress over the largest one.
    fn done(&mut self, _cracks: &[CrackEvent<S>], _share: f64) -> bool {
        false
    }
}

/// A test that is a reading and nothing else.
impl<S: Space, F: Fn(&Engine<S>) -> Reading> Bench<S> for F {
    fn read(&self, engine: &Engine<S>) -> Reading {
        self(engine)
    }
}

/// Samples between two readings of the energies.
const ENERGY_EVERY: usize = 25;
/// Contacts and bodies moved between two questions to the watcher: some hundredths of a second.
const SLICE: u64 = 4_000_000;

/// Steps between two questions to the watcher.
pub(super) fn slice<S: Space>(engine: &Engine<S>) -> u64 {
    (SLICE / (engine.contacts().count() + engine.particle_count()).max(1) as u64).max(1)
}

/// A run under way.
struct Drive<'a, S: Space> {
    rule: &'a Rule,
    schedule: &'a Schedule,
    run: Run<S>,
    governor: Option<Governor>,
    ladder: Ladder<S>,
    largest: f64,
    /// Strain at which the stress fell below the stop fraction, if it is below.
    fell: Option<f64>,
    slice: u64,
    last_step: u64,
}

/// Loads until the rule or the test itself ends it; `watch` sees every sample and may interrupt. Between samples that
/// take long it is shown the last one again.
pub fn drive<S: Space>(
    engine: &mut Engine<S>,
    schedule: &Schedule,
    rule: &Rule,
    bench: &mut impl Bench<S>,
    watch: &mut dyn FnMut(&Sample) -> Watch,
) -> Run<S> {
    let run = Run {
        samples: vec![Sample { speed: schedule.speed, ..Sample::default() }],
        cracks: Vec::new(),
        on_fissures: engine.fractures().map(|(_, closed)| closed).collect(),
        snapshots: Vec::new(),
        energies: Vec::new(),
        at_peak: Reading::default(),
        failure: None,
        interrupted: false,
        steps: 0,
        time_step: engine.time_step(),
    };
    let last_step = engine.steps().saturating_add(rule.max_steps);
    let (ladder, slice) = (Ladder::default(), slice(engine));
    let governor = Governor::new(engine, schedule);
    let mut drive = Drive { rule, schedule, run, governor, ladder, largest: 0.0, fell: None, slice, last_step };
    engine.track_energy();
    while drive.sample(engine, bench, watch) {}
    drive.finish(engine)
}

impl<S: Space> Drive<'_, S> {
    /// One sample; returns whether to go on.
    fn sample(
        &mut self,
        engine: &mut Engine<S>,
        bench: &mut impl Bench<S>,
        watch: &mut dyn FnMut(&Sample) -> Watch,
    ) -> bool {
        let last = self.run.samples[self.run.samples.len() - 1];
        let before = (engine.steps(), last.axial);
        bench.follow(engine);
        let outcome = self.advance(engine, &last, watch);
        let reading = bench.read(engine);
        let Reading { axial, lateral, stress, .. } = reading;
        let speed = self.schedule.speed * self.factor();
        let sample = Sample { axial, lateral, stress, cracks: engine.cracks().len(), speed };
        note_cracks(engine, &mut self.run.cracks, before, sample.axial);
        if let Err(failure) = outcome {
            self.run.failure = Some(failure.into());
            return false;
        }
        self.run.samples.push(sample);
        self.ladder.offer(&sample, || state(engine, self.rule));
        if stress > self.largest {
            self.run.at_peak = reading;
        }
        self.largest = self.largest.max(stress);
        if self.run.samples.len().is_multiple_of(ENERGY_EVERY) {
            self.run.energies.push((axial, energy(engine)));
        }
        if self.run.interrupted || !engine.heed(watch(&sample)) {
            self.run.interrupted = true;
            return false;
        }
        if self.fallen(&sample) || bench.done(&self.run.cracks, stress / self.largest) {
            return false;
        }
        let share = if self.largest > 0.0 { stress / self.largest } else { 1.0 };
        let paced = self.governor.as_mut().map_or(Ok(()), |governor| governor.look(engine, axial, share));
        debug_assert!(paced.is_ok(), "a governor asks for factors and dampings that an engine takes: {paced:?}");
        self.run.failure = self.given_up(engine, axial);
        self.run.failure.is_none()
    }

    /// Speed now over that of the schedule.
    fn factor(&self) -> f64 {
        self.governor.as_ref().map_or(1.0, Governor::factor)
    }

    /// Makes the steps of a sample, in slices between which the watcher is asked.
    fn advance(
        &mut self,
        engine: &mut Engine<S>,
        last: &Sample,
        watch: &mut dyn FnMut(&Sample) -> Watch,
    ) -> Result<(), Failure> {
        let rate = self.schedule.rate * self.factor();
        let every = (self.schedule.sample_strain / (rate * engine.time_step())).max(1.0) as u64;
        let mut left = every.min(self.last_step - engine.steps());
        while left > 0 {
            let now = left.min(self.slice);
            engine.advance(now)?;
            left -= now;
            if left > 0 && !engine.heed(watch(last)) {
                self.run.interrupted = true;
                break;
            }
        }
        Ok(())
    }

    /// Whether the stress has fallen for good.
    fn fallen(&mut self, sample: &Sample) -> bool {
        let rule = self.rule;
        if !(self.largest > self.schedule.seating && sample.stress <= rule.stop_fraction * self.largest) {
            self.fell = None;
            return false;
        }
        let fell = *self.fell.get_or_insert(sample.axial);
        sample.axial - fell >= rule.lasting * self.run.at_peak.axial
    }

    /// Why the test is given up, if it is.
    fn given_up(&self, engine: &Engine<S>, strain: f64) -> Option<TestFailure> {
        let (strain_limit, stress) = (self.schedule.strain_limit, self.largest);
        if strain >= strain_limit {
            return Some(TestFailure::NoPeak { strain_limit, stress });
        }
        let steps = self.rule.max_steps;
        (engine.steps() >= self.last_step).then_some(TestFailure::OutOfSteps { steps, strain, stress })
    }

    fn finish(self, engine: &Engine<S>) -> Run<S> {
        let Self { rule, mut run, ladder, .. } = self;
        run.steps = engine.steps();
        let top = peak(&run.samples).map_or(0.0, |k| run.samples[k].stress);
        let last = run.samples[run.samples.len() - 1];
        run.energies.push((last.axial, energy(engine)));
        run.snapshots = ladder.keep(top, &rule.snapshots, Snapshot::new(&last, state(engine, rule)));
        run
    }
}

/// What a snapshot stores of the engine.
fn state<S: Space>(engine: &Engine<S>, rule: &Rule) -> State<S> {
    State {
        centres: (0..engine.particle_count()).map(|i| engine.position(i)).collect(),
        forces: if rule.forces { links(engine) } else { Vec::new() },
    }
}
