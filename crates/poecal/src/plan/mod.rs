//! Which configurations to measure, how many, and what error to expect: before anything is measured, and while it is (docs/theory.md,
//! *Choosing configurations*).

mod capsule;
mod conditions;
mod experiment;
mod make;
mod options;
mod order;
mod search;
mod state;
mod watch;

pub use capsule::Capsule;
pub use conditions::{Conditions, Obstacle, Refusals, Sight};
pub use make::{CurvePoint, ExpectedErrors, Plan, PlanOptions, PlannedRow, RowPart, plan, workspace_in};
pub use options::{PlanCriterion, PlannedFit};
pub use watch::{Mistake, Watch, WatchOptions, WatchedRow};
