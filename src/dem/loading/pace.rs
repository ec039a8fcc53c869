//! A speed that adapts: fast while nothing breaks, slow while cracks come.
//!
//! Loading does harm where cracks come: while a crack spreads, a fast platen raises the stress above what the piece bears at
//! rest. Where nothing breaks it does none, as long as a few waves run through the piece. So the governor reads the state of
//! the piece at every sample and chooses how many times the slow speed, the one that is asked for, the next sample is made at:
//!
//! ```text
//! damage rate  d = (dN/dε) ε / M          N cracks so far, ε axial strain, M the bonds whose loss is failure
//! speed        v = slow × min(κ/d, v_fast/slow, what growth allows), at least slow
//! ```
//!
//! dN/dε is a mean with a memory of [`MEMORY`] of the strain so far. M is all bonds where damage is spread (compression), and
//! the bonds of one section, M^((n−1)/n) in n dimensions, where one crack ends the test (tension, splitting, bending). v_fast
//! lets [`LEAST_TRANSITS`] waves run through the height within the reference strain. Speed grows twofold in a transit at
//! most, so that the lateral motion follows, and falls at once.
//!
//! At f times the slow speed the local damping is α/f, with α what the test sets. Local damping opposes the mean motion wherever
//! the forces on a particle fluctuate; this drag grows with the speed, lags the lateral strain by 1 % and raises the tangent
//! modulus by 2 % at ten times 0.02 m/s. With α/f the drag is that of the slow speed all the time. (A first rule, a damping of
//! 0.1 above three times the slow speed, let the drag change where the tangent modulus is read.)
//!
//! Behind the peak, where the stress has fallen below [`PAST`] of the largest, the speed is at least [`AFTER`] times the slow
//! one where damage is spread: strength, moduli and cracks at the peak are known by then.
//!
//! Small rocks, packings at a fixed speed and with that as the slow speed; geometric means of the ratios and their standard
//! errors (`benches/pace.rs`), and under them what half of the fixed speed changes:
//!
//! | test | pairs | steps | strength | tangent E | secant E | ν | cracks at the peak |
//! |---|---|---|---|---|---|---|---|
//! | plane compression | 12 | 0.26 | 0.999 ± 0.006 | 1.0008 ± 0.0002 | 1.0006 ± 0.0004 | 0.9985 ± 0.0015 | 1.10 ± 0.06 |
//! | half the speed | | 1.89 | 0.996 ± 0.006 | 0.9998 ± 0.0001 | 0.9998 | 1.0003 | 0.70 ± 0.21 |
//! | plane tension | 12 | 0.16 | 1.003 ± 0.001 | 0.9935 ± 0.0024 | 1.0003 ± 0.0006 | 0.988 ± 0.003 | 1.01 ± 0.10 |
//! | half the speed | | 1.96 | 0.996 ± 0.001 | 1.0000 | 0.9997 | 1.0010 ± 0.0001 | 0.80 ± 0.25 |
//! | solid tension | 8 | 0.26 | 1.000 ± 0.000 | 1.0047 ± 0.0024 | 1.0026 ± 0.0002 | 0.9947 ± 0.0003 | 1.05 ± 0.05 |
//! | half the speed | | 1.97 | 0.998 ± 0.002 | 1.0000 | 0.9999 | 1.0001 | 1.08 ± 0.05 |
//!
//! In compression the bars of 0.5 % of the strength and 0.2 % of the moduli are met in the mean. In tension the strength is
//! right, and the secant modulus within 0.1 % in the plane and 0.3 % in space; the tangent modulus and ν are not: less than two
//! waves cross the piece between 40 and 60 % of the peak. Take `E_secant` there, or a fixed speed.
//!
//! With the first rule, seven concretes of 22,409 discs (strengths 10/10, 10/30, 20/20, 30/10 MPa, slow speed 0.02 m/s) gave:
//! strength 0.994 ± 0.003, tangent modulus 1.004 ± 0.001, secant modulus 1.0007 ± 0.0005, ν 0.998 ± 0.002, cracks at the peak
//! 0.96 ± 0.05, steps 0.37 (0.24 to 0.49), some 15 % more cracks after the peak. Published campaigns stay at their fixed speed.
//!
//! A change of speed multiplies every velocity, of platens and particles alike ([`Engine::scale_motion`]): at a quasi-static
//! pace the field of velocities is proportional to the speed of the platens, so no shock runs through the piece. Everything
//! is decided from strain, cracks and the time of the simulation, hence with the same bits on any machine.

use super::settings::Schedule;
use crate::{Engine, Faults, Space};
use serde::{Deserialize, Serialize};

/// Whether the speed of a test is one or adapts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pace {
    /// One speed from start to end.
    #[default]
    Fixed,
    /// The speed is the slow one; the piece is loaded faster while nothing breaks. The number counts the changes of the rule,
    /// so that results of different rules have different task texts.
    #[serde(rename = "adaptive-2")]
    Adaptive,
}

/// Damage rate above which the speed stays slow.
const SLOW_DAMAGE: f64 = 0.12;
/// Memory of the damage rate, over the strain so far.
const MEMORY: f64 = 0.02;
/// Wave transits of the height within the reference strain at the fast speed.
const LEAST_TRANSITS: f64 = 8.0;
/// Share of the largest stress below which the peak is past.
const PAST: f64 = 0.9;
/// Least factor on the slow speed behind the peak.
const AFTER: f64 = 3.0;

/// Chooses the speed of the next sample.
#[derive(Clone, Debug)]
pub(super) struct Governor {
    /// Speed now over the slow speed.
    factor: f64,
    /// Largest factor.
    fastest: f64,
    /// Least factor behind the peak.
    after: f64,
    /// Local damping that the test sets.
    damping: f64,
    /// Bonds whose loss is failure.
    members: f64,
    /// Time that a wave takes through the height (s).
    transit: f64,
    /// Cracks per strain, remembered.
    rate: f64,
    /// Strain, time (s) and cracks at the last sample.
    last: (f64, f64, usize),
}

impl Governor {
    /// The governor of a test on `engine`; none for a fixed pace.
    pub(super) fn new<S: Space>(engine: &Engine<S>, schedule: &Schedule) -> Option<Self> {
        if schedule.pace == Pace::Fixed {
            return None;
        }
        let (bonds, n) = (engine.bond_count().max(1) as f64, S::DIMENSION as f64);
        let members = if schedule.localised { math::elementary::pow(bonds, (n - 1.0) / n) } else { bonds };
        let fastest = (schedule.transits / LEAST_TRANSITS).max(1.0);
        Some(Self {
            factor: 1.0,
            fastest,
            after: if schedule.localised { 1.0 } else { AFTER.min(fastest) },
            damping: engine.settings().damping,
            members,
            transit: schedule.transit,
            rate: 0.0,
            last: (0.0, engine.time(), engine.cracks().len()),
        })
    }

    /// Speed now over the slow speed.
    pub(super) fn factor(&self) -> f64 {
        self.factor
    }

    /// Looks at the sample that ended at `strain`, with `share` of the largest stress so far, and sets the speed of the next.
    pub(super) fn look<S: Space>(&mut self, engine: &mut Engine<S>, strain: f64, share: f64) -> Result<(), Faults> {
        let next = self.next(strain, engine.time(), engine.cracks().len());
        let wanted = if share < PAST { next.max(self.after) } else { next };
        if wanted != self.factor {
            engine.set_damping(self.damping / wanted)?;
            engine.scale_motion(wanted / self.factor)?;
            self.factor = wanted;
        }
        Ok(())
    }

    fn next(&mut self, strain: f64, time: f64, cracks: usize) -> f64 {
        let (before, then, known) = self.last;
        self.last = (strain, time, cracks);
        let grown = strain - before;
        if !(grown > 0.0 && strain > 0.0) {
            return self.factor;
        }
        let weight = grown / (grown + MEMORY * strain);
        self.rate += weight * ((cracks - known) as f64 / grown - self.rate);
        let damage = self.rate * strain / self.members;
        let allowed = if damage > 0.0 { SLOW_DAMAGE / damage } else { f64::INFINITY };
        let growth = self.factor * (1.0 + (time - then) / self.transit);
        allowed.min(growth).clamp(1.0, self.fastest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn governor() -> Governor {
        Governor {
            factor: 1.0,
            fastest: 10.0,
            after: 3.0,
            damping: 0.7,
            members: 1e4,
            transit: 1e-4,
            rate: 0.0,
            last: (0.0, 0.0, 0),
        }
    }

    /// Drives `samples` of 1e-6 of strain at a slow rate of 0.1/s, with `cracks` at a strain.
    fn factors(governor: &mut Governor, samples: usize, cracks: impl Fn(f64) -> usize) -> Vec<f64> {
        let mut time = governor.last.1;
        let from = (governor.last.0 / 1e-6).round() as usize;
        let mut step = |k: usize| {
            let strain = 1e-6 * (from + k) as f64;
            time += 1e-6 / (0.1 * governor.factor);
            governor.factor = governor.next(strain, time, cracks(strain));
            governor.factor
        };
        (1..=samples).map(&mut step).collect()
    }

    /// Growth (1 + Δt/T) a sample: with Δt = 1e-5 s / f and T = 1e-4 s, f grows by 0.1 a sample whatever f is.
    #[test]
    fn without_cracks_the_speed_grows_by_its_rule_to_the_fastest_and_stays() {
        let got = factors(&mut governor(), 200, |_| 0);
        assert!((got[9] - 2.0).abs() < 1e-9 && (got[49] - 6.0).abs() < 1e-9, "{} {}", got[9], got[49]);
        assert_eq!(got[199], 10.0);
    }

    /// N = 10⁴ (ε/10⁻³)³ / 10 has d = 3 N/M = 0.3 (ε/10⁻³)³: 0.12/d is 1 at ε = 0.737e-3 and 4 at 0.464e-3.
    #[test]
    fn the_speed_falls_as_the_damage_rate_grows() {
        let cracks = |strain: f64| (1e3 * (strain / 1e-3) * (strain / 1e-3) * (strain / 1e-3)) as usize;
        let got = factors(&mut governor(), 900, cracks);
        assert_eq!(got[250], 10.0);
        assert!((got[463] - 4.0).abs() < 0.8, "{}", got[463]);
        assert!(got[800..].iter().all(|&factor| factor == 1.0));
    }

    #[test]
    fn a_burst_slows_at_once_and_is_forgotten() {
        let mut governor = governor();
        factors(&mut governor, 500, |_| 0);
        let burst = factors(&mut governor, 500, |_| 200);
        assert!(burst[0] < 2.0, "{}", burst[0]);
        assert_eq!(burst[499], 10.0);
    }
}
