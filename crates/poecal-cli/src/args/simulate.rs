//! Arguments of `poecal simulate`.

use std::path::PathBuf;

use clap::Args;
use poecal_calibrate::DeviceFrameKnowledge;
#[cfg(any(unix, windows))]
use poecal_detect::BoardSpec;
#[cfg(any(unix, windows))]
use poecal_fit::hand_eye::CameraMounting;
use poecal_model::robot::Sizes;
use poecal_model::simulate::SessionKind;

use super::shared_args::TreeArgs;
use crate::quantity::{LengthAndAngle, direction, terms};
#[cfg(any(unix, windows))]
use crate::words::CAMERA;
use crate::words::{FRAME, one_of, parser_of_simulated};

/// Arguments of `poecal simulate`.
#[derive(Args, Debug)]
pub(crate) struct Simulate {
    /// Robot model to deviate from: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    /// Angle and distance by which every axis, and the tip, is off
    #[arg(long, value_name = "ANGLE,LENGTH", default_value = "1deg,2mm", allow_hyphen_values = true)]
    pub(crate) errors: LengthAndAngle,
    /// Standard deviations of each measured component; with --camera, of what the arm is off in each configuration
    #[arg(long, value_name = "LENGTH,ANGLE", default_value = "0.05mm,0.01deg", allow_hyphen_values = true)]
    pub(crate) noise: LengthAndAngle,
    /// Joint effects beyond geometry: groups of terms with the standard deviations of their random coefficients in radians or metres,
    /// sag, tilt, ratio, harmonics, wobble, backlash, factors, payload, shift, runout
    #[arg(long, value_name = "off|GROUP[=SIZE],...", value_parser = terms, default_value = "off")]
    pub(crate) terms: Sizes,
    /// Direction of gravity in the robot's base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, default_value = "0,0,-1", allow_hyphen_values = true)]
    pub(crate) gravity: [f64; 3],
    /// Number of measurements
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(crate) count: u32,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Kind of the measurements
    #[arg(long, value_parser = parser_of_simulated(), default_value = "pose")]
    pub(crate) kind: SessionKind,
    /// The measuring device's frame: unknown, or the robot's base
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown")]
    pub(crate) device_frame: DeviceFrameKnowledge,
    /// Number of further measurements, free of noise, to judge a calibration by
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=10_000_000))]
    pub(crate) held_out_count: u32,
    /// Pictures of a board and the readings of each, in place of measurements: where the camera is
    #[cfg(any(unix, windows))]
    #[arg(long, value_parser = one_of(CAMERA), conflicts_with_all = ["kind", "device_frame", "held_out_count", "terms", "gravity"])]
    pub(crate) camera: Option<CameraMounting>,
    /// The board in the pictures, as poecal detect --print draws it
    #[cfg(any(unix, windows))]
    #[arg(long, value_name = "SPEC", default_value = "charuco:7x5:36mm:26mm:DICT_4X4_50", requires = "camera")]
    pub(crate) board: BoardSpec,
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Overwrite files in an existing folder
    #[arg(long)]
    pub(crate) force: bool,
}
