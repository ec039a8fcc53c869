//! The address of a remote, as a person writes it.

use std::path::PathBuf;

/// The address of a remote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// A folder.
    Folder(PathBuf),
    /// A bucket, `s3://NAME/PREFIX`.
    Bucket {
        /// Its name.
        name: String,
        /// What the names of all objects in it begin with, without slashes at its ends; may be empty.
        prefix: String,
        /// Address of the server; that of the user's settings, else Amazon's, when there is none.
        endpoint: Option<String>,
    },
}

impl Address {
    /// Reads an address as a person writes it; `endpoint` is the server of a bucket.
    ///
    /// # Errors
    /// It is none; why, in words.
    pub fn parse(text: &str, endpoint: Option<&str>) -> Result<Self, String> {
        let Some((scheme, rest)) = text.split_once("://") else {
            return match endpoint {
                None => Ok(Self::Folder(PathBuf::from(text))),
                Some(_) => Err(format!("`--endpoint` has no effect with the folder {text}; write s3://BUCKET/PREFIX")),
            };
        };
        if scheme != "s3" {
            return Err(format!("`{text}` is no remote; write a folder or s3://BUCKET/PREFIX"));
        }
        let (name, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let is_name = |name: &str| {
            let fits =
                |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || matches!(byte, b'-' | b'.' | b'_');
            (1..=255).contains(&name.len()) && name.bytes().all(fits)
        };
        if !is_name(name) {
            return Err(format!("`{name}` in `{text}` is no name of a bucket; write s3://BUCKET/PREFIX"));
        }
        let prefix = prefix.trim_matches('/');
        if prefix.split('/').any(|part| part == "." || part == "..") {
            return Err(format!("`{text}` has a part `.` or `..`, which no bucket has"));
        }
        Ok(Self::Bucket { name: name.to_owned(), prefix: prefix.to_owned(), endpoint: endpoint.map(str::to_owned) })
    }
}

impl Address {
    /// The address as it is written, and its server.
    pub(in crate::store) fn parts(&self) -> (String, Option<String>) {
        let endpoint = match self {
            Self::Folder(_) => None,
            Self::Bucket { endpoint, .. } => endpoint.clone(),
        };
        // Another command may be run in another folder.
        let text = match self {
            Self::Folder(path) => std::path::absolute(path).unwrap_or_else(|_| path.clone()).display().to_string(),
            Self::Bucket { .. } => self.to_string(),
        };
        (text, endpoint)
    }
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Folder(path) => write!(f, "{}", path.display()),
            Self::Bucket { name, prefix, .. } if prefix.is_empty() => write!(f, "s3://{name}"),
            Self::Bucket { name, prefix, .. } => write!(f, "s3://{name}/{prefix}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_read_as_people_write_them() {
        let bucket = |name: &str, prefix: &str, endpoint: Option<&str>| Address::Bucket {
            name: name.to_owned(),
            prefix: prefix.to_owned(),
            endpoint: endpoint.map(str::to_owned),
        };
        assert_eq!(Address::parse("/group/results", None), Ok(Address::Folder("/group/results".into())));
        assert_eq!(Address::parse("s3://lab-1", None), Ok(bucket("lab-1", "", None)));
        let minio = Some("https://minio.uni.edu");
        assert_eq!(Address::parse("s3://lab/a/b/", minio), Ok(bucket("lab", "a/b", minio)));
        for (text, why) in [
            ("https://lab/a", "write a folder or s3://"),
            ("s3:///a", "no name of a bucket"),
            ("s3://Lab", "no name of a bucket"),
            ("s3://lab/../a", "a part `.` or `..`"),
        ] {
            assert!(Address::parse(text, None).unwrap_err().contains(why), "{text}");
        }
        assert!(Address::parse("/group", minio).unwrap_err().contains("has no effect with the folder"));
        for text in ["s3://lab/a/b", "s3://lab", "/group/results"] {
            assert_eq!(Address::parse(text, None).unwrap().to_string(), text);
        }
    }
}
