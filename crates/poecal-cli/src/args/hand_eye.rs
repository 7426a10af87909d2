//! Arguments of `poecal hand-eye`.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal_fit::hand_eye::CameraMounting;
use poecal_import::{PoseUnits, ReadOptions, camera_file};
use poecal_results::hand_eye::FrameNames;
use poecal_storage::disk::is_file;

use super::shared_args::ChainArgs;
use crate::words::{FLANGE_POSES, HAND_EYE_CAMERA, TARGET_POSES, one_of};

/// Arguments of `poecal hand-eye`.
#[derive(Args, Debug)]
pub(crate) struct HandEyeArgs {
    /// Poses (CSV or xlsx): one file with those of the arm and of the target side by side, or two files, the arm's and the target's, joined by a column
    /// `image` or row by row. Instead of the target's poses the corners of its pictures, with --lens and --markers
    #[arg(required = true, num_args = 1..=2, value_name = "POSES")]
    pub(crate) poses: Vec<PathBuf>,
    /// Place of the camera
    #[arg(long, value_parser = one_of(HAND_EYE_CAMERA))]
    pub(crate) camera: CameraMounting,
    /// Units of columns that state none, like mm,deg
    #[arg(long, value_name = "LENGTH[,ANGLE]", default_value = "", hide_default_value = true, value_parser = units)]
    pub(crate) units: PoseUnits,
    /// Which way round the arm's poses are [default: found]
    #[arg(long, value_parser = one_of(FLANGE_POSES))]
    pub(crate) flange: Option<bool>,
    /// Which way round the target's poses are [default: found]
    #[arg(long, value_parser = one_of(TARGET_POSES))]
    pub(crate) target: Option<bool>,
    /// Robot whose joint readings the file of the arm has instead of poses (URDF, MJCF, SDF or TOML). Then it is said too whether poses are predicted
    /// better if the arm is fitted with the camera
    #[arg(long, value_name = "MODEL")]
    pub(crate) robot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// Lens of corners in pixels, in the forms of --camera of poecal calibrate
    #[arg(long, value_name = "FILE[#VERSION]|unknown:WxH")]
    pub(crate) lens: Option<String>,
    /// Board of corners in pixels, as poecal calibrate has it
    #[arg(long, value_name = "FILE|BOARD")]
    pub(crate) markers: Option<String>,
    /// Names of base, flange, camera and target in what is written [default: base_link,tool0,camera_color_optical_frame,target; of a model its own]
    #[arg(long, value_name = "BASE,FLANGE,CAMERA,TARGET")]
    pub(crate) frame_names: Option<FrameNames>,
    #[command(flatten)]
    pub(crate) out: FramesOutputArgs,
}

impl HandEyeArgs {
    /// The input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let lens = self.lens.iter().filter_map(|typed| camera_file(typed)).map(|(path, _)| path);
        let board = self.markers.iter().map(Path::new).filter(|path| is_file(path));
        self.poses.iter().chain(&self.robot).map(PathBuf::as_path).chain(lens).chain(board).collect()
    }

    /// Lens and board of corners.
    pub(crate) fn pictures(&self) -> poecal_numerics::error::Result<ReadOptions> {
        let mut options = ReadOptions::default();
        if let Some(typed) = &self.lens {
            options.add_cameras(typed)?;
        }
        if let Some(typed) = &self.markers {
            options.add_boards(typed)?;
        }
        Ok(options)
    }
}

/// Parser of units for clap.
pub(super) fn units(text: &str) -> Result<PoseUnits, String> {
    if text.is_empty() {
        return Ok(PoseUnits::default());
    }
    text.parse().map_err(|error: poecal_numerics::error::Error| error.to_string())
}

/// Arguments of `poecal tcp`.
#[derive(Args, Debug)]
pub(crate) struct TcpArgs {
    /// Poses of the flange (CSV or xlsx) in which the tip touched a fixed point; a column `point` for several points, a column `tip` for two tips along the
    /// tool, which show its direction
    pub(crate) poses: PathBuf,
    /// Robot whose joint readings the file has instead of poses (URDF, MJCF, SDF or TOML)
    #[arg(long, value_name = "MODEL")]
    pub(crate) robot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// Units of columns that state none, like mm,deg
    #[arg(long, value_name = "LENGTH[,ANGLE]", default_value = "", hide_default_value = true, value_parser = units)]
    pub(crate) units: PoseUnits,
    #[command(flatten)]
    pub(crate) out: FramesOutputArgs,
}

impl TcpArgs {
    /// The input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        std::iter::once(&self.poses).chain(&self.robot).map(PathBuf::as_path).collect()
    }
}

/// Destination of the frames that were found.
#[derive(Args, Debug)]
pub(crate) struct FramesOutputArgs {
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite the results of an earlier run in the folder
    #[arg(long)]
    pub(crate) force: bool,
    /// Print the result as JSON, as the folder has it, instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}
