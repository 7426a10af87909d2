//! The command line.

mod identify;
mod report;

pub(crate) use identify::Identify;
pub(crate) use report::{Report, ReportPlace};

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use poecal::calibration::{Level, Loss, Robust};
use poecal::io::measurements::{ColumnMap, ReadOptions};
use poecal::io::model::ModelFormat;
use poecal::io::predictions::PredictionFrame;
use poecal::io::urdf::ChainSelection;
use poecal::measurement::PoseResidual;
use poecal::offsets;
use poecal::parameters::Formulation;
use poecal::simulate::Kind;
use poecal::solve::Method;

use crate::quantity::{LengthAndAngle, share, sigma_m, sigma_rad, whole};

/// Finds the robot that is really there: kinematic calibration by the product of exponentials.
#[derive(Debug, Parser)]
#[command(name = "poecal", version, arg_required_else_help = true)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print errors and data only: what --json gives, predictions and converted models
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Number of threads (results do not depend on it)
    #[arg(long, global = true, value_name = "N", value_parser = whole::<usize>)]
    pub(crate) threads: Option<usize>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Calibrate a robot from measurements
    Calibrate(Calibrate),
    /// Simulate a robot with errors and its measurements, for tests and for learning
    Simulate(Simulate),
    /// Write the report of a calibration again
    Report(Report),
    /// Judge a calibration by other measurements
    Validate(Validate),
    /// Predict poses from joint readings
    Predict(Predict),
    /// Show how a model and measurement files are understood
    Check(Check),
    /// Write a model in another form
    Convert(Convert),
    /// Explain how a robot differs from its model by joint offsets
    Offsets(Offsets),
    /// Repeat the experiment of a paper and check its claims, or show what gross errors do
    Reproduce(Reproduce),
    /// Tell what measuring in some configurations would tell, before anything is measured
    Identify(Identify),
    /// Print the JSON Schema of calibration.json
    Schema,
}

/// Which chain of a URDF.
#[derive(Args, Debug)]
pub(crate) struct Chain {
    /// First link of the chain, where a URDF has several
    #[arg(long, value_name = "LINK")]
    pub(crate) base_link: Option<String>,
    /// Last link of the chain, where a URDF has several
    #[arg(long, value_name = "LINK")]
    pub(crate) tip_link: Option<String>,
}

impl Chain {
    pub(crate) fn selection(&self) -> ChainSelection {
        ChainSelection { base_link: self.base_link.clone(), tip_link: self.tip_link.clone() }
    }
}

/// What columns of files mean.
#[derive(Args, Debug)]
pub(crate) struct Columns {
    /// Mapping file that says what the columns of other people's files mean
    #[arg(long, value_name = "MAP.toml")]
    pub(crate) columns: Option<PathBuf>,
}

impl Columns {
    pub(crate) fn options(&self) -> poecal::Result<ReadOptions> {
        let mapping = self.columns.as_ref().map(ColumnMap::read).transpose()?;
        Ok(ReadOptions { mapping, ..ReadOptions::default() })
    }
}

/// How to read measurement files.
#[derive(Args, Debug)]
pub(crate) struct Reading {
    #[command(flatten)]
    pub(crate) columns: Columns,
    /// Fit only rows whose COLUMN has one of these values, and hold out all others
    #[arg(long, value_name = "COLUMN=VALUE[,VALUE]")]
    pub(crate) fit_where: Option<String>,
}

impl Reading {
    pub(crate) fn options(&self) -> poecal::Result<ReadOptions> {
        let fit_where = self.fit_where.as_deref().map(str::parse).transpose()?;
        Ok(ReadOptions { fit_where, ..self.columns.options()? })
    }
}

/// What is known of the measuring device's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Frame {
    /// The device stands anywhere
    Unknown,
    /// Measurements are in the robot's base frame
    Base,
}

/// How errors of the joints are written as unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormulationWord {
    /// Axes move as rigid bodies, without offsets: minimal, unconstrained
    Adjoint,
    /// Screws are free numbers, normalised after every step
    Screw,
    /// Free screws and joint offsets, 7n + 6 unknowns
    ScrewOffsets,
    /// Axes as rigid bodies, and joint offsets
    AdjointOffsets,
}

impl From<FormulationWord> for Formulation {
    fn from(word: FormulationWord) -> Self {
        match word {
            FormulationWord::Adjoint => Formulation::Adjoint,
            FormulationWord::Screw => Formulation::Screw,
            FormulationWord::ScrewOffsets => Formulation::ScrewOffsets,
            FormulationWord::AdjointOffsets => Formulation::AdjointOffsets,
        }
    }
}

/// How errors of measured frames are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ResidualWord {
    /// Position and rotation at the target
    Tool,
    /// The twist about the device's origin
    Spatial,
}

impl From<ResidualWord> for PoseResidual {
    fn from(word: ResidualWord) -> Self {
        match word {
            ResidualWord::Tool => PoseResidual::Tool,
            ResidualWord::Spatial => PoseResidual::Spatial,
        }
    }
}

/// What to do about grossly wrong rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RobustWord {
    /// Least squares, unless outliers are evident: then the tukey loss, and a warning
    Auto,
    /// Least squares: every row counts in full
    Off,
    /// Far rows pull no more than near ones
    Huber,
    /// Far rows pull less the farther they are
    Cauchy,
    /// Far rows do not pull
    Tukey,
}

impl From<RobustWord> for Robust {
    fn from(word: RobustWord) -> Self {
        match word {
            RobustWord::Auto => Robust::Auto,
            RobustWord::Off => Robust::Off,
            RobustWord::Huber => Robust::Loss(Loss::Huber),
            RobustWord::Cauchy => Robust::Loss(Loss::Cauchy),
            RobustWord::Tukey => Robust::Loss(Loss::Tukey),
        }
    }
}

/// By which steps to minimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodWord {
    /// Damped steps, taken only if they help
    LevenbergMarquardt,
    /// Full steps, taken as they are
    GaussNewton,
}

impl From<MethodWord> for Method {
    fn from(word: MethodWord) -> Self {
        match word {
            MethodWord::LevenbergMarquardt => Method::LevenbergMarquardt,
            MethodWord::GaussNewton => Method::GaussNewton,
        }
    }
}

/// Arguments of `poecal calibrate`.
#[derive(Args, Debug)]
pub(crate) struct Calibrate {
    /// Robot model: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    /// Measurement files (CSV), joined
    #[arg(required = true)]
    pub(crate) measurements: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: Chain,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// The measuring device's frame
    #[arg(long, value_enum, default_value = "unknown")]
    pub(crate) frame: Frame,
    /// Standard deviation of each measured position component, like 0.05mm [default: estimated from the data]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true)]
    pub(crate) sigma_position: Option<f64>,
    /// Standard deviation of each measured rotation component, like 0.01deg [default: estimated from the data]
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true)]
    pub(crate) sigma_rotation: Option<f64>,
    /// Share of the configurations held out, where nothing else says which rows are; 0 fits every row in any case [default: 0.3]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true)]
    pub(crate) held_out: Option<f64>,
    /// Seed of that choice [default: 1]
    #[arg(long, value_parser = whole::<u64>)]
    pub(crate) seed: Option<u64>,
    /// What to do about grossly wrong rows: auto fits by least squares, and by the tukey loss where that shows outliers
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) robust: RobustWord,
    /// How errors of the joints are written; all but the default are for comparison
    #[arg(long, value_enum, default_value = "adjoint", help_heading = "Comparison")]
    pub(crate) formulation: FormulationWord,
    /// How errors of measured frames are written; the paper's is for comparison. Points have one residual only
    #[arg(long, value_enum, default_value = "tool", help_heading = "Comparison")]
    pub(crate) residual: ResidualWord,
    /// By which steps to minimise; plain Gauss-Newton may diverge [default: gauss-newton for formulations with free screws, else
    /// levenberg-marquardt]
    #[arg(long, value_enum, help_heading = "Comparison")]
    pub(crate) method: Option<MethodWord>,
    /// Measurement file to judge by: all other rows are fitted
    #[arg(long, value_name = "FILE", conflicts_with = "fit_where")]
    pub(crate) validate: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "poecal-out")]
    pub(crate) out: PathBuf,
    /// Overwrite results in an existing folder
    #[arg(long)]
    pub(crate) force: bool,
    /// File for the report, or `none` [default: report.html among the results]
    #[arg(long, value_name = "FILE|none")]
    pub(crate) report: Option<ReportPlace>,
    /// End with code 1 if the verdict is worse than this (results are written all the same)
    #[arg(long, value_enum, value_name = "VERDICT")]
    pub(crate) require: Option<RequiredLevel>,
    /// Print the calibration as JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

/// The verdicts that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RequiredLevel {
    /// Good to use anywhere within the limits
    Good,
    /// Good to use inside the sampled range, or better
    #[value(name = "inside_sampled_range")]
    InsideSampledRange,
}

impl From<RequiredLevel> for Level {
    fn from(required: RequiredLevel) -> Self {
        match required {
            RequiredLevel::Good => Level::Good,
            RequiredLevel::InsideSampledRange => Level::InsideSampledRange,
        }
    }
}

/// What a simulated device sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SimulatedKind {
    /// Positions and orientations
    Pose,
    /// Positions
    Point,
    /// Both in turn
    Mixed,
}

impl From<SimulatedKind> for Kind {
    fn from(kind: SimulatedKind) -> Self {
        match kind {
            SimulatedKind::Pose => Kind::Pose,
            SimulatedKind::Point => Kind::Point,
            SimulatedKind::Mixed => Kind::Mixed,
        }
    }
}

/// Arguments of `poecal simulate`.
#[derive(Args, Debug)]
pub(crate) struct Simulate {
    /// Robot model to deviate from: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: Chain,
    /// Angle and distance by which every axis, and the tip, is off
    #[arg(long, value_name = "ANGLE,LENGTH", default_value = "1deg,2mm", allow_hyphen_values = true)]
    pub(crate) errors: LengthAndAngle,
    /// Standard deviations of each measured component
    #[arg(long, value_name = "LENGTH,ANGLE", default_value = "0.05mm,0.01deg", allow_hyphen_values = true)]
    pub(crate) noise: LengthAndAngle,
    /// Number of measurements
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(crate) count: u32,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// What the device sees
    #[arg(long, value_enum, default_value = "pose")]
    pub(crate) kind: SimulatedKind,
    /// Where the device stands: anywhere, or at the robot's base
    #[arg(long, value_enum, default_value = "unknown")]
    pub(crate) frame: Frame,
    /// Number of further measurements, free of noise, to judge a calibration by
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=10_000_000))]
    pub(crate) held_out_count: u32,
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Overwrite files in an existing folder
    #[arg(long)]
    pub(crate) force: bool,
}

/// Arguments of `poecal validate`.
#[derive(Args, Debug)]
pub(crate) struct Validate {
    /// Calibration to judge (calibration.json)
    pub(crate) calibration: PathBuf,
    /// Measurement files (CSV), joined; every row counts
    #[arg(required = true)]
    pub(crate) measurements: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) columns: Columns,
    /// Find the measuring device's frame anew from these measurements
    #[arg(long)]
    pub(crate) refit_frame: bool,
    /// Find the targets anew from these measurements
    #[arg(long)]
    pub(crate) refit_tool: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

/// The frame of predicted poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PredictIn {
    /// The robot's base
    Base,
    /// The measuring device of a calibration
    Device,
}

impl From<PredictIn> for PredictionFrame {
    fn from(frame: PredictIn) -> Self {
        match frame {
            PredictIn::Base => PredictionFrame::Base,
            PredictIn::Device => PredictionFrame::Device,
        }
    }
}

/// Arguments of `poecal predict`.
#[derive(Args, Debug)]
pub(crate) struct Predict {
    /// Robot model: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    /// Joint readings (CSV); other columns than the joints' and `id` are left alone
    pub(crate) joints: PathBuf,
    #[command(flatten)]
    pub(crate) chain: Chain,
    #[command(flatten)]
    pub(crate) columns: Columns,
    /// The frame of the poses
    #[arg(long, value_enum, default_value = "base")]
    pub(crate) frame: PredictIn,
    /// Add the error to expect of each prediction, and whether it lies in the sampled range (of a calibration.json)
    #[arg(long)]
    pub(crate) with_uncertainty: bool,
    /// Predict this target of the model instead of the tip
    #[arg(long, value_name = "NAME")]
    pub(crate) target: Option<String>,
    /// File to write, over an old one [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// Arguments of `poecal check`.
#[derive(Args, Debug)]
pub(crate) struct Check {
    /// Robot model: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    /// Measurement files (CSV)
    pub(crate) measurements: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: Chain,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// Print JSON instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// The forms that a model can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Form {
    /// A new URDF of links, joints and a tip
    Urdf,
    /// A table of screws
    Toml,
}

impl From<Form> for ModelFormat {
    fn from(form: Form) -> Self {
        match form {
            Form::Urdf => ModelFormat::Urdf,
            Form::Toml => ModelFormat::Toml,
        }
    }
}

/// Arguments of `poecal convert`.
#[derive(Args, Debug)]
pub(crate) struct Convert {
    /// Robot model: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: Chain,
    /// The form to write [default: as the extension of --out says]
    #[arg(long, value_enum)]
    pub(crate) to: Option<Form>,
    /// Write the screws and home pose of the robot with this added to the joint's value, like joint2=0.5deg or slide=1.2mm
    /// (repeatable). Mimic joints that follow it stay: an error of its encoder would move them too
    #[arg(long, value_name = "JOINT=ANGLE|LENGTH")]
    pub(crate) offset: Vec<String>,
    /// File to write, over an old one [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// Whether a frame is the same in both models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum End {
    /// It is found with the offsets
    Free,
    /// It is the same in both
    Kept,
}

impl From<End> for offsets::End {
    fn from(end: End) -> Self {
        match end {
            End::Free => offsets::End::Free,
            End::Kept => offsets::End::Kept,
        }
    }
}

/// Arguments of `poecal offsets`.
#[derive(Args, Debug)]
pub(crate) struct Offsets {
    /// Robot model as delivered: URDF, TOML or calibration.json
    pub(crate) nominal: PathBuf,
    /// The robot that is there, with the same joints: URDF, TOML or calibration.json
    pub(crate) actual: PathBuf,
    #[command(flatten)]
    pub(crate) chain: Chain,
    /// The base frame [default: free for a calibration whose device stood anywhere, else kept]
    #[arg(long, value_enum)]
    pub(crate) base: Option<End>,
    /// The tip frame [default: free for a calibration, else kept]
    #[arg(long, value_enum)]
    pub(crate) tip: Option<End>,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    /// File to write, over an old one [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// The experiments that can be repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Experiment {
    /// Lou, Chen, Wu, Li, Jiang 2009: POE calibration of an elbow manipulator
    Lou2009,
    /// What a growing share of gross errors does to a calibration, with least squares and with each robust loss
    Breakdown,
}

/// Arguments of `poecal reproduce`.
#[derive(Args, Debug)]
pub(crate) struct Reproduce {
    /// The experiment
    #[arg(value_enum)]
    pub(crate) experiment: Experiment,
    /// Sessions by which formulations, or losses, are compared
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) trials: u32,
    /// Random starts for each formulation and size of error (lou1009)
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) starts: u32,
    /// Seed of everything random
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    pub(crate) seed: u64,
    /// Folder for the report
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Overwrite the report in an existing folder
    #[arg(long)]
    pub(crate) force: bool,
}
