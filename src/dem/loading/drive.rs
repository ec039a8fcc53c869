//! The loop that every loading test shares: advance, sample, note cracks and snapshots, stop after the peak.
//!
//! Samples are taken every `sample_strain` of axial strain. The run stops when the stress has fallen to `stop_fraction`
//! of the largest one so far, armed only after that has passed `seating_stress`; or at `strain_limit`, which is a
//! failure ("no peak"), as is whatever the engine reports. Failures are data: the record up to that point is kept.

use super::crack::{CrackEvent, note_cracks};
use super::curve::{Macro, Sample, peak};
use super::judgement::Judgement;
use super::material::Material;
use super::rig::Machine;
use super::snapshot::{Ladder, Snapshot, State};
use crate::genesis::specimen::Specimen;
use crate::measure::{Energy, energy, links};
use crate::{D2, Engine, Failure, Fault, Faults, Watch};
use serde::{Deserialize, Serialize};

/// Kinds of test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TestKind {
    /// Compression of a rectangle between two platens.
    Uniaxial,
    /// Splitting of a disc between two platens.
    Brazilian,
    /// Direct tension of a rectangle by grips.
    Tension,
}

/// Settings of a loading test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loading {
    /// Which test.
    pub kind: TestKind,
    /// Speed of each platen or grip (m/s).
    pub speed: f64,
    /// Friction of the platens.
    pub platen_friction: f64,
    /// Damping, masses, time step.
    pub machine: Machine,
    /// Sampling and stopping.
    pub rule: Rule,
}

impl Loading {
    /// The published test: 0.02 m/s each, frictionless platens.
    pub fn new(kind: TestKind) -> Self {
        Self { kind, speed: 0.02, platen_friction: 0.0, machine: Machine::default(), rule: Rule::default() }
    }

    /// What is wrong with speed, sampling and stopping; the engine checks the rest.
    fn faults(&self) -> Vec<Fault> {
        let rule = &self.rule;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let share = |x: f64| x > 0.0 && x <= 1.0;
        let rules = [
            ("speed of the test", self.speed, positive(self.speed), "a number above 0"),
            ("strain between samples", rule.sample_strain, positive(rule.sample_strain), "a number above 0"),
            ("share of the peak at the end", rule.stop_fraction, share(rule.stop_fraction), "in (0, 1]"),
            ("seating stress", rule.seating_stress, rule.seating_stress >= 0.0, "0 or more"),
            ("strain limit", rule.strain_limit, positive(rule.strain_limit), "a number above 0"),
        ];
        let snapshots = rule.snapshots.iter().map(|&x| ("share of the peak of a snapshot", x, share(x), "in (0, 1]"));
        let bad = rules.into_iter().chain(snapshots).filter(|rule| !rule.2);
        bad.map(|(quantity, value, _, wanted)| Fault::Setting { quantity, value, wanted }).collect()
    }

    /// Mounts the specimen and runs the test to its end. `seed` draws bond strengths where they scatter; `watch` sees every
    /// sample and may interrupt.
    ///
    /// # Errors
    /// All faults of the settings, an outline of the specimen that does not fit the test, or what the engine finds wrong.
    pub fn run(
        &self,
        specimen: &Specimen,
        material: &Material,
        seed: u64,
        watch: &mut dyn FnMut(&Sample) -> Watch,
    ) -> Result<TestRecord, TestError> {
        let faults = self.faults();
        if !faults.is_empty() {
            return Err(Faults(faults).into());
        }
        match self.kind {
            TestKind::Uniaxial => super::uniaxial::run(self, specimen, material, seed, watch),
            TestKind::Brazilian => super::brazilian::run(self, specimen, material, seed, watch),
            TestKind::Tension => super::tension::run(self, specimen, material, seed, watch),
        }
    }
}

/// A test that cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestError {
    /// Wrong outline.
    #[error("the {test} test needs a {wanted}; give the specimen {remedy}")]
    Outline {
        /// Which test.
        test: &'static str,
        /// Outline that it needs.
        wanted: &'static str,
        /// Settings that make it.
        remedy: &'static str,
    },
    /// Faults of the settings, or those that the engine finds.
    #[error(transparent)]
    Faults(#[from] Faults),
}

/// The record of a test.
#[derive(Clone, Debug)]
pub struct TestRecord {
    /// Samples, cracks, snapshots, failure.
    pub run: Run,
    /// Peak, moduli, Poisson's ratios.
    pub values: Macro,
    /// Numbers by which the run is judged.
    pub judgement: Judgement,
    /// Whether the specimen failed as the test supposes.
    pub checks: Vec<Check>,
}

/// A number that must stay within a bound for the test to be valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// What it is.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// Its bound.
    pub bound: f64,
    /// Whether it is within.
    pub met: bool,
}

/// When to sample and when to stop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// Strain between two samples.
    pub sample_strain: f64,
    /// Share of the peak at which the test ends.
    pub stop_fraction: f64,
    /// Stress (Pa) that must be passed before the test may end.
    pub seating_stress: f64,
    /// Strain at which a test without a peak is given up.
    pub strain_limit: f64,
    /// Shares of the peak at which the state is kept, besides the last state.
    pub snapshots: Vec<f64>,
    /// Whether the forces between the discs are kept with each of these states.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub forces: bool,
}

impl Default for Rule {
    fn default() -> Self {
        let snapshots = vec![0.5, 0.8, 1.0];
        Self {
            sample_strain: 2e-6,
            stop_fraction: 0.75,
            seating_stress: 5e5,
            strain_limit: 0.02,
            snapshots,
            forces: false,
        }
    }
}

/// Why a test has no complete result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TestFailure {
    /// Nothing broke it.
    #[error(
        "no peak up to a strain of {strain_limit}: the largest stress is {stress:.4e} Pa; raise the strain limit or check the strengths"
    )]
    NoPeak {
        /// Strain limit.
        strain_limit: f64,
        /// Largest stress (Pa).
        stress: f64,
    },
    /// The engine gave up.
    #[error("{0}")]
    Engine(#[from] Failure),
}

/// All that a loading test leaves.
#[derive(Clone, Debug)]
pub struct Run {
    /// Every sample.
    pub samples: Vec<Sample>,
    /// Every crack, in the order of breaking.
    pub cracks: Vec<CrackEvent>,
    /// States kept.
    pub snapshots: Vec<Snapshot>,
    /// Energies at some axial strains, from the start of loading on.
    pub energies: Vec<(f64, Energy)>,
    /// Why it is not complete, if so.
    pub failure: Option<TestFailure>,
    /// Whether the watcher stopped it.
    pub interrupted: bool,
    /// Steps made.
    pub steps: u64,
    /// First time step (s).
    pub time_step: f64,
}

/// Samples between two readings of the energies.
const ENERGY_EVERY: usize = 25;

/// Loads until the rule ends the test. `rate` is the strain rate at the start (1/s), `measure` reads axial strain,
/// lateral strain and stress; `watch` sees every sample and may interrupt.
pub fn drive(
    engine: &mut Engine<D2>,
    rate: f64,
    rule: &Rule,
    measure: impl Fn(&Engine<D2>) -> [f64; 3],
    watch: &mut dyn FnMut(&Sample) -> Watch,
) -> Run {
    let mut run = Run {
        samples: vec![Sample::default()],
        cracks: Vec::new(),
        snapshots: Vec::new(),
        energies: Vec::new(),
        failure: None,
        interrupted: false,
        steps: 0,
        time_step: engine.time_step(),
    };
    let mut ladder = Ladder::default();
    let mut largest = 0.0_f64;
    engine.keep_books();
    loop {
        let before = (engine.steps(), run.samples[run.samples.len() - 1].axial);
        let every = (rule.sample_strain / (rate * engine.time_step())).max(1.0) as u64;
        let outcome = engine.advance(every);
        let [axial, lateral, stress] = measure(engine);
        let sample = Sample { axial, lateral, stress, cracks: engine.cracks().len() };
        note_cracks(engine, &mut run.cracks, before, sample.axial);
        if let Err(failure) = outcome {
            run.failure = Some(failure.into());
            break;
        }
        run.samples.push(sample);
        ladder.offer(&sample, || state(engine, rule));
        largest = largest.max(stress);
        if run.samples.len().is_multiple_of(ENERGY_EVERY) {
            run.energies.push((axial, energy(engine)));
        }
        if !engine.heed(watch(&sample)) {
            run.interrupted = true;
            break;
        }
        if largest > rule.seating_stress && stress <= rule.stop_fraction * largest {
            break;
        }
        if axial >= rule.strain_limit {
            run.failure = Some(TestFailure::NoPeak { strain_limit: rule.strain_limit, stress: largest });
            break;
        }
    }
    run.steps = engine.steps();
    let top = peak(&run.samples).map_or(0.0, |k| run.samples[k].stress);
    let last = run.samples[run.samples.len() - 1];
    run.energies.push((last.axial, energy(engine)));
    run.snapshots = ladder.keep(top, &rule.snapshots, Snapshot::new(&last, state(engine, rule)));
    run
}

/// What a snapshot keeps of the engine.
fn state(engine: &Engine<D2>, rule: &Rule) -> State {
    State {
        centres: (0..engine.particle_count()).map(|i| engine.position(i)).collect(),
        forces: if rule.forces { links(engine) } else { Vec::new() },
    }
}
