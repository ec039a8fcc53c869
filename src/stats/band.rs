//! The mean of many curves and how far they scatter about it.
//!
//! Curves are read at common abscissae by straight lines between their points. The mean is that of all curves, over the abscissae
//! that all of them reach: where one curve ended, the mean of the others would jump. Scatter is the standard deviation over the
//! curves. Points at which a curve runs back are left out.

/// Mean and scatter of curves at common abscissae.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeanCurve {
    /// The abscissae, ascending.
    pub x: Vec<f64>,
    /// The mean there.
    pub mean: Vec<f64>,
    /// The standard deviation there.
    pub deviation: Vec<f64>,
}

/// The mean of curves, each its abscissae and values, at `count` equally spaced abscissae over what all of them cover; empty for
/// fewer than two curves.
pub fn mean_curve(curves: &[(&[f64], &[f64])], count: usize) -> MeanCurve {
    let clean: Vec<Vec<[f64; 2]>> = curves.iter().map(|(x, y)| ascending(x, y)).filter(|c| !c.is_empty()).collect();
    let low = clean.iter().map(|c| c[0][0]).fold(f64::NEG_INFINITY, f64::max);
    let high = clean.iter().map(|c| c[c.len() - 1][0]).fold(f64::INFINITY, f64::min);
    let mut found = MeanCurve::default();
    if clean.len() < 2 || high < low {
        return found;
    }
    let steps = count.saturating_sub(1).max(1) as f64;
    for x in (0..count).map(|i| (low + (high - low) * i as f64 / steps).min(high)) {
        let values: Vec<f64> = clean.iter().filter_map(|curve| at(curve, x)).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        found.x.push(x);
        found.mean.push(mean);
        found.deviation.push((squares / (n - 1.0)).sqrt());
    }
    found
}

fn ascending(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for (&x, &y) in x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite()) {
        if kept.last().is_none_or(|last| x > last[0]) {
            kept.push([x, y]);
        }
    }
    kept
}

fn at(curve: &[[f64; 2]], x: f64) -> Option<f64> {
    let above = curve.partition_point(|p| p[0] < x);
    let right = curve.get(above)?;
    if right[0] == x {
        return Some(right[1]);
    }
    let left = curve.get(above.checked_sub(1)?)?;
    Some(left[1] + (right[1] - left[1]) * (x - left[0]) / (right[0] - left[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of slope 1, 2 and 3: mean 2x, deviation x, whatever points they are given by.
    #[test]
    fn lines_have_the_mean_line() {
        let x: Vec<f64> = (0..=10).map(f64::from).collect();
        let coarse = [0.0, 4.0, 10.0];
        let times = |x: &[f64], s: f64| x.iter().map(|x| s * x).collect::<Vec<_>>();
        let (a, b, c) = (times(&x, 1.0), times(&coarse, 2.0), times(&x, 3.0));
        let found = mean_curve(&[(&x, &a), (&coarse, &b), (&x, &c)], 21);
        assert_eq!(found.x.len(), 21);
        for ((x, mean), deviation) in found.x.iter().zip(&found.mean).zip(&found.deviation) {
            assert!((mean - 2.0 * x).abs() < 1e-12 && (deviation - x).abs() < 1e-12, "{x} {mean} {deviation}");
        }
    }

    #[test]
    fn the_mean_ends_where_the_first_curve_does() {
        let long: Vec<f64> = (0..=10).map(f64::from).collect();
        let double: Vec<f64> = long.iter().map(|x| 2.0 * x).collect();
        // the third point runs back and is left out
        let short = [1.0, 5.0, 3.0];
        let found = mean_curve(&[(&long, &long), (&long, &double), (&short, &[3.0, 15.0, 100.0])], 11);
        assert_eq!((found.x[0], found.x[10]), (1.0, 5.0));
        // no jump: 2x all along, though the others go on
        assert!(found.x.iter().zip(&found.mean).all(|(x, mean)| (mean - 2.0 * x).abs() < 1e-12), "{found:?}");
        assert_eq!(mean_curve(&[(&long, &long)], 5), MeanCurve::default());
        assert_eq!(mean_curve(&[(&[0.0, 1.0], &[0.0, 1.0]), (&[2.0, 3.0], &[0.0, 1.0])], 5), MeanCurve::default());
    }
}
