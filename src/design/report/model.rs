//! Models and whether a table can estimate them.
//!
//! The columns of the model matrix X (coded units) are made orthogonal one after the other, X = QR, by Gram–Schmidt
//! done twice (Giraud, Langou & Rozložník 2005, doi:10.1016/j.camwa.2005.08.009). A column of which nothing remains
//! beside the earlier ones is a term that the runs cannot tell from them; the number of the others is the rank.
//!
//! * variance of a coefficient: σ² c_jj, C = (XᵀX)⁻¹ = R⁻¹R⁻ᵀ
//! * variance inflation: c_jj Σ(x_j − x̄_j)², 1 when the term is orthogonal to all others (Marquardt 1970,
//!   doi:10.1080/00401706.1970.10488699)
//! * condition number: largest over smallest singular value of X with columns of length 1 (Belsley, Kuh & Welsch 1980,
//!   doi:10.1002/0471725153), by one-sided Jacobi rotations of R (Hestenes 1958, doi:10.1137/0106005)

use super::balance::{MOST_LEVELS, level_count, levels};
use super::{named, tidy};
use crate::table::{DesignTable, PointType};

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Constant and one slope a factor.
    Main,
    /// Constant and the levels of every factor as classes (analysis of variance of main effects).
    Levels,
    /// Slopes and products of two factors.
    Interactions,
    /// Slopes, squares and products of two factors.
    SecondOrder,
}

impl Kind {
    /// Its name in the report.
    pub fn words(self) -> &'static str {
        match self {
            Self::Main => "main effects",
            Self::Levels => "levels",
            Self::Interactions => "main effects and interactions",
            Self::SecondOrder => "second order",
        }
    }

    /// Whether the model means something for this table: classes need a table of levels; a product needs two factors;
    /// squares need a third value of some factor.
    pub fn applies(self, table: &DesignTable) -> bool {
        let counts = || (0..table.factors.len()).map(|j| level_count(table, j));
        let of_levels = |p: &PointType| matches!(p, PointType::Cube | PointType::Grid | PointType::Given);
        match self {
            Self::Main => true,
            Self::Levels => {
                table.point_type.iter().all(of_levels) && counts().all(|n| n <= MOST_LEVELS) && counts().any(|n| n > 2)
            }
            Self::Interactions => table.factors.len() > 1,
            Self::SecondOrder => counts().any(|n| n > 2),
        }
    }
}

/// What is left of a column counts as nothing below this part of its length.
const NOTHING: f64 = 1e-9;
/// More multiplications than this are not spent on one model.
const MOST_WORK: f64 = 4e9;

/// A model fitted to the rows of a table, without responses.
#[derive(Clone, Debug)]
pub struct Model {
    /// The kind.
    pub kind: Kind,
    /// Names of all terms: `const`, `Ec`, `Ec[20]`, `Ec^2`, `Ec*kn_ks`.
    pub terms: Vec<String>,
    /// The factor of each term of [`Kind::Levels`]; none for the constant and other kinds.
    pub factor: Vec<Option<usize>>,
    /// Indices of the terms that can be separated, in order.
    pub independent: Vec<usize>,
    runs: usize,
    judged: bool,
    /// Rows of R⁻¹ (upper triangular) over the independent terms.
    inverse: Vec<Vec<f64>>,
    /// Rows of R with columns scaled to length 1.
    scaled: Vec<Vec<f64>>,
    /// Σ(x − x̄)² of the independent terms.
    about_mean: Vec<f64>,
    /// The orthonormal columns.
    basis: Vec<Vec<f64>>,
}

/// What a table can do for a model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelReport {
    /// The kind.
    pub kind: Kind,
    /// Number of terms, the constant included.
    pub terms: usize,
    /// How many of them can be separated; none if the model was too large to judge.
    pub rank: Option<usize>,
    /// Runs less rank.
    pub residual_df: usize,
    /// Terms that are combinations of earlier ones.
    pub missing: Vec<String>,
    /// Largest variance inflation among the terms that can be separated, and the term.
    pub largest_inflation: Option<(String, f64)>,
    /// Condition number of the terms that can be separated.
    pub condition: f64,
}

/// Names and columns of a model's terms.
type Terms = (Vec<String>, Vec<Option<usize>>, Vec<Vec<f64>>);

fn terms(kind: Kind, table: &DesignTable) -> Terms {
    let k = table.factors.len();
    let name = |j: usize| table.factors[j].name.clone();
    let column = |f: &dyn Fn(&[f64]) -> f64| table.coded.iter().map(|r| f(r)).collect::<Vec<f64>>();
    let mut names = vec!["const".to_string()];
    let mut columns = vec![vec![1.0; table.runs()]];
    let mut factor = vec![None];
    let mut push = |text: String, of: Option<usize>, values: Vec<f64>| {
        names.push(text);
        factor.push(of);
        columns.push(values);
    };
    if kind == Kind::Levels {
        for j in 0..k {
            let (cells, values) = levels(table, j);
            for (level, value) in values.iter().enumerate().skip(1) {
                // against the first level
                let indicator = cells.iter().map(|&c| if c == level { 1.0 } else { 0.0 }).collect();
                push(format!("{}[{value}]", name(j)), Some(j), indicator);
            }
        }
        return (names, factor, columns);
    }
    for j in 0..k {
        push(name(j), None, column(&|r| r[j]));
    }
    if kind == Kind::SecondOrder {
        for j in 0..k {
            push(format!("{}^2", name(j)), None, column(&|r| r[j] * r[j]));
        }
    }
    if kind == Kind::Interactions || kind == Kind::SecondOrder {
        for (a, b) in (0..k).flat_map(|a| (a + 1..k).map(move |b| (a, b))) {
            push(format!("{}*{}", name(a), name(b)), None, column(&|r| r[a] * r[b]));
        }
    }
    (names, factor, columns)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Model {
    /// Fits the model to the rows.
    pub fn new(kind: Kind, table: &DesignTable) -> Self {
        let (terms, factor, columns) = terms(kind, table);
        let (runs, p) = (table.runs(), terms.len());
        let work = 4.0 * runs as f64 * p as f64 * p.min(runs) as f64;
        let judged = work <= MOST_WORK;
        let mut model = Self {
            kind,
            terms,
            factor,
            independent: vec![],
            runs,
            judged,
            inverse: vec![],
            scaled: vec![],
            about_mean: vec![],
            basis: vec![],
        };
        if judged {
            model.orthogonalise(&columns);
        }
        model
    }

    fn orthogonalise(&mut self, columns: &[Vec<f64>]) {
        let mut triangle: Vec<Vec<f64>> = Vec::new();
        for (j, column) in columns.iter().enumerate() {
            let length = dot(column, column).sqrt();
            let (left, mut share) = self.remainder(column);
            let rest = dot(&left, &left).sqrt();
            if rest <= NOTHING * length {
                continue;
            }
            let mean = column.iter().sum::<f64>() / self.runs as f64;
            self.about_mean.push(column.iter().map(|x| (x - mean) * (x - mean)).sum());
            share.push(rest);
            self.scaled.push(share.iter().map(|x| x / length).collect());
            triangle.push(share);
            self.basis.push(left.iter().map(|x| x / rest).collect());
            self.independent.push(j);
        }
        self.inverse = invert(&triangle);
    }

    /// What is left of a column beside the basis, and its components along it.
    fn remainder(&self, column: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut left = column.to_vec();
        let mut share = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            for (q, s) in self.basis.iter().zip(&mut share) {
                let r = dot(q, &left);
                *s += r;
                left.iter_mut().zip(q).for_each(|(x, q)| *x -= r * q);
            }
        }
        (left, share)
    }

    /// Coefficients of the least-squares fit of a column by the independent terms.
    pub(super) fn fit(&self, column: &[f64]) -> Vec<f64> {
        let share: Vec<f64> = self.basis.iter().map(|q| dot(q, column)).collect();
        self.inverse.iter().map(|row| dot(row, &share)).collect()
    }

    /// c_ij of C = (XᵀX)⁻¹ over the independent terms.
    pub(super) fn covariance(&self, i: usize, j: usize) -> f64 {
        dot(&self.inverse[i], &self.inverse[j])
    }

    /// What the table can do for the model.
    pub fn report(&self) -> ModelReport {
        let mut largest: Option<(String, f64)> = None;
        for (i, &term) in self.independent.iter().enumerate().skip(1) {
            let inflation = tidy(self.covariance(i, i) * self.about_mean[i]);
            if largest.as_ref().is_none_or(|(_, most)| inflation > *most) {
                largest = Some((self.terms[term].clone(), inflation));
            }
        }
        let missing = (0..self.terms.len()).filter(|t| self.judged && !self.independent.contains(t));
        ModelReport {
            kind: self.kind,
            terms: self.terms.len(),
            rank: self.judged.then_some(self.independent.len()),
            residual_df: if self.judged { self.runs - self.independent.len() } else { 0 },
            missing: missing.map(|t| self.terms[t].clone()).collect(),
            largest_inflation: largest,
            condition: tidy(condition(&self.scaled)),
        }
    }
}

impl ModelReport {
    /// Whether all its terms can be separated.
    pub fn estimable(&self) -> bool {
        self.rank == Some(self.terms)
    }

    pub(super) fn lines(&self, line: &mut impl FnMut(&'static str, &str, &str, f64, String)) {
        let words = self.kind.words();
        line("model", words, "terms", self.terms as f64, String::new());
        let Some(rank) = self.rank else {
            line("model", words, "rank", f64::NAN, "too large to judge".into());
            return;
        };
        let verdict = match self.estimable() {
            true => "can be estimated".to_string(),
            false => format!("cannot be told from earlier terms: {}", named(&self.missing)),
        };
        line("model", words, "rank", rank as f64, verdict);
        line("model", words, "residual df", self.residual_df as f64, String::new());
        if !self.estimable() {
            return;
        }
        if let Some((term, inflation)) = &self.largest_inflation {
            line("model", words, "largest variance inflation", *inflation, term.clone());
        }
        line("model", words, "condition number", self.condition, String::new());
    }
}

/// Inverse of the upper triangular matrix whose j-th column (rows 0 … j) is `triangle[j]`; its rows in full length.
fn invert(triangle: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let p = triangle.len();
    let mut inverse = vec![vec![0.0; p]; p];
    for j in 0..p {
        inverse[j][j] = 1.0 / triangle[j][j];
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|m| triangle[m][i] * inverse[m][j]).sum();
            inverse[i][j] = -sum / triangle[i][i];
        }
    }
    inverse
}

/// Ratio of the extreme singular values of the triangular matrix given by its columns.
fn condition(columns: &[Vec<f64>]) -> f64 {
    let p = columns.len();
    let mut c: Vec<Vec<f64>> = columns.iter().map(|col| [col.as_slice(), &vec![0.0; p - col.len()]].concat()).collect();
    for _ in 0..40 {
        let mut turned = false;
        for b in 1..p {
            let (before, from_b) = c.split_at_mut(b);
            for column in before {
                turned |= rotate(column, &mut from_b[0]);
            }
        }
        if !turned {
            break;
        }
    }
    let lengths = c.iter().map(|col| dot(col, col).sqrt());
    let (most, least) = lengths.fold((0.0, f64::INFINITY), |(m, l): (f64, f64), x| (m.max(x), l.min(x)));
    if p == 0 { f64::NAN } else { most / least }
}

/// Turns two columns until they are orthogonal; returns whether they were not.
fn rotate(a: &mut [f64], b: &mut [f64]) -> bool {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    if ab.abs() <= 1e-13 * (aa * bb).sqrt() {
        return false;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let cos = 1.0 / (1.0 + t * t).sqrt();
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (cos * *x - cos * t * *y, cos * t * *x + cos * *y);
    }
    true
}
