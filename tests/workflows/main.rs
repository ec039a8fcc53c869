//! Workflow files: good ones run, bad ones say what is wrong with them, the schema agrees, and no bytes make a reader panic.

#![allow(clippy::unwrap_used)]

mod bytes;
mod corpus;
mod files;
mod fuzz;
mod properties;
mod schema;
mod texts;
mod validator;
