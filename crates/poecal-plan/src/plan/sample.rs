//! Properties of a planned session that a sample of configurations determines: layout, prior, robot error and modes.

use nalgebra::DMatrix;

use super::experiment::{PlannedExperiment, SAMPLE, inverse};
use super::options::{PlannedFit, RobotError};
use poecal_calibrate::free_parameters;
use poecal_fit::analysis::predicted_data;
use poecal_fit::parameters::screw_axes;
use poecal_fit::problem::{Layout, MOST_UNKNOWNS, Prior, TermPrior};
use poecal_fit::state::{Estimate, PackedValues, Session, nominal_estimate};
use poecal_model::measurement::{ByQuantity, Dataset, Quantity};
use poecal_model::robot::{CorrectionModel, Tolerance};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;
use poecal_numerics::unit::Unit;

/// Largest number of stations from which one configuration is measured.
const MOST_PLACES: usize = 64;
/// Prior information on every unknown without another prior, including the base's position, 1/m²: a standard deviation of one metre.
const RIDGE: f64 = 1.0;
/// Least share of a combination's prior variance that all rows together must remove; below it the combination is left out.
const NEGLIGIBLE: f64 = 0.01;
/// Default robot error, as a share of the reach.
const USUAL_ERROR: f64 = 3e-4;
/// Least share of the squared robot error that no terms describe: 0.14 for an IRB 120, more for others.
const LEAST_REST: f64 = 0.16;
/// Least share of the robot error due to terms, if it is stated with and without them.
const LEAST_TERMS: f64 = 0.2;

/// Indices of the unknowns in a step: of geometry, and of terms with their scales and prior standard deviations.
struct StepIndices {
    geometry: Vec<usize>,
    terms: Vec<usize>,
    scales: Vec<f64>,
    priors: Vec<TermPrior>,
}

impl PlannedExperiment {
    /// Layout, prior, robot error and modes, from a sample of configurations.
    pub(crate) fn settle(
        &mut self,
        sample: &[f64],
        fit: &PlannedFit,
        (deviations, corrected): (&[f64], &CorrectionModel),
        begun: Option<(&Dataset, &Estimate)>,
    ) -> Result<()> {
        if !self.session.kind.has_device() && begun.is_none() {
            self.repeats = self.count_places(sample)?;
        }
        let (data, devices) = self.data(sample)?;
        let first = data.observations.first().map(|row| row.measurement.dim());
        if data.observations.iter().any(|row| Some(row.measurement.dim()) != first) {
            return ErrorKind::Option.refuse(format!(
                "found the kind `{}`, of which rows measure different numbers, expected one kind: plan points or poses",
                self.session.kind.word()
            ));
        }
        self.numbers = data.observations.iter().map(|row| row.measurement.dim()).sum::<usize>() / SAMPLE.max(1);
        let packed = PackedValues::from_dataset(&self.model, &data);
        let rows = data.all_rows();
        let mut estimate = match begun {
            Some((_, registered)) => self.with_gives(registered, &data),
            None => nominal_estimate(&self.model, &data),
        };
        for (station, device) in devices.into_iter().enumerate() {
            *estimate.device_mut(station) = device;
        }
        let session = self.session_of(&data, &packed);
        estimate.recentre(&session, &rows);
        self.estimate = estimate;
        let session = self.session_of(&data, &packed);
        let joints = screw_axes(self.estimate.kinds());
        let free = match begun {
            // Device frames turn about the middle of the measured points.
            Some((data, _)) => {
                let packed = PackedValues::from_dataset(&self.model, data);
                free_parameters(&self.session_of(data, &packed), &self.estimate, &data.all_rows(), joints)
            }
            None => free_parameters(&session, &self.estimate, &rows, joints),
        };
        let layout = Layout::new(free.clone(), self.length_m);
        if layout.dim() > MOST_UNKNOWNS {
            return ErrorKind::Problem.refuse(format!(
                "found {} unknowns, expected at most {MOST_UNKNOWNS} in one fit: plan a shorter chain",
                layout.dim()
            ));
        }
        let StepIndices { geometry, terms, scales, priors } = sort_places(&layout, deviations, corrected);
        let tolerance = fit.tolerance.unwrap_or(Tolerance::WIDE);
        let prior = self.prior_information(&session, tolerance, &layout, &geometry);
        (self.prior, self.geometry, self.terms) = (prior, geometry, terms);
        (self.free, self.targets, self.deviations) = (free, data.targets.len().max(1), priors);
        self.turn = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(scales));
        self.settle_error(sample, fit)?;
        self.settle_modes(sample, fit.count)
    }

    /// Counts the stations that measure one configuration.
    fn count_places(&self, sample: &[f64]) -> Result<usize> {
        let often = sample[..self.width()].repeat(MOST_PLACES);
        let (data, _) = predicted_data(&self.robot, &often, &self.session)?;
        let mut sights: Vec<(usize, usize)> = data.observations.iter().map(|row| (row.station, row.target)).collect();
        sights.sort_unstable();
        sights.dedup();
        Ok(sights.len().max(1))
    }

    /// The prior information of geometry, with a minimum on every unknown.
    fn prior_information(
        &self,
        session: &Session<'_>,
        tolerance: Tolerance,
        layout: &Layout,
        geometry: &[usize],
    ) -> DMatrix<f64> {
        let n = layout.dim();
        let mut prior = NormalEquations::new(n);
        Prior::from_session(session, tolerance).without_terms().add(&self.estimate, layout, 1.0, &mut prior);
        let own = |i: usize, j: usize| {
            let (a, b) = (geometry[i], geometry[j]);
            prior.gram[a.min(b) * n + a.max(b)] + if i == j { RIDGE } else { 0.0 }
        };
        DMatrix::from_fn(geometry.len(), geometry.len(), own)
    }

    /// Splits the robot error: the part due to the terms, whose sizes are scaled down for a smaller error, and the rest, which becomes noise of every
    /// row.
    fn settle_error(&mut self, sample: &[f64], fit: &PlannedFit) -> Result<()> {
        let usual = RobotError { calibrated_m: USUAL_ERROR * self.robot.reach_m(), corrected_m: None };
        let stated = fit.robot_error.unwrap_or(usual);
        let error_m = stated.calibrated_m;
        self.robot_error_m = error_m;
        let of_terms = if self.terms.is_empty() { 0.0 } else { self.error_of_terms(sample)? };
        let scale = match stated.corrected_m {
            _ if of_terms <= 0.0 => 1.0,
            Some(rest_m) => {
                let wanted = (error_m.powi(2) - rest_m.powi(2)).max((LEAST_TERMS * error_m).powi(2)).sqrt();
                // Lists that are chosen for terms beyond the common sizes determine geometry less.
                (wanted / of_terms).min(1.0)
            }
            // Terms never describe all of it.
            None => (error_m * (1.0 - LEAST_REST).sqrt() / of_terms).min(1.0),
        };
        self.turn *= scale;
        self.deviations.iter_mut().for_each(|it| it.deviation *= scale);
        self.rest_m = (error_m.powi(2) - (scale * of_terms).powi(2)).max(0.0).sqrt();
        self.left_m = stated.corrected_m.unwrap_or(self.rest_m);
        // The rest varies between configurations; for rotations it is converted by the length that a radian counts.
        let each = self.rest_m / 3f64.sqrt();
        let (stated, length_m) = (fit.session.noise, self.length_m);
        let leading = fit.session.kind.quantities().first().copied().unwrap_or(Quantity::Position);
        let noise = stated[leading] * if leading.unit() == Unit::Radian { length_m } else { 1.0 };
        self.share = (noise.powi(2) + each.powi(2)) / (noise.powi(2) + error_m.powi(2) / 3.0);
        self.session.noise = ByQuantity::from_fn(|quantity| match quantity.unit() {
            Unit::Metre => stated[quantity].hypot(each),
            Unit::Radian => stated[quantity].hypot(each / length_m),
            Unit::One | Unit::Second => stated[quantity],
        });
        Ok(())
    }

    /// Error of the tip due to terms of their sizes in the limit of many random rows, RMS.
    fn error_of_terms(&self, sample: &[f64]) -> Result<f64> {
        let (rows, moments) = (self.blocks(sample)?, self.moments(sample));
        let (g, c) = (self.geometry.len(), self.terms.len());
        let gram = rows.gram(0..rows.count());
        let h = gram.view((0, 0), (g, g)) + &self.prior;
        let Some(inverse) = inverse(&h) else { return Ok(0.0) };
        let a = inverse * gram.view((0, g), (g, c));
        let (mgg, mgc) = (moments.view((0, 0), (g, g)), moments.view((0, g), (g, c)));
        let bias = (a.transpose() * (mgg * &a)).trace() - 2.0 * a.dot(&mgc) + moments.view((g, g), (c, c)).trace();
        Ok(bias.max(0.0).sqrt())
    }

    /// Combines terms into the directions that a session of this number of configurations determines.
    fn settle_modes(&mut self, sample: &[f64], count: usize) -> Result<()> {
        if self.terms.is_empty() {
            return Ok(());
        }
        let rows = self.blocks(sample)?;
        let (g, c) = (self.geometry.len(), self.terms.len());
        let own = rows.gram(0..rows.count()).view((g, g), (c, c)).into_owned();
        let own = own * (count.max(100) as f64 / rows.count().max(1) as f64);
        let (values, vectors) = linalg::symmetric_eigen(own.as_slice(), c);
        let first = values.iter().take_while(|&&value| value < NEGLIGIBLE).count();
        self.turn = &self.turn * vectors.columns(first, c - first);
        Ok(())
    }
}

/// Sorts the indices of a layout into those of geometry and of terms.
fn sort_places(layout: &Layout, deviations: &[f64], corrected: &CorrectionModel) -> StepIndices {
    let (mut geometry, mut terms, mut scales) = (Vec::new(), Vec::new(), Vec::new());
    let mut priors = Vec::new();
    let known: Vec<(usize, poecal_model::robot::Term)> = corrected.terms().collect();
    for (parameter, places) in layout.parameters() {
        match parameter.value_term() {
            Some(it) => {
                let own = known.iter().position(|&(joint, term)| (joint, term) == (it.joint, it.term));
                let deviation = own.and_then(|at| deviations.get(at)).copied().unwrap_or(0.0);
                priors.push(TermPrior { joint: it.joint, term: it.term, deviation });
                // A step along a term is in scaled units.
                terms.extend(places.iter().map(|(place, _)| *place));
                scales.extend(places.iter().map(|(_, scale)| deviation * scale));
            }
            None => geometry.extend(places.iter().map(|(place, _)| *place)),
        }
    }
    geometry.sort_unstable();
    StepIndices { geometry, terms, scales, priors }
}
