//! Figures of fitted models: surfaces, residuals, effects.

use super::super::{StageError, artifact_kind};
use super::source::{Source, Sources, pick, rows_of};
use super::{Label, Params};
use crate::artifact::envelope::Envelope;
use crate::artifact::statistics::{Anova, Residuals as StoredResiduals, Screening};
use crate::artifact::surfaces::{Coefficients, Domains, Surfaces};
use figure::Quantity;
use figure::agreement::{Agreement, Cloud, Pair};
use figure::axis::{fixed, significant};
use figure::bars::{Bar, RankedBars};
use figure::contour::Contour;
use figure::effect_plot::{Coordinates, Effect, EffectPlot};
use figure::marks::Band;
use figure::residuals::Residuals;
use figure::surface::Surface;
use figure::text;
use figure::xy::{self, Xy};
use math::distribution::normal_quantile;
use math::elementary::ln;
use math::scale::Scale;
use stats::terms::Term;

fn one_response(params: &Params) -> Result<&Label, StageError> {
    params.responses.first().ok_or_else(|| StageError::new("no response is named"))
}

/// Nodes along one side of a drawn surface.
const NODES: usize = 61;

/// A polynomial in natural units, of logarithms where a factor has such a scale: terms with their coefficients.
struct Polynomial(Vec<(Term, f64)>);

impl Polynomial {
    fn read(stored: &Coefficients, response: &str) -> Result<Self, StageError> {
        let which = rows_of(&stored.response, response)?;
        let (terms, values) = (pick(&stored.term, &which), pick(&stored.estimate, &which));
        let parsed = terms.iter().map(|t| Term::parse(t).map_err(|e| StageError::new(e.to_string())));
        Ok(Self(parsed.collect::<Result<Vec<_>, _>>()?.into_iter().zip(values).collect()))
    }

    fn factors(&self) -> Vec<String> {
        let mut found: Vec<String> = Vec::new();
        for name in self.0.iter().flat_map(|(term, _)| term.factors()) {
            if !found.iter().any(|f| f == name) {
                found.push(name.to_owned());
            }
        }
        found
    }

    fn value(&self, point: &dyn Fn(&str) -> f64) -> f64 {
        let one = |(term, c): &(Term, f64)| {
            term.factors().fold(*c, |product, f| product * (0..term.power_of(f)).fold(1.0, |p, _| p * point(f)))
        };
        self.0.iter().map(one).sum()
    }
}

pub(super) fn contour(params: &Params, sources: &Sources) -> Result<Contour, StageError> {
    let response = one_response(params)?;
    let surfaces = Surfaces::from_artifact(sources.first()?.0)?;
    let model = Polynomial::read(&surfaces.coefficients, &response.key)?;
    let [x, y] = params.factors.first_chunk::<2>().ok_or_else(|| StageError::new("two factors must be named"))?;
    let used = model.factors();
    for label in [x, y] {
        if !used.contains(&label.key) {
            let message = format!("the surface of `{}` does not depend on `{}`", response.key, label.key);
            return Err(StageError::new(message).hint(format!("it depends on {}", used.join(", "))));
        }
    }
    let domain = Domain::read(&surfaces.domain, &response.key);
    let range = |label: &Label| {
        let own = domain.of(&label.key).or(label.range);
        own.ok_or_else(|| StageError::new(format!("[factor.{}] has neither levels nor range", label.key)))
    };
    let nodes = |label: &Label| -> Result<Vec<f64>, StageError> {
        let ([low, high], scale) = (range(label)?, domain.scale(&label.key));
        let [from, to] = [low, high].map(|end| scale.of(end));
        let even = |i: usize| scale.natural(from + (to - from) * i as f64 / (NODES - 1) as f64);
        let node = |i: usize| match (scale, i) {
            (Scale::Log, 0) => low,
            (Scale::Log, i) if i == NODES - 1 => high,
            _ => even(i),
        };
        Ok((0..NODES).map(node).collect())
    };
    let (xs, ys) = (nodes(x)?, nodes(y)?);
    let mut held: Vec<(&Label, f64)> = Vec::new();
    for key in used.iter().filter(|key| **key != x.key && **key != y.key) {
        let label = params.factors.iter().find(|l| l.key == *key);
        let label =
            label.ok_or_else(|| StageError::new(format!("the surface depends on `{key}`, which is no factor")))?;
        let value = match params.at.get(key) {
            Some(value) => *value,
            None => range(label).map(|[low, high]| middle(domain.scale(key), low, high))?,
        };
        held.push((label, value));
    }
    let at = |key: &str, u: f64, v: f64| match key {
        key if key == x.key => u,
        key if key == y.key => v,
        key => held.iter().find(|(l, _)| l.key == key).map_or(0.0, |(_, value)| *value),
    };
    let values = ys.iter().flat_map(|&v| xs.iter().map(move |&u| (u, v)));
    let values = values.map(|(u, v)| model.value(&|key| domain.scale(key).of(at(key, u, v)))).collect();
    let note = held.iter().map(|(l, v)| {
        let unit = if l.unit.is_empty() { String::new() } else { format!(" {}", figure::text::unit_markup(&l.unit)) };
        format!("{} = {}{unit}", l.quantity().sign(), short(*v))
    });
    let note = note.collect::<Vec<_>>().join(", ");
    Ok(Contour {
        x: x.quantity(),
        y: y.quantity(),
        z: response.quantity(),
        xs,
        ys,
        values,
        points: marks(sources, x, y)?,
        note,
        scales: [x, y].map(|label| match domain.scale(&label.key) {
            Scale::Linear => figure::axis::Scale::Linear,
            Scale::Log => figure::axis::Scale::Log,
        }),
    })
}

/// The middle of a range on a scale.
fn middle(scale: Scale, low: f64, high: f64) -> f64 {
    match scale {
        Scale::Linear => (low + high) / 2.0,
        Scale::Log => (low * high).sqrt(),
    }
}

/// The ranges over which a response was fitted, and the scale of each factor in the model.
struct Domain(Vec<(String, [f64; 2], Scale)>);

impl Domain {
    fn read(stored: &Domains, response: &str) -> Self {
        let own = (0..stored.response.len()).filter(|&i| stored.response[i] == response);
        let scale = |i: usize| stored.scale.as_ref().map_or(Scale::Linear, |all| all[i]);
        Self(own.map(|i| (stored.factor[i].clone(), [stored.low[i], stored.high[i]], scale(i))).collect())
    }

    /// The scale of a factor in the model.
    fn scale(&self, factor: &str) -> Scale {
        self.0.iter().find(|(name, ..)| name == factor).map_or(Scale::Linear, |(_, _, scale)| *scale)
    }

    fn of(&self, factor: &str) -> Option<[f64; 2]> {
        self.0.iter().find(|(name, [low, high], _)| name == factor && low < high).map(|(_, range, _)| *range)
    }
}

/// Points of the runs to which a surface was fitted, in its two factors.
fn marks(sources: &Sources, x: &Label, y: &Label) -> Result<Vec<[f64; 2]>, StageError> {
    let mut marks: Vec<[f64; 2]> = Vec::new();
    for source in &sources.compare {
        let rows = source.main()?;
        for (u, v) in rows.reals(&x.key, &x.unit)?.into_iter().zip(rows.reals(&y.key, &y.unit)?) {
            if !marks.contains(&[u, v]) {
                marks.push([u, v]);
            }
        }
    }
    Ok(marks)
}

/// The smallest number of decimals that shows the number.
fn short(v: f64) -> String {
    let exact = |d: &usize| (format!("{v:.d$}").parse::<f64>().unwrap_or(f64::NAN) - v).abs() <= 1e-9 * v.abs();
    (0..6).find(exact).map_or_else(|| significant(v, 4), |d| fixed(v, d))
}

pub(super) fn surface(params: &Params, sources: &Sources) -> Result<Surface, StageError> {
    Ok(Surface { field: contour(params, sources)?, azimuth: -60.0, elevation: 28.0 })
}

pub(super) fn residuals(params: &Params, sources: &Sources) -> Result<Residuals, StageError> {
    let response = one_response(params)?;
    let stored = residuals_of(sources.first()?)?;
    let which = rows_of(&stored.response, &response.key)?;
    let (studentized, leverage) = (pick(&stored.studentized, &which), pick(&stored.leverage, &which));
    // The trace of the hat matrix is the number of coefficients.
    let coefficients = leverage.iter().filter(|h| h.is_finite()).sum::<f64>().round() as usize;
    Ok(Residuals {
        response: response.quantity(),
        runs: which.iter().map(|&i| stored.row[i].to_string()).collect(),
        fitted: pick(&stored.fitted, &which),
        quantiles: normal_scores(&studentized),
        studentized,
        leverage,
        coefficients,
        limit: 3.0,
    })
}

/// The normal quantile of (rank − 3/8)/(n + 1/4) (Blom 1958) of each value.
fn normal_scores(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).filter(|&i| values[i].is_finite()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let n = order.len() as f64;
    let mut scores = vec![f64::NAN; values.len()];
    for (rank, i) in order.into_iter().enumerate() {
        scores[i] = normal_quantile((rank as f64 + 0.625) / (n + 0.25));
    }
    scores
}

pub(super) fn observed(params: &Params, sources: &Sources) -> Result<Agreement, StageError> {
    let stored = residuals_of(sources.first()?)?;
    let mut pairs = Vec::new();
    for response in &params.responses {
        let Ok(which) = rows_of(&stored.response, &response.key) else { continue };
        let (x, y) = (pick(&stored.observed, &which), pick(&stored.fitted, &which));
        let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
        let total: f64 = x.iter().map(|v| (v - mean) * (v - mean)).sum();
        let left: f64 = x.iter().zip(&y).map(|(a, b)| (a - b) * (a - b)).sum();
        let note = format!("$R^2$ = {}", fixed(1.0 - left / total, 4));
        let names = (1..=x.len()).map(|i| i.to_string()).collect();
        pairs.push(Pair {
            quantity: response.quantity(),
            clouds: vec![Cloud { name: String::new(), x, y, rows: names }],
            note,
        });
    }
    if pairs.is_empty() {
        return Err(StageError::new("the model holds none of the responses that are named"));
    }
    Ok(Agreement { x_word: "Observed".into(), y_word: "Predicted".into(), pairs, band: params.band })
}

/// Effects on one response, their positions in the plots, and the limits of the active ones.
struct Effects {
    names: Vec<String>,
    values: Vec<f64>,
    normal: Vec<f64>,
    half_normal: Vec<f64>,
    error: f64,
    margin: Option<(String, f64)>,
    simultaneous: Option<f64>,
    /// Effects divided by their standard errors, with the critical value as the margin.
    standardized: bool,
}

fn effects(params: &Params, sources: &Sources) -> Result<Effects, StageError> {
    let response = one_response(params)?;
    let Screening { effects, limits, .. } = Screening::from_artifact(sources.first()?.0)?;
    let which = rows_of(&effects.response, &response.key)?;
    let mine = rows_of(&limits.response, &response.key)?;
    let limit = |values: &[f64]| pick(values, &mine).first().copied().filter(|value| value.is_finite());
    let names = pick(&effects.term, &which).iter().map(|t| term_label(t, params)).collect();
    let (normal, half_normal) = (pick(&effects.normal, &which), pick(&effects.half_normal, &which));
    if let Some(critical) = limit(&limits.critical) {
        return Ok(Effects {
            names,
            values: pick(&effects.standardized, &which),
            normal,
            half_normal,
            error: 1.0,
            margin: Some(("critical value".to_owned(), critical)),
            simultaneous: None,
            standardized: true,
        });
    }
    Ok(Effects {
        names,
        values: pick(&effects.effect, &which),
        normal,
        half_normal,
        error: limit(&limits.pse).unwrap_or(f64::NAN),
        margin: limit(&limits.margin).map(|margin| ("margin of error".to_owned(), margin)),
        simultaneous: limit(&limits.simultaneous),
        standardized: false,
    })
}

/// The residuals that an artifact of the statistics holds.
fn residuals_of(source: Source) -> Result<StoredResiduals, StageError> {
    let kind = artifact_kind(source.0);
    Ok(if kind == Some(Anova::KIND) {
        Anova::from_artifact(source.0)?.residuals
    } else if kind == Some(Screening::KIND) {
        Screening::from_artifact(source.0)?.residuals
    } else {
        Surfaces::from_artifact(source.0)?.residuals
    })
}

/// The sources of an analysis of variance by the roots of their sums of squares: χ quantiles of the plot positions
/// (i − ½)/m, which for two degrees of freedom are √(−2 ln(1 − p)).
fn chi_plot(params: &Params, source: Source) -> Result<EffectPlot, StageError> {
    let response = one_response(params)?;
    let lines = Anova::from_artifact(source.0)?.anova;
    let which = rows_of(&lines.response, &response.key)?;
    let (names, df) = (pick(&lines.source, &which), pick(&lines.df, &which));
    let (squares, words) = (pick(&lines.ss, &which), pick(&lines.significance, &which));
    let effects: Vec<usize> = (0..names.len()).filter(|&i| names[i] != "residual" && names[i] != "total").collect();
    let degrees = effects.first().map_or(0, |&i| df[i]);
    if !(degrees == 1 || degrees == 2) || effects.iter().any(|&i| df[i] != degrees) {
        return Err(StageError::new(
            "the sources of the analysis of variance do not all have one, or all two, degrees of freedom",
        )
        .hint("show = \"pareto\" compares sources of different degrees of freedom"));
    }
    let mut order = effects.clone();
    order.sort_by(|&a, &b| squares[a].total_cmp(&squares[b]));
    let position =
        |i: usize| order.iter().position(|&k| k == i).map_or(0.0, |rank| rank as f64 + 0.5) / order.len() as f64;
    let quantile = |p: f64| if degrees == 1 { normal_quantile(0.5 + 0.5 * p) } else { (-2.0 * ln(1.0 - p)).sqrt() };
    let residual = (0..names.len()).find(|&i| names[i] == "residual");
    let effect = |&i: &usize| Effect {
        name: term_label(&names[i], params),
        size: squares[i].max(0.0).sqrt(),
        quantile: quantile(position(i)),
        active: !words[i].is_empty() && words[i] != "-",
    };
    Ok(EffectPlot {
        response: response.quantity(),
        coordinates: if degrees == 1 { Coordinates::HalfNormal } else { Coordinates::Chi(degrees as usize) },
        effects: effects.iter().map(effect).collect(),
        error: residual.map_or(f64::NAN, |i| (squares[i] / df[i] as f64).sqrt()),
        standardized: false,
        margin: None,
    })
}

pub(super) fn half_normal(params: &Params, sources: &Sources) -> Result<EffectPlot, StageError> {
    if sources.first()?.0.is(Anova::KIND) {
        return chi_plot(params, sources.first()?);
    }
    let found = effects(params, sources)?;
    let places = found.values.iter().map(|e| e.abs()).zip(found.half_normal.iter().copied()).collect();
    effect_plot(params, found, Coordinates::HalfNormal, places)
}

pub(super) fn normal(params: &Params, sources: &Sources) -> Result<EffectPlot, StageError> {
    let found = effects(params, sources)?;
    let places = found.values.iter().copied().zip(found.normal.iter().copied()).collect();
    effect_plot(params, found, Coordinates::Normal, places)
}

/// `places`: effect and quantile of each.
fn effect_plot(
    params: &Params,
    found: Effects,
    coordinates: Coordinates,
    places: Vec<(f64, f64)>,
) -> Result<EffectPlot, StageError> {
    let active = found.values.iter().map(|e| found.margin.as_ref().is_some_and(|(_, m)| e.abs() > *m));
    let effects = places.into_iter().zip(found.names).zip(active);
    let effect = |(((size, quantile), name), active)| Effect { name, size, quantile, active };
    Ok(EffectPlot {
        response: one_response(params)?.quantity(),
        coordinates,
        effects: effects.map(effect).collect(),
        error: found.error,
        margin: found.margin,
        standardized: found.standardized,
    })
}

/// A term with the symbols of its factors: `Ec*kn_ks` → E_c · k_n/k_s.
fn term_label(term: &str, params: &Params) -> String {
    let part = |part: &str| {
        let (key, power) = part.split_once('^').unwrap_or((part, ""));
        let label = params.factors.iter().find(|l| l.key == key.trim());
        let sign = label.map_or_else(|| key.to_owned(), |l| l.quantity().sign());
        match label.is_some_and(|l| text::is_compound(&l.symbol)) {
            _ if power.is_empty() => sign,
            true => format!("({sign})$^{{{power}}}$"),
            false => format!("{sign}$^{{{power}}}$"),
        }
    };
    term.split('*').map(part).collect::<Vec<_>>().join(" · ")
}

/// Fractions of the total sum of squares of an analysis of variance, by source.
fn shares(params: &Params, source: Source) -> Result<RankedBars, StageError> {
    let response = one_response(params)?;
    let lines = Anova::from_artifact(source.0)?.anova;
    let which = rows_of(&lines.response, &response.key)?;
    let (names, squares) = (pick(&lines.source, &which), pick(&lines.eta2, &which));
    // Beside factors that set properties of groups, one that sets nothing is an empty column.
    let grouped = params.factors.iter().any(|l| !l.group.is_empty());
    let mut bars = Vec::new();
    for (name, share) in names.iter().zip(squares).filter(|(name, share)| *name != "total" && share.is_finite()) {
        let label = params.factors.iter().find(|l| l.key == *name);
        let group = match label.map_or("", |l| l.group.as_str()) {
            _ if name == "residual" => "residual",
            "" if grouped => "empty column",
            group => group,
        };
        let factor = Quantity::new(&term_label(name, params), "", "");
        bars.push(Bar { factor, group: group.to_owned(), value: 100.0 * share, published: None });
    }
    let sign = response.quantity().sign();
    let name = format!("Share of the sum of squares of {sign},");
    let title = format!("Contributions to {}", response.quantity().words());
    Ok(RankedBars { title, quantity: Quantity::new(&name, r"\eta^2", "%"), bars, references: Vec::new() })
}

pub(super) fn pareto(params: &Params, sources: &Sources) -> Result<RankedBars, StageError> {
    let source = sources.first()?;
    if source.0.is(Anova::KIND) {
        return shares(params, source);
    }
    let response = one_response(params)?;
    let found = effects(params, sources)?;
    let bar = |i: usize| Bar {
        factor: Quantity::new(&found.names[i], "", ""),
        group: String::new(),
        value: found.values[i].abs(),
        published: None,
    };
    let simultaneous = found.simultaneous.map(|limit| ("simultaneous margin".to_owned(), limit));
    let plain = || Quantity { unit: String::new(), ..response.quantity() };
    let quantity = if found.standardized {
        plain().worded("Standardized effect on")
    } else {
        response.quantity().worded("Absolute effect on")
    };
    Ok(RankedBars {
        title: format!("Effects on {}", response.quantity().words()),
        quantity,
        bars: (0..found.values.len()).map(bar).collect(),
        references: found.margin.into_iter().chain(simultaneous).collect(),
    })
}

/// Tests as points, the two criteria as lines with their parameters in the legend.
pub(super) fn envelope(sources: &Sources) -> Result<Xy, StageError> {
    let Envelope { parameters, tests, curves, .. } = Envelope::from_artifact(sources.first()?.0)?;
    let value = |name: &str| {
        let row = parameters.parameter.iter().position(|own| own == name);
        row.map_or(f64::NAN, |row| parameters.value[row])
    };
    let cloud = |name: String, y: Vec<f64>| {
        let line = Some(Band { x: curves.sigma_3.clone(), y, ..Band::default() });
        xy::Cloud { name, line, ..xy::Cloud::default() }
    };
    let line = format!(
        "Mohr–Coulomb: $c$ {} MPa, $\\varphi$ {}°",
        fixed(value("cohesion"), 1),
        fixed(value("friction_angle"), 1)
    );
    let curve =
        format!("Hoek–Brown: $\\sigma_{{ci}}$ {} MPa, $m_i$ {}", fixed(value("sigma_ci"), 0), fixed(value("m_i"), 1));
    let points = xy::Cloud { name: "tests".to_owned(), x: tests.sigma_3, y: tests.sigma_1, ..xy::Cloud::default() };
    Ok(Xy {
        x: Quantity::new("Confining stress", "\\sigma_3", "MPa").keyed("sigma_3"),
        y: Quantity::new("Stress at failure", "\\sigma_1", "MPa").keyed("sigma_1"),
        clouds: vec![cloud(line, curves.mohr_coulomb), cloud(curve, curves.hoek_brown)],
        measured: vec![points],
        ..Xy::default()
    })
}
