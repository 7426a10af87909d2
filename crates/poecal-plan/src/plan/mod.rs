//! Choice of configurations, their number, and the expected error: before anything is measured, and during measurement (docs/theory.md, *Choosing
//! configurations*).
//!
//! `make.rs` has the steps: an experiment at the nominal model (`experiment.rs`), conditions of measurement (`conditions.rs`, `capsule.rs`), the
//! choice of candidates (`search.rs`, by the low-rank updates of `state.rs`, `change.rs` and `caches.rs`), and the order of travel (`order.rs`).
//! `watch.rs` judges a row against its prediction, then fits it. No files and no fits of its own except that one.

mod blocks;
mod caches;
mod candidates;
mod capsule;
mod change;
mod choice;
mod conditions;
mod curve;
mod error_curve;
mod experiment;
mod make;
mod options;
mod order;
mod plan_result;
mod rows;
mod running_fit;
mod sample;
mod search;
mod sequence;
mod skeleton;
mod state;
mod test_cube;
mod watch;
mod watched_row;

pub use candidates::workspace_in;
pub use capsule::Capsule;
pub use conditions::{Conditions, DeviceView, Obstacle, RefusalCounts};
pub use error_curve::{CurvePoint, ExpectedErrors, ListExpectation, expected_errors};
pub use make::plan;
pub use options::{PlanCriterion, PlanOptions, PlannedFit, RobotError};
pub use plan_result::Plan;
pub use rows::{PlannedRow, RETURN_EVERY, RowPurpose, returns_of};
pub use skeleton::skeleton;
pub use test_cube::{CYCLE, TestCube, test_cube};
pub use watch::Watch;
pub use watched_row::{Mistake, WatchOptions, WatchedRow};
