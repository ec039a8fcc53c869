//! The units in which people of the field read quantities that are stored in SI units.
//!
//! A response or factor is shown in the unit that the workflow declares (`[response.NAME]`, `[factor.NAME]`). Any other
//! quantity in pascal gets the prefix that leaves one to three digits before the point; lengths below a decimetre are shown
//! in millimetres, forces from a thousand newtons on in kilonewtons.

use super::Context;
use crate::artifact::run::Run;
use crate::artifact::{Artifact, ArtifactKind, Column, Group, Node, Table, Values};
use crate::unit::Conversion;
use dem::loading::kind::KINDS;

/// The symbol that a test gives to a response, in the notation of labels, for pages where the workflow declares none.
pub fn symbol_of_test(name: &str) -> Option<&'static str> {
    let mut responses = KINDS.iter().flat_map(|kind| kind.responses());
    responses.find(|response| response.name == name).map(|response| response.symbol)
}

/// The unit of the field for a column whose largest value is `largest` in `unit`.
pub(super) fn field_unit(unit: &str, largest: f64) -> String {
    let shown = match unit {
        "Pa" if (1e3..1e6).contains(&largest) => "kPa",
        "Pa" if (1e6..1e9).contains(&largest) => "MPa",
        "Pa" if largest >= 1e9 => "GPa",
        "m" if largest < 0.1 => "mm",
        "N" if largest >= 1e3 => "kN",
        "N/m" if largest >= 1e9 => "GN/m",
        "N/m" if largest >= 1e6 => "MN/m",
        "N/m" if largest >= 1e3 => "kN/m",
        own => own,
    };
    shown.to_owned()
}

/// The unit in which a quantity is shown: the one that the workflow declares, or that of the field.
pub(super) fn shown_unit(declared: Option<&String>, unit: &str, value: f64) -> String {
    match declared {
        Some(wanted) if Conversion::between(unit, wanted).is_ok() => wanted.clone(),
        _ => field_unit(unit, value.abs()),
    }
}

/// A result in the units of readers: every column and every number of its groups in the declared unit or that of the field.
/// Arrays stay as stored, for programs. The responses of a single run get the columns of validity that tables of runs have.
#[must_use]
pub fn presented(artifact: &Artifact, context: &Context) -> Artifact {
    // printed tables and the numbers of figures are in the units of readers already
    if artifact.is(ArtifactKind::PICTURE) || artifact.is(ArtifactKind::TABLE) {
        return artifact.clone();
    }
    let shown = Artifact { root: group(&artifact.root, context), ..artifact.clone() };
    if artifact.is(ArtifactKind::RUN) { Run::judged(&shown) } else { shown }
}

fn group(own: &Group, context: &Context) -> Group {
    own.iter().fold(Group::new(), |shown, (name, node)| shown.with(name, self::node(name, node, context)))
}

fn node(name: &str, node: &Node, context: &Context) -> Node {
    match node {
        Node::Group(inner) => Node::Group(group(inner, context)),
        Node::Table(table) => Node::Table(shown_table(table, context)),
        Node::Real { value, unit } => {
            let shown = shown_unit(declared(name, context), unit, *value);
            let value = Conversion::between(unit, &shown).map_or(*value, |to| to.of(*value));
            Node::Real { value, unit: shown }
        }
        Node::Array(_) | Node::Text(_) | Node::Int(_) | Node::Flag(_) | Node::Bytes(_) => node.clone(),
    }
}

/// The unit that the workflow declares for a response.
fn declared<'a>(name: &str, context: &'a Context) -> Option<&'a String> {
    context.responses.get(name).map(|response| &response.unit)
}

fn shown_table(table: &Table, context: &Context) -> Table {
    let texts = |name: &str| match table.column(name).map(|column| &column.values) {
        Some(Values::Texts(texts)) => Some(texts),
        Some(_) | None => None,
    };
    // quantities row by row have their units in a column of their own
    if let (Some(units), Ok((values, _))) = (texts("unit"), table.shown("value")) {
        let name = |row: usize| texts("response").map_or("", |names| names[row].as_str());
        let unit = |row: usize| shown_unit(declared(name(row), context), &units[row], values[row]);
        let shown: Vec<String> = (0..units.len()).map(unit).collect();
        let convert = |(row, value): (usize, &f64)| {
            Conversion::between(&units[row], &shown[row]).map_or(*value, |to| to.of(*value))
        };
        let column = |column: &Column| match column.name.as_str() {
            "unit" => Column { values: Values::Texts(shown.clone()), ..column.clone() },
            "value" => {
                let values = values.iter().enumerate().map(convert).collect();
                Column { values: Values::Reals(values), ..column.clone() }
            }
            _ => column.clone(),
        };
        return Table { about: table.about.clone(), columns: table.columns.iter().map(column).collect() };
    }
    let columns = table.columns.iter().map(|column| shown_column(column, context)).collect();
    Table { about: table.about.clone(), columns }
}

fn shown_column(column: &Column, context: &Context) -> Column {
    let Values::Reals(values) = &column.values else { return column.clone() };
    let largest = values.iter().filter(|v| v.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
    let unit = shown_unit(declared(&column.name, context), &column.unit, largest);
    match Conversion::between(&column.unit, &unit) {
        Ok(to) if !to.is_identity() => {
            Column { unit, values: Values::Reals(to.of_all(values.clone())), ..column.clone() }
        }
        _ => column.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::Response;

    #[test]
    fn declared_units_come_first_and_no_pascal_is_left_bare() {
        let mut context = Context::default();
        context.responses.insert("E".into(), Response { unit: "MPa".into(), ..Response::default() });
        let words = |list: &[&str]| list.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();
        let responses = Table::default()
            .texts_column("response", "", words(&["E", "UCS", "nu", "seating"]))
            .reals_column("value", "", "", vec![2.87e10, 3.52e7, 0.203, 5e3])
            .texts_column("unit", "", words(&["Pa", "Pa", "", "Pa"]));
        let curve = Table::default()
            .reals_column("axial_strain", "", "", vec![0.0, 1e-3])
            .reals_column("stress", "Pa", "", vec![0.0, 3.52e7])
            .reals_column("x", "m", "", vec![-0.01, 0.05]);
        let root = Group::new()
            .with("responses", Node::Table(responses))
            .with("curve", Node::Table(curve))
            .with("width", Node::Real { value: 0.05, unit: "m".into() });
        let shown = presented(&Artifact::of(ArtifactKind::RUN, root), &context);
        let responses = shown.table("responses").unwrap();
        let values = responses.shown("value").unwrap().0;
        for (found, wanted) in values.iter().zip([28_700.0, 35.2, 0.203, 5.0]) {
            assert!((found - wanted).abs() < 1e-12 * wanted, "{values:?}");
        }
        let units = responses.column("unit").unwrap();
        assert_eq!(units.values, Values::Texts(words(&["MPa", "MPa", "", "kPa"])));
        let curve = shown.table("curve").unwrap();
        let units: Vec<&str> = curve.columns.iter().map(|c| c.unit.as_str()).collect();
        assert_eq!(units, ["", "MPa", "mm"]);
        assert!((curve.shown("x").unwrap().0[1] - 50.0).abs() < 1e-12);
        assert_eq!(shown.root.get("width"), Some(&Node::Real { value: 50.0, unit: "mm".into() }));
    }
}
