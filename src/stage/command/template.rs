//! Templates: `{{name}}` is replaced by a value of the run.

use crate::stage::StageError;

/// A stretch of a template.
enum Part<'t> {
    /// Text that is copied.
    Text(&'t str),
    /// The name between double braces, and its line.
    Name(&'t str, usize),
}

/// The parts of a template in order.
fn parts(text: &str) -> Result<Vec<Part<'_>>, String> {
    let mut parts = Vec::new();
    let (mut rest, mut line) = (text, 1);
    while let Some((before, after)) = rest.split_once("{{") {
        line += before.matches('\n').count();
        let unclosed = || format!("line {line}: `{{{{` without `}}}}` in the same line");
        let (name, behind) = after.split_once("}}").ok_or_else(unclosed)?;
        if name.contains('\n') {
            return Err(unclosed());
        }
        parts.extend([Part::Text(before), Part::Name(name.trim(), line)]);
        rest = behind;
    }
    parts.push(Part::Text(rest));
    Ok(parts)
}

/// The error about the first unknown name; its hint lists the known ones.
pub(super) fn fault(text: &str, known: impl Fn() -> Vec<String>) -> Option<StageError> {
    let parts = match parts(text) {
        Ok(parts) => parts,
        Err(why) => return Some(StageError::new(why)),
    };
    let names = known();
    parts.into_iter().find_map(|part| match part {
        Part::Name(name, line) if !names.iter().any(|known| known == name) => Some(unknown(name, line, &names)),
        Part::Name(..) | Part::Text(_) => None,
    })
}

fn unknown(name: &str, line: usize, known: &[String]) -> StageError {
    StageError::new(format!("line {line}: `{name}` is not a value of this run"))
        .hint(format!("known are {}", known.join(", ")))
}

/// The template with its names replaced.
///
/// # Errors
/// A name has no value.
pub(super) fn filled(text: &str, value: impl Fn(&str) -> Option<String>) -> Result<String, StageError> {
    let mut out = String::with_capacity(text.len());
    for part in parts(text).map_err(StageError::new)? {
        match part {
            Part::Text(text) => out.push_str(text),
            Part::Name(name, line) => out.push_str(&value(name).ok_or_else(|| unknown(name, line, &[]))?),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_replaced_and_unknown_ones_told_with_their_line() {
        let value = |name: &str| (name == "Ec").then(|| "16".to_owned());
        assert_eq!(filled("a {{ Ec }}\n{b} {{Ec}}", value).unwrap(), "a 16\n{b} 16");
        let told = |text: &str| {
            fault(text, || vec!["Ec".to_owned(), "seed".to_owned()]).map(|error| (error.message, error.hint))
        };
        assert_eq!(told("{{Ec}} {{seed}}"), None);
        let hint = Some("known are Ec, seed".to_owned());
        assert_eq!(told("{{Ec}}\n\n{{row}}"), Some(("line 3: `row` is not a value of this run".to_owned(), hint)));
        assert_eq!(told("x\n{{Ec").unwrap().0, "line 2: `{{` without `}}` in the same line");
        assert_eq!(told("{{Ec\n}}").unwrap().0, "line 1: `{{` without `}}` in the same line");
        assert!(filled("{{row}}", value).is_err());
    }
}
