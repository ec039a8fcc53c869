//! Printed values beside computed ones: the values of a paper, the deviation, and its explanation.
//!
//! The file is a CSV with a column `response`, a column with the name of the line (`source` or `term`), the value with the
//! decimals of the print, an optional `decimals` where the print drops zeros at the end, and an optional `note` that
//! explains a printed value that differs.

use super::sheet::Sheet;
use super::{Failure, Job, StageError};
use crate::artifact::statistics::Published;

/// One printed value.
pub(super) struct Print {
    response: String,
    line: String,
    value: f64,
    /// Decimals that it was rounded to.
    decimals: usize,
    note: String,
}

/// The printed values of a job, when it has any.
pub(super) fn prints(job: &Job, line: &str, value: &str) -> Result<Option<Vec<Print>>, Failure> {
    if job.files.iter().any(|file| file.name == "published") {
        Ok(Some(parse(&job.file("published")?, line, value)?))
    } else {
        Ok(None)
    }
}

fn parse(bytes: &[u8], line: &str, value: &str) -> Result<Vec<Print>, StageError> {
    let sheet = Sheet::read(bytes).map_err(|e| StageError { message: format!("published values: {e}"), ..e })?;
    let needed = |name: &str| {
        sheet.place(name).ok_or_else(|| {
            StageError::new(format!("published values: no column `{name}`"))
                .hint(format!("the file has columns `response`, `{line}`, `{value}` and perhaps `note`"))
        })
    };
    let (response, name, print) = (needed("response")?, needed(line)?, needed(value)?);
    let (decimals, note) = (sheet.place("decimals"), sheet.place("note"));
    let one = |i: usize| {
        let cell = |at: usize| sheet.columns[at][i].clone();
        let text = cell(print);
        let wrong = |text: &str| StageError::new(format!("published values, row {}: `{text}` is no number", i + 1));
        let value: f64 = text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| wrong(&text))?;
        let decimals = match decimals.map(cell).filter(|own| !own.is_empty()) {
            Some(own) => own.parse().map_err(|_| wrong(&own))?,
            None => text.split_once('.').map_or(0, |(_, digits)| digits.len()),
        };
        let note = note.map(cell).unwrap_or_default();
        Ok(Print { response: cell(response), line: cell(name), value, decimals, note })
    };
    (0..sheet.rows()).map(one).collect()
}

/// One computed value, and how far rounding of the data may change it.
pub(super) struct Computed<'a> {
    pub response: &'a str,
    pub line: &'a str,
    pub value: Option<f64>,
    /// Standard deviation of the value under rounding of the responses; 0 when they count as exact.
    pub rounding: f64,
    /// A remark on the line.
    pub remark: &'static str,
}

/// The printed values, the deviations of the computed ones, and a remark on each.
///
/// A computed value agrees with print within half a unit of its last decimal; where the data are rounded, within that and
/// two standard deviations of the effect of rounding.
pub(super) fn beside(prints: &[Print], computed: &[Computed]) -> (Published, Vec<String>) {
    let own = |c: &Computed| prints.iter().find(|p| p.response == c.response && p.line == c.line);
    let published = computed.iter().map(|c| own(c).map_or(f64::NAN, |p| p.value)).collect();
    let off = |c: &Computed| Some(c.value? - own(c)?.value);
    let deviation = computed.iter().map(|c| off(c).unwrap_or(f64::NAN)).collect();
    let remark = |c: &Computed| match (own(c), off(c)) {
        (Some(print), Some(off)) => {
            [&judge(print, off.abs(), c.rounding), c.remark].join("; ").trim_end_matches("; ").into()
        }
        (Some(_) | None, _) => c.remark.to_owned(),
    };
    (Published { published, deviation }, computed.iter().map(remark).collect())
}

fn judge(print: &Print, off: f64, rounding: f64) -> String {
    let half_unit = format!("0.5e-{}", print.decimals).parse().unwrap_or(0.5) * (1.0 + 1e-9);
    if off <= half_unit {
        "as printed".to_owned()
    } else if off <= half_unit + 2.0 * rounding {
        "within the rounding of the printed responses".to_owned()
    } else if print.note.is_empty() {
        "differs from print".to_owned()
    } else {
        format!("differs from print: {}", print.note)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_print_is_judged_by_its_own_decimals() {
        let file = b"response,term,estimate,decimals,note\nE,a,0.3,2,\nE,b,-1.5,,sign\n";
        let prints = parse(file, "term", "estimate").unwrap();
        let computed =
            |line, value, rounding| Computed { response: "E", line, value: Some(value), rounding, remark: "" };
        let all =
            [computed("a", 0.3049, 0.0), computed("a", 0.31, 0.0), computed("a", 0.31, 0.003), computed("b", 1.5, 0.0)];
        let (found, remarks) = beside(&prints, &all);
        assert_eq!(remarks[..2], ["as printed", "differs from print"]);
        assert_eq!(remarks[2], "within the rounding of the printed responses");
        assert_eq!(remarks[3], "differs from print: sign");
        assert!((found.deviation[3] - 3.0).abs() < 1e-12);
    }

    #[test]
    fn faults_name_column_and_row() {
        let message = |text: &[u8]| parse(text, "term", "estimate").err().unwrap().message;
        assert!(message(b"response,source,f\n").contains("`term`"));
        assert!(message(b"response,term,estimate\nE,a,x\n").contains("row 1"));
    }
}
