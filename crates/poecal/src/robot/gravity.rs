//! Weights that a robot carries.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{Body, Joint, Robot};
use crate::lie::Screw;

/// Direction of gravity, and the weights whose moments bend the robot. How heavy they are is not known: only products of mass, lever and
/// give show (theory.md §3, *Sag*).
///
/// ```
/// let robot = poecal::simulate::elbow();
/// let gravity = poecal::robot::Gravity::of_unit_weights(&robot, nalgebra::Vector3::new(0.0, 0.0, -1.0));
/// // At the origins of joints 2 to 6, and at the tip.
/// assert_eq!(gravity.weights.len(), 6);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gravity {
    /// Where weights are pulled, in the base frame, of length 1.
    pub direction: Vector3<f64>,
    /// The weights.
    pub weights: Vec<Weight>,
    /// Screw and origin of each joint by which moments are counted, at zero joint values: those of the drawing, whatever is found.
    pub axes: Vec<(Screw, Vector3<f64>)>,
}

/// A weight on the robot.
///
/// ```
/// use poecal::robot::{Body, Weight};
/// let tool = Weight { name: "tip".to_owned(), body: Body::Link(5), place: nalgebra::Vector3::x() };
/// assert_eq!(tool.body.joint(), Some(5));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weight {
    /// What it is at: the name of a joint, or of the tip.
    pub name: String,
    /// Its body.
    pub body: Body,
    /// Its place at zero joint values, base frame, metres.
    pub place: Vector3<f64>,
}

impl Gravity {
    /// A weight at the origin of each joint but the first, on the link that carries it, and at the tip.
    #[must_use]
    pub fn of_unit_weights(robot: &Robot, direction: Vector3<f64>) -> Self {
        let carried = (0..robot.joints.len()).filter(|&joint| robot.joints[joint].give_of.is_none());
        let at_joints = carried.filter_map(|joint| {
            let body = robot.body_before(joint);
            body.joint()?;
            let place = robot.joints[joint].frame.translation;
            Some(Weight { name: robot.joints[joint].name.clone(), body, place })
        });
        let tip =
            Weight { name: robot.tip_name.clone(), body: robot.tip_body(), place: robot.home.translation };
        let weights = at_joints.chain([tip]).collect();
        Gravity { direction: direction.normalize(), weights, axes: axes(&robot.joints) }
    }
}

/// Screws and origins of joints.
pub(super) fn axes(joints: &[Joint]) -> Vec<(Screw, Vector3<f64>)> {
    joints.iter().map(|joint| (joint.screw, joint.frame.translation)).collect()
}
