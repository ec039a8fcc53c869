//! Which column each factor gets.

use super::array::{Array, entanglement};
use super::shape::{Counts, count};
use crate::coding::Factor;
use crate::error::Fault;

/// Whether columns of these levels can hold the factors, with levels merged where a column has more than its factor.
pub(super) fn holds(columns: &Counts, factors: &[Factor]) -> bool {
    classes(columns, factors).is_some()
}

/// The number of levels of each factor's column: its own number if such a column is left, else the next larger.
fn classes(columns: &Counts, factors: &[Factor]) -> Option<Vec<usize>> {
    let mut left = columns.clone();
    let mut class = vec![0; factors.len()];
    let mut take = |levels: usize, class: &mut usize| {
        if let Some(n) = left.get_mut(&levels).filter(|n| **n > 0) {
            *n -= 1;
            *class = levels;
        }
    };
    for (f, class) in factors.iter().zip(&mut class) {
        take(f.level_count(), class);
    }
    let larger: Vec<usize> = columns.keys().copied().collect();
    // the factors that need most levels choose first among the larger columns
    let mut rest: Vec<usize> = (0..factors.len()).filter(|&i| class[i] == 0).collect();
    rest.sort_by_key(|&i| std::cmp::Reverse(factors[i].level_count()));
    for i in rest {
        for &levels in larger.iter().filter(|&&n| n > factors[i].level_count()) {
            if class[i] == 0 {
                take(levels, &mut class[i]);
            }
        }
    }
    class.iter().all(|&c| c > 0).then_some(class)
}

/// Index of the column of each factor: the stated ones (from 1), or those with the least aliasing.
pub(super) fn columns(array: &Array, factors: &[Factor], said: Option<&[usize]>) -> Result<Vec<usize>, Vec<Fault>> {
    if let Some(said) = said {
        let faults = faults(array, factors, said);
        return if faults.is_empty() { Ok(said.iter().map(|c| c - 1).collect()) } else { Err(faults) };
    }
    let levels: Vec<usize> = array.columns.iter().map(|c| c.levels).collect();
    let classes =
        classes(&count(&levels), factors).unwrap_or_else(|| panic!("BUG: the table does not hold the factors"));
    let mut penalty = vec![0.0_f64; levels.len()];
    let mut chosen: Vec<usize> = Vec::new();
    for (i, &class) in classes.iter().enumerate() {
        let free = (0..levels.len()).filter(|c| levels[*c] == class && !chosen.contains(c));
        // columns that tie up to rounding are taken in the order of the table
        let best = free.reduce(|best, c| if penalty[c] < penalty[best] - 1e-9 { c } else { best });
        let new = best.unwrap_or_else(|| panic!("BUG: no column left"));
        if i + 1 < classes.len() && levels.len() > classes.len() {
            for (c, penalty) in penalty.iter_mut().enumerate().filter(|(c, _)| *c != new && !chosen.contains(c)) {
                let with = |p: &usize| entanglement(&array.columns[c], &array.columns[*p], &array.columns[new]);
                *penalty += chosen.iter().map(with).sum::<f64>();
            }
        }
        chosen.push(new);
    }
    Ok(chosen)
}

fn faults(array: &Array, factors: &[Factor], said: &[usize]) -> Vec<Fault> {
    let fault = |found: String, wanted: String| Fault::BadOption { option: "columns".into(), found, wanted };
    if said.len() != factors.len() {
        let found = format!("a list of {}", said.len());
        return vec![fault(found, format!("give one column for each of the {} factors", factors.len()))];
    }
    let mut faults = Vec::new();
    for (i, (&c, f)) in said.iter().zip(factors).enumerate() {
        match c.checked_sub(1).and_then(|c| array.columns.get(c)) {
            None => faults.push(fault(
                format!("{c} for `{}`", f.name),
                format!("the table has the columns 1 to {}", array.columns.len()),
            )),
            Some(_) if said[..i].contains(&c) => {
                faults.push(fault(format!("{c} twice"), format!("give `{}` a column of its own", f.name)));
            }
            Some(column) if column.levels < f.level_count() => faults.push(fault(
                format!("{c} for `{}`", f.name),
                format!("that column has {} levels and the factor {}", column.levels, f.level_count()),
            )),
            Some(_) => {}
        }
    }
    faults
}
