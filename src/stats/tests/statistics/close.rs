//! Responses with almost all digits in common, against exact rational numbers.

use super::{digits, number, numbers, reference};
use stats::anova::{Settings, anova};
use stats::error::Fault;
use stats::regression::{self, regress};
use stats::sample::{Factor, Response, Sample};
use stats::terms::Term;

/// The cells as a table of level, index and response, `copies` times.
fn table(cells: &[Vec<f64>], copies: usize) -> Sample {
    let mut columns = [vec![], vec![], vec![]];
    for (level, cell) in cells.iter().enumerate() {
        for (index, &value) in cell.iter().enumerate() {
            for (column, entry) in columns.iter_mut().zip([level as f64, index as f64, value]) {
                column.extend(std::iter::repeat_n(entry, copies));
            }
        }
    }
    let [level, index, y] = columns;
    Sample {
        factors: vec![Factor::new("level", level), Factor::new("index", index)],
        responses: vec![Response::new("y", y)],
        weights: None,
    }
}

fn terms() -> Vec<Term> {
    ["const", "level", "index"].map(|term| Term::parse(term).unwrap()).to_vec()
}

#[test]
fn squares_about_the_mean_do_not_depend_on_the_mean() {
    for set in reference("close.toml")["set"].as_array().unwrap() {
        let lead = number(&set["lead"]);
        let cells: Vec<Vec<f64>> = set["cells"].as_array().unwrap().iter().map(numbers).collect();
        let mut sample = table(&cells, 1);
        let fitted = regress(&sample, "y", &terms(), &regression::Settings::default()).unwrap();
        let close = |found: f64, wanted: f64, what: &str| {
            assert!(digits(found, wanted) > 14.0, "lead {lead}, {what}: {found} for {wanted}");
        };
        for (index, slope) in numbers(&set["slopes"]).into_iter().enumerate() {
            close(fitted.natural[index + 1].estimate, slope, "slope");
        }
        close(fitted.fit.f.unwrap(), number(&set["f_model"]), "F of the model");
        close(fitted.fit.s.unwrap() * fitted.fit.s.unwrap() * 9.0, number(&set["left"]), "residual squares");
        sample.factors.truncate(1);
        let lines = &anova(&sample, &Settings::default()).unwrap()[0].lines;
        let squares = numbers(&set["ss"]);
        close(lines[0].ss, squares[0], "SS of the factor");
        close(lines[1].ss, squares[1], "SS of the residual");
        close(lines[0].f.unwrap(), number(&set["f"]), "F of the factor");
    }
}

/// Beyond the size up to which everything is computed in 31 digits.
#[test]
fn a_large_table_has_the_same_coefficients_and_squares() {
    let set = &reference("close.toml")["set"][0];
    let cells: Vec<Vec<f64>> = set["cells"].as_array().unwrap().iter().map(numbers).collect();
    let copies = 20_000;
    let fitted = regress(&table(&cells, copies), "y", &terms(), &regression::Settings::default()).unwrap();
    for (index, slope) in numbers(&set["slopes"]).into_iter().enumerate() {
        assert!(digits(fitted.natural[index + 1].estimate, slope) > 14.0);
    }
    let squares = fitted.fit.s.unwrap() * fitted.fit.s.unwrap() * fitted.fit.df_residual as f64;
    assert!(digits(squares, copies as f64 * number(&set["left"])) > 13.0, "{squares}");
}

#[test]
fn what_is_left_of_the_digits_is_said_where_nothing_is_left() {
    let lead = 1e16;
    let cells = [vec![lead, lead + 2.0, lead + 4.0], vec![lead + 4.0, lead, lead + 2.0]];
    let faults = anova(&table(&cells, 1), &Settings::default()).unwrap_err();
    assert!(faults.0.iter().any(|fault| matches!(fault, Fault::DigitsLost { .. })), "{faults}");
    let message = faults.to_string();
    assert!(message.contains("of the size 1e16 that differ by at most 4: 15.4 of the 16 digits"), "{message}");
    assert!(regress(&table(&cells, 1), "y", &terms(), &regression::Settings::default()).is_err());
}
