//! Typesetting of one label: reads the markup from left to right and places the glyphs.

use super::{Glyph, LabelError};
use crate::font::Face;
use crate::scene::Rect;

const SCRIPT_SIZE: f64 = 0.70;
const SUB_DROP: f64 = 0.17;
const SUPER_RISE: f64 = 0.34;
const BAR_GAP: f64 = 0.075;
const BAR_WIDTH: f64 = 0.05;

/// Named signs.
const SIGNS: [(&str, char); 55] = [
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
    ("varnothing", 'Ø'),
    ("emptyset", 'Ø'),
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

/// State while a label is set.
pub(super) struct Pen<'a> {
    label: &'a str,
    rest: std::iter::Peekable<std::str::Chars<'a>>,
    face: Face,
    size: f64,
    pub(super) x: f64,
    y: f64,
    /// Letters are italic.
    slanted: bool,
    /// Levels of sub- and superscripts.
    depth: usize,
    pub(super) glyphs: Vec<Glyph>,
    pub(super) rules: Vec<Rect>,
    pub(super) plain: String,
    pub(super) fault: Option<LabelError>,
}

impl<'a> Pen<'a> {
    pub(super) fn new(label: &'a str, size: f64, face: Face) -> Self {
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

    pub(super) fn label(&mut self) {
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

    /// One atom with the scripts that follow it; a subscript and a superscript are stacked.
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
        let before = self.plain.len();
        self.plain.push(sign);
        self.atom();
        if let Some(raised) = (sign == '^').then(|| raised(&self.plain[before + 1..])).flatten() {
            self.plain.truncate(before);
            self.plain += &raised;
        }
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

/// A power of digits in raised characters, as people write it in plain text.
fn raised(power: &str) -> Option<String> {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let one = |c: char| match c {
        '-' | '−' => Some('⁻'),
        _ => c.to_digit(10).map(|digit| RAISED[digit as usize]),
    };
    power.chars().map(one).collect()
}
