use super::*;

/// One list of rows of `tests/reference/statistics/tails.toml`.
fn rows(name: &str) -> Vec<Vec<f64>> {
    let text = include_str!("../../../tests/reference/statistics/tails.toml");
    let table: toml::Table = text.parse().unwrap();
    let number = |v: &toml::Value| v.as_float().unwrap_or_else(|| v.as_integer().unwrap() as f64);
    table[name].as_array().unwrap().iter().map(|row| row.as_array().unwrap().iter().map(number).collect()).collect()
}

fn assert_close(found: f64, wanted: f64, relative: f64, what: &[f64]) {
    assert!((found - wanted).abs() <= relative * wanted.abs(), "{what:?}: {found:e} against {wanted:e}");
}

#[test]
fn tails_agree_with_60_digit_arithmetic() {
    for r in rows("f_upper") {
        assert_close(f_upper(r[0], r[1], r[2]), r[3], 1e-12, &r);
    }
    for r in rows("t_two_sided") {
        assert_close(t_two_sided(r[0], r[1]), r[2], 1e-12, &r);
        assert_eq!(t_two_sided(r[0], r[1]).to_bits(), t_two_sided(-r[0], r[1]).to_bits());
    }
}

#[test]
fn quantiles_agree_with_60_digit_arithmetic() {
    for r in rows("t_for_tail") {
        assert_close(t_for_tail(r[0], r[1]), r[2], 2e-14, &r);
    }
    for r in rows("normal_quantile") {
        assert!((normal_quantile(r[0]) - r[1]).abs() <= 2e-15 * r[1].abs().max(0.5), "{r:?} {}", normal_quantile(r[0]));
    }
}

/// On two degrees of freedom the tail is elementary: P = (1 + 2F/ν)^(−ν/2).
#[test]
fn two_degrees_of_freedom_have_a_closed_form() {
    for nu in [1.0, 4.0, 35.0, 36.0, 99_769.0] {
        for f in [0.01, 1.0, 3.0, 42.37] {
            let closed = exp(-0.5 * nu * ln_1p(2.0 * f / nu));
            assert_close(f_upper(f, 2.0, nu), closed, 1e-12, &[f, nu]);
        }
    }
}

#[test]
fn limits_and_faults() {
    assert_eq!(f_upper(0.0, 2.0, 3.0), 1.0);
    assert_eq!(f_upper(f64::INFINITY, 2.0, 3.0), 0.0);
    assert!(f_upper(f64::NAN, 2.0, 3.0).is_nan());
    assert_eq!(t_two_sided(f64::NEG_INFINITY, 3.0), 0.0);
    assert_eq!(t_for_coverage(0.0, 5.0), 0.0);
    assert_eq!(normal_quantile(0.0), f64::NEG_INFINITY);
    assert_eq!(normal_quantile(0.5), 0.0);
}

/// Shape 1 is the exponential distribution, shape 2 Rayleigh's; for shape 3 by Γ(1/3) and Γ(2/3);
/// a small deviation is √6/π of it (Gumbel's limit).
#[test]
fn a_weibull_distribution_has_the_mean_and_deviation_asked_for() {
    let near = |(scale, shape): (f64, f64), wanted: [f64; 2]| {
        assert!((scale / wanted[0] - 1.0).abs() < 1e-12 && (shape / wanted[1] - 1.0).abs() < 1e-12, "{scale} {shape}");
    };
    near(weibull_of_deviation(1.0), [1.0, 1.0]);
    near(weibull_of_deviation((4.0 / PI - 1.0).sqrt()), [2.0 / PI.sqrt(), 2.0]);
    let (one_third, two_thirds) = (2.678_938_534_707_747_6, 1.354_117_939_426_400_4);
    let (mean, square): (f64, f64) = (one_third / 3.0, two_thirds * 2.0 / 3.0);
    near(weibull_of_deviation((square / (mean * mean) - 1.0).sqrt()), [1.0 / mean, 3.0]);
    let (_, shape) = weibull_of_deviation(1e-3);
    assert!((shape * 1e-3 / (PI / 6.0_f64.sqrt()) - 1.0).abs() < 2e-3, "{shape}");
}
