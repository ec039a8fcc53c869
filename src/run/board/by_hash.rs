//! Numbers of things by the hashes of these, which stand with the things: five to eleven bytes a number, where a map from
//! hashes takes over forty. There may be a million tasks.

/// A place of the table without a number.
const FREE: u32 = u32::MAX;

/// A table of numbers, each at the first free place from the one that its hash names.
#[derive(Default)]
pub(super) struct ByHash {
    slots: Vec<u32>,
    count: usize,
}

impl ByHash {
    /// The numbers that may have this hash, among them all that do.
    pub(super) fn candidates<'a>(&'a self, hash: &[u8; 32]) -> impl Iterator<Item = usize> + use<'a> {
        let from = self.place(hash);
        let (after, before) = (self.slots.iter().skip(from), self.slots.iter().take(from));
        after.chain(before).take_while(|&&number| number != FREE).map(|&number| number as usize)
    }

    /// Adds a number; `hash_of` gives the hash of any number that was added, and of this one.
    pub(super) fn add(&mut self, number: usize, hash_of: impl Fn(usize) -> [u8; 32]) {
        if 4 * (self.count + 1) > 3 * self.slots.len() {
            let larger = (2 * self.slots.len()).max(16);
            let old = std::mem::replace(&mut self.slots, vec![FREE; larger]);
            old.into_iter().filter(|&number| number != FREE).for_each(|old| self.enter(old, &hash_of(old as usize)));
        }
        self.enter(number as u32, &hash_of(number));
        self.count += 1;
    }

    fn enter(&mut self, number: u32, hash: &[u8; 32]) {
        let (mut place, last) = (self.place(hash), self.slots.len() - 1);
        while self.slots[place] != FREE {
            place = (place + 1) & last;
        }
        self.slots[place] = number;
    }

    /// Where the search for a hash begins: there are 2ⁿ places, and hashes are even as they are.
    fn place(&self, hash: &[u8; 32]) -> usize {
        let word = hash.first_chunk().map_or(0, |first| u64::from_le_bytes(*first));
        word as usize & self.slots.len().saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every 16th hash begins as another one does, and most stand at the end of the table.
    fn hash(number: usize) -> [u8; 32] {
        let mut hash = [0xff; 32];
        hash[0] = 0xf0 | (number % 16) as u8;
        hash[8..16].copy_from_slice(&(number as u64).to_le_bytes());
        hash
    }

    #[test]
    fn every_number_is_found_among_hashes_that_begin_alike() {
        let mut numbers = ByHash::default();
        assert_eq!(numbers.candidates(&hash(0)).count(), 0);
        for number in 0..300 {
            numbers.add(number, hash);
            let found = |of: usize| numbers.candidates(&hash(of)).filter(|&other| hash(other) == hash(of)).count();
            assert_eq!((found(0), found(number / 2), found(number), found(number + 1)), (1, 1, 1, 0));
        }
    }
}
