//! Models to and from the group `models` of an artifact `surfaces`: one group per response.

use super::super::StageError;
use super::{named, reals, unreadable};
use crate::artifact::{Artifact, Field, Group, Node, Table, Values};
use crate::stage::columns::Rows;
use stats::model::{Axis, Model};
use stats::terms::Term;

/// The group `models`.
pub(super) fn kept<'a>(models: impl Iterator<Item = (&'a str, &'a Model)>) -> Group {
    models.fold(Group::new(), |group, (response, model)| group.with(response, Node::Group(keep(model))))
}

fn keep(model: &Model) -> Group {
    let rows = Rows(&model.axes);
    let axes = named("coding and domain of the factors")
        .texts_column("factor", "", rows.texts(|a| a.name.as_str()))
        .reals_column("centre", "", "natural value at coded 0", rows.reals(|a| Some(a.centre)))
        .reals_column("half", "", "natural length of a coded unit", rows.reals(|a| Some(a.half)))
        .reals_column("low", "", "least value fitted", rows.reals(|a| Some(a.low)))
        .reals_column("high", "", "greatest value fitted", rows.reals(|a| Some(a.high)));
    let terms = named("terms of the coded model")
        .texts_column("term", "", model.terms.iter().map(Term::to_string).collect())
        .reals_column("coefficient", "", "of the coded term", model.coefficients.clone());
    let count = model.terms.len();
    let root = reals(model.root.clone(), vec![count, count], "inverse triangle: its rows span the covariance");
    Group::new()
        .with("factors", Node::Table(axes))
        .with("terms", Node::Table(terms))
        .with("root", root)
        .with("s", Node::Real { value: model.s.unwrap_or(f64::NAN), unit: String::new() })
        .with("df_residual", Node::Int(model.df_residual as i64))
        .with("greatest_leverage", Node::Real { value: model.greatest_leverage, unit: String::new() })
}

/// The models of an artifact `surfaces`, by response.
///
/// # Errors
/// Something is missing or of another type.
pub fn models(surfaces: &Artifact) -> Result<Vec<(String, Model)>, StageError> {
    let Some(Node::Group(group)) = surfaces.root.get("models") else {
        return Err(unreadable("there is no group `models`"));
    };
    let read = |(response, node): (&str, &Node)| match node {
        Node::Group(own) => Ok((response.to_owned(), read(own)?)),
        other => Err(unreadable(&format!("`models/{response}` is a {}", other.type_name()))),
    };
    group.iter().map(read).collect()
}

fn read(group: &Group) -> Result<Model, StageError> {
    let wrong = |e: crate::artifact::Wanted| unreadable(&e.to_string());
    let factors: Table = Field::take(group, "factors", "").map_err(wrong)?;
    let listed: Table = Field::take(group, "terms", "").map_err(wrong)?;
    let column = |table: &Table, name: &str| table.numbers(name, "").map_err(|e| unreadable(&e.to_string()));
    let [centre, half, low, high] = ["centre", "half", "low", "high"].map(|name| column(&factors, name));
    let (centre, half, low, high) = (centre?, half?, low?, high?);
    let names = texts(&factors, "factor")?;
    let axis = |(i, name): (usize, &String)| Axis {
        name: name.clone(),
        centre: centre[i],
        half: half[i],
        low: low[i],
        high: high[i],
    };
    let axes: Vec<Axis> = names.iter().enumerate().map(axis).collect();
    let terms = texts(&listed, "term")?.iter().map(|t| Term::parse(t)).collect::<Result<Vec<_>, _>>();
    let terms = terms.map_err(|e| unreadable(&e.to_string()))?;
    let coefficients = column(&listed, "coefficient")?;
    let root = match group.get("root") {
        Some(Node::Array(array)) if array.shape == [terms.len(), terms.len()] => match &array.values {
            Values::Reals(values) => values.clone(),
            Values::Ints(_) | Values::Texts(_) => return Err(unreadable("`root` holds no reals")),
        },
        Some(_) | None => return Err(unreadable("`root` is not the square of the terms")),
    };
    let s: f64 = Field::take(group, "s", "").map_err(wrong)?;
    let df: i64 = Field::take(group, "df_residual", "").map_err(wrong)?;
    Ok(Model {
        powers: terms.iter().flat_map(|t| axes.iter().map(|axis| t.power_of(&axis.name))).collect(),
        axes,
        terms,
        coefficients,
        root,
        s: (!s.is_nan()).then_some(s),
        df_residual: usize::try_from(df).map_err(|_| unreadable("`df_residual` is negative"))?,
        greatest_leverage: Field::take(group, "greatest_leverage", "").map_err(wrong)?,
    })
}

fn texts<'a>(table: &'a Table, name: &str) -> Result<&'a Vec<String>, StageError> {
    match table.column(name).map(|column| &column.values) {
        Some(Values::Texts(texts)) => Ok(texts),
        Some(_) | None => Err(unreadable(&format!("no texts `{name}`"))),
    }
}
