//! How well one set of values agrees with another: computed with published, predicted with observed.
//!
//! The ratio ρᵢ = yᵢ/xᵢ of each pair is summed up by its quartiles (linear interpolation between order statistics,
//! Hyndman & Fan 1996, type 7, doi:10.1080/00031305.1996.10473566), mean and standard deviation; the order of the values
//! by Spearman's rank correlation (equal values share their mean rank). What the ratio depends on is asked of a
//! regression: 100 ln ρ against the factors, [`super::regression`].

use math::distribution::t_for_coverage;
use math::elementary::{exp, ln};
use math::sample::Moments;

/// Agreement of pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Pairs.
    pub n: usize,
    /// First quartile, median and third quartile of y/x.
    pub quartiles: [f64; 3],
    /// Least and greatest y/x.
    pub extremes: [f64; 2],
    /// Mean of y/x.
    pub mean: f64,
    /// Its standard deviation; `None` of one pair.
    pub deviation: Option<f64>,
    /// Rank correlation; `None` where either side is constant.
    pub spearman: Option<f64>,
}

/// Agreement of `y` with `x`, pairs without a ratio (x = 0, a missing value) left out; `None` when none is left.
pub fn agreement(x: &[f64], y: &[f64]) -> Option<Agreement> {
    let usable = |(&x, &y): (&f64, &f64)| (x != 0.0 && x.is_finite() && y.is_finite()).then_some((x, y));
    let (x, y): (Vec<f64>, Vec<f64>) = x.iter().zip(y).filter_map(usable).unzip();
    let mut ratios: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y / x).collect();
    ratios.sort_by(f64::total_cmp);
    let (least, greatest) = (*ratios.first()?, *ratios.last()?);
    let Moments { count, mean, deviation } = Moments::of(&ratios);
    Some(Agreement {
        n: count,
        quartiles: [0.25, 0.5, 0.75].map(|share| quantile(&ratios, share)),
        extremes: [least, greatest],
        mean,
        deviation,
        spearman: spearman(&x, &y),
    })
}

/// Geometric mean of positive ratios with its 95 % interval, `[low, mean, high]`: the mean of ln ρ and Student's t of its
/// standard error. The ends are not finite for fewer than two ratios; `None` where a ratio is not positive, or there is none.
pub fn geometric_mean(ratios: &[f64]) -> Option<[f64; 3]> {
    let n = ratios.len() as f64;
    if ratios.is_empty() || ratios.iter().any(|ratio| !(*ratio > 0.0 && ratio.is_finite())) {
        return None;
    }
    let logarithms: Vec<f64> = ratios.iter().map(|ratio| ln(*ratio)).collect();
    let mean = logarithms.iter().sum::<f64>() / n;
    let squares: f64 = logarithms.iter().map(|l| (l - mean) * (l - mean)).sum();
    let half = if n > 1.0 { t_for_coverage(0.95, n - 1.0) * (squares / (n - 1.0) / n).sqrt() } else { f64::NAN };
    Some([exp(mean - half), exp(mean), exp(mean + half)])
}

/// Rows that describe the same point: `ours[f][i]` and `theirs[f][j]` are levels of factor f, and equal within
/// `tolerance` of the larger, because published levels are rounded. Equal rows pair off in their order. Pairs (i, j)
/// come in the order of theirs.
pub fn pair_rows<V: AsRef<[f64]>>(ours: &[V], theirs: &[V], tolerance: f64) -> Vec<(usize, usize)> {
    let rows = |columns: &[V]| columns.first().map_or(0, |column| column.as_ref().len());
    let near = |p: f64, q: f64| (p - q).abs() <= tolerance * p.abs().max(q.abs());
    let mut used = vec![false; rows(ours)];
    let mut found = Vec::new();
    for j in 0..rows(theirs) {
        let same = |i: usize| ours.iter().zip(theirs).all(|(a, b)| near(a.as_ref()[i], b.as_ref()[j]));
        if let Some(i) = (0..used.len()).find(|&i| !used[i] && same(i)) {
            used[i] = true;
            found.push((i, j));
        }
    }
    found
}

/// The value that a share of the sorted values does not exceed.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = share * (sorted.len() - 1) as f64;
    let below = rank.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (rank - below as f64) * (sorted[above] - sorted[below])
}

fn spearman(x: &[f64], y: &[f64]) -> Option<f64> {
    let (a, b) = (ranks(x), ranks(y));
    let middle = (x.len() as f64 - 1.0) / 2.0;
    let product =
        |p: &[f64], q: &[f64]| -> f64 { p.iter().zip(q).map(|(p, q)| (p - middle) * (q - middle)).sum::<f64>() };
    let spread = product(&a, &a) * product(&b, &b);
    (spread > 0.0).then(|| product(&a, &b) / spread.sqrt())
}

/// Ranks from 0; equal values share their mean rank.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let equal = order[from..].iter().take_while(|&&i| values[i] == values[order[from]]).count();
        for &i in &order[from..from + equal] {
            ranks[i] = from as f64 + (equal as f64 - 1.0) / 2.0;
        }
        from += equal;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_pair_off_by_their_levels() {
        let ours = [vec![1.0, 2.0, 2.0, 3.0], vec![5.0, 5.858, 5.858, 7.0]];
        let theirs = [vec![2.0, 2.0, 2.0, 1.0], vec![5.85786, 5.85786, 5.85786, 5.0]];
        assert_eq!(pair_rows(&ours, &theirs, 1e-3), [(1, 0), (2, 1), (0, 3)]);
        assert_eq!(pair_rows(&ours, &theirs, 1e-6), [(0, 3)]);
    }

    #[test]
    fn what_has_no_ratio_is_left_out() {
        let found = agreement(&[0.0, 2.0, f64::NAN, 4.0], &[1.0, 3.0, 1.0, f64::NAN]).unwrap();
        assert_eq!((found.n, found.mean, found.deviation, found.spearman), (1, 1.5, None, None));
        assert_eq!(agreement(&[0.0], &[1.0]), None);
    }

    #[test]
    fn the_geometric_mean_has_the_interval_of_students_t() {
        // ln ρ = 0, 0.1, 0.2: mean 0.1, s = 0.1, and t of 2 degrees of freedom at 95 % is 4.302653 (tables of Student's t).
        let ratios = [0.0, 0.1, 0.2].map(exp);
        let half = 4.302_652_73 * 0.1 / 3.0_f64.sqrt();
        for (found, wanted) in geometric_mean(&ratios).unwrap().into_iter().zip([0.1 - half, 0.1, 0.1 + half]) {
            assert!((ln(found) - wanted).abs() < 1e-8, "{found}");
        }
        let [low, mean, high] = geometric_mean(&[2.0]).unwrap();
        assert!(low.is_nan() && high.is_nan() && (mean - 2.0).abs() < 1e-15);
        assert_eq!([geometric_mean(&[]), geometric_mean(&[1.0, -1.0])], [None, None]);
    }
}
