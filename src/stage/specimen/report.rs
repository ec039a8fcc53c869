//! The report on a specimen as a table.

use crate::artifact::{Table, Values};
use dem::genesis::mix::MixReport;
use dem::genesis::quality::Quality;

/// Quantities, values and units; `balls` is the word for the particles, `groups` the names of their groups.
pub(super) fn report(quality: &Quality, balls: &str, groups: &[String]) -> Table {
    let fabric = &quality.fabric;
    let held = quality.held;
    let contacts = quality.contacts.map(|count| count as f64);
    let with_aggregate = usize::from(quality.polygons > 0);
    let (one, aggregate) = match groups {
        [name] => (name.as_str(), ""),
        [name, aggregate] if with_aggregate == 1 => (name.as_str(), aggregate.as_str()),
        [.., aggregate] => (balls, aggregate.as_str()),
        [] => (balls, ""),
    };
    let mut rows = vec![
        (balls.to_owned(), quality.balls as f64, ""),
        ("mean radius".to_owned(), quality.mean_radius, "m"),
        ("smallest radius".to_owned(), quality.radius_range[0], "m"),
        ("largest radius".to_owned(), quality.radius_range[1], "m"),
        ("radii / those asked for".to_owned(), quality.radius_factor, ""),
        ("ball porosity".to_owned(), quality.porosity, ""),
        ("coordination (2 contacts / ball)".to_owned(), fabric.coordination, ""),
        ("bonds / ball at no gap".to_owned(), quality.bonds_per_ball, ""),
        (format!("{balls} with fewer than {held} contacts"), fabric.floaters as f64, ""),
        ("rounds of treating them".to_owned(), quality.floater_rounds as f64, ""),
        ("largest factor on their radius".to_owned(), quality.floater_growth, ""),
        ("taken out".to_owned(), quality.deleted as f64, ""),
        ("mean overlap / smaller radius".to_owned(), fabric.mean_overlap, ""),
        ("largest overlap / smaller radius".to_owned(), fabric.largest_overlap, ""),
        ("mean stress of the packing / modulus".to_owned(), fabric.mean_stress, ""),
        ("mean stress of the packing".to_owned(), quality.stress.unwrap_or(f64::NAN), "Pa"),
        ("stress anisotropy of the packing".to_owned(), fabric.anisotropy, ""),
        ("anisotropy of the contact normals".to_owned(), fabric.normals, ""),
        ("unbalanced force / contact force".to_owned(), quality.unbalanced, ""),
        (format!("{balls} across"), quality.particles_across, ""),
        (format!("contacts {one}-{one}"), contacts[0], ""),
    ];
    if quality.polygons > 0 {
        rows.extend([
            (format!("contacts {one}-{aggregate}"), contacts[1], ""),
            (format!("contacts {aggregate}-{aggregate}"), contacts[2], ""),
            ("area fraction of the size circles".to_owned(), quality.circle_fraction, ""),
            ("area fraction of the polygons".to_owned(), quality.polygon_fraction, ""),
            ("share of discs' area that is aggregate".to_owned(), quality.pebble_fraction, ""),
            ("polygons".to_owned(), quality.polygons as f64, ""),
            ("polygons without a disc".to_owned(), quality.empty_polygons as f64, ""),
        ]);
    }
    let (names, rest): (Vec<String>, Vec<(f64, &str)>) =
        rows.into_iter().map(|(name, value, unit)| (name, (value, unit))).unzip();
    Table { about: "quality of the specimen".to_owned(), columns: Vec::new() }
        .texts_column("quantity", "", names)
        .reals_column("value", "", "in the unit beside it", rest.iter().map(|row| row.0).collect())
        .texts_column("unit", "", rest.iter().map(|row| row.1.to_owned()).collect())
}

/// The report with the rows of a mix; contacts are those between mortar, of mortar and stones, between stones.
pub(super) fn with_mix(mut table: Table, mix: &MixReport, contacts: [usize; 3]) -> Table {
    let mut rows = Vec::new();
    for ([from, to], number, volume) in &mix.classes {
        let class = format!("stones of {} to {} mm", 1e3 * from, 1e3 * to);
        rows.push((class.clone(), *number as f64, ""));
        rows.push((format!("volume of {class}"), *volume, "m^3"));
    }
    rows.extend([
        ("pebbles of the stones".to_owned(), mix.pebbles as f64, ""),
        ("mortar balls".to_owned(), mix.balls as f64, ""),
        ("share of the volume that is stones".to_owned(), mix.stones, ""),
        ("ball porosity of the mortar between the stones".to_owned(), mix.mortar_porosity, ""),
        ("bulk density".to_owned(), mix.bulk_density, "kg/m^3"),
        ("density of the mortar balls".to_owned(), mix.ball_density, "kg/m^3"),
        ("share of stones at the walls / inside".to_owned(), mix.wall_effect, ""),
        ("contacts mortar-stone".to_owned(), contacts[1] as f64, ""),
        ("contacts stone-stone".to_owned(), contacts[2] as f64, ""),
    ]);
    for (name, value, unit) in rows {
        for column in &mut table.columns {
            match (&mut column.values, column.name.as_str()) {
                (Values::Reals(values), _) => values.push(value),
                (Values::Texts(values), "quantity") => values.push(name.clone()),
                (Values::Texts(values), _) => values.push(unit.to_owned()),
                (Values::Ints(_), _) => {}
            }
        }
    }
    table
}
