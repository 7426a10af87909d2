//! Errors of the nominal model in the configurations of programs, and the gain of the delivered model over it.

use nalgebra::{DMatrix, DVector, Vector3};

use super::domain::Domain;
use poecal_fit::state::{Linkage, PackedValues, RowChain};
use poecal_fit::uncertainty::Uncertainty;
use poecal_model::measurement::Quantity;
use poecal_numerics::linalg;

/// 97.5 % quantile of the normal distribution.
const NORMAL_95: f64 = 1.959_964;
/// Damping of the fit of targets and device, as a share of the largest diagonal element.
const DAMPING: f64 = 1e-9;

/// Errors of the nominal model inside the sampled range, with its targets and device positions fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalError {
    /// Root mean square distance of its predictions from those of the delivered model, metres.
    pub apart_m: f64,
    /// The gain, square metres: the mean square error of the nominal model less that of the delivered one.
    pub gain_m2: f64,
    /// Standard deviation of the gain.
    pub sigma_gain_m2: f64,
}

impl NominalError {
    /// The ends of the gain's 95 % interval, square metres: theory.md §9 (40b).
    #[must_use]
    pub fn gain_interval_m2(&self) -> [f64; 2] {
        let half = NORMAL_95 * self.sigma_gain_m2;
        [self.gain_m2 - half, self.gain_m2 + half]
    }

    /// Error over rows of joint values of the session's robot, for the first targets; the delivered model's expected error there is `expected_m`
    /// (RMS).
    pub(crate) fn new(
        domain: &Domain<'_>,
        (uncertainty, expected_m): (&Uncertainty, f64),
        (values, targets): (&[f64], usize),
    ) -> Self {
        let both = domain.pack_values(values);
        let rows = both[0].rows();
        let apart = domain.position_differences(uncertainty, &both, targets);
        let mut gradient = vec![0.0; uncertainty.layout.dim()];
        for (target, apart) in apart.chunks(rows.max(1)).enumerate() {
            let own = uncertainty.derivatives_along(&both[0], target, apart);
            gradient.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        let count = apart.len().max(1) as f64;
        gradient.iter_mut().for_each(|it| *it *= 2.0 / count);
        let apart_m2 = apart.iter().map(Vector3::norm_squared).sum::<f64>() / count;
        // Both models share the errors that neither describes; the rest of the expected error is due to the fit.
        let beyond_m2 = 3.0 * uncertainty.discrepancy.standard_deviation[Quantity::Position].powi(2);
        let fit_m2 = (expected_m.powi(2) - beyond_m2).max(0.0);
        NominalError {
            apart_m: apart_m2.sqrt(),
            gain_m2: apart_m2 - fit_m2,
            sigma_gain_m2: uncertainty.variance(&gradient).sqrt(),
        }
    }
}

impl Domain<'_> {
    /// Joint values of the session's robot, and those of the nominal one, which has no joints for compliant links.
    fn pack_values(&self, values: &[f64]) -> [PackedValues; 2] {
        let (robot, nominal) = (self.session.robot, self.nominal.0);
        let own = |name: &str| robot.joints.iter().position(|joint| joint.name == name);
        let columns: Vec<usize> = nominal.joints.iter().filter_map(|joint| own(&joint.name)).collect();
        let rows = values.chunks_exact(robot.joints.len().max(1));
        let of_nominal: Vec<f64> = rows.flat_map(|row| columns.iter().map(|&column| row[column])).collect();
        [PackedValues::of_values(robot, values), PackedValues::of_values(nominal, &of_nominal)]
    }

    /// Differences of the predicted positions of each target, row by row, from those of the nominal model with its targets and device fitted to them,
    /// if these are unknown: linear least squares over the rows.
    fn position_differences(
        &self,
        uncertainty: &Uncertainty,
        both: &[PackedValues; 2],
        targets: usize,
    ) -> Vec<Vector3<f64>> {
        let session = self.session;
        let linkages = [&uncertainty.estimate, self.nominal.1].map(Linkage::new);
        let frame = if session.device_free { 6 } else { 0 };
        let moved: Vec<usize> = (0..targets).filter(|target| session.unknowns.moves_target(*target)).collect();
        let (rows, width) = (both[0].rows(), frame + 3 * moved.len());
        let mut apart = DVector::zeros(3 * rows * targets);
        let mut columns = DMatrix::zeros(apart.len(), width);
        let mut chain = RowChain::default();
        for (at, (target, row)) in (0..targets).flat_map(|target| (0..rows).map(move |row| (target, row))).enumerate() {
            let [found, nominal] = [0, 1].map(|which| {
                chain.evaluate(&linkages[which], &both[which], row, target);
                chain.target
            });
            apart.fixed_rows_mut::<3>(3 * at).copy_from(&(found.translation - nominal.translation));
            if frame > 0 {
                for axis in 0..3 {
                    let unit = Vector3::ith(axis, 1.0);
                    let turned = unit.cross(&nominal.translation) / session.length_m;
                    columns.fixed_view_mut::<3, 1>(3 * at, axis).copy_from(&unit);
                    columns.fixed_view_mut::<3, 1>(3 * at, 3 + axis).copy_from(&turned);
                }
            }
            if let Some(own) = moved.iter().position(|it| *it == target) {
                columns.fixed_view_mut::<3, 3>(3 * at, frame + 3 * own).copy_from(&nominal.rotation);
            }
        }
        let mut normal = columns.tr_mul(&columns);
        let damping = DAMPING * normal.diagonal().max();
        (0..width).for_each(|k| normal[(k, k)] += damping);
        if let Some(step) = linalg::solve_symmetric(normal, &columns.tr_mul(&apart)) {
            apart -= columns * step;
        }
        apart.as_slice().chunks_exact(3).map(Vector3::from_column_slice).collect()
    }
}
