//! Aggregate placed in a region: largest first, at random, without overlap.
//!
//! Each polygon is drawn once and then tried at uniformly random positions until it lies inside the region with its gap
//! to the walls and to every polygon placed before. Random sequential placement jams near an area fraction of one
//! half for equal convex shapes, so contents beyond about 0.45 of enclosing circles need smaller gaps or a settled
//! packing; the error says how many were placed.
//!
//! Lengths in metres.

use super::gradation::SizeClass;
use super::polygon::{Polygon, PolygonRecipe};
use super::region::{Point, Region, norm};
use crate::D2;
use math::random::Stream;
use serde::{Deserialize, Serialize};

/// Which diameter the particles of a size class get.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ClassSize {
    /// All the middle of the class, the size that the count is computed with.
    Middle,
    /// Uniform between the bounds of the class.
    Uniform,
}

/// How polygons are placed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Least distance between two polygons (m).
    pub gap: f64,
    /// Least distance from a polygon to a wall (m).
    pub wall_gap: f64,
    /// Tries per polygon before giving up.
    pub attempts: usize,
    /// Diameters within a class.
    pub class_size: ClassSize,
}

/// Aggregate that does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "aggregate does not fit: particle {} of {wanted} (size {:.3} mm) found no place in {attempts} tries; \
     the {placed} placed ones take {:.1} % of the area. Lower the content or the gaps ({:.3} mm between particles, \
     {:.3} mm to the walls), or enlarge the specimen",
    placed + 1, size * 1e3, area_fraction * 100.0, gap * 1e3, wall_gap * 1e3
)]
pub struct DoesNotFit {
    /// Diameter of the particle that found no position (m).
    pub size: f64,
    /// Particles placed before it.
    pub placed: usize,
    /// Particles wanted.
    pub wanted: usize,
    /// Area of the placed ones over that of the region.
    pub area_fraction: f64,
    /// Tries spent on this particle.
    pub attempts: usize,
    /// Gap between particles asked for (m).
    pub gap: f64,
    /// Gap to the walls asked for (m).
    pub wall_gap: f64,
}

/// Polygons of all `classes` placed in `region`, largest size first.
///
/// # Errors
/// [`DoesNotFit`] with the first particle that found no position.
pub fn place(
    classes: &[SizeClass],
    recipe: &PolygonRecipe,
    placement: &Placement,
    region: &Region,
    stream: &mut Stream,
) -> Result<Vec<Polygon>, DoesNotFit> {
    let sizes = sizes(classes, placement.class_size, stream);
    let mut placed: Vec<Placed> = Vec::with_capacity(sizes.len());
    for &size in &sizes {
        let shape = recipe.draw(size, stream);
        let found = (0..placement.attempts).find_map(|_| try_once(&shape, placement, region, &placed, stream));
        match found {
            Some(polygon) => placed.push(polygon),
            None => {
                let area: f64 = placed.iter().map(|p| p.polygon.moments().area).sum();
                return Err(DoesNotFit {
                    size,
                    placed: placed.len(),
                    wanted: sizes.len(),
                    area_fraction: area / region.volume(),
                    attempts: placement.attempts,
                    gap: placement.gap,
                    wall_gap: placement.wall_gap,
                });
            }
        }
    }
    Ok(placed.into_iter().map(|p| p.polygon).collect())
}

struct Placed {
    polygon: Polygon,
    centre: Point,
    reach: f64,
}

/// Diameters of all particles, largest first.
fn sizes(classes: &[SizeClass], law: ClassSize, stream: &mut Stream) -> Vec<f64> {
    let mut sizes: Vec<f64> = Vec::new();
    for class in classes {
        for _ in 0..class.count {
            sizes.push(match law {
                ClassSize::Middle => class.middle(),
                ClassSize::Uniform => stream.uniform_in(class.low, class.high),
            });
        }
    }
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes
}

fn try_once(
    shape: &Polygon,
    placement: &Placement,
    region: &Region,
    placed: &[Placed],
    stream: &mut Stream,
) -> Option<Placed> {
    let [width, height] = region.extent();
    let centre = [width * (stream.uniform() - 0.5), height * (stream.uniform() - 0.5)];
    let polygon = shape.moved(centre);
    if polygon.vertices.iter().any(|&vertex| region.depth::<D2>(vertex) < placement.wall_gap) {
        return None;
    }
    let reach = shape.reach();
    let clear = placed.iter().all(|other| {
        let between = norm([centre[0] - other.centre[0], centre[1] - other.centre[1]]);
        between > reach + other.reach + placement.gap || polygon.distance(&other.polygon) >= placement.gap.max(1e-12)
    });
    clear.then_some(Placed { polygon, centre, reach })
}

#[cfg(test)]
mod tests {
    use super::super::gradation::Gradation;
    use super::super::polygon::{AngleLaw, SizeRule};
    use super::*;

    const SPECIMEN: Region = Region::Rectangle { width: 0.1, height: 0.2 };
    const PLACEMENT: Placement =
        Placement { gap: 0.5e-3, wall_gap: 1e-3, attempts: 10_000, class_size: ClassSize::Middle };

    fn published() -> Vec<SizeClass> {
        let gradation = Gradation::Walraven { content: 0.75, max_size: 0.015 };
        gradation.classes(&[0.005, 0.007, 0.009, 0.011, 0.013, 0.015], 0.02).unwrap()
    }

    fn recipe(size: SizeRule, angles: AngleLaw) -> PolygonRecipe {
        PolygonRecipe { min_vertices: 4, max_vertices: 6, size, angles, least_fill: 0.05 }
    }

    /// 59 π 3² + 28 π 4² + 15 π 5² + 8 π 6² + 4 π 7² mm² = 5774 mm², 28.9 % of 200 × 100 mm.
    #[test]
    fn published_aggregate_fits_with_its_area_and_gaps() {
        let shape = recipe(SizeRule::EqualArea, AngleLaw::Jittered);
        let polygons = place(&published(), &shape, &PLACEMENT, &SPECIMEN, &mut Stream::new(1, "aggregate", 0)).unwrap();
        assert_eq!(polygons.len(), 114);
        let areas: Vec<f64> = polygons.iter().map(|p| p.moments().area).collect();
        let circles = std::f64::consts::PI * (59.0 * 9.0 + 28.0 * 16.0 + 15.0 * 25.0 + 8.0 * 36.0 + 4.0 * 49.0) * 1e-6;
        assert!((areas.iter().sum::<f64>() / circles - 1.0).abs() < 1e-12);
        assert!(areas.windows(2).all(|pair| pair[0] >= pair[1] * (1.0 - 1e-9)));
        for (k, a) in polygons.iter().enumerate() {
            assert!(a.vertices.iter().all(|&v| SPECIMEN.depth::<D2>(v) >= PLACEMENT.wall_gap));
            assert!(polygons[..k].iter().all(|b| a.distance(b) >= PLACEMENT.gap));
        }
    }

    #[test]
    fn a_disc_region_holds_its_aggregate_too() {
        let region = Region::Disc { diameter: 0.1 };
        let classes = [SizeClass { low: 0.005, high: 0.007, count: 40 }];
        let law = Placement { class_size: ClassSize::Uniform, ..PLACEMENT };
        let shape = recipe(SizeRule::Inscribed, AngleLaw::Random);
        let polygons = place(&classes, &shape, &law, &region, &mut Stream::new(2, "aggregate", 0)).unwrap();
        assert!(polygons.iter().flat_map(|p| &p.vertices).all(|&v| norm(v) <= 0.049 + 1e-15));
    }

    #[test]
    fn what_cannot_fit_says_how_far_it_came() {
        let classes = [SizeClass { low: 0.02, high: 0.02 + 1e-9, count: 90 }];
        let law = Placement { attempts: 200, ..PLACEMENT };
        let shape = recipe(SizeRule::EqualArea, AngleLaw::Even);
        let error = place(&classes, &shape, &law, &SPECIMEN, &mut Stream::new(1, "aggregate", 0)).unwrap_err();
        assert!(error.placed > 10 && error.placed < 64 && error.wanted == 90, "{error}");
        assert!((error.area_fraction - error.placed as f64 * std::f64::consts::PI * 1e-4 / 0.02).abs() < 1e-6);
        assert!(error.to_string().contains("size 20.000 mm"), "{error}");
    }
}
