//! Whether a robot is still as it was calibrated, by a few measurements: which joint is not, what cannot be seen, and how large a shift
//! would be found (theory.md §9, *Has it drifted*).

mod by_model;
mod explain;
mod found;
mod hypotheses;
mod judged;
mod model;
mod options;
mod pairs;
mod repair;
mod run;
mod sight;
mod visit;
mod witness;
mod words;

pub use explain::Kind;
pub use found::{Explanation, Size, Tracked};
pub use judged::Earlier;
pub use options::{JudgedBy, State, TrackOptions};
pub use repair::{Repaired, recalibrate};
pub use run::track;
pub use sight::{JointSight, Unseen};
pub use witness::{Witnesses, witnesses};
