//! The command line of `poecal identify`.

use std::path::PathBuf;

use clap::Args;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_model::simulate::Kind;
use poecal_plan::plan::RobotError;

use super::shared::{CameraArgs, ColumnArgs, TreeArgs};
use super::words::{FRAME, one_of, simulated};
use crate::quantity::{robot_error, sigma_m, sigma_rad};

/// Arguments of `poecal identify`.
#[derive(Args, Debug)]
pub(crate) struct Identify {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    /// Joint readings (CSV, xlsx, or as controllers and recorders write them), joined; other columns than the joints' and `id` are ignored, but for kinds that touch something: these need the
    /// columns that name it. With --camera and --markers pictures that were taken: the files that calibrate reads
    #[arg(required = true)]
    pub(crate) joints: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) cameras: CameraArgs,
    /// Kind of the measurements of the tip
    #[arg(long, visible_alias = "measure", value_parser = simulated(), default_value = "pose", conflicts_with = "camera")]
    pub(crate) kind: Kind,
    /// Standard deviation of each measured position component [default: 0.05mm]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true, conflicts_with = "camera")]
    pub(crate) sigma_position: Option<f64>,
    /// Standard deviation of each measured rotation component [default: 0.01deg]
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true, conflicts_with = "camera")]
    pub(crate) sigma_rotation: Option<f64>,
    /// Error of the tip (RMS) that a calibration leaves however much is measured, and that with corrections, like 0.3mm or 0.3mm,0.12mm, as an
    /// earlier calibration of such a robot found it [default: 0.3 mm for each metre of reach, which is a guess]
    #[arg(long, value_name = "LENGTH[,LENGTH]", value_parser = robot_error, allow_hyphen_values = true, conflicts_with = "camera")]
    pub(crate) robot_error: Option<RobotError>,
    /// The measuring device's frame
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown")]
    pub(crate) frame: DeviceFrameKnowledge,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}
