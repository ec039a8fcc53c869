//! The numbers that a fit is computed in: doubles for large tables, pairs of doubles for small ones.
//!
//! A [`Twofold`] is an unevaluated sum of two doubles with about 31 digits (Dekker 1971, doi:10.1007/BF01397083;
//! Joldes, Muller and Popescu 2017, doi:10.1145/3121432). Small designs cost nothing in it, and a regression whose
//! columns are nearly dependent has every digit of its data. Fused multiply-add is exact in IEEE 754, so the
//! bits are the same on every machine.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Columns that are worked on together, so that another column is read once for all of them.
pub(crate) const PANEL: usize = 4;

/// What the linear algebra needs of a number.
pub(crate) trait Real:
    Copy
    + PartialOrd
    + Send
    + Sync
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A column whose part outside the earlier ones is smaller than this share of it counts as dependent on them.
    const DEPENDENT: f64;

    /// A residual smaller than this share of the response is what this arithmetic leaves of an exact fit. The rounding
    /// of the responses themselves comes on top of it.
    const EXACT: f64;

    /// Rounded to a double.
    fn value(self) -> f64;

    /// Square root of a number ≥ 0.
    fn sqrt(self) -> Self;

    /// Zero.
    fn zero() -> Self {
        Self::from(0.0)
    }

    /// Scalar product of two columns, in a fixed order.
    fn dot(a: &[Self], b: &[Self]) -> Self {
        a.iter().zip(b).fold(Self::zero(), |sum, (&x, &y)| sum + x * y)
    }

    /// `to += factor · of`, row by row.
    fn add_multiple(to: &mut [Self], factor: Self, of: &[Self]) {
        for (t, &o) in to.iter_mut().zip(of) {
            *t = *t + factor * o;
        }
    }

    /// Scalar products of the columns of a panel with one column.
    fn dots(panel: [&[Self]; PANEL], column: &[Self]) -> [Self; PANEL] {
        panel.map(|own| Self::dot(own, column))
    }

    /// Adds a multiple of each column of a panel.
    fn add_multiples(to: &mut [Self], factors: [Self; PANEL], [a, b, c, d]: [&[Self]; PANEL]) {
        for ((((t, &a), &b), &c), &d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *t = *t + ((factors[0] * a + factors[1] * b) + (factors[2] * c + factors[3] * d));
        }
    }
}

/// Partial sums of a dot product of doubles; the order of summation is theirs, so it must never change.
const LANES: usize = 16;

impl Real for f64 {
    const DEPENDENT: f64 = 1e-11;
    const EXACT: f64 = 1e-14;

    fn value(self) -> f64 {
        self
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn dot(a: &[Self], b: &[Self]) -> Self {
        let mut sums = [0.0; LANES];
        let (a_blocks, b_blocks) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
        for (x, y) in a_blocks.0.iter().zip(b_blocks.0) {
            for lane in 0..LANES {
                sums[lane] += x[lane] * y[lane];
            }
        }
        for (lane, (x, y)) in a_blocks.1.iter().zip(b_blocks.1).enumerate() {
            sums[lane] += x * y;
        }
        let mut width = LANES / 2;
        while width > 0 {
            for lane in 0..width {
                sums[lane] += sums[lane + width];
            }
            width /= 2;
        }
        sums[0]
    }

    fn dots(panel: [&[Self]; PANEL], column: &[Self]) -> [Self; PANEL] {
        const WIDE: usize = 4;
        let (blocks, rest) = column.as_chunks::<WIDE>();
        let [a, b, c, d] = panel.map(|own| own.as_chunks::<WIDE>().0);
        let mut sums = [[0.0; WIDE]; PANEL];
        for ((((x, a), b), c), d) in blocks.iter().zip(a).zip(b).zip(c).zip(d) {
            for lane in 0..WIDE {
                sums[0][lane] += a[lane] * x[lane];
                sums[1][lane] += b[lane] * x[lane];
                sums[2][lane] += c[lane] * x[lane];
                sums[3][lane] += d[lane] * x[lane];
            }
        }
        let done = column.len() - rest.len();
        std::array::from_fn(|i| {
            let tail = panel[i][done..].iter().zip(rest).fold(0.0, |sum, (x, y)| sum + x * y);
            ((sums[i][0] + sums[i][2]) + (sums[i][1] + sums[i][3])) + tail
        })
    }
}

/// `high + low` with |low| at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Twofold {
    high: f64,
    low: f64,
}

/// The exact sum of two doubles (Knuth).
fn two_sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    let shadow = high - a;
    Twofold { high, low: (a - (high - shadow)) + (b - shadow) }
}

/// The exact sum of two doubles, the first being the larger.
fn quick_sum(a: f64, b: f64) -> Twofold {
    let high = a + b;
    Twofold { high, low: b - (high - a) }
}

impl From<f64> for Twofold {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let s = two_sum(self.high, other.high);
        let t = two_sum(self.low, other.low);
        let once = quick_sum(s.high, s.low + t.high);
        quick_sum(once.high, t.low + once.low)
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let error = self.high.mul_add(other.high, -high);
        let cross = self.low.mul_add(other.high, self.high * other.low);
        quick_sum(high, error + cross)
    }
}

impl Div for Twofold {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        quick_sum(first, second) + Self::from(rest.high / other.high)
    }
}

impl Real for Twofold {
    const DEPENDENT: f64 = 1e-13;
    const EXACT: f64 = 1e-26;

    fn value(self) -> f64 {
        self.high + self.low
    }

    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::zero();
        }
        let root = Self::from(self.high.sqrt());
        let better = root + (self - root * root) / (root + root);
        better + (self - better * better) / (better + better)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twofold_keeps_31_digits() {
        let third = Twofold::from(1.0) / Twofold::from(3.0);
        let back = third + third + third - Twofold::from(1.0);
        assert!(back.value().abs() < 1e-31, "{back:?}");
        let root = Twofold::from(2.0).sqrt();
        let error = root * root - Twofold::from(2.0);
        assert!(error.value().abs() < 1e-31, "{error:?}");
        let tiny = Twofold::from(1e16) + Twofold::from(1.0) - Twofold::from(1e16);
        assert_eq!(tiny.value(), 1.0);
    }

    #[test]
    fn both_numbers_agree_on_a_dot_product() {
        let a: Vec<f64> = (0..101).map(|i| f64::from(i) * 0.37 - 9.0).collect();
        let b: Vec<f64> = (0..101).map(|i| 1.0 / (f64::from(i) + 0.5)).collect();
        let wide = |v: &[f64]| v.iter().map(|&x| Twofold::from(x)).collect::<Vec<_>>();
        let exact = Twofold::dot(&wide(&a), &wide(&b)).value();
        assert!((f64::dot(&a, &b) - exact).abs() < 1e-13 * exact.abs());
    }
}
