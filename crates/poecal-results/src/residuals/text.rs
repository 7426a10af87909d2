//! Residuals of a calibration, and their text.

use std::convert::Infallible;
use std::io::Write;

use super::rows::Residuals;
use super::source::RowSource;
use super::write::{ResidualRows, in_pieces};
use poecal_calibrate::Calibration;
use poecal_model::measurement::Dataset;

impl Residuals {
    /// Residuals of a finished calibration.
    #[must_use]
    pub fn from_calibration(data: &Dataset, calibration: &Calibration) -> Self {
        let source = RowSource::new(data, calibration);
        let mut all = source.rows(0..0);
        all.rows.reserve_exact(data.len());
        all.values.reserve_exact(data.all_readings().len());
        // Nothing can fail here.
        let _: Result<(), Infallible> = in_pieces(
            data.len(),
            |rows| source.rows(rows),
            |some| {
                all.rows.extend(some.rows);
                all.values.extend(some.values);
                some.kinds.into_iter().for_each(|(kind, count)| all.count(kind, count));
                Ok(())
            },
        );
        all
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = Vec::with_capacity(self.rows.len() * 200);
        // Writing to memory cannot fail, and the result is UTF-8.
        let _ = self.write_to(&mut out);
        String::from_utf8(out).unwrap_or_default()
    }

    /// Writes the text of the file in pieces.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write_to(&self, out: &mut (dyn Write + Send)) -> std::io::Result<()> {
        ResidualRows::AtHand(self).write_to(out)
    }
}
