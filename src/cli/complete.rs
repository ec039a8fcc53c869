//! What completions offer beyond commands and options: stages, profiles, paths of overrides, responses and factors of the
//! workflow that stands on the line.

use crate::plan::{self, Overrides, Workflow};
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

/// The variable by which the script of [`flow completions`](super::completions) asks.
pub(super) const ASKED: &str = "FLOW_COMPLETE";

/// Stages, for arguments that name them.
pub(super) fn stages() -> ArgValueCompleter {
    offer(|workflow| workflow.stages.iter().map(|stage| (stage.name.clone(), stage.kind.to_owned())).collect())
}

/// Profiles, for `--profile`.
pub(super) fn profiles() -> ArgValueCompleter {
    offer(|workflow| workflow.profiles.iter().map(|name| (name.clone(), String::new())).collect())
}

/// Settings, for `--set`: those of the stages, and the levels of the factors.
pub(super) fn settings() -> ArgValueCompleter {
    offer(|workflow| {
        let levels = workflow.context.factors.iter().map(|(name, factor)| {
            let unit = if factor.unit.is_empty() { String::new() } else { format!("in {}", factor.unit) };
            (format!("factor.{name}.levels="), unit)
        });
        let keys = workflow.stages.iter().flat_map(|node| {
            let settings = node.stage.settings();
            let keys: Vec<String> = settings.as_object().into_iter().flatten().map(|(key, _)| key.clone()).collect();
            keys.into_iter().map(|key| (format!("stage.{}.{key}=", node.name), node.kind.to_owned()))
        });
        levels.chain(keys).collect()
    })
}

/// Responses, for `--target`.
pub(super) fn responses() -> ArgValueCompleter {
    offer(|workflow| {
        let all = workflow.context.responses.iter();
        all.map(|(name, response)| (format!("{name}="), response.unit.clone())).collect()
    })
}

/// Words with a remark each.
type Words = Vec<(String, String)>;

fn offer(words: fn(&Workflow) -> Words) -> ArgValueCompleter {
    ArgValueCompleter::new(move |typed: &OsStr| {
        let all = workflow(std::env::args_os()).map(|workflow| words(&workflow)).unwrap_or_default();
        begun(all, typed)
    })
}

/// The words that begin as what is typed.
fn begun(words: Words, typed: &OsStr) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy().into_owned();
    let fitting = words.into_iter().filter(|(word, _)| word.starts_with(&typed));
    fitting
        .map(|(word, remark)| CompletionCandidate::new(word).help((!remark.is_empty()).then(|| remark.into())))
        .collect()
}

/// The workflow on a line: the first word that is a file of this kind. None when it has faults.
fn workflow(line: impl Iterator<Item = OsString>) -> Option<Workflow> {
    let file = line.map(PathBuf::from).find(|path| path.extension().is_some_and(|e| e == "toml") && path.is_file())?;
    plan::load(&file, &Overrides::default()).ok()
}
