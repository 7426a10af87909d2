//! Which configurations to measure, how many, and what error to expect: before anything is measured, and while it is (docs/theory.md,
//! *Choosing configurations*).

mod blocks;
mod caches;
mod candidates;
mod capsule;
mod change;
mod choice;
mod conditions;
mod curve;
mod expected;
mod experiment;
mod known;
mod make;
mod options;
mod order;
mod planned;
mod rows;
mod sample;
mod search;
mod sequence;
mod skeleton;
mod state;
mod watch;
mod watched;

pub use candidates::workspace_in;
pub use capsule::Capsule;
pub use conditions::{Conditions, Obstacle, Refusals, Sight};
pub use expected::{CurvePoint, ExpectedErrors, ListExpectation, expected_errors};
pub use make::plan;
pub use options::{PlanCriterion, PlanOptions, PlannedFit, RobotError};
pub use planned::Plan;
pub use rows::{PlannedRow, RETURN_EVERY, RowPart, returns_of};
pub use skeleton::skeleton;
pub use watch::Watch;
pub use watched::{Mistake, WatchOptions, WatchedRow};
