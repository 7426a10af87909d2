//! Sentences on the result of a visit.

use super::visit_result::ChangeExplanation;
use poecal_numerics::error::{Error, ErrorKind};

/// Sentence if too few rows repeat an earlier configuration.
pub(crate) fn few_repeat(repeated: usize, rows: usize) -> String {
    match repeated {
        0 => "none of the rows repeats a configuration of the earlier rows (to 0.1 deg or 0.1 mm): judged by the model"
            .to_owned(),
        some => format!(
            "only {some} of the {rows} rows repeat configurations of the earlier rows, too few to be judged alone: judged by the model"
        ),
    }
}

pub(crate) fn no_uncertainty() -> Error {
    ErrorKind::Model.error(
        "found a calibration without an uncertainty, expected one where rows are judged by the model: measure configurations of the calibration \
         again, or calibrate with more rows",
    )
}

pub(crate) fn level_is_assumed() -> String {
    "the rows of the calibration are not there, or too few, to show how large errors of the model are: 1.5 times what the calibration states is \
     allowed; name them by --reference"
        .to_owned()
}

pub(crate) fn geometry_alone() -> String {
    "the calibration has geometry alone: what the joints do beyond it looks like changes where configurations do not repeat".to_owned()
}

/// Sentence if the rows scatter more than stated, beside an explanation if there is one.
pub(crate) fn describe_wider_scatter(is_stated: bool, is_explained: bool, times: f64) -> String {
    if is_stated && is_explained {
        format!(
            "the explanation is not complete: what it leaves scatters {times:.1} times as much as the stated repeatability, and no zeros of several joints \
             explain it; something else changed too, or the rows are noisier than stated: calibrate anew, or all zeros by `poecal calibrate` with \
             --fix joints --free '*.offset'"
        )
    } else if is_stated {
        format!(
            "the rows scatter {times:.1} times as much as the stated repeatability, and no change explains it: judged by their own scatter"
        )
    } else {
        format!("the rows scatter {times:.1} times as much as the model lets expect: judged by their own scatter")
    }
}

/// Sentence if no single change explains the changes.
pub(crate) fn describe_unexplained(change_m: f64, usual_m: f64, device_is_known: bool) -> String {
    let device = if device_is_known { "if the device was set up anew, state --device refit; " } else { "" };
    format!(
        "the rows are {:.3} mm off (RMS), where errors of the model and noise explain {:.3} mm a coordinate, and no change of one joint, the tool or the \
         device explains the rest: {device}if the calibration is of this robot and this tool, calibrate anew",
        1e3 * change_m,
        1e3 * usual_m
    )
}

/// Sentence if a visit is a copy of the earlier rows.
pub(crate) fn describe_copy() -> String {
    "the rows are those before to the last digit, a copy: nothing was measured anew".to_owned()
}

/// Sentence if a shift exceeds the linear range.
pub(crate) fn describe_far_shift(found: &ChangeExplanation) -> String {
    let name = found.names.first().map(String::as_str).unwrap_or_default();
    format!("the shift of joint `{name}` is beyond 2 deg, where rows are no linear function of it: calibrate anew")
}
