//! Appearance of objects in notebooks, as HTML.

use maud::{Markup, html};
use poecal_calibrate::AcceptedModel;
use poecal_model::measurement::Quantity;
use poecal_model::robot::{Joint, JointKind, Robot};
use poecal_numerics::text::visible_markup;
use poecal_numerics::unit::Unit;
use poecal_results::calibration_file::CalibrationFile;

/// A robot's joints.
pub(crate) fn robot(robot: &Robot, words: &str) -> String {
    let ends = |joint: &Joint| {
        let (factor, unit) = match joint.kind {
            JointKind::Revolute => (1f64.to_degrees(), "°"),
            JointKind::Prismatic => (1e3, " mm"),
        };
        let ends = [joint.limits.map(|limits| limits.lower), joint.limits.map(|limits| limits.upper)];
        ends.map(|end| end.map_or("none".to_owned(), |end| format!("{:.1}{unit}", end * factor)))
    };
    visible_markup(html! {
        div {
            p { (words) }
            table {
                tr { @for name in ["joint", "kind", "lower", "upper", "direction"] { th { (name) } } }
                @for joint in &robot.joints {
                    @let [x, y, z]: [f64; 3] = joint.screw.direction().into();
                    tr {
                        td { (joint.name) }
                        td { (joint.kind.word()) }
                        @for end in ends(joint) { td { (end) } }
                        td { (format_args!("({x:.4}, {y:.4}, {z:.4})")) }
                    }
                }
            }
        }
    })
}

/// Measurements and the names of their sources.
pub(crate) fn measurements(words: &str, names: &[String], warnings: &[String]) -> String {
    visible_markup(html! { div { p { (words) ", from " (names.join(", ")) } (warning_markup(warnings)) } })
}

/// Findings as the program prints them.
pub(crate) fn findings(text: &str, warnings: &[String]) -> String {
    visible_markup(html! { div { pre { (text) } (warning_markup(warnings)) } })
}

/// A calibration's verdict and errors; those of the corrected model if it is delivered.
pub(crate) fn calibration(file: &CalibrationFile, delivered: AcceptedModel, warnings: &[String]) -> String {
    let is_corrected = delivered == AcceptedModel::Corrected;
    let corrected = is_corrected.then_some("corrected");
    let columns = ["error (RMS)", "rows", "nominal", "registered", "calibrated"].into_iter().chain(corrected);
    let fitted = ("fitted", &file.accuracy.training);
    let sets = std::iter::once(fitted).chain(file.accuracy.held_out.iter().map(|set| ("held out", set)));
    visible_markup(html! {
        div {
            @if let Some(verdict) = &file.verdict {
                p { (file.robot.name) ": " (verdict.level.words()) " (" (verdict.reasons.join("; ")) ")" }
            }
            table {
                tr { @for name in columns { th { (name) } } }
                @for (name, set) in sets {
                    @let corrected = set.corrected.as_ref().filter(|_| is_corrected);
                    @let models = [&set.nominal, &set.registered, &set.calibrated].into_iter().chain(corrected);
                    @for (quantity, _) in set.calibrated.iter() {
                        tr {
                            td { (quantity.name()) ", " (name) } td { (set.count) }
                            @for found in models.clone().filter_map(|model| model.get(quantity)) {
                                td { (format_args!("{:.4}{}", found.rms, sign(quantity))) }
                            }
                        }
                    }
                }
            }
            (warning_markup(warnings))
        }
    })
}

/// The unit of a quantity behind a number.
fn sign(quantity: Quantity) -> &'static str {
    match quantity.unit() {
        Unit::Metre => " mm",
        Unit::Radian => "°",
        Unit::One | Unit::Second => "",
    }
}

fn warning_markup(warnings: &[String]) -> Markup {
    html! { @for warning in warnings { p { "warning: " (warning) } } }
}
