//! Measurement files: CSV with one row per configuration and target (docs/file-formats.md, "Measurements").
//!
//! Text becomes lines (`text`) and cells (`cells`), a table with places for messages (`table`), columns with a meaning and a unit
//! (`layout` and `builder`, from header, mapping and robot), numbers in SI (`inputs`), without those of lost beams (`lost`), and at
//! last measurements (`row`, [`read()`]), which are judged for their scale (`scale`, `spread`, `turns`).

mod beside;
mod board_files;
mod board_words;
mod boards;
mod builder;
mod camera_tables;
mod camera_texts;
mod cameras;
mod cells;
mod column_meanings;
mod column_names;
mod column_spec;
mod configurations;
mod corner_columns;
mod corner_names;
mod counted;
mod encodings;
mod fit_where;
mod gathering;
mod growing;
mod guess;
mod header;
mod imported;
mod inputs;
mod instrument_noise;
mod intrinsics;
mod join_doubt;
mod join_entry;
mod join_judgement;
mod join_lags;
mod join_motion;
mod join_order;
mod join_pairs;
mod join_plan;
mod join_words;
mod joining;
mod joints;
mod kinds;
mod layout;
mod lens_checks;
mod lost;
mod mapping;
mod mapping_values;
mod messages;
mod missing_columns;
mod motions;
mod naming;
mod no_file_for;
mod no_stands;
mod number;
mod numbered;
mod orientation;
mod paired_readings;
mod picture_files;
mod picture_names;
mod picture_poses;
mod pixels;
mod places;
mod pose_columns;
mod pose_file;
mod pose_lists;
mod pose_names;
mod pose_readings;
mod pose_table;
mod read;
mod recorded;
mod rewritten;
mod row;
mod scale;
mod set_choice;
mod shifted_header;
mod sightings;
mod socket_distance;
mod spread;
mod stand_means;
mod streams;
mod table;
mod taken;
mod targets;
mod template;
mod text;
mod times;
mod turns;
mod understanding;
mod understood;
mod units;
mod unknown_camera;
mod unused;
mod witness;
mod write;
mod wrong_boards;

pub use super::numbers::LARGEST_NUMBER;
pub use board_files::{BoardOfFile, board_of_file};
pub use boards::read_boards;
pub use cameras::{camera_file, read_cameras};
pub use cells::Separator;
pub(in crate::io) use cells::{Cell, split};
pub use fit_where::FitWhere;
pub use growing::{GrowingFile, News};
pub use guess::{ColumnGuess, FoundColumn, MappedChoice, MappedField, guess_columns};
pub use imported::imported_table;
pub use instrument_noise::InstrumentNoise;
pub use join_entry::{InputEntry, JoinEntry, MotionEntry, RowEntry};
pub use joints::{JointsTable, parse_joints, read_joints};
pub use lost::LostBeams;
pub use mapping::ColumnMap;
pub use number::DecimalSign;
pub use pose_columns::PoseUnits;
pub use pose_lists::{FlangePoses, PosePairs, PoseSource, read_flange_poses, read_pose_pairs};
pub use pose_table::pose_table;
pub use read::{parse, read};
pub use rewritten::{JointRow, RewrittenTable, rewrite_joints};
pub use scale::{LARGEST_OTHERWISE as LARGEST_ANGLE_RAD, REACHES as MOST_REACHES, SHARE as WRONG_UNIT_SHARE};
pub use socket_distance::SocketDistances;
pub use template::planned_table;
pub(in crate::io) use template::{plan, template};
pub use understanding::{ColumnUnderstanding, FileUnderstanding};
pub use units::{NamedUnit, UnitSource};
pub use witness::to_measure_again;
pub(in crate::io) use write::text;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::{Board, Camera};
use crate::error::Result;
use crate::measurement::Dataset;
use crate::robot::Controller;

/// Options for reading measurement files.
///
/// ```
/// use poecal::io::measurements::ReadOptions;
/// let options = ReadOptions { fit_where: Some("stage=1,2".parse()?), ..ReadOptions::default() };
/// assert!(options.mapping.is_none());
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Mapping of columns with other names than ours; applies to every file.
    pub mapping: Option<ColumnMap>,
    /// How the joint readings are made of columns, as the calibration of this robot kept it, for files that have these columns; a mapping with
    /// joints precedes it.
    pub controller: Option<Controller>,
    /// Training rows; precedes the `set` column and the mapping's `set`.
    pub fit_where: Option<FitWhere>,
    /// Whether sets are ignored ([`ReadOptions::fit_where`], the mapping's `set`, the `set` column), as for files that only judge a
    /// calibration.
    pub ignore_sets: bool,
    /// Whether a lost beam, an empty or zero position, is an error; otherwise it is omitted and counted in a warning.
    pub strict: bool,
    /// Rows with a common device frame.
    pub frames: Frames,
    /// How joint readings and measurements in two files find each other; found if it is not stated.
    pub join: Option<Join>,
    /// The lag of the clocks of two streams, if it is known.
    pub lag: Option<Lag>,
    /// The sheet of workbooks; that which holds a table if it is not stated.
    pub sheet: Option<String>,
    /// The body, marker or tool of recordings; that which moves if it is not stated.
    pub body: Option<String>,
    /// Topics of bags, with or without the stroke that their names begin with; the only ones that can be meant if they are not stated.
    pub topics: Vec<String>,
    /// Bags whose messages were read from elsewhere: a file of these is not opened.
    pub bags: Vec<GivenBag>,
    /// Known distances between the sockets of a place.
    pub socket_distances: Option<SocketDistances>,
    /// What rows with a `plane` are that do not say it in `contact`.
    pub contact: PlaneContact,
    /// Cameras that saw corners in pixels.
    pub cameras: Vec<Camera>,
    /// The boards or solids of these corners.
    pub boards: Vec<Board>,
    /// Noise of instruments that depends on the distance, for rows that state none.
    pub instrument_noise: Vec<InstrumentNoise>,
    /// What was understood of files of boards, a sentence each, for the warnings.
    pub said: Vec<String>,
}

/// A bag that was read from a file in another form, as the Python package reads `.db3`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenBag {
    /// The file, as it is named among those that are read.
    pub path: PathBuf,
    /// Its messages as MCAP.
    pub mcap: Arc<[u8]>,
    /// SHA-256 of the file.
    pub sha256: String,
}

impl ReadOptions {
    /// States the units of columns that state none, in words like `mm`, `deg` or `mm,deg`; those of the mapping precede.
    ///
    /// # Errors
    /// [`ErrorKind::Unit`](crate::ErrorKind::Unit) of an unknown unit, or of two of one kind.
    pub fn state_units(&mut self, words: &str) -> Result<()> {
        self.mapping.get_or_insert_default().state_units(words)
    }

    /// Adds the boards of a file or of words ([`read_boards`]), with what was understood of them.
    ///
    /// # Errors
    /// As [`read_boards`].
    pub fn add_boards(&mut self, typed: &str) -> Result<()> {
        self.boards.extend(read_boards(typed)?);
        self.said.extend(board_of_file(typed)?.map(|board| board.said));
        Ok(())
    }
}

/// How a target touches a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlaneContact {
    /// By a point: a height.
    #[default]
    Point,
    /// By a face: a height and two tilts.
    Flush,
}

impl PlaneContact {
    /// Its word in the column `contact`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            PlaneContact::Point => "point",
            PlaneContact::Flush => "flush",
        }
    }
}

/// How the rows of a file of joint readings and of one of measurements find each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Join {
    /// By the names of their rows.
    Name,
    /// By their order.
    Rows,
    /// By their times, each file with a clock of its own: at the stands of the robot.
    Time,
    /// By their times, each file with a clock of its own, while the robot moves: lag and drift of the clocks are unknowns of the fit.
    Motion,
}

/// The lag of two clocks: the time of measurements less that of joint readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// The lag, seconds.
    pub lag_s: f64,
    /// How far it may be off, seconds.
    pub off_s: f64,
}

/// How far a lag may be off that does not say it, seconds.
const LAG_OFF_S: f64 = 0.5;

impl std::str::FromStr for Lag {
    type Err = crate::error::Error;

    /// From `12s`, or `12s+-2s`.
    fn from_str(text: &str) -> Result<Self> {
        let seconds =
            |word: &str| word.trim().strip_suffix('s')?.trim().parse().ok().filter(|it: &f64| it.is_finite());
        let (lag, off) = text.split_once("+-").map_or((text, None), |(lag, off)| (lag, Some(off)));
        let found = seconds(lag).zip(off.map_or(Some(LAG_OFF_S), seconds)).filter(|it| it.1 > 0.0);
        let Some((lag_s, off_s)) = found else {
            return crate::ErrorKind::Option
                .refuse(format!("found the lag `{text}`, expected seconds, like 12s or 12s+-2s"));
        };
        Ok(Lag { lag_s, off_s })
    }
}

/// Rows with a common device frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frames {
    /// All rows, or those of one name in the column `instrument`.
    #[default]
    Common,
    /// Those of a file.
    PerFile,
}

/// Contents of measurement files, and how they were read.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::io::measurements::{self, ReadOptions};
/// use poecal::lie::{Pose, Screw};
/// use poecal::robot::{Joint, Robot};
/// let joint = Joint::revolute("joint1", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
/// let robot = Robot::new("one_axis", vec![joint], Pose::from_translation(Vector3::x()))?;
/// let path = std::env::temp_dir().join("poecal_measurement_file_example.csv");
/// # let write = |text: &str| std::fs::write(&path, text).unwrap();
/// write("joint1[deg],x[mm],y[mm],z[mm]\n90,0,1000,0\n");
/// let file = measurements::read(&[&path], &robot, &ReadOptions::default())?;
/// # std::fs::remove_file(&path).unwrap();
/// assert_eq!(file.data.readings(0), [std::f64::consts::FRAC_PI_2]);
/// assert_eq!(file.understood[0].columns[1].unit, Some("mm"));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MeasurementFile {
    /// The rows of all files, in order.
    pub data: Dataset,
    /// How each file was read.
    pub understood: Vec<FileUnderstanding>,
    /// SHA-256 of each file by its name, of the bytes that were read.
    pub sha256: BTreeMap<String, String>,
    /// What was found in the rows and is nothing to be looked after, a sentence each.
    pub notes: Vec<String>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// How files of joint readings and of measurements were joined, if some were.
    pub join: Option<Join>,
    /// Each join of two files, as `calibration.json` has it.
    pub joins: Vec<JoinEntry>,
    /// Whether angles of joints that state no unit were taken for degrees.
    pub is_in_degrees: bool,
}
