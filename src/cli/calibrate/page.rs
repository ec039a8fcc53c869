//! The calibrator as a page of its own.

use super::Asked;
use crate::cli::Exit;
use crate::cli::common::{Campaign, system};
use crate::cli::files::Files;
use crate::cli::output;
use crate::cli::store::bytes;
use crate::report::{calibrator_page, gather};
use std::path::Path;

/// Writes the page of a calibration whose surfaces are stored.
pub(super) fn write(campaign: &Campaign, asked: &Asked, file: &Path) -> Result<Exit, Exit> {
    let text = std::fs::read_to_string(&campaign.workflow).map_err(|e| system(&e))?;
    let own = crate::report::Asked { text, sets: campaign.sets.clone(), store: String::new() };
    let paper = gather(&asked.workflow, own, &asked.store).map_err(|e| system(&*e))?;
    let page = calibrator_page(&paper, &asked.stage).map_err(|e| {
        err!("error: {}: {}", asked.stage, e.message);
        Exit::Failed
    })?;
    let Some(page) = page else {
        err!(
            "error: the surfaces of `{}` have no result that can be read\n  run them again: {}",
            asked.stage,
            campaign.command("run", &[])
        );
        return Err(Exit::Failed);
    };
    if file == Path::new("-") {
        output::write(&page);
        return Ok(Exit::Done);
    }
    Files::of(&asked.workflow).put(file, page.as_bytes())?;
    if !campaign.common.quiet {
        out!("{}  {}", file.display(), bytes(page.len() as u64));
    }
    Ok(Exit::Done)
}
