//! Converts a specimen to and from its artifact.

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

/// Columns of the inertia of a clump in space.
const INERTIA: [(&str, [usize; 2]); 6] = [
    ("inertia_xx", [0, 0]),
    ("inertia_yy", [1, 1]),
    ("inertia_zz", [2, 2]),
    ("inertia_xy", [0, 1]),
    ("inertia_xz", [0, 2]),
    ("inertia_yz", [1, 2]),
];

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
    let shape = |about| {
        let table = Table { about: "rigid clumps".to_owned(), columns: Vec::new() };
        table.ints_column("polygon", about, made.clumps.iter().map(|clump| clump.polygon as i64).collect())
    };
    let clumps = if S::DIMENSION == 2 || made.clumps.is_empty() {
        shape("its polygon")
            .reals_column("mass", "kg/m", "mass per metre of thickness", of(&|clump| clump.mass))
            .reals_column(
                "inertia",
                "kg*m",
                "moment of inertia per metre of thickness",
                of(&|clump| clump.inertia[2][2]),
            )
            .reals_column("x", "m", "centre of mass", of(&|clump| clump.centre.at(0)))
            .reals_column("y", "m", "centre of mass", of(&|clump| clump.centre.at(1)))
    } else {
        let mut table = shape("its shape").reals_column("mass", "kg", "mass", of(&|clump| clump.mass));
        for (name, [i, j]) in INERTIA {
            table = table.reals_column(
                name,
                "kg*m^2",
                "inertia about the centre of mass",
                of(&|clump| clump.inertia[i][j]),
            );
        }
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            table = table.reals_column(name, "m", "centre of mass", of(&|clump| clump.centre.at(axis)));
        }
        table
    };
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

/// The artifact of a specimen of this outline whose packing failed.
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

/// The stored specimen in an artifact, for readers that need its balls.
///
/// # Errors
/// The artifact is not a specimen, or holds the reason why its packing failed.
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
/// Its packing failed, or parts of the artifact are missing or inconsistent.
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
    let plane = S::DIMENSION == 2 || table.rows() == 0;
    let mass = table.numbers("mass", if plane { "kg/m" } else { "kg" })?;
    let mut inertia = vec![[[0.0; 3]; 3]; mass.len()];
    if plane {
        let moments = table.numbers("inertia", "kg*m")?;
        inertia = moments.into_iter().map(plane_inertia).collect();
    } else {
        for (name, [i, j]) in INERTIA {
            for (own, value) in inertia.iter_mut().zip(table.numbers(name, "kg*m^2")?) {
                (own[i][j], own[j][i]) = (value, value);
            }
        }
    }
    let axes: &[&str] = if plane { &["x", "y"] } else { &["x", "y", "z"] };
    let places = axes.iter().map(|axis| table.numbers(axis, "m")).collect::<Result<Vec<_>, _>>()?;
    let mut pebbles: Vec<Vec<usize>> = vec![Vec::new(); mass.len()];
    for (ball, &clump) in stored.clump_of.iter().enumerate().filter(|(_, clump)| **clump >= 0) {
        pebbles.get_mut(clump as usize).ok_or_else(|| odd("clumps"))?.push(ball);
    }
    let mut clumps = Vec::with_capacity(mass.len());
    for (k, (&polygon, pebbles)) in table.ints("polygon")?.iter().zip(pebbles).enumerate() {
        let polygon = usize::try_from(polygon).map_err(|_| odd("clumps"))?;
        let centre = Vector::<S>::build(|axis| places.get(axis).map_or(0.0, |place| place[k]));
        clumps.push(Clump { polygon, pebbles, mass: mass[k], inertia: inertia[k], centre });
    }
    Ok(clumps)
}
