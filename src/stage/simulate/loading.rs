//! The test of a `simulate` stage: its settings in the types of the loading tests, and their faults.

use super::super::Complaint;
use super::Simulate;
use dem::loading::kind::TestKind;
use dem::loading::rig::{Machine, Platens};
use dem::loading::settings::{Loading, Particulars, Rule};
use dem::loading::speed::{Speed, Threshold};
use math::text::Amount;

/// Largest platen speed; no test is quasi-static above it (m/s).
const FASTEST: f64 = 1.0;
/// Largest value of `max_steps`.
const MOST_STEPS: u64 = 1_000_000_000;

impl Simulate {
    /// The test with all its settings.
    pub(super) fn spec(&self) -> Loading {
        let rule = Rule::of(self.test);
        let absolute = |value: Option<f64>, default: Threshold| value.map_or(default, Threshold::Absolute);
        Loading {
            kind: self.test,
            speed: self.platen_speed.speed,
            pace: self.platen_speed.pace,
            platens: Platens { friction: self.platen_friction, modulus: self.platen_modulus.map(|m| m.get()) },
            particulars: Particulars {
                jaw_angle: self.jaw_angle.map(|angle| angle.get()),
                confinement: self.confinement.map(|stress| stress.get()),
                span: self.span.map(|span| span.get()),
                notch: self.notch,
            },
            machine: Machine { damping: self.damping, masses: self.masses, ..Machine::default() },
            rule: Rule {
                sample_strain: absolute(self.sample_strain, rule.sample_strain),
                stop_fraction: self.stop_fraction,
                lasting: self.lasting.unwrap_or(rule.lasting),
                seating: absolute(self.seating_stress.map(|stress| stress.get()), rule.seating),
                strain_limit: absolute(self.strain_limit, rule.strain_limit),
                max_steps: self.max_steps,
                snapshots: self.snapshots.clone(),
                forces: self.forces,
            },
        }
    }

    /// Faults of the settings of the test.
    pub(super) fn setting_faults(&self) -> Vec<Complaint> {
        let share = |x: f64| x > 0.0 && x < 1.0;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let (speed, speed_wanted) = self.speed_rule();
        let seating = Amount(self.seating_stress.map_or(1.0, |stress| stress.get()), "Pa");
        let (limit, sample) = (self.strain_limit.unwrap_or(0.5), self.sample_strain.unwrap_or(1e-6));
        let (lasting, steps) = (self.lasting.unwrap_or(0.0), self.max_steps as f64);
        let modulus = Amount(self.platen_modulus.map_or(1.0, |m| m.get()), "Pa");
        let number = Amount::number;
        let rules = [
            (speed, "platen_speed", self.platen_speed.speed.given(), speed_wanted),
            (self.platen_friction >= 0.0, "platen_friction", number(self.platen_friction), "at least 0"),
            (positive(modulus.0), "platen_modulus", modulus, "a positive modulus"),
            (share(self.stop_fraction), "stop_fraction", number(self.stop_fraction), "between 0 and 1"),
            ((0.0..=1.0).contains(&lasting), "lasting", number(lasting), "a share of the strain at the peak, 0 to 1"),
            (share(limit), "strain_limit", number(limit), "a strain between 0 and 1"),
            (share(sample), "sample_strain", number(sample), "a strain between 0 and 1"),
            (positive(seating.0), "seating_stress", seating, "positive"),
            ((0.0..1.0).contains(&self.damping), "damping", number(self.damping), "at least 0 and below 1"),
            ((1..=MOST_STEPS).contains(&self.max_steps), "max_steps", number(steps), "between 1 and 1e9"),
        ];
        let bad = rules.into_iter().filter(|rule| !rule.0);
        let mut faults: Vec<Complaint> = bad
            .map(|(_, key, found, wanted)| Complaint::new(key, format!("`{key}` is {found:#}; it must be {wanted}")))
            .collect();
        for found in self.snapshots.iter().filter(|&&found| !(found > 0.0 && found <= 1.0)) {
            faults.push(Complaint::new("snapshots", format!("{found} is no share of the peak; give 0 to 1")));
        }
        faults.extend(self.particular_faults());
        faults
    }

    fn speed_rule(&self) -> (bool, &'static str) {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        match self.platen_speed.speed {
            Speed::Each(v) => (v > 0.0 && v <= FASTEST, "above 0 and at most 1 m/s; 0.02 m/s is quasi-static"),
            Speed::StrainRate(rate) => (positive(rate), "a strain rate above 0"),
            Speed::Transits(n) => (positive(n), "above 0; from about 60 on a test is quasi-static"),
        }
    }

    /// Settings that the kind of test needs or does not use.
    fn particular_faults(&self) -> Vec<Complaint> {
        let confined = matches!(self.test, TestKind::Biaxial | TestKind::Triaxial);
        let (disc, beam) = (self.test == TestKind::Brazilian, self.test == TestKind::Bending);
        let name = self.test.name();
        let given = [
            ("jaw_angle", self.jaw_angle.is_some(), disc),
            ("confinement", self.confinement.is_some(), confined),
            ("span", self.span.is_some(), beam),
            ("notch", self.notch.is_some(), beam),
        ];
        let useless = given.into_iter().filter(|&(_, given, used)| given && !used);
        let mut faults: Vec<Complaint> = useless
            .map(|(key, ..)| {
                Complaint::new(key, format!("`{key}` has no effect on a {name} test")).hint("leave it out")
            })
            .collect();
        let mut need = |bad: bool, key: &str, message: String| {
            if bad {
                faults.push(Complaint::new(key, message));
            }
        };
        let missing = confined && self.confinement.is_none();
        need(
            missing,
            "confinement",
            format!("a {name} test needs a confining stress; write for example confinement = \"5 MPa\""),
        );
        let angle = self.jaw_angle.map_or(0.1, |angle| angle.get());
        need(
            !(angle > 0.0 && angle <= 0.8),
            "jaw_angle",
            format!("`jaw_angle` is {:#}; it must be above 0 and at most 45 deg", Amount(angle, "rad")),
        );
        let stress = self.confinement.map_or(1.0, |stress| stress.get());
        need(
            !(stress > 0.0),
            "confinement",
            format!("`confinement` is {:#}; it must be positive", Amount(stress, "Pa")),
        );
        let span = self.span.map_or(1.0, |span| span.get());
        need(!(span > 0.0), "span", format!("`span` is {:#}; it must be positive", Amount(span, "m")));
        if let Some(notch) = self.notch {
            let depth = notch.depth > 0.0 && notch.depth < 0.9;
            need(
                !depth,
                "notch.depth",
                format!(
                    "`depth` of the notch is {}; it must be a share of the height above 0 and below 0.9",
                    notch.depth
                ),
            );
            let width = notch.width > 0.0 && notch.width < 0.5;
            need(
                !width,
                "notch.width",
                format!(
                    "`width` of the notch is {}; it must be a share of the height above 0 and below 0.5",
                    notch.width
                ),
            );
        }
        faults
    }
}
