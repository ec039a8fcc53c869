//! Terms of a polynomial model: products of powers of factors, written `const`, `Ec`, `Ec^2`, `Ec*kn_ks`.
//!
//! What stands between the products may also be a formula, such as `scn/(1+ratio)`: it is one factor of the term, and
//! the caller computes its column. A sum or difference outside brackets makes the whole text one formula.

use super::error::Fault;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A product of powers of factors; empty for the constant.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Term {
    /// Factor names with their powers ≥ 1, each name once.
    powers: Vec<(String, u32)>,
}

impl Term {
    /// The constant.
    pub fn constant() -> Self {
        Self::default()
    }

    /// The factor to some power.
    pub fn power(factor: &str, power: u32) -> Self {
        Self { powers: vec![(factor.into(), power)] }
    }

    /// The product of two factors.
    pub fn product(a: &str, b: &str) -> Self {
        Self { powers: vec![(a.into(), 1), (b.into(), 1)] }
    }

    /// The constant and every factor.
    pub fn first_order(factors: &[impl AsRef<str>]) -> Vec<Self> {
        let linear = factors.iter().map(|f| Self::power(f.as_ref(), 1));
        std::iter::once(Self::constant()).chain(linear).collect()
    }

    /// The constant, every factor and every product of two factors.
    pub fn interactions(factors: &[impl AsRef<str>]) -> Vec<Self> {
        let mut terms = Self::first_order(factors);
        terms.extend(pairs(factors));
        terms
    }

    /// A full second-order surface: constant, linear terms, squares, products of two, in that order.
    pub fn second_order(factors: &[impl AsRef<str>]) -> Vec<Self> {
        let mut terms = Self::first_order(factors);
        terms.extend(factors.iter().map(|f| Self::power(f.as_ref(), 2)));
        terms.extend(pairs(factors));
        terms
    }

    /// Reads `const`, `Ec`, `Ec^2`, `Ec*kn_ks`, `scn/(1+ratio)`.
    ///
    /// # Errors
    /// [`Fault::Term`] for anything else.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        if text.trim() == "const" {
            return Ok(Self::constant());
        }
        let fault = || Fault::Term { text: text.into() };
        let mut term = Self::constant();
        for part in parts(text).ok_or_else(fault)? {
            let (name, power) = base_and_power(part).ok_or_else(fault)?;
            match term.powers.iter_mut().find(|(known, _)| known == name) {
                Some((_, known)) => *known += power,
                None => term.powers.push((name.into(), power)),
            }
        }
        Ok(term)
    }

    /// The power of a factor, 0 when the term does not contain it.
    pub fn power_of(&self, factor: &str) -> u32 {
        self.powers.iter().find(|(name, _)| name == factor).map_or(0, |&(_, power)| power)
    }

    /// The sum of its powers: 0 for the constant, 2 for a square or a product of two factors.
    pub fn degree(&self) -> u32 {
        self.powers.iter().map(|(_, power)| power).sum()
    }

    /// The names of its factors.
    pub fn factors(&self) -> impl Iterator<Item = &str> {
        self.powers.iter().map(|(name, _)| name.as_str())
    }

    /// Whether `part` divides this term (every term contains itself and the constant).
    pub fn contains(&self, part: &Self) -> bool {
        part.powers.iter().all(|(name, power)| self.power_of(name) >= *power)
    }

    /// The terms of one degree less that divide this one: what hierarchy asks for beside it.
    pub fn parents(&self) -> Vec<Self> {
        let lowered = |i: usize| {
            let mut term = self.clone();
            term.powers[i].1 -= 1;
            term.powers.retain(|&(_, power)| power > 0);
            term
        };
        (0..self.powers.len()).map(lowered).collect()
    }

    /// The terms that stand for this one when `factor` is replaced by each of `names`; itself without the factor.
    pub(crate) fn with_factor_as(&self, factor: &str, names: &[String]) -> Vec<Self> {
        let Some(index) = self.powers.iter().position(|(name, _)| name == factor) else { return vec![self.clone()] };
        let replaced = |name: &String| {
            let mut term = self.clone();
            term.powers[index].0.clone_from(name);
            term
        };
        names.iter().map(replaced).collect()
    }

    /// Whether two terms are the same product, in whatever order it is written.
    pub fn same(&self, other: &Self) -> bool {
        self.contains(other) && other.contains(self)
    }
}

/// The factors of a product as written; a sum outside brackets is one part. `None` where brackets do not close.
fn parts(text: &str) -> Option<Vec<&str>> {
    let (mut depth, mut start, mut found, mut before) = (0_i32, 0, Vec::new(), None);
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            '+' | '-' if depth == 0 && is_sum(text, at, before) => return balanced(text).then(|| vec![text.trim()]),
            '*' if depth == 0 => {
                found.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
        before = if c.is_whitespace() { before } else { Some(c) };
    }
    found.push(text[start..].trim());
    balanced(text).then_some(found)
}

/// Whether the sign at `at` adds: it follows an operand, and is not the exponent's of `1e-3`.
fn is_sum(text: &str, at: usize, before: Option<char>) -> bool {
    let operand = before.is_some_and(|c| !"+-*/^(".contains(c));
    let mut last = text[..at].chars().rev();
    let exponent = last.next().is_some_and(|c| c == 'e' || c == 'E') && last.next().is_some_and(|c| c.is_ascii_digit());
    operand && !exponent
}

/// Whether every bracket closes.
fn balanced(text: &str) -> bool {
    let depth = text.chars().try_fold(0_i32, |depth, c| {
        let depth = depth + i32::from(c == '(' || c == '[') - i32::from(c == ')' || c == ']');
        (depth >= 0).then_some(depth)
    });
    depth == Some(0)
}

/// A factor and its power, 1 where none is written. A power inside a formula, as in `a^2/(1+b)`, belongs to it.
fn base_and_power(part: &str) -> Option<(&str, u32)> {
    let name = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let (base, power) = match part.rsplit_once('^') {
        Some((base, power)) if power.trim().bytes().all(|b| b.is_ascii_digit()) => {
            (base.trim(), power.trim().parse().ok()?)
        }
        Some((base, power)) if power.trim().chars().all(name) || base.trim().is_empty() => return None,
        _ => (part, 1),
    };
    (!base.is_empty() && (1..=30).contains(&power)).then_some((base, power))
}

/// Every product of two factors.
fn pairs(factors: &[impl AsRef<str>]) -> Vec<Term> {
    let mut found = Vec::new();
    for (i, a) in factors.iter().enumerate() {
        found.extend(factors[i + 1..].iter().map(|b| Term::product(a.as_ref(), b.as_ref())));
    }
    found
}

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.powers.is_empty() {
            return f.write_str("const");
        }
        for (i, (name, power)) in self.powers.iter().enumerate() {
            f.write_str(if i == 0 { "" } else { "*" })?;
            f.write_str(name)?;
            if *power > 1 {
                write!(f, "^{power}")?;
            }
        }
        Ok(())
    }
}

impl TryFrom<String> for Term {
    type Error = Fault;
    fn try_from(text: String) -> Result<Self, Fault> {
        Self::parse(&text)
    }
}

impl From<Term> for String {
    fn from(term: Term) -> Self {
        term.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_read_back_as_written() {
        for text in ["const", "Ec", "Ec^2", "Ec*kn_ks", "a^2*b*c^3"] {
            assert_eq!(Term::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(Term::parse(" a * a ").unwrap().to_string(), "a^2");
        for bad in ["", "a**b", "a^x", "a^0", "^2", "a^", "(a", "a)*(b"] {
            assert_eq!(Term::parse(bad), Err(Fault::Term { text: bad.into() }));
        }
    }

    #[test]
    fn formulas_are_factors() {
        let names = |text: &str| Term::parse(text).unwrap().factors().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(names("scn/(1+ratio)"), ["scn/(1+ratio)"]);
        assert_eq!(names("tau*scn/(1+ratio)"), ["tau", "scn/(1+ratio)"]);
        assert_eq!(names("a + b*c"), ["a + b*c"]);
        assert_eq!(names("sqrt(a*b)*c"), ["sqrt(a*b)", "c"]);
        assert_eq!(names("a^2/(1+b)"), ["a^2/(1+b)"]);
        assert_eq!(names("a*1e-3"), ["a", "1e-3"]);
        assert_eq!(names("cement[CEM I*2]*water"), ["cement[CEM I*2]", "water"]);
        let square = Term::parse("(a/b)^2").unwrap();
        assert_eq!((square.power_of("(a/b)"), square.to_string().as_str()), (2, "(a/b)^2"));
        for text in ["scn/(1+ratio)", "tau*scn/(1+ratio)", "a - b*c", "a^2/(1+b)"] {
            let term = Term::parse(text).unwrap();
            assert!(Term::parse(&term.to_string()).unwrap().same(&term), "{text}");
        }
    }

    #[test]
    fn a_surface_of_five_factors_has_21_terms() {
        let terms = Term::second_order(&["a", "b", "c", "d", "e"]);
        assert_eq!(terms.len(), 21);
        let text: Vec<String> = terms.iter().map(Term::to_string).collect();
        assert_eq!(text[..8], ["const", "a", "b", "c", "d", "e", "a^2", "b^2"]);
        assert_eq!(text[20], "d*e");
    }

    #[test]
    fn hierarchy() {
        let term = Term::parse("a^2*b").unwrap();
        let parents: Vec<String> = term.parents().iter().map(Term::to_string).collect();
        assert_eq!(parents, ["a*b", "a^2"]);
        assert!(Term::parse("b*a").unwrap().same(&Term::parse("a*b").unwrap()));
    }
}
