//! Rows of a test from files: where the target was commanded to be, and where it was measured.
//!
//! Commands are joint readings of a robot, or poses in the columns `commanded_x`, `commanded_y`, `commanded_z` with or without `commanded_roll`,
//! `commanded_pitch`, `commanded_yaw`. These are readings too: of a gantry whose tip is the commanded pose. So all forms of measurement files are read.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nalgebra::Vector3;

use super::TestFrame;
use crate::calibration_file::CalibrationFile;
use crate::model::{Model, ModelSource};
use crate::predictions::{PredictionFrame, default_target, predict_readings};
use crate::record::Record;
use poecal_arm::lie::{Pose, Screw};
use poecal_calibrate::{TestLabels, TestRow};
use poecal_import::{MeasurementFile, ReadOptions, read, read_labels};
use poecal_model::measurement::{Dataset, Observation, Quantity};
use poecal_model::robot::{Joint, Robot};
use poecal_numerics::error::{ErrorKind, Result};

/// Columns of what was done, in the order of [`TestLabels`].
const LABELS: [&str; 7] = ["pose", "cycle", "approach", "series", "arm", "speed", "payload"];
/// Columns of commanded positions, and of their orientations.
const COMMANDED: [&str; 3] = ["commanded_x", "commanded_y", "commanded_z"];
const TURNED: [&str; 3] = ["commanded_yaw", "commanded_pitch", "commanded_roll"];
/// Commanded orientations (radians) within this are one.
const SAME_RAD: f64 = 0.01;

/// Options of reading the rows of a test.
#[derive(Clone, Debug, Default)]
pub struct TestOptions {
    /// Options of reading measurement files.
    pub reading: ReadOptions,
    /// The device's frame.
    pub frame: TestFrame,
    /// Standard deviation of the instrument's noise, each component, for rows that state none, metres.
    pub sigma_position_m: Option<f64>,
    /// The same of rotations, radians.
    pub sigma_rotation_rad: Option<f64>,
}

/// Rows of a test.
#[derive(Clone, Debug, Default)]
pub(super) struct TestFile {
    /// The rows.
    pub(super) rows: Vec<TestRow>,
    /// Pose of the device in the base, if it is stated.
    pub(super) base_from_device: Option<Pose>,
    /// Result of reading the files.
    pub(super) read: MeasurementFile,
    /// Warnings, a sentence each.
    pub(super) warnings: Vec<String>,
}

/// Reads the rows of a test. With a robot, commands are its joint readings, by the nominal model; of a calibration.json the rows are also predicted by the
/// corrected model. Without one, files have the columns of commanded poses.
///
/// # Errors
/// As [`poecal_import::read()`]; [`ErrorKind::Measurement`] if a row has no position, or rows are of several targets or device frames;
/// [`ErrorKind::Option`] for the frame of a calibration without one.
pub(super) fn read_test(paths: &[PathBuf], model: Option<&Model>, options: &TestOptions) -> Result<TestFile> {
    let gantry = gantry(paths, options, model.is_none())?;
    let commanded = match (model, &gantry) {
        (Some(model), _) => nominal_model(model)?,
        (None, robot) => Model { robot: robot.clone(), source: ModelSource::Toml, path: PathBuf::new() },
    };
    let reading = ReadOptions { ignore_sets: true, ..options.reading.clone() };
    let mut reading = model.map_or(reading.clone(), |model| model.reads(reading));
    if let Some((model, known)) = model.and_then(|it| Some((it, calibration(it)?.pictures.as_ref()?))) {
        known.complete_options(&mut reading).map_err(|error| error.in_file(&model.path))?;
    }
    let read = read(paths, &commanded.robot, &without_labels(&reading, &commanded.robot))?;
    let data = &read.data;
    refuse_several(data)?;
    let base_from_device = stated_frame(model, options.frame)?;
    let target = target_of(model, data);
    let readings: Vec<f64> = (0..data.len()).flat_map(|row| data.readings(row)).copied().collect();
    let poses = |model: &Model| {
        Ok::<_, poecal_numerics::error::Error>(
            predict_readings(model, &readings, PredictionFrame::Base, target.as_deref(), false)?.poses,
        )
    };
    let wanted = poses(&commanded)?;
    let calibrated = match model {
        Some(model) if calibration(model).is_some() => Some(poses(&model.clone().corrected_model()?)?),
        _ => None,
    };
    let labels = RowLabels::read(paths, &commanded.robot, &reading);
    let rows = data.observations.iter().enumerate().map(|(row, seen)| {
        let place = place(data, seen);
        let Some(position_m) = seen.measurement.position() else {
            return ErrorKind::Measurement.refuse(format!(
                "{place}: found {}, expected the position of the target, x, y and z, or its corners in pictures: test with a device that measures these",
                seen.measurement.function().name
            ));
        };
        Ok(TestRow {
            commanded: wanted[row],
            calibrated: calibrated.as_ref().map(|it| it[row]),
            position_m,
            rotation: seen.measurement.orientation(),
            noise: [
                seen.stated.get(Quantity::Position).or(options.sigma_position_m),
                seen.stated.get(Quantity::Rotation).or(options.sigma_rotation_rad),
            ],
            labels: labels.find(data, row, seen),
            place,
        })
    });
    let mut rows = rows.collect::<Result<Vec<TestRow>>>()?;
    let mut warnings = doubts(model, &mut rows, target.as_deref(), options.frame);
    warnings.extend(model.and_then(|model| find_fitted_files(calibration(model)?, &read)));
    Ok(TestFile { rows, base_from_device, warnings, read })
}

impl TestFile {
    /// A record with the speed and load that rows state.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if it states another speed or load than the rows.
    pub(super) fn completed(&self, record: Record) -> Result<Record> {
        let Some(TestRow { labels, place, .. }) = self.rows.first() else { return Ok(record) };
        let mut record = record;
        let pairs = [("speed", &labels.speed, &mut record.speed), ("payload", &labels.payload, &mut record.payload)];
        for (key, own, stated) in pairs {
            match stated {
                _ if own.is_empty() => {}
                None => *stated = Some(own.clone()),
                Some(stated) if stated == own => {}
                Some(stated) => {
                    return ErrorKind::Option.refuse(format!(
                        "{place}: found the {key} `{own}` and `{stated}` in the record, expected one {key}: correct either"
                    ));
                }
            }
        }
        Ok(record)
    }
}

/// The same options for the measurements alone, beside which labels have no meaning but as factors of the robot.
fn without_labels(reading: &ReadOptions, robot: &Robot) -> ReadOptions {
    let mut reading = reading.clone();
    let known = robot.reading_names();
    let names = LABELS.iter().map(|it| (*it).to_owned()).filter(|it| !known.contains(it));
    reading.mapping.get_or_insert_default().ignore_columns(names);
    reading
}

/// The calibration of a model.
fn calibration(model: &Model) -> Option<&CalibrationFile> {
    match &model.source {
        ModelSource::Calibration(file) => Some(file),
        ModelSource::Urdf(_) | ModelSource::Toml => None,
    }
}

/// The model by which a controller commands: the nominal one.
fn nominal_model(model: &Model) -> Result<Model> {
    let robot = match calibration(model) {
        Some(file) => file.nominal_robot().map_err(|error| error.in_file(&model.path))?,
        None => model.robot.clone(),
    };
    Ok(Model { robot, ..model.clone() })
}

/// Whose tip is at the pose that it reads: sliding axes x, y, z, and turning ones if a file has orientations.
fn gantry(paths: &[PathBuf], options: &TestOptions, is_needed: bool) -> Result<Robot> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let slides = COMMANDED.iter().zip(axes);
    let mut joints: Vec<Joint> = slides.map(|(name, axis)| Joint::prismatic(name, Screw::prismatic(&axis))).collect();
    let of_positions = Robot::new("commanded", joints.clone(), Pose::identity())?;
    let Some(path) = paths.first().filter(|_| is_needed) else { return Ok(of_positions) };
    let names: Vec<&str> = COMMANDED.into_iter().chain(TURNED).collect();
    let found = read_labels(path, &names, &of_positions, &options.reading)?;
    if let Some((_, missing)) = found.has.iter().zip(&names).take(3).find(|(has, _)| !**has) {
        let message = format!(
            "found no column `{missing}`, expected commanded_x, commanded_y, commanded_z with their units, or the robot whose joint readings the file has: --robot MODEL"
        );
        return Err(ErrorKind::Measurement.error(message).in_file(path));
    }
    if found.has.iter().skip(3).any(|has| *has) {
        let turns = TURNED.iter().zip(axes.into_iter().rev());
        joints.extend(turns.map(|(name, axis)| Joint::revolute(name, Screw::revolute(&axis, &Vector3::zeros()))));
        return Robot::new("commanded", joints, Pose::identity());
    }
    Ok(of_positions)
}

/// Refuses rows of several targets, or of devices with frames of their own.
fn refuse_several(data: &Dataset) -> Result<()> {
    let refuse = |count: usize, what: &str, remedy: &str| {
        let message = format!("found rows of {count} {what}, expected those of one: {remedy}");
        let error = ErrorKind::Measurement.error(message);
        Err(data.files.first().map_or(error.clone(), |path| error.in_file(path)))
    };
    if data.targets.len() > 1 {
        return refuse(data.targets.len(), "targets", "test each by a file of its own");
    }
    if data.station_count() > 1 {
        return refuse(data.station_count(), "device frames", "test each by a file of its own");
    }
    Ok(())
}

/// Pose of the device in the base, if it is stated.
fn stated_frame(model: Option<&Model>, frame: TestFrame) -> Result<Option<Pose>> {
    match frame {
        TestFrame::Unknown => Ok(None),
        TestFrame::Base => Ok(Some(Pose::identity())),
        TestFrame::Calibration => {
            let Some((model, file)) = model.and_then(|it| Some((it, calibration(it)?))) else {
                return ErrorKind::Option.refuse(
                    "found --device-frame calibration and no calibration, expected --robot calibration.json, or the frame unknown or base",
                );
            };
            let corrected = file.corrected_file();
            let own = corrected.as_ref().unwrap_or(file);
            own.base_from_device().map(Some).map_err(|error| error.in_file(&model.path))
        }
    }
}

/// The target that rows are of, if the model knows it; else the tip.
fn target_of(model: Option<&Model>, data: &Dataset) -> Option<String> {
    let model = model?;
    let named = data.targets.first().cloned().flatten();
    let robot = &model.robot;
    let knows =
        |name: &String| robot.targets.iter().any(|it| it.0 == *name) || robot.mounted.iter().any(|it| it.name == *name);
    if let Some(name) = named {
        return Some(name).filter(knows);
    }
    calibration(model)?;
    default_target(model, PredictionFrame::Base, true).ok().flatten().map(str::to_owned)
}

/// File and line of a row.
fn place(data: &Dataset, seen: &Observation) -> String {
    let file = data.files.get(seen.source.file as usize).map(|it: &PathBuf| it.display().to_string());
    format!("{}:{}", file.unwrap_or_default(), seen.source.line)
}

/// Words of what was done, by lines of files and by pictures.
#[derive(Default)]
struct RowLabels {
    by_line: BTreeMap<(PathBuf, usize), Vec<String>>,
    by_image: BTreeMap<String, Vec<String>>,
}

impl RowLabels {
    /// Reads the columns of each file; a file in another form has none.
    fn read(paths: &[PathBuf], robot: &Robot, reading: &ReadOptions) -> Self {
        let names: Vec<&str> = LABELS.into_iter().chain(["image"]).collect();
        let mut all = RowLabels::default();
        for path in paths {
            let columns = read_labels(path, &names, robot, reading).unwrap_or_default();
            if !columns.has.iter().take(LABELS.len()).any(|has| *has) {
                continue;
            }
            for (line, words) in columns.lines {
                if let Some(image) = words.last().filter(|it| !it.is_empty()) {
                    all.by_image.insert(image.clone(), words.clone());
                }
                all.by_line.insert((path.clone(), line), words);
            }
        }
        all
    }

    /// Words of a row: those of its line, else of its picture.
    fn find(&self, data: &Dataset, row: usize, seen: &Observation) -> TestLabels {
        let path = data.files.get(seen.source.file as usize).cloned().unwrap_or_default();
        let image = || {
            let picture = data.pictures.all.get(data.pictures.index_of_row(u32::try_from(row).ok()?)?)?;
            self.by_image.get(picture.image.as_ref()?)
        };
        let words = self.by_line.get(&(path, seen.source.line as usize)).or_else(image);
        let word = |at: usize| words.and_then(|it| it.get(at)).cloned().unwrap_or_default();
        let [pose, cycle, approach, series, arm, speed, payload] = std::array::from_fn(word);
        TestLabels { pose, cycle, approach, series, arm, speed, payload }
    }
}

/// Files of which the calibration was made, whose rows it predicts better than others.
fn find_fitted_files(file: &CalibrationFile, read: &MeasurementFile) -> Option<String> {
    let sums: Vec<&String> = file.inputs.measurements.iter().filter_map(|name| file.inputs.sha256.get(name)).collect();
    let (name, _) = read.sha256.iter().find(|(_, sum)| sums.contains(sum))?;
    Some(format!(
        "{name}: the calibration was made of this file, so the accuracy of corrected commands is better here than elsewhere: predict it from other rows"
    ))
}

/// Doubts about accuracy, a sentence each; takes orientations away whose target is not known.
fn doubts(model: Option<&Model>, rows: &mut [TestRow], target: Option<&str>, frame: TestFrame) -> Vec<String> {
    let mut said = Vec::new();
    let Some(model) = model else { return said };
    let first = rows.first().map(|it| it.commanded);
    let turn_rad =
        rows.iter().zip(first).map(|(row, first)| row.commanded.distance_and_angle(&first).1).fold(0.0, f64::max);
    if target.is_none() && turn_rad > SAME_RAD && calibration(model).is_none() {
        said.push(format!(
            "found commanded orientations that differ by up to {:.1} deg and a target whose place on the flange is not known, expected it in the model: \
             AP contains its lever arm, if it is not at the tip",
            turn_rad.to_degrees()
        ));
    }
    let entry = calibration(model).zip(target).and_then(|(file, name)| file.targets.get(name));
    if frame != TestFrame::Unknown && entry.is_some_and(|it| it.quaternion_xyzw.is_none()) {
        rows.iter_mut().for_each(|row| row.rotation = None);
    }
    said
}
