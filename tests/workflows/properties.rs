//! What holds for any text or bytes in a file of a user: for the tests beside this file, and for `fuzz/`.
//!
//! Each function reads its input; an assertion fails if what is read is not sound.

use flow::expression::{Expression, Measure};
use flow::plan::{Overrides, parse};
use flow::stage::data;
use flow::unit::{Unit, parse_any};
use shape::{mend, stl};

/// A unit has a factor, and its inverse the inverse one.
pub(crate) fn unit(text: &str) {
    if let Ok(unit) = Unit::parse(text) {
        assert!(unit.factor.is_normal() && unit.factor > 0.0, "{unit:?}");
        let inverse = Unit::parse(&format!("1/({text})"));
        if let (Ok(inverse), false) = (inverse, text.trim().is_empty()) {
            assert!((inverse.factor * unit.factor - 1.0).abs() < 1e-9, "{inverse:?} {unit:?}");
        }
        if let Ok((value, dimension)) = parse_any(&format!("2 {text}")) {
            assert!(value.is_finite() && dimension == unit.dimension);
        }
    }
}

/// A bracket around a formula changes nothing.
pub(crate) fn formula(text: &str) {
    let Ok(formula) = Expression::parse(text) else { return };
    let values = vec![Measure::number(1.5); formula.names().len()];
    let value = formula.eval(&values).unwrap().value;
    let again = Expression::parse(&format!("({text})")).map(|same| same.eval(&values).unwrap().value);
    assert!(again.is_err() || again.is_ok_and(|again| again.to_bits() == value.to_bits() || again.is_nan()));
}

/// A table comes back from its text as it is.
pub(crate) fn table(text: &str) {
    let Ok(table) = data::parse(text.as_bytes()) else { return };
    assert!(table.rows() > 0 && table.columns.iter().all(|column| column.values.len() == table.rows()));
    let written = flow::export::csv_text(&table);
    let again = data::parse(written.as_bytes()).unwrap_or_else(|e| panic!("{e}: {written:?}"));
    assert_eq!(again.columns, table.columns, "{written:?}");
}

/// What is read has finite corners or is refused by what follows, and a surface that is closed has a volume.
pub(crate) fn surface(bytes: &[u8]) {
    let Ok(triangles) = stl::read(bytes, 1e-3) else { return };
    assert!(triangles.len() <= bytes.len());
    let Ok((mesh, _)) = mend::mend(&triangles) else { return };
    let (low, high) = mesh.extent();
    assert!(low.iter().chain(&high).all(|x| x.is_finite()) && mesh.surface() > 0.0);
    let again = stl::read(&stl::write(&mesh, 1e-3), 1e-3).unwrap();
    assert_eq!(again.len(), mesh.facets().len());
}

/// A table has as many cells in each column, or there is none.
pub(crate) fn workbook(bytes: &[u8]) {
    if let Ok(table) = data::parse(bytes) {
        assert!(table.rows() > 0 && table.columns.iter().all(|column| column.values.len() == table.rows()));
    }
}

/// A workflow is usable, or every fault points into its text.
pub(crate) fn workflow(text: &str, overrides: &Overrides) {
    match parse("fuzz.toml", text, overrides) {
        Ok(workflow) => {
            for (i, stage) in workflow.stages.iter().enumerate() {
                assert!(stage.inputs.iter().all(|(_, input)| *input < i), "an input comes after its stage");
                stage.stage.settings();
            }
        }
        Err(faults) => {
            assert!(!faults.is_empty(), "refused without a fault");
            for fault in &faults {
                let locations = fault.location.iter().chain(fault.also.iter().map(|(location, _)| location));
                for location in locations {
                    assert!(
                        location.source.text.get(location.span.clone()).is_some(),
                        "a fault points outside its text"
                    );
                    let (line, column) = location.line_column();
                    assert!(line > 0 && column > 0);
                }
            }
        }
    }
}
