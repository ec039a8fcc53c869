//! Typesetting of labels: words upright, symbols in italics, subscripts, superscripts, bars, Greek, minus signs.
//!
//! A label is plain text with mathematics between dollar signs, in the notation of LaTeX:
//! `Peak strength $\sigma_u$ / MPa`, `$\bar\sigma_c$`, `$(k_n/k_s)_j$`, `$10^{-3}$`. Letters are italic, except
//! capital Greek and everything in a subscript or superscript (they name, they do not vary). A hyphen in
//! mathematics is a minus sign. Lengths are millimetres.

use super::font::Face;
use super::scene::{Point, Rect};
use crate::math::elementary::sin_cos;

/// Height of capitals and digits in em.
pub const CAP_HEIGHT: f64 = 0.66;
/// One typographic point (1/72 inch) in mm.
pub const POINT: f64 = 25.4 / 72.0;

const SCRIPT_SIZE: f64 = 0.70;
const SUB_DROP: f64 = 0.17;
const SUPER_RISE: f64 = 0.34;
const BAR_GAP: f64 = 0.075;
const BAR_WIDTH: f64 = 0.05;

/// A glyph in its place: mm from the start of the baseline, right and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Face it is taken from.
    pub face: Face,
    /// Number in the face.
    pub id: u16,
    /// Character it stands for.
    pub character: char,
    /// Place of its origin.
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
    /// The text for those who read and search.
    pub plain: String,
}

/// What is wrong with a label.
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
    /// A brace or dollar sign without its partner.
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

/// Named signs.
const SIGNS: [(&str, char); 53] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("varepsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("phi", 'φ'),
    ("varphi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Sigma", 'Σ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
    ("partial", '∂'),
    ("cdot", '·'),
    ("times", '×'),
    ("pm", '±'),
    ("le", '≤'),
    ("leq", '≤'),
    ("ge", '≥'),
    ("geq", '≥'),
    ("ne", '≠'),
    ("approx", '≈'),
    ("to", '→'),
    ("infty", '∞'),
    ("prime", '′'),
    ("ell", 'ℓ'),
    ("circ", '°'),
    ("degree", '°'),
    ("%", '%'),
    ("$", '$'),
    ("_", '_'),
    (",", '\u{2009}'),
    (" ", ' '),
    ("quad", '\u{2003}'),
];
const BARS: [&str; 2] = ["bar", "overline"];
const UPRIGHT: [&str; 3] = ["mathrm", "text", "rm"];

/// Looks for faults in a label without setting it.
pub fn check(label: &str) -> Result<(), LabelError> {
    let mut pen = Pen::new(label, 1.0, Face::Regular);
    pen.label();
    pen.fault.map_or(Ok(()), Err)
}

/// The markup of a quantity: name, symbol and unit, each of which may be empty.
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

/// The markup of a unit: `kg/m^3` gets a superscript, `*` becomes a centred dot, `um` and `deg` their signs.
pub fn unit_markup(unit: &str) -> String {
    let (mut out, mut power) = (String::new(), false);
    for c in unit.chars() {
        if power && !(c.is_ascii_digit() || c == '-') {
            out += "}$";
            power = false;
        }
        match c {
            '^' => {
                out += "$^{";
                power = true;
            }
            '*' => out.push('·'),
            _ => out.push(c),
        }
    }
    if power {
        out += "}$";
    }
    match out.as_str() {
        "um" => "μm".into(),
        "deg" => "°".into(),
        _ => out,
    }
}

impl Line {
    /// Sets a label at a size in mm. Faults ([`check`]) are set as well as they can be.
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

    /// The corners of the ink's place when the baseline starts at `at` and is turned by `angle` degrees anticlockwise.
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

/// State while a label is set.
struct Pen<'a> {
    label: &'a str,
    rest: std::iter::Peekable<std::str::Chars<'a>>,
    face: Face,
    size: f64,
    x: f64,
    y: f64,
    /// Letters are italic.
    slanted: bool,
    /// Levels of sub- and superscripts.
    depth: usize,
    glyphs: Vec<Glyph>,
    rules: Vec<Rect>,
    plain: String,
    fault: Option<LabelError>,
}

impl<'a> Pen<'a> {
    fn new(label: &'a str, size: f64, face: Face) -> Self {
        Pen {
            label,
            rest: label.chars().peekable(),
            face,
            size,
            x: 0.0,
            y: 0.0,
            slanted: false,
            depth: 0,
            glyphs: Vec::new(),
            rules: Vec::new(),
            plain: String::new(),
            fault: None,
        }
    }

    fn label(&mut self) {
        while let Some(c) = self.rest.next() {
            if c == '$' {
                self.slanted = true;
                self.list('$');
                self.slanted = false;
            } else {
                self.put(c, self.face);
            }
        }
    }

    /// Mathematics up to the closing sign.
    fn list(&mut self, close: char) {
        loop {
            match self.rest.peek() {
                None => return self.unpaired(if close == '$' { '$' } else { '{' }),
                Some(&c) if c == close => {
                    self.rest.next();
                    return;
                }
                Some('}') => {
                    self.rest.next();
                    self.unpaired('}');
                }
                Some(_) => self.atom_with_scripts(),
            }
        }
    }

    /// One atom with the scripts that follow it; a subscript and a superscript stand one over the other.
    fn atom_with_scripts(&mut self) {
        if !matches!(self.rest.peek(), Some('_' | '^')) {
            self.atom();
        }
        let start = self.x;
        let mut end = start;
        while let Some(&c @ ('_' | '^')) = self.rest.peek() {
            self.rest.next();
            self.x = start + if c == '^' && self.slanted && self.depth == 0 { 0.06 * self.size } else { 0.0 };
            self.script(c);
            end = end.max(self.x);
        }
        if end > start {
            self.x = end + 0.03 * self.size;
        }
    }

    fn script(&mut self, sign: char) {
        let (size, y, slanted) = (self.size, self.y, self.slanted);
        self.y += if sign == '_' { SUB_DROP * size } else { -SUPER_RISE * size };
        self.size *= SCRIPT_SIZE;
        self.slanted = false;
        self.depth += 1;
        self.plain.push(sign);
        self.atom();
        (self.size, self.y, self.slanted, self.depth) = (size, y, slanted, self.depth - 1);
    }

    fn atom(&mut self) {
        match self.rest.next() {
            None => {}
            Some('{') => self.list('}'),
            Some('\\') => self.command(),
            Some(' ') => {}
            Some('-') => self.put('−', self.face),
            Some(c) if "=≤≥≈<>".contains(c) => self.relation(c),
            Some(c) => self.put(c, self.letter_face(c)),
        }
    }

    fn relation(&mut self, c: char) {
        let space = if self.depth == 0 { 0.2 * self.size } else { 0.0 };
        self.x += space;
        self.put(c, self.face);
        self.x += space;
    }

    fn letter_face(&self, c: char) -> Face {
        let capital_greek = ('Α'..='Ω').contains(&c);
        if self.slanted && c.is_alphabetic() && !capital_greek { Face::Italic } else { self.face }
    }

    fn command(&mut self) {
        let mut name = String::new();
        while let Some(&c) = self.rest.peek() {
            if !c.is_ascii_alphabetic() && !name.is_empty() {
                break;
            }
            name.push(c);
            self.rest.next();
            if !c.is_ascii_alphabetic() {
                break;
            }
        }
        if BARS.contains(&name.as_str()) {
            return self.bar();
        }
        if UPRIGHT.contains(&name.as_str()) {
            let slanted = std::mem::replace(&mut self.slanted, false);
            self.skip_blanks();
            self.words();
            self.slanted = slanted;
            return;
        }
        match SIGNS.iter().find(|(known, _)| *known == name) {
            Some(&(_, c)) if "≤≥≈≠→".contains(c) => self.relation(c),
            Some(&(_, c)) => self.put(c, self.letter_face(c)),
            None => self.unknown(&name),
        }
        self.skip_blanks();
    }

    /// The argument of `\text`: blanks count.
    fn words(&mut self) {
        if self.rest.peek() != Some(&'{') {
            return self.atom();
        }
        self.rest.next();
        loop {
            match self.rest.next() {
                None => return self.unpaired('{'),
                Some('}') => return,
                Some(c) => self.put(c, self.face),
            }
        }
    }

    fn skip_blanks(&mut self) {
        while self.rest.peek() == Some(&' ') {
            self.rest.next();
        }
    }

    fn bar(&mut self) {
        self.skip_blanks();
        let (first, start) = (self.glyphs.len(), self.x);
        self.atom();
        let inked = &self.glyphs[first..];
        let (mut left, mut right, mut top) = (f64::INFINITY, start, self.y);
        for g in inked {
            let [l, _, r, t] = g.face.extent(g.id);
            left = left.min(g.at[0] + l * g.size);
            right = right.max(g.at[0] + r * g.size);
            top = top.min(g.at[1] - t * g.size);
        }
        if left < right {
            let bottom = top - BAR_GAP * self.size;
            self.rules.push(Rect { left, right, bottom, top: bottom - BAR_WIDTH * self.size });
        }
        self.plain.push('\u{304}');
    }

    fn put(&mut self, c: char, face: Face) {
        let (id, c) = match face.glyph(c) {
            Some(id) => (id, c),
            None if c == '\u{2009}' || c == '\u{2003}' => {
                self.x += self.size * if c == '\u{2009}' { 0.167 } else { 1.0 };
                self.plain.push(' ');
                return;
            }
            None => {
                let fault = LabelError::Character { label: self.label.into(), character: c };
                self.fault.get_or_insert(fault);
                (face.glyph('?').unwrap_or(0), '?')
            }
        };
        if let Some(last) = self.glyphs.last().filter(|g| g.face == face && g.size == self.size && g.at[1] == self.y) {
            self.x += face.kerning(last.id, id) * self.size;
        }
        let turned =
            self.glyphs.last().is_some_and(|g| g.face == Face::Italic && face != Face::Italic && g.at[1] == self.y);
        if turned && "/)]|".contains(c) {
            self.x += 0.04 * self.size;
        }
        self.glyphs.push(Glyph { face, id, character: c, at: [self.x, self.y], size: self.size });
        self.plain.push(c);
        self.x += face.advance(id) * self.size;
    }

    fn unpaired(&mut self, sign: char) {
        let fault = LabelError::Unpaired { label: self.label.into(), sign };
        self.fault.get_or_insert(fault);
    }

    fn unknown(&mut self, name: &str) {
        let known: Vec<&str> = BARS.iter().chain(&UPRIGHT).copied().chain(SIGNS.iter().map(|s| s.0)).collect();
        let fault = LabelError::Command { label: self.label.into(), command: name.into(), known: known.join(" ") };
        self.fault.get_or_insert(fault);
        for c in name.chars() {
            self.put(c, self.face);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_barred_symbol_with_subscript_and_unit() {
        let line = Line::new(&quantity("", r"\bar\sigma_c", "MPa"), 10.0);
        assert_eq!(line.plain, "σ\u{304}_c / MPa");
        let [sigma, c, space, ..] = &line.glyphs[..] else { panic!("too few glyphs") };
        assert_eq!((sigma.face, sigma.character), (Face::Italic, 'σ'));
        assert_eq!((c.face, c.character), (Face::Regular, 'c'));
        assert!(c.size < sigma.size && c.at[1] > 0.0 && space.at[1] == 0.0);
        let bar = line.rules[0];
        let top = -Face::Italic.extent(sigma.id)[3] * 10.0;
        assert!(bar.bottom < top && bar.left >= sigma.at[0] - 0.5 && bar.right <= c.at[0] + 1.0);
    }

    #[test]
    fn scripts_stand_over_one_another() {
        let line = Line::new(r"$R^2_{adj}$", 10.0);
        let at = |c| line.glyphs.iter().find(|g| g.character == c).map(|g| g.at).unwrap();
        assert!(at('2')[1] < 0.0 && at('a')[1] > 0.0 && (at('2')[0] - at('a')[0]).abs() < 1.0);
    }

    #[test]
    fn minus_and_units() {
        assert_eq!(Line::new("$10^{-3}$", 1.0).plain, "10^−3");
        assert_eq!(unit_markup("kg/m^3"), "kg/m$^{3}$");
        assert_eq!(quantity("Density", r"\rho", "kg/m^3"), r"Density $\rho$ / (kg/m$^{3}$)");
        assert_eq!(Line::new("Density / (kg/m$^3$)", 1.0).plain, "Density / (kg/m^3)");
    }

    #[test]
    fn faults_are_named() {
        assert_eq!(check(r"strain $\varepsilon_{1}$ / %"), Ok(()));
        assert!(check(r"$\sigm_c$").unwrap_err().to_string().contains(r"unknown command `\sigm`"));
        assert!(matches!(check("$E_{c$"), Err(LabelError::Unpaired { .. })));
        assert!(matches!(check("$E_c"), Err(LabelError::Unpaired { sign: '$', .. })));
        assert!(matches!(check("力"), Err(LabelError::Character { character: '力', .. })));
    }

    #[test]
    fn a_turned_line_takes_a_tall_place() {
        let line = Line::new("Strength", 3.0);
        let r = line.bounds([10.0, 50.0], 90.0);
        assert!((r.height() - line.width).abs() < 1e-9 && (r.bottom - 50.0).abs() < 1e-9);
        assert!((r.right - 10.0 - line.below).abs() < 1e-9 && (10.0 - r.left - line.above).abs() < 1e-9);
    }
}
