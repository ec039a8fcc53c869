//! `flow schema`: the JSON Schema of workflow files, for editors.

use super::Exit;
use clap::Args;

/// Print the JSON Schema of workflow files; editors complete and check a file whose first line is
/// `#:schema flow.schema.json`.
#[derive(Args)]
pub(super) struct Schema {}

impl Schema {
    pub(super) fn go(self) -> Exit {
        out!("{:#}", crate::plan::schema::schema());
        Exit::Done
    }
}
