//! Arguments of `poecal detect`.

use std::path::PathBuf;

use clap::Args;
use poecal_detect::BoardSpec;
use poecal_detect::print::{PaperSize, PrintMeasurement};

use super::shared_args::TextOutput;

/// Heading of the options of a board on paper.
const PRINT: &str = "A board on paper";

/// Arguments of `poecal detect`.
#[derive(Args, Debug)]
pub(crate) struct Detect {
    /// Pictures (PNG, JPEG), or folders of them
    #[arg(required_unless_present = "print")]
    pub(crate) pictures: Vec<PathBuf>,
    /// The board in them: charuco:5x7:36mm:18mm:DICT_6X6_250 (squares along x and y, their side, that of a marker, dictionary; :legacy for the pattern
    /// of OpenCV before 4.6), chessboard:10x7:27mm (squares, not corners), circles:9x6:30mm (dots, pitch of the rows; :asymmetric at the end),
    /// aprilgrid:6x6:88mm:0.3 (tags, their side, what is between them as a part of it; 36h11, or :FAMILY at the end) or tags:36h11:50mm (loose tags);
    /// or a file that states it: YAML of Kalibr or industrial_calibration, settings of OpenCV (YAML, XML)
    #[arg(long, value_name = "BOARD|FILE", required_unless_present = "print")]
    pub(crate) board: Option<String>,
    /// Folder for pictures with rings around the corners or dots that were found, to look at
    #[arg(long, value_name = "FOLDER")]
    pub(crate) preview: Option<PathBuf>,
    /// Draw this board to scale instead, like charuco:5x7:36mm:18mm:DICT_6X6_250, into a file .svg or .pdf; the words are those of --board
    #[arg(long, value_name = "BOARD", conflicts_with_all = ["pictures", "board", "preview"], help_heading = PRINT)]
    pub(crate) print: Option<BoardSpec>,
    /// The paper: a4, a3 and letter lie as the board does; a size such as 400x300mm is as stated
    #[arg(long, value_name = "a4|a3|letter|WxHmm", default_value = "a4", requires = "print", help_heading = PRINT)]
    pub(crate) paper: PaperSize,
    /// Lengths by a ruler on the print along x and along y, like 180.0mm,251.3mm: between the outer edges of all squares, or of the tags of a grid;
    /// from the left edge of the leftmost dot to that of the rightmost one; or of one loose tag. Prints the board with the size that it has
    #[arg(long, value_name = "X,Y", requires = "print", help_heading = PRINT)]
    pub(crate) measured: Option<PrintMeasurement>,
    #[command(flatten)]
    pub(crate) place: TextOutput,
}
