//! Whether a test measured what it is called after: checks, each with its number, its bound and what to do.
//!
//! A run whose checks are not all met is not valid. Its numbers remain; analyses report why they should
//! not count.

use serde::{Deserialize, Serialize};

/// What can be wrong with a run that ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// Nothing broke it within the strain limit.
    NoPeak,
    /// The bound on steps ended it.
    OutOfSteps,
    /// The engine gave up.
    EngineFailure,
    /// The confining stress was not reached or not held.
    Confinement,
    /// The piece was not at rest before it was loaded.
    NotAtRest,
    /// Too few particles across.
    FewParticles,
    /// Too few wave transits before failure.
    Transits,
    /// The disc turned.
    Rotation,
    /// Cracks away from the loaded diameter.
    OffDiameter,
    /// Cracks on the loaded diameter that are not tensile.
    ShearOnDiameter,
    /// The cracks do not run from platen to platen.
    CrackPath,
    /// The platens carry different forces.
    Asymmetry,
    /// The piece broke in or at a grip.
    AtGrip,
}

impl Reason {
    /// Whether a run that does not meet the check is invalid; a caution otherwise, to be read beside the result.
    pub fn invalidates(self) -> bool {
        !matches!(self, Self::Transits | Self::FewParticles | Self::ShearOnDiameter)
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoPeak => "no peak",
            Self::OutOfSteps => "bound on steps",
            Self::EngineFailure => "engine failure",
            Self::Confinement => "confining stress",
            Self::NotAtRest => "rest before loading",
            Self::FewParticles => "particles across",
            Self::Transits => "wave transits before failure",
            Self::Rotation => "rotation",
            Self::OffDiameter => "cracks near the loaded diameter",
            Self::ShearOnDiameter => "tensile cracks on the diameter",
            Self::CrackPath => "crack path between the platens",
            Self::Asymmetry => "difference of the platen forces",
            Self::AtGrip => "cracks between the grips",
        }
    }

    /// What the number is.
    pub fn about(self) -> &'static str {
        match self {
            Self::NoPeak => "largest stress up to the strain limit",
            Self::OutOfSteps => "steps made",
            Self::EngineFailure => "step of the failure",
            Self::Confinement => "largest deviation of the confining stress from its target, over the target",
            Self::NotAtRest => "mean unbalanced force over mean contact force before loading",
            Self::FewParticles => "narrowest extent over the mean diameter",
            Self::Transits => "wave transits of the height until the bonds can be expected to fail",
            Self::Rotation => "least-squares rotation of all balls up to the peak",
            Self::OffDiameter => "share of the cracks up to the peak within a tenth of the diameter of the loaded one",
            Self::ShearOnDiameter => "share of tensile cracks among those near the loaded diameter, up to the peak",
            Self::CrackPath => "share of the loaded diameter's middle four fifths that is cracked at the end",
            Self::Asymmetry => "difference of the two platen forces over their mean, at the peak",
            Self::AtGrip => "share of the cracks up to the end that lie between the grips",
        }
    }

    /// SI unit of the number; empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::NoPeak => "Pa",
            Self::Rotation => "rad",
            _ => "",
        }
    }

    /// What to do about it.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::NoPeak => "raise strain_limit, or check the strengths of the bonds",
            Self::OutOfSteps => "load faster, coarsen the specimen, or raise max_steps",
            Self::EngineFailure => "load slower, or look at the particle that is named",
            Self::Confinement => "load slower, so that the side walls can follow",
            Self::NotAtRest => "make the packing with a smaller unbalanced ratio",
            Self::FewParticles => "reduce the mean radius",
            Self::Transits => "lower the platen speed",
            Self::Rotation => "use a smaller ratio of radii, smaller particles, or curved jaws",
            Self::OffDiameter | Self::CrackPath => "use smaller particles or curved jaws, or load slower",
            Self::ShearOnDiameter => "raise the shear strength of the bonds over their tensile strength",
            Self::Asymmetry => "load slower",
            Self::AtGrip => "use smaller particles, or test another packing",
        }
    }
}

/// A number that must stay on one side of a bound for the test to be valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// What is checked.
    pub reason: Reason,
    /// The number.
    pub value: f64,
    /// Its bound.
    pub bound: f64,
    /// Whether the number is on the right side of the bound.
    pub met: bool,
}

impl Check {
    /// The value must be at least the bound.
    pub fn at_least(reason: Reason, value: f64, bound: f64) -> Self {
        Self { reason, value, bound, met: value >= bound }
    }

    /// The value must be at most the bound.
    pub fn at_most(reason: Reason, value: f64, bound: f64) -> Self {
        Self { reason, value, bound, met: value <= bound }
    }
}

impl std::fmt::Display for Check {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (reason, unit) = (self.reason, self.reason.unit());
        let space = if unit.is_empty() { "" } else { " " };
        let side = match (self.met, self.value > self.bound) {
            (true, _) => "within",
            (false, true) => "above",
            (false, false) => "below",
        };
        let [value, bound] = [self.value, self.bound].map(short);
        let name = reason.name();
        // What ended a test has no bound that it should have met.
        if !self.bound.is_finite() || (!self.met && self.value == self.bound) {
            write!(f, "{name}: {value}{space}{unit}")?;
        } else {
            write!(f, "{name}: {value}{space}{unit} is {side} {bound}{space}{unit}")?;
        }
        if self.met { Ok(()) } else { write!(f, " ({}); {}", reason.about(), reason.remedy()) }
    }
}

/// Three digits, with a power of ten where it is needed.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) { format!("{}", (x * 1e3).round() / 1e3) } else { format!("{x:.2e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_that_is_not_met_says_number_bound_meaning_and_remedy() {
        let turned = Check::at_most(Reason::Rotation, 0.031, 0.0175);
        assert_eq!(
            turned.to_string(),
            "rotation: 0.031 rad is above 0.018 rad (least-squares rotation of all balls up to the peak); \
             use a smaller ratio of radii, smaller particles, or curved jaws"
        );
        assert_eq!(
            Check::at_least(Reason::CrackPath, 0.95, 0.9).to_string(),
            "crack path between the platens: 0.95 is within 0.9"
        );
        let no_peak = Check { reason: Reason::NoPeak, value: 0.0, bound: f64::INFINITY, met: false };
        assert_eq!(
            no_peak.to_string(),
            "no peak: 0 Pa (largest stress up to the strain limit); raise strain_limit, or check the strengths of the bonds"
        );
        assert!(!Check::at_least(Reason::CrackPath, f64::NAN, 0.9).met);
    }
}
