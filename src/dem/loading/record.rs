//! The record of a test: what it leaves, and whether it is valid.

use super::curve::{Macro, Sample};
use super::drive::{Run, TestFailure};
use super::judgement::Judgement;
use super::validity::{Check, Reason};
use crate::{Failure, Space, Watch};

/// Sees every sample, and between them the last one again; may interrupt.
pub type Watcher<'a> = &'a mut dyn FnMut(&Sample) -> Watch;

/// The record of a test.
#[derive(Clone, Debug)]
pub struct TestRecord<S: Space> {
    /// Samples, cracks, snapshots, failure.
    pub run: Run<S>,
    /// Peak, moduli, Poisson's ratios.
    pub values: Macro,
    /// Numbers by which the run is judged.
    pub judgement: Judgement,
    /// Whether the specimen failed as the test supposes.
    pub checks: Vec<Check>,
}

impl<S: Space> TestRecord<S> {
    /// Puts a record together: the test's own `checks`, those that its failure adds, and those on its speed and size.
    pub(super) fn new(run: Run<S>, values: Macro, judgement: Judgement, own: Vec<Check>) -> Self {
        let mut checks: Vec<Check> = run.failure.map(failed).into_iter().collect();
        checks.extend(own);
        checks.extend(judgement.checks());
        Self { run, values, judgement, checks }
    }

    /// Checks that are not met and make the run invalid.
    pub fn invalid(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| !check.met && check.reason.invalidates())
    }

    /// Why the run is not valid, in words; empty when it is.
    pub fn validity(&self) -> String {
        self.invalid().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    }
}

/// The check that a failure does not meet.
fn failed(failure: TestFailure) -> Check {
    let (reason, value, bound) = match failure {
        TestFailure::NoPeak { stress, .. } => (Reason::NoPeak, stress, f64::INFINITY),
        TestFailure::OutOfSteps { steps, .. } => (Reason::OutOfSteps, steps as f64, steps as f64),
        TestFailure::Confinement { off, .. } => (Reason::Confinement, off, super::confined::TOLERANCE),
        TestFailure::Engine(failure) => (Reason::EngineFailure, step_of(&failure) as f64, f64::INFINITY),
    };
    Check { reason, value, bound, met: false }
}

fn step_of(failure: &Failure) -> u64 {
    match *failure {
        Failure::Instability { step, .. } | Failure::NotFinite { step, .. } | Failure::Escape { step, .. } => step,
    }
}
