//! Conversion between typed artifacts and the tree: one [`Field`] per type of value, one macro per artifact.

use super::{Array, Group, Node, Table, Values};

/// Why a node could not be read as what was wanted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: wanted {wanted}, found {found}")]
pub struct Wanted {
    /// Where: `curve.strain`.
    pub place: String,
    /// The type that was wanted.
    pub wanted: String,
    /// What stands there, or `nothing`.
    pub found: String,
}

/// A type of value that artifacts can hold.
pub trait Field: Sized {
    /// The tree's form; `unit` and `about` come from the declaration.
    fn to_node(&self, unit: &str, about: &str) -> Node;

    /// Reads the tree's form back, or says what was wanted.
    ///
    /// # Errors
    /// The name of the wanted type when the node has another one.
    fn from_node(node: &Node) -> Result<Self, &'static str>;
}

macro_rules! scalar_field {
    ($type:ty, $wanted:literal, $self:ident, $unit:ident => $to:expr, $node:pat => $from:expr) => {
        impl Field for $type {
            fn to_node(&self, $unit: &str, _about: &str) -> Node {
                let $self = self;
                $to
            }
            fn from_node(node: &Node) -> Result<Self, &'static str> {
                match node {
                    $node => Ok($from),
                    _ => Err($wanted),
                }
            }
        }
    };
}
scalar_field!(f64, "real", v, unit => Node::Real { value: *v, unit: unit.to_owned() }, Node::Real { value, .. } => *value);
scalar_field!(i64, "whole number", v, _unit => Node::Int(*v), Node::Int(value) => *value);
scalar_field!(bool, "flag", v, _unit => Node::Flag(*v), Node::Flag(value) => *value);
scalar_field!(String, "text", v, _unit => Node::Text(v.clone()), Node::Text(value) => value.clone());
scalar_field!(Vec<u8>, "bytes", v, _unit => Node::Bytes(v.clone()), Node::Bytes(value) => value.clone());
scalar_field!(Table, "table", v, _unit => Node::Table(v.clone()), Node::Table(value) => value.clone());
scalar_field!(Group, "group", v, _unit => Node::Group(v.clone()), Node::Group(value) => value.clone());

macro_rules! array_field {
    ($type:ty, $values:ident, $wanted:literal) => {
        impl Field for Vec<$type> {
            fn to_node(&self, unit: &str, about: &str) -> Node {
                Node::Array(Array {
                    shape: vec![self.len()],
                    unit: unit.to_owned(),
                    about: about.to_owned(),
                    values: Values::$values(self.clone()),
                })
            }
            fn from_node(node: &Node) -> Result<Self, &'static str> {
                match node {
                    Node::Array(Array { values: Values::$values(values), shape, .. }) if shape.len() == 1 => {
                        Ok(values.clone())
                    }
                    _ => Err($wanted),
                }
            }
        }
    };
}
array_field!(f64, Reals, "reals");
array_field!(i64, Ints, "whole numbers");
array_field!(String, Texts, "texts");

/// Vectors of the plane or of space: an array of shape (n, D).
impl<const D: usize> Field for Vec<[f64; D]> {
    fn to_node(&self, unit: &str, about: &str) -> Node {
        Node::Array(Array {
            shape: vec![self.len(), D],
            unit: unit.to_owned(),
            about: about.to_owned(),
            values: Values::Reals(self.as_flattened().to_vec()),
        })
    }
    fn from_node(node: &Node) -> Result<Self, &'static str> {
        match node {
            Node::Array(Array { values: Values::Reals(values), shape, .. }) if shape.len() == 2 && shape[1] == D => {
                Ok(values.as_chunks::<D>().0.to_vec())
            }
            _ => Err("vectors"),
        }
    }
}

/// Declares an artifact: its struct, its kind and version, and the conversions both ways.
///
/// ```
/// use flow::artifact::ArtifactKind;
/// const CURVE: ArtifactKind = ArtifactKind::new("curve", 1);
/// flow::artifact! {
///     /// A stress–strain curve.
///     pub struct Curve = CURVE {
///         /// Axial strain, shortening positive.
///         pub strain: Vec<f64>, "";
///         /// Axial stress, compression positive.
///         pub stress: Vec<f64>, "Pa";
///     }
/// }
/// let curve = Curve { strain: vec![0.0, 1e-4], stress: vec![0.0, 3e6] };
/// let stored = curve.to_artifact();
/// assert_eq!(Curve::from_artifact(&stored), Ok(curve));
/// ```
///
/// The doc comment of a field is its description in the file, the text after it its unit. The expansion is the
/// struct itself, `KIND`, `to_artifact` and `from_artifact`; a missing or wrong field reads
/// `curve.strain: wanted reals, found text`.
#[macro_export]
macro_rules! artifact {
    ($(#[$attribute:meta])* $visible:vis struct $name:ident = $kind:path {
        $($(#[doc = $about:literal])* $field_visible:vis $field:ident : $type:ty, $unit:literal;)*
    }) => {
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq)]
        $visible struct $name { $($(#[doc = $about])* $field_visible $field: $type,)* }

        impl $name {
            /// The kind, by which ports accept it.
            pub const KIND: $crate::artifact::ArtifactKind = $kind;

            /// The storable form.
            pub fn to_artifact(&self) -> $crate::artifact::Artifact {
                let mut root = $crate::artifact::Group::new();
                $(root.put(stringify!($field),
                    $crate::artifact::Field::to_node(&self.$field, $unit, concat!($($about),*).trim()));)*
                $crate::artifact::Artifact::of($kind, root)
            }

            /// Reads the storable form.
            ///
            /// # Errors
            /// The field that is missing or has another type, or the kind or version that does not fit.
            pub fn from_artifact(artifact: &$crate::artifact::Artifact) -> Result<Self, $crate::artifact::Wanted> {
                $crate::artifact::expect_kind(artifact, $kind)?;
                Ok(Self { $($field: $crate::artifact::take(&artifact.root, $kind.name(), stringify!($field))?,)* })
            }
        }
    };
}

/// Checks kind and version; used by [`artifact!`](crate::artifact!).
///
/// # Errors
/// The kind or version that was wanted and found.
pub fn expect_kind(artifact: &super::Artifact, kind: super::ArtifactKind) -> Result<(), Wanted> {
    if artifact.is(kind) && artifact.version == kind.version() {
        return Ok(());
    }
    Err(Wanted {
        place: artifact.kind.clone(),
        wanted: format!("{kind} version {}", kind.version()),
        found: format!("{} version {}", artifact.kind, artifact.version),
    })
}

/// Reads one field of a group; used by [`artifact!`](crate::artifact!).
///
/// # Errors
/// What was wanted and found.
pub fn take<F: Field>(group: &Group, kind: &str, name: &str) -> Result<F, Wanted> {
    let fail = |wanted: &str, found: &str| Wanted {
        place: format!("{kind}.{name}"),
        wanted: wanted.to_owned(),
        found: found.to_owned(),
    };
    let node = group.get(name).ok_or_else(|| fail("a value", "nothing"))?;
    F::from_node(node).map_err(|wanted| fail(wanted, node.type_name()))
}
