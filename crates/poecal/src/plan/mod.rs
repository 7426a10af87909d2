//! Which configurations to measure, how many, and what error to expect: before anything is measured, and while it is (docs/theory.md,
//! *Choosing configurations*).

mod capsule;
mod conditions;
mod expected;
mod experiment;
mod make;
mod options;
mod order;
mod rows;
mod search;
mod skeleton;
mod state;
mod watch;

pub use capsule::Capsule;
pub use conditions::{Conditions, Obstacle, Refusals, Sight};
pub use expected::{CurvePoint, ExpectedErrors, ListExpectation, expected_errors};
pub use make::{Plan, plan, workspace_in};
pub use options::{PlanCriterion, PlanOptions, PlannedFit, RobotError};
pub use rows::{PlannedRow, RETURN_EVERY, RowPart, returns_of};
pub use skeleton::skeleton;
pub use watch::{Mistake, Watch, WatchOptions, WatchedRow};
