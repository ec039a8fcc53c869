//! A specimen as it is stored, and back.

use super::super::StageError;
use super::report::report;
use crate::artifact::specimen::Specimen as Stored;
use crate::artifact::{Artifact, Table};
use dem::genesis::clump::{Clump, plane_inertia};
use dem::genesis::polygon::Polygon;
use dem::genesis::quality::Quality;
use dem::genesis::region::Region;
use dem::genesis::specimen::Specimen;
use dem::space::Tuple;
use dem::{D2, D3, Group, Space, Vector};
use ndarray::Array2;

/// A specimen of either space.
#[derive(Clone, Debug)]
pub enum Loaded {
    /// Discs.
    Plane(Specimen<D2>),
    /// Spheres.
    Solid(Specimen<D3>),
}

impl Loaded {
    /// The specimen of discs.
    ///
    /// # Errors
    /// It is one of spheres.
    pub fn plane(self) -> Result<Specimen<D2>, StageError> {
        match self {
            Self::Plane(specimen) => Ok(specimen),
            Self::Solid(_) => Err(StageError::new("the specimen is solid, and this needs a plane one")
                .hint("leave out `depth` (or `height` beside `diameter`)")),
        }
    }
}

pub(super) fn store<S: Space>(made: &Specimen<S>, quality: &Quality) -> Stored {
    let [width, height, depth] = made.region.edges();
    let number = |clump: &Option<usize>| clump.map_or(-1, |index| index as i64);
    let of = |pick: &dyn Fn(&Clump<S>) -> f64| made.clumps.iter().map(pick).collect::<Vec<f64>>();
    let clumps = Table { about: "rigid clumps".to_owned(), columns: Vec::new() }
        .ints_column("polygon", "its polygon", made.clumps.iter().map(|clump| clump.polygon as i64).collect())
        .reals_column("mass", "kg/m", "mass per metre of thickness", of(&|clump| clump.mass))
        .reals_column("inertia", "kg*m", "moment of inertia per metre of thickness", of(&|clump| clump.inertia[2][2]))
        .reals_column("x", "m", "centre of mass", of(&|clump| clump.centre.at(0)))
        .reals_column("y", "m", "centre of mass", of(&|clump| clump.centre.at(1)));
    let corners = made.polygons.iter().enumerate().flat_map(|(index, p)| p.vertices.iter().map(move |_| index as i64));
    Stored {
        outline: made.region.name().to_owned(),
        width,
        height,
        depth,
        density: made.density,
        centres: Array2::from_shape_fn((made.centres.len(), S::DIMENSION), |(i, k)| made.centres[i].at(k)),
        radii: made.radii.clone(),
        group_of: made.groups.iter().map(|group| i64::from(group.0)).collect(),
        groups: made.group_names.clone(),
        clump_of: made.clump_of_balls().iter().map(number).collect(),
        clumps,
        polygon_of: corners.collect(),
        vertices: made.polygons.iter().flat_map(|p| p.vertices.iter().copied()).collect(),
        quality: report(quality, if S::DIMENSION == 2 { "discs" } else { "spheres" }, &made.group_names),
        warnings: quality.warnings().iter().map(ToString::to_string).collect(),
        failure: None,
    }
}

/// A specimen of this outline that could not be made.
pub(super) fn nothing(region: &Region, density: f64, why: String) -> Stored {
    let [width, height, depth] = region.edges();
    Stored {
        outline: region.name().to_owned(),
        width,
        height,
        depth,
        density,
        centres: Array2::zeros((0, region.dimension())),
        radii: Vec::new(),
        group_of: Vec::new(),
        groups: Vec::new(),
        clump_of: Vec::new(),
        clumps: Table { about: "rigid clumps".to_owned(), columns: Vec::new() },
        polygon_of: Vec::new(),
        vertices: Vec::new(),
        quality: Table { about: "quality of the specimen".to_owned(), columns: Vec::new() },
        warnings: vec![why.clone()],
        failure: Some(why),
    }
}

/// The stored specimen in an artifact, as one reads it that needs its balls.
///
/// # Errors
/// The artifact is no specimen, or says why the specimen could not be made.
pub fn stored(artifact: &Artifact) -> Result<Stored, StageError> {
    let stored = Stored::from_artifact(artifact)?;
    match stored.failure {
        Some(why) => Err(StageError::new(why)),
        None => Ok(stored),
    }
}

/// The specimen in a stored artifact, for tests on it.
///
/// # Errors
/// It could not be made; or what is missing or does not fit together.
pub fn load(artifact: &Artifact) -> Result<Loaded, StageError> {
    let stored = stored(artifact)?;
    let region = Region::named(&stored.outline, [stored.width, stored.height, stored.depth]);
    let region = region.ok_or_else(|| odd("outline"))?;
    match (region.dimension(), stored.centres.ncols()) {
        (2, 2) => Ok(Loaded::Plane(specimen::<D2>(stored, region)?)),
        (3, 3) => Ok(Loaded::Solid(specimen::<D3>(stored, region)?)),
        _ => Err(odd("outline and balls")),
    }
}

fn odd(what: &str) -> StageError {
    StageError::new(format!("the specimen's {what} do not fit together"))
}

fn specimen<S: Space>(stored: Stored, region: Region) -> Result<Specimen<S>, StageError> {
    let (polygons, clumps) = (polygons(&stored)?, clumps::<S>(&stored)?);
    let Stored { centres, radii, group_of, groups: group_names, density, clump_of, .. } = stored;
    let centres: Vec<Vector<S>> = centres.rows().into_iter().map(|x| Vector::<S>::build(|k| x[k])).collect();
    if [centres.len(), group_of.len(), clump_of.len()].iter().any(|&count| count != radii.len()) {
        return Err(odd("balls"));
    }
    let named = |&group: &i64| u8::try_from(group).ok().filter(|&g| usize::from(g) < group_names.len()).map(Group);
    let groups = group_of.iter().map(named).collect::<Option<Vec<Group>>>().ok_or_else(|| odd("groups"))?;
    Ok(Specimen { region, centres, radii, groups, group_names, density, polygons, clumps })
}

fn polygons(stored: &Stored) -> Result<Vec<Polygon>, StageError> {
    let mut polygons: Vec<Polygon> = Vec::new();
    for (&index, &vertex) in stored.polygon_of.iter().zip(&stored.vertices) {
        let index = usize::try_from(index).map_err(|_| odd("polygons"))?;
        if index > polygons.len() {
            return Err(odd("polygons"));
        }
        if index == polygons.len() {
            polygons.push(Polygon { vertices: Vec::new() });
        }
        polygons[index].vertices.push(vertex);
    }
    Ok(polygons)
}

fn clumps<S: Space>(stored: &Stored) -> Result<Vec<Clump<S>>, StageError> {
    let table = &stored.clumps;
    let (mass, inertia) = (table.numbers("mass", "kg/m")?, table.numbers("inertia", "kg*m")?);
    let (x, y) = (table.numbers("x", "m")?, table.numbers("y", "m")?);
    let polygon_of = table.ints("polygon")?;
    let mut clumps = Vec::with_capacity(polygon_of.len());
    for (k, &polygon) in polygon_of.iter().enumerate() {
        let pebbles = (0..stored.clump_of.len()).filter(|&i| stored.clump_of[i] == k as i64).collect();
        let polygon = usize::try_from(polygon).map_err(|_| odd("clumps"))?;
        let centre = Vector::<S>::build(|axis| [x[k], y[k], 0.0][axis]);
        clumps.push(Clump { polygon, pebbles, mass: mass[k], inertia: plane_inertia(inertia[k]), centre });
    }
    Ok(clumps)
}
