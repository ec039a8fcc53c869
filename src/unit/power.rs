//! Exponents of units: small fractions, so that `m^0.5 · m^0.5` is exactly `m` and `m^(1/3)` is no decimal.

/// Largest exponent that is read; a creep law has about 5, subcritical crack growth up to 60.
const LARGEST: i64 = 60;

/// Largest denominator that is written: four decimals.
const FINEST: i64 = 10_000;

/// Largest denominator of a sum.
const FINEST_SUM: i64 = 1_000_000;

/// A fraction in lowest terms, its denominator positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Power {
    numerator: i64,
    denominator: i64,
}

impl Power {
    /// A whole exponent.
    pub(super) const fn whole(number: i8) -> Self {
        Self { numerator: number as i64, denominator: 1 }
    }

    /// The exponent of `√`.
    pub(super) const HALF: Self = Self { numerator: 1, denominator: 2 };

    /// In lowest terms; `None` beyond what the bounds above allow.
    fn new(numerator: i64, denominator: i64, finest: i64) -> Option<Self> {
        if denominator == 0 {
            return None;
        }
        let common = i64::try_from(gcd(numerator.unsigned_abs(), denominator.unsigned_abs())).ok()?;
        let sign = denominator.signum();
        let (numerator, denominator) = (sign * numerator / common, sign * denominator / common);
        let within = denominator <= finest && numerator.abs() <= LARGEST * denominator;
        within.then_some(Self { numerator, denominator })
    }

    /// The sum.
    pub(super) fn plus(self, other: Self) -> Option<Self> {
        let numerator = self.numerator * other.denominator + other.numerator * self.denominator;
        Self::new(numerator, self.denominator * other.denominator, FINEST_SUM)
    }

    /// The product.
    pub(super) fn times(self, other: Self) -> Option<Self> {
        Self::new(self.numerator * other.numerator, self.denominator * other.denominator, FINEST_SUM)
    }

    /// Reads `2`, `-1`, `0.5` or `1/3`.
    pub(super) fn read(text: &str) -> Option<Self> {
        let (above, below) = text.split_once('/').map_or((text, None), |(above, below)| (above, Some(below)));
        let above = decimal(above.trim())?;
        let Some(below) = below else { return Some(above) };
        let below = decimal(below.trim())?;
        Self::new(above.numerator * below.denominator, above.denominator * below.numerator, FINEST)
    }

    /// `base` to this power.
    pub(super) fn of(self, base: f64) -> f64 {
        let whole = |base: f64| i32::try_from(self.numerator).map_or(f64::NAN, |power| base.powi(power));
        match self.denominator {
            1 => whole(base),
            2 => whole(base.sqrt()),
            _ => math::elementary::pow(base, self.numerator as f64 / self.denominator as f64),
        }
    }
}

impl std::fmt::Display for Power {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            _ => write!(f, "({}/{})", self.numerator, self.denominator),
        }
    }
}

/// Reads a sign, digits and at most four decimals.
fn decimal(text: &str) -> Option<Power> {
    let (sign, digits) = match text.strip_prefix(['-', '−']) {
        Some(rest) => (-1, rest),
        None => (1, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, decimals) = digits.split_once('.').unwrap_or((digits, ""));
    let all = [whole, decimals].concat();
    if all.is_empty() || all.len() > 12 || !all.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let denominator = 10_i64.checked_pow(u32::try_from(decimals.len()).ok()?)?;
    Power::new(sign * all.parse::<i64>().ok()?, denominator, FINEST)
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
