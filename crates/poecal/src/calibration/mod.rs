//! From a robot and measurements to a calibrated robot.

mod acceptance;
mod accepted;
mod accuracy;
mod arm_too;
mod assess;
mod blocks;
mod calibrate;
mod calibrated;
mod changes;
mod corrected;
mod corrections;
mod count;
mod coverage_check;
mod doubts;
mod events;
mod expected;
mod figures;
mod fit;
mod formulation;
mod found;
mod image_map;
mod improvement;
mod information;
mod instrument_noise;
mod judge;
mod located;
mod moves;
mod noise;
mod noise_doubts;
mod one_zero;
mod optics;
mod optics_doubts;
mod options;
mod pictures;
mod pixels;
mod placed;
mod projection;
mod pull;
mod refused;
mod repeatability;
mod restart;
mod result;
mod robust;
mod rounding;
mod run;
mod signs;
mod split;
mod stage;
mod stations;
mod summary;
mod suspicion;
mod task;
mod together;
mod tolerance;
mod trust;
mod verdict;
mod view_doubts;
mod workspace;

pub use crate::robot::{CorrectionModel, Corrections, Sizes, TermGroup};
pub use acceptance::{
    Acceptance, AcceptanceLimits, AcceptedLimit, AcceptedModel, AcceptedRows, AcceptedStatistic, Decision,
    Limit,
};
pub use accepted::accepted_by;
pub use accuracy::{
    Accuracy, Improvement, Improvements, ModelAccuracy, Models, SetAccuracy, Statistic, set_accuracy,
};
pub use arm_too::{ArmToo, arm_too, session_of};
pub use blocks::BlockChoice;
pub(crate) use blocks::names;
pub use calibrate::{calibrate, calibrate_repairing};
pub use corrections::{
    CorrectedFit, Correction, Effects, JointEffect, JointErrorPart, JointErrors, SizesReason, TriedSizes,
};
pub(crate) use corrections::{unknowns, whitened_rows};
pub use coverage_check::{
    CoverageCheck, InSampledRange, JudgedError, JudgedRow, PartCoverage, PredictedUncertainty, Promise,
};
pub(crate) use events::family;
pub use events::{Event, EventKind, Repairs};
pub use expected::{Expectations, Expected, RangePart};
pub use fit::fit_screws;
pub(crate) use fit::free_parameters;
pub use formulation::{Formulation, FormulationWords, Minimize, Minimum};
pub use found::SolverReport;
pub use image_map::{ImageCell, ImageMap};
pub use judge::{DeliveredModel, JudgedModel, Judgement, MovedDevice, Refitted, Subject, judge};
pub use noise::{NoiseSource, estimate_noise};
pub use options::{CalibrationOptions, DeviceFrameKnowledge};
pub(crate) use pixels::corner_error;
pub use pixels::{CornerError, PixelAccuracy};
pub use placed::{CalibratedStation, CalibratedTarget};
pub use repeatability::{RepeatedPose, repeatability};
pub use result::{Calibration, Repaired};
pub(crate) use robust::RowInfluence;
pub use robust::{Loss, Robust, Robustness, RowJudgement, row_influence};
pub use split::{settle_sets, split_rows};
pub use stage::Stage;
pub use suspicion::JointCorrection;
pub use together::CommonDirection;
pub use trust::Trust;
pub use verdict::{Level, Verdict};
pub(crate) use workspace::{Displacements, Spread, Workspace, workspace};

pub use crate::estimate::{RowError, delivered, radian_m};
