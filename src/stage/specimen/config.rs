//! Settings of a `specimen` stage, and the recipe that they define.

use super::super::Complaint;
use super::aggregate::AggregateConfig;
use super::fault::key;
use super::stones::StonesConfig;
use crate::unit::{Density, Length, Pressure};
use dem::genesis::compress::{Floaters, StressTarget};
use dem::genesis::groups::Share;
use dem::genesis::lattice::Lattice;
use dem::genesis::packing::Packing;
use dem::genesis::region::Region;
use dem::genesis::sizes::{GivesWay, Size, SizeLaw, Sizes};
use dem::genesis::specimen::Recipe;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of a `specimen` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Specimen {
    /// Width of a rectangle or box, perpendicular to the axis of loading.
    pub width: Option<Length>,
    /// Height of a rectangle, box or cylinder, along the axis of loading.
    pub height: Option<Length>,
    /// Depth of a box, or thickness of a disc in space, along the third axis.
    pub depth: Option<Length>,
    /// Diameter of a disc or cylinder, instead of a width.
    pub diameter: Option<Length>,
    /// Ball porosity (overlaps counted twice) of the packing. With the radius it determines the number of balls.
    pub porosity: Option<f64>,
    /// Packing to a stress or as a lattice, instead of `porosity`.
    pub packing: Option<PackingConfig>,
    /// Law of the radii.
    #[serde(default)]
    pub sizes: SizeName,
    /// Mean radius of the balls.
    pub mean_radius: Option<Length>,
    /// Smallest radius of the balls, instead of their mean.
    pub smallest_radius: Option<Length>,
    /// Largest over smallest radius.
    pub radius_ratio: Option<f64>,
    /// Standard deviation of the radii over their mean, for `log-normal`.
    pub size_deviation: Option<f64>,
    /// Sieve curve, for `sieve`.
    pub sieve: Option<SieveConfig>,
    /// Radii and numbers, for `classes`.
    pub classes: Option<ClassesConfig>,
    /// Whether the radii are scaled to reach the porosity or stress, or the number of balls is adapted.
    #[serde(default)]
    pub gives_way: GivesWay,
    /// Density of the balls.
    pub density: Density,
    /// Group of the balls in the material; a material of one group fits under any name.
    #[serde(default = "balls")]
    pub group: String,
    /// Several groups and their fractions of the volume, instead of `group`: `{ quartz = 0.3, feldspar = 0.7 }`.
    pub groups: Option<BTreeMap<String, f64>>,
    /// Largest fraction of balls with too few contacts (3 in the plane, 4 in space) at a fixed porosity.
    #[serde(default)]
    pub floaters: f64,
    /// Polygons of aggregate, in the plane.
    pub aggregate: Option<AggregateConfig>,
    /// Stones of given shapes, in a box or cylinder; the balls are the mortar between them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stones: Option<StonesConfig>,
}

/// Law of the radii.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SizeName {
    /// Uniform by number between the smallest and the largest radius.
    #[default]
    Uniform,
    /// Uniform by volume.
    UniformByVolume,
    /// Log-normal, truncated at the ratio.
    LogNormal,
    /// Masses that pass sieves.
    Sieve,
    /// Radii in stated numbers.
    Classes,
}

/// A sieve curve.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SieveConfig {
    /// Increasing diameters.
    pub diameters: Vec<Length>,
    /// Fraction of the mass below each, from 0 to 1.
    pub passing: Vec<f64>,
}

/// Radii in stated numbers.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClassesConfig {
    /// Radii.
    pub radii: Vec<Length>,
    /// Balls of each.
    pub counts: Vec<usize>,
}

/// Packing to a stress, or as a lattice.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PackingConfig {
    /// Mean stress of the packing.
    pub stress: Option<Pressure>,
    /// Contact modulus during packing; only stress over modulus matters. 30 GPa by default.
    pub modulus: Option<Pressure>,
    /// Largest relative deviation of the stress; 0.01 by default.
    pub tolerance: Option<f64>,
    /// Ball porosity that determines the number of balls; by default 0.16 in the plane and 0.36 in space.
    pub cloud_porosity: Option<f64>,
    /// Mean unbalanced force over mean contact force that counts as equilibrium; 0.001 by default.
    pub equilibrium: Option<f64>,
    /// Treatment of balls with too few contacts; by default they are enlarged.
    pub floaters: Option<Floaters>,
    /// Largest fraction of them without treatment; 0.002 by default.
    pub floater_share: Option<f64>,
    /// A regular lattice instead of a stress; it has one radius, which is adapted to the height.
    pub lattice: Option<Lattice>,
}

fn balls() -> String {
    "mortar".to_owned()
}

const MODULUS: f64 = 30e9;
const TOLERANCE: f64 = 0.01;
const EQUILIBRIUM: f64 = 1e-3;
const FLOATER_SHARE: f64 = 2e-3;

fn cloud_porosity(region: &Region) -> f64 {
    if region.dimension() == 2 { 0.16 } else { 0.36 }
}

/// The complaint about a setting that is missing, or has no effect.
fn misfit(key: &str, needed: bool, because: &str) -> Complaint {
    let message =
        if needed { format!("{because} needs `{key}`") } else { format!("`{key}` has no effect on {because}") };
    Complaint::new(key, message)
}

/// The settings (key, set, needed, allowed) that are missing or have no effect.
fn misfits(because: &str, settings: &[(&str, bool, bool, bool)]) -> Vec<Complaint> {
    let wrong = settings.iter().filter(|(_, given, needed, allowed)| if *given { !allowed } else { *needed });
    wrong.map(|&(key, _, needed, _)| misfit(key, needed, because)).collect()
}

impl Specimen {
    pub(super) fn region(&self) -> Result<Region, Complaint> {
        let [width, height, depth, diameter] =
            [self.width, self.height, self.depth, self.diameter].map(|length| length.map(|length| length.get()));
        match (width, height, depth, diameter) {
            (Some(width), Some(height), None, None) => Ok(Region::Rectangle { width, height }),
            (None, None, None, Some(diameter)) => Ok(Region::Disc { diameter }),
            (Some(width), Some(height), Some(depth), None) => Ok(Region::Box { width, height, depth }),
            (None, Some(height), None, Some(diameter)) => Ok(Region::Cylinder { diameter, height }),
            (None, None, Some(depth), Some(diameter)) => Ok(Region::ThickDisc { diameter, depth }),
            _ => Err(Complaint::new("", "the outline is not clear").hint(
                "give `width` and `height` (and `depth` for a solid), or `diameter` (and `height` for a cylinder, `depth` for a disc in the solid)",
            )),
        }
    }

    fn sizes(&self) -> Result<Sizes, Vec<Complaint>> {
        use SizeName::{Classes, LogNormal, Sieve, Uniform, UniformByVolume};
        let scaled = matches!(self.sizes, Uniform | UniformByVolume | LogNormal);
        let name = serde_json::to_value(self.sizes).unwrap_or_default();
        let (sieve, classes) = (self.sizes == Sieve, self.sizes == Classes);
        let mut faults = misfits(
            &format!("sizes {name}"),
            &[
                ("mean_radius", self.mean_radius.is_some(), scaled && self.smallest_radius.is_none(), scaled),
                ("smallest_radius", self.smallest_radius.is_some(), false, scaled),
                ("radius_ratio", self.radius_ratio.is_some(), scaled, scaled),
                ("size_deviation", self.size_deviation.is_some(), self.sizes == LogNormal, self.sizes == LogNormal),
                ("sieve", self.sieve.is_some(), sieve, sieve),
                ("classes", self.classes.is_some(), classes, classes),
            ],
        );
        if self.mean_radius.is_some() && self.smallest_radius.is_some() {
            faults.push(
                Complaint::new("smallest_radius", "`mean_radius` and `smallest_radius` are both given")
                    .hint("give one"),
            );
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let (ratio, deviation) = (self.radius_ratio.unwrap_or(1.0), self.size_deviation.unwrap_or_default());
        let metres = |lengths: &[Length]| lengths.iter().map(|length| length.get()).collect();
        let law = match self.sizes {
            Uniform => SizeLaw::Uniform { ratio },
            UniformByVolume => SizeLaw::UniformVolume { ratio },
            LogNormal => SizeLaw::LogNormal { ratio, deviation },
            Sieve => {
                let curve = self.sieve.as_ref().map(|sieve| (metres(&sieve.diameters), sieve.passing.clone()));
                let (diameters, passing) = curve.unwrap_or_default();
                SizeLaw::Sieve { diameters, passing }
            }
            Classes => {
                let classes = self.classes.as_ref().map(|classes| (metres(&classes.radii), classes.counts.clone()));
                let (radii, counts) = classes.unwrap_or_default();
                SizeLaw::Classes { radii, counts }
            }
        };
        let size = match (self.mean_radius, self.smallest_radius) {
            (Some(mean), _) => Size::Mean(mean.get()),
            (None, Some(smallest)) => Size::Smallest(smallest.get()),
            (None, None) => Size::Stated,
        };
        Ok(Sizes { law, size, gives_way: self.gives_way })
    }

    fn packing(&self, region: &Region) -> Result<Packing, Vec<Complaint>> {
        let Some(packing) = &self.packing else {
            let porosity = self.porosity.ok_or_else(|| {
                let lacks = Complaint::new("", "the packing is not clear");
                vec![lacks.hint("give `porosity`, or `packing = { stress = \"0.3 MPa\" }`, or `packing = { lattice = \"hexagonal\" }`")]
            })?;
            return Ok(Packing::Porosity { sizes: self.sizes()?, porosity, floaters: self.floaters });
        };
        let mut faults = packing.misfits();
        let fixed = [("porosity", self.porosity.is_some()), ("floaters", self.floaters != 0.0)];
        let stray = fixed.into_iter().filter(|setting| setting.1);
        faults.extend(stray.map(|(key, _)| misfit(key, false, "a packing to a stress or as a lattice")));
        if let Some(lattice) = packing.lattice {
            let odd = [
                ("radius_ratio", self.radius_ratio.is_some()),
                ("smallest_radius", self.smallest_radius.is_some()),
                ("size_deviation", self.size_deviation.is_some()),
                ("sieve", self.sieve.is_some()),
                ("classes", self.classes.is_some()),
            ];
            faults.extend(odd.into_iter().filter(|odd| odd.1).map(|(key, _)| misfit(key, false, "a lattice")));
            let radius = self.mean_radius.map(|radius| radius.get());
            faults.extend(radius.is_none().then(|| misfit("mean_radius", true, "a lattice")));
            return if faults.is_empty() {
                Ok(Packing::Lattice { lattice, radius: radius.unwrap_or_default() })
            } else {
                Err(faults)
            };
        }
        match (self.sizes(), faults.is_empty()) {
            (Ok(sizes), true) => Ok(Packing::Stress { sizes, target: packing.target(region) }),
            (Ok(_), false) => Err(faults),
            (Err(others), _) => Err(faults.into_iter().chain(others).collect()),
        }
    }

    /// Groups of the balls and their fractions.
    pub(super) fn shares(&self) -> Vec<Share> {
        match &self.groups {
            None => vec![Share { name: self.group.clone(), share: 1.0 }],
            Some(groups) => groups.iter().map(|(name, &share)| Share { name: name.clone(), share }).collect(),
        }
    }

    /// The recipe, or all faults of the settings.
    pub(super) fn recipe(&self) -> Result<Recipe, Vec<Complaint>> {
        let region = self.region().map_err(|fault| vec![fault])?;
        let packing = self.packing(&region);
        let aggregate = self.aggregate.as_ref().map(AggregateConfig::aggregate).transpose();
        let (packing, aggregate) = match (packing, aggregate) {
            (Ok(packing), Ok(aggregate)) => (packing, aggregate),
            (packing, aggregate) => {
                return Err([packing.err(), aggregate.err()].into_iter().flatten().flatten().collect());
            }
        };
        let recipe = Recipe { region, packing, density: self.density.get(), groups: self.shares(), aggregate };
        let faults = recipe.faults();
        if faults.is_empty() {
            return Ok(recipe);
        }
        Err(faults.iter().map(|fault| Complaint::new(key(fault), fault.to_string())).collect())
    }
}

impl PackingConfig {
    fn misfits(&self) -> Vec<Complaint> {
        let lattice = self.lattice.is_some();
        let because = if lattice { "a lattice" } else { "a packing to a stress" };
        misfits(
            because,
            &[
                ("packing.stress", self.stress.is_some(), !lattice, !lattice),
                ("packing.modulus", self.modulus.is_some(), false, !lattice),
                ("packing.tolerance", self.tolerance.is_some(), false, !lattice),
                ("packing.cloud_porosity", self.cloud_porosity.is_some(), false, !lattice),
                ("packing.equilibrium", self.equilibrium.is_some(), false, !lattice),
                ("packing.floaters", self.floaters.is_some(), false, !lattice),
                (
                    "packing.floater_share",
                    self.floater_share.is_some(),
                    false,
                    !lattice && self.floaters != Some(Floaters::Keep),
                ),
            ],
        )
    }

    fn target(&self, region: &Region) -> StressTarget {
        StressTarget {
            stress: self.stress.map_or(0.0, |stress| stress.get()),
            modulus: self.modulus.map_or(MODULUS, |modulus| modulus.get()),
            tolerance: self.tolerance.unwrap_or(TOLERANCE),
            cloud_porosity: self.cloud_porosity.unwrap_or_else(|| cloud_porosity(region)),
            equilibrium: self.equilibrium.unwrap_or(EQUILIBRIUM),
            floaters: self.floaters.unwrap_or_default(),
            floater_share: self.floater_share.unwrap_or(FLOATER_SHARE),
        }
    }
}
