//! Parameters of a task in few bytes: a fan-out has a hundred thousand tasks in memory, and a [`Value`] takes about a
//! kilobyte for every table in it.

use serde_json::{Map, Number, Value};

/// A JSON value in one piece of memory, without loss.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed(Box<[u8]>);

impl From<Value> for Packed {
    fn from(value: Value) -> Self {
        let mut bytes = Vec::with_capacity(128);
        pack(&mut bytes, &value);
        Self(bytes.into_boxed_slice())
    }
}

impl Packed {
    /// The value.
    pub fn value(&self) -> Value {
        let mut rest = &*self.0;
        unpack(&mut rest).unwrap_or_else(|| panic!("BUG: packed parameters that cannot be read"))
    }

    /// Its bytes as hexadecimal digits: a text that holds every bit of every number.
    pub fn to_hex(&self) -> String {
        self.0.iter().fold(String::with_capacity(2 * self.0.len()), |mut text, byte| {
            for digit in [byte >> 4, byte & 15] {
                text.push(char::from_digit(digit.into(), 16).unwrap_or('0'));
            }
            text
        })
    }

    /// The value of such a text; `None` when it is not one.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digit = |byte: u8| char::from(byte).to_digit(16);
        let (pairs, []) = text.as_bytes().as_chunks::<2>() else { return None };
        let byte = |[high, low]: &[u8; 2]| u8::try_from(digit(*high)? << 4 | digit(*low)?).ok();
        let bytes: Box<[u8]> = pairs.iter().map(byte).collect::<Option<_>>()?;
        let mut rest = &*bytes;
        unpack(&mut rest).filter(|_| rest.is_empty())?;
        Some(Self(bytes))
    }
}

const NULL: u8 = 0;
const FALSE: u8 = 1;
const TRUE: u8 = 2;
const UNSIGNED: u8 = 3;
const SIGNED: u8 = 4;
const REAL: u8 = 5;
const TEXT: u8 = 6;
const LIST: u8 = 7;
const TABLE: u8 = 8;

fn pack(bytes: &mut Vec<u8>, value: &Value) {
    match value {
        Value::Null => bytes.push(NULL),
        Value::Bool(flag) => bytes.push(if *flag { TRUE } else { FALSE }),
        Value::Number(number) => {
            let (tag, word) = match (number.as_u64(), number.as_i64()) {
                (Some(whole), _) => (UNSIGNED, whole),
                (None, Some(whole)) => (SIGNED, whole as u64),
                (None, None) => (REAL, number.as_f64().unwrap_or(f64::NAN).to_bits()),
            };
            bytes.push(tag);
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        Value::String(text) => {
            bytes.push(TEXT);
            push_text(bytes, text);
        }
        Value::Array(list) => {
            bytes.push(LIST);
            push_length(bytes, list.len());
            list.iter().for_each(|item| pack(bytes, item));
        }
        Value::Object(map) => {
            bytes.push(TABLE);
            push_length(bytes, map.len());
            for (name, value) in map {
                push_text(bytes, name);
                pack(bytes, value);
            }
        }
    }
}

fn push_text(bytes: &mut Vec<u8>, text: &str) {
    push_length(bytes, text.len());
    bytes.extend_from_slice(text.as_bytes());
}

/// Seven bits per byte, the lowest first; the last byte is below 128.
fn push_length(bytes: &mut Vec<u8>, mut length: usize) {
    while length > 127 {
        bytes.push(length as u8 | 128);
        length >>= 7;
    }
    bytes.push(length as u8);
}

fn unpack(rest: &mut &[u8]) -> Option<Value> {
    Some(match take(rest, 1)?[0] {
        NULL => Value::Null,
        FALSE => Value::Bool(false),
        TRUE => Value::Bool(true),
        UNSIGNED => word(rest)?.into(),
        SIGNED => (word(rest)? as i64).into(),
        REAL => Number::from_f64(f64::from_bits(word(rest)?)).map_or(Value::Null, Value::Number),
        TEXT => Value::String(text(rest)?),
        LIST => {
            let length = length(rest)?;
            Value::Array((0..length).map(|_| unpack(rest)).collect::<Option<_>>()?)
        }
        TABLE => {
            let length = length(rest)?;
            let entry = |rest: &mut &[u8]| Some((text(rest)?, unpack(rest)?));
            Value::Object((0..length).map(|_| entry(rest)).collect::<Option<Map<String, Value>>>()?)
        }
        _ => return None,
    })
}

fn take<'a>(rest: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (taken, left) = rest.split_at_checked(length)?;
    *rest = left;
    Some(taken)
}

fn word(rest: &mut &[u8]) -> Option<u64> {
    take(rest, 8)?.first_chunk().map(|word| u64::from_le_bytes(*word))
}

fn text(rest: &mut &[u8]) -> Option<String> {
    let length = length(rest)?;
    String::from_utf8(take(rest, length)?.to_vec()).ok()
}

fn length(rest: &mut &[u8]) -> Option<usize> {
    let mut length = 0;
    for shift in (0..usize::BITS).step_by(7) {
        let byte = take(rest, 1)?[0];
        length |= usize::from(byte & 127) << shift;
        if byte < 128 {
            return Some(length);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_value() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::Bool),
            any::<u64>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            any::<f64>().prop_map(Value::from),
            ".*".prop_map(Value::from),
            "[a-z]{100,300}".prop_map(Value::from),
        ];
        leaf.prop_recursive(4, 64, 8, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..8).prop_map(Value::from),
                prop::collection::btree_map(".{0,9}", inner, 0..8)
                    .prop_map(|map| Value::Object(map.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #[test]
        fn every_value_comes_back(value in any_value()) {
            let packed = Packed::from(value.clone());
            prop_assert_eq!(Packed::from_hex(&packed.to_hex()), Some(packed.clone()));
            prop_assert_eq!(packed.value(), value);
        }
    }

    #[test]
    fn a_text_that_is_no_packed_value_is_refused() {
        let hex = Packed::from(serde_json::json!({ "a": [1.5, null, "x"] })).to_hex();
        for wrong in ["", "0", "zz", "ff", &hex[..hex.len() - 2], &format!("{hex}00"), &format!("é{hex}")] {
            assert_eq!(Packed::from_hex(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn numbers_come_back_with_their_bits_and_their_type() {
        for number in [0.0, -0.0, 1.0, 1e300, f64::MIN_POSITIVE / 3.0] {
            let back = Packed::from(Value::from(number)).value();
            assert_eq!(back.as_f64().unwrap().to_bits(), f64::to_bits(number));
            assert!(back.is_f64());
        }
        assert!(Packed::from(Value::from(3_u64)).value().is_u64());
    }
}
