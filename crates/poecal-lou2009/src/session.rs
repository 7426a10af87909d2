//! Measurements of the elbow by a device: those that a run fits, and the configurations that judge it.

use rand_chacha::ChaCha8Rng;
use rand_core::SeedableRng;

use super::MeasurementKind;
use crate::{PaperFormulation, PaperResidual};
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_fit::parameters::{Parameter, TargetFrame, TargetPlace};
use poecal_fit::state::{Estimate, Linkage, PackedValues, RowChain, Session};
use poecal_model::measurement::{Dataset, Measurement, Noise, Quantity};
use poecal_model::robot::Robot;
use poecal_model::simulate::{random, random_configuration};
use poecal_numerics::error::Result;

/// Configurations that a fit never saw.
const UNSEEN: usize = 60;

/// Random configurations of a robot within its limits, and the actual robot.
pub(super) struct PaperSession {
    pub(super) nominal: Robot,
    pub(super) truth: Estimate,
    pub(super) seen: MeasurementKind,
    pub(super) readings: Vec<f64>,
    pub(super) packed: PackedValues,
    pub(super) unseen: PackedValues,
    /// True positions of the tip in the unseen configurations.
    unseen_positions: Vec<Vector3<f64>>,
}

impl PaperSession {
    pub(super) fn new(nominal: &Robot, truth: Estimate, seen: MeasurementKind, count: usize, seed: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut configurations = |count: usize| -> Vec<f64> {
            (0..count).flat_map(|_| random_configuration(nominal, &mut generator)).collect()
        };
        let readings = configurations(count);
        let width = nominal.joints.len();
        let packed = PackedValues::new(nominal, &readings, width);
        let unseen = PackedValues::new(nominal, &configurations(UNSEEN), width);
        let unseen_positions = poses(&truth, &unseen).map(|pose| pose.translation).collect();
        PaperSession { nominal: nominal.clone(), truth, seen, readings, packed, unseen, unseen_positions }
    }

    /// All rows.
    pub(super) fn rows(&self) -> Vec<u32> {
        (0..self.packed.rows() as u32).collect()
    }

    /// The target's poses in the measured configurations.
    pub(super) fn exact_poses(&self) -> Vec<Pose> {
        poses(&self.truth, &self.packed).collect()
    }

    /// Poses with noise drawn from a seed.
    pub(super) fn noisy_poses(&self, sigma: Noise, seed: u64) -> Vec<Pose> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let measured = |pose: Pose| {
            let position = pose.translation + random::normal_vector(&mut generator) * sigma[Quantity::Position];
            let turn = rotation::exp(&(random::normal_vector(&mut generator) * sigma[Quantity::Rotation]));
            Pose::new(turn * pose.rotation, position)
        };
        poses(&self.truth, &self.packed).map(measured).collect()
    }

    /// Measurements of these poses by the device.
    pub(super) fn data(&self, residual: PaperResidual, measured: &[Pose]) -> Result<Dataset> {
        let mut data = Dataset::new(self.nominal.reading_names());
        for (readings, &pose) in self.readings.chunks_exact(self.nominal.joints.len()).zip(measured) {
            let measurement = match self.seen {
                MeasurementKind::Poses => Measurement::of_pose(&pose),
                MeasurementKind::Points => Measurement::point(pose.translation),
            };
            data.push(readings, None, measurement)?;
        }
        data.write_poses_by(residual.model());
        Ok(data)
    }

    /// The session of such data, with the metres per radian.
    pub(super) fn session_with_data<'a>(&'a self, data: &'a Dataset, length_m: f64) -> Session<'a> {
        Session::new(&self.nominal, data, &self.packed, false).with_length(length_m)
    }

    /// The start of every run: nominal screws and home pose, no offsets, device at the base.
    pub(super) fn start(&self) -> Estimate {
        Estimate::new(&self.nominal, vec![self.nominal.home], Pose::identity())
    }

    /// The unknowns of a formulation.
    pub(super) fn free_parameters(&self, formulation: PaperFormulation) -> Vec<Parameter> {
        let mut free = formulation.joint_parameters(self.truth.kinds());
        free.push(match self.seen {
            MeasurementKind::Poses => Parameter::TargetFrame(TargetFrame::new(0)),
            MeasurementKind::Points => Parameter::TargetPlace(TargetPlace { target: 0 }),
        });
        free
    }

    /// RMS distance from an estimate's predictions to the truth on configurations that were not measured, metres.
    pub(super) fn held_out_rms_m(&self, estimate: &Estimate) -> f64 {
        let pairs = poses(estimate, &self.unseen).zip(&self.unseen_positions);
        let squares: f64 = pairs.map(|(pose, position)| (pose.translation - position).norm_squared()).sum();
        (squares / self.unseen.rows() as f64).sqrt()
    }
}

/// An estimate's target in configurations.
fn poses(estimate: &Estimate, packed: &PackedValues) -> impl Iterator<Item = Pose> {
    let (linkage, mut chain) = (Linkage::new(estimate), RowChain::default());
    (0..packed.rows()).map(move |row| {
        chain.evaluate(&linkage, packed, row, 0);
        chain.target
    })
}
