//! The table that is analysed: factors, responses, weights, and which rows are missing.

use super::error::{Fault, Faults};
use math::scale::Scale;
use math::text::typed;

/// A column that was set by the experimenter.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Its name, as in the table.
    pub name: String,
    /// One value per row, in the unit of the table.
    pub values: Vec<f64>,
    /// The declared levels, which no row may leave; empty when whatever occurs is a level.
    pub levels: Vec<f64>,
    /// The values that stand for −1 and +1 in coded units; `None` takes the least and greatest that occur.
    pub coding: Option<(f64, f64)>,
    /// How a regression takes its values; analyses of levels do not look at it.
    pub scale: Scale,
    /// Names of the levels 0, 1, 2 … of a category such as the kind of cement; empty when the values are numbers.
    pub labels: Vec<String>,
}

impl Factor {
    /// A factor whose levels are the values that occur.
    pub fn new(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), values, levels: Vec::new(), coding: None, scale: Scale::Linear, labels: Vec::new() }
    }

    /// A factor whose values are names; its levels are the names that occur, in alphabetical order.
    pub fn named(name: &str, values: &[impl AsRef<str>]) -> Self {
        let mut labels: Vec<String> = values.iter().map(|v| v.as_ref().to_owned()).collect();
        labels.sort();
        labels.dedup();
        Self::of_labels(name, values, labels)
    }

    /// A factor whose values are names, with its levels in the order given; a name that is none of them has no number.
    pub fn of_labels(name: &str, values: &[impl AsRef<str>], labels: Vec<String>) -> Self {
        let number = |value: &str| labels.iter().position(|l| l == value).map_or(f64::NAN, |i| i as f64);
        Self { labels: labels.clone(), ..Self::new(name, values.iter().map(|v| number(v.as_ref())).collect()) }
    }

    /// Whether its values are names of levels.
    pub fn is_named(&self) -> bool {
        !self.labels.is_empty()
    }

    /// A level as it is called: its name, or its number.
    pub fn level_text(&self, level: f64) -> String {
        let name = self.labels.get(level as usize).filter(|_| level >= 0.0);
        name.cloned().unwrap_or_else(|| typed(level))
    }

    /// The levels that occur in `rows`, ascending.
    pub(crate) fn occurring(&self, rows: impl IntoIterator<Item = usize>) -> Vec<f64> {
        let mut found: Vec<f64> = Vec::new();
        for row in rows {
            let value = self.values[row] + 0.0;
            if let Err(index) = found.binary_search_by(|level| level.total_cmp(&value)) {
                found.insert(index, value);
            }
        }
        found
    }

    /// The levels that occur in the table, ascending.
    pub(crate) fn all_levels(&self) -> Vec<f64> {
        self.occurring(0..self.values.len())
    }
}

/// A column that was measured. `None` is a run that failed or was not done.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Its name, as in the table.
    pub name: String,
    /// One value per row.
    pub values: Vec<Option<f64>>,
}

impl Response {
    /// A response without missing rows.
    pub fn new(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), values: values.into_iter().map(Some).collect() }
    }
}

/// A table of runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// What was set.
    pub factors: Vec<Factor>,
    /// What was measured.
    pub responses: Vec<Response>,
    /// Weight of each row: the number of replicates that a row is the mean of. `None` is 1 everywhere.
    pub weights: Option<Vec<f64>>,
}

/// The rows in which a response has a value, and how many have none.
pub(crate) struct Usable {
    /// Row numbers from 0, ascending.
    pub rows: Vec<usize>,
    /// The values in those rows.
    pub values: Vec<f64>,
    /// How many rows have no value.
    pub missing: usize,
}

impl Usable {
    /// The largest value by size.
    pub(crate) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    /// Largest value minus smallest.
    pub(crate) fn spread(&self) -> f64 {
        let low = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
    }

    /// One unit in the last digit of the largest value: doubles between it and the next one do not exist.
    pub(crate) fn last_digit(&self) -> f64 {
        let largest = self.largest();
        largest.next_up() - largest
    }
}

/// Fewer units of the last digit than this between the smallest and the largest response are no spread to analyse.
const FEWEST_UNITS: f64 = 16.0;

impl Sample {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.factors.first().map_or_else(|| self.responses.first().map_or(0, |r| r.values.len()), |f| f.values.len())
    }

    /// The factor of that name.
    ///
    /// # Errors
    /// [`Fault::Unknown`] with the names there are.
    pub fn factor(&self, name: &str) -> Result<usize, Fault> {
        self.factors.iter().position(|f| f.name == name).ok_or_else(|| Fault::Unknown {
            what: "factor",
            name: name.into(),
            known: self.factors.iter().map(|f| f.name.clone()).collect(),
        })
    }

    /// The table of some of its rows.
    #[must_use]
    pub fn with_rows(&self, rows: &[usize]) -> Self {
        let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect();
        let factor = |f: &Factor| Factor { values: pick(&f.values), ..f.clone() };
        let response =
            |r: &Response| Response { name: r.name.clone(), values: rows.iter().map(|&row| r.values[row]).collect() };
        Self {
            factors: self.factors.iter().map(factor).collect(),
            responses: self.responses.iter().map(response).collect(),
            weights: self.weights.as_deref().map(pick),
        }
    }

    /// The response of that name.
    ///
    /// # Errors
    /// [`Fault::Unknown`] with the names there are.
    pub fn response(&self, name: &str) -> Result<usize, Fault> {
        self.responses.iter().position(|r| r.name == name).ok_or_else(|| Fault::Unknown {
            what: "response",
            name: name.into(),
            known: self.responses.iter().map(|r| r.name.clone()).collect(),
        })
    }

    /// Checks names, lengths, finiteness, declared levels and weights.
    ///
    /// # Errors
    /// Every fault of the table.
    pub fn check(&self) -> Result<(), Faults> {
        let mut faults = self.doubled_names();
        let rows = self.rows();
        let lengths = self.factors.iter().map(|f| (f.name.as_str(), f.values.len()));
        let lengths = lengths.chain(self.responses.iter().map(|r| (r.name.as_str(), r.values.len())));
        let lengths = lengths.chain(self.weights.iter().map(|w| ("weights", w.len())));
        for (column, found) in lengths {
            if found != rows {
                faults.push(Fault::Length { column: column.into(), found, expected: rows });
            }
        }
        for factor in &self.factors {
            faults.extend(factor.values.iter().enumerate().filter_map(|(i, &value)| bad_setting(factor, i, value)));
        }
        for response in &self.responses {
            faults.extend(response.values.iter().enumerate().filter_map(|(i, value)| {
                let value = value.filter(|v| !v.is_finite())?;
                Some(Fault::NotFinite { column: response.name.clone(), row: i + 1, value })
            }));
        }
        faults.extend(self.factors.iter().filter_map(|factor| magnitude(&factor.name, &factor.values, false)));
        for response in &self.responses {
            let values: Vec<f64> = response.values.iter().flatten().copied().collect();
            faults.extend(magnitude(&response.name, &values, true));
        }
        for (i, &value) in self.weights.iter().flatten().enumerate() {
            if !(value.is_finite() && value > 0.0) {
                faults.push(Fault::Weight { row: i + 1, value });
            }
        }
        Faults::none_in(faults)
    }

    fn doubled_names(&self) -> Vec<Fault> {
        let names: Vec<&String> =
            self.factors.iter().map(|f| &f.name).chain(self.responses.iter().map(|r| &r.name)).collect();
        let doubled = |i: usize| names[..i].contains(&names[i]);
        let found = (0..names.len()).filter(|&i| doubled(i));
        found.map(|i| Fault::DuplicateName { name: names[i].clone() }).collect()
    }

    /// The rows in which the response has a value.
    pub(crate) fn usable(&self, response: usize) -> Usable {
        let all = &self.responses[response].values;
        let rows: Vec<usize> = (0..all.len()).filter(|&i| all[i].is_some()).collect();
        let values = all.iter().flatten().copied().collect();
        Usable { missing: all.len() - rows.len(), rows, values }
    }

    /// A table without enough rows, a constant response, or one whose differences are but its rounding.
    pub(crate) fn check_response(&self, response: usize, usable: &Usable, terms: usize) -> Option<Fault> {
        let name = self.responses[response].name.clone();
        let (rows, missing) = (usable.rows.len(), usable.missing);
        if rows < terms.max(1) {
            return Some(Fault::TooFewRows { response: name, rows, missing, terms });
        }
        let value = usable.values[0];
        let constant = usable.values.iter().all(|&v| v == value);
        if constant {
            return Some(Fault::ConstantResponse { response: name, value, rows });
        }
        let (largest, spread) = (usable.largest(), usable.spread());
        (spread < FEWEST_UNITS * usable.last_digit()).then(|| {
            let lost = math::elementary::log10(largest / spread);
            Fault::DigitsLost { response: name, size: format!("{largest:.0e}"), spread, lost: format!("{lost:.1}") }
        })
    }

    /// The weight of a row.
    pub(crate) fn weight(&self, row: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |w| w[row])
    }
}

/// Sizes between which sums of squares, and the products of their parts in double length, are numbers.
const SIZES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// A column of which squares would be infinite or nothing: by its largest value or, where squares about the mean are
/// taken, by its spread.
fn magnitude(column: &str, values: &[f64], about_mean: bool) -> Option<Fault> {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let largest = finite().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let [low, high] = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
    let spread = high - low;
    let size = if largest > *SIZES.end() {
        largest
    } else if about_mean && spread > 0.0 && spread < *SIZES.start() {
        spread
    } else {
        return None;
    };
    Some(Fault::Magnitude { column: column.to_owned(), size: format!("{size:.0e}") })
}

/// A factor's value that is not finite or not one of its declared levels.
fn bad_setting(factor: &Factor, index: usize, value: f64) -> Option<Fault> {
    let row = index + 1;
    if !value.is_finite() {
        return Some(Fault::NotFinite { column: factor.name.clone(), row, value });
    }
    let known = factor.levels.is_empty() || factor.levels.contains(&value);
    (!known).then(|| Fault::UndeclaredLevel { factor: factor.name.clone(), row, value, levels: factor.levels.clone() })
}
