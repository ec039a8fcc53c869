//! How far responses are from their targets.
//!
//! The deviation of response k is dₖ = (yₖ − tₖ) / sₖ with the computed value y and the target t. A target may be a band,
//! or open to one side ("at least"): t is then the end that y lies beyond, and d is 0 within. The denominator s is
//! * the target, Su et al. 2021 (doi:10.3390/ma14071627) eq. 16 and 17,
//! * the computed value, their eq. 19, which their genetic algorithm minimised,
//! * the largest target: for the ordinates of one curve, so that its first points, near zero, do not rule.
//!
//! Deviations are combined with the weights w as Σ wₖ |dₖ|, as max wₖ |dₖ| (Wang & Cao 2017), or as Σ wₖ dₖ².
//! A stress–strain curve is a list of targets, one per given strain, see [`ordinates`].

use super::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How deviations are combined into one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// Σ w |d|
    #[default]
    Sum,
    /// max w |d|
    Maximum,
    /// Σ w d²
    Squares,
}

/// What a deviation is measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Denominator {
    /// The target.
    #[default]
    Target,
    /// The computed value.
    Computed,
    /// The largest target by magnitude.
    Largest,
}

/// A wanted response: a value, or a band that may be open to one side.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Name of the response.
    pub response: String,
    /// Least wanted value, in the unit the model gives; −∞ when there is none.
    pub low: f64,
    /// Greatest wanted value; ∞ when there is none.
    pub high: f64,
    /// Weight of its deviation.
    pub weight: f64,
    /// Relative deviation up to which it counts as met; a method's own where none is given.
    pub tolerance: Option<f64>,
}

impl Target {
    /// A wanted value.
    pub fn exactly(response: &str, value: f64, weight: f64) -> Self {
        Self::band(response, [value, value], weight)
    }

    /// A wanted band; an infinite end leaves it open there.
    pub fn band(response: &str, [low, high]: [f64; 2], weight: f64) -> Self {
        Self { response: response.to_owned(), low, high, weight, tolerance: None }
    }

    /// The reference value of the target: the lower end where there is one, else the upper.
    pub fn value(&self) -> f64 {
        if self.low.is_finite() { self.low } else { self.high }
    }

    /// The wanted value nearest to `y`.
    pub fn nearest(&self, y: f64) -> f64 {
        if y < self.low {
            self.low
        } else if y > self.high {
            self.high
        } else if self.low == self.high {
            self.low
        } else {
            y
        }
    }

    /// Whether the values from `low` to `high` all meet it, each end of the band widened by its relative tolerance.
    pub fn holds(&self, [low, high]: [f64; 2], tolerance: f64) -> bool {
        let slack = |end: f64| if end.is_finite() { self.tolerance.unwrap_or(tolerance) * end.abs() } else { 0.0 };
        low >= self.low - slack(self.low) && high <= self.high + slack(self.high)
    }

    /// The finite ends.
    fn ends(&self) -> impl Iterator<Item = f64> {
        let upper = (self.high != self.low).then_some(self.high);
        [Some(self.low), upper].into_iter().flatten().filter(|end| !end.is_infinite())
    }

    fn fault(&self) -> Option<Error> {
        let Self { response, low, high, .. } = self;
        let not_finite = |value| Error::NotFinite { what: format!("the target of `{response}`"), value };
        if let Some(value) = [*low, *high].into_iter().find(|end| end.is_nan()) {
            return Some(not_finite(value));
        }
        if *low == f64::INFINITY || *high == f64::NEG_INFINITY {
            return Some(not_finite(*low));
        }
        if low.is_infinite() && high.is_infinite() {
            return Some(not_finite(*high));
        }
        (low > high).then(|| Error::EmptyBand { response: response.clone(), low: *low, high: *high })
    }
}

/// Targets and how deviations from them are combined.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    targets: Vec<Target>,
    form: Form,
    denominator: Denominator,
    largest: f64,
}

impl Misfit {
    /// Checks the targets; every fault is reported.
    pub fn new(targets: Vec<Target>, form: Form, denominator: Denominator) -> Result<Self, Vec<Error>> {
        let mut faults = Vec::new();
        if targets.is_empty() {
            faults.push(Error::Nothing { what: "target" });
        }
        let largest = targets.iter().flat_map(Target::ends).map(f64::abs).fold(0.0, f64::max);
        for (i, target) in targets.iter().enumerate() {
            let Target { response, weight, .. } = target;
            if targets[..i].iter().any(|other| other.response == *response) {
                faults.push(Error::Twice { name: response.clone() });
            }
            faults.extend(target.fault());
            if !(*weight > 0.0 && weight.is_finite()) {
                faults.push(Error::Weight { response: response.clone(), weight: *weight });
            }
            let zero =
                if denominator == Denominator::Largest { largest == 0.0 } else { target.ends().any(|end| end == 0.0) };
            if zero {
                faults.push(Error::ZeroTarget { response: response.clone() });
            }
        }
        if faults.is_empty() { Ok(Self { targets, form, denominator, largest }) } else { Err(faults) }
    }

    /// The targets.
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// Signed relative deviations of responses given in the order of the targets.
    pub fn deviations(&self, responses: &[f64]) -> Vec<f64> {
        assert_eq!(responses.len(), self.targets.len(), "BUG: a response per target");
        let one = |(t, &y): (&Target, &f64)| {
            let wanted = t.nearest(y);
            if wanted == y && t.low != t.high { 0.0 } else { (y - wanted) / self.scale(wanted, y) }
        };
        self.targets.iter().zip(responses).map(one).collect()
    }

    /// The misfit of responses given in the order of the targets; infinite where it is undefined (a computed value
    /// of zero as denominator, a response that is not a number).
    pub fn of(&self, responses: &[f64]) -> f64 {
        let deviations = self.deviations(responses);
        if deviations.iter().any(|d| d.is_nan()) { f64::INFINITY } else { self.combine(&deviations) }
    }

    /// Combines deviations, one per target.
    pub fn combine(&self, deviations: &[f64]) -> f64 {
        let parts = self.targets.iter().zip(deviations).map(|(t, d)| (t.weight, d.abs()));
        match self.form {
            Form::Sum => parts.map(|(w, d)| w * d).sum(),
            Form::Maximum => parts.map(|(w, d)| w * d).fold(0.0, f64::max),
            Form::Squares => parts.map(|(w, d)| w * d * d).sum(),
        }
    }

    fn scale(&self, wanted: f64, computed: f64) -> f64 {
        match self.denominator {
            Denominator::Target => wanted.abs(),
            Denominator::Computed => computed.abs(),
            Denominator::Largest => self.largest,
        }
    }
}

/// The ordinates of a curve at wanted strains, by linear interpolation; strains of the curve must not decrease.
pub fn ordinates(strain: &[f64], stress: &[f64], wanted: &[f64]) -> Result<Vec<f64>, Error> {
    assert_eq!(strain.len(), stress.len(), "BUG: a stress per strain");
    let (low, high) = match (strain.first(), strain.last()) {
        (Some(&low), Some(&high)) => (low, high),
        _ => (f64::NAN, f64::NAN),
    };
    let at = |&x: &f64| {
        if !(low <= x && x <= high) {
            return Err(Error::CurveTooShort { low, high, wanted: x });
        }
        let right = strain.partition_point(|&s| s < x).max(1).min(strain.len() - 1);
        let left = right.saturating_sub(1);
        let width = strain[right] - strain[left];
        let part = if width > 0.0 { (x - strain[left]) / width } else { 1.0 };
        Ok(stress[left] + part * (stress[right] - stress[left]))
    };
    wanted.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn misfit(form: Form, denominator: Denominator) -> Misfit {
        let t = Target::exactly;
        Misfit::new(vec![t("UCS", 40.0, 1.0), t("nu", 0.2, 2.0)], form, denominator).expect("good")
    }

    #[test]
    fn forms_and_denominators_are_those_of_the_equations() {
        let y = [50.0, 0.16];
        let close = |m: Misfit, wanted: f64| assert!((m.of(&y) - wanted).abs() < 1e-14, "{} {wanted}", m.of(&y));
        close(misfit(Form::Sum, Denominator::Target), 0.25 + 2.0 * 0.2);
        close(misfit(Form::Sum, Denominator::Computed), 0.2 + 2.0 * 0.25);
        close(misfit(Form::Maximum, Denominator::Target), 0.4);
        close(misfit(Form::Squares, Denominator::Target), 0.0625 + 2.0 * 0.04);
        close(misfit(Form::Sum, Denominator::Largest), 0.25 + 2.0 * 0.001);
    }

    /// A band deviates from the end that is passed, relative to that end; an open side never does.
    #[test]
    fn bands_deviate_outside_only() {
        let (free, least) = ([3.0, 5.0], [4.0, f64::INFINITY]);
        let targets = vec![Target::band("UCS", free, 1.0), Target::band("E", least, 1.0)];
        let misfit = Misfit::new(targets, Form::Sum, Denominator::Target).expect("good");
        assert_eq!(misfit.deviations(&[4.0, 400.0]), [0.0, 0.0]);
        assert_eq!(misfit.deviations(&[6.0, 3.0]), [0.2, -0.25]);
        assert_eq!(misfit.deviations(&[1.5, 4.0]), [-0.5, 0.0]);
        assert!(misfit.deviations(&[f64::NAN, 4.0])[0].is_nan());
        let [strength, modulus] = misfit.targets() else { panic!("two") };
        assert!(strength.holds([2.95, 5.05], 0.02) && !strength.holds([2.95, 5.2], 0.02));
        assert!(modulus.holds([3.93, 1e9], 0.02) && !modulus.holds([3.9, 4.1], 0.02));
        let bad = vec![
            Target::band("a", [5.0, 3.0], 1.0),
            Target::band("b", [f64::NEG_INFINITY, f64::INFINITY], 1.0),
            Target::band("c", [f64::NEG_INFINITY, 0.0], 1.0),
        ];
        let faults = Misfit::new(bad, Form::Sum, Denominator::Target).expect_err("bad");
        assert!(
            matches!(faults[..], [Error::EmptyBand { .. }, Error::NotFinite { .. }, Error::ZeroTarget { .. }]),
            "{faults:?}"
        );
    }

    #[test]
    fn an_undefined_misfit_is_infinite_not_zero() {
        assert_eq!(misfit(Form::Maximum, Denominator::Computed).of(&[0.0, 0.2]), f64::INFINITY);
        assert_eq!(misfit(Form::Maximum, Denominator::Target).of(&[f64::NAN, 0.2]), f64::INFINITY);
    }

    #[test]
    fn bad_targets_are_all_named() {
        let t = Target::exactly;
        let bad = vec![t("UCS", 0.0, 1.0), t("E", f64::INFINITY, 1.0), t("nu", 0.2, -1.0)];
        let faults = Misfit::new(bad, Form::Sum, Denominator::Target).expect_err("bad");
        assert!(matches!(faults[..], [Error::ZeroTarget { .. }, Error::NotFinite { .. }, Error::Weight { .. }]));
    }

    #[test]
    fn a_curve_is_read_at_given_strains() {
        let (strain, stress) = ([0.0, 1.0, 1.0, 3.0], [0.0, 10.0, 8.0, 4.0]);
        assert_eq!(ordinates(&strain, &stress, &[0.0, 0.5, 2.0, 3.0]), Ok(vec![0.0, 5.0, 6.0, 4.0]));
        assert!(matches!(ordinates(&strain, &stress, &[3.5]), Err(Error::CurveTooShort { .. })));
        assert!(matches!(ordinates(&[], &[], &[0.0]), Err(Error::CurveTooShort { .. })));
    }
}
