//! The one helper of these tests: a folder of its own with a store, and the binary run in it.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use tempfile::TempDir;

/// A temporary folder in which `flow` is run.
pub(crate) struct Space {
    folder: TempDir,
}

/// What a campaign did.
pub(crate) struct Ran {
    /// Tasks computed, by stage, without those that computed none.
    pub(crate) ran: Vec<(String, u64)>,
    /// Result of each stage.
    pub(crate) objects: Vec<(String, Option<String>)>,
}

impl Space {
    pub(crate) fn new() -> Self {
        Self { folder: TempDir::new().expect("a temporary folder") }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("writing a file");
    }

    pub(crate) fn flow(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("running flow")
    }

    pub(crate) fn start(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starting flow")
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flow"));
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    /// Runs `w.toml` to a good end.
    pub(crate) fn run(&self, more: &[&str]) -> Ran {
        let output = self.flow(&[&["run", "w.toml", "--json", "--quiet"], more].concat());
        assert!(output.status.success(), "{}", told(&output));
        Ran::read(&output)
    }

    /// What `flow` printed to standard output.
    pub(crate) fn stdout(&self, arguments: &[&str]) -> String {
        let output = self.flow(arguments);
        assert!(output.status.success(), "{}", told(&output));
        String::from_utf8(output.stdout).expect("text")
    }

    /// All object files of the store, sorted.
    pub(crate) fn objects(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        walk(&self.path("store/objects"), &mut found);
        found.sort();
        found
    }
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() { walk(&entry.path(), found) } else { found.push(entry.path()) }
    }
}

impl Ran {
    pub(crate) fn read(output: &Output) -> Self {
        let text = String::from_utf8_lossy(&output.stdout);
        let document: Value = serde_json::from_str(text.lines().last().unwrap_or_default())
            .unwrap_or_else(|e| panic!("{e}: {}", told(output)));
        let stages = document["stages"].as_array().cloned().unwrap_or_default();
        let name = |stage: &Value| stage["name"].as_str().unwrap_or_default().to_owned();
        let count = |stage: &Value| stage["ran"].as_u64().unwrap_or_default();
        Self {
            ran: stages.iter().filter(|stage| count(stage) > 0).map(|stage| (name(stage), count(stage))).collect(),
            objects: stages.iter().map(|stage| (name(stage), stage["object"].as_str().map(str::to_owned))).collect(),
        }
    }

    /// Asserts which stages computed how many tasks.
    pub(crate) fn expect(&self, wanted: &[(&str, u64)]) {
        let wanted: Vec<(String, u64)> = wanted.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect();
        assert_eq!(self.ran, wanted);
    }
}

/// Everything a command printed.
pub(crate) fn told(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!("{}\n{}\n{}", output.status, text(&output.stdout), text(&output.stderr))
}
