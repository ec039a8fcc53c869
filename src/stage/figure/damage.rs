//! The picture of damage: every interface of which something is broken, in four classes of the broken share of its area.
//!
//! In the plane an interface is a line of its whole width at its contact, at several moments; in space its broken elements
//! are discs of their area, at the end of the test, in the class of their interface.

use super::super::StageError;
use super::parts::MM;
use super::run::{Ground, fissures, ground, moments};
use super::source::Sources;
use super::space;
use crate::artifact::damage::Damaged;
use crate::artifact::run::Run;
use figure::Figure as Picture;
use figure::cracks::{By, Crack, Cracks, Moment};
use figure::solid::{Penny, Solid};
use math::elementary::atan2;
use std::collections::BTreeMap;

/// Classes of the broken share of an interface.
const CLASSES: [&str; 4] = ["25 % or less broken", "50 % or less", "below 100 %", "100 %"];

/// The class of a share.
fn class(share: f64) -> usize {
    // Shares are quotients of whole numbers, so a quarter is exact.
    [0.25, 0.5].iter().filter(|&&bound| share > bound).count() + usize::from(share >= 1.0)
}

pub(super) fn damage(sources: &Sources) -> Result<Box<dyn Picture>, StageError> {
    let run = Run::from_artifact(sources.first()?.0)?;
    let missing = "the run does not say how much of its interfaces is broken";
    let lacks =
        || StageError::new(missing).hint("contacts with `bond = \"flat-joint\"` have interfaces that break in parts");
    let last = run.damaged(f64::INFINITY).ok_or_else(lacks)?;
    if run.cracks.as_ref().is_some_and(|cracks| cracks.position.ncols() == 3) {
        return Ok(Box::new(solid(&run, &last, sources)?));
    }
    let lines = |all: &[Damaged]| all.iter().filter_map(|one| line(&run, one)).collect::<Vec<Crack>>();
    let points: Vec<[f64; 2]> = lines(&last).iter().map(|line| line.at).collect();
    let ground = ground(sources, &points)?;
    let fissures = fissures(&run, &ground);
    let Ground { outline, low, high, polygons: outlines } = ground;
    let moment = |(title, strain)| Moment { title, cracks: lines(&run.damaged(strain).unwrap_or_default()) };
    let (modes, moments) = (CLASSES.map(str::to_owned).into(), moments(&run)?.map(moment).into());
    Ok(Box::new(Cracks { by: By::Damage, outline, low, high, modes, moments, outlines, fissures }))
}

/// A damaged interface of the plane as a line.
fn line(run: &Run, one: &Damaged) -> Option<Crack> {
    let (contact, normal) = (&run.interfaces.as_ref()?.contact, &run.cracks.as_ref()?.normal);
    Some(Crack {
        at: [0, 1].map(|axis| contact[[one.row, axis]] * MM),
        angle: atan2(normal[[one.row, 0]], -normal[[one.row, 1]]),
        length: one.width * MM,
        mode: class(one.share),
    })
}

/// The broken elements of a run in space.
fn solid(run: &Run, all: &[Damaged], sources: &Sources) -> Result<Solid, StageError> {
    let solid = space::cracks(run, sources)?;
    let Some(interfaces) = &run.interfaces else { return Ok(solid) };
    let of: BTreeMap<[usize; 2], usize> = all.iter().map(|one| (one.bodies, class(one.share))).collect();
    let mode = |row: usize| of.get(&[interfaces.first[row], interfaces.second[row]]).copied().unwrap_or(0);
    let cracks = solid.cracks.iter().enumerate().map(|(row, penny)| Penny { mode: mode(row), ..*penny }).collect();
    Ok(Solid { by: By::Damage, modes: CLASSES.map(str::to_owned).into(), cracks, ..solid })
}

#[cfg(test)]
mod tests {
    use super::class;

    #[test]
    fn classes_end_at_quarter_half_and_whole() {
        let shares = [1.0 / 32.0, 0.25, 1.0 / 3.0, 0.5, 2.0 / 3.0, 0.75, 31.0 / 32.0, 1.0];
        assert_eq!(shares.map(class), [0, 0, 1, 1, 2, 2, 2, 3]);
    }
}
