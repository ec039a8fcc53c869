//! Figures: plain series → [`scene::Scene`] → SVG, PNG or PDF. Nothing here knows stages, files or HDF5.
//!
//! A figure is a struct of its data with `impl Figure`; one file each. [`Figure::data`] returns what it draws as columns, so
//! every figure has its CSV. Sizes are millimetres on paper, text is 8 pt when printed.
//!
//! * page: [`scene`] (what is drawn), [`text`] and [`font`] (labels), [`svg`], [`png`], [`pdf`], [`film`] (writers)
//! * plot: [`axis`], [`panel`], [`legend`], [`palette`], [`marks`]
//! * words and numbers: [`mod@column`], [`table`]
//! * every other file is a figure

pub mod agreement;
pub mod axis;
pub mod bars;
pub mod boxes;
pub mod bundle;
pub mod chains;
pub mod column;
pub mod contour;
pub mod convergence;
pub mod cracks;
pub mod curve;
pub mod dag;
pub mod effect_plot;
pub mod effects;
pub mod escape;
pub mod film;
pub mod font;
mod footnote;
mod geometry;
pub mod heatmap;
pub mod histogram;
pub mod isoline;
pub mod layers;
pub mod legend;
pub mod marks;
pub mod palette;
pub mod panel;
pub mod pdf;
pub mod png;
pub mod points;
pub mod residuals;
pub mod rose;
pub mod scatter;
pub mod scene;
pub mod snapshots;
pub mod solid;
pub mod solutions;
pub mod specimen;
pub mod stones;
pub mod surface;
pub mod svg;
pub mod table;
pub mod text;
pub mod verification;
pub mod view;
pub mod xy;
pub mod zingg;

use column::Column;
use scene::Scene;

/// A picture of some data.
pub trait Figure {
    /// Draws it.
    fn scene(&self, style: &Style) -> Scene;
    /// The numbers it shows, one column each.
    fn data(&self) -> Vec<Column>;
    /// Scenes of one size, one after another, of a figure that also moves.
    fn frames(&self, _style: &Style) -> Vec<Scene> {
        Vec::new()
    }
}

/// Settings shared by all figures of a publication.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Width of the page in mm: 90 for one column of a journal, 190 for two.
    pub width: f64,
    /// Size of the text in points.
    pub points: f64,
    /// Colours of surfaces.
    pub map: palette::Map,
}

/// Width of one journal column in mm.
pub const SINGLE: f64 = 90.0;
/// Width of two journal columns in mm.
pub const DOUBLE: f64 = 190.0;

impl Style {
    /// Default look at a given width.
    pub fn wide(width: f64) -> Self {
        Self { width, points: 8.0, map: palette::Map::default() }
    }

    /// Size of the text in mm.
    pub fn size(&self) -> f64 {
        self.points * text::POINT
    }
}

/// Name, symbol and unit of something that has values; each may be empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Quantity {
    /// Name in tables and programs: "UCS"; when empty, the plain name is used.
    pub key: String,
    /// Plain words: "Peak strength".
    pub name: String,
    /// Symbol in LaTeX notation without dollar signs: `\sigma_u`.
    pub symbol: String,
    /// Unit: "MPa"; empty for a pure number.
    pub unit: String,
    /// Whether the name keeps its letters among words, because a person or a file gave it: other languages write nouns with a
    /// capital.
    pub is_as_written: bool,
}

impl Quantity {
    /// From its three parts.
    pub fn new(name: &str, symbol: &str, unit: &str) -> Self {
        Self { key: String::new(), name: name.into(), symbol: symbol.into(), unit: unit.into(), is_as_written: false }
    }

    /// Sets the key.
    pub fn keyed(mut self, key: &str) -> Self {
        self.key = key.into();
        self
    }

    /// The key, or the name.
    pub fn id(&self) -> &str {
        if self.key.is_empty() { &self.name } else { &self.key }
    }

    /// A value of it in words: "12.3 MPa", or "0.203".
    pub fn in_words(&self, value: f64) -> String {
        let words = format!("{} {}", axis::significant(value, 3), text::unit_markup(&self.unit));
        text::Line::new(words.trim_end(), 1.0).plain
    }

    /// Name, symbol and unit as an axis title.
    pub fn title(&self) -> String {
        text::quantity(&self.name, &self.symbol, &self.unit)
    }

    /// Plain words for titles and descriptions: the name, with a small first letter unless it is as written, or the symbol.
    pub fn words(&self) -> String {
        if self.name.is_empty() {
            return text::Line::new(&self.sign(), 1.0).plain;
        }
        if self.is_as_written {
            return text::Line::new(&self.name, 1.0).plain;
        }
        let mut letters = self.name.chars();
        let first = letters.next().unwrap_or_default();
        let is_word = letters.clone().next().is_some_and(char::is_lowercase);
        if is_word { first.to_lowercase().chain(letters).collect() } else { self.name.clone() }
    }

    /// The axis title with a word before the symbol, or before the name when there is no symbol: "Published σ_u".
    pub fn worded(&self, word: &str) -> Self {
        let name = if self.symbol.is_empty() { format!("{word} {}", self.words()) } else { word.to_string() };
        Self { name, ..self.clone() }
    }

    /// Symbol and unit, or name and unit when there is no symbol.
    pub fn short(&self) -> String {
        if self.symbol.is_empty() { self.title() } else { text::quantity("", &self.symbol, &self.unit) }
    }

    /// The symbol as markup, or the name.
    pub fn sign(&self) -> String {
        if self.symbol.is_empty() { self.name.clone() } else { format!("${}$", self.symbol) }
    }

    /// A column of values of this quantity.
    pub fn column(&self, key: &str, values: Vec<f64>) -> Column {
        Column { symbol: self.symbol.clone(), unit: self.unit.clone(), ..Column::reals(key, values) }
    }
}
