//! Converts shapes to and from their artifact.

use super::super::StageError;
use crate::artifact::Artifact;
use crate::artifact::shapes::{Shapes, Stones};
use ::shape::Ball;
use ::shape::clump::{Clump, Errors};
use ::shape::mesh::Mesh;
use ::shape::moments::Moments;
use ::shape::statistics::Measures;

/// A stone with its clump.
pub(super) struct Stone {
    pub name: String,
    pub share: f64,
    pub mesh: Mesh,
    pub mended: String,
    pub clump: Clump,
}

/// A shape of stones for specimens, figures and other codes: the origin is the clump's centre of mass, the axes are its
/// principal ones with the smallest moment of inertia (the longest side) first.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its name.
    pub name: String,
    /// Its fraction of the stones, by number.
    pub share: f64,
    /// Intermediate extent, which decides whether it passes a sieve (m).
    pub breadth: f64,
    /// The clump, lengths in m.
    pub clump: Clump,
    /// The solid, lengths in m.
    pub mesh: Mesh,
}

/// The largest of three errors, with its sign.
fn worst(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, |worst: f64, error| if error.abs() > worst.abs() { error } else { worst })
}

pub(super) fn store(stones: &[Stone]) -> Shapes {
    let mut shapes = Shapes {
        shapes: Stones::default(),
        pebble_of: Vec::new(),
        centres: Vec::new(),
        radii: Vec::new(),
        vertex_of: Vec::new(),
        vertices: Vec::new(),
        facets: Vec::new(),
        warnings: Vec::new(),
    };
    for (index, stone) in stones.iter().enumerate() {
        let Stone { name, share, mesh, mended, clump } = stone;
        let (_, axes) = clump.moments.principal();
        let own = clump.about_centre(axes);
        let centre = clump.moments.centre;
        let local = |v: [f64; 3]| axes.map(|axis| (0..3).map(|k| axis[k] * (v[k] - centre[k])).sum());
        let first = shapes.vertices.len() as i64;
        shapes.vertices.extend(mesh.vertices().iter().map(|&v| local(v)));
        shapes.vertex_of.extend(mesh.vertices().iter().map(|_| index as i64));
        shapes.facets.extend(mesh.facets().iter().flatten().map(|&v| first + i64::from(v)));
        shapes.pebble_of.extend(own.balls.iter().map(|_| index as i64));
        shapes.centres.extend(own.balls.iter().map(|ball| ball.centre));
        shapes.radii.extend(own.balls.iter().map(|ball| ball.radius));
        row(&mut shapes.shapes, stone, &own);
        if !mended.is_empty() {
            shapes.warnings.push(format!("{name}: {mended}"));
        }
        let Errors { volume, inertia, distance, .. } = clump.errors;
        if !clump.met && *share > 0.0 {
            shapes.warnings.push(format!(
                "{name}: a clump of {} leaves an error of {:.1} % in volume, {:.1} % in inertia and {:.1} % in the mean distance of the surfaces",
                clump.balls.len(),
                100.0 * volume,
                100.0 * worst(inertia),
                100.0 * distance
            ));
        }
    }
    shapes
}

fn row(table: &mut Stones, stone: &Stone, own: &Clump) {
    let measures = Measures::of(&stone.mesh);
    let [length, breadth, thickness] = measures.extents;
    let errors = own.errors;
    table.shape.push(stone.name.clone());
    table.share.push(stone.share);
    table.length.push(length);
    table.breadth.push(breadth);
    table.thickness.push(thickness);
    table.elongation.push(measures.elongation);
    table.flatness.push(measures.flatness);
    table.sphericity.push(measures.sphericity);
    table.angularity.push(measures.angularity);
    table.convexity.push(measures.convexity);
    table.zingg.push(measures.zingg.name().to_owned());
    table.volume.push(measures.moments.volume);
    table.surface.push(measures.surface);
    table.facets.push(stone.mesh.facets().len());
    table.pebbles.push(own.balls.len());
    table.clump_volume.push(own.moments.volume);
    table.inertia_1.push(own.moments.inertia[0][0]);
    table.inertia_2.push(own.moments.inertia[1][1]);
    table.inertia_3.push(own.moments.inertia[2][2]);
    table.volume_error.push(errors.volume);
    table.surface_error.push(errors.surface);
    table.inertia_error.push(worst(errors.inertia));
    table.centre_error.push(errors.centre);
    table.distance.push(errors.distance);
    table.growth.push(own.growth);
    table.mended.push(stone.mended.clone());
}

/// The shapes in a stored artifact.
///
/// # Errors
/// What is missing or does not fit together.
pub fn load(artifact: &Artifact) -> Result<Vec<Shape>, StageError> {
    let stored = Shapes::from_artifact(artifact)?;
    let table = &stored.shapes;
    let odd = |what: &str| StageError::new(format!("the {what} of the shapes do not fit together"));
    let (pebbles, vertices) = (stored.centres.len(), stored.vertices.len());
    if stored.pebble_of.len() != pebbles || stored.radii.len() != pebbles {
        return Err(odd("pebbles"));
    }
    if stored.vertex_of.len() != vertices || !stored.facets.len().is_multiple_of(3) {
        return Err(odd("surfaces"));
    }
    let shape = |index: usize| {
        let mine = |of: &i64| usize::try_from(*of) == Ok(index);
        let balls = (0..pebbles).filter(|&k| mine(&stored.pebble_of[k]));
        let balls = balls.map(|k| Ball { centre: stored.centres[k], radius: stored.radii[k] }).collect();
        let first = stored.vertex_of.iter().position(mine).ok_or_else(|| odd("surfaces"))?;
        let own: Vec<[f64; 3]> =
            (first..vertices).take_while(|&k| mine(&stored.vertex_of[k])).map(|k| stored.vertices[k]).collect();
        let local = |v: &i64| usize::try_from(*v).ok().and_then(|v| v.checked_sub(first)).filter(|v| *v < own.len());
        let facet = |corners: &[i64]| {
            let mut own = corners.iter().filter_map(local).map(|v| v as u32);
            Some([own.next()?, own.next()?, own.next()?])
        };
        let facets = stored.facets.chunks_exact(3).filter_map(facet).collect();
        let mesh = Mesh::of(own.clone(), facets).ok_or_else(|| odd("surfaces"))?;
        let mut inertia = [[0.0; 3]; 3];
        for (k, column) in [&table.inertia_1, &table.inertia_2, &table.inertia_3].into_iter().enumerate() {
            inertia[k][k] = column[index];
        }
        let moments = Moments { volume: table.clump_volume[index], centre: [0.0; 3], inertia };
        let errors = Errors {
            volume: table.volume_error[index],
            surface: table.surface_error[index],
            inertia: [table.inertia_error[index]; 3],
            centre: table.centre_error[index],
            distance: table.distance[index],
        };
        let surface = table.surface[index] * (1.0 + errors.surface);
        let clump = Clump { balls, moments, surface, errors, growth: table.growth[index], met: true };
        let (name, share, breadth) = (table.shape[index].clone(), table.share[index], table.breadth[index]);
        Ok(Shape { name, share, breadth, clump, mesh })
    };
    (0..table.shape.len()).map(shape).collect()
}
