//! Arguments of `poecal init`.

use std::path::PathBuf;

use clap::Args;
use poecal_fit::hand_eye::CameraMounting;
use poecal_model::simulate::SessionKind;

use super::shared_args::TreeArgs;
use crate::quantity::parse_count;
use crate::words::{HAND_EYE_CAMERA, one_of, parser_of_measured};

/// Choice, and the column or the word for it.
fn choice(text: &str) -> Result<(String, String), String> {
    let (what, column) = text.split_once('=').ok_or("expected what a column is for, and the column, like x=X_meas")?;
    Ok((what.trim().to_owned(), column.trim().to_owned()))
}

/// Arguments of `poecal init`.
#[derive(Args, Debug)]
pub(crate) struct Init {
    /// Robot model: URDF, MJCF, SDF, TOML, a maker's YAML or conf, or calibration.json
    #[arg(required_unless_present_any = ["hand_eye", "tcp"])]
    pub(crate) model: Option<PathBuf>,
    /// Instead of a project with a model: the file of poses for `poecal hand-eye`
    #[arg(long, value_parser = one_of(HAND_EYE_CAMERA), conflicts_with_all = ["model", "tcp"])]
    pub(crate) hand_eye: Option<CameraMounting>,
    /// Instead of a project with a model: the file of touches for `poecal tcp`
    #[arg(long, conflicts_with = "model")]
    pub(crate) tcp: bool,
    /// Instead of a project: the mapping of this file's columns (columns.toml), as poecal guesses them, to look over
    #[arg(long, value_name = "FILE", conflicts_with_all = ["hand_eye", "tcp"])]
    pub(crate) columns_from: Option<PathBuf>,
    /// A column in place of the guessed one, as joint1=shoulder_pan, x=X_meas or target=; also orientation=FORM, unit.position=mm
    #[arg(long, value_name = "WHAT=COLUMN", requires = "columns_from", value_parser = choice)]
    pub(crate) column: Vec<(String, String)>,
    /// With --columns-from: print the columns, what each is taken for, and what can be chosen, as JSON, and write nothing
    #[arg(long, requires = "columns_from")]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) chain: TreeArgs,
    /// Kind of the measurements
    #[arg(long, value_parser = parser_of_measured(), default_value = "point")]
    pub(crate) kind: SessionKind,
    /// Number of configurations to suggest
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) count: u32,
    /// Seed of their choice
    #[arg(long, default_value_t = 1, value_parser = parse_count::<u64>)]
    pub(crate) seed: u64,
    /// Folder for the project; files in it are never overwritten
    #[arg(short, long, value_name = "DIR", default_value = "poecal-project")]
    pub(crate) out: PathBuf,
}
