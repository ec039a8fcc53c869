//! A run at its stored states, and as a moving picture: the specimen displaced in the plane, the cracks in space.

use super::super::StageError;
use super::super::specimen::stored;
use super::parts::MM;
use super::run::{crack_list, curve_of, plane, shown};
use super::source::Sources;
use super::space;
use crate::artifact::run::Run;
use figure::Figure as Picture;
use figure::snapshots::{Snapshots, State};
use figure::solid::growth::Growth;

/// A stress that differs from the peak by less than this share of it is that of the peak.
const AT_PEAK: f64 = 0.005;

pub(super) fn snapshots(sources: &Sources) -> Result<Box<dyn Picture>, StageError> {
    let run = Run::from_artifact(sources.first()?.0)?;
    let specimen = sources.compare.first().ok_or_else(|| StageError::new("the specimen of the run is not named"))?;
    let specimen = stored(specimen.0)?;
    let curve = curve_of(&run)?;
    if specimen.centres.ncols() == 3 {
        let solid = space::cracks(&run, sources)?;
        let strains = run.cracks.as_ref().map(|cracks| cracks.axial_strain.clone()).unwrap_or_default();
        return Ok(Box::new(Growth { solid, strains, end: curve.axial_strain.last().copied().unwrap_or_default() }));
    }
    let (modes, mut cracks) = crack_list(&run)?;
    cracks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let points = curve.axial_strain.iter().copied().zip(shown(&curve.stress, "Pa", "MPa"));
    let known = points.filter(|(strain, stress)| strain.is_finite() && stress.is_finite());
    Ok(Box::new(Snapshots {
        specimen: plane(&specimen),
        states: states(&run, specimen.radii.len())?,
        modes,
        cracks,
        curve: known.map(|(strain, stress)| [strain, stress]).collect(),
    }))
}

/// The stored states of a run on a specimen of so many discs.
fn states(run: &Run, discs: usize) -> Result<Vec<State>, StageError> {
    let missing = || StageError::new("the run holds no states");
    let (states, centres) = run.states.as_ref().zip(run.state_centres.as_ref()).ok_or_else(missing)?;
    if centres.dim() != (states.stress.len(), discs, 2) {
        return Err(StageError::new("the states of the run are those of another specimen"));
    }
    let stress = &states.stress;
    let peak =
        (0..stress.len()).max_by(|&a, &b| stress[a].total_cmp(&stress[b]).then(b.cmp(&a))).ok_or_else(missing)?;
    // The greatest stress of the curve, which a state at the peak was stored beside.
    let top = curve_of(run)?.stress.iter().copied().chain([stress[peak]]).filter(|s| s.is_finite()).fold(0.0, f64::max);
    let title = |state: usize| {
        let share = stress[state] / top;
        let percent = (100.0 * share).round();
        match state {
            _ if share >= 1.0 - AT_PEAK => "peak".to_owned(),
            _ if state < peak => format!("{percent} % of the peak"),
            _ => format!("after the peak, {percent} %"),
        }
    };
    let centre = |state, disc| [0, 1].map(|axis| centres[[state, disc, axis]] * MM);
    let state = |number: usize| State {
        strain: states.axial_strain[number],
        title: title(number),
        centres: (0..discs).map(|disc| centre(number, disc)).collect(),
    };
    Ok((0..stress.len()).map(state).collect())
}
