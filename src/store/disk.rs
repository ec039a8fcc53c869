//! The few file operations of the store, with its rules: unique temporary name, check, rename; errors with their path.
//! Folders are named as they stand below the root: `objects/ab`, `""` for the root itself.

use super::StoreError;
use super::folder::{self, Folder};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Folder of a store on disk.
#[derive(Clone, Debug)]
pub(super) struct Disk {
    pub(super) root: PathBuf,
    /// Whether nothing is to be written: short cuts are then not stored, and damaged files stay where they are.
    pub(super) read_only: bool,
}

/// A new file under a temporary name; it is removed when dropped.
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) folder: Folder,
    pub(super) name: String,
    pub(super) file: File,
    named: bool,
}

impl Draft {
    /// Gives it its name in its folder; an error of kind `AlreadyExists` when the name is taken.
    pub(super) fn persist_new(&mut self, name: &str) -> std::io::Result<()> {
        self.folder.rename_new(&self.name, &self.folder, name)?;
        self.named = true;
        Ok(())
    }

    /// Its file, once it has a name.
    pub(super) fn into_file(self) -> std::io::Result<File> {
        self.file.try_clone()
    }

    /// When it was made, by the clock of the file system, seconds.
    pub(super) fn file_time(&self) -> Option<i64> {
        rustix::fs::fstat(&self.file).ok().map(|stat| stat.st_ctime)
    }

    fn persist(mut self, name: &str) -> std::io::Result<()> {
        self.folder.rename(&self.name, &self.folder, name)?;
        self.named = true;
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.named {
            let _ = self.folder.remove(&self.name);
        }
    }
}

impl Disk {
    /// The path of the file called `name` in a folder of the store.
    pub(super) fn path(&self, folder: &str, name: &str) -> PathBuf {
        self.root.join(folder).join(name)
    }

    /// An error of the operating system, sorted by its remedy.
    pub(super) fn fail(&self, doing: &'static str, path: &Path, source: std::io::Error) -> StoreError {
        StoreError::io(doing, path, &self.root, source)
    }

    /// A folder below the root, reached without links.
    pub(super) fn folder(&self, inside: &str) -> std::io::Result<Folder> {
        let root = Folder::at(&self.root)?;
        // A name that a user gave, such as that of a queue, leads nowhere else.
        if inside.split('/').any(|part| part == "..") {
            return Err(std::io::Error::new(ErrorKind::InvalidInput, "a name with `..` leads out of the store"));
        }
        inside.split('/').filter(|part| !part.is_empty()).try_fold(root, |folder, part| folder.inner(part))
    }

    /// Whether an error says that a file or folder is not there, though the store is. One that is only read need not be there.
    pub(super) fn lacks(&self, error: &std::io::Error) -> bool {
        error.kind() == ErrorKind::NotFound && (self.read_only || self.root.is_dir())
    }

    /// As [`Disk::folder`], but `None` when there is no such folder.
    pub(super) fn find_folder(&self, inside: &str) -> Result<Option<Folder>, StoreError> {
        match self.folder(inside) {
            Ok(folder) => Ok(Some(folder)),
            Err(error) if self.lacks(&error) => Ok(None),
            Err(error) => Err(self.fail("open the folder", &self.root.join(inside), error)),
        }
    }

    /// As [`Disk::folder`], but makes the folder when there is none; a store that has vanished is not made anew.
    pub(super) fn make_folder(&self, inside: &str) -> Result<Folder, StoreError> {
        match self.folder(inside) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            other => return other.map_err(|error| self.fail("open the folder", &self.root.join(inside), error)),
        }
        self.writable(inside)?;
        let root = Folder::at(&self.root).map_err(|error| self.fail("make the folder", &self.root, error))?;
        let inner = |folder: Folder, part| {
            folder.make(part)?;
            folder.inner(part)
        };
        let made = inside.split('/').filter(|part| !part.is_empty()).try_fold(root, inner);
        made.map_err(|error| self.fail("make the folder", &self.root.join(inside), error))
    }

    /// Writes a new file under a temporary name, reads it back, and renames it. Returns false, and leaves everything as
    /// it is, when the name is taken already.
    pub(super) fn write_new(&self, folder: &str, name: &str, bytes: &[u8], durable: bool) -> Result<bool, StoreError> {
        let path = self.path(folder, name);
        match self.written(folder, name, bytes, durable)?.persist_new(name) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return Ok(false),
            Err(error) => return Err(self.fail("rename to", &path, error)),
        }
        if durable {
            self.sync_folder(folder)?;
        }
        Ok(true)
    }

    /// As [`Disk::write_new`], but into a file that is open and has the name `draft`; the new name becomes its second.
    /// `None` when that file has lost its name or cannot get a second one: the caller writes a new file then.
    pub(super) fn link_new(
        &self,
        draft: (&Folder, &str, &mut File),
        (folder, name): (&str, &str),
        bytes: &[u8],
        durable: bool,
    ) -> Result<Option<bool>, StoreError> {
        let (at, draft, file) = draft;
        let path = self.path(folder, name);
        // The claim in the file is shorter than almost any image, and truncating a file costs more than asking for its size.
        let size = bytes.len() as u64;
        let longer = file.metadata().is_ok_and(|data| data.len() > size);
        let cut = if longer { file.set_len(0) } else { Ok(()) };
        let written = cut.and_then(|()| file.rewind()).and_then(|()| folder::write(file, bytes));
        written
            .and_then(|()| if durable { folder::sync(file) } else { Ok(()) })
            .map_err(|e| self.fail("write", &path, e))?;
        if !at.names(draft, file) {
            return Ok(None);
        }
        match self.read_back(at, draft, &path, bytes) {
            // Another node has just taken over the claim, since it looked abandoned; this one may see that only later.
            Err(StoreError::Changed { .. }) => return Ok(None),
            Err(_) if !at.names(draft, file) => return Ok(None),
            other => other?,
        }
        let to = self.make_folder(folder)?;
        match at.link(draft, &to, name) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return Ok(Some(false)),
            // A file system without links.
            Err(_) => return Ok(None),
        }
        // Between check and link the name may have become that of another file.
        let other = match self.read_back(&to, name, &path, bytes) {
            // Where files are known by their names alone, the open file, too, is that of the other node.
            Err(StoreError::Changed { .. }) => true,
            read => {
                read?;
                !to.names(name, file)
            }
        };
        if other {
            to.remove(name).map_err(|error| self.fail("remove", &path, error))?;
            return Ok(None);
        }
        if let Ok(mut permissions) = file.metadata().map(|data| data.permissions()) {
            permissions.set_readonly(true);
            let _ = file.set_permissions(permissions);
        }
        if durable {
            to.sync().map_err(|error| self.fail("sync", &path, error))?;
        }
        Ok(Some(true))
    }

    /// As [`Disk::write_new`], but replaces an older file: for memos and listings, which can be made anew, never for objects.
    pub(super) fn replace(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        self.replace_in_parts(folder, name, |parts| parts.add(bytes))
    }

    /// As [`Disk::replace`], for a file whose bytes come in parts.
    pub(super) fn replace_in_parts(
        &self,
        folder: &str,
        name: &str,
        write: impl FnOnce(&mut Parts<'_>) -> std::io::Result<()>,
    ) -> Result<(), StoreError> {
        let path = self.path(folder, name);
        let draft = self.draft(folder, 0o444)?;
        let mut parts = Parts { file: &draft.file, block: Vec::new(), hash: blake3::Hasher::new(), length: 0 };
        write(&mut parts).and_then(|()| parts.flush()).map_err(|error| self.fail("write", &path, error))?;
        let mut back = blake3::Hasher::new();
        let read = draft.folder.open(&draft.name, false).and_then(|file| back.update_reader(file).map(|_| ()));
        read.map_err(|error| self.fail("read back", &path, error))?;
        if back.finalize() != parts.hash.finalize() {
            return Err(StoreError::Changed { path, bytes: parts.length });
        }
        draft.persist(name).map_err(|error| self.fail("rename to", &path, error))
    }

    /// A new file under a temporary name; the user's umask decides who may read it.
    pub(super) fn draft(&self, folder: &str, mode: u32) -> Result<Draft, StoreError> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        self.writable(folder)?;
        let at = self.make_folder(folder)?;
        for _ in 0..100 {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let name = format!("{TEMPORARY}{:08x}{number:08x}", std::process::id() ^ seed());
            match at.create(&name, mode) {
                Ok(file) => return Ok(Draft { folder: at, name, file, named: false }),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(self.fail("create a file in", &self.root.join(folder), error)),
            }
        }
        Err(self.fail("create a file in", &self.root.join(folder), ErrorKind::AlreadyExists.into()))
    }

    /// An error where nothing is to be written.
    fn writable(&self, folder: &str) -> Result<(), StoreError> {
        let refused = || self.fail("write into", &self.root.join(folder), ErrorKind::PermissionDenied.into());
        if self.read_only { Err(refused()) } else { Ok(()) }
    }

    fn written(&self, folder: &str, name: &str, bytes: &[u8], durable: bool) -> Result<Draft, StoreError> {
        let path = self.path(folder, name);
        let draft = self.draft(folder, 0o444)?;
        let written = folder::write(&draft.file, bytes);
        written
            .and_then(|()| if durable { folder::sync(&draft.file) } else { Ok(()) })
            .map_err(|error| self.fail("write", &path, error))?;
        self.read_back(&draft.folder, &draft.name, &path, bytes)?;
        Ok(draft)
    }

    /// Reads a file that was just written and will get the name `path`; [`StoreError::Changed`] if it holds anything else.
    fn read_back(&self, folder: &Folder, written: &str, path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
        let same = folder.open(written, false).and_then(|file| holds(file, bytes));
        match same.map_err(|error| self.fail("read back", path, error))? {
            true => Ok(()),
            false => Err(StoreError::Changed { path: path.to_owned(), bytes: bytes.len() }),
        }
    }

    /// Removes a file, if it is there.
    pub(super) fn remove(&self, folder: &str, name: &str) -> Result<(), StoreError> {
        self.writable(folder)?;
        let Some(found) = self.find_folder(folder)? else { return Ok(()) };
        found.remove(name).map_err(|error| self.fail("remove", &self.path(folder, name), error))
    }

    /// Makes the names in a folder survive a power cut.
    pub(super) fn sync_folder(&self, folder: &str) -> Result<(), StoreError> {
        let synced = self.folder(folder).and_then(|found| found.sync());
        synced.map_err(|error| self.fail("sync", &self.root.join(folder), error))
    }
}

/// A number that differs between processes with equal process ids on two machines.
fn seed() -> u32 {
    use std::hash::{BuildHasher, RandomState};
    use std::sync::OnceLock;
    static SEED: OnceLock<u32> = OnceLock::new();
    *SEED.get_or_init(|| RandomState::new().hash_one(0) as u32)
}

/// Whether a file holds exactly these bytes.
fn holds(mut file: File, mut bytes: &[u8]) -> std::io::Result<bool> {
    let mut block = vec![0; (bytes.len() + 1).min(1 << 16)];
    loop {
        match file.read(&mut block) {
            Ok(0) => return Ok(bytes.is_empty()),
            Ok(count) => match bytes.strip_prefix(&block[..count]) {
                Some(rest) => bytes = rest,
                None => return Ok(false),
            },
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Bytes that are gathered before they are written.
const BLOCK: usize = 1 << 16;

/// A file that is being written in parts.
pub(super) struct Parts<'a> {
    file: &'a File,
    block: Vec<u8>,
    hash: blake3::Hasher,
    length: usize,
}

impl Parts<'_> {
    /// Adds bytes.
    pub(super) fn add(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        if self.block.len() + bytes.len() > BLOCK {
            self.flush()?;
        }
        if bytes.len() > BLOCK {
            return self.put(bytes);
        }
        self.block.extend_from_slice(bytes);
        Ok(())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        if self.block.is_empty() {
            return Ok(());
        }
        let mut block = std::mem::take(&mut self.block);
        self.put(&block)?;
        block.clear();
        self.block = block;
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        folder::write(self.file, bytes)?;
        self.hash.update(bytes);
        self.length += bytes.len();
        Ok(())
    }
}

/// Prefix of temporary names; gc removes the files that a killed process leaves behind.
const TEMPORARY: &str = ".flow-writing-";

/// Whether a name is one that [`Disk::draft`] gives.
pub(super) fn is_temporary(name: &str) -> bool {
    name.strip_prefix(TEMPORARY).is_some_and(|rest| rest.len() == 16 && rest.bytes().all(|b| b.is_ascii_hexdigit()))
}
