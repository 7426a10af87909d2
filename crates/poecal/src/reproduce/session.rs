//! What a device sees of the elbow: the measurements that a run fits, and the configurations that judge it.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::Seen;
use crate::error::Result;
use crate::estimate::{Chain, Estimate, Linkage, Packed};
use crate::lie::{Pose, rotation};
use crate::measurement::{Dataset, Measurement, Noise, PointMeasurement, PoseMeasurement, PoseResidual};
use crate::parameters::{Formulation, Parameter, TargetFrame, TargetPlace};
use crate::robot::Robot;
use crate::simulate::{random, random_configuration};

/// Configurations that a fit never saw.
const UNSEEN: usize = 100;

/// Random configurations of a robot within its limits, and the robot that is really there.
pub(super) struct Session {
    pub(super) nominal: Robot,
    pub(super) truth: Estimate,
    pub(super) seen: Seen,
    pub(super) readings: Vec<f64>,
    pub(super) packed: Packed,
    pub(super) unseen: Packed,
}

impl Session {
    pub(super) fn new(nominal: &Robot, truth: Estimate, seen: Seen, count: usize, seed: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut configurations = |count: usize| -> Vec<f64> {
            (0..count).flat_map(|_| random_configuration(nominal, &mut generator)).collect()
        };
        let readings = configurations(count);
        let width = nominal.joints.len();
        let packed = Packed::new(nominal, &readings, width);
        let unseen = Packed::new(nominal, &configurations(UNSEEN), width);
        Session { nominal: nominal.clone(), truth, seen, readings, packed, unseen }
    }

    /// All rows.
    pub(super) fn rows(&self) -> Vec<u32> {
        (0..self.packed.rows() as u32).collect()
    }

    /// What the device sees: exactly, or with noise drawn from a seed.
    pub(super) fn data(&self, residual: PoseResidual, noise: Option<(Noise, u64)>) -> Result<Dataset> {
        let linkage = Linkage::new(&self.truth);
        let mut chain = Chain::default();
        let mut data = Dataset::new(self.nominal.reading_names());
        let mut generator = ChaCha8Rng::seed_from_u64(noise.map_or(0, |(_, seed)| seed));
        let sigma = noise.map_or(Noise { position_m: 0.0, rotation_rad: 0.0 }, |(sigma, _)| sigma);
        for (row, readings) in self.readings.chunks_exact(self.nominal.joints.len()).enumerate() {
            chain.evaluate(&linkage, &self.packed, row, 0);
            let position =
                chain.target.translation + random::normal_vector(&mut generator) * sigma.position_m;
            let turn = rotation::exp(&(random::normal_vector(&mut generator) * sigma.rotation_rad));
            let measurement = match self.seen {
                Seen::Poses => Measurement::Pose(PoseMeasurement {
                    pose: Pose::new(turn * chain.target.rotation, position),
                }),
                Seen::Points => Measurement::Point(PointMeasurement { position }),
            };
            data.push(readings, None, measurement.with_residual(residual))?;
        }
        Ok(data)
    }

    /// The estimate that every run starts from: nominal screws and home pose, no offsets, device at the base.
    pub(super) fn start(&self) -> Estimate {
        Estimate::new(&self.nominal, vec![self.nominal.home], Pose::identity())
    }

    /// The unknowns of a formulation.
    pub(super) fn free(&self, formulation: Formulation) -> Vec<Parameter> {
        let mut free = formulation.joint_parameters(&self.truth.kinds);
        free.push(match self.seen {
            Seen::Poses => Parameter::TargetFrame(TargetFrame { target: 0 }),
            Seen::Points => Parameter::TargetPlace(TargetPlace { target: 0 }),
        });
        free
    }

    /// RMS distance from an estimate's predictions to the truth on configurations that were not measured, metres.
    pub(super) fn held_out_rms_m(&self, estimate: &Estimate) -> f64 {
        let (found, truth) = (Linkage::new(estimate), Linkage::new(&self.truth));
        let (mut at_found, mut at_truth) = (Chain::default(), Chain::default());
        let mut squares = 0.0;
        for row in 0..self.unseen.rows() {
            at_found.evaluate(&found, &self.unseen, row, 0);
            at_truth.evaluate(&truth, &self.unseen, row, 0);
            squares += (at_found.target.translation - at_truth.target.translation).norm_squared();
        }
        (squares / self.unseen.rows() as f64).sqrt()
    }
}
