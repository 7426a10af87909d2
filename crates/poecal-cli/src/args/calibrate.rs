//! Arguments of `poecal calibrate`.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal_calibrate::{
    AcceptanceLimit, AcceptedModel, Corrections, DeviceFrameKnowledge, Level, RepairLimit, Repairs, RobustLoss,
};
use poecal_lou2009::{Method, PaperFormulation, PaperResidual};
use poecal_model::robot::GravityDirection;
use poecal_results::output::ExistingFiles;
use poecal_results::record::Record;

use super::report::ReportPlace;
use super::shared_args::{FIT, JUDGED, RESULTS, ReadingArgs, TreeArgs};
use crate::quantity::{BelievedTolerance, parse_count, share, sigma_m, sigma_rad};
use crate::words::{FORMULATION, FRAME, METHOD, MODEL, REPAIR, REQUIRED_LEVEL, RESIDUAL, ROBUST, one_of};

/// Arguments of `poecal calibrate`.
#[derive(Args, Debug)]
pub(crate) struct Calibrate {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json [default: from the settings]
    pub(crate) model: Option<PathBuf>,
    /// Measurement files (CSV, xlsx, or as instruments and recorders write them), joined [default: from the settings]
    pub(crate) measurements: Vec<PathBuf>,
    /// Settings (TOML) for options that are not given here [default: poecal.toml in this folder, if no model is named]
    #[arg(long, value_name = "FILE")]
    pub(crate) settings: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    /// The measuring device's frame
    #[arg(long, value_parser = one_of(FRAME), default_value = "unknown", help_heading = FIT)]
    pub(crate) device_frame: DeviceFrameKnowledge,
    /// Standard deviation of each measured position component, like 0.05mm [default: estimated from the data]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true, help_heading = FIT)]
    pub(crate) sigma_position: Option<f64>,
    /// Standard deviation of each measured rotation component, like 0.01deg [default: estimated from the data]
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true, help_heading = FIT)]
    pub(crate) sigma_rotation: Option<f64>,
    /// Deviations of the axes from the model (the prior): standard deviations of their directions and places, or none. They matter only
    /// where the measurements leave an axis open, which then stays near the model. auto chooses by cross-validation among 0.05deg,0.5mm,
    /// 0.2deg,2mm, 0.5deg,5mm, 1deg,10mm and 3deg,10mm. A joint of a TOML model may state its own. MOC.cfg of an ABB controller with Absolute
    /// Accuracy has the deviations that the maker found
    #[arg(long, value_name = "ANGLE,LENGTH|none|auto|MOC.cfg", default_value = "0.5deg,5mm", help_heading = FIT)]
    pub(crate) tolerance: BelievedTolerance,
    /// Joint effects beyond geometry: auto fits the terms that predict rows best which were not fitted, all looks
    /// among more of them; groups of terms with their sizes
    /// in radians or metres, sag, tilt, ratio, harmonics, wobble, backlash, factors, payload, shift, runout
    #[arg(long, value_name = "auto|all|off|GROUP[=SIZE],...", default_value = "auto", help_heading = FIT)]
    pub(crate) corrections: Corrections,
    /// Highest order of the harmonics of a turn among these terms, 1 to 8
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8), help_heading = FIT)]
    pub(crate) harmonics: u8,
    /// Further columns of the measurements on which terms may depend, like temperature; approach or approach_JOINT says from which side joints
    /// came, 1 or -1, and payload which mass hangs at the tip, in kg
    #[arg(long, value_name = "COLUMN", value_delimiter = ',', help_heading = FIT)]
    pub(crate) factors: Vec<String>,
    /// Direction of gravity in the robot's base frame, like 0,0,1 for a robot on the ceiling; find takes the direction with which the terms
    /// leave the least noise
    #[arg(long, value_name = "X,Y,Z|find", default_value = "0,0,-1", allow_hyphen_values = true, help_heading = FIT)]
    pub(crate) gravity: GravityDirection,
    /// Blocks to hold as in the model: joints, targets, frames, or names like joint2.axis, in which * stands for any letters
    #[arg(long, value_name = "NAME", value_delimiter = ',', help_heading = FIT)]
    pub(crate) fix: Vec<String>,
    /// Blocks to fit, also those that are usually held, like joint2.offset, and after --fix: `--fix joints --free joint2`. A target that is named
    /// may be anywhere, not only near the tip: `--free targets`
    #[arg(long, value_name = "NAME", value_delimiter = ',', help_heading = FIT)]
    pub(crate) free: Vec<String>,
    /// Put the tip where the measured point is, for a model that ends in its reflector. Otherwise the links beyond the last joint stay as in the
    /// model, and the point is the target `measured`
    #[arg(long, help_heading = FIT)]
    pub(crate) move_tip: bool,
    /// Share of the configurations held out at random, unless a column `set`, --train-where or --validate chooses them; 0 fits every row [default: 0.3;
    /// 0 if fewer than 12 would be held out, but for pictures, rows in motion and --accept]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_hyphen_values = true, help_heading = JUDGED)]
    pub(crate) held_out: Option<f64>,
    /// Seed of that choice [default: 1]
    #[arg(long, value_parser = parse_count::<u64>, help_heading = JUDGED)]
    pub(crate) seed: Option<u64>,
    /// Treatment of outliers: auto fits by least squares, and by the tukey loss where that shows outliers
    #[arg(long, value_parser = one_of(ROBUST), default_value = "auto", help_heading = FIT)]
    pub(crate) robust: RobustLoss,
    /// Treatment of a device, a target, a nest or a joint's zero that moved during the session, and of configurations that are wrong as a whole
    #[arg(long, value_parser = one_of(REPAIR), default_value = "auto", help_heading = FIT)]
    pub(crate) repair: Repairs,
    /// Largest repair of a device (usually 50 mm), a tool (20 mm) or a zero (5 deg), with its turn as an arc at a third of the robot's reach; what is
    /// larger is named
    #[arg(long, value_name = "THING=SIZE", value_delimiter = ',', help_heading = FIT)]
    pub(crate) repair_limit: Vec<RepairLimit>,
    /// Parameterisation of joint errors; all but the default are for comparison
    #[arg(long, value_parser = one_of(FORMULATION), default_value = "adjoint", hide = true)]
    pub(crate) formulation: PaperFormulation,
    /// Residual of measured frames; the paper's is for comparison. Points have one residual only
    #[arg(long, value_parser = one_of(RESIDUAL), default_value = "tool", hide = true)]
    pub(crate) residual: PaperResidual,
    /// Steps of the solver; plain Gauss-Newton may diverge [default: gauss-newton for formulations with free screws, else
    /// levenberg-marquardt]
    #[arg(long, value_parser = one_of(METHOD), hide = true)]
    pub(crate) method: Option<Method>,
    /// Measurement file to judge by: all other rows are fitted
    #[arg(long, value_name = "FILE", conflicts_with = "train_where", help_heading = JUDGED)]
    pub(crate) validate: Vec<PathBuf>,
    /// Folder for the results [default: poecal-out; if it is there and --force is not stated, poecal-out-2, and so on]
    #[arg(long, value_name = "DIR", help_heading = RESULTS)]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results in an existing folder, and a report that exists
    #[arg(long, help_heading = RESULTS)]
    pub(crate) force: bool,
    /// Overwrite them where poecal wrote them: the meaning of `force` in the settings
    #[arg(long, hide = true)]
    pub(crate) force_own: bool,
    /// File for the report, or `none` [default: report.html among the results]
    #[arg(long, value_name = "FILE|none", help_heading = RESULTS)]
    pub(crate) report: Option<ReportPlace>,
    /// End with code 1 if the verdict is worse than this (results are written all the same); it also does if the verdict is `do not use`
    #[arg(long, value_parser = one_of(REQUIRED_LEVEL), value_name = "VERDICT", help_heading = JUDGED)]
    pub(crate) require: Option<Level>,
    /// End with code 1 unless the result clearly predicts better than the nominal model anywhere inside the sampled range, with 95 % confidence
    #[arg(long, help_heading = JUDGED)]
    pub(crate) require_gain: bool,
    /// Limits that the errors of rows that were not fitted must meet, like 0.2mm or 0.2mm,max:0.5mm,0.05deg: rms (the default), p95 or max of all
    /// errors in a unit. End with code 1 unless each is shown to be kept, with 95 % confidence
    #[arg(long, value_name = "[rms:|p95:|max:]LIMIT", value_delimiter = ',', help_heading = JUDGED)]
    pub(crate) accept: Vec<AcceptanceLimit>,
    /// Which model must meet them: the corrected one, if there is one (the default), or the calibrated one, which a URDF holds
    #[arg(long, value_parser = one_of(MODEL), help_heading = JUDGED)]
    pub(crate) accept_model: Option<AcceptedModel>,
    /// Entries of the report on the session, like serial=4711 (repeatable): certificate, laboratory, customer, robot, serial, instrument,
    /// instrument_calibrated, tool, payload, speed, warm_up, operator, date, place, temperature, valid_until or note
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair, help_heading = RESULTS)]
    pub(crate) record: Vec<(String, String)>,
    /// Print everything: errors of fitted rows and of the nominal model, noise, solver, cross-validation, every joint
    #[arg(long, help_heading = RESULTS)]
    pub(crate) verbose: bool,
    /// Print the calibration as JSON instead of the table
    #[arg(long, help_heading = RESULTS)]
    pub(crate) json: bool,
    /// Print where the time went, as a line of JSON on standard error; the solve is repeated for that
    #[arg(long, hide = true)]
    pub(crate) timings: bool,
}

impl Calibrate {
    /// Treatment of existing results.
    pub(crate) fn existing(&self) -> ExistingFiles {
        if self.force_own && !self.force { ExistingFiles::Own } else { ExistingFiles::from_switch(self.force) }
    }

    /// All input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let files = self.model.iter().chain(&self.measurements).chain(&self.validate).chain(&self.settings);
        files.map(PathBuf::as_path).chain(self.reading.meaning.files()).collect()
    }
}
