//! From a robot and measurements to a calibrated and judged robot.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and is not stable
//! by itself.
//!
//! `steps/calibrate.rs` calls the steps, each once, in order, and has no formulas. `run` is the session ready for a fit, with its options. `robust`,
//! `corrections`, `pictures`, `events` and `moves` are the loops around a fit; `doubts`, `trust`, `acceptance`, `validate` and `workspace` judge it.
//! To understand a calibration, read `steps/calibrate.rs`, then `poecal-fit`'s `problem/mod.rs` and `problem/fast.rs`, then `poecal-numerics`'s
//! `solve/levenberg_marquardt.rs`: all other files are called from there.
//!
//! This crate has no files, tables or pages, and calls the solver and the problem.

#![forbid(unsafe_code)]

pub(crate) mod acceptance;
pub(crate) mod corrections;
pub(crate) mod doubts;
pub(crate) mod events;
pub(crate) mod iso9283;
pub mod limit_words;
pub(crate) mod moves;
pub(crate) mod pictures;
pub(crate) mod robust;
pub(crate) mod run;
pub(crate) mod steps;
pub(crate) mod trust;
pub(crate) mod validate;
pub(crate) mod workspace;

pub use crate::doubts::suspicion::JointCorrection;
pub use crate::pictures::image_map::{ImageCell, ImageMap};
pub use crate::run::accuracy::{
    Accuracy, Improvement, Improvements, ModelAccuracy, Models, SetAccuracy, Statistic, set_accuracy,
};
pub use crate::run::blocks::{BlockChoice, names};
pub use crate::run::calibrated_places::{CalibratedStation, CalibratedTarget};
pub use crate::run::fit::{fit_screws, free_parameters};
pub use crate::run::formulation::{Formulation, FormulationWords, Minimize, Minimum};
pub use crate::run::noise::{NoiseSource, estimate_noise};
pub use crate::run::options::{CalibrationOptions, DeviceFrameKnowledge};
pub use crate::run::pixels::{CornerError, PixelAccuracy, corner_error};
pub use crate::run::split::{FEWEST_HELD_OUT, settle_sets, split_rows};
pub use crate::run::stage::CalibrationStage;
pub use crate::steps::calibrate::{calibrate, calibrate_repairing};
pub use crate::steps::fit_progress::SolverReport;
pub use crate::steps::joint_correlations::CommonDirection;
pub use crate::steps::level::{Gain, Level, Verdict};
pub use crate::steps::limit_checks::accepted_by;
pub use crate::steps::repeatability::{RepeatScatter, RepeatedPose, repeatability};
pub use crate::steps::result::{Calibration, RepairedSession};
pub use crate::steps::trust::Trust;
pub use crate::trust::coverage_check::{
    CoverageCheck, JudgedError, JudgedRow, PredictedUncertainty, PredictiveDistribution, QuantityCoverage,
    SampledRangeErrors,
};
pub use crate::trust::expected_errors::{Expectations, ExpectedPositionErrors, RangePart};
pub use crate::trust::nominal_errors::NominalError;
pub use crate::validate::compare_with_arm_fit::{ArmFitComparison, arm_too, session_of};
pub use crate::validate::judge::{
    DeliveredModel, JudgedCalibration, JudgedModel, Judgement, MovedDevice, RefittedPart, improvement, judge,
};
pub use acceptance::{
    Acceptance, AcceptanceLimit, AcceptanceLimits, AcceptedLimit, AcceptedModel, AcceptedRows, AcceptedStatistic,
    Decision,
};
pub use corrections::{
    CorrectedFit, Correction, Effects, JointEffect, JointErrorPart, JointErrors, SizesReason, TriedSizes, unknowns,
    whitened_rows,
};
pub use events::{Event, EventKind, RepairLimit, RepairLimits, Repairs, family};
pub use iso9283::{
    FigureBounds, FigureLimit, FigureName, Iso9283, JudgedFigure, PoseCluster, STANDARD_CYCLES, TestFigure, TestLabels,
    TestRow, iso9283,
};
pub use poecal_model::robot::{CorrectionModel, Corrections, Sizes, TermGroup};
pub use robust::{Loss, RobustLoss, Robustness, RowInfluence, RowJudgement, row_influence};
pub use workspace::{Displacements, ValueSpread, Workspace, workspace};

pub use poecal_fit::state::{RowError, nominal_estimate, radian_m};
