//! Contents of a calibration, converted on demand.

use std::borrow::Cow;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use poecal_calibrate::AcceptedModel;
use poecal_cli::words;
use poecal_import as measurements;
use poecal_import::{MeasurementFile, ReadOptions};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::ErrorKind;
use poecal_report as report;
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::{Model, ModelSource};
use poecal_results::record::Record;
use poecal_results::residuals::Residuals;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::errors::{argument, raise};
use crate::robot::{Robot, RobotState};
use crate::words::one_of;

/// A calibration: the calibrated robot, its errors on fitted and held-out rows, and the verdict on its trustworthiness.
///
/// `calibrate` makes one, `Calibration.read` reads one from a file. Its parts are those of `calibration.json`,
/// converted on demand.
#[pyclass(frozen, module = "poecal", name = "Calibration")]
pub(crate) struct Calibration {
    /// The nominal robot, after whose file models are written.
    pub(super) nominal: Robot,
    found: ContentSource,
    calibrated: OnceLock<Robot>,
    corrected: OnceLock<Option<Robot>>,
}

/// Source of all other contents.
enum ContentSource {
    /// A calibration of this process.
    Fit(Box<ProcessFit>),
    /// A calibration from files, or from a pickle.
    Written(Box<StoredCalibration>),
}

/// A calibration of this process; its file is made on demand.
struct ProcessFit {
    calibration: poecal_calibrate::Calibration,
    data: Arc<MeasurementFile>,
    inputs: Inputs,
    record: Record,
    took: Duration,
    file: OnceLock<CalibrationFile>,
    residuals: OnceLock<Residuals>,
    summary: OnceLock<String>,
}

/// A calibration from files.
struct StoredCalibration {
    /// The calibrated robot with its targets, exactly as fitted.
    robot: poecal_model::robot::Robot,
    file: CalibrationFile,
    residuals: Option<Residuals>,
    summary: String,
}

/// Pickled calibration.
#[derive(Serialize, Deserialize)]
pub(crate) struct CalibrationState {
    nominal: RobotState,
    robot: poecal_model::robot::Robot,
    file: String,
    residuals: Option<String>,
    summary: String,
}

/// Name for a missing file.
const UNWRITTEN: &str = "calibration.json";

impl Calibration {
    /// A calibration of `data` made in this process.
    pub(crate) fn of_fit(
        nominal: Robot,
        calibration: poecal_calibrate::Calibration,
        data: Arc<MeasurementFile>,
        (inputs, record): (Inputs, Record),
        took: Duration,
    ) -> Self {
        let fit = ProcessFit {
            calibration,
            data,
            inputs,
            record,
            took,
            file: OnceLock::new(),
            residuals: OnceLock::new(),
            summary: OnceLock::new(),
        };
        Calibration {
            nominal,
            found: ContentSource::Fit(Box::new(fit)),
            calibrated: OnceLock::new(),
            corrected: OnceLock::new(),
        }
    }

    /// A calibration from files.
    pub(super) fn from_files(
        nominal: Robot,
        robot: poecal_model::robot::Robot,
        file: CalibrationFile,
        residuals: Option<Residuals>,
        summary: String,
    ) -> Self {
        let written = StoredCalibration { robot, file, residuals, summary };
        Calibration {
            nominal,
            found: ContentSource::Written(Box::new(written)),
            calibrated: OnceLock::new(),
            corrected: OnceLock::new(),
        }
    }

    /// The file from which it was read; `None` for one that was made in a process.
    pub(crate) fn source(&self) -> Option<&Path> {
        let path = self.nominal.model.path.as_path();
        let is_file = path.extension().is_some_and(|it| it.eq_ignore_ascii_case("json"));
        matches!(self.found, ContentSource::Written(_)).then_some(path).filter(|_| is_file)
    }

    /// The same robot with another result.
    pub(crate) fn with_result(
        &self,
        robot: poecal_model::robot::Robot,
        file: CalibrationFile,
        summary: String,
    ) -> Self {
        Calibration::from_files(self.nominal.clone(), robot, file, None, summary)
    }

    /// The calibration as a state.
    pub(super) fn state(&self) -> PyResult<CalibrationState> {
        Ok(CalibrationState {
            nominal: self.nominal.state()?,
            robot: self.as_fitted(),
            file: self.file().to_text().map_err(raise)?,
            residuals: self.rows().ok().map(Residuals::text),
            summary: self.summary().to_owned(),
        })
    }

    /// The calibration from a state.
    pub(crate) fn of_state(state: CalibrationState) -> PyResult<Self> {
        let CalibrationState { nominal, robot, file, residuals, summary } = state;
        let file = CalibrationFile::parse(&file, UNWRITTEN).map_err(raise)?;
        let residuals = residuals.map(|text| Residuals::parse(&text, "residuals.csv")).transpose().map_err(raise)?;
        Ok(Calibration::from_files(Robot::of_state(nominal)?, robot, file, residuals, summary))
    }

    /// The rows from which it was made: at hand, or read from the files that it names.
    pub(crate) fn own_rows(&self) -> PyResult<Cow<'_, Dataset>> {
        let written = match &self.found {
            ContentSource::Fit(fit) => return Ok(Cow::Borrowed(&fit.data.data)),
            ContentSource::Written(written) => written,
        };
        let file = &written.file;
        let paths = self.source().and_then(|source| file.own_measurements(source)).ok_or_else(|| {
            let names = file.inputs.measurements.join(", ");
            let message = format!(
                "found none, and the measurements of the calibration ({names}) are not where it was made or have other bytes, expected \
                 measurements of the calibration or of an earlier visit"
            );
            argument("earlier", message)
        })?;
        let mut meaning =
            ReadOptions { ignore_sets: true, controller: file.controller.clone(), ..ReadOptions::default() };
        if let Some(known) = &file.pictures {
            known.complete_options(&mut meaning).map_err(raise)?;
        }
        let read = measurements::read(&paths, &written.robot, &meaning).map_err(raise)?;
        Ok(Cow::Owned(read.data))
    }

    /// The contents of `calibration.json`.
    pub(crate) fn file(&self) -> &CalibrationFile {
        match &self.found {
            ContentSource::Fit(fit) => fit.file.get_or_init(|| CalibrationFile {
                record: fit.record.clone(),
                ..CalibrationFile::new(&fit.calibration, &fit.data.data, fit.inputs.clone())
            }),
            ContentSource::Written(written) => &written.file,
        }
    }

    /// Residuals of each row.
    pub(crate) fn rows(&self) -> PyResult<&Residuals> {
        match &self.found {
            ContentSource::Fit(fit) => {
                Ok(fit.residuals.get_or_init(|| Residuals::from_calibration(&fit.data.data, &fit.calibration)))
            }
            ContentSource::Written(written) => written.residuals.as_ref().ok_or_else(|| {
                let message =
                    "found no residuals.csv beside the calibration.json, expected it: name it in Calibration.read";
                argument("residuals", message)
            }),
        }
    }

    /// The program's table.
    pub(super) fn summary(&self) -> &str {
        match &self.found {
            ContentSource::Fit(fit) => fit.summary.get_or_init(|| report::summary(self.file(), report::Detail::Short)),
            ContentSource::Written(written) => &written.summary,
        }
    }

    /// Time of the library in seconds, for a calibration of this process.
    pub(super) fn seconds(&self) -> Option<f64> {
        match &self.found {
            ContentSource::Fit(fit) => Some(fit.took.as_secs_f64()),
            ContentSource::Written(_) => None,
        }
    }

    /// Errors of the three models; those of a fit need no file.
    pub(super) fn errors(&self) -> poecal_calibrate::Accuracy {
        match &self.found {
            ContentSource::Fit(fit) => fit.calibration.accuracy,
            ContentSource::Written(written) => written.file.accuracy,
        }
    }

    /// The verdict.
    pub(super) fn require_verdict(&self) -> PyResult<&poecal_calibrate::Verdict> {
        match &self.found {
            ContentSource::Fit(fit) => Ok(&fit.calibration.verdict),
            ContentSource::Written(written) => written.file.verdict.as_ref().ok_or_else(|| {
                let message = "found a calibration without a verdict, expected one: calibrate again with this version";
                raise(ErrorKind::Model.error(message))
            }),
        }
    }

    /// The delivered model: the corrected one if it has terms.
    pub(crate) fn delivered_model(&self) -> AcceptedModel {
        let verdict = match &self.found {
            ContentSource::Fit(fit) => Some(&fit.calibration.verdict),
            ContentSource::Written(written) => written.file.verdict.as_ref(),
        };
        verdict.and_then(|verdict| verdict.model).unwrap_or_else(|| {
            // Files of earlier versions do not state it.
            match self.file().corrected.as_ref().is_some_and(|it| it.has_terms()) {
                true => AcceptedModel::Corrected,
                false => AcceptedModel::Calibrated,
            }
        })
    }

    /// The calibrated robot with its targets, exactly as fitted.
    pub(super) fn as_fitted(&self) -> poecal_model::robot::Robot {
        match &self.found {
            ContentSource::Fit(fit) => fit.calibration.robot_with_targets(),
            ContentSource::Written(written) => written.robot.clone(),
        }
    }

    /// The calibrated robot as in its file, which makes all predictions.
    pub(crate) fn calibrated_robot(&self) -> PyResult<&Robot> {
        if let Some(robot) = self.calibrated.get() {
            return Ok(robot);
        }
        let file = self.file().clone();
        let robot = file.robot().map_err(raise)?;
        let model = Model { robot, source: ModelSource::Calibration(Box::new(file)), path: UNWRITTEN.into() };
        Ok(self.calibrated.get_or_init(|| Robot::new(model)))
    }

    /// The robot that a word names: "corrected", if there is one, or "calibrated".
    pub(crate) fn actual_robot(&self, model: &str) -> PyResult<&Robot> {
        let is_corrected = one_of("model", model, words::MODEL)? == AcceptedModel::Corrected;
        let corrected = if is_corrected { self.optional_corrected_robot()? } else { None };
        corrected.map_or_else(|| self.calibrated_robot(), Ok)
    }

    /// The corrected robot as in the file; `None` without terms.
    pub(crate) fn optional_corrected_robot(&self) -> PyResult<Option<&Robot>> {
        if let Some(robot) = self.corrected.get() {
            return Ok(robot.as_ref());
        }
        let made = self.file().corrected_file().map(|file| {
            let robot = file.robot().map_err(raise)?;
            let source = ModelSource::Calibration(Box::new(file));
            Ok::<_, PyErr>(Robot::new(Model { robot, source, path: UNWRITTEN.into() }))
        });
        let made = made.transpose()?;
        Ok(self.corrected.get_or_init(|| made).as_ref())
    }
}

/// A part of a file as Python dicts and lists.
pub(super) fn part<'py>(py: Python<'py>, part: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = report::json(part).map_err(raise)?;
    py.import("json")?.call_method1("loads", (text,))
}
