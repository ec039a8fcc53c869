//! Forces between the overlapping balls of a heap, several pairs at a time.
//!
//! A pair pushes its balls apart with k_n U along the line of their centres. Pairs are taken in blocks of eight; what each of
//! them contributes is added to its balls pair by pair, in the order of the list, and so is the sum of all forces. Hence the
//! bits are those of a plain loop at every [`Width`].

use super::heap::{Heap, Neighbours};
use crate::simd::{Kernel, Lane, Quad, Row, Table, WIDEST, Width, dispatch};
use crate::space::{Space, Tuple, Vector, flat};
use std::marker::PhantomData;

/// Eight pairs of a list.
struct Block {
    ends: [[u32; WIDEST]; 2],
    stiffness: Row,
}

/// Forces of the contacts of a heap.
pub(super) struct Forces<S: Space> {
    width: Width,
    blocks: Vec<Block>,
    /// Centre and radius of each ball, and of one without a radius that fills up blocks: `x y z r`.
    records: Table,
    /// Force on each ball and the sum of its normal forces: `fx fy fz n`.
    loads: Table,
    /// Force on each ball.
    pub(super) balls: Vec<Vector<S>>,
    /// Mean contact force.
    pub(super) mean: f64,
}

impl<S: Space> Forces<S> {
    /// Forces of the pairs of `list`.
    pub(super) fn new(heap: &Heap<S>, list: &Neighbours) -> Self {
        let count = heap.radii.len();
        let (records, loads) = (Table::new(count + 1), Table::new(count + 1));
        let balls = vec![Vector::<S>::zero(); count];
        let mut forces = Self { width: Width::detect(), blocks: Vec::new(), records, loads, balls, mean: 0.0 };
        forces.take(list);
        forces
    }

    /// Takes the pairs of another list.
    pub(super) fn take(&mut self, list: &Neighbours) {
        let nobody = self.balls.len() as u32;
        self.blocks.clear();
        self.blocks.extend(list.pairs.chunks(WIDEST).map(|pairs| {
            let mut block = Block { ends: [[nobody; WIDEST]; 2], stiffness: Row::default() };
            for (k, pair) in pairs.iter().enumerate() {
                block.ends[0][k] = pair.i;
                block.ends[1][k] = pair.j;
                block.stiffness.0[k] = pair.stiffness;
            }
            block
        }));
    }

    /// Computes them; the mean one on a ball that is free over the mean of a contact, 0 when nothing overlaps.
    pub(super) fn fill(&mut self, heap: &Heap<S>, list: &Neighbours) -> f64 {
        for (record, (&x, &radius)) in self.records.iter_mut().zip(heap.centres.iter().zip(&heap.radii)) {
            let [x, y, z] = flat::<S>(x);
            *record = Quad([x, y, z, radius]);
        }
        self.loads.fill(Quad::default());
        let (blocks, records, loads) = (&self.blocks[..], &self.records[..], &mut self.loads[..]);
        let mut total = dispatch(self.width, Pushes { blocks, records, loads, space: PhantomData::<S> });
        heap.visit_walls(list, |overlap| {
            let size = overlap.stiffness * overlap.depth;
            let push = overlap.normal.times(size);
            let load = &mut self.loads[overlap.first].0;
            for k in 0..S::DIMENSION {
                load[k] -= push.at(k);
            }
            load[3] += size;
            total.sum += size;
            total.count += 1;
        });
        let still = heap.still.pebbles;
        let mut unbalanced = 0.0;
        for (force, load) in self.balls.iter_mut().zip(&self.loads[..]).skip(still) {
            *force = Vector::<S>::build(|k| load.0[k]);
            unbalanced += force.norm();
        }
        let free = (self.balls.len() - still) as f64;
        self.mean = if total.count == 0 { 0.0 } else { total.sum / total.count as f64 };
        if total.count == 0 { 0.0 } else { unbalanced / free * total.count as f64 / total.sum }
    }

    /// Sum of the normal forces on a ball.
    pub(super) fn on(&self, ball: usize) -> f64 {
        self.loads[ball].0[3]
    }
}

/// Sum and number of the forces of contacts.
#[derive(Default)]
struct Total {
    sum: f64,
    count: usize,
}

/// Adds the pushes of all pairs to their balls.
struct Pushes<'a, S: Space> {
    blocks: &'a [Block],
    records: &'a [Quad],
    loads: &'a mut [Quad],
    space: PhantomData<S>,
}

impl<S: Space> Kernel for Pushes<'_, S> {
    type Output = Total;

    #[inline(always)]
    fn run<L: Lane>(self) -> Total {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut total = Total::default();
        let mut sizes = Row::default();
        for block in self.blocks {
            for at in (0..WIDEST).step_by(L::WIDTH) {
                let ends = [&block.ends[0][at..at + L::WIDTH], &block.ends[1][at..at + L::WIDTH]];
                let [[first], [second]] =
                    [L::gather::<1>(self.records, ends[0]), L::gather::<1>(self.records, ends[1])];
                let mut apart = [zero; 4];
                let mut square = zero;
                for k in 0..S::DIMENSION {
                    apart[k] = second[k] - first[k];
                    square = if k == 0 { apart[k] * apart[k] } else { square + apart[k] * apart[k] };
                }
                let reach = first[3] + second[3];
                let touches = (reach * reach).above(square);
                let distance = square.sqrt();
                let size = L::select(touches, L::load(&block.stiffness, at) * (reach - distance), zero);
                let parted = distance.above(zero);
                let mut pushes = [[[zero; 4]; 1]; 2];
                for k in 0..S::DIMENSION {
                    let aside = if k == 0 { one } else { zero };
                    let push = L::select(parted, apart[k] / distance, aside) * size;
                    (pushes[0][0][k], pushes[1][0][k]) = (-push, push);
                }
                (pushes[0][0][3], pushes[1][0][3]) = (size, size);
                L::scatter_add_both::<1>(self.loads, ends, pushes);
                size.store(&mut sizes, at);
                total.count += L::bits(touches).count_ones() as usize;
            }
            // What does not touch adds nothing.
            for size in sizes.0 {
                total.sum += size;
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::super::heap::Still;
    use super::super::region::Region;
    use super::*;
    use crate::{D2, D3};
    use math::random::Stream;

    /// The same as a plain loop over what overlaps, to the last bit, at every width; two balls lie in one point.
    fn same_bits<S: Space>(region: Region, radius: f64) {
        let mut stream = Stream::new(5, "repulsion", 0);
        let edges = region.edges();
        let centre = |stream: &mut Stream| Vector::<S>::build(|k| edges[k] * (stream.uniform() - 0.5));
        let mut centres: Vec<Vector<S>> = (0..301).map(|_| centre(&mut stream)).collect();
        centres[200] = centres[7];
        let radii: Vec<f64> = (0..301).map(|_| radius * stream.uniform_in(0.5, 1.5)).collect();
        let heap = Heap::<S> { region, centres, radii, still: Still { pebbles: 5, volume: 0.0 } };
        let list = heap.neighbours(0.3 * radius, 1.25);
        let (mut balls, mut normal) = (vec![Vector::<S>::zero(); 301], vec![0.0; 301]);
        let (mut sum, mut count) = (0.0, 0_usize);
        heap.visit(&list, |overlap| {
            let size = overlap.stiffness * overlap.depth;
            let push = overlap.normal.times(size);
            balls[overlap.first] = balls[overlap.first].minus(push);
            normal[overlap.first] += size;
            if let Some(j) = overlap.second {
                balls[j] = balls[j].plus(push);
                normal[j] += size;
            }
            sum += size;
            count += 1;
        });
        let unbalanced = balls[5..].iter().map(|force| force.norm()).sum::<f64>() / 296.0;
        assert!(count > 200 && list.pairs.len() > count);
        let bits = |v: Vector<S>| (0..S::DIMENSION).map(|k| v.at(k).to_bits()).collect::<Vec<_>>();
        for width in [Width::One, Width::Four, Width::Eight].into_iter().filter(|width| width.available()) {
            let mut forces = Forces { width, ..Forces::new(&heap, &list) };
            assert_eq!(forces.fill(&heap, &list).to_bits(), (unbalanced * count as f64 / sum).to_bits());
            assert_eq!(forces.mean.to_bits(), (sum / count as f64).to_bits());
            for i in 0..301 {
                assert_eq!(forces.on(i).to_bits(), normal[i].to_bits());
                let expected = if i < 5 { Vector::<S>::zero() } else { balls[i] };
                assert_eq!(bits(forces.balls[i]), bits(expected));
            }
        }
    }

    #[test]
    fn every_width_gives_the_bits_of_a_plain_loop() {
        same_bits::<D2>(Region::Rectangle { width: 1.0, height: 2.0 }, 0.05);
        same_bits::<D3>(Region::Cylinder { diameter: 1.0, height: 2.0 }, 0.12);
    }
}
