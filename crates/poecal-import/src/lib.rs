//! Measurement files of instruments, recorders and cameras as rows of a session (docs/file-formats.md, "Measurements").
//!
//! This crate is a part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package. Its interface follows their needs
//! and promises nothing by itself.
//!
//! Text becomes lines and cells with their positions (`table`), then columns with a meaning and a unit (`table/layout.rs` and `table/builder.rs`,
//! from header, mapping and robot). These become numbers in SI (`table/cursor.rs`) without beam breaks (`table/lost.rs`), and at last measurements
//! (`table/row.rs`, [`read()`]), which rules of `poecal_fit::input_doubts` judge. Files of instruments and messages are first converted to tables
//! (`instruments`, `messages`); two files are joined (`join`); `poses` and `pictures` read lists of poses and corners, `guess` names foreign
//! columns, `write` makes templates and lists. Workbooks and bags are features.
//!
//! Other crates have the fits (the nominal robot is registered if files or units are in doubt), results, and sentences on results.

#![forbid(unsafe_code)]

pub(crate) mod guess;
pub(crate) mod instruments;
pub(crate) mod join;
pub(crate) mod messages;
pub(crate) mod pictures;
pub(crate) mod poses;
pub(crate) mod read;
pub(crate) mod table;
pub(crate) mod write;

pub use crate::join::join_entry::{InputEntry, JoinEntry, RowEntry};
pub use crate::join::witness::to_measure_again;
pub use crate::pictures::board_files::{BoardOfFile, board_of_file};
pub use crate::pictures::boards::read_boards;
pub use crate::pictures::cameras::{CameraFile, camera_file, read_cameras};
pub use crate::poses::pose_columns::PoseUnits;
pub use crate::poses::pose_lists::{FlangePoses, PosePairs, PoseSource, read_flange_poses, read_pose_pairs};
pub use crate::poses::pose_table::pose_table;
pub use crate::read::joints::{JointsTable, parse_joints, read_joints};
pub use crate::read::labels::{LabelColumns, read_labels};
pub use crate::read::socket_distance::SocketDistances;
pub use crate::table::beam_breaks::lost_words;
pub use crate::table::cells::{Cell, Separator, split};
pub use crate::table::mapping::ColumnMap;
pub use crate::table::number::DecimalSign;
pub use crate::table::train_where::FitWhere;
pub use crate::table::understanding::{ColumnUnderstanding, FileUnderstanding};
pub use crate::write::growing_file::{GrowingFile, NewRows};
pub use crate::write::own_rows::imported_table;
pub use crate::write::rewriting::{JointRow, RewrittenTable, rewrite_joints};
pub use crate::write::template::{plan, planned_table, template, test_table};
pub use guess::{ColumnGuess, FoundColumn, MappedChoice, MappedField, guess_columns};
pub use poecal_fit::start::MotionEntry;
pub use poecal_model::measurement::InstrumentNoise;
pub use poecal_numerics::named_unit::{NamedUnit, UnitSource};
pub use poecal_storage::numbers::LARGEST_NUMBER;
pub use read::{parse, read};
pub use write::text;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_model::camera::{Board, Camera};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Controller;
use poecal_numerics::error::Result;

/// Options for reading measurement files.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_import::{ReadOptions, read as read_measurements};
/// # }
/// use poecal::ReadOptions;
/// let options = ReadOptions { train_where: Some("stage=1,2".parse()?), ..ReadOptions::default() };
/// assert!(options.mapping.is_none());
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Mapping of columns with other names than ours; applies to every file.
    pub mapping: Option<ColumnMap>,
    /// Conversion of columns into joint readings, as the calibration of this robot kept it, for files that have these columns; a mapping with
    /// joints precedes it.
    pub controller: Option<Controller>,
    /// Training rows; precedes the `set` column and the mapping's `set`.
    pub train_where: Option<FitWhere>,
    /// True if sets are ignored ([`ReadOptions::train_where`], the mapping's `set`, the `set` column), as for files that only judge a calibration.
    pub ignore_sets: bool,
    /// True if a beam break, an empty or zero position, is an error; otherwise it is omitted and counted in a warning.
    pub strict: bool,
    /// Rows with a common device frame.
    pub frames: FrameGrouping,
    /// Method by which joint readings and measurements in two files are matched; determined from the files if not stated.
    pub join: Option<Join>,
    /// The lag of the clocks of two streams, if it is known.
    pub lag: Option<Lag>,
    /// The sheet of workbooks; the one with a table if not stated.
    pub sheet: Option<String>,
    /// The body, marker or tool of recordings; the one that moves if not stated.
    pub body: Option<String>,
    /// Topics of bags, with or without the leading slash; the only possible ones if not stated.
    pub topics: Vec<String>,
    /// Bags whose messages were read elsewhere: their files are not opened.
    pub bags: Vec<ConvertedBag>,
    /// Known distances between the sockets of one `place`.
    pub socket_distances: Option<SocketDistances>,
    /// Contact of rows with a `plane` that do not state it in `contact`.
    pub contact: PlaneContact,
    /// Cameras that saw corners in pixels.
    pub cameras: Vec<Camera>,
    /// The boards or solids of these corners.
    pub boards: Vec<Board>,
    /// Noise of instruments that depends on the distance, for rows that state none.
    pub instrument_noise: Vec<InstrumentNoise>,
    /// Joints that the model has beyond the robot's tip link, each with an end link that it moves: their columns are named.
    pub beyond_tip: Vec<(String, String)>,
    /// Interpretation of files of cameras and boards, a sentence each, for the warnings.
    pub said: Vec<String>,
}

/// A bag that was read from a file in another form, as the Python package reads `.db3`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConvertedBag {
    /// The file, by its name among those that are read.
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
    /// [`ErrorKind::Unit`](poecal_numerics::error::ErrorKind::Unit) for an unknown unit, or for two of one kind.
    pub fn state_units(&mut self, words: &str) -> Result<()> {
        self.mapping.get_or_insert_default().state_units(words)
    }

    /// Adds the cameras of a file ([`read_cameras`]), with the sentences on their interpretation.
    ///
    /// # Errors
    /// Those of [`read_cameras`].
    pub fn add_cameras(&mut self, typed: &str) -> Result<()> {
        let CameraFile { cameras, said } = read_cameras(typed)?;
        self.cameras.extend(cameras);
        self.said.extend(said);
        Ok(())
    }

    /// Adds the boards of a file or of words ([`read_boards`]), with the sentences on their interpretation.
    ///
    /// # Errors
    /// Those of [`read_boards`].
    pub fn add_boards(&mut self, typed: &str) -> Result<()> {
        self.boards.extend(read_boards(typed)?);
        self.said.extend(board_of_file(typed)?.map(|board| board.said));
        Ok(())
    }
}

/// Contact of a target with a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlaneContact {
    /// Contact at a point: a height.
    #[default]
    Point,
    /// Contact of a face: a height and two tilts.
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

/// Method by which the rows of a file of joint readings and of one of measurements are matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Join {
    /// Match by the names of the rows.
    Name,
    /// Match by the order of the rows.
    Rows,
    /// Match by times, each file with a clock of its own: at the robot's static intervals.
    Time,
    /// Match by times, each file with a clock of its own, while the robot moves: lag and drift of the clocks are unknowns of the fit.
    Motion,
}

/// The lag of two clocks: the time of measurements less that of joint readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// The lag, seconds.
    pub lag_s: f64,
    /// Largest error of the lag, seconds.
    pub off_s: f64,
}

/// Largest error of a lag that does not state it, seconds.
const LAG_OFF_S: f64 = 0.5;

impl std::str::FromStr for Lag {
    type Err = poecal_numerics::error::Error;

    /// Parses `12s`, or `12s+-2s`.
    fn from_str(text: &str) -> Result<Self> {
        let seconds = |word: &str| word.trim().strip_suffix('s')?.trim().parse().ok().filter(|it: &f64| it.is_finite());
        let (lag, off) = text.split_once("+-").map_or((text, None), |(lag, off)| (lag, Some(off)));
        let found = seconds(lag).zip(off.map_or(Some(LAG_OFF_S), seconds)).filter(|it| it.1 > 0.0);
        let Some((lag_s, off_s)) = found else {
            return poecal_numerics::error::ErrorKind::Option
                .refuse(format!("found the lag `{text}`, expected seconds, like 12s or 12s+-2s"));
        };
        Ok(Lag { lag_s, off_s })
    }
}

/// Rows with a common device frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameGrouping {
    /// All rows, or those of one name in the column `instrument`, have a common frame.
    #[default]
    Common,
    /// The rows of a file have a common frame.
    PerFile,
}

/// Contents of measurement files, and the interpretation of each.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_import::{ReadOptions, read as read_measurements};
/// #     pub use poecal_arm::lie;
/// #     pub use poecal_model::robot::{Joint, Robot};
/// # }
/// use poecal::{Joint, ReadOptions, Robot, read_measurements};
/// use poecal::lie::{Pose, Screw};
/// use nalgebra::Vector3;
/// let joint = Joint::revolute("joint1", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
/// let robot = Robot::new("one_axis", vec![joint], Pose::from_translation(Vector3::x()))?;
/// let path = std::env::temp_dir().join("poecal_measurement_file_example.csv");
/// # let write = |text: &str| std::fs::write(&path, text).unwrap();
/// write("joint1[deg],x[mm],y[mm],z[mm]\n90,0,1000,0\n");
/// let file = read_measurements(&[&path], &robot, &ReadOptions::default())?;
/// # std::fs::remove_file(&path).unwrap();
/// assert_eq!(file.data.readings(0), [std::f64::consts::FRAC_PI_2]);
/// assert_eq!(file.understood[0].columns[1].unit, Some("mm"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MeasurementFile {
    /// The rows of all files, in order.
    pub data: Dataset,
    /// Interpretation of each file.
    pub understood: Vec<FileUnderstanding>,
    /// SHA-256 of each file by its name, over the bytes that were read.
    pub sha256: BTreeMap<String, String>,
    /// Findings in the rows that need no attention, a sentence each.
    pub notes: Vec<String>,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// Method by which files of joint readings and of measurements were joined, if any were.
    pub join: Option<Join>,
    /// Each join of two files, in the form of `calibration.json`.
    pub joins: Vec<JoinEntry>,
    /// True if angles of joints that state no unit were taken for degrees.
    pub is_in_degrees: bool,
}
