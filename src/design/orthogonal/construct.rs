//! The constructions. Each gives an array of strength two or more; the tests count every pair (or triple) of columns.

use super::array::Array;
use crate::galois::Field;
use crate::hadamard::two_level;

/// How an array is made. `q` and `order` are prime powers for which [`Field`] exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Recipe {
    /// OA(qⁿ, (qⁿ − 1)/(q − 1), q, 2): one column for every point of the projective geometry PG(n − 1, q), the linear
    /// form of that point (Rao 1947; Bose 1947).
    RaoHamming { q: usize, n: u32 },
    /// OA(qᵗ, q + 1, q, t): polynomials of degree below t at every element, and their leading coefficient (Bush 1952);
    /// for even q and t = 3 one more column, the middle coefficient.
    Bush { q: usize, t: u32 },
    /// OA(N, N − 1, 2, 2) from a Hadamard matrix.
    Hadamard(usize),
    /// OA(2N, N, 2, 3): a Hadamard matrix over its mirror image.
    Fold(usize),
    /// OA(rq, r¹ qᶜ, 2) from a difference scheme with r rows over q levels (Bose & Bush 1952): every row of the scheme
    /// plus every element, and the number of the row.
    Developed(Scheme),
    /// All combinations of two factors.
    Product(usize, usize),
    /// OA(4s, s¹ 2²⁽ˢ⁻¹⁾, 2) for s = 3 and 5 (Wang & Wu 1991): every level of the first column has four runs, and in
    /// them every other column is one of the three contrasts of L4, with a sign, as [`contrasts`] lists them.
    Contrasts(usize),
    /// OA(2m, m¹ 2², 2) for even m: every level has one run of either sign, in the last column turned about in half of
    /// them.
    Halves(usize),
    /// OA(2N, 4¹ 2²ᴺ⁻⁴, 2): a Hadamard matrix of order N twice, the second time with a new sign. A column, the sign and
    /// their product make the one of four levels (Addelman 1962).
    Quadruple(usize),
}

/// A difference scheme D(r, r, q): the differences of any two columns take every element equally often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scheme {
    /// D(Q, Q, q): the multiplication table of GF(Q) seen in the additive group of GF(q), Q a power of q's prime.
    Products { order: usize, q: usize },
    /// D(2q, 2q, q) for odd q (Masuyama 1957; Jungnickel 1979): the one behind Addelman & Kempthorne's 2qⁿ runs.
    Double(usize),
    /// D(12, 12, 3) (Seiden 1954).
    Twelve,
    /// D(18, 18, 3): the Kronecker sum of D(3, 3, 3) and D(6, 6, 3).
    Eighteen,
    /// D(N, N, 2): a Hadamard matrix.
    Signs(usize),
}

impl Recipe {
    /// Levels of the columns.
    pub(super) fn shape(self) -> Vec<usize> {
        match self {
            Self::RaoHamming { q, n } => vec![q; (q.pow(n) - 1) / (q - 1)],
            Self::Bush { q, t } => vec![q; q + 1 + usize::from(q % 2 == 0 && t == 3)],
            Self::Hadamard(n) => vec![2; n - 1],
            Self::Fold(n) => vec![2; n],
            Self::Developed(scheme) => {
                let (r, q) = scheme.size();
                [vec![r], vec![q; r]].concat()
            }
            Self::Product(a, b) => vec![a, b],
            Self::Contrasts(s) => [vec![s], vec![2; 2 * (s - 1)]].concat(),
            Self::Halves(m) => vec![m, 2, 2],
            Self::Quadruple(n) => [vec![4], vec![2; 2 * n - 4]].concat(),
        }
    }

    /// Number of runs.
    pub(super) fn runs(self) -> usize {
        match self {
            Self::RaoHamming { q, n: power } | Self::Bush { q, t: power } => q.pow(power),
            Self::Hadamard(n) => n,
            Self::Fold(n) | Self::Halves(n) | Self::Quadruple(n) => 2 * n,
            Self::Contrasts(s) => 4 * s,
            Self::Developed(scheme) => scheme.size().0 * scheme.size().1,
            Self::Product(a, b) => a * b,
        }
    }

    /// Strength: any choice of this many columns is a full factorial, equally often.
    pub(super) fn strength(self) -> usize {
        match self {
            Self::Bush { t, .. } => t as usize,
            Self::Fold(_) => 3,
            _ => 2,
        }
    }

    /// The array.
    pub(super) fn build(self) -> Array {
        let (runs, shape) = (self.runs(), self.shape());
        match self {
            Self::RaoHamming { q, n } => rao_hamming(q, n as usize),
            Self::Bush { q, t } => bush(q, t as usize),
            Self::Hadamard(n) => {
                let rows = hadamard(n);
                Array::from_fn(runs, &shape, |r, c| rows[r][c + 1])
            }
            Self::Fold(n) => {
                let rows = hadamard(n);
                Array::from_fn(runs, &shape, |r, c| rows[r % n][c] ^ (r / n))
            }
            Self::Developed(scheme) => {
                let (field, entries) = scheme.build();
                let q = field.order();
                Array::from_fn(
                    runs,
                    &shape,
                    |r, c| if c == 0 { r / q } else { field.add(entries[r / q][c - 1], r % q) },
                )
            }
            Self::Product(_, b) => Array::from_fn(runs, &shape, |r, c| if c == 0 { r / b } else { r % b }),
            Self::Contrasts(s) => {
                let words = contrasts(s);
                Array::from_fn(runs, &shape, |r, c| if c == 0 { r / 4 } else { contrast(words[c - 1][r / 4], r % 4) })
            }
            Self::Halves(m) => Array::from_fn(runs, &shape, |r, c| match c {
                0 => r / 2,
                1 => r % 2,
                _ => (r % 2) ^ usize::from(r >= m),
            }),
            Self::Quadruple(n) => {
                let rows = hadamard(n);
                Array::from_fn(runs, &shape, |r, c| match c {
                    0 => 2 * rows[r % n][1] + r / n,
                    c if c < n - 1 => rows[r % n][c + 1],
                    c => rows[r % n][c + 3 - n] ^ (r / n),
                })
            }
        }
    }

    /// The construction in words.
    pub(super) fn words(self) -> String {
        match self {
            Self::RaoHamming { q, .. } => format!("Rao–Hamming over GF({q})"),
            Self::Bush { q, t } => format!("Bush, strength {t} over GF({q})"),
            Self::Hadamard(n) => format!("Hadamard matrix of order {n}"),
            Self::Fold(n) => format!("Hadamard matrix of order {n} folded over, strength 3"),
            Self::Developed(scheme) => {
                let (r, q) = scheme.size();
                format!("difference scheme D({r}, {r}, {q})")
            }
            Self::Product(..) => "all combinations".into(),
            Self::Contrasts(_) => "signed contrasts of L4 in blocks of four runs".into(),
            Self::Halves(_) => "pairs of opposite runs".into(),
            Self::Quadruple(n) => format!("Hadamard matrix of order {n} doubled"),
        }
    }

    /// Who published it.
    pub(super) fn source(self) -> &'static str {
        match self {
            Self::RaoHamming { .. } => "Rao 1947, J. R. Stat. Soc. Suppl. 9, 128, doi:10.2307/2983576",
            Self::Bush { .. } => "Bush 1952, Ann. Math. Stat. 23, 426, doi:10.1214/aoms/1177729387",
            Self::Hadamard(_) => "Plackett & Burman 1946, Biometrika 33, 305, doi:10.1093/biomet/33.4.305",
            Self::Developed(Scheme::Double(_) | Scheme::Eighteen) => {
                "Addelman & Kempthorne 1961, Ann. Math. Stat. 32, 1167, doi:10.1214/aoms/1177704855"
            }
            Self::Developed(Scheme::Twelve) => "Seiden 1954, Ann. Math. Stat. 25, 151, doi:10.1214/aoms/1177728855",
            Self::Developed(_) | Self::Fold(_) => {
                "Bose & Bush 1952, Ann. Math. Stat. 23, 508, doi:10.1214/aoms/1177729331"
            }
            Self::Product(..) | Self::Halves(_) => "Fisher 1935, The Design of Experiments",
            Self::Contrasts(_) => {
                "Wang & Wu 1991, J. Am. Stat. Assoc. 86, 450; listed by Xu 2002, Technometrics 44, 356"
            }
            Self::Quadruple(_) => "Addelman 1962, Technometrics 4, 21, doi:10.1080/00401706.1962.10489985",
        }
    }
}

fn field(q: usize) -> Field {
    Field::new(q).unwrap_or_else(|| panic!("BUG: no field of {q} elements"))
}

/// Hadamard matrix as bits (0 for +), its first column and last row constant.
fn hadamard(n: usize) -> Vec<Vec<usize>> {
    let table = two_level(n).unwrap_or_else(|| panic!("BUG: no Hadamard matrix of order {n}"));
    let bits = |row: &Vec<i8>| [vec![0], row.iter().map(|&x| usize::from(x < 0)).collect()].concat();
    // the row of −1 comes first, as 0, so that run 1 has every factor at its first level
    table
        .rows
        .iter()
        .rev()
        .map(bits)
        .map(|row: Vec<usize>| row.iter().enumerate().map(|(c, b)| b ^ usize::from(c > 0)).collect())
        .collect()
}

/// Points are ordered as in the printed tables (1, 2, 12, 3, 13, 23, 123 …): the last coordinate other than 0 is 1.
fn rao_hamming(q: usize, n: usize) -> Array {
    let f = field(q);
    let mut points: Vec<Vec<usize>> = Vec::new();
    for last in 0..n {
        for low in 0..q.pow(last as u32) {
            let mut point: Vec<usize> = (0..last).map(|i| low / q.pow(i as u32) % q).collect();
            point.push(1);
            points.push(point);
        }
    }
    let coordinate = |r: usize, i: usize| r / q.pow((n - 1 - i) as u32) % q;
    let form = |r: usize, c: usize| {
        points[c].iter().enumerate().fold(0, |sum, (i, &p)| f.add(sum, f.mul(p, coordinate(r, i))))
    };
    Array::from_fn(q.pow(n as u32), &vec![q; points.len()], form)
}

fn bush(q: usize, t: usize) -> Array {
    let f = field(q);
    let coefficient = |r: usize, i: usize| r / q.pow(i as u32) % q;
    let cell = |r: usize, c: usize| match c {
        // Horner's rule from the leading coefficient down
        x if x < q => (0..t).rev().fold(0, |sum, i| f.add(f.mul(sum, x), coefficient(r, i))),
        x if x == q => coefficient(r, t - 1),
        _ => coefficient(r, 1),
    };
    Array::from_fn(q.pow(t as u32), &Recipe::Bush { q, t: t as u32 }.shape(), cell)
}

impl Scheme {
    /// Rows (= columns) and levels.
    pub(super) fn size(self) -> (usize, usize) {
        match self {
            Self::Products { order, q } => (order, q),
            Self::Double(q) => (2 * q, q),
            Self::Twelve => (12, 3),
            Self::Eighteen => (18, 3),
            Self::Signs(n) => (n, 2),
        }
    }

    /// The group of its entries (as a field) and the entries, row by row.
    fn build(self) -> (Field, Vec<Vec<usize>>) {
        let (r, q) = self.size();
        let group = field(q);
        let entries = match self {
            Self::Products { order, .. } => {
                let big = field(order);
                (0..r).map(|i| (0..r).map(|j| big.mul(i, j) % q).collect()).collect()
            }
            Self::Double(_) => double(&group),
            Self::Twelve => TWELVE.iter().map(|row| row.bytes().map(|b| usize::from(b - b'0')).collect()).collect(),
            Self::Eighteen => {
                let (three, six) = (Self::Products { order: 3, q: 3 }.build().1, double(&group));
                (0..18).map(|i| (0..18).map(|j| group.add(three[i / 6][j / 6], six[i % 6][j % 6])).collect()).collect()
            }
            Self::Signs(n) => hadamard(n),
        };
        (group, entries)
    }
}

/// D(2q, 2q, q), q odd. Row (j, y), column (i, x) holds a_ij xy + b_ij x² + c_ij y² with ν a non-square and
/// a = (1 1; 1 ν), b = (0, (1/ν − 1)/4; 0, (1 − ν)/4), c = (0 0; −1 −ν). For two columns of one kind the term in y runs
/// through the field; for columns of two kinds completing the square leaves K + y'² for j = 1 and K + νy'² for j = 2:
/// squares and non-squares, each element twice.
fn double(f: &Field) -> Vec<Vec<usize>> {
    let q = f.order();
    let non_square = (1..q).find(|&a| !f.is_square(a)).unwrap_or_else(|| panic!("BUG: {q} is even"));
    let two = f.add(1, 1);
    let quarter = f.inverse(f.mul(two, two));
    let minus = |a: usize, b: usize| f.add(a, f.negative(b));
    let a = [[1, 1], [1, non_square]];
    let b = [[0, f.mul(quarter, minus(f.inverse(non_square), 1))], [0, f.mul(quarter, minus(1, non_square))]];
    let c = [[0, 0], [f.negative(1), f.negative(non_square)]];
    let entry = |row: usize, column: usize| {
        let ((j, y), (i, x)) = ((row / q, row % q), (column / q, column % q));
        let mixed = f.mul(a[i][j], f.mul(x, y));
        f.add(mixed, f.add(f.mul(b[i][j], f.mul(x, x)), f.mul(c[i][j], f.mul(y, y))))
    };
    (0..2 * q).map(|row| (0..2 * q).map(|column| entry(row, column)).collect()).collect()
}

/// D(12, 12, 3): the rows of the published L36 (2¹¹ 3¹²), three runs each.
const TWELVE: [&str; 12] = [
    "000000000000",
    "000011112222",
    "001201220112",
    "002102121021",
    "012021022101",
    "012100212210",
    "010222011012",
    "011220100221",
    "021012202011",
    "021110021202",
    "022212110100",
    "020121201120",
];

/// For every two-level column, the contrast of L4 (1 to 3, negative when turned about) in each block of four runs.
///
/// Two columns are orthogonal when their contrasts, wherever they are the same, agree in sign as often as not. The words
/// were found by searching a set in which all pairs are; the tests count them.
fn contrasts(s: usize) -> &'static [&'static [i8]] {
    match s {
        3 => &[&[1, 1, 1], &[1, 2, -1], &[2, 3, 2], &[2, -3, 3]],
        5 => &[
            &[1, 1, 1, 1, 1],
            &[1, 2, -1, -3, 2],
            &[3, -2, 2, 2, 2],
            &[3, -3, -3, -2, -3],
            &[1, -1, -3, 3, 3],
            &[3, 3, -1, 1, -2],
            &[1, -2, 3, -2, -1],
            &[3, 1, -2, -1, 3],
        ],
        _ => panic!("BUG: no contrasts for {s} blocks"),
    }
}

/// Level of a contrast of L4 in its run.
fn contrast(which: i8, run: usize) -> usize {
    let level = match which.unsigned_abs() {
        1 => run / 2,
        2 => run % 2,
        _ => (run / 2) ^ (run % 2),
    };
    level ^ usize::from(which < 0)
}
