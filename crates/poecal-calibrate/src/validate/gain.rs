//! The gain of a calibration over the nominal model on rows that judge it.

use super::judge::Judgement;
use crate::run::accuracy::Improvement;
use crate::steps::level::Gain;

impl Judgement {
    /// Reason why the measurements show no clear gain over the nominal model; `None` if they do.
    #[must_use]
    pub fn gain_doubt(&self) -> Option<String> {
        let Some(found) = self.improvement else {
            return Some("these rows are too few to compare it with the nominal model".to_owned());
        };
        let Improvement { factor, from, to } = found;
        (found.gain() != Gain::Clear).then(|| {
            format!(
                "on these rows the error of the nominal model is {factor:.2} times that of this one, from {from:.2} to {to:.2} with 95 % confidence"
            )
        })
    }
}
