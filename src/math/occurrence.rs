//! Which of equal rows each row is.

/// The occurrence of each row among those equal to it, from 1, in the order of the table. Rows are their bits, `width` words each;
/// rows of no width are all equal.
pub fn occurrences(words: &[u64], width: usize, rows: usize) -> Vec<u64> {
    assert_eq!(words.len(), width * rows, "BUG: rows of another width");
    let row = |place: usize| &words[place * width..(place + 1) * width];
    let mut order: Vec<usize> = (0..rows).collect();
    // Stable, so that equal rows stay in the order given; designs are sorted as a rule, and then it is one pass.
    order.sort_by(|&a, &b| row(a).cmp(row(b)));
    let mut found = vec![1; rows];
    for pair in order.windows(2).filter(|pair| row(pair[0]) == row(pair[1])) {
        found[pair[1]] = found[pair[0]] + 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::occurrences;

    #[test]
    fn equal_rows_are_numbered_in_the_order_given() {
        assert_eq!(occurrences(&[5, 1, 5, 2, 5, 1, 3, 3, 5, 1], 2, 5), [1, 1, 2, 1, 3]);
        assert_eq!(occurrences(&[9, 7, 9, 9], 1, 4), [1, 1, 2, 3]);
        assert_eq!(occurrences(&[], 0, 3), [1, 2, 3]);
        assert!(occurrences(&[], 4, 0).is_empty());
    }
}
