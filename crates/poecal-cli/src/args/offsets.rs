//! Arguments of `poecal offsets`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use poecal::offsets;

use super::shared::{ChainArgs, OutFile};

/// Whether a frame is the same in both models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum End {
    /// It is fitted with the offsets
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
    /// Nominal robot model: URDF, TOML or calibration.json
    pub(crate) nominal: PathBuf,
    /// Model of the actual robot, with the same joints: URDF, TOML or calibration.json
    pub(crate) actual: PathBuf,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// The base frame [default: free for a calibration whose device stood anywhere, else kept]
    #[arg(long, value_enum)]
    pub(crate) base: Option<End>,
    /// The tip frame [default: free for a calibration, else kept]
    #[arg(long, value_enum)]
    pub(crate) tip: Option<End>,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: OutFile,
}
