//! Faults of a workflow: what was found, where, what was expected, what to do.

use crate::stage::Missing;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text that faults point into: the workflow file, or the text of a `--set` option.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's name as it was given, or `--set`.
    pub name: String,
    /// The whole text.
    pub text: String,
}

/// A stretch of a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The text it lies in.
    pub source: Arc<Source>,
    /// Bytes of the text, on character boundaries.
    pub span: Range<usize>,
}

impl Location {
    /// Line and column of its first character, counted from 1, the column in characters.
    pub fn line_column(&self) -> (usize, usize) {
        let before = &self.source.text[..self.span.start];
        let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        (line, column)
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_column();
        write!(f, "{}:{line}:{column}", self.source.name)
    }
}

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", self.location.as_ref().map(|location| format!("{location}: ")).unwrap_or_default())]
pub struct Fault {
    /// Where; `None` for a file that cannot be read at all.
    pub location: Option<Location>,
    /// What was found and what was expected.
    pub message: String,
    /// A few words at the location itself.
    pub label: Option<String>,
    /// What to do.
    pub hint: Option<String>,
    /// Other locations that belong to it, with a few words each.
    pub also: Vec<(Location, String)>,
    /// What is not there, if it is about that.
    pub missing: Option<Box<Missing>>,
}

impl Fault {
    /// A fault without a location.
    pub fn new(message: impl Into<String>) -> Self {
        Self { location: None, message: message.into(), label: None, hint: None, also: Vec::new(), missing: None }
    }

    /// Says where.
    #[must_use]
    pub fn at(mut self, location: Location) -> Self {
        self.location = Some(location);
        self
    }

    /// Adds a few words at the location.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }

    /// Adds what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds another location that belongs to it.
    #[must_use]
    pub fn also(mut self, location: Location, words: impl Into<String>) -> Self {
        self.also.push((location, words.into()));
        self
    }

    /// Adds the known alternatives to the unknown name `found`, and the one that was probably meant.
    #[must_use]
    pub fn known<'a>(self, found: &str, what: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let listed = match known.len() {
            0 => format!("there are no {what}"),
            n if n > MOST_LISTED => format!("known {what}: {}, … ({n} in all)", quoted(&known[..MOST_LISTED])),
            _ => format!("known {what}: {}", quoted(&known)),
        };
        match nearest(found, known.iter().copied()) {
            Some(near) => self.label(format!("did you mean `{near}`?")).hint(listed),
            None => self.hint(listed),
        }
    }
}

const MOST_LISTED: usize = 30;

fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// The known name that differs from `found` by few enough letters to be a slip.
pub fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 64;
    if found.len() > LONGEST {
        return None;
    }
    let found: Vec<char> = found.to_lowercase().chars().collect();
    let slip = |name: &str| {
        let name: Vec<char> = name.to_lowercase().chars().take(LONGEST).collect();
        let most = found.len().max(name.len()).div_ceil(3);
        let distance = distance(&found, &name);
        (distance <= most && distance < name.len()).then_some(distance)
    };
    let known: Vec<&str> = known.into_iter().collect();
    let near = known.iter().filter_map(|name| Some((slip(name)?, *name))).min_by_key(|(distance, _)| *distance);
    near.map(|(_, name)| name).or_else(|| {
        // `boxplot` for `box`, `hist` for `histogram`, where one name alone begins so
        let found: String = found.iter().collect();
        let begins = |long: &str, short: &str| short.chars().count() >= 3 && long.starts_with(short);
        let mut like =
            known.iter().filter(|name| begins(&found, &name.to_lowercase()) || begins(&name.to_lowercase(), &found));
        like.next().filter(|_| like.next().is_none()).copied()
    })
}

/// Letters to insert, remove, replace or swap with the next one (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    let width = b.len() + 1;
    let mut cost = vec![0; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            cost[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let at = |i: usize, j: usize| cost[i * width + j];
                let replaced = at(i - 1, j - 1) + usize::from(a[i - 1] != b[j - 1]);
                let mut least = replaced.min(at(i - 1, j) + 1).min(at(i, j - 1) + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    least = least.min(at(i - 2, j - 2) + 1);
                }
                least
            };
        }
    }
    cost[a.len() * width + b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        let known = ["specimen", "simulate", "alpha", "levels"];
        assert_eq!(nearest("speicmen", known), Some("specimen"));
        assert_eq!(nearest("Alpha", known), Some("alpha"));
        assert_eq!(nearest("level", known), Some("levels"));
        assert_eq!(nearest("table", known), None);
        assert_eq!(nearest("", known), None);
        assert_eq!(nearest(&"x".repeat(100_000), known), None);
    }

    #[test]
    fn lines_and_columns_count_from_one_in_characters() {
        let source = Arc::new(Source { name: "w.toml".into(), text: "a\nσ = 1".into() });
        let location = |span| Location { source: Arc::clone(&source), span };
        assert_eq!(location(0..1).line_column(), (1, 1));
        assert_eq!(location(5..6).line_column(), (2, 3));
        assert_eq!(Fault::new("no").at(location(8..8)).to_string(), "w.toml:2:6: no");
    }
}
