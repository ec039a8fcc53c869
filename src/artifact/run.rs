//! One run of a simulator as it is stored.

use super::{Artifact, ArtifactKind, Group, Node, Table, Unread, Values, Wanted, results};
use ndarray::{Array2, Array3};
use std::borrow::Cow;

crate::artifact! {
    /// One run of a simulator. External programs and formulas give responses only.
    pub struct Run = ArtifactKind::RUN {
        /// why the run gave no result; empty when it did
        pub failure: String, "";
        /// why the result is not valid; empty when it is
        pub validity: Option<String>, "";
        /// why the result is to be read with caution, where a program says so; empty when there is no reason
        pub cautions: Option<String>, "";
        /// what should be known before its results are believed
        pub warnings: Option<Vec<String>>, "";
        /// what the run gave
        pub responses: Responses, "";
        /// numbers by which the run is judged
        pub judgement: Option<Quantities>, "";
        /// whether the specimen failed as the test supposes
        pub checks: Option<Checks>, "";
        /// stress and strains
        pub curve: Option<Curve>, "";
        /// energies
        pub energies: Option<Energies>, "";
        /// broken bonds
        pub cracks: Option<Cracks>, "";
        /// interfaces of the cracks, row by row, where contacts are flat joints
        pub interfaces: Option<Interfaces>, "";
        /// fissures that were laid into the specimen, where there are any
        pub fissures: Option<Fissures>, "";
        /// states at shares of the peak
        pub states: Option<States>, "";
        /// centres of the bodies in each state: state, body, axis
        pub state_centres: Option<Array3<f64>>, "m";
        /// forces between bodies in each state
        pub forces: Option<Forces>, "";
    }
}

crate::table! {
    /// what the run gave
    pub struct Responses {
        /// name
        pub response: Vec<String>, "";
        /// in the unit beside it
        pub value: Vec<f64>, "";
        /// unit of the value
        pub unit: Vec<String>, "";
    }
}

crate::table! {
    /// numbers by which the result is judged
    pub struct Quantities {
        /// name
        pub quantity: Vec<String>, "";
        /// in the unit beside it
        pub value: Vec<f64>, "";
        /// unit of the value
        pub unit: Vec<String>, "";
    }
}

crate::table! {
    /// whether the specimen failed as the test supposes
    pub struct Checks {
        /// what is checked
        pub check: Vec<String>, "";
        /// what was found
        pub value: Vec<f64>, "";
        /// what must not be passed, in the unit beside it
        pub bound: Vec<f64>, "";
        /// unit of value and bound
        pub unit: Vec<String>, "";
        /// 1 when on the right side of the bound
        pub met: Vec<bool>, "";
        /// 1 when the run is not valid unless it is met
        pub decisive: Vec<bool>, "";
        /// what the value is
        pub meaning: Vec<String>, "";
        /// what to do when it is not met
        pub remedy: Vec<String>, "";
    }
}

crate::table! {
    /// stress and strains at even axial strains
    pub struct Curve {
        /// shortening positive
        pub axial_strain: Vec<f64>, "";
        /// compression positive
        pub stress: Vec<f64>, "Pa";
        /// extension positive
        pub lateral_strain: Vec<f64>, "";
        /// contraction positive
        pub volumetric_strain: Vec<f64>, "";
        /// broken bonds so far
        pub cracks: Vec<usize>, "";
        /// speed of each platen or grip, where it adapts
        pub speed: Option<Vec<f64>>, "m/s";
    }
}

crate::table! {
    /// energies per metre of thickness since the start of loading
    pub struct Energies {
        /// shortening positive
        pub axial_strain: Vec<f64>, "";
        /// given by platens or grips
        pub boundary: Vec<f64>, "J";
        /// with the masses that move the bodies
        pub kinetic: Vec<f64>, "J";
        /// stored in linear springs
        pub spring: Vec<f64>, "J";
        /// stored in bonds
        pub bond: Vec<f64>, "J";
        /// lost with the bonds that broke
        pub broken: Vec<f64>, "J";
        /// spent by friction
        pub slip: Vec<f64>, "J";
        /// spent by local damping
        pub damping: Vec<f64>, "J";
    }
}

crate::words! {
    /// How a bond broke.
    pub enum CrackMode {
        /// Pulled apart.
        Tension = "tension",
        /// Sheared.
        Shear = "shear",
    }
}

crate::table! {
    /// broken bonds in the order of breaking
    pub struct Cracks {
        /// of the specimen when it broke
        pub axial_strain: Vec<f64>, "";
        /// tension or shear
        pub mode: Vec<CrackMode>, "";
        /// group of the contact
        pub group: Vec<String>, "";
        /// position of the contact
        pub position: Array2<f64>, "m";
        /// normal of the contact; the crack lies across it
        pub normal: Array2<f64>, "";
        /// length of the crack
        pub size: Vec<f64>, "m";
    }
}

crate::table! {
    /// the interface of each crack, row by row: an interface of several elements has several cracks
    pub struct Interfaces {
        /// body, from 0
        pub first: Vec<usize>, "";
        /// body, from 0
        pub second: Vec<usize>, "";
        /// element that broke, from 0
        pub element: Vec<usize>, "";
        /// elements of the interface, of equal area
        pub elements: Vec<usize>, "";
        /// middle of the interface
        pub contact: Array2<f64>, "m";
        /// share of the area of the interface that is broken from then on
        pub damage: Vec<f64>, "";
    }
}

crate::table! {
    /// fissures in the specimen: straight lines in the plane, discs in space
    pub struct Fissures {
        /// set, from 1
        pub set: Vec<usize>, "";
        /// middle, from that of the specimen
        pub position: Array2<f64>, "m";
        /// normal
        pub normal: Array2<f64>, "";
        /// length, or diameter of the disc; none for one that cuts through the specimen
        pub size: Vec<f64>, "m";
        /// length in the specimen in the plane (m), area in space (m²)
        pub inside: Vec<f64>, "";
        /// contacts that it crosses and that were closed at the start
        pub contacts: Vec<usize>, "";
    }
}

crate::table! {
    /// states at shares of the peak
    pub struct States {
        /// shortening positive
        pub axial_strain: Vec<f64>, "";
        /// compression positive
        pub stress: Vec<f64>, "Pa";
        /// broken bonds so far
        pub cracks: Vec<usize>, "";
    }
}

crate::table! {
    /// forces between bodies in each state, per metre of thickness in the plane; single precision
    pub struct Forces {
        /// row of the table of states, from 0
        pub state: Vec<usize>, "";
        /// body, from 0
        pub first: Vec<usize>, "";
        /// body, from 0
        pub second: Vec<usize>, "";
        /// compression positive
        pub normal_force: Vec<f64>, "N";
        /// size
        pub shear_force: Vec<f64>, "N";
        /// 1 while a bond holds the two
        pub bonded: Vec<bool>, "";
    }
}

impl Run {
    /// How a warning begins that repeats [`Run::validity`].
    pub const NOT_VALID: &'static str = "not valid: ";

    /// The stress–strain curve of an artifact, without a copy; `None` where it holds none.
    pub fn curve_of(artifact: &Artifact) -> Option<&Table> {
        artifact.table("curve")
    }

    /// A run that holds responses only.
    pub fn plain(failure: &str, responses: Responses) -> Self {
        Self {
            failure: failure.to_owned(),
            validity: None,
            cautions: None,
            warnings: None,
            responses,
            judgement: None,
            checks: None,
            curve: None,
            energies: None,
            cracks: None,
            interfaces: None,
            fissures: None,
            states: None,
            state_centres: None,
            forces: None,
        }
    }

    /// What gathering and calibration take from a run, without a copy of the rest.
    ///
    /// # Errors
    /// The artifact is no run.
    pub fn outcome(artifact: &Artifact) -> Result<Outcome<'_>, Wanted> {
        let lacks = |name: &str, wanted: &str| Wanted::new(name, wanted, "nothing").within(Self::KIND.name());
        let Some(Node::Text(failure)) = artifact.root.get("failure") else { return Err(lacks("failure", "text")) };
        let Some(Node::Table(table)) = artifact.root.get("responses") else { return Err(lacks("responses", "table")) };
        let wrong = |unread: Unread| Wanted::new("responses", "its columns", unread.to_string());
        let (names, units) = (table.texts("response").map_err(wrong)?, table.texts("unit").map_err(wrong)?);
        let values = table.numbers("value", "").map_err(wrong)?;
        let all =
            names.iter().zip(values).zip(units).map(|((name, value), unit)| (name.as_str(), value, unit.as_str()));
        let (validity, cautions) = match (artifact.root.get("checks"), artifact.root.get("validity")) {
            (Some(Node::Table(table)), _) => {
                let checks = Checks::from_table(table);
                let checks = checks.map_err(|unread| Wanted::new("checks", "its columns", unread.to_string()))?;
                (Some(Cow::Owned(checks.unmet(true))), checks.unmet(false))
            }
            (_, Some(Node::Text(why))) => {
                let cautions = match artifact.root.get("cautions") {
                    Some(Node::Text(cautions)) => cautions.clone(),
                    Some(_) | None => String::new(),
                };
                (Some(Cow::Borrowed(why.as_str())), cautions)
            }
            (_, _) => (None, String::new()),
        };
        Ok(Outcome { failure, validity, cautions: Cow::Owned(cautions), responses: all.collect() })
    }

    /// The run as a reader gets it: what it gave with its verdict in columns beside it, as the row of a run among many has
    /// them. A run without a result has no values there, whatever was measured before it failed.
    #[must_use]
    pub fn judged(artifact: &Artifact) -> Artifact {
        let (Ok(outcome), Some(table)) = (Self::outcome(artifact), artifact.table("responses")) else {
            return artifact.clone();
        };
        let verdicts = [
            (results::FAILURE, outcome.failure),
            (results::VALIDITY, outcome.invalid().unwrap_or_default()),
            (results::CAUTIONS, outcome.cautions.as_ref()),
        ];
        let mut table = table.clone();
        let rows = table.rows();
        for column in table.columns.iter_mut().filter(|column| column.name == "value" && !outcome.failure.is_empty()) {
            column.values = Values::Reals(vec![f64::NAN; rows]);
        }
        let said = verdicts.into_iter().filter(|(_, why)| !why.is_empty());
        let table = said.fold(table, |table, (name, why)| table.texts_column(name, "", vec![why.to_owned(); rows]));
        let node =
            |name: &str, node: &Node| if name == "responses" { Node::Table(table.clone()) } else { node.clone() };
        let root = artifact.root.iter().fold(Group::new(), |root, (name, own)| root.with(name, node(name, own)));
        Artifact { root, ..artifact.clone() }
    }
}

impl Checks {
    /// Names of the checks that are not met: of those that make the run invalid, or of the others.
    fn unmet(&self, decisive: bool) -> String {
        let all = self.check.iter().zip(self.met.iter().zip(&self.decisive));
        let unmet = all.filter(|(_, (met, own))| !**met && **own == decisive).map(|(name, _)| name.as_str());
        unmet.collect::<Vec<_>>().join(", ")
    }
}

/// What gathering and calibration take from a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome<'a> {
    /// Why it gave no result; empty when it did.
    pub failure: &'a str,
    /// The checks that it does not meet and that make it invalid, by name; empty when it is valid, none when the
    /// simulator has no checks.
    pub validity: Option<Cow<'a, str>>,
    /// The checks that it does not meet and that are no more than a reason to look at it.
    pub cautions: Cow<'a, str>,
    /// Name, value and unit of each response.
    pub responses: Vec<(&'a str, f64, &'a str)>,
}

impl Outcome<'_> {
    /// Why a run that gave a result is not valid.
    pub fn invalid(&self) -> Option<&str> {
        self.validity.as_deref().filter(|why| self.failure.is_empty() && !why.is_empty())
    }
}

impl Responses {
    /// Responses from names, values and units.
    pub fn of(responses: &[(&str, f64, &str)]) -> Self {
        Self {
            response: responses.iter().map(|(name, ..)| (*name).to_owned()).collect(),
            value: responses.iter().map(|(_, value, _)| *value).collect(),
            unit: responses.iter().map(|(.., unit)| (*unit).to_owned()).collect(),
        }
    }
}

impl Quantities {
    /// Quantities from names, values and units.
    pub fn of(quantities: &[(&str, f64, &str)]) -> Self {
        let Responses { response, value, unit } = Responses::of(quantities);
        Self { quantity: response, value, unit }
    }
}
