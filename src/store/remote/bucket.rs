//! A remote in a bucket of a server that speaks S3: Amazon S3, MinIO, Ceph, a server of a computing centre.
//!
//! A file is written once: `If-None-Match: *` makes the server refuse a second one of the same name. What a server sends is
//! read within bounds and believed no more than a file of a folder. Requests are tried again when the server or the network
//! falters, and each is signed by the clock of this machine, which nothing else depends on.

use super::RemoteError;
use super::access::{Remote, SEGMENTS};
use super::address::Address;
use super::credentials::Settings;
use rusty_s3::actions::ListObjectsV2;
use rusty_s3::{Credentials, S3Action, UrlStyle};
use std::time::Duration;
use ureq::tls::{RootCerts, TlsConfig};

/// Pauses before a request is tried again, seconds.
const PAUSES: [f64; 4] = [0.2, 1.0, 3.0, 8.0];
/// How long a signature holds.
const SIGNED_FOR: Duration = Duration::from_secs(900);
/// A server that says nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(60);
/// Requests that are under way at once.
const AT_ONCE: usize = 16;
/// The largest answer that is no file: a page of a list has a thousand names of at most a kilobyte.
const MOST_ANSWER: u64 = 1 << 23;

pub(super) struct Bucket {
    address: Address,
    prefix: String,
    bucket: rusty_s3::Bucket,
    credentials: Option<Credentials>,
    agent: ureq::Agent,
}

/// What a server has answered.
struct Answer {
    status: u16,
    /// The body; none when it is longer than the bound.
    body: Option<Vec<u8>>,
}

impl Bucket {
    /// The bucket at an address, with the settings of the user; nothing is asked yet.
    pub(super) fn of(address: &Address) -> Result<Self, RemoteError> {
        let Address::Bucket { name, prefix, endpoint } = address else { panic!("BUG: a folder is no bucket") };
        let wrong = |why: String| RemoteError::Server { remote: address.to_string(), why };
        let settings = Settings::of_user().map_err(wrong)?;
        let own = endpoint.clone().or(settings.endpoint);
        let amazon = format!("https://s3.{}.amazonaws.com", settings.region);
        // A name with a dot is not covered by the certificate of Amazon's servers.
        let style = if own.is_some() || name.contains('.') { UrlStyle::Path } else { UrlStyle::VirtualHost };
        let server = own.unwrap_or(amazon);
        let no_server =
            |why: String| wrong(format!("`{server}` is no address of a server ({why}); write https://HOST"));
        let url = server.parse().map_err(|error| no_server(format!("{error}")))?;
        let bucket = rusty_s3::Bucket::new(url, style, name.clone(), settings.region);
        let bucket = bucket.map_err(|error| no_server(error.to_string()))?;
        let credentials = settings.keys.map(|keys| match keys.token {
            Some(token) => Credentials::new_with_token(keys.key, keys.secret, token),
            None => Credentials::new(keys.key, keys.secret),
        });
        Ok(Self { address: address.clone(), prefix: prefix.clone(), bucket, credentials, agent: agent() })
    }

    fn key(&self, folder: &str, name: &str) -> String {
        let parts = [self.prefix.as_str(), folder, name];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/")
    }

    fn fail(&self, why: String) -> RemoteError {
        RemoteError::Server { remote: self.address.to_string(), why }
    }

    /// Sends a request until there is an answer.
    fn ask(
        &self,
        most: u64,
        send: impl Fn() -> Result<ureq::http::Response<ureq::Body>, ureq::Error>,
    ) -> Result<Answer, RemoteError> {
        let mut pauses = PAUSES.iter();
        loop {
            let why = match send().and_then(|response| read(response, most)) {
                Ok(answer) if !is_passing(answer.status) => return Ok(answer),
                Ok(answer) => words(&answer),
                Err(error) => match error {
                    ureq::Error::HostNotFound
                    | ureq::Error::BadUri(_)
                    | ureq::Error::Tls(_)
                    | ureq::Error::Rustls(_) => {
                        return Err(self.fail(error.to_string()));
                    }
                    error => format!("the server cannot be reached ({error})"),
                },
            };
            let Some(pause) = pauses.next() else {
                return Err(self.fail(format!("{why}; it was tried {} times", PAUSES.len() + 1)));
            };
            std::thread::sleep(Duration::from_secs_f64(*pause));
        }
    }

    /// An answer that says what cannot be done.
    fn refused(&self, answer: &Answer) -> RemoteError {
        let hint = match answer.status {
            401 | 403 if self.credentials.is_none() => {
                "; no credentials were found: set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_PROFILE"
            }
            401 | 403 => "; see that the credentials are those of this server and that they allow it",
            301 | 307 | 308 => "; set AWS_REGION to the region of the bucket",
            _ => "",
        };
        self.fail(format!("{}{hint}", words(answer)))
    }

    /// Writes a file; `once` refuses when there is one of this name.
    fn put(&self, key: &str, bytes: &[u8], once: bool) -> Result<Answer, RemoteError> {
        self.ask(MOST_ANSWER, || {
            let mut action = self.bucket.put_object(self.credentials.as_ref(), key);
            let mut request;
            if once {
                action.headers_mut().insert("if-none-match", "*");
                request = self.agent.put(action.sign(SIGNED_FOR).as_str());
                request = request.header("if-none-match", "*");
            } else {
                request = self.agent.put(action.sign(SIGNED_FOR).as_str());
            }
            request.content_type("application/octet-stream").send(bytes)
        })
    }
}

impl Remote for Bucket {
    fn list(&self) -> Result<Vec<String>, RemoteError> {
        let (prefix, mut names, mut token) = (self.key(SEGMENTS, "") + "/", Vec::new(), None::<String>);
        loop {
            let answer = self.ask(MOST_ANSWER, || {
                let mut action = self.bucket.list_objects_v2(self.credentials.as_ref());
                action.with_prefix(prefix.clone());
                if let Some(token) = &token {
                    action.with_continuation_token(token.clone());
                }
                self.agent.get(action.sign(SIGNED_FOR).as_str()).call()
            })?;
            if answer.status != 200 {
                return Err(self.refused(&answer));
            }
            let text = String::from_utf8(answer.body.unwrap_or_default());
            let page = text.ok().and_then(|text| ListObjectsV2::parse_response(&text).ok());
            let page =
                page.ok_or_else(|| self.fail("its list of files cannot be read; does it speak S3?".to_owned()))?;
            names.extend(page.contents.iter().filter_map(|file| Some(file.key.strip_prefix(&prefix)?.to_owned())));
            // A server that gives the same page for ever lists nothing new.
            match page.next_continuation_token.filter(|next| token.as_ref() != Some(next)) {
                Some(next) => token = Some(next),
                None => return Ok(names),
            }
        }
    }

    fn read(&self, folder: &str, name: &str, most: u64) -> Result<Option<Vec<u8>>, RemoteError> {
        let key = self.key(folder, name);
        let answer = self.ask(most, || {
            let action = self.bucket.get_object(self.credentials.as_ref(), &key);
            self.agent.get(action.sign(SIGNED_FOR).as_str()).call()
        })?;
        match answer.status {
            200 => Ok(Some(answer.body.unwrap_or_default())),
            404 => Ok(None),
            _ => Err(self.refused(&answer)),
        }
    }

    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<bool, RemoteError> {
        let key = self.key(folder, name);
        let mut answer = self.put(&key, bytes, true)?;
        if answer.status == 501 {
            // The server does not know the condition; a name is given to one content only, so the same is written again.
            answer = self.put(&key, bytes, false)?;
        }
        match answer.status {
            200 | 201 | 204 => Ok(true),
            412 => Ok(false),
            _ => Err(self.refused(&answer)),
        }
    }

    fn at_once(&self) -> usize {
        AT_ONCE
    }
}

fn agent() -> ureq::Agent {
    // The certificates of the system, so that those of a university's own authority count.
    let tls = TlsConfig::builder().root_certs(RootCerts::PlatformVerifier).build();
    let config = ureq::Agent::config_builder()
        .tls_config(tls)
        .http_status_as_error(false)
        .max_redirects(0)
        .user_agent(concat!("flow/", env!("CARGO_PKG_VERSION")))
        .max_idle_connections(AT_ONCE)
        .max_idle_connections_per_host(AT_ONCE)
        .timeout_connect(Some(Duration::from_secs(15)))
        .timeout_recv_response(Some(PATIENCE))
        .timeout_per_read(Some(PATIENCE))
        .timeout_per_write(Some(PATIENCE));
    config.build().into()
}

fn read(mut response: ureq::http::Response<ureq::Body>, most: u64) -> Result<Answer, ureq::Error> {
    let status = response.status().as_u16();
    // What a server complains of may be longer than the file that was asked for.
    let most = if status == 200 { most } else { MOST_ANSWER };
    // One byte more than the bound tells a file of this size from a longer one.
    match response.body_mut().with_config().limit(most + 1).read_to_vec() {
        Ok(body) => Ok(Answer { status, body: (body.len() as u64 <= most).then_some(body) }),
        Err(ureq::Error::BodyExceedsLimit(_)) => Ok(Answer { status, body: None }),
        Err(error) => Err(error),
    }
}

/// Whether a status may be another one in a moment.
fn is_passing(status: u16) -> bool {
    matches!(status, 409 | 429 | 500 | 502 | 503 | 504)
}

/// A refusal in the server's own words.
fn words(answer: &Answer) -> String {
    let body = String::from_utf8_lossy(answer.body.as_deref().unwrap_or_default()).into_owned();
    let part = |name: &str| {
        let (_, rest) = body.split_once(&format!("<{name}>"))?;
        let (text, _) = rest.split_once(&format!("</{name}>"))?;
        Some(text.chars().filter(|c| !c.is_control()).take(200).collect::<String>())
    };
    match (part("Code"), part("Message")) {
        (Some(code), Some(message)) => format!("the server says {} {code}: {message}", answer.status),
        (Some(code), None) => format!("the server says {} {code}", answer.status),
        _ => format!("the server says {}", answer.status),
    }
}

#[cfg(test)]
mod tests;
