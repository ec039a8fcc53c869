//! What can be stored: plain data, in one form for every kind of stage.
//!
//! An [`Artifact`] is a named, versioned tree of [`Node`]s. Its [`ContentHash`] is taken over names, types, shapes,
//! units and numbers, never over file bytes, so two runs that compute the same thing have the same hash whatever the
//! file format does. Descriptions (`about`) are for readers of the file and are not part of the hash.
//!
//! Typed artifacts are declared with [`artifact!`](crate::artifact!), one type per file, and convert to and from the tree.

pub mod agreement;
pub mod calibration;
mod cells;
pub mod damage;
mod declare;
pub mod design;
pub mod envelope;
mod field;
pub mod groups;
mod key;
mod kind;
mod node;
pub mod notes;
pub mod presentation;
pub mod range;
mod read;
pub mod results;
pub mod run;
pub mod shapes;
pub mod specimen;
pub mod statistics;
pub mod surfaces;
pub mod validity;

pub use cells::{Cells, Numbered, Word};
pub use declare::expect_kind;
pub use field::{Field, Wanted};
pub use key::{FirstBytes, Key};
pub use kind::{Accepts, ArtifactKind};
pub use node::{Array, Column, Group, Node, Table, Values};
pub use read::Unread;

use std::fmt;

/// A stored result: what kind of thing it is, and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Artifact {
    /// The kind, such as `specimen` or `table`; ports accept artifacts by this name.
    pub kind: String,
    /// Version of the kind's layout.
    pub version: u32,
    /// The values.
    pub root: Group,
}

impl Artifact {
    /// An artifact of a declared kind with the given values.
    pub fn of(kind: ArtifactKind, root: Group) -> Self {
        Self::new(kind.name(), kind.version(), root)
    }

    /// Whether it is of this kind, in any version.
    pub fn is(&self, kind: ArtifactKind) -> bool {
        self.kind == kind.name()
    }

    /// An artifact as a file names it.
    pub fn new(kind: &str, version: u32, root: Group) -> Self {
        Self { kind: kind.to_owned(), version, root }
    }

    /// Hash of kind, version and all values.
    pub fn content_hash(&self) -> ContentHash {
        let mut hash = blake3::Hasher::new_derive_key("flow artifact 1");
        node::feed_text(&mut hash, &self.kind);
        hash.update(&self.version.to_le_bytes());
        self.root.feed(&mut hash);
        ContentHash(*hash.finalize().as_bytes())
    }

    /// The artifact as it comes back from a file: every missing value one NaN, no zero with a sign.
    #[must_use]
    pub fn canonical(mut self) -> Self {
        self.root.canonicalise();
        self
    }

    /// About the memory its values take, in bytes.
    pub fn bytes(&self) -> usize {
        self.root.bytes()
    }

    /// The table called `name`, wherever a group of this artifact holds it.
    pub fn table(&self, name: &str) -> Option<&Table> {
        self.tables().into_iter().find(|(n, _)| n == name).map(|(_, table)| table)
    }

    /// All tables by name, in stable order; a table inside a group is called `group/name`.
    pub fn tables(&self) -> Vec<(String, &Table)> {
        let mut found = Vec::new();
        collect_tables("", &self.root, &mut found);
        found
    }
}

fn collect_tables<'a>(prefix: &str, group: &'a Group, found: &mut Vec<(String, &'a Table)>) {
    for (name, node) in group.iter() {
        match node {
            Node::Table(table) => found.push((format!("{prefix}{name}"), table)),
            Node::Group(inner) => collect_tables(&format!("{prefix}{name}/"), inner, found),
            Node::Array(_) | Node::Text(_) | Node::Real { .. } | Node::Int(_) | Node::Flag(_) | Node::Bytes(_) => {}
        }
    }
}

/// blake3 of an artifact's values: its name in the store.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentHash(pub [u8; 32]);

impl ContentHash {
    /// Reads 64 lower-case hexadecimal digits.
    pub fn from_hex(text: &str) -> Option<Self> {
        let hash = blake3::Hash::from_hex(text).ok()?;
        Some(Self(*hash.as_bytes()))
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&blake3::Hash::from_bytes(self.0).to_hex())
    }
}

impl fmt::Debug for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}
