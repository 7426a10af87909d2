//! Arguments of `poecal iso9283`.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal_calibrate::FigureLimit;
use poecal_results::iso9283::TestFrame;
use poecal_results::record::Record;

use super::shared_args::{ChainArgs, FIT, JUDGED, MeaningArgs, RESULTS, TextOutput};
use crate::quantity::{sigma_m, sigma_rad};
use crate::words::{TEST_FRAME, one_of};

/// Arguments of `poecal iso9283`.
#[derive(Args, Debug)]
pub(crate) struct Iso9283Args {
    /// Rows of the test (CSV, xlsx, or as instruments and recorders write them), joined: commanded and measured pose, and columns pose, cycle,
    /// approach, series, arm, speed, payload, as far as there are any
    #[arg(required = true)]
    pub(crate) measurements: Vec<PathBuf>,
    /// Robot whose joint readings the rows have instead of commanded_x, commanded_y, commanded_z; of a calibration.json also the accuracy to
    /// expect of corrected commands
    #[arg(long, value_name = "MODEL")]
    pub(crate) robot: Option<PathBuf>,
    /// Rows of the same test before the calibration, whose figures stand beside; with --robot calibration.json also what these rows predict of corrected
    /// commands (repeatable)
    #[arg(long, value_name = "BEFORE.csv")]
    pub(crate) reference: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    #[command(flatten)]
    pub(crate) meaning: MeaningArgs,
    /// The measuring device's frame, in which accuracy is stated
    #[arg(long, value_parser = one_of(TEST_FRAME), default_value = "unknown", help_heading = FIT)]
    pub(crate) device_frame: TestFrame,
    /// Standard deviation of the instrument in each position component, like 0.01mm, for rows that state none: repeatability is stated without it too
    #[arg(long, value_name = "LENGTH", value_parser = sigma_m, allow_hyphen_values = true, help_heading = FIT)]
    pub(crate) sigma_position: Option<f64>,
    /// The same of rotation components, like 0.01deg
    #[arg(long, value_name = "ANGLE", value_parser = sigma_rad, allow_hyphen_values = true, help_heading = FIT)]
    pub(crate) sigma_rotation: Option<f64>,
    /// Limits that figures must keep, like AP:0.5mm or RP:0.05mm,AP:0.1deg. End with code 1 unless each is shown to be kept at every pose, with
    /// 95 % confidence
    #[arg(long, value_name = "FIGURE:LIMIT", value_delimiter = ',', help_heading = JUDGED)]
    pub(crate) accept: Vec<FigureLimit>,
    /// Entries of the report on the test, like payload="10 kg", warm_up="1 h" or instrument=AT960 (repeatable): the keys of `poecal calibrate`
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair, help_heading = RESULTS)]
    pub(crate) record: Vec<(String, String)>,
    /// Write a page (HTML) with all figures, the cube and the scatter of each pose; its print begins with a certificate
    #[arg(long, value_name = "FILE", help_heading = RESULTS)]
    pub(crate) report: Option<PathBuf>,
    /// Write the certificate alone as the page, one page of paper
    #[arg(long, requires = "report", help_heading = RESULTS)]
    pub(crate) certificate: bool,
    /// Print JSON instead of the table
    #[arg(long, help_heading = RESULTS)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}

impl Iso9283Args {
    /// All input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        self.measurements
            .iter()
            .chain(&self.reference)
            .chain(&self.robot)
            .map(PathBuf::as_path)
            .chain(self.meaning.files())
            .collect()
    }
}
