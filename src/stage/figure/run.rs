//! Figures of a specimen and of one run on it: curves, cracks, forces, particles.

use super::super::StageError;
use super::super::specimen::stored;
use super::parts::{MM, groups, modes};
use super::source::Sources;
use super::{Params, space};
use crate::artifact::run::{CrackMode, Cracks as StoredCracks, Curve as Stored, Run};
use crate::artifact::specimen::Specimen as StoredSpecimen;
use crate::unit::Conversion;
use figure::Figure as Picture;
use figure::chains::{Chains, Link};
use figure::cracks::{By, Crack, Cracks, Moment};
use figure::curve::{Curve, StressStrain};
use figure::rose::Rose;
use figure::specimen::{Outline, Specimen};
use math::elementary::atan2;

pub(super) fn stress_strain(params: &Params, sources: &Sources) -> Result<StressStrain, StageError> {
    let mut curves = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let run = Run::from_artifact(source.0)?;
        let curve = curve_of(&run)?;
        let cracks = run.cracks.as_ref().map(|cracks| counts(cracks, &curve.axial_strain)).unwrap_or_default();
        let several = sources.of.len() > 1;
        curves.push(Curve {
            name: params.series.get(k).cloned().unwrap_or_default(),
            // Negative when the specimen widens.
            lateral: if several { Vec::new() } else { curve.lateral_strain.iter().map(|e| -e).collect() },
            stress: shown(&curve.stress, "Pa", "MPa"),
            cracks,
            modulus: if several { None } else { response(&run, "E", "GPa") },
            axial: curve.axial_strain.clone(),
        });
    }
    Ok(StressStrain { curves })
}

pub(super) fn curve_of(run: &Run) -> Result<&Stored, StageError> {
    run.curve.as_ref().ok_or_else(|| StageError::new("the run has no stress–strain curve"))
}

/// Converts numbers from their declared unit to the unit of the figure.
pub(super) fn shown(values: &[f64], from: &str, to: &str) -> Vec<f64> {
    Conversion::between(from, to).unwrap_or_else(|e| panic!("BUG: {from} in {to}: {e}")).of_all(values.to_vec())
}

/// A response of a run.
fn response(run: &Run, name: &str, unit: &str) -> Option<f64> {
    let at = run.responses.response.iter().position(|own| own == name)?;
    let value = Conversion::between(&run.responses.unit[at], unit).ok()?.of(run.responses.value[at]);
    Some(value).filter(|value| value.is_finite())
}

/// Number of cracks of each mode up to each axial strain of the curve.
fn counts(cracks: &StoredCracks, axial: &[f64]) -> Vec<(String, Vec<f64>)> {
    let of_mode = |mode: &CrackMode| {
        let own = cracks.axial_strain.iter().zip(&cracks.mode).filter(|(_, own)| *own == mode);
        let mut at: Vec<f64> = own.map(|(strain, _)| *strain).collect();
        at.sort_by(f64::total_cmp);
        (mode.word().to_owned(), axial.iter().map(|e| at.partition_point(|s| s <= e) as f64).collect())
    };
    modes(cracks).0.iter().map(of_mode).collect()
}

/// Lower left and upper right corner of a specimen in mm; its centre is the origin.
pub(super) fn domain(specimen: &StoredSpecimen) -> ([f64; 2], [f64; 2]) {
    let [w, h] = [specimen.width, specimen.height].map(|v| v * MM / 2.0);
    ([-w, -h], [w, h])
}

/// Shape of a specimen.
pub(super) fn outline(specimen: &StoredSpecimen) -> Outline {
    if specimen.outline == "disc" { Outline::Disc } else { Outline::Rectangle }
}

/// Polygons of the aggregate in mm.
fn outlines(specimen: &StoredSpecimen) -> Vec<Vec<[f64; 2]>> {
    let corners: Vec<(&i64, &[f64; 2])> = specimen.polygon_of.iter().zip(&specimen.vertices).collect();
    let polygon = |corners: &[(&i64, &[f64; 2])]| corners.iter().map(|(_, vertex)| vertex.map(|v| v * MM)).collect();
    corners.chunk_by(|a, b| a.0 == b.0).map(polygon).collect()
}

pub(super) fn specimen(params: &Params, sources: &Sources) -> Result<Box<dyn Picture>, StageError> {
    let stored = stored(sources.first()?.0)?;
    if stored.centres.ncols() == 3 {
        return Ok(Box::new(space::solid(&stored, params.cut)));
    }
    Ok(Box::new(plane(&stored)))
}

/// A specimen of the plane, in mm.
pub(super) fn plane(stored: &StoredSpecimen) -> Specimen {
    let (group, groups) = groups(stored);
    let (low, high) = domain(stored);
    Specimen {
        outline: outline(stored),
        low,
        high,
        centres: stored.centres.rows().into_iter().map(|c| [c[0] * MM, c[1] * MM]).collect(),
        radii: stored.radii.iter().map(|r| r * MM).collect(),
        group,
        groups,
        outlines: outlines(stored),
    }
}

/// The frame of cracks and forces.
pub(super) struct Ground {
    pub(super) outline: Outline,
    /// Lower left corner in mm.
    pub(super) low: [f64; 2],
    /// Upper right corner in mm.
    pub(super) high: [f64; 2],
    /// Outlines of the aggregate in mm.
    pub(super) polygons: Vec<Vec<[f64; 2]>>,
}

/// Domain and polygons of the specimen if there is one, else the box around the points.
pub(super) fn ground(sources: &Sources, points: &[[f64; 2]]) -> Result<Ground, StageError> {
    if let Some(specimen) = sources.compare.first() {
        let specimen = stored(specimen.0)?;
        let (low, high) = domain(&specimen);
        return Ok(Ground { outline: outline(&specimen), low, high, polygons: outlines(&specimen) });
    }
    let around = figure::scene::Rect::around(points.iter().copied());
    let r = around.ok_or_else(|| StageError::new("there is nothing to draw").hint("the run has no cracks"))?;
    let (low, high) = ([r.left, r.top], [r.right, r.bottom]);
    Ok(Ground { outline: Outline::Rectangle, low, high, polygons: Vec::new() })
}

/// Names of the modes, and the cracks with the strain at which they opened.
pub(super) type CrackList = (Vec<String>, Vec<(f64, Crack)>);

pub(super) fn crack_list(run: &Run) -> Result<CrackList, StageError> {
    let cracks = run.cracks.as_ref().ok_or_else(|| StageError::new("the run has no table of cracks"))?;
    let (found, mode) = modes(cracks);
    if cracks.position.ncols() != 2 {
        return Err(StageError::new("cracks are drawn in the plane, and these are in space"));
    }
    let (length, to_mm) = (shown(&cracks.size, "m", "mm"), |row: usize, axis: usize| cracks.position[[row, axis]] * MM);
    // The line of a crack is perpendicular to its normal.
    let crack = |i: usize| Crack {
        at: [to_mm(i, 0), to_mm(i, 1)],
        angle: atan2(cracks.normal[[i, 0]], -cracks.normal[[i, 1]]),
        length: length[i],
        mode: mode[i],
    };
    let names = found.into_iter().map(|mode| mode.word().to_owned()).collect();
    Ok((names, (0..length.len()).map(|i| (cracks.axial_strain[i], crack(i))).collect()))
}

/// Titles and axial strains of the moments of a run that pictures show: half, four fifths and all of the peak stress, and the
/// end of the test.
pub(super) fn moments(run: &Run) -> Result<[(String, f64); 4], StageError> {
    let Stored { axial_strain: axial, stress, .. } = curve_of(run)?;
    let pairs = stress.iter().copied().enumerate().filter(|(_, s)| s.is_finite());
    let peak = pairs.max_by(|a, b| a.1.total_cmp(&b.1)).ok_or_else(|| StageError::new("the curve has no stress"))?;
    let reached = |share: f64| {
        let first = (0..=peak.0).find(|&i| stress[i] >= share * peak.1).unwrap_or(peak.0);
        axial.get(first).copied().unwrap_or(f64::INFINITY)
    };
    let end = axial.last().copied().unwrap_or(f64::INFINITY);
    let left = stress.last().map_or(0.0, |s| (100.0 * s / peak.1).round());
    Ok([
        ("50 % of the peak".to_owned(), reached(0.5)),
        ("80 % of the peak".to_owned(), reached(0.8)),
        ("peak".to_owned(), axial.get(peak.0).copied().unwrap_or(end)),
        (format!("after the peak, {left} %"), end),
    ])
}

/// The fissures of a run in the plane, as their ends in mm; those that cut through are as long as the ground is wide and high.
pub(super) fn fissures(run: &Run, ground: &Ground) -> Vec<[[f64; 2]; 2]> {
    let Some(fissures) = &run.fissures else { return Vec::new() };
    let reach = (ground.high[0] - ground.low[0]) + (ground.high[1] - ground.low[1]);
    let ends = |row: usize| {
        let half = if fissures.size[row].is_finite() { 0.5 * fissures.size[row] * MM } else { reach };
        let along = [fissures.normal[[row, 1]], -fissures.normal[[row, 0]]];
        [-half, half].map(|way| [0, 1].map(|axis| fissures.position[[row, axis]] * MM + way * along[axis]))
    };
    (0..fissures.size.len()).map(ends).collect()
}

/// In the plane at the [`moments`], in space at the end of the test.
pub(super) fn cracks(sources: &Sources) -> Result<Box<dyn Picture>, StageError> {
    let run = Run::from_artifact(sources.first()?.0)?;
    if run.cracks.as_ref().is_some_and(|cracks| cracks.position.ncols() == 3 && !cracks.mode.is_empty()) {
        return Ok(Box::new(space::cracks(&run, sources)?));
    }
    let (modes, list) = crack_list(&run)?;
    let until = |strain: f64| list.iter().filter(|(s, _)| *s <= strain).map(|(_, c)| *c).collect::<Vec<_>>();
    let points: Vec<[f64; 2]> = list.iter().map(|(_, c)| c.at).collect();
    let ground = ground(sources, &points)?;
    let fissures = fissures(&run, &ground);
    let Ground { outline, low, high, polygons: outlines } = ground;
    let moments = moments(&run)?.map(|(title, strain)| Moment { title, cracks: until(strain) }).into();
    Ok(Box::new(Cracks { by: By::Mode, outline, low, high, modes, moments, outlines, fissures }))
}

pub(super) fn rose(sources: &Sources) -> Result<Rose, StageError> {
    let (names, list) = crack_list(&Run::from_artifact(sources.first()?.0)?)?;
    let of = |k: usize| list.iter().filter(|(_, c)| c.mode == k).map(|(_, c)| c.angle).collect();
    Ok(Rose { modes: names.into_iter().enumerate().map(|(k, name)| (name, of(k))).collect(), petals: 18 })
}

/// The state of the largest stress, and the centres of the discs in it in mm.
fn state_at_peak(run: &Run) -> Result<(usize, Vec<[f64; 2]>), StageError> {
    let missing = || StageError::new("the run holds no states");
    let (states, centres) = run.states.as_ref().zip(run.state_centres.as_ref()).ok_or_else(missing)?;
    let stress = &states.stress;
    let peak =
        (0..stress.len()).max_by(|&a, &b| stress[a].total_cmp(&stress[b]).then(b.cmp(&a))).ok_or_else(missing)?;
    let (count, discs, axes) = centres.dim();
    if peak >= count || axes != 2 {
        return Err(StageError::new("force chains are drawn in the plane, one set of centres for each state"));
    }
    Ok((peak, (0..discs).map(|disc| [0, 1].map(|axis| centres[[peak, disc, axis]] * MM)).collect()))
}

pub(super) fn chains(sources: &Sources) -> Result<Chains, StageError> {
    let run = Run::from_artifact(sources.first()?.0)?;
    let missing = || StageError::new("the run holds no forces").hint("write `forces = true` in the stage of the run");
    let forces = run.forces.as_ref().ok_or_else(missing)?;
    let (peak, centres) = state_at_peak(&run)?;
    let force = shown(&forces.normal_force, "N", "kN");
    let centre = |disc: usize| centres.get(disc).copied();
    let link = |i: usize| Some(Link { from: centre(forces.first[i])?, to: centre(forces.second[i])?, force: force[i] });
    let links: Option<Vec<Link>> = (0..force.len()).filter(|&i| forces.state[i] == peak).map(link).collect();
    let links = links.ok_or_else(|| StageError::new("the forces name discs that the run does not have"))?;
    let points: Vec<[f64; 2]> = links.iter().flat_map(|l| [l.from, l.to]).collect();
    let Ground { outline, low, high, .. } = ground(sources, &points)?;
    let when = "at the greatest stress of the states kept".into();
    Ok(Chains { outline, low, high, links, when, unit: "kN/m".into(), least: 1.0 })
}
