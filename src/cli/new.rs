//! `flow new`: a commented workflow to start from.

use super::Exit;
use crate::plan::{nearest, schema};
use crate::report::quoted;
use clap::Args;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Write a commented workflow to start from, and the schema for editors beside it.
#[derive(Args)]
pub(super) struct New {
    /// Name of the workflow: NAME.toml is written, never over a file that is there.
    name: PathBuf,
    /// The shipped workflow to copy.
    #[arg(long, value_name = "WORKFLOW", default_value = SHIPPED[0].name)]
    from: String,
}

/// A workflow in the repository's folder `workflows`, with the tables it reads.
struct Shipped {
    name: &'static str,
    text: &'static str,
    files: &'static [(&'static str, &'static str)],
}

/// The first is copied when none is named.
const SHIPPED: &[Shipped] = &[
    Shipped { name: "start", text: include_str!("../../workflows/start.toml"), files: &[] },
    Shipped { name: "rock", text: include_str!("../../workflows/rock.toml"), files: &[] },
    Shipped { name: "rock-3d", text: include_str!("../../workflows/rock-3d.toml"), files: &[] },
    Shipped { name: "granite", text: include_str!("../../workflows/granite.toml"), files: &[] },
    Shipped { name: "envelope", text: include_str!("../../workflows/envelope.toml"), files: &[] },
    Shipped { name: "fissure", text: include_str!("../../workflows/fissure.toml"), files: &[] },
    Shipped { name: "concrete", text: include_str!("../../workflows/concrete.toml"), files: &[] },
    Shipped { name: "c30", text: include_str!("../../workflows/c30.toml"), files: SU2021 },
    Shipped { name: "brazilian", text: include_str!("../../workflows/brazilian.toml"), files: &[] },
    Shipped { name: "rcc", text: include_str!("../../workflows/rcc.toml"), files: RCC },
    Shipped { name: "calibrate", text: include_str!("../../workflows/calibrate.toml"), files: &[] },
    Shipped { name: "su2021-published", text: include_str!("../../workflows/su2021-published.toml"), files: SU2021 },
];

const SU2021: &[(&str, &str)] = &[
    ("su2021/l64.csv", include_str!("../../workflows/su2021/l64.csv")),
    ("su2021/table02.csv", include_str!("../../workflows/su2021/table02.csv")),
    ("su2021/table03.csv", include_str!("../../workflows/su2021/table03.csv")),
    ("su2021/table04.csv", include_str!("../../workflows/su2021/table04.csv")),
    ("su2021/table05.csv", include_str!("../../workflows/su2021/table05.csv")),
    ("su2021/table06.csv", include_str!("../../workflows/su2021/table06.csv")),
    ("su2021/table07.csv", include_str!("../../workflows/su2021/table07.csv")),
    ("su2021/table08.csv", include_str!("../../workflows/su2021/table08.csv")),
    ("su2021/table09.csv", include_str!("../../workflows/su2021/table09.csv")),
    ("su2021/table10.csv", include_str!("../../workflows/su2021/table10.csv")),
    ("su2021/table11.csv", include_str!("../../workflows/su2021/table11.csv")),
    ("su2021/table12.csv", include_str!("../../workflows/su2021/table12.csv")),
    ("su2021/table13.csv", include_str!("../../workflows/su2021/table13.csv")),
    ("su2021/trial.csv", include_str!("../../workflows/su2021/trial.csv")),
];

const RCC: &[(&str, &str)] = &[
    ("stones/sections.csv", include_str!("../../workflows/stones/sections.csv")),
    ("rcc/measured_2h.csv", include_str!("../../workflows/rcc/measured_2h.csv")),
    ("rcc/measured_4h.csv", include_str!("../../workflows/rcc/measured_4h.csv")),
    ("rcc/measured_6h.csv", include_str!("../../workflows/rcc/measured_6h.csv")),
    ("rcc/measured_8h.csv", include_str!("../../workflows/rcc/measured_8h.csv")),
    ("rcc/table02.csv", include_str!("../../workflows/rcc/table02.csv")),
];

impl New {
    pub(super) fn go(self) -> Exit {
        let Some(shipped) = SHIPPED.iter().find(|shipped| shipped.name == self.from) else {
            let known: Vec<&str> = SHIPPED.iter().map(|shipped| shipped.name).collect();
            let near = nearest(&self.from, known.iter().copied());
            let meant = near.map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
            err!("error: there is no shipped workflow `{}`{meant}\n  there are {}", self.from, known.join(", "));
            return Exit::BadInput;
        };
        let path = self.name.with_extension("toml");
        match self.write(&path, shipped) {
            Ok(beside) => {
                for file in beside {
                    out!("{} is written", file.display());
                }
                let next = quoted(&path.display().to_string());
                out!("{} is written; next: flow plan {next}", path.display());
                Exit::Done
            }
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {
                err!("error: {} is there already and was left as it is", path.display());
                Exit::BadInput
            }
            Err(e) => {
                err!("error: {} cannot be written: {e}", path.display());
                Exit::System
            }
        }
    }

    /// Writes the workflow, which must be new, and the schema and tables beside it, which may be there from another one;
    /// returns the files beside it that are new.
    fn write(&self, path: &Path, shipped: &Shipped) -> std::io::Result<Vec<PathBuf>> {
        std::fs::File::create_new(path)?.write_all(shipped.text.as_bytes())?;
        let schema = format!("{:#}\n", schema::schema());
        let beside = shipped.files.iter().copied().chain([(schema::FILE_NAME, schema.as_str())]);
        let mut written = Vec::new();
        for (name, text) in beside {
            let file = path.with_file_name(name);
            file.parent().map_or(Ok(()), std::fs::create_dir_all)?;
            match std::fs::File::create_new(&file) {
                Ok(mut new) => {
                    new.write_all(text.as_bytes())?;
                    written.push(file);
                }
                Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
        Ok(written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every workflow that `--from` gives passes `flow check`, with all the files that it names.
    #[test]
    fn every_shipped_workflow_is_complete() {
        for shipped in SHIPPED {
            let folder = tempfile::tempdir().unwrap();
            let new = New { name: folder.path().join("mine"), from: shipped.name.to_owned() };
            assert_eq!(new.go(), Exit::Done);
            let path = folder.path().join("mine.toml");
            let faults = crate::plan::load(&path, &crate::plan::Overrides::default()).err().unwrap_or_default();
            assert!(faults.is_empty(), "{}: {}", shipped.name, faults[0]);
            for (_, named) in
                shipped.text.match_indices("file = \"").map(|(at, head)| (at, &shipped.text[at + head.len()..]))
            {
                let file = named.split('"').next().unwrap_or_default();
                assert!(folder.path().join(file).exists(), "{} names {file}, which is not shipped", shipped.name);
            }
            let again = New { name: folder.path().join("mine"), from: shipped.name.to_owned() };
            assert_eq!(again.go(), Exit::BadInput);
        }
    }
}
