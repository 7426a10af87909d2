//! The readings of a robot in the order in which languages count axes.

use poecal_model::robot::{JointKind, Robot};

/// Reason why a target stays unchanged.
pub(crate) const NO_EXTERNAL: &str = "it states no value of an external axis that the model has";
pub(crate) const OTHER_EXTERNAL: &str = "external axes are used that the model does not have: make it a joint target";

/// The readings of the robot, in the order in which languages count axes.
#[derive(Clone, Debug, Default)]
pub struct ControllerAxes {
    /// Names of the readings.
    pub names: Vec<String>,
    /// True for each reading of a prismatic joint.
    pub(crate) slides: Vec<bool>,
    /// Indices of prismatic joints of a robot with six revolute joints: external axes, E1, E2 and so on, in the order of the chain. Empty for other
    /// robots.
    pub external: Vec<usize>,
}

impl ControllerAxes {
    /// The readings of a robot, without factors.
    pub fn from_robot(robot: &Robot) -> Self {
        let slides = |name: &String| {
            let joint = robot.joints.iter().find(|it| it.reading.name == *name);
            joint.is_some_and(|it| it.kind == JointKind::Prismatic)
        };
        let names = robot.joint_reading_names();
        let slides: Vec<bool> = names.iter().map(slides).collect();
        let sliding: Vec<usize> = (0..names.len()).filter(|&it| slides[it]).collect();
        let is_arm = names.len() - sliding.len() == 6;
        ControllerAxes { names, slides, external: if is_arm { sliding } else { Vec::new() } }
    }

    /// Number of the readings.
    pub fn count(&self) -> usize {
        self.names.len()
    }

    /// The six readings of the arm, and those of external axes, in the order of the robot's readings; `None` if there are too few. A robot without
    /// external axes has only the arm's readings.
    pub(crate) fn join_readings<T: Clone>(&self, arm: &[T], external: &[T]) -> Option<Vec<T>> {
        if self.external.is_empty() {
            return Some(arm.to_vec());
        }
        let mut arm = arm.iter();
        let number = |at: usize| match self.external.iter().position(|it| *it == at) {
            Some(place) => external.get(place).cloned(),
            None => arm.next().cloned(),
        };
        (0..self.count()).map(number).collect()
    }

    /// Factor that converts a written reading to rad or m, by its factors for revolute and prismatic joints.
    pub(crate) fn scale(&self, index: usize, turning: f64, sliding: f64) -> f64 {
        if self.slides.get(index) == Some(&true) { sliding } else { turning }
    }
}
