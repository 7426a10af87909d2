//! Common parts of the Monte Carlo benchmarks: noise, and measurements with it.

use poecal_arm::lie::{Pose, rotation};
use poecal_model::measurement::{Dataset, Measurement, Noise, Quantity};
use poecal_model::simulate::random;
use rand_chacha::ChaCha8Rng;

/// Noise of the workload: 0.05 mm and 0.0005 rad.
pub(crate) const NOISE: Noise = Noise::new(5e-5, 5e-4);

/// Measurements with further noise.
pub(crate) fn disturb_measurements(data: &Dataset, generator: &mut ChaCha8Rng) -> Vec<Measurement> {
    let mut disturb = |seen: &Measurement| {
        let shift = random::normal_vector(generator) * NOISE[Quantity::Position];
        let turn = random::normal_vector(generator) * NOISE[Quantity::Rotation];
        let seen = seen.pose();
        let pose = Pose::new(rotation::exp(&turn) * seen.rotation, seen.translation + shift);
        Measurement::of_pose(&pose)
    };
    data.observations.iter().map(|observation| disturb(&observation.measurement)).collect()
}
