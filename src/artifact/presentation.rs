//! What tables and figures give: results of others, ready to be read.

use super::{ArtifactKind, Table};

crate::artifact! {
    /// A figure: its files, the words for those who cannot see it, and its numbers.
    pub struct Picture = ArtifactKind::PICTURE {
        /// title
        pub title: String, "";
        /// what it shows, in words
        pub description: String, "";
        /// as SVG
        pub svg: String, "";
        /// as PDF
        pub pdf: Vec<u8>, "";
        /// as PNG
        pub png: Vec<u8>, "";
        /// as SVG that moves, of figures that have several moments
        pub moving: Option<String>, "";
        /// the numbers that are drawn
        pub data: Table, "";
    }
}

crate::artifact! {
    /// A printed table: its files and its columns.
    pub struct Printed = ArtifactKind::TABLE {
        /// as CSV, with all digits
        pub csv: String, "";
        /// as LaTeX
        pub latex: String, "";
        /// as Markdown
        pub markdown: String, "";
        /// the columns that are printed
        pub table: Table, "";
    }
}
