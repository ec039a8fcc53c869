//! The spelling that was meant by one that is not known: `Mpa`, `cm3`, `24,5 MPa`.

use super::{PREFIXES, SYMBOLS, symbol_unit};

/// Words that people write for a symbol.
const WORDS: [(&str, &str); 8] = [
    ("sec", "s"),
    ("hr", "h"),
    ("hours", "h"),
    ("day", "d"),
    ("days", "d"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("percent", "%"),
];

/// The known symbol with its power that this one, which is not known, was probably meant for: digits at its end are a power,
/// and small letters may stand for large ones. A prefix that makes a unit larger goes before one that makes it smaller.
pub(super) fn meant(symbol: &str) -> Option<String> {
    let letters = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    let power = &symbol[letters.len()..];
    let written = |symbol: &str| if power.is_empty() { symbol.to_owned() } else { format!("{symbol}^{power}") };
    if letters.is_empty() {
        return None;
    }
    if symbol_unit(letters).is_some() {
        return (!power.is_empty()).then(|| written(letters));
    }
    let same = |known: &str| known.to_lowercase() == letters.to_lowercase();
    let plain = SYMBOLS.iter().map(|known| known.0.to_owned());
    let with =
        |prefix: &'static str| SYMBOLS.iter().filter(|known| known.3).map(move |known| format!("{prefix}{}", known.0));
    let all = plain.chain(PREFIXES.iter().flat_map(|(prefix, _)| with(prefix)));
    let word = || WORDS.iter().find(|(word, _)| same(word)).map(|(_, symbol)| (*symbol).to_owned());
    all.into_iter().find(|known| same(known)).or_else(word).map(|known| written(&known))
}

/// A number with a decimal comma as it is written here; `None` for a text that begins otherwise, and for one with more signs
/// than one, which may be separators of thousands.
pub(super) fn without_comma(text: &str) -> Option<String> {
    let (whole, rest) = text.split_once(',')?;
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let is_whole = whole.strip_prefix(['-', '+']).unwrap_or(whole).bytes().all(|b| b.is_ascii_digit());
    let one = is_whole && !whole.is_empty() && digits > 0 && !rest[digits..].starts_with([',', '.']);
    one.then(|| format!("{whole}.{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spelling_that_was_meant_is_found() {
        let cases = [("GPA", "GPa"), ("Mpa", "MPa"), ("mpa", "MPa"), ("KN", "kN"), ("cm3", "cm^3"), ("mm2", "mm^2")];
        for (written, wanted) in cases.into_iter().chain([("sec", "s"), ("hz", "Hz"), ("Percent", "%")]) {
            assert_eq!(meant(written).as_deref(), Some(wanted), "{written}");
        }
        for strange in ["psi", "ell", "MPaa", "3", "MPa"] {
            assert_eq!(meant(strange), None, "{strange}");
        }
    }

    #[test]
    fn a_decimal_comma_becomes_a_point_where_it_can_be_nothing_else() {
        assert_eq!(without_comma("24,5 MPa").as_deref(), Some("24.5 MPa"));
        assert_eq!(without_comma("-0,25").as_deref(), Some("-0.25"));
        for other in ["1,234.5 MPa", "1,234,567", "a,5", ",5", "5, 6", "5"] {
            assert_eq!(without_comma(other), None, "{other}");
        }
    }
}
