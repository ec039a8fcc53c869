//! Formulas as people write them: numbers, names, `+ - * / ^`, brackets and functions.
//!
//! ```text
//! sum     = product { ( "+" | "-" ) product }
//! product = signed { ( "*" | "/" ) signed }          from the left: a/b/c is (a/b)/c
//! signed  = [ "+" | "-" ] signed | power
//! power   = value [ "^" [ "+" | "-" ] power ]        from the right: a^b^c is a^(b^c)
//! value   = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! A minus directly before a power is refused, because `-a^2` is −(a²) in mathematics and (−a)² in spreadsheets; so is
//! one behind `*` or `/`, as in `2*-a^2`. An exponent may have a sign: `a^-2`. `min` and `max` take one value
//! or more. `1e-3` is a number, `2a` is a fault.

use super::{Measure, function_of_all, function_of_one};
use crate::unit::vanishes;

/// Longest formula that is read, in bytes.
const LONGEST: usize = 10_000;

/// Brackets, signs and powers within one another.
const DEEPEST: usize = 64;

/// A formula as a tree.
#[derive(Clone, Debug)]
pub(super) enum Term {
    Number(f64),
    /// Index of a name.
    Name(usize),
    Negative(Box<Term>),
    /// Operations of one rank, from the left. A list and not a tree: a long sum must not take a deep stack.
    Chain(Box<Term>, Vec<(Binary, Term)>),
    Power(Box<Term>, Box<Term>),
    /// A function of one value.
    One(fn(Measure) -> Measure, Box<Term>),
    /// A function of all values, two by two from the left.
    All(fn(Measure, Measure) -> Measure, Vec<Term>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
}

/// Names of all functions.
const FUNCTIONS: [&str; 12] = ["abs", "sqrt", "exp", "ln", "log10", "sin", "cos", "tan", "atan", "tanh", "min", "max"];

/// Reads a formula: its tree, and the names that it uses in alphabetical order.
///
/// # Errors
/// What stands where, and what was expected.
pub(super) fn formula(text: &str) -> Result<(Term, Vec<String>), String> {
    if text.len() > LONGEST {
        return Err(format!("it has {} characters; at most {LONGEST} are read", text.len()));
    }
    let mut reader = Reader { text, at: 0, depth: 0, names: Vec::new() };
    let mut root = reader.sum()?;
    if reader.peek().is_some() {
        return Err(reader.expected("an operator or the end"));
    }
    let mut order: Vec<usize> = (0..reader.names.len()).collect();
    order.sort_by(|a, b| reader.names[*a].cmp(&reader.names[*b]));
    let mut indices = vec![0; order.len()];
    order.iter().enumerate().for_each(|(index, &name)| indices[name] = index);
    root.rename(&indices);
    reader.names.sort_unstable();
    Ok((root, reader.names))
}

impl Term {
    /// Its value from those of the names.
    pub(super) fn value(&self, names: &[Measure]) -> Measure {
        match self {
            Self::Number(number) => Measure::number(*number),
            Self::Name(name) => names[*name],
            Self::Negative(term) => term.value(names).mapped(|value| -value),
            Self::Chain(first, rest) => {
                rest.iter().fold(first.value(names), |value, (operator, term)| operator.apply(value, term.value(names)))
            }
            Self::Power(base, exponent) => base.value(names).raised(exponent.value(names)),
            Self::One(function, term) => function(term.value(names)),
            Self::All(function, terms) => {
                let values = terms.iter().map(|term| term.value(names));
                values.reduce(function).unwrap_or(Measure::number(f64::NAN))
            }
        }
    }

    /// Renumbers the names.
    fn rename(&mut self, indices: &[usize]) {
        match self {
            Self::Number(_) => {}
            Self::Name(name) => *name = indices[*name],
            Self::Negative(term) | Self::One(_, term) => term.rename(indices),
            Self::Chain(first, rest) => {
                first.rename(indices);
                rest.iter_mut().for_each(|(_, term)| term.rename(indices));
            }
            Self::Power(a, b) => [a, b].into_iter().for_each(|term| term.rename(indices)),
            Self::All(_, terms) => terms.iter_mut().for_each(|term| term.rename(indices)),
        }
    }
}

impl Binary {
    fn apply(self, a: Measure, b: Measure) -> Measure {
        match self {
            Self::Add => a.sum(b, a.value + b.value),
            Self::Subtract => a.sum(b, a.value - b.value),
            Self::Multiply => a.scaled(b, a.value * b.value, 1.0),
            Self::Divide => a.scaled(b, a.value / b.value, -1.0),
        }
    }
}

fn chain(first: Term, rest: Vec<(Binary, Term)>) -> Term {
    if rest.is_empty() { first } else { Term::Chain(Box::new(first), rest) }
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
    names: Vec<String>,
}

impl Reader<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn take(&mut self, wanted: &str) -> Option<char> {
        let next = self.peek().filter(|next| wanted.contains(*next))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn expected(&mut self, what: &str) -> String {
        let column = self.text[..self.at].chars().count() + 1;
        match self.peek() {
            Some(found) => format!("expected {what} at character {column}, found `{found}`"),
            None => format!("expected {what} at its end"),
        }
    }

    /// One level further down, which has a limit because every level takes stack.
    fn deeper(&mut self, read: fn(&mut Self) -> Result<Term, String>) -> Result<Term, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("more than {DEEPEST} levels of brackets, signs and powers"));
        }
        let term = read(self);
        self.depth -= 1;
        term
    }

    fn sum(&mut self) -> Result<Term, String> {
        let first = self.product()?;
        let mut rest = Vec::new();
        while let Some(sign) = self.take("+-") {
            let operator = if sign == '+' { Binary::Add } else { Binary::Subtract };
            rest.push((operator, self.product()?));
        }
        Ok(chain(first, rest))
    }

    fn product(&mut self) -> Result<Term, String> {
        let first = self.signed()?;
        let mut rest = Vec::new();
        while let Some(sign) = self.take("*/") {
            let operator = if sign == '*' { Binary::Multiply } else { Binary::Divide };
            rest.push((operator, self.signed()?));
        }
        Ok(chain(first, rest))
    }

    fn signed(&mut self) -> Result<Term, String> {
        let begin = self.at;
        match self.take("+-") {
            None => self.power(),
            Some('+') => self.deeper(Self::signed),
            Some(_) => {
                let bracket = self.peek() == Some('(');
                let term = self.deeper(Self::signed)?;
                // -(a^2) is a bracket that holds a power, and no power itself.
                let power = matches!(term, Term::Power(..));
                if power && !(bracket && self.closes(begin)) {
                    let found = self.text[begin..self.at].trim();
                    return Err(format!("a minus before a power at `{found}`; write -(a^2) or (-a)^2"));
                }
                Ok(Term::Negative(Box::new(term)))
            }
        }
    }

    /// Whether the first bracket behind `begin` is closed by the last character that was read.
    fn closes(&self, begin: usize) -> bool {
        let mut depth = 0;
        for (at, c) in self.text[begin..self.at].char_indices() {
            depth += i32::from(c == '(') - i32::from(c == ')');
            if depth == 0 && c == ')' {
                return self.text[begin + at + 1..self.at].trim().is_empty();
            }
        }
        false
    }

    fn power(&mut self) -> Result<Term, String> {
        let base = self.operand()?;
        if self.take("^").is_none() {
            return Ok(base);
        }
        let exponent = self.deeper(|reader| match reader.take("+-") {
            Some('-') => Ok(Term::Negative(Box::new(reader.deeper(Self::power)?))),
            Some(_) | None => reader.power(),
        })?;
        Ok(Term::Power(Box::new(base), Box::new(exponent)))
    }

    fn operand(&mut self) -> Result<Term, String> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let inner = self.deeper(Self::sum)?;
                if self.take(")").is_none() {
                    return Err(self.expected("`)`"));
                }
                Ok(inner)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(_) | None => Err(self.expected("a number, a name or `(`")),
        }
    }

    fn number(&mut self) -> Result<Term, String> {
        let rest = &self.text.as_bytes()[self.at..];
        let digits = |from: usize| rest[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let mut end = digits(0);
        if rest.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if rest.get(end).is_some_and(|byte| matches!(byte, b'e' | b'E')) {
            let sign = usize::from(rest.get(end + 1).is_some_and(|byte| matches!(byte, b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            end += if exponent > 0 { 1 + sign + exponent } else { 0 };
        }
        let text = &self.text[self.at..self.at + end];
        let next = self.text[self.at + end..].chars().next();
        let joined = next.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '.');
        match text.parse::<f64>() {
            Ok(value) if vanishes(text, value) && !joined => Err(format!("`{text}` is too small: it would be 0")),
            Ok(value) if value.is_finite() && !joined => {
                self.at += end;
                Ok(Term::Number(value))
            }
            Ok(value) if !joined => Err(format!("`{text}` is {value}, which is not a finite number")),
            Ok(_) | Err(_) => {
                Err(format!("`{}` is no number", &self.text[self.at..self.at + end + next.map_or(0, char::len_utf8)]))
            }
        }
    }

    fn name(&mut self) -> Result<Term, String> {
        let rest = &self.text[self.at..];
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = rest[..length].to_owned();
        self.at += length;
        if self.peek() == Some('(') {
            return self.call(&name);
        }
        let known = self.names.iter().position(|known| *known == name);
        Ok(Term::Name(known.unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        })))
    }

    fn call(&mut self, name: &str) -> Result<Term, String> {
        let (one, all) = (function_of_one(name), function_of_all(name));
        if one.is_none() && all.is_none() {
            return Err(format!("there is no function `{name}`; there are {}", FUNCTIONS.join(", ")));
        }
        self.at += 1;
        let mut terms = vec![self.deeper(Self::sum)?];
        while self.take(",").is_some() {
            terms.push(self.deeper(Self::sum)?);
        }
        if self.take(")").is_none() {
            return Err(self.expected("`,` or `)`"));
        }
        match (one, all) {
            (Some(function), _) if terms.len() == 1 => Ok(Term::One(function, Box::new(terms.remove(0)))),
            (Some(_), _) => Err(format!("`{name}` takes one value, not {}", terms.len())),
            (None, Some(function)) => Ok(Term::All(function, terms)),
            (None, None) => panic!("BUG: `{name}` is in neither list"),
        }
    }
}
