//! Pictures in a fit: the common error of their corners, and the pose of each that is nearest to its prediction (theory.md §4, *Pictures*).
//!
//! A picture is one row, so that fits, bounds and judgements count pictures. The common error is estimated in turn with the fit. `poecal-fit`'s
//! `start/pictures.rs` determines the end of the robot that carries a camera, and the one of two poses of a flat board that the others support; its
//! `problem/bundle.rs` fits all corners at once.

pub(crate) mod image_map;
pub(crate) mod optics;
pub(crate) mod optics_doubts;
pub(crate) mod projection;
pub(crate) mod view_doubts;

use nalgebra::{Matrix6, Vector6};

use super::robust::RobustFit;
use super::run::CalibrationRun;
use crate::pictures::optics::Optics;
use crate::trust::information::FitInformation;
use poecal_arm::lie::Pose;
use poecal_fit::start::predicted_pose;
use poecal_model::camera::{Centre, CommonError, Sighting, SightingInput};
use poecal_model::measurement::{Dataset, Noise, SightingAbout, deviation};

/// Most fits with the noise of pictures re-estimated.
pub(crate) const ROUNDS: usize = 8;
/// Change of a standard deviation that is worth another fit.
const CHANGE: f64 = 0.05;
/// Turn of a pose from its prediction beyond which a flat board is seen as tilted the other way, rad.
const FLIPPED_RAD: f64 = 0.2;
/// Ratio to the noise of its best pose up to which a pose near the prediction is preferred.
const AS_GOOD: f64 = 3.0;

/// Largest extension of a round, as a multiple of its step.
const FASTEST: f64 = 4.0;

/// Convergence of the rounds to the common error that they agree with: each round alone goes a share of the distance, a smaller one the less its
/// pictures determine it.
#[derive(Default)]
pub(crate) struct RoundPace {
    /// Start of the last round, as logarithms of shift and turn, and its step.
    last: Option<([f64; 2], [f64; 2])>,
}

impl RoundPace {
    /// The common error at which the steps of this round and the last would end, if they shrink evenly: between the step and [`FASTEST`] times it.
    fn extrapolate(&mut self, from: CommonError, to: CommonError) -> CommonError {
        let logs = |it: CommonError| [it.shift_m, it.turn_rad].map(f64::ln);
        let (begin, end) = (logs(from), logs(to));
        let step = [end[0] - begin[0], end[1] - begin[1]];
        let last = self.last.replace((begin, step));
        let Some((last_begin, last_step)) = last.filter(|_| from.about == to.about) else { return to };
        let next = [0, 1].map(|k| {
            let factor = (begin[k] - last_begin[k]) / (last_step[k] - step[k]);
            let is_even = last_step[k] * step[k] > 0.0 && factor.is_finite();
            let factor = if is_even && factor < 0.0 { FASTEST } else { factor };
            begin[k] + step[k] * if is_even { factor.clamp(1.0, FASTEST) } else { 1.0 }
        });
        let [shift_m, turn_rad] = next.map(|it| it.exp().max(CommonError::FINEST));
        CommonError { shift_m, turn_rad, ..to }
    }
}

/// A sighting, and the deviation of its row from the prediction.
type SightingError = (Sighting, Vector6<f64>);

impl CalibrationRun<'_> {
    /// The data with the noise of pictures as estimated from the residuals of a fit, and with each picture at the pose nearest to its prediction.
    /// `None` if that changes nothing.
    pub(crate) fn renewed_pictures(
        &self,
        ratios: &[Noise],
        fit: &RobustFit,
        (optics, pace): (&mut Option<Optics>, &mut RoundPace),
    ) -> Option<Dataset> {
        if self.data.pictures.is_empty() {
            return None;
        }
        let weights = fit.weights();
        let information = FitInformation::from_fit(self, ratios, (fit, &weights));
        let advance = |it: &mut Optics| it.advance(self, (information.as_ref()?, fit), CHANGE);
        let next = optics.as_mut().and_then(advance);
        let pictures = next.as_ref().map_or(&self.data.pictures, |(next, _)| &next.pictures);
        let estimate = next.as_ref().map_or(&fit.fitted.estimate, |(_, estimate)| estimate);
        let session = self.session(ratios);
        let rows: Vec<u32> = pictures.all.iter().map(|it| it.row).collect();
        let errors = session.errors(&rows, estimate);
        let mut has_moved = next.is_some();
        // Sightings with their deviations from prediction, as motions of their rows.
        let mut found: Vec<SightingError> = Vec::with_capacity(rows.len());
        for (picture, error) in pictures.all.iter().zip(&errors) {
            let measured = self.data.observations[picture.row as usize].measurement.pose();
            let predicted = predicted_pose(&measured, error);
            let view = pictures.view(picture)?;
            let kept = view.sighting(&picture.directed_measurement(&measured), true)?;
            let expected = picture.directed_measurement(&predicted);
            let sighting = nearest_sighting(&view, kept, &expected);
            let pose = picture.directed_measurement(&sighting.camera_from_board);
            let moved = deviation(&sighting.camera_from_board, &picture.directed_measurement(&measured));
            has_moved |= (moved.transpose() * sighting.information * moved)[0] > CHANGE * CHANGE;
            found.push((sighting, deviation(&pose, &predicted)));
        }
        let numbers = optics.as_ref().map_or(0.0, Optics::determined_count);
        let spreads = self.spreads_of_pictures(information.as_ref());
        let common = self.common_error((fit, numbers), (&found, &spreads), session.length_m);
        let before = pictures.common;
        let common = pace.extrapolate(before, common);
        let differs = |a: f64, b: f64| (a / b).ln().abs() > CHANGE;
        let same = common.about == before.about
            && !differs(common.shift_m, before.shift_m)
            && !differs(common.turn_rad, before.turn_rad)
            && !differs(common.corners, before.corners);
        if !has_moved && same {
            return None;
        }
        let mut data = next.map(|(next, _)| next).unwrap_or_else(|| self.data.clone().into_owned());
        data.pictures.common = common;
        if optics.is_some() {
            let sightings: Vec<Sighting> = found.iter().map(|(sighting, _)| sighting.clone()).collect();
            data.pictures.sigma_px = data.corner_noise(&sightings, numbers).unwrap_or(data.pictures.sigma_px);
        }
        for (at, (sighting, _)) in found.iter().enumerate() {
            data.state_picture(at, sighting);
        }
        Some(data)
    }

    /// Likeliest common error of the corners of a picture, about the board or about the camera. Deviations from predictions are smaller than those
    /// from the truth, by the error of the predictions themselves.
    fn common_error(
        &self,
        (fit, numbers): (&RobustFit, f64),
        (found, spreads): (&[SightingError], &[Matrix6<f64>]),
        length_m: f64,
    ) -> CommonError {
        let pictures = &self.data.pictures;
        let counts = |row: u32| self.fit_rows.binary_search(&row).is_ok() && !fit.robustness.suspects_row(row);
        let seen = |about: Centre| -> Vec<(Matrix6<f64>, Matrix6<f64>)> {
            let own = pictures.all.iter().zip(found).zip(spreads).filter(|((picture, _), _)| counts(picture.row));
            own.map(|((picture, (sighting, deviation)), spread)| {
                let sighting = SightingAbout::new((&sighting.camera_from_board, sighting.information), about);
                let from_row = sighting.from_row(picture.of_camera);
                let squares = deviation * deviation.transpose() + spread;
                (sighting.information, from_row * squares * from_row.transpose())
            })
            .collect()
        };
        let likeliest =
            |about: Centre| CommonError { about, ..pictures.common }.estimate_likely(&seen(about), numbers, length_m);
        let (board, camera) = (likeliest(Centre::Board), likeliest(Centre::Camera));
        // The known centre is kept unless the other is better.
        let margin = if pictures.common.about == Centre::Board { 2.0 } else { -2.0 };
        if camera.1 + margin < board.1 { camera.0 } else { board.0 }
    }

    /// Covariance of the predicted pose of each picture by the unknowns of a fit, as motions of its row; empty for pictures that are not fitted.
    fn spreads_of_pictures(&self, information: Option<&FitInformation<'_>>) -> Vec<Matrix6<f64>> {
        let pictures = &self.data.pictures.all;
        let mut spreads = vec![Matrix6::zeros(); pictures.len()];
        let Some(information) = information else { return spreads };
        let covariance = information.covariance();
        for (at, by) in information.of_pictures(self) {
            spreads[at] = &by * &covariance * by.transpose();
        }
        spreads
    }
}

/// The sighting of a picture nearest to its prediction, if it is nearly as good as the kept one; else the kept one.
fn nearest_sighting(view: &SightingInput<'_>, kept: Sighting, expected: &Pose) -> Sighting {
    let is_near = |it: &Sighting| expected.distance_and_angle(&it.camera_from_board).1 <= FLIPPED_RAD;
    // To first order at the prediction, where the rounds end at the fit of the pixels; far from it at the nearest best pose.
    let near = || view.sighting(expected, true).filter(is_near);
    let mean = |it: &Sighting| it.cost / it.freedom.max(1.0);
    let is_as_good =
        |near: &Sighting| mean(near) <= AS_GOOD * AS_GOOD * mean(&kept).max(1.0) && near.freedom >= kept.freedom - 1.0;
    let sighting = view.sighting_near(expected).filter(is_as_good);
    sighting.or_else(|| near().filter(is_as_good)).unwrap_or(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_that_shrink_evenly_are_gone_at_once() {
        let at = |log: f64| CommonError { shift_m: log.exp(), turn_rad: log.exp(), ..CommonError::NONE };
        let mut pace = RoundPace::default();
        // The first step alone, then half of it: together they end at -4 - 1.
        assert_eq!(pace.extrapolate(at(-3.0), at(-4.0)), at(-4.0));
        let ahead = pace.extrapolate(at(-4.0), at(-4.5));
        println!("steps of 1 and 1/2 end at {:.6}", ahead.shift_m.ln());
        assert!((ahead.shift_m.ln() + 5.0).abs() < 1e-12 && (ahead.turn_rad.ln() + 5.0).abs() < 1e-12);
        // Steps that turn back are not extended.
        assert!((pace.extrapolate(at(-5.0), at(-4.75)).shift_m.ln() + 4.75).abs() < 1e-12);
        // Another centre is another error.
        let other = CommonError { about: Centre::Camera, ..at(-4.9) };
        assert_eq!(pace.extrapolate(at(-4.75), other), other);
    }
}
