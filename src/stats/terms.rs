//! Terms of a polynomial model: products of powers of factors, written `const`, `Ec`, `Ec^2`, `Ec*kn_ks`.

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

    /// Reads `const`, `Ec`, `Ec^2`, `Ec*kn_ks`.
    ///
    /// # Errors
    /// [`Fault::Term`] for anything else.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        if text.trim() == "const" {
            return Ok(Self::constant());
        }
        let fault = || Fault::Term { text: text.into() };
        let mut term = Self::constant();
        for part in text.split('*') {
            let (name, power) = match part.split_once('^') {
                None => (part.trim(), 1),
                Some((name, power)) => (name.trim(), power.trim().parse().map_err(|_| fault())?),
            };
            if name.is_empty() || power == 0 || power > 30 {
                return Err(fault());
            }
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

    /// Whether two terms are the same product, in whatever order it is written.
    pub fn same(&self, other: &Self) -> bool {
        self.contains(other) && other.contains(self)
    }
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
        for bad in ["", "a**b", "a^x", "a^0", "^2"] {
            assert_eq!(Term::parse(bad), Err(Fault::Term { text: bad.into() }));
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
