//! Whether a robot is still as it was calibrated, by a few measurements: which joint is not, what cannot be seen, and how large a shift
//! would be found (theory.md §9, *Has it drifted*).
//!
//! `judged.rs` has the visit (`visit.rs`: rows as linear functions) and the earlier one, by `pairs.rs` or `by_model.rs`; `hypotheses.rs` what may have
//! changed, as columns; `explain.rs` the simplest that suffices; `sight.rs` the smallest shift of each joint, and why one is not seen; `witness.rs`
//! chooses configurations for `--plan`; `repair.rs` is `--recalibrate`. No files and tables here: it has numbers and single sentences.

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
mod several;
mod sight;
mod visit;
mod witness;
mod words;

pub use explain::{Kind, Size};
pub use found::{Explanation, Tracked};
pub use judged::Earlier;
pub use options::{JudgedBy, State, TrackOptions};
pub use repair::{Repaired, recalibrate};
pub use run::track;
pub use sight::{JointSight, Unseen};
pub use witness::{Witnesses, witnesses};
