//! The table of a calibration judged on other measurements.

use std::fmt::Write as _;

use super::table::{STATISTICS, line, number};
use crate::calibration::{Judgement, Kept, ModelAccuracy, Refitted, Statistic};

/// How good a calibration is on measurements that it did not see, as text of lines up to 80 characters. `calibration` and
/// `measurements` name the files.
#[must_use]
pub fn judgement(calibration: &str, measurements: &str, judgement: &Judgement) -> String {
    let mut out = String::new();
    line(&mut out, "calibration", calibration);
    line(&mut out, "measurements", &format!("{} in {measurements}", judgement.count));
    line(&mut out, "refitted", &refitted_words(judgement));
    out.push('\n');
    block(&mut out, "position, mm", judgement, |model| Some(model.position_mm));
    if judgement.calibrated.rotation_deg.is_some() {
        out.push('\n');
        block(&mut out, "rotation, deg", judgement, |model| model.rotation_deg);
    }
    if let Some(kept) = &judgement.promised {
        out.push('\n');
        promise(&mut out, kept, judgement.calibrated.position_mm.rms);
    }
    out
}

fn promise(out: &mut String, kept: &Kept, found_mm: f64) {
    let expected = number(kept.expected_rms_mm);
    line(out, "promised", &format!("{expected} mm (RMS, noise included), found {}", number(found_mm)));
    line(
        out,
        "95 % bounds",
        &format!("{:.1} % of the errors are inside theirs", 100.0 * kept.inside_bound95),
    );
    let sampled = 100.0 * kept.inside_sampled_range;
    line(out, "sampled range", &format!("{sampled:.1} % of the configurations are inside it"));
}

fn refitted_words(judgement: &Judgement) -> String {
    let words = judgement.refitted.iter().map(|part| match part {
        Refitted::DeviceFrame => "device frame",
        Refitted::Tool => "tool",
    });
    let words: Vec<&str> = words.collect();
    if words.is_empty() {
        return "nothing: screws, tool and device frame are the calibration's".to_owned();
    }
    format!("{}: fitted to these measurements, so training for them", words.join(" and "))
}

fn block(
    out: &mut String,
    title: &str,
    judgement: &Judgement,
    of: impl Fn(&ModelAccuracy) -> Option<Statistic>,
) {
    let nominal = judgement.nominal.as_ref().map(|model| ("nominal", model));
    let columns: Vec<_> = nominal.into_iter().chain([("calibrated", &judgement.calibrated)]).collect();
    // Writing to a String cannot fail.
    let _ = write!(out, "{title:<26}");
    for (head, _) in &columns {
        let _ = write!(out, "{head:>14}");
    }
    out.push('\n');
    for (label, value) in STATISTICS {
        let _ = write!(out, "  {label:<24}");
        for (_, model) in &columns {
            let cell = of(model).map_or_else(|| "-".to_owned(), |statistic| number(value(&statistic)));
            let _ = write!(out, "{cell:>14}");
        }
        out.push('\n');
    }
}
