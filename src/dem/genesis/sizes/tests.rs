//! Drawn radii against the laws they are drawn from.

use super::*;
use crate::{D2, D3};

fn drawn<S: Space>(law: SizeLaw, size: Size, count: usize) -> Vec<f64> {
    let sizes = Sizes { law, size, gives_way: GivesWay::Number };
    sizes.draw::<S>(count, &mut Stream::new(1, "radii", 0))
}

/// Share of the volume of balls below a radius.
fn share_below<S: Space>(radii: &[f64], limit: f64) -> f64 {
    let volume = |keep: &dyn Fn(f64) -> bool| radii.iter().filter(|&&r| keep(r)).map(|&r| S::volume(r)).sum::<f64>();
    volume(&|r| r < limit) / volume(&|_| true)
}

#[test]
fn equal_steps_of_radius_hold_equal_volumes() {
    let law = SizeLaw::UniformVolume { ratio: 5.0 };
    let plane = drawn::<D2>(law.clone(), Size::Smallest(1.0), 5000);
    let solid = drawn::<D3>(law, Size::Smallest(1.0), 5000);
    for k in 1..4 {
        let (limit, expected) = (1.0 + f64::from(k), 0.25 * f64::from(k));
        assert!((share_below::<D2>(&plane, limit) - expected).abs() < 2e-3);
        assert!((share_below::<D3>(&solid, limit) - expected).abs() < 4e-3);
    }
}

#[test]
fn a_sieve_curve_is_met_at_every_sieve() {
    let (diameters, passing) = (vec![2.0, 4.0, 8.0, 16.0], vec![0.0, 0.2, 0.5, 1.0]);
    let law = SizeLaw::Sieve { diameters: diameters.clone(), passing: passing.clone() };
    let radii = drawn::<D3>(law, Size::Stated, 20_000);
    for (d, p) in diameters.iter().zip(&passing) {
        assert!((share_below::<D3>(&radii, 0.5 * d) - p).abs() < 5e-3, "{d}");
    }
}

/// Mean and deviation of ln R of a log-normal law that is hardly cut: −s²/2 (mean 1) and s.
#[test]
fn a_log_normal_law_has_its_moments() {
    let law = SizeLaw::LogNormal { ratio: 20.0, deviation: 0.3 };
    let radii = drawn::<D2>(law, Size::Mean(1.0), 20_000);
    let spread = ln(1.0 + 0.09).sqrt();
    let logs: Vec<f64> = radii.iter().map(|&r| ln(r)).collect();
    let mean = logs.iter().sum::<f64>() / 2e4;
    let deviation = (logs.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 2e4).sqrt();
    assert!((mean + 0.5 * spread * spread).abs() < 1e-3 && (deviation - spread).abs() < 1e-3, "{mean} {deviation}");
}

/// Cut close: nothing outside the ratio, median at the root of the ends.
#[test]
fn a_cut_log_normal_law_stays_in_its_ratio() {
    let radii = drawn::<D2>(SizeLaw::LogNormal { ratio: 2.0, deviation: 0.5 }, Size::Smallest(3.0), 1001);
    assert!(radii.iter().all(|&r| (3.0 - 1e-9..=6.0 + 1e-9).contains(&r)));
    assert!((radii[500] / 18.0_f64.sqrt() - 1.0).abs() < 2e-3);
}

#[test]
fn classes_are_drawn_as_counted_and_fill_what_they_fill() {
    let law = SizeLaw::Classes { radii: vec![2.0, 1.0], counts: vec![3, 5] };
    let sizes = Sizes { law, size: Size::Stated, gives_way: GivesWay::Radius };
    assert_eq!(sizes.draw::<D2>(8, &mut Stream::new(1, "radii", 0)), [2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(sizes.count::<D2>(1e9, 0.1), 8.0);
    assert!((sizes.mean_radius::<D2>() - 11.0 / 8.0).abs() < 1e-15);
}

/// The number that gives way fills the volume; the means of the uniform law are exact.
#[test]
fn the_number_that_gives_way_fills_the_volume() {
    for size in [Size::Mean(0.02), Size::Smallest(0.015)] {
        let sizes = Sizes { law: SizeLaw::Uniform { ratio: 1.66 }, size, gives_way: GivesWay::Number };
        let count = sizes.count::<D3>(1.0, 0.36) as usize;
        let radii = sizes.draw::<D3>(count, &mut Stream::new(1, "radii", 0));
        let filled: f64 = radii.iter().map(|&r| D3::volume(r)).sum();
        assert!((filled - 0.64).abs() < 1e-3, "{filled}");
        let mean = radii.iter().sum::<f64>() / count as f64;
        let wanted = if let Size::Mean(mean) = size { mean } else { 0.015 * 1.33 };
        assert!((mean / wanted - 1.0).abs() < 1e-3);
    }
}
