//! Arguments of `poecal board`.

use std::path::PathBuf;

use clap::Args;
use poecal_detect::Spec;
use poecal_detect::print::{Measured, Page};

/// Arguments of `poecal board`.
#[derive(Args, Debug)]
pub(crate) struct Board {
    /// The board: chessboard:COLSxROWS:SQUARE, charuco:COLSxROWS:SQUARE:MARKER:DICT[:legacy], circles:COLSxROWS:PITCH[:asymmetric],
    /// aprilgrid:COLSxROWS:SIZE:SPACING[:FAMILY] or tags:FAMILY:SIZE, such as charuco:5x7:36mm:18mm:DICT_6X6_250; columns and rows count squares,
    /// dots or tags
    #[arg(value_name = "SPEC")]
    pub(crate) spec: Spec,
    /// The page: a4, a3 and letter lie as the board does; a size such as 400x300mm is as stated
    #[arg(long, value_name = "a4|a3|letter|WxHmm", default_value = "a4")]
    pub(crate) page: Page,
    /// File to draw: .svg or .pdf
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// What a ruler shows on the print along x and along y, like 180.0mm,251.3mm: between the outer edges of all squares, or of the tags of a grid;
    /// from the left edge of the leftmost dot to that of the rightmost one; or of one loose tag. Prints the board with the size that it has
    #[arg(long, value_name = "X,Y")]
    pub(crate) measured: Option<Measured>,
    /// Write over a file that exists
    #[arg(long)]
    pub(crate) force: bool,
}
