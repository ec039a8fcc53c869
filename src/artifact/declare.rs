//! The declarations of artifacts and of their tables.

use super::{Artifact, ArtifactKind, Wanted};

/// Declares an artifact: its struct, its kind, and the conversions both ways.
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
/// The doc comment of a field is its description in the file, the text after it its unit: numbers come back in it,
/// whatever unit the file has. The expansion is the struct itself, `KIND`, `to_artifact` and `from_artifact`; a missing
/// or wrong field reads `curve.strain: wanted reals, found text`.
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
            $visible const KIND: $crate::artifact::ArtifactKind = $kind;

            /// The storable form.
            $visible fn to_artifact(&self) -> $crate::artifact::Artifact {
                let mut root = $crate::artifact::Group::new();
                $($crate::artifact::Field::put(
                    &self.$field, &mut root, stringify!($field), $unit, concat!($($about),*).trim());)*
                $crate::artifact::Artifact::of($kind, root)
            }

            /// Reads the storable form.
            ///
            /// # Errors
            /// The field that is missing or has another type or unit, or the kind or version that does not fit.
            $visible fn from_artifact(artifact: &$crate::artifact::Artifact) -> Result<Self, $crate::artifact::Wanted> {
                $crate::artifact::expect_kind(artifact, $kind)?;
                Ok(Self { $($field: $crate::artifact::Field::take(&artifact.root, stringify!($field), $unit)
                    .map_err(|wanted| wanted.within($kind.name()))?,)* })
            }
        }
    };
}

/// Declares a table of an artifact: a struct with a list per column, which is a [`Field`](super::Field).
///
/// ```
/// flow::table! {
///     /// stress and strains at even axial strains
///     pub struct Curve {
///         /// shortening positive
///         pub axial_strain: Vec<f64>, "";
///         /// compression positive
///         pub stress: Vec<f64>, "Pa";
///     }
/// }
/// let curve = Curve { axial_strain: vec![0.0, 1e-4], stress: vec![0.0, 3e6] };
/// let table = curve.to_table();
/// assert_eq!(table.numbers("stress", "MPa"), Ok(vec![0.0, 3.0]));
/// assert_eq!(Curve::from_table(&table), Ok(curve));
/// ```
///
/// The doc comments are the descriptions in the file. A column is a [`Cells`](super::Cells) type; a field of type
/// [`Table`](super::Table) holds the columns that the declaration does not name, where it stands.
#[macro_export]
macro_rules! table {
    ($(#[doc = $about:literal])* $visible:vis struct $name:ident {
        $($(#[doc = $column_about:literal])* $field_visible:vis $field:ident : $type:ty, $unit:literal;)*
    }) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, Default, PartialEq)]
        $visible struct $name { $($(#[doc = $column_about])* $field_visible $field: $type,)* }

        impl $name {
            /// The storable form.
            $visible fn to_table(&self) -> $crate::artifact::Table {
                let mut table =
                    $crate::artifact::Table { about: concat!($($about),*).trim().to_owned(), columns: Vec::new() };
                $($crate::artifact::Cells::put(
                    &self.$field, &mut table, stringify!($field), $unit, concat!($($column_about),*).trim());)*
                table
            }

            /// Reads the storable form.
            ///
            /// # Errors
            /// The column that is missing or has another type or unit.
            $visible fn from_table(table: &$crate::artifact::Table) -> Result<Self, $crate::artifact::Unread> {
                let mut read = Self { $($field: $crate::artifact::Cells::take(table, stringify!($field), $unit)?,)* };
                let declared = [$(stringify!($field)),*];
                $($crate::artifact::Cells::take_undeclared(&mut read.$field, table, &declared);)*
                Ok(read)
            }
        }

        impl $crate::artifact::Field for $name {
            fn put(&self, group: &mut $crate::artifact::Group, name: &str, _unit: &str, _about: &str) {
                group.put(name, $crate::artifact::Node::Table(self.to_table()));
            }
            fn take(
                group: &$crate::artifact::Group,
                name: &str,
                unit: &str,
            ) -> Result<Self, $crate::artifact::Wanted> {
                let table = <$crate::artifact::Table as $crate::artifact::Field>::take(group, name, unit)?;
                Self::from_table(&table)
                    .map_err(|unread| $crate::artifact::Wanted::new(name, "its columns", unread.to_string()))
            }
        }
    };
}

/// Declares a group of an artifact: a struct whose fields stand together below one name.
///
/// ```
/// flow::group! {
///     /// A law.
///     pub struct Law {
///         /// its coefficient
///         pub coefficient: f64, "MPa";
///     }
/// }
/// let mut root = flow::artifact::Group::new();
/// flow::artifact::Field::put(&Law { coefficient: 2.0 }, &mut root, "law", "", "");
/// assert_eq!(flow::artifact::Field::take(&root, "law", ""), Ok(Law { coefficient: 2.0 }));
/// ```
#[macro_export]
macro_rules! group {
    ($(#[$attribute:meta])* $visible:vis struct $name:ident {
        $($(#[doc = $about:literal])* $field_visible:vis $field:ident : $type:ty, $unit:literal;)*
    }) => {
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq)]
        $visible struct $name { $($(#[doc = $about])* $field_visible $field: $type,)* }

        impl $crate::artifact::Field for $name {
            fn put(&self, group: &mut $crate::artifact::Group, name: &str, _unit: &str, _about: &str) {
                let mut own = $crate::artifact::Group::new();
                $($crate::artifact::Field::put(
                    &self.$field, &mut own, stringify!($field), $unit, concat!($($about),*).trim());)*
                group.put(name, $crate::artifact::Node::Group(own));
            }
            fn take(
                group: &$crate::artifact::Group,
                name: &str,
                unit: &str,
            ) -> Result<Self, $crate::artifact::Wanted> {
                let own = <$crate::artifact::Group as $crate::artifact::Field>::take(group, name, unit)?;
                Ok(Self { $($field: $crate::artifact::Field::take(&own, stringify!($field), $unit)
                    .map_err(|wanted| wanted.within(name))?,)* })
            }
        }
    };
}

/// Checks kind and version; used by [`artifact!`](crate::artifact!).
///
/// # Errors
/// The kind or version that was wanted and found.
pub fn expect_kind(artifact: &Artifact, kind: ArtifactKind) -> Result<(), Wanted> {
    if artifact.is(kind) && artifact.version == kind.version() {
        return Ok(());
    }
    let wanted = format!("{kind} version {}", kind.version());
    Err(Wanted::new(&artifact.kind, wanted, format!("{} version {}", artifact.kind, artifact.version)))
}
