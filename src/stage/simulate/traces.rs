//! Fissures from a CSV file, a row for each.
//!
//! | columns | meaning |
//! |---|---|
//! | `x`, `y`, in space `z` | middle, from that of the specimen: along the width, the axis of loading, the depth |
//! | `dip` | angle below the horizontal |
//! | `direction` (space only) | azimuth of the steepest descent, from the width towards the depth |
//! | `length` | length, or diameter of the disc |
//! | `x1`, `y1`, `x2`, `y2` | in place of all these, in the plane: the two ends |
//!
//! Every column has its unit in its head, `x [mm]`. Other columns are refused, so that none is overlooked.

use super::super::{StageError, data};
use crate::artifact::Table;
use dem::loading::fissure::Fissure;
use math::elementary::atan2;

/// Columns of middles in the plane and in space, and of ends.
const MIDDLE: [&str; 4] = ["x", "y", "dip", "length"];
const SPACE: [&str; 6] = ["x", "y", "z", "dip", "direction", "length"];
const ENDS: [&str; 4] = ["x1", "y1", "x2", "y2"];

/// The fissures of a file for a specimen of so many dimensions.
///
/// # Errors
/// A missing, unknown or unfit column, or a row with a missing value or a length of 0.
pub(super) fn read(bytes: &[u8], dimension: usize) -> Result<Vec<Fissure>, StageError> {
    let table = data::parse(bytes)?;
    let ends = dimension == 2 && ENDS.iter().any(|name| table.column(name).is_some());
    let wanted: &[&str] = match (ends, dimension) {
        (true, _) => &ENDS,
        (false, 2) => &MIDDLE,
        (false, _) => &SPACE,
    };
    let known = match dimension {
        2 => format!("{}; or {}", MIDDLE.join(", "), ENDS.join(", ")),
        _ => SPACE.join(", "),
    };
    if let Some(other) = table.columns.iter().find(|column| !wanted.contains(&column.name.as_str())) {
        let message = format!("column `{}` is none of a fissure's", other.name);
        return Err(StageError::new(message).hint(format!("the columns are {known}, each with its unit: `x [mm]`")));
    }
    let column = |name: &str| numbers(&table, name, &known);
    let columns = wanted.iter().map(|name| column(name)).collect::<Result<Vec<_>, StageError>>()?;
    let fissure = |row: usize| {
        let value = |k: usize| columns[k][row];
        let [centre, [dip, direction, length]] = match (ends, dimension) {
            (true, _) => {
                let (across, up) = (value(2) - value(0), value(3) - value(1));
                let centre = [0.5 * (value(0) + value(2)), 0.5 * (value(1) + value(3)), 0.0];
                [centre, [atan2(-up, across), 0.0, (across * across + up * up).sqrt()]]
            }
            (false, 2) => [[value(0), value(1), 0.0], [value(2), 0.0, value(3)]],
            (false, _) => [[value(0), value(1), value(2)], [value(3), value(4), value(5)]],
        };
        if length > 0.0 && length.is_finite() {
            return Ok(Fissure { centre, dip, direction, length: Some(length) });
        }
        Err(StageError::new(format!("row {}: the length of the fissure is {length} m; it must be above 0", row + 1)))
    };
    (0..table.rows()).map(fissure).collect()
}

/// The numbers of a column, in metres or radians.
fn numbers(table: &Table, name: &str, known: &str) -> Result<Vec<f64>, StageError> {
    let unit = if matches!(name, "dip" | "direction") { "rad" } else { "m" };
    let example = if unit == "rad" { "deg" } else { "mm" };
    let hint = || format!("the columns are {known}, each with its unit: `{name} [{example}]`");
    let found = table.numbers(name, unit).map_err(|unread| StageError::new(unread.to_string()).hint(hint()))?;
    match found.iter().position(|value| !value.is_finite()) {
        Some(row) => Err(StageError::new(format!("row {}: `{name}` has no value", row + 1))),
        None => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::elementary::{cos, sin};
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, SQRT_2};

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn middles_and_ends_say_the_same() {
        let middles = b"x [mm],y [mm],dip [deg],length [cm]\n5,-2,45,2\n0,1,0,1\n";
        let half = 10.0 * FRAC_1_SQRT_2;
        let ends = format!(
            "x1 [mm],y1 [mm],x2 [mm],y2 [mm]\n{},{},{},{}\n5,1,-5,1\n",
            5.0 - half,
            -2.0 + half,
            5.0 + half,
            -2.0 - half
        );
        let [a, b] = [&middles[..], ends.as_bytes()].map(|text| read(text, 2).unwrap());
        for (a, b) in a.iter().zip(&b) {
            assert!(near(a.length.unwrap(), b.length.unwrap()), "{a:?} {b:?}");
            assert!((0..3).all(|k| near(a.centre[k], b.centre[k])), "{a:?} {b:?}");
            // The same line, whichever of its ends comes first.
            assert!(near(sin(a.dip - b.dip), 0.0), "{a:?} {b:?}");
        }
        assert!(near(a[0].centre[0], 5e-3) && near(a[0].length.unwrap(), 0.02) && near(a[0].dip, FRAC_PI_4));
        // It descends towards x.
        assert!(near(cos(b[0].dip), 1.0 / SQRT_2) && near(sin(b[0].dip), 1.0 / SQRT_2));
    }

    #[test]
    fn discs_have_a_depth_and_a_direction() {
        let text = b"x [m],y [m],z [m],dip [deg],direction [deg],length [m]\n0.1,0.2,0.3,90,90,0.5\n";
        let [one] = read(text, 3).unwrap()[..] else { panic!() };
        assert_eq!((one.centre, one.length), ([0.1, 0.2, 0.3], Some(0.5)));
        let normal = one.normal();
        assert!(near(normal[0], 0.0) && near(normal[1], 0.0) && near(normal[2], 1.0), "{normal:?}");
    }

    #[test]
    fn faults_name_the_column_and_the_row() {
        let fault = |text: &str, dimension: usize| {
            let error = read(text.as_bytes(), dimension).unwrap_err();
            format!("{} | {}", error.message, error.hint.unwrap_or_default())
        };
        for (text, dimension, wanted) in [
            ("x,y [mm],dip [deg],length [mm]\n1,2,3,4\n", 2, "`x [mm]`"),
            ("x [mm],y [mm],dip [mm],length [mm]\n1,2,3,4\n", 2, "`dip [deg]`"),
            ("x [mm],y [mm],dip [deg],aperture [mm],length [mm]\n1,2,3,4,5\n", 2, "`aperture`"),
            ("x [mm],y [mm],z [mm],dip [deg],length [mm]\n1,2,3,4,5\n", 2, "`z`"),
            ("x [mm],y [mm],dip [deg],length [mm]\n1,2,3,4\n", 3, "`z"),
            ("x [mm],y [mm],dip [deg],length [mm]\n1,2,3,0\n", 2, "row 1"),
            ("x [mm],y [mm],dip [deg],length [mm]\n1,2,3,4\n1,,3,4\n", 2, "row 2: `y`"),
            ("x1 [mm],y1 [mm],x2 [mm],y2 [mm]\n1,2,1,2\n", 2, "row 1"),
        ] {
            let found = fault(text, dimension);
            assert!(found.contains(wanted), "{found}");
        }
    }
}
