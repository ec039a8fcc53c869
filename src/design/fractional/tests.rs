use super::*;
use crate::{Layout, Method, build};

fn factors(n: usize) -> Vec<Factor> {
    (0..n).map(|i| Factor::range(&format!("x{}", i + 1), "", -1.0, 1.0)).collect()
}

fn by(generators: &[&str]) -> FractionalFactorial {
    FractionalFactorial { generators: generators.iter().map(ToString::to_string).collect(), ..Default::default() }
}

fn size(runs: usize) -> FractionalFactorial {
    FractionalFactorial { runs: Some(runs), ..Default::default() }
}

fn error(design: FractionalFactorial, factors: &[Factor]) -> String {
    build(&Method::FractionalFactorial(design), factors, Layout::default(), 1).unwrap_err().to_string()
}

/// 2^(3-1), I = ABC, and 2^(5-2), D = AB, E = AC, as printed in NIST's handbook, section 5.3.3.4.
#[test]
fn small_fractions_are_the_printed_matrices() {
    let rows = |d, n| build(&Method::FractionalFactorial(d), &factors(n), Layout::default(), 1).unwrap().coded;
    let half = [[-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
    assert_eq!(rows(by(&["C=AB"]), 3), half);
    assert_eq!(rows(by(&["x3 = x1*x2"]), 3), half);
    let other: Vec<Vec<f64>> = half.iter().map(|r| vec![r[0], r[1], -r[2]]).collect();
    assert_eq!(rows(by(&["C=-AB"]), 3), other);
    let quarter = rows(size(8), 5);
    let text = |r: &Vec<f64>| r.iter().map(|&x| if x > 0.0 { '+' } else { '-' }).collect::<String>();
    let printed = ["---++", "+----", "-+--+", "++-+-", "--++-", "+-+-+", "-++--", "+++++"];
    assert_eq!(quarter.iter().map(text).collect::<Vec<_>>(), printed);
}

/// Word-length patterns (A3, A4, …) of the minimum-aberration designs, from Chen, Sun & Wu 1993 and Wu & Hamada 2009.
#[test]
fn listed_fractions_have_the_published_word_lengths() {
    let published: &[(usize, usize, &[usize])] = &[
        (3, 4, &[1]),
        (4, 8, &[0, 1]),
        (5, 8, &[2, 1]),
        (6, 8, &[4, 3]),
        (7, 8, &[7, 7, 0, 0, 1]),
        (5, 16, &[0, 0, 1]),
        (6, 16, &[0, 3]),
        (7, 16, &[0, 7]),
        (8, 16, &[0, 14, 0, 0, 0, 1]),
        (9, 16, &[4, 14, 8, 0, 4, 1]),
        (10, 16, &[8, 18, 16, 8, 8, 5]),
        (11, 16, &[12, 26, 28, 24, 20, 13, 4]),
        (12, 16, &[16, 39, 48, 48, 48, 39, 16, 0, 0, 1]),
        (13, 16, &[22, 55, 72]),
        (14, 16, &[28, 77, 112]),
        (15, 16, &[35, 105, 168]),
        (6, 32, &[0, 0, 0, 1]),
        (7, 32, &[0, 1, 2]),
        (8, 32, &[0, 3, 4]),
        (9, 32, &[0, 6, 8, 0, 0, 1]),
        (10, 32, &[0, 10, 16, 0, 0, 5]),
        (11, 32, &[0, 25, 0, 27, 0, 10, 0, 1]),
        (12, 32, &[0, 38, 0, 52, 0, 33, 0, 4]),
        (13, 32, &[0, 55, 0, 96]),
        (14, 32, &[0, 77, 0, 168]),
        (15, 32, &[0, 105, 0, 280]),
        (16, 32, &[0, 140, 0, 448]),
        (7, 64, &[0, 0, 0, 0, 1]),
        (8, 64, &[0, 0, 2, 1]),
        (9, 64, &[0, 1, 4, 2]),
        (10, 64, &[0, 2, 8, 4, 0, 1]),
        (11, 64, &[0, 4, 14, 8, 0, 3, 2]),
        (8, 128, &[0, 0, 0, 0, 0, 1]),
        (9, 128, &[0, 0, 0, 3]),
        (10, 128, &[0, 0, 3, 3, 1]),
        (11, 128, &[0, 0, 6, 6, 2, 1]),
    ];
    for (k, runs, lengths) in published {
        let relation = size(*runs).relation(&factors(*k)).unwrap();
        assert_eq!(relation.lengths[3..3 + lengths.len()], **lengths, "{k} factors, {runs} runs");
        assert_eq!(relation.words.len() + 1, (1 << k) / runs);
    }
}

#[test]
fn every_column_and_word_of_a_listed_fraction_is_orthogonal_and_constant() {
    for (k, runs) in [(5, 8), (7, 16), (11, 32), (11, 64), (10, 128)] {
        let design = size(runs);
        let table = build(&Method::FractionalFactorial(design.clone()), &factors(k), Layout::default(), 1).unwrap();
        assert_eq!(table.runs(), runs);
        for a in 0..k {
            for b in 0..a {
                assert_eq!(table.coded.iter().map(|r| r[a] * r[b]).sum::<f64>(), 0.0);
            }
        }
        for (sign, word) in design.relation(&factors(k)).unwrap().words {
            assert!(table.coded.iter().all(|r| word.iter().map(|&i| r[i]).product::<f64>() == f64::from(sign)));
        }
    }
}

#[test]
fn resolution_picks_the_smallest_fraction() {
    let runs = |k, r| {
        let design = FractionalFactorial { resolution: Some(r), ..Default::default() };
        build(&Method::FractionalFactorial(design), &factors(k), Layout::default(), 1).unwrap().runs()
    };
    assert_eq!([runs(5, 3), runs(5, 4), runs(5, 5), runs(5, 6), runs(7, 4), runs(8, 5)], [8, 16, 16, 32, 16, 64]);
    assert_eq!([runs(2, 3), runs(11, 5), runs(15, 3), runs(16, 4)], [4, 128, 16, 32]);
}

#[test]
fn relation_reads_in_factor_names() {
    let f =
        [Factor::range("Ec", "", 0.0, 1.0), Factor::range("kn_ks", "", 0.0, 1.0), Factor::range("mu", "", 0.0, 1.0)];
    assert_eq!(by(&["mu=-Ec*kn_ks"]).relation(&f).unwrap().text(&f, 9), "I = -Ec*kn_ks*mu");
    let r = by(&["F=ABCD", "G=ABDE"]).relation(&factors(7)).unwrap();
    assert_eq!((r.resolution(), r.text(&factors(7), 1).as_str()), (Some(4), "I = x3*x5*x6*x7 = … (3 words)"));
}

#[test]
fn bad_generators_are_refused_each_with_its_reason() {
    let text = error(by(&["E=AQ", "F=A", "G", "D=AAB", "E=AB", "E=BC"]), &factors(7));
    for part in
        ["`AQ` is no factor", "`x6` would be another factor", "\"E=ABCD\"", "`x1` stands twice", "already generated"]
    {
        assert!(text.contains(part), "{part} not in {text}");
    }
    assert!(error(by(&["E=ABF", "F=BCD"]), &factors(6)).contains("`x6` is itself generated"));
    assert!(error(by(&["D=ABC", "E=ABC"]), &factors(5)).contains("I = x4*x5"));
    assert!(error(FractionalFactorial::default(), &factors(5)).contains("exactly one of the three"));
    assert!(error(size(32), &factors(20)).contains("none is listed for 20 factors and 32 runs"));
    let wide =
        [Factor::levels("a", "", &[1.0, 2.0, 3.0]), Factor::range("b", "", 0.0, 1.0), Factor::range("c", "", 0.0, 1.0)];
    assert!(error(size(4), &wide).contains("give two of them, or the range 1 to 3"));
}
