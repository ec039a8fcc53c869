//! `platen_speed`: the speed of a test, and whether it adapts.

use crate::unit::{Rate, Velocity};
use dem::loading::pace::Pace;
use dem::loading::speed::Speed;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::de::{self, Deserialize, Deserializer, MapAccess};
use std::borrow::Cow;
use std::fmt;

/// The speed of a test: `"0.02 m/s"`, `{ strain_rate = "0.1 s^-1" }`, `{ transits = 100 }`, each of these with
/// `adaptive = true`, or `"adaptive"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlatenSpeed {
    /// The speed; of an adaptive test the slow one.
    pub speed: Speed,
    /// Whether it adapts.
    #[serde(default)]
    pub pace: Pace,
}

/// The slow speed of `"adaptive"`: that of a strong quasi-static test.
const ADAPTIVE: Speed = Speed::Transits(80.0);
/// The word in a workflow.
const WORD: &str = "adaptive";
/// The keys of its table.
const KEYS: [&str; 4] = ["speed", "strain_rate", "transits", WORD];

impl PlatenSpeed {
    /// A constant speed.
    pub const fn fixed(speed: Speed) -> Self {
        Self { speed, pace: Pace::Fixed }
    }
}

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
            "a velocity with its unit, such as \"0.02 m/s\", \"adaptive\", or a table with one of `speed`, `strain_rate` and `transits`, such as { transits = 100 } or { speed = \"0.02 m/s\", adaptive = true }",
        )
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<PlatenSpeed, E> {
        if text == WORD {
            return Ok(PlatenSpeed { speed: ADAPTIVE, pace: Pace::Adaptive });
        }
        Velocity::parse(text).map(|speed| PlatenSpeed::fixed(Speed::Each(speed.get()))).map_err(E::custom)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PlatenSpeed, A::Error> {
        let (mut speeds, mut adaptive) = (Vec::new(), false);
        while let Some(key) = map.next_key::<Cow<'_, str>>()? {
            match key.as_ref() {
                "speed" => speeds.push(Speed::Each(map.next_value::<Velocity>()?.get())),
                "strain_rate" => speeds.push(Speed::StrainRate(map.next_value::<Rate>()?.get())),
                "transits" => speeds.push(Speed::Transits(map.next_value()?)),
                WORD => adaptive = map.next_value()?,
                other => return Err(de::Error::unknown_field(other, &KEYS)),
            }
        }
        let pace = if adaptive { Pace::Adaptive } else { Pace::Fixed };
        match speeds[..] {
            [speed] => Ok(PlatenSpeed { speed, pace }),
            [] if adaptive => Ok(PlatenSpeed { speed: ADAPTIVE, pace }),
            _ => Err(de::Error::custom("give one of `speed`, `strain_rate` and `transits`")),
        }
    }

    /// Placeholder for a faulty value whose fault has been reported.
    fn visit_unit<E: de::Error>(self) -> Result<PlatenSpeed, E> {
        Ok(PlatenSpeed::fixed(Speed::Each(0.02)))
    }
}

impl JsonSchema for PlatenSpeed {
    fn schema_name() -> Cow<'static, str> {
        "platen_speed".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (velocity, rate) = (generator.subschema_for::<Velocity>(), generator.subschema_for::<Rate>());
        let adaptive = json_schema!({ "type": "boolean", "description": "Whether this is the slow speed of a test that goes faster while nothing breaks." });
        let one = |key: &str, of: &Schema| json_schema!({ "type": "object", "properties": { key: of, WORD: adaptive }, "required": [key], "additionalProperties": false });
        let transits = json_schema!({ "type": "number", "exclusiveMinimum": 0 });
        json_schema!({
            "description": "Speed of each platen or grip, the strain rate of the specimen, or how many times a wave runs through its height before the bonds can be expected to fail; with `adaptive` the slow speed, from which the test goes faster while nothing breaks.",
            "anyOf": [
                velocity,
                { "const": WORD },
                one("speed", &velocity), one("strain_rate", &rate), one("transits", &transits),
                { "type": "object", "properties": { WORD: { "const": true } }, "required": [WORD], "additionalProperties": false },
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

    fn read(text: &str) -> Result<PlatenSpeed, String> {
        let file: Result<File, _> = toml::from_str(text);
        file.map(|file| file.platen_speed).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn spellings_of_a_speed_and_no_other() {
        let fixed = |speed| Ok(PlatenSpeed::fixed(speed));
        let adaptive = |speed| Ok(PlatenSpeed { speed, pace: Pace::Adaptive });
        assert_eq!(read("platen_speed = \"20 mm/s\""), fixed(Speed::Each(0.02)));
        assert_eq!(read("platen_speed = { speed = \"20 mm/s\" }"), fixed(Speed::Each(0.02)));
        assert_eq!(read("platen_speed = { strain_rate = \"0.2 s^-1\" }"), fixed(Speed::StrainRate(0.2)));
        assert_eq!(read("platen_speed = { transits = 100, adaptive = false }"), fixed(Speed::Transits(100.0)));
        assert_eq!(read("platen_speed = \"adaptive\""), adaptive(Speed::Transits(80.0)));
        assert_eq!(read("platen_speed = { adaptive = true }"), adaptive(Speed::Transits(80.0)));
        assert_eq!(read("platen_speed = { adaptive = true, speed = \"20 mm/s\" }"), adaptive(Speed::Each(0.02)));
        let bad = [
            "0.02",
            "\"0.02\"",
            "\"adapt\"",
            "{ transit = 100 }",
            "{}",
            "{ transits = 100, strain_rate = \"1 s^-1\" }",
        ];
        for bad in bad {
            assert!(read(&format!("platen_speed = {bad}")).is_err(), "{bad}");
        }
    }
}
