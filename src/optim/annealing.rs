//! Improved simulated annealing: heavy-tailed moves whose width follows the temperature.
//!
//! At temperature T a chain of trial moves is made; a move that raises the misfit by Δ is accepted with probability
//! exp(−Δ / (s T)). Moves, in ranges, with q uniform in (0, 1):
//! * `ingber`: y = sgn(q − ½) T [(1 + 1/T)^|2q−1| − 1], at most one range (Ingber 1989);
//! * `cauchy`: y = T tan(π (q − ½)) (Szu & Hartley 1987);
//!
//! redrawn until the point is inside. Cooling after the i-th of n-parameter chains:
//! * `exponential`: Tᵢ = T₀ k^(i^(1/n)) (Ingber, Wang & Cao);
//! * `geometric`: Tᵢ = T₀ kⁱ.
//!
//! The acceptance scale s is 1 as published, or the spread of the misfit in the first chain, which makes T₀ = 1 mean
//! the same for every problem. The default preset moves all parameters in the first half of a chain and one at a time
//! in the second, descends ([`super::local`]) from what it found, and starts anew when frozen, as in Xiang et al. 2013.
//! Several chains may run side by side on parallel machines; each has its own random stream and state.
//!
//! The preset `wang2017` is the improved annealing of Wang & Cao 2017 (doi:10.1155/2017/6401835) as printed: a random
//! first point, then chains of 100 moves (their steps 3 to 8), all parameters at once by the Cauchy-like moves of their
//! eq. 7 and 9, accepted by their eq. 2 and 10 with s = 1, cooled by their eq. 4 and 5 from T₀ = 100 with k = 0.95
//! (their Table 3; the text has 0.99). The energy is the greatest relative deviation (their eq. 8), which is why
//! [`Settings::published_form`] and [`Settings::published_misfit`] are the maximum and 10 %. The stored text has lost its
//! equations; those of Ingber, whom it cites for both changes, are taken for them. With an energy of order 1 such
//! temperatures accept nearly every move, so the published search is close to a random walk.
//!
//! A failed run has an infinite energy: it costs its evaluation, and is left for whatever comes next.
//!
//! Sources: Ingber 1989, doi:10.1016/0895-7177(89)90202-1; Szu & Hartley
//! 1987, doi:10.1016/0375-9601(87)90796-1; Metropolis et al. 1953, doi:10.1063/1.1699114; Xiang et al. 2013,
//! doi:10.32614/RJ-2013-002.

use super::constraint::Domain;
use super::local::Local;
use super::misfit::Form;
use super::{Optimiser, Stop, Trial};
use math::elementary::{exp, pow, tan};
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Published sets of settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Geometric cooling with descents and restarts: for fitted surfaces.
    #[default]
    Descending,
    /// Wang & Cao 2017.
    Wang2017,
}

/// Distribution of the moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Moves {
    /// Bounded, density nearly 1/|y| down to the temperature.
    Ingber,
    /// Cauchy of the temperature's width.
    Cauchy,
}

/// How the temperature falls from chain to chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cooling {
    /// T₀ k^(i^(1/n))
    Exponential,
    /// T₀ kⁱ
    Geometric,
}

/// Settings; a setting that is left out has the value of the preset.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Where settings that are left out come from.
    pub preset: Preset,
    /// Distribution of the moves.
    pub moves: Option<Moves>,
    /// How the temperature falls.
    pub cooling: Option<Cooling>,
    /// T₀.
    pub temperature: Option<f64>,
    /// k, between 0 and 1.
    pub factor: Option<f64>,
    /// Moves at one temperature (length of the Markov chain).
    pub chain: Option<usize>,
    /// Temperature that counts as frozen.
    pub frozen: Option<f64>,
    /// Descend from the point found, and start anew when frozen.
    pub descend: Option<bool>,
    /// Chains side by side.
    pub chains: Option<usize>,
}

impl Settings {
    /// Wang & Cao 2017.
    pub fn wang2017() -> Self {
        Self { preset: Preset::Wang2017, ..Self::default() }
    }

    /// How the preset's authors combine deviations, if they say.
    pub fn published_form(&self) -> Option<Form> {
        match self.preset {
            Preset::Descending => None,
            Preset::Wang2017 => Some(Form::Maximum),
        }
    }

    /// The misfit at which the preset's authors stop, if they do.
    pub fn published_misfit(&self) -> Option<f64> {
        match self.preset {
            Preset::Descending => None,
            Preset::Wang2017 => Some(0.1),
        }
    }

    fn plan(&self, factors: usize) -> Plan {
        let published = self.preset == Preset::Wang2017;
        let or = |set: Option<f64>, wang: f64, own: f64| set.unwrap_or(if published { wang } else { own });
        let cooling = if published { Cooling::Exponential } else { Cooling::Geometric };
        Plan {
            moves: self.moves.unwrap_or(Moves::Ingber),
            cooling: self.cooling.unwrap_or(cooling),
            temperature: or(self.temperature, 100.0, 1.0),
            factor: or(self.factor, 0.95, 0.85),
            chain: self.chain.unwrap_or(if published { 100 } else { 10 * factors }).max(1),
            frozen: or(self.frozen, 1e-6, 1e-9),
            descend: self.descend.unwrap_or(!published),
            scaled: !published,
            one_at_a_time: !published,
            counts_first: !published,
        }
    }
}

#[derive(Clone)]
struct Plan {
    moves: Moves,
    cooling: Cooling,
    temperature: f64,
    factor: f64,
    chain: usize,
    frozen: f64,
    descend: bool,
    scaled: bool,
    one_at_a_time: bool,
    /// Whether the first point, which no move made, is one of the first chain.
    counts_first: bool,
}

/// The algorithm's state.
pub struct Annealing {
    chains: Vec<Chain>,
    /// Number of points of each chain.
    asked: Vec<usize>,
}

impl Annealing {
    /// A fresh search.
    pub fn new(settings: &Settings, domain: &Domain, seed: u64, start: Option<&[f64]>) -> Self {
        let plan = settings.plan(domain.len());
        let chain = |i| Chain::new(plan.clone(), domain, Stream::new(seed, "annealing", i));
        let mut chains: Vec<Chain> = (0..settings.chains.unwrap_or(1).max(1) as u64).map(chain).collect();
        chains[0].start = start.map(<[f64]>::to_vec);
        Self { chains, asked: Vec::new() }
    }
}

impl Optimiser for Annealing {
    fn ask(&mut self) -> Vec<Vec<f64>> {
        let asked: Vec<Vec<Vec<f64>>> = self.chains.iter_mut().map(Chain::ask).collect();
        self.asked = asked.iter().map(Vec::len).collect();
        asked.into_iter().flatten().collect()
    }

    fn tell(&mut self, mut trials: &[Trial]) {
        for (chain, &count) in self.chains.iter_mut().zip(&self.asked) {
            let (own, others) = trials.split_at(count.min(trials.len()));
            if own.len() == count {
                chain.tell(own);
            }
            trials = others;
        }
    }

    fn stop(&self) -> Option<Stop> {
        self.chains.iter().all(Chain::is_frozen).then_some(Stop::Iterations)
    }
}

/// Chains between descents.
const DESCENT: usize = 6;

struct Chain {
    plan: Plan,
    domain: Domain,
    random: Stream,
    /// A first guess.
    start: Option<Vec<f64>>,
    current: Option<(Vec<f64>, f64)>,
    /// Lowest point since the last start, and whether it was found after the last descent.
    lowest: (Vec<f64>, f64, bool),
    descent: Option<Local>,
    /// Number of the chain since the last start, and of the move in it.
    cooled: usize,
    done: usize,
    temperature: f64,
    seen: Vec<f64>,
    scale: f64,
}

impl Chain {
    fn new(plan: Plan, domain: &Domain, random: Stream) -> Self {
        Self {
            temperature: plan.temperature,
            plan,
            domain: domain.clone(),
            random,
            start: None,
            current: None,
            lowest: (Vec::new(), f64::INFINITY, false),
            descent: None,
            cooled: 0,
            done: 0,
            seen: Vec::new(),
            scale: 1.0,
        }
    }

    fn is_frozen(&self) -> bool {
        !self.plan.descend && self.temperature < self.plan.frozen
    }

    fn ask(&mut self) -> Vec<Vec<f64>> {
        if let Some(descent) = &mut self.descent {
            return descent.ask();
        }
        match self.current.clone() {
            None => vec![self.start.take().unwrap_or_else(|| self.domain.sample(&mut self.random))],
            Some((from, _)) => vec![self.moved(&from)],
        }
    }

    fn tell(&mut self, trials: &[Trial]) {
        if let Some(mut descent) = self.descent.take() {
            descent.tell(trials);
            if descent.stop().is_none() {
                self.descent = Some(descent);
            } else {
                let (point, misfit) = descent.best();
                self.current = Some((point.to_vec(), misfit));
                self.lowest = (point.to_vec(), misfit, false);
            }
            return;
        }
        let trial = &trials[0];
        let counts = self.current.is_some() || self.plan.counts_first;
        let accepted = match &self.current {
            None => true,
            Some((_, misfit)) => self.accepts(trial.misfit - misfit),
        };
        if accepted {
            self.current = Some((trial.point.clone(), trial.misfit));
        }
        if trial.misfit < self.lowest.1 {
            self.lowest = (trial.point.clone(), trial.misfit, true);
        }
        if self.cooled == 0 && trial.misfit.is_finite() {
            self.seen.push(trial.misfit);
        }
        self.done += usize::from(counts);
        if self.done >= self.plan.chain {
            self.cool();
        }
    }

    fn accepts(&mut self, rise: f64) -> bool {
        // A failed run compared with a failed run gives NaN: go on from the new one.
        if rise <= 0.0 || rise.is_nan() {
            return true;
        }
        self.random.uniform() < exp(-rise / (self.scale * self.temperature))
    }

    fn cool(&mut self) {
        if self.cooled == 0 && self.plan.scaled {
            self.scale = spread(&self.seen);
        }
        self.done = 0;
        self.cooled += 1;
        let exponent = match self.plan.cooling {
            Cooling::Geometric => self.cooled as f64,
            Cooling::Exponential => pow(self.cooled as f64, 1.0 / self.domain.len() as f64),
        };
        self.temperature = self.plan.temperature * pow(self.plan.factor, exponent);
        if !self.plan.descend {
            return;
        }
        if self.temperature < self.plan.frozen {
            *self = Self::new(self.plan.clone(), &self.domain, self.random.clone());
        } else if self.lowest.2 && self.cooled.is_multiple_of(DESCENT) {
            self.descent = Some(Local::new(&self.domain, &self.lowest.0, self.lowest.1)).filter(|d| d.stop().is_none());
        }
    }

    /// A move of all parameters, or of one, redrawn until it is allowed.
    fn moved(&mut self, from: &[f64]) -> Vec<f64> {
        let single = self.plan.one_at_a_time && self.done >= self.plan.chain / 2;
        let only = if single { Some(self.random.below(from.len())) } else { None };
        let mut point = from.to_vec();
        for _ in 0..100 {
            for (j, &u) in from.iter().enumerate() {
                if only.is_none_or(|only| only == j) {
                    point[j] = self.coordinate(u);
                }
            }
            if self.domain.contains(&point) {
                return point;
            }
        }
        self.domain.repair(&point)
    }

    /// One parameter moved, redrawn until it is in its range.
    fn coordinate(&mut self, from: f64) -> f64 {
        let t = self.temperature;
        for _ in 0..1000 {
            let q = self.random.uniform();
            let step = match self.plan.moves {
                Moves::Ingber => (q - 0.5).signum() * t * (pow(1.0 + 1.0 / t, (2.0 * q - 1.0).abs()) - 1.0),
                Moves::Cauchy => t * tan(std::f64::consts::PI * (q - 0.5)),
            };
            if (0.0..=1.0).contains(&(from + step)) {
                return from + step;
            }
        }
        self.random.uniform()
    }
}

/// Standard deviation; 1 where there is none.
fn spread(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n;
    if variance > 0.0 { variance.sqrt() } else { 1.0 }
}
