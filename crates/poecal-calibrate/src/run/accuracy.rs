//! Errors of the three models.

use std::ops::Deref;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::pixels::{PixelAccuracy, pixel_accuracy};
use crate::steps::level::Gain;
use poecal_fit::state::{Estimate, RowError, Session};
use poecal_model::measurement::{Dataset, MeasuredQuantities, Quantity};
use poecal_numerics::unit::Unit;

/// The three models of every result, as estimates.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    /// Screws and targets nominal; only an unknown device frame is fitted.
    pub nominal: Estimate,
    /// Device frame and targets fitted, screws nominal.
    pub registered: Estimate,
    /// Screws, targets and device frame fitted.
    pub calibrated: Estimate,
}

/// Mean, root mean square, 95th percentile (linear between ranks) and maximum of errors.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::Statistic;
/// # }
/// use poecal::Statistic;
/// let s = Statistic::from_errors(vec![3.0, 4.0]).expect("two values");
/// assert_eq!((s.mean, s.rms, s.max), (3.5, 12.5_f64.sqrt(), 4.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Statistic {
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

impl Statistic {
    /// Statistic of absolute errors, with the 95 % quantile by linear interpolation between order statistics: theory.md §9. `None` without
    /// errors.
    #[must_use]
    pub fn from_errors(mut errors: Vec<f64>) -> Option<Self> {
        if errors.is_empty() {
            return None;
        }
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
        let max = errors.iter().copied().max_by(f64::total_cmp)?;
        let rank = 0.95 * (errors.len() - 1) as f64;
        let (_, &mut below, beyond) = errors.select_nth_unstable_by(rank.floor() as usize, f64::total_cmp);
        let above = beyond.iter().copied().min_by(f64::total_cmp).unwrap_or(below);
        // A whole rank must not use the next value, which may be infinite.
        let p95 = if rank.fract() == 0.0 { below } else { below + (above - below) * rank.fract() };
        Some(Statistic { mean, rms, p95, max })
    }
}

/// Errors of one model on one set of rows, of each quantity: distance from measured to predicted position (millimetres), angle from measured
/// to predicted orientation (degrees).
///
/// ```
/// # use poecal_calibrate::CalibrationOptions;
/// # use poecal_model::measurement::SessionKind;
/// # use poecal_model::simulate::{Simulation, elbow};
/// # use poecal_calibrate::calibrate;
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let calibrated = calibration.accuracy.training.calibrated;
/// assert!(calibrated.position_mm().rms < 0.1 && calibrated.rotation_deg().is_some());
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelAccuracy {
    /// Statistics of each measured quantity.
    #[serde(flatten)]
    pub quantities: MeasuredQuantities<Statistic>,
    /// Residuals of all rows measured by a device without a frame of its own, millimetres, for any quantity: the remaining violation of their
    /// constraint, as the error of a distance, the distance of a ball from the middle of its socket, or a height over its plane. Absent if there are
    /// none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual_mm: Option<Statistic>,
    /// Errors of the corners of all pictures; absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixels: Option<PixelAccuracy>,
}

impl Deref for ModelAccuracy {
    type Target = MeasuredQuantities<Statistic>;

    fn deref(&self) -> &MeasuredQuantities<Statistic> {
        &self.quantities
    }
}

impl ModelAccuracy {
    /// Errors of the corners if all of `rows` rows are pictures. The pose of a small board in its picture is uncertain along the ray and in its turn,
    /// so its corners judge.
    pub fn of_pictures(&self, rows: usize) -> Option<PixelAccuracy> {
        self.pixels.filter(|pixels| pixels.pictures == rows)
    }

    /// Error that judges the model on this number of rows.
    pub(crate) fn judging_error(&self, rows: usize) -> JudgingError {
        if let Some(pixels) = self.of_pictures(rows) {
            let (what, rms) = (CORNERS.to_owned(), pixels.rms_mm);
            return JudgingError { what, rms, unit: Unit::Metre };
        }
        let (quantity, rms) = self.leading_value().map_or((Quantity::Position, 0.0), |(it, found)| (it, found.rms));
        JudgingError { what: format!("{} error", quantity.name()), rms, unit: quantity.unit() }
    }
}

/// Name of the error of corners in millimetres.
pub(crate) const CORNERS: &str = "error of the corners at the board";

/// The error by which a model is judged, root mean square in the unit in which people read it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JudgingError {
    pub(crate) what: String,
    pub(crate) rms: f64,
    pub(crate) unit: Unit,
}

impl Default for JudgingError {
    fn default() -> Self {
        JudgingError { what: String::new(), rms: 0.0, unit: Unit::Metre }
    }
}

impl JudgingError {
    /// The error in metres; zero if it is not a length.
    pub(crate) fn metres(&self) -> f64 {
        if self.unit == Unit::Metre { 1e-3 * self.rms } else { 0.0 }
    }
}

impl From<MeasuredQuantities<Statistic>> for ModelAccuracy {
    fn from(quantities: MeasuredQuantities<Statistic>) -> Self {
        ModelAccuracy { quantities, residual_mm: None, pixels: None }
    }
}

impl ModelAccuracy {
    /// Root mean square of the leading quantity, metres, if it is a length.
    pub(crate) fn leading_m(&self) -> f64 {
        let length = self.leading_value().filter(|(quantity, _)| quantity.unit() == Unit::Metre);
        length.map_or(0.0, |(_, found)| 1e-3 * found.rms)
    }
}

/// Ratio of the root mean square error of the nominal model, registered, to that of another model on the same rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Improvement {
    /// The factor.
    pub factor: f64,
    /// Lower end of its interval, with 95 % confidence.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

impl Improvement {
    /// Decision whether the other model is clearly better.
    #[must_use]
    pub fn gain(&self) -> Gain {
        Gain::of_interval([self.from.ln(), self.to.ln()])
    }
}

/// Improvement of each quantity by the models that are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Improvements {
    /// Improvement by the calibrated model.
    pub calibrated: MeasuredQuantities<Improvement>,
    /// Improvement by the corrected model; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrected: Option<MeasuredQuantities<Improvement>>,
}

/// Errors of the three models on one set of rows.
///
/// ```
/// # use poecal_calibrate::CalibrationOptions;
/// # use poecal_model::measurement::SessionKind;
/// # use poecal_model::simulate::{Simulation, elbow};
/// # use poecal_calibrate::calibrate;
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let fitted = calibration.accuracy.training;
/// assert!(fitted.calibrated.position_mm().rms < fitted.registered.position_mm().rms);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SetAccuracy {
    /// Number of measurements.
    pub count: usize,
    /// The nominal model; only an unknown device frame is fitted.
    pub nominal: ModelAccuracy,
    /// Device frame and targets fitted, screws nominal.
    pub registered: ModelAccuracy,
    /// Screws fitted too.
    pub calibrated: ModelAccuracy,
    /// Screws and terms of the joints fitted together; absent if no terms were requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrected: Option<ModelAccuracy>,
    /// Ratio of the registered model's errors to those of the fitted models, on held-out rows; absent for other rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub improvement: Option<Improvements>,
}

/// Errors on training and held-out rows.
///
/// ```
/// # use poecal_calibrate::CalibrationOptions;
/// # use poecal_model::measurement::SessionKind;
/// # use poecal_model::simulate::{Simulation, elbow};
/// # use poecal_calibrate::calibrate;
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), SessionKind::POSE)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let accuracy = calibration.accuracy;
/// assert_eq!((accuracy.training.count, accuracy.held_out.map(|set| set.count)), (28, Some(12)));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Accuracy {
    /// On the training rows.
    pub training: SetAccuracy,
    /// On the held-out rows; null if there are none.
    pub held_out: Option<SetAccuracy>,
    /// Number of configurations, if all were fitted because too few would have been held out; absent otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub few_configurations: Option<usize>,
}

/// Errors of the three models on some rows (at least one): theory.md §9.
#[must_use]
pub fn set_accuracy(session: &Session<'_>, rows: &[u32], models: &Models) -> SetAccuracy {
    let of = |estimate: &Estimate| model_accuracy(session.data, rows, &session.errors(rows, estimate));
    SetAccuracy {
        count: rows.len(),
        nominal: of(&models.nominal),
        registered: of(&models.registered),
        calibrated: of(&models.calibrated),
        corrected: None,
        improvement: None,
    }
}

/// Statistics of one model's row errors.
pub(crate) fn model_accuracy(data: &Dataset, rows: &[u32], errors: &[RowError]) -> ModelAccuracy {
    let quantities = MeasuredQuantities::from_fn(|quantity| {
        let shown = |length: f64| quantity.unit().in_shown_unit(length);
        Statistic::from_errors(errors.iter().filter_map(|error| error.length(quantity).map(shown)).collect())
    });
    let constrained = errors.iter().filter_map(RowError::constraint_m);
    let residual_mm = Statistic::from_errors(constrained.map(|it| 1e3 * it).collect());
    ModelAccuracy { quantities, residual_mm, pixels: pixel_accuracy(data, rows, errors) }
}
