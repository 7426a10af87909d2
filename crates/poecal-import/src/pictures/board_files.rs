//! Boards in files of Kalibr, industrial_calibration and OpenCV (YAML or XML), as words of `poecal detect`.

use std::path::Path;

use super::keyed_values::{KeyedValues, of_xml};
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;
use poecal_storage::other_keys::KeyOwner;
use poecal_storage::source_text::read_up_to;
use poecal_storage::yaml::{YamlLeaf, leaves};

/// Description of such a file in errors.
const EXPECTED: &str = "a board: YAML of Kalibr (target_type, …) or industrial_calibration (target_finder), or settings of OpenCV's calibration \
                        (BoardSize_Width, …)";
/// Endings of such files.
const ENDINGS: [&str; 3] = ["yaml", "yml", "xml"];
/// Smallest side in millimetres: smaller sides in OpenCV's settings, which state no unit, are metres.
const LEAST_MM: f64 = 1.0;
/// Markers of industrial_calibration if its file states none.
const USUAL_MARKERS: &str = "DICT_6X6_250";
/// Sets of markers in the order in which OpenCV numbers them.
const DICTIONARIES: &str = "DICT_4X4_50 DICT_4X4_100 DICT_4X4_250 DICT_4X4_1000 DICT_5X5_50 DICT_5X5_100 DICT_5X5_250 DICT_5X5_1000 DICT_6X6_50 \
                            DICT_6X6_100 DICT_6X6_250 DICT_6X6_1000 DICT_7X7_50 DICT_7X7_100 DICT_7X7_250 DICT_7X7_1000 DICT_ARUCO_ORIGINAL \
                            DICT_APRILTAG_16h5 DICT_APRILTAG_25h9 DICT_APRILTAG_36h10 DICT_APRILTAG_36h11";

/// A program whose files have boards.
struct BoardSoftware {
    name: &'static str,
    /// A key that only its files have.
    mark: &'static str,
    /// The section of the file with the board.
    section: &'static str,
    /// Keys that are read or do not change the board, in small letters; a key that ends with a star is a beginning.
    known: &'static str,
    words: fn(&KeyedValues<'_>) -> Result<String>,
}

const MAKERS: [BoardSoftware; 3] = [
    BoardSoftware {
        name: "Kalibr",
        mark: "target_type",
        section: "Settings",
        known: "target_type tagcols tagrows tagsize tagspacing codeoffset targetcols targetrows rowspacingmeters colspacingmeters spacingmeters asymmetricgrid",
        words: |it| it.kalibr(),
    },
    BoardSoftware {
        name: "industrial_calibration",
        mark: "target_finder.type",
        section: "target_finder",
        // The last keys state how its circles are found.
        known: "type cols rows spacing chessboard_dim aruco_marker_dim dictionary circle_diameter circle_detector_params",
        words: |it| it.industrial(),
    },
    BoardSoftware {
        name: "OpenCV's settings",
        mark: "BoardSize_Width",
        // The board may also be at the top level. Keys beside it state how pictures are taken and which results are written.
        section: "Settings",
        known: "boardsize_* square_size* marker_size* aruco_* calibrate_* input* write_* show_* fix_* grid_width*",
        words: |it| it.opencv(),
    },
];

/// A board of a file in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoardOfFile {
    /// The words, such as `aprilgrid:6x6:88mm:0.3`.
    pub words: String,
    /// The file and the board that was read, a sentence.
    pub said: String,
}

/// The board of a file of Kalibr, industrial_calibration or OpenCV (`.yaml`, `.yml`, `.xml`); `None` for other endings.
///
/// # Errors
/// The file cannot be read, or has no such board.
pub fn board_of_file(typed: &str) -> Result<Option<BoardOfFile>> {
    let path = Path::new(typed);
    let ending = path.extension().and_then(|it| it.to_str()).map(str::to_ascii_lowercase);
    let Some(ending) = ending.filter(|it| ENDINGS.contains(&it.as_str())) else { return Ok(None) };
    let text = read_up_to(path, EXPECTED, ResourceLimit::Settings)?;
    let leaves = if ending == "xml" { of_xml(&text, path, EXPECTED)? } else { leaves(&text, path, EXPECTED)? };
    let stated = KeyedValues { leaves, path };
    let Some(maker) = MAKERS.iter().find(|it| stated.find(it.mark).is_some()) else {
        return Err(ErrorKind::Option.error(format!("found no board, expected {EXPECTED}")).in_file(path));
    };
    let words = (maker.words)(&stated)?;
    let others = stated.describe_unread_keys(maker)?.map_or(String::new(), |it| format!("; {it}"));
    let said = format!("{}: read the board `{words}` ({}){others}", path.display(), maker.name);
    Ok(Some(BoardOfFile { words, said }))
}

impl KeyedValues<'_> {
    /// The value behind keys that are joined by dots, at the top level or below others.
    fn find(&self, keys: &str) -> Option<&YamlLeaf> {
        let count = keys.split('.').count();
        self.leaves.iter().find(|leaf| leaf.path.iter().rev().take(count).eq(keys.rsplit('.')))
    }

    fn refuse(&self, leaf: &YamlLeaf, expected: &str) -> Error {
        let key = leaf.path.last().map_or("", String::as_str);
        let message = format!("found `{}` for `{key}`, expected {expected}", leaf.text);
        ErrorKind::Option.error(message).at_line(self.path, leaf.line)
    }

    fn require_leaf(&self, keys: &str) -> Result<&YamlLeaf> {
        self.find(keys).ok_or_else(|| {
            let message = format!("found no `{keys}`, expected it beside the other numbers of the board");
            ErrorKind::Option.error(message).in_file(self.path)
        })
    }

    fn above_0(&self, keys: &str) -> Result<f64> {
        let leaf = self.require_leaf(keys)?;
        let number = leaf.text.parse().ok().filter(|it: &f64| it.is_finite() && *it > 0.0);
        number.ok_or_else(|| self.refuse(leaf, "a number above 0"))
    }

    /// A length in millimetres, for the words of boards.
    fn length(&self, keys: &str) -> Result<String> {
        self.above_0(keys).map(millimetres)
    }

    /// Counts along x and along y.
    fn counts(&self, columns: &str, rows: &str) -> Result<[usize; 2]> {
        let count = |keys: &str| {
            let leaf = self.require_leaf(keys)?;
            let count = leaf.text.parse().ok().filter(|it| (1..=1000).contains(it));
            count.ok_or_else(|| self.refuse(leaf, "a count of 1 to 1000"))
        };
        Ok([count(columns)?, count(rows)?])
    }

    /// The value of an optional boolean key; false if it is missing.
    fn is_true(&self, keys: &str) -> Result<bool> {
        let Some(leaf) = self.find(keys) else { return Ok(false) };
        match leaf.text.to_ascii_lowercase().as_str() {
            "true" | "1" | "yes" => Ok(true),
            "false" | "0" | "no" => Ok(false),
            _ => Err(self.refuse(leaf, "true or false")),
        }
    }

    /// The keys of the board that were not read.
    fn describe_unread_keys(&self, maker: &BoardSoftware) -> Result<Option<String>> {
        let is_below = |leaf: &YamlLeaf| leaf.path.len() > 1 && leaf.path.first().is_some_and(|it| it == maker.section);
        let at = usize::from(self.leaves.iter().any(is_below));
        self.describe_other_keys(KeyOwner::Board, (at, |leaf| at == 0 || is_below(leaf)), &[maker.known])
    }

    fn kalibr(&self) -> Result<String> {
        let kind = self.require_leaf("target_type")?;
        match kind.text.as_str() {
            "aprilgrid" => {
                if let Some(offset) = self.find("codeOffset").filter(|it| it.text.parse() != Ok(0)) {
                    return Err(self.refuse(offset, "0: a grid begins with tag 0"));
                }
                let [columns, rows] = self.counts("tagCols", "tagRows")?;
                let (size, spacing) = (self.length("tagSize")?, self.above_0("tagSpacing")?);
                Ok(format!("aprilgrid:{columns}x{rows}:{size}:{spacing}"))
            }
            "checkerboard" => {
                let [columns, rows] = self.counts("targetCols", "targetRows")?;
                let side_m = self.above_0("rowSpacingMeters")?;
                if self.above_0("colSpacingMeters")? != side_m {
                    let other = self.require_leaf("colSpacingMeters")?;
                    return Err(self.refuse(other, "the same as `rowSpacingMeters`: squares"));
                }
                // Kalibr counts inner corners.
                Ok(format!("chessboard:{}x{}:{}", columns + 1, rows + 1, millimetres(side_m)))
            }
            "circlegrid" => {
                let [columns, rows] = self.counts("targetCols", "targetRows")?;
                let pitch = self.length("spacingMeters")?;
                let end = if self.is_true("asymmetricGrid")? { ":asymmetric" } else { "" };
                Ok(format!("circles:{columns}x{rows}:{pitch}{end}"))
            }
            _ => Err(self.refuse(kind, "aprilgrid, checkerboard or circlegrid")),
        }
    }

    fn industrial(&self) -> Result<String> {
        let kind = self.require_leaf("target_finder.type")?;
        let counts = || self.counts("target_finder.cols", "target_finder.rows");
        match kind.text.as_str() {
            "ModifiedCircleGridTargetFinder" | "CircleGridTargetFinder" => {
                let ([columns, rows], pitch) = (counts()?, self.length("target_finder.spacing")?);
                Ok(format!("circles:{columns}x{rows}:{pitch}"))
            }
            "CharucoGridTargetFinder" => {
                let square = self.length("target_finder.chessboard_dim")?;
                let marker = self.length("target_finder.aruco_marker_dim")?;
                let markers = self.find("target_finder.dictionary");
                let markers = markers.map_or(Ok(USUAL_MARKERS), |leaf| self.dictionary(leaf))?;
                let [columns, rows] = counts()?;
                Ok(format!("charuco:{columns}x{rows}:{square}:{marker}:{markers}"))
            }
            _ => Err(self.refuse(kind, "ModifiedCircleGridTargetFinder or CharucoGridTargetFinder")),
        }
    }

    /// Markers by their name or OpenCV's number.
    fn dictionary<'a>(&self, leaf: &'a YamlLeaf) -> Result<&'a str> {
        let is_name = leaf.text.bytes().all(|it| it.is_ascii_alphanumeric() || it == b'_');
        match leaf.text.parse::<usize>() {
            Ok(at) => DICTIONARIES
                .split(' ')
                .nth(at)
                .ok_or_else(|| self.refuse(leaf, "a number of OpenCV's dictionaries, 0 to 20")),
            Err(_) if is_name => Ok(&leaf.text),
            Err(_) => Err(self.refuse(leaf, "the name of a dictionary, such as DICT_6X6_250")),
        }
    }

    fn opencv(&self) -> Result<String> {
        let [columns, rows] = self.counts("BoardSize_Width", "BoardSize_Height")?;
        let length = |keys: &str| -> Result<String> {
            let stated = self.above_0(keys)?;
            Ok(millimetres(if stated < LEAST_MM { stated } else { 1e-3 * stated }))
        };
        let (kind, square) = (self.require_leaf("Calibrate_Pattern")?, length("Square_Size")?);
        match kind.text.trim_matches('"') {
            // Inner corners; of a ChArUco board squares.
            "CHESSBOARD" => Ok(format!("chessboard:{}x{}:{square}", columns + 1, rows + 1)),
            "CIRCLES_GRID" => Ok(format!("circles:{columns}x{rows}:{square}")),
            "ASYMMETRIC_CIRCLES_GRID" => Ok(format!("circles:{columns}x{rows}:{square}:asymmetric")),
            "CHARUCOBOARD" => {
                let marker = length("Marker_Size")?;
                let markers = self.dictionary(self.require_leaf("ArUco_Dict_Name")?)?;
                Ok(format!("charuco:{columns}x{rows}:{square}:{marker}:{markers}"))
            }
            _ => Err(self.refuse(kind, "CHESSBOARD, CIRCLES_GRID, ASYMMETRIC_CIRCLES_GRID or CHARUCOBOARD")),
        }
    }
}

/// A length in millimetres, for the words of boards.
fn millimetres(length_m: f64) -> String {
    format!("{}mm", (length_m * 1e9).round() / 1e6)
}
