//! Artifact → file image.

use super::{Hdf5Error, LAYOUT, MAX_DEPTH, link_name};
use crate::artifact::{Array, Artifact, Group, Node, Table, Values};
use ::hdf5::{AttrValue, DatasetBuilder, EnumTypeBuilder, FileBuilder, GroupBuilder, make_i8_type};

/// Arrays from this size on are compressed; below it the filter costs more than it saves.
const COMPRESS_FROM: usize = 4096;
/// Compression level: the third takes five times as long and saves 2 % of the results of a campaign.
const LEVEL: u32 = 1;
/// Longest text that is stored inside an object's header, which holds 64 kB in all, bytes.
const MOST_INLINE: usize = 8192;
/// Padded texts up to this many bytes in all are written padded in any case.
const MOST_PADDED: usize = 1 << 20;
/// Desired size of one chunk, bytes: a reader of a part of a large array need not decompress all of it.
const CHUNK: usize = 1 << 20;
/// Most rows of one chunk. The HDF5 library 2.0 refuses to open a dataset whose chunk has a longer edge: it wants the edge in
/// three bytes where the file has four.
const ROWS: usize = 0xFFFF;

/// The HDF5 image of an artifact; the same artifact and text give the same bytes.
///
/// # Errors
/// [`Hdf5Error::Unstorable`] for a text with a NUL character, an array whose shape does not fit its values, groups
/// nested too deeply.
pub(in crate::store) fn encode(artifact: &Artifact, task_text: impl Into<String>) -> Result<Vec<u8>, Hdf5Error> {
    let task_text = task_text.into();
    let mut file = FileBuilder::new();
    check_text(&task_text, "task")?;
    check_text(&artifact.kind, "kind")?;
    // The task text may be long, so the root has a heap of its own anyway.
    file.set_attr("kind", AttrValue::VarLenString(artifact.kind.clone()));
    file.set_attr("version", AttrValue::I64(i64::from(artifact.version)));
    file.set_attr("layout", AttrValue::I64(LAYOUT));
    file.set_attr("task", AttrValue::VarLenString(task_text));
    put_group(&mut file, &artifact.root, "", 0)?;
    Ok(file.finish()?)
}

/// What nodes can be written into: the file's root and every group.
trait Parent {
    fn dataset(&mut self, link: &str) -> &mut DatasetBuilder;
    fn group(&mut self, link: &str) -> GroupBuilder;
    fn add(&mut self, group: GroupBuilder);
}

macro_rules! parent {
    ($type:ty) => {
        impl Parent for $type {
            fn dataset(&mut self, link: &str) -> &mut DatasetBuilder {
                self.create_dataset(link)
            }
            fn group(&mut self, link: &str) -> GroupBuilder {
                self.create_group(link)
            }
            fn add(&mut self, group: GroupBuilder) {
                self.add_group(group.finish());
            }
        }
    };
}
parent!(FileBuilder);
parent!(GroupBuilder);

fn put_group(parent: &mut impl Parent, group: &Group, place: &str, depth: usize) -> Result<(), Hdf5Error> {
    if depth > MAX_DEPTH {
        return Err(unstorable(place, "its groups are nested too deeply"));
    }
    group.iter().try_for_each(|(name, node)| put_node(parent, name, node, &format!("{place}/{name}"), depth))
}

fn put_node(parent: &mut impl Parent, name: &str, node: &Node, place: &str, depth: usize) -> Result<(), Hdf5Error> {
    check_text(name, place)?;
    let link = link_name(name);
    match node {
        Node::Group(group) => {
            let mut inner = parent.group(&link);
            put_group(&mut inner, group, place, depth + 1)?;
            parent.add(inner);
        }
        Node::Table(table) => {
            let mut inner = parent.group(&link);
            put_table(&mut inner, table, place)?;
            parent.add(inner);
        }
        Node::Array(array) => put_array(parent.dataset(&link), array, place)?,
        Node::Text(value) => put_texts(parent.dataset(&link), std::slice::from_ref(value), &[], place)?,
        Node::Real { value, unit } => {
            let dataset = parent.dataset(&link).with_f64_data(&[canonical(*value)]).with_shape(&[]);
            describe(dataset, unit, "", place)?;
        }
        Node::Int(value) => {
            parent.dataset(&link).with_i64_data(&[*value]).with_shape(&[]);
        }
        Node::Flag(value) => put_flag(parent.dataset(&link), *value)?,
        Node::Bytes(bytes) => {
            let dataset = parent.dataset(&link).with_u8_data(bytes);
            compress(dataset, &[bytes.len()], 1);
        }
    }
    Ok(())
}

fn put_table(group: &mut GroupBuilder, table: &Table, place: &str) -> Result<(), Hdf5Error> {
    group.set_attr("class", AttrValue::String("table".to_owned()));
    if !table.about.is_empty() {
        group.set_attr("about", text(&table.about, place)?);
    }
    let names: Vec<String> = table.columns.iter().map(|column| column.name.clone()).collect();
    let room = names.len() * names.iter().map(String::len).max().unwrap_or(0);
    let fixed = room <= MOST_INLINE;
    group.set_attr("columns", if fixed { AttrValue::StringArray(names) } else { AttrValue::VarLenStringArray(names) });
    for column in &table.columns {
        let place = format!("{place}/{}", column.name);
        check_text(&column.name, &place)?;
        let dataset = group.create_dataset(&link_name(&column.name));
        put_values(dataset, &column.values, &[column.values.len()], &place)?;
        describe(dataset, &column.unit, &column.about, &place)?;
    }
    Ok(())
}

fn put_array(dataset: &mut DatasetBuilder, array: &Array, place: &str) -> Result<(), Hdf5Error> {
    let count = array.shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    if count != Some(array.values.len()) {
        return Err(unstorable(place, "its shape does not fit the number of its values"));
    }
    if array.shape.is_empty() {
        dataset.set_attr("class", AttrValue::String("array".to_owned()));
    }
    put_values(dataset, &array.values, &array.shape, place)?;
    describe(dataset, &array.unit, &array.about, place)
}

fn put_values(dataset: &mut DatasetBuilder, values: &Values, shape: &[usize], place: &str) -> Result<(), Hdf5Error> {
    match values {
        Values::Reals(values) => {
            let values: Vec<f64> = values.iter().map(|&value| canonical(value)).collect();
            compress(dataset.with_f64_data(&values), shape, 8);
        }
        Values::Ints(values) => compress(dataset.with_i64_data(values), shape, 8),
        Values::Texts(values) => return put_texts(dataset, values, shape, place),
    }
    dataset.with_shape(&shape.iter().map(|&n| n as u64).collect::<Vec<_>>());
    Ok(())
}

/// Texts of one width, padded with NUL, unless one long text among many would waste the room.
fn put_texts(dataset: &mut DatasetBuilder, values: &[String], shape: &[usize], place: &str) -> Result<(), Hdf5Error> {
    values.iter().try_for_each(|value| check_text(value, place))?;
    let width = values.iter().map(String::len).max().unwrap_or(0).max(1);
    let total: usize = values.iter().map(String::len).sum();
    let texts: Vec<&str> = values.iter().map(String::as_str).collect();
    if width * values.len() <= MOST_PADDED.max(4 * total) {
        dataset.with_strings(&texts).map_err(|error| Hdf5Error::Library(error.to_string()))?;
        if !shape.is_empty() {
            compress(dataset, shape, width);
        }
    } else {
        dataset.with_vlen_strings(&texts);
    }
    dataset.with_shape(&shape.iter().map(|&n| n as u64).collect::<Vec<_>>());
    Ok(())
}

fn put_flag(dataset: &mut DatasetBuilder, value: bool) -> Result<(), Hdf5Error> {
    // The enumeration that numpy's bool has in HDF5 files.
    let boolean = EnumTypeBuilder::with_base(make_i8_type()).value("FALSE", 0).value("TRUE", 1).build();
    let boolean = boolean.map_err(|error| Hdf5Error::Library(error.to_string()))?;
    dataset.with_enum_u8_data(boolean, &[u8::from(value)]).with_shape(&[]);
    Ok(())
}

fn compress(dataset: &mut DatasetBuilder, shape: &[usize], size: usize) {
    let bytes = shape.iter().product::<usize>() * size;
    if bytes < COMPRESS_FROM {
        return;
    }
    let row = bytes / shape[0];
    let mut chunk: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
    chunk[0] = (CHUNK / row).clamp(1, shape[0].min(ROWS)) as u64;
    dataset.with_chunks(&chunk).with_deflate(LEVEL);
    if size == 8 {
        dataset.with_shuffle();
    }
}

fn describe(dataset: &mut DatasetBuilder, unit: &str, about: &str, place: &str) -> Result<(), Hdf5Error> {
    for (name, value) in [("unit", unit), ("about", about)] {
        if !value.is_empty() {
            dataset.set_attr(name, text(value, place)?);
        }
    }
    Ok(())
}

/// One NaN and one zero, as the content hash sees them.
fn canonical(value: f64) -> f64 {
    if value.is_nan() { f64::NAN.abs() } else { value + 0.0 }
}

/// A text attribute. A variable-length one takes a heap of 4 kB per object, so only a long text gets it.
fn text(value: &str, place: &str) -> Result<AttrValue, Hdf5Error> {
    check_text(value, place)?;
    let fixed = value.len() <= MOST_INLINE;
    Ok(if fixed { AttrValue::String(value.to_owned()) } else { AttrValue::VarLenString(value.to_owned()) })
}

fn check_text(value: &str, place: &str) -> Result<(), Hdf5Error> {
    if value.contains('\0') {
        return Err(unstorable(place, "it holds the character NUL, which no text in an HDF5 file can hold"));
    }
    Ok(())
}

fn unstorable(place: &str, why: &'static str) -> Hdf5Error {
    let place = place.trim_start_matches('/').to_owned();
    Hdf5Error::Unstorable { place, why }
}
