//! Detection of a robot's change since its calibration by a few measurements (theory.md §9, *Has it drifted*). The result is the changed joint, the
//! joints that cannot be seen, and the detectable size of a shift.
//!
//! `judged.rs` has the visit (`visit.rs`: rows as linear functions) and the earlier one, by `pairs.rs` or `by_model.rs`. `hypotheses.rs` has the
//! possible changes as columns, `explain.rs` the simplest sufficient one. `sight.rs` has the smallest detectable shift of each joint, and the reason
//! if it is not seen. `witness.rs` chooses configurations for `--plan`; `repair.rs` is `--recalibrate`. This module has numbers and single sentences,
//! no files and tables.

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
