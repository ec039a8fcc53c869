//! `flow` runs a numerical-experiment campaign with bonded-particle models that is written down as one TOML file.
//!
//! # Layers
//! A module may import another one only along the arrows. The domains and [`math`] are crates of their own
//! below `src/`, so Cargo holds them to it; `tests/layers.rs` holds the modules of this crate to it.
//!
//! ```text
//! cli → { report, export }; report → run → { cluster, exec, plan, store }
//! cluster → { plan, store, stage }
//! export → stage
//! { run, plan } → stage → { dem, design, stats, optim, shape, figure } → math
//! { run, plan, stage, store } → artifact
//! { plan, stage } → expression → unit
//! { plan, stage, artifact } → unit
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`cli`] | what a person types and reads; the only place that prints |
//! | [`export`] | results as files: CSV, pictures, ParaView, lists of particles |
//! | [`report`] | a campaign as one HTML page |
//! | [`run`] | the run loop, and the only state that changes during a run |
//! | [`cluster`] | workers on other machines: lists, reports, site files, schedulers |
//! | [`exec`] | threads that take work; knows neither tasks nor physics |
//! | [`plan`] | TOML text → checked workflow; tasks → texts and keys; reasons of reruns |
//! | [`store`] | the folder of results: HDF5, journals, locks |
//! | [`stage`] | one file per kind of stage: where domains meet workflows and artifacts |
//! | [`mod@artifact`] | what can be stored, as plain data with a content hash |
//! | [`dem`] | the discrete-element engine, specimens and tests |
//! | [`shape`] | solids of stones, and the clumps of balls that stand for them |
//! | [`design`], [`stats`], [`optim`], [`figure`] | designs of experiments, statistics, optimisers, pictures |
//! | [`math`], [`mod@unit`], [`expression`] | random streams, elementary functions, distributions; quantities with units, formulas of them |
//!
//! The domains (`dem`, `design`, `stats`, `optim`, `shape`, `figure`) are pure and know nothing of one another, of files or of TOML.
//!
//! # The life of `flow run`
//! 1. `plan` reads the file: each table becomes the config type of its kind; all faults are found at once.
//! 2. `run` asks each stage whose inputs are known for its next step: tasks, which may need other tasks.
//! 3. The text of a task whose inputs are known is hashed to its key. The task runs unless the store has a result for the key.
//! 4. A worker computes the artifact; the store writes it under the hash of its values and records key → object.
//! 5. Keys use the content of inputs, so an equal result reruns nothing that follows; equal tasks of two stages run once.
//!
//! # What is written down, and what it is called
//! | word | what it is | where |
//! |---|---|---|
//! | artifact | the result of one task: tables, arrays, texts | [`mod@artifact`] |
//! | object | an artifact as a file of the store, named by its content | [`store`] |
//! | record | one line of a journal: task → object, digest, size, time, machine | [`store`] |
//! | journal | a file of records, one per process that writes; lines are only added | [`store`] |
//! | memo | a short cut: the result of an unchanged stage, or the runs of a stage; may be lost | [`store::Memo`] |
//! | summary | of a run: failure, validity and responses, all that a table of runs needs | [`stage::cached`] |
//! | campaign record | what one `flow run` did: stages, times, settings, versions; `flow diff` reads it as `#N` | [`store::Campaign`] |
//! | report | of a worker: its messages, one line each; of a campaign: the HTML page | [`cluster`], [`report`] |
//! | note | a sentence on an analysis that a reader must not miss; the table `notes` of statistics | [`mod@artifact`] |
//! | warning | of `flow check` or of a running task: no fault, but to be known before a result is trusted | [`plan`], [`cli`] |
//!
//! Types named `Params` are the parameters of the tasks of one kind, in SI units, private to the file of the kind. Types
//! named `Settings` are the settings of one method, and are called by their module (`genetic::Settings`). A config type has
//! the name of its kind (`specimen::Specimen`), as a figure has that of what it shows (`figure::specimen::Specimen`).
//!
//! # What may never happen
//! * Two results for one task text. Nothing in a result comes from a clock, a host, a thread, an order of completion or a
//!   locale. Sums keep their order; elementary functions are those of [`math`].
//! * A result that depends on what else lies in the store, or on anything but the task text, its inputs and its files.
//! * A file of the store that is changed or replaced. Files are written under another name, checked, and renamed; only
//!   `flow store gc` deletes.
//! * An object that is decoded before its size and digest were compared with its record.
//! * A number that passes from a file, a command line or an artifact into a computation without its unit.
//! * A domain crate that reads a file, prints, asks for the time or draws a random number without a seed it was given.
//! * Printing anywhere but in [`cli`].
//! * An external program that a workflow does not name.
//! * Lost rows, failed runs or unmet targets that are not reported beside the numbers.
//! * A panic on anything that a person, a file or a disk supplies. `panic!("BUG: …")` marks a broken invariant of ours.

pub mod artifact;
pub mod cli;
pub mod cluster;
pub mod exec;
pub mod export;
pub mod expression;
pub mod plan;
pub mod report;
pub mod run;
pub mod stage;
pub mod store;
pub mod unit;
