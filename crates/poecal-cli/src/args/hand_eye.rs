//! Arguments of `poecal hand-eye`.

use std::path::{Path, PathBuf};

use clap::Args;
use poecal::hand_eye::CameraPlace;
use poecal::io::hand_eye::FrameNames;
use poecal::io::measurements::PoseUnits;

use super::words::{FLANGE_POSES, HAND_EYE_CAMERA, TARGET_POSES, one_of};

/// Arguments of `poecal hand-eye`.
#[derive(Args, Debug)]
pub(crate) struct HandEye {
    /// Poses (CSV): one file with those of the arm and of the target side by side, or two files, the arm's and the target's, joined by a column
    /// `image` or row by row
    #[arg(required = true, num_args = 1..=2, value_name = "POSES")]
    pub(crate) poses: Vec<PathBuf>,
    /// Where the camera is
    #[arg(long, value_parser = one_of(HAND_EYE_CAMERA))]
    pub(crate) camera: CameraPlace,
    /// Units of columns that state none, like mm,deg
    #[arg(long, value_name = "LENGTH[,ANGLE]", default_value = "", hide_default_value = true, value_parser = units)]
    pub(crate) units: PoseUnits,
    /// Which way round the arm's poses are [default: found]
    #[arg(long, value_parser = one_of(FLANGE_POSES))]
    pub(crate) flange: Option<bool>,
    /// Which way round the target's poses are [default: found]
    #[arg(long, value_parser = one_of(TARGET_POSES))]
    pub(crate) target: Option<bool>,
    /// Names of base, flange, camera and target in what is written
    #[arg(long, value_name = "BASE,FLANGE,CAMERA,TARGET", value_parser = names, default_value = "base_link,tool0,camera_color_optical_frame,target")]
    pub(crate) frames: FrameNames,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite the results of an earlier run in the folder
    #[arg(long)]
    pub(crate) force: bool,
    /// Print hand_eye.json instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

impl HandEye {
    /// The input files.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        self.poses.iter().map(PathBuf::as_path).collect()
    }
}

/// Parser of units for clap.
pub(super) fn units(text: &str) -> Result<PoseUnits, String> {
    if text.is_empty() {
        return Ok(PoseUnits::default());
    }
    text.parse().map_err(|error: poecal::Error| error.to_string())
}

/// Parser of the names of frames for clap.
fn names(text: &str) -> Result<FrameNames, String> {
    let is_plain = |name: &&str| {
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-/.".contains(c))
    };
    let names: Vec<&str> = text.split(',').map(str::trim).filter(is_plain).collect();
    match names.as_slice() {
        [base, flange, camera, target] => {
            let [base, flange, camera, target] = [base, flange, camera, target].map(|it| (*it).to_owned());
            Ok(FrameNames { base, flange, camera, target })
        }
        _ => Err(format!(
            "found `{text}`, expected four names of letters, digits, `_`, `-`, `/` and `.`, like base_link,tool0,camera,board"
        )),
    }
}

/// Arguments of `poecal tcp`.
#[derive(Args, Debug)]
pub(crate) struct Tcp {
    /// Poses of the flange (CSV) in which the tip touched a fixed point; a column `point` for several points, a column `tip` for two tips along the
    /// tool, which show its direction
    pub(crate) poses: PathBuf,
    /// Units of columns that state none, like mm,deg
    #[arg(long, value_name = "LENGTH[,ANGLE]", default_value = "", hide_default_value = true, value_parser = units)]
    pub(crate) units: PoseUnits,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite the results of an earlier run in the folder
    #[arg(long)]
    pub(crate) force: bool,
    /// Print tcp.json instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}
