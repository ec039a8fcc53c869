//! The setting of each fault of a recipe.

use dem::genesis::gradation::GradationError;
use dem::genesis::packing::PackingError;
use dem::genesis::polygon::PolygonError;
use dem::genesis::specimen::SpecimenError;

/// The path of the setting of a fault; that of the table for a key that is not set.
pub(super) fn key(fault: &SpecimenError) -> &'static str {
    match fault {
        SpecimenError::Packing(packing) => packing_key(packing),
        SpecimenError::Value { name, .. } => value_key(name),
        SpecimenError::Gradation(GradationError::Value { name: "content", .. }) => "aggregate.content",
        SpecimenError::Gradation(GradationError::Value { name: "max_size", .. }) => "aggregate.max_size",
        SpecimenError::Gradation(GradationError::Value { name: "exponent", .. }) => "aggregate.exponent",
        SpecimenError::Gradation(GradationError::Value { name: "passing fraction", .. }) => "aggregate.passing",
        SpecimenError::Gradation(_) | SpecimenError::LargeAggregate { .. } | SpecimenError::ManyAggregate(_) => {
            "aggregate.classes"
        }
        SpecimenError::Polygon(PolygonError::Vertices { .. }) => "aggregate.vertices",
        SpecimenError::Polygon(PolygonError::Fill(_)) => "aggregate.least_fill",
        SpecimenError::Placement(_) | SpecimenError::NoAggregate { .. } | SpecimenError::SolidAggregate => "aggregate",
        SpecimenError::Groups(_) => "groups",
        SpecimenError::Stones(fault) => super::stones::key(fault),
    }
}

fn packing_key(fault: &PackingError) -> &'static str {
    match fault {
        PackingError::Value { name, .. } => value_key(name),
        PackingError::List { name: "classes", .. } => "classes",
        PackingError::List { name: "sieve passing", .. } => "sieve.passing",
        PackingError::List { name: "sieve diameters", .. } => "sieve.diameters",
        PackingError::List { .. } => "sieve",
        PackingError::Few { .. } | PackingError::Many { .. } | PackingError::Large { .. } => "mean_radius",
        PackingError::Dimension { .. } => "packing.lattice",
        PackingError::Loose { .. }
        | PackingError::Dense { .. }
        | PackingError::Escaped { .. }
        | PackingError::Stopped
        | PackingError::Restless { .. }
        | PackingError::Unsettled { .. } => "",
    }
}

fn value_key(name: &str) -> &'static str {
    match name {
        "porosity" => "porosity",
        "mean_radius" | "radius" => "mean_radius",
        "smallest_radius" => "smallest_radius",
        "radius ratio" => "radius_ratio",
        "size_deviation" => "size_deviation",
        "floaters" => "floaters",
        "stress" | "stress over modulus" => "packing.stress",
        "modulus" => "packing.modulus",
        "tolerance" => "packing.tolerance",
        "cloud_porosity" => "packing.cloud_porosity",
        "equilibrium" => "packing.equilibrium",
        "floater_share" => "packing.floater_share",
        "density" => "density",
        "aggregate density" => "aggregate.density",
        "aggregate gap" => "aggregate.gap",
        "aggregate wall gap" => "aggregate.wall_gap",
        "attempts" => "aggregate.attempts",
        _ => "",
    }
}
