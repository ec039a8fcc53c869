//! Who may touch whom while balls move: a list of pairs that follows them.
//!
//! A pair is listed while the surfaces of its balls, as they were when each ball was last looked up (its *origin*), are nearer
//! than the margin. No ball strays further than half of the margin from its origin, so a pair that is not listed does not
//! touch. When some balls have strayed, only they are looked up anew: few balls of a heap near rest move far (rattlers mostly).
//! The list is at every time the one that a search over all origins gives, in the same order, so it changes no bit of a sum
//! over the contacts.

use super::heap::{Heap, Neighbours, Pair};
use crate::space::{Space, Tuple, Vector, flat};

/// Way from the origin that a ball may go, over the margin; with some room for rounding.
const ALLOWED: f64 = 0.499;
/// Way over the margin from which a ball is looked up anew together with those that must be.
const DUE: f64 = 0.2;
/// Share of the balls above which all are looked up anew.
const MANY: f64 = 0.3;

/// The list, and where the balls were when it was made.
pub(super) struct Vicinity<S: Space> {
    margin: f64,
    scale: f64,
    origins: Vec<Vector<S>>,
    radii: Vec<f64>,
    cells: Cells,
    list: Neighbours,
    /// No ball is further than this from its origin (m).
    strayed: f64,
}

impl<S: Space> Vicinity<S> {
    /// All that is nearer than `margin` (m); all stiffnesses times `scale`.
    pub(super) fn new(heap: &Heap<S>, margin: f64, scale: f64) -> Self {
        let cells = Cells::new(heap, margin);
        let list = heap.neighbours(margin, scale);
        let (origins, radii) = (heap.centres.clone(), heap.radii.clone());
        Self { margin, scale, origins, radii, cells, list, strayed: 0.0 }
    }

    /// What may touch now.
    pub(super) fn list(&self) -> &Neighbours {
        &self.list
    }

    /// Follows the balls, none of which has moved further than `way` (m) since the last call. Returns whether the list is
    /// another one now.
    pub(super) fn follow(&mut self, heap: &Heap<S>, way: f64) -> bool {
        self.strayed += way;
        if self.strayed <= ALLOWED * self.margin {
            return false;
        }
        let (mut due, mut farthest) = (Vec::new(), 0.0_f64);
        for (i, (x, origin)) in heap.centres.iter().zip(&self.origins).enumerate() {
            let way = x.minus(*origin).norm();
            if way > DUE * self.margin {
                due.push(i);
            } else if way > farthest {
                farthest = way;
            }
        }
        self.strayed = farthest;
        match due.len() {
            0 => return false,
            some if some as f64 <= MANY * self.origins.len() as f64 => self.look_up(heap, &due),
            _ => *self = Self::new(heap, self.margin, self.scale),
        }
        true
    }

    /// Follows balls whose radii change: the list is made anew when the balls have moved and the `swelling` ones have grown by
    /// half of the margin. Returns whether it was.
    pub(super) fn follow_swelling(&mut self, heap: &Heap<S>, swelling: &[usize]) -> bool {
        let square = |(a, b): (&Vector<S>, &Vector<S>)| {
            let apart = a.minus(*b);
            apart.dot(apart)
        };
        let moved = heap.centres.iter().zip(&self.origins).map(square).fold(0.0, f64::max).sqrt();
        let grown = swelling.iter().map(|&i| (heap.radii[i] - self.radii[i]).abs()).fold(0.0, f64::max);
        let over = moved + grown > 0.5 * self.margin;
        if over {
            *self = Self::new(heap, self.margin, self.scale);
        }
        over
    }

    /// Looks up the balls `due` (ascending) at their present centres.
    fn look_up(&mut self, heap: &Heap<S>, due: &[usize]) {
        let mut moved = vec![false; self.origins.len()];
        for &i in due {
            moved[i] = true;
            self.cells.shift(i, flat::<S>(self.origins[i]), flat::<S>(heap.centres[i]));
            self.origins[i] = heap.centres[i];
        }
        let mut found: Vec<Pair> = Vec::new();
        for &i in due {
            self.cells.around(flat::<S>(self.origins[i]), |j| {
                let twice = moved[j] && j <= i;
                let still = i.max(j) < heap.still.pebbles;
                let reach = heap.radii[i] + heap.radii[j] + self.margin;
                let apart = self.origins[j].minus(self.origins[i]);
                if !twice && !still && apart.dot(apart) < reach * reach {
                    found.push(heap.pair(i.min(j), i.max(j), self.scale));
                }
            });
        }
        found.sort_unstable_by_key(|pair| (pair.i, pair.j));
        self.list.pairs = merged(&self.list.pairs, &found, &moved);
        let near = |&i: &usize| heap.is_near_wall(self.origins[i], i, self.margin);
        self.list.at_wall.retain(|&i| !moved[i as usize]);
        self.list
            .at_wall
            .extend(due.iter().copied().filter(|&i| i >= heap.still.pebbles).filter(near).map(|i| i as u32));
        self.list.at_wall.sort_unstable();
    }
}

/// The pairs of balls that have not moved, and the `found` ones, in order.
fn merged(old: &[Pair], found: &[Pair], moved: &[bool]) -> Vec<Pair> {
    let mut all = Vec::with_capacity(old.len() + found.len());
    let mut next = found.iter().peekable();
    for pair in old.iter().filter(|pair| !moved[pair.i as usize] && !moved[pair.j as usize]) {
        while let Some(new) = next.next_if(|new| (new.i, new.j) < (pair.i, pair.j)) {
            all.push(*new);
        }
        all.push(*pair);
    }
    all.extend(next);
    all
}

/// Balls by cell of a grid, as chains that balls leave and join.
struct Cells {
    low: [f64; 3],
    inverse: f64,
    count: [usize; 3],
    /// First ball of each cell, and the one after each ball; [`NOBODY`] at the end of a chain.
    first: Vec<u32>,
    next: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

impl Cells {
    /// Cells so large that balls nearer than `margin` lie in the same or in neighbouring ones.
    fn new<S: Space>(heap: &Heap<S>, margin: f64) -> Self {
        let largest = heap.radii.iter().copied().fold(0.0, f64::max);
        let edges = heap.region.edges();
        let most = 4.0 * heap.radii.len() as f64 + 64.0;
        let cells = |side: f64| (0..S::DIMENSION).map(|k| (edges[k] / side).floor() + 1.0).product::<f64>();
        let mut side = 2.0 * largest + margin;
        while cells(side) > most {
            side *= 1.5;
        }
        let count = std::array::from_fn(|k| if k < S::DIMENSION { (edges[k] / side).floor() as usize + 1 } else { 1 });
        let first = vec![NOBODY; count.iter().product()];
        let next = vec![NOBODY; heap.radii.len()];
        let mut new = Self { low: edges.map(|edge| -0.5 * edge), inverse: 1.0 / side, count, first, next };
        heap.centres.iter().enumerate().for_each(|(i, &x)| new.join(i, flat::<S>(x)));
        new
    }

    /// Cell along each axis; what lies outside belongs to the outermost ones.
    fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| (((x[k] - self.low[k]) * self.inverse).max(0.0) as usize).min(self.count[k] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }

    fn join(&mut self, ball: usize, x: [f64; 3]) {
        let cell = self.index(self.cell(x));
        self.next[ball] = std::mem::replace(&mut self.first[cell], ball as u32);
    }

    /// Moves a ball from the cell of `from` to that of `to`.
    fn shift(&mut self, ball: usize, from: [f64; 3], to: [f64; 3]) {
        let cell = self.index(self.cell(from));
        if cell == self.index(self.cell(to)) {
            return;
        }
        let after = self.next[ball];
        if self.first[cell] == ball as u32 {
            self.first[cell] = after;
        } else {
            let mut before = self.first[cell];
            while self.next[before as usize] != ball as u32 {
                before = self.next[before as usize];
            }
            self.next[before as usize] = after;
        }
        self.join(ball, to);
    }

    /// Calls `visit` for every ball in the cell of `x` and in those around it.
    fn around(&self, x: [f64; 3], mut visit: impl FnMut(usize)) {
        let home = self.cell(x);
        let span = |k: usize| home[k].saturating_sub(1)..=(home[k] + 1).min(self.count[k] - 1);
        for z in span(2) {
            for y in span(1) {
                for x in span(0) {
                    let mut ball = self.first[self.index([x, y, z])];
                    while ball != NOBODY {
                        visit(ball as usize);
                        ball = self.next[ball as usize];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::heap::Still;
    use super::super::region::Region;
    use super::*;
    use crate::{D2, D3};
    use math::random::Stream;

    fn pairs(list: &Neighbours) -> Vec<(u32, u32, u64)> {
        list.pairs.iter().map(|pair| (pair.i, pair.j, pair.stiffness.to_bits())).collect()
    }

    /// Some balls wander, a few far (out of the vessel, too): the list holds all that a search finds at the origins, in its
    /// order, and all that touches.
    fn follows<S: Space>(region: Region, radius: f64, still: usize) {
        let mut stream = Stream::new(4, "wander", 0);
        let edges = region.edges();
        let point = |stream: &mut Stream| Vector::<S>::build(|k| edges[k] * (stream.uniform() - 0.5));
        let centres: Vec<Vector<S>> = (0..400).map(|_| point(&mut stream)).collect();
        let radii: Vec<f64> = (0..400).map(|_| radius * stream.uniform_in(0.5, 1.5)).collect();
        let mut heap = Heap::<S> { region, centres, radii, still: Still { pebbles: still, volume: 0.0 } };
        let margin = 0.5 * radius;
        let mut vicinity = Vicinity::new(&heap, margin, 1.0);
        let (mut partly, mut wholly) = (0, 0);
        for round in 0..400 {
            let pace = if round % 50 == 49 { 0.5 } else { 0.002 } * radius;
            let mut way = 0.0_f64;
            for (i, x) in heap.centres.iter_mut().enumerate().skip(still) {
                let step = if i % 40 == 0 { 0.1 * radius } else { pace };
                let moved = Vector::<S>::build(|_| step * (stream.uniform() - 0.3));
                way = way.max(moved.norm());
                *x = x.plus(moved);
            }
            let before = vicinity.origins.clone();
            if vicinity.follow(&heap, way) {
                let moved = before.iter().zip(&vicinity.origins).filter(|(a, b)| a.minus(**b).norm() > 0.0).count();
                *(if moved > 200 { &mut wholly } else { &mut partly }) += 1;
            }
            let origins = Heap::<S> { centres: vicinity.origins.clone(), ..heap.clone() };
            let expected = origins.neighbours(margin, 1.0);
            assert_eq!(pairs(vicinity.list()), pairs(&expected));
            assert_eq!(vicinity.list().at_wall, expected.at_wall);
            let listed: std::collections::BTreeSet<_> = vicinity.list().pairs.iter().map(|p| (p.i, p.j)).collect();
            let touching = heap.neighbours(0.0, 1.0);
            assert!(touching.pairs.iter().all(|pair| listed.contains(&(pair.i, pair.j))));
        }
        assert!(partly > 20 && wholly > 2, "{partly} {wholly}");
    }

    #[test]
    fn the_list_follows_the_balls() {
        follows::<D2>(Region::Rectangle { width: 1.0, height: 2.0 }, 0.03, 0);
        follows::<D3>(Region::Box { width: 1.0, height: 2.0, depth: 0.5 }, 0.06, 50);
    }
}
