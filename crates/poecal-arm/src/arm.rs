//! An arm: joints with their screws in a row, and its forward kinematics.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use crate::arm_state::{ArmState, MOST_JOINTS};
use crate::chain::LinkChain;
use crate::lie::{Pose, Screw};
use crate::model::{ArmModel, ModelJoint};
use crate::real_chain::RealChain;
use crate::rows::{ConfigurationBatch, PassOutputs};

/// Least joint value per reading of a joint that counts as moved by the reading.
const LEAST_SENSE: f64 = 0.5;

/// A serial arm, `base_from_tip(q) = exp(ξ₁q₁) … exp(ξₙqₙ) M` (lou2009 (2)).
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{Arm, lie::{Pose, Screw}};
/// let shoulder = Screw::revolute(&Vector3::z(), &Vector3::zeros());
/// let elbow = Screw::revolute(&Vector3::z(), &Vector3::x());
/// let arm = Arm::new(&[shoulder, elbow], &Pose::from_translation(2.0 * Vector3::x())).unwrap();
/// let tip = arm.forward_kinematics(&[0.0, core::f64::consts::FRAC_PI_2]);
/// assert!((tip.translation - Vector3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// For each reading, the screw of the joint that it moves, with all readings at 0.
    screws: Vec<Screw>,
    home: Pose,
    chain: LinkChain,
    reach_m: f64,
    limits: Vec<(f64, f64)>,
    /// Joint values per reading; `None` if a reading moves several joints.
    senses: Option<Vec<f64>>,
    /// Parts of its joint values beyond their readings.
    real: Option<Box<RealChain>>,
}

impl Arm {
    /// The arm of these screws (base frame, at zero) and the pose of its tip there; `None` without joints, with more than [`MOST_JOINTS`],
    /// or with numbers that are not finite.
    #[must_use]
    pub fn new(screws: &[Screw], home: &Pose) -> Option<Self> {
        let is_finite = |screw: &Screw| screw.v().iter().chain(screw.w().iter()).all(|it| it.is_finite());
        let is_home = home.rotation.iter().chain(home.translation.iter()).all(|it| it.is_finite());
        if screws.is_empty() || screws.len() > MOST_JOINTS || !screws.iter().all(is_finite) || !is_home {
            return None;
        }
        let chain = LinkChain::new(screws, home);
        let limits = vec![(f64::NEG_INFINITY, f64::INFINITY); screws.len()];
        let senses = Some(vec![1.0; screws.len()]);
        let reach_m = chain.length_m.max(1e-3);
        Some(Arm { screws: screws.to_vec(), home: *home, chain, reach_m, limits, senses, real: None })
    }

    /// The arm of a model; `None` if it has no joint, more than [`MOST_JOINTS`] readings, a reading that moves nothing, numbers that are not
    /// finite, or invalid indices.
    #[must_use]
    pub fn from_model(model: &ArmModel) -> Option<Self> {
        if !model.is_whole() {
            return None;
        }
        let real = RealChain::new(model);
        let at_zero = ConfigurationBatch::from_readings(&[0.0; MOST_JOINTS])
            .place_with(|rows| rows.place_real(&real, PassOutputs::Steps));
        let mut screws = Vec::with_capacity(model.readings);
        for reading in 0..model.readings {
            let (v, w) = (at_zero.v[reading], at_zero.w[reading]);
            let slides = w.norm() < 1e-6;
            let size = if slides { v.norm() } else { w.norm() };
            if size < 1e-9 {
                return None;
            }
            // If a reading moves other joints a little, its screw has a pitch: the axis counts.
            screws.push(if slides {
                Screw::prismatic(&v)
            } else {
                Screw::revolute(&w, &(w.cross(&v) / (size * size)))
            });
        }
        let mut arm = Arm::new(&screws, &at_zero.tip)?;
        for (limits, own) in arm.limits.iter_mut().zip(&model.limits) {
            *limits = own.unwrap_or(*limits);
        }
        let main = |joint: &ModelJoint| -> Vec<(usize, f64)> {
            let all = joint.value.linear.iter().copied();
            all.filter(|(_, factor)| factor.abs() > LEAST_SENSE).collect()
        };
        let moved: Vec<Vec<(usize, f64)>> = model.joints.iter().map(main).filter(|it| !it.is_empty()).collect();
        let is_serial = moved.len() == model.readings
            && moved.iter().enumerate().all(|(index, of)| matches!(of[..], [(reading, _)] if reading == index));
        arm.senses = is_serial.then(|| moved.iter().flatten().map(|(_, factor)| factor.abs()).collect());
        let is_rigid = model.joints.len() == model.readings
            && model.joints.iter().enumerate().all(|(index, joint)| joint.value.is_reading(index));
        arm.real = (!is_rigid).then(|| Box::new(real));
        Some(arm)
    }

    /// The arm of the numbers of a model ([`ArmModel::numbers`]); `None` if they are no model.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        Arm::from_model(&ArmModel::from_numbers(numbers)?)
    }

    /// Number of readings: of the joints that are moved.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.chain.len()
    }

    /// Screws of the joints that readings move, in the base, with all readings at 0.
    #[must_use]
    pub fn screws(&self) -> &[Screw] {
        &self.screws
    }

    /// Tip in the base, with all readings at 0.
    #[must_use]
    pub fn home(&self) -> &Pose {
        &self.home
    }

    /// Smallest and largest value of each reading (rad, m), infinite without a limit.
    #[must_use]
    pub fn limits(&self) -> &[(f64, f64)] {
        &self.limits
    }

    /// True if joint values are their readings.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.real.is_none()
    }

    /// Joints as if their values were their readings, and the parts of the values beyond them.
    #[inline(always)]
    pub(crate) fn parts(&self) -> (&LinkChain, Option<&RealChain>) {
        (&self.chain, self.real.as_deref())
    }

    /// Joint values per reading; `None` if a reading moves several joints.
    pub(crate) fn senses(&self) -> Option<&[f64]> {
        self.senses.as_deref()
    }

    /// Length of the path from the first axis over all axes to the tip, metres: lengths are compared with it.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// `base_from_tip` at readings (rad, m); missing ones are 0.
    #[must_use]
    pub fn forward_kinematics(&self, q: &[f64]) -> Pose {
        // Small arrays are filled faster.
        match self.joints() {
            ..=6 => self.placed_at(&take_first::<6>(q)).tip,
            7 | 8 => self.placed_at(&take_first::<8>(q)).tip,
            _ => self.placement(q).tip,
        }
    }

    /// The tip and its motions at readings; missing ones are 0.
    pub(crate) fn placement(&self, q: &[f64]) -> ArmState<MOST_JOINTS> {
        self.placed_at(&take_first::<MOST_JOINTS>(q))
    }

    /// The same at `N` readings, the number of joints or more.
    #[inline]
    pub(crate) fn placed_at<const N: usize>(&self, q: &[f64; N]) -> ArmState<N> {
        // Parts that only one of the two needs are not computed for the other.
        match &self.real {
            Some(real) => {
                ConfigurationBatch::from_readings(q).place_with(|rows| rows.place_real(real, PassOutputs::Steps))
            }
            None => ConfigurationBatch::from_readings(q)
                .place_with(|rows| rows.place_rigid(&self.chain, PassOutputs::Steps)),
        }
    }
}

/// The first readings; missing ones are 0.
pub(crate) fn take_first<const N: usize>(q: &[f64]) -> [f64; N] {
    let mut all = [0.0; N];
    all.iter_mut().zip(q).for_each(|(to, from)| *to = *from);
    all
}

impl Arm {
    /// The smallest singular value of the Jacobian at joint values, lengths over [`Arm::reach_m`]: 0 at singularities.
    #[must_use]
    pub fn smallest_singular_value(&self, q: &[f64]) -> f64 {
        let placed = self.placement(q);
        let mut a = nalgebra::Matrix6::<f64>::zeros();
        for index in 0..self.joints() {
            let (mut v, w) = placed.column(index);
            if !self.screws[index].is_prismatic() {
                v /= self.reach_m;
            }
            let column = nalgebra::Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z);
            a += column * column.transpose();
        }
        nalgebra::ComplexField::sqrt(a.symmetric_eigenvalues().min().max(0.0))
    }
}

impl Arm {
    /// Sign of the determinant of the Jacobian of six joints, which changes when the arm passes through a singularity; 0 for other numbers
    /// of joints.
    #[must_use]
    pub fn handedness(&self, q: &[f64]) -> f64 {
        if self.joints() != 6 {
            return 0.0;
        }
        let determinant = self.minor(&self.placement(q), [0, 1, 2, 3, 4, 5]);
        if determinant == 0.0 { 0.0 } else { determinant.signum() }
    }

    /// Determinant of the columns of six joints, lengths over [`Arm::reach_m`].
    pub(crate) fn minor<const N: usize>(&self, placed: &ArmState<N>, joints: [usize; 6]) -> f64 {
        let mut rows = [[0.0; 6]; 6];
        for (column, joint) in joints.into_iter().enumerate() {
            let (mut v, w) = placed.column(joint);
            if !self.screws[joint].is_prismatic() {
                v /= self.reach_m;
            }
            for (row, value) in rows.iter_mut().zip([v.x, v.y, v.z, w.x, w.y, w.z]) {
                row[column] = value;
            }
        }
        crate::small_systems::determinant(&mut rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn an_arm_of_one_joint_is_singular_and_bent_no_way() {
        let axis = Screw::revolute(&Vector3::z(), &Vector3::zeros());
        let arm = Arm::new(&[axis], &Pose::identity()).unwrap();
        assert!(arm.smallest_singular_value(&[0.0]) < 1e-12);
        assert_eq!(arm.handedness(&[0.0]), 0.0);
    }
}
