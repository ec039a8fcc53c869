//! Sample data of every figure, made by formulas that look like the real thing.

pub(crate) mod columns;
mod fits;
mod spatial;

use figure::axis::Scale;
use figure::bars::{Bar, RankedBars};
use figure::contour::Contour;
use figure::curve::{Curve, StressStrain};
use figure::dag::{Dag, Stage};
use figure::effect_plot::Coordinates;
use figure::effects::{FactorMeans, MainEffects};
use figure::points::DesignPoints;
use figure::solid::Cut;
use figure::surface::Surface;
use figure::{DOUBLE, Figure, Quantity, SINGLE, Style};
use fits::{convergence, effect_plot, observed, published, residuals, solutions, verification};
use math::random::Stream;
use spatial::{chains, cracks, rose, specimen};

/// Name, style and figure of each sample.
pub(crate) fn all() -> Vec<(&'static str, Style, Box<dyn Figure>)> {
    let (one, two) = (Style::wide(SINGLE), Style::wide(DOUBLE));
    vec![
        ("stress-strain", one.clone(), Box::new(stress_strain(1))),
        ("stress-strain-3", one.clone(), Box::new(stress_strain(3))),
        ("main-effects", two.clone(), Box::new(main_effects(true))),
        ("range", one.clone(), Box::new(range())),
        ("pareto", one.clone(), Box::new(pareto())),
        ("contour", one.clone(), Box::new(contour())),
        ("surface", one.clone(), Box::new(Surface { field: contour(), azimuth: -60.0, elevation: 28.0 })),
        ("surface-saddle", one.clone(), Box::new(Surface { field: saddle(), azimuth: -50.0, elevation: 30.0 })),
        ("contour-saddle", one.clone(), Box::new(saddle())),
        ("contour-log", one.clone(), Box::new(decades())),
        ("surface-log", one.clone(), Box::new(Surface { field: decades(), azimuth: -60.0, elevation: 28.0 })),
        ("points-ccd", one.clone(), Box::new(points_ccd())),
        ("points-bbd", one.clone(), Box::new(points_cube("Box–Behnken design", false))),
        ("points-orthogonal", one.clone(), Box::new(points_cube("orthogonal table", true))),
        ("specimen", one.clone(), Box::new(specimen(1.0))),
        ("specimen-wide", two.clone(), Box::new(specimen(2.4))),
        ("cracks", two.clone(), Box::new(cracks())),
        ("cracks-2", one.clone(), Box::new(cracks())),
        ("snapshots", two.clone(), Box::new(spatial::snapshots())),
        ("snapshots-2", one.clone(), Box::new(spatial::snapshots())),
        ("damage", two.clone(), Box::new(spatial::damage())),
        ("damage-1", one.clone(), Box::new(spatial::damage())),
        ("cracks-disc", two.clone(), Box::new(spatial::disc_cracks())),
        ("specimen-disc", one.clone(), Box::new(spatial::disc())),
        ("solid", one.clone(), Box::new(spatial::cube(None))),
        ("solid-cut", one.clone(), Box::new(spatial::cube(Some(60.0)))),
        ("core", one.clone(), Box::new(spatial::core(None))),
        ("core-cut", one.clone(), Box::new(spatial::core(Some(Cut { axis: 1, at: 60.0 })))),
        ("core-cut-up", one.clone(), Box::new(spatial::core(Some(Cut { axis: 2, at: 90.0 })))),
        ("solid-cracks", one.clone(), Box::new(spatial::prism_cracks())),
        ("rose", one.clone(), Box::new(rose())),
        ("chains", one.clone(), Box::new(chains())),
        ("half-normal", one.clone(), Box::new(effect_plot(Coordinates::HalfNormal))),
        ("normal", one.clone(), Box::new(effect_plot(Coordinates::Normal))),
        ("residuals", two.clone(), Box::new(residuals())),
        ("residuals-1", one.clone(), Box::new(residuals())),
        ("published", two.clone(), Box::new(published())),
        ("observed", one.clone(), Box::new(observed())),
        ("convergence", one.clone(), Box::new(convergence())),
        ("solutions", two.clone(), Box::new(solutions(1))),
        ("solutions-5", two.clone(), Box::new(solutions(5))),
        ("verification", two.clone(), Box::new(verification())),
        ("dag", two.clone(), Box::new(dag())),
        ("xy", one.clone(), Box::new(columns::xy(1, 1.0))),
        ("xy-4", one.clone(), Box::new(columns::xy(4, 1.0))),
        ("xy-10", two.clone(), Box::new(columns::xy(10, 1.0))),
        ("xy-large", one.clone(), Box::new(columns::xy(3, 1e7))),
        ("xy-small", one.clone(), Box::new(columns::xy(3, 1e-7))),
        ("xy-log", one.clone(), Box::new(columns::xy_log())),
        ("bundle", one.clone(), Box::new(columns::bundle(1))),
        ("bundle-3", one.clone(), Box::new(columns::bundle(3))),
        ("histogram", one.clone(), Box::new(columns::histogram(1.0))),
        ("histogram-small", one.clone(), Box::new(columns::histogram(1e-5))),
        ("boxes", one.clone(), Box::new(columns::boxes(4))),
        ("boxes-12", one.clone(), Box::new(columns::boxes(12))),
        ("heat", one.clone(), Box::new(columns::heat(false))),
        ("heat-2", two.clone(), Box::new(columns::heat(true))),
    ]
}

fn factors() -> Vec<(Quantity, &'static str, [f64; 3])> {
    let q = Quantity::new;
    vec![
        (q("Ec", "E_c", "GPa"), "mortar", [10.0, 20.0, 30.0]),
        (q("kn_ks", "k_n/k_s", ""), "mortar", [1.0, 2.5, 4.0]),
        (q("sigma_c", r"\bar\sigma_c", "MPa"), "mortar", [10.0, 20.0, 30.0]),
        (q("tau_c", r"\bar\tau_c", "MPa"), "mortar", [10.0, 20.0, 30.0]),
        (q("mu", r"\mu", ""), "mortar", [0.5, 1.0, 1.5]),
        (q("Ecg", "(E_c)_g", "GPa"), "aggregate", [20.0, 30.0, 40.0]),
        (q("kn_ks_g", "(k_n/k_s)_g", ""), "aggregate", [1.0, 2.5, 4.0]),
        (q("mu_g", r"\mu_g", ""), "aggregate", [0.5, 1.0, 1.5]),
        (q("Ecj", "(E_c)_j", "GPa"), "interface", [5.0, 10.0, 15.0]),
        (q("kn_ks_j", "(k_n/k_s)_j", ""), "interface", [1.0, 2.5, 4.0]),
        (q("sigma_cj", r"(\bar\sigma_c)_j", "MPa"), "interface", [5.0, 15.0, 25.0]),
        (q("tau_cj", r"(\bar\tau_c)_j", "MPa"), "interface", [5.0, 15.0, 25.0]),
        (q("mu_j", r"\mu_j", ""), "interface", [0.5, 1.0, 1.5]),
    ]
}

fn stress_strain(n: usize) -> StressStrain {
    let curve = |k: usize| {
        let mut random = Stream::new(7, "curve", k as u64);
        let modulus = 34.0 - 6.0 * k as f64;
        let peak_strain = 1.45e-3 + 1e-4 * k as f64;
        let points = 400;
        let mut c = Curve { name: format!("Set {}", k + 1), modulus: Some(modulus), ..Curve::default() };
        let (mut tensile, mut shear) = (Vec::new(), Vec::new());
        for i in 0..=points {
            let e = 2.4e-3 * i as f64 / points as f64;
            let r = e / peak_strain;
            let mut stress = if r < 1.0 { modulus * 1e3 * e * (1.0 - 0.18 * r.powi(5)) } else { 0.0 };
            if r >= 1.0 {
                let peak = modulus * 1e3 * peak_strain * 0.82;
                stress = peak * (0.12 + 0.88 * (-9.0 * (r - 1.0).powf(1.15)).exp()) + 0.25 * random.normal();
            }
            c.axial.push(e);
            c.lateral.push(-0.22 * e - 4e-4 * (r.powi(6)).min(2.0));
            c.stress.push(stress.max(0.0));
            let grow = 1.0 / (1.0 + (-(r - 1.02) * 22.0).exp());
            tensile.push((1450.0 * grow + 60.0 * r.powi(4).min(3.0)).round());
            shear.push((420.0 * grow + 15.0 * r.powi(4).min(3.0)).round());
        }
        if n > 1 {
            c.lateral.clear();
            c.modulus = None;
        }
        c.cracks = vec![("Tensile".into(), tensile), ("Shear".into(), shear)];
        c
    };
    StressStrain { curves: (0..n).map(curve).collect() }
}

pub(crate) fn main_effects(published: bool) -> MainEffects {
    let slopes = [0.3, -0.8, 9.3, 7.8, 2.0, 0.4, -0.5, 0.6, 0.9, -0.7, 1.4, 2.1, 0.5];
    let grand = 38.6;
    let mut random = Stream::new(3, "means", 0);
    let factors = factors().into_iter().zip(slopes).map(|((factor, group, levels), s)| FactorMeans {
        factor,
        group: group.into(),
        levels: levels.to_vec(),
        means: vec![grand - s, grand + 0.12 * s + 0.3 * random.normal(), grand + 0.9 * s],
        half_width: vec![1.6; 3],
        published: if published {
            (0..3).map(|i| grand + (i as f64 - 1.0) * s + 0.5 * random.normal()).collect()
        } else {
            vec![]
        },
    });
    MainEffects {
        response: Quantity::new("Peak strength", r"\sigma_u", "MPa"),
        grand_mean: grand,
        factors: factors.collect(),
    }
}

pub(crate) fn range() -> RankedBars {
    let values = [0.9, 1.6, 18.64, 15.59, 4.1, 1.2, 1.4, 1.1, 2.0, 1.5, 3.1, 4.4, 1.3];
    let mut random = Stream::new(3, "range", 0);
    let bars = factors().into_iter().zip(values).map(|((factor, group, _), value)| Bar {
        factor,
        group: group.into(),
        value,
        published: Some((value + 0.5 * random.normal()).max(0.1)),
    });
    RankedBars {
        title: "Range analysis of peak strength".into(),
        quantity: Quantity::new("Range of", r"\sigma_u", "MPa"),
        bars: bars.collect(),
        references: vec![("empty column".into(), 2.3)],
    }
}

pub(crate) fn pareto() -> RankedBars {
    let values = [("A", 11.4), ("B", 9.1), ("AB", 5.2), ("C", 3.3), ("AC", 1.6), ("BC", 1.2), ("ABC", 0.4)];
    let bars = values.map(|(name, value)| Bar {
        factor: Quantity::new(name, "", ""),
        group: String::new(),
        value,
        published: None,
    });
    RankedBars {
        title: "Pareto chart of effects".into(),
        quantity: Quantity::new("Standardized effect", "|t|", ""),
        bars: bars.to_vec(),
        references: vec![("$t_{0.05, 9}$ = 2.26".into(), 2.26), ("Bonferroni".into(), 3.6)],
    }
}

/// The published surface of strength (Table 12 of Su et al. 2021).
pub(crate) fn contour() -> Contour {
    let n = 61;
    let axis: Vec<f64> = (0..n).map(|i| 5.858 + 28.284 * i as f64 / (n - 1) as f64).collect();
    let f = |s: f64, t: f64| -0.48 + 1.083 * s + 0.919 * t - 0.03138 * s * s - 0.0259 * t * t + 0.0656 * s * t;
    Contour {
        scales: [Scale::Linear; 2],
        x: Quantity::new("", r"\bar\sigma_c", "MPa"),
        y: Quantity::new("", r"\bar\tau_c", "MPa"),
        z: Quantity::new("Peak strength", r"\sigma_u", "MPa"),
        values: axis.iter().flat_map(|&t| axis.iter().map(move |&s| f(s, t))).collect(),
        xs: axis.clone(),
        ys: axis,
        points: [
            [10., 10.],
            [30., 10.],
            [10., 30.],
            [30., 30.],
            [20., 20.],
            [5.858, 20.],
            [34.142, 20.],
            [20., 5.858],
            [20., 34.142],
        ]
        .to_vec(),
        note: r"$E_c$ = 20 GPa, $k_n/k_s$ = 2.5, $\mu$ = 1".into(),
    }
}

/// A strength over the ratio of stiffnesses, three decades of it.
fn decades() -> Contour {
    let n = 41;
    let part = |i: usize| i as f64 / (n - 1) as f64;
    let xs: Vec<f64> = (0..n).map(|i| math::elementary::pow(10.0, -1.0 + 3.0 * part(i))).collect();
    let ys: Vec<f64> = (0..n).map(|i| 1.0 + 4.0 * part(i)).collect();
    let f = |x: f64, y: f64| 20.0 + 6.0 * math::elementary::ln(x) - y * y;
    Contour {
        scales: [Scale::Log, Scale::Linear],
        x: Quantity::new("", "k_n/k_s", ""),
        y: Quantity::new("", r"\mu", ""),
        z: Quantity::new("Peak strength", r"\sigma_u", "MPa"),
        values: ys.iter().flat_map(|&y| xs.iter().map(move |&x| f(x, y))).collect(),
        points: vec![[0.1, 1.0], [3.162, 3.0], [100.0, 5.0]],
        xs,
        ys,
        ..Contour::default()
    }
}

fn saddle() -> Contour {
    let n = 51;
    let axis: Vec<f64> = (0..n).map(|i| -1.0 + 2.0 * f64::from(i) / f64::from(n - 1)).collect();
    let f = |a: f64, b: f64| 0.24 + 0.08 * a * a - 0.07 * b * b + 0.03 * a * b + 0.02 * a;
    Contour {
        x: Quantity::new("", "k_n/k_s", ""),
        y: Quantity::new("", r"\mu", ""),
        z: Quantity::new("Poisson's ratio", r"\nu", ""),
        values: axis.iter().flat_map(|&b| axis.iter().map(move |&a| f(a, b))).collect(),
        xs: axis.iter().map(|a| 2.5 + 1.5 * a).collect(),
        ys: axis.iter().map(|b| 1.0 + 0.5 * b).collect(),
        ..Contour::default()
    }
}

fn points_ccd() -> DesignPoints {
    let mut points =
        vec![[10., 10.], [30., 10.], [10., 30.], [30., 30.], [5.858, 20.], [34.142, 20.], [20., 5.858], [20., 34.142]];
    points.extend([[20., 20.]; 5]);
    let kinds = (0..13)
        .map(|i| {
            if i < 4 {
                "cube"
            } else if i < 8 {
                "axial"
            } else {
                "centre"
            }
            .to_string()
        })
        .collect();
    DesignPoints {
        title: "central composite design".into(),
        factors: vec![
            Quantity::new("", r"\bar\sigma_c", "MPa").keyed("sigma_c"),
            Quantity::new("", r"\bar\tau_c", "MPa").keyed("tau_c"),
        ],
        sides: vec![[10.0, 30.0]; 2],
        points: points.iter().map(|p| p.to_vec()).collect(),
        kinds,
    }
}

fn points_cube(title: &str, orthogonal: bool) -> DesignPoints {
    let (mut points, mut kinds) = (Vec::new(), Vec::new());
    for k in 0..27 {
        let c = [k % 3, k / 3 % 3, k / 9];
        let middles = c.iter().filter(|&&v| v == 1).count();
        let (keep, kind) = if orthogonal {
            ((c[0] + c[1] + c[2]) % 3 == 0, "test point")
        } else {
            (middles == 1 || middles == 3, if middles == 3 { "centre" } else { "edge" })
        };
        for _ in 0..if keep { if kind == "centre" { 3 } else { 1 } } else { 0 } {
            points.push(vec![10.0 + 10.0 * c[0] as f64, 1.0 + 1.5 * c[1] as f64, 0.5 + 0.5 * c[2] as f64]);
            kinds.push(kind.to_string());
        }
    }
    let factors =
        vec![Quantity::new("Ec", "E_c", "GPa"), Quantity::new("kn_ks", "k_n/k_s", ""), Quantity::new("mu", r"\mu", "")];
    DesignPoints { title: title.into(), factors, sides: vec![[10.0, 30.0], [1.0, 4.0], [0.5, 1.5]], points, kinds }
}

fn dag() -> Dag {
    let names = [
        ("specimen", "22 409 discs", 0),
        ("trial", "1 run", 1),
        ("orthogonal", "64 runs", 1),
        ("range", "", 2),
        ("anova", "", 2),
        ("regression", "", 2),
        ("ccd_ucs", "13 runs", 1),
        ("bbd_e", "46 runs", 1),
        ("bbd_nu", "27 runs", 1),
        ("rsm", "3 surfaces", 2),
        ("calibrate", "5 targets", 3),
        ("verify", "25 runs", 3),
        ("curve", "figure", 4),
        ("effects", "3 figures", 4),
        ("contours", "figures", 4),
        ("table_15", "table", 4),
    ];
    let index = |n: &str| names.iter().position(|m| m.0 == n).unwrap_or(0);
    let edges = [
        ("specimen", "trial"),
        ("specimen", "orthogonal"),
        ("orthogonal", "range"),
        ("orthogonal", "anova"),
        ("orthogonal", "regression"),
        ("anova", "regression"),
        ("anova", "ccd_ucs"),
        ("anova", "bbd_e"),
        ("anova", "bbd_nu"),
        ("specimen", "ccd_ucs"),
        ("specimen", "bbd_e"),
        ("specimen", "bbd_nu"),
        ("ccd_ucs", "rsm"),
        ("bbd_e", "rsm"),
        ("bbd_nu", "rsm"),
        ("rsm", "calibrate"),
        ("calibrate", "verify"),
        ("specimen", "verify"),
        ("trial", "curve"),
        ("range", "effects"),
        ("rsm", "contours"),
        ("verify", "table_15"),
    ];
    Dag {
        stages: names
            .iter()
            .map(|&(name, note, class)| Stage { name: name.into(), note: note.into(), class })
            .collect(),
        edges: edges.iter().map(|(a, b)| (index(a), index(b))).collect(),
        classes: ["specimen", "simulation", "statistics", "calibration", "output"].map(String::from).to_vec(),
    }
}
