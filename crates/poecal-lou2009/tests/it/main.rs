//! The paper's formulas, tables and claims, and the formulations beside the library's own.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

// Each crate uses what it needs of it.
#[allow(dead_code)]
#[path = "../../../poecal/tests/files/mod.rs"]
mod files;
mod findings;
mod formula;
mod formulations;
mod jacobians;
#[path = "../../../poecal/tests/largest/mod.rs"]
mod largest;
mod paper;
#[path = "../../../poecal/tests/reference/mod.rs"]
mod reference;
mod reproduce;
mod reproduction_report;
