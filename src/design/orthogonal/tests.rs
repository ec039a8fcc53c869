use super::*;
use crate::{DesignTable, Layout, Method, build};

fn factors(levels: &[usize]) -> Vec<Factor> {
    let factor = |(i, n): (usize, &usize)| {
        let values: Vec<f64> = (1..=*n).map(|v| v as f64).collect();
        Factor::levels(&format!("x{}", i + 1), "", &values)
    };
    levels.iter().enumerate().map(factor).collect()
}

fn named(table: &str) -> Orthogonal {
    Orthogonal { table: Some(table.into()), ..Default::default() }
}

fn made(design: Orthogonal, levels: &[usize]) -> DesignTable {
    build(&Method::Orthogonal(design), &factors(levels), Layout::default(), 1).unwrap()
}

fn error(design: Orthogonal, levels: &[usize]) -> String {
    build(&Method::Orthogonal(design), &factors(levels), Layout::default(), 1).unwrap_err().to_string()
}

/// Rows as digits, "1" for the first level.
fn digits(table: &DesignTable) -> Vec<String> {
    table.natural.iter().map(|row| row.iter().map(|x| x.to_string()).collect()).collect()
}

/// Every combination of any `strength` columns equally often.
fn assert_strength(array: &Array, strength: usize, what: &str) {
    let runs = array.columns[0].cells.len();
    let k = array.columns.len();
    let check = |chosen: &[usize]| {
        let cells: usize = chosen.iter().map(|&c| array.columns[c].levels).product();
        let mut counts = vec![0; cells];
        for r in 0..runs {
            counts[chosen.iter().fold(0, |cell, &c| cell * array.columns[c].levels + array.columns[c].cells[r])] += 1;
        }
        assert!(counts.iter().all(|&n| n * cells == runs), "{what}: columns {chosen:?} have counts {counts:?}");
    };
    for a in 0..k {
        for b in 0..a {
            check(&[a, b]);
            if strength == 3 {
                (0..b).for_each(|c| check(&[a, b, c]));
            }
        }
    }
}

#[test]
fn every_array_has_its_strength_and_shape() {
    for (list, strength) in [(STRENGTH_TWO, 2), (STRENGTH_THREE, 3)] {
        assert!(list.is_sorted_by_key(|r| r.runs()));
        for recipe in list {
            let array = recipe.build();
            assert_eq!(array.columns.iter().map(|c| c.levels).collect::<Vec<_>>(), recipe.shape());
            assert!(array.columns.iter().all(|c| c.cells.len() == recipe.runs() && c.cells[0] == 0));
            assert_strength(&array, strength, &format!("{recipe:?}"));
        }
    }
}

#[test]
fn the_standard_tables_are_all_there() {
    let standard = [
        "L4(2^3)",
        "L8(2^7)",
        "L8(2^4 4^1)",
        "L9(3^4)",
        "L12(2^11)",
        "L12(2^4 3^1)",
        "L12(2^2 6^1)",
        "L16(2^15)",
        "L16(4^5)",
        "L16(2^12 4^1)",
        "L16(2^9 4^2)",
        "L16(2^6 4^3)",
        "L16(2^3 4^4)",
        "L16(2^8 8^1)",
        "L18(2^1 3^7)",
        "L18(3^6 6^1)",
        "L20(2^19)",
        "L20(2^8 5^1)",
        "L20(2^2 10^1)",
        "L24(2^23)",
        "L24(2^12 12^1)",
        "L24(2^12 3^1 4^1)",
        "L24(2^16 3^1)",
        "L24(2^20 4^1)",
        "L24(2^14 6^1)",
        "L25(5^6)",
        "L27(3^13)",
        "L27(3^9 9^1)",
        "L28(2^27)",
        "L32(2^31)",
        "L32(2^1 4^9)",
        "L32(2^4 4^9)",
        "L32(4^8 8^1)",
        "L32(2^16 16^1)",
        "L36(2^11 3^12)",
        "L36(2^3 3^13)",
        "L36(2^4 3^13)",
        "L36(3^13 4^1)",
        "L36(2^35)",
        "L40(2^39)",
        "L40(2^36 4^1)",
        "L40(2^28 5^1)",
        "L44(2^43)",
        "L48(2^47)",
        "L48(2^44 4^1)",
        "L49(7^8)",
        "L50(2^1 5^11)",
        "L54(2^1 3^25)",
        "L54(3^24 6^1)",
        "L64(2^63)",
        "L64(4^21)",
        "L64(8^9)",
        "L64(2^15 4^16)",
        "L81(3^40)",
        "L81(9^10)",
        "L98(2^1 7^15)",
        "L125(5^31)",
        "L128(2^127)",
        "L162(2^1 9^19)",
        "L243(3^121)",
        "L256(4^85)",
        "L256(16^17)",
    ];
    for table in standard {
        let (runs, columns) = parse(table).unwrap();
        let columns = columns.unwrap();
        let levels: Vec<usize> = columns.iter().flat_map(|(s, n)| vec![*s; *n]).collect();
        let found = named(table).table(&factors(&levels)).unwrap_or_else(|fault| panic!("{table}: {fault}"));
        assert_eq!((found.name.as_str(), found.recipe.runs()), (table, runs));
        assert_strength(&found.array, 2, table);
        // without a name nothing larger is taken
        assert!(Orthogonal::default().table(&factors(&levels)).unwrap().recipe.runs() <= runs);
    }
}

/// Taguchi & Konishi 1987, *Orthogonal Arrays and Linear Graphs*; also NIST handbook 5.3.3.10.
#[test]
fn small_tables_are_the_printed_ones() {
    assert_eq!(digits(&made(named("L4"), &[2; 3])), ["111", "122", "212", "221"]);
    let l8 = ["1111111", "1112222", "1221122", "1222211", "2121212", "2122121", "2211221", "2212112"];
    assert_eq!(digits(&made(named("L8"), &[2; 7])), l8);
    let l9 = ["1111", "1222", "1333", "2123", "2231", "2312", "3132", "3213", "3321"];
    assert_eq!(digits(&made(Orthogonal::default(), &[3; 4])), l9);
    let l27 = digits(&made(named("L27(3^13)"), &[3; 13]));
    assert_eq!(l27[..4], ["1111111111111", "1111222222222", "1111333333333", "1222111222333"]);
    let l18 = digits(&made(named("L18"), &[2, 3, 3, 3, 3, 3, 3, 3]));
    assert_eq!((l18.len(), l18[0].as_str()), (18, "11111111"));
}

/// Generators of the columns of L27 as Taguchi prints them: a, b, ab, ab², c, ac, ac², bc, abc, ab²c², bc², ab²c, abc².
#[test]
fn columns_of_l27_are_the_printed_products() {
    let printed = [
        [1, 0, 0],
        [0, 1, 0],
        [1, 1, 0],
        [1, 2, 0],
        [0, 0, 1],
        [1, 0, 1],
        [1, 0, 2],
        [0, 1, 1],
        [1, 1, 1],
        [1, 2, 2],
        [0, 1, 2],
        [1, 2, 1],
        [1, 1, 2],
    ];
    let array = Recipe::RaoHamming { q: 3, n: 3 }.build();
    for (c, p) in printed.iter().enumerate() {
        let form = |r: usize| (p[0] * (r / 9) + p[1] * (r / 3 % 3) + p[2] * (r % 3)) % 3;
        let same = |factor: usize| (0..27).all(|r| array.columns[c].cells[r] == factor * form(r) % 3);
        assert!(same(1) || same(2), "column {}", c + 1);
    }
}

/// Table 5 and 6 of Su et al. 2021 (doi:10.3390/ma14071627): 14 columns of 64 runs at 32/16/16, the first level
/// doubled.
#[test]
fn the_64_run_table_of_three_levels_is_exactly_proportional() {
    for doubled in 1..=3 {
        let t = made(Orthogonal { doubled: Some(doubled), ..named("L64(4^21)") }, &[3; 14]);
        let count = |test: &dyn Fn(&Vec<f64>) -> bool| t.natural.iter().filter(|r| test(r)).count();
        let expected = |level: usize| if level == doubled { 32 } else { 16 };
        for a in 0..14 {
            for x in 1..=3 {
                assert_eq!(count(&|r| r[a] == x as f64), expected(x));
                for (b, y) in (0..a).flat_map(|b| (1..=3).map(move |y| (b, y))) {
                    assert_eq!(count(&|r| r[a] == x as f64 && r[b] == y as f64) * 64, expected(x) * expected(y));
                }
            }
        }
    }
    let t = made(named("L64"), &[3; 14]);
    assert!(t.construction.starts_with("L64(4^21), Rao–Hamming over GF(4); columns 1, 2, "), "{}", t.construction);
    assert!(t.construction.ends_with("merged levels, level 1 met most often"));
}

/// Third element of the generalized word-length pattern of the tables as others print them (`generate.py`, from the
/// files of pyDOE3, which took them from Taguchi's and Sloane's collections).
#[test]
fn word_lengths_are_those_of_the_published_tables() {
    let published = [
        ("L8(2^7)", 7.0),
        ("L9(3^4)", 8.0),
        ("L12(2^11)", 55.0 / 3.0),
        ("L16(2^15)", 35.0),
        ("L16(4^5)", 30.0),
        ("L18(3^6 6^1)", 40.0),
        ("L25(5^6)", 80.0),
        ("L32(2^1 4^9)", 104.0),
        ("L36(2^11 3^12)", 583.0 / 3.0),
        ("L50(2^1 5^11)", 280.0),
        ("L54(2^1 3^25)", 400.0),
        ("L64(4^21)", 630.0),
        ("L81(3^40)", 1040.0),
    ];
    for (table, a3) in published {
        let (_, columns) = parse(table).unwrap();
        let levels: Vec<usize> = columns.unwrap().iter().flat_map(|(s, n)| vec![*s; *n]).collect();
        let array = named(table).table(&factors(&levels)).unwrap().array;
        let c = &array.columns;
        let mut sum = 0.0;
        for i in 0..c.len() {
            for j in 0..i {
                sum += (0..j).map(|k| array::entanglement(&c[i], &c[j], &c[k])).sum::<f64>();
            }
        }
        assert!((sum - a3).abs() < 1e-9, "{table}: {sum}");
    }
}

#[test]
fn surplus_levels_are_dealt_out_evenly() {
    let balance = |t: &DesignTable, levels: usize| -> Vec<usize> {
        (1..=levels).map(|x| t.natural.iter().filter(|r| r[0] == x as f64).count()).collect()
    };
    assert_eq!(balance(&made(named("L16(4^5)"), &[2; 3]), 2), [8, 8]);
    assert_eq!(balance(&made(named("L25(5^6)"), &[3; 3]), 3), [10, 10, 5]);
    assert_eq!(balance(&made(Orthogonal { doubled: Some(3), ..named("L25(5^6)") }, &[3; 3]), 3), [10, 5, 10]);
}

#[test]
fn the_smallest_table_is_found() {
    let name = |levels: &[usize]| Orthogonal::default().table(&factors(levels)).map(|t| t.name).unwrap();
    assert_eq!(name(&[2; 3]), "L4(2^3)");
    assert_eq!(name(&[2; 8]), "L12(2^11)");
    assert_eq!(name(&[2, 4]), "L8(2^4 4^1)");
    assert_eq!(name(&[3; 5]), "L18(3^6 6^1)");
    assert_eq!(name(&[2, 3, 3, 3]), "L18(2^1 3^7)");
    assert_eq!(name(&[3; 13]), "L27(3^13)");
    assert_eq!(name(&[3; 14]), "L54(3^18 18^1)");
    assert_eq!(name(&[[2; 11].as_slice(), &[3; 12]].concat()), "L36(2^11 3^12)");
    assert_eq!(name(&[5; 7]), "L50(5^10 10^1)");
}

#[test]
fn spare_columns_are_chosen_to_entangle_least() {
    // four factors in L8: the resolution IV fraction, columns 1, 2, 4 and 7
    assert!(made(Orthogonal::default(), &[2; 4]).construction.contains("columns 1, 2, 4, 7"));
    let a3 = |design: Orthogonal, k: usize| {
        let t = made(design, &vec![2; k]);
        let product = |a: usize, b: usize, c: usize| t.coded.iter().map(|r| r[a] * r[b] * r[c]).sum::<f64>();
        (0..k)
            .flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| (a, b, c))))
            .map(|(a, b, c)| product(a, b, c).abs())
            .sum::<f64>()
    };
    assert_eq!(a3(named("L16"), 8), 0.0);
    assert_eq!(a3(Orthogonal { columns: Some((1..=8).collect()), ..named("L16") }, 8), 7.0 * 16.0);
    assert_eq!(a3(named("L32"), 16), 0.0);
}

#[test]
fn strength_three_frees_main_effects() {
    let t = made(Orthogonal { strength: Some(3), ..Default::default() }, &[4; 6]);
    assert_eq!(t.runs(), 64);
    assert_eq!(made(Orthogonal { strength: Some(3), ..Default::default() }, &[2; 12]).runs(), 24);
    assert_eq!(made(Orthogonal { strength: Some(3), ..Default::default() }, &[3; 4]).runs(), 27);
}

#[test]
fn what_does_not_fit_is_refused_with_the_table_that_would() {
    let has = |text: String, part: &str| assert!(text.contains(part), "{part} not in {text}");
    has(error(named("L9"), &[3; 5]), "L9: no table of that size has columns for the 5 factors; known are L9(3^4)");
    has(error(named("L9(3^4)"), &[3; 5]), "it cannot hold 5 factors (5 of 3 levels); L18(3^6 6^1) would");
    has(error(named("L18(2^1 3^8)"), &[3; 5]), "no construction of this table is known here; known are L18(3^6 6^1)");
    has(error(named("L17"), &[3; 5]), "no construction");
    has(error(named("nine"), &[3; 5]), "`table` is \"nine\"");
    has(
        error(Orthogonal::default(), &[6; 4]),
        "`table = \"L49(7^8)\"` would hold them with some levels met more often",
    );
    has(error(Orthogonal { strength: Some(5), ..Default::default() }, &[3; 3]), "strength 2 and 3");
    has(error(Orthogonal { columns: Some(vec![1, 1, 9]), ..named("L9") }, &[3; 3]), "`columns` is 1 twice");
    has(
        error(Orthogonal { columns: Some(vec![1, 1, 9]), ..named("L9") }, &[3; 3]),
        "9 for `x3`; the table has the columns 1 to 4",
    );
    has(error(Orthogonal { columns: Some(vec![1, 2]), ..named("L9") }, &[3; 3]), "a list of 2");
    has(error(Orthogonal { doubled: Some(1), ..named("L9") }, &[3; 3]), "none is merged");
    has(error(Orthogonal { doubled: Some(4), ..named("L64(4^21)") }, &[3; 3]), "`x1` has the levels 1 to 3");
    has(error(Orthogonal::default(), &[2; 300]), "no table here has columns for 300 factors");
}
