//! Values of typed artifacts: one [`Field`] per type of value, read back in the unit that the declaration names.

use super::{Array, Artifact, Group, Node, Table, Values};
use crate::unit::Conversion;
use ndarray::{Dimension, IxDyn};
use std::collections::BTreeMap;

/// Why a value could not be read as it was declared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: wanted {wanted}, found {found}")]
pub struct Wanted {
    /// Where: `curve.strain`.
    pub path: String,
    /// The type that was wanted.
    pub wanted: String,
    /// What stands there, or `nothing`.
    pub found: String,
}

impl Wanted {
    /// A value of another type than declared.
    pub fn new(name: &str, wanted: impl Into<String>, found: impl Into<String>) -> Self {
        Self { path: name.to_owned(), wanted: wanted.into(), found: found.into() }
    }

    /// Names what the path lies in.
    #[must_use]
    pub fn within(mut self, outer: &str) -> Self {
        self.path = format!("{outer}.{}", self.path);
        self
    }
}

/// A type of value that artifacts can hold.
pub trait Field: Sized {
    /// Puts it into a group under a name; unit and description come from the declaration.
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str);

    /// Reads it back, its numbers converted to the declared unit.
    ///
    /// # Errors
    /// The declared type and the value found.
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted>;
}

/// The node called `name`.
fn node<'g>(group: &'g Group, name: &str, wanted: &str) -> Result<&'g Node, Wanted> {
    group.get(name).ok_or_else(|| Wanted::new(name, wanted, "nothing"))
}

/// The conversion to the declared unit.
fn to_unit(name: &str, from: &str, to: &str) -> Result<Conversion, Wanted> {
    Conversion::between(from, to).map_err(|_| Wanted::new(name, format!("the unit `{to}`"), format!("`{from}`")))
}

impl Field for f64 {
    fn put(&self, group: &mut Group, name: &str, unit: &str, _about: &str) {
        group.put(name, Node::Real { value: *self, unit: unit.to_owned() });
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        match node(group, name, "real")? {
            Node::Real { value, unit: own } => Ok(to_unit(name, own, unit)?.of(*value)),
            other => Err(Wanted::new(name, "real", other.type_name())),
        }
    }
}

macro_rules! plain_field {
    ($($type:ty, $node:ident, $wanted:literal;)*) => {$(
        impl Field for $type {
            fn put(&self, group: &mut Group, name: &str, _unit: &str, _about: &str) {
                group.put(name, Node::$node(self.clone()));
            }
            fn take(group: &Group, name: &str, _unit: &str) -> Result<Self, Wanted> {
                match node(group, name, $wanted)? {
                    Node::$node(value) => Ok(value.clone()),
                    other => Err(Wanted::new(name, $wanted, other.type_name())),
                }
            }
        }
    )*};
}
plain_field! {
    i64, Int, "whole number";
    bool, Flag, "flag";
    String, Text, "text";
    Vec<u8>, Bytes, "bytes";
    Table, Table, "table";
    Group, Group, "group";
}

/// What only some artifacts of a kind hold.
impl<F: Field> Field for Option<F> {
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
        if let Some(value) = self {
            value.put(group, name, unit, about);
        }
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        group.get(name).map(|_| F::take(group, name, unit)).transpose()
    }
}

/// Values by name, in the order of the names.
impl<F: Field> Field for BTreeMap<String, F> {
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
        let mut own = Group::new();
        self.iter().for_each(|(key, value)| value.put(&mut own, key, unit, about));
        group.put(name, Node::Group(own));
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        let own = <Group as Field>::take(group, name, unit)?;
        let one = |(key, _): (&str, &Node)| Ok((key.to_owned(), F::take(&own, key, unit)?));
        own.iter().map(one).collect::<Result<_, Wanted>>().map_err(|wanted| wanted.within(name))
    }
}

/// The table called `name` of an artifact, without a copy.
pub(super) fn table_of<'a>(artifact: &'a Artifact, name: &str) -> Result<&'a Table, Wanted> {
    match node(&artifact.root, name, "a table")? {
        Node::Table(table) => Ok(table),
        other => Err(Wanted::new(name, "a table", other.type_name())),
    }
}

/// Puts an array of numbers or texts.
fn put_array(group: &mut Group, name: &str, unit: &str, about: &str, shape: Vec<usize>, values: Values) {
    group.put(name, Node::Array(Array { shape, unit: unit.to_owned(), about: about.to_owned(), values }));
}

/// The array called `name`.
fn array<'g>(group: &'g Group, name: &str, wanted: &str) -> Result<&'g Array, Wanted> {
    match node(group, name, wanted)? {
        Node::Array(array) => Ok(array),
        other => Err(Wanted::new(name, wanted, other.type_name())),
    }
}

/// The numbers of the array called `name` in a unit, and its shape.
fn reals(group: &Group, name: &str, unit: &str) -> Result<(Vec<usize>, Vec<f64>), Wanted> {
    let array = array(group, name, "reals")?;
    match &array.values {
        Values::Reals(values) => Ok((array.shape.clone(), to_unit(name, &array.unit, unit)?.of_all(values.clone()))),
        other => Err(Wanted::new(name, "reals", other.type_name())),
    }
}

impl Field for Vec<f64> {
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
        put_array(group, name, unit, about, vec![self.len()], Values::Reals(self.clone()));
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        match reals(group, name, unit)? {
            (shape, values) if shape.len() == 1 => Ok(values),
            (shape, _) => Err(Wanted::new(name, "a list of reals", format!("an array of shape {shape:?}"))),
        }
    }
}

macro_rules! list_field {
    ($($type:ty, $values:ident, $wanted:literal;)*) => {$(
        impl Field for Vec<$type> {
            fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
                put_array(group, name, unit, about, vec![self.len()], Values::$values(self.clone()));
            }
            fn take(group: &Group, name: &str, _unit: &str) -> Result<Self, Wanted> {
                match array(group, name, $wanted)? {
                    Array { values: Values::$values(values), shape, .. } if shape.len() == 1 => Ok(values.clone()),
                    other => Err(Wanted::new(name, $wanted, other.values.type_name())),
                }
            }
        }
    )*};
}
list_field! {
    i64, Ints, "whole numbers";
    String, Texts, "texts";
}

/// Vectors of the plane or of space whose dimension is known when the program is written: an array of shape (n, D).
impl<const D: usize> Field for Vec<[f64; D]> {
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
        let values = self.as_flattened().to_vec();
        put_array(group, name, unit, about, vec![self.len(), D], Values::Reals(values));
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        match reals(group, name, unit)? {
            (shape, values) if shape.len() == 2 && shape[1] == D => Ok(values.as_chunks::<D>().0.to_vec()),
            (shape, _) => Err(Wanted::new(name, format!("vectors of {D}"), format!("an array of shape {shape:?}"))),
        }
    }
}

/// Arrays of reals whose shape is data: points in the plane or in space are an `Array2` of shape (n, 2) or (n, 3).
impl<D: Dimension> Field for ndarray::Array<f64, D> {
    fn put(&self, group: &mut Group, name: &str, unit: &str, about: &str) {
        let values = self.iter().copied().collect();
        put_array(group, name, unit, about, self.shape().to_vec(), Values::Reals(values));
    }
    fn take(group: &Group, name: &str, unit: &str) -> Result<Self, Wanted> {
        let (shape, values) = reals(group, name, unit)?;
        let wrong = || Wanted::new(name, "an array of reals with other axes", format!("the shape {shape:?}"));
        let all = ndarray::Array::from_shape_vec(IxDyn(&shape), values).map_err(|_| wrong())?;
        all.into_dimensionality::<D>().map_err(|_| wrong())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn values_come_back_in_the_declared_unit() {
        let mut group = Group::new();
        16.1.put(&mut group, "modulus", "GPa", "");
        vec![0.5, 1.5].put(&mut group, "radii", "mm", "");
        array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]].put(&mut group, "centres", "mm", "");
        None::<f64>.put(&mut group, "nothing", "", "");
        assert_eq!(f64::take(&group, "modulus", "MPa"), Ok(16100.0));
        assert_eq!(Vec::<f64>::take(&group, "radii", "m"), Ok(vec![0.0005, 0.0015]));
        let centres = ndarray::Array2::<f64>::take(&group, "centres", "mm").unwrap();
        assert_eq!((centres.ncols(), centres[[1, 2]]), (3, 6.0));
        assert_eq!(Vec::<[f64; 3]>::take(&group, "centres", "mm").unwrap()[1], [4.0, 5.0, 6.0]);
        assert!(Vec::<[f64; 2]>::take(&group, "centres", "mm").is_err());
        assert!(ndarray::Array3::<f64>::take(&group, "centres", "mm").is_err());
        assert_eq!(<Option<f64> as Field>::take(&group, "nothing", ""), Ok(None));
        let message = f64::take(&group, "modulus", "mm").unwrap_err().within("test").to_string();
        assert_eq!(message, "test.modulus: wanted the unit `mm`, found `GPa`");
        assert_eq!(i64::take(&group, "radii", "").unwrap_err().to_string(), "radii: wanted whole number, found reals");
    }
}
