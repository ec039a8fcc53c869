//! The binary in a temporary folder: write a file, run a command, read what it says.

#![allow(clippy::unwrap_used)]

mod bucket;
mod calibrate;
mod calibrator;
mod cases;
mod cluster;
mod columns;
mod command;
mod engines;
mod export;
mod faults;
mod forecast;
mod guide;
mod hostile;
mod joints;
mod kill;
mod laboratory;
mod nodes;
mod reading;
mod readme;
mod reads;
mod report;
mod reruns;
mod resume;
mod scales;
mod share;
mod space;
mod stop;
mod trust;
mod unread;
mod validity;
mod verdicts;
mod vocabulary;
