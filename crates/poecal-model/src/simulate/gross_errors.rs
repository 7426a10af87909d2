//! Gross errors among measurements: rows that are plainly wrong.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::random;
use crate::measurement::{Dataset, Measurement};
use poecal_arm::lie::{Pose, rotation};

/// Gross errors of a share of the rows: each is moved in a random direction, and every second one with an orientation is also rotated.
/// Distances and angles are uniform between their two limits.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::simulate::{GrossErrors, SessionKind, elbow};
/// use poecal::Simulation;
/// let mut made = Simulation::default().run(&elbow(), SessionKind::POSE)?;
/// let rows = GrossErrors { share: 0.1, ..GrossErrors::default() }.spoil(&mut made.data);
/// assert_eq!(rows.len(), 5);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrossErrors {
    /// Share of the rows, 0 to 1.
    pub share: f64,
    /// Least and greatest distance, metres.
    pub distance_m: [f64; 2],
    /// Least and greatest angle, radians.
    pub angle_rad: [f64; 2],
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for GrossErrors {
    fn default() -> Self {
        let angle_rad = [1f64.to_radians(), 20f64.to_radians()];
        GrossErrors { share: 0.1, distance_m: [5e-3, 0.1], angle_rad, seed: 1 }
    }
}

impl GrossErrors {
    /// Adds the gross errors; returns the rows that have one, in their order.
    pub fn spoil(&self, data: &mut Dataset) -> Vec<u32> {
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        // Another stream than that of a session with the same seed.
        generator.set_stream(2);
        let mut rows: Vec<u32> = data.all_rows();
        random::shuffle(&mut generator, &mut rows);
        rows.truncate((self.share.clamp(0.0, 1.0) * data.len() as f64).round() as usize);
        for (count, &row) in rows.iter().enumerate() {
            let measurement = &mut data.observations[row as usize].measurement;
            *measurement = self.spoil_measurement(measurement, count % 2 == 0, &mut generator);
        }
        rows.sort_unstable();
        rows
    }

    fn spoil_measurement(&self, measurement: &Measurement, turned: bool, generator: &mut ChaCha8Rng) -> Measurement {
        let mut between = |[least, most]: [f64; 2]| -> Vector3<f64> {
            let direction = random::direction(generator);
            direction * (least + (most - least) * random::uniform_number(generator))
        };
        let (shift, turn) = (between(self.distance_m), between(self.angle_rad));
        let spoilt = measurement.map_pose(|pose| {
            let rotation = if turned { rotation::exp(&turn) * pose.rotation } else { pose.rotation };
            Pose::new(rotation, pose.translation + shift)
        });
        spoilt.unwrap_or(*measurement)
    }
}
