//! Settings of the stones of a specimen.

use super::super::Complaint;
use super::super::shapes::Shape;
use crate::unit::{Density, Length, Mass};
use dem::genesis::mix::Mix;
use dem::genesis::specimen::Recipe;
use dem::genesis::stones::{HowMany, StoneClass, StoneFault, StoneSize, Stones, Template, WithinClass};
use math::elementary::pow;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the stones.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StonesConfig {
    /// The `shapes` stage with their shapes.
    pub shapes: String,
    /// Classes of sizes.
    pub classes: Vec<StoneClassConfig>,
    /// A grading curve that gives the numbers of the classes, instead of numbers of their own.
    pub fuller: Option<FullerConfig>,
    /// Definition of the size.
    #[serde(default)]
    pub size: StoneSize,
    /// Sizes within a class.
    #[serde(default)]
    pub within: WithinClass,
    /// Density of the stones.
    pub density: Density,
    /// Group of their pebbles in the material.
    #[serde(default = "stones")]
    pub group: String,
    /// Least distance between stones; 0.1 mm by default.
    pub gap: Option<Length>,
    /// Least distance to the outline; by default that between stones.
    pub wall_gap: Option<Length>,
    /// Most attempts to place a stone; 20 000 by default.
    pub attempts: Option<usize>,
    /// Number of mortar balls, whose radii are then scaled to reach the porosity; by default it follows from the porosity.
    pub balls: Option<usize>,
    /// Factor on the radii of the mortar for a coarse twin with the same stones: 2 makes an eighth of the balls.
    pub coarsen: Option<f64>,
    /// Density of the whole specimen, from which that of the mortar balls follows; `density` then has no effect.
    pub bulk_density: Option<Density>,
}

/// Stones between two sizes, by number, mass or fraction of the volume.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StoneClassConfig {
    /// Smallest size, a diameter.
    pub from: Length,
    /// Largest size, a diameter.
    pub to: Length,
    /// Number of stones.
    pub count: Option<usize>,
    /// Their mass in the specimen.
    pub mass: Option<Mass>,
    /// Their fraction of the specimen's volume.
    pub share: Option<f64>,
}

/// Fuller's curve between the smallest and the largest bound of the classes.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FullerConfig {
    /// Volume fraction of stones in the specimen.
    pub content: f64,
    /// Exponent; 0.5 by default.
    pub exponent: Option<f64>,
}

fn stones() -> String {
    "aggregate".to_owned()
}

const GAP: f64 = 1e-4;
const ATTEMPTS: usize = 20_000;

impl StonesConfig {
    /// Bounds and numbers of the classes.
    fn classes(&self) -> Result<Vec<StoneClass>, Vec<Complaint>> {
        let mut faults = Vec::new();
        let bounds: Vec<[f64; 2]> = self.classes.iter().map(|class| [class.from.get(), class.to.get()]).collect();
        let shares = match &self.fuller {
            Some(fuller) if fuller.content > 0.0 && fuller.content < 1.0 => {
                let power = |d: f64| pow(d, fuller.exponent.unwrap_or(0.5));
                let parts: Vec<f64> = bounds.iter().map(|[a, b]| power(*b) - power(*a)).collect();
                let whole: f64 = parts.iter().sum();
                parts.into_iter().map(|part| fuller.content * part / whole).collect()
            }
            Some(fuller) => {
                let message = format!("the content is {}", fuller.content);
                faults.push(
                    Complaint::new("stones.fuller.content", message).hint("a share of the volume above 0 and below 1"),
                );
                Vec::new()
            }
            None => Vec::new(),
        };
        let mut classes = Vec::new();
        for (k, class) in self.classes.iter().enumerate() {
            let [from, to] = bounds[k];
            let share = shares.get(k).copied().or(class.share);
            let number = match (class.count, class.mass, share) {
                (Some(count), None, None) => HowMany::Count(count),
                (None, Some(mass), None) => HowMany::Mass(mass.get()),
                (None, None, Some(share)) if self.fuller.is_none() || class.share.is_none() => HowMany::Share(share),
                _ if self.fuller.is_some() && !faults.is_empty() => continue,
                _ => {
                    let message = format!("class {} needs one of `count`, `mass`, `share`", k + 1);
                    let hint = "with `fuller` the curve gives the share, and the classes have none of them";
                    faults.push(Complaint::new("stones.classes", message).hint(hint));
                    continue;
                }
            };
            classes.push(StoneClass { from, to, number });
        }
        if faults.is_empty() { Ok(classes) } else { Err(faults) }
    }

    /// The stones in the types of genesis, or all faults.
    pub(super) fn mix(&self, recipe: &Recipe) -> Result<Mix, Vec<Complaint>> {
        let classes = self.classes()?;
        let gap = self.gap.map_or(GAP, Length::get);
        let mix = Mix {
            stones: Stones {
                classes,
                size: self.size,
                within: self.within,
                density: self.density.get(),
                gap,
                wall_gap: self.wall_gap.map_or(gap, Length::get),
                attempts: self.attempts.unwrap_or(ATTEMPTS),
                group: self.group.clone(),
            },
            balls: self.balls,
            coarsen: self.coarsen.unwrap_or(1.0),
            bulk_density: self.bulk_density.map(Density::get),
        };
        let mut faults: Vec<Complaint> =
            mix.faults(recipe).iter().map(|fault| Complaint::new(key(fault), fault.to_string())).collect();
        if recipe.aggregate.is_some() {
            let both = Complaint::new("stones", "`aggregate` and `stones` are both given");
            faults.push(both.hint("`aggregate` is for the plane, `stones` for a solid"));
        }
        if recipe.groups.iter().any(|group| group.name == self.group) {
            let message = format!("the group `{}` is that of the mortar too", self.group);
            faults.push(Complaint::new("stones.group", message).hint("give stones and mortar groups of their own"));
        }
        if faults.is_empty() { Ok(mix) } else { Err(faults) }
    }
}

/// The path of the setting of a fault.
pub(super) fn key(fault: &StoneFault) -> &'static str {
    match fault {
        StoneFault::Value { name, .. } => match *name {
            "density" => "stones.density",
            "gap" => "stones.gap",
            "wall gap" => "stones.wall_gap",
            "attempts" => "stones.attempts",
            "coarsen" => "stones.coarsen",
            "bulk density" => "stones.bulk_density",
            "number of mortar balls" => "stones.balls",
            "packing" => "packing",
            _ => "stones.classes",
        },
        StoneFault::NoShape => "stones.shapes",
        StoneFault::Many(_) => "stones.classes",
        StoneFault::Plane | StoneFault::NoPlace { .. } => "stones",
    }
}

/// A shape in the type of genesis.
pub(super) fn template(shape: Shape) -> Template {
    let moments = shape.clump.moments;
    Template {
        share: shape.share,
        breadth: shape.breadth,
        volume: moments.volume,
        inertia: [0, 1, 2].map(|k| moments.inertia[k][k]),
        centres: shape.clump.balls.iter().map(|ball| ball.centre).collect(),
        radii: shape.clump.balls.iter().map(|ball| ball.radius).collect(),
    }
}
