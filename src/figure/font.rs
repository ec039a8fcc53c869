//! The three embedded faces: character → glyph, advance, kerning, outline. All lengths in fractions of the size.
//!
//! The faces are subsets of Source Sans 3 (SIL Open Font License 1.1, `fonts/OFL.txt`), made by `fonts/subset.py`.

use std::sync::LazyLock;
use ttf_parser::{GlyphId, OutlineBuilder};

/// A face of the family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Face {
    /// Words, numbers, units, subscripts.
    Regular,
    /// Symbols of quantities.
    Italic,
    /// Panel letters and headings.
    Semibold,
}

/// Every face, in the order of its discriminant.
pub const FACES: [Face; 3] = [Face::Regular, Face::Italic, Face::Semibold];

static FILES: [&[u8]; 3] =
    [include_bytes!("fonts/regular.ttf"), include_bytes!("fonts/italic.ttf"), include_bytes!("fonts/semibold.ttf")];

static PARSED: LazyLock<[ttf_parser::Face<'static>; 3]> = LazyLock::new(|| {
    FILES.map(|file| match ttf_parser::Face::parse(file, 0) {
        Ok(face) => face,
        Err(e) => panic!("BUG: an embedded font does not parse: {e}"),
    })
});

/// Font units per em of all three faces (pinned by a test).
pub const UNITS_PER_EM: f64 = 1000.0;

impl Face {
    /// The font file.
    pub fn file(self) -> &'static [u8] {
        FILES[self as usize]
    }

    /// The parsed tables.
    pub fn tables(self) -> &'static ttf_parser::Face<'static> {
        &PARSED[self as usize]
    }

    /// One letter that names the face in files.
    pub fn letter(self) -> char {
        match self {
            Face::Regular => 'r',
            Face::Italic => 'i',
            Face::Semibold => 'b',
        }
    }

    /// The glyph of a character, `None` when the subset lacks it.
    pub fn glyph(self, c: char) -> Option<u16> {
        self.tables().glyph_index(c).map(|g| g.0)
    }

    /// Horizontal advance of a glyph in em.
    pub fn advance(self, glyph: u16) -> f64 {
        f64::from(self.tables().glyph_hor_advance(GlyphId(glyph)).unwrap_or(0)) / UNITS_PER_EM
    }

    /// Kerning between two glyphs in em.
    pub fn kerning(self, left: u16, right: u16) -> f64 {
        let table = self.tables().tables().kern.and_then(|k| k.subtables.into_iter().next());
        let units = table.and_then(|t| t.glyphs_kerning(GlyphId(left), GlyphId(right))).unwrap_or(0);
        f64::from(units) / UNITS_PER_EM
    }

    /// Extent of a glyph in em, y up: left, bottom, right, top. Zero for a blank.
    pub fn extent(self, glyph: u16) -> [f64; 4] {
        let bounds = self.tables().glyph_bounding_box(GlyphId(glyph));
        bounds.map_or([0.0; 4], |b| [b.x_min, b.y_min, b.x_max, b.y_max].map(|v| f64::from(v) / UNITS_PER_EM))
    }

    /// Draws the outline of a glyph in font units, y up.
    pub fn outline(self, glyph: u16, builder: &mut dyn OutlineBuilder) {
        self.tables().outline_glyph(GlyphId(glyph), builder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_have_the_letters_of_the_field() {
        for face in FACES {
            assert_eq!(f64::from(face.tables().units_per_em()), UNITS_PER_EM);
            for c in
                "Axial strain 0123456789 σ τ μ ν ε ρ φ Δ Σ χ − × · ± ≤ ≥ ° ² ³ → – / % ( ) [ ] ö é Š ′ √ ≈ ∞".chars()
            {
                assert!(face.glyph(c).is_some(), "{face:?} lacks {c}");
            }
        }
    }

    #[test]
    fn kerning_pulls_a_pair_together() {
        let face = Face::Regular;
        let pair = |a, b| face.kerning(face.glyph(a).unwrap(), face.glyph(b).unwrap());
        assert!(pair('T', 'o') < 0.0 && pair('A', 'V') < 0.0);
        assert_eq!(pair('n', 'n'), 0.0);
    }
}
