//! Arithmetic of the finite fields GF(q), q a prime power up to 27.
//!
//! An element is a number 0 … q − 1 whose base-p digits are the coefficients of a polynomial, lowest power first; 0 and
//! 1 are the neutral elements. Products are reduced by the polynomial listed for q (Lidl & Niederreiter 1997, *Finite
//! Fields*, doi:10.1017/CBO9780511525926).

/// Prime, degree and the reducing monic polynomial without its leading term (coefficients of 1, x, x², …).
const PRIME_POWERS: &[(usize, usize, &[usize])] =
    &[(2, 2, &[1, 1]), (2, 3, &[1, 1, 0]), (3, 2, &[2, 1]), (2, 4, &[1, 1, 0, 0]), (5, 2, &[2, 1]), (3, 3, &[1, 2, 0])];

/// Primes that are used as they are.
const PRIMES: &[usize] = &[2, 3, 5, 7, 11, 13, 17, 19, 23];

/// A finite field with its tables of sums and products.
#[derive(Clone, Debug)]
pub(super) struct Field {
    order: usize,
    sum: Vec<usize>,
    product: Vec<usize>,
}

impl Field {
    /// The field of `order` elements, if there is one here.
    pub(super) fn new(order: usize) -> Option<Self> {
        let prime = PRIMES.iter().find(|&&p| p == order).map(|&p| (p, 1, [0].as_slice()));
        let power = PRIME_POWERS.iter().find(|(p, n, _)| p.pow(*n as u32) == order);
        let (p, n, reduce) = prime.or(power.copied())?;
        let digits = |a: usize| -> Vec<usize> { (0..n).map(|k| a / p.pow(k as u32) % p).collect() };
        let number = |digits: &[usize]| digits.iter().rev().fold(0, |a, d| a * p + d);
        let add = |a: usize, b: usize| {
            let (a, b) = (digits(a), digits(b));
            number(&a.iter().zip(&b).map(|(x, y)| (x + y) % p).collect::<Vec<_>>())
        };
        let multiply = |a: usize, b: usize| {
            let mut long = vec![0; 2 * n];
            for (i, x) in digits(a).iter().enumerate() {
                for (j, y) in digits(b).iter().enumerate() {
                    long[i + j] = (long[i + j] + x * y) % p;
                }
            }
            for top in (n..2 * n).rev() {
                let lead = std::mem::take(&mut long[top]);
                for (k, r) in reduce.iter().enumerate() {
                    long[top - n + k] = (long[top - n + k] + lead * (p - r)) % p;
                }
            }
            number(&long[..n])
        };
        let table = |f: &dyn Fn(usize, usize) -> usize| -> Vec<usize> {
            (0..order * order).map(|i| f(i / order, i % order)).collect()
        };
        Some(Self { order, sum: table(&add), product: table(&multiply) })
    }

    /// Number of elements.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// a + b.
    pub(super) fn add(&self, a: usize, b: usize) -> usize {
        self.sum[a * self.order + b]
    }

    /// a · b.
    pub(super) fn mul(&self, a: usize, b: usize) -> usize {
        self.product[a * self.order + b]
    }

    /// −a.
    pub(super) fn negative(&self, a: usize) -> usize {
        (0..self.order).find(|&b| self.add(a, b) == 0).unwrap_or_else(|| panic!("BUG: no negative of {a}"))
    }

    /// 1 / a, for a ≠ 0.
    pub(super) fn inverse(&self, a: usize) -> usize {
        (1..self.order).find(|&b| self.mul(a, b) == 1).unwrap_or_else(|| panic!("BUG: no inverse of {a}"))
    }

    /// Whether a is the square of an element other than 0.
    pub(super) fn is_square(&self, a: usize) -> bool {
        (1..self.order).any(|b| self.mul(b, b) == a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn field_axioms_hold_for_every_order() {
        for q in [2, 3, 4, 5, 7, 8, 9, 11, 13, 16, 17, 19, 23, 25, 27] {
            let f = Field::new(q).unwrap();
            for a in 0..q {
                assert_eq!((f.add(a, 0), f.mul(a, 1), f.mul(a, 0), f.add(a, f.negative(a))), (a, a, 0, 0));
                assert!(a == 0 || f.mul(a, f.inverse(a)) == 1);
                for b in 0..q {
                    assert_eq!((f.add(a, b), f.mul(a, b)), (f.add(b, a), f.mul(b, a)));
                    assert!(a == 0 || b == 0 || f.mul(a, b) != 0, "GF({q}) has divisors of zero");
                    for c in 0..q {
                        assert_eq!(f.mul(a, f.add(b, c)), f.add(f.mul(a, b), f.mul(a, c)));
                        assert_eq!(f.mul(a, f.mul(b, c)), f.mul(f.mul(a, b), c));
                        assert_eq!(f.add(a, f.add(b, c)), f.add(f.add(a, b), c));
                    }
                }
            }
            let squares = (1..q).filter(|&a| f.is_square(a)).count();
            assert_eq!(squares, if q % 2 == 0 { q - 1 } else { (q - 1) / 2 });
        }
        assert!([1, 6, 10, 12, 14, 15].iter().all(|&q| Field::new(q).is_none()));
    }

    /// Cayley table of GF(4) as printed everywhere: with a = 2, a² = a + 1 = 3.
    #[test]
    fn gf4_is_the_printed_table() {
        let f = Field::new(4).unwrap();
        assert_eq!((f.mul(2, 2), f.mul(2, 3), f.mul(3, 3), f.add(2, 3), f.add(1, 1)), (3, 1, 2, 1, 0));
    }
}
