//! Corrections of joints, and suspicious joints: one whose correction alone explains most deviations, or whose position the residuals follow.

use super::fault_explanation::{FaultExplanation, JointPart, blame};
use poecal_fit::uncertainty::{FitView, JointPattern, Uncertainty, strongest_pattern};
use poecal_model::offsets::JointChange;
use poecal_model::robot::JointKind;
use poecal_numerics::error::shorten_name;
use poecal_numerics::solve::NormalEquations;

/// A joint's correction.
#[derive(Clone, Debug, PartialEq)]
pub struct JointCorrection {
    /// Angle between nominal and calibrated direction, radians.
    pub tilt_rad: f64,
    /// Distance of the calibrated axis from the nominal joint's origin, metres.
    pub shift_m: f64,
    /// Expected root mean square error of the direction, radians; `None` if it is not determined.
    pub sigma_tilt_rad: Option<f64>,
    /// Expected root mean square error of the axis' position at the joint, metres; `None` if it is not determined.
    pub sigma_shift_m: Option<f64>,
    /// Determined share of the tilt: the part of its information that the measurements supply, the rest being the tolerance's, from 0 to 1
    /// (theory.md §9 (39a)); `None` without a tolerance.
    pub tilt_from_data: Option<f64>,
    /// Determined share of the shift; `None` for a joint that slides.
    pub shift_from_data: Option<f64>,
    /// Root mean square position error with this screw alone nominal, tool and device frame refitted, metres.
    pub left_nominal_rms_m: f64,
    /// Standard deviations of tilt (radians) and shift (metres) if the axes of all other joints were known; `None` if they are not determined even
    /// then, or the axis was held.
    pub held: Option<(f64, f64)>,
    /// The correction in parts, with directions: joint offset, and the part of tilt and shift that offsets and base do not explain.
    pub change: JointChange,
    /// Reason for suspicion of the joint, if there is one.
    pub suspicious: Option<String>,
}

/// Evidence (twice a logarithm of probabilities) from which a part of a joint is named: if the other axes are as accurate as those of usual robots,
/// and if they are worse, since then one or another often deviates by more.
const NAMED: [f64; 2] = [1.0, 12.0];
/// Deviations of the other axes (each direction, radians) from which each of the two thresholds applies.
const USUAL_RAD: [f64; 2] = [4e-4, 1.2e-3];
/// Difference of evidence up to which measurements do not distinguish two explanations.
const ALIKE: f64 = 3.0;
/// Corrections that are of no concern: a twentieth of a degree, half a millimetre.
const LEAST_RAD: f64 = 1e-3;
const LEAST_M: f64 = 5e-4;
/// Standard deviations of the correction from which it is more than noise.
const SIGMAS: f64 = 3.0;

/// Suspicions of each joint, in words (theory.md §9 (44)).
pub(crate) fn suspicions(
    view: &FitView<'_>,
    normal: &NormalEquations,
    joints: &[JointCorrection],
    uncertainty: Option<&Uncertainty>,
) -> Vec<Option<String>> {
    let robot = view.session.robot;
    let mut words: Vec<Vec<String>> = vec![Vec::new(); joints.len()];
    let found = uncertainty.map(|it| faulty_parts(&blame(view, it), joints)).unwrap_or_default();
    let told =
        |it: &FaultExplanation| Some((it.joint, robot.joints.get(it.joint)?, part_words(it, joints.get(it.joint)?)));
    match found.iter().filter_map(told).collect::<Vec<_>>().as_slice() {
        [] => {}
        [(joint, _, own)] => words[*joint].push(own.clone()),
        several => {
            for (joint, _, own) in several {
                let others = several.iter().filter(|it| it.0 != *joint);
                let others: Vec<String> =
                    others.map(|(_, other, words)| format!("{}: {words}", shorten_name(&other.name))).collect();
                words[*joint].push(format!(
                    "{own}, or else {}; the measurements do not distinguish them",
                    others.join(", or else ")
                ));
            }
        }
    }
    if let Some((joint, pattern)) = strongest_pattern(view, normal) {
        words[joint].push(pattern_words(&pattern, robot.joints[joint].kind));
    }
    words.into_iter().map(|parts| (!parts.is_empty()).then(|| parts.join("; "))).collect()
}

/// The faulty part, if there is one, and a part of another joint that explains the deviations about as well.
fn faulty_parts(all: &[FaultExplanation], joints: &[JointCorrection]) -> Vec<FaultExplanation> {
    let counts = |it: &&FaultExplanation| {
        let Some(JointChange { kind, sigma_offset, sigma_tilt, sigma_shift, .. }) =
            joints.get(it.joint).map(|joint| &joint.change)
        else {
            return false;
        };
        let (sigma, is_length) = match it.part {
            JointPart::Zero => (sigma_offset, *kind == JointKind::Prismatic),
            JointPart::Tilt => (sigma_tilt, false),
            JointPart::Shift => (sigma_shift, true),
        };
        let least = if is_length { LEAST_M } else { LEAST_RAD };
        sigma.is_some_and(|sigma| it.size > least.max(SIGMAS * sigma))
    };
    let mut counted = all.iter().filter(counts);
    let Some(best) = counted.next() else { return Vec::new() };
    let worse = (best.usual_rad / USUAL_RAD[0]).ln() / (USUAL_RAD[1] / USUAL_RAD[0]).ln();
    let named = NAMED[0] + (NAMED[1] - NAMED[0]) * worse.clamp(0.0, 1.0);
    if best.evidence < named {
        return Vec::new();
    }
    let least = (best.evidence - ALIKE).max(0.0);
    let other = counted.find(|it| it.joint != best.joint).filter(|it| it.evidence > least);
    [Some(best), other].into_iter().flatten().copied().collect()
}

/// Description of a faulty part, with the joint's correction.
fn part_words(found: &FaultExplanation, correction: &JointCorrection) -> String {
    let change = &correction.change;
    let (what, own, words) = match found.part {
        JointPart::Zero => ("zero is off", change.offset.map_or(0.0, f64::abs), change.offset_words()),
        JointPart::Tilt => ("axis is tilted", change.tilt.norm(), change.tilt_words()),
        JointPart::Shift => ("axis is shifted", change.shift.norm(), change.shift_words()),
    };
    // A part that offsets can explain counts as offset, of other joints too.
    if own < 0.5 * found.size {
        return format!("its {what} by more than others are, counted as corrections of its neighbours");
    }
    format!("its {what} by more than others are ({words})")
}

fn pattern_words(pattern: &JointPattern, kind: JointKind) -> String {
    let (size, parts) = match kind {
        JointKind::Revolute => (format!("{:.3} mrad", 1e3 * pattern.rms), "gear, bearing, encoder or sag"),
        JointKind::Prismatic => (format!("{:.3} mm", 1e3 * pattern.rms), "scale, spindle or guide"),
    };
    format!(
        "{:.0} % of the squared residuals follow its position, like a joint error of {size} (RMS): {parts}",
        100.0 * pattern.share
    )
}
