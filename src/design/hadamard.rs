//! Two-level orthogonal tables of N = 4, 8, … 48 runs and N − 1 columns, from Hadamard matrices of order N.
//!
//! The tables are those of Plackett & Burman (1946, *Biometrika* 33, 305, doi:10.1093/biomet/33.4.305): a first row of
//! N − 1 signs is shifted cyclically N − 1 times and a row of −1 is added. How each first row arises:
//!
//! | N | construction |
//! |---|---|
//! | 4, 8, 12, 20, 24, 44, 48 | quadratic residues modulo the prime N − 1 (Paley 1933, type I, doi:10.1002/sapm1933121311) |
//! | 16, 32 | shift-register sequences over GF(2): the regular fractions 2^(15−11) and 2^(31−26) |
//! | 36 | twin primes 5 · 7 (Stanton & Sprott 1958, *Can. J. Math.* 10, 73; printed by Plackett & Burman) |
//! | 28 | not cyclic: nine blocks of 9 × 9 cyclic in A, B, C, each of 3 × 3 circulants, as printed |
//! | 40 | doubling of N = 20: (H, H; H, −H), as printed |

/// First rows as printed by Plackett & Burman.
const CYCLIC: &[(usize, &str)] = &[
    (4, "++-"),
    (8, "+++-+--"),
    (12, "++-+++---+-"),
    (16, "++++-+-++--+---"),
    (20, "++--++++-+-+----++-"),
    (24, "+++++-+-++--++--+-+----"),
    (32, "----+-+-+++-++---+++++--++-+--+"),
    (36, "-+-+++---+++++-+++--+----+-+-++--+-"),
    (44, "++--+-+--+++-+++++---+-+++-----+---++-+-++-"),
    (48, "+++++-++++--+-+-+++--+--++-++---+-+-++----+----"),
];

/// The 9 × 9 blocks A, B, C of 28 runs, by the first row of each of their nine circulants, row by row.
const BLOCKS_28: [[&str; 3]; 3] = [
    ["+-++++---", "---+-++++", "+++---+-+"],
    ["-+---+--+", "--+-+---+", "--+--+-+-"],
    ["++-+-++-+", "+-+++-+-+", "+-++-+++-"],
];

/// A table of ±1: one row a run, N − 1 columns, and how it was made.
#[derive(Clone, Debug)]
pub(super) struct TwoLevel {
    pub(super) rows: Vec<Vec<i8>>,
    pub(super) how: &'static str,
}

/// The table of `runs` runs, if `runs` is a multiple of 4 up to 48.
pub(super) fn two_level(runs: usize) -> Option<TwoLevel> {
    match runs {
        28 => Some(TwoLevel { rows: with_last_row(blocks_28()), how: "blocks of 9 × 9, not cyclic" }),
        40 => Some(TwoLevel { rows: doubled(&two_level(20)?.rows), how: "doubling of 20 runs" }),
        _ => {
            let (_, first) = CYCLIC.iter().find(|(n, _)| *n == runs)?;
            let first = signs(first);
            let count = first.len();
            let rows = (0..count).map(|r| (0..count).map(|c| first[(c + count - r) % count]).collect());
            Some(TwoLevel { rows: with_last_row(rows.collect()), how: "cyclic" })
        }
    }
}

fn signs(text: &str) -> Vec<i8> {
    text.bytes().map(|b| if b == b'+' { 1 } else { -1 }).collect()
}

fn with_last_row(mut rows: Vec<Vec<i8>>) -> Vec<Vec<i8>> {
    rows.push(vec![-1; rows[0].len()]);
    rows
}

/// Rows of blocks (A B C; C A B; B C A).
fn blocks_28() -> Vec<Vec<i8>> {
    let entry = |block: usize, row: usize, column: usize| -> i8 {
        let first = signs(BLOCKS_28[block][row / 3]);
        first[column / 3 * 3 + (column % 3 + 3 - row % 3) % 3]
    };
    let cell = |r: usize, c: usize| entry((c / 9 + 3 - r / 9) % 3, r % 9, c % 9);
    (0..27).map(|r| (0..27).map(|c| cell(r, c)).collect()).collect()
}

/// (H, H; H, −H), the first column of ones left out, with signs of columns such that the last row is −1.
fn doubled(rows: &[Vec<i8>]) -> Vec<Vec<i8>> {
    let half = |sign: i8| {
        move |row: &Vec<i8>| -> Vec<i8> {
            let right = row.iter().map(|x| -sign * x);
            row.iter().copied().chain([sign]).chain(right).collect()
        }
    };
    rows.iter().map(half(1)).chain(rows.iter().map(half(-1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_multiple_of_four_to_48_is_a_hadamard_matrix() {
        for runs in (4..=48).step_by(4) {
            let rows = two_level(runs).unwrap().rows;
            assert_eq!((rows.len(), rows[0].len()), (runs, runs - 1));
            assert!(rows[runs - 1].iter().all(|&x| x == -1));
            for a in 0..runs - 1 {
                assert_eq!(rows.iter().map(|r| i32::from(r[a])).sum::<i32>(), 0, "{runs} runs, column {a}");
                for b in 0..a {
                    let product: i32 = rows.iter().map(|r| i32::from(r[a] * r[b])).sum();
                    assert_eq!(product, 0, "{runs} runs, columns {a} and {b}");
                }
            }
        }
        assert!([0, 2, 6, 10, 52].iter().all(|&n| two_level(n).is_none()));
    }

    #[test]
    fn cyclic_rows_of_prime_order_are_the_quadratic_residues() {
        for runs in [4, 8, 12, 20, 24, 44, 48] {
            let q = runs - 1;
            let field = super::super::galois::Field::new(q.min(23)).unwrap();
            let square = |a: usize| if q <= 23 { field.is_square(a) } else { (1..q).any(|b| b * b % q == a) };
            let row = signs(CYCLIC.iter().find(|(n, _)| *n == runs).unwrap().1);
            // the printed row is the residue row up to shift and direction
            let residue: Vec<i8> = (0..q).map(|a| if a == 0 || square(a) { 1 } else { -1 }).collect();
            let same = |f: &dyn Fn(usize) -> i8| (0..q).any(|s| (0..q).all(|i| row[i] == f((i + s) % q)));
            assert!(same(&|i| residue[i]) || same(&|i| residue[(q - i) % q]), "{runs} runs");
        }
    }
}
