//! A server that answers what a test has written down. Servers that others wrote are met by `tests/cli/bucket.rs`.

use super::*;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::sync::mpsc::{Receiver, channel};

/// The bucket of a server that gives these answers (status, body), one connection each; and the requests as they come.
fn server(answers: &[(u16, &str)]) -> (Bucket, Receiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let (requests, inbox) = channel();
    let answers: Vec<(u16, String)> = answers.iter().map(|(status, body)| (*status, (*body).to_owned())).collect();
    std::thread::spawn(move || {
        for (status, body) in answers {
            let (mut stream, _) = listener.accept().unwrap();
            let mut reader = BufReader::new(stream.try_clone().unwrap());
            let (mut request, mut length) = (String::new(), 0);
            while !request.ends_with("\r\n\r\n") {
                let from = request.len();
                reader.read_line(&mut request).unwrap();
                let line = request[from..].to_ascii_lowercase();
                if let Some(value) = line.strip_prefix("content-length:") {
                    length = value.trim().parse().unwrap();
                }
            }
            std::io::copy(&mut reader.by_ref().take(length), &mut std::io::sink()).unwrap();
            let _ = requests.send(request);
            let head = format!("HTTP/1.1 {status} X\r\ncontent-length: {}\r\nconnection: close\r\n\r\n", body.len());
            stream.write_all((head + &body).as_bytes()).unwrap();
        }
    });
    let address = Address::parse("s3://lab/group 1", Some(&url)).unwrap();
    let bucket = rusty_s3::Bucket::new(url.parse().unwrap(), UrlStyle::Path, "lab", "us-east-1").unwrap();
    let credentials = Some(Credentials::new("KEY", "secret"));
    (Bucket { address, prefix: "group 1".to_owned(), bucket, credentials, agent: agent() }, inbox)
}

#[test]
fn a_file_is_asked_for_by_a_signed_address_and_again_when_the_server_falters() {
    let (bucket, requests) = server(&[(503, ""), (200, "bytes")]);
    assert_eq!(bucket.read("objects/ab", "x.h5", 5).unwrap().as_deref(), Some(b"bytes".as_slice()));
    let requests: Vec<String> = requests.iter().collect();
    assert_eq!(requests.len(), 2);
    assert!(
        requests[1].starts_with("GET /lab/group%201/objects/ab/x.h5?X-Amz-Algorithm=AWS4-HMAC-SHA256"),
        "{requests:?}"
    );
    assert!(!requests[1].contains("secret"));
    let (bucket, _) = server(&[(404, "")]);
    assert_eq!(bucket.read("", "x", 5).unwrap(), None);
}

#[test]
fn what_is_longer_than_recorded_is_not_read() {
    let (bucket, _) = server(&[(200, "bytes!"), (200, "bytes")]);
    assert_eq!(bucket.read("", "x", 5).unwrap().as_deref(), Some(b"".as_slice()));
    assert_eq!(bucket.read("", "x", 5).unwrap().as_deref(), Some(b"bytes".as_slice()));
}

#[test]
fn a_file_is_written_once_also_where_the_condition_is_not_known() {
    let (bucket, requests) = server(&[(200, ""), (412, ""), (501, ""), (200, "")]);
    assert!(bucket.write("", "x", b"bytes").unwrap());
    assert!(!bucket.write("", "x", b"bytes").unwrap());
    assert!(bucket.write("", "x", b"bytes").unwrap());
    let conditional: Vec<bool> = requests.iter().map(|request| request.contains("if-none-match: *")).collect();
    assert_eq!(conditional, [true, true, true, false]);
}

#[test]
fn a_refusal_is_told_in_the_servers_words_with_what_to_do() {
    let body =
        "<?xml version=\"1.0\"?><Error><Code>SignatureDoesNotMatch</Code><Message>Not yours.\n</Message></Error>";
    let (bucket, _) = server(&[(403, body)]);
    let error = bucket.list().unwrap_err().to_string();
    assert!(
        error.contains("s3://lab/group 1: the server says 403 SignatureDoesNotMatch: Not yours.; see that"),
        "{error}"
    );
    let (mut bucket, _) = server(&[(403, "")]);
    bucket.credentials = None;
    assert!(bucket.list().unwrap_err().to_string().contains("set AWS_ACCESS_KEY_ID"));
    let (bucket, _) = server(&[(200, "<html>"), (301, "")]);
    assert!(bucket.list().unwrap_err().to_string().contains("does it speak S3?"));
    assert!(bucket.list().unwrap_err().to_string().contains("set AWS_REGION"));
}

#[test]
fn a_list_is_read_page_by_page() {
    let page = |keys: &[&str], next: &str| {
        let file = |key: &&str| {
            format!(
                "<Contents><Key>{key}</Key><LastModified>2026-01-01T00:00:00.000Z</LastModified><ETag>e</ETag>\
                 <Size>1</Size><StorageClass>STANDARD</StorageClass></Contents>"
            )
        };
        format!(
            "<ListBucketResult xmlns=\"http://s3.amazonaws.com/doc/2006-03-01/\"><Name>lab</Name><Prefix></Prefix>\
             <KeyCount>1</KeyCount><MaxKeys>1000</MaxKeys><IsTruncated>{}</IsTruncated>{}{next}</ListBucketResult>",
            !next.is_empty(),
            keys.iter().map(file).collect::<String>()
        )
    };
    let first = page(
        &["group 1/segments/a.sig", "group 1/segments/b.sig"],
        "<NextContinuationToken>t+1</NextContinuationToken>",
    );
    let (bucket, requests) = server(&[(200, &first), (200, &page(&["group 1/segments/c.sig"], ""))]);
    assert_eq!(bucket.list().unwrap(), ["a.sig", "b.sig", "c.sig"]);
    let requests: Vec<String> = requests.iter().collect();
    assert!(requests[0].contains("prefix=group%201%2Fsegments%2F") && requests[1].contains("continuation-token=t%2B1"));
}
