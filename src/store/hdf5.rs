//! Artifact ⇄ HDF5 file image: the only code that knows the HDF5 library.
//!
//! | value | in the file |
//! |---|---|
//! | artifact | root group; attributes `kind`, `version`, `task` (the task text), `layout` (version of this mapping) |
//! | group | group |
//! | table | group with `class = "table"`, `about` and `columns` (names in reading order); one dataset per column |
//! | array, column | dataset with `unit` and `about`; 64-bit reals or integers, or variable-length UTF-8 texts |
//! | real, whole number, text | scalar dataset, a real with `unit` |
//! | flag | scalar dataset of the enumeration FALSE, TRUE |
//! | bytes | dataset of unsigned 8-bit integers |
//!
//! The type and rank of a dataset say what it is; an array of rank zero carries `class = "array"`, so that it is not
//! taken for a scalar. `/`, `%`, `.` and the empty name cannot be link names and are written `%2F`, `%25`, `%2E`, `%`.
//! Missing values are one NaN and zero has no sign, as in the content hash: equal artifacts give equal bytes.
//!
//! **Reading is bounded**: depth, number of nodes, and the bytes a shape asks for are checked against the size of the
//! image before anything is allocated, so a damaged file costs an error and not the memory of the machine.
//!
//! **Older layouts**: [`decode`] reads `layout` first and calls the reader of that layout. A new layout adds a reader and
//! does not change the old one.

mod read;
mod write;

#[cfg(test)]
mod tests;

pub(super) use read::decode;
pub(super) use write::encode;

/// Version of the mapping that [`encode`] writes.
const LAYOUT: i64 = 1;
/// Deepest nesting of groups, written or read.
const MAX_DEPTH: usize = 32;

/// Why an artifact could not be encoded as a file image, or an image not be decoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Hdf5Error {
    /// The value cannot be held by an HDF5 file.
    #[error("`{place}` cannot be stored: {why}")]
    Unstorable {
        /// Path of the node.
        place: String,
        /// The reason.
        why: &'static str,
    },
    /// The image was written by a newer version.
    #[error("it has layout {found}, and this version of flow reads up to {LAYOUT}; use a newer flow")]
    Newer {
        /// The layout of the image.
        found: i64,
    },
    /// The image is not that of an artifact.
    #[error("`{place}`: wanted {wanted}, found {found}")]
    Unexpected {
        /// Path of the node or attribute.
        place: String,
        /// What is expected there.
        wanted: &'static str,
        /// What was found.
        found: String,
    },
    /// A shape asks for more than such a file can hold.
    #[error("`{place}` claims {bytes} bytes in a file of {file} bytes")]
    Oversized {
        /// Path of the node.
        place: String,
        /// The bytes its shape asks for.
        bytes: u64,
        /// Size of the file.
        file: u64,
    },
    /// The library could not read or write the image.
    #[error("{0}")]
    Library(String),
}

impl From<::hdf5::Error> for Hdf5Error {
    fn from(error: ::hdf5::Error) -> Self {
        Self::Library(error.to_string())
    }
}

/// The link name of a node: names that HDF5 paths cannot hold are escaped.
fn link_name(name: &str) -> String {
    match name {
        "" => "%".to_owned(),
        "." => "%2E".to_owned(),
        _ => name.replace('%', "%25").replace('/', "%2F"),
    }
}

/// The name of the node that a link name stands for.
fn node_name(link: &str) -> String {
    match link {
        "%" => String::new(),
        "%2E" => ".".to_owned(),
        _ => link.replace("%2F", "/").replace("%25", "%"),
    }
}
