//! Settings of the polygons of aggregate.

use super::super::Complaint;
use crate::unit::{Density, Length};
use dem::genesis::clump::ClumpMass;
use dem::genesis::gradation::Gradation;
use dem::genesis::placement::{ClassSize, Placement};
use dem::genesis::polygon::{AngleLaw, PolygonRecipe, SizeRule};
use dem::genesis::specimen::Aggregate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the aggregate.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AggregateConfig {
    /// Group of its particles, as the material names it.
    #[serde(default = "stones")]
    pub group: String,
    /// Law of the gradation.
    pub gradation: GradationName,
    /// Area fraction of aggregate; not for `table`.
    pub content: Option<f64>,
    /// Largest size; by default the last class bound.
    pub max_size: Option<Length>,
    /// Exponent of `fuller`.
    pub exponent: Option<f64>,
    /// Area fraction below each class bound, for `table`.
    pub passing: Option<Vec<f64>>,
    /// Bounds of the size classes, increasing.
    pub classes: Vec<Length>,
    /// Fewest and most vertices of a polygon.
    pub vertices: [usize; 2],
    /// Whether a polygon has the area of the circle of its size or is inscribed in it.
    pub area: SizeRule,
    /// Distribution of the vertex angles.
    #[serde(default = "random_angles")]
    pub angles: AngleLaw,
    /// Smallest fraction of its circle that a polygon fills.
    #[serde(default = "least_fill")]
    pub least_fill: f64,
    /// Least distance between polygons.
    #[serde(default = "gap")]
    pub gap: Length,
    /// Least distance from a polygon to the outline.
    #[serde(default = "gap")]
    pub wall_gap: Length,
    /// Most attempts to place a polygon.
    #[serde(default = "attempts")]
    pub attempts: usize,
    /// Sizes within a class: all in the middle, or uniform.
    #[serde(default = "middle")]
    pub class_size: ClassSize,
    /// Density of the aggregate.
    pub density: Density,
    /// Shape from which mass and inertia of a clump are computed.
    #[serde(default = "union")]
    pub mass: ClumpMass,
}

/// Law of a gradation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GradationName {
    /// Fuller's curve of a solid, converted to a plane section.
    Walraven,
    /// Power law.
    Fuller,
    /// Sieve curve.
    Table,
}

fn stones() -> String {
    "aggregate".to_owned()
}

fn random_angles() -> AngleLaw {
    AngleLaw::Random
}

fn least_fill() -> f64 {
    0.05
}

fn gap() -> Length {
    Length::si(1e-3)
}

fn attempts() -> usize {
    100_000
}

fn middle() -> ClassSize {
    ClassSize::Middle
}

fn union() -> ClumpMass {
    ClumpMass::Union
}

impl AggregateConfig {
    fn classes(&self) -> Vec<f64> {
        self.classes.iter().map(|bound| bound.get()).collect()
    }

    /// The law, and complaints about settings that it lacks or that have no effect on it.
    fn law(&self) -> Result<Gradation, Vec<Complaint>> {
        let classes = self.classes();
        let max_size = self.max_size.map(Length::get).or(classes.last().copied()).unwrap_or(0.0);
        let given = [("content", self.content.is_some()), ("max_size", self.max_size.is_some())];
        let given =
            given.into_iter().chain([("exponent", self.exponent.is_some()), ("passing", self.passing.is_some())]);
        let (name, needed, allowed): (_, &[&str], &[&str]) = match self.gradation {
            GradationName::Walraven => ("walraven", &["content"], &["content", "max_size"]),
            GradationName::Fuller => ("fuller", &["content"], &["content", "max_size", "exponent"]),
            GradationName::Table => ("table", &["passing"], &["passing"]),
        };
        let faults: Vec<Complaint> = given
            .filter_map(|(key, is)| match (is, needed.contains(&key), allowed.contains(&key)) {
                (false, true, _) => Some((key, format!("gradation `{name}` needs `{key}`"))),
                (true, _, false) => Some((key, format!("`{key}` has no effect on gradation `{name}`"))),
                _ => None,
            })
            .map(|(key, message)| Complaint::new(&format!("aggregate.{key}"), message))
            .collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let content = self.content.unwrap_or_default();
        Ok(match self.gradation {
            GradationName::Walraven => Gradation::Walraven { content, max_size },
            GradationName::Fuller => Gradation::Fuller { content, max_size, exponent: self.exponent.unwrap_or(0.5) },
            GradationName::Table => {
                Gradation::Table { sizes: classes, passing: self.passing.clone().unwrap_or_default() }
            }
        })
    }

    /// The aggregate in the types of genesis, or all faults.
    pub(super) fn aggregate(&self) -> Result<Aggregate, Vec<Complaint>> {
        Ok(Aggregate {
            gradation: self.law()?,
            classes: self.classes(),
            polygons: PolygonRecipe {
                min_vertices: self.vertices[0],
                max_vertices: self.vertices[1],
                size: self.area,
                angles: self.angles,
                least_fill: self.least_fill,
            },
            placement: Placement {
                gap: self.gap.get(),
                wall_gap: self.wall_gap.get(),
                attempts: self.attempts,
                class_size: self.class_size,
            },
            density: self.density.get(),
            mass: self.mass,
            group: self.group.clone(),
        })
    }
}
