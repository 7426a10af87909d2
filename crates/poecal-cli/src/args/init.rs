//! Arguments of `poecal init`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use poecal::simulate::Kind;

use super::shared::ChainArgs;
use crate::quantity::whole;

/// What will be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Measured {
    /// Positions of a target, as a laser tracker sees them
    Points,
    /// Positions and orientations
    Poses,
}

impl From<Measured> for Kind {
    fn from(measured: Measured) -> Self {
        match measured {
            Measured::Points => Kind::Point,
            Measured::Poses => Kind::Pose,
        }
    }
}

/// Arguments of `poecal init`.
#[derive(Args, Debug)]
pub(crate) struct Init {
    /// Robot model: URDF, TOML or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// Kind of the measurements
    #[arg(long, value_enum, default_value = "points")]
    pub(crate) measure: Measured,
    /// Number of configurations to suggest
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) count: u32,
    /// Seed of their choice
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    pub(crate) seed: u64,
    /// Folder for the project; files in it are never overwritten
    #[arg(short, long, value_name = "DIR", default_value = "poecal-project")]
    pub(crate) out: PathBuf,
}
