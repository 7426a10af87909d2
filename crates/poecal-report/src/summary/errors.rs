//! The decisive errors: of rows that were not fitted, before and after.

use super::super::fitted_cameras::found_words;
use super::super::table::{
    STATISTICS, corner_words, further_words, line, lines, number, number_or_dash, pictures_words, row,
};
use super::review_points::reasons;
use super::{Expectation, expected_summary};
use poecal_calibrate::{
    AcceptedLimit, AcceptedStatistic, DeviceFrameKnowledge, FEWEST_HELD_OUT, Level, ModelAccuracy, SetAccuracy,
};
use poecal_model::measurement::Quantity;
use poecal_results::calibration_file::CalibrationFile;

/// Widths of the label and of each figure.
const WIDTHS: [usize; 2] = [38, 10];

/// The errors of a model: its words, the errors, and their key in `calibration.json`.
pub(crate) type ModelRow<'a> = (String, &'a ModelAccuracy, String);

/// The rows that a calibration is judged by, and the errors of the models on them.
pub(crate) struct LeadingRows<'a> {
    pub(crate) set: &'a SetAccuracy,
    pub(crate) models: Vec<ModelRow<'a>>,
    /// Words after the name of the rows: the rows that are left out.
    pub(crate) without: String,
    /// Other rows that are shown beside them, and the errors of the same models on these.
    pub(crate) beside: Option<(String, Vec<ModelRow<'a>>)>,
}

impl<'a> LeadingRows<'a> {
    /// For rows held out all of them, with those that are not suspected beside them. For fitted rows, if none was held out, those that are not
    /// suspected, as in cross-validation, with all beside them.
    pub(crate) fn from_calibration(file: &'a CalibrationFile) -> Self {
        let (accuracy, robust) = (&file.accuracy, &file.robust);
        let training = (&accuracy.training, "accuracy.training");
        let rest = robust.without_suspected.training.as_ref();
        let rest = rest.map(|rest| (rest, "robust.without_suspected.training"));
        let all = String::new();
        let ((set, key), without, beside) = match &accuracy.held_out {
            Some(set) => {
                let rest = robust.without_suspected.held_out.as_ref();
                let words = format!("without {} suspected", robust.suspected.held_out);
                let beside = rest.map(|rest| (words, (rest, "robust.without_suspected.held_out")));
                ((set, "accuracy.held_out"), all, beside)
            }
            None => rest.map_or((training, all, None), |rest| {
                let [without, with] =
                    [" without", "with"].map(|it| format!("{it} {} suspected", robust.suspected.training));
                (rest, without, Some((with, training)))
            }),
        };
        let beside = beside.map(|(words, (set, key))| (words, models_of(file, set, key)));
        LeadingRows { set, models: models_of(file, set, key), without, beside }
    }

    /// Before and after: the first and the last model.
    pub(crate) fn ends(&self) -> Option<[&ModelRow<'a>; 2]> {
        let [before, .., after] = self.models.as_slice() else { return None };
        Some([before, after])
    }

    /// All models, and the calibrated one on the rows beside.
    pub(crate) fn rows(&self) -> Vec<ModelRow<'a>> {
        let beside = self.beside.iter().filter_map(|(words, models)| {
            let (name, model, key) = models.get(1)?;
            Some((format!("{name}, {words}"), *model, key.clone()))
        });
        self.models.iter().cloned().chain(beside).collect()
    }
}

/// The errors of the models that are shown, for a set by its key.
fn models_of<'a>(file: &CalibrationFile, set: &'a SetAccuracy, key: &str) -> Vec<ModelRow<'a>> {
    let holds = |kind: &str| {
        let is_of = |name: &String| name == kind || name.starts_with(&format!("{kind}."));
        file.blocks.as_ref().is_some_and(|blocks| blocks.held.iter().any(is_of))
    };
    let nominal = match file.measurement_frame.known {
        DeviceFrameKnowledge::Unknown | DeviceFrameKnowledge::Base if holds("target") || holds("frame") => {
            "your model, registered by what is free"
        }
        DeviceFrameKnowledge::Unknown => "your model, tool and device located",
        DeviceFrameKnowledge::Base => "your model, tool located",
    };
    let corrected = set.corrected.as_ref().filter(|_| has_terms(file));
    let models = [
        (nominal, "registered", Some(&set.registered)),
        ("calibrated", "calibrated", Some(&set.calibrated)),
        ("corrected", "corrected", corrected),
    ];
    let row = |(name, word, model): (&str, &str, Option<&'a ModelAccuracy>)| {
        Some((name.to_owned(), model?, format!("{key}.{word}")))
    };
    models.into_iter().filter_map(row).collect()
}

/// True if the corrected model has terms: otherwise it is the calibrated one.
pub(crate) fn has_terms(file: &CalibrationFile) -> bool {
    file.corrected.as_ref().is_some_and(|it| it.has_terms())
}

/// The rows on which the errors before and after were measured.
pub(crate) fn judged_on(file: &CalibrationFile) -> String {
    let LeadingRows { set, without, .. } = LeadingRows::from_calibration(file);
    let rows = if set.calibrated.of_pictures(set.count).is_some() { "pictures" } else { "rows" };
    if file.accuracy.held_out.is_some() { format!("{rows} held out") } else { format!("fitted {rows}{without}") }
}

/// An error of the delivered model on rows that were left out of its fits.
pub(crate) struct CrossValidated {
    pub(crate) quantity: Quantity,
    /// Error (RMS), millimetres or degrees.
    pub(crate) rms: f64,
    /// Its key in `calibration.json`.
    pub(crate) key: String,
}

/// Cross-validation error of the delivered model; for a corrected one, with parts of the range left out.
pub(crate) fn cross_validated(file: &CalibrationFile) -> Option<CrossValidated> {
    if let Some(found) = file.corrected.as_ref().filter(|_| has_terms(file)) {
        let (quantity, key) = (Quantity::Position, "corrected.left_out_position_mm".to_owned());
        return found.left_out_position_mm.map(|rms| CrossValidated { quantity, rms, key });
    }
    let (quantity, rms) = file.cross_validation.as_ref()?.random.rms.leading_value()?;
    Some(CrossValidated { quantity, rms, key: format!("cross_validation.random.rms.{}", quantity.key()) })
}

/// Reason why the expected error is larger than the measured one, if it is.
pub(crate) fn why_larger(file: &CalibrationFile) -> Option<&'static str> {
    let leading = LeadingRows::from_calibration(file);
    let [_, (_, after, _)] = leading.ends()?;
    let measured_mm = after.get(Quantity::Position)?.rms;
    (expected_summary(file)?.error_mm > measured_mm).then_some(
        "The expected error is larger than the measured one: it counts every residual that no stated noise explains as robot error, and it \
         allows for joint effects that these rows leave open.",
    )
}

/// Errors before and after on the same rows, the expected error, and its domain.
pub(crate) fn figures(out: &mut String, file: &CalibrationFile) {
    let leading = LeadingRows::from_calibration(file);
    let (Some([before, after]), set) = (leading.ends(), leading.set) else { return };
    let held_out = file.accuracy.held_out.is_some();
    let judging = if held_out { "held out" } else { "fitted" };
    let words = |model: &ModelAccuracy| {
        if let Some(pixels) = model.of_pictures(set.count) {
            return corner_words(&pixels);
        }
        let each = model.iter().map(|(quantity, error)| {
            format!("{} {}{}", number(error.rms), quantity.unit().symbol(), further_words(quantity))
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let on = judged_on(file);
    line(out, "before", &format!("{} (RMS) on {on}: {}", words(before.1), before.0));
    line(out, "after", &format!("{} (RMS) on {on}: {} model", words(after.1), after.0));
    if let Some(expectation) = expected_summary(file) {
        say_expected(out, file, expectation);
    }
    let largest = after
        .1
        .leading_value()
        .map(|(quantity, error)| format!(", at most {} {}", number(error.max), quantity.unit().symbol()));
    let beside = leading.beside.as_ref().and_then(|(of, models)| {
        let (_, model, _) = models.get(1)?;
        Some(format!("; {of}: {}", words(model)))
    });
    let beside = beside.unwrap_or_default();
    match after.1.of_pictures(set.count) {
        Some(pixels) => {
            line(out, judging, &format!("{}{beside}", pictures_words(&pixels)));
        }
        None => {
            let largest = largest.unwrap_or_default();
            line(out, judging, &format!("{} rows{largest}{beside}", set.count));
        }
    }
    if let (Some(before), Some(after), None) = (before.1.pixels, after.1.pixels, after.1.of_pictures(set.count)) {
        let (was, is, mm) = (number(before.rms_px), number(after.rms_px), number(after.rms_mm));
        let words = format!("{was} px before, {is} px after (RMS), {mm} mm at the board square to the ray");
        line(out, "corners", &words);
    }
    lines(out, "found", found_words(file));
    if !held_out {
        let validated = cross_validated(file).map_or_else(String::new, |it| {
            format!("; cross-validation {} {} (RMS)", number(it.rms), it.quantity.unit().symbol())
        });
        line(out, "", &format!("{}{validated}", none_held_out(file)));
    }
}

/// Note that no row was held out; with few configurations also the reason.
pub(crate) fn none_held_out(file: &CalibrationFile) -> String {
    file.accuracy.few_configurations.map_or_else(
        || "no row was held out".to_owned(),
        |count| {
            format!("all {count} configurations were fitted, since fewer than {FEWEST_HELD_OUT} would judge (--held-out 0.3 holds them out)")
        },
    )
}

/// The expected error, and its domain.
fn say_expected(out: &mut String, file: &CalibrationFile, expectation: Expectation) {
    let Expectation { error_mm, bound_mm, inside_mm, nominal_mm, anywhere } = expectation;
    let (error, bound) = (number(error_mm), number(bound_mm));
    let is_exceeded = |limit: &AcceptedLimit| {
        limit.quantity == Quantity::Position.name()
            && limit.statistic == AcceptedStatistic::Rms
            && limit.to.is_some_and(|to| to < error_mm)
    };
    // The bounds of a limit are those of measured errors.
    let why = if file.acceptance.as_ref().is_some_and(|it| it.limits.iter().any(is_exceeded)) {
        "; above the upper bound of the measured error, since unexplained residuals count as robot error"
    } else {
        ""
    };
    let here = if inside_mm.is_some() { "near measured configurations" } else { "of predictions" };
    let expected = format!("{error} mm (RMS) {here}, 95 % below {bound} mm{why}");
    let nominal = nominal_mm.map(|it| format!(" (your model: {} mm)", number(it)));
    let inside = inside_mm
        .map(|it| format!("{} mm anywhere inside the sampled range{}", number(it), nominal.unwrap_or_default()));
    lines(out, "expected", [Some(expected), inside].into_iter().flatten());
    let place = match file.verdict.as_ref().map(|it| it.level) {
        Some(Level::Located) => "for the positions of targets and devices",
        Some(Level::MeasuredConfigurations) => "in configurations like those measured",
        Some(Level::DoNotUse | Level::InsideSampledRange | Level::Good) | None => "inside the sampled range",
    };
    let valid = match (anywhere, reasons(file).into_iter().next()) {
        (Some((sigma, _)), _) => {
            format!("anywhere within the limits, {} mm (RMS) expected there", number(sigma))
        }
        (None, Some(reason)) => format!("{place}: {reason}"),
        (None, None) => place.to_owned(),
    };
    line(out, "valid", &valid);
}

/// Mean, RMS, 95 % and maximum of the errors of the rows held out, or else of those fitted.
pub(crate) fn table(out: &mut String, file: &CalibrationFile) {
    let leading = LeadingRows::from_calibration(file);
    let (set, rows) = (leading.set, leading.rows());
    let name = if file.accuracy.held_out.is_some() { "held out" } else { "fitted" };
    for (quantity, _) in set.calibrated.iter() {
        let title = format!("{name} ({}), {} in {}", set.count, quantity.name(), quantity.unit().symbol());
        row(out, &title, WIDTHS, STATISTICS.map(|(label, ..)| label));
        for (label, model, _) in &rows {
            let cells = STATISTICS.map(|(.., value)| number_or_dash(model.get(quantity).map(value)));
            row(out, &format!("  {label}"), WIDTHS, cells);
        }
    }
    if file.accuracy.held_out.is_none() {
        line(out, "", "no row was held out: these errors are of fitted rows");
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::{Detail, summary};
    use super::*;
    use poecal_calibrate::{CalibrationOptions, calibrate};
    use poecal_model::simulate::{GrossErrors, SessionKind, Simulation, elbow};
    use poecal_results::calibration_file::Inputs;

    /// All of thirty poses are fitted: the stated errors before and after exclude the one with a large deviation.
    #[test]
    fn suspected_rows_do_not_count_where_none_is_held_out() {
        let mut made = Simulation { count: 30, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap();
        let gross = GrossErrors { share: 0.04, ..GrossErrors::default() }.spoil(&mut made.data).len();
        let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
        let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
        assert!(file.accuracy.held_out.is_none() && (gross, file.robust.suspected.training) == (1, 1));
        let leading = LeadingRows::from_calibration(&file);
        let [before, after] = leading.ends().unwrap();
        let rms = |model: &ModelAccuracy| model.get(Quantity::Position).unwrap().rms;
        let all = &file.accuracy.training;
        assert!(leading.set.count == 29 && rms(&all.calibrated) > 50.0 * rms(after.1), "{after:?}");
        assert!(rms(before.1) < rms(&all.registered));
        let text = summary(&file, Detail::Full);
        assert!(text.contains("(RMS) on fitted rows without 1 suspected:"), "{text}");
        assert!(text.contains("29 rows, at most") && text.contains("; with 1 suspected:"), "{text}");
    }
}
