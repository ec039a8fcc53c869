//! The faults of a workflow while it is checked.

use super::fault::Fault;
use super::node::{Entry, Node, Sources, Step, Table, Value};

/// Most faults that are reported; the search ends soon after them.
pub(super) const MOST_FAULTS: usize = 50;

/// Longest name of a stage, factor, response or material.
const LONGEST_NAME: usize = 64;

/// What such a name is like.
pub(super) const NAME_PATTERN: &str = "^[A-Za-z][A-Za-z0-9_-]{0,63}$";

/// Collects faults.
pub(super) struct Check<'a> {
    /// For the locations of faults.
    pub(super) sources: &'a Sources,
    /// The faults so far.
    pub(super) faults: Vec<Fault>,
    /// Section and name of factors, responses and materials that could not be read.
    pub(super) lost: Vec<(&'static str, String)>,
}

impl Check<'_> {
    /// The table of tables below `key`.
    pub(super) fn tables<'t>(&mut self, root: &'t mut Table, key: &str) -> Option<&'t mut Table> {
        let node = &mut root.0.get_mut(key)?.node;
        let (span, found) = (node.span, node.describe());
        if let Value::Table(table) = &mut node.value {
            return Some(table);
        }
        let message = format!("wanted tables such as [{key}.NAME], found {found}");
        self.faults.push(Fault::new(message).at(self.sources.location(span)));
        None
    }

    /// Names stand in file names, on the command line and in figures.
    pub(super) fn name(&mut self, section: &str, name: &str, entry: &Entry) {
        let inner = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let begins = name.starts_with(|c: char| c.is_ascii_alphabetic());
        if begins && name.chars().all(inner) && name.len() <= LONGEST_NAME {
            return;
        }
        let fault = Fault::new(format!("`{}` cannot be a name", super::node::shortened(name)));
        let mut hint = format!("a letter first, then letters, digits, `_` and `-`, at most {LONGEST_NAME} in all");
        if section == "factor" || section == "response" {
            hint += "; a column of a file gets such a name by `rename` of its `data` stage";
        }
        self.faults.push(fault.at(self.sources.location(entry.key)).hint(hint));
    }

    /// Adds a fault at `path` below `node`, or at the nearest value that the file has. A fault that two stages find is added once.
    pub(super) fn complain(&mut self, node: &Node, path: &[Step], fault: Fault) {
        let fault = fault.at(self.sources.location(node.nearest(path).span));
        if !self.faults.contains(&fault) {
            self.faults.push(fault);
        }
    }
}

/// A path below a table, as names.
pub(super) fn steps<'p>(path: impl IntoIterator<Item = &'p str>) -> Vec<Step> {
    path.into_iter().map(|part| Step::Key(part.to_owned())).collect()
}
