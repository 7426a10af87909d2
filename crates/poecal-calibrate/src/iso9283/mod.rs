//! Pose and distance characteristics of a robot after ISO 9283:1998, each with a 95 % interval (theory.md §9, *ISO 9283*).
//!
//! `rows.rs` sorts rows into cells: a pose, by one arm, from one approach, in one series. `faults.rs` names rows that are missing, exchanged or
//! doubled. `frame.rs` has the barycentres in the base frame, `spread.rs` the scatter about them, `intervals.rs` the distributions of both,
//! `figures.rs` the figures, a row each, and `cluster.rs` the positions about each command. No files here, and no robots: commanded poses are given.

mod cluster;
mod faults;
mod figure;
mod figures;
mod frame;
mod intervals;
mod rows;
mod spread;

pub use cluster::PoseCluster;
pub use figure::{FigureBounds, FigureLimit, FigureName, JudgedFigure, TestFigure};
pub use figures::{Iso9283, iso9283};
pub use rows::{TestLabels, TestRow};

/// Cycles that the standard asks for (clause 6.11).
pub const STANDARD_CYCLES: usize = 30;
