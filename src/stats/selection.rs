//! Choice of terms by significance, with hierarchy.
//!
//! Backward: the term with the largest p above the level is removed, as long as no remaining term contains it; the rest
//! is fitted again; until none can go. Forward: from the constant, the term with the smallest p below the level is
//! added among those whose divisors are all in; until none comes. The constant always stays.
//!
//! Stepwise p-values are optimistic (the same data choose and judge); the steps are reported so that a reader sees it.
//! Source: Draper and Smith 1998, chapter 15; Peixoto 1987, doi:10.2307/2684752 (hierarchy).

use super::error::Fault;
use super::fit::Solution;
use super::number::Real;
use super::terms::Term;
use serde::{Deserialize, Serialize};

/// From which end terms are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// From the full model down.
    Backward,
    /// From the constant up.
    Forward,
}

/// How terms are chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Down or up.
    pub direction: Direction,
    /// A term stays (or comes) when its p is at most this.
    pub alpha: f64,
}

impl Selection {
    pub(crate) fn check(&self) -> Option<Fault> {
        let fine = self.alpha > 0.0 && self.alpha < 1.0;
        (!fine).then_some(Fault::Probability { what: "selection level", value: self.alpha })
    }
}

/// One step of a selection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The term that came or went.
    pub term: String,
    /// Whether it was added.
    pub added: bool,
    /// Its p in the model that held it.
    pub p: f64,
}

/// The chosen columns in the order of the model, and the steps that led there.
pub(crate) fn select<T: Real>(
    solution: &Solution<T>,
    terms: &[Term],
    selection: &Selection,
) -> (Vec<usize>, Vec<Step>) {
    match selection.direction {
        Direction::Backward => backward(solution, terms, selection.alpha),
        Direction::Forward => forward(solution, terms, selection.alpha),
    }
}

fn backward<T: Real>(full: &Solution<T>, terms: &[Term], alpha: f64) -> (Vec<usize>, Vec<Step>) {
    let mut selected: Vec<usize> = (0..terms.len()).collect();
    let mut steps = Vec::new();
    loop {
        let now = full.with_terms(&selected);
        let needed = |i: usize| selected.iter().any(|&k| k != i && terms[k].contains(&terms[i]));
        let removable = selected.iter().enumerate().filter(|&(_, &i)| terms[i].degree() > 0 && !needed(i));
        let weak = removable.filter_map(|(at, _)| Some((at, now.p_for_choice(at)?))).filter(|&(_, p)| p > alpha);
        let Some((at, p)) = weak.reduce(|a, b| if b.1 > a.1 { b } else { a }) else { return (selected, steps) };
        if selected.len() == 1 {
            return (selected, steps);
        }
        steps.push(Step { term: terms[selected.remove(at)].to_string(), added: false, p });
    }
}

fn forward<T: Real>(full: &Solution<T>, terms: &[Term], alpha: f64) -> (Vec<usize>, Vec<Step>) {
    let mut selected: Vec<usize> = (0..terms.len()).filter(|&i| terms[i].degree() == 0).collect();
    let mut steps = Vec::new();
    loop {
        let supported = |i: usize| {
            let parents = terms[i].parents();
            let known =
                |parent: &Term| terms.iter().position(|t| t.same(parent)).is_none_or(|at| selected.contains(&at));
            parents.iter().all(known)
        };
        let candidates = (0..terms.len()).filter(|i| !selected.contains(i) && supported(*i));
        let strong = candidates.filter_map(|i| {
            let mut trial = selected.clone();
            trial.push(i);
            Some((i, full.with_terms(&trial).p_for_choice(selected.len())?))
        });
        let best = strong.filter(|&(_, p)| p <= alpha).reduce(|a, b| if b.1 < a.1 { b } else { a });
        let Some((i, p)) = best else { break };
        steps.push(Step { term: terms[i].to_string(), added: true, p });
        selected.push(i);
    }
    selected.sort_unstable();
    if selected.is_empty() {
        selected.push(0);
    }
    (selected, steps)
}
