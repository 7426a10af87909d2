//! What to command so that the robot as it is does what a program for its drawing meant.

mod inverse;
mod kinematics;
mod programs;
mod reach;
mod summary;
mod table;

use poecal_arm::Arm;
use reach::Reach;

pub use inverse::Inverse;
pub use kinematics::Kinematics;
pub use programs::{
    Given, LARGEST_PROGRAM, Language, Listed, PoseCompensation, ProgramOptions, ProgramSummary,
    compensate_file, compensate_program,
};
pub use summary::{Largest, Summary};
pub use table::{TableOptions, compensate_table};

use crate::error::{Error, ErrorKind, Result};
use crate::lie::Pose;
use crate::robot::Robot;
use crate::threads::map_chunks;

/// Distance (m) and angle (rad) below which a pose counts as reached.
pub const REACHED: f64 = 1e-9;

/// Compensation of joint readings: those with which the actual robot has its tip where the nominal one has it,
/// `base_from_tip(q) = nominal base_from_tip(q₀)` (theory.md §2).
#[derive(Clone, Debug)]
pub struct Compensation {
    nominal: Arm,
    actual: Reach,
    /// Of each reading of the arm, its index among the robot's.
    readings: Vec<usize>,
    names: Vec<String>,
    /// The last correction: where the next one begins.
    last: Vec<f64>,
    /// Number of configurations since the last one that began without.
    since: usize,
    before: Vec<f64>,
    q: Vec<f64>,
    meant: Vec<f64>,
    out: Vec<f64>,
}

/// A corrected configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<'a> {
    /// Readings to command (rad, m), in the order of [`Robot::reading_names`].
    pub readings: &'a [f64],
    /// How far the actual robot's tip would have been off without correction, metres.
    pub moved_m: f64,
    /// The same of its orientation, radians.
    pub turned_rad: f64,
    /// Distance that is left, metres.
    pub left_m: f64,
    /// Angle that is left, radians.
    pub left_rad: f64,
    /// Whether the actual robot is bent another way than the nominal one: a singularity lies between them.
    pub is_other_branch: bool,
}

impl Compensated<'_> {
    /// Whether nothing is left but rounding.
    #[must_use]
    pub fn is_reached(&self) -> bool {
        self.left_m <= REACHED && self.left_rad <= REACHED
    }
}

impl Compensation {
    /// Of two robots with the same joints, at these values of the actual one's factors.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if their joints differ, or as [`Robot::arm`].
    pub fn new(nominal: &Robot, actual: &Robot, factors: &[f64]) -> Result<Self> {
        let (nominal_arm, own) = nominal.arm(&[])?;
        let (actual_arm, readings) = actual.arm(factors)?;
        let names = actual.joint_reading_names();
        if names != nominal.joint_reading_names() || own != readings {
            let message = "the nominal robot has other joints than the actual one, expected the same";
            return Err(Error::new(ErrorKind::Model, message));
        }
        let count = readings.len();
        Ok(Compensation {
            nominal: nominal_arm,
            actual: Reach::new(actual_arm),
            last: vec![0.0; count],
            since: 0,
            before: vec![0.0; count],
            q: vec![0.0; count],
            meant: vec![0.0; count],
            out: vec![0.0; names.len()],
            readings,
            names,
        })
    }

    /// Names of the readings.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The nominal arm.
    #[must_use]
    pub fn nominal(&self) -> &Arm {
        &self.nominal
    }

    /// The actual arm.
    #[must_use]
    pub fn actual(&self) -> &Arm {
        self.actual.arm()
    }

    /// Of each reading of the arms, its index among all readings.
    #[must_use]
    pub fn readings(&self) -> &[usize] {
        &self.readings
    }

    /// Whether readings are beyond the actual arm's limits.
    #[must_use]
    pub fn is_beyond_limits(&self, readings: &[f64]) -> bool {
        let of = |&at: &usize| readings.get(at).copied().unwrap_or(0.0);
        self.readings
            .iter()
            .map(of)
            .zip(self.actual.arm().limits())
            .any(|(it, &(low, high))| it < low || it > high)
    }

    /// Readings of the actual robot for readings of the nominal one (rad, m); those that do not move the tip stay as they are. The search
    /// begins with the corrections before, and every [`TOGETHER`] configurations without.
    pub fn joints(&mut self, meant: &[f64]) -> Compensated<'_> {
        if self.since == TOGETHER {
            self.since = 0;
            self.last.fill(0.0);
            self.before.fill(0.0);
        }
        self.since += 1;
        self.out.clear();
        self.out.extend_from_slice(meant);
        self.out.resize(self.names.len().max(meant.len()), 0.0);
        for (to, &at) in self.meant.iter_mut().zip(&self.readings) {
            *to = meant.get(at).copied().unwrap_or(0.0);
        }
        let target = self.nominal.forward_kinematics(&self.meant);
        let uncorrected = self.actual().forward_kinematics(&self.meant);
        let (moved_m, turned_rad) = uncorrected.apart(&target);
        if moved_m == 0.0 && turned_rad == 0.0 {
            return self.told((moved_m, turned_rad), (0.0, 0.0), false);
        }
        // Along a path, corrections change evenly.
        let changes = self.last.iter().zip(&self.before).map(|(last, before)| 2.0 * last - before);
        for (to, (meant, change)) in self.q.iter_mut().zip(self.meant.iter().zip(changes)) {
            *to = meant + change;
        }
        let mut left = self.solve(&target);
        let far = |q: &[f64], meant: &[f64]| q.iter().zip(meant).any(|(a, b)| (a - b).abs() > FAR);
        if left.0 > REACHED || left.1 > REACHED || far(&self.q, &self.meant) {
            // The last correction may lead astray.
            self.q.copy_from_slice(&self.meant);
            left = self.solve(&target);
        }
        let is_other_branch = far(&self.q, &self.meant)
            || self.nominal.handedness(&self.meant) * self.nominal.handedness(&self.q) < 0.0;
        std::mem::swap(&mut self.last, &mut self.before);
        for (last, (to, from)) in self.last.iter_mut().zip(self.q.iter().zip(&self.meant)) {
            *last = if is_other_branch { 0.0 } else { to - from };
        }
        for (&at, value) in self.readings.iter().zip(&self.q) {
            if let Some(out) = self.out.get_mut(at) {
                *out = *value;
            }
        }
        self.told((moved_m, turned_rad), left, is_other_branch)
    }

    fn told(&self, moved: (f64, f64), left: (f64, f64), is_other_branch: bool) -> Compensated<'_> {
        Compensated {
            readings: &self.out,
            moved_m: moved.0,
            turned_rad: moved.1,
            left_m: left.0,
            left_rad: left.1,
            is_other_branch,
        }
    }

    /// What `told` makes of each of many configurations, their readings one after the other, as [`Compensation::joints`] of a new compensation
    /// one by one, but by all threads; the first error in their order.
    ///
    /// # Errors
    /// Those of `told`, which also gets the index of the configuration.
    pub fn of_many<T: Send, E: Send>(
        &self,
        readings: &[f64],
        told: impl Fn(usize, &Compensated<'_>) -> std::result::Result<Vec<T>, E> + Sync + Send,
    ) -> std::result::Result<Vec<T>, E> {
        let width = self.names.len().max(1);
        let parts = map_chunks(readings, TOGETHER * width, |index, some| {
            let mut own = self.clone();
            (own.since, own.last, own.before) = (0, vec![0.0; own.last.len()], vec![0.0; own.before.len()]);
            let mut out = Vec::new();
            for (row, meant) in some.chunks_exact(width).enumerate() {
                out.extend(told(index * TOGETHER + row, &own.joints(meant))?);
            }
            Ok(out)
        });
        Ok(parts.into_iter().collect::<std::result::Result<Vec<_>, E>>()?.into_iter().flatten().collect())
    }

    /// Takes `q` to the nearest configuration that has the tip at a pose; distance and angle that are left.
    fn solve(&mut self, target: &Pose) -> (f64, f64) {
        let left = self.actual.nearest(target, &mut self.q);
        // Both are below their common measure.
        let (left_m, left_rad) = (left * self.actual().reach_m(), left);
        if left_m < NOTHING && left_rad < NOTHING {
            return (left_m, left_rad);
        }
        self.actual().forward_kinematics(&self.q).apart(target)
    }
}

/// Configurations that are corrected one after the other, each from where the one before led; the next ones begin anew, so that several
/// threads find the same bits.
pub const TOGETHER: usize = 256;
/// Remainder (m, rad) of which it does not matter where it is.
const NOTHING: f64 = 1e-11;
/// Correction of a joint (rad, m) that is none of a robot like its drawing: another branch.
const FAR: f64 = 0.6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tests::elbow;
    use crate::robot::{JointTerm, Term};

    #[test]
    fn an_offset_is_taken_off_the_reading() {
        let nominal = elbow();
        let mut actual = nominal.clone();
        actual.terms.push(JointTerm { joint: 1, term: Term::Offset, coefficient: 0.01 });
        let mut compensation = Compensation::new(&nominal, &actual, &[]).unwrap();
        let found = compensation.joints(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        assert!((found.readings[1] - 0.19).abs() < 1e-12 && found.is_reached());
    }

    #[test]
    fn a_robot_that_is_as_drawn_is_not_moved() {
        let mut compensation = Compensation::new(&elbow(), &elbow(), &[]).unwrap();
        assert_eq!(compensation.joints(&[0.1; 6]).moved_m, 0.0);
        let moved = compensation.of_many(&[0.1; 12], |_, it| Ok::<_, Error>(vec![it.moved_m])).unwrap();
        assert_eq!(moved, [0.0, 0.0]);
    }
}
