//! Errors of models, and the verdict, as attributes.

use poecal::calibration::{self, Level};
use poecal::report::table::number;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::words::chosen;

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
#[pyclass(frozen, eq, get_all, module = "poecal", name = "ModelAccuracy")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct ModelAccuracy {
    /// Distance from measured to predicted position, millimetres.
    position_mm: Statistic,
    /// Angle from measured to predicted orientation, degrees; None where no orientation was measured.
    rotation_deg: Option<Statistic>,
}

#[pymethods]
impl ModelAccuracy {
    fn __repr__(&self) -> String {
        let rotation = self.rotation_deg.map_or_else(String::new, |it| format!(", {} deg", number(it.rms)));
        format!("<poecal.ModelAccuracy {} mm{rotation} RMS>", number(self.position_mm.rms))
    }
}

impl From<calibration::ModelAccuracy> for ModelAccuracy {
    fn from(found: calibration::ModelAccuracy) -> Self {
        ModelAccuracy {
            position_mm: found.position_mm.into(),
            rotation_deg: found.rotation_deg.map(Into::into),
        }
    }
}

/// Errors of the nominal, registered and calibrated model on one set of rows.
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
}

#[pymethods]
impl SetAccuracy {
    fn __repr__(&self) -> String {
        let [nominal, registered, calibrated] =
            [self.nominal, self.registered, self.calibrated].map(|it| number(it.position_mm.rms));
        format!(
            "<poecal.SetAccuracy of {} rows: nominal {nominal}, registered {registered}, calibrated {calibrated} mm RMS>",
            self.count
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
        }
    }
}

/// Errors on the rows that were fitted and on those that were held out.
#[pyclass(frozen, eq, get_all, module = "poecal", name = "Accuracy")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// On the rows that were fitted.
    training: SetAccuracy,
    /// On the rows that were not; None if none was held out.
    held_out: Option<SetAccuracy>,
}

#[pymethods]
impl Accuracy {
    fn __repr__(&self) -> String {
        let words = |set: &SetAccuracy, name: &str| {
            format!("{} mm RMS on {} {name} rows", number(set.calibrated.position_mm.rms), set.count)
        };
        let held_out = self.held_out.as_ref().map_or_else(String::new, |set| words(set, "held-out") + ", ");
        format!("<poecal.Accuracy: {held_out}{}>", words(&self.training, "fitted"))
    }
}

impl From<calibration::Accuracy> for Accuracy {
    fn from(found: calibration::Accuracy) -> Self {
        Accuracy { training: found.training.into(), held_out: found.held_out.map(Into::into) }
    }
}

/// Verdict: how far a calibration may be used, and why no farther.
#[pyclass(frozen, eq, module = "poecal", name = "Verdict")]
#[derive(Clone, PartialEq)]
pub(crate) struct Verdict(pub(crate) calibration::Verdict);

#[pymethods]
impl Verdict {
    /// "good", "inside_sampled_range" or "do_not_use".
    #[getter]
    fn level(&self) -> &'static str {
        self.0.level.word()
    }

    /// Sentences with the deciding figures.
    #[getter]
    fn reasons(&self) -> Vec<String> {
        self.0.reasons.clone()
    }

    /// Whether a calibration may be used as far as this.
    ///
    /// Parameters
    /// ----------
    /// level
    ///     "good", "inside_sampled_range" or "do_not_use".
    ///
    /// Returns
    /// -------
    /// bool
    ///     Whether the verdict's level is `level` or a better one.
    fn is_at_least(&self, #[pyo3(from_py_with = arg::level)] level: &str) -> PyResult<bool> {
        let levels = [Level::Good, Level::InsideSampledRange, Level::DoNotUse];
        Ok(self.0.level >= chosen("level", level, &levels.map(|level| (level.word(), level)))?)
    }

    fn __repr__(&self) -> String {
        format!("<poecal.Verdict {}: {}>", self.0.level.word(), self.0.reasons.join("; "))
    }

    fn __str__(&self) -> String {
        format!("{}: {}", self.0.level.words(), self.0.reasons.join("; "))
    }
}
