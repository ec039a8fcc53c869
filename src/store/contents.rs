//! The files in a store, and which of them flow has written.

use super::disk::{self, Disk};
use super::folder::{Entry, Folder};
use super::{StoreError, campaign, journal, lock, memo, object, queue, root};

/// A file in the store.
pub(super) struct Place<'a> {
    /// Its folder, open.
    pub(super) at: &'a Folder,
    /// The folder below the root.
    pub(super) folder: &'a str,
    pub(super) name: &'a str,
    pub(super) entry: Entry,
}

impl Place<'_> {
    /// Whether flow has written it.
    pub(super) fn is_ours(&self) -> bool {
        let Self { at, folder, name, entry } = self;
        if !matches!(entry, Entry::File(_)) {
            return false;
        }
        let (top, shard) = folder.split_once('/').unwrap_or((folder, ""));
        match (top, shard) {
            _ if disk::is_temporary(name) => true,
            ("", "") => root::is_ours(name) || root::is_note(name),
            ("objects", shard) => object::is_shard(shard) && object::is_ours(at, shard, name),
            (memo::FOLDER, shard) => object::is_shard(shard) && memo::is_ours(at, shard, name),
            (journal::FOLDER, "") => journal::is_ours(at, name),
            (campaign::FOLDER, "") => campaign::is_ours(at, name),
            (lock::FOLDER, "") => lock::is_name(name),
            (object::ASIDE, "") => object::is_aside(name),
            (queue::FOLDER, inside) => queue::is_ours(inside, name),
            (super::remote::FOLDER, "") => super::attached::is_ours(name),
            _ => false,
        }
    }

    /// Its size, bytes.
    pub(super) fn bytes(&self) -> u64 {
        match self.entry {
            Entry::File(bytes) => bytes,
            Entry::Folder | Entry::Strange => 0,
        }
    }
}

/// Calls `visit` with every file in the folders that flow makes; other folders are not entered.
pub(super) fn walk(disk: &Disk, visit: &mut impl FnMut(Place<'_>)) -> Result<(), StoreError> {
    let fail = |error| disk.fail("list", &disk.root, error);
    enter(&disk.folder("").map_err(fail)?, "", visit).map_err(fail)
}

fn enter(at: &Folder, folder: &str, visit: &mut impl FnMut(Place<'_>)) -> std::io::Result<()> {
    let mut names = Vec::new();
    at.list(|name, _| names.push(name.to_owned()))?;
    names.sort_unstable();
    for name in names {
        let Ok(entry) = at.entry(&name) else { continue };
        if entry == Entry::Folder && root::is_folder(folder, &name) {
            let inside = if folder.is_empty() { name } else { format!("{folder}/{name}") };
            if let Ok(inner) = at.inner(inside.rsplit('/').next().unwrap_or_default()) {
                enter(&inner, &inside, visit)?;
            }
        } else {
            visit(Place { at, folder, name: &name, entry });
        }
    }
    Ok(())
}
