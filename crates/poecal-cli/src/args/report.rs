//! Arguments of `poecal report`, and place of the report of `poecal calibrate`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use poecal_results::record::Record;

/// Place of a calibration's report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ReportPlace {
    /// Nowhere.
    None,
    /// Into this file.
    File(PathBuf),
}

impl FromStr for ReportPlace {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(if text == "none" { ReportPlace::None } else { ReportPlace::File(text.into()) })
    }
}

/// Arguments of `poecal report`.
#[derive(Args, Debug)]
pub(crate) struct Report {
    /// calibration.json, with the residuals.csv that was written with it in the same folder
    pub(crate) calibration: PathBuf,
    /// residuals.csv, where it lies elsewhere
    #[arg(long, value_name = "FILE", conflicts_with = "certificate")]
    pub(crate) residuals: Option<PathBuf>,
    /// Write the certificate instead, one page of paper: errors before and after, limits, ranges, who and what
    #[arg(long)]
    pub(crate) certificate: bool,
    /// Picture for the head of the certificate: PNG, JPEG or SVG
    #[arg(long, value_name = "FILE", requires = "certificate")]
    pub(crate) logo: Option<PathBuf>,
    /// File to write, a new one or one of poecal [default: report.html or certificate.html beside the calibration]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Entries beside and in place of those of the calibration's record, like serial=4711 or valid_until=2027-11-28
    /// (repeatable)
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair)]
    pub(crate) record: Vec<(String, String)>,
    /// Write over any file that exists
    #[arg(long)]
    pub(crate) force: bool,
}
