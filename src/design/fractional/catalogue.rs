//! Fractions of minimum aberration up to 128 runs (Chen, Sun & Wu 1993; Box, Hunter & Hunter 2005).

use super::generator::{LETTERS, Word};
use crate::error::Fault;

/// Runs, and the generators of the factors beyond the basic ones, in the order of the factors.
const DESIGNS: &[(usize, &[&str])] = &[
    (4, &["AB"]),
    (8, &["ABC"]),
    (8, &["AB", "AC"]),
    (8, &["AB", "AC", "BC"]),
    (8, &["AB", "AC", "BC", "ABC"]),
    (16, &["ABCD"]),
    (16, &["ABC", "BCD"]),
    (16, &["ABC", "BCD", "ACD"]),
    (16, &["BCD", "ACD", "ABC", "ABD"]),
    (16, &["ABC", "BCD", "ACD", "ABD", "ABCD"]),
    (16, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB"]),
    (16, &["ABC", "BCD", "ACD", "ABD", "ABCD", "AB", "AC"]),
    (16, &["ABC", "ABD", "ACD", "BCD", "ABCD", "AB", "AC", "AD"]),
    (16, &["ABC", "ABD", "ACD", "BCD", "ABCD", "AB", "AC", "AD", "BC"]),
    (16, &["ABC", "ABD", "ACD", "BCD", "ABCD", "AB", "AC", "AD", "BC", "BD"]),
    (16, &["ABC", "ABD", "ACD", "BCD", "ABCD", "AB", "AC", "AD", "BC", "BD", "CD"]),
    (32, &["ABCDE"]),
    (32, &["ABCD", "ABDE"]),
    (32, &["ABC", "ABD", "BCDE"]),
    (32, &["BCDE", "ACDE", "ABDE", "ABCE"]),
    (32, &["ABCD", "ABCE", "ABDE", "ACDE", "BCDE"]),
    (32, &["ABC", "BCD", "CDE", "ACD", "ADE", "BDE"]),
    (32, &["ACE", "ACD", "ABD", "ABE", "CDE", "ABCDE", "ADE"]),
    (32, &["ABC", "ABD", "ABE", "ACD", "ACE", "ADE", "BCD", "BCE"]),
    (32, &["ABC", "ABD", "ABE", "ACD", "ACE", "ADE", "BCD", "BCE", "BDE"]),
    (32, &["ABC", "ABD", "ABE", "ACD", "ACE", "ADE", "BCD", "BCE", "BDE", "CDE"]),
    (32, &["ABC", "ABD", "ABE", "ACD", "ACE", "ADE", "BCD", "BCE", "BDE", "CDE", "ABCDE"]),
    (64, &["ABCDEF"]),
    (64, &["ABCD", "ABEF"]),
    (64, &["ABCD", "ACEF", "CDEF"]),
    (64, &["BCDF", "ACDF", "ABDE", "ABCE"]),
    (64, &["CDE", "ABCD", "ABF", "BDEF", "ADEF"]),
    (128, &["ABCDEFG"]),
    (128, &["ACDFG", "BCEFG"]),
    (128, &["ABCG", "BCDE", "ACDF"]),
    (128, &["ABCG", "BCDE", "ACDF", "ABCDEFG"]),
];

/// The listed fraction for `factors` factors in `runs` runs, or the smallest of at least this `resolution`; a full
/// factorial where that is the smallest.
pub(super) fn find(factors: usize, runs: Option<usize>, resolution: Option<usize>) -> Result<Vec<Word>, Fault> {
    let listed = || {
        let fits =
            move |(runs, generators): &&(usize, &[&str])| runs.trailing_zeros() as usize + generators.len() == factors;
        DESIGNS.iter().filter(fits).map(move |(runs, generators)| (*runs, words(*runs, generators)))
    };
    let full = 1_usize << factors.min(20);
    let shortest = |w: &[Word]| super::relation(w, factors).resolution().unwrap_or(usize::MAX);
    let found = match (runs, resolution) {
        (Some(runs), _) if runs == full => Some(vec![]),
        (Some(runs), _) => listed().find(|(n, _)| *n == runs).map(|(_, w)| w),
        (None, least) => {
            let enough = |w: &[Word]| shortest(w) >= least.unwrap_or(3);
            listed().find(|(_, w)| enough(w)).map(|(_, w)| w).or((factors <= 7).then(Vec::new))
        }
    };
    found.ok_or_else(|| {
        let mut sizes: Vec<String> =
            listed().map(|(n, w)| format!("{n} runs of resolution {}", shortest(&w))).collect();
        if factors <= 20 {
            sizes.push(format!("{full} runs, the full factorial"));
        }
        let asked = match (runs, resolution) {
            (Some(runs), _) => format!("{runs} runs"),
            (_, Some(r)) => format!("resolution {r}"),
            _ => "no size".into(),
        };
        Fault::NoConstruction {
            design: "fractional factorial".into(),
            found: format!("none is listed for {factors} factors and {asked}"),
            remedy: match sizes.is_empty() {
                true => "give `generators`, or fewer factors".to_owned(),
                false => format!("listed are: {}; or give `generators`", sizes.join(", ")),
            },
        }
    })
}

/// Words of generators whose targets follow the basic factors.
fn words(runs: usize, generators: &[&str]) -> Vec<Word> {
    let basic = runs.trailing_zeros() as usize;
    let position = |letter: char| LETTERS.find(letter).unwrap_or_else(|| panic!("BUG: no factor letter {letter}"));
    let word =
        |(i, text): (usize, &&str)| Word { target: basic + i, factors: text.chars().map(position).collect(), sign: 1 };
    generators.iter().enumerate().map(word).collect()
}
