//! The table of a tool's tip.

use super::hand_eye::{decimals, with_bound};
use super::table::lines;
use poecal_fit::hand_eye::{TouchedTip, TouchedTool};
use poecal_results::tcp::ToolResult;

/// Position of the tip, its bounds, and the judgement, in a sentence.
#[must_use]
pub fn tool_tip_answer(found: &TouchedTool) -> String {
    let tips: Vec<String> = found.tips.iter().map(tip_words).collect();
    format!("{}: {}", found.level.words(), tips.join("; "))
}

/// The position of a tip.
fn tip_words(tip: &TouchedTip) -> String {
    let t = 1e3 * tip.placed.pose.translation;
    let name = if tip.name.is_empty() { String::new() } else { format!("{}: ", tip.name) };
    let bound_mm = 1e3 * tip.placed.bound95_m;
    let digits = decimals(bound_mm);
    format!(
        "{name}({:.digits$}, {:.digits$}, {:.digits$}) mm in the flange; 95 % within {bound_mm:.digits$} mm",
        t.x, t.y, t.z
    )
}

/// The table of a result.
#[must_use]
pub fn tool_tip(result: &ToolResult<'_>) -> String {
    let found = result.found;
    let mut out = String::new();
    let mut say = |label: &str, text: &str| lines(&mut out, label, text.lines());
    let reasons: String = found.reasons.iter().map(|it| format!("\n{it}")).collect();
    let bound = found.tips.iter().map(|it| it.placed.bound95_m).fold(0.0, f64::max);
    say("verdict", &format!("{}{reasons}", with_bound(found.level, "tip", bound)));
    for tip in &found.tips {
        say("tip", &tip_words(tip));
    }
    if let Some((direction, bound)) = &found.axis {
        say(
            "axis",
            &format!(
                "({:.6}, {:.6}, {:.6}) in the flange, from the second tip to the first; 95 % within {:.3} deg",
                direction.x,
                direction.y,
                direction.z,
                bound.to_degrees()
            ),
        );
    }
    let fitted = found.rows.len() - found.outliers.len();
    say(
        "touches",
        &format!(
            "{fitted} of {} fitted; {:.3} mm (RMS) from the point, {:.3} mm each component",
            found.rows.len(),
            1e3 * found.rms_m,
            1e3 * found.sigma_m
        ),
    );
    let is_said = |statement: &String| found.reasons.contains(statement);
    for finding in found.findings.iter().filter(|it| !is_said(&it.statement)) {
        say("look at", &finding.statement);
    }
    for form in result.forms() {
        say(form.maker, &form.text);
    }
    out
}
