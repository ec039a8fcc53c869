//! The report: one HTML page that holds a campaign, complete in itself.
//!
//! [`gather`] reads what the page shows from the store (every object is checked before it is opened, nothing is
//! computed); [`page`] writes it. Between them is a [`Paper`], plain data, so the page is a pure function: the same
//! workflow and store give the same bytes. Times are those of the records.
//!
//! * [`gather`](mod@gather): workflow and store → [`Paper`]
//! * `page`: head, masthead, contents; `summary`, `provenance`: the first sections; `stage`: a section per stage
//! * `compared`: computed beside published values, judged by their scatter; `tally`: what is counted at the top
//! * `table`, `figure`: what sections are made of; `svg` lets only harmless pictures in, `values` gives their numbers
//! * `calibrator`: parameters to responses and back, for someone who has no `flow`; also a page of its own
//! * `warning`, `symbol`, `time`: warnings; symbols as HTML; times in words
//! * `page.css`, `base.js`, `page.js`: style and script; the page reads, links and prints without the script
//!
//! Nothing that comes from a workflow or a store becomes markup: texts are escaped by `maud`, pictures pass through
//! `svg`, numbers for the script are JSON in which `<` cannot occur, and the page forbids itself every script, style,
//! picture and address that is not its own.

mod calibrator;
mod compared;
mod dag;
mod figure;
mod gather;
mod page;
mod paper;
mod provenance;
mod stage;
mod summary;
mod svg;
mod symbol;
mod table;
mod tally;
mod time;
mod values;
mod warning;

pub use gather::{Asked, gather};
pub use page::{calibrator_page, page};
pub use paper::{Cost, Outcome, Paper, Part, State, quoted};
pub use time::{duration, moment};

#[cfg(test)]
mod tests;
