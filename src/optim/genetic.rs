//! Genetic algorithm with the operators and defaults of MATLAB's `ga` for a bounded problem in real numbers.
//!
//! A generation keeps its elite, and fills up with crossover children and mutation children:
//! * *scaling*: the individual of rank r gets the expectation r^(−1/2), scaled to the number of parents needed;
//! * *selection*, stochastic uniform: one walk with equal steps over a line on which each individual has a stretch
//!   as long as its expectation; the parents are then shuffled;
//! * *crossover*: scattered, each gene from either parent by a fair coin; with linear constraints intermediate,
//!   child = a + ρ (b − a), which cannot leave a convex region;
//! * *mutation*, adaptive feasible: a random direction of a random orthonormal basis, with a step that is quadrupled
//!   after a generation that improved the best and quartered after one that did not, halved until it is allowed;
//!   or Gaussian with σ = scale (1 − shrink · generation / generations) of the range, brought back into the box;
//! * *stop*: the number of generations, or an average relative change of the best over the stall window within the
//!   tolerance.
//!
//! Sources: MathWorks, Global Optimization Toolbox User's Guide, chapter "Genetic Algorithm Options" (operators and
//! defaults); Baker, Proc. 2nd Int. Conf. on Genetic Algorithms (1987) 14 (the selection); Su et al. 2021,
//! doi:10.3390/ma14071627, section 6.2 (population 300, all else default). How the toolbox draws the directions of its
//! adaptive mutation is not documented in detail; the reading above is ours.

use super::constraint::Domain;
use super::{Optimiser, Stop, Trial};
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Published sets of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The toolbox's defaults: population 50 up to five factors and 200 above.
    #[default]
    Matlab,
    /// Su et al. 2021: population 300.
    Su2021,
}

/// Which mutation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mutation {
    /// Steps along random directions, adapted to success: the default for bounded problems.
    #[default]
    Adaptive,
    /// Normal steps that shrink with the generations.
    Gaussian,
}

/// Settings; a setting that is left out has the value of the preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Where settings that are left out come from.
    pub preset: Preset,
    /// Individuals in a generation.
    pub population: Option<usize>,
    /// Most generations; 100 per factor when left out.
    pub generations: Option<usize>,
    /// Generations over which the improvement is averaged for the stall rule.
    pub stall_generations: usize,
    /// Average relative change of the best over the stall window that ends the search.
    pub tolerance: f64,
    /// Part of the population that survives unchanged, rounded up.
    pub elite: f64,
    /// Part of the other children that come from crossover.
    pub crossover: f64,
    /// Which mutation.
    pub mutation: Mutation,
    /// Gaussian mutation: standard deviation at the start, in ranges.
    pub scale: f64,
    /// Gaussian mutation: part of the scale lost by the last generation.
    pub shrink: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            preset: Preset::Matlab,
            population: None,
            generations: None,
            stall_generations: 50,
            tolerance: 1e-6,
            elite: 0.05,
            crossover: 0.8,
            mutation: Mutation::Adaptive,
            scale: 1.0,
            shrink: 1.0,
        }
    }
}

impl Settings {
    /// Su et al. 2021.
    pub fn su2021() -> Self {
        Self { preset: Preset::Su2021, ..Self::default() }
    }

    /// Individuals in a generation for a number of factors.
    pub fn population(&self, factors: usize) -> usize {
        let preset = match self.preset {
            Preset::Matlab if factors <= 5 => 50,
            Preset::Matlab => 200,
            Preset::Su2021 => 300,
        };
        self.population.unwrap_or(preset).max(4)
    }
}

/// The algorithm's state.
pub struct Genetic {
    settings: Settings,
    domain: Domain,
    random: Stream,
    size: usize,
    generations: usize,
    generation: usize,
    /// Sorted by misfit after each generation.
    population: Vec<(Vec<f64>, f64)>,
    /// Best misfit of each generation.
    best: Vec<f64>,
    step: f64,
    /// A first guess, which takes part in the first generation.
    start: Option<Vec<f64>>,
}

impl Genetic {
    /// A fresh search.
    pub fn new(settings: &Settings, domain: &Domain, seed: u64, start: Option<&[f64]>) -> Self {
        Self {
            start: start.map(<[f64]>::to_vec),
            size: settings.population(domain.len()),
            generations: settings.generations.unwrap_or(100 * domain.len()),
            settings: settings.clone(),
            domain: domain.clone(),
            random: Stream::new(seed, "genetic", 0),
            generation: 0,
            population: Vec::new(),
            best: Vec::new(),
            step: 1.0,
        }
    }

    fn elite(&self) -> usize {
        ((self.settings.elite * self.size as f64).ceil() as usize).min(self.size - 1)
    }

    /// Stochastic uniform selection of `count` parents by rank, in random order.
    fn parents(&mut self, count: usize) -> Vec<usize> {
        let expectation = |rank: usize| 1.0 / ((rank + 1) as f64).sqrt();
        let total: f64 = (0..self.size).map(expectation).sum();
        let step = total / count as f64;
        let mut mark = step * self.random.uniform();
        let (mut rank, mut end) = (0, expectation(0));
        let mut chosen = Vec::with_capacity(count);
        for _ in 0..count {
            while mark >= end && rank + 1 < self.size {
                rank += 1;
                end += expectation(rank);
            }
            chosen.push(rank);
            mark += step;
        }
        self.random.shuffle(&mut chosen);
        chosen
    }

    fn cross(&mut self, a: usize, b: usize) -> Vec<f64> {
        let pairs: Vec<(f64, f64)> =
            self.population[a].0.iter().copied().zip(self.population[b].0.iter().copied()).collect();
        if self.domain.is_box() {
            pairs.into_iter().map(|(a, b)| if self.random.uniform() < 0.5 { a } else { b }).collect()
        } else {
            let child: Vec<f64> = pairs.into_iter().map(|(a, b)| a + self.random.uniform() * (b - a)).collect();
            self.domain.repair(&child)
        }
    }

    fn mutate(&mut self, parent: usize) -> Vec<f64> {
        let parent = self.population[parent].0.clone();
        match self.settings.mutation {
            Mutation::Gaussian => {
                let progress = self.generation as f64 / self.generations as f64;
                let deviation = (self.settings.scale * (1.0 - self.settings.shrink * progress)).max(0.0);
                let child: Vec<f64> = parent.iter().map(|x| x + deviation * self.random.normal()).collect();
                self.domain.repair(&child)
            }
            Mutation::Adaptive => self.step_along_a_basis(&parent),
        }
    }

    /// The first allowed step of the adaptive length along a random basis, halved where nothing is allowed.
    fn step_along_a_basis(&mut self, parent: &[f64]) -> Vec<f64> {
        let basis = random_basis(parent.len(), &mut self.random);
        let mut length = self.step;
        for _ in 0..30 {
            for direction in &basis {
                let sign = if self.random.uniform() < 0.5 { 1.0 } else { -1.0 };
                for sign in [sign, -sign] {
                    let child: Vec<f64> = parent.iter().zip(direction).map(|(x, d)| x + sign * length * d).collect();
                    if self.domain.contains(&child) {
                        return self.domain.repair(&child);
                    }
                }
            }
            length *= 0.5;
        }
        parent.to_vec()
    }
}

/// A random orthonormal basis: Gram–Schmidt on normal vectors.
fn random_basis(n: usize, random: &mut Stream) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(n);
    while basis.len() < n {
        let mut v: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        for b in &basis {
            let along: f64 = v.iter().zip(b).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(b).for_each(|(v, b)| *v -= along * b);
        }
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length > 1e-8 {
            v.iter_mut().for_each(|v| *v /= length);
            basis.push(v);
        }
    }
    basis
}

impl Optimiser for Genetic {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        if self.population.is_empty() {
            let (guess, random) = (self.start.clone(), &mut self.random);
            let others = self.size - guess.iter().len();
            return guess.into_iter().chain((0..others).map(|_| self.domain.sample(random))).collect();
        }
        let others = self.size - self.elite();
        let crossed = (self.settings.crossover * others as f64).round() as usize;
        let mutated = others - crossed;
        let parents = self.parents(2 * crossed + mutated);
        let mut children: Vec<Vec<f64>> =
            (0..crossed).map(|i| self.cross(parents[2 * i], parents[2 * i + 1])).collect();
        children.extend(parents[2 * crossed..].iter().map(|&p| self.mutate(p)));
        children
    }

    fn tell(&mut self, trials: &[Trial]) {
        if !self.population.is_empty() {
            self.generation += 1;
            self.population.truncate(self.elite());
        }
        self.population.extend(trials.iter().map(|t| (t.point.clone(), t.misfit)));
        self.population.sort_by(|a, b| a.1.total_cmp(&b.1));
        let improved = self.best.last().is_none_or(|&last| self.population[0].1 < last);
        self.step = if improved { (4.0 * self.step).min(1.0) } else { (self.step / 4.0).max(1e-8) };
        self.best.push(self.population[0].1);
    }

    fn stop(&self) -> Option<Stop> {
        if self.generation >= self.generations {
            return Some(Stop::Iterations);
        }
        let window = self.settings.stall_generations;
        let (now, before) = (self.best.last()?, self.best.get(self.best.len().checked_sub(window + 1)?)?);
        let change = (before - now) / (window as f64 * now.abs().max(1.0));
        (change <= self.settings.tolerance).then_some(Stop::Stalled)
    }
}
