//! Earlier rows of a calibrated robot, and configurations to measure at its visits: for `poecal track` and `poecal plan --purpose drift`.

use std::path::{Path, PathBuf};

use poecal_calibrate::DeviceFrameKnowledge;
use poecal_import as measurements;
use poecal_import::{MeasurementFile, ReadOptions, read_joints};
use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_report as report;
use poecal_results::calibration_file::CalibrationFile;
use poecal_results::track::{Baseline, TrackOptions, witnesses};
use poecal_storage::named_files::refuse_repeats;

use crate::console::Console;

/// A calibration with the interpretation of its rows and the knowledge of its visits.
pub(super) struct VisitedCalibration {
    pub(super) file: CalibrationFile,
    pub(super) robot: Robot,
    pub(super) meaning: ReadOptions,
    pub(super) options: TrackOptions,
    pub(super) earlier: EarlierRows,
}

/// Statements about the visits.
pub(super) struct VisitSettings<'a> {
    pub(super) calibration: &'a Path,
    pub(super) reference: &'a [PathBuf],
    pub(super) meaning: ReadOptions,
    pub(super) device_is_known: Option<bool>,
    pub(super) tool_is_anew: bool,
    pub(super) repeatability_m: Option<f64>,
}

impl VisitedCalibration {
    /// Reads the calibration and the earlier rows.
    pub(super) fn read(stated: VisitSettings<'_>, console: &Console) -> Result<Self> {
        let file = CalibrationFile::read(stated.calibration)?;
        let in_file = |error: poecal_numerics::error::Error| {
            if error.kind() == ErrorKind::Model { error.in_file(stated.calibration) } else { error }
        };
        let robot = file.robot().map_err(in_file)?;
        let mut meaning = ReadOptions { ignore_sets: true, controller: file.controller.clone(), ..stated.meaning };
        if let Some(known) = &file.pictures {
            known.complete_options(&mut meaning).map_err(|error| error.in_file(stated.calibration))?;
        }
        if file.has_another_model(stated.calibration) {
            console.remark(format!(
                "the model {} has other bytes than when it was calibrated: the visit is judged by the model in the calibration",
                file.inputs.model
            ));
        }
        let is_base = file.frame() == DeviceFrameKnowledge::Base;
        let options = TrackOptions {
            device_is_known: stated.device_is_known.unwrap_or(is_base),
            tool_is_anew: stated.tool_is_anew,
            repeatability_m: stated.repeatability_m,
        };
        let earlier = EarlierRows::read(stated.calibration, stated.reference, (&file, &robot, &meaning), console)?;
        Ok(VisitedCalibration { file, robot, meaning, options, earlier })
    }

    /// Chooses `count` configurations, of the earlier rows or of a file of joint readings: their detectable shifts, and the table to fill in.
    /// `option` is the option that requested it.
    pub(super) fn plan_visit(
        &self,
        option: &str,
        count: usize,
        target: Option<&str>,
        new: Option<&PathBuf>,
    ) -> Result<(report::WitnessPlan, String)> {
        let Some(rows) = self.earlier.rows() else {
            return ErrorKind::Option.refuse(format!(
                "{option}: found no earlier rows, expected those of the calibration or of --reference: their configurations are those to be repeated"
            ));
        };
        let new = new.map(|path| read_joints(path, &self.robot, &self.meaning)).transpose()?;
        let readings = new.as_ref().map(|it| it.readings.as_slice());
        let kept = rows.kept_rows(&self.file);
        let found = witnesses(&self.file, &kept, readings, count, target, &self.options)?;
        let told = report::WitnessPlan::new(&found, &self.file.robot.name, new.is_some());
        let table = measurements::to_measure_again(&found.rows, &found.configurations, &self.robot, new.is_some())?;
        Ok((told, table))
    }
}

/// The earlier rows.
pub(super) struct EarlierRows {
    pub(super) read: Option<MeasurementFile>,
    /// True if they are those of the calibration.
    is_own: bool,
}

impl EarlierRows {
    /// The named rows, or else those of the calibration if they still exist.
    fn read(
        calibration: &Path,
        reference: &[PathBuf],
        (file, robot, meaning): (&CalibrationFile, &Robot, &ReadOptions),
        console: &Console,
    ) -> Result<Self> {
        if !reference.is_empty() {
            refuse_repeats(reference)?;
            let read = measurements::read(reference, robot, meaning)?;
            let own: Vec<&String> =
                file.inputs.measurements.iter().filter_map(|name| file.inputs.sha256.get(name)).collect();
            let is_own = read.sha256.values().all(|sha256| own.contains(&sha256));
            return Ok(EarlierRows { read: Some(read), is_own });
        }
        let names = file.inputs.measurements.join(", ");
        let Some(paths) = file.own_measurements(calibration) else {
            console.remark(format!(
                "the measurements of the calibration ({names}) are not where it was made, or have other bytes: name earlier rows by --reference; \
                 without, rows are judged by the model"
            ));
            return Ok(EarlierRows { read: None, is_own: false });
        };
        let read = measurements::read(&paths, robot, meaning);
        if let Err(error) = &read {
            console.remark(format!(
                "the measurements of the calibration ({names}) cannot be read with the options of this visit ({error}): rows are judged by the model"
            ));
        }
        Ok(EarlierRows { read: read.ok(), is_own: true })
    }

    pub(super) fn rows(&self) -> Option<Baseline<'_>> {
        self.read.as_ref().map(|it| Baseline { data: &it.data, is_own: self.is_own })
    }
}
