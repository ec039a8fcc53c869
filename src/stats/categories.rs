//! Factors whose levels are names, in a regression: dummy (treatment) coding.
//!
//! A category of k levels becomes k − 1 terms `cement[B]`, 1 in the rows of level B and 0 elsewhere; the first level is
//! the reference, and the coefficient of `cement[B]` is the mean response at B minus that at the reference, all else
//! equal. A product with a category becomes the product with each of its terms. The number of a level never enters, so
//! no slope is drawn over an order that names do not have.
//!
//! Source: Draper and Smith, Applied Regression Analysis, 3rd ed., 1998, chapter 14.

use super::error::{Fault, Faults};
use super::sample::{Factor, Sample};
use super::terms::Term;

/// Name of the term of one level of a category.
pub fn dummy_name(factor: &str, level: &str) -> String {
    format!("{factor}[{level}]")
}

/// The table with each category that the terms use as dummy columns, and the terms on them.
///
/// # Errors
/// A power of a category.
pub(crate) fn spread(sample: &Sample, terms: &[Term]) -> Result<(Sample, Vec<Term>), Faults> {
    let used = |factor: &&Factor| factor.is_named() && terms.iter().any(|t| t.power_of(&factor.name) > 0);
    let categories: Vec<&Factor> = sample.factors.iter().filter(used).collect();
    let powers = terms.iter().flat_map(|term| {
        let power = categories.iter().filter(|f| term.power_of(&f.name) > 1);
        power.map(|f| Fault::PowerOfNames { term: term.to_string(), factor: f.name.clone() })
    });
    Faults::none_in(powers.collect())?;
    let mut wide = sample.clone();
    let mut spread: Vec<Term> = terms.to_vec();
    for factor in categories {
        let levels = levels_of(factor);
        let names: Vec<String> =
            levels.iter().skip(1).map(|&l| dummy_name(&factor.name, &factor.level_text(l))).collect();
        let column = |(name, &level): (&String, &f64)| Factor {
            // coded and natural units are the same: a dummy has no middle
            coding: Some((-1.0, 1.0)),
            ..Factor::new(name, factor.values.iter().map(|v| f64::from(u8::from(*v == level))).collect())
        };
        wide.factors.extend(names.iter().zip(&levels[1..]).map(column));
        spread = spread.iter().flat_map(|term| term.with_factor_as(&factor.name, &names)).collect();
    }
    Ok((wide, spread))
}

/// The levels that the rows have, the reference first: declared levels in their order, else by name.
fn levels_of(factor: &Factor) -> Vec<f64> {
    let mut levels = factor.all_levels();
    levels.sort_by_key(|level| factor.levels.iter().position(|l| l == level));
    levels
}

#[cfg(test)]
mod tests {
    use super::super::sample::Response;
    use super::*;

    fn table() -> Sample {
        Sample {
            factors: vec![
                Factor::named("cement", &["B", "A", "C", "A", "B", "C"]),
                Factor::new("w", vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            ],
            responses: vec![Response::new("y", vec![1.0; 6])],
            weights: None,
        }
    }

    #[test]
    fn one_column_per_level_but_the_first() {
        let terms = ["const", "cement", "w", "w*cement"].map(|t| Term::parse(t).unwrap());
        let (wide, spread) = super::spread(&table(), &terms).unwrap();
        let text: Vec<String> = spread.iter().map(Term::to_string).collect();
        assert_eq!(text, ["const", "cement[B]", "cement[C]", "w", "w*cement[B]", "w*cement[C]"]);
        assert_eq!(wide.factors[2].values, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(wide.factors[3].values, [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn the_first_declared_level_is_the_reference() {
        let mut table = table();
        table.factors[0].levels = vec![2.0, 0.0, 1.0];
        let (_, spread) = super::spread(&table, &[Term::parse("cement").unwrap()]).unwrap();
        assert_eq!(spread.iter().map(Term::to_string).collect::<Vec<_>>(), ["cement[A]", "cement[B]"]);
    }

    #[test]
    fn a_power_of_names_is_refused() {
        let Faults(faults) = super::spread(&table(), &[Term::parse("cement^2").unwrap()]).unwrap_err();
        assert_eq!(faults, [Fault::PowerOfNames { term: "cement^2".into(), factor: "cement".into() }]);
    }
}
