//! `--to vtu`: a specimen, or the states of a run, for ParaView. Lengths in m, forces in N per metre of thickness.
//!
//! | file | cells | fields |
//! |---|---|---|
//! | `NAME.particles.vtu` | discs as points | `radius`, `group` (number among those of the specimen; the aggregate's is the last), `clump` (-1 none); of a run `displacement` |
//! | `NAME.contacts.vtu` | contacts of a specimen as lines | `group` (0 between discs, 1 of a disc and aggregate, 2 within aggregate), `gap` |
//! | `NAME.clumps.vtu` | polygons of aggregate | `polygon`, `clump` (-1 when no disc lies in it), `mass` |
//! | `NAME.forces.vtu` | contacts of a run as lines, where it stored forces | `normal_force` (compression positive), `shear_force`, `bonded`, `chain` (1 from the mean force on) |
//! | `NAME.cracks.vtu` | cracks up to the state, as lines across the contact | `mode` (0 tension, 1 shear), `group` (number of the contact among those of all cracks by name), `axial_strain` |
//! | `NAME.pvd` | all states of a run over the axial strain | |
//!
//! In ParaView: *Glyph* with `radius` as scale shows the discs, *Tube* the forces.

use super::File;
use super::bodies::contacts;
use super::vtu::{Cells, Field, Grid, in_space, pvd};
use crate::artifact::Artifact;
use crate::artifact::run::{CrackMode, Run};
use dem::genesis::specimen::Specimen;
use std::collections::BTreeSet;

/// The files of a specimen.
pub fn specimen(name: &str, specimen: &Specimen) -> Vec<File> {
    let particles = Grid { on_points: bodies(specimen), ..points(&specimen.centres) };
    let mut files = vec![
        (format!("{name}.particles.vtu"), particles.vtu().into_bytes()),
        (format!("{name}.contacts.vtu"), links(specimen).vtu().into_bytes()),
    ];
    if !specimen.polygons.is_empty() {
        files.push((format!("{name}.clumps.vtu"), clumps(specimen).vtu().into_bytes()));
    }
    files
}

/// The files of a run on a specimen.
pub fn run(name: &str, run: &Artifact, specimen: &Specimen) -> Result<Vec<File>, String> {
    let run = Run::from_artifact(run).map_err(|e| e.to_string())?;
    let strains = run.states.as_ref().map(|states| states.axial_strain.clone()).ok_or("the run holds no states")?;
    let centres = states(&run, strains.len(), specimen.radii.len())?;
    let mut files = Vec::new();
    let mut series = Vec::new();
    for (state, (&strain, centres)) in strains.iter().zip(&centres).enumerate() {
        let moved = |(now, before): (&[f64; 2], &[f64; 2])| [now[0] - before[0], now[1] - before[1]];
        let moved = centres.iter().zip(&specimen.centres).map(moved).collect();
        let mut fields = bodies(specimen);
        fields.push(Field::Vectors("displacement", moved));
        let grids = [
            ("particles", Some(Grid { on_points: fields, ..points(centres) })),
            ("forces", forces(&run, state, centres)?),
            ("cracks", cracks(&run, strain)?),
        ];
        for (part, (what, grid)) in grids.into_iter().enumerate() {
            let Some(grid) = grid else { continue };
            let file = format!("{name}.{what}.{state}.vtu");
            series.push((strain, part, file.clone()));
            files.push((file, grid.vtu().into_bytes()));
        }
    }
    files.push((format!("{name}.pvd"), pvd(&series).into_bytes()));
    Ok(files)
}

fn points(points: &[[f64; 2]]) -> Grid {
    Grid { points: in_space(points), cells: Cells::Points, on_points: Vec::new(), on_cells: Vec::new() }
}

/// What is the same in every state.
fn bodies(specimen: &Specimen) -> Vec<Field> {
    let clump: Vec<i64> = specimen.clump_of_balls().iter().map(|c| c.map_or(-1, |c| c as i64)).collect();
    vec![
        Field::Reals("radius", specimen.radii.clone()),
        Field::Ints("group", specimen.groups.iter().map(|group| i64::from(group.0)).collect()),
        Field::Ints("clump", clump),
    ]
}

fn links(specimen: &Specimen) -> Grid {
    let contacts = contacts(specimen, 0.0);
    Grid {
        points: in_space(&specimen.centres),
        cells: Cells::Lines(contacts.iter().map(|c| c.ends).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("group", contacts.iter().map(|c| (c.groups[0] + c.groups[1]) as i64).collect()),
            Field::Reals("gap", contacts.iter().map(|c| c.gap).collect()),
        ],
    }
}

fn clumps(specimen: &Specimen) -> Grid {
    let mut points = Vec::new();
    let mut polygons = Vec::new();
    for polygon in &specimen.polygons {
        polygons.push((points.len()..points.len() + polygon.vertices.len()).collect());
        points.extend(polygon.vertices.iter().copied());
    }
    let numbers = 0..specimen.polygons.len();
    let clump = |polygon: usize| specimen.clumps.iter().position(|clump| clump.polygon == polygon);
    Grid {
        points: in_space(&points),
        cells: Cells::Polygons(polygons),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("polygon", numbers.clone().map(|polygon| polygon as i64).collect()),
            Field::Ints("clump", numbers.clone().map(|p| clump(p).map_or(-1, |c| c as i64)).collect()),
            Field::Reals("mass", numbers.map(|p| clump(p).map_or(0.0, |c| specimen.clumps[c].mass)).collect()),
        ],
    }
}

/// Centres of the discs in each state.
fn states(run: &Run, count: usize, discs: usize) -> Result<Vec<Vec<[f64; 2]>>, String> {
    let centres = run.state_centres.as_ref().ok_or("the run holds no states")?;
    if centres.dim() != (count, discs, 2) {
        return Err("the states of the run are those of another specimen".to_owned());
    }
    let centre = |state, disc| [0, 1].map(|axis| centres[[state, disc, axis]]);
    Ok((0..count).map(|state| (0..discs).map(|disc| centre(state, disc)).collect()).collect())
}

fn forces(run: &Run, state: usize, centres: &[[f64; 2]]) -> Result<Option<Grid>, String> {
    let Some(forces) = &run.forces else { return Ok(None) };
    let rows: Vec<usize> = (0..forces.state.len()).filter(|&row| forces.state[row] == state).collect();
    let lines: Vec<[usize; 2]> = rows.iter().map(|&row| [forces.first[row], forces.second[row]]).collect();
    if lines.iter().flatten().any(|&disc| disc >= centres.len()) {
        return Err("the forces name discs that the run does not have".to_owned());
    }
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let (normal, shear) = (pick(&forces.normal_force), pick(&forces.shear_force));
    let mean = normal.iter().map(|force| force.abs()).sum::<f64>() / normal.len().max(1) as f64;
    Ok(Some(Grid {
        points: in_space(centres),
        cells: Cells::Lines(lines),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("chain", normal.iter().map(|force| i64::from(force.abs() >= mean)).collect()),
            Field::Reals("normal_force", normal),
            Field::Reals("shear_force", shear),
            Field::Ints("bonded", rows.iter().map(|&row| i64::from(forces.bonded[row])).collect()),
        ],
    }))
}

/// The cracks up to an axial strain; none is no grid.
fn cracks(run: &Run, until: f64) -> Result<Option<Grid>, String> {
    let Some(cracks) = &run.cracks else { return Ok(None) };
    if cracks.position.ncols() != 2 {
        return Err("cracks in space are no lines; write them with --to csv".to_owned());
    }
    let open: Vec<usize> = (0..cracks.size.len()).filter(|&crack| cracks.axial_strain[crack] <= until).collect();
    if open.is_empty() {
        return Ok(None);
    }
    let ends = |&c: &usize| {
        let ([x, y], [nx, ny]) =
            ([0, 1].map(|axis| cracks.position[[c, axis]]), [0, 1].map(|axis| cracks.normal[[c, axis]]));
        [-0.5, 0.5].map(|half| [x - half * cracks.size[c] * ny, y + half * cracks.size[c] * nx])
    };
    let names: BTreeSet<&String> = cracks.group.iter().collect();
    let number = |name: &String| names.iter().position(|known| *known == name).map_or(-1, |place| place as i64);
    let marked = |is: &dyn Fn(usize) -> bool| open.iter().map(|&crack| i64::from(is(crack))).collect();
    Ok(Some(Grid {
        points: in_space(&open.iter().flat_map(ends).collect::<Vec<_>>()),
        cells: Cells::Lines((0..open.len()).map(|k| [2 * k, 2 * k + 1]).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("mode", marked(&|crack| cracks.mode[crack] == CrackMode::Shear)),
            Field::Ints("group", open.iter().map(|&crack| number(&cracks.group[crack])).collect()),
            Field::Reals("axial_strain", open.iter().map(|&crack| cracks.axial_strain[crack]).collect()),
        ],
    }))
}
