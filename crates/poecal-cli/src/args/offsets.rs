//! Arguments of `poecal offsets`.

use std::path::PathBuf;

use clap::Args;
use poecal_model::offsets::EndConstraint;
use poecal_numerics::error::{ErrorKind, Result};

use super::shared_args::{ChainArgs, TextOutput};
use crate::words::{OUTER_FRAME, OuterFrame, one_of};

/// Arguments of `poecal offsets`.
#[derive(Args, Debug)]
pub(crate) struct OffsetsArgs {
    /// Nominal robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) nominal: PathBuf,
    /// Model of the actual robot, with the same joints: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    pub(crate) actual: PathBuf,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// Frames that are fitted with the offsets [default: of a calibration the tip, and the base if the device stood anywhere]
    #[arg(long, value_parser = one_of(OUTER_FRAME), value_name = "FRAME", value_delimiter = ',')]
    pub(crate) free: Vec<OuterFrame>,
    /// Frames that are the same in both [default: the others]
    #[arg(long, value_parser = one_of(OUTER_FRAME), value_name = "FRAME", value_delimiter = ',')]
    pub(crate) fix: Vec<OuterFrame>,
    /// Print JSON instead of the table
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}

impl OffsetsArgs {
    /// Statement about a frame.
    pub(crate) fn stated_constraint(&self, frame: OuterFrame) -> Result<Option<EndConstraint>> {
        match (self.free.contains(&frame), self.fix.contains(&frame)) {
            (true, true) => ErrorKind::Option.refuse("found a frame in --free and in --fix, expected one of the two"),
            (true, false) => Ok(Some(EndConstraint::Free)),
            (false, true) => Ok(Some(EndConstraint::Kept)),
            (false, false) => Ok(None),
        }
    }
}
