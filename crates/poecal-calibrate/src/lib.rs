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
pub use crate::run::fit::{fit_screws, free_parameters};
pub use crate::run::formulation::{Formulation, FormulationWords, Minimize, Minimum};
pub use crate::run::noise::{NoiseSource, estimate_noise};
pub use crate::run::options::{CalibrationOptions, DeviceFrameKnowledge};
pub use crate::run::pixels::{CornerError, PixelAccuracy, corner_error};
pub use crate::run::placed::{CalibratedStation, CalibratedTarget};
pub use crate::run::split::{FEWEST_HELD_OUT, settle_sets, split_rows};
pub use crate::run::stage::Stage;
pub use crate::steps::accepted::accepted_by;
pub use crate::steps::calibrate::{calibrate, calibrate_repairing};
pub use crate::steps::found::SolverReport;
pub use crate::steps::level::{Gain, Level, Verdict};
pub use crate::steps::repeatability::{RepeatScatter, RepeatedPose, repeatability};
pub use crate::steps::result::{Calibration, Repaired};
pub use crate::steps::together::CommonDirection;
pub use crate::steps::trust::Trust;
pub use crate::trust::coverage_check::{
    CoverageCheck, InSampledRange, JudgedError, JudgedRow, PartCoverage, PredictedUncertainty, Promise,
};
pub use crate::trust::expected::{Expectations, Expected, RangePart};
pub use crate::trust::nominal::NominalError;
pub use crate::validate::arm_too::{ArmToo, arm_too, session_of};
pub use crate::validate::judge::{
    DeliveredModel, JudgedModel, Judgement, MovedDevice, Refitted, Subject, improvement, judge,
};
pub use acceptance::{
    Acceptance, AcceptanceLimits, AcceptedLimit, AcceptedModel, AcceptedRows, AcceptedStatistic, Decision,
    Limit,
};
pub use corrections::{
    CorrectedFit, Correction, Effects, JointEffect, JointErrorPart, JointErrors, SizesReason, TriedSizes,
    unknowns, whitened_rows,
};
pub use events::{Event, EventKind, RepairLimit, RepairLimits, Repairs, family};
pub use iso9283::{
    FigureBounds, FigureLimit, FigureName, Iso9283, JudgedFigure, STANDARD_CYCLES, TestFigure, TestLabels,
    TestRow, iso9283,
};
pub use poecal_model::robot::{CorrectionModel, Corrections, Sizes, TermGroup};
pub use robust::{Loss, Robust, Robustness, RowInfluence, RowJudgement, row_influence};
pub use workspace::{Displacements, Spread, Workspace, workspace};

pub use poecal_fit::state::{RowError, delivered, radian_m};
