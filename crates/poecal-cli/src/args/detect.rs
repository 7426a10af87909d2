//! Arguments of `poecal detect`.

use std::path::PathBuf;

use clap::Args;

use super::shared::OutFile;

/// Arguments of `poecal detect`.
#[derive(Args, Debug)]
pub(crate) struct Detect {
    /// Pictures (PNG, JPEG), or folders of them
    #[arg(required = true)]
    pub(crate) pictures: Vec<PathBuf>,
    /// The board in them: charuco:5x7:36mm:18mm:DICT_6X6_250 (squares along x and y, their side, that of a marker, dictionary; :legacy for the pattern
    /// of OpenCV before 4.6), chessboard:10x7:27mm (squares, not corners), circles:9x6:30mm (dots, pitch of the rows; :asymmetric at the end),
    /// aprilgrid:6x6:88mm:0.3 (tags, their side, what is between them as a part of it; 36h11, or :FAMILY at the end) or tags:36h11:50mm (loose tags);
    /// or a file that states it: YAML of Kalibr or industrial_calibration, settings of OpenCV (YAML, XML)
    #[arg(long, value_name = "BOARD|FILE")]
    pub(crate) board: String,
    /// Folder for pictures with rings around the corners or dots that were found, to look at
    #[arg(long, value_name = "FOLDER")]
    pub(crate) preview: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) place: OutFile,
}
