//! Readings and programs corrected so that the actual robot executes the motion programmed for the nominal one.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and is not stable
//! by itself.
//!
//! `table.rs` corrects files of joint readings, `programs` targets in the text of robot programs; [`Inverse`] and [`Kinematics`] compute inverses,
//! poses, Jacobians and sag of many configurations.
//!
//! Not here: iterations, which are `poecal-arm`'s; languages, which are `poecal-programs`'s; base and tool, with which `poecal-results`'s
//! `calibration_file/taught.rs` provides the nominal robot.

#![forbid(unsafe_code)]

mod inverse;
mod kinematics;
mod programs;
mod reach;
mod summary;
mod table;

use std::borrow::Cow;
use std::sync::Arc;

use poecal_arm::{Arm, CorrectionResidual, ReadingCorrections};
use reach::Reach;

pub use inverse::Inverse;
pub use kinematics::Kinematics;
pub use poecal_arm::{CorrectionOutcome, MaxCorrection};
pub use programs::{PoseCompensation, ProgramOptions, ProgramSummary, compensate_file, compensate_program};
pub use summary::{CompensationSummary, CorrectedTarget, ForwardCheck, LargestValue};
pub use table::{TableOptions, compensate_table};

pub use poecal_programs::{Language, StatedFrames, UnchangedStatement};

use poecal_model::robot::Robot;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::threads::map_chunks;

/// Distance (m) and angle (rad) below which a pose counts as reached.
pub const REACHED: f64 = 1e-9;

/// Limits of the changes of readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChangeOptions {
    /// Largest motion of a joint beyond its zero.
    pub most_change: MaxCorrection,
    /// True if the nearest configuration is used when an arm of six or more joints cannot reach the intended pose of the tip.
    pub nearest: bool,
}

/// Compensation of joint readings: those with which the actual robot's tip has the pose of the nominal one's,
/// `base_from_tip(q) = nominal base_from_tip(q₀)`, on the branch of `q₀` (theory.md §2).
#[derive(Clone, Debug)]
pub struct Compensation {
    corrections: Arc<ReadingCorrections>,
    nearest: bool,
    /// Index of each reading of the arm among the robot's.
    readings: Vec<usize>,
    names: Vec<String>,
    /// The last change: start of the next one.
    last: Vec<f64>,
    before: Vec<f64>,
    /// Number of known changes of the configurations just before: 0, 1, or 2.
    known: usize,
    /// Number of configurations since the last one that started without a known change.
    since: usize,
    expected: Vec<f64>,
    q: Vec<f64>,
    meant: Vec<f64>,
    out: Vec<f64>,
}

/// A configuration, corrected or unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensatedConfiguration<'a> {
    /// Readings to command (rad, m), in the order of [`Robot::reading_names`].
    pub readings: &'a [f64],
    /// Distance of the actual robot's tip from its intended position without correction, metres.
    pub moved_m: f64,
    /// Angle of its tip from the intended orientation without correction, radians.
    pub turned_rad: f64,
    /// Remaining distance, metres.
    pub left_m: f64,
    /// Remaining angle, radians.
    pub left_rad: f64,
    /// Outcome of the correction.
    pub outcome: CorrectionOutcome,
    /// True if it is corrected; otherwise the readings are unchanged, and the remaining error is that without correction.
    pub is_corrected: bool,
}

impl Compensation {
    /// Compensation between two robots with the same joints, at these values of the actual one's factors.
    ///
    /// # Errors
    /// [`ErrorKind::Model`] if their joints differ, or those of [`Robot::arm`].
    pub fn new(nominal: &Robot, actual: &Robot, factors: &[f64], options: &ChangeOptions) -> Result<Self> {
        Compensation::with_held_joints(nominal, actual, factors, &[], options)
    }

    /// Compensation with some readings held (each by its index among the robot's, with its value in rad or m): the others are corrected for them.
    ///
    /// # Errors
    /// Those of [`Compensation::new`].
    pub fn with_held_joints(
        nominal: &Robot,
        actual: &Robot,
        factors: &[f64],
        held: &[(usize, f64)],
        options: &ChangeOptions,
    ) -> Result<Self> {
        let (nominal_arm, own) = nominal.arm_holding(&[], held)?;
        let (actual_arm, readings) = actual.arm_holding(factors, held)?;
        let names = actual.joint_reading_names();
        let corrections = ReadingCorrections::new(&nominal_arm, &actual_arm, options.most_change);
        let Some(corrections) = corrections.filter(|_| names == nominal.joint_reading_names() && own == readings)
        else {
            return ErrorKind::Model
                .refuse("the nominal robot has other joints than the actual one, expected the same");
        };
        let count = readings.len();
        Ok(Compensation {
            corrections: Arc::new(corrections),
            nearest: options.nearest,
            last: vec![0.0; count],
            before: vec![0.0; count],
            known: 0,
            since: 0,
            expected: vec![0.0; count],
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
    pub fn nominal_arm(&self) -> &Arm {
        self.corrections.nominal_arm()
    }

    /// The actual arm.
    #[must_use]
    pub fn actual_arm(&self) -> &Arm {
        self.corrections.actual_arm()
    }

    /// Corrections of the arms.
    #[must_use]
    pub fn corrections(&self) -> &ReadingCorrections {
        &self.corrections
    }

    /// Index of each reading of the arms among all readings.
    #[must_use]
    pub fn readings(&self) -> &[usize] {
        &self.readings
    }

    /// True if readings are beyond the actual arm's limits.
    #[must_use]
    pub fn is_beyond_limits(&self, readings: &[f64]) -> bool {
        let of = |&at: &usize| readings.get(at).copied().unwrap_or(0.0);
        self.readings.iter().map(of).zip(self.actual_arm().limits()).any(|(it, &(low, high))| it < low || it > high)
    }

    /// Readings of the actual robot for readings of the nominal one (rad, m). Readings that do not move the tip are unchanged, and so are all of a
    /// configuration that cannot be corrected. The search starts with the changes before, and every [`TOGETHER`] configurations without.
    pub fn joints(&mut self, meant: &[f64]) -> CompensatedConfiguration<'_> {
        if self.since == TOGETHER {
            self.forget();
        }
        self.since += 1;
        self.out.clear();
        self.out.extend_from_slice(meant);
        self.out.resize(self.names.len().max(meant.len()), 0.0);
        for (to, &at) in self.meant.iter_mut().zip(&self.readings) {
            *to = meant.get(at).copied().unwrap_or(0.0);
        }
        let target = self.nominal_arm().forward_kinematics(&self.meant);
        let uncorrected = self.actual_arm().forward_kinematics(&self.meant);
        let (moved_m, turned_rad) = uncorrected.distance_and_angle(&target);
        if moved_m == 0.0 && turned_rad == 0.0 {
            let nothing = CorrectionResidual { outcome: CorrectionOutcome::Reached, left_m: 0.0, left_rad: 0.0 };
            return self.compensated((moved_m, turned_rad), nothing);
        }
        // Along a path, changes vary evenly.
        for (to, (last, before)) in self.expected.iter_mut().zip(self.last.iter().zip(&self.before)) {
            *to = if self.known > 1 { 2.0 * last - before } else { *last };
        }
        let expected = (self.known > 0).then_some(&self.expected[..]);
        let found = self.corrections.correct_to(&target, &self.meant, expected, &mut self.q);
        if found.outcome == CorrectionOutcome::Reached {
            std::mem::swap(&mut self.last, &mut self.before);
            for (last, (to, from)) in self.last.iter_mut().zip(self.q.iter().zip(&self.meant)) {
                *last = to - from;
            }
            self.known = (self.known + 1).min(2);
        } else {
            self.known = 0;
        }
        if self.is_taken(found.outcome) {
            for (&at, value) in self.readings.iter().zip(&self.q) {
                if let Some(out) = self.out.get_mut(at) {
                    *out = *value;
                }
            }
        }
        self.compensated((moved_m, turned_rad), found)
    }

    /// True if the solution is commanded.
    fn is_taken(&self, outcome: CorrectionOutcome) -> bool {
        match outcome {
            CorrectionOutcome::Reached | CorrectionOutcome::Turned => true,
            CorrectionOutcome::Nearest => self.nearest || self.readings.len() < 6,
            CorrectionOutcome::TooFar(..) => false,
        }
    }

    /// The largest change of a joint beyond its zero, relative to the limit.
    #[must_use]
    pub fn share_of_most(&self, meant: &[f64], commanded: &[f64]) -> f64 {
        let own =
            |all: &[f64]| -> Vec<f64> { self.readings.iter().map(|&at| all.get(at).copied().unwrap_or(0.0)).collect() };
        self.corrections.share_of_most(&own(meant), &own(commanded))
    }

    /// Reason why a configuration is unchanged, by its outcome and remaining error (m, rad).
    #[must_use]
    pub fn reason(&self, outcome: CorrectionOutcome, (left_m, left_rad): (f64, f64)) -> Cow<'static, str> {
        match outcome {
            CorrectionOutcome::TooFar(joint, change) => {
                let at = self.readings.get(joint).copied().unwrap_or(joint);
                let slides = self.actual_arm().screws().get(joint).is_some_and(|it| it.is_prismatic());
                let most = self.corrections.max_correction();
                let in_words = |it: f64| {
                    if slides { format!("{:.3} mm", it * 1e3) } else { format!("{:.3} deg", it.to_degrees()) }
                };
                let most = if slides { most.sliding_m } else { most.turning_rad };
                format!(
                    "joint `{}` would have to move by {} beyond its zero, where {} are allowed: a singularity is near, or the \
                     robot is far from its drawing (how far it may can be set)",
                    self.names.get(at).map_or("", String::as_str),
                    in_words(change),
                    in_words(most)
                )
                .into()
            }
            CorrectionOutcome::Nearest => format!(
                "the actual robot does not reach it: {:.3} mm and {:.4} deg are left at the nearest configuration",
                left_m * 1e3,
                left_rad.to_degrees()
            )
            .into(),
            CorrectionOutcome::Reached | CorrectionOutcome::Turned => Cow::Borrowed("it is corrected"),
        }
    }

    /// Starts the next configuration without those before.
    fn forget(&mut self) {
        (self.since, self.known) = (0, 0);
    }

    fn compensated(&self, moved: (f64, f64), found: CorrectionResidual) -> CompensatedConfiguration<'_> {
        CompensatedConfiguration {
            readings: &self.out,
            moved_m: moved.0,
            turned_rad: moved.1,
            left_m: found.left_m,
            left_rad: found.left_rad,
            outcome: found.outcome,
            is_corrected: self.is_taken(found.outcome),
        }
    }

    /// Readings of many configurations, one after the other, as by [`Compensation::joints`] of a new compensation one by one, but by all threads.
    /// Also the summary of changes, by the index of each row from 0; on request with every row.
    #[must_use]
    pub fn of_many(&self, readings: &[f64], each: bool) -> (Vec<f64>, CompensationSummary) {
        let width = self.names.len().max(1);
        let parts = map_chunks(readings, TOGETHER * width, |_, some| {
            let mut own = self.clone();
            own.forget();
            let mut out = Vec::with_capacity(some.len());
            let mut found = Vec::with_capacity(some.len() / width);
            for meant in some.chunks_exact(width) {
                let it = own.joints(meant);
                out.extend_from_slice(it.readings);
                found.push(CompensatedConfiguration { readings: &[], ..it });
            }
            (out, found)
        });
        let mut summary = CompensationSummary::of_rows(self, each);
        let mut out = Vec::with_capacity(readings.len());
        for (some, found) in parts {
            let first = out.len();
            out.extend_from_slice(&some);
            for (row, (meant, found)) in readings[first..].chunks_exact(width).zip(found).enumerate() {
                let at = first / width + row;
                if found.is_corrected {
                    let commanded = &some[row * width..(row + 1) * width];
                    summary.include(at, meant, &CompensatedConfiguration { readings: commanded, ..found });
                } else {
                    summary.list(at, "row", self.reason(found.outcome, (found.left_m, found.left_rad)));
                }
            }
        }
        (out, summary)
    }
}

/// Configurations that are corrected one after the other, each starting from the change of the one before; the next ones restart, so that several
/// threads find the same bits.
pub const TOGETHER: usize = 256;

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::robot::{JointTerm, Term};
    use poecal_testing::sessions::unlimited_elbow as elbow;

    #[test]
    fn an_offset_is_taken_off_the_reading() {
        let nominal = elbow();
        let mut actual = nominal.clone();
        actual.terms.push(JointTerm { joint: 1, term: Term::OFFSET, coefficient: 0.01 });
        let mut compensation = Compensation::new(&nominal, &actual, &[], &ChangeOptions::default()).unwrap();
        let found = compensation.joints(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        assert!((found.readings[1] - 0.19).abs() < 1e-12 && found.outcome == CorrectionOutcome::Reached);
    }

    #[test]
    fn a_robot_that_is_as_drawn_is_not_moved() {
        let mut compensation = Compensation::new(&elbow(), &elbow(), &[], &ChangeOptions::default()).unwrap();
        assert_eq!(compensation.joints(&[0.1; 6]).moved_m, 0.0);
        let (out, summary) = compensation.of_many(&[0.1; 12], true);
        assert_eq!((out, summary.rows, summary.moved_m.value), (vec![0.1; 12], 2, 0.0));
    }
}
