//! Contacts: the list that the hot loop runs over, and what a caller sees of one.

mod section;
mod sweep;
mod view;

pub(crate) use section::{Key, LawKind, Rank, Reader, Section, Writer};
pub(crate) use sweep::{Break, Face, Second, Sweep, sweep_section};
pub use view::{Contact, Other};
