//! `kind = "envelope"`: the strength of a rock over the confining stress, by the criteria of Mohr and Coulomb and of Hoek and Brown.
//!
//! `table` names runs that vary the confining stress, such as a biaxial or triaxial test with a design over its `confinement`. The
//! result has the tables
//! * `parameters` (`criterion,parameter,value,std_error,unit,r2`): UCS, slope, cohesion and friction angle of the line, σ_ci, m_i and
//!   the tensile strength of the curve;
//! * `tests` and `curves`: what the tests gave, and what the criteria give;
//! * `notes`.

use super::columns::{Columns, Wanted, check_names, runs};
use super::given::check_given;
use super::invalid::Invalid;
use super::notes::Notes;
use super::reads::Reads;
use super::{Class, Complaint, Context, Failure, Job, Kind, Known, Port, Stage, StageError, Step, Task, Work};
use crate::artifact::envelope::{Curves, Envelope as Stored, Parameters, Tests};
use crate::artifact::{Accepts, Artifact, ArtifactKind};
use crate::unit::Conversion;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use stats::envelope::{Estimate, HoekBrown, MohrCoulomb};

/// Settings of an `envelope` stage.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Envelope {
    /// The stage whose runs are analysed.
    pub table: String,
    /// The response or factor that is the confining stress; by default `sigma_3`, that at the peak as the test measured it.
    #[serde(default = "sigma_3")]
    pub confinement: String,
    /// The response that is the greatest stress at failure; `sigma_1` by default.
    #[serde(default = "sigma_1")]
    pub strength: String,
    /// What to do with runs that are not valid.
    #[serde(default, skip_serializing_if = "Invalid::is_default")]
    pub invalid: Invalid,
}

fn sigma_3() -> String {
    "sigma_3".to_owned()
}

fn sigma_1() -> String {
    "sigma_1".to_owned()
}

#[derive(Serialize, Deserialize)]
struct Params {
    columns: Columns,
    confinement: String,
    strength: String,
    units: [String; 2],
}

/// Unit of the stresses of the result.
const UNIT: &str = "MPa";
/// Points of the curves.
const POINTS: usize = 61;

impl Stage for Envelope {
    fn inputs(&self) -> Vec<Port> {
        vec![Port { key: "table", stages: vec![self.table.clone()], accepts: Accepts::Only(&[ArtifactKind::RESULTS]) }]
    }

    fn gives(&self) -> ArtifactKind {
        ArtifactKind::ENVELOPE
    }

    fn check(&self, context: &Context) -> Vec<Complaint> {
        let (factors, responses) = self.names(context);
        let mut found = check_names(context, &factors, &responses);
        found.extend(check_given(context, "strength", &[&self.table], &responses));
        for (key, unit) in ["confinement", "strength"].into_iter().zip(self.units(context)) {
            if Conversion::between(&unit, UNIT).is_err() {
                let message = format!("`{key}` is measured in `{unit}`; it must be a stress");
                found.push(Complaint::new(key, message).hint("give the factor and the response the unit \"MPa\""));
            }
        }
        found
    }

    fn reads(&self) -> Vec<Reads> {
        vec![
            Reads::of("confinement", &self.table, [&self.confinement]),
            Reads::of("strength", &self.table, [&self.strength]),
        ]
    }

    fn next(&self, known: &Known) -> Result<Step, StageError> {
        let input = known.one("table")?;
        let artifact = known.load(input)?;
        let (factors, responses) = self.names(known.context);
        let wanted = Wanted { factors: &factors, responses: &responses, invalid: self.invalid, ..Wanted::default() };
        let columns = Columns::of(runs(&artifact)?, known.context, wanted)?;
        let params = Params {
            columns,
            confinement: self.confinement.clone(),
            strength: self.strength.clone(),
            units: self.units(known.context),
        };
        Ok(Step::Finish(Task::new(Self::WORKS[0].name, json!(params)).input("table", input.content)))
    }
}

impl Envelope {
    /// The factors (none for all of the table) and responses that it reads.
    fn names(&self, context: &Context) -> (Vec<String>, Vec<String>) {
        let (confinement, strength) = (self.confinement.clone(), self.strength.clone());
        if context.factors.contains_key(&confinement) {
            return (vec![confinement], vec![strength]);
        }
        (Vec::new(), vec![confinement, strength])
    }

    /// Units of the confining stress and of the strength.
    fn units(&self, context: &Context) -> [String; 2] {
        let factor = |name: &String| context.factors.get(name).map(|factor| factor.unit.clone());
        let response = |name: &String| context.responses.get(name).map(|response| response.unit.clone());
        let confinement = factor(&self.confinement).or_else(|| response(&self.confinement));
        // A name that is not declared is a fault of its own.
        [confinement, response(&self.strength)].map(|unit| unit.unwrap_or_else(|| UNIT.to_owned()))
    }
}

impl Kind for Envelope {
    const NAME: &'static str = "envelope";
    const ABOUT: &'static str = "strength over confining stress by Mohr–Coulomb and Hoek–Brown";
    const GIVES: &'static [ArtifactKind] = &[ArtifactKind::ENVELOPE];
    const CLASS: Class = Class::Statistics;
    const WORKS: &'static [Work] = &[Work { name: "envelope", version: 1, run: fit }];
}

fn fit(job: &Job) -> Result<Artifact, Failure> {
    let params: Params = job.params()?;
    let table = runs(job.input("table")?)?;
    let not_valid = params.columns.not_valid(table)?;
    let sample = params.columns.sample(table)?;
    let convert = |unit: &str| Conversion::between(unit, UNIT).map_err(|e| StageError::new(e.to_string()));
    let (to_confinement, to_strength) = (convert(&params.units[0])?, convert(&params.units[1])?);
    let values = |name: &str| -> Option<Vec<Option<f64>>> {
        let factor = sample.factors.iter().find(|factor| factor.name == name);
        let measured = || sample.responses.iter().find(|response| response.name == name);
        factor
            .map(|factor| factor.values.iter().copied().map(Some).collect())
            .or_else(|| measured().map(|response| response.values.clone()))
    };
    let (Some(confinements), Some(strengths)) = (values(&params.confinement), values(&params.strength)) else {
        return Err(StageError::new("the table lacks the confining stress or the strength").into());
    };
    let pairs = confinements.iter().zip(&strengths);
    let points: Vec<[f64; 2]> =
        pairs.filter_map(|(&p, &s)| Some([to_confinement.of(p?), to_strength.of(s?)])).collect();
    let both = MohrCoulomb::fit(&points).zip(HoekBrown::fit(&points));
    let (line, curve) = both.ok_or_else(|| {
        let message = format!("{} tests give no envelope", points.len());
        StageError::new(message).hint("two confining stresses are needed at least, and a strength that rises with them")
    })?;
    let mut notes = Notes::of(&not_valid);
    notes.missing(&params.strength, points.len(), strengths.len() - points.len());
    notes.add(&params.strength, ratio(&curve));
    let notes = notes.table();
    let stored = Stored {
        parameters: parameters(&line, &curve),
        tests: Tests {
            sigma_3: points.iter().map(|p| p[0]).collect(),
            sigma_1: points.iter().map(|p| p[1]).collect(),
            mohr_coulomb: points.iter().map(|p| line.strength(p[0])).collect(),
            hoek_brown: points.iter().map(|p| curve.strength(p[0])).collect(),
        },
        curves: curves(&line, &curve, &points),
        not_valid: not_valid.some(),
        notes: Some(notes),
    };
    Ok(stored.to_artifact())
}

fn ratio(curve: &HoekBrown) -> String {
    format!(
        "m_i {:.1} ± {:.1}: published values for granite are about 32 ± 3, for marble 9 ± 3, for sandstone 17 ± 4 (Marinos & Hoek 2000)",
        curve.m_i[0], curve.m_i[1]
    )
}

fn parameters(line: &MohrCoulomb, curve: &HoekBrown) -> Parameters {
    let degrees = line.friction_angle.map(f64::to_degrees);
    let tension: Estimate = [curve.tensile_strength(), f64::NAN];
    let rows: [(&str, &str, Estimate, &str, f64); 7] = [
        ("Mohr–Coulomb", "UCS", line.ucs, UNIT, line.r2),
        ("Mohr–Coulomb", "k", line.k, "", line.r2),
        ("Mohr–Coulomb", "cohesion", line.cohesion, UNIT, line.r2),
        ("Mohr–Coulomb", "friction_angle", degrees, "deg", line.r2),
        ("Hoek–Brown", "sigma_ci", curve.sigma_ci, UNIT, curve.r2),
        ("Hoek–Brown", "m_i", curve.m_i, "", curve.r2),
        ("Hoek–Brown", "tensile_strength", tension, UNIT, curve.r2),
    ];
    Parameters {
        criterion: rows.iter().map(|row| row.0.to_owned()).collect(),
        parameter: rows.iter().map(|row| row.1.to_owned()).collect(),
        value: rows.iter().map(|row| row.2[0]).collect(),
        std_error: rows.iter().map(|row| row.2[1]).collect(),
        unit: rows.iter().map(|row| row.3.to_owned()).collect(),
        r2: rows.iter().map(|row| row.4).collect(),
    }
}

/// The criteria from no confinement to the greatest.
fn curves(line: &MohrCoulomb, curve: &HoekBrown, points: &[[f64; 2]]) -> Curves {
    let most = points.iter().map(|p| p[0]).fold(0.0, f64::max);
    let sigma_3: Vec<f64> = (0..POINTS).map(|k| most * k as f64 / (POINTS - 1) as f64).collect();
    Curves {
        mohr_coulomb: sigma_3.iter().map(|&p| line.strength(p)).collect(),
        hoek_brown: sigma_3.iter().map(|&p| curve.strength(p)).collect(),
        sigma_3,
    }
}
