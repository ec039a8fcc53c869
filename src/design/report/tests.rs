use super::*;
use crate::box_behnken::BoxBehnken;
use crate::central_composite::{Alpha, CentralComposite};
use crate::factorial::FullFactorial;
use crate::fractional::FractionalFactorial;
use crate::given::Given;
use crate::orthogonal::Orthogonal;
use crate::plackett_burman::PlackettBurman;
use crate::sobol::Sobol;
use crate::{Factor, Layout, Method, build};
use power::{f_critical, noncentral_f_upper};

fn factors(levels: &[usize]) -> Vec<Factor> {
    let factor = |(i, n): (usize, &usize)| {
        let values: Vec<f64> = (0..*n).map(|v| v as f64).collect();
        Factor::levels(&format!("x{}", i + 1), "", &values)
    };
    levels.iter().enumerate().map(factor).collect()
}

fn judged(method: Method, levels: &[usize]) -> Report {
    let table = build(&method, &factors(levels), Layout::default(), 1).unwrap();
    report(&table, Question::default())
}

fn model(report: &Report, kind: Kind) -> &ModelReport {
    report.models.iter().find(|m| m.kind == kind).unwrap()
}

/// The non-centrality behind a power: (effect/σ)² per unit.
fn unit(report: &Report, term: &str) -> f64 {
    report.power.iter().find(|p| p.term == term).unwrap().unit_noncentrality
}

/// `tests/reference/design/generate.py`, scipy's ncf.
#[test]
fn noncentral_tails_are_those_of_scipy() {
    let reference = include_str!("../../../tests/reference/design/power.csv");
    let mut compared = 0;
    for line in reference.lines().filter(|l| !l.starts_with('#')) {
        let c: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
        let critical = f_critical(c[0], c[1], c[2]);
        assert!((critical / c[4] - 1.0).abs() < 1e-11, "{line}: {critical}");
        let tail = noncentral_f_upper(c[4], c[1], c[2], c[3]);
        assert!((tail / c[5] - 1.0).abs() < 1e-10, "{line}: {tail}");
        compared += 1;
    }
    assert_eq!(compared, 40);
}

#[test]
fn aliases_of_a_fraction_are_its_defining_relation() {
    // I = x1 x2 x4 = x1 x3 x5 = x2 x3 x4 x5
    let design = FractionalFactorial { runs: Some(8), ..Default::default() };
    let r = judged(Method::FractionalFactorial(design), &[2; 5]);
    let text: Vec<String> =
        r.aliases.iter().flatten().map(|a| format!("{}={:+}{}", a.main, a.coefficient.round(), a.with)).collect();
    assert_eq!(text, ["x1=+1x2*x4", "x1=+1x3*x5", "x2=+1x1*x4", "x3=+1x1*x5", "x4=+1x1*x2", "x5=+1x1*x3"]);
    assert_eq!((r.balance.strength, r.balance.largest_correlation, r.runs), (Some(2), 0.0, 8));
    assert!(model(&r, Kind::Main).estimable());
    let inter = model(&r, Kind::Interactions);
    assert_eq!((inter.terms, inter.rank), (16, Some(8)));
    assert_eq!(inter.missing, ["x1*x2", "x1*x3", "x1*x4", "x1*x5", "x2*x4", "x3*x4", "x3*x5", "x4*x5"]);
}

#[test]
fn resolution_five_leaves_main_effects_and_interactions_clear() {
    let design = FractionalFactorial { runs: Some(16), ..Default::default() };
    let r = judged(Method::FractionalFactorial(design), &[2; 5]);
    assert_eq!((r.aliases.as_deref(), r.balance.strength), (Some([].as_slice()), Some(4)));
    let design = FractionalFactorial { runs: Some(16), centre_points: 3, ..Default::default() };
    let with_centre = judged(Method::FractionalFactorial(design), &[2; 5]);
    assert_eq!((with_centre.balance.strength, with_centre.balance.disproportional_pairs), (Some(4), Some(0)));
    assert_eq!(with_centre.balance.factors[0].counts, [(0.0, 8), (0.5, 3), (1.0, 8)]);
    assert_eq!(with_centre.power_model, Some(Kind::Interactions));
    let inter = model(&r, Kind::Interactions);
    assert_eq!((inter.rank, inter.residual_df), (Some(16), 0));
    // no degrees of freedom beside the interactions: power is that of the main effects
    assert_eq!(r.power_model, Some(Kind::Main));
}

/// Twelve runs: every main effect shares ±1/3 with each interaction of two others (Plackett & Burman 1946).
#[test]
fn plackett_burman_aliases_are_thirds() {
    let r = judged(Method::PlackettBurman(PlackettBurman::default()), &[2; 11]);
    let aliases = r.aliases.as_ref().unwrap();
    assert_eq!(aliases.len(), 11 * 45);
    assert!(aliases.iter().all(|a| (a.coefficient.abs() - 1.0 / 3.0).abs() < 1e-12));
    assert_eq!((r.power_model, r.power.len()), (None, 0));
    let folded = judged(Method::PlackettBurman(PlackettBurman { fold: true, ..Default::default() }), &[2; 11]);
    assert_eq!(folded.aliases.as_deref(), Some([].as_slice()));
    assert_eq!(folded.balance.strength, Some(3));
}

#[test]
fn the_64_run_table_is_proportional_but_not_balanced() {
    let design = Orthogonal { table: Some("L64(4^21)".into()), ..Default::default() };
    let r = judged(Method::Orthogonal(design), &[3; 14]);
    assert_eq!((r.balance.disproportional_pairs, r.balance.strength), (Some(0), Some(0)));
    assert_eq!(r.balance.largest_correlation, 0.0);
    assert!(r.balance.factors.iter().all(|f| f.counts.iter().map(|c| c.1).eq([32, 16, 16])));
    let levels = model(&r, Kind::Levels);
    assert_eq!((levels.rank, levels.residual_df), (Some(29), 35));
    assert_eq!(r.power_model, Some(Kind::Levels));
    // the two levels met 16 times differ with variance σ²(1/16 + 1/16)
    assert!((unit(&r, "x1") - 8.0).abs() < 1e-9 && r.power[0].df == 2);
    assert!(!model(&r, Kind::SecondOrder).estimable());
}

/// Table 6 as printed: SPSS's table of the same kind.
#[test]
fn the_published_table_is_exactly_proportional() {
    let text = include_str!("../../../tests/reference/design/su2021_table06.csv");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|l| !l.starts_with('#'))
        .map(|l| l.split(',').map(|c| c.parse::<f64>().unwrap() - 1.0).collect())
        .collect();
    let r = judged(Method::Given(Given { rows, ..Default::default() }), &[3; 14]);
    assert_eq!((r.runs, r.distinct, r.balance.disproportional_pairs), (64, 63, Some(0)));
    assert!(r.balance.factors.iter().all(|f| f.counts.iter().map(|c| c.1).eq([32, 16, 16])));
    assert_eq!(model(&r, Kind::Levels).residual_df, 35);
}

/// Largest VIF and condition number of the column-scaled matrix from statsmodels and numpy (`generate.py`).
#[test]
fn surface_designs_estimate_the_second_order() {
    let ccd = Method::CentralComposite(CentralComposite { centre_points: Some(5), ..Default::default() });
    let r = judged(ccd, &[2, 2]);
    let second = model(&r, Kind::SecondOrder);
    assert_eq!((second.terms, second.rank, second.residual_df), (6, Some(6), 7));
    let inflation = second.largest_inflation.as_ref().unwrap().1;
    assert!((inflation - 1.0173076923076925).abs() < 1e-12, "{inflation}");
    assert!((second.condition - 2.915305446487741).abs() < 1e-12, "{}", second.condition);
    assert_eq!(r.power_model, Some(Kind::SecondOrder));

    let r = judged(Method::BoxBehnken(BoxBehnken::default()), &[3; 4]);
    let second = model(&r, Kind::SecondOrder);
    assert_eq!((second.terms, second.rank, second.residual_df), (15, Some(15), 12));
    assert!((second.largest_inflation.as_ref().unwrap().1 - 1.25).abs() < 1e-12);
    assert!((second.condition - 6.202742008738108).abs() < 1e-11, "{}", second.condition);
    assert_eq!(r.aliases.as_deref(), Some([].as_slice()));
}

#[test]
fn missing_terms_are_named() {
    // two levels cannot show curvature; face points without a third level of x2
    let r = judged(Method::FullFactorial(FullFactorial { centre_points: 0 }), &[3, 2]);
    let second = model(&r, Kind::SecondOrder);
    assert_eq!((second.rank, second.missing.as_slice()), (Some(5), ["x2^2".to_string()].as_slice()));
    let table =
        build(&Method::FullFactorial(FullFactorial { centre_points: 0 }), &factors(&[3, 2]), Layout::default(), 1);
    let lines = r.lines(&table.unwrap());
    let line =
        lines.iter().find(|l| l.section == "model" && l.subject == "second order" && l.quantity == "rank").unwrap();
    assert_eq!(line.text, "cannot be told from earlier terms: x2^2");
}

/// Power of one-way and 2^k layouts has closed non-centralities: n δ² / 2 per level pair, N (δ/2)² for a slope.
#[test]
fn noncentralities_are_the_closed_ones() {
    let r = judged(Method::Orthogonal(Orthogonal::default()), &[3; 3]);
    assert!((unit(&r, "x1") - 1.5).abs() < 1e-12);
    let cube = Method::FullFactorial(FullFactorial { centre_points: 3 });
    let r = judged(cube, &[2; 3]);
    assert_eq!(r.power_model, Some(Kind::Interactions));
    assert!((unit(&r, "x1") - 2.0).abs() < 1e-12 && (unit(&r, "x1*x3") - 2.0).abs() < 1e-12);
    let p = &r.power[0];
    let again = noncentral_f_upper(f_critical(0.05, 1.0, 4.0), 1.0, 4.0, 2.0 * p.detectable * p.detectable);
    assert!((again - 0.8).abs() < 1e-9);
}

#[test]
fn a_sample_is_judged_by_its_spread() {
    let sobol = Method::Sobol(Sobol { runs: 16, scramble: false, skip: 0 });
    let ranges: Vec<Factor> = (0..3).map(|i| Factor::range(&format!("x{i}"), "", 0.0, 1.0)).collect();
    let table = build(&sobol, &ranges, Layout::default(), 1).unwrap();
    let spread = report(&table, Question::default()).spread.unwrap();
    // scipy.stats.qmc.discrepancy, method CD
    assert!((spread.discrepancy - 0.00787341567101274).abs() < 1e-14, "{}", spread.discrepancy);
    assert!((spread.smallest_distance - least(&table.coded)).abs() < 1e-15);
}

fn least(coded: &[Vec<f64>]) -> f64 {
    let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>() / 4.0;
    let pairs = (0..coded.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| square(&coded[i], &coded[j])).fold(f64::INFINITY, f64::min).sqrt()
}

/// Tables 9 to 11 of Su et al. 2021, coded: the same set of points as ours.
#[test]
fn published_surface_tables_have_our_points() {
    let text = include_str!("../../../tests/reference/design/su2021_surfaces.csv");
    let printed = |name: &str| -> Vec<Vec<f64>> {
        let rows = text.lines().filter_map(|l| l.strip_prefix(name)?.strip_prefix(','));
        rows.map(|l| l.split(',').map(|c| c.parse().unwrap()).collect()).collect()
    };
    let ccd = CentralComposite { alpha: Alpha::Rotatable, centre_points: Some(5), ..Default::default() };
    let [two, four, five] = [
        vec![Factor::range("sigma_c", "MPa", 10.0, 30.0), Factor::range("tau_c", "MPa", 10.0, 30.0)],
        vec![
            Factor::range("Ec", "GPa", 10.0, 30.0),
            Factor::range("kn_ks", "", 1.0, 4.0),
            Factor::range("mu", "", 0.5, 1.5),
            Factor::range("kn_ks_j", "", 1.0, 4.0),
        ],
        vec![
            Factor::range("Ec", "GPa", 10.0, 30.0),
            Factor::range("kn_ks", "", 1.0, 4.0),
            Factor::range("mu", "", 0.5, 1.5),
            Factor::range("Ecj", "GPa", 5.0, 15.0),
            Factor::range("kn_ks_j", "", 1.0, 4.0),
        ],
    ];
    for (name, method, factors) in [
        ("ccd", Method::CentralComposite(ccd), two),
        ("bbd4", Method::BoxBehnken(BoxBehnken::default()), four),
        ("bbd5", Method::BoxBehnken(BoxBehnken::default()), five),
    ] {
        let ours = build(&method, &factors, Layout::default(), 1).unwrap();
        // the paper prints three decimals of α
        let near = |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-3);
        let mut rest = ours.natural.clone();
        for row in printed(name) {
            let at = rest.iter().position(|r| near(r, &row));
            rest.remove(at.unwrap_or_else(|| panic!("{name}: {row:?} is not ours")));
        }
        assert_eq!(rest.len(), 0, "{name}");
    }
}
