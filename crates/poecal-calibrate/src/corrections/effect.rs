//! Effects of terms at joints, in numbers and in words.

use poecal_model::robot::TermGroup;

/// Effect of one group of terms at one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEffect {
    /// Name of the joint.
    pub joint: String,
    /// The group.
    pub group: TermGroup,
    /// Largest deviation in the fitted rows, radians or metres ([`TermGroup::is_of_lengths`]); for a ratio the change per radian.
    pub amplitude: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Determined share: the part of its prior variance that the measurements removed, 0 to 1.
    pub told: f64,
    /// Root mean square displacement of the target by this effect in the fitted rows, without its mean, metres.
    pub effect_m: f64,
}

impl JointEffect {
    /// The effect in words.
    #[must_use]
    pub fn words(&self) -> String {
        let JointEffect { joint, group, amplitude, .. } = self;
        let much = format!("{:.2} {}", 1e3 * amplitude.abs(), group.row().symbols[0]);
        let way = if *amplitude < 0.0 { "less" } else { "more" };
        let words = [("{much}", much.as_str()), ("{way}", way), ("{joint}", joint)];
        let effect = group.row().effect.to_owned();
        words.into_iter().fold(effect, |effect, (of, word)| effect.replace(of, word))
    }

    /// True if the effect is more than chance and the prior explain.
    #[must_use]
    pub fn is_found(&self) -> bool {
        self.amplitude.abs() > 2.0 * self.sigma && self.told > 0.5
    }
}

/// Error of a joint in a part of its range, radians or metres of its own value: the motion of the joint that explains most of the rows'
/// residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointErrorPart {
    /// Lower and upper end, values of the joint.
    pub range: [f64; 2],
    /// Number of rows.
    pub rows: usize,
    /// Error of the calibrated model.
    pub before: f64,
    /// Error of the corrected model.
    pub after: f64,
    /// Mean deviation by the joint's own terms, and its standard deviation.
    pub terms: (f64, f64),
}

/// Error of a joint over its sampled range.
#[derive(Clone, Debug, PartialEq)]
pub struct JointErrors {
    /// Name of the joint.
    pub joint: String,
    /// True if the joint slides.
    pub slides: bool,
    /// Parts with enough rows.
    pub parts: Vec<JointErrorPart>,
}

/// Effects of the terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects {
    /// Effects by joint and group, the largest displacement of the target first.
    pub each: Vec<JointEffect>,
    /// Errors of each joint over its range.
    pub errors: Vec<JointErrors>,
    /// Indistinguishable effects, a sentence each.
    pub confused: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_is_said_in_milliradians() {
        let sag = JointEffect {
            joint: "joint2".into(),
            group: TermGroup::Sag,
            amplitude: 4e-4,
            sigma: 5e-5,
            told: 0.9,
            effect_m: 2e-4,
        };
        assert_eq!(sag.words(), "joint2 sags by up to 0.40 mrad under weight");
    }
}
