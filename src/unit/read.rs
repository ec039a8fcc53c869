//! The grammar of units.
//!
//! ```text
//! unit   = part { "/" part }                      what follows a "/" divides, up to the next "/"
//! part   = factor { [ "*" | "·" | " " ] factor }
//! factor = [ "√" ] ( symbol | "(" unit ")" ) [ "^" number | "^(" number "/" number ")" | raised digits ]
//! ```

use super::power::Power;
use super::{Dimension, Unit, UnitError, instead_of, symbol_unit};

/// Brackets within brackets.
const DEEPEST: usize = 8;

/// The raised sign and digits, in the order of `-0123456789`.
const RAISED: &str = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";

/// Letters of a unit that a message repeats.
const QUOTED: usize = 40;

/// The text as a message repeats it.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

pub(super) struct Reader<'t> {
    text: &'t str,
    rest: &'t str,
    depth: usize,
}

impl<'t> Reader<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, rest: text, depth: 0 }
    }

    /// The whole text.
    pub(super) fn whole(mut self) -> Result<Unit, UnitError> {
        let unit = self.unit()?;
        if self.rest.trim().is_empty() { Ok(unit) } else { Err(self.incomplete()) }
    }

    fn incomplete(&self) -> UnitError {
        UnitError::Incomplete(quoted(self.text))
    }

    /// Takes one of these characters, after spaces.
    fn take(&mut self, wanted: &[char]) -> bool {
        let rest = self.rest.trim_start().strip_prefix(wanted);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn unit(&mut self) -> Result<Unit, UnitError> {
        let mut unit = self.part()?;
        while self.take(&['/']) {
            let below = self.part()?;
            unit = self.join(unit, below, Power::whole(-1))?;
        }
        Ok(unit)
    }

    fn part(&mut self) -> Result<Unit, UnitError> {
        let mut unit = self.factor()?;
        loop {
            let sign = self.take(&['*', '·', '⋅']);
            let more = !self.rest.trim_start().is_empty() && !self.rest.trim_start().starts_with(['/', ')']);
            if !sign && !more {
                return Ok(unit);
            }
            let next = self.factor()?;
            unit = self.join(unit, next, Power::whole(1))?;
        }
    }

    /// `unit · other^power`.
    fn join(&self, unit: Unit, other: Unit, power: Power) -> Result<Unit, UnitError> {
        let dimension = unit.dimension.times(other.dimension, power);
        let dimension = dimension.ok_or_else(|| UnitError::Power(quoted(self.text.trim())))?;
        let factor = unit.factor * power.of(other.factor);
        if factor.is_normal() {
            Ok(Unit { factor, dimension })
        } else {
            Err(UnitError::Extreme(quoted(self.text.trim())))
        }
    }

    fn factor(&mut self) -> Result<Unit, UnitError> {
        let root = self.take(&['√']);
        let begin = self.rest.trim_start();
        let unit = if self.take(&['(']) { self.bracket()? } else { self.symbol()? };
        let wrong = |rest: &str| UnitError::Power(quoted(&begin[..begin.len() - rest.len()]));
        let power = self.power().map_err(wrong)?;
        let power = match (root, power) {
            (true, Some(_)) => return Err(wrong(self.rest)),
            (true, None) => Power::HALF,
            (false, power) => power.unwrap_or(Power::whole(1)),
        };
        self.join(Unit { factor: 1.0, dimension: Dimension::NONE }, unit, power)
    }

    fn bracket(&mut self) -> Result<Unit, UnitError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.incomplete());
        }
        let unit = self.unit()?;
        self.depth -= 1;
        if self.take(&[')']) { Ok(unit) } else { Err(self.incomplete()) }
    }

    fn symbol(&mut self) -> Result<Unit, UnitError> {
        let text = self.rest.trim_start();
        let ends = |c: char| c.is_whitespace() || "*·⋅/^()√".contains(c) || RAISED.contains(c);
        let (symbol, rest) = text.split_at(text.find(ends).unwrap_or(text.len()));
        if symbol.is_empty() {
            return Err(self.incomplete());
        }
        self.rest = rest;
        symbol_unit(symbol).ok_or_else(|| UnitError::Unknown(quoted(symbol), instead_of(symbol)))
    }

    /// The power behind a symbol or a bracket; the error is what follows a power that is no number.
    fn power(&mut self) -> Result<Option<Power>, &'t str> {
        let raised = self.rest.find(|c| !RAISED.contains(c)).unwrap_or(self.rest.len());
        if raised > 0 {
            let digit = |c: char| Some("-0123456789".as_bytes()[RAISED.chars().position(|r| r == c)?] as char);
            let number: Option<String> = self.rest[..raised].chars().map(digit).collect();
            self.rest = &self.rest[raised..];
            return number.and_then(|number| Power::read(&number)).map(Some).ok_or(self.rest);
        }
        let Some(after) = self.rest.strip_prefix('^') else { return Ok(None) };
        let (number, rest) = match after.strip_prefix('(') {
            Some(inner) => inner.split_once(')').ok_or("")?,
            None => {
                after.split_at(after.find(|c: char| c.is_whitespace() || "*·⋅/()√".contains(c)).unwrap_or(after.len()))
            }
        };
        self.rest = rest;
        Power::read(number).map(Some).ok_or(rest)
    }
}
