//! Arguments of `poecal init`.

use std::path::PathBuf;

use clap::Args;
use poecal::simulate::Kind;

use super::shared::TreeArgs;
use super::words::measured;
use crate::quantity::whole;

/// Arguments of `poecal init`.
#[derive(Args, Debug)]
pub(crate) struct Init {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    /// Kind of the measurements
    #[arg(long, value_parser = measured(), default_value = "points")]
    pub(crate) measure: Kind,
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
