//! Commanded readings with which an actual arm has its tip at the pose of its nominal arm.

use crate::arm::Arm;
use crate::arm_state::MOST_JOINTS;
use crate::lie::Pose;
use crate::motions::FirstOrderMotions;
use crate::newton::{REACHED, TipResidual};
use crate::zeros::{CONFIGURATIONS, configuration, zeros};

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Largest motion of a joint from its reading with the fitted zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxCorrection {
    /// Revolute joints, rad.
    pub turning_rad: f64,
    /// Prismatic joints, m.
    pub sliding_m: f64,
}

impl Default for MaxCorrection {
    /// 2°, 2 mm.
    fn default() -> Self {
        MaxCorrection { turning_rad: 2_f64.to_radians(), sliding_m: 2e-3 }
    }
}

/// Outcome of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CorrectionOutcome {
    /// The tip is at its intended pose.
    Reached,
    /// The point is reached, the orientation is not: near a singularity the joints would have to move too far. The orientation error is
    /// no larger than without correction, or than five times the usual error of the arm's orientation.
    Turned,
    /// The arm cannot reach the pose, as is usual with fewer than six joints: this is the nearest configuration.
    Nearest,
    /// The joint of this index would have to move by this amount (rad, m) beyond its zero; nothing is changed.
    TooFar(usize, f64),
}

/// Remainder of a corrected configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionResidual {
    /// Outcome.
    pub outcome: CorrectionOutcome,
    /// Remaining distance, metres.
    pub left_m: f64,
    /// Remaining angle, radians.
    pub left_rad: f64,
}

/// Corrections of an arm's readings: with them the actual arm has its tip at the pose of the nominal one, `actual(q) = nominal(q₀)`, on the
/// branch of `q₀`. No joint moves by more than [`MaxCorrection`] from `q₀ + z`, where `z` are the zeros of the actual arm's joints. Near a
/// singularity the pose may need more. Then the tip's point is exact, and its rotation keeps an unreachable remainder, which is not much more
/// than without correction.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{Arm, ReadingCorrections, MaxCorrection, CorrectionOutcome, lie::{Pose, Screw}};
/// let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
/// let arm = |tilt: f64| {
///     let axes = [(z, z * 0.0), (y, z * 0.0), (y, z * 0.4), (x, z * 0.4), (y + z * tilt, z * 0.4 + x * 0.4), (x, z * 0.4)];
///     let screws = axes.map(|(direction, point)| Screw::revolute(&direction.normalize(), &point));
///     Arm::new(&screws, &Pose::from_translation(x * 0.5 + z * 0.4)).unwrap()
/// };
/// let corrections = ReadingCorrections::new(&arm(0.0), &arm(1e-3), MaxCorrection::default()).unwrap();
/// let meant = [0.1, 0.2, 0.3, 0.4, 0.0, 0.6];
/// let mut q = meant;
/// let found = corrections.correct(&meant, None, &mut q);
/// assert!(found.left_m < 1e-12 && q.iter().zip(meant).all(|(to, from)| (to - from).abs() < 0.01));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingCorrections {
    nominal: Arm,
    actual: Arm,
    zeros: [f64; MOST_JOINTS],
    most: MaxCorrection,
    /// Smallest singular value below which a configuration is near a singularity: the usual one.
    singular: f64,
    /// Largest angle that may remain near a singularity if it was less without correction, radians.
    most_left_rad: f64,
}

impl ReadingCorrections {
    /// Corrections of two arms with the same joints; `None` if their numbers or kinds differ.
    #[must_use]
    pub fn new(nominal: &Arm, actual: &Arm, most: MaxCorrection) -> Option<Self> {
        let kinds = |arm: &Arm, joint: usize| arm.screws()[joint].is_prismatic();
        if nominal.joints() != actual.joints()
            || (0..actual.joints()).any(|joint| kinds(nominal, joint) != kinds(actual, joint))
        {
            return None;
        }
        let zeros = zeros(nominal, actual);
        let mut sizes: [f64; CONFIGURATIONS as usize] = core::array::from_fn(|row| {
            actual.smallest_singular_value(&configuration(nominal, row as u32)[..actual.joints()])
        });
        let mut angles: [f64; CONFIGURATIONS as usize] = core::array::from_fn(|row| {
            let q = configuration(nominal, row as u32);
            let q = &q[..actual.joints()];
            actual.forward_kinematics(q).distance_and_angle(&nominal.forward_kinematics(q)).1
        });
        let median = |all: &mut [f64]| {
            all.sort_unstable_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let (singular, most_left_rad) = (median(&mut sizes), LEFT * median(&mut angles));
        let (nominal, actual) = (nominal.clone(), actual.clone());
        Some(ReadingCorrections { nominal, actual, zeros, most, singular, most_left_rad })
    }

    /// The nominal arm.
    #[must_use]
    pub fn nominal_arm(&self) -> &Arm {
        &self.nominal
    }

    /// The actual arm.
    #[must_use]
    pub fn actual_arm(&self) -> &Arm {
        &self.actual
    }

    /// Zeros of the actual arm's joints (rad, m): the additions to all readings with which its tip is nearest to that of the nominal one,
    /// by least squares over configurations within the limits.
    #[must_use]
    pub fn zeros(&self) -> &[f64] {
        &self.zeros[..self.actual.joints()]
    }

    /// Largest motion of joints from their zeros.
    #[must_use]
    pub fn max_correction(&self) -> MaxCorrection {
        self.most
    }

    /// Largest motion of a joint.
    fn most_of(&self, joint: usize) -> f64 {
        if self.actual.screws()[joint].is_prismatic() { self.most.sliding_m } else { self.most.turning_rad }
    }

    /// Changes `q` to the readings of the actual arm for those `meant` for the nominal one (rad, m). The search begins with the expected
    /// changes, if there are any, and else with the zeros.
    pub fn correct(&self, meant: &[f64], expected: Option<&[f64]>, q: &mut [f64]) -> CorrectionResidual {
        self.correct_to(&self.nominal.forward_kinematics(meant), meant, expected, q)
    }

    /// The same for the nominal arm's tip at `meant`.
    pub fn correct_to(
        &self,
        target: &Pose,
        meant: &[f64],
        expected: Option<&[f64]>,
        q: &mut [f64],
    ) -> CorrectionResidual {
        let n = self.actual.joints().min(q.len()).min(meant.len());
        let (q, meant) = (&mut q[..n], &meant[..n]);
        let mut farthest = None;
        if let Some(expected) = expected {
            q.iter_mut().zip(meant.iter().zip(expected)).for_each(|(q, (meant, by))| *q = meant + by);
            if let Some(found) = self.solve_exactly(target, meant, q, &mut farthest) {
                return found;
            }
        }
        self.begin(meant, q);
        if let Some(found) = self.solve_exactly(target, meant, q, &mut farthest) {
            return found;
        }
        if n < 6 {
            return self.solve_nearby(target, meant, q, farthest);
        }
        let mut near = [0.0; MOST_JOINTS];
        near[..n].copy_from_slice(q);
        if let Some(found) = self.solve_by_turning(target, meant, q) {
            return found;
        }
        q.copy_from_slice(&near[..n]);
        self.solve_nearby(target, meant, q, farthest)
    }

    /// Configuration with the tip's point, and the orientation as near as joints may move. The goal is the intended orientation, or the
    /// uncorrected one if the first ends farther off than without correction and the second is nearer. `None` if the point cannot be reached in
    /// this manner, or if no singularity is near. It is also `None` if the orientation would end farther off than without correction and far
    /// beyond the arm's usual error.
    fn solve_by_turning(&self, target: &Pose, meant: &[f64], q: &mut [f64]) -> Option<CorrectionResidual> {
        let of = |(left_m, left_rad)| CorrectionResidual { outcome: CorrectionOutcome::Turned, left_m, left_rad };
        self.begin(meant, q);
        self.point(target, meant, q)?;
        let found = of(self.tip_error(target, q));
        let uncorrected = self.actual.forward_kinematics(meant);
        let (_, was_rad) = uncorrected.distance_and_angle(target);
        if found.left_rad <= was_rad {
            return Some(found);
        }
        let mut other = [0.0; MOST_JOINTS];
        let other = &mut other[..q.len()];
        self.begin(meant, other);
        let as_it_was = Pose::new(uncorrected.rotation, target.translation);
        if self.point(&as_it_was, meant, other).is_some() {
            let instead = of(self.tip_error(target, other));
            if instead.left_rad < found.left_rad {
                q.copy_from_slice(other);
                return Some(instead).filter(|it| it.left_rad <= self.most_left_rad.max(was_rad));
            }
        }
        Some(found).filter(|it| it.left_rad <= self.most_left_rad)
    }

    /// Sets `q` to the readings with zeros alone.
    fn begin(&self, meant: &[f64], q: &mut [f64]) {
        q.iter_mut().zip(meant.iter().zip(&self.zeros)).for_each(|(q, (meant, zero))| *q = meant + zero);
    }

    fn tip_error(&self, target: &Pose, q: &[f64]) -> (f64, f64) {
        self.actual.forward_kinematics(q).distance_and_angle(target)
    }

    /// Joint that exceeds its largest motion most, and its change.
    fn farthest_joint(&self, meant: &[f64], q: &[f64]) -> Option<(usize, f64)> {
        let mut worst: Option<(usize, f64)> = None;
        for (joint, (q, meant)) in q.iter().zip(meant).enumerate() {
            let change = (q - meant - self.zeros[joint]).abs();
            let over = change / self.most_of(joint);
            // A value that is not a number is too far as well.
            let is_too_far = over.is_nan() || over > 1.0 + 1e-9;
            if is_too_far && worst.is_none_or(|(other, it)| over > it / self.most_of(other)) {
                worst = Some((joint, change));
            }
        }
        worst
    }

    /// Largest change of a joint beyond its zero, as a share of its limit.
    #[must_use]
    pub fn share_of_most(&self, meant: &[f64], q: &[f64]) -> f64 {
        let shares = q.iter().zip(meant).zip(&self.zeros).enumerate();
        shares.map(|(joint, ((q, meant), zero))| (q - meant - zero).abs() / self.most_of(joint)).fold(0.0, f64::max)
    }

    /// Configuration with the pose, if it is on this branch; keeps the joint that is too far.
    fn solve_exactly(
        &self,
        target: &Pose,
        meant: &[f64],
        q: &mut [f64],
        farthest: &mut Option<(usize, f64)>,
    ) -> Option<CorrectionResidual> {
        let left = self.actual.solve_nearest(target, q);
        *farthest = self.farthest_joint(meant, q);
        // Both are below their common limit.
        let is_reached = left < REACHED;
        (is_reached && farthest.is_none()).then(|| CorrectionResidual {
            outcome: CorrectionOutcome::Reached,
            left_m: left * self.actual.reach_m(),
            left_rad: left,
        })
    }

    /// Nearest configuration of a pose out of reach, or the joint that is too far for it.
    fn solve_nearby(
        &self,
        target: &Pose,
        meant: &[f64],
        q: &mut [f64],
        farthest: Option<(usize, f64)>,
    ) -> CorrectionResidual {
        let outcome = match farthest {
            None => CorrectionOutcome::Nearest,
            Some((joint, change)) => {
                q.copy_from_slice(meant);
                CorrectionOutcome::TooFar(joint, change)
            }
        };
        let (left_m, left_rad) = self.tip_error(target, q);
        CorrectionResidual { outcome, left_m, left_rad }
    }

    /// Changes `q` to a configuration with the exact point of the tip and its rotation as far as joints may move. For every rotation that the
    /// arm can make with the point at rest, a singular one takes `c/s` for a rotation by `c`. If that exceeds the remaining motion of a joint,
    /// it decreases with `s` and is 0 at `s = 0`. So a smooth motion stays smooth. Returns the remaining angle; `None` if the point cannot be
    /// reached, or no singularity is near.
    fn point(&self, target: &Pose, meant: &[f64], q: &mut [f64]) -> Option<f64> {
        let n = q.len();
        let reach = self.actual.reach_m();
        let slides: [bool; MOST_JOINTS] =
            core::array::from_fn(|joint| joint < n && self.actual.screws()[joint].is_prismatic());
        // Steps of prismatic joints are counted in reaches, as angles.
        let unit = |joint: usize| if slides[joint] { reach } else { 1.0 };
        let most: [f64; MOST_JOINTS] =
            core::array::from_fn(|joint| if joint < n { MARGIN * self.most_of(joint) / unit(joint) } else { 0.0 });
        let at = |q: &[f64]| {
            let placed = self.actual.placement(q);
            let ways =
                FirstOrderMotions::from_placement(&placed, n, |joint| if slides[joint] { 1.0 } else { 1.0 / reach });
            (TipResidual::new(&placed.tip, target), ways)
        };
        for step in 0..MOST_STEPS {
            let (left, ways) = at(q);
            let mut from = [0.0; MOST_JOINTS];
            for joint in 0..n {
                from[joint] = (q[joint] - meant[joint] - self.zeros[joint]) / unit(joint);
            }
            let to = ways.least_correction(&left, 1.0 / reach, &from[..n], &most[..n])?;
            let mut longest = 0.0_f64;
            for joint in 0..n {
                let by = to[joint] - from[joint];
                longest = longest.max(by.abs());
                q[joint] += by * unit(joint);
            }
            if longest < 1e-9 || (step > 12 && longest < 1e-7) {
                break;
            }
        }
        // The last digits of the point follow by the least motion.
        for _ in 0..6 {
            let (left, ways) = at(q);
            if left.position.norm() < POINT * reach {
                break;
            }
            let by = ways.to_point(&(left.position / reach))?;
            for joint in 0..n {
                q[joint] += by[joint] * unit(joint);
            }
        }
        let (left_m, left_rad) = self.tip_error(target, q);
        let is_found = left_m < 10.0 * POINT * reach && left_rad <= self.most.turning_rad;
        let is_kept = is_found && self.farthest_joint(meant, q).is_none();
        (is_kept && self.actual.smallest_singular_value(q) < self.singular).then_some(left_rad)
    }
}

/// Largest number of steps to a configuration near a singularity: each leaves some hundredths of the one before.
const MOST_STEPS: u32 = 40;
/// Angle that may remain near a singularity, in units of the usual one without correction. A tool of a tenth of the reach then has an error equal
/// to the correction of its point.
const LEFT: f64 = 5.0;
/// Share of a joint's largest motion that the search uses: the last digits of the point take some more.
const MARGIN: f64 = 0.999;
/// Distance over the reach below which the tip's point is reached.
const POINT: f64 = 1e-13;
