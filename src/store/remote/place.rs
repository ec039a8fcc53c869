//! Where a remote is: a folder, or a bucket of a server that speaks S3.

use super::bucket::Bucket;
use super::folder::RemoteFolder;
use super::{RemoteError, Trust};
use crate::store::object::ObjectId;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

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

pub(super) const SEGMENTS: &str = "segments";
pub(super) const MARKER: &str = "flow.remote";
pub(super) const TEXT: &str = "flow remote 1\nflow keeps pushed results in this folder and made this file with it.\n";

/// What is asked of a remote. Nothing in it is ever replaced.
pub(super) trait Remote: Send + Sync {
    /// Names of all files in `segments/`.
    fn list(&self) -> Result<Vec<String>, RemoteError>;
    /// A file of at most `most` bytes; none when there is none, an empty one when it is larger or no plain file.
    fn read(&self, folder: &str, name: &str, most: u64) -> Result<Option<Vec<u8>>, RemoteError>;
    /// Writes a file; whether none of this name was there.
    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<bool, RemoteError>;
    /// How many files may be on their way at once.
    fn at_once(&self) -> usize;
}

/// A remote that was found or made.
pub(in crate::store) struct Place {
    pub(in crate::store) address: Address,
    remote: Box<dyn Remote>,
    /// Names of its segments, in order.
    pub(in crate::store) segments: Vec<String>,
    /// Those of them that are signed.
    signed: HashSet<String>,
}

impl Place {
    /// The remote at an address, with what it lists.
    pub(in crate::store) fn open(address: &Address) -> Result<Self, RemoteError> {
        let place = Self::known(address)?.listed()?;
        // What lists segments is a remote; only an empty bucket has to say so.
        if place.is_unmarked()? {
            let why = "nothing was pushed to it; `flow store push` makes a remote".to_owned();
            return Err(RemoteError::NotARemote { path: address.to_string(), why });
        }
        Ok(place)
    }

    /// The same, made when there is nothing yet.
    pub(super) fn make(address: &Address) -> Result<Self, RemoteError> {
        if let Address::Folder(path) = address {
            return Self::of(address, RemoteFolder::make(path)?).listed();
        }
        let place = Self::known(address)?.listed()?;
        if place.is_unmarked()? {
            place.remote.write("", MARKER, TEXT.as_bytes())?;
        }
        Ok(place)
    }

    /// The same, without what it lists: a server is asked for nothing.
    pub(in crate::store) fn known(address: &Address) -> Result<Self, RemoteError> {
        match address {
            Address::Folder(path) => Ok(Self::of(address, RemoteFolder::open(path)?)),
            Address::Bucket { .. } => Ok(Self::of(address, Bucket::of(address)?)),
        }
    }

    fn of(address: &Address, remote: impl Remote + 'static) -> Self {
        let (segments, signed) = (Vec::new(), HashSet::new());
        Self { address: address.clone(), remote: Box::new(remote), segments, signed }
    }

    fn listed(mut self) -> Result<Self, RemoteError> {
        for name in self.remote.list()? {
            match name.rsplit_once('.') {
                Some((hash, "segment")) if is_hash(hash) => self.segments.push(hash.to_owned()),
                Some((hash, "sig")) => drop(self.signed.insert(hash.to_owned())),
                _ => {}
            }
        }
        self.segments.sort_unstable();
        Ok(self)
    }

    /// Whether it is a bucket without segments and without the file that says what it is.
    fn is_unmarked(&self) -> Result<bool, RemoteError> {
        if !matches!(self.address, Address::Bucket { .. }) || !self.segments.is_empty() {
            return Ok(false);
        }
        match self.remote.read("", MARKER, 1 << 12)? {
            None => Ok(true),
            Some(text) if text.starts_with(b"flow remote 1\n") => Ok(false),
            Some(_) => {
                let why = "a newer flow made it".to_owned();
                Err(RemoteError::NotARemote { path: self.address.to_string(), why })
            }
        }
    }

    /// Who has signed a segment (its name, its bytes, the number of its results), or why it is refused.
    pub(in crate::store) fn signer(
        &self,
        (name, bytes, results): (&str, &[u8], usize),
        trust: &Trust,
    ) -> Result<Result<String, String>, RemoteError> {
        let signer = trust.signer(bytes, self.signature(name)?.as_deref());
        Ok(signer.map_err(|why| format!("segment {name:.12} ({results} results): {why}")))
    }

    pub(super) fn segment(&self, name: &str) -> Result<Vec<u8>, RemoteError> {
        Ok(self.remote.read(SEGMENTS, &format!("{name}.segment"), MOST_SEGMENT)?.unwrap_or_default())
    }

    pub(super) fn put_segment(&self, name: &str, bytes: &[u8]) -> Result<(), RemoteError> {
        self.remote.write(SEGMENTS, &format!("{name}.segment"), bytes).map(|_| ())
    }

    pub(super) fn signature(&self, name: &str) -> Result<Option<Vec<u8>>, RemoteError> {
        if !self.signed.contains(name) {
            return Ok(None);
        }
        self.remote.read(SEGMENTS, &format!("{name}.sig"), MOST_SIGNATURE)
    }

    pub(super) fn put_signature(&self, name: &str, bytes: &[u8]) -> Result<(), RemoteError> {
        self.remote.write(SEGMENTS, &format!("{name}.sig"), bytes).map(|_| ())
    }

    /// An object of this size; none when there is none, an empty one when it is larger or no plain file.
    pub(super) fn object(&self, id: &ObjectId, size: u64) -> Result<Option<Vec<u8>>, RemoteError> {
        self.remote.read(&id.folder(), &id.file_name(), size)
    }

    /// Writes an object; whether it was not there.
    pub(super) fn put_object(&self, id: &ObjectId, bytes: &[u8]) -> Result<bool, RemoteError> {
        self.remote.write(&id.folder(), &id.file_name(), bytes)
    }

    /// Whether asking it takes long.
    pub(super) fn is_far(&self) -> bool {
        self.remote.at_once() > 1
    }

    /// Does something for each of these, several at once where the remote is far; results in the order of the items.
    ///
    /// # Errors
    /// The first error that was met; nothing more is begun after it.
    pub(super) fn each<T: Sync, R: Send, E: Send>(
        &self,
        items: &[T],
        does: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E> {
        let threads = self.remote.at_once().min(items.len());
        if threads <= 1 {
            return items.iter().map(does).collect();
        }
        let (next, ends) = (AtomicUsize::new(0), AtomicBool::new(false));
        let work = || {
            let mut done = Vec::new();
            while !ends.load(Ordering::Relaxed) {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(index) else { break };
                let result = does(item);
                ends.fetch_or(result.is_err(), Ordering::Relaxed);
                done.push((index, result));
            }
            done
        };
        let mut done: Vec<(usize, Result<R, E>)> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            let joined = threads.into_iter().map(|thread| thread.join());
            joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
        });
        done.sort_unstable_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, result)| result).collect()
    }
}

/// The largest segment that is read: one of ten million records.
const MOST_SEGMENT: u64 = 1 << 31;
/// The largest signature that is read.
const MOST_SIGNATURE: u64 = 1 << 16;

/// Whether a name is the digits of a blake3.
fn is_hash(name: &str) -> bool {
    name.len() == 64 && crate::store::object::is_hex(name)
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
