//! Arguments of `poecal reproduce`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::quantity::parse_count;

/// The experiments that can be repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Experiment {
    /// Lou, Chen, Wu, Li, Jiang 2009: POE calibration of an elbow manipulator
    Lou2009,
    /// Effect of a growing share of gross errors on a calibration, by least squares and by each robust loss
    Breakdown,
}

/// Arguments of `poecal reproduce`.
#[derive(Args, Debug)]
pub(crate) struct Reproduce {
    /// The experiment
    #[arg(value_enum)]
    pub(crate) experiment: Experiment,
    /// Sessions by which formulations, or losses, are compared
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) trials: u32,
    /// Random starts for each formulation and size of error (lou2009)
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) starts: u32,
    /// Seed of everything random
    #[arg(long, default_value_t = 1, value_parser = parse_count::<u64>)]
    pub(crate) seed: u64,
    /// Folder for the report
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Overwrite the report in an existing folder
    #[arg(long)]
    pub(crate) force: bool,
}
