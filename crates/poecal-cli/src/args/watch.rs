//! Arguments of `poecal watch`.

use std::path::PathBuf;

use clap::Args;

use super::plan::FitArgs;
use super::shared_args::{ColumnArgs, TreeArgs};
use crate::quantity::{WorkspaceChoice, error_m, parse_count};

/// Arguments of `poecal watch`.
#[derive(Args, Debug)]
pub(crate) struct WatchArgs {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    /// Measurement file (CSV) that grows while it is watched; a last line without an end is waited for
    pub(crate) measurements: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    #[command(flatten)]
    pub(crate) columns: ColumnArgs,
    #[command(flatten)]
    pub(crate) fit: FitArgs,
    /// Choose the next configuration among these (a table of joint readings) [default: random ones within the limits]
    #[arg(long, value_name = "FILE")]
    pub(crate) candidates: Option<PathBuf>,
    /// Workspace, as of poecal plan
    #[arg(long, value_name = "limits|FILE|X,Y,Z:X,Y,Zmm", default_value = "limits", allow_hyphen_values = true)]
    pub(crate) workspace: WorkspaceChoice,
    /// End with code 0 as soon as the expected error is at most this, like 0.15mm: of the corrected model, of the calibrated one without
    /// corrections
    #[arg(long, value_name = "LENGTH", value_parser = error_m)]
    pub(crate) target_error: Option<f64>,
    /// Judge the rows of a finished file, one after the other, and end
    #[arg(long)]
    pub(crate) batch: bool,
    /// Seed of everything random
    #[arg(long, default_value_t = 1, value_parser = parse_count::<u64>)]
    pub(crate) seed: u64,
    /// Print a line of JSON for each row
    #[arg(long)]
    pub(crate) json: bool,
}
