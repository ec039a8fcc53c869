//! `--to vtu`: a specimen, or the states of a run, for ParaView. Lengths in m, forces in N; in the plane per metre of
//! thickness.
//!
//! | file | cells | fields |
//! |---|---|---|
//! | `NAME.particles.vtu` | balls as points | `radius`, `group` (number among those of the specimen; the aggregate's is the last), `clump` (-1 none); of a run `displacement`, with flat joints `broken_area` of the interfaces of the ball |
//! | `NAME.contacts.vtu` | contacts of a specimen as lines | `group` (0 between balls, 1 of a ball and aggregate, 2 within aggregate), `gap` |
//! | `NAME.clumps.vtu` | polygons of aggregate | `polygon`, `clump` (-1 when no ball lies in it), `mass` |
//! | `NAME.forces.vtu` | contacts of a run as lines, where it stored forces | `normal_force` (compression positive), `shear_force`, `bonded`, `chain` (1 from the mean force on) |
//! | `NAME.cracks.vtu` | cracks up to the state, as lines across the contact, in space as discs | `mode` (0 tension, 1 shear), `group` (index of the contact among those of all cracks by name), `axial_strain` |
//! | `NAME.damage.vtu` | interfaces of flat joints of which something is broken, as lines between the balls | `damage` (broken share of the area), `broken_area` (in the plane per metre), `cracks` |
//! | `NAME.pvd` | all states of a run over the axial strain | |
//!
//! In ParaView: *Glyph* with `radius` as scale shows the balls, *Tube* the forces.

use super::File;
use super::bodies::contacts;
use super::vtu::{Cells, Field, Grid, pvd, spatial};
use crate::artifact::Artifact;
use crate::artifact::damage::Damaged;
use crate::artifact::run::{CrackMode, Cracks, Run};
use dem::genesis::specimen::Specimen;
use dem::space::Tuple;
use dem::{D2, Space, Vector};
use math::elementary::sin_cos;
use ndarray::Array2;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// The files of a specimen.
pub fn specimen<S: Space>(name: &str, specimen: &Specimen<S>) -> Vec<File> {
    let particles = Grid { on_points: bodies(specimen), ..points::<S>(&specimen.centres) };
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
///
/// # Errors
/// The run holds no states, or those of another specimen.
pub fn run<S: Space>(name: &str, run: &Artifact, specimen: &Specimen<S>) -> Result<Vec<File>, String> {
    let run = Run::from_artifact(run).map_err(|e| e.to_string())?;
    let strains = run.states.as_ref().map(|states| states.axial_strain.clone()).ok_or("the run holds no states")?;
    let centres = states::<S>(&run, strains.len(), specimen.radii.len())?;
    let mut files = Vec::new();
    let mut series = Vec::new();
    for (state, (&strain, centres)) in strains.iter().zip(&centres).enumerate() {
        let moved = |(now, before): (&Vector<S>, &Vector<S>)| spatial::<S>(now.minus(*before));
        let moved = centres.iter().zip(&specimen.centres).map(moved).collect();
        let mut fields = bodies(specimen);
        fields.push(Field::Vectors("displacement", moved));
        let damage = run.damaged(strain);
        if damage.iter().flatten().any(|one| one.bodies.iter().any(|&ball| ball >= centres.len())) {
            return Err("the interfaces name balls that the run does not have".to_owned());
        }
        fields.extend(damage.as_ref().map(|all| Field::Reals("broken_area", broken(all, centres.len()))));
        let grids = [
            ("particles", Some(Grid { on_points: fields, ..points::<S>(centres) })),
            ("forces", forces::<S>(&run, state, centres)?),
            ("cracks", cracks::<S>(&run, strain)?),
            ("damage", damage.as_ref().map(|all| damaged::<S>(all, centres))),
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

fn all<S: Space>(points: &[Vector<S>]) -> Vec<[f64; 3]> {
    points.iter().map(|point| spatial::<S>(*point)).collect()
}

fn points<S: Space>(points: &[Vector<S>]) -> Grid {
    Grid { points: all::<S>(points), cells: Cells::Points, on_points: Vec::new(), on_cells: Vec::new() }
}

/// What is the same in every state.
fn bodies<S: Space>(specimen: &Specimen<S>) -> Vec<Field> {
    let clump: Vec<i64> = specimen.clump_of_balls().iter().map(|c| c.map_or(-1, |c| c as i64)).collect();
    vec![
        Field::Reals("radius", specimen.radii.clone()),
        Field::Ints("group", specimen.groups.iter().map(|group| i64::from(group.0)).collect()),
        Field::Ints("clump", clump),
    ]
}

fn links<S: Space>(specimen: &Specimen<S>) -> Grid {
    let contacts = contacts(specimen, 0.0);
    Grid {
        points: all::<S>(&specimen.centres),
        cells: Cells::Lines(contacts.iter().map(|c| c.ends).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("group", contacts.iter().map(|c| (c.groups[0] + c.groups[1]) as i64).collect()),
            Field::Reals("gap", contacts.iter().map(|c| c.gap).collect()),
        ],
    }
}

fn clumps<S: Space>(specimen: &Specimen<S>) -> Grid {
    let mut points = Vec::new();
    let mut polygons = Vec::new();
    for polygon in &specimen.polygons {
        polygons.push((points.len()..points.len() + polygon.vertices.len()).collect());
        points.extend(polygon.vertices.iter().copied());
    }
    let numbers = 0..specimen.polygons.len();
    let clump = |polygon: usize| specimen.clumps.iter().position(|clump| clump.polygon == polygon);
    Grid {
        points: all::<D2>(&points),
        cells: Cells::Polygons(polygons),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("polygon", numbers.clone().map(|polygon| polygon as i64).collect()),
            Field::Ints("clump", numbers.clone().map(|p| clump(p).map_or(-1, |c| c as i64)).collect()),
            Field::Reals("mass", numbers.map(|p| clump(p).map_or(0.0, |c| specimen.clumps[c].mass)).collect()),
        ],
    }
}

/// Centres of the balls in each state.
fn states<S: Space>(run: &Run, count: usize, balls: usize) -> Result<Vec<Vec<Vector<S>>>, String> {
    let centres = run.state_centres.as_ref().ok_or("the run holds no states")?;
    if centres.dim() != (count, balls, S::DIMENSION) {
        return Err("the states of the run are those of another specimen".to_owned());
    }
    let centre = |state, ball| Vector::<S>::build(|axis| centres[[state, ball, axis]]);
    Ok((0..count).map(|state| (0..balls).map(|ball| centre(state, ball)).collect()).collect())
}

fn forces<S: Space>(run: &Run, state: usize, centres: &[Vector<S>]) -> Result<Option<Grid>, String> {
    let Some(forces) = &run.forces else { return Ok(None) };
    let rows: Vec<usize> = (0..forces.state.len()).filter(|&row| forces.state[row] == state).collect();
    let lines: Vec<[usize; 2]> = rows.iter().map(|&row| [forces.first[row], forces.second[row]]).collect();
    if lines.iter().flatten().any(|&ball| ball >= centres.len()) {
        return Err("the forces name balls that the run does not have".to_owned());
    }
    let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
    let (normal, shear) = (pick(&forces.normal_force), pick(&forces.shear_force));
    let mean = normal.iter().map(|force| force.abs()).sum::<f64>() / normal.len().max(1) as f64;
    Ok(Some(Grid {
        points: all::<S>(centres),
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

/// Damaged interfaces as lines between the centres of their balls.
fn damaged<S: Space>(all: &[Damaged], centres: &[Vector<S>]) -> Grid {
    Grid {
        points: self::all::<S>(centres),
        cells: Cells::Lines(all.iter().map(|one| one.bodies).collect()),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Reals("damage", all.iter().map(|one| one.share).collect()),
            Field::Reals("broken_area", all.iter().map(|one| one.area).collect()),
            Field::Ints("cracks", all.iter().map(|one| one.cracks as i64).collect()),
        ],
    }
}

/// The broken area of the interfaces of each ball.
fn broken(all: &[Damaged], balls: usize) -> Vec<f64> {
    let mut sum = vec![0.0; balls];
    for one in all {
        one.bodies.iter().for_each(|&ball| sum[ball] += one.area);
    }
    sum
}

/// The cracks up to an axial strain; none is no grid.
fn cracks<S: Space>(run: &Run, until: f64) -> Result<Option<Grid>, String> {
    let Some(cracks) = &run.cracks else { return Ok(None) };
    if cracks.position.ncols() != S::DIMENSION {
        return Err("the cracks of the run are those of another space than its specimen's".to_owned());
    }
    let open: Vec<usize> = (0..cracks.size.len()).filter(|&crack| cracks.axial_strain[crack] <= until).collect();
    if open.is_empty() {
        return Ok(None);
    }
    let names: BTreeSet<&String> = cracks.group.iter().collect();
    let index = |name: &String| names.iter().position(|known| *known == name).map_or(-1, |index| index as i64);
    let marked = |is: &dyn Fn(usize) -> bool| open.iter().map(|&crack| i64::from(is(crack))).collect();
    let outlines: Vec<Vec<[f64; 3]>> = open.iter().map(|&crack| outline::<S>(cracks, crack)).collect();
    Ok(Some(Grid {
        cells: crack_cells(&outlines),
        points: outlines.concat(),
        on_points: Vec::new(),
        on_cells: vec![
            Field::Ints("mode", marked(&|crack| cracks.mode[crack] == CrackMode::Shear)),
            Field::Ints("group", open.iter().map(|&crack| index(&cracks.group[crack])).collect()),
            Field::Reals("axial_strain", open.iter().map(|&crack| cracks.axial_strain[crack]).collect()),
        ],
    }))
}

/// Corners of the polygon that stands for a crack in space.
const CORNERS: usize = 12;

/// The crack as points: in the plane the ends of a line of its length, in space the corners of a disc of its diameter.
fn outline<S: Space>(cracks: &Cracks, crack: usize) -> Vec<[f64; 3]> {
    let row = |array: &Array2<f64>| spatial::<S>(Vector::<S>::build(|axis| array[[crack, axis]]));
    let (centre, normal, half) = (row(&cracks.position), row(&cracks.normal), 0.5 * cracks.size[crack]);
    let from_centre = |[along, across]: [[f64; 3]; 2], [a, b]: [f64; 2]| {
        std::array::from_fn(|axis| centre[axis] + half * (a * along[axis] + b * across[axis]))
    };
    if S::DIMENSION == 2 {
        let along = [-normal[1], normal[0], 0.0];
        return [1.0, -1.0].map(|end| from_centre([along, [0.0; 3]], [end, 0.0])).to_vec();
    }
    let along = perpendicular(normal);
    let axes = [along, cross(normal, along)];
    let corner = |k: usize| {
        let (sine, cosine) = sin_cos(TAU * k as f64 / CORNERS as f64);
        from_centre(axes, [cosine, sine])
    };
    (0..CORNERS).map(corner).collect()
}

/// A unit vector at right angles to a unit vector: across the axis that is farthest from it.
fn perpendicular(normal: [f64; 3]) -> [f64; 3] {
    let least = (1..3).fold(0, |least, axis| if normal[axis].abs() < normal[least].abs() { axis } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let vector = cross(normal, axis);
    vector.times(1.0 / vector.norm())
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The cells of outlines whose points follow one another: lines of two points, polygons of more.
fn crack_cells(outlines: &[Vec<[f64; 3]>]) -> Cells {
    let mut first = 0;
    let mut cell = |outline: &Vec<[f64; 3]>| {
        first += outline.len();
        (first - outline.len()..first).collect::<Vec<usize>>()
    };
    let cells: Vec<Vec<usize>> = outlines.iter().map(&mut cell).collect();
    let lines: Option<Vec<[usize; 2]>> = cells.iter().map(|cell| cell.as_slice().try_into().ok()).collect();
    lines.map_or(Cells::Polygons(cells), Cells::Lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dem::D3;

    fn crack<S: Space>(position: Vector<S>, normal: Vector<S>, size: f64) -> Cracks {
        let row = |vector: Vector<S>| Array2::from_shape_fn((1, S::DIMENSION), |(_, axis)| vector.at(axis));
        Cracks {
            axial_strain: vec![0.0],
            mode: vec![CrackMode::Tension],
            group: vec!["rock".to_owned()],
            position: row(position),
            normal: row(normal),
            size: vec![size],
        }
    }

    #[test]
    fn cracks_lie_across_their_contacts() {
        let plane = outline::<D2>(&crack::<D2>([1.0, 2.0], [0.0, -1.0], 2.0), 0);
        assert_eq!(plane, [[2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
        for normal in [[0.6, 0.0, 0.8], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.36, 0.48, 0.8]] {
            let centre = [1.0, 2.0, 3.0];
            let corners = outline::<D3>(&crack::<D3>(centre, normal, 2.0), 0);
            assert_eq!(corners.len(), CORNERS);
            for corner in corners {
                let arm = corner.minus(centre);
                assert!((arm.norm() - 1.0).abs() < 1e-12, "{corner:?}");
                assert!(arm.dot(normal).abs() < 1e-12, "{corner:?}");
            }
        }
    }

    #[test]
    fn cells_name_the_points_of_their_outlines() {
        let outlines = |corners: usize| vec![vec![[0.0; 3]; corners]; 2];
        assert!(matches!(crack_cells(&outlines(2)), Cells::Lines(lines) if lines == [[0, 1], [2, 3]]));
        let is = |cells: &[Vec<usize>]| cells == [vec![0, 1, 2], vec![3, 4, 5]];
        assert!(matches!(crack_cells(&outlines(3)), Cells::Polygons(cells) if is(&cells)));
    }
}
