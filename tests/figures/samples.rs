//! Sample data of every figure, made by formulas that look like the real thing.

use flow::figure::agreement::{Agreement, Cloud, Pair};
use flow::figure::bars::{Bar, RankedBars};
use flow::figure::chains::{Chains, Link};
use flow::figure::contour::Contour;
use flow::figure::convergence::{Convergence, Descent};
use flow::figure::cracks::{Crack, Cracks, Moment};
use flow::figure::curve::{Curve, StressStrain};
use flow::figure::dag::{Dag, Stage};
use flow::figure::effects::{FactorMeans, MainEffects};
use flow::figure::half_normal::{Effect, HalfNormal};
use flow::figure::points::DesignPoints;
use flow::figure::residuals::Residuals;
use flow::figure::rose::Rose;
use flow::figure::solutions::{SolutionSet, Solutions};
use flow::figure::specimen::Specimen;
use flow::figure::surface::Surface;
use flow::figure::verification::{Check, Verification};
use flow::figure::{DOUBLE, Figure, Quantity, SINGLE, Style};
use flow::math::random::Stream;

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
        ("points-ccd", one.clone(), Box::new(points_ccd())),
        ("points-bbd", one.clone(), Box::new(points_cube("Box–Behnken design", false))),
        ("points-orthogonal", one.clone(), Box::new(points_cube("orthogonal table", true))),
        ("specimen", one.clone(), Box::new(specimen(1.0))),
        ("specimen-wide", two.clone(), Box::new(specimen(2.4))),
        ("cracks", two.clone(), Box::new(cracks())),
        ("cracks-2", one.clone(), Box::new(cracks())),
        ("rose", one.clone(), Box::new(rose())),
        ("chains", one.clone(), Box::new(chains())),
        ("half-normal", one.clone(), Box::new(half_normal())),
        ("residuals", two.clone(), Box::new(residuals())),
        ("residuals-1", one.clone(), Box::new(residuals())),
        ("published", two.clone(), Box::new(published())),
        ("observed", one.clone(), Box::new(observed())),
        ("convergence", one.clone(), Box::new(convergence())),
        ("solutions", two.clone(), Box::new(solutions(1))),
        ("solutions-5", two.clone(), Box::new(solutions(5))),
        ("verification", two.clone(), Box::new(verification())),
        ("dag", two.clone(), Box::new(dag())),
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

fn main_effects(published: bool) -> MainEffects {
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

fn range() -> RankedBars {
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

fn pareto() -> RankedBars {
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
fn contour() -> Contour {
    let n = 61;
    let axis: Vec<f64> = (0..n).map(|i| 5.858 + 28.284 * i as f64 / (n - 1) as f64).collect();
    let f = |s: f64, t: f64| -0.48 + 1.083 * s + 0.919 * t - 0.03138 * s * s - 0.0259 * t * t + 0.0656 * s * t;
    Contour {
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
        factors: vec![Quantity::new("", r"\bar\sigma_c", "MPa"), Quantity::new("", r"\bar\tau_c", "MPa")],
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

type Polygon = Vec<[f64; 2]>;

fn polygons(random: &mut Stream, w: f64, h: f64) -> Vec<Polygon> {
    let mut found: Vec<([f64; 2], f64, Polygon)> = Vec::new();
    for (size, n) in [(12.0, 8), (10.0, 15), (8.0, 28), (6.0, 59)] {
        let mut placed = 0;
        for _ in 0..20_000 {
            let r = size / 2.0;
            let c = [random.uniform_in(r, w - r), random.uniform_in(r, h - r)];
            if found.iter().any(|(d, q, _)| (c[0] - d[0]).hypot(c[1] - d[1]) < r + q + 1.0) {
                continue;
            }
            let sides = 4 + random.below(3);
            let turn = random.uniform_in(0.0, 6.28);
            let corner = |k: usize| {
                let a = turn + 6.2832 * (k as f64 + 0.25 * ((k * 7 % 3) as f64 - 1.0)) / sides as f64;
                [c[0] + r * a.cos(), c[1] + r * a.sin()]
            };
            found.push((c, r, (0..sides).map(corner).collect()));
            placed += 1;
            if placed == n {
                break;
            }
        }
    }
    found.into_iter().map(|f| f.2).collect()
}

fn inside(p: [f64; 2], poly: &[[f64; 2]]) -> bool {
    let n = poly.len();
    (0..n)
        .filter(|&i| {
            let (a, b) = (poly[i], poly[(i + 1) % n]);
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        })
        .count()
        % 2
        == 1
}

/// About 22,000 discs on a jittered hexagonal lattice.
fn specimen(ratio: f64) -> Specimen {
    let (w, h) = if ratio > 1.0 { (200.0, 200.0 / ratio) } else { (100.0, 200.0) };
    let mut random = Stream::new(11, "discs", 0);
    let outlines = polygons(&mut random, w, h);
    let pitch = 1.02;
    let (mut centres, mut radii, mut group) = (Vec::new(), Vec::new(), Vec::new());
    let mut y = 0.5;
    let mut row = 0;
    while y < h {
        let mut x = if row % 2 == 0 { 0.5 } else { 1.0 };
        while x < w {
            let c = [x + 0.12 * random.normal(), y + 0.12 * random.normal()];
            centres.push(c);
            radii.push(random.uniform_in(0.3, 0.68));
            group.push(usize::from(outlines.iter().any(|o| inside(c, o))));
            x += pitch;
        }
        y += pitch * 0.87;
        row += 1;
    }
    Specimen {
        low: [0.0, 0.0],
        high: [w, h],
        centres,
        radii,
        group,
        groups: vec!["mortar".into(), "aggregate".into()],
        outlines,
    }
}

fn cracks() -> Cracks {
    let mut random = Stream::new(5, "cracks", 0);
    let outlines = polygons(&mut random, 100.0, 200.0);
    let mut moment = |title: &str, n: usize, sharp: f64| {
        let crack = |_| {
            let t = random.uniform();
            let band = random.uniform() < sharp;
            let y = 200.0 * t;
            let x = if band { 20.0 + 62.0 * t + 2.5 * random.normal() } else { random.uniform_in(2.0, 98.0) };
            let mode = usize::from(random.uniform() < if band { 0.35 } else { 0.05 });
            let angle = if mode == 0 { 1.57 + 0.25 * random.normal() } else { 1.1 + 0.2 * random.normal() };
            Crack { at: [x, y], angle, length: random.uniform_in(0.7, 1.4), mode }
        };
        Moment { title: title.into(), cracks: (0..n).map(crack).collect() }
    };
    let moments = vec![
        moment("50 %", 40, 0.0),
        moment("80 %", 190, 0.2),
        moment("peak", 760, 0.55),
        moment("70 % after the peak", 2400, 0.8),
    ];
    Cracks {
        low: [0.0, 0.0],
        high: [100.0, 200.0],
        modes: vec!["tensile crack".into(), "shear crack".into()],
        moments,
        outlines,
    }
}

fn rose() -> Rose {
    let mut random = Stream::new(5, "rose", 0);
    let tensile = (0..1700).map(|_| 1.57 + 0.42 * random.normal()).collect();
    let shear = (0..500).map(|i| if i % 2 == 0 { 1.05 } else { 2.09 } + 0.2 * random.normal()).collect();
    Rose { modes: vec![("tensile".into(), tensile), ("shear".into(), shear)], petals: 18 }
}

fn chains() -> Chains {
    let s = specimen(1.0);
    let mut random = Stream::new(5, "chains", 0);
    let mut links = Vec::new();
    let n = s.centres.len();
    for i in 0..n {
        for j in i + 1..(i + 110).min(n) {
            let (a, b) = (s.centres[i], s.centres[j]);
            let d = [b[0] - a[0], b[1] - a[1]];
            let length = d[0].hypot(d[1]);
            if length < 1.25 {
                let steep = (d[1] / length).powi(2);
                let chain = (0.35 * a[0] + 0.9 * (0.05 * a[1]).sin()).sin().powi(2);
                let force = 2.4e4 * (steep * (0.2 + 1.6 * chain) * -random.uniform().max(1e-3).ln() * 0.5)
                    - 2.5e3 * (1.0 - steep);
                links.push(Link { from: a, to: b, force: force / 1e3 });
            }
        }
    }
    Chains { low: s.low, high: s.high, links, unit: "kN".into(), least: 0.5 }
}

fn half_normal() -> HalfNormal {
    let names = ["A", "B", "C", "D", "E", "AB", "AC", "AD", "AE", "BC", "BD", "BE", "CD", "CE", "DE"];
    let sizes = [21.6, 3.1, 9.9, 14.6, 0.4, 1.2, 18.1, 16.6, 0.4, 2.4, 0.4, 1.1, 1.9, 4.1, 2.6];
    let mut order: Vec<usize> = (0..15).collect();
    order.sort_by(|&a, &b| f64::total_cmp(&sizes[a], &sizes[b]));
    let quantiles = [0.04, 0.13, 0.21, 0.3, 0.38, 0.48, 0.57, 0.67, 0.78, 0.9, 1.02, 1.17, 1.35, 1.6, 2.13];
    let effect = |(rank, &i): (usize, &usize)| Effect {
        name: format!("${}$", names[i]),
        size: sizes[i],
        quantile: quantiles[rank],
        active: sizes[i] > 6.7,
    };
    HalfNormal {
        response: Quantity::new("Filtration rate", "", "gal/h"),
        effects: order.iter().enumerate().map(effect).collect(),
        error: 2.62,
        margin: Some(("margin of error".into(), 6.7)),
    }
}

fn residuals() -> Residuals {
    let n = 46;
    let mut random = Stream::new(9, "residuals", 0);
    let mut studentized: Vec<f64> = (0..n).map(|_| 0.95 * random.normal()).collect();
    studentized[17] = 3.9;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| studentized[a].total_cmp(&studentized[b]));
    let mut quantiles = vec![0.0; n];
    for (rank, &i) in order.iter().enumerate() {
        let p: f64 = (rank as f64 + 0.625) / (n as f64 + 0.25);
        quantiles[i] = 4.91 * (p.powf(0.14) - (1.0 - p).powf(0.14));
    }
    Residuals {
        response: Quantity::new("Elastic modulus", "E", "GPa"),
        runs: (1..=n).map(|i| i.to_string()).collect(),
        fitted: (0..n).map(|_| random.uniform_in(16.0, 58.0)).collect(),
        studentized,
        quantiles,
        leverage: (0..n).map(|i| if i % 9 == 0 { 0.16 } else { 0.42 + 0.01 * random.normal() }).collect(),
        coefficients: 21,
        limit: 3.5,
    }
}

fn cloud(name: &str, n: usize, low: f64, high: f64, noise: f64, purpose: &str) -> Cloud {
    let mut random = Stream::new(2, purpose, 0);
    let x: Vec<f64> = (0..n).map(|_| random.uniform_in(low, high)).collect();
    let y = x.iter().map(|v| v * (1.0 + noise * random.normal())).collect();
    Cloud { name: name.into(), rows: (1..=n).map(|i| i.to_string()).collect(), x, y }
}

fn published() -> Agreement {
    let pair = |q: Quantity, low: f64, high: f64, noise: f64, other: &str, m: usize| Pair {
        clouds: vec![
            cloud("orthogonal table", 64, low, high, noise, &q.name),
            cloud(other, m, low, high, 0.8 * noise, other),
        ],
        note: format!("mean deviation {} %", if noise > 0.05 { "+3.1" } else { "−0.6" }),
        quantity: q,
    };
    Agreement {
        x_word: "Published".into(),
        y_word: "Computed".into(),
        pairs: vec![
            pair(Quantity::new("Peak strength", r"\sigma_u", "MPa"), 17.0, 62.0, 0.07, "central composite", 13),
            pair(Quantity::new("Elastic modulus", "E", "GPa"), 14.0, 58.0, 0.03, "Box–Behnken", 46),
            pair(Quantity::new("Poisson's ratio", r"\nu", ""), 0.09, 0.38, 0.05, "Box–Behnken", 27),
        ],
        band: Some(0.1),
    }
}

fn observed() -> Agreement {
    let quantity = Quantity::new("Elastic modulus", "E", "GPa");
    let pair = Pair {
        quantity,
        clouds: vec![cloud("", 46, 16.0, 58.0, 0.02, "observed")],
        note: "$R^2$ = 0.9964, $R^2_{pred}$ = 0.9871".into(),
    };
    Agreement { x_word: "Observed".into(), y_word: "Predicted".into(), pairs: vec![pair], band: None }
}

fn convergence() -> Convergence {
    let run = |k: u64| {
        let mut random = Stream::new(2, "descent", k);
        let effort: Vec<f64> = (0..=120).map(f64::from).collect();
        let mut best = Vec::new();
        let mut now = 0.9;
        for _ in &effort {
            if random.uniform() < 0.35 {
                now *= random.uniform_in(0.55, 0.98);
            }
            best.push(now);
        }
        let median = best.iter().map(|b| 3.0 * b + 0.01).collect();
        Descent { name: format!("target {}", k + 1), effort, best, median }
    };
    Convergence { effort: "Generation".into(), misfit: "Misfit $f$ / –".into(), runs: (0..5).map(run).collect() }
}

fn solutions(sets: u64) -> Solutions {
    let keep = [0, 1, 2, 3, 4, 8, 9];
    let all = factors();
    let factors: Vec<Quantity> = keep.iter().map(|&k| all[k].0.clone()).collect();
    let bounds: Vec<[f64; 2]> = keep.iter().map(|&k| [all[k].2[0], all[k].2[2]]).collect();
    let set = |k: u64| {
        let mut random = Stream::new(2, "solutions", k);
        let centre: Vec<f64> =
            bounds.iter().map(|b| random.uniform_in(b[0] + 0.2 * (b[1] - b[0]), b[1] - 0.2 * (b[1] - b[0]))).collect();
        let n = if sets == 1 { 120 } else { 25 };
        let mut misfit: Vec<f64> = (0..n).map(|_| 0.002 + 0.05 * random.uniform()).collect();
        misfit.sort_by(f64::total_cmp);
        let row = |m: &f64| {
            let spread = |(c, b): (&f64, &[f64; 2])| (c + 4.0 * m * (b[1] - b[0]) * random.normal()).clamp(b[0], b[1]);
            centre.iter().zip(&bounds).map(spread).collect()
        };
        let rows = misfit.iter().map(row).collect();
        SolutionSet { name: format!("target {}", k + 1), rows, misfit }
    };
    let sets = (0..sets).map(set).collect();
    Solutions { factors, bounds, sets }
}

fn verification() -> Verification {
    let check = |response: Quantity, target: [f64; 5], noise: f64| {
        let mut random = Stream::new(4, &response.name, 0);
        let runs =
            target.iter().map(|t| (0..5).map(|_| t * (1.0 + 0.01 + noise * random.normal())).collect()).collect();
        Check { response, target: target.to_vec(), runs }
    };
    Verification {
        sets: (1..=5).map(|i| i.to_string()).collect(),
        checks: vec![
            check(Quantity::new("Peak strength", r"\sigma_u", "MPa"), [59.67, 42.67, 36.54, 47.67, 30.1], 0.04),
            check(Quantity::new("Elastic modulus", "E", "GPa"), [32.68, 26.78, 25.66, 21.54, 40.2], 0.025),
            check(Quantity::new("Poisson's ratio", r"\nu", ""), [0.201, 0.209, 0.218, 0.222, 0.15], 0.05),
        ],
    }
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
    let index = |n: &str| names.iter().position(|m| m.0 == n).unwrap();
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
