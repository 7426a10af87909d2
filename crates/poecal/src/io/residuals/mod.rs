//! `residuals.csv`: residuals and diagnostics of each measurement.

mod read;
mod source;
mod write;

use std::convert::Infallible;
use std::io::Write;

use crate::calibration::Calibration;
use crate::measurement::Dataset;
use crate::robot::JointKind;
use source::RowSource;
pub use write::ResidualRows;
use write::in_pieces;

/// First columns of every file; a column for each joint reading follows.
const COLUMNS: &str = "file,line,id,set,target,position_nominal[mm],position_registered[mm],position_calibrated[mm],x[mm],y[mm],z[mm],\
     rotation_nominal[deg],rotation_registered[deg],rotation_calibrated[deg],rx[deg],ry[deg],rz[deg],\
     weight,leverage,studentized,suspected";

/// Last column, if there are several instruments.
const INSTRUMENT: &str = "instrument";

/// Errors of one row by the nominal, registered and calibrated model, and the calibrated model's residual by component in the device's
/// axes.
///
/// ```
/// let errors = poecal::io::residuals::ModelErrors { models: [11.2, 10.4, 0.1], residual: [0.1, 0.0, 0.0] };
/// assert_eq!(errors.models[2], errors.residual[0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelErrors {
    /// Of the nominal, registered and calibrated model.
    pub models: [f64; 3],
    /// By component.
    pub residual: [f64; 3],
}

impl ModelErrors {
    /// Of nothing measured.
    pub(crate) const NONE: ModelErrors = ModelErrors { models: [f64::NAN; 3], residual: [f64::NAN; 3] };
}

/// Diagnostics of a row.
///
/// ```
/// let found = poecal::io::residuals::RowDiagnostics { weight: 1.0, leverage: 0.3, studentized: 1.6, suspected: false };
/// assert!(!found.suspected);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowDiagnostics {
    /// Weight in the fit; of a held-out row the weight that it would have had.
    pub weight: f64,
    /// Leverage: mean variance of its prediction in units of its noise.
    pub leverage: f64,
    /// Studentised residual: length of the residual over its own standard deviation.
    pub studentized: f64,
    /// Whether it is suspected of a gross error.
    pub suspected: bool,
}

/// Residuals and diagnostics of one measurement.
///
/// ```
/// use poecal::io::residuals::{ModelErrors, ResidualRow};
/// let position_mm = ModelErrors { models: [11.2, 10.4, 0.1], residual: [0.1, 0.0, 0.0] };
/// let row = ResidualRow { file: 0, line: 3, id: String::new(), held_out: true, target: 0, station: 0, position_mm, rotation_deg: None, judged: None };
/// assert!(row.held_out);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualRow {
    /// Index of its file.
    pub file: usize,
    /// Its line there, from 1.
    pub line: u32,
    /// Its name; empty without one.
    pub id: String,
    /// Whether it was held out.
    pub held_out: bool,
    /// Index of its target.
    pub target: usize,
    /// Index of its instrument; 0 if there is only one.
    pub station: usize,
    /// Errors of position, millimetres.
    pub position_mm: ModelErrors,
    /// Errors of rotation, degrees, where orientation was measured.
    pub rotation_deg: Option<ModelErrors>,
    /// Diagnostics.
    pub judged: Option<RowDiagnostics>,
}

/// Residuals and diagnostics of all measurements, in the order read.
///
/// ```
/// use poecal::calibration::{CalibrationOptions, calibrate};
/// use poecal::io::residuals::Residuals;
/// use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation::default().run(&elbow(), Kind::Point)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let residuals = Residuals::of(&made.data, &calibration);
/// let text = residuals.text();
/// assert_eq!(Residuals::parse(&text, "residuals.csv")?.text(), text);
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Files of the rows, as named by the user.
    pub files: Vec<String>,
    /// The targets' names; the tip's is empty.
    pub targets: Vec<String>,
    /// The instruments' names, if there are several.
    pub stations: Vec<String>,
    /// Names of the joint readings, and whether each is a length (millimetres) or an angle (degrees).
    pub readings: Vec<(String, JointKind)>,
    /// The rows.
    pub rows: Vec<ResidualRow>,
    /// The readings of all rows, one after the other, degrees or millimetres.
    values: Vec<f64>,
}

impl Residuals {
    /// Residuals of a finished calibration.
    #[must_use]
    pub fn of(data: &Dataset, calibration: &Calibration) -> Self {
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
                Ok(())
            },
        );
        all
    }

    /// The readings of a row, degrees or millimetres.
    #[must_use]
    pub fn values(&self, row: usize) -> &[f64] {
        let n = self.readings.len();
        self.values.get(row * n..(row + 1) * n).unwrap_or_default()
    }

    /// Name of a row's file; empty if it has none.
    #[must_use]
    pub fn file(&self, row: &ResidualRow) -> &str {
        self.files.get(row.file).map_or("", String::as_str)
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

/// The unit of a column of readings.
fn unit(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "deg",
        JointKind::Prismatic => "mm",
    }
}
