//! One row of the validation page: what was computed, where the expectation comes from, and how near it must be.

use std::fmt::Write;
use std::sync::LazyLock;

/// How near is near enough.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Near {
    /// |got/expected − 1| at most.
    Relative(f64),
    /// |got − expected| at most.
    Absolute(f64),
    /// The same bits.
    Exact,
    /// Got is at most what is expected.
    Below,
    /// Got is at least what is expected.
    Above,
}

/// One computed number.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) name: String,
    /// Equation or source.
    pub(crate) source: &'static str,
    pub(crate) expected: f64,
    pub(crate) got: f64,
    pub(crate) near: Near,
}

impl Case {
    pub(crate) fn new(name: impl Into<String>, source: &'static str, expected: f64, got: f64, near: Near) -> Self {
        Self { name: name.into(), source, expected, got, near }
    }

    /// Whether the number is as near as it must be. A number that is none never is.
    pub(crate) fn holds(&self) -> bool {
        let off = (self.got - self.expected).abs();
        match self.near {
            Near::Relative(share) => off <= share * self.expected.abs(),
            Near::Absolute(size) => off <= size,
            Near::Exact => self.got.to_bits() == self.expected.to_bits(),
            Near::Below => self.got <= self.expected,
            Near::Above => self.got >= self.expected,
        }
    }

    fn row(&self) -> String {
        let share = (self.got / self.expected - 1.0).abs();
        let (off, allowed) = match self.near {
            Near::Relative(allowed) => (short(share), short(allowed)),
            Near::Absolute(allowed) => {
                (short((self.got - self.expected).abs()), format!("{} absolute", short(allowed)))
            }
            Near::Exact => ("none".to_owned(), "same bits".to_owned()),
            Near::Below => ("–".to_owned(), "at most".to_owned()),
            Near::Above => ("–".to_owned(), "at least".to_owned()),
        };
        format!(
            "| {} | {} | {} | {} | {off} | {allowed} |",
            self.name,
            self.source,
            long(self.expected),
            long(self.got)
        )
    }
}

/// Cases of one kind, computed once whoever asks first.
pub(crate) struct Family {
    pub(crate) title: &'static str,
    pub(crate) about: &'static str,
    pub(crate) cases: &'static LazyLock<Vec<Case>>,
}

impl Family {
    /// Fails with every case that does not hold.
    pub(crate) fn check(&self) {
        let bad: Vec<String> = self.cases.iter().filter(|case| !case.holds()).map(Case::row).collect();
        assert!(bad.is_empty(), "{}:\n{}", self.title, bad.join("\n"));
        assert!(!self.cases.is_empty(), "{} has no case", self.title);
    }

    /// Its section of the page.
    pub(crate) fn section(&self) -> String {
        let mut text = format!("\n## {}\n\n{}\n\n", self.title, self.about);
        text.push_str("| case | source | expected | got | off | allowed |\n|---|---|---|---|---|---|\n");
        for case in self.cases.iter() {
            let _ = writeln!(text, "{}", case.row());
        }
        text
    }
}

/// Five digits.
fn long(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1e-3..1e5).contains(&size) {
        let whole = size.trunc().to_string().len() - 1;
        let text = format!("{x:.*}", if size >= 1.0 { 4 - whole.min(4) } else { 6 });
        let plain = text.trim_end_matches('0').trim_end_matches('.');
        return if text.contains('.') { plain.to_owned() } else { text };
    }
    format!("{x:.4e}")
}

/// One digit: of a deviation only the size is of interest.
fn short(x: f64) -> String {
    if x == 0.0 { "0".to_owned() } else { format!("{x:.0e}") }
}
