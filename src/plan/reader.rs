//! serde's view of the tree: errors know the path to the value they are about, and a hole reads as whatever is wanted.

use super::node::{Entry, Node, Span, Step, Table, Value};
use serde::de::value::StrDeserializer;
use serde::de::{self, DeserializeSeed, Deserializer, Expected, IntoDeserializer, Unexpected, Visitor};
use std::fmt;

/// Why the tree could not be read as what was wanted, and where.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unread {
    /// Steps from the innermost outwards.
    path: Vec<Step>,
    /// What is wrong.
    pub(super) cause: Cause,
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cause {
    /// A required key is not there.
    Missing(&'static str),
    /// A key that nothing reads.
    Unknown(String, &'static [&'static str]),
    /// A word that is none of the known ones.
    Word(String, &'static [&'static str]),
    /// Another type or a value out of range: what was wanted.
    Wanted(String),
    /// What the type itself says.
    Other(String),
}

impl Unread {
    fn new(cause: Cause) -> Self {
        Self { path: Vec::new(), cause }
    }

    /// Steps from the outermost inwards.
    pub(super) fn path(&self) -> Vec<Step> {
        self.path.iter().rev().cloned().collect()
    }

    /// Whether a word was wanted that says how to read the rest.
    pub(super) fn is_about_a_word(&self) -> bool {
        matches!(&self.cause, Cause::Word(..)) || self.cause == Cause::Wanted(WORD.to_owned())
    }

    fn inside(mut self, step: Step) -> Self {
        self.path.push(step);
        self
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.cause)
    }
}

impl std::error::Error for Unread {}

impl de::Error for Unread {
    fn custom<T: fmt::Display>(message: T) -> Self {
        let message = message.to_string();
        let untagged = message.starts_with("data did not match any variant of untagged enum");
        Self::new(if untagged { Cause::Wanted("a value of another form".to_owned()) } else { Cause::Other(message) })
    }
    fn invalid_type(_: Unexpected<'_>, wanted: &dyn Expected) -> Self {
        Self::new(Cause::Wanted(in_words(&wanted.to_string())))
    }
    fn invalid_value(_: Unexpected<'_>, wanted: &dyn Expected) -> Self {
        Self::new(Cause::Wanted(in_words(&wanted.to_string())))
    }
    fn invalid_length(_: usize, wanted: &dyn Expected) -> Self {
        Self::new(Cause::Wanted(in_words(&wanted.to_string())))
    }
    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Self {
        Self::new(Cause::Word(word.to_owned(), known))
    }
    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::new(Cause::Unknown(name.to_owned(), known))
    }
    fn missing_field(name: &'static str) -> Self {
        Self::new(Cause::Missing(name))
    }
}

/// What a tag must be.
const WORD: &str = "one of the known words";

/// serde's names of types in the words of the workflow file.
fn in_words(wanted: &str) -> String {
    let words = match wanted {
        "f32" | "f64" => "a number",
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "u64" | "usize" => "a whole number of 0 or more",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a string" | "string" => "a text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a map" | "map" => "a table",
        "variant identifier" => WORD,
        other if other.starts_with("struct ") => "a table",
        other if other.starts_with("a nonzero ") => "a whole number of 1 or more",
        other => match other.strip_prefix("an array of length ") {
            Some(length) => return format!("a list of {length} values"),
            None => other,
        },
    };
    words.to_owned()
}

/// A table with its keys, as long as a person can take them in.
fn table_of(keys: &[&str]) -> String {
    match keys {
        [] => "a table".to_owned(),
        keys if keys.len() > 6 => "a table".to_owned(),
        [key] => format!("a table with the key `{key}`"),
        keys => format!("a table with the keys `{}`", keys.join("`, `")),
    }
}

/// Reads one node.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a>(pub(super) &'a Node);

impl<'a> Reader<'a> {
    fn hole(self) -> bool {
        matches!(self.0.value, Value::Hole)
    }
}

macro_rules! filled {
    ($($method:ident => $visit:ident($value:expr);)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
            if self.hole() { visitor.$visit($value) } else { self.deserialize_any(visitor) }
        }
    )*};
}

impl<'de> Deserializer<'de> for Reader<'de> {
    type Error = Unread;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        match &self.0.value {
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::Int(value) => visitor.visit_i64(*value),
            Value::Real(value) => visitor.visit_f64(*value),
            Value::Flag(value) => visitor.visit_bool(*value),
            Value::Date(_) => Err(de::Error::invalid_type(Unexpected::Other("date"), &visitor)),
            Value::List(list) => visitor.visit_seq(Items { items: list.iter().enumerate() }),
            Value::Table(table) => visitor.visit_map(Entries::new(table)),
            Value::Hole => visitor.visit_unit(),
            Value::Probe => visitor.visit_newtype_struct(Reader(&HOLE)),
        }
    }

    filled! {
        deserialize_bool => visit_bool(false);
        deserialize_i8 => visit_i64(1);
        deserialize_i16 => visit_i64(1);
        deserialize_i32 => visit_i64(1);
        deserialize_i64 => visit_i64(1);
        deserialize_u8 => visit_u64(1);
        deserialize_u16 => visit_u64(1);
        deserialize_u32 => visit_u64(1);
        deserialize_u64 => visit_u64(1);
        deserialize_f32 => visit_f64(1.0);
        deserialize_f64 => visit_f64(1.0);
        deserialize_char => visit_char('?');
        deserialize_str => visit_borrowed_str("?");
        deserialize_string => visit_borrowed_str("?");
        deserialize_seq => visit_seq(Holes { fields: &[], left: 0 });
        deserialize_map => visit_map(Holes { fields: &[], left: 0 });
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unread> {
        if self.hole() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Unread> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Unread> {
        match &self.0.value {
            Value::Hole => visitor.visit_seq(Holes { fields: &[], left: length }),
            Value::List(list) if list.len() != length => Err(de::Error::invalid_length(list.len(), &visitor)),
            _ => self.deserialize_any(visitor),
        }
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Unread> {
        self.deserialize_tuple(length, visitor)
    }

    /// Strict whatever the type says: a key that is none of the struct's fields is a fault.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unread> {
        match &self.0.value {
            Value::Hole => visitor.visit_map(Holes { fields, left: fields.len() }),
            Value::Table(table) => match table.0.keys().find(|name| !fields.contains(&name.as_str())) {
                Some(name) => Err(de::Error::unknown_field(name, fields)),
                None => self.deserialize_any(visitor),
            },
            _ => Err(Unread::new(Cause::Wanted(table_of(fields)))),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unread> {
        match &self.0.value {
            Value::Text(word) => visitor.visit_enum(Variant { word, content: None }),
            Value::Table(table) if table.0.len() == 1 => {
                let (word, entry) = table.0.iter().next().unwrap_or_else(|| panic!("BUG: one entry"));
                visitor.visit_enum(Variant { word, content: Some(&entry.node) })
            }
            Value::Hole => visitor.visit_enum(Variant { word: variants[0], content: Some(self.0) }),
            _ => Err(Unread::new(Cause::Wanted(format!("one of {}", variants.join(", "))))),
        }
    }

    serde::forward_to_deserialize_any! { i128 u128 bytes byte_buf unit unit_struct identifier ignored_any }
}

/// The values of a list.
struct Items<'a> {
    items: std::iter::Enumerate<std::slice::Iter<'a, Node>>,
}

impl<'a> de::SeqAccess<'a> for Items<'a> {
    type Error = Unread;

    fn next_element_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<Option<S::Value>, Unread> {
        let Some((i, node)) = self.items.next() else { return Ok(None) };
        seed.deserialize(Reader(node)).map(Some).map_err(|e| e.inside(Step::Index(i)))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len())
    }
}

/// The names and values of a table.
struct Entries<'a> {
    entries: std::collections::btree_map::Iter<'a, String, Entry>,
    value: Option<(&'a str, &'a Node)>,
}

impl<'a> Entries<'a> {
    fn new(table: &'a Table) -> Self {
        Self { entries: table.0.iter(), value: None }
    }
}

impl<'a> de::MapAccess<'a> for Entries<'a> {
    type Error = Unread;

    fn next_key_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<Option<S::Value>, Unread> {
        let Some((name, entry)) = self.entries.next() else { return Ok(None) };
        self.value = Some((name, &entry.node));
        seed.deserialize(de::value::BorrowedStrDeserializer::new(name)).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<S::Value, Unread> {
        let (name, node) = self.value.take().unwrap_or_else(|| panic!("BUG: a value is read before its name"));
        seed.deserialize(Reader(node)).map_err(|e| e.inside(Step::Key(name.to_owned())))
    }
}

/// What every hole reads from.
static HOLE: Node = Node { span: Span { source: 0, start: 0, end: 0 }, value: Value::Hole };

/// So many holes, with names when a struct is wanted.
struct Holes {
    fields: &'static [&'static str],
    left: usize,
}

impl<'a> de::SeqAccess<'a> for Holes {
    type Error = Unread;

    fn next_element_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<Option<S::Value>, Unread> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(Reader(&HOLE)).map(Some)
    }
}

impl<'a> de::MapAccess<'a> for Holes {
    type Error = Unread;

    fn next_key_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<Option<S::Value>, Unread> {
        let Some(name) = self.fields.get(self.fields.len().wrapping_sub(self.left)) else { return Ok(None) };
        self.left -= 1;
        seed.deserialize(StrDeserializer::new(name)).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'a>>(&mut self, seed: S) -> Result<S::Value, Unread> {
        seed.deserialize(Reader(&HOLE))
    }
}

/// A word, or a table with one word and what belongs to it.
struct Variant<'a> {
    word: &'a str,
    content: Option<&'a Node>,
}

impl<'a> Variant<'a> {
    fn content(self, wanted: &str) -> Result<(Step, Reader<'a>), Unread> {
        let step = Step::Key(self.word.to_owned());
        self.content.map(|node| (step, Reader(node))).ok_or_else(|| Unread::new(Cause::Wanted(wanted.to_owned())))
    }
}

impl<'a> de::EnumAccess<'a> for Variant<'a> {
    type Error = Unread;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'a>>(self, seed: S) -> Result<(S::Value, Self), Unread> {
        let word: StrDeserializer<'_, Unread> = self.word.into_deserializer();
        Ok((seed.deserialize(word)?, self))
    }
}

impl<'a> de::VariantAccess<'a> for Variant<'a> {
    type Error = Unread;

    fn unit_variant(self) -> Result<(), Unread> {
        match self.content.map(|node| &node.value) {
            None | Some(Value::Hole) => Ok(()),
            Some(_) => Err(Unread::new(Cause::Wanted(format!("the text \"{}\"", self.word)))),
        }
    }

    fn newtype_variant_seed<S: DeserializeSeed<'a>>(self, seed: S) -> Result<S::Value, Unread> {
        let (step, reader) = self.content("a table")?;
        seed.deserialize(reader).map_err(|e| e.inside(step))
    }

    fn tuple_variant<V: Visitor<'a>>(self, length: usize, visitor: V) -> Result<V::Value, Unread> {
        let (step, reader) = self.content("a table")?;
        reader.deserialize_tuple(length, visitor).map_err(|e| e.inside(step))
    }

    fn struct_variant<V: Visitor<'a>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Unread> {
        let (step, reader) = self.content("a table")?;
        reader.deserialize_struct("", fields, visitor).map_err(|e| e.inside(step))
    }
}
