//! `platen_speed`: how fast a test is driven, in one of three spellings.

use crate::unit::{Rate, Velocity};
use dem::loading::speed::Speed;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::de::{self, Deserialize, Deserializer, MapAccess};
use std::borrow::Cow;
use std::fmt;

/// How fast a test is driven: `"0.02 m/s"`, `{ strain_rate = "0.1 s^-1" }` or `{ transits = 100 }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlatenSpeed(pub Speed);

/// The keys of its table.
const KEYS: [&str; 2] = ["strain_rate", "transits"];

impl<'de> Deserialize<'de> for PlatenSpeed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Visitor)
    }
}

struct Visitor;

impl<'de> de::Visitor<'de> for Visitor {
    type Value = PlatenSpeed;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "a velocity with its unit, such as \"0.02 m/s\", or { strain_rate = \"0.1 s^-1\" }, or { transits = 100 }",
        )
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<PlatenSpeed, E> {
        Velocity::parse(text).map(|speed| PlatenSpeed(Speed::Each(speed.get()))).map_err(E::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PlatenSpeed, A::Error> {
        let one = || de::Error::custom("give one of `strain_rate` and `transits`");
        let Some(key) = map.next_key::<Cow<'_, str>>()? else { return Err(one()) };
        let speed = match key.as_ref() {
            "strain_rate" => Speed::StrainRate(map.next_value::<Rate>()?.get()),
            "transits" => Speed::Transits(map.next_value()?),
            other => return Err(de::Error::unknown_field(other, &KEYS)),
        };
        match map.next_key::<Cow<'_, str>>()? {
            None => Ok(PlatenSpeed(speed)),
            Some(other) if KEYS.contains(&other.as_ref()) => Err(one()),
            Some(other) => Err(de::Error::unknown_field(&other, &KEYS)),
        }
    }

    /// A hole: the value was faulty and that was reported already.
    fn visit_unit<E: de::Error>(self) -> Result<PlatenSpeed, E> {
        Ok(PlatenSpeed(Speed::Each(0.02)))
    }
}

impl JsonSchema for PlatenSpeed {
    fn schema_name() -> Cow<'static, str> {
        "platen_speed".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (velocity, rate) = (generator.subschema_for::<Velocity>(), generator.subschema_for::<Rate>());
        json_schema!({
            "description": "Speed of each platen or grip, the strain rate of the specimen, or how many times a wave runs through its height before the bonds can be expected to fail.",
            "anyOf": [
                velocity,
                { "type": "object", "properties": { "strain_rate": rate }, "required": ["strain_rate"], "additionalProperties": false },
                { "type": "object", "properties": { "transits": { "type": "number", "exclusiveMinimum": 0 } }, "required": ["transits"], "additionalProperties": false },
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    struct File {
        platen_speed: PlatenSpeed,
    }

    fn read(text: &str) -> Result<Speed, String> {
        let file: Result<File, _> = toml::from_str(text);
        file.map(|file| file.platen_speed.0).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn three_spellings_and_no_other() {
        assert_eq!(read("platen_speed = \"20 mm/s\""), Ok(Speed::Each(0.02)));
        assert_eq!(read("platen_speed = { strain_rate = \"0.2 s^-1\" }"), Ok(Speed::StrainRate(0.2)));
        assert_eq!(read("platen_speed = { transits = 100 }"), Ok(Speed::Transits(100.0)));
        for bad in ["0.02", "\"0.02\"", "{ transit = 100 }", "{}", "{ transits = 100, strain_rate = \"1 s^-1\" }"] {
            assert!(read(&format!("platen_speed = {bad}")).is_err(), "{bad}");
        }
    }
}
