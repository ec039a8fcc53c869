//! Differential evolution with F and CR adapted per individual.
//!
//! A mutant is made from members of the population, crossed with its parent gene by gene with probability CR (one
//! gene always crosses), and replaces the parent when it is not worse.
//! * `rand1`: v = x_r1 + F (x_r2 − x_r3); each individual carries F and CR, redrawn with probability 0.1 as
//!   F ∈ U(0.1, 1), CR ∈ U(0, 1), and stored when the trial wins (jDE, Brest et al. 2006).
//! * `current-to-best`: v = x + F (x_p − x) + F (x_r1 − x_r2), x_p among the best p, x_r2 also from an archive of
//!   replaced parents; F from a Cauchy, CR from a normal distribution around a memory of what has won, weighted by
//!   the gain (SHADE, Tanabe & Fukunaga 2013; JADE, Zhang & Sanderson 2009).
//!
//! A gene that leaves the box is set halfway between its parent and the bound; linear constraints by projection.
//!
//! The first population is random over the box, or, around a first guess, the guess itself and points off it by up to
//! `spread` ranges in every parameter. A failed run has an infinite misfit and is replaced by any that did not fail.
//!
//! The preset `rcc2020` is the adaptive differential evolution by which the contact parameters of a
//! roller-compacted-concrete dam were found from a stress–strain curve (Math. Probl. Eng. 2020, 6686609,
//! doi:10.1155/2020/6686609, sections 3.2 and 4.4): 24 individuals around an initial set, DE/rand/1, F = 0.9 and
//! CR = 0.1 at the start and self-adapted (Brest et al. 2006 with τ₁ = τ₂ = 0.1, F_l = 0.1, F_u = 0.9), 30
//! generations. Its objective, the sum of the errors at the points of the curve (eq. 14), is the misfit `sum`; the
//! fitness that it maximises (eq. 15) falls as the objective rises, so both rank alike.
//!
//! Sources: Storn & Price 1997, doi:10.1023/A:1008202821328; Brest et al. 2006, doi:10.1109/TEVC.2006.872133;
//! Zhang & Sanderson 2009, doi:10.1109/TEVC.2009.2014613; Tanabe & Fukunaga 2013, doi:10.1109/CEC.2013.6557555.

use super::constraint::Domain;
use super::{Optimiser, Stop, Trial};
use math::elementary::tan;
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Published sets of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Success-history adaptation, a population of five per factor.
    #[default]
    Shade,
    /// jDE with its authors' population of 100, F = 0.5 and CR = 0.9 at the start.
    Jde,
    /// The roller-compacted-concrete dam: jDE, 24 individuals, 30 generations.
    Rcc2020,
}

/// How mutants are made and F, CR adapted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// DE/rand/1 with self-adaptive F and CR.
    Rand1,
    /// DE/current-to-pbest/1 with archive and success history.
    CurrentToBest,
}

/// Settings; a setting that is left out has the value of the preset.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Where settings that are left out come from.
    pub preset: Preset,
    /// Mutation and adaptation.
    pub strategy: Option<Strategy>,
    /// Individuals.
    pub population: Option<usize>,
    /// Most generations after the first population.
    pub generations: Option<usize>,
    /// F at the start.
    pub initial_f: Option<f64>,
    /// CR at the start.
    pub initial_cr: Option<f64>,
    /// How far the first population lies around a first guess, in ranges; a quarter when left out.
    pub spread: Option<f64>,
}

impl Settings {
    /// The adaptive differential evolution of the roller-compacted-concrete dam.
    pub fn rcc2020() -> Self {
        Self { preset: Preset::Rcc2020, ..Self::default() }
    }

    fn plan(&self, factors: usize) -> Plan {
        let (strategy, population, generations, f, cr) = match self.preset {
            Preset::Shade => (Strategy::CurrentToBest, (5 * factors).max(30), 1000 * factors, 0.5, 0.5),
            Preset::Jde => (Strategy::Rand1, 100, 1000 * factors, 0.5, 0.9),
            Preset::Rcc2020 => (Strategy::Rand1, 24, 30, 0.9, 0.1),
        };
        Plan {
            strategy: self.strategy.unwrap_or(strategy),
            population: self.population.unwrap_or(population).max(5),
            generations: self.generations.unwrap_or(generations),
            f: self.initial_f.unwrap_or(f),
            cr: self.initial_cr.unwrap_or(cr),
            spread: self.spread.unwrap_or(0.25),
        }
    }
}

struct Plan {
    strategy: Strategy,
    population: usize,
    generations: usize,
    f: f64,
    cr: f64,
    spread: f64,
}

#[derive(Clone)]
struct Individual {
    point: Vec<f64>,
    misfit: f64,
    f: f64,
    cr: f64,
}

/// Slots of the success history.
const MEMORY: usize = 6;
/// Part of the population that counts as best in `current-to-best`.
const BEST: f64 = 0.11;
/// Largest spread of the population, in the unit box and of the misfit, that counts as collapsed.
const COLLAPSED: f64 = 1e-13;

/// The algorithm's state.
pub struct Differential {
    plan: Plan,
    start: Option<Vec<f64>>,
    domain: Domain,
    random: Stream,
    generation: usize,
    population: Vec<Individual>,
    /// F and CR of each proposed trial.
    asked: Vec<(f64, f64)>,
    archive: Vec<Vec<f64>>,
    memory: Vec<(f64, f64)>,
    slot: usize,
}

impl Differential {
    /// A fresh search.
    pub fn new(settings: &Settings, domain: &Domain, seed: u64, start: Option<&[f64]>) -> Self {
        let plan = settings.plan(domain.len());
        Self {
            memory: vec![(plan.f, plan.cr); MEMORY],
            plan,
            start: start.map(<[f64]>::to_vec),
            domain: domain.clone(),
            random: Stream::new(seed, "differential", 0),
            generation: 0,
            population: Vec::new(),
            asked: Vec::new(),
            archive: Vec::new(),
            slot: 0,
        }
    }

    /// The first population.
    fn first(&mut self) -> Vec<Vec<f64>> {
        let (size, spread, random) = (self.plan.population, self.plan.spread, &mut self.random);
        let Some(start) = &self.start else { return (0..size).map(|_| self.domain.sample(random)).collect() };
        let mut around = || {
            // Redrawn within the box, so that a guess near an end does not gather individuals there.
            let mut near = |u: f64| random.uniform_in((u - spread).max(0.0), (u + spread).min(1.0));
            start.iter().map(|&u| near(u)).collect::<Vec<_>>()
        };
        let others: Vec<Vec<f64>> = (1..size).map(|_| around()).collect();
        std::iter::once(start.clone()).chain(others).map(|point| self.domain.repair(&point)).collect()
    }

    /// F and CR for the trial of individual `i`.
    fn controls(&mut self, i: usize) -> (f64, f64) {
        let random = &mut self.random;
        match self.plan.strategy {
            Strategy::Rand1 => {
                let f = if random.uniform() < 0.1 { random.uniform_in(0.1, 1.0) } else { self.population[i].f };
                let cr = if random.uniform() < 0.1 { random.uniform() } else { self.population[i].cr };
                (f, cr)
            }
            Strategy::CurrentToBest => {
                let (location, mean) = self.memory[random.below(MEMORY)];
                let mut f = 0.0;
                while f <= 0.0 {
                    f = location + 0.1 * tan(std::f64::consts::PI * (random.uniform() - 0.5));
                }
                (f.min(1.0), (mean + 0.1 * random.normal()).clamp(0.0, 1.0))
            }
        }
    }

    /// An index below `n` that is none of `used`.
    fn other(&mut self, n: usize, used: &[usize]) -> usize {
        loop {
            let i = self.random.below(n);
            if !used.contains(&i) {
                return i;
            }
        }
    }

    fn mutant(&mut self, i: usize, f: f64) -> Vec<f64> {
        let n = self.population.len();
        match self.plan.strategy {
            Strategy::Rand1 => {
                let a = self.other(n, &[i]);
                let b = self.other(n, &[i, a]);
                let c = self.other(n, &[i, a, b]);
                let of = |k: usize| &self.population[k].point;
                let step = of(b).iter().zip(of(c)).map(|(b, c)| f * (b - c));
                of(a).iter().zip(step).map(|(a, s)| a + s).collect()
            }
            Strategy::CurrentToBest => {
                let best = self.random.below(((BEST * n as f64) as usize).max(2));
                let a = self.other(n, &[i]);
                let b = self.other(n + self.archive.len(), &[i, a]);
                let of = |k: usize| if k < n { &self.population[k].point } else { &self.archive[k - n] };
                (0..self.domain.len())
                    .map(|j| of(i)[j] + f * (of(best)[j] - of(i)[j]) + f * (of(a)[j] - of(b)[j]))
                    .collect()
            }
        }
    }

    fn trial(&mut self, i: usize) -> Vec<f64> {
        let (f, cr) = self.controls(i);
        self.asked.push((f, cr));
        let mutant = self.mutant(i, f);
        let sure = self.random.below(mutant.len());
        let parent = &self.population[i].point;
        let mut child = parent.clone();
        for (j, value) in mutant.into_iter().enumerate() {
            if j == sure || self.random.uniform() < cr {
                child[j] = if value < 0.0 {
                    0.5 * parent[j]
                } else if value > 1.0 {
                    0.5 * (parent[j] + 1.0)
                } else {
                    value
                };
            }
        }
        self.domain.repair(&child)
    }

    /// Moves the success history: the weighted Lehmer mean of the winning F and CR.
    fn remember(&mut self, won: &[(f64, f64, f64)]) {
        let total: f64 = won.iter().map(|w| w.2).sum();
        if total <= 0.0 || !total.is_finite() {
            return;
        }
        let lehmer = |of: fn(&(f64, f64, f64)) -> f64| {
            let (square, plain) = won.iter().fold((0.0, 0.0), |s, w| (s.0 + w.2 * of(w) * of(w), s.1 + w.2 * of(w)));
            if plain > 0.0 { square / plain } else { 0.0 }
        };
        self.memory[self.slot] = (lehmer(|w| w.0), lehmer(|w| w.1));
        self.slot = (self.slot + 1) % MEMORY;
    }

    fn replace(&mut self, trials: &[Trial]) {
        let mut won = Vec::new();
        for (i, (trial, (f, cr))) in trials.iter().zip(std::mem::take(&mut self.asked)).enumerate() {
            let parent = &mut self.population[i];
            if trial.misfit > parent.misfit {
                continue;
            }
            if trial.misfit < parent.misfit {
                won.push((f, cr, parent.misfit - trial.misfit));
                if self.archive.len() < trials.len() {
                    self.archive.push(parent.point.clone());
                } else {
                    let index = self.random.below(self.archive.len());
                    self.archive[index].clone_from(&parent.point);
                }
            }
            *parent = Individual { point: trial.point.clone(), misfit: trial.misfit, f, cr };
        }
        self.remember(&won);
    }
}

impl Optimiser for Differential {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        if self.population.is_empty() {
            return self.first();
        }
        // The best stand first, for `current-to-best`.
        self.population.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        (0..self.population.len()).map(|i| self.trial(i)).collect()
    }

    fn tell(&mut self, trials: &[Trial]) {
        if self.population.is_empty() {
            let (f, cr) = (self.plan.f, self.plan.cr);
            let fresh = |t: &Trial| Individual { point: t.point.clone(), misfit: t.misfit, f, cr };
            self.population = trials.iter().map(fresh).collect();
        } else {
            self.generation += 1;
            self.replace(trials);
        }
    }

    fn stop(&self) -> Option<Stop> {
        if self.generation >= self.plan.generations {
            return Some(Stop::Iterations);
        }
        let first = self.population.first()?;
        let near = |p: &Individual| {
            (p.misfit - first.misfit).abs() <= COLLAPSED * (1.0 + first.misfit.abs())
                && p.point.iter().zip(&first.point).all(|(a, b)| (a - b).abs() <= COLLAPSED)
        };
        self.population.iter().all(near).then_some(Stop::Collapsed)
    }
}
