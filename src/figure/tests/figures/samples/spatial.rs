//! Specimens, cracks and forces.

use figure::chains::{Chains, Link};
use figure::cracks::{By, Crack, Cracks, Moment};
use figure::rose::Rose;
use figure::snapshots::{Snapshots, State};
use figure::solid::{Cut, Penny, Solid};
use figure::specimen::{Outline, Specimen};
use math::random::Stream;

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
pub(super) fn specimen(ratio: f64) -> Specimen {
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
        outline: Outline::Rectangle,
        low: [0.0, 0.0],
        high: [w, h],
        centres,
        radii,
        group,
        groups: vec!["mortar".into(), "aggregate".into()],
        outlines,
    }
}

pub(super) fn cracks() -> Cracks {
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
        by: By::Mode,
        outline: Outline::Rectangle,
        low: [0.0, 0.0],
        high: [100.0, 200.0],
        modes: vec!["tensile crack".into(), "shear crack".into()],
        moments,
        outlines,
        fissures: Vec::new(),
    }
}

/// The specimen slides along its shear band.
pub(super) fn snapshots() -> Snapshots {
    let (specimen, cracks) = (specimen(1.0), cracks());
    let last = cracks.moments.last().expect("four moments");
    let count = last.cracks.len();
    let strain = |i: usize| 2.4e-3 * (0.2 + 0.8 * (i as f64 / count as f64).sqrt());
    let moved = |share: f64| {
        let at = |c: &[f64; 2]| {
            let slid = if c[1] > (c[0] - 20.0) * 200.0 / 62.0 { share.powi(4) } else { 0.0 };
            [c[0] - 0.2 * slid, c[1] - 0.24 * share * (c[1] / 200.0 - 0.5) - 0.4 * slid]
        };
        specimen.centres.iter().map(at).collect()
    };
    let state = |title: &str, share: f64| State { strain: 2.4e-3 * share, title: title.into(), centres: moved(share) };
    let stress = |e: f64| if e < 1.5e-3 { 3e4 * e * (1.0 - e / 3.2e-3) } else { 23.9 * (-(e - 1.5e-3) / 1.2e-3).exp() };
    Snapshots {
        states: vec![
            state("50 % of the peak", 0.2),
            state("80 % of the peak", 0.4),
            state("peak", 0.63),
            state("after the peak, 50 %", 1.0),
        ],
        modes: cracks.modes.clone(),
        cracks: last.cracks.iter().enumerate().map(|(i, c)| (strain(i), *c)).collect(),
        curve: (0..=200).map(|i| [1.2e-5 * f64::from(i), stress(1.2e-5 * f64::from(i))]).collect(),
        specimen,
    }
}

pub(super) fn rose() -> Rose {
    let mut random = Stream::new(5, "rose", 0);
    let tensile = (0..1700).map(|_| 1.57 + 0.42 * random.normal()).collect();
    let shear = (0..500).map(|i| if i % 2 == 0 { 1.05 } else { 2.09 } + 0.2 * random.normal()).collect();
    Rose { modes: vec![("tensile".into(), tensile), ("shear".into(), shear)], petals: 18 }
}

pub(super) fn chains() -> Chains {
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
    Chains {
        outline: Outline::Rectangle,
        low: s.low,
        high: s.high,
        links,
        when: String::new(),
        unit: "kN".into(),
        least: 0.5,
    }
}

/// A Brazilian disc of 50 mm that splits along its diameter.
pub(super) fn disc_cracks() -> Cracks {
    let mut random = Stream::new(6, "disc", 0);
    let mut moment = |title: &str, n: usize| {
        let crack = |_| {
            let along = random.uniform() < 0.9;
            let y = random.uniform_in(-24.0, 24.0);
            let x = if along { 0.6 * random.normal() } else { random.uniform_in(-12.0, 12.0) };
            let angle = 1.57 + if along { 0.3 } else { 0.9 } * random.normal();
            Crack { at: [x, y], angle, length: 0.5, mode: usize::from(y.abs() > 21.0 && random.uniform() < 0.6) }
        };
        Moment { title: title.into(), cracks: (0..n).map(crack).collect() }
    };
    let moments = vec![moment("80 % of the peak", 30), moment("peak", 110), moment("after the peak, 60 %", 420)];
    let modes = vec!["tensile crack".into(), "shear crack".into()];
    Cracks {
        outline: Outline::Disc,
        low: [-25.0; 2],
        high: [25.0; 2],
        modes,
        moments,
        fissures: vec![[[-5.0, 5.0], [5.0, -5.0]]],
        ..Cracks::default()
    }
}

/// The same cracks as interfaces in four classes of damage.
pub(super) fn damage() -> Cracks {
    let cracks = cracks();
    let class = |(k, crack): (usize, Crack)| Crack { mode: k % 4, ..crack };
    let moment = |m: Moment| Moment { cracks: m.cracks.into_iter().enumerate().map(class).collect(), ..m };
    let modes = ["25 % or less broken", "50 % or less", "below 100 %", "100 %"].map(str::to_owned).into();
    let moments = cracks.moments.into_iter().map(moment).collect();
    let fissures = vec![[[30.0, 80.0], [70.0, 40.0]]];
    Cracks { by: By::Damage, modes, moments, fissures, ..cracks }
}

/// The disc itself.
pub(super) fn disc() -> Specimen {
    let (mut centres, mut radii) = (Vec::new(), Vec::new());
    let mut random = Stream::new(6, "grains", 0);
    for row in -40..=40 {
        for column in -40..=40 {
            let x = 0.64 * (f64::from(column) + 0.5 * f64::from(row & 1)) + 0.05 * random.normal();
            let y = 0.56 * f64::from(row);
            if x.hypot(y) < 24.7 {
                centres.push([x, y]);
                radii.push(0.3 + 0.02 * random.uniform());
            }
        }
    }
    let group = vec![0; radii.len()];
    let (outline, groups) = (Outline::Disc, vec!["rock".into()]);
    Specimen { outline, low: [-25.0; 2], high: [25.0; 2], centres, radii, group, groups, outlines: Vec::new() }
}

/// A cube of 150 mm of mortar with large and small aggregate.
/// A core drilled out of the cube along z.
pub(super) fn core(cut: Option<Cut>) -> Solid {
    let cube = cube(None);
    let inside = |i: &usize| (cube.centres[*i][0] - 75.0).hypot(cube.centres[*i][1] - 75.0) + cube.radii[*i] < 75.0;
    let members: Vec<usize> = (0..cube.centres.len()).filter(inside).collect();
    Solid {
        centres: members.iter().map(|&i| cube.centres[i]).collect(),
        radii: members.iter().map(|&i| cube.radii[i]).collect(),
        group: members.iter().map(|&i| cube.group[i]).collect(),
        round: Some(2),
        cut,
        ..cube
    }
}

pub(super) fn cube(cut: Option<f64>) -> Solid {
    let mut random = Stream::new(8, "cube", 0);
    let (mut centres, mut radii, mut group) = (Vec::new(), Vec::new(), Vec::new());
    let mut stones: Vec<([f64; 3], f64)> = Vec::new();
    for radius in [16.0, 12.0, 8.0] {
        for _ in 0..400 {
            let at: [f64; 3] = std::array::from_fn(|_| random.uniform_in(radius, 150.0 - radius));
            let apart = |(other, r): &([f64; 3], f64)| distance(at, *other) > r + radius + 2.0;
            if stones.len() < 60 && stones.iter().all(apart) {
                stones.push((at, radius));
            }
        }
    }
    for k in 0..30_usize.pow(3) {
        let cell = [k % 30, k / 30 % 30, k / 900];
        let at = cell.map(|c| 5.0 * c as f64 + 2.5 + 0.6 * random.normal());
        if stones.iter().all(|(stone, r)| distance(at, *stone) > *r) {
            centres.push(at);
            radii.push(2.4 + 0.3 * random.normal());
            group.push(0);
        }
    }
    for (at, radius) in stones {
        centres.push(at);
        radii.push(radius);
        group.push(1);
    }
    Solid {
        low: [0.0; 3],
        high: [150.0; 3],
        centres,
        radii,
        group,
        groups: vec!["mortar".into(), "aggregate".into()],
        cut: cut.map(|at| Cut { axis: 1, at }),
        ..Solid::default()
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Two inclined bands of cracks in a prism.
pub(super) fn prism_cracks() -> Solid {
    let mut random = Stream::new(8, "prism", 0);
    let crack = |k: usize| {
        let side = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (x, y) = (random.uniform_in(2.0, 48.0), random.uniform_in(2.0, 48.0));
        let z = 50.0 + side * 1.4 * (x - 25.0) + 3.0 * random.normal();
        let normal = [1.0, 0.4 * random.normal(), -side * 0.6 + 0.3 * random.normal()];
        Penny { at: [x, y, z.clamp(1.0, 99.0)], normal, radius: 1.1, mode: usize::from(random.uniform() < 0.25) }
    };
    let cracks = (0..700).map(crack).collect();
    let modes = vec!["tensile crack".into(), "shear crack".into()];
    Solid { low: [0.0; 3], high: [50.0, 50.0, 100.0], cracks, modes, ..Solid::default() }
}
