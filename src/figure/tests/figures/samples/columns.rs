//! Sample data of the plots of a user's own columns.

use figure::Quantity;
use figure::axis::Scale;
use figure::boxes::{self, BoxPlot};
use figure::bundle::{self, Bundle};
use figure::heatmap::HeatMap;
use figure::histogram::Histogram;
use figure::marks::Band;
use figure::xy::{Cloud, Xy};
use math::random::Stream;

/// A line through the origin with its band, `slope ± error`.
fn origin_line(slope: f64, error: f64, to: f64) -> Band {
    let x: Vec<f64> = (0..=40).map(|i| to * f64::from(i) / 40.0).collect();
    let times = |s: f64| x.iter().map(|x| s * x).collect::<Vec<_>>();
    Band { y: times(slope), low: times(slope - 2.8 * error), high: times(slope + 2.8 * error), x }
}

/// Strength of a disc over that of its bonds: `n` ratios, `magnitude` times the usual size.
pub(crate) fn xy(n: usize, magnitude: f64) -> Xy {
    let mut random = Stream::new(5, "xy", n as u64);
    let cloud = |k: usize| {
        let ratio = 1.0 + k as f64;
        let slope = (0.5 + 0.2 * ratio) / (1.0 + ratio);
        let x: Vec<f64> = [1.0, 5.0, 15.0, 20.0, 30.0].map(|x| magnitude * x).to_vec();
        let y = x.iter().map(|x| slope * x * (1.0 + 0.05 * random.normal())).collect();
        Cloud {
            name: format!("{ratio}"),
            y_error: x.iter().map(|x| 0.05 * slope * x).collect(),
            y,
            x,
            line: Some(origin_line(slope, 0.02, 30.0 * magnitude)),
            note: if n == 1 { "$K'$ = 0.35 ± 0.02, $R^2$ through the origin 0.998".into() } else { String::new() },
            ..Cloud::default()
        }
    };
    Xy {
        x: Quantity::new("Normal strength of the bonds", r"\sigma_{cn}", "MPa").keyed("sigma_cn"),
        y: Quantity::new("Tensile strength", r"\sigma_t", "MPa").keyed("sigma_t"),
        by: Quantity::new("Ratio", r"R_{max}/R_{min}", ""),
        clouds: (0..n).map(cloud).collect(),
        ..Xy::default()
    }
}

/// Points over five powers of ten, with the laboratory's over them.
pub(crate) fn xy_log() -> Xy {
    let mut random = Stream::new(5, "log", 0);
    let x: Vec<f64> = (0..60).map(|i| 10.0_f64.powf(-3.0 + 5.0 * f64::from(i) / 59.0)).collect();
    let y = x.iter().map(|x| 3.0 * x.sqrt() * (1.0 + 0.3 * random.uniform())).collect();
    let measured = vec![Cloud {
        name: "laboratory".into(),
        x: vec![0.01, 0.3, 8.0],
        y: vec![0.4, 1.9, 9.0],
        y_error: vec![0.1, 0.4, 3.0],
        ..Cloud::default()
    }];
    Xy {
        x: Quantity::new("Strain rate", r"\varepsilon'", "1/s").keyed("rate"),
        y: Quantity::new("Strength", r"\sigma_u", "MPa").keyed("UCS"),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        clouds: vec![Cloud { x, y, ..Cloud::default() }],
        measured,
        ..Xy::default()
    }
}

pub(crate) fn bundle(groups: usize) -> Bundle {
    let mut random = Stream::new(9, "bundle", groups as u64);
    let x: Vec<f64> = (0..=120).map(|i| 2.4 * f64::from(i) / 120.0).collect();
    let mut curve = |peak: f64| {
        let (at, top) = (1.4 + 0.08 * random.normal(), peak * (1.0 + 0.05 * random.normal()));
        let y = x.iter().map(|x| {
            let r = x / at;
            if r < 1.0 { top * r * (1.25 - 0.25 * r.powi(4)) } else { top * (-6.0 * (r - 1.0)).exp() }
        });
        bundle::Line { name: "run".into(), x: x.clone(), y: y.collect() }
    };
    let mut group = |k: usize| {
        let curves: Vec<bundle::Line> = (0..9).map(|_| curve(30.0 + 12.0 * k as f64)).collect();
        let at = |i: usize| curves.iter().map(|c| c.y[i]).collect::<Vec<f64>>();
        let mean: Vec<f64> = (0..x.len()).map(|i| at(i).iter().sum::<f64>() / 9.0).collect();
        let spread: Vec<f64> =
            (0..x.len()).map(|i| (at(i).iter().map(|v| (v - mean[i]).powi(2)).sum::<f64>() / 8.0).sqrt()).collect();
        let shift = |sign: f64| mean.iter().zip(&spread).map(|(m, s)| m + sign * s).collect::<Vec<_>>();
        let band = Band { x: x.clone(), low: shift(-1.0), high: shift(1.0), y: mean };
        let name = if groups == 1 { String::new() } else { format!(r"$\bar\sigma_c$ = {} MPa", 10 * (k + 1)) };
        bundle::Group { name, curves, mean: Some(band) }
    };
    let groups = (0..groups).map(&mut group).collect();
    let mut lab = curve(34.0);
    lab.name = "measured".into();
    Bundle {
        x: Quantity::new("Axial strain", r"\varepsilon_1", "%").keyed("axial_strain"),
        y: Quantity::new("Axial stress", r"\sigma", "MPa").keyed("stress"),
        groups,
        band: "one standard deviation".into(),
        measured: vec![lab],
        limits: [None; 2],
    }
}

pub(crate) fn histogram(magnitude: f64) -> Histogram {
    let counts = vec![1, 0, 4, 9, 14, 12, 7, 2, 1];
    let edges = (0..=9).map(|i| magnitude * (30.0 + f64::from(i))).collect();
    let q = Quantity::new("Peak strength", r"\sigma_u", "MPa").keyed("UCS");
    Histogram { quantity: q, edges, counts, mean: 34.9 * magnitude, deviation: 1.5 * magnitude }
}

pub(crate) fn boxes(groups: usize) -> BoxPlot {
    let mut random = Stream::new(2, "boxes", groups as u64);
    let mut group = |k: usize| {
        let n = if k == 1 { 3 } else { 20 };
        let mut values: Vec<f64> = (0..n).map(|_| 30.0 + 3.0 * k as f64 + 2.0 * random.normal()).collect();
        if k == 2 {
            values.push(55.0);
        }
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |p: f64| sorted[(p * (sorted.len() - 1) as f64).round() as usize];
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let name = if groups > 6 { format!("set number {k}") } else { format!("Set {}", k + 1) };
        boxes::Group { name, five: [at(0.02), at(0.25), at(0.5), at(0.75), at(0.9)], mean, values }
    };
    BoxPlot {
        by: Quantity::new("Target set", "", ""),
        y: Quantity::new("Peak strength", r"\sigma_u", "MPa").keyed("UCS"),
        scale: Scale::Linear,
        groups: (0..groups).map(&mut group).collect(),
        limits: None,
    }
}

/// The scale coefficient of a disc over radius and ratio.
pub(crate) fn heat(scatter: bool) -> HeatMap {
    let (rows, columns) = (7, 10);
    let value = |i: usize| {
        let (r, c) = (i / columns, i % columns);
        if i == 38 { f64::NAN } else { 0.54 + 0.3 * c as f64 + 0.02 * (r as f64 - 3.0) * (c as f64 - 4.0).abs() }
    };
    let cells: Vec<f64> = (0..rows * columns).map(value).collect();
    HeatMap {
        down: Quantity::new("Least radius", r"R_{min}", "mm").keyed("R_min"),
        across: Quantity::new("Ratio of radii", r"R_{max}/R_{min}", "").keyed("ratio"),
        value: Quantity::new("Scale coefficient", "K'", "").keyed("K"),
        rows: (0..rows).map(|i| format!("{:.2}", 0.1 + 0.05 * i as f64)).collect(),
        columns: (1..=columns).map(|i| i.to_string()).collect(),
        scatter: if scatter { cells.iter().map(|v| 0.03 * v).collect() } else { Vec::new() },
        cells,
    }
}
