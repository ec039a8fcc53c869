//! `flow new`: a commented workflow to start from.

use super::Exit;
use crate::plan::{nearest, schema};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Write a commented workflow to start from, and the schema for editors beside it.
#[derive(Args)]
pub(super) struct New {
    /// Name of the workflow: NAME.toml is written, never over a file that is there.
    name: PathBuf,
    /// The shipped workflow to copy.
    #[arg(long, value_name = "WORKFLOW", default_value = TEMPLATES[0].0)]
    from: String,
}

/// Shipped workflows by name.
const TEMPLATES: &[(&str, &str)] =
    &[("start", include_str!("../../workflows/start.toml")), ("c30", include_str!("../../workflows/c30.toml"))];

impl New {
    pub(super) fn go(self) -> Exit {
        let names = || TEMPLATES.iter().map(|(name, _)| *name);
        let Some((_, text)) = TEMPLATES.iter().find(|(name, _)| *name == self.from) else {
            let meant =
                nearest(&self.from, names()).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
            let known: Vec<&str> = names().collect();
            eprintln!("error: there is no shipped workflow `{}`{meant}\n  there are {}", self.from, known.join(", "));
            return Exit::BadInput;
        };
        let path = self.name.with_extension("toml");
        let schema_path = path.with_file_name(schema::FILE_NAME);
        match write_new(&path, text).and_then(|()| write_new(&schema_path, &format!("{:#}\n", schema::schema()))) {
            Ok(()) => {}
            Err((place, e)) if place == schema_path && e.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err((place, e)) if e.kind() == std::io::ErrorKind::AlreadyExists => {
                eprintln!("error: {} is there already and was left as it is", place.display());
                return Exit::BadInput;
            }
            Err((place, e)) => {
                eprintln!("error: {} cannot be written: {e}", place.display());
                return Exit::System;
            }
        }
        out!("{} written; next: flow plan {0}", path.display());
        Exit::Done
    }
}

fn write_new(path: &Path, text: &str) -> Result<(), (PathBuf, std::io::Error)> {
    let file = std::fs::File::create_new(path);
    file.and_then(|mut file| file.write_all(text.as_bytes())).map_err(|e| (path.to_owned(), e))
}
