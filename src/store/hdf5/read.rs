//! File image → artifact.

use super::{Hdf5Error, LAYOUT, MAX_DEPTH, node_name};
use crate::artifact::{Array, Artifact, Column, Group, Node, Table, Values};
use ::hdf5::{AttrValue, DType, Dataset, File, VlenStringReadOptions};
use std::cell::Cell;
use std::collections::HashMap;

/// Deflate compresses by a factor of about 1032 at most; a shape that needs more is damaged.
const MOST_PACKED: u64 = 1100;
/// Fewest bytes that a group or dataset takes in a file: its name, its link and its header.
const LEAST_NODE: u64 = 24;
/// Larger than any stored object.
const MOST_BYTES: u64 = 1 << 36;

/// Reads an image back: the artifact and the text of its task.
///
/// # Errors
/// The image is damaged, is not an artifact, or was written by a newer version.
pub(in crate::store) fn decode(image: Vec<u8>) -> Result<(Artifact, String), Hdf5Error> {
    let (file, attributes) = open(image)?;
    let kind = attribute_text(&attributes, "", "kind")?;
    let version = attribute_whole(&attributes, "version")?;
    let version = u32::try_from(version).map_err(|_| unexpected("version", "a version", &version.to_string()))?;
    let task = attribute_text(&attributes, "", "task")?;
    let size = file.file_size();
    let mut walk = Walk { file: size, left: Cell::new(allowance(size)), nodes: Cell::new(size / LEAST_NODE) };
    let root = walk.group(&file.root(), "", 0)?;
    Ok((Artifact::new(&kind, version, root), task))
}

type Attributes = HashMap<String, AttrValue>;

/// Opens the image and chooses the reader of its layout; there is one layout so far.
fn open(image: Vec<u8>) -> Result<(File, Attributes), Hdf5Error> {
    let file = File::from_bytes(image)?;
    let attributes = file.root().attrs()?;
    match attribute_whole(&attributes, "layout")? {
        LAYOUT => Ok((file, attributes)),
        found if found > LAYOUT => Err(Hdf5Error::Newer { found }),
        found => Err(unexpected("layout", "a layout", &found.to_string())),
    }
}

fn allowance(file: u64) -> u64 {
    file.saturating_mul(MOST_PACKED).min(MOST_BYTES)
}

/// One bounded walk through a file.
struct Walk {
    file: u64,
    /// Bytes that may still be read: the sum over all datasets is bounded, not only the size of each.
    left: Cell<u64>,
    /// Nodes that may still be visited: in a damaged file a group may contain itself.
    nodes: Cell<u64>,
}

impl Walk {
    fn group(&mut self, group: &::hdf5::Group, place: &str, depth: usize) -> Result<Group, Hdf5Error> {
        if depth > MAX_DEPTH {
            return Err(unexpected(place, "a value", "groups nested too deeply"));
        }
        let mut nodes = Group::new();
        for (link, dataset) in group.iter_datasets()? {
            let place = format!("{place}/{link}");
            self.count(&place)?;
            let node = self.dataset(&dataset, &place)?;
            insert(&mut nodes, &link, &place, node)?;
        }
        for (link, inner) in group.iter_groups()? {
            let place = format!("{place}/{link}");
            self.count(&place)?;
            let attributes = inner.attrs()?;
            let node = match attributes.get("class").and_then(AttrValue::as_str) {
                Some("table") => Node::Table(self.table(&inner, &attributes, &place)?),
                Some(other) => return Err(unexpected(&place, "a group or a table", other)),
                None => Node::Group(self.group(&inner, &place, depth + 1)?),
            };
            insert(&mut nodes, &link, &place, node)?;
        }
        Ok(nodes)
    }

    fn table(&self, group: &::hdf5::Group, attributes: &Attributes, place: &str) -> Result<Table, Hdf5Error> {
        let names = attributes.get("columns").and_then(AttrValue::as_strings).unwrap_or_default();
        // Looking each of them up by its name would read the list of names once for every column.
        let mut datasets: HashMap<String, Dataset> = group.iter_datasets()?.collect();
        let mut columns: Vec<Column> = Vec::new();
        for name in names {
            let place = format!("{place}/{name}");
            self.count(&place)?;
            let dataset = datasets.remove(&super::link_name(name));
            let dataset = dataset.ok_or_else(|| unexpected(&place, "a column", "nothing"))?;
            let Node::Array(Array { shape, unit, about, values }) = self.array(&dataset, &place)? else {
                return Err(unexpected(&place, "a column", "bytes"));
            };
            if shape.len() != 1 || columns.first().is_some_and(|first| first.values.len() != values.len()) {
                return Err(unexpected(&place, "a column as long as the others", &format!("shape {shape:?}")));
            }
            columns.push(Column { name: name.clone(), unit, about, values });
        }
        Ok(Table { about: optional_text(attributes, place, "about")?, columns })
    }

    fn dataset(&self, dataset: &Dataset, place: &str) -> Result<Node, Hdf5Error> {
        let shape = dataset.shape()?;
        let kind = dataset.dtype()?;
        if !shape.is_empty() || dataset.attrs()?.contains_key("class") {
            return self.array(dataset, place);
        }
        self.reserve(dataset, &shape, place)?;
        let nothing = || unexpected(place, "one value", "none");
        match kind {
            DType::F64 => {
                let value = dataset.read_f64()?.pop().ok_or_else(nothing)?;
                Ok(Node::Real { value, unit: optional_text(&dataset.attrs()?, place, "unit")? })
            }
            DType::I64 => Ok(Node::Int(dataset.read_i64()?.pop().ok_or_else(nothing)?)),
            DType::Enum(_) => Ok(Node::Flag(dataset.read_raw()?.pop().ok_or_else(nothing)? != 0)),
            DType::String | DType::VariableLengthString => {
                Ok(Node::Text(self.texts(dataset)?.pop().ok_or_else(nothing)?))
            }
            other => Err(unexpected(place, "a real, whole number, flag or text", &other.to_string())),
        }
    }

    /// An array or, for unsigned bytes, a [`Node::Bytes`].
    fn array(&self, dataset: &Dataset, place: &str) -> Result<Node, Hdf5Error> {
        let shape = dataset.shape()?;
        self.reserve(dataset, &shape, place)?;
        let values = match dataset.dtype()? {
            DType::F64 => Values::Reals(dataset.read_f64()?),
            DType::I64 => Values::Ints(dataset.read_i64()?),
            DType::String | DType::VariableLengthString => Values::Texts(self.texts(dataset)?),
            DType::U8 => return Ok(Node::Bytes(dataset.read_u8()?)),
            other => return Err(unexpected(place, "reals, whole numbers, texts or bytes", &other.to_string())),
        };
        let attributes = dataset.attrs()?;
        let shape: Vec<usize> = shape.iter().map(|&n| usize::try_from(n).unwrap_or(usize::MAX)).collect();
        let (unit, about) = (optional_text(&attributes, place, "unit")?, optional_text(&attributes, place, "about")?);
        Ok(Node::Array(Array { shape, unit, about, values }))
    }

    fn texts(&self, dataset: &Dataset) -> Result<Vec<String>, Hdf5Error> {
        if dataset.dtype()? == DType::String {
            return Ok(dataset.read_string()?);
        }
        let most = usize::try_from(self.file).unwrap_or(usize::MAX);
        Ok(dataset.read_vlen_strings(VlenStringReadOptions::new().with_max_payload_bytes(most))?)
    }

    /// Subtracts the bytes that a shape needs from the allowance, before the library allocates them.
    fn reserve(&self, dataset: &Dataset, shape: &[u64], place: &str) -> Result<(), Hdf5Error> {
        let size = dataset.element_size()?;
        let bytes = shape.iter().try_fold(size.max(1), |product, &n| product.checked_mul(n)).unwrap_or(u64::MAX);
        let most = if dataset.is_chunked() { self.left.get() } else { self.left.get().min(self.file) };
        if bytes > most {
            return Err(Hdf5Error::Oversized { place: place.to_owned(), bytes, file: self.file });
        }
        self.left.set(self.left.get() - bytes);
        Ok(())
    }

    /// Subtracts one node from those that a file of this size can hold.
    fn count(&self, place: &str) -> Result<(), Hdf5Error> {
        let left = self.nodes.get().checked_sub(1);
        self.nodes.set(left.ok_or_else(|| unexpected(place, "a value", "more values than the file has room for"))?);
        Ok(())
    }
}

fn insert(nodes: &mut Group, link: &str, place: &str, node: Node) -> Result<(), Hdf5Error> {
    let name = node_name(link);
    if name.is_empty() || name.contains('/') || nodes.get(&name).is_some() {
        return Err(unexpected(place, "a name of its own", &name));
    }
    nodes.put(&name, node);
    Ok(())
}

/// A text attribute, which files leave out when it is empty.
fn optional_text(attributes: &Attributes, place: &str, name: &str) -> Result<String, Hdf5Error> {
    if attributes.contains_key(name) { attribute_text(attributes, place, name) } else { Ok(String::new()) }
}

fn attribute_text(attributes: &Attributes, place: &str, name: &str) -> Result<String, Hdf5Error> {
    match attributes.get(name) {
        Some(value) => value.as_str().map(str::to_owned).ok_or_else(|| value.type_name()),
        None => Err("nothing"),
    }
    .map_err(|found| unexpected(&format!("{place}@{name}"), "a text", found))
}

fn attribute_whole(attributes: &Attributes, name: &str) -> Result<i64, Hdf5Error> {
    let found = attributes.get(name);
    found
        .and_then(AttrValue::as_i64)
        .ok_or_else(|| unexpected(&format!("@{name}"), "a whole number", found.map_or("nothing", AttrValue::type_name)))
}

fn unexpected(place: &str, wanted: &'static str, found: &str) -> Hdf5Error {
    Hdf5Error::Unexpected { place: place.trim_start_matches('/').to_owned(), wanted, found: found.to_owned() }
}
