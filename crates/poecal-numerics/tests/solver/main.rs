//! The solver on problems without robots: NIST's certified regressions (StRD) and the test problems of Moré, Garbow and Hillstrom
//! (more1981, nist1999 in docs/bibliography.md), through the public trait.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod more_problems;
mod more_set;
mod more_variable;
mod nist;
mod nist_models;
mod plain;
mod reuse;
