//! Arguments of `poecal track`.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal_results::record::Record;

use super::ReportPlace;
use super::shared_args::{JUDGED, MeaningArgs, RESULTS};
use crate::quantity::sigma_m;
use crate::words::{DEVICE, TOOL, one_of};

/// Arguments of `poecal track`.
#[derive(Args, Debug)]
pub(crate) struct TrackArgs {
    /// The calibration (calibration.json)
    pub(crate) calibration: PathBuf,
    /// Measurements of the visit, preferably of configurations of the calibration
    #[arg(required_unless_present = "plan")]
    pub(crate) measurements: Vec<PathBuf>,
    /// Rows of an earlier visit whose configurations are repeated [default: the measurements that the calibration was made of, by their SHA-256]
    #[arg(long, value_name = "OLD.csv", help_heading = JUDGED)]
    pub(crate) reference: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) meaning: MeaningArgs,
    /// State of the measuring device: known if it did not move [default: known where the calibration was made in the base frame]
    #[arg(long, value_parser = one_of(DEVICE), value_name = "WHERE", action = clap::ArgAction::Set, help_heading = JUDGED)]
    pub(crate) device: Option<bool>,
    /// State of the tool with its targets: same if it stayed on the flange
    #[arg(long, value_parser = one_of(TOOL), value_name = "HOW", default_value = "same", action = clap::ArgAction::Set, help_heading = JUDGED)]
    pub(crate) tool: bool,
    /// Standard deviation of one visit and coordinate, like 0.03mm, as measured by repeats [default: what repeats within a visit and what no
    /// explanation takes away]
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, help_heading = JUDGED)]
    pub(crate) repeatability: Option<f64>,
    /// Choose so many of the earlier configurations that their repeats show the smallest shift of the worst joint, and print what each would show
    #[arg(long, value_name = "N", conflicts_with_all = ["measurements", "recalibrate", "history"], value_parser = clap::value_parser!(u16).range(2..=200))]
    pub(crate) plan: Option<u16>,
    /// The target that will be measured [default: all of the earlier rows]; with --plan
    #[arg(long, value_name = "NAME", requires = "plan")]
    pub(crate) target: Option<String>,
    /// Calibrate the zero of this joint anew (JOINT or JOINT.offset), or its axis (JOINT.axis), and hold all else; with --out
    #[arg(long, value_name = "JOINT[.offset|.axis]", requires = "out", conflicts_with_all = ["history", "json"], help_heading = RESULTS)]
    pub(crate) recalibrate: Option<String>,
    /// File to write: with --plan the table of configurations (CSV), with --recalibrate the new calibration.json
    #[arg(long, value_name = "FILE", help_heading = RESULTS)]
    pub(crate) out: Option<PathBuf>,
    /// Write over a file that exists
    #[arg(long, help_heading = RESULTS)]
    pub(crate) force: bool,
    /// File for the page of the visit: then and now, on one page of A4 to sign
    #[arg(long, value_name = "FILE", conflicts_with_all = ["plan", "recalibrate"], help_heading = RESULTS)]
    pub(crate) report: Option<PathBuf>,
    /// Entries of the page on this visit, like operator=Mia (repeatable): the keys of `poecal calibrate`
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair, conflicts_with_all = ["plan", "recalibrate"], help_heading = RESULTS)]
    pub(crate) record: Vec<(String, String)>,
    /// File to which the check is appended as a line, or `none` [default: history.jsonl beside the calibration]
    #[arg(long, value_name = "FILE|none", help_heading = RESULTS)]
    pub(crate) history: Option<ReportPlace>,
    /// Print JSON instead of the table
    #[arg(long, help_heading = RESULTS)]
    pub(crate) json: bool,
}

impl TrackArgs {
    /// All input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let files = std::iter::once(&self.calibration).chain(&self.measurements).chain(&self.reference);
        files.map(PathBuf::as_path).chain(self.meaning.files()).collect()
    }
}
