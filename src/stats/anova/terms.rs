//! Which terms an analysis of variance has, and which columns belong to each.

use super::{Column, Interactions, Matrix, Part, Sample, Settings, Usable};
use crate::sample::Factor;
use crate::triangle::Triangle;
use std::ops::Range;

/// The terms of a model and their columns; column 0 is the constant.
pub(super) struct Layout {
    /// Factors of each term.
    pub terms: Vec<Vec<usize>>,
    /// Known levels of each factor of the sample.
    pub levels: Vec<Vec<f64>>,
    /// Columns, the constant first.
    pub columns: Vec<Column>,
    /// First column of each term, and the end.
    starts: Vec<usize>,
    names: Vec<String>,
}

impl Layout {
    fn new(names: &[String], terms: Vec<Vec<usize>>, levels: Vec<Vec<f64>>) -> Self {
        let mut columns: Vec<Column> = vec![Vec::new()];
        let mut starts = vec![1];
        for term in &terms {
            let mut products: Vec<Column> = vec![Vec::new()];
            for &factor in term {
                let contrast = |level| Part::Contrast { factor, level };
                let grow = |done: &Column| {
                    let longer = |level| done.iter().cloned().chain([contrast(level)]).collect::<Column>();
                    (0..levels[factor].len() - 1).map(longer).collect::<Vec<_>>()
                };
                products = products.iter().flat_map(grow).collect();
            }
            columns.extend(products);
            starts.push(columns.len());
        }
        Self { terms, levels, columns, starts, names: names.to_vec() }
    }

    /// The columns of a term.
    pub(super) fn range(&self, term: usize) -> Range<usize> {
        self.starts[term]..self.starts[term + 1]
    }

    /// Degrees of freedom of a term.
    pub(super) fn df(&self, term: usize) -> usize {
        self.range(term).len()
    }

    /// `a` or `a*b`.
    pub(super) fn label(&self, term: usize) -> String {
        self.terms[term].iter().map(|&f| self.names[f].as_str()).collect::<Vec<_>>().join("*")
    }

    /// The label of the term that a column belongs to.
    pub(super) fn name_of(&self, column: usize) -> String {
        match (0..self.terms.len()).find(|&term| self.range(term).contains(&column)) {
            Some(term) => self.label(term),
            None => "const".into(),
        }
    }

    /// Whether term `large` contains every factor of term `small`.
    pub(super) fn contains(&self, large: usize, small: usize) -> bool {
        self.terms[small].iter().all(|f| self.terms[large].contains(f))
    }

    /// Every factor of the model.
    pub(super) fn factors(&self) -> Vec<usize> {
        (0..self.names.len()).filter(|f| self.terms.iter().any(|term| term.contains(f))).collect()
    }

    /// The same model without the named terms.
    pub(super) fn without(&self, labels: &[String]) -> Self {
        let remaining = (0..self.terms.len()).filter(|&term| !labels.contains(&self.label(term)));
        Self::new(&self.names, remaining.map(|term| self.terms[term].clone()).collect(), self.levels.clone())
    }
}

/// Main effects and interactions as the settings ask, and the interactions that cannot be estimated.
pub(super) fn chosen_terms(sample: &Sample, usable: &Usable, settings: &Settings) -> (Layout, Vec<String>) {
    let names: Vec<String> = sample.factors.iter().map(|f| f.name.clone()).collect();
    let levels: Vec<Vec<f64>> = sample.factors.iter().map(Factor::all_levels).collect();
    let mains: Vec<usize> = (0..names.len()).filter(|&f| !settings.as_error.contains(&names[f])).collect();
    let mut terms: Vec<Vec<usize>> = mains.iter().map(|&f| vec![f]).collect();
    match &settings.interactions {
        Interactions::None => {}
        Interactions::Named(pairs) => {
            let index = |name: &String| names.iter().position(|n| n == name);
            terms.extend(pairs.iter().filter_map(|(a, b)| Some(vec![index(a)?, index(b)?])));
        }
        Interactions::Estimable => return estimable(sample, usable, &names, terms, levels),
    }
    (Layout::new(&names, terms, levels), Vec::new())
}

/// Adds the pairs of factors one by one as long as their columns are new and a degree of freedom is left.
fn estimable(
    sample: &Sample,
    usable: &Usable,
    names: &[String],
    mut terms: Vec<Vec<usize>>,
    levels: Vec<Vec<f64>>,
) -> (Layout, Vec<String>) {
    let mains: Vec<usize> = terms.iter().map(|term| term[0]).collect();
    let mut refused = Vec::new();
    let mut width = 1 + mains.iter().map(|&f| levels[f].len() - 1).sum::<usize>();
    for (i, &a) in mains.iter().enumerate() {
        for &b in &mains[i + 1..] {
            let added = (levels[a].len() - 1) * (levels[b].len() - 1);
            terms.push(vec![a, b]);
            let fits = width + added < usable.rows.len() && {
                let trial = Layout::new(names, terms.clone(), levels.clone());
                let matrix = Matrix::new(sample, usable, trial.columns.clone(), &levels);
                Triangle::<f64>::of(&matrix).is_independent(trial.columns.len())
            };
            if fits {
                width += added;
            } else {
                terms.pop();
                refused.push(format!("{}*{}", names[a], names[b]));
            }
        }
    }
    (Layout::new(names, terms, levels), refused)
}
