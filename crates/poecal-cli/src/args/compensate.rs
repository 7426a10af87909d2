//! Arguments of `poecal compensate`.

use std::path::PathBuf;

use clap::Args;
use poecal_calibrate::AcceptedModel;
use poecal_compensate::MaxCorrection;
use poecal_model::robot::ThirdAxis;

use super::shared_args::{ColumnArgs, TextOutput};
use crate::quantity::most_change;
use crate::words::{LANGUAGE, MODEL, ProgramLanguage, THIRD_AXIS, one_of};

/// Arguments of `poecal compensate`.
#[derive(Args, Debug)]
pub(crate) struct Compensate {
    /// The calibration (calibration.json)
    pub(crate) calibration: PathBuf,
    /// The program for the nominal robot: joint readings (CSV), or a robot program in URScript (.script), RAPID (.mod, .prg, .sys), KRL (.src,
    /// .dat) or of FANUC (.ls)
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// The language of the program [default: by the end of its name, else csv]
    #[arg(long, value_parser = one_of(LANGUAGE))]
    pub(crate) language: Option<ProgramLanguage>,
    /// Tool of a robot program, in the controller's flange: by its number or name, or that of programs that set none; the numbers as the
    /// language writes poses
    #[arg(long = "tool-data", value_name = "[NAME=]NUMBERS", allow_hyphen_values = true)]
    pub(crate) tool_data: Vec<String>,
    /// Frame of a robot program's poses (work object, base, user frame), in the controller's base: as --tool-data
    #[arg(long = "work-object", value_name = "[NAME=]NUMBERS", allow_hyphen_values = true)]
    pub(crate) work_objects: Vec<String>,
    /// The controller's base in the model's base [default: the same]
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) controller_base: Option<String>,
    /// The controller's flange in the model's tip [default: the same]
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) controller_flange: Option<String>,
    /// Readings where the robot is before the program's first motion, as the language writes joints (J1,J2,...): of programs that begin with a pose and
    /// state no configuration (ConfL\Off, movej)
    #[arg(long, value_name = "READINGS", allow_hyphen_values = true)]
    pub(crate) start: Option<String>,
    /// From where J3 of a program of FANUC counts: the level, as its controllers do by themselves, or the arm [default: as the calibration's mapping
    /// says and its rows show]
    #[arg(long, value_parser = one_of(THIRD_AXIS))]
    pub(crate) third_axis: Option<ThirdAxis>,
    /// Which model of the calibration is the actual robot: the corrected one, if there is one, or the calibrated one
    #[arg(long = "model", value_parser = one_of(MODEL), default_value = "corrected")]
    pub(crate) of: AcceptedModel,
    /// Values of factors of the corrected model while the program runs [default: their references]
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
    pub(crate) factors: Vec<String>,
    /// End with code 1 unless the calibration clearly predicts better than the nominal model anywhere inside the sampled range
    #[arg(long)]
    pub(crate) require_gain: bool,
    /// Compute what is left once more, from the written numbers and by the models' own forward kinematics
    #[arg(long)]
    pub(crate) check: bool,
    /// Write the nearest configuration if the actual robot cannot reach a pose, instead of leaving the target as it is
    #[arg(long)]
    pub(crate) nearest: bool,
    /// Largest motion of a joint beyond its zero, like 2deg,2mm; a target that takes more, at a singularity, stays as it is and is listed
    #[arg(long, value_name = "SIZES", value_parser = most_change, default_value = "2deg,2mm")]
    pub(crate) max_correction: MaxCorrection,
    /// Write nothing, only print what would be changed
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print the summary as JSON, with every target
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}
