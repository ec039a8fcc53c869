//! `--to vtu`: a specimen, or the states of a run, for ParaView. Lengths in m, forces in N per metre of thickness.
//!
//! | file | cells | fields |
//! |---|---|---|
//! | `NAME.particles.vtu` | discs as points | `radius`, `group` (0 mortar, 1 aggregate), `clump` (-1 none); of a run `displacement` |
//! | `NAME.contacts.vtu` | contacts of a specimen as lines | `group` (0 mortar, 1 interface, 2 aggregate), `gap` |
//! | `NAME.clumps.vtu` | polygons of aggregate | `polygon`, `clump` (-1 when no disc lies in it), `mass` |
//! | `NAME.forces.vtu` | contacts of a run as lines, where it kept forces | `normal_force` (compression positive), `shear_force`, `bonded`, `chain` (1 from the mean force on) |
//! | `NAME.cracks.vtu` | cracks up to the state, as lines across the contact | `mode` (0 tension, 1 shear), `group` (0 mortar, 1 interface), `axial_strain` |
//! | `NAME.pvd` | all states of a run over the axial strain | |
//!
//! In ParaView: *Glyph* with `radius` as scale shows the discs, *Tube* the forces.

use super::File;
use super::bodies::{column, contacts};
use super::vtu::{Cells, Field, Grid, pvd};
use crate::artifact::{Array, Artifact, Node, Values};
use dem::genesis::specimen::Specimen;

/// The files of a specimen.
pub(super) fn specimen(name: &str, specimen: &Specimen) -> Vec<File> {
    let particles = Grid { on_points: bodies(specimen), ..points(specimen.centres.clone()) };
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
pub(super) fn run(name: &str, run: &Artifact, specimen: &Specimen) -> Result<Vec<File>, String> {
    let strains = column(run, "snapshots/states", "axial_strain", "")?;
    let centres = states(run, strains.len(), specimen.radii.len())?;
    let mut files = Vec::new();
    let mut series = Vec::new();
    for (state, (&strain, centres)) in strains.iter().zip(&centres).enumerate() {
        let moved = |(now, before): (&[f64; 2], &[f64; 2])| [now[0] - before[0], now[1] - before[1]];
        let moved = centres.iter().zip(&specimen.centres).map(moved).collect();
        let mut fields = bodies(specimen);
        fields.push(Field::Vectors("displacement", moved));
        let grids = [
            ("particles", Some(Grid { on_points: fields, ..points(centres.clone()) })),
            ("forces", forces(run, state, centres)?),
            ("cracks", cracks(run, strain)?),
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

fn points(points: Vec<[f64; 2]>) -> Grid {
    Grid { points, cells: Cells::Points, on_points: Vec::new(), on_cells: Vec::new() }
}

/// What is the same in every state.
fn bodies(specimen: &Specimen) -> Vec<Field> {
    let clump: Vec<i64> = specimen.clump_of_balls().iter().map(|c| c.map_or(-1, |c| c as i64)).collect();
    vec![
        Field::Reals("radius", specimen.radii.clone()),
        Field::Ints("group", clump.iter().map(|&c| i64::from(c >= 0)).collect()),
        Field::Ints("clump", clump),
    ]
}

fn links(specimen: &Specimen) -> Grid {
    let contacts = contacts(specimen, 0.0);
    Grid {
        points: specimen.centres.clone(),
        cells: Cells::Lines(contacts.iter().map(|c| c.ends).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("group", contacts.iter().map(|c| c.group as i64).collect()),
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
        points,
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
fn states(run: &Artifact, count: usize, discs: usize) -> Result<Vec<Vec<[f64; 2]>>, String> {
    let group = match run.root.get("snapshots") {
        Some(Node::Group(group)) => group.get("centres"),
        Some(_) | None => None,
    };
    match group {
        Some(Node::Array(Array { values: Values::Reals(values), .. })) if values.len() == 2 * count * discs => {
            Ok(values.as_chunks::<2>().0.chunks(discs.max(1)).map(<[_]>::to_vec).collect())
        }
        Some(_) => Err("the states of the run are those of another specimen".to_owned()),
        None => Err("the run kept no states".to_owned()),
    }
}

fn forces(run: &Artifact, state: usize, centres: &[[f64; 2]]) -> Result<Option<Grid>, String> {
    if run.table("forces").is_none() {
        return Ok(None);
    }
    let read = |name: &str, unit: &str| column(run, "forces", name, unit);
    let of = read("state", "")?;
    let rows: Vec<usize> = (0..of.len()).filter(|&row| of[row] == state as f64).collect();
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let (first, second) = (pick(&read("first", "")?), pick(&read("second", "")?));
    let lines: Vec<[usize; 2]> = first.iter().zip(&second).map(|(&a, &b)| [a as usize, b as usize]).collect();
    if lines.iter().flatten().any(|&disc| disc >= centres.len()) {
        return Err("the forces name discs that the run does not have".to_owned());
    }
    let (normal, shear, bonded) =
        (pick(&read("normal_force", "N")?), pick(&read("shear_force", "N")?), pick(&read("bonded", "")?));
    let mean = normal.iter().map(|force| force.abs()).sum::<f64>() / normal.len().max(1) as f64;
    Ok(Some(Grid {
        points: centres.to_vec(),
        cells: Cells::Lines(lines),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("chain", normal.iter().map(|force| i64::from(force.abs() >= mean)).collect()),
            Field::Reals("normal_force", normal),
            Field::Reals("shear_force", shear),
            Field::Ints("bonded", bonded.iter().map(|&bonded| bonded as i64).collect()),
        ],
    }))
}

/// The cracks up to an axial strain; none is no grid.
fn cracks(run: &Artifact, until: f64) -> Result<Option<Grid>, String> {
    let read = |name: &str, unit: &str| column(run, "cracks", name, unit);
    let words = |name: &str| match run.table("cracks").and_then(|table| table.column(name)).map(|c| &c.values) {
        Some(Values::Texts(texts)) => Ok(texts.clone()),
        Some(_) | None => Err(format!("the cracks have no column `{name}`")),
    };
    let (strain, x, y, size) = (read("axial_strain", "")?, read("x", "m")?, read("y", "m")?, read("size", "m")?);
    let (nx, ny) = (read("normal_x", "")?, read("normal_y", "")?);
    let (mode, group) = (words("mode")?, words("group")?);
    let open: Vec<usize> = (0..strain.len()).filter(|&crack| strain[crack] <= until).collect();
    if open.is_empty() {
        return Ok(None);
    }
    let ends = |&c: &usize| [-0.5, 0.5].map(|half| [x[c] - half * size[c] * ny[c], y[c] + half * size[c] * nx[c]]);
    let is = |texts: &[String], word: &str| open.iter().map(|&c| i64::from(texts[c] == word)).collect();
    Ok(Some(Grid {
        points: open.iter().flat_map(ends).collect(),
        cells: Cells::Lines((0..open.len()).map(|k| [2 * k, 2 * k + 1]).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("mode", is(&mode, "shear")),
            Field::Ints("group", is(&group, "interface")),
            Field::Reals("axial_strain", open.iter().map(|&c| strain[c]).collect()),
        ],
    }))
}
