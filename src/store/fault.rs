//! Faults of the disk, for the tests of the store: every operation calls this module first.
//!
//! A test plans which operation fails and how ([`plan`]); outside of the tests nothing fails here.

use std::io;

/// Operations that can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// A file or folder is opened or listed.
    Open,
    /// A file or folder is made.
    Make,
    /// A name is given, changed or removed.
    Name,
}

#[cfg(not(test))]
mod disk {
    use super::{Step, io};

    #[inline(always)]
    pub(in crate::store) fn meet(_: Step) -> io::Result<()> {
        Ok(())
    }

    #[inline(always)]
    pub(in crate::store) fn write(bytes: &[u8], write: impl FnOnce(&[u8]) -> io::Result<()>) -> io::Result<()> {
        write(bytes)
    }

    #[inline(always)]
    pub(in crate::store) fn sync(sync: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        sync()
    }
}

pub(super) use disk::*;

#[cfg(test)]
mod disk {
    use super::{Step, io};
    use std::cell::RefCell;

    /// How an operation fails.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(in crate::store) enum Fault {
        /// An operation fails with this error number.
        Error(i32),
        /// Half of the bytes are written, then the write fails.
        Short,
        /// Half of the bytes are written, and the write says that all are.
        Lie,
    }

    #[derive(Default)]
    struct Plan {
        fault: Option<Fault>,
        /// Operations that still succeed before it.
        left: usize,
        /// Whether every later operation fails too, as on a full disk.
        stays: bool,
        met: usize,
    }

    thread_local! {
        static PLAN: RefCell<Plan> = RefCell::default();
    }

    /// The operation after `left` others meets `fault`, and so do all later ones when it `stays`. Of this thread only.
    pub(in crate::store) fn plan(fault: Option<Fault>, left: usize, stays: bool) {
        PLAN.set(Plan { fault, left, stays, met: 0 });
    }

    /// Operations that met the fault since it was planned.
    pub(in crate::store) fn met() -> usize {
        PLAN.with_borrow(|plan| plan.met)
    }

    /// The fault that the next operation meets; `fits` says which it can meet at all.
    fn next(fits: impl Fn(Fault) -> bool) -> Option<Fault> {
        PLAN.with_borrow_mut(|plan| {
            let fault = plan.fault.filter(|fault| fits(*fault))?;
            if plan.left > 0 {
                plan.left -= 1;
                return None;
            }
            plan.met += 1;
            if !plan.stays {
                plan.fault = None;
            }
            Some(fault)
        })
    }

    pub(in crate::store) fn meet(_: Step) -> io::Result<()> {
        match next(|fault| matches!(fault, Fault::Error(_))) {
            Some(Fault::Error(number)) => Err(io::Error::from_raw_os_error(number)),
            _ => Ok(()),
        }
    }

    pub(in crate::store) fn write(bytes: &[u8], write: impl FnOnce(&[u8]) -> io::Result<()>) -> io::Result<()> {
        match next(|_| true) {
            Some(Fault::Error(number)) => Err(io::Error::from_raw_os_error(number)),
            Some(Fault::Short) => {
                write(&bytes[..bytes.len() / 2])?;
                Err(io::ErrorKind::StorageFull.into())
            }
            Some(Fault::Lie) => write(&bytes[..bytes.len() / 2]),
            None => write(bytes),
        }
    }

    pub(in crate::store) fn sync(sync: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        meet(Step::Open)?;
        sync()
    }
}
