//! Decision whether programs are to be corrected with a calibration.

use poecal_calibrate::{Gain, Level};

use super::CalibrationFile;

impl CalibrationFile {
    /// True if correction is a clear gain; false for files of earlier versions, which do not state it.
    #[must_use]
    pub fn has_clear_gain(&self) -> bool {
        self.verdict.as_ref().is_some_and(|it| it.gain == Some(Gain::Clear)) && self.gain_doubt().is_none()
    }

    /// Sentence with the reason why programs are not to be corrected with this calibration. `None` if correction is a clear gain, or if the file is
    /// of an earlier version, which does not state it.
    #[must_use]
    pub fn gain_doubt(&self) -> Option<String> {
        let why = self.no_gain()?;
        Some(format!("do not correct programs with this calibration: {why}"))
    }

    fn no_gain(&self) -> Option<String> {
        let verdict = self.verdict.as_ref()?;
        match (verdict.level, verdict.gain) {
            (Level::DoNotUse, _) => Some("its verdict is do not use".to_owned()),
            (Level::Located, _) => {
                Some("the axes of the joints were held, so that there is nothing to correct".to_owned())
            }
            (_, None | Some(Gain::Clear)) => None,
            (_, Some(Gain::Unclear | Gain::Loss)) => {
                let figures = verdict.sampled_range_error_mm.zip(verdict.nominal_error_mm);
                let figures = figures.map(|(own, nominal)| {
                    format!(
                        ": an error of {own:.3} mm (RMS) is expected of corrected ones, and the nominal model is {nominal:.3} mm from it"
                    )
                });
                Some(format!(
                    "anywhere inside the sampled range it is not clearly better than the nominal model{}",
                    figures.unwrap_or_default()
                ))
            }
        }
    }
}
