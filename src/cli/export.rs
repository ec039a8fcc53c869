//! `flow export`: results as files for people and other programs.

use super::common::{Campaign, decided, system};
use super::files::Files;
use super::show::{object, parts};
use super::{Exit, complete};
use crate::artifact::run::Run;
use crate::artifact::{Artifact, ArtifactKind, ContentHash};
use crate::export::{File, files, paraview, particles, pfc, shapes, tables};
use crate::plan::Workflow;
use crate::run::Report;
use crate::stage;
use crate::stage::specimen::{self, Loaded};
use crate::stage::units::presented;
use crate::store::{ObjectId, Store};
use clap::{Args, ValueEnum};
use dem::Space;
use dem::genesis::specimen::Specimen;
use std::path::PathBuf;
use std::sync::Arc;

/// Write results as files: pictures, printed tables, CSV, or what ParaView and other particle codes read.
#[derive(Args)]
pub(super) struct Export {
    #[command(flatten)]
    campaign: Campaign,
    /// The stages, or single runs of them such as `orthogonal[12]`; by default all that have a result.
    #[arg(value_name = "STAGE[ROW]", add = complete::stages())]
    stages: Vec<String>,
    /// Form of the files.
    #[arg(long, value_enum, value_name = "FORM", default_value_t = Form::Files)]
    to: Form,
    /// The folder that the files are written to.
    #[arg(long, value_name = "FOLDER", default_value = "export")]
    folder: PathBuf,
}

/// Forms of export.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// Pictures as SVG, PDF and PNG; printed tables as CSV, LaTeX and Markdown; other tables as CSV.
    Files,
    /// Every table as CSV, with units in the heads.
    Csv,
    /// Specimens, runs and shapes for ParaView: VTU, and PVD for the states of a run.
    Vtu,
    /// Specimens, and runs with their microparameters, as lists of particles, clumps, groups and contacts (CSV, SI); clumps
    /// of shapes as PFC, LAMMPS and YADE read them.
    Particles,
    /// Surfaces of shapes as STL, in mm.
    Stl,
}

/// A result that is exported: its name in the names of files, and the task that made it.
struct Chosen {
    name: String,
    object: ObjectId,
}

impl Export {
    pub(super) fn go(self) -> Exit {
        self.write().unwrap_or_else(|exit| exit)
    }

    fn write(&self) -> Result<Exit, Exit> {
        let asked = self.stages.iter().map(|what| parts(what)).collect::<Result<Vec<_>, Exit>>()?;
        let names: Vec<String> = asked.iter().map(|(stage, _)| stage.clone()).collect();
        let workflow = self.campaign.load(&names)?;
        let store = self.campaign.common.read()?;
        // Single rows are known only when every task is looked up.
        let memos = asked.iter().all(|(_, row)| row.is_none());
        let report = decided(&workflow, &store, &names, memos)?;
        let (chosen, missing) = choose(&workflow, &report, &asked);
        std::fs::create_dir_all(&self.folder).map_err(|error| {
            err!("error: {}: {error}", self.folder.display());
            Exit::System
        })?;
        let (own, mut written) = (Files::of(&workflow), 0);
        for one in &chosen {
            let artifact = store.get(&one.object.content).map_err(|e| system(&e))?;
            let read = matches!(self.to, Form::Files | Form::Csv);
            let artifact = if read { Arc::new(presented(&artifact, &workflow.context)) } else { artifact };
            let files = self.files(&store, one, &artifact).map_err(|why| {
                err!("error: {}: {why}", one.name);
                Exit::BadInput
            })?;
            for (name, bytes) in files {
                let path = self.folder.join(name);
                own.put(&path, &bytes)?;
                if !self.campaign.common.quiet {
                    out!("{}", path.display());
                }
                written += 1;
            }
        }
        if !missing.is_empty() {
            err!("error: no result yet of {}; run them first", missing.join(", "));
            return Ok(Exit::Failed);
        }
        if written == 0 {
            err!("error: nothing of these stages can be written in this form");
            return Ok(Exit::BadInput);
        }
        Ok(Exit::Done)
    }

    /// The files of one result. A result that has no such form is a fault only when it was named.
    fn files(&self, store: &Store, chosen: &Chosen, artifact: &Artifact) -> Result<Vec<File>, String> {
        let name = &chosen.name;
        match self.to {
            Form::Files => Ok(files(name, artifact)),
            Form::Csv => Ok(tables(name, artifact)),
            Form::Vtu | Form::Particles | Form::Stl if artifact.is(ArtifactKind::SHAPES) => {
                let shapes = stage::shapes::load(artifact).map_err(|e| e.to_string())?;
                Ok(match self.to {
                    Form::Stl => shapes::stl(name, &shapes),
                    Form::Particles => shapes::particles(name, &shapes),
                    Form::Vtu | Form::Files | Form::Csv => shapes::vtu(name, &shapes),
                })
            }
            Form::Stl if self.stages.is_empty() => Ok(Vec::new()),
            Form::Stl => Err(format!("`{}` holds no shapes of stones", artifact.kind)),
            Form::Vtu | Form::Particles if artifact.is(ArtifactKind::SPECIMEN) => match load(artifact)? {
                Loaded::Plane(specimen) => self.specimen(name, &specimen),
                Loaded::Solid(specimen) => self.specimen(name, &specimen),
            },
            Form::Vtu | Form::Particles if Run::from_artifact(artifact).is_ok_and(|run| run.cracks.is_some()) => {
                let Made { specimen, mut setting } = Made::of(store, &chosen.object)?;
                setting.fissures = Run::from_artifact(artifact).ok().and_then(|run| run.fissures);
                match specimen {
                    Loaded::Plane(specimen) => self.run(name, artifact, &specimen, &setting),
                    Loaded::Solid(specimen) => self.run(name, artifact, &specimen, &setting),
                }
            }
            Form::Vtu | Form::Particles if self.stages.is_empty() => Ok(Vec::new()),
            Form::Vtu | Form::Particles => Err(format!(
                "`{}` holds neither a specimen nor a run; single runs of a stage are named as in orthogonal[12]",
                artifact.kind
            )),
        }
    }

    fn specimen<S: Space>(&self, name: &str, specimen: &Specimen<S>) -> Result<Vec<File>, String> {
        match self.to {
            Form::Vtu => Ok(paraview::specimen(name, specimen)),
            Form::Files | Form::Csv | Form::Particles | Form::Stl => particles::files(name, specimen, None),
        }
    }

    fn run<S: Space>(
        &self,
        name: &str,
        run: &Artifact,
        specimen: &Specimen<S>,
        setting: &particles::Setting,
    ) -> Result<Vec<File>, String> {
        if self.to == Form::Particles {
            pfc::cautions(&setting.material()?).iter().for_each(|words| err!("note: {name}: {words}"));
        }
        match self.to {
            Form::Vtu => paraview::run(name, run, specimen),
            Form::Files | Form::Csv | Form::Particles | Form::Stl => particles::files(name, specimen, Some(setting)),
        }
    }
}

/// The named results, or all, and the names of those that are missing.
fn choose(workflow: &Workflow, report: &Report, asked: &[(String, Option<usize>)]) -> (Vec<Chosen>, Vec<String>) {
    let all: Vec<(String, Option<usize>)> = match asked {
        [] => report.stages.iter().map(|stage| (stage.name.clone(), None)).collect(),
        asked => asked.to_vec(),
    };
    let (mut chosen, mut missing) = (Vec::new(), Vec::new());
    for (stage, row) in all {
        let number = row.map(|row| row + 1);
        match object(workflow, report, &stage, row) {
            Some(object) => {
                let name = number.map_or(stage.clone(), |number| format!("{stage}.{number}"));
                chosen.push(Chosen { name, object });
            }
            None => missing.push(number.map_or(stage.clone(), |number| format!("{stage}[{number}]"))),
        }
    }
    (chosen, missing)
}

fn load(artifact: &Artifact) -> Result<Loaded, String> {
    specimen::load(artifact).map_err(|e| e.to_string())
}

/// The specimen and the setting of a run, from its task text.
struct Made {
    specimen: Loaded,
    setting: particles::Setting,
}

impl Made {
    fn of(store: &Store, object: &ObjectId) -> Result<Self, String> {
        let record = store.find(&object.key).map_err(|e| e.to_string())?;
        let record = record.ok_or("the store has lost the record of the run")?;
        let text = store.task_text(&record).map_err(|e| e.to_string())?;
        let line = |head: &'static str| text.lines().filter_map(move |line| line.strip_prefix(head)?.split_once(' '));
        let input = line("input ").find(|(name, _)| *name == "specimen").map(|(_, hash)| hash);
        let content = input.and_then(ContentHash::from_hex).ok_or("the run does not name its specimen")?;
        let specimen = load(&*store.get(&content).map_err(|e| e.to_string())?)?;
        let parameters = line("param ").map(|(path, value)| (path.to_owned(), value.to_owned())).collect();
        let seed = text.lines().find_map(|line| line.strip_prefix("seed ")?.trim().parse().ok()).unwrap_or_default();
        Ok(Self { specimen, setting: particles::Setting { parameters, seed, fissures: None } })
    }
}
