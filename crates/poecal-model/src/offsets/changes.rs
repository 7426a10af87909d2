//! Changes of each joint of one robot from another: joint offset, tilt and shift, with directions, and their derivatives by small
//! motions of the axes.

use nalgebra::{Vector3, Vector6};

use super::fit::{OffsetEquations, ResidualBlock, RobotPair};
use super::screws::check_same_joints;
use super::{EndConstraint, OffsetOptions};
use crate::robot::{JointKind, Robot};
use poecal_numerics::error::Result;

/// Cosine of the angle from a direction of the base below which a direction is stated by its components: 20 degrees.
const NEAR: f64 = 0.94;
/// Standard deviations below which a change is no more than noise.
const SIGMAS: f64 = 2.0;
/// Rounding: smaller changes (m, rad) do not count.
const NONE: f64 = 1e-9;

/// Change of a joint from another model's, in three parts (theory.md §8 (38e)): the joint offset, and the tilt and shift of its axis that
/// offsets and base do not explain. It is in the base frame at zero joint values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointChange {
    /// Kind of the joint.
    pub kind: JointKind,
    /// Point of the axis for which the shift is stated: the nearest to the joint's origin, metres.
    pub at: Vector3<f64>,
    /// Correction of the joint's value, radians or metres; `None` if base or tool can take its place.
    pub offset: Option<f64>,
    /// Tilt of the axis, a rotation vector across it, radians.
    pub tilt: Vector3<f64>,
    /// Shift of the axis across itself, metres; zero for a prismatic joint.
    pub shift: Vector3<f64>,
    /// Standard deviation of the offset, radians or metres; `None` if it is not determined.
    pub sigma_offset: Option<f64>,
    /// Root mean square error of the tilt, radians.
    pub sigma_tilt: Option<f64>,
    /// Root mean square error of the shift, metres.
    pub sigma_shift: Option<f64>,
    /// True if standard deviations are known: a part without one is then not determined.
    pub is_estimated: bool,
}

impl JointChange {
    /// Description: `2.00 ± 0.31 mm toward +x, tilt 0.700 ± 0.020 deg about +y, offset −0.900 ± 0.030 deg`.
    #[must_use]
    pub fn words(&self) -> String {
        let shift = (self.kind == JointKind::Revolute).then(|| self.shift_words());
        let parts: Vec<String> = shift.into_iter().chain([self.tilt_words(), self.offset_words()]).collect();
        parts.join(", ")
    }

    /// The shift in words: `2.00 ± 0.31 mm toward +x`.
    #[must_use]
    pub fn shift_words(&self) -> String {
        let told = PartDetermination::new(1e3, "mm", self.sigma_shift, self.is_estimated);
        told.vector("shift", "toward", &self.shift)
    }

    /// The tilt in words: `tilt 0.700 ± 0.020 deg about +y`.
    #[must_use]
    pub fn tilt_words(&self) -> String {
        let told = PartDetermination::new(1f64.to_degrees(), "deg", self.sigma_tilt, self.is_estimated);
        told.vector("tilt", "about", &self.tilt)
    }

    /// The offset in words: `offset −0.900 ± 0.030 deg`.
    #[must_use]
    pub fn offset_words(&self) -> String {
        let (factor, unit) = match self.kind {
            JointKind::Revolute => (1f64.to_degrees(), "deg"),
            JointKind::Prismatic => (1e3, "mm"),
        };
        let told = PartDetermination::new(factor, unit, self.sigma_offset, self.is_estimated);
        self.offset.map_or_else(|| "offset not determined".to_owned(), |offset| told.number("offset", offset))
    }
}

/// Format of a part in words.
struct PartDetermination {
    factor: f64,
    unit: &'static str,
    sigma: Option<f64>,
    is_determined: bool,
    decimals: usize,
}

impl PartDetermination {
    fn new(factor: f64, unit: &'static str, sigma: Option<f64>, is_estimated: bool) -> Self {
        // Two digits of the standard deviation.
        let digits = |sigma: f64| (1.0 - (sigma * factor).log10().floor()).clamp(0.0, 6.0);
        let decimals = sigma.filter(|sigma| *sigma > 0.0).map_or(3.0, digits) as usize;
        PartDetermination { factor, unit, sigma, is_determined: sigma.is_some() || !is_estimated, decimals }
    }

    fn format_signed(&self, value: f64) -> String {
        let (value, decimals) = (value * self.factor, self.decimals);
        let text = format!("{:.decimals$}", value.abs());
        let is_zero = text.bytes().all(|it| matches!(it, b'0' | b'.'));
        format!(
            "{}{text}",
            if is_zero {
                ""
            } else if value < 0.0 {
                "−"
            } else {
                "+"
            }
        )
    }

    fn sigma(&self) -> String {
        let (decimals, factor) = (self.decimals, self.factor);
        self.sigma.map_or_else(String::new, |sigma| format!(" ± {:.decimals$}", sigma * factor))
    }

    /// Text of a part that is no more than noise, or not determined.
    fn describe_nothing(&self, name: &str, size: f64) -> Option<String> {
        if !self.is_determined {
            return Some(format!("{name} not determined"));
        }
        if size <= NONE {
            return Some(format!("no {name}"));
        }
        let sigma = self.sigma.filter(|sigma| size < SIGMAS * sigma)?;
        let (decimals, size, sigma) = (self.decimals, size * self.factor, sigma * self.factor);
        let unit = self.unit;
        Some(format!("{name} within noise ({size:.decimals$} ± {sigma:.decimals$} {unit})"))
    }

    fn number(&self, name: &str, value: f64) -> String {
        let told = || format!("{name} {}{} {}", self.format_signed(value), self.sigma(), self.unit);
        self.describe_nothing(name, value.abs()).unwrap_or_else(told)
    }

    fn vector(&self, name: &str, relation: &str, value: &Vector3<f64>) -> String {
        let size = value.norm();
        if let Some(words) = self.describe_nothing(name, size) {
            return words;
        }
        let decimals = self.decimals;
        let length = format!("{:.decimals$}{} {}", size * self.factor, self.sigma(), self.unit);
        let name = if name == "shift" { String::new() } else { format!("{name} ") };
        match direction(value) {
            Some(direction) => format!("{name}{length} {relation} {direction}"),
            None => {
                let parts: Vec<String> = value.iter().map(|part| self.format_signed(*part)).collect();
                format!("{name}{length} ({})", parts.join(", "))
            }
        }
    }
}

/// Direction of the base that is near to a vector.
pub fn direction(value: &Vector3<f64>) -> Option<&'static str> {
    const NAMES: [[&str; 2]; 3] = [["+x", "−x"], ["+y", "−y"], ["+z", "−z"]];
    let (axis, largest) = value.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let is_near = largest.abs() > NEAR * value.norm();
    is_near.then(|| NAMES[axis][usize::from(*largest < 0.0)])
}

/// Changes of the joints of a robot from another, and their derivatives by motions of its axes.
pub struct Changes {
    /// Change of each joint.
    pub joints: Vec<JointChange>,
    length_m: f64,
    /// Directions of the other robot's axes after offsets and base motion.
    directions: Vec<Vector3<f64>>,
    blocks: Vec<(usize, ResidualBlock)>,
    normal: OffsetEquations,
    rows: Vec<f64>,
    scales: Vec<f64>,
}

/// Derivatives of a joint's change by each of some motions.
pub struct ChangeBySteps {
    /// Derivative of its offset, radians or metres for a unit of the motion.
    pub offset: Vec<f64>,
    /// Derivative of the tilt of its axis, radians for a unit of the motion.
    pub tilt: [Vec<f64>; 3],
    /// Derivative of the shift of its axis, metres for a unit of the motion.
    pub shift: [Vec<f64>; 3],
}

impl Changes {
    /// Changes from `nominal` to `actual`, with the best tool and with `base` free or not.
    ///
    /// # Errors
    /// As [`explain`](super::explain).
    pub fn from_robots(nominal: &Robot, actual: &Robot, base: EndConstraint) -> Result<Self> {
        check_same_joints(nominal, actual)?;
        let (nominal, actual) = (&nominal.without_offsets(), &actual.without_offsets());
        let options = OffsetOptions { base, tip: EndConstraint::Free, ..OffsetOptions::default() };
        let comparison = RobotPair::new(nominal, actual, &options);
        let found = comparison.best_state();
        let (screws, blocks) = comparison.blocks(&found);
        let (normal, rows) = comparison.equations(&screws, &blocks);
        let undetermined = comparison.undetermined_joints(&found);
        let joint = |(index, joint): (usize, &crate::robot::Joint)| {
            let (own, goal) = (screws[index].direction(), joint.screw.direction());
            let across = own.cross(&goal);
            let angle = across.norm().atan2(own.dot(&goal));
            let at = joint.screw.nearest_point(&joint.frame.translation);
            let shift = match joint.kind {
                JointKind::Revolute => at - screws[index].nearest_point(&at),
                JointKind::Prismatic => Vector3::zeros(),
            };
            JointChange {
                kind: joint.kind,
                at,
                offset: (!undetermined.contains(&index)).then(|| found.offsets[index]),
                tilt: across.try_normalize(0.0).map_or_else(Vector3::zeros, |axis| axis * angle),
                shift,
                sigma_offset: None,
                sigma_tilt: None,
                sigma_shift: None,
                is_estimated: false,
            }
        };
        Ok(Changes {
            joints: actual.joints.iter().enumerate().map(joint).collect(),
            length_m: comparison.length_m,
            directions: screws.iter().map(|screw| screw.direction()).collect(),
            blocks,
            normal,
            rows,
            scales: comparison.scales(),
        })
    }

    /// Metres that a radian counts relative to shifts: a third of the arm's length.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Derivatives of each joint's change by some motions of the actual robot's axes; each motion has a spatial twist for every joint.
    pub fn by_steps(&self, steps: &[Vec<Vector6<f64>>]) -> Vec<ChangeBySteps> {
        let zeros = || vec![0.0; steps.len()];
        let none = || ChangeBySteps {
            offset: zeros(),
            tilt: std::array::from_fn(|_| zeros()),
            shift: std::array::from_fn(|_| zeros()),
        };
        let mut found: Vec<ChangeBySteps> = self.joints.iter().map(|_| none()).collect();
        let n = self.scales.len();
        for (step, motions) in steps.iter().enumerate() {
            // Motions of the axes, and the part that offsets and base follow.
            let mut moved = Vec::with_capacity(3 * self.blocks.len());
            for (joint, (_, derivative)) in &self.blocks {
                let motion = motions.get(*joint).copied().unwrap_or_else(Vector6::zeros);
                moved.extend((derivative * motion).iter().copied());
            }
            let mut gradient = vec![0.0; n];
            for (row, moved) in self.rows.chunks_exact(n.max(1)).zip(&moved) {
                gradient.iter_mut().zip(row).for_each(|(sum, part)| *sum -= part * moved);
            }
            let follows = self.normal.step_by(&gradient, 0.0);
            for (row, moved) in self.rows.chunks_exact(n.max(1)).zip(&mut moved) {
                *moved -= row.iter().zip(&follows).map(|(part, step)| part * step).sum::<f64>();
            }
            for ((entry, offset), scale) in found.iter_mut().zip(&follows).zip(&self.scales) {
                entry.offset[step] = offset / scale;
            }
            let mut earlier = None;
            for ((joint, _), left) in self.blocks.iter().zip(moved.chunks_exact(3)) {
                let (Some(entry), Some(direction)) = (found.get_mut(*joint), self.directions.get(*joint)) else {
                    continue;
                };
                let left = Vector3::new(left[0], left[1], left[2]);
                // For each joint the tilt comes first.
                let is_tilt = earlier != Some(*joint);
                earlier = Some(*joint);
                let (part, into) = if is_tilt {
                    (direction.cross(&left) / self.length_m, &mut entry.tilt)
                } else {
                    (left, &mut entry.shift)
                };
                into.iter_mut().zip(part.iter()).for_each(|(row, value)| row[step] = *value);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offsets::into_screws;
    use crate::simulate::elbow;
    use poecal_arm::lie::{Pose, Twist};

    /// An elbow with offsets, and axes moved by twists of some size.
    fn move_elbow(size: f64) -> Robot {
        let offsets: Vec<f64> = [0.0, 0.3, -0.2, 0.1, 0.4, 0.0].into_iter().map(|it| it * size).collect();
        let mut robot = into_screws(&elbow(), &offsets).unwrap();
        for (k, joint) in robot.joints.iter_mut().enumerate() {
            let k = k as f64;
            let twist = Vector6::from_fn(|i, _| 0.01 * size * (1.7 * k + 2.3 * i as f64).sin());
            joint.screw = joint.screw.transform(&Pose::exp(&Twist::from_vector(&twist)));
        }
        robot
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let robot = move_elbow(0.02);
        let changes = Changes::from_robots(&elbow(), &robot, EndConstraint::Free).unwrap();
        let mut worst = 0f64;
        for (joint, motion) in (0..6).flat_map(|joint| (0..6).map(move |motion| (joint, motion))) {
            let mut twists = vec![Vector6::zeros(); 6];
            twists[joint][motion] = 1.0;
            let found = changes.by_steps(std::slice::from_ref(&twists));
            const STEP: f64 = 1e-5;
            let at = |sign: f64| {
                let mut robot = robot.clone();
                let by = Pose::exp(&Twist::from_vector(&(twists[joint] * (sign * STEP))));
                robot.joints[joint].screw = robot.joints[joint].screw.transform(&by);
                Changes::from_robots(&elbow(), &robot, EndConstraint::Free).unwrap()
            };
            let (less, more) = (at(-1.0), at(1.0));
            for (k, entry) in found.iter().enumerate() {
                let (less, more) = (&less.joints[k], &more.joints[k]);
                let by = |less: f64, more: f64| (more - less) / (2.0 * STEP);
                if let (Some(less), Some(more)) = (less.offset, more.offset) {
                    worst = worst.max((by(less, more) - entry.offset[0]).abs());
                }
                for part in 0..3 {
                    worst = worst.max((by(less.tilt[part], more.tilt[part]) - entry.tilt[part][0]).abs());
                    worst = worst.max((by(less.shift[part], more.shift[part]) - entry.shift[part][0]).abs());
                }
            }
        }
        println!("derivatives of offsets, tilts and shifts differ from differences by {worst:.1e}");
        // The tolerance is for the neglected second order: the size of the changes themselves, 0.02 of 0.01 and of 0.4 rad.
        assert!(worst < 0.03, "{worst}");
    }

    #[test]
    fn offsets_alone_are_found_as_such() {
        let offsets = [0.0, 0.01, -0.02, 0.015, 0.005, 0.0];
        let robot = into_screws(&elbow(), &offsets).unwrap();
        let changes = Changes::from_robots(&elbow(), &robot, EndConstraint::Free).unwrap();
        let words: Vec<String> = changes.joints.iter().map(JointChange::words).collect();
        println!("{words:#?}");
        assert_eq!(changes.joints[0].offset, None, "the base may turn instead");
        assert_eq!(changes.joints[5].offset, None, "the tool may turn instead");
        for (joint, offset) in offsets.into_iter().enumerate().take(5).skip(1) {
            let found = changes.joints[joint].offset.unwrap();
            assert!((found - offset).abs() < 1e-12, "{joint}: {found}");
        }
        assert_eq!(words[1], "no shift, no tilt, offset +0.573 deg");
    }

    #[test]
    fn what_is_noise_is_said_to_be() {
        let mut change = Changes::from_robots(&elbow(), &elbow(), EndConstraint::Free).unwrap().joints[1];
        change.is_estimated = true;
        change.shift = Vector3::new(0.001, 0.001, 0.0);
        change.sigma_shift = Some(0.00031);
        change.tilt = Vector3::new(0.0, 1e-4, 0.0);
        change.sigma_tilt = Some(1e-4);
        assert_eq!(
            change.words(),
            "1.41 ± 0.31 mm (+1.00, +1.00, 0.00), tilt within noise (0.0057 ± 0.0057 deg), offset not determined"
        );
    }

    #[test]
    fn what_is_not_estimated_is_said_without_doubt() {
        let change = JointChange {
            kind: JointKind::Revolute,
            at: Vector3::zeros(),
            offset: Some(-0.9f64.to_radians()),
            tilt: Vector3::y() * 0.7f64.to_radians(),
            shift: Vector3::new(0.002, 0.0001, 0.0),
            sigma_offset: None,
            sigma_tilt: None,
            sigma_shift: None,
            is_estimated: false,
        };
        assert_eq!(change.words(), "2.002 mm toward +x, tilt 0.700 deg about +y, offset −0.900 deg");
    }
}
