//! Repair: from loose triangles to a closed surface that faces outwards, with a list of the repairs.
//!
//! 1. Corners nearer than 10⁻⁶ of the diagonal become one vertex; triangles without three corners or without area are
//!    dropped, and of triangles with the same corners one stays.
//! 2. Every edge belongs to one or two triangles; more is a fault.
//! 3. Neighbours are turned so that they run along their common edge in opposite ways; where that is impossible (a Möbius
//!    band) it is a fault.
//! 4. Edges of one triangle make the rims of holes. A hole is closed by a fan about the middle of its rim when the fan is
//!    at most 5 % of the surface; a larger one is a fault.
//! 5. Every shell is turned so that its volume is positive. Of several shells the largest counts, if the others together
//!    have at most 1 % of its volume; else it is a fault, because it is not clear which of them is the stone.

use super::mesh::{Mesh, area_vector};
use super::moments::Moments;
use super::vector::{dot, extent, minus, norm, plus, times};
use std::collections::{BTreeMap, HashMap};

/// Corners nearer than this fraction of the diagonal are one vertex.
const NEAR: f64 = 1e-6;
/// Largest hole that a fan closes, as a fraction of the surface.
const HOLE: f64 = 0.05;
/// Largest volume of stray shells, as a fraction of that of the stone.
const STRAY: f64 = 0.01;

/// The repairs of a surface.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Mended {
    /// Triangles without area and duplicate triangles, which were dropped.
    pub dropped: usize,
    /// Triangles whose corners ran the wrong way.
    pub turned: usize,
    /// Holes that were closed.
    pub holes: usize,
    /// Small shells beside the stone that were left out.
    pub strays: usize,
}

impl Mended {
    /// The repairs in words, one text each.
    pub fn words(&self) -> Vec<String> {
        let said = [
            (
                self.dropped,
                "facet without area, or given twice, was dropped",
                "facets without area, or given twice, were dropped",
            ),
            (self.turned, "facet faced inwards and was turned", "facets faced inwards and were turned"),
            (
                self.holes,
                "hole was closed by a fan about the middle of its rim",
                "holes were closed by fans about the middles of their rims",
            ),
            (
                self.strays,
                "small shell beside the largest was left out",
                "small shells beside the largest were left out",
            ),
        ];
        let words = |&(count, one, many): &(usize, &str, &str)| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            _ => Some(format!("{count} {many}")),
        };
        said.iter().filter_map(words).collect()
    }
}

/// Why triangles make no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unsound {
    /// Nothing there.
    #[error("the surface has {0} facets with an area; at least 4 enclose a volume")]
    Few(usize),
    /// A coordinate that is no number.
    #[error("facet {0} has a corner that is not finite")]
    Number(usize),
    /// More than two facets at an edge.
    #[error(
        "{facets} facets meet at one edge near {at:?} m; a closed surface has two at every edge: export the stone as one solid"
    )]
    Branching {
        /// How many.
        facets: usize,
        /// Middle of the edge.
        at: [f64; 3],
    },
    /// One-sided.
    #[error("the surface is one-sided near {0:?} m (as a Möbius band is) and encloses nothing")]
    OneSided([f64; 3]),
    /// A hole too large.
    #[error(
        "a hole of {edges} edges near {at:?} m has {share:.1} % of the surface; at most 5 % is closed: close the surface"
    )]
    Hole {
        /// Edges of its rim.
        edges: usize,
        /// Middle of the rim.
        at: [f64; 3],
        /// Area of the fan in per cent of the surface.
        share: f64,
    },
    /// Several solids.
    #[error("{} shells of comparable volumes ({}); give one stone a file", .0.len(), volumes(.0))]
    Shells(Vec<f64>),
    /// No volume.
    #[error("the surface encloses no volume")]
    Flat,
}

fn volumes(volumes: &[f64]) -> String {
    volumes.iter().take(5).map(|v| format!("{v:.3e} m³")).collect::<Vec<_>>().join(", ")
}

/// The solid that loose triangles enclose.
///
/// # Errors
/// The first fault because of which they enclose no solid, or no single one.
pub fn mend(triangles: &[[[f64; 3]; 3]]) -> Result<(Mesh, Mended), Unsound> {
    if let Some(bad) = triangles.iter().position(|t| t.iter().flatten().any(|x| !x.is_finite())) {
        return Err(Unsound::Number(bad + 1));
    }
    let mut mended = Mended::default();
    let mut mesh = weld(triangles, &mut mended);
    if mesh.facets.len() < 4 {
        return Err(Unsound::Few(mesh.facets.len()));
    }
    let shells = orient(&mut mesh, &mut mended)?;
    let shells = close(&mut mesh, shells, &mut mended)?;
    let mesh = largest(mesh, &shells, &mut mended)?;
    Ok((mesh, mended))
}

/// Merges corners that are near one another into one vertex.
fn weld(triangles: &[[[f64; 3]; 3]], mended: &mut Mended) -> Mesh {
    let (low, high) = extent(triangles.iter().flatten().copied());
    let near = NEAR * norm(minus(high, low));
    let cell = |p: [f64; 3], shift: [f64; 3]| -> [i64; 3] {
        std::array::from_fn(|k| ((p[k] - low[k]) / (4.0 * near).max(f64::MIN_POSITIVE) + shift[k]).floor() as i64)
    };
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    // Only looked up, never iterated: no result depends on its order.
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut vertex = |p: [f64; 3]| -> u32 {
        for corner in 0..8 {
            let shift = [0, 1, 2].map(|k| if corner >> k & 1 == 1 { 0.25 } else { -0.25 });
            let found = cells.get(&cell(p, shift)).into_iter().flatten();
            if let Some(&same) = found.into_iter().find(|&&v| norm(minus(vertices[v as usize], p)) <= near) {
                return same;
            }
        }
        vertices.push(p);
        let index = (vertices.len() - 1) as u32;
        cells.entry(cell(p, [0.0; 3])).or_default().push(index);
        index
    };
    let welded: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(&mut vertex)).collect();
    let mut facets = Vec::with_capacity(welded.len());
    let mut seen = std::collections::BTreeSet::new();
    for facet in welded {
        let area = norm(area_vector(facet.map(|v| vertices[v as usize])));
        let mut sorted = facet;
        sorted.sort_unstable();
        let apart = sorted[0] != sorted[1] && sorted[1] != sorted[2];
        if apart && area > 0.0 && seen.insert(sorted) {
            facets.push(facet);
        } else {
            mended.dropped += 1;
        }
    }
    Mesh { vertices, facets }
}

/// Facets at each edge: index, and whether the facet runs from the smaller to the larger vertex.
fn edges(facets: &[[u32; 3]]) -> BTreeMap<[u32; 2], Vec<(usize, bool)>> {
    let mut edges: BTreeMap<[u32; 2], Vec<(usize, bool)>> = BTreeMap::new();
    for (index, facet) in facets.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (facet[k], facet[(k + 1) % 3]);
            edges.entry([a.min(b), a.max(b)]).or_default().push((index, a < b));
        }
    }
    edges
}

/// Orients neighbours consistently, and shells outwards by the sign of their volume; returns the shell of every facet.
fn orient(mesh: &mut Mesh, mended: &mut Mended) -> Result<Vec<usize>, Unsound> {
    let edges = edges(&mesh.facets);
    let middle = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|v| mesh.vertices[v as usize]);
        times(plus(a, b), 0.5)
    };
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); mesh.facets.len()];
    for (edge, at) in &edges {
        match at.as_slice() {
            [_] => {}
            &[(a, up), (b, down)] => {
                neighbours[a].push((b, up == down));
                neighbours[b].push((a, up == down));
            }
            more => return Err(Unsound::Branching { facets: more.len(), at: middle(edge) }),
        }
    }
    let mut state: Vec<Option<(usize, bool)>> = vec![None; mesh.facets.len()];
    let mut shells = 0;
    for first in 0..mesh.facets.len() {
        if state[first].is_some() {
            continue;
        }
        state[first] = Some((shells, false));
        let mut queue = vec![first];
        while let Some(facet) = queue.pop() {
            let turned = state[facet].is_some_and(|(_, turned)| turned);
            for &(other, unlike) in &neighbours[facet] {
                match state[other] {
                    None => {
                        state[other] = Some((shells, turned != unlike));
                        queue.push(other);
                    }
                    Some((_, already)) if already != (turned != unlike) => {
                        return Err(Unsound::OneSided(mesh.corners(other)[0]));
                    }
                    Some(_) => {}
                }
            }
        }
        shells += 1;
    }
    let state: Vec<(usize, bool)> = state.into_iter().flatten().collect();
    // The centre of the corners lies inside of an open shell, or near enough to it for the sign of the volume.
    let mut volumes = vec![0.0; shells];
    let base = times(mesh.vertices.iter().fold([0.0; 3], |sum, &v| plus(sum, v)), 1.0 / mesh.vertices.len() as f64);
    for (facet, &(shell, turned)) in state.iter().enumerate() {
        let corners = mesh.corners(facet);
        let sign = if turned { -1.0 } else { 1.0 };
        volumes[shell] += sign * dot(minus(corners[0], base), area_vector(corners));
    }
    for (facet, &(shell, turned)) in mesh.facets.iter_mut().zip(&state) {
        if turned != (volumes[shell] < 0.0) {
            facet.swap(1, 2);
            mended.turned += 1;
        }
    }
    Ok(state.into_iter().map(|(shell, _)| shell).collect())
}

/// Closes small holes; returns the shell of every facet.
fn close(mesh: &mut Mesh, mut shells: Vec<usize>, mended: &mut Mended) -> Result<Vec<usize>, Unsound> {
    // The rim runs against the facet at it: from its second vertex to its first.
    let mut next: BTreeMap<u32, (u32, usize)> = BTreeMap::new();
    for ([low, high], at) in edges(&mesh.facets) {
        if let [(facet, up)] = at[..] {
            let (from, to) = if up { (high, low) } else { (low, high) };
            if next.insert(from, (to, facet)).is_some() {
                let at = mesh.vertices[from as usize];
                return Err(Unsound::Branching { facets: 3, at });
            }
        }
    }
    let surface = mesh.surface();
    while let Some((&start, &(_, facet))) = next.iter().next() {
        let mut rim = Vec::new();
        let mut at = start;
        while let Some((to, _)) = next.remove(&at) {
            rim.push(at);
            at = to;
        }
        let corners: Vec<[f64; 3]> = rim.iter().map(|&v| mesh.vertices[v as usize]).collect();
        let middle = times(corners.iter().fold([0.0; 3], |sum, &v| plus(sum, v)), 1.0 / corners.len() as f64);
        let spokes = (0..rim.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()], middle]);
        let share = spokes.map(|t| 0.5 * norm(area_vector(t))).sum::<f64>() / surface;
        if at != start || rim.len() < 3 || share > HOLE {
            return Err(Unsound::Hole { edges: rim.len(), at: middle, share: 100.0 * share });
        }
        let shell = shells[facet];
        if rim.len() == 3 {
            mesh.facets.push([rim[0], rim[1], rim[2]]);
            shells.push(shell);
        } else {
            let hub = mesh.vertices.len() as u32;
            mesh.vertices.push(middle);
            mesh.facets.extend((0..rim.len()).map(|k| [rim[k], rim[(k + 1) % rim.len()], hub]));
            shells.extend(std::iter::repeat_n(shell, rim.len()));
        }
        mended.holes += 1;
    }
    Ok(shells)
}

/// The largest shell, outwards, with only the vertices that it uses.
fn largest(mesh: Mesh, shell_of: &[usize], mended: &mut Mended) -> Result<Mesh, Unsound> {
    let shells = shell_of.iter().max().map_or(0, |last| last + 1);
    let part = |shell: usize| {
        let mut vertices = Vec::new();
        let mut number: BTreeMap<u32, u32> = BTreeMap::new();
        let mut facets = Vec::new();
        for (facet, _) in mesh.facets.iter().zip(shell_of).filter(|(_, of)| **of == shell) {
            facets.push(facet.map(|v| {
                *number.entry(v).or_insert_with(|| {
                    vertices.push(mesh.vertices[v as usize]);
                    vertices.len() as u32 - 1
                })
            }));
        }
        Mesh { vertices, facets }
    };
    let volume = |part: &Mesh| Moments::of(part).volume;
    let volumes: Vec<f64> = (0..shells).map(|shell| volume(&part(shell))).collect();
    let order = |a: &usize, b: &usize| volumes[*a].abs().total_cmp(&volumes[*b].abs()).then(b.cmp(a));
    let best = (0..shells).max_by(order).unwrap_or(0);
    let whole: f64 = volumes.iter().map(|v| v.abs()).sum();
    let mut stone = part(best);
    let (low, high) = stone.extent();
    if !(volumes[best].abs() > 1e-9 * norm(minus(high, low)).powi(3)) {
        return Err(Unsound::Flat);
    }
    if whole - volumes[best].abs() > STRAY * volumes[best].abs() {
        return Err(Unsound::Shells(volumes.iter().map(|v| v.abs()).collect()));
    }
    if volumes[best] < 0.0 {
        mended.turned += stone.facets.len();
        stone.facets.iter_mut().for_each(|facet| facet.swap(1, 2));
    }
    mended.strays = shells - 1;
    Ok(stone)
}

#[cfg(test)]
mod tests {
    use super::super::mesh::samples::{cuboid, ellipsoid};
    use super::*;

    fn soup(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
        mesh.triangles().collect()
    }

    #[test]
    fn a_sound_solid_stays_as_it_is() {
        let mesh = ellipsoid([1.0, 2.0, 3.0], 20);
        let (found, mended) = mend(&soup(&mesh)).unwrap();
        assert_eq!(mended, Mended::default());
        assert_eq!(found.facets.len(), mesh.facets.len());
        assert_eq!(found.vertices.len(), mesh.vertices.len());
        assert!((Moments::of(&found).volume - Moments::of(&mesh).volume).abs() < 1e-12);
    }

    #[test]
    fn flipped_double_and_flat_facets_are_mended_and_counted() {
        let mut triangles = soup(&ellipsoid([1.0, 1.0, 1.0], 12));
        let whole = Moments::of(&ellipsoid([1.0, 1.0, 1.0], 12)).volume;
        for k in [3, 40, 41, 100] {
            triangles[k].swap(0, 1);
        }
        triangles.push(triangles[7]);
        triangles.push([triangles[0][0], triangles[0][1], triangles[0][0]]);
        let (found, mended) = mend(&triangles).unwrap();
        assert_eq!(mended, Mended { dropped: 2, turned: 4, holes: 0, strays: 0 });
        assert!((Moments::of(&found).volume - whole).abs() < 1e-12);
        assert_eq!(mended.words().len(), 2);
    }

    #[test]
    fn an_inside_out_solid_is_turned() {
        let mut triangles = soup(&cuboid([1.0, 1.0, 2.0]));
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let (found, mended) = mend(&triangles).unwrap();
        assert_eq!(mended.turned, 12);
        assert!((Moments::of(&found).volume - 2.0).abs() < 1e-12);
    }

    #[test]
    fn small_holes_are_closed_and_large_ones_refused() {
        let mut triangles = soup(&ellipsoid([1.0; 3], 24));
        let whole = triangles.len();
        triangles.remove(500);
        triangles.remove(200);
        triangles.remove(200);
        let (found, mended) = mend(&triangles).unwrap();
        assert!(mended.holes >= 2 && found.facets.len() >= whole);
        assert!((Moments::of(&found).volume / Moments::of(&ellipsoid([1.0; 3], 24)).volume - 1.0).abs() < 1e-3);
        let mut open = soup(&cuboid([1.0; 3]));
        open.truncate(10);
        assert!(matches!(mend(&open), Err(Unsound::Hole { edges: 4, .. })), "{:?}", mend(&open));
    }

    #[test]
    fn shells_branches_and_numbers_that_are_none_are_faults() {
        let one = soup(&cuboid([1.0; 3]));
        let two: Vec<_> = one
            .iter()
            .chain(&one)
            .enumerate()
            .map(|(k, t)| t.map(|p| if k < 12 { p } else { plus(p, [5.0; 3]) }))
            .collect();
        assert!(matches!(mend(&two), Err(Unsound::Shells(volumes)) if volumes.len() == 2));
        let crumb = one.iter().map(|t| t.map(|p| plus(times(p, 0.1), [3.0; 3])));
        let (_, mended) = mend(&one.iter().copied().chain(crumb).collect::<Vec<_>>()).unwrap();
        assert_eq!(mended.strays, 1);
        let mut winged = one.clone();
        winged.push([one[0][0], one[0][1], [5.0, 5.0, 5.0]]);
        assert!(matches!(mend(&winged), Err(Unsound::Branching { facets: 3, .. })));
        let mut odd = one.clone();
        odd[4][1][2] = f64::NAN;
        assert_eq!(mend(&odd), Err(Unsound::Number(5)));
        assert!(matches!(mend(&one[..3]), Err(Unsound::Few(3))));
        assert!(matches!(mend(&[]), Err(Unsound::Few(0))));
    }
}
