//! Errors of an estimate's predictions, several rows side by side.

use super::side_by_side::SideBySide;
use super::{Estimate, Linkage, RowError, Session, Sight};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{ByQuantity, Dataset, FormulatedMeasurement, NUMBERS, Observation};
use poecal_numerics::kernels::WIDTH;
use poecal_numerics::threads;

/// Rows that one thread takes at a time.
const CHUNK: usize = 1024;

impl Session<'_> {
    /// Errors of an estimate, one for each row: measured minus predicted, metres and radians, in the axes of the row's own device frame
    /// (theory.md §4 (15), (16), not whitened).
    #[must_use]
    pub fn errors(&self, rows: &[u32], estimate: &Estimate) -> Vec<RowError> {
        self.map_errors(rows, estimate, |_, error, _| error)
    }

    /// Maps each row by `each`, from its observation and, for each quantity, the sum of squares (m², rad²) and the count of its residual's
    /// numbers. The noise of positions counts as the same in all directions. Residuals are those of theory.md §4 (15), (16), or of the data
    /// set's own formulation (16a).
    pub fn map_squares<T: Send>(
        &self,
        rows: &[u32],
        estimate: &Estimate,
        each: impl Fn(&Observation, ByQuantity<(f64, usize)>) -> T + Sync,
    ) -> Vec<T> {
        self.map_errors(rows, estimate, |observation, error, predicted| {
            let written = FormulatedMeasurement::new(&observation.measurement, self.data.pose_residual);
            let error = if written.is_usual() {
                error
            } else {
                let mut values = [0.0; NUMBERS];
                written.residual(&predicted(), &mut values);
                RowError::from_values(written.measurement, values)
            };
            each(observation, self.equalize_noise(observation, error).squares())
        })
    }

    /// An error of a row with noise of its position that is the same in all directions.
    pub fn equalize_noise(&self, observation: &Observation, error: RowError) -> RowError {
        self.data.noise_shape(observation).map_or(error, |shape| error.whiten(shape))
    }

    /// Maps each row by `each`, from its observation, its error in the device's axes (theory.md §4 (16), not whitened) and, on demand, the
    /// predicted `device_from_target` (theory.md §4 (13)).
    fn map_errors<T: Send>(
        &self,
        rows: &[u32],
        estimate: &Estimate,
        each: impl Fn(&Observation, RowError, &dyn Fn() -> Pose) -> T + Sync,
    ) -> Vec<T> {
        let linkage = Linkage::new(estimate);
        threads::concat_chunks(rows, CHUNK, |_, rows| {
            let routes = self.by_route(&linkage, rows);
            if let [(route, _)] = routes[..] {
                return self.map_route(&linkage, route, rows, &each);
            }
            let mut found: Vec<(usize, T)> = Vec::with_capacity(rows.len());
            for (route, places) in routes {
                let own: Vec<u32> = places.iter().map(|&place| rows[place]).collect();
                found.extend(places.into_iter().zip(self.map_route(&linkage, route, &own, &each)));
            }
            found.sort_unstable_by_key(|&(place, _)| place);
            found.into_iter().map(|(_, found)| found).collect()
        })
    }

    fn map_route<T>(
        &self,
        linkage: &Linkage,
        route: usize,
        rows: &[u32],
        each: impl Fn(&Observation, RowError, &dyn Fn() -> Pose) -> T,
    ) -> Vec<T> {
        let mut found = Vec::with_capacity(rows.len());
        let mut side_by_side = SideBySide::new(linkage, route);
        for rows in rows.chunks(WIDTH) {
            side_by_side.predict(self, rows);
            side_by_side.compare(self, rows);
            for (lane, &row) in rows.iter().enumerate() {
                let observation = self.observation(row);
                let predicted = || side_by_side.predicted_pose(lane, observation);
                found.push(each(observation, side_by_side.error(lane, observation), &predicted));
            }
        }
        found
    }

    /// Indices of the rows of each route among these; empty if all are of the only one.
    fn by_route(&self, linkage: &Linkage, rows: &[u32]) -> Vec<(usize, Vec<usize>)> {
        let routes = linkage.tree().routes().len();
        if routes == 1 {
            return vec![(0, Vec::new())];
        }
        let mut places = vec![Vec::new(); routes];
        for (place, &row) in rows.iter().enumerate() {
            places[linkage.tree().route_index(Sight::from(self.observation(row)))].push(place);
        }
        places.into_iter().enumerate().filter(|(_, places)| !places.is_empty()).collect()
    }
}

/// Rotates the errors of rows from the axes of their own station to those of the first: `e ← R_1 R_sᵀ e` with the rotations of the device
/// frames `X_s` of theory.md §4 (13).
pub fn turn_to_first(data: &Dataset, rows: &[u32], estimate: &Estimate, errors: &mut [RowError]) {
    if data.station_count() == 1 {
        return;
    }
    for (&row, error) in rows.iter().zip(errors) {
        let own = estimate.device(data.observations[row as usize].station).rotation;
        *error = error.rotate(&(estimate.device_from_base.rotation * own.transpose()));
    }
}
