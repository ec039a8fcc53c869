//! `flow store`: list, verify, sizes, removal and sharing of results.

mod share;

use super::common::{Campaign, Common, decided, system};
use super::{Exit, examples};
use crate::artifact::Key;
use crate::report::duration;
use crate::stage::command::leftover;
use crate::store::{Amount, Store};
use clap::{Args, Subcommand};
use std::collections::HashSet;
use std::path::PathBuf;

/// Manage the store.
#[derive(Args)]
pub(super) struct StoreCommand {
    #[command(flatten)]
    common: Common,
    #[command(subcommand)]
    command: What,
}

#[derive(Subcommand)]
enum What {
    /// List the results: task, size, duration.
    #[command(after_help = examples::STORE_LS)]
    Ls,
    /// Turn the folder of an earlier flow, which has no file `flow.store`, into a store.
    #[command(after_help = examples::STORE_ADOPT)]
    Adopt,
    /// Read every result and compare it with its record; set aside what is damaged.
    #[command(after_help = examples::STORE_VERIFY)]
    Verify,
    /// Sizes.
    #[command(after_help = examples::STORE_DU)]
    Du,
    /// Remove results that none of the named workflows can reach; without --yes it only lists them.
    #[command(after_help = examples::STORE_GC)]
    Gc(Gc),
    /// Copy all results to a remote, a folder or a bucket that others can read, and sign the list of them.
    #[command(after_help = examples::STORE_PUSH)]
    Push(share::Push),
    /// Take results of people whom you trust from a remote; each result is proven first.
    #[command(after_help = examples::STORE_PULL)]
    Pull(share::Pull),
    /// Read what this store lacks from a remote, each result when it is first needed; once, until it is detached.
    #[command(after_help = examples::STORE_ATTACH)]
    Attach(share::Attach),
    /// Read nothing more from the attached remote.
    #[command(after_help = examples::STORE_DETACH)]
    Detach,
    /// Copy a remote to another one, with its signatures.
    #[command(after_help = examples::STORE_MIRROR)]
    Mirror(share::Mirror),
    /// Compute some results of a workflow again and compare: equal bits prove them.
    #[command(after_help = examples::STORE_AUDIT)]
    Audit(share::Audit),
}

#[derive(Args)]
struct Gc {
    /// Workflows whose results stay. `FILE` alone means the file as it stands and all its profiles.
    #[arg(required = true)]
    workflows: Vec<PathBuf>,
    /// Really remove.
    #[arg(long)]
    yes: bool,
}

impl StoreCommand {
    pub(super) fn go(self) -> Exit {
        let done = match &self.command {
            What::Ls => self.list(),
            What::Adopt => self.adopt(),
            What::Verify => self.verify(),
            What::Du => self.usage(),
            What::Gc(gc) => self.collect(gc),
            What::Push(push) => push.go(&self.common),
            What::Pull(pull) => pull.go(&self.common),
            What::Attach(attach) => attach.go(&self.common),
            What::Detach => self.detach(),
            What::Mirror(mirror) => mirror.go(),
            What::Audit(audit) => audit.go(&self.common),
        };
        done.unwrap_or_else(|exit| exit)
    }

    /// The store, which must exist: a mistyped name would otherwise give an empty store without faults.
    fn open(&self) -> Result<Store, Exit> {
        let folder = &self.common.store;
        if !folder.exists() {
            err!("error: there is no store at {}; name its folder with `--store`", folder.display());
            return Err(Exit::System);
        }
        self.common.open()
    }

    fn list(&self) -> Result<Exit, Exit> {
        let store = self.open()?;
        let mut records = store.records().map_err(|e| system(&e))?;
        records.sort_by_key(|record| (record.started, record.key));
        for record in records {
            let text = store.task_text(&record).unwrap_or_default();
            let work = text.lines().nth(1).and_then(|line| line.strip_prefix("work ")).unwrap_or("unreadable");
            let (took, size) = (duration(record.seconds), bytes(record.bytes()));
            out!(
                "{:.16}  {work:16} {took:>8} {size:>9}  {}",
                record.content.to_string(),
                store.path(&record.object()).display()
            );
        }
        Ok(Exit::Done)
    }

    fn detach(&self) -> Result<Exit, Exit> {
        let there = self.common.open()?.detach().map_err(|error| system(&error))?;
        out!("{}", if there { "detached; what was fetched stays" } else { "no remote was attached" });
        Ok(Exit::Done)
    }

    fn adopt(&self) -> Result<Exit, Exit> {
        Store::adopt(&self.common.store).map_err(|e| system(&e))?;
        out!("{} is a store now; its results are proven when they are first used", self.common.store.display());
        Ok(Exit::Done)
    }

    fn verify(&self) -> Result<Exit, Exit> {
        let verdict = self.open()?.verify().map_err(|e| system(&e))?;
        out!("{} results are sound ({})", verdict.sound.files, bytes(verdict.sound.bytes));
        for damage in &verdict.damages {
            out!("damaged: {damage}");
        }
        for key in &verdict.missing {
            out!("missing: the result of task {key}; the next run computes it again");
        }
        for key in &verdict.adopted {
            out!("adopted: the result of task {key} had no record");
        }
        for (key, first, second) in &verdict.contradictions {
            out!(
                "contradiction: task {key} gave {first} and {second}; it depends on something outside its key, or one is \
                 forged: neither is believed, and the next run computes it again"
            );
        }
        if verdict.lost_records > 0 {
            out!("{} records of the journal cannot be read; their results were adopted again", verdict.lost_records);
        }
        if !verdict.proven.is_empty() {
            out!(
                "{} results were recorded by others; their task texts and values prove them to be what their names say, \
                 not that the values are right",
                verdict.proven.len()
            );
        }
        if verdict.not_own > 0 {
            out!(
                "{} memos and records of runs were not written by you, or changed since; they are not used",
                verdict.not_own
            );
        }
        for path in &verdict.strangers {
            out!("not written by flow, not touched: {}", path.display());
        }
        Ok(if verdict.is_sound() { Exit::Done } else { Exit::System })
    }

    fn usage(&self) -> Result<Exit, Exit> {
        let usage = self.open()?.usage().map_err(|e| system(&e))?;
        let rows: [(&str, Amount); 6] = [
            ("results", usage.objects),
            ("journal", usage.journal),
            ("memos", usage.memos),
            ("records of runs", usage.runs),
            ("damaged, set aside", usage.aside),
            ("leftovers", usage.temporary),
        ];
        for (name, amount) in rows {
            out!("{name:20} {:>7} files {:>10}", amount.files, bytes(amount.bytes));
        }
        Ok(Exit::Done)
    }

    fn collect(&self, gc: &Gc) -> Result<Exit, Exit> {
        let store = self.open()?;
        let mut reachable = HashSet::new();
        for path in &gc.workflows {
            reach(path, &self.common, &store, &mut reachable)?;
        }
        if gc.yes {
            leftover::sweep().iter().for_each(|line| err!("{line}"));
        } else if let found @ 1.. = leftover::count() {
            err!("would end what {found} runs of programs left whose campaign was killed, and remove their folders");
        }
        let swept = store.sweep(&reachable, gc.yes).map_err(|e| system(&e))?;
        let verb = if gc.yes { "removed" } else { "would remove" };
        let (removed, memos, rubbish) = (swept.removed, swept.memos, swept.rubbish);
        out!("{verb} {} results ({}) that no named workflow reaches", removed.files, bytes(removed.bytes));
        out!("{verb} {} memos ({}) that rest on other results", memos.files, bytes(memos.bytes));
        out!("{verb} {} damaged or left-over files ({})", rubbish.files, bytes(rubbish.bytes));
        out!("{} results remain ({})", swept.kept.files, bytes(swept.kept.bytes));
        if !gc.yes {
            out!("nothing was removed; --yes removes them");
        }
        Ok(Exit::Done)
    }
}

/// Adds all that a workflow can reach, as it stands and with each of its profiles.
fn reach(path: &std::path::Path, common: &Common, store: &Store, keys: &mut HashSet<Key>) -> Result<(), Exit> {
    let campaign = |profile| Campaign::of(path.to_owned(), profile, common);
    let plain = campaign(None).load(&[])?;
    let profiles = plain.profiles.iter().cloned().map(Some);
    for profile in std::iter::once(None).chain(profiles) {
        let workflow = campaign(profile).load(&[])?;
        if let Some(absent) = workflow.absent.first() {
            let why = &absent.message;
            err!("error: {}: {why}\n  what rests on it would count as not needed; nothing was removed", path.display());
            return Err(Exit::Failed);
        }
        let report = decided(&workflow, store, &[], false)?;
        keys.extend(report.objects().map(|object| object.key));
    }
    Ok(())
}

/// A size in bytes, in words.
pub(super) fn bytes(n: u64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB"];
    let (mut value, mut unit) = (n as f64, 0);
    while value >= 999.5 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    if unit == 0 || value >= 99.5 {
        format!("{value:.0} {}", units[unit])
    } else {
        format!("{value:.1} {}", units[unit])
    }
}
