//! Where a user's bucket is and what opens it, from where all programs for S3 look: the variables `AWS_…`, then the profile in
//! `~/.aws/credentials` and `~/.aws/config`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What the user has set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Settings {
    /// None: only what everybody may read can be read.
    pub(super) keys: Option<Keys>,
    pub(super) region: String,
    /// Address of the server; Amazon's when there is none.
    pub(super) endpoint: Option<String>,
}

#[derive(Clone, PartialEq, Eq)]
pub(super) struct Keys {
    pub(super) key: String,
    pub(super) secret: String,
    pub(super) token: Option<String>,
}

// A secret is shown to nobody.
impl std::fmt::Debug for Keys {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Keys").field("key", &self.key).finish_non_exhaustive()
    }
}

impl Settings {
    /// Those of the user of this process.
    ///
    /// # Errors
    /// They contradict themselves; in words.
    pub(super) fn of_user() -> Result<Self, String> {
        let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let file = |path: &Path| std::fs::read_to_string(path).ok();
        Self::of(variable, file)
    }

    fn of(variable: impl Fn(&str) -> Option<String>, file: impl Fn(&Path) -> Option<String>) -> Result<Self, String> {
        let home = variable("HOME").map(PathBuf::from).unwrap_or_default();
        let path = |name: &str, own: &str| variable(name).map_or_else(|| home.join(".aws").join(own), PathBuf::from);
        let named = variable("AWS_PROFILE").or_else(|| variable("AWS_DEFAULT_PROFILE"));
        let profile = named.clone().unwrap_or_else(|| "default".to_owned());
        let credentials = file(&path("AWS_SHARED_CREDENTIALS_FILE", "credentials"));
        let config = file(&path("AWS_CONFIG_FILE", "config"));
        let section = |text: &Option<String>, name: &str| text.as_deref().and_then(|text| section(text, name));
        let of_profile = [
            section(&credentials, &profile),
            section(&config, &format!("profile {profile}")),
            section(&config, &profile),
        ];
        if named.is_some() && of_profile.iter().all(Option::is_none) {
            return Err(format!("there is no profile `{profile}` in the files of AWS; see AWS_PROFILE"));
        }
        let set = |key: &str| of_profile.iter().flatten().find_map(|section| section.get(key).cloned());
        let both = |key: Option<String>, secret: Option<String>, token, at: &str| match (key, secret) {
            (Some(key), Some(secret)) => Ok(Some(Keys { key, secret, token })),
            (None, None) => Ok(None),
            _ => Err(format!("of key and secret for S3 only one is set in {at}")),
        };
        let (key, secret) = (variable("AWS_ACCESS_KEY_ID"), variable("AWS_SECRET_ACCESS_KEY"));
        let of_variables = both(key, secret, variable("AWS_SESSION_TOKEN"), "the variables AWS_…")?;
        let keys = match of_variables {
            Some(keys) => Some(keys),
            None => {
                let at = format!("the profile `{profile}`");
                both(set("aws_access_key_id"), set("aws_secret_access_key"), set("aws_session_token"), &at)?
            }
        };
        let region = variable("AWS_REGION").or_else(|| variable("AWS_DEFAULT_REGION")).or_else(|| set("region"));
        let endpoint = variable("AWS_ENDPOINT_URL_S3").or_else(|| variable("AWS_ENDPOINT_URL"));
        Ok(Self {
            keys,
            region: region.unwrap_or_else(|| "us-east-1".to_owned()),
            endpoint: endpoint.or_else(|| set("endpoint_url")),
        })
    }
}

/// A section of a file of AWS.
fn section(text: &str, name: &str) -> Option<HashMap<String, String>> {
    let mut found = None::<HashMap<String, String>>;
    let mut inside = false;
    for line in text.lines() {
        let line = line.trim();
        if let Some(head) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            inside = head.split_whitespace().collect::<Vec<_>>().join(" ") == name;
            if inside {
                found.get_or_insert_default();
            }
        } else if inside
            && !line.starts_with(['#', ';'])
            && let Some((key, value)) = line.split_once('=')
            && let Some(found) = &mut found
        {
            found.insert(key.trim().to_owned(), value.trim().to_owned());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(variables: &[(&str, &str)], credentials: &str, config: &str) -> Result<Settings, String> {
        let variable =
            |name: &str| variables.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned());
        let file = |path: &Path| match path.file_name()?.to_str()? {
            "credentials" => Some(credentials.to_owned()),
            "config" => Some(config.to_owned()),
            _ => None,
        };
        Settings::of(variable, file)
    }

    const CREDENTIALS: &str = "[default]\naws_access_key_id = AKD\naws_secret_access_key = sd/=+\n# note\n\
                               [lab]\naws_access_key_id=AKL\naws_secret_access_key=sl\naws_session_token = t\n";
    const CONFIG: &str =
        "[default]\nregion = eu-west-1\n[profile  lab]\nregion = eu-north-1\nendpoint_url = http://minio:9000\n";

    #[test]
    fn a_profile_gives_keys_region_and_server() {
        let of = settings(&[], CREDENTIALS, CONFIG).unwrap();
        let keys = of.keys.unwrap();
        assert_eq!((keys.key.as_str(), keys.secret.as_str(), keys.token), ("AKD", "sd/=+", None));
        assert_eq!((of.region.as_str(), of.endpoint), ("eu-west-1", None));
        let of = settings(&[("AWS_PROFILE", "lab")], CREDENTIALS, CONFIG).unwrap();
        assert_eq!(of.keys.unwrap().token.as_deref(), Some("t"));
        assert_eq!((of.region.as_str(), of.endpoint.as_deref()), ("eu-north-1", Some("http://minio:9000")));
    }

    #[test]
    fn variables_come_before_a_profile_and_nothing_at_all_is_nobody() {
        let variables = [("AWS_ACCESS_KEY_ID", "AKV"), ("AWS_SECRET_ACCESS_KEY", "sv"), ("AWS_REGION", "x-1")];
        let of = settings(&variables, CREDENTIALS, CONFIG).unwrap();
        assert_eq!((of.keys.clone().unwrap().key.as_str(), of.region.as_str()), ("AKV", "x-1"));
        assert!(!format!("{of:?}").contains("sv"), "a secret is not shown");
        let of = settings(&[], "", "").unwrap();
        assert_eq!((of.keys, of.region.as_str()), (None, "us-east-1"));
    }

    #[test]
    fn half_of_a_pair_and_a_profile_that_is_not_there_are_told() {
        let half = settings(&[("AWS_ACCESS_KEY_ID", "AKV")], "", "").unwrap_err();
        assert!(half.contains("only one is set in the variables"), "{half}");
        let half = settings(&[], "[default]\naws_access_key_id = A\n", "").unwrap_err();
        assert!(half.contains("only one is set in the profile `default`"), "{half}");
        let none = settings(&[("AWS_PROFILE", "labb")], CREDENTIALS, CONFIG).unwrap_err();
        assert!(none.contains("no profile `labb`"), "{none}");
    }
}
