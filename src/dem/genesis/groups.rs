//! Groups of particles: minerals by their share of the volume.
//!
//! Balls are taken in random order, and each group takes the next ones until its share is full. So each share is met to
//! the volume of one ball, and it depends neither on the position nor on the size of a ball.

use super::heap::ball_volume;
use crate::particle::Group;
use crate::space::Space;
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// A named group and its share of the volume of all balls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Name.
    pub name: String,
    /// Share, 0 … 1; all together 1.
    pub share: f64,
}

/// What is wrong with the groups of a specimen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GroupError {
    /// None, or more than can be numbered.
    #[error("groups: {0} are given; there must be between 1 and {MOST_GROUPS}")]
    Number(usize),
    /// A share that is none.
    #[error("groups: the share of `{name}` is {share}; it must be above 0 and at most 1")]
    Share {
        /// The group.
        name: String,
        /// What was given.
        share: f64,
    },
    /// Shares that do not make a whole.
    #[error("groups: the shares add up to {0}; they must add up to 1")]
    Sum(f64),
    /// A duplicate name.
    #[error("groups: `{0}` is the name of two groups")]
    Twice(String),
}

/// Most groups of a specimen.
pub const MOST_GROUPS: usize = 64;

/// All that is wrong with the groups, with one of aggregate beside them where there is one.
pub fn group_faults(groups: &[Share], aggregate: Option<&str>) -> Vec<GroupError> {
    let mut faults = Vec::new();
    if groups.is_empty() || groups.len() > MOST_GROUPS {
        return vec![GroupError::Number(groups.len())];
    }
    for Share { name, share } in groups.iter().filter(|group| !(group.share > 0.0 && group.share <= 1.0)) {
        faults.push(GroupError::Share { name: name.clone(), share: *share });
    }
    let sum: f64 = groups.iter().map(|group| group.share).sum();
    if faults.is_empty() && (sum - 1.0).abs() > 1e-9 {
        faults.push(GroupError::Sum(sum));
    }
    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).chain(aggregate).collect();
    let twice = |k: &usize| names[..*k].contains(&names[*k]);
    faults.extend((0..names.len()).filter(twice).map(|k| GroupError::Twice(names[k].to_owned())));
    faults
}

/// The group of every ball, by its index in `groups`.
pub fn assign<S: Space>(groups: &[Share], radii: &[f64], stream: &mut Stream) -> Vec<Group> {
    let mut of = vec![Group(0); radii.len()];
    if groups.len() < 2 {
        return of;
    }
    let mut order: Vec<usize> = (0..radii.len()).collect();
    stream.shuffle(&mut order);
    let whole = ball_volume::<S>(radii);
    let (mut group, mut placed, mut full) = (0, 0.0, groups[0].share * whole);
    for i in order {
        let volume = ball_volume::<S>(&radii[i..=i]);
        while placed + 0.5 * volume > full && group + 1 < groups.len() {
            group += 1;
            full += groups[group].share * whole;
        }
        placed += volume;
        of[i] = Group(group as u8);
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D3;

    fn share(name: &str, share: f64) -> Share {
        Share { name: name.to_owned(), share }
    }

    #[test]
    fn shares_are_met_to_a_ball_and_scattered() {
        let groups = [share("quartz", 0.3), share("feldspar", 0.6), share("mica", 0.1)];
        let mut stream = Stream::new(1, "radii", 0);
        let radii: Vec<f64> = (0..4000).map(|_| stream.uniform_in(1.0, 2.0)).collect();
        let of = assign::<D3>(&groups, &radii, &mut Stream::new(1, "groups", 0));
        let volume = |k: Option<u8>| {
            let own: Vec<f64> = (0..4000).filter(|&i| k.is_none_or(|k| of[i] == Group(k))).map(|i| radii[i]).collect();
            ball_volume::<D3>(&own)
        };
        for (k, group) in groups.iter().enumerate() {
            let off = volume(Some(k as u8)) - group.share * volume(None);
            assert!(off.abs() < ball_volume::<D3>(&[2.0]), "{} off by {off}", group.name);
        }
        // Neighbours in the list are of one group as often as chance has it: Σ share².
        let same = of.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / 3999.0;
        assert!((same - 0.46).abs() < 0.04, "{same}");
    }

    #[test]
    fn shares_that_make_no_whole_and_names_that_clash_are_told() {
        assert!(group_faults(&[share("rock", 1.0)], Some("aggregate")).is_empty());
        assert_eq!(group_faults(&[share("a", 0.3), share("b", 0.3)], None), [GroupError::Sum(0.6)]);
        assert_eq!(group_faults(&[share("a", 1.5), share("b", 0.0)], None).len(), 2);
        assert_eq!(group_faults(&[share("a", 1.0)], Some("a")), [GroupError::Twice("a".to_owned())]);
        assert_eq!(group_faults(&[], None), [GroupError::Number(0)]);
    }
}
