//! All measurements of a calibration, with their configurations and targets.

use std::path::PathBuf;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{ByQuantity, KnownLength, Measurement, Noise, NoiseShape, PoseResidual, Quantity, Stated};
use crate::error::{Error, ErrorKind, Result};
use crate::lie::Freedom;
use crate::robot::Controller;

/// Set of a row: training or held out.
///
/// ```
/// # use poecal::{Kind, Set, Simulation, simulate::elbow};
/// let mut data = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::Pose)?.data;
/// for (row, observation) in data.observations.iter_mut().enumerate() {
///     observation.set = Some(if row < 30 { Set::Fit } else { Set::HeldOut });
/// }
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Set {
    /// Used to fit.
    Fit,
    /// Held out to judge the fit.
    HeldOut,
}

/// Where a row came from: index into [`Dataset::files`] and line (from 1; 0 if it has none).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Source {
    /// Index into [`Dataset::files`].
    pub file: u32,
    /// Line in that file, from 1.
    pub line: u32,
}

/// One row: a measurement of a target, with its noise, set and source.
///
/// ```
/// # use poecal::{Dataset, Measurement, PointMeasurement};
/// # use nalgebra::Vector3;
/// let mut data = Dataset::new(vec!["joint1".into()]);
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(0.1, 0.2, 0.3) });
/// data.push(&[0.1], Some("ball"), seen)?;
/// assert_eq!((data.observations[0].target, &data.targets[0]), (0, &Some("ball".to_owned())));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Index into [`Dataset::targets`].
    pub target: usize,
    /// Index into [`Dataset::stations`]; 0 where there is one device frame only.
    #[serde(default)]
    pub station: usize,
    /// The instrument's own configuration, if it differs from the target's: index into [`Dataset::further_readings`].
    #[serde(default)]
    pub from: Option<u32>,
    /// The measurement.
    pub measurement: Measurement,
    /// Standard deviations of each component, metres or radians, where the row states them.
    pub stated: Stated,
    /// Shape of the noise of its position, if it is not the same in all directions: index into [`Dataset::noise_shapes`].
    #[serde(default)]
    pub noise_shape: Option<u32>,
    /// Set of the row, if it states it.
    pub set: Option<Set>,
    /// File and line.
    pub source: Source,
}

impl Observation {
    /// A measurement of a target from the first station, in one configuration, without stated noise.
    #[must_use]
    pub fn new(target: usize, measurement: Measurement) -> Self {
        Observation {
            target,
            station: 0,
            from: None,
            measurement,
            stated: Stated::default(),
            noise_shape: None,
            set: None,
            source: Source::default(),
        }
    }

    /// The noise that the row states; `usual` for a standard deviation that it does not state.
    #[must_use]
    pub fn noise_or(&self, usual: Noise) -> Noise {
        ByQuantity::from_fn(|quantity| self.stated.get(quantity).unwrap_or(usual[quantity]))
    }
}

/// Measurements with the configurations they were taken in. Readings are stored flat, one after the other.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal::measurement::{Dataset, Measurement, PointMeasurement};
/// let mut data = Dataset::new(vec!["joint1".into(), "joint2".into()]);
/// let seen = Measurement::Point(PointMeasurement { position: Vector3::new(0.1, 0.2, 0.3) });
/// data.push(&[0.1, -0.4], None, seen)?;
/// assert_eq!((data.len(), data.readings(0)), (1, &[0.1, -0.4][..]));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dataset {
    reading_names: Vec<String>,
    readings: Vec<f64>,
    #[serde(default)]
    further_readings: Vec<f64>,
    /// How many of the readings, the last ones, are of no joint.
    #[serde(default)]
    factors: usize,
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
    /// How the readings are made of those that the controller counts, where they are not one by one.
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

    /// The same with so many of the readings, the last ones, of no joint: they make no other configuration.
    #[must_use]
    pub fn with_factors(self, count: usize) -> Self {
        Dataset { factors: count, ..self }
    }

    /// The readings of a row that are of joints: what makes a configuration.
    pub(super) fn of_joints(&self, row: u32) -> &[f64] {
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
        if !observation.measurement.observe().is_finite() {
            return Err(not_finite());
        }
        self.readings.extend_from_slice(readings);
        self.observations.push(observation);
        Ok(())
    }

    fn check_readings(&self, readings: &[f64]) -> Result<()> {
        if readings.len() != self.reading_names.len() {
            return Err(Error::new(
                ErrorKind::Measurement,
                format!(
                    "found {} joint readings, expected {}: {}",
                    readings.len(),
                    self.reading_names.len(),
                    self.reading_names.join(", ")
                ),
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
        let further =
            u32::try_from(self.further_readings.len() / self.reading_names.len().max(1)).unwrap_or(u32::MAX);
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
            && self.observations.iter().all(|row| (row.source.file as usize) < files);
        if fits {
            return Ok(());
        }
        let message = "found readings, rows and targets of a data set that do not fit together, expected a reading of each joint and a \
                       target in every row";
        Err(Error::new(ErrorKind::Measurement, message))
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

    /// Index of a target, added if it is new.
    pub fn target_index(&mut self, name: Option<&str>) -> usize {
        if let Some(index) = self.targets.iter().position(|target| target.as_deref() == name) {
            return index;
        }
        self.targets.push(name.map(str::to_owned));
        self.targets.len() - 1
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

    /// What a station is: a socket, a plane and so on, if all its rows say so; a pair, if each of its rows is of two configurations; else an
    /// instrument.
    #[must_use]
    pub fn station_word(&self, station: usize) -> &'static str {
        let own = self.observations.iter().filter(|it| it.station == station);
        let word = |it: &Observation| match it.from {
            Some(_) => "pair",
            None => it.measurement.observe().device_word(),
        };
        let mut words = own.map(word);
        let first = words.next().unwrap_or("instrument");
        match words.all(|word| word == first) {
            true if self.sphere_reading(station).is_some() => "sphere",
            true => first,
            false => "instrument",
        }
    }

    /// The one distance that all rows of a station have, if it has several rows and they are distances alone: its targets are on a sphere.
    #[must_use]
    pub(crate) fn sphere_reading(&self, station: usize) -> Option<f64> {
        let own = self.observations.iter().filter(|it| it.station == station);
        let mut readings =
            own.map(|it| if it.from.is_some() { None } else { it.measurement.observe().range() });
        let first = readings.next().flatten()?;
        let mut others = readings.peekable();
        (others.peek().is_some() && others.all(|it| it == Some(first))).then_some(first)
    }

    /// Name of a station in messages.
    #[must_use]
    pub fn station_words(&self, station: usize) -> String {
        let word = self.station_word(station);
        match self.stations.get(station).and_then(Option::as_deref) {
            Some(name) => format!("{word} `{name}`"),
            None => format!("the {word} without a name"),
        }
    }

    /// Those of some rows that were measured from one station, in their order.
    #[must_use]
    pub fn seen_from(&self, station: usize, rows: &[u32]) -> Vec<u32> {
        if station == 0 && self.station_count() == 1 {
            return rows.to_vec();
        }
        rows.iter().copied().filter(|&row| self.observations[row as usize].station == station).collect()
    }

    /// The first station of some rows, whose frame stays where the base frame is a choice.
    #[must_use]
    pub(crate) fn first_station(&self, rows: &[u32]) -> usize {
        if self.station_count() == 1 {
            return 0;
        }
        rows.iter().map(|&row| self.observations[row as usize].station).min().unwrap_or_default()
    }

    /// The same rows as if all had been measured from one station.
    #[must_use]
    pub(crate) fn without_stations(&self) -> Self {
        let mut data = self.clone();
        data.stations.clear();
        data.lengths.clear();
        data.observations.iter_mut().for_each(|row| row.station = 0);
        data
    }

    /// Writes the errors of measured frames in this way; without measured frames nothing changes.
    pub fn write_poses_by(&mut self, pose_residual: Option<&'static dyn PoseResidual>) {
        let has_frames = self.observations.iter().any(|row| row.measurement.sees_orientation());
        self.pose_residual = pose_residual.filter(|_| has_frames);
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.observations.len()
    }

    /// Whether there is no row.
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
    pub(crate) fn change_readings(&mut self, before: u32, change: impl FnMut(&mut [f64])) {
        let width = self.reading_names.len().max(1);
        self.readings.chunks_exact_mut(width).take(before as usize).for_each(change);
    }

    /// Whether some row measured this target's orientation.
    #[must_use]
    pub fn target_is_frame(&self, target: usize) -> bool {
        self.observations.iter().any(|row| row.target == target && row.measurement.sees_orientation())
    }

    /// For each target, whether some of these rows measured its orientation.
    #[must_use]
    pub fn frames(&self, rows: &[u32]) -> Vec<bool> {
        let mut frames = vec![false; self.targets.len()];
        let mut points = frames.len();
        for &row in rows {
            let observation = &self.observations[row as usize];
            if !frames[observation.target] && observation.measurement.sees_orientation() {
                frames[observation.target] = true;
                points -= 1;
                if points == 0 {
                    break;
                }
            }
        }
        frames
    }

    /// What some of these rows show of a station; of no rows, its frame.
    #[must_use]
    pub fn device_freedom(&self, station: usize, rows: &[u32]) -> Freedom {
        let own = rows.iter().map(|&row| &self.observations[row as usize]).filter(|it| it.station == station);
        own.map(|it| it.measurement.observe().device_freedom())
            .reduce(Freedom::with)
            .unwrap_or(Freedom::FRAME)
    }

    /// Whether some of these rows are readings of a station whose zero is unknown.
    #[must_use]
    pub fn zero_is_unknown(&self, station: usize, rows: &[u32]) -> bool {
        // Nothing else has one: very many rows are asked, and a call for each would take as long as the row itself in a fit.
        let is_distance = |it: &&Observation| matches!(it.measurement, Measurement::Distance(_));
        let mut own = rows.iter().map(|&row| &self.observations[row as usize]).filter(is_distance);
        own.any(|it| it.station == station && it.measurement.observe().zero_is_unknown())
    }

    /// Whether a station's rows are all distances, so that it has a zero and a scale.
    #[must_use]
    pub fn is_ranging(&self, station: usize) -> bool {
        let mut own = self.observations.iter().filter(|it| it.station == station);
        own.all(|it| it.measurement.observe().range().is_some())
    }

    /// What some of these rows show of each target; of one that none sees, its place.
    #[must_use]
    pub fn target_freedoms(&self, rows: &[u32]) -> Vec<Freedom> {
        let mut found: Vec<Option<Freedom>> = vec![None; self.targets.len()];
        let mut partly = found.len();
        for &row in rows {
            let observation = &self.observations[row as usize];
            let known = &mut found[observation.target];
            if *known == Some(Freedom::FRAME) {
                continue;
            }
            let own = observation.measurement.target_freedom();
            let both = known.map_or(own, |known| known.with(own));
            *known = Some(both);
            if both == Freedom::FRAME {
                partly -= 1;
                if partly == 0 {
                    break;
                }
            }
        }
        found.into_iter().map(|it| it.unwrap_or(Freedom::PLACE)).collect()
    }

    /// Number of rotations of targets that some of these rows show.
    #[must_use]
    pub fn turns_of_targets(&self, rows: &[u32]) -> usize {
        let turns = |freedom: Freedom| freedom.motions().iter().filter(|&&motion| motion >= 3).count();
        self.target_freedoms(rows).into_iter().map(turns).sum()
    }

    /// Mean of the positions that some rows measured, metres, device frame; of each component over the rows that have it.
    #[must_use]
    pub fn mean_position(&self, rows: &[u32]) -> Vector3<f64> {
        let (mut sum, mut count) = (Vector3::zeros(), [0u32; 3]);
        for components in self.positions(rows) {
            for (k, value) in components.into_iter().enumerate() {
                sum[k] += value.unwrap_or_default();
                count[k] += u32::from(value.is_some());
            }
        }
        sum.component_div(&Vector3::from(count.map(|count| f64::from(count.max(1)))))
    }

    /// Root mean square distance of the positions that some rows measured from their mean, metres.
    #[must_use]
    pub fn spread_m(&self, rows: &[u32]) -> f64 {
        let mean = self.mean_position(rows);
        let square = |components: [Option<f64>; 3]| -> f64 {
            let parts = components.iter().zip(mean.iter());
            parts.filter_map(|(value, mean)| Some(((*value)? - mean).powi(2))).sum()
        };
        let (sum, count) =
            self.positions(rows).map(square).fold((0.0, 0), |(sum, count), it| (sum + it, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }

    fn positions(&self, rows: &[u32]) -> impl Iterator<Item = [Option<f64>; 3]> {
        let of = |row: u32| self.observations[row as usize].measurement.observe().position_components();
        rows.iter().map(move |&row| of(row)).filter(|components| components.iter().any(Option::is_some))
    }

    /// Whether some row measured a quantity.
    #[must_use]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.observations.iter().any(|row| row.measurement.has(quantity))
    }

    /// Configurations in which instruments stood while their targets were seen in others, readings one after the other.
    #[must_use]
    pub fn further_readings(&self) -> &[f64] {
        &self.further_readings
    }

    /// Adds a configuration in which an instrument stood, and returns its index for [`Observation::from`].
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if the number of readings is wrong, or a number is not finite.
    pub fn push_further(&mut self, readings: &[f64]) -> Result<u32> {
        self.check_readings(readings)?;
        let index = self.further_readings.len() / self.reading_names.len().max(1);
        self.further_readings.extend_from_slice(readings);
        Ok(u32::try_from(index).unwrap_or(u32::MAX))
    }

    /// Changes each configuration in which an instrument stood.
    pub(crate) fn change_further(&mut self, change: impl FnMut(&mut [f64])) {
        let width = self.reading_names.len().max(1);
        self.further_readings.chunks_exact_mut(width).for_each(change);
    }

    /// Some of the rows, in this order.
    #[must_use]
    pub(crate) fn only(&self, rows: &[u32]) -> Dataset {
        let mut found = Dataset {
            readings: Vec::with_capacity(rows.len() * self.reading_names.len()),
            observations: Vec::with_capacity(rows.len()),
            ids: Vec::new(),
            reading_names: self.reading_names.clone(),
            further_readings: self.further_readings.clone(),
            noise_shapes: self.noise_shapes.clone(),
            factors: self.factors,
            targets: self.targets.clone(),
            stations: self.stations.clone(),
            lengths: self.lengths.clone(),
            files: self.files.clone(),
            controller: self.controller.clone(),
            pose_residual: self.pose_residual,
        };
        for row in rows.iter().map(|&row| row as usize) {
            found.readings.extend_from_slice(self.readings(row));
            found.observations.extend(self.observations.get(row).copied());
            found.ids.extend(self.ids.get(row).cloned());
        }
        found
    }

    /// Marks every row as one to fit, and adds the rows of another data set as held out.
    ///
    /// # Errors
    /// As [`Dataset::extend`].
    pub fn judged_by(&mut self, other: &Dataset) -> Result<()> {
        let known = self.len();
        self.extend(other)?;
        for (row, observation) in self.observations.iter_mut().enumerate() {
            observation.set = Some(if row < known { Set::Fit } else { Set::HeldOut });
        }
        Ok(())
    }

    /// The rows of another data set after these; readings are matched by name.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if the other set lacks one of these readings.
    pub fn extend(&mut self, other: &Dataset) -> Result<()> {
        let order: Vec<usize> = self
            .reading_names
            .iter()
            .map(|name| {
                other.reading_names.iter().position(|candidate| candidate == name).ok_or_else(|| {
                    Error::new(
                        ErrorKind::Measurement,
                        format!("found no reading of joint `{name}`, expected one in every file"),
                    )
                })
            })
            .collect::<Result<_>>()?;
        if self.controller.is_none() {
            self.controller.clone_from(&other.controller);
        }
        let first_file = u32::try_from(self.files.len()).unwrap_or(u32::MAX);
        let first_further = self.further_readings.len() / self.reading_names.len().max(1);
        let first_further = u32::try_from(first_further).unwrap_or(u32::MAX);
        for readings in other.further_readings.chunks_exact(other.reading_names.len().max(1)) {
            self.further_readings.extend(order.iter().map(|&index| readings[index]));
        }
        let first_shape = u32::try_from(self.noise_shapes.len()).unwrap_or(u32::MAX);
        self.noise_shapes.extend_from_slice(&other.noise_shapes);
        self.files.extend(other.files.iter().cloned());
        let mut readings = Vec::with_capacity(order.len());
        // Looked up once for each target: there may be very many rows.
        let mut targets: Vec<Option<usize>> = vec![None; other.targets.len()];
        let stations: Vec<usize> = match (self.stations.as_slice(), other.stations.as_slice()) {
            ([], []) => Vec::new(),
            (_, []) => vec![self.station_index(None)],
            (_, named) => named.iter().map(|name| self.station_index(name.as_deref())).collect(),
        };
        let station = |at: usize| stations.get(at).copied().unwrap_or_default();
        let lengths =
            other.lengths.iter().map(|it| KnownLength { stations: it.stations.map(station), ..*it });
        for length in lengths {
            if !self.lengths.contains(&length) {
                self.lengths.push(length);
            }
        }
        for row in 0..other.len() {
            readings.clear();
            readings.extend(order.iter().map(|&index| other.readings(row)[index]));
            let mut observation = other.observations[row];
            observation.from = observation.from.map(|from| from + first_further);
            observation.noise_shape = observation.noise_shape.map(|shape| shape + first_shape);
            let target = observation.target;
            let known = targets[target];
            observation.target = known.unwrap_or_else(|| self.target_index(other.targets[target].as_deref()));
            targets[target] = Some(observation.target);
            observation.station = stations.get(observation.station).copied().unwrap_or_default();
            observation.source.file += first_file;
            self.push_observation(&readings, observation)?;
        }
        if !self.ids.is_empty() || !other.ids.is_empty() {
            let known = self.len() - other.len();
            self.ids.resize(known, String::new());
            self.ids.extend(other.ids.iter().cloned());
            self.ids.resize(self.len(), String::new());
        }
        Ok(())
    }
}

fn is_finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

fn not_finite() -> Error {
    Error::new(
        ErrorKind::Measurement,
        "found a number that is not finite, expected finite joint readings and measurements",
    )
}
