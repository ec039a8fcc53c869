//! Snapshots at shares of the peak, which is known only afterwards.
//!
//! While the stress climbs, a state is stored for every 4 % of rise (the ladder), and the state of the largest stress so
//! far for every 0.2 %. At the end the rung next to each wanted share remains. Rungs below a third of the largest
//! stress are dropped on the way, so memory stays at about thirty states.

use super::curve::Sample;
use crate::measure::Link;
use crate::{Space, Vector};

/// The state of the balls at one moment.
#[derive(Clone, Debug, Default)]
pub struct State<S: Space> {
    /// Centres (m).
    pub centres: Vec<Vector<S>>,
    /// Forces between them, where they are wanted.
    pub forces: Vec<Link>,
}

/// All balls at one moment.
#[derive(Clone, Debug)]
pub struct Snapshot<S: Space> {
    /// Axial strain.
    pub strain: f64,
    /// Stress (Pa).
    pub stress: f64,
    /// Cracks so far.
    pub cracks: usize,
    /// The balls.
    pub state: State<S>,
}

impl<S: Space> Snapshot<S> {
    /// The state at a sample.
    pub fn new(sample: &Sample, state: State<S>) -> Self {
        Self { strain: sample.axial, stress: sample.stress, cracks: sample.cracks, state }
    }
}

/// States on the way up.
#[derive(Clone, Debug, Default)]
pub struct Ladder<S: Space> {
    rungs: Vec<Snapshot<S>>,
    top: Option<Snapshot<S>>,
}

const RUNG: f64 = 1.04;
const TOP: f64 = 1.002;
const FORGET: f64 = 1.0 / 3.0;

impl<S: Space> Ladder<S> {
    /// Stores the state of this sample if it is a rung or a new top.
    pub fn offer(&mut self, sample: &Sample, state: impl Fn() -> State<S>) {
        if sample.stress > TOP * self.top.as_ref().map_or(0.0, |top| top.stress) {
            self.top = Some(Snapshot::new(sample, state()));
        }
        if sample.stress > RUNG * self.rungs.last().map_or(0.0, |rung| rung.stress) {
            self.rungs.push(Snapshot::new(sample, state()));
            self.rungs.retain(|rung| rung.stress >= FORGET * sample.stress);
        }
    }

    /// The states nearest to `shares` of `peak`, then `last`. Shares below a third find nothing nearer than a third.
    pub fn keep(mut self, peak: f64, shares: &[f64], last: Snapshot<S>) -> Vec<Snapshot<S>> {
        self.rungs.extend(self.top);
        let nearest = |share: &f64| {
            let off = |s: &&Snapshot<S>| (s.stress - share * peak).abs();
            self.rungs.iter().min_by(|a, b| off(a).total_cmp(&off(b))).cloned()
        };
        shares.iter().filter_map(nearest).chain([last]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D2;

    #[test]
    fn states_lie_near_the_wanted_shares() {
        let mut ladder = Ladder::<D2>::default();
        let sample = |stress: f64, strain: f64| Sample { axial: strain, lateral: 0.0, stress, cracks: 0, speed: 0.0 };
        let climb: Vec<f64> = (1..=1000).map(f64::from).chain((500..1000).rev().map(f64::from)).collect();
        for (k, &stress) in climb.iter().enumerate() {
            ladder.offer(&sample(stress, k as f64), || State { centres: vec![[stress, 0.0]], forces: vec![] });
        }
        assert!(ladder.rungs.len() < 40);
        let last = Snapshot::new(&sample(500.0, 1500.0), State::default());
        let kept = ladder.keep(1000.0, &[0.5, 0.8, 1.0], last.clone());
        for (snapshot, wanted) in kept.iter().zip([500.0, 800.0, 1000.0]) {
            assert!((snapshot.stress / wanted - 1.0).abs() < 0.03, "{}", snapshot.stress);
            assert_eq!(snapshot.state.centres[0][0], snapshot.stress);
            assert!(snapshot.strain < 1000.0);
        }
        assert!(kept[2].stress > 997.0);
        assert_eq!((kept[3].stress, kept[3].strain), (last.stress, last.strain));
    }
}
