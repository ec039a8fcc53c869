//! Settings of a loading test, and the numbers that they come to on one piece.

use super::kind::TestKind;
use super::pace::Pace;
use super::piece::Outline;
use super::rig::{Machine, Platens, Scales};
use super::speed::{Speed, Threshold};
use crate::{Fault, Faults};
use math::text::{Amount, Number};
use serde::{Deserialize, Serialize};

/// Settings of a loading test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loading {
    /// Which test.
    pub kind: TestKind,
    /// How fast.
    pub speed: Speed,
    /// Whether that speed is the only one, or the slow one of a test that adapts.
    #[serde(default, skip_serializing_if = "is_fixed")]
    pub pace: Pace,
    /// The platens.
    pub platens: Platens,
    /// What the kind of test needs besides.
    #[serde(default, skip_serializing_if = "Particulars::is_plain")]
    pub particulars: Particulars,
    /// Damping, masses, time step.
    pub machine: Machine,
    /// Sampling and stopping.
    pub rule: Rule,
}

/// What some kinds of test need besides. A setting that the kind has no use for is a fault.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Particulars {
    /// Brazilian: whole angle of the arc on which curved jaws touch the disc (rad); flat platens when not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jaw_angle: Option<f64>,
    /// Biaxial, triaxial: confining stress (Pa).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confinement: Option<f64>,
    /// Bending: distance of the supports (m); nine tenths of the length when not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span: Option<f64>,
    /// Bending: the notch, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notch: Option<Notch>,
}

/// A notch at the middle of the tension side of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Notch {
    /// Depth over the height of the beam.
    pub depth: f64,
    /// Width over the height of the beam.
    pub width: f64,
}

impl Particulars {
    fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// When to sample and when to stop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// Strain between two samples; shares are of the reference strain.
    pub sample_strain: Threshold,
    /// Share of the peak at which the test ends.
    pub stop_fraction: f64,
    /// Further strain, over the strain at the peak, for which the stress must stay below that share.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub lasting: f64,
    /// Stress that must be passed before the test may end; shares are of the reference stress.
    pub seating: Threshold,
    /// Strain at which a test without a peak is given up; shares are of the reference strain.
    pub strain_limit: Threshold,
    /// Steps after which a test is given up.
    pub max_steps: u64,
    /// Shares of the peak at which the state is stored, besides the last state.
    pub snapshots: Vec<f64>,
    /// Whether the forces between the balls are stored with each of these states.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub forces: bool,
}

fn is_fixed(pace: &Pace) -> bool {
    *pace == Pace::Fixed
}

fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

impl Default for Rule {
    fn default() -> Self {
        Self {
            sample_strain: Threshold::Share(2e-3),
            stop_fraction: 0.75,
            lasting: 0.0,
            seating: Threshold::Share(1e-2),
            strain_limit: Threshold::Share(20.0),
            max_steps: 20_000_000,
            snapshots: vec![0.5, 0.8, 1.0],
            forces: false,
        }
    }
}

/// Most samples that a test may ask for: what a record takes in memory is bounded by it.
pub const MOST_SAMPLES: f64 = 1e6;

impl Rule {
    /// The rule that suits a kind of test.
    pub fn of(kind: TestKind) -> Self {
        match kind {
            // The first contacts of a disc and its platens, or of a beam and its rollers, may fail long before the piece does.
            TestKind::Brazilian | TestKind::Bending => Self { lasting: 0.05, ..Self::default() },
            _ => Self::default(),
        }
    }
}

/// The numbers of a test on one piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Speed of each platen or grip (m/s); the slow one where it adapts.
    pub speed: f64,
    /// Whether it adapts.
    pub pace: Pace,
    /// Whether one crack through one section ends the test, or damage that is spread.
    pub localised: bool,
    /// Time that a wave takes through the height (s).
    pub transit: f64,
    /// Wave transits within the reference strain at that speed.
    pub transits: f64,
    /// Strain rate at the start (1/s).
    pub rate: f64,
    /// Strain between two samples.
    pub sample_strain: f64,
    /// Stress that must be passed before the test may end (Pa).
    pub seating: f64,
    /// Strain at which a test without a peak is given up.
    pub strain_limit: f64,
}

/// A test that cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TestError {
    /// Wrong outline.
    #[error("the {test} test needs a {wanted}, and the specimen is a {found}; give the specimen {remedy}")]
    Outline {
        /// Which test.
        test: &'static str,
        /// Outline that it needs.
        wanted: &'static str,
        /// Outline that it found.
        found: &'static str,
        /// Settings that make it.
        remedy: &'static str,
    },
    /// It would not end within the bound on steps.
    #[error(
        "at {} m/s the strain at which the bonds can be expected to fail, {}, takes {steps:.1e} steps of {time_step:.1e} s, above max_steps = {bound:.1e}; load faster or raise max_steps",
        Number(*.speed), Number(*.strain)
    )]
    TooLong {
        /// Speed of each platen (m/s).
        speed: f64,
        /// Reference strain.
        strain: f64,
        /// Steps that it takes.
        steps: f64,
        /// Time step (s).
        time_step: f64,
        /// Bound on steps.
        bound: f64,
    },
    /// Faults of the settings, or those that the engine finds.
    #[error(transparent)]
    Faults(#[from] Faults),
}

impl Loading {
    /// The test at 0.02 m/s, frictionless platens, with the rule that suits its kind.
    pub fn new(kind: TestKind) -> Self {
        Self {
            kind,
            speed: Speed::Each(0.02),
            pace: Pace::Fixed,
            platens: Platens::default(),
            particulars: Particulars::default(),
            machine: Machine::default(),
            rule: Rule::of(kind),
        }
    }

    /// What is wrong with speed, sampling and stopping, and what the kind of test has no use for; the engine checks the rest.
    pub fn faults(&self) -> Vec<Fault> {
        let rule = &self.rule;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let share = |x: f64| x > 0.0 && x <= 1.0;
        let above = "a number above 0";
        let [speed, sample, limit] = [self.speed.given(), rule.sample_strain.given(""), rule.strain_limit.given("")];
        let (seating, lasting, steps) = (rule.seating.given("Pa"), rule.lasting, rule.max_steps as f64);
        let stop = Amount::number(rule.stop_fraction);
        let rules = [
            ("speed of the test", speed, positive(speed.0), above),
            ("strain between samples", sample, positive(sample.0), above),
            ("share of the peak at the end", stop, share(stop.0), "in (0, 1]"),
            ("lasting", Amount::number(lasting), (0.0..=1.0).contains(&lasting), "a share of the peak strain, 0 to 1"),
            ("seating stress", seating, seating.0 >= 0.0 && seating.0.is_finite(), "0 or more"),
            ("strain limit", limit, positive(limit.0), above),
            ("largest number of steps", Amount::number(steps), steps >= 1.0, "1 or more"),
        ];
        let snapshot = |&x: &f64| ("share of the peak of a snapshot", Amount::number(x), share(x), "in (0, 1]");
        let snapshots = rule.snapshots.iter().map(snapshot);
        let own = self.particular_faults();
        let bad = rules.into_iter().chain(snapshots).chain(own).filter(|rule| !rule.2);
        bad.map(|(quantity, value, _, wanted)| Fault::Setting { quantity, value, wanted }).collect()
    }

    fn particular_faults(&self) -> Vec<(&'static str, Amount, bool, &'static str)> {
        let Particulars { jaw_angle, confinement, span, notch } = self.particulars;
        let confined = matches!(self.kind, TestKind::Biaxial | TestKind::Triaxial);
        let (disc, beam) = (self.kind == TestKind::Brazilian, self.kind == TestKind::Bending);
        let mut rules = Vec::new();
        if let Some(angle) = jaw_angle {
            let found = Amount(angle, "rad");
            rules.push(("jaw angle", found, disc, "none: this test has no jaws"));
            rules.push(("jaw angle", found, angle > 0.0 && angle <= 0.8, "above 0 and at most 0.8 rad (45°)"));
        }
        if let Some(stress) = confinement {
            let found = Amount(stress, "Pa");
            rules.push(("confining stress", found, confined, "none: this test has no confinement"));
            rules.push(("confining stress", found, stress > 0.0 && stress.is_finite(), "a stress above 0"));
        } else if confined {
            rules.push(("confining stress", Amount(f64::NAN, "Pa"), false, "a stress above 0: the test needs it"));
        }
        if let Some(span) = span {
            let found = Amount(span, "m");
            rules.push(("span", found, beam, "none: this test has no supports"));
            rules.push(("span", found, span > 0.0 && span.is_finite(), "a length above 0"));
        }
        if let Some(Notch { depth, width }) = notch {
            rules.push(("notch depth", Amount::number(depth), beam, "none: this test has no notch"));
            rules.push((
                "notch depth",
                Amount::number(depth),
                depth > 0.0 && depth < 0.9,
                "a share of the height, above 0 and below 0.9",
            ));
            rules.push((
                "notch width",
                Amount::number(width),
                width > 0.0 && width < 0.5,
                "a share of the height, above 0 and below 0.5",
            ));
        }
        rules
    }

    /// The numbers of the test on a piece of this outline and these scales.
    ///
    /// # Errors
    /// It would take more steps of `time_step` (s) than its bound, or more samples than can be stored.
    pub fn schedule(&self, scales: &Scales, outline: &Outline, time_step: f64) -> Result<Schedule, TestError> {
        let rule = &self.rule;
        let (height, (ends, length)) = (outline.height(), self.stretch(outline));
        let speed = self.speed.of(length / ends, scales);
        let rate = ends * speed / length;
        let schedule = Schedule {
            speed,
            pace: self.pace,
            localised: self.kind.localised(),
            transit: height / scales.wave_speed(),
            transits: self.speed.transits(speed, scales),
            rate,
            sample_strain: rule.sample_strain.of(scales.strain()),
            seating: rule.seating.of(scales.stress()),
            strain_limit: rule.strain_limit.of(scales.strain()).min(1.0),
        };
        let strain = scales.strain().min(schedule.strain_limit);
        let (steps, bound) = (strain / (rate * time_step), rule.max_steps as f64);
        if !(steps <= bound) {
            return Err(TestError::TooLong { speed, strain, steps, time_step, bound });
        }
        let samples = schedule.strain_limit / schedule.sample_strain;
        if !(samples <= MOST_SAMPLES) {
            let (quantity, wanted) = ("samples up to the strain limit", "at most 1e6: sample more coarsely");
            return Err(Faults(vec![Fault::Setting { quantity, value: Amount::number(samples), wanted }]).into());
        }
        Ok(schedule)
    }
}
