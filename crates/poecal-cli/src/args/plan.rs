//! Arguments of `poecal plan`.

use std::path::PathBuf;

use clap::Args;
use poecal::calibration::{Corrections, DeviceFrameKnowledge};
use poecal::plan::PlanCriterion;
use poecal::simulate::Kind;

use super::shared::{ColumnArgs, OutFile, TreeArgs};
use super::words::{CRITERION, FRAME, one_of, simulated};
use crate::quantity::{BelievedTolerance, Over, direction, error_m, place_m, sigma_m, sigma_rad, whole};

/// Arguments of `poecal plan`.
#[derive(Args, Debug)]
pub(crate) struct Plan {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// What will be measured of the tip
    #[arg(long, value_parser = simulated(), default_value = "point")]
    pub(crate) measure: Kind,
    /// Number of different configurations to fit
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) count: u32,
    /// Number of further rows to judge by, at random over the workspace [default: a third of the configurations]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1000))]
    pub(crate) judge: Option<u32>,
    /// Choose from these configurations alone (CSV of joint readings)
    #[arg(long, value_name = "FILE")]
    pub(crate) candidates: Option<PathBuf>,
    /// Where the robot will work and predictions shall be good: anywhere within its limits, in the configurations of a file, or with the tip in a
    /// box of the base frame, from one corner to the other
    #[arg(
        long,
        value_name = "limits|FILE|X,Y,Z:X,Y,Zmm",
        default_value = "limits",
        allow_hyphen_values = true
    )]
    pub(crate) over: Over,
    /// Configurations that are in the list in any case, or were measured already (CSV of joint readings): new ones complete them, and --count
    /// counts both
    #[arg(long, visible_alias = "measured", value_name = "FILE")]
    pub(crate) keep: Vec<PathBuf>,
    /// What the list shall be good at
    #[arg(long, value_parser = one_of(CRITERION), default_value = "expected")]
    pub(crate) criterion: PlanCriterion,
    /// Number of targets of a nest at the tip, all measured in each configuration
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub(crate) targets: u32,
    /// Where the target is in the tip's frame, of several the first, the others turned about z, like 50,0,30mm [default: the targets of the
    /// model, or the tip]
    #[arg(long, value_name = "X,Y,Zmm", value_parser = place_m, allow_hyphen_values = true)]
    pub(crate) target_offset: Option<[f64; 3]>,
    /// Standard deviation of each measured position component
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true, default_value = "0.05mm")]
    pub(crate) sigma_position: f64,
    /// Standard deviation of each measured rotation component
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true, default_value = "0.01deg")]
    pub(crate) sigma_rotation: f64,
    /// Error of the tip (RMS) that a calibration leaves however much is measured, like 0.3mm, as an earlier calibration of such a robot found
    /// it [default: 0.3 mm for each metre of reach, which is a guess]
    #[arg(long, value_name = "LENGTH", value_parser = error_m, allow_hyphen_values = true)]
    pub(crate) robot_error: Option<f64>,
    /// The measuring device's frame
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown")]
    pub(crate) frame: DeviceFrameKnowledge,
    /// Prior of the fit: deviation of each axis from nominal, as standard deviations, or none
    #[arg(long, value_name = "ANGLE,LENGTH|none", default_value = "0.5deg,5mm")]
    pub(crate) tolerance: BelievedTolerance,
    /// What joints are expected to do beyond geometry: auto and all terms of the common sizes, off nothing, or groups with their sizes, as of
    /// poecal calibrate
    #[arg(long, value_name = "auto|all|off|GROUP[=SIZE],...", default_value = "auto")]
    pub(crate) corrections: Corrections,
    /// Where gravity pulls, in the robot's base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, default_value = "0,0,-1", allow_hyphen_values = true)]
    pub(crate) gravity: [f64; 3],
    /// Seed of everything random
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) place: OutFile,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}
