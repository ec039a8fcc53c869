//! The report on a specimen as a table.

use crate::artifact::Table;
use dem::genesis::quality::Quality;

/// Quantities, values and units; `balls` is the word for what is packed, `groups` the names of its groups.
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
