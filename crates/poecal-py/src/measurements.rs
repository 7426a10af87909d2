//! Measurements from files, arrays and data frames.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use maud::html;
use numpy::{PyArray1, PyArray2, PyArray3};
use poecal::io::calibration_file::Inputs;
use poecal::io::measurements::{self, ColumnMap, Frames, MeasurementFile, ReadOptions};
use poecal::io::named_files::refuse_repeats;
use poecal::measurement::{Dataset, Set};
use poecal::text::visible_markup;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::{Deserialize, Serialize};

use crate::arrays::{pose_arrays, table};
use crate::errors::{argument, python_words, raise};
use crate::from_arrays::{ArrayColumns, dataset};
use crate::from_dataframe;
use crate::pickle;
use crate::robot::Robot;
use crate::words::chosen;

/// Measurements of a robot: in each row a configuration and the measurement of a target. Immutable.
///
/// Make them by `Measurements.from_csv`, `from_arrays` or `from_dataframe`. Lengths are in metres, angles in radians. Measurements
/// compare by value, and can be copied and pickled.
#[pyclass(frozen, module = "poecal", name = "Measurements")]
#[derive(Clone)]
pub(crate) struct Measurements {
    pub(crate) file: Arc<MeasurementFile>,
    pub(crate) source: Arc<MeasurementSource>,
}

/// Source of measurements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeasurementSource {
    /// File names, or their substitutes.
    pub(crate) names: Vec<String>,
    /// SHA-256 of each file that was read.
    pub(crate) sha256: BTreeMap<String, String>,
    /// Whether `fit_where` chose the rows to fit.
    pub(crate) fit_where: bool,
}

/// Pickled measurements.
#[derive(Serialize, Deserialize)]
struct MeasurementState {
    data: Dataset,
    warnings: Vec<String>,
    source: MeasurementSource,
}

/// A path, or several.
#[derive(FromPyObject)]
enum Paths {
    One(PathBuf),
    Several(Vec<PathBuf>),
}

/// Options of a reader, from the arguments of the same names.
fn options(
    columns: Option<&PathBuf>,
    fit_where: Option<&str>,
    ignore_sets: bool,
    strict: bool,
    frames: Frames,
) -> poecal::Result<ReadOptions> {
    Ok(ReadOptions {
        frames,
        mapping: columns.map(ColumnMap::read).transpose()?,
        fit_where: fit_where.map(str::parse).transpose()?,
        ignore_sets,
        strict,
    })
}

impl Measurements {
    fn new(file: MeasurementFile, source: MeasurementSource) -> Self {
        Measurements { file: Arc::new(file), source: Arc::new(source) }
    }

    /// Source of rows without a file.
    pub(crate) fn in_memory(data: Dataset, name: &str) -> Self {
        let source = MeasurementSource { names: vec![name.to_owned()], ..MeasurementSource::default() };
        Measurements::new(MeasurementFile { data, ..MeasurementFile::default() }, source)
    }

    pub(crate) fn data(&self) -> &Dataset {
        &self.file.data
    }

    /// Refuses a robot whose readings are not those of the rows.
    pub(crate) fn check_robot(&self, robot: &Robot) -> PyResult<()> {
        let expected = robot.model.robot.reading_names();
        if self.data().reading_names() == expected {
            return Ok(());
        }
        Err(argument(
            "measurements",
            format!(
                "found readings of {}, expected those of robot `{}`: {}",
                self.data().reading_names().join(", "),
                robot.model.robot.name,
                expected.join(", ")
            ),
        ))
    }

    pub(crate) fn of_state(state: &[u8]) -> PyResult<Self> {
        let MeasurementState { data, warnings, source } = pickle::value(state)?;
        data.check().map_err(raise)?;
        let file = MeasurementFile { data, warnings, ..MeasurementFile::default() };
        Ok(Measurements::new(file, source))
    }

    fn words(&self) -> String {
        let data = self.data();
        let poses = data.observations.iter().filter(|row| row.measurement.sees_orientation()).count();
        let points = data.len() - poses;
        let targets: Vec<&str> = data.targets.iter().flatten().map(String::as_str).collect();
        let of = if targets.is_empty() { "the tip".to_owned() } else { targets.join(", ") };
        format!("{} rows: {poses} poses and {points} points of {of}", data.len())
    }
}

#[pymethods]
impl Measurements {
    /// Reads measurement files, joined in their order.
    ///
    /// Parameters
    /// ----------
    /// paths : a path or several
    /// robot : the robot whose joints the columns name
    /// columns : a mapping file for files with other column names
    /// fit_where : "COLUMN=VALUE[,VALUE]"
    ///     Fit only rows whose column has one of these values, and hold out all others.
    /// ignore_sets : whether the files' column `set` means nothing, as for rows that judge a calibration
    /// strict : whether lost beams, empty or zero positions, are an error instead of being skipped with a warning
    /// frames : "common" or "per-file"
    ///     Which rows share a frame of the measuring device: all (or those of one name in the column `instrument`), or those of a file.
    #[staticmethod]
    #[pyo3(signature = (paths, robot, *, columns=None, fit_where=None, ignore_sets=false, strict=false, frames="common"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_csv(
        py: Python<'_>,
        paths: Paths,
        robot: &Robot,
        columns: Option<PathBuf>,
        fit_where: Option<&str>,
        ignore_sets: bool,
        strict: bool,
        frames: &str,
    ) -> PyResult<Self> {
        let words = [("common", Frames::Common), ("per-file", Frames::PerFile)];
        let frames = chosen("frames", frames, &words)?;
        let paths = match paths {
            Paths::One(path) => vec![path],
            Paths::Several(paths) => paths,
        };
        let read = || {
            refuse_repeats(&paths)?;
            let options = options(columns.as_ref(), fit_where, ignore_sets, strict, frames)?;
            let file = measurements::read(&paths, &robot.model.robot, &options)?;
            let mut sha256 = Inputs::checksums(columns.iter().map(PathBuf::as_path))?;
            sha256.extend(file.sha256.clone());
            Ok((file, sha256))
        };
        let (file, sha256) = py.detach(read).map_err(raise)?;
        crate::warn(py, &file.warnings)?;
        let names = paths.iter().map(|path| path.display().to_string()).collect();
        Ok(Measurements::new(file, MeasurementSource { names, sha256, fit_where: fit_where.is_some() }))
    }

    /// Measurements of arrays: positions, with orientations or without, or poses.
    ///
    /// Parameters
    /// ----------
    /// joints : array of shape (m, n)
    ///     Readings in the order of `robot.reading_names`: in `angle_unit`, of sliding joints in `length_unit`.
    /// positions : array of shape (m, 3)
    ///     Positions of the target in the device's frame, in `length_unit`.
    /// quaternions_xyzw : array of shape (m, 4), with `positions`
    ///     Orientations as unit quaternions x, y, z, w; rows of NaN are points without orientation.
    /// poses : array of shape (m, 4, 4), instead of `positions`
    ///     Poses device_from_target, translations in `length_unit`.
    /// targets : list of m names, default the tip itself
    /// instruments : list of m names of the measuring devices, each with a frame of its own
    /// sets : list of m "fit" or "held_out" (or None for rows that do not say)
    /// ids : list of m names of the rows
    /// sigma_position_mm, sigma_rotation_deg : a number, or an array of shape (m,)
    ///     Standard deviations of each measured component, where rows state them; NaN where a row does not.
    /// angle_unit, length_unit : "rad", "deg", …; "m", "mm", …
    #[staticmethod]
    #[pyo3(signature = (robot, *, joints, positions=None, quaternions_xyzw=None, poses=None, targets=None, instruments=None, sets=None, ids=None,
                        sigma_position_mm=None, sigma_rotation_deg=None, angle_unit="rad", length_unit="m"))]
    #[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
    fn from_arrays(
        robot: &Robot,
        joints: &Bound<'_, PyAny>,
        positions: Option<&Bound<'_, PyAny>>,
        quaternions_xyzw: Option<&Bound<'_, PyAny>>,
        poses: Option<&Bound<'_, PyAny>>,
        targets: Option<Vec<String>>,
        instruments: Option<Vec<String>>,
        sets: Option<Vec<Option<String>>>,
        ids: Option<Vec<String>>,
        sigma_position_mm: Option<&Bound<'_, PyAny>>,
        sigma_rotation_deg: Option<&Bound<'_, PyAny>>,
        angle_unit: &str,
        length_unit: &str,
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

    /// Measurements of a data frame (pandas, polars, or anything with `columns` and columns by name).
    ///
    /// Columns have the same names, units in brackets and meanings as those of a file, `x[mm]` or `target`, and `columns`, `fit_where`,
    /// `ignore_sets` and `strict` are as for files. Missing values are empty cells.
    #[staticmethod]
    #[pyo3(signature = (frame, robot, *, columns=None, fit_where=None, ignore_sets=false, strict=false))]
    fn from_dataframe(
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        robot: &Robot,
        columns: Option<PathBuf>,
        fit_where: Option<&str>,
        ignore_sets: bool,
        strict: bool,
    ) -> PyResult<Self> {
        let text = from_dataframe::text(frame)?;
        let read = || {
            let options = options(columns.as_ref(), fit_where, ignore_sets, strict, Frames::Common)?;
            measurements::parse(&text, from_dataframe::NAME, &robot.model.robot, &options)
        };
        let mut file = py.detach(read).map_err(from_dataframe::raise)?;
        crate::warn(py, &file.warnings)?;
        // Line numbers of an internal text would mislead: errors name rows instead.
        file.data.files.clear();
        file.data.observations.iter_mut().for_each(|row| row.source = Default::default());
        let names = vec![from_dataframe::NAME.to_owned()];
        let source =
            MeasurementSource { names, fit_where: fit_where.is_some(), ..MeasurementSource::default() };
        Ok(Measurements::new(file, source))
    }

    fn __len__(&self) -> usize {
        self.data().len()
    }

    /// Names of the readings that a configuration consists of.
    #[getter]
    fn reading_names(&self) -> Vec<String> {
        self.data().reading_names().to_vec()
    }

    /// Readings, shape (m, n), radians and metres.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.data().all_readings().to_vec(), self.data().reading_names().len())
    }

    /// Measured positions in the device's frame, shape (m, 3), metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let position =
            |row: &poecal::measurement::Observation| <[f64; 3]>::from(row.measurement.pose().translation);
        table(py, self.data().observations.iter().flat_map(position).collect(), 3)
    }

    /// Measured poses device_from_target, shape (m, 4, 4); with the identity where a row has no orientation (`has_orientation`).
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let poses: Vec<_> = self.data().observations.iter().map(|row| row.measurement.pose()).collect();
        pose_arrays(py, &poses)
    }

    /// Whether a row's orientation was measured, shape (m,).
    #[getter]
    fn has_orientation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let seen = self.data().observations.iter().map(|row| row.measurement.sees_orientation());
        PyArray1::from_vec(py, seen.collect())
    }

    /// The target of each row; None for the tip itself.
    #[getter]
    fn targets(&self) -> Vec<Option<String>> {
        let data = self.data();
        data.observations.iter().map(|row| data.targets.get(row.target).cloned().flatten()).collect()
    }

    /// The instrument, or the place of it, that measured each row; None where there is one without a name.
    #[getter]
    fn instruments(&self) -> Vec<Option<String>> {
        let data = self.data();
        data.observations.iter().map(|row| data.stations.get(row.station).cloned().flatten()).collect()
    }

    /// "fit", "held_out", or None, for each row.
    #[getter]
    fn sets(&self) -> Vec<Option<&'static str>> {
        let word = |set| match set {
            Set::Fit => "fit",
            Set::HeldOut => "held_out",
        };
        self.data().observations.iter().map(|row| row.set.map(word)).collect()
    }

    /// The rows' ids; empty if they have none.
    #[getter]
    fn ids(&self) -> Vec<String> {
        self.data().ids.clone()
    }

    /// The files that the rows came from, as they were named.
    #[getter]
    fn files(&self) -> Vec<String> {
        self.data().files.iter().map(|path| path.display().to_string()).collect()
    }

    /// Warnings about the files, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.file.warnings.iter().map(|warning| python_words(warning)).collect()
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Measurements {}>", self.words())
    }

    fn _repr_html_(&self) -> String {
        visible_markup(html! {
            div {
                p { (self.words()) ", from " (self.source.names.join(", ")) }
                @for warning in &self.file.warnings { p { "warning: " (warning) } }
            }
        })
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Measurements>().is_ok_and(|other| {
            let other = other.get();
            self.file.data == other.file.data
                && self.file.warnings == other.file.warnings
                && self.source == other.source
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let MeasurementFile { data, warnings, .. } = &*self.file;
        let state = MeasurementState {
            data: data.clone(),
            warnings: warnings.clone(),
            source: (*self.source).clone(),
        };
        pickle::reduce(py, "_measurements", &state)
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }
}
