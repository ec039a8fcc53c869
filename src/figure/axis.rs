//! Axes: positions and labels of the ticks, and the position of a value between the ends.
//!
//! Linear ticks are 1, 2, 2.5 or 5 times a power of ten; logarithmic ones are powers of ten with 2 … 9 as minor
//! ticks (labelled too when the axis holds less than two powers). Large and small numbers have a power of ten, `4×10⁶`.
//! Where labels would be longer than [`LONGEST`] characters, their common part goes into the title: a power of ten, or an
//! offset, `σ / MPa (+100000)`.

use math::elementary::{log10, pow};

/// Most characters of a label before the part that all labels share goes into the title.
const LONGEST: usize = 7;

/// Labels whose span is less than this fraction of the largest share leading digits.
const SHARED: f64 = 0.02;

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal ratios; values must be above zero.
    Log,
}

/// A labelled position on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Value.
    pub at: f64,
    /// Label in the markup of [`super::text`]; may be empty.
    pub label: String,
}

/// One axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Title with its unit, in the markup of [`super::text`].
    pub label: String,
    /// The part that all labels of ticks share, in the same markup; it is appended to the title. Mostly empty.
    pub common: String,
    /// Spread of the values.
    pub scale: Scale,
    /// Value at the start.
    pub low: f64,
    /// Value at the end.
    pub high: f64,
    /// Labelled ticks.
    pub ticks: Vec<Tick>,
    /// Ticks without label.
    pub minor: Vec<f64>,
    /// Whether lines run across the panel at the ticks.
    pub grid: bool,
}

impl Axis {
    /// From `low` to `high` exactly, with about `want` labelled ticks.
    pub fn between(label: impl Into<String>, scale: Scale, low: f64, high: f64, want: usize) -> Self {
        let (low, high) = widened(scale, low, high);
        let (ticks, minor) = match scale {
            Scale::Linear => linear_ticks(low, high, want),
            Scale::Log => log_ticks(low, high, want),
        };
        Self { label: label.into(), common: String::new(), scale, low, high, ticks, minor, grid: true }.shortened()
    }

    /// The title with the part that all labels share.
    pub fn title(&self) -> String {
        if self.label.is_empty() || self.common.is_empty() {
            self.label.clone()
        } else {
            format!("{} ({})", self.label, self.common)
        }
    }

    /// Moves a common offset or power of ten from long labels into the title.
    fn shortened(mut self) -> Self {
        self.common.clear();
        let long = self.ticks.iter().any(|tick| signs(&tick.label) > LONGEST);
        if !long || self.scale == Scale::Log || self.label.is_empty() || self.ticks.len() < 2 {
            return self;
        }
        let at: Vec<f64> = self.ticks.iter().map(|tick| tick.at).collect();
        let step = at.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(f64::INFINITY, f64::min);
        let span = at[at.len() - 1] - at[0];
        let largest = at.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if !(step > 0.0 && span.is_finite() && largest.is_finite()) {
            return self;
        }
        let place = power_of_ten(log10(span).ceil() as i32);
        let base = if span < SHARED * largest { (at[0] / place).floor() * place } else { 0.0 };
        let greatest = at.iter().fold(0.0, |greatest: f64, value| greatest.max((value - base).abs()));
        let exponent = if (1e-2..1e4).contains(&greatest) { 0 } else { log10(greatest).floor() as i32 };
        let unit = power_of_ten(exponent);
        let places = at.iter().map(|value| decimals((value - base).abs().max(step) / unit)).max().unwrap_or(0);
        let places = places.min(decimals(step / unit) + 1).min(LONGEST - 2);
        for tick in &mut self.ticks {
            tick.label = fixed((tick.at - base) / unit, places);
        }
        let number = fixed(base.abs(), decimals(place));
        let short = number.trim_end_matches('0').trim_end_matches('.');
        let zeros = number.len() - number.trim_end_matches('0').len();
        let number = match number.contains('.') {
            true => short.to_owned(),
            false if number.len() > LONGEST => format!("{}×$10^{{{zeros}}}$", &number[..number.len() - zeros]),
            false => number,
        };
        let above = match (base == 0.0, base > 0.0, number) {
            (true, ..) => String::new(),
            (_, true, number) => format!("+{number}"),
            (_, false, number) => format!("−{number}"),
        };
        let power = if exponent == 0 { String::new() } else { format!("×$10^{{{exponent}}}$") };
        self.common = [power, above].iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join(", ");
        self
    }

    /// Around all finite values, with a margin of 5 % on both sides.
    pub fn around(label: impl Into<String>, scale: Scale, values: impl IntoIterator<Item = f64>, want: usize) -> Self {
        let (low, high) = extent(values.into_iter().filter(|v| scale == Scale::Linear || *v > 0.0));
        let (low, high) = match scale {
            Scale::Linear => (low - 0.05 * (high - low), high + 0.05 * (high - low)),
            Scale::Log => {
                let margin = pow(high / low, 0.05);
                (low / margin, high * margin)
            }
        };
        Self::between(label, scale, low, high, want)
    }

    /// From zero to a little above the largest value.
    pub fn from_zero(label: impl Into<String>, values: impl IntoIterator<Item = f64>, want: usize) -> Self {
        let (_, high) = extent(values.into_iter().chain([0.0]));
        Self::between(label, Scale::Linear, 0.0, if high > 0.0 { 1.06 * high } else { 1.0 }, want)
    }

    /// One labelled position per category at 0, 1, 2 …, without lines across.
    pub fn categories(label: impl Into<String>, names: &[String]) -> Self {
        let ticks = names.iter().enumerate().map(|(i, n)| Tick { at: i as f64, label: n.clone() }).collect();
        let high = names.len() as f64 - 0.5;
        let (common, scale) = (String::new(), Scale::Linear);
        Self { label: label.into(), common, scale, low: -0.5, high, ticks, minor: Vec::new(), grid: false }
    }

    /// The same axis without lines across.
    pub fn without_grid(mut self) -> Self {
        self.grid = false;
        self
    }

    /// Ticks at the given values only, such as the levels of a factor.
    pub fn with_ticks_at(mut self, values: &[f64]) -> Self {
        let step = values.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min);
        let step = if step.is_finite() && step > 0.0 { step } else { (self.high - self.low).abs() / 4.0 };
        self.ticks = values.iter().map(|&at| Tick { at, label: shortest(at, step) }).collect();
        self.minor = Vec::new();
        self.shortened()
    }

    /// Position of a value: 0 at the start of the axis, 1 at its end.
    pub fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => {
                let (low, high) = (log10(self.low), log10(self.high));
                (log10(value.max(f64::MIN_POSITIVE)) - low) / (high - low)
            }
        }
    }

    /// Whether a value lies between the ends.
    pub fn holds(&self, value: f64) -> bool {
        value.is_finite() && self.low <= value && value <= self.high
    }
}

/// Smallest and largest finite value; (0, 1) when there is none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// An axis needs a length: a single value gets room on both sides.
fn widened(scale: Scale, low: f64, high: f64) -> (f64, f64) {
    let (low, high) = if low.is_finite() && high.is_finite() { (low.min(high), low.max(high)) } else { (0.0, 1.0) };
    match scale {
        Scale::Linear if high - low > 1e-12 * high.abs().max(low.abs()) => (low, high),
        Scale::Linear if low == 0.0 && high == 0.0 => (0.0, 1.0),
        Scale::Linear => (low - 0.1 * low.abs().max(1e-12), high + 0.1 * high.abs().max(1e-12)),
        Scale::Log => {
            let high = high.max(f64::MIN_POSITIVE * 1e6);
            let low = if low > 0.0 { low } else { high * 1e-3 };
            if high > low * 1.001 { (low, high) } else { (low / 2.0, high * 2.0) }
        }
    }
}

/// The step among 1, 2, 2.5, 5 × 10ⁿ whose number of ticks is nearest to `want`.
fn nice_step(length: f64, want: usize) -> f64 {
    let rough = length / want.max(1) as f64;
    let power = log10(rough).floor() as i32;
    let mut best = (f64::INFINITY, rough);
    for exponent in power - 1..=power + 1 {
        for mantissa in [1.0, 2.0, 2.5, 5.0] {
            let step = mantissa * power_of_ten(exponent);
            let cost = (length / step - want as f64).abs() + if mantissa == 2.5 { 0.4 } else { 0.0 };
            if cost < best.0 {
                best = (cost, step);
            }
        }
    }
    best.1
}

/// A power of ten: exact where a double holds it exactly, correctly rounded for its inverse.
fn power_of_ten(exponent: i32) -> f64 {
    if exponent >= 0 { pow(10.0, f64::from(exponent)) } else { 1.0 / pow(10.0, f64::from(-exponent)) }
}

fn multiples(low: f64, high: f64, step: f64) -> Vec<f64> {
    let slack = 1e-9 * (high - low);
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    // A division keeps 0.3 = 3/10 exact where a product gives 0.30000000000000004.
    let inverse = (1.0 / step).round();
    let exact = step < 1.0 && (inverse * step - 1.0).abs() < 1e-12;
    (first..=last).map(|i| if exact { i as f64 / inverse } else { i as f64 * step }).collect()
}

fn linear_ticks(low: f64, high: f64, want: usize) -> (Vec<Tick>, Vec<f64>) {
    // An axis is read between two ticks: a step that leaves only one inside is too long.
    let enough = |step: &f64| multiples(low, high, *step).len() >= 2;
    let mut steps = (want..4 * want.max(1)).map(|want| nice_step(high - low, want));
    let step = steps.find(enough).unwrap_or_else(|| nice_step(high - low, want));
    let at = multiples(low, high, step);
    let lead = step / power_of_ten(log10(step).floor() as i32);
    let parts = if (lead - 2.0).abs() < 0.01 { 4.0 } else { 5.0 };
    let minor = multiples(low, high, step / parts)
        .into_iter()
        .filter(|m| at.iter().all(|a| (a - m).abs() > 1e-6 * step))
        .collect();
    (at.into_iter().map(|at| Tick { at, label: tick_label(at, step, low.abs().max(high.abs())) }).collect(), minor)
}

fn log_ticks(low: f64, high: f64, want: usize) -> (Vec<Tick>, Vec<f64>) {
    let inside = |v: f64| v >= low * (1.0 - 1e-9) && v <= high * (1.0 + 1e-9);
    let (first, last) = (log10(low).floor() as i32, log10(high).ceil() as i32);
    let powers: Vec<i32> = (first..=last).filter(|&e| inside(power_of_ten(e))).collect();
    let every = (powers.len() / want.max(1)).max(1) as i32;
    let few = powers.len() < 2;
    let plain = powers.iter().all(|e| (-2..=3).contains(e));
    let (mut ticks, mut minor) = (Vec::new(), Vec::new());
    for exponent in first..=last {
        for m in 1..=9 {
            let at = f64::from(m) * power_of_ten(exponent);
            let labelled = if few { [1, 2, 5].contains(&m) } else { m == 1 && exponent.rem_euclid(every) == 0 };
            match (inside(at), labelled) {
                (true, true) => ticks.push(Tick { at, label: power_label(at, m, exponent, plain) }),
                (true, false) if every == 1 || m == 1 => minor.push(at),
                _ => {}
            }
        }
    }
    (ticks, minor)
}

fn power_label(at: f64, m: i32, exponent: i32, plain: bool) -> String {
    match m {
        _ if plain || exponent == 0 => shortest(at, at),
        1 => format!("$10^{{{exponent}}}$"),
        _ => format!("{m}×$10^{{{exponent}}}$"),
    }
}

/// Label of a linear tick: as many decimals as the step has; powers of ten beyond 10⁵ and below 10⁻³.
fn tick_label(at: f64, step: f64, largest: f64) -> String {
    if at == 0.0 {
        return "0".into();
    }
    if !(1e-2..1e5).contains(&largest) {
        let exponent = log10(largest).floor() as i32;
        let unit = power_of_ten(exponent);
        return format!("{}×$10^{{{exponent}}}$", shortest(at / unit, step / unit));
    }
    fixed(at, decimals(step))
}

/// Number of decimals that distinguish multiples of `step`.
fn decimals(step: f64) -> usize {
    (0..12)
        .find(|&d| {
            let scaled = step * power_of_ten(d);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .unwrap_or(12) as usize
}

fn shortest(value: f64, step: f64) -> String {
    let digits = decimals(step).max(decimals(value.abs().max(1e-300))).min(decimals(step) + 3);
    fixed(value, digits)
}

/// Number of visible characters of a label.
fn signs(label: &str) -> usize {
    label.chars().filter(|c| !"${}^".contains(*c)).count()
}

/// A number with fixed decimals and a true minus sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|b| b"-0.".contains(&b));
    match text.strip_prefix('-') {
        Some(rest) if zero => rest.into(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// A number with this many significant digits, for annotations.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return fixed(value, 0);
    }
    let exponent = log10(value.abs()).floor() as i32;
    if !(-4..=5).contains(&exponent) {
        return format!("{}×$10^{{{exponent}}}$", fixed(value / power_of_ten(exponent), digits.saturating_sub(1)));
    }
    fixed(value, (digits as i32 - 1 - exponent).max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|t| t.label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        let axis = Axis::between("x", Scale::Linear, 0.0, 62.09, 5);
        assert_eq!(labels(&axis), ["0", "10", "20", "30", "40", "50", "60"]);
        let axis = Axis::between("x", Scale::Linear, 0.083, 0.37, 5);
        assert_eq!(labels(&axis), ["0.10", "0.15", "0.20", "0.25", "0.30", "0.35"]);
        let axis = Axis::between("x", Scale::Linear, -1.0, 1.0, 4);
        assert_eq!(labels(&axis), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(
            labels(&Axis::between("x", Scale::Linear, 0.0, 4.0e7, 4)),
            ["0", "1×$10^{7}$", "2×$10^{7}$", "3×$10^{7}$", "4×$10^{7}$"]
        );
    }

    #[test]
    fn log_ticks_are_powers() {
        let axis = Axis::between("x", Scale::Log, 1e-6, 1.0, 7);
        assert_eq!(labels(&axis), ["$10^{-6}$", "$10^{-5}$", "$10^{-4}$", "$10^{-3}$", "$10^{-2}$", "$10^{-1}$", "1"]);
        assert_eq!(labels(&Axis::between("x", Scale::Log, 15.0, 90.0, 4)), ["20", "50"]);
        assert!((axis.fraction(1e-3) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn levels_and_degenerate_ranges() {
        assert_eq!(
            labels(&Axis::between("x", Scale::Linear, 0.7, 4.3, 3).with_ticks_at(&[1.0, 2.5, 4.0])),
            ["1.0", "2.5", "4.0"]
        );
        let flat = Axis::around("x", Scale::Linear, [3.0, 3.0], 4);
        assert!(flat.low < 3.0 && flat.high > 3.0 && !flat.ticks.is_empty());
        let none = Axis::around("x", Scale::Linear, [f64::NAN], 4);
        assert!(none.low < none.high);
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(significant(0.012345, 3), "0.0123");
    }

    /// Labels of an experiment whose factor is 100000, 100000.5 and 100001 Pa, and of responses far from zero.
    #[test]
    fn what_long_labels_share_goes_into_the_title() {
        let axis = Axis::between("p / Pa", Scale::Linear, 99_999.9, 100_001.1, 3);
        let axis = axis.with_ticks_at(&[100_000.0, 100_000.5, 100_001.0]);
        assert_eq!(labels(&axis), ["0.0", "0.5", "1.0"]);
        assert_eq!(axis.title(), "p / Pa (+100000)");
        let axis = Axis::between("y", Scale::Linear, -3.0e9, -1.0e9, 5);
        assert_eq!(axis.title(), "y (×$10^{9}$)");
        assert!(labels(&axis).contains(&"−2.0") || labels(&axis).contains(&"−2"), "{:?}", labels(&axis));
        let axis = Axis::between("y", Scale::Linear, 5.000_000_01, 5.000_000_03, 4);
        assert!(labels(&axis).iter().all(|label| signs(label) <= LONGEST), "{:?}", labels(&axis));
        assert_eq!(axis.title(), "y (×$10^{-8}$, +5)");
        // Without a title there is nowhere to say it.
        assert_eq!(Axis::between("", Scale::Linear, 100_000.1, 100_000.3, 4).common, "");
    }

    proptest::proptest! {
        #![proptest_config(proptest::test_runner::Config { failure_persistence: None, ..Default::default() })]
        /// A reader finds the value of a tick again from its label and what the title adds.
        #[test]
        fn labels_and_title_give_the_value(centre in -1e12..1e12f64, exponent in -9i32..3, want in 3usize..8) {
            let span = centre.abs() * pow(10.0, f64::from(exponent));
            proptest::prop_assume!(span > 1e-9);
            let axis = Axis::between("x", Scale::Linear, centre, centre + span, want);
            let number = |text: &str| {
                let text = text.replace('−', "-");
                let Some((digits, power)) = text.split_once("×$10^{") else { return text.parse::<f64>() };
                let power = power.trim_end_matches("}$").parse::<i32>().unwrap();
                Ok(digits.parse::<f64>()? * power_of_ten(power))
            };
            let (mut power, mut base) = (0, 0.0);
            for part in axis.common.split(", ").filter(|part| !part.is_empty()) {
                match part.strip_prefix("×$10^{") {
                    Some(rest) => power = rest.trim_end_matches("}$").parse::<i32>().unwrap(),
                    None => base = number(part).unwrap(),
                }
            }
            let mut seen = std::collections::BTreeSet::new();
            for tick in &axis.ticks {
                proptest::prop_assert!(seen.insert(tick.label.clone()), "{:?} {}", axis.ticks, axis.common);
                if let Ok(label) = number(&tick.label) {
                    let value = base + label * power_of_ten(power);
                    proptest::prop_assert!((value - tick.at).abs() < 0.51 * span / axis.ticks.len() as f64, "{value} {tick:?} {}", axis.common);
                }
            }
        }
    }

    /// Found by chance: a range of which the round numbers gave one tick.
    #[test]
    fn a_range_between_round_numbers_has_two_ticks() {
        let low = -980_840.928_315_904_1;
        let axis = Axis::between("x", Scale::Linear, low, low + 935_353.384_523_406_4, 3);
        assert!((2..=7).contains(&axis.ticks.len()), "{:?}", axis.ticks);
    }

    proptest::proptest! {
        #![proptest_config(proptest::test_runner::Config { failure_persistence: None, ..Default::default() })]
        #[test]
        fn ticks_lie_inside_and_are_few(low in -1e6..1e6f64, length in 1e-6..1e6f64, want in 3usize..9) {
            let axis = Axis::between("x", Scale::Linear, low, low + length, want);
            proptest::prop_assert!((2..=2 * want + 1).contains(&axis.ticks.len()), "{:?}", axis.ticks);
            proptest::prop_assert!(axis.ticks.iter().all(|t| (-1e-6..=1.0 + 1e-6).contains(&axis.fraction(t.at))));
        }
    }
}
