//! The site file: what flow must know of a cluster, written once by its user.
//!
//! It lies in the user's configuration folder (`$XDG_CONFIG_HOME/flow/sites/NAME.toml`, else `~/.config/…`), not beside
//! the workflow: the same campaign runs on other clusters, and nothing of the site is in a key.

mod needs;

pub use needs::{Memory, Needs};

use crate::unit::Time;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A cluster, and what is asked of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Site {
    /// What takes the jobs: `slurm`, or `commands` for any other scheduler, which `[commands]` then describes.
    pub scheduler: Kind,
    /// Partition, where the cluster's default one does not do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub partition: Option<String>,
    /// Account that is charged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub account: Option<String>,
    /// Most workers at once.
    pub workers: usize,
    /// Cores of a worker, which runs as many tasks at once, or one with as many threads.
    pub cpus: usize,
    /// Memory of a worker, such as "2 GB"; the cluster's default when not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory: Option<Memory>,
    /// Longest life of a worker, such as "4 h". Longer campaigns take several rounds. The cluster's default, which flow
    /// does not know, when not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
    /// How long a worker that has nothing to do waits for more.
    pub linger: Time,
    /// Lines of the job script before flow is started, such as "module load gcc".
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub setup: Vec<String>,
    /// More options of `sbatch`, such as "--qos=normal".
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
    /// The program on the nodes, where it is not the one that submits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<PathBuf>,
    /// Other values for the tasks of a stage of this name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub stage: BTreeMap<String, Override>,
    /// How another scheduler is spoken to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commands: Option<Commands>,
}

impl Default for Site {
    fn default() -> Self {
        let seconds = |text| Time::parse(text).unwrap_or_else(|error| panic!("BUG: {error}"));
        Self {
            scheduler: Kind::Slurm,
            partition: None,
            account: None,
            workers: 16,
            cpus: 1,
            memory: None,
            time: None,
            linger: seconds("30 s"),
            setup: Vec::new(),
            options: Vec::new(),
            flow: None,
            stage: BTreeMap::new(),
            commands: None,
        }
    }
}

/// What takes jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Slurm: `sbatch`, `squeue`, `scancel`.
    Slurm,
    /// Any other scheduler, by the commands of `[commands]`.
    Commands,
}

/// Values for the tasks of one stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Override {
    /// Whether its tasks run on the machine of the submitter (`true`) or on the cluster (`false`). When not given,
    /// specimens, simulations and external programs go to the cluster.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub here: Option<bool>,
    /// Partition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub partition: Option<String>,
    /// Most workers at once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub workers: Option<usize>,
    /// Cores of a worker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpus: Option<usize>,
    /// Memory of a worker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory: Option<Memory>,
    /// Longest life of a worker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<Time>,
    /// More options of `sbatch`, in place of those of the site.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub options: Option<Vec<String>>,
}

/// How a scheduler other than Slurm is spoken to. Each command is a list of words, no shell. In them `{script}` is the
/// job script, `{workers}` the number of workers, `{last}` one less, `{name}` the name of the job, `{log}` the file for
/// what workers print, `{user}` the user's name, `{jobs}` (a word of its own) the jobs, `{memory}` megabytes, `{cpus}` cores,
/// `{seconds}` the time of a worker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Commands {
    /// Submits `{workers}` equal jobs as one array; prints the number of the job.
    pub submit: Vec<String>,
    /// Lists the jobs that wait or run; their numbers stand in what it prints. It must succeed when there are none.
    pub alive: Vec<String>,
    /// Cancels `{jobs}`.
    pub cancel: Vec<String>,
    /// Regular expression of the job in what `submit` prints.
    #[serde(default = "number")]
    pub job: String,
    /// Lines at the top of the script, such as "#PBS -N {name}".
    #[serde(default)]
    pub header: Vec<String>,
    /// What the shell replaces by the number of a job in its array, such as "$PBS_ARRAY_INDEX".
    pub index: String,
}

fn number() -> String {
    r"\d+".to_owned()
}

/// Why a site cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SiteError {
    /// It cannot be read.
    #[error("the site file {}: {source}{}", path.display(), known(near))]
    Unread {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
        /// Sites that are there.
        near: Vec<String>,
    },
    /// It says what it cannot say.
    #[error("the site file {}: {why}", path.display())]
    Wrong {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
}

fn known(names: &[String]) -> String {
    match names {
        [] => "; `flow site new NAME` writes one to fill in".to_owned(),
        names => format!("; there are {}; `flow site new NAME` writes one to fill in", names.join(", ")),
    }
}

impl Site {
    /// Reads a site: a name in the configuration folder, or a path that ends in `.toml`. Without a name the site `default`
    /// is taken when there is one, else a Slurm of which nothing is known.
    ///
    /// # Errors
    /// It cannot be read, or it has faults; the error lists all of them.
    pub fn load(name: Option<&str>) -> Result<Self, SiteError> {
        let path = match name {
            Some(name) if name.ends_with(".toml") => PathBuf::from(name),
            Some(name) => folder().join(format!("{name}.toml")),
            None => folder().join("default.toml"),
        };
        match std::fs::read_to_string(&path) {
            Ok(text) => Self::parse(&text).map_err(|why| SiteError::Wrong { path, why }),
            Err(error) if name.is_none() && error.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(source) => Err(SiteError::Unread { path, source, near: names() }),
        }
    }

    /// Reads the text of a site file.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let site: Self = toml::from_str(text).map_err(|error| error.to_string())?;
        match site.faults().as_slice() {
            [] => Ok(site),
            faults => Err(faults.join("; ")),
        }
    }

    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let all = std::iter::once((String::new(), Some(self.workers), Some(self.cpus), self.time));
        let stages = self.stage.iter().map(|(name, s)| (format!("stage.{name}."), s.workers, s.cpus, s.time));
        for (at, workers, cpus, time) in all.chain(stages) {
            let counts = [("workers", workers, 10_000), ("cpus", cpus, 1024)];
            for (key, count, most) in counts.iter().filter_map(|(key, count, most)| Some((key, (*count)?, most))) {
                if !(1..=*most).contains(&count) {
                    faults.push(format!("`{at}{key}` is {count}; give a number from 1 to {most}"));
                }
            }
            if let Some(time) = time.filter(|time| !(time.get() >= 60.0)) {
                faults.push(format!("`{at}time` is {} s; give at least \"1 min\"", time.get()));
            }
        }
        if !(self.linger.get() >= 0.0) {
            faults.push("`linger` is below 0".to_owned());
        }
        let line = |text: &String| text.contains(['\n', '\0']);
        let words = self.partition.iter().chain(&self.account).chain(&self.options);
        if words.chain(&self.setup).any(line) {
            faults.push("a value has more than one line".to_owned());
        }
        match (self.scheduler, &self.commands) {
            (Kind::Commands, None) => faults.push("`scheduler = \"commands\"` needs a table `[commands]`".to_owned()),
            (Kind::Slurm, Some(_)) => {
                faults
                    .push("`[commands]` has no effect with `scheduler = \"slurm\"`; leave out one of them".to_owned());
            }
            (Kind::Commands, Some(commands)) => {
                for (key, command) in
                    [("submit", &commands.submit), ("alive", &commands.alive), ("cancel", &commands.cancel)]
                {
                    if command.is_empty() {
                        faults.push(format!("`commands.{key}` has no program"));
                    }
                }
                if let Err(error) = regex_lite::Regex::new(&commands.job) {
                    faults.push(format!("`commands.job`: {error}"));
                }
            }
            (Kind::Slurm, None) => {}
        }
        faults
    }

    /// What the workers for the tasks of a stage are given.
    pub fn needs(&self, stage: &str) -> Needs {
        let none = Override::default();
        let own = self.stage.get(stage).unwrap_or(&none);
        Needs {
            partition: own.partition.clone().or_else(|| self.partition.clone()),
            workers: own.workers.unwrap_or(self.workers),
            cpus: own.cpus.unwrap_or(self.cpus),
            memory: own.memory.or(self.memory),
            time: own.time.or(self.time),
            options: own.options.clone().unwrap_or_else(|| self.options.clone()),
            alone: false,
        }
    }

    /// Whether a task of a stage goes to the cluster; `far` says whether its work does as a rule.
    pub fn sends(&self, stage: &str, far: bool) -> bool {
        self.stage.get(stage).and_then(|own| own.here).map_or(far, |here| !here)
    }
}

/// The folder of site files.
pub fn folder() -> PathBuf {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let config = absolute("XDG_CONFIG_HOME").or_else(|| Some(absolute("HOME")?.join(".config")));
    config.unwrap_or_else(|| Path::new(".").to_owned()).join("flow/sites")
}

/// Names of the sites that are there.
pub fn names() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).into_iter().flatten().flatten();
    let name = |entry: std::fs::DirEntry| Some(entry.file_name().to_str()?.strip_suffix(".toml")?.to_owned());
    let mut names: Vec<String> = entries.filter_map(name).collect();
    names.sort_unstable();
    names
}

#[cfg(test)]
mod tests;
