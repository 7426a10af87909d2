//! Arguments of `poecal offsets`.

use std::path::PathBuf;

use clap::Args;
use poecal_model::offsets::End;

use super::shared::{ChainArgs, OutFile};
use super::words::{END, one_of};

/// Arguments of `poecal offsets`.
#[derive(Args, Debug)]
pub(crate) struct Offsets {
    /// Nominal robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) nominal: PathBuf,
    /// Model of the actual robot, with the same joints: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) actual: PathBuf,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// The base frame [default: free for a calibration whose device stood anywhere, else kept]
    #[arg(long, value_parser = one_of(END))]
    pub(crate) base: Option<End>,
    /// The tip frame [default: free for a calibration, else kept]
    #[arg(long, value_parser = one_of(END))]
    pub(crate) tip: Option<End>,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: OutFile,
}
