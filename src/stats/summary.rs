//! Plain values without a model: quartiles and whiskers of a box plot, bins of a histogram, mean and its interval.
//!
//! Quantiles are linear between the order statistics, `x(1 + (n − 1)p)` (type 7 of Hyndman and Fan 1996,
//! doi:10.1080/00031305.1996.10473566: the default of R and numpy). Whiskers end at the last value within 1.5
//! interquartile ranges of the box (Tukey, Exploratory Data Analysis, 1977). Bins have the width
//! `2·IQR/∛n` of Freedman and Diaconis 1981 (doi:10.1007/BF01025868), no less than `range/2√n` (long tails), or Sturges'
//! `range/(1 + log₂ n)` where that is narrower or the quartiles coincide: the rule "auto" of numpy 2.

use math::distribution::t_for_coverage;
use math::elementary::{cbrt, log10};

/// Five numbers of a box plot, the mean, and what lies beyond the whiskers.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub n: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation; `None` with fewer than two values.
    pub deviation: Option<f64>,
    /// End of the lower whisker.
    pub low: f64,
    /// First quartile.
    pub first: f64,
    /// Median.
    pub median: f64,
    /// Third quartile.
    pub third: f64,
    /// End of the upper whisker.
    pub high: f64,
    /// Values beyond the whiskers, ascending.
    pub beyond: Vec<f64>,
}

/// Whiskers reach this many interquartile ranges beyond the box.
const REACH: f64 = 1.5;

impl Summary {
    /// Of the finite values; `None` when there is none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let sorted = sorted(values);
        let n = sorted.len();
        let mean = sorted.iter().sum::<f64>() / n as f64;
        let squares: f64 = sorted.iter().map(|v| (v - mean) * (v - mean)).sum();
        let [first, median, third] = [0.25, 0.5, 0.75].map(|p| quantile_of(&sorted, p));
        let reach = REACH * (third - first);
        let inside = |v: &&f64| (first - reach..=third + reach).contains(*v);
        Some(Self {
            n,
            mean,
            deviation: (n > 1).then(|| (squares / (n - 1) as f64).sqrt()),
            low: *sorted.iter().find(inside)?,
            high: *sorted.iter().rev().find(inside)?,
            first,
            median,
            third,
            beyond: sorted.iter().filter(|v| !inside(v)).copied().collect(),
        })
    }

    /// Half of the confidence interval of the mean at a coverage such as 0.95; `None` with fewer than two values.
    pub fn half_interval(&self, coverage: f64) -> Option<f64> {
        let n = self.n as f64;
        self.deviation.map(|s| t_for_coverage(coverage, n - 1.0) * s / n.sqrt())
    }
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    finite
}

/// The quantile at `p` (0 … 1) of the finite values; NaN when there is none.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    quantile_of(&sorted(values), p)
}

fn quantile_of(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let rank = p * last as f64;
    let below = (rank.floor() as usize).min(last);
    let above = (below + 1).min(last);
    (sorted[above] - sorted[below]).mul_add(rank - below as f64, sorted[below])
}

/// A histogram: bin edges, one more than counts. A value on an inner edge counts above it, one on the last edge below.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Ends of the bins, ascending, at equal distances.
    pub edges: Vec<f64>,
    /// Values in each bin.
    pub counts: Vec<usize>,
}

/// More bins than this are not read.
const MOST_BINS: usize = 200;

/// The histogram of the finite values over `bins` bins, or over as many as the rule in the head of this file gives.
pub fn histogram(values: &[f64], bins: Option<usize>) -> Histogram {
    let sorted = sorted(values);
    let (Some(&low), Some(&high)) = (sorted.first(), sorted.last()) else {
        return Histogram { edges: vec![0.0, 1.0], counts: vec![0] };
    };
    // equal values share one bin of width 1
    let (low, high, best) =
        if high > low { (low, high, best_count(&sorted, high - low)) } else { (low - 0.5, low + 0.5, 1) };
    let count = bins.unwrap_or(best).clamp(1, MOST_BINS);
    let edges: Vec<f64> = (0..=count).map(|i| low + (high - low) * i as f64 / count as f64).collect();
    let mut counts = vec![0; count];
    for value in sorted {
        counts[edges[1..count].partition_point(|edge| *edge <= value)] += 1;
    }
    Histogram { edges, counts }
}

fn best_count(sorted: &[f64], range: f64) -> usize {
    let n = sorted.len() as f64;
    let sturges = range / (1.0 + log10(n) / log10(2.0));
    let spread = 2.0 * (quantile_of(sorted, 0.75) - quantile_of(sorted, 0.25)) / cbrt(n);
    let width = if spread > 0.0 { spread.max(0.5 * range / n.sqrt()).min(sturges) } else { sturges };
    (range / width).ceil() as usize
}
