//! Errors of models, and the verdict, as attributes.

use poecal_calibrate as calibration;
use poecal_calibrate::{AcceptedModel, Level};
use poecal_report::table::number;
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::words::choose_word;

/// Mean, root mean square, 95th percentile and maximum of errors.
#[pyclass(frozen, eq, get_all, module = "poecal", name = "Statistic")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Statistic {
    /// Mean.
    mean: f64,
    /// Root mean square.
    rms: f64,
    /// 95th percentile.
    p95: f64,
    /// Largest.
    max: f64,
}

#[pymethods]
impl Statistic {
    fn __repr__(&self) -> String {
        let [mean, rms, p95, max] = [self.mean, self.rms, self.p95, self.max].map(number);
        format!("<poecal.Statistic mean {mean}, RMS {rms}, 95 % {p95}, max {max}>")
    }
}

impl From<calibration::Statistic> for Statistic {
    fn from(calibration::Statistic { mean, rms, p95, max }: calibration::Statistic) -> Self {
        Statistic { mean, rms, p95, max }
    }
}

/// Errors of one model on one set of rows.
#[pyclass(frozen, eq, module = "poecal", name = "ModelAccuracy")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct ModelAccuracy(calibration::ModelAccuracy);

#[pymethods]
impl ModelAccuracy {
    /// Distance from measured to predicted position, millimetres.
    #[getter]
    fn position_mm(&self) -> PyResult<Statistic> {
        self.__getattr__("position_mm")
    }

    /// Angle from measured to predicted orientation, degrees; None if no orientation was measured.
    #[getter]
    fn rotation_deg(&self) -> Option<Statistic> {
        self.0.rotation_deg().map(Into::into)
    }

    /// The errors of any other measured quantity, by its key in `calibration.json`.
    fn __getattr__(&self, name: &str) -> PyResult<Statistic> {
        let found = self.0.iter().find(|(quantity, _)| quantity.key() == name);
        found.map(|(_, found)| found.into()).ok_or_else(|| {
            let known: Vec<&str> = self.0.iter().map(|(quantity, _)| quantity.key()).collect();
            PyAttributeError::new_err(format!("found no errors named `{name}`, expected {}", known.join(" or ")))
        })
    }

    fn __repr__(&self) -> String {
        format!("<poecal.ModelAccuracy {} RMS>", self.words())
    }
}

impl ModelAccuracy {
    /// Root mean square of each measured quantity.
    fn words(&self) -> String {
        let words = self.0.iter().map(|(quantity, it)| format!("{} {}", number(it.rms), quantity.unit().symbol()));
        words.collect::<Vec<_>>().join(", ")
    }

    /// Root mean square of the quantity that judges it.
    fn leading_rms(&self) -> String {
        number(self.0.lead().rms)
    }

    /// Unit of that quantity.
    fn unit(&self) -> &'static str {
        self.0.leading_value().map_or("mm", |(quantity, _)| quantity.unit().symbol())
    }
}

impl From<calibration::ModelAccuracy> for ModelAccuracy {
    fn from(found: calibration::ModelAccuracy) -> Self {
        ModelAccuracy(found)
    }
}

/// Errors of the nominal, registered, calibrated and corrected model on one set of rows.
#[pyclass(frozen, eq, get_all, module = "poecal", name = "SetAccuracy")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct SetAccuracy {
    /// Number of measurements.
    count: usize,
    /// The nominal model; only an unknown device frame is fitted.
    nominal: ModelAccuracy,
    /// Device frame and targets fitted, screws nominal.
    registered: ModelAccuracy,
    /// Screws fitted too.
    calibrated: ModelAccuracy,
    /// Screws and terms of the joints fitted together; None if no terms were requested.
    corrected: Option<ModelAccuracy>,
}

#[pymethods]
impl SetAccuracy {
    fn __repr__(&self) -> String {
        let [nominal, registered, calibrated] =
            [self.nominal, self.registered, self.calibrated].map(|it| it.leading_rms());
        let corrected = self.corrected.map_or_else(String::new, |model| format!(", corrected {}", model.leading_rms()));
        format!(
            "<poecal.SetAccuracy of {} rows: nominal {nominal}, registered {registered}, calibrated {calibrated}{corrected} {} RMS>",
            self.count,
            self.calibrated.unit()
        )
    }
}

impl From<calibration::SetAccuracy> for SetAccuracy {
    fn from(found: calibration::SetAccuracy) -> Self {
        SetAccuracy {
            count: found.count,
            nominal: found.nominal.into(),
            registered: found.registered.into(),
            calibrated: found.calibrated.into(),
            corrected: found.corrected.map(Into::into),
        }
    }
}

/// Errors on the rows that were fitted and on those that were held out.
#[pyclass(frozen, eq, module = "poecal", name = "Accuracy")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// Errors on the rows that were fitted.
    #[pyo3(get)]
    training: SetAccuracy,
    /// Errors on the rows that were not fitted; None if none was held out.
    #[pyo3(get)]
    held_out: Option<SetAccuracy>,
    /// Number of configurations if all were fitted because too few would have been held out; None otherwise.
    #[pyo3(get)]
    few_configurations: Option<usize>,
    /// The delivered model.
    delivered: AcceptedModel,
}

#[pymethods]
impl Accuracy {
    fn __repr__(&self) -> String {
        let words = |set: &SetAccuracy, name: &str| {
            let model = match self.delivered {
                AcceptedModel::Corrected => set.corrected.unwrap_or(set.calibrated),
                AcceptedModel::Calibrated => set.calibrated,
            };
            format!("{} {} RMS on {} {name} rows", model.leading_rms(), model.unit(), set.count)
        };
        let held_out = self.held_out.as_ref().map_or_else(String::new, |set| words(set, "held-out") + ", ");
        format!(
            "<poecal.Accuracy of the {} model: {held_out}{}>",
            self.delivered.word(),
            words(&self.training, "fitted")
        )
    }
}

impl Accuracy {
    pub(crate) fn new(found: calibration::Accuracy, delivered: AcceptedModel) -> Self {
        let held_out = found.held_out.map(Into::into);
        let few_configurations = found.few_configurations;
        Accuracy { training: found.training.into(), held_out, few_configurations, delivered }
    }
}

/// Verdict: permitted use of a calibration, and the reasons against a wider one.
#[pyclass(frozen, eq, module = "poecal", name = "Verdict")]
#[derive(Clone, PartialEq)]
pub(crate) struct Verdict(pub(crate) calibration::Verdict);

#[pymethods]
impl Verdict {
    /// "good", "inside_sampled_range", "measured_configurations", "located" or "do_not_use".
    #[getter]
    fn level(&self) -> &'static str {
        self.0.level.word()
    }

    /// Sentences with the deciding figures.
    #[getter]
    fn reasons(&self) -> Vec<String> {
        self.0.reasons.clone()
    }

    /// The delivered model: "corrected" if it has terms, else "calibrated".
    #[getter]
    fn model(&self) -> Option<&'static str> {
        self.0.model.map(AcceptedModel::word)
    }

    /// Expected error of that model in configurations like those that were measured, millimetres (RMS); None if no use is advised.
    #[getter]
    fn expected_error_mm(&self) -> Option<f64> {
        self.0.expected_error_mm
    }

    /// The distance that 95 % of its errors do not exceed there, millimetres.
    #[getter]
    fn bound95_mm(&self) -> Option<f64> {
        self.0.bound95_mm
    }

    /// Expected error of that model anywhere inside the sampled range of each joint, millimetres (RMS).
    #[getter]
    fn sampled_range_error_mm(&self) -> Option<f64> {
        self.0.sampled_range_error_mm
    }

    /// Distance of the nominal model's predictions from its own there, with targets and devices fitted, millimetres (RMS).
    #[getter]
    fn nominal_error_mm(&self) -> Option<f64> {
        self.0.nominal_error_mm
    }

    /// Comparison with the nominal model's predictions there: "clear", "unclear" or "loss".
    #[getter]
    fn gain(&self) -> Option<&'static str> {
        self.0.gain.map(calibration::Gain::word)
    }

    /// Sentence with figures if the axes of the nominal model are confirmed; None if they are not.
    #[getter]
    fn confirmed(&self) -> Option<String> {
        self.0.confirmed.clone()
    }

    /// True if a calibration may be used at least to this level.
    ///
    /// Parameters
    /// ----------
    /// level
    ///     "good", "inside_sampled_range", "measured_configurations", "located" or "do_not_use".
    ///
    /// Returns
    /// -------
    /// bool
    ///     True if the verdict's level is `level` or a better one.
    fn is_at_least(&self, #[pyo3(from_py_with = arg::level)] level: &str) -> PyResult<bool> {
        let mut levels = Level::TABLE.map(|(level, word, _)| (word, level));
        levels.reverse();
        Ok(self.0.level >= choose_word("level", level, &levels)?)
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Verdict {}: {}>", self.0.level.word(), self.0.reasons.join("; "))
    }

    fn __str__(&self) -> String {
        format!("{}: {}", self.0.level.words(), self.0.reasons.join("; "))
    }
}
