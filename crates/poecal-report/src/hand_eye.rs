//! The table of a hand-eye calibration.

use super::table::lines;
use poecal_fit::hand_eye::{FoundLens, FrameEstimate, HandEye, HandEyeLevel};
use poecal_model::camera::PictureNumber;
use poecal_results::frame_texts::NamedFrame;
use poecal_results::hand_eye::{ArmByJoints, HandEyeResult};
use poecal_results::lens_entries::lens_number_name;

/// Pose of the camera, its bounds, and the judgement, in a sentence.
#[must_use]
pub fn hand_eye_answer(result: &HandEyeResult<'_>) -> String {
    let [(frame, placed), _] = result.frames();
    format!("{}: {}", result.found.level.words(), in_parent(&frame, &placed))
}

/// A level with the bound of the result, unless nothing holds.
pub(crate) fn with_bound(level: HandEyeLevel, what: &str, bound_m: f64) -> String {
    match level {
        HandEyeLevel::DoNotUse => level.words().to_owned(),
        HandEyeLevel::Good | HandEyeLevel::WithinBounds => {
            let bound_mm = 1e3 * bound_m;
            format!("{}: {what} within {bound_mm:.*} mm (95 %)", level.words(), decimals(bound_mm))
        }
    }
}

/// Number of decimals that resolve two digits of an uncertainty.
pub(crate) fn decimals(uncertainty: f64) -> usize {
    let first = if uncertainty > 0.0 { uncertainty.log10().floor() } else { 0.0 };
    (1.0 - first).clamp(0.0, 9.0) as usize
}

/// Pose of a frame in its parent, with its bounds.
fn in_parent(frame: &NamedFrame, placed: &FrameEstimate) -> String {
    let t = 1e3 * frame.pose.translation;
    let (bound_mm, bound_deg) = (1e3 * placed.bound95_m, placed.bound95_rad.to_degrees());
    format!(
        "{} in {}: ({:.3}, {:.3}, {:.3}) mm; 95 % within {bound_mm:.3} mm and {bound_deg:.4} deg",
        frame.child, frame.parent, t.x, t.y, t.z
    )
}

/// The table of a result.
#[must_use]
pub fn hand_eye(result: &HandEyeResult<'_>) -> String {
    let found = result.found;
    let mut out = String::new();
    let mut say = |label: &str, text: &str| lines(&mut out, label, text.lines());
    let reasons: String = found.reasons.iter().map(|it| format!("\n{it}")).collect();
    say("verdict", &format!("{}{reasons}", with_bound(found.level, "camera", found.camera_frame().bound95_m)));
    let [camera, target] = result.frames();
    for (label, (frame, placed)) in [("camera", &camera), ("target", &target)] {
        say(label, &place(frame, placed));
    }
    say("ROS 2", &camera.0.static_transform_publisher());
    if let Some(held_out) = &found.held_out {
        say(
            "held out",
            &format!(
                "{:.3} mm, {:.4} deg (RMS): each of {} poses predicted by the others",
                1e3 * held_out.rms_m,
                held_out.rms_rad.to_degrees(),
                held_out.rows
            ),
        );
    }
    if let Some(lens) = &found.lens {
        say("lens", &lens_words(lens));
    }
    say("noise", &noise(found));
    let fitted = found.rows.iter().filter(|it| it.is_fitted).count();
    say("poses", &format!("{fitted} of {} fitted; {}", found.rows.len(), found.directions.words()));
    if let Some(arm) = result.arm {
        say("arm", &arm_words(arm));
    }
    for finding in found.findings.iter().filter(|it| !found.reasons.contains(&it.statement)) {
        say("look at", &finding.statement);
    }
    out
}

/// The numbers of a lens that was fitted, each with its standard deviation.
fn lens_words(lens: &FoundLens) -> String {
    let number = |it: &PictureNumber| {
        let decimals = decimals(it.deviation);
        format!("{} {:.decimals$} ± {:.decimals$}", lens_number_name(it), it.found, it.deviation)
    };
    let of = |unit: &str| -> Vec<String> { lens.numbers.iter().filter(|it| it.unit == unit).map(number).collect() };
    let bend = of("mm");
    let bend = if bend.is_empty() { String::new() } else { format!("; board: {} mm", bend.join(", ")) };
    format!("{} px; {}{bend} (± standard deviation)", of("px").join(", "), of("").join(", "))
}

/// The arm model that predicts poses better, and the command that fits it.
fn arm_words(arm: &ArmByJoints) -> String {
    let command = &arm.command;
    match &arm.errors {
        Ok(errors) => {
            let of = |(mm, deg): (f64, f64)| format!("{mm:.3} mm, {deg:.4} deg");
            let (held, fitted, rows) = (of(errors.held), of(errors.fitted), errors.rows);
            if errors.is_better() {
                format!(
                    "fitted with the camera it predicts {rows} other poses {:.1} times better: {fitted} (RMS) instead of {held} as it is:\n{command}",
                    errors.gain()
                )
            } else {
                format!(
                    "as it is, it predicts {rows} other poses to {held} (RMS); fitted with the camera, to {fitted}: hold it"
                )
            }
        }
        Err(reason) => format!("as it is; it was not fitted with the camera: {reason}"),
    }
}

fn place(frame: &NamedFrame, placed: &FrameEstimate) -> String {
    let t = 1e3 * frame.pose.translation;
    let [qx, qy, qz, qw] = frame.pose.quaternion_xyzw();
    format!(
        "{} in {}: ({:.3}, {:.3}, {:.3}) mm, quaternion x y z w ({qx:.6}, {qy:.6}, {qz:.6}, {qw:.6}); 95 % within {:.3} mm and {:.4} deg",
        frame.child,
        frame.parent,
        t.x,
        t.y,
        t.z,
        1e3 * placed.bound95_m,
        placed.bound95_rad.to_degrees()
    )
}

/// Scatter of the camera's poses.
fn noise(found: &HandEye) -> String {
    let [across, along, tilt, turn] = found.noise;
    let about = found.noise_about;
    let point = if about.norm() > 0.0 {
        format!(", of the point ({:.0}, {:.0}, {:.0}) mm of the target", 1e3 * about.x, 1e3 * about.y, 1e3 * about.z)
    } else {
        String::new()
    };
    format!(
        "of the poses, each component: {:.3} mm across and {:.3} mm along the view{point}; tilts {:.4} deg, turn about the view {:.4} deg",
        1e3 * across,
        1e3 * along,
        tilt.to_degrees(),
        turn.to_degrees()
    )
}
