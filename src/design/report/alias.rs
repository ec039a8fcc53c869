//! Aliases of main effects.
//!
//! When the model y = X₁β₁ (constant and slopes) is fitted although X₂β₂ (squares, products of two) also acts, the
//! estimates have the expectation β₁ + Aβ₂ with the alias matrix A = (X₁ᵀX₁)⁻¹X₁ᵀX₂ (Box & Wilson 1951,
//! doi:10.1111/j.2517-6161.1951.tb00067.x). In a regular fraction its entries are 0 and ±1, in a Plackett–Burman design
//! also ±1/3 and the like.

use super::model::Model;
use super::tidy;
use crate::table::DesignTable;

/// One entry of the alias matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Alias {
    /// The term of the first-order model: a factor, or `const`.
    pub main: String,
    /// The term that is left out.
    pub with: String,
    /// How much of its coefficient goes into that of `main`, coded units.
    pub coefficient: f64,
}

/// Entries below this are rounding.
const NOTHING: f64 = 1e-9;
/// More products of columns than this are not searched.
const MOST_WORK: f64 = 4e9;

/// Every alias of the slopes that is not 0, by slope and descending size. The constant is left out: squares always add
/// to it. None when there are too many runs and factors to compute it. `model` is the one of main effects.
pub fn aliases(table: &DesignTable, model: &Model) -> Option<Vec<Alias>> {
    let k = table.factors.len();
    let pairs = (k * (k + 1) / 2) as f64;
    if pairs * table.runs() as f64 * k as f64 > MOST_WORK {
        return None;
    }
    let name = |j: usize| table.factors[j].name.as_str();
    let mut found: Vec<Vec<Alias>> = vec![Vec::new(); k + 1];
    for a in 0..k {
        for b in a..k {
            let column: Vec<f64> = table.coded.iter().map(|r| r[a] * r[b]).collect();
            let with = || if a == b { format!("{}^2", name(a)) } else { format!("{}*{}", name(a), name(b)) };
            for (&term, coefficient) in model.independent.iter().zip(model.fit(&column)) {
                let coefficient = tidy(coefficient);
                if coefficient.abs() > NOTHING && term > 0 {
                    found[term].push(Alias { main: model.terms[term].clone(), with: with(), coefficient });
                }
            }
        }
    }
    for list in &mut found {
        // sizes that differ by rounding keep the order of the terms
        list.sort_by_key(|a| std::cmp::Reverse((a.coefficient.abs() * 1e9).round() as i64));
    }
    Some(found.concat())
}
