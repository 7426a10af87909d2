//! Arguments of `poecal compensate`.

use std::path::PathBuf;

use clap::Args;

use super::shared::{ColumnArgs, OutFile};
use super::words::{PREDICTED_MODEL, PredictedModel, one_of};

/// Arguments of `poecal compensate`.
#[derive(Args, Debug)]
pub(crate) struct Compensate {
    /// The calibration (calibration.json)
    pub(crate) calibration: PathBuf,
    /// The program for the nominal robot: joint readings (CSV)
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Which model of the calibration is the actual robot: the corrected one, if there is one, or the calibrated one
    #[arg(long = "model", value_parser = one_of(PREDICTED_MODEL), default_value = "corrected")]
    pub(crate) of: PredictedModel,
    /// Value of a factor of the corrected model while the program runs [default: its reference]
    #[arg(long = "factor", value_name = "NAME=VALUE")]
    pub(crate) factors: Vec<String>,
    /// Compute what is left once more, from the written numbers and by the models' own forward kinematics
    #[arg(long)]
    pub(crate) check: bool,
    /// Where the actual robot cannot reach a pose, write the nearest configuration instead of refusing
    #[arg(long)]
    pub(crate) nearest: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: OutFile,
}
