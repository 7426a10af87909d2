//! Arguments of `poecal plan`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Arg, Args, Command};
use poecal_calibrate::{Corrections, DeviceFrameKnowledge};
use poecal_model::simulate::SessionKind;
use poecal_plan::plan::{PlanCriterion, RobotError};

use super::shared_args::{CameraArgs, ColumnArgs, FIT, TextOutput, TreeArgs};
use crate::quantity::{
    BelievedTolerance, LengthAndAngle, WorkspaceChoice, box_m, direction, distances_m, height_m, parse_count, place_m,
    robot_error, seconds, sigma_m, sigma_rad,
};
use crate::words::{CRITERION, FRAME, SELF_COLLISION, TOOL, one_of, parser_of_simulated};

/// Arguments of `poecal plan`.
#[derive(Args, Debug)]
pub(crate) struct PlanArgs {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// Judge this list instead of choosing one: what measurements in its configurations would determine, and the error to expect (CSV, xlsx, or as
    /// controllers and recorders write them; repeatable). Only the joints' columns are read, but for kinds that touch something, which need those that
    /// name it. With --camera and --markers pictures that were taken: the files that calibrate reads
    #[arg(long, value_name = "FILE")]
    pub(crate) rows: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) cameras: CameraArgs,
    /// Plan for something else than a calibration: drift chooses, of the configurations that a calibration.json was made of, those whose repeats
    /// show the smallest shift of the worst joint, and prints what each joint would show; with --candidates among new ones. iso9283 lists P1 to P5 of the
    /// largest cube within reach and limits, or of the cube or plane (one side of zero) of --workspace, in --count cycles, as a table to fill in
    #[arg(long, value_name = "PURPOSE", value_parser = ["drift", "iso9283"])]
    pub(crate) purpose: Option<String>,
    #[command(flatten)]
    pub(crate) visits: VisitArgs,
    /// Quantity that will be measured of the tip
    #[arg(long, value_parser = parser_of_simulated(), default_value = "point")]
    pub(crate) kind: SessionKind,
    /// Number of different configurations to fit [with --purpose drift: to measure at each visit, by default 8]
    #[arg(long, value_name = "N", default_value_if("purpose", "drift", "8"), default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) count: u32,
    /// Number of further rows to judge by, at random over the workspace [default: a third of the configurations]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1000))]
    pub(crate) held_out_count: Option<u32>,
    /// Choose from these configurations alone (a table of joint readings)
    #[arg(long, value_name = "FILE")]
    pub(crate) candidates: Option<PathBuf>,
    /// Workspace in which predictions shall be good: anywhere within its limits, in the configurations of a file, or with the tip in a
    /// box of the base frame, from one corner to the other
    #[arg(long, value_name = "limits|FILE|X,Y,Z:X,Y,Zmm", default_value = "limits", allow_hyphen_values = true)]
    pub(crate) workspace: WorkspaceChoice,
    /// Rows that are in the list in any case, or were measured already (a table of joint readings): new ones complete them, and --count counts both.
    /// Rows whose `set` is held_out do not count
    #[arg(long, value_name = "FILE")]
    pub(crate) keep_rows: Vec<PathBuf>,
    /// Rows of --keep-rows, counted from 1 through all files, that collided or were not seen: new ones take their places, not within 10 degrees of
    /// them, and all other rows stay. The list has all rows then, in their order
    #[arg(long, value_name = "ROW", value_delimiter = ',', requires = "keep_rows", conflicts_with_all = ["count", "held_out_count"])]
    pub(crate) replace_rows: Vec<u32>,
    /// Purpose of the list
    #[arg(long, value_parser = one_of(CRITERION), default_value = "expected")]
    pub(crate) criterion: PlanCriterion,
    /// Number of targets of a nest at the tip, all measured in each configuration
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub(crate) targets: u32,
    /// Position of the target in the tip's frame, of several the first, the others turned about z, like 50,0,30mm [default: the targets of the
    /// model, or the tip]
    #[arg(long, value_name = "X,Y,Zmm", value_parser = place_m, allow_hyphen_values = true)]
    pub(crate) target_offset: Option<[f64; 3]>,
    #[command(flatten)]
    pub(crate) fit: FitArgs,
    #[command(flatten)]
    pub(crate) conditions: ConditionArgs,
    /// Dwell at each row, for the duration of the whole
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "30s")]
    pub(crate) stop: Duration,
    /// Seed of everything random
    #[arg(long, default_value_t = 1, value_parser = parse_count::<u64>)]
    pub(crate) seed: u64,
    /// Write the list also as a program of joint motions with a stop at each row: its name ends in .script (Universal Robots), .mod (ABB),
    /// .src (KUKA) or .ls (FANUC)
    #[arg(long, value_name = "FILE")]
    pub(crate) program: Option<PathBuf>,
    /// Write a page of the plan (HTML): the targets of all configurations, some arms, the device, errors by number, how each joint is sampled
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    #[command(flatten)]
    pub place: TextOutput,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of a list that is stated, and of visits: each purpose excludes all others.
const OF_ROWS: &str = "rows camera markers base_link tip_link instrument target columns units kind sigma_position sigma_rotation robot_error \
                       device_frame json";
const OF_VISITS: &str = "purpose repeatability tool reference columns units count candidates device out force json base_link tip_link workspace program floor_height";
/// Options that pictures replace.
const NOT_OF_PICTURES: [&str; 4] = ["kind", "sigma_position", "sigma_rotation", "robot_error"];

/// The command with its options that exclude each other.
pub(crate) fn with_exclusions(plan: Command) -> Command {
    let excluded = |kept: &str| {
        let options = plan.get_opts().map(Arg::get_id);
        let others = options.filter(|id| !kept.split(' ').any(|it| it == id.as_str()));
        others.cloned().collect::<Vec<_>>()
    };
    let (of_rows, of_visits) = (excluded(OF_ROWS), excluded(OF_VISITS));
    plan.mut_arg("rows", |it| it.conflicts_with_all(of_rows))
        .mut_arg("purpose", |it| it.conflicts_with_all(of_visits))
        .mut_arg("camera", |it| it.conflicts_with_all(NOT_OF_PICTURES))
}

/// Knowledge about the visits to a calibrated robot.
#[derive(Args, Debug)]
#[command(next_help_heading = "With --purpose drift")]
pub(crate) struct VisitArgs {
    /// Standard deviation of one visit and coordinate, like 0.03mm, as measured by repeats [default: the noise of the calibration]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, requires = "purpose")]
    pub(crate) repeatability: Option<f64>,
    /// State of the tool with its targets at the visits: same if it stays on the flange [default: same]
    #[arg(long, value_parser = one_of(TOOL), value_name = "HOW", requires = "purpose", action = clap::ArgAction::Set)]
    pub(crate) tool: Option<bool>,
    /// Rows of an earlier visit whose configurations may be repeated [default: the measurements that the calibration was made of]
    #[arg(long, value_name = "OLD.csv", requires = "purpose")]
    pub(crate) reference: Vec<PathBuf>,
}

/// Position of the measuring device, or known if it will not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PlannedDevice {
    /// A place in the robot's base frame, metres.
    At([f64; 3]),
    /// At a visit: where it stood, or set up again.
    IsKnown(bool),
}

/// A place, or a word of a visit.
fn planned_device(text: &str) -> Result<PlannedDevice, String> {
    match text {
        "known" => Ok(PlannedDevice::IsKnown(true)),
        "refit" => Ok(PlannedDevice::IsKnown(false)),
        place => place_m(place)
            .map(PlannedDevice::At)
            .map_err(|error| format!("{error}; or known or refit with --purpose drift")),
    }
}

/// The fit that will be made, and what is believed before.
#[derive(Args, Debug)]
#[command(next_help_heading = FIT)]
pub(crate) struct FitArgs {
    /// Standard deviation of each measured position component
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true, default_value = "0.05mm")]
    pub(crate) sigma_position: f64,
    /// Standard deviation of each measured rotation component
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true, default_value = "0.01deg")]
    pub(crate) sigma_rotation: f64,
    /// Error of the tip (RMS) that a calibration leaves however much is measured, and that with corrections, like 0.3mm or 0.3mm,0.12mm, as an
    /// earlier calibration of such a robot found it [default: 0.3 mm for each metre of reach, which is an assumption]
    #[arg(long, value_name = "LENGTH[,LENGTH]", value_parser = robot_error, allow_hyphen_values = true)]
    pub(crate) robot_error: Option<RobotError>,
    /// The measuring device's frame
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown")]
    pub(crate) device_frame: DeviceFrameKnowledge,
    /// Deviations of the axes from the model (the prior of the fit): standard deviations of their directions and places, or none
    #[arg(long, value_name = "ANGLE,LENGTH|none", default_value = "0.5deg,5mm")]
    pub(crate) tolerance: BelievedTolerance,
    /// Joint effects that are expected beyond geometry: auto and all terms of the common sizes, off nothing, or groups with their sizes, as of
    /// poecal calibrate
    #[arg(long, value_name = "auto|all|off|GROUP[=SIZE],...", default_value = "auto")]
    pub(crate) corrections: Corrections,
    /// Direction of gravity in the robot's base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, default_value = "0,0,-1", allow_hyphen_values = true)]
    pub(crate) gravity: [f64; 3],
}

/// Conditions on a configuration that is measured; all places in the robot's base frame.
#[derive(Args, Debug)]
#[command(next_help_heading = "What can be measured")]
pub(crate) struct ConditionArgs {
    /// Distance of every joint from its limits [default: 2deg,5mm; of a list that is stated none]
    #[arg(long, value_name = "ANGLE,LENGTH")]
    pub(crate) margin: Option<LengthAndAngle>,
    /// Box into which no part of the robot may reach, by two corners (repeatable)
    #[arg(long, value_name = "X,Y,Z:X,Y,Zmm", value_parser = box_m, allow_hyphen_values = true)]
    pub(crate) keep_out: Vec<[[f64; 3]; 2]>,
    /// Height above which all links that move stay, like 20mm
    #[arg(long, value_name = "LENGTH", value_parser = height_m, allow_hyphen_values = true)]
    pub(crate) floor_height: Option<f64>,
    /// Least change of some joint between any two configurations
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad)]
    pub(crate) separation: Option<f64>,
    /// Position of the measuring device; targets that links hide from it are left out. With --purpose drift: known where it will stand as it stood, as on
    /// fixed nests, or refit
    #[arg(long, value_name = "X,Y,Zmm|known|refit", value_parser = planned_device, allow_hyphen_values = true)]
    pub(crate) device: Option<PlannedDevice>,
    /// Half the angle of the device's cone, about the direction from it to --device-aim
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, requires = "device")]
    pub(crate) device_half_angle: Option<f64>,
    /// Point at which the device is aimed [default: the base]
    #[arg(long, value_name = "X,Y,Zmm", value_parser = place_m, requires = "device_half_angle", allow_hyphen_values = true)]
    pub(crate) device_aim: Option<[f64; 3]>,
    /// Least and largest distance of the target from the device, like 0.5m:10m
    #[arg(long, value_name = "LENGTH:LENGTH", value_parser = distances_m, requires = "device")]
    pub(crate) distance: Option<[f64; 2]>,
    /// Largest angle between the direction in which the target looks and the line to the device: of a reflector or a board
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, requires = "device")]
    pub(crate) target_half_angle: Option<f64>,
    /// The direction in which the target looks, in its own frame [default: 0,0,1]
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, requires = "target_half_angle", allow_hyphen_values = true)]
    pub(crate) target_normal: Option<[f64; 3]>,
    /// Check of links that overlap by their shapes in the URDF: capsules around these, so that a little room is lost
    #[arg(long, value_parser = one_of(SELF_COLLISION), default_value = "avoid", action = clap::ArgAction::Set)]
    pub(crate) self_collision: bool,
}
