//! Arguments of `poecal certificate`.

use std::path::PathBuf;

use clap::Args;
use poecal_results::record::Record;

/// Arguments of `poecal certificate`.
#[derive(Args, Debug)]
pub(crate) struct Certificate {
    /// calibration.json
    pub(crate) calibration: PathBuf,
    /// File to write, a new one or a certificate of poecal [default: certificate.html beside the calibration]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Picture for its head: PNG, JPEG or SVG
    #[arg(long, value_name = "FILE")]
    pub(crate) logo: Option<PathBuf>,
    /// Day until which it is valid, like 2027-11-28
    #[arg(long, value_name = "DATE")]
    pub(crate) valid_until: Option<String>,
    /// What it states, beside and in place of what the calibration's record states, like serial=4711 (repeatable)
    #[arg(long, value_name = "KEY=TEXT", value_parser = Record::pair)]
    pub(crate) record: Vec<(String, String)>,
    /// Write over any file that exists
    #[arg(long)]
    pub(crate) force: bool,
}
