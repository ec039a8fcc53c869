//! Numbers of any size and names of any length: labels stay on the page and apart.

use crate::samples::{self, columns};
use figure::{DOUBLE, Figure, Quantity, SINGLE, Style};

/// A name as a file may hold it.
const LONG: &str = "a_factor_with_a_rather_long_name";

/// What is made of a number.
type Map = fn(f64) -> f64;

/// What becomes of an ordinary number: shifted far from zero, negative and large, small, near the ends of the range.
const MAPS: [(&str, Map); 7] = [
    ("as it is", |v| v),
    ("above 100000", |v| 1e5 + 1e-3 * v),
    ("above 5", |v| 5.0 + 1e-9 * v),
    ("below -3e9", |v| -1e8 * v - 3e9),
    ("small", |v| 1e-7 * v),
    ("tiny", |v| 1e-290 * v),
    ("huge", |v| 1e290 * v),
];

fn long(quantity: &Quantity) -> Quantity {
    Quantity { name: LONG.to_owned(), symbol: String::new(), ..quantity.clone() }
}

/// The figures with their numbers and names replaced.
fn figures(map: Map, name: &dyn Fn(&Quantity) -> Quantity) -> Vec<(&'static str, Box<dyn Figure>)> {
    let all = |values: &mut [f64]| values.iter_mut().for_each(|v| *v = map(*v));
    let mut bars = samples::pareto();
    bars.quantity = name(&bars.quantity);
    for bar in &mut bars.bars {
        (bar.factor, bar.value) = (name(&bar.factor), map(bar.value).abs());
    }
    bars.references.iter_mut().for_each(|(_, at)| *at = map(*at).abs());
    let mut effects = samples::main_effects(false);
    (effects.response, effects.grand_mean) = (name(&effects.response), map(effects.grand_mean));
    effects.factors.truncate(3);
    for factor in &mut effects.factors {
        factor.factor = name(&factor.factor);
        all(&mut factor.levels);
        all(&mut factor.means);
        factor.half_width.clear();
    }
    let mut field = samples::contour();
    [&mut field.x, &mut field.y, &mut field.z].into_iter().for_each(|q| *q = name(q));
    [&mut field.xs, &mut field.ys, &mut field.values].into_iter().for_each(|values| all(values));
    field.points.iter_mut().for_each(|point| all(point));
    let mut xy = columns::xy(1, 1.0);
    [&mut xy.x, &mut xy.y].into_iter().for_each(|q| *q = name(q));
    for cloud in &mut xy.clouds {
        all(&mut cloud.x);
        all(&mut cloud.y);
        cloud.y_error.clear();
        cloud.line = None;
    }
    let mut histogram = columns::histogram(1.0);
    histogram.quantity = name(&histogram.quantity);
    all(&mut histogram.edges);
    histogram.edges.sort_by(f64::total_cmp);
    (histogram.mean, histogram.deviation) = (map(histogram.mean), (map(1.0) - map(0.0)).abs());
    let mut boxes = columns::boxes(4);
    (boxes.by, boxes.y) = (name(&boxes.by), name(&boxes.y));
    for group in &mut boxes.groups {
        all(&mut group.five);
        group.five.sort_by(f64::total_cmp);
        all(&mut group.values);
        group.mean = map(group.mean);
    }
    let mut heat = columns::heat(false);
    [&mut heat.down, &mut heat.across, &mut heat.value].into_iter().for_each(|q| *q = name(q));
    all(&mut heat.cells);
    vec![
        ("bars", Box::new(bars)),
        ("effects", Box::new(effects)),
        ("contour", Box::new(field)),
        ("xy", Box::new(xy)),
        ("histogram", Box::new(histogram)),
        ("boxes", Box::new(boxes)),
        ("heat map", Box::new(heat)),
    ]
}

#[test]
fn numbers_of_any_size_are_readable() {
    look(&Clone::clone);
}

#[test]
fn names_of_any_length_stay_on_the_page() {
    look(&long);
}

fn look(name: &dyn Fn(&Quantity) -> Quantity) {
    let mut found = Vec::new();
    for (map, change) in MAPS {
        for (figure, drawn) in figures(change, name) {
            for width in [SINGLE, DOUBLE] {
                let faults = drawn.scene(&Style::wide(width)).faults();
                found.extend(faults.into_iter().map(|fault| format!("{figure}, {map}, {width} mm: {fault}")));
            }
        }
    }
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}
