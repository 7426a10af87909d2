//! A visit with the reference of its judgement.

use std::borrow::Cow;

use super::explain::{NoiseLevel, ProjectedChanges};
use super::hypotheses::find_free_columns;
use super::model::VisitModel;
use super::options::{JudgingBasis, TrackOptions};
use super::pairs::VisitChanges;
use super::visit::Visit;
use super::{by_model, visit_sentences};
use crate::calibration_file::CalibrationFile;
use poecal_model::measurement::Dataset;
use poecal_numerics::error::Result;

/// Degrees of freedom beside the free unknowns that repeated rows must have, to be judged alone.
const FREEDOM: f64 = 3.0;
/// Ratio of the error to that of the calibration itself above which the device has moved.
const MUCH: f64 = 3.0;

/// Earlier rows.
#[derive(Clone, Copy, Debug)]
pub struct Baseline<'a> {
    /// The rows.
    pub data: &'a Dataset,
    /// True if they are the rows of the calibration itself: from before joints were recalibrated.
    pub is_own: bool,
}

impl<'a> Baseline<'a> {
    /// The rows; for the calibration's own rows, without those that it suspects.
    #[must_use]
    pub fn kept_rows(&self, file: &CalibrationFile) -> Cow<'a, Dataset> {
        let rows = self.is_own.then(|| file.kept_rows(self.data)).filter(|rows| rows.len() < self.data.len());
        rows.map_or(Cow::Borrowed(self.data), |rows| Cow::Owned(self.data.select_rows(&rows)))
    }
}

/// A visit about the model, its changes, and the level of their noise.
pub(crate) struct JudgedVisit {
    pub(crate) model: VisitModel,
    pub(crate) data: Dataset,
    pub(crate) visit: Visit,
    pub(crate) changes: VisitChanges,
    pub(crate) level: NoiseLevel,
    pub(crate) judged_by: JudgingBasis,
    pub(crate) repeated: usize,
    pub(crate) notes: Vec<String>,
}

impl JudgedVisit {
    /// Judgement of the rows of a visit: compared with earlier ones if enough of them repeat, otherwise with the model.
    pub(crate) fn from_rows(
        file: &CalibrationFile,
        data: &Dataset,
        earlier: Option<Baseline<'_>>,
        options: &TrackOptions,
    ) -> Result<Self> {
        let model = VisitModel::from_calibration(file, options)?;
        let data = file.at_stage(data, file.stages()).into_owned();
        let visit = Visit::from_measurements(&model, &data, options.device_is_known, options)?;
        let before = earlier.map(|it| judge_earlier_visit(file, &model, it, options)).transpose()?;
        let earlier = before.as_ref().map(|(visit, data)| (visit, data));
        let mut notes = Vec::new();
        let pairs = earlier.and_then(|earlier| {
            VisitChanges::from_visits((&visit, &data), earlier, &model.robot, options.tool_is_anew)
        });
        let repeated = pairs.as_ref().map_or(0, |it| it.rows.len());
        let is_enough = |it: &VisitChanges| {
            ProjectedChanges::new(&it.residual, &find_free_columns(&it.jacobian, &visit, options)).remaining_squares().1
                >= FREEDOM
        };
        let (judged_by, changes, level) = match pairs.filter(is_enough) {
            Some(pairs) => {
                let level = match options.repeatability_m {
                    Some(_) => NoiseLevel::Known(1.0),
                    None => NoiseLevel::Found(pairs.scatter.0, pairs.scatter.1),
                };
                (JudgingBasis::Repeats, pairs, level)
            }
            None => {
                if earlier.is_some() {
                    notes.push(visit_sentences::few_repeat(repeated, data.len()));
                }
                let count = data.configurations(&data.all_rows()).len();
                let changes = by_model::changes(&model, &visit, &data).ok_or_else(visit_sentences::no_uncertainty)?;
                let (level, is_found) = by_model::level(&model, earlier, count, options)?;
                notes.extend((!is_found).then(visit_sentences::level_is_assumed));
                notes.extend((!model.is_corrected).then(visit_sentences::geometry_alone));
                (JudgingBasis::Model, changes, level)
            }
        };
        Ok(JudgedVisit { model, data, visit, changes, level, judged_by, repeated, notes })
    }
}

/// The earlier visit, about the model of its rows.
fn judge_earlier_visit(
    file: &CalibrationFile,
    model: &VisitModel,
    earlier: Baseline<'_>,
    options: &TrackOptions,
) -> Result<(Visit, Dataset)> {
    let data = file.at_stage(&earlier.kept_rows(file), file.stages()).into_owned();
    let same_tool = TrackOptions { tool_is_anew: false, ..*options };
    if !earlier.is_own || file.recalibrated.is_empty() {
        return Ok((earlier_visit(model, &data, &same_tool)?, data));
    }
    let model = VisitModel::from_calibration(&file.before_repairs()?, options)?;
    Ok((earlier_visit(&model, &data, &same_tool)?, data))
}

/// The earlier visit: with the devices of the calibration, if it has them; otherwise with fitted ones.
pub(crate) fn earlier_visit(model: &VisitModel, data: &Dataset, options: &TrackOptions) -> Result<Visit> {
    match Visit::from_measurements(model, data, true, options) {
        Ok(found) if found.rms() < MUCH * model.own_m() => Ok(found),
        _ => Visit::from_measurements(model, data, false, options),
    }
}
