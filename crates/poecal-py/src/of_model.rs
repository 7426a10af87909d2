//! The model whose errors a row has.

use poecal_calibrate::AcceptedModel;
use pyo3::prelude::*;

use crate::words::choose_word;

/// A model whose errors a row has.
#[derive(Clone, Copy)]
pub(crate) enum ModelSelector {
    Nominal,
    Registered,
    Calibrated,
    Corrected,
}

impl ModelSelector {
    /// The model that a word names, including the delivered one.
    pub(crate) fn from_name(word: &str, delivered: AcceptedModel) -> PyResult<Self> {
        let delivered = match delivered {
            AcceptedModel::Corrected => ModelSelector::Corrected,
            AcceptedModel::Calibrated => ModelSelector::Calibrated,
        };
        let words = [
            ("delivered", delivered),
            ("nominal", ModelSelector::Nominal),
            ("registered", ModelSelector::Registered),
            ("calibrated", ModelSelector::Calibrated),
            ("corrected", ModelSelector::Corrected),
        ];
        choose_word("model", word, &words)
    }

    /// Its error, selected from those of all models; NaN without such a model.
    pub(crate) fn select_error(self, [nominal, registered, calibrated]: [f64; 3], corrected: Option<f64>) -> f64 {
        match self {
            ModelSelector::Nominal => nominal,
            ModelSelector::Registered => registered,
            ModelSelector::Calibrated => calibrated,
            ModelSelector::Corrected => corrected.unwrap_or(f64::NAN),
        }
    }
}
