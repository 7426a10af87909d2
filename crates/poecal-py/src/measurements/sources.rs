//! Measurements from files, arrays, tables in memory, and from other measurements.

use std::path::PathBuf;

use poecal_cli::words;
use poecal_import as measurements;
use poecal_import::{FrameGrouping, ReadOptions};
use poecal_results::calibration_file::Inputs;
use poecal_storage::named_files::refuse_repeats;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::content::{MeasurementSource, Measurements};
use super::contents::with_contents;
use super::db3;
use super::read_options::options;
use crate::arguments::{self as arg, Paths};
use crate::errors::raise;
use crate::from_arrays::{ArrayColumns, dataset};
use crate::from_dataframe;
use crate::robot::Robot;
use crate::words::one_of;

#[pymethods]
impl Measurements {
    /// Reads measurement files, joined in their order.
    ///
    /// Parameters
    /// ----------
    /// paths
    ///     A file, or several.
    /// robot
    ///     The robot whose joints the columns name.
    /// columns
    ///     A mapping file for files with other column names.
    /// train_where
    ///     "COLUMN=VALUE[,VALUE]": fit only rows whose column has one of these values, and hold out all others.
    /// ignore_sets
    ///     True to ignore the files' column `set`, as for rows that judge a calibration.
    /// strict
    ///     True to treat beam breaks (empty or zero positions) as an error instead of skipping them with a warning.
    /// device_frames
    ///     Rows that share a frame of the measuring device: "common", all (or those of one name in the column `instrument`), or "per-file", those of
    ///     a file.
    /// join
    ///     Rule by which joint readings and measurements in two files are joined: "name", "rows" or "time". By default by name, else recordings at
    ///     the times of their static intervals, and lists by their order, if the nominal robot agrees with no other one as well.
    /// lag
    ///     Lag of the clocks of two recordings, the measurements' time less that of the joint readings, "12s+-2s"; by default it is estimated.
    /// units
    ///     Units of columns that state none, "mm,deg"; a mapping file takes precedence.
    /// sheet
    ///     Sheet of workbooks; by default the only one that holds a table.
    /// body
    ///     Body, marker or tool of recordings of a camera system; by default the only one that moves.
    /// topics
    ///     Topics of ROS 2 bags (MCAP); by default the only ones of joint readings and of measurements.
    /// socket_distance
    ///     Known distance between the two sockets of each place, "50mm", or of pairs by name, "A-B=50mm,B-C=70mm+-0.02mm".
    /// contact
    ///     Kind of contact for rows whose `contact` cell is empty: "point" or "flush".
    /// instrument_noise
    ///     Noise of instruments that grows with the distance, like "tracker:10um+5um/m": a standard deviation in all directions, and one
    ///     across the line of sight for each metre; of all instruments without a name. For rows that state none.
    /// cameras
    ///     Files of the cameras that saw corners in pixels: CSV (FILE#VERSION if it has several), YAML of OpenCV, ROS, Kalibr or
    ///     industrial_calibration, XML of ViSP.
    /// markers
    ///     Boards or solids that they saw: CSV files of points, "chessboard:10x7:27mm", or files of Kalibr, industrial_calibration or OpenCV.
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     The rows of all files.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     A file cannot be read.
    /// MeasurementError
    ///     It holds no measurements of this robot; the error states the line and the column.
    #[staticmethod]
    #[pyo3(signature = (paths, robot, *, columns=None, train_where=None, ignore_sets=false, strict=false, device_frames="common", join=None, lag=None, units=None, sheet=None, body=None, topics=None, socket_distance=None, contact="point", instrument_noise=None, cameras=None, markers=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_csv(
        py: Python<'_>,
        #[pyo3(from_py_with = arg::paths)] paths: Paths,
        #[pyo3(from_py_with = arg::robot)] robot: &Robot,
        #[pyo3(from_py_with = arg::columns)] columns: Option<PathBuf>,
        #[pyo3(from_py_with = arg::train_where)] train_where: Option<&str>,
        #[pyo3(from_py_with = arg::ignore_sets)] ignore_sets: bool,
        #[pyo3(from_py_with = arg::strict)] strict: bool,
        #[pyo3(from_py_with = arg::device_frames)] device_frames: &str,
        #[pyo3(from_py_with = arg::join)] join: Option<&str>,
        #[pyo3(from_py_with = arg::lag)] lag: Option<&str>,
        #[pyo3(from_py_with = arg::units)] units: Option<&str>,
        #[pyo3(from_py_with = arg::sheet)] sheet: Option<&str>,
        #[pyo3(from_py_with = arg::body)] body: Option<&str>,
        #[pyo3(from_py_with = arg::topics)] topics: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::socket_distance)] socket_distance: Option<&str>,
        #[pyo3(from_py_with = arg::contact)] contact: &str,
        #[pyo3(from_py_with = arg::instrument_noise)] instrument_noise: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::cameras)] cameras: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::markers)] markers: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let contact = one_of("contact", contact, words::CONTACT)?;
        let frames = one_of("device_frames", device_frames, words::FRAMES)?;
        let join = join.map(|word| one_of("join", word, words::JOIN)).transpose()?;
        let Paths(paths) = paths;
        let bags = db3::bags(py, &paths)?;
        let read = || {
            refuse_repeats(&paths)?;
            let options = options(
                columns.as_ref(),
                train_where,
                [ignore_sets, strict],
                (frames, join, lag),
                (socket_distance, contact),
                [units, sheet, body],
                [&instrument_noise, &cameras, &markers, &topics].map(|it| it.as_deref()),
            )?;
            let options = ReadOptions { bags, ..options };
            let file = measurements::read(&paths, &robot.model.robot, &robot.model.reads(options))?;
            let mut sha256 = Inputs::checksums(columns.iter().map(PathBuf::as_path))?;
            sha256.extend(file.sha256.clone());
            Ok((file, sha256))
        };
        let (file, sha256) = py.detach(read).map_err(raise)?;
        crate::warn(py, &file.warnings)?;
        let names = paths.iter().map(|path| path.display().to_string()).collect();
        let (files, joins) = (file.inputs(), file.joins.clone());
        let source = MeasurementSource { names, sha256, files, joins, train_where: train_where.is_some() };
        Ok(Measurements::new(file, source))
    }

    /// Reads files of instruments, controllers and recorders in their own forms: the same files and options as `from_csv`, under a clearer name.
    ///
    /// Parameters
    /// ----------
    /// paths
    ///     A file, or several; with joint readings in one and measurements in another they are joined. Bags of ROS 2 may be in MCAP or in SQLite
    ///     (`.db3`), which the program does not read. Bags of ROS 1 are converted to MCAP with `rosbags-convert`.
    /// robot
    ///     The robot whose joints the columns name.
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     The rows of all files.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     A file cannot be read.
    /// MeasurementError
    ///     It holds no measurements of this robot; the error states the line and the column.
    #[staticmethod]
    #[pyo3(signature = (paths, robot, **options))]
    fn from_files(
        py: Python<'_>,
        paths: &Bound<'_, PyAny>,
        robot: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        let found = py.get_type::<Self>().call_method("from_csv", (paths, robot), options)?;
        Ok(found.unbind())
    }

    /// Reads files from their contents, as from a database or an upload: the same files and options as `from_files`.
    ///
    /// Parameters
    /// ----------
    /// contents
    ///     Names of the files, whose extensions count, with their contents as text or bytes: ``{"points.csv": text}``. A bag in SQLite (`.db3`) is
    ///     read as a file only.
    /// robot
    ///     The robot whose joints the columns name.
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     The rows of all files.
    ///
    /// Raises
    /// ------
    /// MeasurementError
    ///     They hold no measurements of this robot; the error states the line and the column.
    #[staticmethod]
    #[pyo3(signature = (contents, robot, **options))]
    fn from_contents(
        py: Python<'_>,
        contents: &Bound<'_, PyDict>,
        robot: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        with_contents(contents, |names| {
            Ok(py.get_type::<Self>().call_method("from_csv", (names, robot), options)?.unbind())
        })
    }

    /// Measurements from arrays: positions, with orientations or without, or poses.
    ///
    /// Arrays may be read-only and of any layout. Masked numbers count as NaN. If the whole row is masked, they are a missing orientation or standard
    /// deviation; otherwise they are refused.
    ///
    /// Parameters
    /// ----------
    /// robot
    ///     The robot that was measured.
    /// joints
    ///     Readings, shape (m, n), in the order of `robot.reading_names`: in `angle_unit`, of sliding joints in `length_unit`.
    /// positions
    ///     Positions of the target in the device's frame, shape (m, 3), in `length_unit`.
    /// quaternions_xyzw
    ///     Orientations beside `positions` as unit quaternions x, y, z, w, shape (m, 4); rows of NaN are points without orientation.
    /// poses
    ///     Poses device_from_target instead of `positions`, shape (m, 4, 4), translations in `length_unit`.
    /// targets
    ///     m names of targets, default the tip itself.
    /// instruments
    ///     m names of measuring devices, each with a frame of its own.
    /// sets
    ///     "fit", "held_out" or None (unstated) for each row.
    /// ids
    ///     m names of the rows.
    /// sigma_position_mm, sigma_rotation_deg
    ///     Standard deviations of each measured component, if rows state them: a number, or shape (m,), NaN for a row without one.
    /// angle_unit, length_unit
    ///     "rad", "deg", …; "m", "mm", …
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     m rows.
    #[staticmethod]
    #[pyo3(signature = (robot, *, joints, positions=None, quaternions_xyzw=None, poses=None, targets=None, instruments=None, sets=None, ids=None,
                        sigma_position_mm=None, sigma_rotation_deg=None, angle_unit="rad", length_unit="m"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_arrays(
        #[pyo3(from_py_with = arg::robot)] robot: &Robot,
        joints: &Bound<'_, PyAny>,
        positions: Option<&Bound<'_, PyAny>>,
        quaternions_xyzw: Option<&Bound<'_, PyAny>>,
        poses: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::targets)] targets: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::instruments)] instruments: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::sets)] sets: Option<Vec<Option<String>>>,
        #[pyo3(from_py_with = arg::ids)] ids: Option<Vec<String>>,
        sigma_position_mm: Option<&Bound<'_, PyAny>>,
        sigma_rotation_deg: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arg::angle_unit)] angle_unit: &str,
        #[pyo3(from_py_with = arg::length_unit)] length_unit: &str,
    ) -> PyResult<Self> {
        let columns = ArrayColumns {
            joints,
            positions,
            quaternions_xyzw,
            poses,
            targets,
            instruments,
            sets,
            ids,
            sigma_position_mm,
            sigma_rotation_deg,
            angle_unit,
            length_unit,
        };
        Ok(Measurements::in_memory(dataset(&robot.model.robot, &columns)?, "arrays"))
    }

    /// Measurements from a table in memory: a data frame of pandas or polars, a dict of columns, or a structured array of NumPy.
    ///
    /// Columns have the same names, units in brackets and meanings as those of a file, `x[mm]` or `target`. Missing and masked values are
    /// empty cells.
    ///
    /// Parameters
    /// ----------
    /// frame
    ///     The table: anything with `columns` and columns by name, a dict of columns of one length, or an array with named fields.
    /// robot
    ///     The robot whose joints the columns name.
    /// columns
    ///     A mapping file for a table with other column names.
    /// train_where
    ///     "COLUMN=VALUE[,VALUE]": fit only rows whose column has one of these values, and hold out all others.
    /// ignore_sets
    ///     True to ignore the column `set`, as for rows that judge a calibration.
    /// strict
    ///     True to treat beam breaks (empty or zero positions) as an error instead of skipping them with a warning.
    /// units
    ///     Units of columns that state none, "mm,deg"; a mapping file takes precedence.
    /// socket_distance
    ///     Known distance between the two sockets of each place, "50mm", or of pairs by name, "A-B=50mm,B-C=70mm+-0.02mm".
    /// contact
    ///     Kind of contact for rows whose `contact` cell is empty: "point" or "flush".
    /// instrument_noise
    ///     Noise of instruments that grows with the distance, like "tracker:10um+5um/m": a standard deviation in all directions, and one
    ///     across the line of sight for each metre; of all instruments without a name. For rows that state none.
    /// cameras
    ///     Files of the cameras that saw corners in pixels: CSV (FILE#VERSION if it has several), YAML of OpenCV, ROS, Kalibr or
    ///     industrial_calibration, XML of ViSP.
    /// markers
    ///     Boards or solids that they saw: CSV files of points, "chessboard:10x7:27mm", or files of Kalibr, industrial_calibration or OpenCV.
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     The rows of the table.
    ///
    /// Raises
    /// ------
    /// MeasurementError
    ///     The table holds no measurements of this robot; the error states the row.
    #[staticmethod]
    #[pyo3(signature = (frame, robot, *, columns=None, train_where=None, ignore_sets=false, strict=false, units=None, socket_distance=None, contact="point", instrument_noise=None, cameras=None, markers=None))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_dataframe(
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = arg::robot)] robot: &Robot,
        #[pyo3(from_py_with = arg::columns)] columns: Option<PathBuf>,
        #[pyo3(from_py_with = arg::train_where)] train_where: Option<&str>,
        #[pyo3(from_py_with = arg::ignore_sets)] ignore_sets: bool,
        #[pyo3(from_py_with = arg::strict)] strict: bool,
        #[pyo3(from_py_with = arg::units)] units: Option<&str>,
        #[pyo3(from_py_with = arg::socket_distance)] socket_distance: Option<&str>,
        #[pyo3(from_py_with = arg::contact)] contact: &str,
        #[pyo3(from_py_with = arg::instrument_noise)] instrument_noise: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::cameras)] cameras: Option<Vec<String>>,
        #[pyo3(from_py_with = arg::markers)] markers: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let contact = one_of("contact", contact, words::CONTACT)?;
        let text = from_dataframe::text(frame)?;
        let read = || {
            let options = options(
                columns.as_ref(),
                train_where,
                [ignore_sets, strict],
                (FrameGrouping::Common, None, None),
                (socket_distance, contact),
                [units, None, None],
                [&instrument_noise, &cameras, &markers, &None].map(|it| it.as_deref()),
            )?;
            measurements::parse(&text, from_dataframe::NAME, &robot.model.robot, &options)
        };
        let mut file = py.detach(read).map_err(from_dataframe::raise)?;
        crate::warn(py, &file.warnings)?;
        // Line numbers of an internal text would mislead: errors name rows instead.
        file.data.files.clear();
        file.data.observations.iter_mut().for_each(|row| row.source = Default::default());
        let names = vec![from_dataframe::NAME.to_owned()];
        let source = MeasurementSource { names, train_where: train_where.is_some(), ..MeasurementSource::default() };
        Ok(Measurements::new(file, source))
    }

    /// Rows of several measurements of one robot, in sequence; `a + b` joins two.
    ///
    /// Rows keep their attributes: target, instrument, set, id, standard deviations, file and line. Targets of one name are one target. Rows of
    /// instruments of one name, and all rows that name none, share a frame of the measuring device: name the instruments if it was moved in between.
    ///
    /// Parameters
    /// ----------
    /// parts
    ///     Measurements of the same joints.
    ///
    /// Returns
    /// -------
    /// Measurements
    ///     The rows of all parts.
    #[staticmethod]
    fn join(#[pyo3(from_py_with = arg::parts)] parts: Vec<Measurements>) -> PyResult<Self> {
        Measurements::join_parts(&parts.iter().collect::<Vec<_>>())
    }
}
