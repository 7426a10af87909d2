//! Motions of devices and targets that the rows of a session determine.

use nalgebra::Vector3;

use super::{Dataset, Device, Observation, Quantity};
use poecal_arm::lie::Freedom;

impl Dataset {
    /// Word of a station: a socket, a plane and so on, if all its rows agree; a pair, if each of its rows is of two configurations; else an
    /// instrument.
    #[must_use]
    pub fn station_word(&self, station: usize) -> &'static str {
        let own = self.observations.iter().filter(|it| it.station == station);
        let device = |it: &Observation| if it.from.is_some() { Device::Pair } else { it.measurement.device() };
        let mut devices = own.map(device);
        let first = devices.next().unwrap_or(Device::Instrument);
        let found = match devices.all(|device| device == first) {
            true if self.sphere_reading(station).is_some() => Device::Sphere,
            true => first,
            false => Device::Instrument,
        };
        found.word()
    }

    /// Common distance of all rows of a station, if it has several rows and they are distances alone: its targets are on a sphere.
    #[must_use]
    pub fn sphere_reading(&self, station: usize) -> Option<f64> {
        let own = self.observations.iter().filter(|it| it.station == station);
        let mut readings = own.map(|it| if it.from.is_some() { None } else { it.measurement.range() });
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

    /// True if some row measured this target's orientation.
    #[must_use]
    pub fn target_is_frame(&self, target: usize) -> bool {
        self.observations.iter().any(|row| row.target == target && row.measurement.sees_orientation())
    }

    /// For each target, true if some of these rows measured its orientation.
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

    /// Motions of a station that some of these rows determine; without rows, its frame.
    #[must_use]
    pub fn device_freedom(&self, station: usize, rows: &[u32]) -> Freedom {
        let own = rows.iter().map(|&row| &self.observations[row as usize]).filter(|it| it.station == station);
        own.map(|it| it.measurement.device_freedom()).reduce(Freedom::union).unwrap_or(Freedom::FRAME)
    }

    /// True if some of these rows are readings of a station whose zero is unknown.
    #[must_use]
    pub fn zero_is_unknown(&self, station: usize, rows: &[u32]) -> bool {
        let mut own = rows.iter().map(|&row| &self.observations[row as usize]).filter(|it| it.station == station);
        own.any(|it| it.measurement.function().zero_is_unknown)
    }

    /// True if a station's rows are all distances, so that it has a zero and a scale.
    #[must_use]
    pub fn is_ranging(&self, station: usize) -> bool {
        let mut own = self.observations.iter().filter(|it| it.station == station);
        own.all(|it| it.measurement.range().is_some())
    }

    /// Motions of each target that some of these rows determine; for a target without rows, its position.
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
            let both = known.map_or(own, |known| known.union(own));
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

    /// Number of rotations of targets that some of these rows determine.
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
        let (sum, count) = self.positions(rows).map(square).fold((0.0, 0), |(sum, count), it| (sum + it, count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }

    fn positions(&self, rows: &[u32]) -> impl Iterator<Item = [Option<f64>; 3]> {
        let of = |row: u32| self.observations[row as usize].measurement.position_components();
        rows.iter().map(move |&row| of(row)).filter(|components| components.iter().any(Option::is_some))
    }

    /// True if some row measured a quantity.
    #[must_use]
    pub fn has(&self, quantity: Quantity) -> bool {
        self.observations.iter().any(|row| row.measurement.has(quantity))
    }
}
