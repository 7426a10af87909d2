//! Corrections of joints, and suspicious joints: the correction stands out, or the residuals follow the joint's position.

use poecal_fit::uncertainty::{Pattern, View, strongest_pattern};
use poecal_model::offsets::JointChange;
use poecal_model::robot::JointKind;
use poecal_numerics::distributions::median;
use poecal_numerics::solve::Normal;

/// A joint's correction.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCorrection {
    /// Angle between nominal and calibrated direction, radians.
    pub tilt_rad: f64,
    /// Distance of the calibrated axis from the nominal joint's origin, metres.
    pub shift_m: f64,
    /// Expected root mean square error of the direction, radians; `None` where it is not determined.
    pub sigma_tilt_rad: Option<f64>,
    /// Expected root mean square error of the axis' place at the joint, metres; `None` where it is not determined.
    pub sigma_shift_m: Option<f64>,
    /// The measurements' share in what is known of the tilt, the rest being the tolerance's: from 0 to 1 (theory.md §9 (39a)); `None` without
    /// a tolerance.
    pub tilt_from_data: Option<f64>,
    /// The same of the shift; `None` of a joint that slides.
    pub shift_from_data: Option<f64>,
    /// Root mean square position error with this screw alone nominal, tool and device frame refitted, metres.
    pub left_nominal_rms_m: f64,
    /// Standard deviations of tilt (radians) and shift (metres) if the axes of all other joints were known; `None` where they are not
    /// determined even then, or the axis was held.
    pub held: Option<(f64, f64)>,
    /// The correction in parts, with directions: joint offset, and what of tilt and shift offsets and base do not explain.
    pub change: JointChange,
    /// Why the joint is suspicious, if it is.
    pub suspicious: Option<String>,
}

/// Ratio to the other joints' median, and to its own standard deviation, above which a correction stands out.
const STANDS_OUT: f64 = 5.0;
const SIGMAS: f64 = 3.0;
/// Fewest other joints for a median.
const FEWEST: usize = 2;
/// Corrections that are of no concern: a tenth of a degree, half a millimetre.
const LEAST_TILT_RAD: f64 = 2e-3;
const LEAST_SHIFT_M: f64 = 5e-4;

/// Suspicions of each joint, in words (theory.md §9 (44)).
pub(crate) fn suspicions(
    view: &View<'_>,
    normal: &Normal,
    joints: &[JointCorrection],
) -> Vec<Option<String>> {
    let kind = |joint: usize| view.session.robot.joints[joint].kind;
    let of_joint = |(joint, correction): (usize, &JointCorrection)| {
        let others = joints.iter().enumerate().filter(|&(other, it)| {
            other != joint && kind(other) == kind(joint) && it.sigma_tilt_rad.is_some()
        });
        stands_out(correction, &others.map(|(_, it)| it).collect::<Vec<_>>())
    };
    let mut words: Vec<Vec<String>> = joints.iter().enumerate().map(of_joint).collect();
    if let Some((joint, pattern)) = strongest_pattern(view, normal) {
        words[joint].push(pattern_words(&pattern, kind(joint)));
    }
    words.into_iter().map(|parts| (!parts.is_empty()).then(|| parts.join("; "))).collect()
}

/// Whether a joint's axis is farther from nominal than those of the other joints of its kind.
fn stands_out(correction: &JointCorrection, others: &[&JointCorrection]) -> Vec<String> {
    let median = |of: fn(&JointCorrection) -> f64| {
        median(others.iter().map(|it| of(it))).filter(|_| others.len() >= FEWEST)
    };
    let mut parts = Vec::new();
    let mut judge = |value: f64, sigma: Option<f64>, least: f64, others: Option<f64>, words: String| {
        let (Some(sigma), Some(others)) = (sigma, others) else { return };
        if value > least && value > SIGMAS * sigma && value > STANDS_OUT * others {
            parts.push(words);
        }
    };
    let tilt = median(|it| it.tilt_rad);
    judge(
        correction.tilt_rad,
        correction.sigma_tilt_rad,
        LEAST_TILT_RAD,
        tilt,
        format!(
            "its axis is tilted by {:.3} deg from nominal, the median of the others by {:.3}",
            correction.tilt_rad.to_degrees(),
            tilt.unwrap_or_default().to_degrees()
        ),
    );
    let shift = median(|it| it.shift_m);
    judge(
        correction.shift_m,
        correction.sigma_shift_m,
        LEAST_SHIFT_M,
        shift,
        format!(
            "its axis is shifted by {:.2} mm from nominal, the median of the others by {:.2}",
            1e3 * correction.shift_m,
            1e3 * shift.unwrap_or_default()
        ),
    );
    parts
}

fn pattern_words(pattern: &Pattern, kind: JointKind) -> String {
    let (size, parts) = match kind {
        JointKind::Revolute => (format!("{:.3} mrad", 1e3 * pattern.rms), "gear, bearing, encoder or sag"),
        JointKind::Prismatic => (format!("{:.3} mm", 1e3 * pattern.rms), "scale, spindle or guide"),
    };
    format!(
        "{:.0} % of the squared residuals follow its position, like a joint error of {size} (RMS): {parts}",
        100.0 * pattern.share
    )
}
