//! Arguments of `poecal fleet`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};

use crate::quantity::seconds;

/// Arguments of `poecal fleet`.
#[derive(Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Fleet {
    #[command(subcommand)]
    pub(crate) command: Option<FleetCommand>,
    /// The station (TOML): inbox, results, model, settings and limits
    #[arg(required = true)]
    pub(crate) station: Option<PathBuf>,
    /// Calibrate robots again that the ledger has
    #[arg(long)]
    pub(crate) rerun: bool,
    /// Robots of this part alone, by their serial numbers, like 2/4; to a ledger of its own, `fleet.2-of-4.jsonl`
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub(crate) shard: Option<(u32, u32)>,
    /// Look into the inbox again and again after this time, like 2s, until the program is ended; a file counts when it is the same twice
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) watch: Option<Duration>,
}

/// Results made from a ledger.
#[derive(Debug, Subcommand)]
pub(crate) enum FleetCommand {
    /// Write a page and a table of the line: first-pass rate, spreads, capability, outliers, steps
    Report(FleetReport),
    /// Print what the line says of its next robot before it is measured, as settings
    Prior(FleetPrior),
}

/// Arguments of `poecal fleet report`.
#[derive(Args, Debug)]
pub(crate) struct FleetReport {
    /// The station (TOML)
    pub(crate) station: PathBuf,
    /// Ledgers to read in its place, like those of all parts; may be given again [default: the station's]
    #[arg(long, value_name = "FLEET.jsonl")]
    pub(crate) ledger: Vec<PathBuf>,
    /// The page to write; the table goes beside it, with the extension csv [default: fleet.html beside the station]
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
    /// Write over files that exist
    #[arg(long)]
    pub(crate) force: bool,
}

/// Arguments of `poecal fleet prior`.
#[derive(Args, Debug)]
pub(crate) struct FleetPrior {
    /// The station (TOML)
    pub(crate) station: PathBuf,
    /// Ledgers to read in its place; may be given again [default: the station's]
    #[arg(long, value_name = "FLEET.jsonl")]
    pub(crate) ledger: Vec<PathBuf>,
}

fn shard(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once('/').and_then(|(at, of)| Some((at.parse().ok()?, of.parse().ok()?)));
    match parts {
        Some((at, of)) if (1..=of).contains(&at) => Ok((at, of)),
        _ => Err(format!("found `{text}`, expected a part and how many there are, like 2/4")),
    }
}
