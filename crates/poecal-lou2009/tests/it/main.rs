//! The paper's formulas, tables and claims, and the formulations beside the library's own.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod findings;
mod formula;
mod formulations;
mod jacobians;
mod paper;
#[path = "../../../poecal-fit/tests/reference/mod.rs"]
mod reference;
mod reproduce;
mod reproduction_report;
