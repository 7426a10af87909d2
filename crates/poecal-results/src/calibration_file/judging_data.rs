//! Data of a calibration file that its judgement needs.

use super::{CalibrationFile, MeasuredEntry};
use poecal_arm::lie::Pose;
use poecal_calibrate::{AcceptedModel, DeviceFrameKnowledge, ModelAccuracy};
use poecal_model::measurement::{ByQuantity, Dataset, Noise, Quantity};
use poecal_numerics::error::{ErrorKind, Result, first_few, nearest_word};
use poecal_plan::plan::RobotError;
use poecal_storage::hashes;

/// Noise of a quantity if the calibration measured none of its unit, millimetres or degrees.
const UNSEEN: f64 = 0.05;

impl CalibrationFile {
    /// SHA-256 of the file as it is written.
    ///
    /// # Errors
    /// As [`CalibrationFile::to_text`].
    pub fn sha256(&self) -> Result<String> {
        Ok(hashes::sha256_of(&self.to_text()?))
    }

    /// Position errors that remained after the calibration: of held-out rows, else in cross-validation, else of the fitted rows.
    #[must_use]
    pub fn left_error(&self) -> Option<RobotError> {
        let set = self.accuracy.held_out.as_ref().unwrap_or(&self.accuracy.training);
        let position_m = |errors: &ModelAccuracy, model| {
            let own = errors.get(Quantity::Position)?.rms;
            // Suspected rows are in the errors of fitted rows, and in no cross-validation.
            Some(1e-3 * self.left_out(model, Quantity::Position).unwrap_or(own))
        };
        let calibrated_m = position_m(&set.calibrated, AcceptedModel::Calibrated)?;
        let corrected = set.corrected.as_ref().and_then(|it| position_m(it, AcceptedModel::Corrected));
        let corrected_m = corrected.map(|it| it.min(calibrated_m));
        Some(RobotError { calibrated_m, corrected_m })
    }

    /// Knowledge of the device frame.
    #[must_use]
    pub fn frame(&self) -> DeviceFrameKnowledge {
        self.measurement_frame.known
    }

    /// Noise of the calibration, metres and radians.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if the file holds no valid noise.
    pub fn noise(&self) -> Result<Noise> {
        let sigma = &self.noise.sigma;
        for (quantity, sigma) in sigma.iter() {
            if sigma.is_nan() || sigma <= 0.0 {
                let key = quantity.key();
                return ErrorKind::Model.refuse(format!(
                    "found `noise.sigma.{key}` of {sigma}, expected a standard deviation above 0: calibrate again"
                ));
            }
        }
        let like = |quantity: Quantity| sigma.iter().find(|(other, _)| other.unit() == quantity.unit());
        let shown = |quantity| sigma.get(quantity).or_else(|| like(quantity).map(|(_, sigma)| sigma));
        Ok(ByQuantity::from_fn(|quantity| quantity.unit().from_shown(shown(quantity).unwrap_or(UNSEEN))))
    }

    /// Root mean square error of a model's leading quantity, of poses and points the position, on held-out rows, otherwise in cross-validation,
    /// otherwise on training rows, without suspected ones; millimetres or degrees.
    #[must_use]
    pub fn own_rms(&self, model: AcceptedModel) -> f64 {
        self.own_error(model).0
    }

    /// The same error with the name of its rows, in the words of files.
    #[must_use]
    pub fn own_error(&self, model: AcceptedModel) -> (f64, &'static str) {
        let (accuracy, robust) = (&self.accuracy, &self.robust);
        let (set, rows) = match &accuracy.held_out {
            Some(set) => (robust.without_suspected.held_out.as_ref().unwrap_or(set), "held_out"),
            None => (robust.without_suspected.training.as_ref().unwrap_or(&accuracy.training), "training"),
        };
        let corrected = set.corrected.as_ref().filter(|_| model == AcceptedModel::Corrected);
        let errors = corrected.unwrap_or(&set.calibrated);
        let rms = errors.lead().rms;
        let left_out = errors.leading_value().and_then(|(quantity, _)| self.left_out(model, quantity));
        left_out.map_or((rms, rows), |it| (it, "cross_validation"))
    }

    /// Root mean square error of a model in cross-validation, where no row was held out; millimetres or degrees.
    fn left_out(&self, model: AcceptedModel, quantity: Quantity) -> Option<f64> {
        let found = self.cross_validation.as_ref().filter(|_| self.accuracy.held_out.is_none())?;
        let corrected = self.corrected.as_ref().filter(|it| model == AcceptedModel::Corrected && it.has_terms());
        match corrected {
            Some(corrected) => corrected.left_out_position_mm.filter(|_| quantity == Quantity::Position),
            None => found.random.rms.get(quantity),
        }
    }

    /// `base_from_device` of each station of some measurements, by the names of the instruments.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`] if the calibration does not know one of them, [`ErrorKind::Model`] if the file holds no valid pose.
    pub fn devices_of(&self, data: &Dataset) -> Result<Vec<Pose>> {
        const REFIT: &str = "or refit the frames with --refit device";
        let stations = data.station_count();
        if self.stations.is_empty() {
            if stations == 1 {
                return Ok(vec![self.base_from_device()?]);
            }
            return ErrorKind::Problem.refuse(format!(
                "found measurements of {stations} instruments, expected those of one, since the calibration has one device frame: judge \
                 each by itself, {REFIT}"
            ));
        }
        let names = || self.stations.iter().filter_map(|it| it.instrument.as_deref());
        let known = first_few(&names().collect::<Vec<_>>());
        (0..stations)
            .map(|station| {
                let name = data.stations.get(station).and_then(Option::as_deref);
                let found = match (self.stations.as_slice(), name) {
                    ([only], None) => Some(only),
                    (_, None) if self.last_station().is_some() => self.last_station(),
                    (several, name) => several.iter().find(|it| it.instrument.as_deref() == name),
                };
                if let Some(found) = found {
                    return found.base_from_device.pose();
                }
                ErrorKind::Problem.refuse(match name {
                    None => format!(
                        "found measurements without an instrument's name, expected one of {known} as in the calibration: add a column \
                         `instrument`, {REFIT}"
                    ),
                    Some(name) => format!(
                        "found measurements of instrument `{name}`, whose frame is not in the calibration, expected one of {known}: \
                         rename it, {REFIT}"
                    ),
                })
            })
            .collect()
    }

    /// Refuses measurements of unknown targets, or of orientations of targets that were calibrated as points.
    ///
    /// # Errors
    /// [`ErrorKind::Problem`].
    pub fn check_targets(&self, data: &Dataset) -> Result<()> {
        let refit = "or refit the targets with --refit tool";
        let names = || self.targets.keys().map(String::as_str);
        let frames = data.frames(&data.all_rows());
        let known = first_few(&names().collect::<Vec<_>>());
        for (is_frame, name) in frames.into_iter().zip(&data.targets) {
            return ErrorKind::Problem.refuse(match name.as_deref().or(self.unnamed_target()) {
                None if self.targets.is_empty() => continue,
                None => format!(
                    "found measurements without a target's name, expected one of {known} as in the calibration: add a \
                     column `target`, {refit}"
                ),
                Some(name) => match self.targets.get(name) {
                    Some(target) if target.measured_entry() == MeasuredEntry::Nothing => {
                        format!(
                            "found measurements of target `{name}`, expected targets that the calibration measured: calibrate with some of it, {refit}"
                        )
                    }
                    Some(target) if target.measured_entry() == MeasuredEntry::Position && is_frame => {
                        format!(
                            "found orientations of target `{name}`, expected positions alone, since it is a point in the calibration: leave the orientation columns out, {refit}"
                        )
                    }
                    Some(_) => continue,
                    None if self.targets.is_empty() => format!(
                        "found measurements of target `{name}`, expected no name, since the calibration has the tip alone: leave the names out, {refit}"
                    ),
                    None => {
                        let near = nearest_word(name, names()).map(|near| format!(" (nearest: `{near}`)"));
                        format!(
                            "found measurements of target `{name}`, expected one of {known} as in the calibration{}: rename \
                             it, {refit}",
                            near.unwrap_or_default()
                        )
                    }
                },
            });
        }
        Ok(())
    }
}
