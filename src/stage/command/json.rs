//! JSON as programs leave it: the only reader of it.
//!
//! Two things that the standard leaves open are settled here (RFC 8259, section 4: names "SHOULD be unique"). A key that
//! stands twice in one object is refused, because one of its values would be dropped without a word. `NaN`, which many
//! programs write although JSON has none, is read as `null`; infinities are read as texts, so that they are refused by name.

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// The value that a text holds.
///
/// # Errors
/// It is no JSON, or a key stands twice in one object.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    serde_json::from_str::<Unique>(&without_nan(text)).map(|unique| unique.0).map_err(|e| e.to_string())
}

/// A value without doubled keys.
struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Keys).map(Unique)
    }
}

/// Builds a value and compares keys.
struct Keys;

impl<'de> Visitor<'de> for Keys {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E: de::Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: de::Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Value, A::Error> {
        let mut all = Vec::new();
        while let Some(Unique(value)) = from.next_element()? {
            all.push(value);
        }
        Ok(all.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> Result<Value, A::Error> {
        let mut all = Map::new();
        while let Some((key, Unique(value))) = from.next_entry::<String, Unique>()? {
            if all.insert(key.clone(), value).is_some() {
                return Err(de::Error::custom(format!("the key `{key}` stands twice in one object")));
            }
        }
        Ok(all.into())
    }
}

/// The text with `null` for each bare `NaN`, and with infinities in quotes, where they are refused by name.
fn without_nan(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let (mut rest, mut quoted) = (text, false);
    while let Some(c) = rest.chars().next() {
        let bare = |word: &str| !quoted && rest.starts_with(word);
        let (taken, written) = if quoted && c == '\\' {
            let taken = rest.chars().take(2).map(char::len_utf8).sum();
            (taken, &rest[..taken])
        } else if bare("NaN") {
            (3, "null")
        } else if bare("-Infinity") {
            (9, "\"-Infinity\"")
        } else if bare("Infinity") {
            (8, "\"Infinity\"")
        } else {
            (c.len_utf8(), &rest[..c.len_utf8()])
        };
        quoted ^= c == '"';
        out.push_str(written);
        rest = &rest[taken..];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_that_stands_twice_is_refused() {
        for text in
            [r#"{"UCS": 1, "UCS": 2}"#, r#"[{"a": {"UCS": 1, "E": 2, "UCS": 1}}]"#, r#"{"UCS": 1, "\u0055CS": 1}"#]
        {
            assert!(
                parse(text).unwrap_err().starts_with("the key `UCS` stands twice in one object at line 1"),
                "{text}"
            );
        }
        let apart = r#"{"a": {"UCS": 1}, "b": [{"UCS": 2}, {"UCS": 3}], "c": [true, null, -1, 1e300, "x"]}"#;
        assert_eq!(parse(apart).unwrap(), serde_json::from_str::<Value>(apart).unwrap());
        assert!(parse(&"[".repeat(100_000)).unwrap_err().contains("recursion limit"));
    }

    #[test]
    fn words_within_quotes_stay() {
        let text = r#"{"note \"NaN": "NaN \\", "a": NaN, "b": -Infinity}"#;
        let value = parse(text).unwrap();
        assert_eq!(value, serde_json::json!({"note \"NaN": "NaN \\", "a": null, "b": "-Infinity"}));
    }
}
