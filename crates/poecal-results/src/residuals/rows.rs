//! Rows of `residuals.csv`, and the names of its columns.

use poecal_model::measurement::{MeasuredQuantities, Quantity};
use poecal_model::robot::ReadingKind;

/// First columns of every file; those of each quantity follow.
pub(crate) const FIRST: [&str; 5] = ["file", "line", "id", "set", "target"];

/// Columns after those of the quantities; a column for each joint reading follows.
pub(crate) const DIAGNOSTICS: [&str; 4] = ["weight", "leverage", "studentized", "suspected"];

/// Models whose errors a row has.
pub(crate) const MODELS: usize = 3;

/// Last column, if there are several instruments.
pub(crate) const INSTRUMENT: &str = "instrument";

/// Errors of one quantity in one row by the nominal, registered and calibrated model, and the delivered model's residual by component, of vectors in
/// the device's axes. Millimetres or degrees. The corrected model is delivered if there is one, else the calibrated one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelErrors {
    /// Errors of the nominal, registered and calibrated model.
    pub models: [f64; MODELS],
    /// Error of the corrected model, if there is one.
    pub corrected: Option<f64>,
    /// Residual by component, NaN for one that was not measured, 0 beyond the quantity's components.
    residual: [f64; Quantity::MOST_COMPONENTS],
    components: usize,
}

impl ModelErrors {
    /// Errors of the three models, and the residual by component, at most [`Quantity::MOST_COMPONENTS`].
    #[must_use]
    pub fn new(models: [f64; MODELS], residual: &[f64]) -> Self {
        let mut all = [0.0; Quantity::MOST_COMPONENTS];
        all.iter_mut().zip(residual).for_each(|(to, from)| *to = *from);
        ModelErrors { models, corrected: None, residual: all, components: residual.len().min(all.len()) }
    }

    /// The same errors with the error of a corrected model.
    #[must_use]
    pub fn with_corrected(self, corrected: Option<f64>) -> Self {
        ModelErrors { corrected, ..self }
    }

    /// The error of the calibrated model.
    #[must_use]
    pub fn calibrated_error(&self) -> f64 {
        self.models[2]
    }

    /// The error of the model that is delivered: the corrected one, if there is one.
    #[must_use]
    pub fn delivered_error(&self) -> f64 {
        self.corrected.unwrap_or(self.models[2])
    }

    /// The delivered model's residual by component, NaN for a component that was not measured.
    #[must_use]
    pub fn residual(&self) -> &[f64] {
        self.residual.get(..self.components).unwrap_or_default()
    }

    /// All numbers, in the order of [`columns`].
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.models.iter().chain(&self.corrected).chain(self.residual()).copied()
    }
}

/// Names of the columns of a quantity: errors of the three models, and of the corrected one if there is one, then the residual of the delivered model
/// by component.
pub fn columns(quantity: Quantity, has_corrected: bool) -> impl Iterator<Item = String> {
    let (name, unit) = (quantity.name(), quantity.unit().symbol());
    let components = quantity.component_names().iter().map(move |component| format!("{component}[{unit}]"));
    model_names(has_corrected).map(move |model| format!("{name}_{model}[{unit}]")).chain(components)
}

/// Errors of the corners of a picture by the nominal, registered and calibrated model; NaN if a model sees none of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerErrors {
    /// Root mean square distance in the picture by each model, pixels.
    pub models_px: [f64; MODELS],
    /// Distance by the corrected model, if there is one.
    pub corrected_px: Option<f64>,
    /// Distance by the delivered model at the board, perpendicular to the ray, millimetres.
    pub at_board_mm: f64,
}

impl CornerErrors {
    /// All numbers, in the order of [`corner_columns`].
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.models_px.iter().chain(&self.corrected_px).chain([&self.at_board_mm]).copied()
    }
}

/// Names of the columns of corners.
pub fn corner_columns(has_corrected: bool) -> impl Iterator<Item = String> {
    model_names(has_corrected).map(|model| format!("corners_{model}[px]")).chain(["corners[mm]".to_owned()])
}

fn model_names(has_corrected: bool) -> impl Iterator<Item = &'static str> {
    ["nominal", "registered", "calibrated"].into_iter().chain(has_corrected.then_some("corrected"))
}

/// Diagnostics of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowDiagnostics {
    /// Weight in the fit; of a held-out row the weight that it would have had.
    pub weight: f64,
    /// Leverage: mean variance of its prediction in units of its noise.
    pub leverage: f64,
    /// Studentised residual: length of the residual over its own standard deviation.
    pub studentized: f64,
    /// True if it is suspected of a gross error.
    pub suspected: bool,
}

/// Residuals and diagnostics of one measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualRow {
    /// Index of its file.
    pub file: usize,
    /// Its line there, from 1.
    pub line: u32,
    /// Its name; empty without one.
    pub id: String,
    /// True if it was held out.
    pub held_out: bool,
    /// Index of its target.
    pub target: usize,
    /// Index of its instrument; 0 if there is only one.
    pub station: usize,
    /// Errors of each measured quantity, millimetres or degrees.
    pub errors: MeasuredQuantities<ModelErrors>,
    /// Errors of the corners of a picture.
    pub corners: Option<CornerErrors>,
    /// Diagnostics.
    pub judged: Option<RowDiagnostics>,
}

/// Residuals and diagnostics of all measurements, in the order read.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_calibrate::{CalibrationOptions, calibrate};
/// #     pub use poecal_results::residuals::Residuals;
/// #     pub use poecal_model::simulate;
/// #     pub use poecal_model::simulate::Simulation;
/// # }
/// use poecal::{CalibrationOptions, calibrate, Residuals, Simulation};
/// use poecal::simulate::{SessionKind, elbow};
/// let made = Simulation::default().run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let residuals = Residuals::from_calibration(&made.data, &calibration);
/// let text = residuals.text();
/// assert_eq!(Residuals::parse(&text, "residuals.csv")?.text(), text);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Files of the rows, as named by the user.
    pub files: Vec<String>,
    /// The targets' names; the tip's is empty.
    pub targets: Vec<String>,
    /// The instruments' names, if there are several.
    pub stations: Vec<String>,
    /// Names of the joint readings, each a length (millimetres) or an angle (degrees).
    pub readings: Vec<(String, ReadingKind)>,
    /// Quantities that were measured beside positions and rotations, which always have their columns; in the order of
    /// [`Quantity::ALL`]. Errors of a quantity without columns are not written.
    pub further: Vec<Quantity>,
    /// True if the rows have errors of a corrected model.
    pub has_corrected: bool,
    /// True if some rows are pictures.
    pub has_corners: bool,
    /// The rows.
    pub(crate) rows: Vec<ResidualRow>,
    /// Sets of measured quantities with their numbers of rows, in the order of the first row of each.
    pub(crate) kinds: Vec<(MeasuredQuantities<()>, usize)>,
    /// The readings of all rows, in sequence, degrees or millimetres.
    pub(crate) values: Vec<f64>,
}

impl Residuals {
    /// The quantities that have columns: position, rotation, and those that were measured beside them.
    pub fn quantities(&self) -> impl Iterator<Item = Quantity> {
        Quantity::ALL.into_iter().filter(|quantity| quantity.is_of_pose() || self.further.contains(quantity))
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> &[ResidualRow] {
        &self.rows
    }

    /// Adds a row; its readings are stored separately.
    pub(crate) fn push(&mut self, row: ResidualRow) {
        self.count(row.errors.map(|_, _| ()), 1);
        self.rows.push(row);
    }

    /// Counts rows that measured the same quantities.
    pub(crate) fn count(&mut self, kind: MeasuredQuantities<()>, count: usize) {
        match self.kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, all)) => *all += count,
            None => self.kinds.push((kind, count)),
        }
    }

    /// Sets of measured quantities with their numbers of rows.
    #[must_use]
    pub fn kinds(&self) -> &[(MeasuredQuantities<()>, usize)] {
        &self.kinds
    }

    /// The quantities that some row measured.
    #[must_use]
    pub fn measured_quantities(&self) -> Vec<Quantity> {
        let has = |quantity: &Quantity| self.kinds.iter().any(|(kind, _)| kind.get(*quantity).is_some());
        Quantity::ALL.into_iter().filter(has).collect()
    }

    /// The first quantity that some row measured, lengths before angles: the one that judges the calibration.
    #[must_use]
    pub fn leading_quantity(&self) -> Option<Quantity> {
        let measured = self.measured_quantities();
        MeasuredQuantities::from_fn(|quantity| measured.contains(&quantity).then_some(()))
            .leading_value()
            .map(|(quantity, ())| quantity)
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
}
