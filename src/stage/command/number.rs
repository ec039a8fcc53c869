//! Numbers as programs write them.
//!
//! Besides the usual forms: Fortran's exponent letters (`1.0D+03`, `1.0d3`, `1.0Q2`), its exponents of three digits without
//! a letter (`0.123-100`), fields too narrow for their number (`*****`), and the words of compilers for "not a number"
//! (`NaN`, `-nan(ind)`, `1.#QNAN`). Decimal commas and thousands separators are refused because they are ambiguous.

use crate::unit::vanishes;

/// The value of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    /// A finite number.
    Finite(f64),
    /// A missing value, written as not-a-number.
    Missing,
}

/// Reads one number.
///
/// # Errors
/// Why the text is not a number, in words that follow the text.
pub(super) fn number(text: &str) -> Result<Number, String> {
    let text = text.trim();
    if is_nan(text) {
        return Ok(Number::Missing);
    }
    if !text.is_empty() && text.bytes().all(|byte| byte == b'*') {
        return Err(
            "is no number: the program's field is too narrow for it; write it wider or in scientific form".into()
        );
    }
    let value = text.parse().ok().or_else(|| fortran(text)?.parse().ok());
    match value {
        Some(value) if vanishes(text, value) => Err("is too small for a number of the machine: it would be 0".into()),
        Some(value) if f64::is_finite(value) => Ok(Number::Finite(value)),
        Some(_) => Err("is not a finite number".into()),
        None if text.contains(',') => Err("is not a number; decimals stand behind a point".into()),
        None => Err("is not a number".into()),
    }
}

/// `NaN` in the words of C, Fortran and the Microsoft libraries, with or without a sign.
fn is_nan(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    let bare = word.split_once('(').map_or(word.as_str(), |(bare, _)| bare);
    matches!(bare, "nan" | "nanq" | "nans" | "1.#qnan" | "1.#snan" | "1.#ind")
}

/// A number in Fortran's forms with the exponent letter that is usual elsewhere.
fn fortran(text: &str) -> Option<String> {
    if let Some(letter) = text.find(['d', 'D', 'q', 'Q']) {
        let (mantissa, exponent) = text.split_at(letter);
        return Some(format!("{mantissa}e{}", &exponent[1..]));
    }
    // The sign of an exponent without a letter stands behind a digit or a point; that of the number stands first.
    let sign = text.char_indices().skip(1).find(|(_, c)| matches!(c, '+' | '-'))?.0;
    let (mantissa, exponent) = text.split_at(sign);
    let plain = |c: char| c.is_ascii_digit() || c == '.';
    (mantissa.contains('.') && mantissa.ends_with(plain) && exponent.len() == 4)
        .then(|| format!("{mantissa}e{exponent}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_of_c_and_of_fortran_are_read() {
        let forms = [
            ("35.5", 35.5),
            ("+3", 3.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("1E-3", 1e-3),
            ("1.0D+03", 1000.0),
            ("-2.5d-1", -0.25),
            ("1.25Q2", 125.0),
            ("0.123-100", 0.123e-100),
            ("-0.4+102", -0.4e102),
        ];
        for (text, value) in forms {
            assert_eq!(number(text), Ok(Number::Finite(value)), "{text}");
        }
    }

    #[test]
    fn words_for_no_number_are_missing_values() {
        for text in ["NaN", "nan", "-nan", "nan(ind)", "-nan(ind)", "1.#QNAN", "-1.#IND", " NaN "] {
            assert_eq!(number(text), Ok(Number::Missing), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_why() {
        assert!(number("******").unwrap_err().contains("too narrow"));
        assert!(number("Infinity").unwrap_err().contains("finite"));
        assert!(number("1e999").unwrap_err().contains("finite"));
        assert!(number("3,5").unwrap_err().contains("point"));
        // A range, a date, a name and a sum are none.
        for text in ["", "many", "1-2", "12-2024", "2024-01-02", "Dd", "1D", "1+1", "--1"] {
            assert!(number(text).unwrap_err().contains("is not a number"), "{text}");
        }
    }
}
