//! Whether the errors of a calibration on other measurements are those that it promised.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use crate::analysis::{JointCoverage, inside};
use crate::estimate::{Packed, RowError};
use crate::measurement::{Dataset, Noise};
use crate::robot::Robot;
use crate::uncertainty::{Quantile, Uncertainty};

/// What a calibration promises of its predictions.
///
/// ```no_run
/// use poecal::calibration::Promise;
/// use poecal::io::calibration_file::CalibrationFile;
/// let file = CalibrationFile::read("calibration.json")?;
/// let (uncertainty, targets) = file.uncertainty(&[None])?;
/// let promise = Promise { uncertainty: &uncertainty, targets: &targets, coverage: &file.coverage };
/// assert_eq!(promise.targets.len(), 1);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Promise<'a> {
    /// Covariance of the unknowns and what the model does not describe.
    pub uncertainty: &'a Uncertainty,
    /// For each target of the judging measurements, which of the uncertainty's targets it is.
    pub targets: &'a [usize],
    /// What of each joint's range was sampled.
    pub coverage: &'a [JointCoverage],
}

/// How errors compare with what was promised (theory.md §9 (40)).
///
/// ```
/// use poecal::calibration::{Kept, KeptPart};
/// let position = KeptPart { expected_rms: 0.67, inside_bound95: 0.97 };
/// let kept = Kept { position_mm: position, rotation_deg: None, inside_sampled_range: 1.0 };
/// assert!(kept.least_inside() > 0.95);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    /// Of positions, millimetres.
    pub position_mm: KeptPart,
    /// Of rotations, degrees, if orientation was measured and the calibration knows it.
    pub rotation_deg: Option<KeptPart>,
    /// Share of the configurations with every joint inside the range that was sampled.
    pub inside_sampled_range: f64,
}

/// How errors of one sort compare with what was promised.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct KeptPart {
    /// Expected root mean square error between measured and predicted, noise of measuring included.
    pub expected_rms: f64,
    /// Share of the errors within their own 95 % bound.
    pub inside_bound95: f64,
}

impl Kept {
    /// The smaller share of errors within their bounds, of positions and rotations.
    #[must_use]
    pub fn least_inside(&self) -> f64 {
        let rotation = self.rotation_deg.map_or(1.0, |part| part.inside_bound95);
        self.position_mm.inside_bound95.min(rotation)
    }
}

/// Sums of one sort of errors.
#[derive(Default)]
struct Sums {
    squares: f64,
    within: usize,
    count: usize,
}

impl Sums {
    fn add(&mut self, promised: &Matrix3<f64>, quantile: &Quantile, error: &Vector3<f64>) {
        self.squares += promised.trace();
        self.within += usize::from(error.norm() <= quantile.bound(promised));
        self.count += 1;
    }

    fn part(&self, unit: f64) -> Option<KeptPart> {
        let count = self.count as f64;
        (self.count > 0).then(|| KeptPart {
            expected_rms: unit * (self.squares / count).sqrt(),
            inside_bound95: self.within as f64 / count,
        })
    }
}

impl Promise<'_> {
    /// Compares the errors of all rows of some measurements.
    #[must_use]
    pub fn kept(&self, robot: &Robot, data: &Dataset, packed: &Packed, errors: &[RowError]) -> Kept {
        self.kept_in(robot, data, packed, &data.all_rows(), errors)
    }

    /// Compares the errors of some rows.
    #[must_use]
    pub fn kept_in(
        &self,
        robot: &Robot,
        data: &Dataset,
        packed: &Packed,
        rows: &[u32],
        errors: &[RowError],
    ) -> Kept {
        let target = |row: &u32| data.observations[*row as usize].target;
        let places = rows
            .iter()
            .map(|row| (*row as usize, self.targets.get(target(row)).copied().unwrap_or_default()));
        let promised = self.uncertainty.predictions_of(places, packed);
        // What is the robot's holds the noise already, unless that was told from it.
        let Noise { position_m, rotation_rad } = self.uncertainty.discrepancy.noise;
        let (mut position, mut rotation) = (Sums::default(), Sums::default());
        let observations = rows.iter().map(|&row| &data.observations[row as usize]);
        for ((promised, error), observation) in promised.into_iter().zip(errors).zip(observations) {
            let own = |sigma: Option<f64>, usual: f64| Matrix3::identity() * sigma.unwrap_or(usual).powi(2);
            position.add(
                &(promised.position + own(observation.sigma_position_m, position_m)),
                &promised.quantiles[0],
                &error.position_m,
            );
            if let Some(turn) = error.rotation_rad {
                rotation.add(
                    &(promised.rotation + own(observation.sigma_rotation_rad, rotation_rad)),
                    &promised.quantiles[1],
                    &turn,
                );
            }
        }
        let is_inside = |row: &&u32| inside(robot, self.coverage, data.readings(**row as usize));
        let sampled = rows.iter().filter(is_inside).count();
        Kept {
            position_mm: position.part(1e3).unwrap_or(KeptPart { expected_rms: 0.0, inside_bound95: 1.0 }),
            rotation_deg: rotation.part(1f64.to_degrees()),
            inside_sampled_range: sampled as f64 / rows.len().max(1) as f64,
        }
    }
}
