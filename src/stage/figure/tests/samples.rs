//! Results that the figures of the tests are drawn from.

use super::*;
use crate::artifact::envelope::{self, Curves, Envelope, Tests};
use crate::artifact::run::{Fissures, Interfaces};

pub(super) fn range_analysis() -> Artifact {
    let factor = words(["Ec", "mu", "null"]);
    let range = Ranges {
        response: words(["UCS", "UCS", "UCS"]),
        factor: factor.clone(),
        level: Numbered(vec![vec![30.0, 34.0, 34.5], vec![40.0, 35.0, 35.0], vec![f64::NAN, 36.0, 34.6]]),
        range: vec![10.0, 2.0, 0.5],
        rank: vec![1, 2, 3],
        missing: vec![0; 3],
    };
    let level = Numbered(vec![vec![10.0, 0.5, 1.0], vec![20.0, 1.0, 2.0], vec![f64::NAN, 1.5, 3.0]]);
    let levels = LevelValues { factor, unit: words(["GPa", "", ""]), level: Levels::Numbers(level) };
    Range { range, levels, notes: NoteTable::default(), not_valid: None }.to_artifact()
}

pub(super) fn results(shift: f64) -> Artifact {
    let ec = vec![10.0, 20.0, 10.0, 20.0, 15.0, 15.0];
    let mu = vec![0.5, 0.5, 1.5, 1.5, 1.0, 1.0];
    let ucs = ec.iter().zip(&mu).map(|(a, b)| a + 4.0 * b + shift).collect();
    let runs =
        table().reals_column("Ec", "GPa", "", ec).reals_column("mu", "", "", mu).reals_column("UCS", "MPa", "", ucs);
    artifact("results", vec![("runs", runs)])
}

fn plain_run() -> Run {
    let axial_strain: Vec<f64> = (0..40).map(|i| f64::from(i) * 5e-5).collect();
    let lateral_strain: Vec<f64> = axial_strain.iter().map(|e| 0.2 * e).collect();
    let n = 30;
    let count = |f: fn(f64) -> f64| (0..n).map(|i| f(f64::from(i))).collect::<Vec<f64>>();
    let curve = Curve {
        stress: axial_strain.iter().map(|e| 3e10 * e * (1.0 - e / 2e-3)).collect(),
        volumetric_strain: axial_strain.iter().zip(&lateral_strain).map(|(a, l)| a - l).collect(),
        cracks: vec![0; 40],
        axial_strain,
        speed: None,
        lateral_strain,
    };
    let cracks = Cracks {
        axial_strain: count(|i| 5e-5 * i),
        mode: (0..n).map(|i| if i % 3 == 0 { CrackMode::Shear } else { CrackMode::Tension }).collect(),
        group: vec!["mortar".to_owned(); 30],
        position: Array2::from_shape_fn((30, 2), |(i, axis)| [1e-3, -2e-3][axis] * (i as f64 - 15.0)),
        normal: Array2::from_shape_fn((30, 2), |(_, axis)| [1.0, 0.0][axis]),
        size: count(|_| 1e-3),
    };
    let forces = Forces {
        state: (0..30).map(|i| i % 2).collect(),
        first: (0..30).collect(),
        second: (1..31).collect(),
        normal_force: count(|i| 100.0 * (i - 4.0)),
        shear_force: count(|_| 0.0),
        bonded: vec![true; 30],
    };
    let states = States { axial_strain: vec![1e-4, 1e-3], stress: vec![1e6, 3e7], cracks: vec![0, 0] };
    let centre = |(state, disc, axis)| [1e-3 * (disc as f64 - 15.0), 1e-2 * state as f64][axis];
    Run {
        curve: Some(curve),
        cracks: Some(cracks),
        forces: Some(forces),
        states: Some(states),
        state_centres: Some(Array3::from_shape_fn((2, 31, 2), centre)),
        ..Run::plain("", Responses::of(&[("E", 3e10, "Pa")]))
    }
}

pub(super) fn run() -> Artifact {
    plain_run().to_artifact()
}

/// The same run with two elements for each interface and a fissure that cuts through.
pub(super) fn jointed() -> Artifact {
    let run = plain_run();
    let cracks = run.cracks.as_ref().unwrap();
    let interfaces = Interfaces {
        first: (0..30).map(|i| i / 2).collect(),
        second: (0..30).map(|i| i / 2 + 1).collect(),
        element: (0..30).map(|i| i % 2).collect(),
        elements: vec![2; 30],
        contact: cracks.position.clone(),
        damage: (0..30).map(|i| if i % 2 == 0 { 0.5 } else { 1.0 }).collect(),
    };
    let fissures = Fissures {
        set: vec![1],
        position: Array2::zeros((1, 2)),
        normal: Array2::from_shape_fn((1, 2), |(_, axis)| [0.6, 0.8][axis]),
        size: vec![f64::NAN],
        inside: vec![0.05],
        contacts: vec![12],
    };
    Run { interfaces: Some(interfaces), fissures: Some(fissures), ..run }.to_artifact()
}

pub(super) fn strength_envelope() -> Artifact {
    let sigma_3: Vec<f64> = (0..5).map(|i| 10.0 * f64::from(i)).collect();
    let line: Vec<f64> = sigma_3.iter().map(|p| 100.0 + 6.0 * p).collect();
    let (mohr_coulomb, hoek_brown) = (line.clone(), line.clone());
    let values = [("cohesion", 20.0), ("friction_angle", 45.0), ("sigma_ci", 100.0), ("m_i", 12.0)];
    let parameters = envelope::Parameters {
        criterion: vec![String::new(); 4],
        parameter: values.iter().map(|one| one.0.to_owned()).collect(),
        value: values.iter().map(|one| one.1).collect(),
        std_error: vec![0.1; 4],
        unit: vec![String::new(); 4],
        r2: vec![0.99; 4],
    };
    let tests = Tests {
        sigma_3: sigma_3.clone(),
        sigma_1: line,
        mohr_coulomb: mohr_coulomb.clone(),
        hoek_brown: hoek_brown.clone(),
    };
    let curves = Curves { sigma_3, mohr_coulomb, hoek_brown };
    Envelope { parameters, tests, curves, not_valid: None, notes: None }.to_artifact()
}

pub(super) fn specimen() -> Artifact {
    let specimen = Specimen {
        outline: "rectangle".into(),
        width: 0.05,
        height: 0.1,
        depth: 0.0,
        density: 2000.0,
        centres: Array2::from(vec![[0.0, 0.0], [0.002, 0.0], [0.004, 0.01]]),
        group_of: vec![0, 1, 1],
        groups: words(["mortar", "aggregate"]),
        radii: vec![1e-3; 3],
        clump_of: vec![-1, 0, 0],
        clumps: table(),
        polygon_of: vec![0, 0, 0],
        vertices: vec![[0.0, 0.0], [0.005, 0.0], [0.0, 0.005]],
        quality: table(),
        warnings: Vec::new(),
        failure: None,
    };
    specimen.to_artifact()
}

/// The specimen of the states of [`run`].
pub(super) fn row_of_discs() -> Artifact {
    let mut specimen = Specimen::from_artifact(&specimen()).unwrap();
    specimen.centres = Array2::from_shape_fn((31, 2), |(disc, axis)| [1e-3 * (disc as f64 - 15.0), 0.0][axis]);
    (specimen.group_of, specimen.radii, specimen.clump_of) = (vec![0; 31], vec![5e-4; 31], vec![-1; 31]);
    specimen.to_artifact()
}

pub(super) fn surfaces() -> Artifact {
    let coefficients = Coefficients {
        response: words(["UCS", "UCS", "UCS", "UCS", "E"]),
        term: words(["const", "Ec", "mu", "Ec*mu", "const"]),
        estimate: vec![1.0, 2.0, -3.0, 0.5, 7.0],
        std_error: vec![0.1; 5],
        t: vec![1.0; 5],
        p: vec![0.5; 5],
        vif: vec![1.0; 5],
        ..Coefficients::default()
    };
    let domain = Domains {
        scale: None,
        response: words(["UCS", "UCS"]),
        factor: words(["Ec", "mu"]),
        unit: words(["GPa", ""]),
        low: vec![8.0, 0.4],
        high: vec![22.0, 1.6],
    };
    let surfaces = Surfaces {
        not_valid: None,
        coefficients,
        coded: Coefficients::default(),
        fit: Fits::default(),
        residuals: residuals(),
        stationary: Stationary::default(),
        axes: PrincipalAxes::default(),
        path: Paths::default(),
        domain,
        selection: Selections::default(),
        notes: NoteTable::default(),
        models: BTreeMap::new(),
        with_constant: None,
        predictions: None,
    };
    surfaces.to_artifact()
}

pub(super) fn residuals() -> Residuals {
    let n = 12;
    let count = |f: fn(f64) -> f64| (0..n).map(|i| f(f64::from(i))).collect::<Vec<f64>>();
    Residuals {
        response: vec!["UCS".into(); 12],
        row: (1..=12).collect(),
        observed: count(|i| 20.0 + i),
        fitted: count(|i| 20.0 + 1.01 * i),
        residual: count(|i| -0.01 * i),
        leverage: count(|i| 0.25 + 0.01 * (i % 3.0)),
        standardized: count(|_| 0.0),
        studentized: count(|i| if i == 5.0 { 4.0 } else { (i * 1.7) % 2.0 - 1.0 }),
        cook: count(|_| 0.0),
        flag: vec![String::new(); 12],
    }
}

pub(super) fn screening() -> Artifact {
    let effects = Effects {
        response: vec!["UCS".into(); 3],
        term: words(["Ec", "mu", "Ec*mu"]),
        effect: vec![9.0, -3.0, 0.4],
        std_error: vec![f64::NAN; 3],
        standardized: vec![f64::NAN; 3],
        p: vec![f64::NAN; 3],
        lenth_t: vec![1.0; 3],
        rank: vec![1, 2, 3],
        share: vec![0.3; 3],
        cumulative: vec![0.3, 0.6, 1.0],
        normal: vec![0.97, -0.97, 0.0],
        half_normal: vec![1.38, 0.67, 0.21],
        verdict: words(["", "", ""]),
        significance: words(["", "", ""]),
    };
    let limits = Limits {
        response: words(["UCS"]),
        pse: vec![0.6],
        margin: vec![2.3],
        simultaneous: vec![f64::NAN],
        critical: vec![f64::NAN],
    };
    let (fit, notes) = (Fits::default(), NoteTable::default());
    Screening { effects, limits, fit, notes, residuals: residuals(), not_valid: None }.to_artifact()
}

pub(super) fn anova() -> Artifact {
    let anova = Variances {
        response: vec!["UCS".into(); 4],
        source: words(["Ec", "mu", "residual", "total"]),
        df: vec![1, 1, 2, 4],
        ss: vec![8.0, 1.5, 0.5, 10.0],
        ms: vec![8.0, 1.5, 0.25, f64::NAN],
        f: vec![f64::NAN; 4],
        p: vec![f64::NAN; 4],
        significance: words(["", "", "", ""]),
        eta2: vec![0.8, 0.15, 0.05, f64::NAN],
        omega2: vec![f64::NAN; 4],
        ..Variances::default()
    };
    Anova { anova, fit: Fits::default(), notes: NoteTable::default(), residuals: residuals(), not_valid: None }
        .to_artifact()
}

pub(super) fn solution() -> Artifact {
    let factors = |ec: Vec<f64>, mu: Vec<f64>| table().reals_column("Ec", "GPa", "", ec).reals_column("mu", "", "", mu);
    let solved = Solved {
        set: vec![1, 2],
        point: factors(vec![12.0, 18.0], vec![0.7, 1.2]),
        misfit: vec![1e-4, 2e-3],
        evaluations: vec![20, 1],
        failed: vec![0, 0],
        stop: words(["", ""]),
        met: vec![Answer::Yes; 2],
        free: vec![0.0, 0.0],
        ..Solved::default()
    };
    let history = Evaluations {
        set: vec![1, 1, 2],
        evaluation: vec![1, 20, 1],
        misfit: vec![0.5, 1e-4, 2e-3],
        best: vec![0.5, 1e-4, 2e-3],
        recommended: vec![f64::NAN; 3],
        failure: words(["", "", ""]),
        ..Evaluations::default()
    };
    let solution = Solution {
        solution: solved,
        parameters: Parameters::default(),
        prediction: Prediction::default(),
        history,
        effort: Effort::default(),
        solution_set: Alternatives { set: vec![1, 2], point: factors(vec![13.0, 17.0], vec![0.8, 1.1]) },
        notes: NoteTable::default(),
    };
    solution.to_artifact()
}

pub(super) fn verification() -> Artifact {
    let runs = VerifiedRuns {
        set: vec![1, 1, 2, 2],
        specimen: vec![1, 2, 1, 2],
        runs: table().reals_column("UCS", "MPa", "", vec![30.0, 31.0, 40.0, f64::NAN]),
    };
    let summary = Summary {
        set: vec![1, 2],
        response: words(["UCS", "UCS"]),
        unit: words(["MPa", "kPa"]),
        target: vec![30.2, 41_000.0],
        mean: vec![30.5, 40.0],
        std: vec![0.7, f64::NAN],
        cv_percent: vec![2.0, f64::NAN],
        relative_error_percent: vec![1.0, 2.0],
        error_of_mean_percent: vec![1.0, 2.0],
        low: vec![f64::NAN; 2],
        high: vec![f64::NAN; 2],
        target_inside: vec![Answer::Unknown; 2],
        n: vec![2, 1],
    };
    Verification { summary, runs, not_valid: None }.to_artifact()
}
