//! The readings of a robot as languages count axes.

use poecal_model::robot::{JointKind, Robot};

/// Why a target stays as it is.
pub(crate) const NO_EXTERNAL: &str = "it states no value of an external axis that the model has";
pub(crate) const OTHER_EXTERNAL: &str =
    "external axes are used that the model does not have: make it a joint target";

/// The readings of the robot, as languages count axes.
#[derive(Clone, Debug, Default)]
pub struct Axes {
    /// Names of the readings.
    pub names: Vec<String>,
    /// Of each, whether it slides.
    pub(crate) slides: Vec<bool>,
    /// Slides of a robot with six turning joints beside: external axes, E1, E2 and so on, in the order of the chain. None of other robots.
    pub external: Vec<usize>,
}

impl Axes {
    /// Those of a robot; factors are none.
    pub fn from_robot(robot: &Robot) -> Self {
        let slides = |name: &String| {
            let joint = robot.joints.iter().find(|it| it.reading.name == *name);
            joint.is_some_and(|it| it.kind == JointKind::Prismatic)
        };
        let names = robot.joint_reading_names();
        let slides: Vec<bool> = names.iter().map(slides).collect();
        let sliding: Vec<usize> = (0..names.len()).filter(|&it| slides[it]).collect();
        let is_arm = names.len() - sliding.len() == 6;
        Axes { names, slides, external: if is_arm { sliding } else { Vec::new() } }
    }

    /// Number of the readings.
    pub fn count(&self) -> usize {
        self.names.len()
    }

    /// The six readings of the arm, and those of external axes, in the order of the robot's readings; `None` if there are too few. Of a robot
    /// without external axes those of the arm as they are.
    pub(crate) fn joined<T: Clone>(&self, arm: &[T], external: &[T]) -> Option<Vec<T>> {
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

    /// What a number of a reading is multiplied with to be in rad or m, where it is written in these units for joints that turn and slide.
    pub(crate) fn scale(&self, index: usize, turning: f64, sliding: f64) -> f64 {
        if self.slides.get(index) == Some(&true) { sliding } else { turning }
    }
}
