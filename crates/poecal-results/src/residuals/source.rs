//! Rows of a finished calibration, computed in parts.

use std::ops::Range;

use super::{CornerErrors, ModelErrors, ResidualRow, Residuals, RowDiagnostics};
use poecal_calibrate::{Calibration, RowError, RowInfluence, corner_error};
use poecal_fit::state::Estimate;
use poecal_model::measurement::{Dataset, MeasuredQuantities, Quantity};

/// Input for computing any row.
pub(crate) struct RowSource<'a> {
    data: &'a Dataset,
    calibration: &'a Calibration,
    influence: RowInfluence<'a>,
    held_out: Vec<bool>,
    /// The names that all rows share, without rows.
    names: Residuals,
}

impl<'a> RowSource<'a> {
    pub(crate) fn new(data: &'a Dataset, calibration: &'a Calibration) -> Self {
        let mut held_out = vec![false; data.len()];
        for &row in &calibration.held_out_rows {
            held_out[row as usize] = true;
        }
        let readings = data.reading_names().iter();
        let names = Residuals {
            files: data.files.iter().map(|path| path.display().to_string()).collect(),
            targets: calibration.targets.iter().map(|it| it.name.clone().unwrap_or_default()).collect(),
            stations: stations(data),
            readings: readings.map(|name| (name.clone(), calibration.nominal.reading_kind(name))).collect(),
            has_corrected: calibration.correction.is_some(),
            has_corners: !data.pictures.is_empty(),
            further: Quantity::ALL.into_iter().filter(|it| !it.is_of_pose() && data.has(*it)).collect(),
            ..Residuals::default()
        };
        RowSource { data, calibration, influence: RowInfluence::new(calibration, data), held_out, names }
    }

    /// The names of the file, with these rows.
    pub(crate) fn rows(&self, range: Range<usize>) -> Residuals {
        let Calibration { models, robustness, .. } = self.calibration;
        let indices: Vec<u32> = range.filter_map(|row| u32::try_from(row).ok()).collect();
        let session = self.influence.session();
        let errors = |estimate: &Estimate| session.errors(&indices, estimate);
        let [nominal, registered, calibrated] = [&models.nominal, &models.registered, &models.calibrated].map(errors);
        let corrected = self.calibration.correction.as_ref().map(|it| it.errors(self.data, &indices));
        let influences = self.influence.influence_of_rows(&indices);
        let row = |(at, &row): (usize, &u32)| {
            let row = row as usize;
            let observation = &self.data.observations[row];
            let errors = [&nominal[at], &registered[at], &calibrated[at]];
            ResidualRow {
                file: observation.source.file as usize,
                line: observation.source.line,
                id: self.data.ids.get(row).cloned().unwrap_or_default(),
                held_out: self.held_out[row],
                target: observation.target,
                station: observation.station,
                errors: MeasuredQuantities::from_fn(|quantity| {
                    let corrected = corrected.as_ref().map(|all| &all[at]);
                    let length = corrected.and_then(|it| it.length(quantity));
                    let length = length.map(|value| quantity.unit().in_shown_unit(value));
                    Some(errors_of(errors, corrected, quantity)?.with_corrected(length))
                }),
                corners: self.corners(row as u32, errors, corrected.as_ref().map(|all| &all[at])),
                judged: robustness.rows.get(row).map(|found| RowDiagnostics {
                    weight: found.weight,
                    leverage: influences[at].leverage,
                    studentized: influences[at].studentized,
                    suspected: found.suspected,
                }),
            }
        };
        let readings = indices.iter().flat_map(|&row| self.data.readings(row as usize));
        let kinds = self.names.readings.iter().map(|(_, kind)| *kind).cycle();
        let values = readings.zip(kinds).map(|(&value, kind)| kind.in_shown_unit(value)).collect();
        let mut found = Residuals { rows: Vec::with_capacity(indices.len()), values, ..self.names.clone() };
        indices.iter().enumerate().map(row).for_each(|row| found.push(row));
        found
    }

    /// Errors of the corners of a row that is a picture, by the errors of the row by each model.
    fn corners(&self, row: u32, errors: [&RowError; 3], corrected: Option<&RowError>) -> Option<CornerErrors> {
        self.data.pictures.index_of_row(row)?;
        let of = |error: &RowError| corner_error(self.data, row, error);
        let px = |error: &RowError| of(error).map_or(f64::NAN, |it| it.rms_px);
        let at_board_mm = of(corrected.unwrap_or(errors[2])).map_or(f64::NAN, |it| it.rms_mm);
        Some(CornerErrors { models_px: errors.map(px), corrected_px: corrected.map(px), at_board_mm })
    }
}

/// The instruments' names, if there are several.
fn stations(data: &Dataset) -> Vec<String> {
    let names = data.stations.iter().map(|name| name.clone().unwrap_or_default());
    if data.station_count() > 1 { names.collect() } else { Vec::new() }
}

/// Errors of one quantity by the three models, with the residual of the delivered one, in the unit of files, if it was measured.
fn errors_of(errors: [&RowError; 3], corrected: Option<&RowError>, quantity: Quantity) -> Option<ModelErrors> {
    let shown = |value: f64| quantity.unit().in_shown_unit(value);
    errors[2].length(quantity)?;
    let length = |error: &RowError| error.length(quantity).map_or(f64::NAN, shown);
    let delivered = corrected.unwrap_or(errors[2]);
    let (measured, mut residual) = (delivered.measured_components(quantity), delivered.vector(quantity).map(shown));
    residual.iter_mut().zip(measured).filter(|(_, is)| !is).for_each(|(value, _)| *value = f64::NAN);
    let components = residual.as_slice().get(..quantity.components()).unwrap_or_default();
    Some(ModelErrors::new(errors.map(length), components))
}
