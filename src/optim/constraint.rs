//! The domain of the parameters: a box, and linear constraints in it.
//!
//! Optimisers see the unit box u ([`super::factor`]). A linear constraint Σ aᵢ xᵢ ≤ b becomes
//! Σ aᵢ wᵢ uᵢ ≤ b − Σ aᵢ lowᵢ with the widths wᵢ, scaled to a normal of unit length. On logarithmic scales two kinds of
//! constraint stay linear, and no other is taken: a bound a x ≤ b, and a ratio a x ≤ b y. A point outside is brought to
//! the nearest allowed one by [`least_distance`].

use super::Error;
pub use super::factor::Factor;
use super::least_distance::least_distance;
use math::elementary::ln;
use math::random::Stream;
use math::scale::Scale;
use std::collections::BTreeMap;

/// How far outside a bound, in the unit box, still counts as on it.
pub const SLACK: f64 = 1e-9;

/// Σ terms ≤ `at_most`, in natural units.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Coefficient of each factor named.
    pub terms: BTreeMap<String, f64>,
    /// Upper bound of the sum.
    pub at_most: f64,
}

/// The allowed parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    factors: Vec<Factor>,
    /// Unit normal in the unit box, bound, and the constraint written out.
    walls: Vec<(Vec<f64>, f64, String)>,
    centre: Vec<f64>,
}

impl Domain {
    /// Checks the box and the constraints; every fault is reported.
    pub fn new(factors: Vec<Factor>, constraints: &[Linear]) -> Result<Self, Vec<Error>> {
        let mut faults = box_faults(&factors);
        let known: Vec<String> = factors.iter().map(|f| f.name.clone()).collect();
        let mut walls = Vec::new();
        for constraint in constraints {
            match wall(constraint, &factors, &known) {
                Ok(wall) => walls.extend(wall),
                Err(mut found) => faults.append(&mut found),
            }
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let mut domain = Self { centre: vec![0.5; factors.len()], factors, walls };
        domain.centre = domain.project(&domain.centre).map_err(|fault| vec![fault])?;
        Ok(domain)
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.factors.len()
    }

    /// Never: a domain has at least one factor.
    pub fn is_empty(&self) -> bool {
        self.factors.is_empty()
    }

    /// The parameters with their ranges.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The linear constraints in the unit box: a normal of unit length, its bound, and the constraint as it is written.
    pub fn walls(&self) -> impl Iterator<Item = (&[f64], f64, &str)> {
        self.walls.iter().map(|(normal, bound, text)| (normal.as_slice(), *bound, text.as_str()))
    }

    /// Whether only the box bounds the parameters.
    pub fn is_box(&self) -> bool {
        self.walls.is_empty()
    }

    /// The allowed point nearest the centre of the box, in the unit box.
    pub fn centre(&self) -> &[f64] {
        &self.centre
    }

    /// Natural units of a point of the unit box; 0 and 1 give the ends of the range exactly.
    pub fn natural(&self, unit: &[f64]) -> Vec<f64> {
        self.factors.iter().zip(unit).map(|(f, &u)| f.natural(u)).collect()
    }

    /// Natural units of a point that may lie outside the unit box.
    pub fn natural_beyond(&self, unit: &[f64]) -> Vec<f64> {
        self.factors.iter().zip(unit).map(|(f, &u)| f.natural_beyond(u)).collect()
    }

    /// Coordinates of a natural point in the unit box; outside the range it lies outside 0 … 1.
    pub fn unit(&self, natural: &[f64]) -> Vec<f64> {
        self.factors.iter().zip(natural).map(|(f, &x)| f.unit(x)).collect()
    }

    /// Whether a point of the unit box is allowed.
    pub fn contains(&self, unit: &[f64]) -> bool {
        unit.iter().all(|&u| (-SLACK..=1.0 + SLACK).contains(&u))
            && self.walls.iter().all(|(normal, bound, _)| dot(normal, unit) <= bound + SLACK)
    }

    /// Refuses a natural point outside, naming the bound it breaks.
    pub fn check(&self, natural: &[f64]) -> Result<(), Error> {
        let unit = self.unit(natural);
        let outside = |reason| Err(Error::Outside { point: natural.to_vec(), reason });
        for (factor, (u, x)) in self.factors.iter().zip(unit.iter().zip(natural)) {
            if !(-SLACK..=1.0 + SLACK).contains(u) {
                let Factor { name, low, high, .. } = factor;
                return outside(format!("`{name}` = {x} is not within {low} … {high}"));
            }
        }
        match self.walls.iter().find(|(normal, bound, _)| dot(normal, &unit) > bound + SLACK) {
            Some((_, _, text)) => outside(format!("{text} does not hold")),
            None => Ok(()),
        }
    }

    /// The allowed point nearest to one of the unit box (the point itself when it is allowed).
    pub fn repair(&self, unit: &[f64]) -> Vec<f64> {
        let clipped: Vec<f64> = unit.iter().map(|u| u.clamp(0.0, 1.0)).collect();
        if self.contains(&clipped) {
            return clipped;
        }
        self.project(&clipped).unwrap_or_else(|_| self.centre.clone())
    }

    /// A random allowed point: uniform, or the repair of a uniform one where nearly all of the box is forbidden.
    pub fn sample(&self, random: &mut Stream) -> Vec<f64> {
        let mut draw = || (0..self.len()).map(|_| random.uniform()).collect::<Vec<_>>();
        let mut point = draw();
        for _ in 0..100 {
            if self.contains(&point) {
                return point;
            }
            point = draw();
        }
        self.repair(&point)
    }

    fn project(&self, unit: &[f64]) -> Result<Vec<f64>, Error> {
        if self.contains(unit) {
            return Ok(unit.to_vec());
        }
        let (rows, bounds) = self.walls_from(unit);
        let step = least_distance(&rows, &bounds).map_err(|rows| self.contradiction(&rows))?;
        Ok(unit.iter().zip(step).map(|(u, s)| (u + s).clamp(0.0, 1.0)).collect())
    }

    /// All bounds as rows · y ≥ bounds for the step y from a point: linear constraints first, then the two ends of
    /// every range.
    pub(super) fn walls_from(&self, unit: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let n = unit.len();
        let (mut rows, mut bounds) = (Vec::new(), Vec::new());
        for (normal, bound, _) in &self.walls {
            rows.push(normal.iter().map(|a| -a).collect());
            bounds.push(dot(normal, unit) - bound);
        }
        for (i, &u) in unit.iter().enumerate() {
            let along = |sign: f64| (0..n).map(|j| if i == j { sign } else { 0.0 }).collect::<Vec<_>>();
            rows.extend([along(1.0), along(-1.0)]);
            bounds.extend([-u, u - 1.0]);
        }
        (rows, bounds)
    }

    fn contradiction(&self, rows: &[usize]) -> Error {
        let name = |&row: &usize| match self.walls.get(row) {
            Some((_, _, text)) => text.clone(),
            None => {
                let Factor { name, low, high, .. } = &self.factors[(row - self.walls.len()) / 2];
                if (row - self.walls.len()).is_multiple_of(2) {
                    format!("{name} ≥ {low}")
                } else {
                    format!("{name} ≤ {high}")
                }
            }
        };
        Error::Contradiction { constraints: rows.iter().map(name).collect() }
    }
}

fn box_faults(factors: &[Factor]) -> Vec<Error> {
    let mut faults = Vec::new();
    if factors.is_empty() {
        faults.push(Error::Nothing { what: "factor" });
    }
    for (i, factor) in factors.iter().enumerate() {
        if factors[..i].iter().any(|other| other.name == factor.name) {
            faults.push(Error::Twice { name: factor.name.clone() });
        }
        faults.extend(factor.fault());
    }
    faults
}

type Wall = (Vec<f64>, f64, String);

/// The constraint in the unit box; `None` when it always holds.
fn wall(constraint: &Linear, factors: &[Factor], known: &[String]) -> Result<Option<Wall>, Vec<Error>> {
    let mut faults = Vec::new();
    let text = written(constraint);
    for (name, &value) in &constraint.terms {
        if !known.contains(name) {
            faults.push(Error::UnknownFactor { found: name.clone(), known: known.to_vec() });
        }
        if !value.is_finite() {
            faults.push(Error::NotFinite { what: format!("the coefficient of `{name}` in {text}"), value });
        }
    }
    if !constraint.at_most.is_finite() {
        faults.push(Error::NotFinite { what: format!("the bound of {text}"), value: constraint.at_most });
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let of = |f: &Factor| constraint.terms.get(&f.name).copied().unwrap_or(0.0);
    if factors.iter().any(|f| f.scale == Scale::Log && of(f) != 0.0) {
        return ratio(constraint, factors, text).map(Some).map_err(|fault| vec![fault]);
    }
    let normal: Vec<f64> = factors.iter().map(|f| of(f) * (f.high - f.low)).collect();
    let bound = constraint.at_most - factors.iter().map(|f| of(f) * f.low).sum::<f64>();
    let length = dot(&normal, &normal).sqrt();
    if length == 0.0 {
        let holds = bound >= 0.0;
        return if holds { Ok(None) } else { Err(vec![Error::Contradiction { constraints: vec![text] }]) };
    }
    Ok(Some((normal.iter().map(|a| a / length).collect(), bound / length, text)))
}

/// A bound or a ratio of parameters on logarithmic scales, which is linear there: a x ≤ b as ln x ≤ ln(b/a), and
/// a x ≤ b y as ln x − ln y ≤ ln(b/a).
fn ratio(constraint: &Linear, factors: &[Factor], text: String) -> Result<Wall, Error> {
    let terms: Vec<(usize, f64)> = factors
        .iter()
        .enumerate()
        .filter_map(|(i, f)| constraint.terms.get(&f.name).map(|&a| (i, a)))
        .filter(|(_, a)| *a != 0.0)
        .collect();
    let logarithmic = terms.iter().all(|(i, _)| factors[*i].scale == Scale::Log);
    let (over, under, limit) = match (&terms[..], constraint.at_most) {
        (&[(x, a)], b) if logarithmic && a * b > 0.0 => {
            (Some(x).filter(|_| a > 0.0), Some(x).filter(|_| a < 0.0), b / a)
        }
        (&[(x, a), (y, b)], 0.0) if logarithmic && a > 0.0 && b < 0.0 => (Some(x), Some(y), -b / a),
        (&[(y, b), (x, a)], 0.0) if logarithmic && a > 0.0 && b < 0.0 => (Some(x), Some(y), -b / a),
        _ => return Err(Error::NotLogarithmic { constraint: text }),
    };
    // ln x − ln y ≤ ln(limit), where a bound from below has no x and ln y ≥ ln(limit).
    let mut bound = if over.is_none() { -ln(limit) } else { ln(limit) };
    let mut normal = vec![0.0; factors.len()];
    for (sign, index) in [(1.0, over), (-1.0, under)] {
        if let Some(i) = index {
            normal[i] = sign * factors[i].span();
            bound -= sign * ln(factors[i].low);
        }
    }
    let length = dot(&normal, &normal).sqrt();
    Ok((normal.iter().map(|a| a / length).collect(), bound / length, text))
}

/// "sigma_c − 3 tau_c ≤ 0".
fn written(constraint: &Linear) -> String {
    let mut text = String::new();
    for (name, &a) in &constraint.terms {
        let sign = match (text.is_empty(), a < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let factor = if a.abs() == 1.0 { String::new() } else { format!("{} ", a.abs()) };
        text += &format!("{sign}{factor}{name}");
    }
    format!("{text} ≤ {}", constraint.at_most)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(name: &str, low: f64, high: f64) -> Factor {
        Factor::linear(name, low, high)
    }

    fn linear(terms: &[(&str, f64)], at_most: f64) -> Linear {
        Linear { terms: terms.iter().map(|(n, a)| ((*n).to_owned(), *a)).collect(), at_most }
    }

    #[test]
    fn all_faults_are_reported_at_once() {
        let factors = vec![factor("a", 2.0, 1.0), factor("b", 0.0, f64::NAN), factor("a", 0.0, 1.0)];
        let faults = Domain::new(factors, &[linear(&[("c", 1.0)], 0.0)]).expect_err("bad");
        let texts: Vec<String> = faults.iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "the range of `a` is empty: from 2 to 1; the lower end must be below the upper one",
                "an end of the range of `b` is NaN; a finite number is needed",
                "`a` is given twice",
                "unknown factor `c`; the factors are `a`, `b`, `a`"
            ]
        );
    }

    #[test]
    fn contradictory_constraints_are_named() {
        let factors = vec![factor("sigma_c", 10.0, 30.0), factor("tau_c", 10.0, 30.0)];
        let apart = [linear(&[("sigma_c", -1.0), ("tau_c", 2.0)], -45.0), linear(&[("tau_c", -1.0)], -5.0)];
        let faults = Domain::new(factors, &apart).expect_err("empty");
        assert_eq!(
            faults[0].to_string(),
            "no point of the box meets `−sigma_c + 2 tau_c ≤ -45`, `sigma_c ≤ 30`, `tau_c ≥ 10` together"
        );
    }

    #[test]
    fn repair_gives_the_nearest_allowed_point() {
        let domain =
            Domain::new(vec![factor("a", 0.0, 1.0), factor("b", 0.0, 1.0)], &[linear(&[("a", 1.0), ("b", 1.0)], 1.0)]);
        let domain = domain.expect("good");
        let near = |u: [f64; 2], v: [f64; 2]| {
            let r = domain.repair(&u);
            assert!((r[0] - v[0]).abs() < 1e-12 && (r[1] - v[1]).abs() < 1e-12, "{r:?}");
            assert!(domain.contains(&r));
        };
        near([0.2, 0.3], [0.2, 0.3]);
        near([0.8, 0.6], [0.6, 0.4]);
        near([2.0, 0.5], [0.75, 0.25]);
        near([-1.0, 0.5], [0.0, 0.5]);
    }

    /// k_s ≤ k_n / 2, k_s ≥ 10 and k_n ≤ 500 by logarithms: the walls are where the numbers say.
    #[test]
    fn ratios_and_bounds_hold_on_logarithmic_scales() {
        let factors = vec![Factor::log("kn", 1.0, 1e3), Factor::log("ks", 1.0, 1e3)];
        let walls =
            [linear(&[("ks", 2.0), ("kn", -1.0)], 0.0), linear(&[("ks", -1.0)], -10.0), linear(&[("kn", 0.5)], 250.0)];
        let domain = Domain::new(factors.clone(), &walls).expect("good");
        for (point, allowed) in [
            ([100.0, 49.9], true),
            ([100.0, 50.1], false),
            ([100.0, 10.01], true),
            ([100.0, 9.99], false),
            ([499.0, 20.0], true),
            ([501.0, 20.0], false),
        ] {
            assert_eq!(domain.contains(&domain.unit(&point)), allowed, "{point:?}");
        }
        let sum = Domain::new(factors, &[linear(&[("kn", 1.0), ("ks", 1.0)], 100.0)]).expect_err("not linear");
        assert_eq!(
            sum[0].to_string(),
            "kn + ks ≤ 100 names factors on a logarithmic scale, where only a bound of one factor or a ratio of two holds"
        );
    }

    #[test]
    fn the_ends_of_a_range_come_back_exactly() {
        let domain = Domain::new(vec![factor("a", 0.1, 0.7)], &[]).expect("good");
        assert_eq!((domain.natural(&[0.0]), domain.natural(&[1.0])), (vec![0.1], vec![0.7]));
        assert_eq!(
            domain.check(&[0.71]).map_err(|e| e.to_string()),
            Err("the point [0.71] leaves the domain: `a` = 0.71 is not within 0.1 … 0.7".into())
        );
    }
}
