//! Orthogonal arrays: tables in which every pair of columns shows all combinations of levels equally often.
//!
//! The arrays come from finite fields, Hadamard matrices and difference schemes ([`construct`] lists constructions and
//! sources; Hedayat, Sloane & Stufken 1999, *Orthogonal Arrays*, doi:10.1007/978-1-4612-1478-6, is the general
//! reference). A column of s levels may be replaced by the columns of an array of s runs, so mixed tables such as
//! L18(2^1 3^7), L32(2^1 4^9), L36(2^11 3^12) and L36(2^3 3^13) come out of the symmetrical ones, and L24(2^16 3^1) out of
//! L24(2^12 12^1) and L12(2^4 3^1).
//!
//! A factor with fewer levels than its column has the surplus levels merged into its own ones (Addelman 1962,
//! *Technometrics* 4, 21, doi:10.1080/00401706.1962.10489985): in L64(4^21) with three-level factors one level stands
//! in 32 runs and the others in 16, and every pair of factors keeps exactly proportional frequencies.
//! [`Orthogonal::doubled`] names them.
//!
//! When a table has more columns than there are factors, those are taken that entangle main effects least with
//! two-factor interactions (smallest A₃ of the generalized word-length pattern, one column after the other).

mod array;
mod assign;
mod catalogue;
mod construct;
mod shape;
#[cfg(test)]
mod tests;

use super::coding::Factor;
use super::error::Fault;
use super::table::{PointType, Points, Position};
use super::{Design, Stream};
use array::Array;
use catalogue::{STRENGTH_THREE, STRENGTH_TWO, splits};
use construct::Recipe;
use serde::{Deserialize, Serialize};
use shape::{Counts, count, name, parse};

/// Options of an orthogonal design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Orthogonal {
    /// The table, as `L18(2^1 3^7)` or `L18`; the smallest that has a column of exactly each factor's levels if left
    /// out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// Column of each factor, from 1, in the order of the factors; those that entangle least if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<Vec<usize>>,
    /// Where levels are merged: the level (from 1) that is met most often; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubled: Option<usize>,
    /// Strength 2 (every pair of columns) or 3 (every triple: main effects clear of two-factor interactions); 2 if left
    /// out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<usize>,
}

/// A table that was found: its array in the column order of its name.
struct Table {
    recipe: Recipe,
    name: String,
    array: Array,
}

const DESIGN: &str = "an orthogonal design";

impl Orthogonal {
    fn recipes(&self) -> Result<&'static [Recipe], Fault> {
        match self.strength {
            None | Some(2) => Ok(STRENGTH_TWO),
            Some(3) => Ok(STRENGTH_THREE),
            Some(other) => Err(Fault::BadOption {
                option: "strength".into(),
                found: other.to_string(),
                wanted: "tables are listed for strength 2 and 3; more is a full factorial".into(),
            }),
        }
    }

    /// The table for these factors.
    fn table(&self, factors: &[Factor]) -> Result<Table, Fault> {
        let recipes = self.recipes()?;
        let wanted = count(&factors.iter().map(Factor::level_count).collect::<Vec<_>>());
        let Some(said) = &self.table else {
            return smallest(recipes, &wanted).ok_or_else(|| no_table(recipes, factors, &wanted));
        };
        let (runs, columns) = parse(said).ok_or_else(|| Fault::BadOption {
            option: "table".into(),
            found: format!("\"{said}\""),
            wanted: "write it as \"L18(2^1 3^7)\" or \"L18\"".into(),
        })?;
        let of_size: Vec<Recipe> = recipes.iter().copied().filter(|r| r.runs() == runs).collect();
        let found = match &columns {
            Some(columns) => cut(&of_size, columns, true),
            None => cut(&of_size, &wanted, false).or_else(|| {
                let holds = |r: &&Recipe| assign::holds(&count(&r.shape()), factors);
                of_size.iter().find(holds).and_then(|r| cut(&[*r], &count(&r.shape()), true))
            }),
        };
        let Some(table) = found else {
            return Err(unknown_table(said, recipes, &of_size, columns.is_none(), factors));
        };
        if !assign::holds(&count(&table.levels()), factors) {
            let need: Vec<String> = wanted.iter().map(|(levels, n)| format!("{n} of {levels} levels")).collect();
            let fits = smallest(recipes, &wanted);
            return Err(Fault::NoConstruction {
                design: table.name,
                found: format!("it cannot hold {} factors ({})", factors.len(), need.join(", ")),
                remedy: fits.map_or("no table here holds them".into(), |t| format!("{} would", t.name)),
            });
        }
        Ok(table)
    }
}

impl Table {
    fn levels(&self) -> Vec<usize> {
        self.array.columns.iter().map(|c| c.levels).collect()
    }
}

/// The first of the recipes out of which the wanted columns can be cut; `exactly` these, or the others too.
fn cut(recipes: &[Recipe], wanted: &Counts, exactly: bool) -> Option<Table> {
    let (recipe, splits) = recipes.iter().find_map(|&recipe| splits(recipe, wanted).map(|s| (recipe, s)))?;
    let mut array = catalogue::build(recipe, &splits);
    array.columns.sort_by_key(|c| c.levels);
    if exactly {
        let mut left = wanted.clone();
        array.columns.retain(|c| left.get_mut(&c.levels).filter(|n| **n > 0).map(|n| *n -= 1).is_some());
    }
    let name = name(recipe.runs(), &count(&array.columns.iter().map(|c| c.levels).collect::<Vec<_>>()));
    Some(Table { recipe, name, array })
}

/// The smallest table with a column of exactly each factor's levels.
fn smallest(recipes: &[Recipe], wanted: &Counts) -> Option<Table> {
    cut(recipes, wanted, false)
}

/// No table fits exactly: name one that would with merged levels.
fn no_table(recipes: &[Recipe], factors: &[Factor], wanted: &Counts) -> Fault {
    let need: Vec<String> = wanted.iter().map(|(levels, n)| format!("{n} of {levels} levels")).collect();
    let merged = recipes.iter().find(|r| assign::holds(&count(&r.shape()), factors));
    Fault::NoConstruction {
        design: DESIGN.into(),
        found: format!("no table here has columns for {} factors ({})", factors.len(), need.join(", ")),
        remedy: match merged {
            Some(r) => format!(
                "`table = \"{}\"` would hold them with some levels met more often than others",
                name(r.runs(), &count(&r.shape()))
            ),
            None => "use fewer levels, or a Latin hypercube or Sobol sample".into(),
        },
    }
}

/// The table that was named is not known, or its size alone was named and none of that size fits.
fn unknown_table(said: &str, all: &[Recipe], of_size: &[Recipe], size_only: bool, factors: &[Factor]) -> Fault {
    let listed = if of_size.is_empty() { all } else { of_size };
    let names: Vec<String> = listed.iter().map(|r| name(r.runs(), &count(&r.shape()))).collect();
    let found = match (size_only, of_size.is_empty()) {
        (true, false) => format!("no table of that size has columns for the {} factors", factors.len()),
        _ => "no construction of this table is known here".into(),
    };
    Fault::NoConstruction {
        design: said.into(),
        found,
        remedy: format!("known are {}, and what comes of them by replacing a column by smaller ones", names.join(", ")),
    }
}

impl Design for Orthogonal {
    const NAME: &'static str = "orthogonal";

    fn points(&self, factors: &[Factor], _: &mut Stream) -> Result<Points, Vec<Fault>> {
        let table = self.table(factors).map_err(|fault| vec![fault])?;
        let columns = assign::columns(&table.array, factors, self.columns.as_deref())?;
        let merged: Vec<&Factor> = factors
            .iter()
            .zip(&columns)
            .filter(|(f, c)| f.level_count() < table.array.columns[**c].levels)
            .map(|(f, _)| f)
            .collect();
        let faults = self.doubled_faults(&merged);
        if !faults.is_empty() {
            return Err(faults);
        }
        let doubled = self.doubled.unwrap_or(1) - 1;
        let position = |run: usize, f: &Factor, c: &usize| {
            let (level, count) = (table.array.columns[*c].cells[run], f.level_count());
            // surplus levels are dealt out one by one, from the doubled level on
            Position::Level(if level < count { level } else { (doubled + level - count) % count })
        };
        let row = |run: usize| {
            let positions = factors.iter().zip(&columns).map(|(f, c)| position(run, f, c)).collect();
            (positions, PointType::Grid)
        };
        let numbers: Vec<String> = columns.iter().map(|c| (c + 1).to_string()).collect();
        let merging = match merged.first() {
            None => String::new(),
            Some(_) if merged.len() == factors.len() => {
                format!("; merged levels, level {} met most often", doubled + 1)
            }
            Some(_) => {
                let names: Vec<&str> = merged.iter().map(|f| f.name.as_str()).collect();
                format!("; merged levels in {}, level {} met most often", names.join(", "), doubled + 1)
            }
        };
        Ok(Points {
            rows: (0..table.recipe.runs()).map(row).collect(),
            centre: 0,
            construction: format!("{}, {}; columns {}{merging}", table.name, table.recipe.words(), numbers.join(", ")),
            source: table.recipe.source().into(),
        })
    }
}

impl Orthogonal {
    fn doubled_faults(&self, merged: &[&Factor]) -> Vec<Fault> {
        let Some(doubled) = self.doubled else { return vec![] };
        let fault = |wanted: String| Fault::BadOption { option: "doubled".into(), found: doubled.to_string(), wanted };
        if merged.is_empty() {
            return vec![fault(
                "every factor has a column of its own number of levels, so none is merged; leave it out".into(),
            )];
        }
        let short = merged.iter().filter(|f| doubled == 0 || doubled > f.level_count());
        short.map(|f| fault(format!("`{}` has the levels 1 to {}", f.name, f.level_count()))).collect()
    }
}
