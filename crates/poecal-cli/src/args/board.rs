//! Arguments of `poecal board`.

use std::path::PathBuf;

use clap::Args;
use poecal_detect::Spec;
use poecal_detect::print::{Measured, Page};

/// Arguments of `poecal board`.
#[derive(Args, Debug)]
pub(crate) struct Board {
    /// The board: chessboard:COLSxROWS:SQUARE or charuco:COLSxROWS:SQUARE:MARKER:DICT[:legacy], such as charuco:5x7:36mm:18mm:DICT_6X6_250;
    /// columns and rows count squares
    #[arg(value_name = "SPEC")]
    pub(crate) spec: Spec,
    /// The page: a4, a3 and letter lie as the board does; a size such as 400x300mm is as stated
    #[arg(long, value_name = "a4|a3|letter|WxHmm", default_value = "a4")]
    pub(crate) page: Page,
    /// File to draw: .svg or .pdf
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// What a ruler shows on the print between the outer edges of the squares, along x and along y, like 180.0mm,251.3mm: print the board with
    /// the squares that it has
    #[arg(long, value_name = "X,Y")]
    pub(crate) measured: Option<Measured>,
    /// Write over a file that exists
    #[arg(long)]
    pub(crate) force: bool,
}
