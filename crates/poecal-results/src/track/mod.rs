//! Detection of a robot's change since its calibration by a few measurements (theory.md §9, *Has it drifted*). The result is the changed joint, the
//! joints that cannot be seen, and the detectable size of a shift.
//!
//! `visit_judgement.rs` has the visit (`visit.rs`: rows as linear functions) and the earlier one, by `pairs.rs` or `by_model.rs`. `hypotheses.rs` has the
//! possible changes as columns, `explain.rs` the simplest sufficient one. `sight.rs` has the smallest detectable shift of each joint, and the reason
//! if it is not seen. `witness.rs` chooses configurations for `--plan`; `repair.rs` is `--recalibrate`. This module has numbers and single sentences,
//! no files and tables.

mod by_model;
mod explain;
mod hypotheses;
mod joint_combinations;
mod model;
mod options;
mod pairs;
mod repair;
mod run;
mod sight;
mod visit;
mod visit_judgement;
mod visit_result;
mod visit_sentences;
mod witness;

pub use explain::{ExplanationKind, Size};
pub use options::{JudgingBasis, RobotCondition, TrackOptions};
pub use repair::{RecalibratedJoint, recalibrate};
pub use run::track;
pub use sight::{JointSight, Undetectable};
pub use visit_judgement::Baseline;
pub use visit_result::{ChangeExplanation, VisitResult};
pub use witness::{Witnesses, witnesses};
