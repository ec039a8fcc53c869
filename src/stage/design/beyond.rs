//! Axial points that leave what a number of a material or a specimen can be.

use super::super::{Complaint, Context};
use design::DesignTable;
use design::table::PointType;
use figure::axis::significant;

/// A complaint for each factor whose axial points are below zero, where no other row is: a modulus or a strength that a factor
/// sets has no such value, and the run would fail.
pub(super) fn zero(table: &DesignTable, context: &Context) -> Vec<Complaint> {
    let is_axial = |row: &usize| table.point_type[*row] == PointType::Axial;
    let complaint = |(column, factor): (usize, &design::Factor)| {
        let sets = context.factors.get(&factor.name).is_some_and(|own| !own.sets.is_empty());
        let value = |row: usize| table.natural[row][column];
        let inside = (0..table.runs()).filter(|row| !is_axial(row)).all(|row| value(row) >= 0.0);
        let row = (0..table.runs()).filter(is_axial).find(|row| value(*row) < 0.0).filter(|_| sets && inside)?;
        let unit = &factor.unit;
        let shown = format!("{} {unit}", significant(value(row), 3));
        let message = format!(
            "row {}: the axial point puts `{}` to {}, beyond its range and below zero",
            row + 1,
            factor.name,
            shown.trim_end()
        );
        let hint = "say `extent = \"axial\"`, which puts the axial points at the ends of the range, or `alpha = \"face\"`, or give a \
                    narrower range";
        Some(Complaint::new("factors", message).hint(hint))
    };
    table.factors.iter().enumerate().filter_map(complaint).collect()
}
