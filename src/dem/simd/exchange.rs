//! One table of records, moved on by several threads: each owns a range, all read the whole.
//!
//! Two buffers. Between two meetings every thread reads the front buffer and writes its own range of the back one; at a
//! meeting the buffers change roles. A meeting waits for all, spinning briefly and then yielding, because a pure spin
//! collapses when the machine has other work. A single thread works in place.

use super::{Quad, Table};
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Looks at the barrier before the thread offers its core to others.
const SPINS: u32 = 4000;

/// Rows that are read as they were and written as they become.
pub(crate) trait Rows {
    /// Row `k` of the old state, counted over the whole table.
    fn read(&self, k: usize) -> Quad;
    /// Writes row `k` of the new state; k lies in the own range.
    fn write(&mut self, k: usize, value: Quad);
}

/// In place.
pub(crate) struct Same<'a>(pub(crate) &'a mut [Quad]);

impl Rows for Same<'_> {
    #[inline(always)]
    fn read(&self, k: usize) -> Quad {
        self.0[k]
    }
    #[inline(always)]
    fn write(&mut self, k: usize, value: Quad) {
        self.0[k] = value;
    }
}

/// From the front to the back buffer.
struct Apart<'a> {
    front: &'a [Quad],
    back: &'a mut [Quad],
    first: usize,
}

impl Rows for Apart<'_> {
    #[inline(always)]
    fn read(&self, k: usize) -> Quad {
        self.front[k]
    }
    #[inline(always)]
    fn write(&mut self, k: usize, value: Quad) {
        self.back[k - self.first] = value;
    }
}

/// Where the threads meet.
#[derive(Debug, Default)]
struct Meeting {
    members: usize,
    arrived: AtomicUsize,
    broken: AtomicBool,
}

impl Meeting {
    /// Returns when all members have come for the `round`-th time.
    fn wait(&self, round: usize) {
        self.arrived.fetch_add(1, Ordering::AcqRel);
        let mut looks = 0;
        while self.arrived.load(Ordering::Acquire) < round * self.members {
            assert!(!self.broken.load(Ordering::Relaxed), "BUG: another thread of the step panicked");
            looks += 1;
            if looks < SPINS {
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }
}

/// One thread's view of the table.
pub(crate) struct Board<'a> {
    buffers: [*mut Quad; 2],
    len: usize,
    own: Range<usize>,
    round: usize,
    meeting: Option<&'a Meeting>,
    life: PhantomData<&'a mut [Quad]>,
}

// SAFETY: a board hands out its own range of the back buffer and shared views of the front one (see the head).
unsafe impl Send for Board<'_> {}

impl Board<'_> {
    /// The whole table as it is.
    #[inline(always)]
    pub(crate) fn all(&self) -> &[Quad] {
        // SAFETY: nobody writes the front buffer before the next meeting, for which `self` must be free.
        unsafe { std::slice::from_raw_parts(self.buffers[self.round % 2], self.len) }
    }

    /// Moves the own rows on with `f`.
    #[inline(always)]
    pub(crate) fn update<T>(&mut self, update: impl Update<T>) -> T {
        let front = self.buffers[self.round % 2];
        if self.meeting.is_none() {
            // SAFETY: a single board has the whole table to itself; both buffers are the same.
            return update.run(&mut Same(unsafe { std::slice::from_raw_parts_mut(front, self.len) }));
        }
        let back = self.buffers[(self.round + 1) % 2];
        // SAFETY: the front buffer is only read before the next meeting; the own ranges of the back one are disjoint.
        let (front, back) = unsafe {
            let own = std::slice::from_raw_parts_mut(back.add(self.own.start), self.own.len());
            (std::slice::from_raw_parts(front, self.len), own)
        };
        update.run(&mut Apart { front, back, first: self.own.start })
    }

    /// Waits for the other threads and makes the new state the present one.
    #[inline(always)]
    pub(crate) fn meet(&mut self) {
        self.round += 1;
        if let Some(meeting) = self.meeting {
            meeting.wait(self.round);
        }
    }
}

impl Drop for Board<'_> {
    fn drop(&mut self) {
        if let (true, Some(meeting)) = (std::thread::panicking(), self.meeting) {
            meeting.broken.store(true, Ordering::Relaxed);
        }
    }
}

/// What is done to the own rows.
pub(crate) trait Update<T> {
    /// Does it.
    fn run<R: Rows>(self, rows: &mut R) -> T;
}

/// Lets one task per range work on `table` at once, each with its board; `ranges` are row ranges, ascending and disjoint.
/// Rows outside all ranges stay as they are. `spare` is the second buffer of several tasks.
pub(crate) fn exchange<T: Send, W: FnOnce(Board<'_>) -> T + Send>(
    table: &mut Table,
    spare: &mut Table,
    ranges: &[Range<usize>],
    tasks: Vec<W>,
) -> Vec<T> {
    assert_eq!(ranges.len(), tasks.len(), "BUG: one task per range");
    let mut end = 0;
    for range in ranges {
        assert!(range.start >= end && range.start <= range.end && range.end <= table.len(), "BUG: ranges overlap");
        end = range.end;
    }
    let alone = ranges.len() == 1;
    if !alone {
        fill_outside(table, spare, ranges);
    }
    let meeting = Meeting { members: ranges.len(), ..Meeting::default() };
    let (len, front) = (table.len(), table.as_mut_ptr());
    let back = if alone { front } else { spare.as_mut_ptr() };
    let board = |own: Range<usize>| Board {
        buffers: [front, back],
        len,
        own,
        round: 0,
        meeting: (!alone).then_some(&meeting),
        life: PhantomData,
    };
    let mut boards: Vec<_> = ranges.iter().cloned().map(board).zip(tasks).collect();
    let rest = boards.split_off(1);
    let results = std::thread::scope(|scope| {
        let handles: Vec<_> = rest.into_iter().map(|(board, task)| scope.spawn(move || task(board))).collect();
        let mut results: Vec<T> = boards.into_iter().map(|(board, task)| task(board)).collect();
        for handle in handles {
            results.push(handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        results
    });
    if meeting.arrived.load(Ordering::Acquire) / ranges.len() % 2 == 1 {
        std::mem::swap(table, spare);
    }
    results
}

/// Rows that nobody writes must be the same in both buffers.
fn fill_outside(table: &Table, spare: &mut Table, ranges: &[Range<usize>]) {
    if spare.len() != table.len() {
        *spare = Table::new(table.len());
    }
    let mut end = 0;
    for next in ranges.iter().map(|r| r.start..r.end).chain(std::iter::once(table.len()..table.len())) {
        spare[end..next.start].copy_from_slice(&table[end..next.start]);
        end = next.end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds to each own row the sum of the first components of all old rows.
    struct AddAll {
        sum: f64,
        own: Range<usize>,
    }

    impl Update<()> for AddAll {
        fn run<R: Rows>(self, rows: &mut R) {
            for k in self.own {
                let mut quad = rows.read(k);
                quad.0[0] += self.sum;
                rows.write(k, quad);
            }
        }
    }

    fn after(ranges: &[Range<usize>], steps: usize) -> Vec<f64> {
        let (mut table, mut spare) = (Table::new(16), Table::default());
        for (k, quad) in table.iter_mut().enumerate() {
            quad.0[0] = k as f64;
        }
        let task = |own: Range<usize>| {
            move |mut board: Board<'_>| {
                for _ in 0..steps {
                    let sum = board.all().iter().map(|q| q.0[0]).sum::<f64>() / 1024.0;
                    board.update(AddAll { sum, own: own.clone() });
                    board.meet();
                }
            }
        };
        exchange(&mut table, &mut spare, ranges, ranges.iter().cloned().map(task).collect());
        table.iter().map(|q| q.0[0]).collect()
    }

    #[test]
    fn threads_see_the_whole_old_state_and_write_only_their_own() {
        for steps in [1, 2, 1001] {
            let whole = 0..14;
            let alone = after(std::slice::from_ref(&whole), steps);
            assert_eq!(alone[14..], [14.0, 15.0]);
            assert_eq!(after(&[0..5, 5..14], steps), alone);
            assert_eq!(after(&[0..1, 1..2, 2..9, 9..14], steps), alone);
        }
    }

    #[test]
    #[should_panic(expected = "thread of the step panicked")]
    fn a_panic_does_not_leave_the_others_waiting() {
        let (mut table, mut spare) = (Table::new(4), Table::default());
        let task = |k: usize| {
            move |mut board: Board<'_>| {
                assert!(k == 0, "the second thread gives up");
                board.meet();
            }
        };
        exchange(&mut table, &mut spare, &[0..2, 2..4], vec![task(0), task(1)]);
    }

    #[test]
    #[should_panic(expected = "ranges overlap")]
    fn overlapping_ranges_are_refused() {
        let (mut table, mut spare) = (Table::new(4), Table::default());
        exchange(&mut table, &mut spare, &[0..3, 2..4], vec![|_: Board<'_>| (), |_: Board<'_>| ()]);
    }
}
