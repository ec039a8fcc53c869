//! Rules that the rows of a design must obey: `valid = ["Ec/sigma_c <= 830", "ratio < 6.2", "Ec/scn in 0.14..1.36 GPa/MPa"]`.
//!
//! A rule compares two sides, or one side with bounds. Sides are formulas of the design's factors and quantities; factors
//! have their units, and both sides must be of one kind. Equality allows for rounding (10⁻¹² of the larger side).

use crate::expression::{Expression, Measure};
use crate::unit::{Dimension, Unit, parse_any, split_any};
use design::{DesignTable, Factor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What to do with rows that break a rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum InvalidRows {
    /// Refuse the design, and list the rows.
    #[default]
    Refuse,
    /// Leave them out, and list them in the table `left_out`.
    LeaveOut,
}

/// Largest rounding difference, as a fraction of the larger side.
const ROUNDING: f64 = 1e-12;

/// A rule that was read.
pub(super) struct Rule {
    text: String,
    left: Expression,
    relation: Relation,
    /// The unit of the quantity that it compares with, as it was written; empty without one.
    unit: String,
}

enum Relation {
    Below { strict: bool, right: Side },
    Above { strict: bool, right: Side },
    Within([Measure; 2]),
}

enum Side {
    Quantity(Measure),
    Formula(Expression),
}

/// A row that breaks a rule.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Broken {
    /// Index of the row in the table.
    pub(super) row: usize,
    /// The rule's text.
    pub(super) rule: String,
    /// Value of the left side in the row, in `unit`.
    pub(super) value: f64,
    /// The unit that the rule is written in; the SI unit where it compares two formulas. Empty for a pure number.
    pub(super) unit: String,
}

impl Rule {
    /// Reads a rule.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (left, relation) = if let Some((left, bounds)) = text.split_once(" in ") {
            (left, Relation::Within(bounds_of(bounds)?))
        } else {
            let found = ["<=", ">=", "<", ">"].into_iter().find_map(|op| Some((op, text.split_once(op)?)));
            let Some((op, (left, right))) = found else {
                return Err(format!(
                    "`{text}` is no rule; write for example \"Ec/sigma_c <= 830\" or \"mu in 0.2..1\""
                ));
            };
            let (strict, right) = (op.len() == 1, side(right)?);
            let below = op.starts_with('<');
            (left, if below { Relation::Below { strict, right } } else { Relation::Above { strict, right } })
        };
        let unit = match &relation {
            Relation::Within(_) => unit_of(text.rsplit_once("..").map_or("", |(_, high)| high)),
            Relation::Below { right: Side::Quantity(_), .. } | Relation::Above { right: Side::Quantity(_), .. } => {
                unit_of(text.trim_start_matches(left).trim_start_matches(['<', '>', '=']))
            }
            Relation::Below { .. } | Relation::Above { .. } => String::new(),
        };
        Ok(Self { text: text.to_owned(), left: Expression::parse(left.trim())?, relation, unit })
    }

    /// A left side as a number of the unit that the rule is written in, and that unit.
    fn shown(&self, left: Measure) -> (f64, String) {
        let dimension = left.dimension.unwrap_or(Dimension::NONE);
        let written = Unit::parse(&self.unit).ok().filter(|unit| unit.dimension == dimension);
        match written.filter(|_| !self.unit.is_empty()) {
            Some(unit) => (unit.of_si(left.value), self.unit.clone()),
            None if dimension == Dimension::NONE => (left.value, String::new()),
            None => (left.value, dimension.to_string()),
        }
    }

    /// The names that it uses.
    pub(super) fn names(&self) -> Vec<&String> {
        let right = match &self.relation {
            Relation::Below { right: Side::Formula(right), .. }
            | Relation::Above { right: Side::Formula(right), .. } => right.names(),
            _ => &[],
        };
        self.left.names().iter().chain(right).collect()
    }

    /// Its left side, and whether it holds.
    fn judge(&self, value: &dyn Fn(&str) -> Option<Measure>) -> Result<(Measure, bool), String> {
        let evaluate = |formula: &Expression| {
            let named = |name: &String| value(name).ok_or_else(|| format!("`{name}` is not a factor of the design"));
            formula.eval(&formula.names().iter().map(named).collect::<Result<Vec<_>, _>>()?)
        };
        let left = evaluate(&self.left)?;
        let against = |side: &Side| match side {
            Side::Quantity(quantity) => Ok(*quantity),
            Side::Formula(formula) => evaluate(formula),
        };
        // How far the left side lies above the right one; 0 where they are equal up to rounding.
        let above = |right: Measure| {
            left.alike(right).map_err(|misfit| format!("`{}`: {misfit}", self.text))?;
            let apart = left.value - right.value;
            let same = apart.abs() <= ROUNDING * left.value.abs().max(right.value.abs());
            Ok::<f64, String>(if same { 0.0 } else { apart })
        };
        let holds = match &self.relation {
            Relation::Below { strict, right } => {
                let above = above(against(right)?)?;
                above < 0.0 || (!strict && above == 0.0)
            }
            Relation::Above { strict, right } => {
                let above = above(against(right)?)?;
                above > 0.0 || (!strict && above == 0.0)
            }
            Relation::Within([low, high]) => above(*low)? >= 0.0 && above(*high)? <= 0.0,
        };
        Ok((left, holds))
    }

    /// The rows of a table that break it.
    pub(super) fn broken(&self, table: &DesignTable) -> Result<Vec<Broken>, String> {
        let units = table.factors.iter().map(|factor| Unit::parse(&factor.unit).map_err(|e| e.to_string()));
        let units = units.collect::<Result<Vec<_>, _>>()?;
        let mut broken = Vec::new();
        for (row, values) in table.natural.iter().enumerate() {
            let value = |name: &str| {
                let place = table.factors.iter().position(|factor| factor.name == name)?;
                Some(Measure::of(values[place] * units[place].factor, units[place].dimension))
            };
            let (left, holds) = self.judge(&value)?;
            if !holds {
                let (value, unit) = self.shown(left);
                broken.push(Broken { row, rule: self.text.clone(), value, unit });
            }
        }
        Ok(broken)
    }
}

/// The unit behind the number of a quantity.
fn unit_of(text: &str) -> String {
    split_any(text).map_or("", |(_, unit)| unit.trim()).to_owned()
}

fn side(text: &str) -> Result<Side, String> {
    let text = text.trim();
    match parse_any(text) {
        Ok((value, dimension)) => Ok(Side::Quantity(Measure::of(value, dimension))),
        Err(error) => match Expression::parse(text) {
            Ok(formula) if !formula.names().is_empty() => Ok(Side::Formula(formula)),
            _ => Err(error.to_string()),
        },
    }
}

/// Bounds such as `0.14..1.36 GPa/MPa`: the unit at the end holds for both unless the first has its own.
fn bounds_of(text: &str) -> Result<[Measure; 2], String> {
    let Some((low, high)) = text.split_once("..") else {
        return Err(format!("`{text}` are no bounds; write for example 0.2..1 or 10..30 MPa"));
    };
    let measure = |text: &str| {
        let (value, dimension) = parse_any(text).map_err(|e| e.to_string())?;
        Ok::<Measure, String>(Measure::of(value, dimension))
    };
    let (low, high) = (low.trim(), high.trim());
    let high_number = high.split_whitespace().next().unwrap_or_default();
    let unit = high.strip_prefix(high_number).unwrap_or_default();
    let low = if low.parse::<f64>().is_ok() { measure(&format!("{low}{unit}"))? } else { measure(low)? };
    let high = measure(high)?;
    low.alike(high).map_err(|misfit| misfit.to_string())?;
    Ok([low, high])
}

/// The rules that were read, and the rows that break them in the order of the rows.
///
/// # Errors
/// A rule that cannot be read or judged.
pub(super) fn broken(rules: &[String], table: &DesignTable) -> Result<Vec<Broken>, String> {
    let mut all = Vec::new();
    for rule in rules {
        all.extend(Rule::parse(rule)?.broken(table)?);
    }
    all.sort_by_key(|broken| broken.row);
    Ok(all)
}

/// A number with ten digits, so that what breaks a rule by little differs from the bound.
fn short(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

/// A row that breaks a rule, in words.
pub(super) fn told(broken: &Broken, table: &DesignTable) -> String {
    let value =
        |(factor, value): (&Factor, &f64)| format!("{} = {value} {}", factor.name, factor.unit).trim_end().to_owned();
    let values: Vec<String> = table.factors.iter().zip(&table.natural[broken.row]).map(value).collect();
    let left = format!("{} {}", short(broken.value), broken.unit);
    format!("row {} breaks `{}`: {} (left side {})", broken.row + 1, broken.rule, values.join(", "), left.trim_end())
}

/// The table without some of its rows.
pub(super) fn without(table: &DesignTable, broken: &[Broken]) -> DesignTable {
    let stays = |row: &usize| broken.iter().all(|broken| broken.row != *row);
    let rows: Vec<usize> = (0..table.runs()).filter(stays).collect();
    DesignTable {
        factors: table.factors.clone(),
        coded: rows.iter().map(|&row| table.coded[row].clone()).collect(),
        natural: rows.iter().map(|&row| table.natural[row].clone()).collect(),
        point_type: rows.iter().map(|&row| table.point_type[row]).collect(),
        standard_order: rows.iter().map(|&row| table.standard_order[row]).collect(),
        construction: format!("{}, {} rows that break a rule left out", table.construction, table.runs() - rows.len()),
        source: table.source.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(rule: &str, ec: &str, scn: &str) -> Result<bool, String> {
        let measure = |text: &str| parse_any(text).map(|(value, dimension)| Measure::of(value, dimension)).ok();
        let value = |name: &str| match name {
            "Ec" => measure(ec),
            "scn" => measure(scn),
            _ => None,
        };
        Rule::parse(rule)?.judge(&value).map(|(_, holds)| holds)
    }

    #[test]
    fn rules_compare_with_units_and_up_to_rounding() {
        let of = |rule: &str| judged(rule, "24.9 GPa", "30 MPa").unwrap();
        assert!(of("Ec/scn <= 830") && of("Ec/scn >= 830") && !of("Ec/scn < 830") && !of("Ec/scn > 830"));
        assert!(
            of("Ec/scn in 0.14..1.36 GPa/MPa") && of("Ec/scn in 0.83..1 GPa/MPa") && !of("Ec/scn in 0.84..1 GPa/MPa")
        );
        assert!(of("Ec <= 25 GPa") && !of("Ec <= 24 GPa") && of("scn < Ec") && of("2*scn in 10 MPa..0.1 GPa"));
    }

    #[test]
    fn a_left_side_is_shown_in_the_unit_that_the_rule_is_written_in() {
        let shown = |rule: &str| {
            let measure = |text: &str| parse_any(text).map(|(value, dimension)| Measure::of(value, dimension)).ok();
            let value = |name: &str| measure(if name == "Ec" { "24.9 GPa" } else { "30 MPa" });
            let rule = Rule::parse(rule).unwrap();
            let (value, unit) = rule.shown(rule.judge(&value).unwrap().0);
            format!("{} {unit}", short(value))
        };
        assert_eq!(shown("Ec <= 24 GPa"), "24.9 GPa");
        assert_eq!(shown("Ec>=26000MPa"), "24900 MPa");
        assert_eq!(shown("Ec/scn in 0.84..1 GPa/MPa"), "0.83 GPa/MPa");
        assert_eq!(shown("Ec/scn < 800"), "830 ");
        assert_eq!(shown("Ec < 2*scn"), "24900000000 Pa");
        assert_eq!(shown("scn in 10 MPa..0.02 GPa"), "0.03 GPa");
    }

    #[test]
    fn rules_that_make_no_sense_are_told() {
        let of = |rule: &str| judged(rule, "24.9 GPa", "30 MPa").unwrap_err();
        assert!(of("Ec/scn = 830").contains("is no rule"));
        assert_eq!(of("Ec < 830"), "`Ec < 830`: Pa and a pure number cannot be added or compared");
        assert_eq!(of("mu < 1"), "`mu` is not a factor of the design");
        assert!(of("Ec in 3 GPa").contains("are no bounds"));
        assert!(of("Ec in 3 m..4 GPa").contains("cannot be added or compared"));
    }
}
