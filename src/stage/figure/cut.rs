//! Where a picture of a specimen in space is cut open.

use super::parts::MM;
use crate::stage::{Complaint, Context};
use crate::unit::Length;
use figure::solid;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The axis across which a specimen is cut open; the load acts along y.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Across {
    /// The specimen is shown whole.
    None,
    /// To the right.
    X,
    /// Up, along the load.
    Y,
    /// To the eye.
    Z,
}

/// The cut of a task: everything that decides it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cut {
    across: Across,
    /// Metres from the middle.
    at: f64,
}

impl Cut {
    /// The cut that the keys `cut` and `cut_at` describe; without `cut` the figure chooses.
    pub(super) fn of(across: Option<Across>, at: Option<Length>) -> Option<Self> {
        across.map(|across| Self { across, at: at.map_or(0.0, Length::get) })
    }

    /// The cut on the page, where the second axis of the specimen points up and the third out of it.
    pub(super) fn on_page(self) -> Option<solid::Cut> {
        let at = self.at * MM;
        match self.across {
            Across::None => None,
            Across::X => Some(solid::Cut { axis: 0, at }),
            Across::Y => Some(solid::Cut { axis: 2, at }),
            Across::Z => Some(solid::Cut { axis: 1, at: 0.0 - at }),
        }
    }

    /// Faults of the keys on the specimen of the stage `of`.
    pub(super) fn check(
        across: Option<Across>,
        at: Option<Length>,
        of: &[String],
        context: &Context,
    ) -> Vec<Complaint> {
        let mut found = Vec::new();
        let region = of.first().and_then(|stage| context.sketches.get(stage)?.region.as_ref());
        if across.is_some() && region.is_some_and(|region| region.dimension() == 2) {
            let message = "`cut` has no effect on a specimen in the plane";
            found.push(Complaint::new("cut", message).hint("leave out `cut`"));
        }
        let Some(at) = at else { return found };
        let number = match across {
            None | Some(Across::None) => {
                let message = "`cut_at` has no effect without `cut`";
                found.push(Complaint::new("cut_at", message).hint("cut = \"z\" opens the specimen to the eye"));
                return found;
            }
            Some(Across::X) => 0,
            Some(Across::Y) => 1,
            Some(Across::Z) => 2,
        };
        let half = region.and_then(|region| region.edges().get(number).copied()).map(|edge| edge / 2.0);
        if let Some(half) = half.filter(|half| at.get().abs() >= *half) {
            let message = format!("the specimen reaches {} mm from its middle", half * MM);
            found.push(Complaint::new("cut_at", message).hint("`cut_at` counts from the middle"));
        }
        found
    }
}
