//! The command line.

mod calibrate;
mod compensate;
#[cfg(any(unix, windows))]
mod detect;
#[cfg(any(unix, windows))]
mod fleet;
mod hand_eye;
mod init;
mod iso9283;
mod offsets;
mod plan;
mod report;
mod reproduce;
mod shared_args;
mod simulate;
mod track;
mod watch;

pub(crate) use crate::words::{
    CONTACT, ExportForm, FRAMES, INSTEAD, JOIN, OuterFrame, ProgramLanguage, RefitChoice, word_of,
};
pub(crate) use calibrate::Calibrate;
pub(crate) use compensate::Compensate;
#[cfg(any(unix, windows))]
pub(crate) use detect::Detect;
#[cfg(any(unix, windows))]
pub(crate) use fleet::{Fleet, FleetCommand, FleetPrior, FleetReport};
pub(crate) use hand_eye::{FramesOutputArgs, HandEyeArgs, TcpArgs};
pub(crate) use init::Init;
pub(crate) use iso9283::Iso9283Args;
pub(crate) use offsets::OffsetsArgs;
pub(crate) use plan::{FitArgs, PlanArgs, PlannedDevice, with_exclusions};
pub(crate) use report::{Report, ReportPlace};
pub(crate) use reproduce::{Experiment, Reproduce};
pub(crate) use shared_args::{TreeArgs, with_mapping};
pub(crate) use simulate::Simulate;
pub(crate) use track::TrackArgs;
pub(crate) use watch::WatchArgs;

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use poecal_calibrate::{AcceptanceLimit as ErrorLimit, AcceptedModel, DeviceFrameKnowledge, Level};
use poecal_results::predictions::PredictionFrame;
use poecal_results::record::Record;

use crate::quantity::{LimitArgument, limit_of_change, limit_of_files, seconds, threads};
use crate::words::{FRAME, MODEL, PREDICT_IN, REFIT, REQUIRED_LEVEL, export_form, export_form_help, one_of};
pub(crate) use shared_args::{ChainArgs, TextOutput};
use shared_args::{ColumnArgs, JUDGED, MeaningArgs, RESULTS, ReadingArgs};

/// End of the program.
const EXIT_CODES: &str = "Exit codes: 0 done, and a calibration is usable; 1 there are results, but the verdict is `do not use` or \
                          worse than --require asks for, a limit of --accept is not met with 95 % confidence, or the output could not be \
                          printed; 2 refused: wrong input or usage, nothing was written; 3 no result at all";

/// Calibrates robot arms: URDF and tracker, CMM or camera measurements in, a URDF that matches the real arm out.
#[derive(Debug, Parser)]
#[command(name = "poecal", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub(crate) struct Arguments {
    /// The command.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Suppress everything except errors and requested output
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Number of threads, 1 to 256 (results do not depend on it)
    #[arg(long, global = true, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Most that a file may take, like rows=5000000 or text=1GiB, where that is less than it needs (repeatable; SECURITY.md has the names)
    #[arg(long, global = true, value_name = "NAME=N", value_parser = limit_of_files)]
    pub(crate) limit: Vec<LimitArgument>,
    /// Wait so long, like 60s, for another run that writes to the same folder or ledger [default: refuse at once]
    #[arg(long, global = true, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) wait: Option<Duration>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a project folder to start from: the model, an empty measurement file, settings
    Init(Init),
    /// Calibrate a robot from measurements
    Calibrate(Box<Calibrate>),
    /// Find where a camera is on the flange, or beside the robot, from poses of the flange and of what the camera saw
    HandEye(Box<HandEyeArgs>),
    /// Find where the tip of a tool is, from poses of the flange in which it touches a fixed point
    Tcp(TcpArgs),
    /// Find the corners of a board in pictures; or print a board
    #[cfg(any(unix, windows))]
    Detect(Detect),
    /// Simulate a robot with errors and its measurements, for tests and for learning
    Simulate(Simulate),
    /// Write the report of a calibration again, or its certificate
    Report(Report),
    /// Judge a calibration by other measurements
    ///
    /// Ends with code 1 if it does not hold for them, or a limit of --accept is not shown to be kept.
    Validate(Validate),
    /// Show by a few measurements whether a robot is as it was calibrated, and which joint is not
    ///
    /// Ends with code 1 if it changed.
    Track(Box<TrackArgs>),
    /// Calibrate every robot whose measurements lie in a folder, with a ledger of what was done
    ///
    /// Ends with code 1 if any robot failed.
    #[cfg(any(unix, windows))]
    Fleet(Box<Fleet>),
    /// Test a robot by ISO 9283: accuracy and repeatability as a data sheet states them, each with its 95 % interval
    ///
    /// Ends with code 1 if a limit of --accept is not shown to be kept.
    Iso9283(Box<Iso9283Args>),
    /// Compare two calibrations of one robot: what changed, and what is noise
    ///
    /// Ends with code 1 if the tip moved by more than the limit.
    Compare(Compare),
    /// Predict poses from joint readings
    Predict(Predict),
    /// Show how a model and measurement files are understood
    Check(CheckArgs),
    /// Write measurements of any form as a table of poecal's, and beside it how they were read
    Import(Import),
    /// Write a robot in the form of a controller, a driver or a simulator, or its numbers into a URDF
    Export(Export),
    /// Correct a program for the nominal robot so that the actual one reaches the programmed poses
    Compensate(Compensate),
    /// Explain how a robot differs from its model by joint offsets
    Offsets(OffsetsArgs),
    /// Repeat the experiment of a paper and check its claims, or show the effect of gross errors
    Reproduce(Reproduce),
    /// Choose the configurations to measure: which, how many, and the error to expect; or judge a list of them
    Plan(Box<PlanArgs>),
    /// Judge measurements while they are made: is a row wrong, what to measure next, is it enough
    ///
    /// Ends with code 0 where the error of --target-error is reached, or --batch the rows are as expected; 1 where it is not, or a row is named.
    Watch(Box<WatchArgs>),
    /// Print the JSON Schema of calibration.json
    Schema,
    /// Print a script with which a shell completes the program's commands, options and words
    Completions(Completions),
    /// Print the manual page of the program, or of a command
    Man(Man),
}

/// Arguments of `poecal completions`.
#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

/// Arguments of `poecal man`.
#[derive(Args, Debug)]
pub(crate) struct Man {
    /// The command [default: the program itself]
    pub(crate) command: Option<String>,
}

/// Arguments of `poecal compare`.
#[derive(Args, Debug)]
pub(crate) struct Compare {
    /// The first calibration (calibration.json)
    pub(crate) first: PathBuf,
    /// The second calibration of the same robot (calibration.json)
    pub(crate) second: PathBuf,
    /// Largest motion of the tip (RMS), like 0.5mm; end with code 1 if it moved further [default: the expected errors of both together].
    /// NAME=N is what a file may take, as for all commands
    #[arg(long, value_name = "LENGTH", value_parser = limit_of_change, allow_hyphen_values = true)]
    limit: Vec<LimitArgument>,
    /// Print each joint with its test against noise, and the errors of both
    #[arg(long)]
    pub(crate) verbose: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}

impl Compare {
    /// Largest motion of the tip, metres, as stated last.
    pub(crate) fn limit_m(&self) -> Option<f64> {
        self.limit
            .iter()
            .rev()
            .find_map(|it| if let LimitArgument::Change(limit_m) = it { Some(*limit_m) } else { None })
    }
}

/// Arguments of `poecal validate`.
#[derive(Args, Debug)]
pub(crate) struct Validate {
    /// Calibration to judge (calibration.json)
    pub(crate) calibration: PathBuf,
    /// Measurement files (CSV, xlsx, or as instruments and recorders write them), joined; every row counts
    #[arg(required = true)]
    pub(crate) measurements: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) meaning: MeaningArgs,
    /// Refit to these measurements: the frame of the measuring device, the targets on the tool, or both; auto refits the device where the rows show that
    /// it stands elsewhere, which is stated otherwise
    #[arg(long, value_parser = one_of(REFIT), value_name = "WHAT", value_delimiter = ',', help_heading = JUDGED)]
    pub(crate) refit: Vec<RefitChoice>,
    /// End with code 1 unless the measurements confirm this: `good` if 80 % of all errors are inside their own 95 % bounds and the error
    /// (RMS) is at most twice the expected one; `inside_sampled_range` if that holds of the rows inside the sampled range
    #[arg(long, value_parser = one_of(REQUIRED_LEVEL), value_name = "VERDICT", help_heading = JUDGED)]
    pub(crate) require: Option<Level>,
    /// End with code 1 unless the calibration clearly predicts these measurements better than the nominal model, device frame and targets fitted
    /// for both, with 95 % confidence
    #[arg(long, help_heading = JUDGED)]
    pub(crate) require_gain: bool,
    /// Limits that the errors must meet, like 0.2mm or 0.2mm,max:0.5mm,0.05deg: rms (the default), p95 or max of all errors in a unit. End with
    /// code 1 unless each is shown to be kept, with 95 % confidence
    #[arg(long, value_name = "[rms:|p95:|max:]LIMIT", value_delimiter = ',', help_heading = JUDGED)]
    pub(crate) accept: Vec<ErrorLimit>,
    /// Which model must meet them: the corrected one, if there is one (the default), or the calibrated one, which a URDF holds
    #[arg(long, value_parser = one_of(MODEL), help_heading = JUDGED)]
    pub(crate) accept_model: Option<AcceptedModel>,
    /// Folder for the results of the check: validation.json, errors.csv with each row beside its bound, and a report
    #[arg(long, value_name = "DIR", help_heading = RESULTS)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results of a check in an existing folder, and a report that exists
    #[arg(long, help_heading = RESULTS)]
    pub(crate) force: bool,
    /// File for the report, or `none` [default: report.html among the results]
    #[arg(long, value_name = "FILE|none", help_heading = RESULTS)]
    pub(crate) report: Option<ReportPlace>,
    /// Entries of the report on this session, like operator=Mia (repeatable): the keys of `poecal calibrate`
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair, help_heading = RESULTS)]
    pub(crate) record: Vec<(String, String)>,
    /// File to which the check is appended as a line, or `none` [default: history.jsonl beside the calibration]
    #[arg(long, value_name = "FILE|none", help_heading = RESULTS)]
    pub(crate) history: Option<ReportPlace>,
    /// Print JSON instead of the table
    #[arg(long, help_heading = RESULTS)]
    pub(crate) json: bool,
}

impl Validate {
    /// All input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let files = std::iter::once(&self.calibration).chain(&self.measurements);
        files.map(PathBuf::as_path).chain(self.meaning.files()).collect()
    }
}

/// Arguments of `poecal predict`.
#[derive(Args, Debug)]
pub(crate) struct Predict {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    /// Joint readings (CSV, xlsx, or as controllers and recorders write them); other columns than the joints' and `id` are ignored
    pub(crate) joints: PathBuf,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    /// The frame of the poses
    #[arg(long, value_parser = one_of(PREDICT_IN), default_value = "base")]
    pub(crate) output_frame: PredictionFrame,
    /// Add the expected error of each prediction, and whether it lies in the sampled range (of a calibration.json); without --target of the first
    /// target that was measured
    #[arg(long)]
    pub(crate) with_uncertainty: bool,
    /// Which model of a calibration predicts: the corrected one, if there is one, or the calibrated one, which a URDF holds
    #[arg(long = "model", value_parser = one_of(MODEL), default_value = "corrected")]
    pub(crate) of: AcceptedModel,
    /// Predict this target of the model, or the `tip` [default: the tip, but for --with-uncertainty]; of a URDF, with its link
    #[arg(long, value_name = "NAME|NAME=LINK")]
    pub(crate) target: Option<String>,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}

/// Arguments of `poecal check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json [default: from the settings]
    pub(crate) model: Option<PathBuf>,
    /// Measurement files (CSV, xlsx, or as instruments and recorders write them) [default: from the settings]
    pub(crate) measurements: Vec<PathBuf>,
    /// Settings (TOML); those that are no options of this command are ignored [default: poecal.toml in this folder, if no model is named]
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    /// The measuring device's frame: `base` looks for mistakes in it too
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown")]
    pub(crate) device_frame: DeviceFrameKnowledge,
    /// Print JSON instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Arguments of `poecal import`.
#[derive(Args, Debug)]
pub(crate) struct Import {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json [default: from the settings]
    pub(crate) model: Option<PathBuf>,
    /// Measurement files, of instruments, controllers and recorders as they are [default: from the settings]
    pub(crate) measurements: Vec<PathBuf>,
    /// Settings (TOML), as the .map.toml of an earlier run [default: poecal.toml in this folder, if no model is named]
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    /// The table to write (CSV); how it was made goes to NAME.map.toml beside it
    #[arg(id = "table", long = "out", value_name = "FILE", help_heading = RESULTS)]
    pub(crate) out: PathBuf,
    /// Write over files that exist
    #[arg(long, help_heading = RESULTS)]
    pub(crate) force: bool,
}

/// Arguments of `poecal export`.
#[derive(Args, Debug)]
pub(crate) struct Export {
    /// The calibration (calibration.json), or another model
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    /// The form [default: by the extension of --out, and URDF with --onto]
    #[arg(long, value_parser = export_form(), long_help = export_form_help())]
    pub(crate) format: Option<ExportForm>,
    /// Which model of the calibration: geometry alone, or the corrected one, whose terms of the joints go to a file beside, FILE.joints.json
    #[arg(long = "model", value_parser = one_of(MODEL), default_value = "calibrated")]
    pub(crate) of: AcceptedModel,
    /// The URDF into which the numbers are written [default: the one that was calibrated]; for --format urdf
    #[arg(long, value_name = "ROBOT.urdf")]
    pub(crate) onto: Option<PathBuf>,
    /// Write the screws and home pose of the robot with this added to the joint's value, like joint2=0.5deg or slide=1.2mm
    /// (repeatable). Mimic joints that follow it stay: an error of its encoder would move them too
    #[arg(long, value_name = "JOINT=ANGLE|LENGTH", conflicts_with = "onto")]
    pub(crate) offset: Vec<String>,
    /// The controller's checksum, which the driver compares, like calib_12788084448423163542; for --format ur
    #[arg(long)]
    pub(crate) hash: Option<String>,
    /// The calibration of motors whose offsets are corrected; for --format lerobot
    #[arg(long, value_name = "FILE")]
    pub(crate) motors: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}
