//! Behaviour of this crate, tested from outside: one program, since linking it once takes less than linking one for each subject.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod basin;
mod events;
mod fast_path;
mod few_rows;
mod forensics;
mod gauge;
mod identifiability;
mod iso9283;
mod mistakes;
mod mistakes_of_places;
mod moves;
mod noise_free;
mod oracle;
mod promises;
#[allow(dead_code)]
#[path = "../../../poecal-fit/tests/reference/mod.rs"]
mod reference;
mod small_sessions;
mod starts;
mod stations;
mod statistics;
mod suspicion;
mod uncertainty;
mod verdict;
mod where_it_holds;
