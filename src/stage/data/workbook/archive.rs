//! The zip archives that new workbooks are: judged before anything of them is believed.
//!
//! A file of some kilobytes may unpack to gigabytes, and a part may say how many texts it holds and hold none. So every part
//! is unpacked once to nowhere, and counted, and what a part says of its size is compared with what it has.

use super::super::super::StageError;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::{BufRead, BufReader, Cursor, Read};
use zip::ZipArchive;

/// Most bytes that all parts of a workbook may unpack to.
const MOST_BYTES: u64 = 1 << 28;

/// Most parts of a workbook.
const MOST_PARTS: usize = 10_000;

/// A workbook whose parts were unpacked once and found to be of a size that can be read.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// The name of every part and the bytes that it unpacks to.
    parts: Vec<(String, u64)>,
}

/// What is wrong with a workbook that cannot be read.
pub(super) fn broken(why: impl std::fmt::Display) -> StageError {
    StageError::new(format!("the workbook cannot be read: {why}"))
        .hint("save it again with the spreadsheet program, or save the sheet as CSV")
}

fn too_large(what: String) -> StageError {
    StageError::new(what).hint("a table of measured values is far smaller; save the sheet as CSV")
}

impl<'a> Archive<'a> {
    /// Opens an archive and unpacks every part to nowhere.
    ///
    /// # Errors
    /// It is damaged, unpacks to more than is read, or a part says that it holds more than it does.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, StageError> {
        let mut archive = Self { zip: ZipArchive::new(Cursor::new(bytes)).map_err(broken)?, parts: Vec::new() };
        if archive.zip.len() > MOST_PARTS {
            let parts = archive.zip.len();
            return Err(too_large(format!("the workbook has {parts} parts, and at most {MOST_PARTS} are read")));
        }
        let mut left = MOST_BYTES;
        for index in 0..archive.zip.len() {
            let part = archive.zip.by_index(index).map_err(broken)?;
            let name = part.name().map_err(broken)?.into_owned();
            let count = std::io::copy(&mut part.take(left + 1), &mut std::io::sink()).map_err(broken)?;
            left = left.checked_sub(count).ok_or_else(|| {
                let most = MOST_BYTES >> 20;
                too_large(format!("the workbook of {} bytes unpacks to more than {most} MiB", bytes.len()))
            })?;
            archive.parts.push((name, count));
        }
        archive.check_texts()?;
        Ok(archive)
    }

    /// The reader of a part; `None` when there is no such part.
    ///
    /// # Errors
    /// The part is damaged.
    pub(super) fn part<'b>(&'b mut self, name: &str) -> Result<Option<impl BufRead + use<'a, 'b>>, StageError> {
        match self.zip.by_name(name) {
            Ok(part) => Ok(Some(BufReader::new(part))),
            Err(zip::result::ZipError::FileNotFound) => Ok(None),
            Err(e) => Err(broken(e)),
        }
    }

    /// The number of texts that `sharedStrings.xml` announces: room is made for so many before one is read.
    fn check_texts(&mut self) -> Result<(), StageError> {
        let is_texts = |(name, _): &&(String, u64)| name.to_ascii_lowercase().ends_with("sharedstrings.xml");
        let texts: Vec<(String, u64)> = self.parts.iter().filter(is_texts).cloned().collect();
        for (name, bytes) in texts {
            let said = self.part(&name)?.and_then(announced).unwrap_or(0);
            // `<si/>` is the shortest text.
            if said > bytes / 5 {
                return Err(broken(format!("{name} says that it holds {said} texts, and has {bytes} bytes")));
            }
        }
        Ok(())
    }
}

/// The largest number of texts that any opening of the list announces.
fn announced(part: impl BufRead) -> Option<u64> {
    let mut reader = Reader::from_reader(part);
    let mut buffer = Vec::new();
    let mut most = None;
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(e) | Event::Empty(e)) if e.local_name().as_ref() == "sst" => {
                most = most.max(attribute(&e, "uniqueCount").and_then(|count| count.parse().ok()));
            }
            Ok(Event::Eof) | Err(_) => return most,
            Ok(_) => (),
        }
    }
}

/// The value of an attribute.
pub(super) fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let found = element.try_get_attribute(name).ok().flatten()?;
    found.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok().map(|value| value.into_owned())
}
