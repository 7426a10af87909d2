//! The readings of a robot as languages count axes.

use super::super::Compensation;
use crate::robot::{JointKind, Robot};

/// The readings of the robot, as languages count axes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Axes {
    /// Names of the readings.
    pub(crate) names: Vec<String>,
    /// Of each, whether it slides.
    pub(crate) slides: Vec<bool>,
}

impl Axes {
    pub(super) fn of(robot: &Robot, compensation: &Compensation) -> Self {
        let slides = |name: &String| {
            let joint = robot.joints.iter().find(|it| it.reading.name == *name);
            joint.is_some_and(|it| it.kind == JointKind::Prismatic)
        };
        let names = compensation.names().to_vec();
        Axes { slides: names.iter().map(slides).collect(), names }
    }

    /// Number of the readings.
    pub(crate) fn count(&self) -> usize {
        self.names.len()
    }

    /// What a number of a reading is multiplied with to be in rad or m, where it is written in these units for joints that turn and slide.
    pub(crate) fn scale(&self, index: usize, turning: f64, sliding: f64) -> f64 {
        if self.slides.get(index) == Some(&true) { sliding } else { turning }
    }
}
