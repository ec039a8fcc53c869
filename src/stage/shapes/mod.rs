//! `kind = "shapes"`: stones from caliper measurements or STL files, and the rigid clumps that stand for them.
//!
//! `sections` names a table (CSV or workbook) with a row for each section of each stone, along its longest side:
//!
//! | column | holds |
//! |---|---|
//! | `shape` | name of the stone |
//! | `position [mm]` | where along the longest side |
//! | `thickness [mm]`, `height [mm]` | the largest thickness a and height b of the section |
//! | `exponent` | outline between a rhombus (1), an ellipse (2, where the column is not there) and a box (6 and more) |
//!
//! `stl` names files instead, one stone each, with `unit`, the length of their coordinate 1. `share` gives the fractions of
//! the shapes by number, `pebbles` the choice of balls, and `within` the largest errors of a clump. What is computed and why:
//! [`shape`].

mod stored;

pub use stored::{Shape, load};

use super::beside::Beside;
use super::{
    Class, Complaint, Context, Failure, Job, Kind, Known, Port, Progress, Stage, StageError, Step, Task, Work, data,
};
use crate::artifact::{Artifact, ArtifactKind, Table};
use crate::unit::Length;
use ::shape::clump::{Bound, ClumpFault, Method, Pebbles, fill};
use ::shape::loft::{Section, faults, loft};
use ::shape::mend::{Mended, mend};
use ::shape::mesh::Mesh;
use ::shape::stl;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stored::{Stone, store};

/// Settings of a `shapes` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shapes {
    /// Table of sections, beside the workflow.
    pub sections: Option<String>,
    /// Points around each section, 32 by default.
    pub around: Option<usize>,
    /// STL files, one stone each, beside the workflow.
    #[serde(default)]
    pub stl: Vec<String>,
    /// Length of coordinate 1 in the STL files: `"1 mm"`.
    pub unit: Option<Length>,
    /// Fractions of the shapes by number, in the order of the table or of the files; equal by default.
    pub share: Option<Vec<f64>>,
    /// How pebbles are chosen.
    #[serde(default)]
    pub pebbles: PebbleConfig,
    /// How near a clump must come to its stone.
    pub within: Option<BoundConfig>,
}

/// How pebbles are chosen.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PebbleConfig {
    /// Source of the candidates.
    #[serde(default)]
    pub method: Method,
    /// Smallest over largest radius; 0.2 by default.
    pub ratio: Option<f64>,
    /// Taghavi's distance, an angle from 0 to 180 degrees; without it the error decides how many pebbles there are.
    pub distance: Option<f64>,
}

/// How near a clump must come to its stone.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundConfig {
    /// Relative error of the volume; 0.02 by default.
    pub volume: Option<f64>,
    /// Relative error of every principal moment of inertia; 0.05 by default.
    pub inertia: Option<f64>,
    /// Mean distance of the surfaces over the radius of the ball of equal volume; 0.05 by default.
    pub surface: Option<f64>,
    /// Most pebbles; 60 by default.
    pub pebbles: Option<usize>,
}

/// Parameters of the task: everything that decides the shapes besides the files.
#[derive(Debug, Serialize, Deserialize)]
struct Params {
    around: usize,
    unit: f64,
    share: Option<Vec<f64>>,
    /// Names of the stones of the STL files, in order.
    names: Vec<String>,
    method: Method,
    ratio: f64,
    distance: Option<f64>,
    within: [f64; 3],
    most: usize,
}

impl Params {
    fn pebbles(&self) -> Pebbles {
        Pebbles { method: self.method, ratio: self.ratio, distance: self.distance }
    }

    fn bound(&self) -> Bound {
        let [volume, inertia, surface] = self.within;
        Bound { volume, inertia, surface, most: self.most }
    }
}

impl Shapes {
    fn params(&self) -> Params {
        let (pebbles, bound) = (Pebbles::default(), Bound::default());
        let within = self.within.as_ref();
        let name = |path: &String| {
            let file = path.rsplit('/').next().unwrap_or(path);
            file.rsplit_once('.').map_or(file, |(stem, _)| stem).to_owned()
        };
        Params {
            around: self.around.unwrap_or(32),
            unit: self.unit.map_or(1.0, |unit| unit.get()),
            share: self.share.clone(),
            names: self.stl.iter().map(name).collect(),
            method: self.pebbles.method,
            ratio: self.pebbles.ratio.unwrap_or(pebbles.ratio),
            distance: self.pebbles.distance,
            within: [
                within.and_then(|own| own.volume).unwrap_or(bound.volume),
                within.and_then(|own| own.inertia).unwrap_or(bound.inertia),
                within.and_then(|own| own.surface).unwrap_or(bound.surface),
            ],
            most: within.and_then(|own| own.pebbles).unwrap_or(bound.most),
        }
    }

    /// The key of a setting of the domain in the table.
    fn key(name: &str) -> &'static str {
        match name {
            "ratio" => "pebbles.ratio",
            "distance" => "pebbles.distance",
            "volume" => "within.volume",
            "inertia" => "within.inertia",
            "surface" => "within.surface",
            _ => "within.pebbles",
        }
    }

    fn check_source(&self) -> Vec<Complaint> {
        let mut found = Vec::new();
        let mut odd = |wrong: bool, key: &str, message: &str, hint: &str| {
            found.extend(wrong.then(|| Complaint::new(key, message).hint(hint)));
        };
        let (sections, files) = (self.sections.is_some(), !self.stl.is_empty());
        odd(!sections && !files, "", "no stones are named", "give `sections = \"FILE.csv\"` or `stl = [\"FILE.stl\"]`");
        odd(sections && files, "stl", "`sections` and `stl` are both given", "give one");
        odd(
            files && self.unit.is_none(),
            "stl",
            "an STL file has no unit",
            "add `unit = \"1 mm\"`, the length that it counts in",
        );
        odd(
            !files && self.unit.is_some(),
            "unit",
            "`unit` has no effect on sections",
            "units stand in the heads of their columns",
        );
        odd(
            // From a nanometre to a kilometre.
            files && self.unit.is_some_and(|unit| !(1e-9..=1e3).contains(&unit.get())),
            "unit",
            "`unit` is no length that a stone could be measured in; a negative one would turn it inside out",
            "unit = \"1 mm\" where the file counts in millimetres",
        );
        odd(files && self.around.is_some(), "around", "`around` has no effect on STL files", "leave it out");
        let around = self.around.unwrap_or(32);
        let good = (8..=512).contains(&around) && around.is_multiple_of(4);
        odd(!good, "around", "the number of points around a section is out of range", "take 8 to 512, a multiple of 4");
        found
    }
}

impl Stage for Shapes {
    fn inputs(&self) -> Vec<Port> {
        Vec::new()
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::SHAPES
    }

    fn check(&self, _context: &Context) -> Vec<Complaint> {
        let mut found = self.check_source();
        let params = self.params();
        for fault in ::shape::clump::faults(&params.pebbles(), &params.bound()) {
            let key = match &fault {
                ClumpFault::Value { name, .. } => Self::key(name),
                ClumpFault::Thin => "",
            };
            found.push(Complaint::new(key, fault.to_string()));
        }
        if let Some(share) = &self.share {
            let sum: f64 = share.iter().sum();
            if share.iter().any(|&part| !(part >= 0.0)) || !((sum - 1.0).abs() < 1e-6) {
                let message = format!("the shares are {share:?} and sum to {sum}");
                found.push(
                    Complaint::new("share", message).hint("give a share of at least 0 for each shape; they sum to 1"),
                );
            }
            if !self.stl.is_empty() && share.len() != self.stl.len() {
                let message = format!("{} shares for {} files", share.len(), self.stl.len());
                found.push(Complaint::new("share", message).hint("give one for each"));
            }
        }
        for (k, name) in params.names.iter().enumerate() {
            if params.names[..k].contains(name) {
                found.push(
                    Complaint::new("stl", format!("two files are called `{name}`"))
                        .hint("names of shapes come from their files"),
                );
            }
        }
        found
    }

    fn beside(&self, _context: &Context, found: &mut Beside) {
        let params = self.params();
        if let Some(path) = &self.sections
            && let Some(bytes) = found.bytes("sections", path)
            && let Err(fault) = data::parse(&bytes).and_then(|table| lofted(&table, params.around))
        {
            found.faults.push(Complaint::new("sections", format!("{path}: {}", fault.message)));
        }
        for path in &self.stl {
            let Some(bytes) = found.bytes("stl", path) else { continue };
            if let Err(why) = surface(&bytes, params.unit) {
                found.faults.push(Complaint::new("stl", format!("{path}: {why}")));
            }
        }
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let mut task = Task::new("shapes", json!(self.params()));
        if let Some(path) = &self.sections {
            task.files.push(known.library.file("sections", path)?);
        }
        for (path, name) in self.stl.iter().zip(self.params().names) {
            task.files.push(known.library.file(&name, path)?);
        }
        Ok(Step::Finish(task))
    }
}

impl Kind for Shapes {
    const NAME: &'static str = "shapes";
    const ABOUT: &'static str = "stones from measured sections or STL files, and clumps of balls for them";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::SHAPES];
    const CLASS: Class = Class::Simulation;
    const WORKS: &'static [Work] = &[Work { name: "shapes", version: 1, run: make }];
}

/// A stone: its name, its surface, and the repairs of the surface.
type Read = (String, Mesh, String);

/// The closed surface of an STL file, and what was mended of it.
fn surface(bytes: &[u8], unit: f64) -> Result<(Mesh, Mended), String> {
    mend(&stl::read(bytes, unit).map_err(|why| why.to_string())?).map_err(|why| why.to_string())
}

fn make(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let read: Vec<Read> = if params.names.is_empty() {
        lofted(&data::parse(&job.file("sections")?)?, params.around)?
    } else {
        let stone = |name: &String| -> Result<Read, Failure> {
            let fail = |why: String| StageError::new(format!("{name}: {why}"));
            let (mesh, mended) = surface(&job.file(name)?, params.unit).map_err(fail)?;
            Ok((name.clone(), mesh, mended.words().join("; ")))
        };
        params.names.iter().map(stone).collect::<Result<_, _>>()?
    };
    let equal = 1.0 / read.len() as f64;
    let share = params.share.clone().unwrap_or_else(|| vec![equal; read.len()]);
    if share.len() != read.len() {
        return Err(StageError::new(format!("{} shares for {} shapes", share.len(), read.len())).into());
    }
    let mut stones = Vec::with_capacity(read.len());
    for ((name, mesh, mended), share) in read.into_iter().zip(share) {
        if job.stopped() {
            return Err(Failure::Stopped);
        }
        let clump =
            fill(&mesh, &params.pebbles(), &params.bound()).map_err(|why| StageError::new(format!("{name}: {why}")))?;
        stones.push(Stone { name, share, mesh, mended, clump });
    }
    let shapes = store(&stones);
    shapes.warnings.iter().for_each(|warning| (job.say)(Progress::warning(warning)));
    Ok(shapes.to_artifact())
}

/// The stones of a table of sections, in the order of their first rows.
fn lofted(table: &Table, around: usize) -> Result<Vec<Read>, StageError> {
    let names = table.texts("shape")?;
    let [position, thickness, height] = ["position", "thickness", "height"].map(|column| table.numbers(column, "m"));
    let (position, thickness, height) = (position?, thickness?, height?);
    let exponent = match table.column("exponent") {
        Some(_) => table.numbers("exponent", "")?,
        None => vec![2.0; names.len()],
    };
    let mut order: Vec<&String> = Vec::new();
    names.iter().for_each(|name| {
        if !order.contains(&name) {
            order.push(name);
        }
    });
    let section =
        |k: usize| Section { position: position[k], thickness: thickness[k], height: height[k], exponent: exponent[k] };
    let stone = |name: &String| {
        let sections: Vec<Section> = (0..names.len()).filter(|&k| names[k] == *name).map(section).collect();
        let said: Vec<String> = faults(&sections).iter().map(ToString::to_string).collect();
        if !said.is_empty() {
            return Err(format!("shape `{name}`: {}", said.join("; ")));
        }
        let mesh = loft(&sections, around).map_err(|why| format!("shape `{name}`: {why}"))?;
        Ok((name.clone(), mesh, String::new()))
    };
    let (good, bad): (Vec<_>, Vec<_>) = order.into_iter().map(stone).partition(Result::is_ok);
    let bad: Vec<String> = bad.into_iter().filter_map(Result::err).collect();
    if !bad.is_empty() {
        return Err(StageError::new(bad.join("; ")).hint("correct the table of sections"));
    }
    Ok(good.into_iter().filter_map(Result::ok).collect())
}

#[cfg(test)]
mod tests;
