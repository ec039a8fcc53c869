//! Lists of declarations of the workflow: its factors, its materials, the aggregate of a specimen, ranges.

use super::super::{Complaint, Context, Known, Named, StageError};
use super::Table;
use crate::artifact::surfaces::Surfaces;
use crate::artifact::{self, Artifact};
use crate::unit::Unit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum List {
    /// Factors: the values that they set, ranges and levels.
    Factors,
    /// Microparameters of materials.
    Materials,
    /// Polygons of a specimen by size class.
    Aggregate,
    /// Ranges of factors, and of the responses of surfaces.
    Ranges,
}

/// A list in the parameters of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Given(Vec<GivenColumn>);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct GivenColumn {
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    unit: String,
    values: GivenValues,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum GivenValues {
    Reals(Vec<Option<f64>>),
    Texts(Vec<String>),
}

impl Given {
    fn texts(self, name: &str, values: Vec<String>) -> Self {
        self.with(name, "", GivenValues::Texts(values))
    }

    fn reals(self, name: &str, unit: &str, values: Vec<Option<f64>>) -> Self {
        self.with(name, unit, GivenValues::Reals(values))
    }

    fn with(mut self, name: &str, unit: &str, values: GivenValues) -> Self {
        self.0.push(GivenColumn { name: name.to_owned(), unit: unit.to_owned(), values });
        self
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.0.iter().map(|column| column.name.clone()).collect()
    }

    pub(super) fn table(&self) -> artifact::Table {
        let add = |table: artifact::Table, column: &GivenColumn| match &column.values {
            GivenValues::Reals(values) => {
                let values = values.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                table.reals_column(&column.name, &column.unit, "", values)
            }
            GivenValues::Texts(texts) => table.texts_column(&column.name, "", texts.clone()),
        };
        self.0.iter().fold(artifact::Table::default(), add)
    }
}

impl Table {
    /// Complaints about settings that a list needs, or that have no effect on it.
    pub(super) fn list_faults(&self, context: &Context) -> Vec<Complaint> {
        let of = self.of.list().len();
        let (wants_of, used): (usize, &[&str]) = match self.list {
            None => (usize::MAX, &[]),
            Some(List::Factors) => (0, &["factors"]),
            Some(List::Materials) => (0, &["materials"]),
            Some(List::Aggregate) => (1, &["classes"]),
            Some(List::Ranges) => (1, &["factors"]),
        };
        let mut found = Vec::new();
        match (of, wants_of) {
            (0, usize::MAX) => found.push(Complaint::new("of", "no stage is named").hint("name one, or give a `list`")),
            (_, usize::MAX) => {}
            (1.., 0) => found.push(Complaint::new("of", "`of` has no effect on this list").hint("leave out `of`")),
            (of, 1) if of != 1 => found.push(Complaint::new("of", "this list needs one stage")),
            _ => {}
        }
        let given = [
            ("factors", self.factors.is_empty()),
            ("materials", self.materials.is_empty()),
            ("classes", self.classes.is_empty()),
        ];
        for (key, _) in given.into_iter().filter(|(key, empty)| !empty && !used.contains(key)) {
            found.push(Complaint::new(key, format!("`{key}` has no effect here")).hint(format!("leave out `{key}`")));
        }
        if self.list == Some(List::Materials) && self.materials.is_empty() {
            found.push(Complaint::new("materials", "no material is named"));
        }
        if self.list == Some(List::Aggregate) && self.classes.windows(2).filter(|pair| pair[0] < pair[1]).count() == 0 {
            found.push(Complaint::new("classes", "the list needs the bounds of the classes, increasing"));
        }
        for name in self.factors.iter().filter(|name| !context.factors.contains_key(*name)) {
            found.push(Complaint::new("factors", format!("there is no [factor.{name}]")).missing(Named::Factor, name));
        }
        for name in self.materials.iter().filter(|name| !context.materials.contains_key(*name)) {
            found.push(
                Complaint::new("materials", format!("there is no [material.{name}]")).missing(Named::Material, name),
            );
        }
        found
    }

    /// The list, if the stage prints one.
    pub(super) fn given(&self, known: &Known) -> Result<Option<Given>, StageError> {
        let Some(list) = self.list else { return Ok(None) };
        let load = || known.load(known.one("of")?);
        Ok(Some(match list {
            List::Factors => self.factor_list(known.context),
            List::Materials => self.material_list(known.context)?,
            List::Aggregate => aggregate(&*load()?, &self.classes.iter().map(|c| c.get()).collect::<Vec<_>>())?,
            List::Ranges => self.range_list(&*load()?, known.context)?,
        }))
    }

    fn factor_names(&self, context: &Context) -> Vec<String> {
        if self.factors.is_empty() { context.factors.keys().cloned().collect() } else { self.factors.clone() }
    }

    fn factor_list(&self, context: &Context) -> Given {
        let names = self.factor_names(context);
        let factors: Vec<_> = names.iter().filter_map(|name| context.factors.get(name)).collect();
        let levels = factors.iter().map(|factor| factor.levels.len()).max().unwrap_or(0);
        let ranges: Vec<_> = factors.iter().map(|factor| range(factor)).collect();
        let mut list = Given(Vec::new())
            .texts("factor", names.clone())
            .texts("parameter", factors.iter().map(|factor| factor.sets.join(", ")).collect())
            .texts("unit", factors.iter().map(|factor| factor.unit.clone()).collect())
            .reals("low", "", ranges.iter().map(|range| range.map(|[low, _]| low)).collect())
            .reals("high", "", ranges.iter().map(|range| range.map(|[_, high]| high)).collect());
        for level in 0..levels {
            let values = factors.iter().map(|factor| factor.levels.get(level).copied()).collect();
            list = list.reals(&format!("level_{}", level + 1), "", values);
        }
        list
    }

    /// Parameters by path, in the units of the factors that set them.
    fn material_list(&self, context: &Context) -> Result<Given, StageError> {
        let materials: Vec<_> = self
            .materials
            .iter()
            .filter_map(|name| Some((name, context.materials.get(name)?.resolve_alone())))
            .collect();
        let mut paths: Vec<&String> = materials.iter().flat_map(|(_, material)| material.keys()).collect();
        paths.sort();
        paths.dedup();
        let unit_of = |path: &str| {
            let factor = context.factors.values().find(|factor| factor.sets.iter().any(|set| set == path));
            let declared = || path.split_once('.').and_then(|(_, key)| dem::parameter::Parameter::from_key(key));
            let own = || declared().map_or("", |parameter| parameter.declaration().quantity.unit()).to_owned();
            factor.map_or_else(own, |factor| factor.unit.clone())
        };
        let units: Vec<String> = paths.iter().map(|path| unit_of(path)).collect();
        let shown = units.iter().map(|unit| Unit::parse(unit));
        let shown = shown.collect::<Result<Vec<Unit>, _>>().map_err(|e| StageError::new(e.to_string()))?;
        let list = Given(Vec::new()).texts("parameter", paths.iter().map(|path| (*path).clone()).collect());
        let list = list.texts("unit", units);
        Ok(materials.iter().fold(list, |list, (name, material)| {
            let value = |(path, unit): (&&String, &Unit)| material.get(*path).map(|p| unit.of_si(p.value));
            list.reals(name, "", paths.iter().zip(&shown).map(value).collect())
        }))
    }

    /// Ranges of the factors in the workflow, then of the responses in the runs that the surfaces were fitted to.
    fn range_list(&self, surfaces: &Artifact, context: &Context) -> Result<Given, StageError> {
        let factors = self.factor_names(context);
        let mut rows: Vec<(String, String, Option<[f64; 2]>)> = Vec::new();
        for name in &factors {
            let factor = context.factors.get(name);
            rows.push((name.clone(), factor.map_or(String::new(), |f| f.unit.clone()), factor.and_then(range)));
        }
        let residuals = Surfaces::from_artifact(surfaces)
            .map_err(|wanted| StageError::new("`of` names no fitted surfaces").hint(wanted.to_string()))?
            .residuals;
        for (response, value) in residuals.response.iter().zip(residuals.observed) {
            match rows.iter_mut().find(|(name, ..)| name == response) {
                Some((_, _, Some([low, high]))) => (*low, *high) = (low.min(value), high.max(value)),
                Some(_) => {}
                None => {
                    let unit = context.responses.get(response).map_or(String::new(), |r| r.unit.clone());
                    rows.push((response.clone(), unit, Some([value, value])));
                }
            }
        }
        Ok(Given(Vec::new())
            .texts("quantity", rows.iter().map(|row| row.0.clone()).collect())
            .texts("unit", rows.iter().map(|row| row.1.clone()).collect())
            .reals("low", "", rows.iter().map(|row| row.2.map(|[low, _]| low)).collect())
            .reals("high", "", rows.iter().map(|row| row.2.map(|[_, high]| high)).collect()))
    }
}

/// The range of a factor: its own, or that of its levels.
fn range(factor: &super::super::Factor) -> Option<[f64; 2]> {
    let low = factor.levels.iter().copied().reduce(f64::min);
    factor.range.or_else(|| Some([low?, factor.levels.iter().copied().reduce(f64::max)?]))
}

/// Polygons of a specimen by class. The size of a polygon is the diameter of the circle through its vertices; if there is
/// no such circle, that of the circle of its area.
fn aggregate(specimen: &Artifact, bounds: &[f64]) -> Result<Given, StageError> {
    let made = super::super::specimen::load(specimen)?.plane()?;
    let sizes: Vec<f64> = made.polygons.iter().map(|polygon| size(&polygon.vertices)).collect();
    let count = |class: &[f64]| sizes.iter().filter(|size| class[0] <= **size && **size < class[1]).count() as f64;
    let bound = |end: usize| bounds.windows(2).map(|class| Some((class[end] * 1e6).round() / 1e3)).collect();
    Ok(Given(Vec::new()).reals("low", "mm", bound(0)).reals("high", "mm", bound(1)).reals(
        "number",
        "",
        bounds.windows(2).map(|class| Some(count(class))).collect(),
    ))
}

/// The size of a polygon with vertices in order, m.
fn size(vertices: &[[f64; 2]]) -> f64 {
    let Some(&[a, b, c]) = vertices.first_chunk::<3>() else { return 0.0 };
    let minus = |p: [f64; 2], q: [f64; 2]| [p[0] - q[0], p[1] - q[1]];
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let square = |p: [f64; 2]| p[0] * p[0] + p[1] * p[1];
    let (u, v) = (minus(b, a), minus(c, a));
    let double = 2.0 * cross(u, v);
    let centre =
        [a[0] + (v[1] * square(u) - u[1] * square(v)) / double, a[1] + (u[0] * square(v) - v[0] * square(u)) / double];
    let radius = square(minus(a, centre)).sqrt();
    if vertices.iter().all(|&p| (square(minus(p, centre)).sqrt() / radius - 1.0).abs() < 1e-6) {
        return 2.0 * radius;
    }
    let next = vertices.iter().cycle().skip(1);
    let area = 0.5 * vertices.iter().zip(next).map(|(&p, &q)| cross(p, q)).sum::<f64>();
    (4.0 * area / std::f64::consts::PI).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_those_of_the_circle_through_the_vertices_or_of_the_area() {
        // A square, and a triangle with a right angle, in a circle of diameter 2.
        assert!((size(&[[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]) - 2.0).abs() < 1e-12);
        assert!((size(&[[3.0, 0.0], [2.0, 1.0], [1.0, 0.0]]) - 2.0).abs() < 1e-12);
        // A rhomb of diagonals 4 and 2 lies on no circle: its area is 4.
        let rhomb = [[2.0, 0.0], [0.0, 1.0], [-2.0, 0.0], [0.0, -1.0]];
        assert!((size(&rhomb) - (16.0 / std::f64::consts::PI).sqrt()).abs() < 1e-12);
    }
}
