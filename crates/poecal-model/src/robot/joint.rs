//! One joint: its screw, its frame, and its joint value as a function of the reading.

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Body;
use poecal_arm::lie::{Pose, Screw, rotation};

/// Kind of a joint.
///
/// ```
/// assert_eq!(poecal_model::robot::JointKind::Revolute.word(), "revolute");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "KindWord", description = "Kind of a joint.")]
pub enum JointKind {
    /// Rotates about an axis; value in radians. URDF's continuous joints are revolute ones without limits.
    #[schemars(description = "Turns.")]
    Revolute,
    /// Translates along a direction; value in metres.
    #[schemars(description = "Slides.")]
    Prismatic,
}

impl JointKind {
    /// The word used in files: `revolute` or `prismatic`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        }
    }

    /// Screw of a joint of this kind: about an axis through a point, or along it.
    pub fn screw(self, direction: &Vector3<f64>, point: &Vector3<f64>) -> Screw {
        match self {
            JointKind::Revolute => Screw::revolute(direction, point),
            JointKind::Prismatic => Screw::prismatic(direction),
        }
    }
}

/// Lower and upper limit of a joint's value, radians or metres.
///
/// ```
/// let limits = poecal_model::robot::JointLimits { lower: -3.1, upper: 3.1 };
/// assert!(limits.lower < limits.upper);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointLimits {
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
}

impl JointLimits {
    /// Stroke of a prismatic joint beyond which its limits are placeholders: files demand limits even if none are known.
    pub const PLACEHOLDER_M: f64 = 100.0;
    /// One turn (rad), with room for rounded numbers.
    pub const TURN_RAD: f64 = std::f64::consts::TAU + 1e-3;
    /// Number (rad, m) beyond which a limit is none: files write 1e16 or infinity if there is none.
    pub const NONE_BEYOND: f64 = 1e5;

    /// Limits as files state them; `None` for an empty range, as exporters write unknown ones, and for numbers that are no limits.
    #[must_use]
    pub fn from_bounds(lower: f64, upper: f64) -> Option<Self> {
        let is_limit = |it: f64| it.abs() < Self::NONE_BEYOND;
        (lower < upper && is_limit(lower) && is_limit(upper)).then_some(JointLimits { lower, upper })
    }
}

/// A joint's value as a function of a reading: `θ = multiplier · reading + offset`, with multiplier 1 and offset 0 except for mimic
/// joints (theory.md §2 (7)).
///
/// ```
/// let own = poecal_model::robot::Reading::from_name("joint1");
/// assert_eq!(own.value(0.3), 0.3);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ReadingEntry", description = "`value = multiplier * reading + offset`.")]
pub struct Reading {
    /// Name of the measured joint: this one, or the leader of a mimic joint.
    #[schemars(description = "Name of the reading.")]
    pub name: String,
    /// Factor on the reading.
    #[schemars(description = "Factor.")]
    pub multiplier: f64,
    /// Offset, radians or metres.
    pub offset: f64,
}

impl Reading {
    /// A joint with a reading of its own.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        Reading { name: name.to_owned(), multiplier: 1.0, offset: 0.0 }
    }

    /// The joint value of a reading.
    #[must_use]
    pub fn value(&self, reading: f64) -> f64 {
        self.multiplier * reading + self.offset
    }
}

/// Standard deviations of an axis from nominal, by the prior of theory.md §6 (27a).
///
/// ```
/// let usual = poecal_model::robot::Tolerance::default();
/// assert_eq!((usual.angle_rad.to_degrees(), usual.length_m), (0.5, 0.005));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Standard deviation of each component of the direction, radians.
    pub angle_rad: f64,
    /// Standard deviation of each component of the position, metres.
    pub length_m: f64,
}

impl Tolerance {
    /// A tolerance so wide that the measurements alone decide: 30° and 0.3 m.
    pub const WIDE: Tolerance = Tolerance { angle_rad: 0.5, length_m: 0.3 };
    /// No prior knowledge.
    pub const NONE: Tolerance = Tolerance { angle_rad: f64::INFINITY, length_m: f64::INFINITY };
}

impl Default for Tolerance {
    /// Half a degree and 5 mm: wider than machining, so that the prior has hardly any effect if the data determine the axis.
    fn default() -> Self {
        Tolerance { angle_rad: 0.5f64.to_radians(), length_m: 5e-3 }
    }
}

/// A moving joint. Its frame is fixed to the link that it moves; at zero joint value it is at `base_from_joint`, with the
/// origin on the axis.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_arm::lie;
/// #     pub use poecal_model::robot::Joint;
/// # }
/// use poecal::lie::Screw;
/// use poecal::Joint;
/// use nalgebra::Vector3;
/// let joint = Joint::revolute("elbow", Screw::revolute(&Vector3::y(), &Vector3::new(0.15, 0.0, 0.57)));
/// assert_eq!(joint.frame.translation, Vector3::new(0.15, 0.0, 0.57));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name, as in the model.
    pub name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Screw in the base frame at zero configuration.
    pub screw: Screw,
    /// `base_from_joint` at zero configuration (URDF: the joint's and its child link's frame).
    pub frame: Pose,
    /// Limits of the value.
    pub limits: Option<JointLimits>,
    /// Joint value as a function of a reading.
    pub reading: Reading,
    /// Tolerance of its axis, if it differs from the common one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Body that carries it, if that is not the link of the joint before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stands_on: Option<Body>,
    /// For a compliant joint, the index of the joint to which its bearing or link belongs. It has no reading of its own; its value is
    /// that of its terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub give_of: Option<usize>,
}

impl Joint {
    /// A revolute joint with its own reading, no limits, and a frame with z along the axis and the origin nearest to the base's.
    #[must_use]
    pub fn revolute(name: &str, screw: Screw) -> Self {
        Joint::with_screw(name, JointKind::Revolute, screw)
    }

    /// A prismatic joint with its own reading, no limits, and a frame at the base's origin with z along the direction.
    #[must_use]
    pub fn prismatic(name: &str, screw: Screw) -> Self {
        Joint::with_screw(name, JointKind::Prismatic, screw)
    }

    /// A joint with a frame on its axis and a reading of its own.
    pub fn with_screw(name: &str, kind: JointKind, screw: Screw) -> Self {
        Joint {
            name: name.to_owned(),
            kind,
            screw,
            frame: axis_frame(&screw),
            limits: None,
            reading: Reading::from_name(name),
            tolerance: None,
            stands_on: None,
            give_of: None,
        }
    }
}

/// A frame with z along the screw, and its origin at the point of the axis nearest to the base's origin.
fn axis_frame(screw: &Screw) -> Pose {
    let z = screw.direction();
    let turn = if z.z.abs() > 1.0 - 1e-12 && z.z > 0.0 {
        Matrix3::identity()
    } else {
        rotation::shortest_arc(&Vector3::z(), &z)
    };
    Pose::new(turn, screw.nearest_point(&Vector3::zeros()))
}
