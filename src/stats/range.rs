//! Range analysis of an orthogonal table: mean response per level, its range over the levels, and the rank of factors.
//!
//! The mean of a level is over its usable rows (weighted where rows are means of replicates); the range of a factor is
//! its greatest level mean minus its least, in the unit of the response; rank 1 has the largest range, equal ranges
//! share a rank. Ranges of factors compare only as far as the table is balanced and all factors move over the span that
//! matters; no error is estimated here, [`super::anova`] does that.

use super::error::{Fault, Faults};
use super::sample::{Sample, Usable};
use serde::{Deserialize, Serialize};

/// One factor in the range analysis of one response.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// The response.
    pub response: String,
    /// The factor.
    pub factor: String,
    /// Its levels, ascending; 0, 1, 2 … where the levels are names.
    pub levels: Vec<f64>,
    /// What the levels are called.
    pub names: Vec<String>,
    /// Mean response at each level.
    pub means: Vec<f64>,
    /// Greatest mean minus least.
    pub range: f64,
    /// 1 for the factor with the largest range.
    pub rank: usize,
    /// Rows of the table without a value of this response.
    pub missing: usize,
}

/// Range analysis of every response for every factor, in the order of the table.
///
/// # Errors
/// All faults of the table: factors with one level, levels without a usable row, constant responses.
pub fn range_analysis(sample: &Sample) -> Result<Vec<Range>, Faults> {
    sample.check()?;
    let mut faults = Vec::new();
    let mut all = Vec::new();
    for (r, response) in sample.responses.iter().enumerate() {
        let usable = sample.usable(r);
        if let Some(fault) = sample.check_response(r, &usable, 1) {
            faults.push(fault);
            continue;
        }
        let found = level_faults(sample, &usable, &response.name);
        if !found.is_empty() {
            faults.extend(found);
            continue;
        }
        let mut ranges: Vec<Range> = (0..sample.factors.len()).map(|f| one(sample, &usable, r, f)).collect();
        let larger = |than: f64| ranges.iter().filter(|other| other.range > than).count();
        let ranks: Vec<usize> = ranges.iter().map(|own| 1 + larger(own.range)).collect();
        for (own, rank) in ranges.iter_mut().zip(ranks) {
            own.rank = rank;
        }
        all.extend(ranges);
    }
    Faults::none_in(faults)?;
    Ok(all)
}

/// Factors with one level, and levels without a usable row.
pub(crate) fn level_faults(sample: &Sample, usable: &Usable, response: &str) -> Vec<Fault> {
    let of_factor = |factor: &super::sample::Factor| {
        let found = factor.occurring(usable.rows.iter().copied());
        if let [value] = found[..] {
            return vec![Fault::OneLevel { factor: factor.name.clone(), value: factor.level_text(value) }];
        }
        let lost = factor.all_levels().into_iter().filter(|level| !found.contains(level));
        let fault = |level| Fault::EmptyLevel {
            factor: factor.name.clone(),
            level: factor.level_text(level),
            response: response.into(),
            missing: usable.missing,
        };
        lost.map(fault).collect()
    };
    sample.factors.iter().flat_map(of_factor).collect()
}

fn one(sample: &Sample, usable: &Usable, response: usize, factor: usize) -> Range {
    let column = &sample.factors[factor];
    let levels = column.all_levels();
    let mean = |&level: &f64| {
        let rows = usable.rows.iter().zip(&usable.values).filter(|(row, _)| column.values[**row] == level);
        let (sum, weights) = rows.fold((0.0, 0.0), |(sum, weights), (&row, value)| {
            (sum + sample.weight(row) * value, weights + sample.weight(row))
        });
        sum / weights
    };
    let means: Vec<f64> = levels.iter().map(mean).collect();
    let greatest = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = means.iter().copied().fold(f64::INFINITY, f64::min);
    Range {
        response: sample.responses[response].name.clone(),
        factor: column.name.clone(),
        names: levels.iter().map(|&level| column.level_text(level)).collect(),
        levels,
        means,
        range: greatest - least,
        rank: 0,
        missing: usable.missing,
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{Factor, Response};
    use super::*;

    /// Worked by hand: an L4 with one failed run.
    #[test]
    fn means_ranges_and_ranks() {
        let sample = Sample {
            factors: vec![
                Factor::new("a", vec![1.0, 1.0, 2.0, 2.0]),
                Factor::new("b", vec![1.0, 2.0, 1.0, 2.0]),
                Factor::new("c", vec![1.0, 2.0, 2.0, 1.0]),
            ],
            responses: vec![
                Response::new("y", vec![1.0, 3.0, 10.0, 12.0]),
                Response { name: "z".into(), values: vec![Some(1.0), None, Some(2.0), Some(5.0)] },
            ],
            weights: None,
        };
        let all = range_analysis(&sample).unwrap();
        let brief: Vec<_> = all.iter().map(|r| (r.means.clone(), r.range, r.rank, r.missing)).collect();
        assert_eq!(brief[0], (vec![2.0, 11.0], 9.0, 1, 0));
        assert_eq!(brief[1], (vec![5.5, 7.5], 2.0, 2, 0));
        assert_eq!(brief[2], (vec![6.5, 6.5], 0.0, 3, 0));
        assert_eq!(brief[3], (vec![1.0, 3.5], 2.5, 2, 1));
        assert_eq!(brief[4], (vec![1.5, 5.0], 3.5, 1, 1));
    }

    #[test]
    fn faults_name_factor_and_level() {
        let a = Factor::new("a", vec![1.0, 1.0, 2.0, 3.0]);
        let flat = Factor::new("b", vec![4.0; 4]);
        let y = Response { name: "y".into(), values: vec![Some(1.0), Some(2.0), Some(3.0), None] };
        let sample = Sample { factors: vec![a, flat], responses: vec![y], weights: None };
        let Faults(faults) = range_analysis(&sample).unwrap_err();
        assert_eq!(
            faults,
            [
                Fault::EmptyLevel { factor: "a".into(), level: "3".into(), response: "y".into(), missing: 1 },
                Fault::OneLevel { factor: "b".into(), value: "4".into() },
            ]
        );
    }
}
