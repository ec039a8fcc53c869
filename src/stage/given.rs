//! Checks of responses before anything runs: `check` refuses a response that none of the named stages can give.

use super::{Complaint, Context, Named};

/// Complaints about responses at `path` that no stage among `stages` gives. The responses of a data file, or of a stage that
/// passes on the results of others, are not known before the run and are not checked.
pub(super) fn check_given<'a>(
    context: &Context,
    path: &str,
    stages: &[&'a String],
    responses: impl IntoIterator<Item = &'a String>,
) -> Vec<Complaint> {
    let known = |&name: &&'a String| Some((name, context.sketches.get(name)?.responses.as_ref()?));
    let Some(givers) = stages.iter().map(known).collect::<Option<Vec<_>>>().filter(|givers| !givers.is_empty()) else {
        return Vec::new();
    };
    let lacks = |response: &&String| givers.iter().all(|(_, given)| !given.contains(response));
    let complaint = |response: &String| {
        let whose = givers.iter().map(|(stage, _)| format!("`{stage}`")).collect::<Vec<_>>().join(" or ");
        let gives = givers.iter().map(|(stage, given)| match given.is_empty() {
            true => format!("`{stage}` gives no response"),
            false => format!("`{stage}` gives {}", given.join(", ")),
        });
        Complaint::new(path, format!("`{response}` is no response of {whose}"))
            .missing(Named::Response, response)
            .among(givers.iter().flat_map(|(_, given)| given.iter()))
            .hint(gives.collect::<Vec<_>>().join("; "))
    };
    // Another check reports a response that the workflow does not declare.
    let declared = |response: &&String| context.responses.contains_key(*response);
    responses.into_iter().filter(declared).filter(lacks).map(complaint).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::{Response, Sketch};

    #[test]
    fn a_response_that_no_stage_gives_is_refused_where_it_is_known_what_they_give() {
        let mut context = Context::default();
        for name in ["UCS", "E", "sigma_t"] {
            context.responses.insert(name.to_owned(), Response::default());
        }
        let gives = |responses: &[&str]| Sketch {
            responses: Some(responses.iter().map(|&name| name.to_owned()).collect()),
            ..Sketch::default()
        };
        context.sketches.insert("split".to_owned(), gives(&["sigma_t"]));
        context.sketches.insert("press".to_owned(), gives(&["UCS", "E"]));
        context.sketches.insert("file".to_owned(), Sketch::default());
        let said = |stages: &[&str], response: &str| -> Vec<(String, String)> {
            let stages: Vec<String> = stages.iter().map(|&name| name.to_owned()).collect();
            let stages: Vec<&String> = stages.iter().collect();
            let found = check_given(&context, "responses", &stages, [&response.to_owned()]);
            found.into_iter().map(|own| (own.message, own.hint.unwrap_or_default())).collect()
        };
        let (message, hint) = ("`E` is no response of `split`".to_owned(), "`split` gives sigma_t".to_owned());
        assert_eq!(said(&["split"], "E"), [(message, hint)]);
        assert_eq!(said(&["split", "press"], "E"), []);
        assert_eq!(said(&["split", "file"], "E"), [], "a file may give anything");
        assert_eq!(said(&["split"], "q"), [], "one that is not declared is said elsewhere");
        assert_eq!(said(&[], "E"), []);
    }
}
