//! Figures of a specimen and of one run on it: curves, cracks, forces, particles.

use super::super::StageError;
use super::Params;
use super::source::{Rows, Source, Sources};
use crate::unit::Conversion;
use figure::chains::{Chains, Link};
use figure::cracks::{Crack, Cracks, Moment};
use figure::curve::{Curve, StressStrain};
use figure::rose::Rose;
use figure::specimen::Specimen;
use math::elementary::atan2;

/// Metres to millimetres.
const MM: f64 = 1e3;

pub(super) fn stress_strain(params: &Params, sources: &Sources) -> Result<StressStrain, StageError> {
    let mut curves = Vec::new();
    for (k, source) in sources.of.iter().enumerate() {
        let rows = source.rows(&["curve"])?;
        let axial = rows.reals("axial_strain", "")?;
        let cracks = match source.rows(&["cracks"]) {
            Ok(cracks) => counts(cracks, &axial)?,
            Err(_) => Vec::new(),
        };
        let several = sources.of.len() > 1;
        curves.push(Curve {
            name: params.series.get(k).cloned().unwrap_or_default(),
            lateral: if several { Vec::new() } else { lateral(rows) },
            stress: rows.reals("stress", "MPa")?,
            cracks,
            modulus: if several { None } else { response(*source, "E", "GPa") },
            axial,
        });
    }
    Ok(StressStrain { curves })
}

/// Lateral strain, negative when the specimen widens; empty when there is none.
fn lateral(rows: Rows<'_>) -> Vec<f64> {
    rows.reals("lateral_strain", "").map(|strain| strain.into_iter().map(|e| -e).collect()).unwrap_or_default()
}

/// A response of a run.
fn response(source: Source, name: &str, unit: &str) -> Option<f64> {
    let rows = source.rows(&["responses"]).ok()?;
    let names = rows.texts("response").ok()?;
    let at = names.iter().position(|n| n == name)?;
    let own = rows.texts("unit").ok()?;
    let value = Conversion::between(&own[at], unit).ok()?.of(rows.reals("value", "").ok()?[at]);
    Some(value).filter(|value| value.is_finite())
}

/// Words of the modes of a table of cracks, in the order in which they appear; tension first.
fn modes(cracks: Rows<'_>) -> Result<(Vec<String>, Vec<usize>), StageError> {
    let words = cracks.texts("mode")?;
    let mut names: Vec<String> = words.clone();
    names.sort_by_key(|name| (!name.starts_with("tens"), name.clone()));
    names.dedup();
    let index = words.iter().map(|w| names.iter().position(|n| n == w).unwrap_or(0)).collect();
    Ok((names, index))
}

/// Number of cracks of each mode up to each axial strain of the curve.
fn counts(cracks: Rows<'_>, axial: &[f64]) -> Result<Vec<(String, Vec<f64>)>, StageError> {
    let (names, mode) = modes(cracks)?;
    let strain = cracks.reals("axial_strain", "")?;
    let of_mode = |(k, name): (usize, String)| {
        let mut at: Vec<f64> = strain.iter().zip(&mode).filter(|(_, m)| **m == k).map(|(s, _)| *s).collect();
        at.sort_by(f64::total_cmp);
        (name, axial.iter().map(|e| at.partition_point(|s| s <= e) as f64).collect())
    };
    Ok(names.into_iter().enumerate().map(of_mode).collect())
}

/// Lower left and upper right corner of a specimen in mm; its centre is the origin.
fn domain(specimen: Source) -> Result<([f64; 2], [f64; 2]), StageError> {
    let half = |name: &str| specimen.number(name).map(|v| v * MM / 2.0).ok_or_else(|| specimen.lacks(name));
    let (w, h) = (half("width")?, half("height")?);
    Ok(([-w, -h], [w, h]))
}

/// Polygons of the aggregate in mm.
fn outlines(specimen: Source) -> Vec<Vec<[f64; 2]>> {
    let vertices = specimen.vectors("vertices").unwrap_or_default();
    let owner = specimen.numbers("polygon_of").unwrap_or_default();
    let mut polygons: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut last = f64::NAN;
    for (vertex, &of) in vertices.iter().zip(&owner) {
        if of != last {
            polygons.push(Vec::new());
            last = of;
        }
        if let Some(polygon) = polygons.last_mut() {
            polygon.push(vertex.map(|v| v * MM));
        }
    }
    polygons
}

pub(super) fn specimen(sources: &Sources) -> Result<Specimen, StageError> {
    let source = sources.first()?;
    let (low, high) = domain(source)?;
    let centres = source.vectors("centres").ok_or_else(|| source.lacks("centres"))?;
    let radii = source.numbers("radii").ok_or_else(|| source.lacks("radii"))?;
    let clump = source.numbers("clump_of").unwrap_or_default();
    let group: Vec<usize> = (0..radii.len()).map(|i| usize::from(clump.get(i).is_some_and(|&c| c >= 0.0))).collect();
    let mut groups = vec!["mortar".to_owned()];
    if group.contains(&1) {
        groups.push("aggregate".into());
    }
    Ok(Specimen {
        low,
        high,
        centres: centres.iter().map(|c| c.map(|v| v * MM)).collect(),
        radii: radii.iter().map(|r| r * MM).collect(),
        group,
        groups,
        outlines: outlines(source),
    })
}

/// Lower left and upper right corner of a domain, and the polygons in it.
type Ground = ([f64; 2], [f64; 2], Vec<Vec<[f64; 2]>>);

/// Domain and polygons: of the specimen when it is given, else around the points.
fn ground(sources: &Sources, points: &[[f64; 2]]) -> Result<Ground, StageError> {
    if let Some(&specimen) = sources.compare.first() {
        let (low, high) = domain(specimen)?;
        return Ok((low, high, outlines(specimen)));
    }
    let around = figure::scene::Rect::around(points.iter().copied());
    let r = around.ok_or_else(|| StageError::new("there is nothing to draw").hint("the run has no cracks"))?;
    Ok(([r.left, r.top], [r.right, r.bottom], Vec::new()))
}

/// Names of the modes, and the cracks with the strain at which they opened.
type CrackList = (Vec<String>, Vec<(f64, Crack)>);

fn crack_list(cracks: Rows<'_>) -> Result<CrackList, StageError> {
    let (names, mode) = modes(cracks)?;
    let strain = cracks.reals("axial_strain", "")?;
    let (x, y, size) = (cracks.reals("x", "mm")?, cracks.reals("y", "mm")?, cracks.reals("size", "mm")?);
    let (nx, ny) = (cracks.reals("normal_x", "")?, cracks.reals("normal_y", "")?);
    // The line of a crack is across its normal.
    let crack = |i: usize| Crack { at: [x[i], y[i]], angle: atan2(nx[i], -ny[i]), length: size[i], mode: mode[i] };
    Ok((names, (0..x.len()).map(|i| (strain[i], crack(i))).collect()))
}

/// Half, four fifths and all of the peak stress, and the end of the test.
pub(super) fn cracks(sources: &Sources) -> Result<Cracks, StageError> {
    let source = sources.first()?;
    let (names, list) = crack_list(source.rows(&["cracks"])?)?;
    let curve = source.rows(&["curve"])?;
    let (axial, stress) = (curve.reals("axial_strain", "")?, curve.reals("stress", "MPa")?);
    let pairs = stress.iter().copied().enumerate().filter(|(_, s)| s.is_finite());
    let peak = pairs.max_by(|a, b| a.1.total_cmp(&b.1)).ok_or_else(|| StageError::new("the curve has no stress"))?;
    let reached = |share: f64| {
        let first = (0..=peak.0).find(|&i| stress[i] >= share * peak.1).unwrap_or(peak.0);
        axial.get(first).copied().unwrap_or(f64::INFINITY)
    };
    let end = axial.last().copied().unwrap_or(f64::INFINITY);
    let left = stress.last().map_or(0.0, |s| (100.0 * s / peak.1).round());
    let moments = [
        ("50 % of the peak".to_owned(), reached(0.5)),
        ("80 % of the peak".to_owned(), reached(0.8)),
        ("peak".to_owned(), axial.get(peak.0).copied().unwrap_or(end)),
        (format!("after the peak, {left} %"), end),
    ];
    let until = |strain: f64| list.iter().filter(|(s, _)| *s <= strain).map(|(_, c)| *c).collect::<Vec<_>>();
    let points: Vec<[f64; 2]> = list.iter().map(|(_, c)| c.at).collect();
    let (low, high, outlines) = ground(sources, &points)?;
    let moments = moments.into_iter().map(|(title, strain)| Moment { title, cracks: until(strain) }).collect();
    Ok(Cracks { low, high, modes: names, moments, outlines })
}

pub(super) fn rose(sources: &Sources) -> Result<Rose, StageError> {
    let (names, list) = crack_list(sources.first()?.rows(&["cracks"])?)?;
    let of = |k: usize| list.iter().filter(|(_, c)| c.mode == k).map(|(_, c)| c.angle).collect();
    Ok(Rose { modes: names.into_iter().enumerate().map(|(k, name)| (name, of(k))).collect(), petals: 18 })
}

/// The state of the largest stress among those that were kept.
fn state_at_peak(source: Source) -> Result<(usize, Vec<[f64; 2]>), StageError> {
    let stress = source.rows(&["snapshots/states"])?.reals("stress", "MPa")?;
    let peak = (0..stress.len()).max_by(|&a, &b| stress[a].total_cmp(&stress[b]).then(b.cmp(&a)));
    let peak = peak.ok_or_else(|| StageError::new("the run kept no state"))?;
    let centres = source.states().ok_or_else(|| source.lacks("snapshots/centres"))?;
    let discs = centres.len() / stress.len();
    Ok((peak, centres[peak * discs..][..discs].to_vec()))
}

pub(super) fn chains(sources: &Sources) -> Result<Chains, StageError> {
    let source = sources.first()?;
    let rows = source.rows(&["forces"]).map_err(|e| e.hint("write `forces = true` in the stage of the run"))?;
    let (peak, centres) = state_at_peak(source)?;
    let (state, force) = (rows.reals("state", "")?, rows.reals("normal_force", "kN")?);
    let (first, second) = (rows.reals("first", "")?, rows.reals("second", "")?);
    let place = |disc: f64| centres.get(disc as usize).map(|c| c.map(|v| v * MM));
    let link = |i: usize| Some(Link { from: place(first[i])?, to: place(second[i])?, force: force[i] });
    let links: Option<Vec<Link>> = (0..force.len()).filter(|&i| state[i] == peak as f64).map(link).collect();
    let links = links.ok_or_else(|| StageError::new("the forces name discs that the run does not have"))?;
    let points: Vec<[f64; 2]> = links.iter().flat_map(|l| [l.from, l.to]).collect();
    let (low, high, _) = ground(sources, &points)?;
    let when = "at the greatest stress of the states kept".into();
    Ok(Chains { low, high, links, when, unit: "kN/m".into(), least: 1.0 })
}
