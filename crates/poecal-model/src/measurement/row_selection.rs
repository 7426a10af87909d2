//! Some of the rows of a session, and the rows of several.

use super::{Dataset, KnownLength, MovingRows, Set};
use poecal_numerics::error::{ErrorKind, Result};

impl Dataset {
    /// The same rows as if all had been measured from one station.
    #[must_use]
    pub fn without_stations(&self) -> Self {
        let mut data = self.clone();
        data.stations.clear();
        data.lengths.clear();
        data.observations.iter_mut().for_each(|row| row.station = 0);
        data
    }

    /// Some of the rows, in this order.
    #[must_use]
    pub fn select_rows(&self, rows: &[u32]) -> Dataset {
        let mut found = Dataset {
            readings: Vec::with_capacity(rows.len() * self.reading_names.len()),
            observations: Vec::with_capacity(rows.len()),
            ids: Vec::new(),
            reading_names: self.reading_names.clone(),
            further_readings: self.further_readings.clone(),
            noise_shapes: self.noise_shapes.clone(),
            moving: self.moving.clone(),
            pictures: self.pictures.select_rows(rows),
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
        let place = |name: &String| {
            let found = other.reading_names.iter().position(|candidate| candidate == name);
            let message = || format!("found no reading of joint `{name}`, expected one in every file");
            found.ok_or_else(|| ErrorKind::Measurement.error(message()))
        };
        let order: Vec<usize> = self.reading_names.iter().map(place).collect::<Result<_>>()?;
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
        let first_moving = u32::try_from(self.moving.times_s.len()).unwrap_or(u32::MAX);
        self.files.extend(other.files.iter().cloned());
        self.pictures.extend(&other.pictures, u32::try_from(self.len()).unwrap_or(u32::MAX));
        let mut readings = Vec::with_capacity(order.len());
        // Looked up once for each target: there may be very many rows.
        let mut targets: Vec<Option<usize>> = vec![None; other.targets.len()];
        let stations: Vec<usize> = match (self.stations.as_slice(), other.stations.as_slice()) {
            ([], []) => Vec::new(),
            (_, []) => vec![self.station_index(None)],
            (_, named) => named.iter().map(|name| self.station_index(name.as_deref())).collect(),
        };
        let station = |at: usize| stations.get(at).copied().unwrap_or_default();
        let width = other.reading_names.len().max(1);
        let in_order = other.moving.rates.chunks_exact(width).flat_map(|of| order.iter().map(|&index| of[index]));
        let moving = MovingRows { rates: in_order.collect(), ..other.moving.clone() };
        self.moving.extend(&moving, station);
        let lengths = other.lengths.iter().map(|it| KnownLength { stations: it.stations.map(station), ..*it });
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
            observation.moving = observation.moving.map(|moving| moving + first_moving);
            let target = observation.target;
            let known = targets[target];
            observation.target = known.unwrap_or_else(|| self.target_index(other.targets[target].as_deref()));
            targets[target] = Some(observation.target);
            observation.station = stations.get(observation.station).copied().unwrap_or_default();
            observation.source.file += first_file;
            self.push_observation(&readings, observation)?;
        }
        self.extend_ids(other);
        Ok(())
    }

    /// Adds the ids of new rows, and empty ones for earlier rows without ids.
    fn extend_ids(&mut self, other: &Dataset) {
        if !self.ids.is_empty() || !other.ids.is_empty() {
            let known = self.len() - other.len();
            self.ids.resize(known, String::new());
            self.ids.extend(other.ids.iter().cloned());
            self.ids.resize(self.len(), String::new());
        }
    }
}
