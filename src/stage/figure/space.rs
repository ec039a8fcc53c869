//! Specimens, cracks and stones in space. The axis of loading, the second of a specimen, points up on the page.

use super::super::specimen::stored;
use super::super::{StageError, shapes};
use super::parts::{MM, groups, modes};
use super::source::Sources;
use crate::artifact::run::Run;
use crate::artifact::shapes::Shapes;
use crate::artifact::specimen::Specimen as StoredSpecimen;
use figure::solid::{Cut, Penny, Rim, Solid};
use figure::stones::{Stone, Stones};
use figure::zingg::Zingg;

/// A position or direction of the specimen on the page, in mm.
fn upright([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x * MM, -z * MM, y * MM]
}

/// A specimen in space, without its balls, in mm.
fn frame(stored: &StoredSpecimen) -> Solid {
    let half = [stored.width, stored.depth, stored.height].map(|edge| 0.5 * edge * MM);
    // On the page the second axis is the depth, the third the height.
    let round = match stored.outline.as_str() {
        "thick-disc" => Some(1),
        "cylinder" => Some(2),
        _ => None,
    };
    Solid { low: half.map(|edge| -edge), high: half, y_up: true, round, ..Solid::default() }
}

/// A specimen in space with the cut that is asked for; without one it is cut open through its middle if it holds rigid clumps,
/// which the mortar would hide.
pub(super) fn solid(stored: &StoredSpecimen, cut: Option<super::cut::Cut>) -> Solid {
    let (group, groups) = groups(stored);
    let clumps = stored.clump_of.iter().any(|&clump| clump >= 0);
    Solid {
        centres: stored.centres.rows().into_iter().map(|c| upright([c[0], c[1], c[2]])).collect(),
        radii: stored.radii.iter().map(|r| r * MM).collect(),
        group,
        groups,
        cut: cut.map_or(clumps.then_some(Cut { axis: 1, at: 0.0 }), super::cut::Cut::on_page),
        ..frame(stored)
    }
}

/// All cracks of a run in space, in the frame of its specimen if that is an input.
pub(super) fn cracks(run: &Run, sources: &Sources) -> Result<Solid, StageError> {
    let cracks = run.cracks.as_ref().ok_or_else(|| StageError::new("the run has no table of cracks"))?;
    let (found, mode) = modes(cracks);
    let vector = |of: &ndarray::Array2<f64>, row: usize| upright([0, 1, 2].map(|axis| of[[row, axis]]));
    let penny = |row: usize| Penny {
        at: vector(&cracks.position, row),
        normal: vector(&cracks.normal, row).map(|part| part / MM),
        radius: 0.5 * cracks.size[row] * MM,
        mode: mode[row],
    };
    let cracks: Vec<Penny> = (0..mode.len()).map(penny).collect();
    let solid = match sources.compare.first() {
        Some(specimen) => frame(&stored(specimen.0)?),
        None => {
            let axis = |k: usize| figure::axis::extent(cracks.iter().map(|crack| crack.at[k]));
            let ends = [0, 1, 2].map(axis);
            Solid { low: ends.map(|end| end.0), high: ends.map(|end| end.1), y_up: true, ..Solid::default() }
        }
    };
    let modes = found.into_iter().map(|mode| mode.word().to_owned()).collect();
    Ok(Solid { cracks, modes, fissures: rims(run, &solid), ..solid })
}

/// The fissures of a run in space that reach its specimen; those that cut through reach across the whole frame.
fn rims(run: &Run, frame: &Solid) -> Vec<Rim> {
    let Some(fissures) = &run.fissures else { return Vec::new() };
    let across = [0, 1, 2].map(|k| frame.high[k] - frame.low[k]);
    let reach = 0.5 * across.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
    let vector = |of: &ndarray::Array2<f64>, row: usize| upright([0, 1, 2].map(|axis| of[[row, axis]]));
    let rim = |row: usize| Rim {
        at: vector(&fissures.position, row),
        normal: vector(&fissures.normal, row).map(|part| part / MM),
        radius: if fissures.size[row].is_finite() { 0.5 * fissures.size[row] * MM } else { reach },
    };
    (0..fissures.size.len()).filter(|&row| fissures.inside[row] > 0.0).map(rim).collect()
}

/// Stones with their clumps, the longest side to the right.
pub(super) fn stones(sources: &Sources) -> Result<Stones, StageError> {
    let millimetres = |v: [f64; 3]| v.map(|x| x * MM);
    let stone = |shape: shapes::Shape| Stone {
        note: match shape.clump.balls.len() {
            1 => "1 pebble".to_owned(),
            many => format!("{many} pebbles"),
        },
        name: figure::text::plain_text(&shape.name),
        facets: shape.mesh.triangles().map(|corners| corners.map(millimetres)).collect(),
        pebbles: shape.clump.balls.iter().map(|ball| (millimetres(ball.centre), ball.radius * MM)).collect(),
    };
    Ok(Stones { stones: shapes::load(sources.first()?.0)?.into_iter().map(stone).collect() })
}

/// Stones by their proportions.
pub(super) fn zingg(sources: &Sources) -> Result<Zingg, StageError> {
    let stored = Shapes::from_artifact(sources.first()?.0)?.shapes;
    Ok(Zingg { names: stored.shape, flatness: stored.flatness, elongation: stored.elongation, share: stored.share })
}
