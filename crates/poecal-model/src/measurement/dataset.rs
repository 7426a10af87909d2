//! All measurements of a calibration, with their configurations and targets.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{KnownLength, Measurement, MovingRows, NoiseShape, Observation, PoseResidual, Quantity};
use crate::camera::Pictures;
use crate::robot::Controller;
use poecal_numerics::error::{Error, ErrorKind, Result};

/// Measurements with the configurations they were taken in. Readings are stored flat, one after the other.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::measurement::{Dataset, Measurement};
/// # }
/// use poecal::{Dataset, Measurement};
/// use nalgebra::Vector3;
/// let mut data = Dataset::new(vec!["joint1".into(), "joint2".into()]);
/// let seen = Measurement::point(Vector3::new(0.1, 0.2, 0.3));
/// data.push(&[0.1, -0.4], None, seen)?;
/// assert_eq!((data.len(), data.readings(0)), (1, &[0.1, -0.4][..]));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dataset {
    pub(crate) reading_names: Vec<String>,
    pub(crate) readings: Vec<f64>,
    #[serde(default)]
    pub(crate) further_readings: Vec<f64>,
    /// Number of the last readings that belong to no joint.
    #[serde(default)]
    pub(crate) factors: usize,
    /// Names of the targets; `None` is the only one, which no row names ([`MEASURED`](crate::robot::MEASURED)).
    pub targets: Vec<Option<String>>,
    /// Names of the stations of the device, each with a frame of its own; empty for a single station without a name.
    #[serde(default)]
    pub stations: Vec<Option<String>>,
    /// Known distances between stations.
    #[serde(default)]
    pub lengths: Vec<KnownLength>,
    /// Shapes of the noise of positions.
    #[serde(default)]
    pub noise_shapes: Vec<NoiseShape>,
    /// The rows that were measured in motion.
    #[serde(default)]
    pub moving: MovingRows,
    /// The pictures among the rows.
    #[serde(default)]
    pub pictures: Pictures,
    /// Relation of the readings to those that the controller counts, if they are not equal one by one.
    #[serde(default)]
    pub controller: Option<Controller>,
    /// The rows.
    pub observations: Vec<Observation>,
    /// The rows' `id`, empty if there is no such column.
    pub ids: Vec<String>,
    /// Files that the rows came from.
    pub files: Vec<PathBuf>,
    /// Formulation of the residuals of measured frames, if not that of their type. Files do not contain it.
    #[serde(skip)]
    pub pose_residual: Option<&'static dyn PoseResidual>,
}

impl Dataset {
    /// An empty data set whose configurations consist of these readings.
    #[must_use]
    pub fn new(reading_names: Vec<String>) -> Self {
        Dataset { reading_names, ..Dataset::default() }
    }

    /// The same data set with the last `count` readings of no joint: they do not distinguish configurations.
    #[must_use]
    pub fn with_factors(self, count: usize) -> Self {
        Dataset { factors: count, ..self }
    }

    /// Readings of a row that belong to joints: these define a configuration.
    pub(crate) fn of_joints(&self, row: u32) -> &[f64] {
        let readings = self.readings(row as usize);
        &readings[..readings.len().saturating_sub(self.factors)]
    }

    /// Names of the readings of a configuration.
    #[must_use]
    pub fn reading_names(&self) -> &[String] {
        &self.reading_names
    }

    /// Adds a measurement of a target (`None`: the only one) in a configuration (radians, metres).
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if the number of readings is wrong, or a number is not finite.
    pub fn push(&mut self, readings: &[f64], target: Option<&str>, measurement: Measurement) -> Result<()> {
        let target = self.target_index(target);
        self.push_observation(readings, Observation::new(target, measurement))
    }

    /// Adds a row by the index of its target.
    ///
    /// # Errors
    /// As [`Dataset::push`].
    pub fn push_observation(&mut self, readings: &[f64], observation: Observation) -> Result<()> {
        self.check_readings(readings)?;
        if !observation.measurement.is_finite() {
            return Err(not_finite());
        }
        self.readings.extend_from_slice(readings);
        self.observations.push(observation);
        Ok(())
    }

    /// Some rows of one configuration as if they had been measured in others: the subject of a plan. Their measured numbers are kept, and
    /// have no meaning.
    pub fn as_if_at(&self, rows: &[u32], readings: &[f64], width: usize) -> Result<Self> {
        let mut made = Dataset {
            readings: Vec::new(),
            noise_shapes: Vec::new(),
            moving: MovingRows::default(),
            pictures: Pictures::default(),
            observations: Vec::new(),
            ids: Vec::new(),
            ..self.clone()
        };
        for own in readings.chunks(width.max(1)) {
            for &row in rows {
                // Readings of no joint stay.
                let rest = self.readings(row as usize).get(own.len()..).unwrap_or_default();
                let seen = self.observations[row as usize];
                let seen = Observation { from: None, noise_shape: None, ..seen };
                made.push_observation(&[own, rest].concat(), seen)?;
            }
        }
        Ok(made)
    }

    fn check_readings(&self, readings: &[f64]) -> Result<()> {
        if readings.len() != self.reading_names.len() {
            return ErrorKind::Measurement.refuse(format!(
                "found {} joint readings, expected {}: {}",
                readings.len(),
                self.reading_names.len(),
                self.reading_names.join(", ")
            ));
        }
        if is_finite(readings) { Ok(()) } else { Err(not_finite()) }
    }

    /// Checks the consistency of a data set of other origin, such as a serialised one.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`].
    pub fn check(&self) -> Result<()> {
        let files = self.files.len().max(1);
        let further = u32::try_from(self.further_readings.len() / self.reading_names.len().max(1)).unwrap_or(u32::MAX);
        let fits = self.readings.len() == self.reading_names.len() * self.len()
            && (self.ids.is_empty() || self.ids.len() == self.len())
            && self.observations.iter().all(|row| row.target < self.targets.len())
            && self.observations.iter().all(|row| row.station < self.station_count())
            && self.lengths.iter().all(|it| it.stations.iter().all(|&at| at < self.station_count()))
            && self.observations.iter().filter_map(|row| row.from).all(|from| from < further)
            && self
                .observations
                .iter()
                .filter_map(|row| row.noise_shape)
                .all(|at| (at as usize) < self.noise_shapes.len())
            && self.moving.rates.len() == self.moving.times_s.len() * self.reading_names.len()
            && self
                .observations
                .iter()
                .filter_map(|row| row.moving)
                .all(|at| (at as usize) < self.moving.times_s.len())
            && self.observations.iter().all(|row| (row.source.file as usize) < files)
            && self.pictures.all.iter().all(|it| (it.row as usize) < self.len() && self.pictures.view(it).is_some());
        if fits {
            return Ok(());
        }
        ErrorKind::Measurement.refuse("found readings, rows and targets of a data set that do not fit together, expected a reading of each joint and a \
                       target in every row")
    }

    /// States the noise of a row's position by its standard deviation σ, metres, and its shape.
    pub fn state_noise(&mut self, row: usize, (sigma_m, shape): (f64, NoiseShape)) {
        let Some(observation) = self.observations.get_mut(row) else { return };
        observation.stated.set(Quantity::Position, Some(sigma_m));
        observation.noise_shape = u32::try_from(self.noise_shapes.len()).ok();
        self.noise_shapes.push(shape);
    }

    /// Shape of the noise of a row's position, if it is not the same in all directions.
    #[must_use]
    pub fn noise_shape(&self, observation: &Observation) -> Option<&NoiseShape> {
        self.noise_shapes.get(observation.noise_shape? as usize)
    }

    /// States the rates of a row's readings (rad/s, m/s), and the time of its measurement, seconds from the middle of all such rows.
    pub fn state_motion(&mut self, row: usize, rates: &[f64], time_s: f64) {
        let Some(observation) = self.observations.get_mut(row) else { return };
        if rates.len() == self.reading_names.len() {
            observation.moving = u32::try_from(self.moving.times_s.len()).ok();
            self.moving.rates.extend_from_slice(rates);
            self.moving.times_s.push(time_s);
        }
    }

    /// Rates of the readings of a row (rad/s, m/s), and its time from the middle of all such rows, seconds, if it was measured in motion.
    #[must_use]
    pub fn motion(&self, observation: &Observation) -> Option<(&[f64], f64)> {
        let (at, width) = (observation.moving? as usize, self.reading_names.len());
        Some((self.moving.rates.get(at * width..(at + 1) * width)?, *self.moving.times_s.get(at)?))
    }

    /// Index of a target, added if it is new.
    pub fn target_index(&mut self, name: Option<&str>) -> usize {
        if let Some(index) = self.targets.iter().position(|target| target.as_deref() == name) {
            return index;
        }
        self.targets.push(name.map(str::to_owned));
        self.targets.len() - 1
    }

    /// Target that was seen most, the first of several; `None` without targets.
    #[must_use]
    pub fn most_seen_target(&self) -> Option<usize> {
        let mut counts = vec![0_usize; self.targets.len()];
        for observation in &self.observations {
            if let Some(count) = counts.get_mut(observation.target) {
                *count += 1;
            }
        }
        (0..counts.len()).max_by_key(|at| (counts[*at], std::cmp::Reverse(*at)))
    }

    /// Number of stations.
    #[must_use]
    pub fn station_count(&self) -> usize {
        self.stations.len().max(1)
    }

    /// Index of a station, added if it is new.
    pub fn station_index(&mut self, name: Option<&str>) -> usize {
        if self.stations.is_empty() && !self.is_empty() {
            self.stations.push(None);
        }
        if let Some(index) = self.stations.iter().position(|station| station.as_deref() == name) {
            return index;
        }
        self.stations.push(name.map(str::to_owned));
        self.stations.len() - 1
    }

    /// Rows, among some, that were measured from one station, in their order.
    #[must_use]
    pub fn seen_from(&self, station: usize, rows: &[u32]) -> Vec<u32> {
        if station == 0 && self.station_count() == 1 {
            return rows.to_vec();
        }
        rows.iter().copied().filter(|&row| self.observations[row as usize].station == station).collect()
    }

    /// First station of some rows, whose frame stays if the base frame is a choice.
    #[must_use]
    pub fn first_station(&self, rows: &[u32]) -> usize {
        if self.station_count() == 1 {
            return 0;
        }
        rows.iter().map(|&row| self.observations[row as usize].station).min().unwrap_or_default()
    }

    /// Sets the formulation of the errors of measured frames; without measured frames nothing changes.
    pub fn write_poses_by(&mut self, pose_residual: Option<&'static dyn PoseResidual>) {
        let has_frames = self.observations.iter().any(|row| row.measurement.sees_orientation());
        self.pose_residual = pose_residual.filter(|_| has_frames);
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.observations.len()
    }

    /// True if there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.observations.is_empty()
    }

    /// The indices of all rows.
    #[must_use]
    pub fn all_rows(&self) -> Vec<u32> {
        (0..u32::try_from(self.len()).unwrap_or(u32::MAX)).collect()
    }

    /// Place of a row in messages: file and line, or its number from 1.
    #[must_use]
    pub fn place(&self, row: u32) -> String {
        let source = self.observations.get(row as usize).map(|observation| observation.source);
        match source.and_then(|source| Some((self.files.get(source.file as usize)?, source.line))) {
            Some((file, line)) if line > 0 => format!("{}:{line}", file.display()),
            _ => format!("row {}", row + 1),
        }
    }

    /// The readings of a row (radians, metres).
    #[must_use]
    pub fn readings(&self, row: usize) -> &[f64] {
        let n = self.reading_names.len();
        &self.readings[row * n..(row + 1) * n]
    }

    /// The readings of all rows, one after the other.
    #[must_use]
    pub fn all_readings(&self) -> &[f64] {
        &self.readings
    }

    /// Changes the readings of the rows before one.
    pub fn change_readings(&mut self, before: u32, change: impl FnMut(&mut [f64])) {
        let width = self.reading_names.len().max(1);
        self.readings.chunks_exact_mut(width).take(before as usize).for_each(change);
    }

    /// Configurations of instruments while their targets were measured in others, readings one after the other.
    #[must_use]
    pub fn further_readings(&self) -> &[f64] {
        &self.further_readings
    }

    /// Adds a configuration of an instrument, and returns its index for [`Observation::from`].
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if the number of readings is wrong, or a number is not finite.
    pub fn push_further(&mut self, readings: &[f64]) -> Result<u32> {
        self.check_readings(readings)?;
        let index = self.further_readings.len() / self.reading_names.len().max(1);
        self.further_readings.extend_from_slice(readings);
        Ok(u32::try_from(index).unwrap_or(u32::MAX))
    }

    /// Changes each configuration of an instrument.
    pub fn change_further(&mut self, change: impl FnMut(&mut [f64])) {
        let width = self.reading_names.len().max(1);
        self.further_readings.chunks_exact_mut(width).for_each(change);
    }
}

fn is_finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

fn not_finite() -> Error {
    ErrorKind::Measurement.error("found a number that is not finite, expected finite joint readings and measurements")
}
