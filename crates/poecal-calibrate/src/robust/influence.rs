//! Influence of each row on a finished calibration.

use std::borrow::Cow;
use std::sync::Arc;

use super::rows::component_scale;
use crate::run::{fit, formulate_data};
use crate::{Calibration, DeviceFrameKnowledge};
use poecal_fit::analysis::{Influence, influence};
use poecal_fit::parameters::{Parameter, screw_axes};
use poecal_fit::problem::Problem;
use poecal_fit::state::{PackedValues, Session};
use poecal_model::measurement::Dataset;
use poecal_numerics::solve::{LeastSquares, NormalEquations};

/// Leverage and studentised residual of these rows in a finished calibration (theory.md §6 (34d), (34e)).
#[must_use]
pub fn row_influence(calibration: &Calibration, data: &Dataset, rows: &[u32]) -> Vec<Influence> {
    if rows.is_empty() {
        return Vec::new();
    }
    RowInfluence::new(calibration, data).influence_of_rows(rows)
}

/// [`row_influence`] in parts.
pub struct RowInfluence<'a> {
    calibration: &'a Calibration,
    data: Cow<'a, Dataset>,
    packed: Arc<PackedValues>,
    weights: Vec<f64>,
    free: Vec<Parameter>,
    length_m: f64,
    /// Normal information of the fitted rows; `None` without rows.
    normal: Option<NormalEquations>,
}

impl<'a> RowInfluence<'a> {
    /// Prepares a finished calibration.
    pub fn new(calibration: &'a Calibration, data: &'a Dataset) -> Self {
        let packed = calibration.packed_values(data);
        let data = formulate_data(Cow::Borrowed(data), calibration.formulation.pose_residual);
        let weights = calibration.robustness.rows.iter().map(|row| row.weight).collect();
        let Calibration { fit_rows, models, .. } = calibration;
        let session = calibration.session(&data, &packed);
        let free = fit::free_parameters(&session, &models.calibrated, fit_rows, screw_axes(models.calibrated.kinds()));
        let length_m = session.length_m;
        let mut made = RowInfluence { calibration, data, packed, weights, free, length_m, normal: None };
        if !made.data.is_empty() {
            let problem = made.problem(&calibration.fit_rows).with_weights(&made.weights);
            made.normal = Some(problem.normal(&calibration.models.calibrated));
        }
        made
    }

    /// Session of the data.
    pub fn session(&self) -> Session<'_> {
        Session {
            robot: &self.calibration.nominal,
            data: &self.data,
            packed: &self.packed,
            length_m: self.length_m,
            device_free: self.calibration.frame == DeviceFrameKnowledge::Unknown,
            noise_ratios: &self.calibration.noise_ratios,
            unknowns: &self.calibration.unknowns,
        }
    }

    fn problem(&self, rows: &[u32]) -> Problem<'_> {
        Problem::new(self.session(), rows.to_vec(), self.free.clone(), self.calibration.noise)
    }

    /// Influence of these rows.
    pub fn influence_of_rows(&self, rows: &[u32]) -> Vec<Influence> {
        let (Some(normal), false) = (&self.normal, rows.is_empty()) else { return Vec::new() };
        let Calibration { fit_rows, models, robustness, .. } = self.calibration;
        let weight = |row: &u32| fit_rows.binary_search(row).map_or(0.0, |_| self.weights[*row as usize]);
        let counted: Vec<f64> = rows.iter().map(weight).collect();
        influence(&self.problem(rows), &models.calibrated, normal, rows, &counted, |row, component| {
            component_scale(&self.data, robustness.scale, row, component)
        })
    }
}
