//! Typesetting of labels: words upright, symbols in italics, subscripts, superscripts, bars, Greek, minus signs.
//!
//! A label is plain text with mathematics between dollar signs, in the notation of LaTeX:
//! `Peak strength $\sigma_u$ / MPa`, `$\bar\sigma_c$`, `$(k_n/k_s)_j$`, `$10^{-3}$`. Letters are italic, except
//! capital Greek and everything in a subscript or superscript (labels, not variables). A hyphen in
//! mathematics is a minus sign. Lengths are millimetres.

mod pen;

use super::font::Face;
use super::scene::{Point, Rect};
use math::elementary::sin_cos;
use pen::Pen;

/// Height of capitals and digits in em.
pub const CAP_HEIGHT: f64 = 0.66;
/// One typographic point (1/72 inch) in mm.
pub const POINT: f64 = 25.4 / 72.0;

/// A glyph at its position: mm from the start of the baseline, right and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Face it is taken from.
    pub face: Face,
    /// Number in the face.
    pub id: u16,
    /// Character it stands for.
    pub character: char,
    /// Position of its origin.
    pub at: Point,
    /// Size (one em) in mm.
    pub size: f64,
}

/// A set line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Glyphs from left to right.
    pub glyphs: Vec<Glyph>,
    /// Bars over symbols.
    pub rules: Vec<Rect>,
    /// Size of the main text in mm.
    pub size: f64,
    /// Advance in mm.
    pub width: f64,
    /// Ink above the baseline in mm.
    pub above: f64,
    /// Ink below the baseline in mm.
    pub below: f64,
    /// The text as plain characters, for search and screen readers.
    pub plain: String,
}

/// A fault of a label.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LabelError {
    /// A command that is not known.
    #[error("label `{label}`: unknown command `\\{command}`; known are {known}")]
    Command {
        /// The label.
        label: String,
        /// The command without its backslash.
        command: String,
        /// All known commands.
        known: String,
    },
    /// An unmatched brace or dollar sign.
    #[error("label `{label}`: `{sign}` has no partner")]
    Unpaired {
        /// The label.
        label: String,
        /// The sign.
        sign: char,
    },
    /// A character that the fonts lack.
    #[error("label `{label}`: the fonts have no sign for `{character}`")]
    Character {
        /// The label.
        label: String,
        /// The character.
        character: char,
    },
}

/// Looks for faults in a label without setting it.
pub fn check(label: &str) -> Result<(), LabelError> {
    let mut pen = Pen::new(label, 1.0, Face::Regular);
    pen.label();
    pen.fault.map_or(Ok(()), Err)
}

/// Any text as markup that shows it as it is.
pub fn plain_text(text: &str) -> String {
    text.replace('$', r"$\$$")
}

/// Whether a symbol needs brackets before a power, as `k_n/k_s` does and `(k_n/k_s)_j` does not.
pub fn is_compound(symbol: &str) -> bool {
    let mut depth = 0_i32;
    symbol.chars().any(|letter| {
        depth += i32::from(matches!(letter, '(' | '[' | '{')) - i32::from(matches!(letter, ')' | ']' | '}'));
        depth == 0 && matches!(letter, '/' | ' ' | '^' | '*' | '+' | '-')
    })
}

/// The markup of a quantity: name (itself markup), symbol and unit, each of which may be empty.
pub fn quantity(name: &str, symbol: &str, unit: &str) -> String {
    let mut out = name.to_string();
    if !symbol.is_empty() {
        out += &format!("{}${symbol}$", if name.is_empty() { "" } else { " " });
    }
    if !unit.is_empty() {
        let unit = unit_markup(unit);
        let compound = unit.contains('/') || unit.contains('·');
        out += &if compound { format!(" / ({unit})") } else { format!(" / {unit}") };
    }
    out
}

/// The markup of a unit: `kg/m^3` and `MPa*m^0.5` get superscripts, `*` becomes a centred dot, `um` and `deg` their signs.
pub fn unit_markup(unit: &str) -> String {
    match unit {
        "um" => return "μm".into(),
        "deg" => return "°".into(),
        _ => {}
    }
    let mut out = String::new();
    for (text, power) in unit_parts(unit) {
        out += &plain_text(&text.replace('*', "·"));
        if !power.is_empty() {
            out += &format!("$^{{{}}}$", power.replace(['\\', '{', '}', '$'], ""));
        }
    }
    out
}

/// A unit split after each of its powers: the text before a power, and the power without `^` and brackets.
pub(crate) fn unit_parts(unit: &str) -> Vec<(&str, &str)> {
    let mut parts = Vec::new();
    let mut rest = unit;
    while let Some((before, after)) = rest.split_once('^') {
        let (power, behind) = match after.strip_prefix('(').and_then(|inner| inner.split_once(')')) {
            Some(bracket) => bracket,
            None => {
                let number = |c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.');
                after.split_at(after.find(|c| !number(c)).unwrap_or(after.len()))
            }
        };
        parts.push((before, power));
        rest = behind;
    }
    if !rest.is_empty() {
        parts.push((rest, ""));
    }
    parts
}

impl Line {
    /// Sets a label at a size in mm. A label with faults ([`check`]) is set as far as it can be read.
    pub fn new(label: &str, size: f64) -> Self {
        Self::with_face(label, size, Face::Regular)
    }

    /// Sets a label whose words are in `face`.
    pub fn with_face(label: &str, size: f64, face: Face) -> Self {
        let mut pen = Pen::new(label, size, face);
        pen.label();
        let (mut above, mut below) = (0.0_f64, 0.0_f64);
        for g in &pen.glyphs {
            let [_, bottom, _, top] = g.face.extent(g.id);
            above = above.max(top * g.size - g.at[1]);
            below = below.max(g.at[1] - bottom * g.size);
        }
        above = pen.rules.iter().fold(above, |a, r| a.max(-r.top));
        Line { glyphs: pen.glyphs, rules: pen.rules, size, width: pen.x, above, below, plain: pen.plain }
    }

    /// The corners of the ink when the baseline starts at `at` and is turned by `angle` degrees anticlockwise.
    pub fn corners(&self, at: Point, angle: f64) -> [Point; 4] {
        let (s, c) = sin_cos(angle.to_radians());
        let turn = |x: f64, y: f64| [at[0] + x * c + y * s, at[1] - x * s + y * c];
        let (w, up, down) = (self.width, -self.above, self.below);
        [turn(0.0, up), turn(w, up), turn(w, down), turn(0.0, down)]
    }

    /// The upright rectangle around the ink when the baseline starts at `at` and is turned by `angle` degrees anticlockwise.
    pub fn bounds(&self, at: Point, angle: f64) -> Rect {
        Rect::around(self.corners(at, angle)).unwrap_or(Rect::new(at[0], at[1], 0.0, 0.0))
    }
}

#[cfg(test)]
mod tests;
