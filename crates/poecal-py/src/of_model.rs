//! The model whose errors a row has.

use poecal_calibrate::AcceptedModel;
use pyo3::prelude::*;

use crate::words::chosen;

/// A model whose errors a row has.
#[derive(Clone, Copy)]
pub(crate) enum OfModel {
    Nominal,
    Registered,
    Calibrated,
    Corrected,
}

impl OfModel {
    /// The model that a word names, including the delivered one.
    pub(crate) fn named(word: &str, delivered: AcceptedModel) -> PyResult<Self> {
        let delivered = match delivered {
            AcceptedModel::Corrected => OfModel::Corrected,
            AcceptedModel::Calibrated => OfModel::Calibrated,
        };
        let words = [
            ("delivered", delivered),
            ("nominal", OfModel::Nominal),
            ("registered", OfModel::Registered),
            ("calibrated", OfModel::Calibrated),
            ("corrected", OfModel::Corrected),
        ];
        chosen("model", word, &words)
    }

    /// Its error, selected from those of all models; NaN without such a model.
    pub(crate) fn select_error(self, [nominal, registered, calibrated]: [f64; 3], corrected: Option<f64>) -> f64 {
        match self {
            OfModel::Nominal => nominal,
            OfModel::Registered => registered,
            OfModel::Calibrated => calibrated,
            OfModel::Corrected => corrected.unwrap_or(f64::NAN),
        }
    }
}
