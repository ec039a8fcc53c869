//! `kind = "specimen"`: discs packed in a rectangle or a disc, with polygons of aggregate as rigid clumps.
//!
//! Replicate k is another packing and another aggregate of the same recipe; its seed comes from the workflow's seed and
//! k. What is computed and why: [`dem::genesis`].

use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Port, Progress, Sketch, Stage, StageError, Step, Task, Work,
};
use crate::artifact::specimen::Specimen as Stored;
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::unit::{Density, Length};
use dem::genesis::clump::{Clump, ClumpMass};
use dem::genesis::gradation::{Gradation, GradationError};
use dem::genesis::packing::{Packing, PackingError};
use dem::genesis::placement::{ClassSize, Placement};
use dem::genesis::polygon::{AngleLaw, Polygon, PolygonError, PolygonRecipe, SizeRule};
use dem::genesis::region::Region;
use dem::genesis::specimen::{Aggregate, Quality, Recipe, Specimen as Made, SpecimenError};
use math::random::Stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Settings of a `specimen` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Specimen {
    /// Width of a rectangle, across the axis of loading.
    pub width: Option<Length>,
    /// Height of a rectangle, along the axis of loading.
    pub height: Option<Length>,
    /// Diameter of a disc, instead of width and height.
    pub diameter: Option<Length>,
    /// Ball porosity (overlaps counted twice). It decides with `mean_radius` how many discs there are.
    pub porosity: f64,
    /// Mean radius of the discs; the radii are rescaled to the porosity, the number of discs stays.
    pub mean_radius: Length,
    /// Largest over smallest radius.
    pub radius_ratio: f64,
    /// Density of the discs.
    pub density: Density,
    /// Group of the discs, as the material names it; a material of one group fits whatever its name.
    #[serde(default = "discs")]
    pub group: String,
    /// Largest share of discs with fewer than three contacts.
    #[serde(default)]
    pub floaters: f64,
    /// Polygons of aggregate.
    pub aggregate: Option<AggregateConfig>,
}

/// Settings of the aggregate.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AggregateConfig {
    /// Group of the aggregate, as the material names it.
    #[serde(default = "stones")]
    pub group: String,
    /// Law of the gradation.
    pub gradation: GradationName,
    /// Share of aggregate; not for `table`.
    pub content: Option<f64>,
    /// Largest size; the last class bound when not given.
    pub max_size: Option<Length>,
    /// Exponent of `fuller`.
    pub exponent: Option<f64>,
    /// Area fraction below each class bound, for `table`.
    pub passing: Option<Vec<f64>>,
    /// Bounds of the size classes, increasing.
    pub classes: Vec<Length>,
    /// Fewest and most vertices of a polygon.
    pub vertices: [usize; 2],
    /// Whether a polygon has the area of the circle of its size or lies in it.
    pub area: SizeRule,
    /// How the vertex angles are drawn.
    #[serde(default = "random_angles")]
    pub angles: AngleLaw,
    /// Smallest share of its circle that a polygon fills.
    #[serde(default = "least_fill")]
    pub least_fill: f64,
    /// Least distance between polygons.
    #[serde(default = "gap")]
    pub gap: Length,
    /// Least distance from a polygon to the outline.
    #[serde(default = "gap")]
    pub wall_gap: Length,
    /// Tries to place a polygon before giving up.
    #[serde(default = "attempts")]
    pub attempts: usize,
    /// Sizes within a class: all the middle one, or uniform.
    #[serde(default = "middle")]
    pub class_size: ClassSize,
    /// Density of the aggregate.
    pub density: Density,
    /// What mass and inertia of a clump are computed from.
    #[serde(default = "union")]
    pub mass: ClumpMass,
}

/// Law of a gradation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GradationName {
    /// Fuller's solid as a plane section sees it.
    Walraven,
    /// Power law.
    Fuller,
    /// Sieve curve.
    Table,
}

fn discs() -> String {
    "mortar".to_owned()
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

    /// The law; settings that it lacks or that have no effect on it are complaints.
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

    fn aggregate(&self) -> Result<Aggregate, Vec<Complaint>> {
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
        })
    }
}

impl Specimen {
    fn region(&self) -> Result<Region, Complaint> {
        match (self.width, self.height, self.diameter) {
            (Some(width), Some(height), None) => Ok(Region::Rectangle { width: width.get(), height: height.get() }),
            (None, None, Some(diameter)) => Ok(Region::Disc { diameter: diameter.get() }),
            _ => Err(Complaint::new("", "the outline is not clear").hint("give `width` and `height`, or `diameter`")),
        }
    }

    /// The recipe, or all that is wrong with the settings.
    fn recipe(&self) -> Result<Recipe, Vec<Complaint>> {
        let region = self.region().map_err(|fault| vec![fault])?;
        let aggregate = self.aggregate.as_ref().map(AggregateConfig::aggregate).transpose()?;
        let packing = Packing {
            porosity: self.porosity,
            mean_radius: self.mean_radius.get(),
            ratio: self.radius_ratio,
            floaters: self.floaters,
        };
        let recipe = Recipe { region, packing, density: self.density.get(), aggregate };
        let faults = recipe.faults();
        if faults.is_empty() {
            return Ok(recipe);
        }
        Err(faults.iter().map(|fault| Complaint::new(key(fault), fault.to_string())).collect())
    }

    fn task(&self, seed: u64, number: u64) -> Result<Task, Vec<Complaint>> {
        let seed = Stream::new(seed, "specimen", number).bits();
        Ok(Task::new("specimen", json!(self.recipe()?)).seed(seed))
    }
}

/// The setting that a fault is about; a key that was not given stands for its table.
fn key(fault: &SpecimenError) -> &'static str {
    match fault {
        SpecimenError::Packing(PackingError::Value { name, .. }) | SpecimenError::Value { name, .. } => match *name {
            "porosity" => "porosity",
            "mean_radius" => "mean_radius",
            "radius ratio" => "radius_ratio",
            "floaters" => "floaters",
            "density" => "density",
            "aggregate density" => "aggregate.density",
            "aggregate gap" => "aggregate.gap",
            "aggregate wall gap" => "aggregate.wall_gap",
            "attempts" => "aggregate.attempts",
            _ => "",
        },
        SpecimenError::Packing(PackingError::Few { .. }) => "mean_radius",
        SpecimenError::Packing(_) => "",
        SpecimenError::Gradation(GradationError::Value { name: "content", .. }) => "aggregate.content",
        SpecimenError::Gradation(GradationError::Value { name: "max_size", .. }) => "aggregate.max_size",
        SpecimenError::Gradation(GradationError::Value { name: "exponent", .. }) => "aggregate.exponent",
        SpecimenError::Gradation(GradationError::Value { name: "passing fraction", .. }) => "aggregate.passing",
        SpecimenError::Gradation(_) => "aggregate.classes",
        SpecimenError::Polygon(PolygonError::Vertices { .. }) => "aggregate.vertices",
        SpecimenError::Polygon(PolygonError::Fill(_)) => "aggregate.least_fill",
        SpecimenError::Placement(_) => "aggregate",
    }
}

impl Stage for Specimen {
    fn inputs(&self) -> Vec<Port> {
        Vec::new()
    }

    fn gives(&self) -> ArtifactKind {
        Stored::KIND
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        self.recipe().err().unwrap_or_default()
    }

    fn sketch(&self) -> Sketch {
        let aggregate = self.aggregate.iter().map(|aggregate| aggregate.group.clone());
        Sketch {
            groups: std::iter::once(self.group.clone()).chain(aggregate).collect(),
            varies: true,
            ..Sketch::default()
        }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let faults = |faults: Vec<Complaint>| {
            StageError::new(faults.iter().map(|fault| fault.message.as_str()).collect::<Vec<_>>().join("; "))
        };
        Ok(Step::Finish(self.task(known.context.seed, 1).map_err(faults)?))
    }

    fn replicate(&self, context: &Context, number: u64) -> Option<Task> {
        self.task(context.seed, number).ok()
    }
}

impl Kind for Specimen {
    const NAME: &'static str = "specimen";
    const ABOUT: &'static str = "discs packed to a porosity, with polygons of aggregate";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SPECIMEN];
    const CLASS: Class = Class::Simulation;
    const WORKS: &'static [Work] = &[Work { name: "specimen", version: 1, run: make }];
}

fn make(job: &Job) -> Result<Artifact, Failure> {
    let recipe: Recipe = job.params()?;
    let seed = job.seed.ok_or_else(|| StageError::new("a specimen needs a seed"))?;
    let failure = |faults: Vec<SpecimenError>| match faults[..] {
        [SpecimenError::Packing(PackingError::Stopped)] => Failure::Stopped,
        _ => StageError::new(faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")).into(),
    };
    let (made, quality) = recipe.make(seed, &|| job.watch()).map_err(failure)?;
    quality.warnings().iter().for_each(|warning| (job.say)(Progress::warning(warning)));
    Ok(store(&made, &quality).to_artifact())
}

fn store(made: &Made, quality: &Quality) -> Stored {
    let [width, height] = made.region.extent();
    let number = |clump: &Option<usize>| clump.map_or(-1, |index| index as i64);
    let of = |pick: fn(&Clump) -> f64| made.clumps.iter().map(pick).collect::<Vec<f64>>();
    let clumps = Table { about: "rigid clumps".to_owned(), columns: Vec::new() }
        .ints_column("polygon", "its polygon", made.clumps.iter().map(|clump| clump.polygon as i64).collect())
        .reals_column("mass", "kg/m", "mass per metre of thickness", of(|clump| clump.mass))
        .reals_column("inertia", "kg*m", "moment of inertia per metre of thickness", of(|clump| clump.inertia))
        .reals_column("x", "m", "centre of mass", of(|clump| clump.centre[0]))
        .reals_column("y", "m", "centre of mass", of(|clump| clump.centre[1]));
    let corners = made.polygons.iter().enumerate().flat_map(|(index, p)| p.vertices.iter().map(move |_| index as i64));
    Stored {
        outline: if matches!(made.region, Region::Disc { .. }) { "disc" } else { "rectangle" }.to_owned(),
        width,
        height,
        density: made.density,
        centres: made.centres.clone(),
        radii: made.radii.clone(),
        clump_of: made.clump_of_balls().iter().map(number).collect(),
        clumps,
        polygon_of: corners.collect(),
        vertices: made.polygons.iter().flat_map(|p| p.vertices.iter().copied()).collect(),
        quality: report(quality),
        warnings: quality.warnings().iter().map(ToString::to_string).collect(),
    }
}

fn report(quality: &Quality) -> Table {
    let fabric = &quality.fabric;
    let rows = [
        ("discs", quality.balls as f64, ""),
        ("mean radius", quality.mean_radius, "m"),
        ("smallest radius", quality.radius_range[0], "m"),
        ("largest radius", quality.radius_range[1], "m"),
        ("mean radius / the one asked for", quality.radius_factor, ""),
        ("ball porosity", quality.porosity, ""),
        ("coordination (2 contacts / disc)", fabric.coordination, ""),
        ("discs with fewer than 3 contacts", fabric.floaters as f64, ""),
        ("rounds of enlarging them", quality.floater_rounds as f64, ""),
        ("largest factor on their radius", quality.floater_growth, ""),
        ("mean overlap / smaller radius", fabric.mean_overlap, ""),
        ("largest overlap / smaller radius", fabric.largest_overlap, ""),
        ("mean stress of the packing / modulus", fabric.mean_stress, ""),
        ("stress anisotropy of the packing", fabric.anisotropy, ""),
        ("unbalanced force / contact force", quality.unbalanced, ""),
        ("discs across", quality.particles_across, ""),
        ("contacts mortar-mortar", quality.contacts[0] as f64, ""),
        ("contacts mortar-aggregate", quality.contacts[1] as f64, ""),
        ("contacts aggregate-aggregate", quality.contacts[2] as f64, ""),
        ("area fraction of the size circles", quality.circle_fraction, ""),
        ("area fraction of the polygons", quality.polygon_fraction, ""),
        ("share of discs' area that is aggregate", quality.pebble_fraction, ""),
        ("polygons", quality.polygons as f64, ""),
        ("polygons without a disc", quality.empty_polygons as f64, ""),
    ];
    Table { about: "quality of the specimen".to_owned(), columns: Vec::new() }
        .texts_column("quantity", "", rows.iter().map(|row| row.0.to_owned()).collect())
        .reals_column("value", "", "in the unit beside it", rows.iter().map(|row| row.1).collect())
        .texts_column("unit", "", rows.iter().map(|row| row.2.to_owned()).collect())
}

/// The specimen in a stored artifact, for tests on it.
///
/// # Errors
/// What is missing or does not fit together.
pub fn load(artifact: &Artifact) -> Result<Made, StageError> {
    let stored = Stored::from_artifact(artifact).map_err(|wanted| StageError::new(wanted.to_string()))?;
    let odd = |what: &str| StageError::new(format!("the specimen's {what} do not fit together"));
    if stored.centres.len() != stored.radii.len() || stored.clump_of.len() != stored.radii.len() {
        return Err(odd("discs"));
    }
    let region = match stored.outline.as_str() {
        "disc" => Region::Disc { diameter: stored.width },
        _ => Region::Rectangle { width: stored.width, height: stored.height },
    };
    let mut polygons: Vec<Polygon> = Vec::new();
    for (&index, &vertex) in stored.polygon_of.iter().zip(&stored.vertices) {
        let index = usize::try_from(index).map_err(|_| odd("polygons"))?;
        if index > polygons.len() {
            return Err(odd("polygons"));
        }
        if index == polygons.len() {
            polygons.push(Polygon { vertices: Vec::new() });
        }
        polygons[index].vertices.push(vertex);
    }
    let clumps = &stored.clumps;
    let (mass, inertia) = (clumps.numbers("mass", "kg/m")?, clumps.numbers("inertia", "kg*m")?);
    let (x, y) = (clumps.numbers("x", "m")?, clumps.numbers("y", "m")?);
    let polygon_of = clumps.ints("polygon")?;
    let mut clumps: Vec<Clump> = Vec::with_capacity(polygon_of.len());
    for (k, &polygon) in polygon_of.iter().enumerate() {
        let pebbles = (0..stored.clump_of.len()).filter(|&i| stored.clump_of[i] == k as i64).collect();
        let polygon = usize::try_from(polygon).map_err(|_| odd("clumps"))?;
        clumps.push(Clump { polygon, pebbles, mass: mass[k], inertia: inertia[k], centre: [x[k], y[k]] });
    }
    let Stored { centres, radii, density, .. } = stored;
    Ok(Made { region, centres, radii, density, polygons, clumps })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_specimen_comes_back_as_it_was_stored() {
        let config: Specimen = toml::from_str(
            "width = '50 mm'\nheight = '100 mm'\nporosity = 0.12\nmean_radius = '1.5 mm'\nradius_ratio = 2.5\n\
             density = '2000 kg/m^3'\n[aggregate]\ngradation = 'walraven'\ncontent = 0.75\n\
             classes = ['8 mm', '12 mm']\nvertices = [4, 6]\narea = 'equal-area'\nangles = 'jittered'\n\
             density = '2650 kg/m^3'",
        )
        .unwrap();
        let (made, quality) = config.recipe().unwrap().make(1, &|| dem::Watch::Continue).unwrap();
        assert!(!made.clumps.is_empty());
        let artifact = store(&made, &quality).to_artifact();
        assert_eq!(load(&artifact).unwrap(), made);
    }

    #[test]
    fn settings_that_lack_or_have_no_effect_are_complaints() {
        let text = "width = '50 mm'\nheight = '100 mm'\nporosity = 0.12\nmean_radius = '1.5 mm'\nradius_ratio = 2.5\n\
                    density = '2000 kg/m^3'\n[aggregate]\ngradation = 'table'\ncontent = 0.75\nclasses = ['8 mm', '12 mm']\n\
                    vertices = [4, 6]\narea = 'inscribed'\ndensity = '2650 kg/m^3'";
        let config: Specimen = toml::from_str(text).unwrap();
        let messages: Vec<String> = config.check(&Context::default()).into_iter().map(|c| c.message).collect();
        assert_eq!(messages, ["`content` has no effect on gradation `table`", "gradation `table` needs `passing`"]);
    }
}
