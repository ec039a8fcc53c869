//! What a sample says of its population: mean, standard deviation, interval of the mean.

use super::distribution::t_for_coverage;

/// The moments of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: usize,
    /// Their mean; NaN of no value.
    pub mean: f64,
    /// Their standard deviation, with one value less than there are in the denominator; `None` of fewer than two values.
    pub deviation: Option<f64>,
}

impl Moments {
    /// The moments of these values, in whose unit they are.
    pub fn of(values: &[f64]) -> Self {
        let (count, n) = (values.len(), values.len() as f64);
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        Self { count, mean, deviation: (count > 1).then(|| (squares / (n - 1.0)).sqrt()) }
    }

    /// Half the 95 % interval of the mean, by Student's t; `None` of fewer than two values.
    pub fn half_interval(&self) -> Option<f64> {
        let n = self.count as f64;
        self.deviation.map(|deviation| t_for_coverage(0.95, n - 1.0) * deviation / n.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// numpy 2.4.6 `std(ddof=1)` and scipy 1.17.1 `t.ppf(0.975, 4) * std / 5**0.5` of the same five numbers.
    #[test]
    fn moments_are_those_of_the_textbook() {
        let found = Moments::of(&[0.40, 0.24, 0.30, 0.35, 0.31]);
        assert!(found.count == 5 && (found.mean - 0.32).abs() < 1e-15, "{found:?}");
        assert!(found.deviation.is_some_and(|own| (own - 0.059_581_876_439_064_92).abs() < 1e-15), "{found:?}");
        assert!(found.half_interval().is_some_and(|own| (own - 0.073_980_670_919_812_02).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn one_value_has_no_deviation_and_none_no_mean() {
        let one = Moments::of(&[3.0]);
        assert_eq!((one.mean, one.deviation, one.half_interval()), (3.0, None, None));
        assert!(Moments::of(&[]).mean.is_nan());
    }
}
