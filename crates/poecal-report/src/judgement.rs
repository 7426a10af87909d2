//! The table of a calibration judged on other measurements.

use super::acceptance;
use super::table::{STATISTICS, WIDTHS, line, lines, number, number_or_dash, pictures_words, row};
use poecal_calibrate::{
    Gain, Improvement, Judgement, Level, ModelAccuracy, QuantityCoverage, RefittedPart, RepeatScatter, Statistic,
};
use poecal_model::measurement::Quantity;

/// Accuracy of a calibration on measurements that it did not use, as text of lines up to 80 characters. `calibration` and `measurements` name the
/// files.
#[must_use]
pub fn judgement(calibration: &str, measurements: &str, judgement: &Judgement) -> String {
    let mut out = String::new();
    lines(&mut out, "verdict", verdict(judgement));
    line(&mut out, "calibration", calibration);
    line(&mut out, "measurements", &format!("{} in {measurements}", judgement.count));
    line(&mut out, "refitted", &refitted_words(judgement));
    if let Some(moved) = judgement.moved_device.filter(|it| it.refitted) {
        let (shift, turn) = (number(moved.shift_mm), number(moved.turn_deg));
        let words = format!("the device stands {shift} mm and {turn} deg from where the calibration has it");
        line(&mut out, "", &words);
    }
    if let Some(found) = judgement.delivered_model().errors.pixels {
        line(&mut out, "corners", &pictures_words(&found));
    }
    out.push('\n');
    for (k, (quantity, _)) in judgement.calibrated.iter().enumerate() {
        if k > 0 {
            out.push('\n');
        }
        let title = format!("{}, {}", quantity.name(), quantity.unit().symbol());
        block(&mut out, &title, judgement, |model| model.get(quantity));
    }
    if let Some(check) = &judgement.promised {
        out.push('\n');
        for (quantity, part) in check.parts.iter() {
            if let Some(found) = judgement.calibrated.get(quantity) {
                coverage(&mut out, "coverage", quantity, &part, found.rms);
            }
        }
        line(&mut out, "sampled range", &range_words(judgement));
    }
    line(&mut out, "gain", &gain_words(judgement));
    if let Some(found) = &judgement.repeats {
        line(&mut out, "repeats", &repeats_words(found));
    }
    if let Some(found) = &judgement.acceptance {
        acceptance::lines(&mut out, found);
    }
    if let Some(model) = judgement.with_terms()
        && let Some(check) = &model.promised
    {
        for (quantity, part) in check.parts.iter() {
            if let Some(found) = model.errors.get(quantity) {
                coverage(&mut out, "corrected", quantity, &part, found.rms);
            }
        }
    }
    out
}

/// The level that the measurements confirm, in words.
pub(crate) fn confirmed_words(level: Option<Level>) -> &'static str {
    match level {
        Some(Level::Good) => "the calibration holds for these measurements",
        Some(Level::Located | Level::MeasuredConfigurations | Level::InsideSampledRange) => {
            "the calibration holds inside the sampled range only"
        }
        Some(Level::DoNotUse) => "the calibration does not hold for these measurements",
        None => "the calibration has no bounds to test",
    }
}

/// Scatter of rows of one configuration.
fn repeats_words(found: &RepeatScatter) -> String {
    let (least, most, unit) = (number(found.smallest), number(found.largest), found.quantity.unit().symbol());
    let range = if found.poses > 1 { format!("{least} to {most}") } else { most };
    let poses =
        if found.poses == 1 { "one configuration".to_owned() } else { format!("{} configurations", found.poses) };
    format!("scatter by {range} {unit} (repeatability of {poses}, {} rows)", found.rows)
}

/// Ratio of the nominal model's errors to the delivered ones on these rows.
fn gain_words(judgement: &Judgement) -> String {
    let Some(found) = judgement.improvement else {
        return "not known: too few rows to fit device frame and targets to them".to_owned();
    };
    let Improvement { factor, from, to } = found;
    format!(
        "{}the error of the nominal model is {factor:.2} times this one's ({from:.2} to {to:.2}), device frame and targets fitted for both",
        before_factor(found.gain())
    )
}

/// The judgement of a gain before its factor; empty for a clear one.
pub(crate) fn before_factor(gain: Gain) -> &'static str {
    match gain {
        Gain::Clear => "",
        Gain::Unclear => "no clear gain: ",
        Gain::Loss => "a loss: ",
    }
}

/// The verdict with its one figure, and the reasons against a better one.
fn verdict(judgement: &Judgement) -> Vec<String> {
    let (_, reasons) = judgement.confirmed_level();
    std::iter::once(describe_judgement(judgement)).chain(reasons).collect()
}

/// The level that the measurements confirm, with the error of the delivered model beside the expected one, in a sentence.
#[must_use]
pub fn describe_judgement(judgement: &Judgement) -> String {
    let (level, _) = judgement.confirmed_level();
    let delivered = judgement.delivered_model();
    let figure = delivered.errors.leading_value().map(|(quantity, found)| {
        let part = delivered.promised.and_then(|it| it.parts.get(quantity));
        let expected = part.map(|it| format!(", expected {}", number(it.expected_rms)));
        let (rms, unit, model) = (number(found.rms), quantity.unit().symbol(), delivered.model.word());
        format!(": {rms} {unit} (RMS) of the {model} model{}", expected.unwrap_or_default())
    });
    format!("{}{}", confirmed_words(level), figure.unwrap_or_default())
}

fn coverage(out: &mut String, label: &str, quantity: Quantity, check: &QuantityCoverage, found: f64) {
    let (what, unit) = (quantity.name(), quantity.unit().symbol());
    let words = format!(
        "{what}: {:.1} % of the errors are inside their 95 % bounds; {} {unit} (RMS), expected {} with measurement noise",
        100.0 * check.inside_bound95,
        number(found),
        number(check.expected_rms)
    );
    line(out, label, &words);
}

fn range_words(judgement: &Judgement) -> String {
    let Some(some) = &judgement.in_sampled_range else {
        return "none of the rows lies inside it, so they do not test it".to_owned();
    };
    if some.count == judgement.count {
        return "all rows lie inside it".to_owned();
    }
    let share = 100.0 * some.promised.parts.lead().inside_bound95;
    let leading = some.calibrated.leading_value().map_or(Quantity::Position, |(quantity, _)| quantity);
    let (rms, what, unit) = (number(some.calibrated.lead().rms), leading.name(), leading.unit().symbol());
    format!(
        "{} of {} rows {} inside it: {what} error {rms} {unit} (RMS), {share:.1} % inside the bounds",
        some.count,
        judgement.count,
        if some.count == 1 { "lies" } else { "lie" }
    )
}

fn refitted_words(judgement: &Judgement) -> String {
    match refitted_parts(judgement).as_str() {
        "" => "nothing: screws, tool and device frame are the calibration's".to_owned(),
        parts => format!("{parts}: fitted to these measurements, so training for them"),
    }
}

/// The refitted parts; empty if there are none.
pub(crate) fn refitted_parts(judgement: &Judgement) -> String {
    let words = judgement.refitted.iter().map(|part| match part {
        RefittedPart::DeviceFrame => "device frame",
        RefittedPart::Tool => "tool",
    });
    words.collect::<Vec<_>>().join(" and ")
}

/// The models that were judged, by their names.
pub(crate) fn judged_models(judgement: &Judgement) -> Vec<(&'static str, &ModelAccuracy)> {
    let nominal = judgement.nominal.as_ref().map(|model| ("nominal", model));
    let corrected = judgement.with_terms().map(|model| ("corrected", &model.errors));
    nominal.into_iter().chain([("calibrated", &judgement.calibrated)]).chain(corrected).collect()
}

fn block(out: &mut String, title: &str, judgement: &Judgement, of: impl Fn(&ModelAccuracy) -> Option<Statistic>) {
    let columns = judged_models(judgement);
    row(out, title, WIDTHS, columns.iter().map(|(head, _)| head));
    for (label, _, value) in STATISTICS {
        let cells = columns.iter().map(|(_, model)| number_or_dash(of(model).map(value)));
        row(out, &format!("  {label}"), WIDTHS, cells);
    }
}
