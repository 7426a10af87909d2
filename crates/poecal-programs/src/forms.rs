//! Forms of poses in the languages.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::Language;
use poecal_arm::lie::{Pose, rotation};

/// A form of a pose in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseForm {
    /// x, y, z in metres, rotation vector in radians (URScript).
    RotationVector,
    /// x, y, z in millimetres, quaternion with its real part first (RAPID).
    Quaternion,
    /// X, Y, Z in millimetres, intrinsic zyx angles A, B, C in degrees (KRL).
    Abc,
    /// X, Y, Z in millimetres, extrinsic xyz angles W, P, R in degrees (FANUC).
    Wpr,
}

const MM: f64 = 1e-3;

impl PoseForm {
    /// The form of a language.
    pub(crate) fn from_language(language: Language) -> Self {
        match language {
            Language::UrScript => PoseForm::RotationVector,
            Language::Rapid => PoseForm::Quaternion,
            Language::Krl => PoseForm::Abc,
            Language::Fanuc => PoseForm::Wpr,
        }
    }

    /// The names of its numbers.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            PoseForm::RotationVector => &["x", "y", "z", "rx", "ry", "rz"],
            PoseForm::Quaternion => &["x", "y", "z", "q1", "q2", "q3", "q4"],
            PoseForm::Abc => &["X", "Y", "Z", "A", "B", "C"],
            PoseForm::Wpr => &["X", "Y", "Z", "W", "P", "R"],
        }
    }

    /// Smallest number of decimals of a number.
    pub fn decimals(self, index: usize) -> usize {
        match (self, index) {
            (PoseForm::RotationVector, _) | (PoseForm::Quaternion, 3..) => 9,
            (_, 0..3) => 6,
            (PoseForm::Abc | PoseForm::Wpr, _) => 7,
        }
    }

    /// The pose of the first of these numbers, the others being words of a configuration; `None` as for `PoseForm::pose`.
    pub fn of_first(self, numbers: &[f64]) -> Option<Pose> {
        self.pose(numbers.get(..self.names().len())?)
    }

    /// The pose of these numbers; `None` if there are too few, or a quaternion is invalid.
    pub(crate) fn pose(self, numbers: &[f64]) -> Option<Pose> {
        let &[x, y, z, a, b, c, ..] = numbers else { return None };
        let angles = [a, b, c].map(f64::to_radians);
        let at = Vector3::new(x, y, z);
        match self {
            PoseForm::RotationVector => Some(Pose::new(rotation::exp(&Vector3::new(a, b, c)), at)),
            PoseForm::Quaternion => {
                let &[.., w, x, y, z] = numbers else { return None };
                let norm = [w, x, y, z].iter().map(|it| it * it).sum::<f64>().sqrt();
                let is_unit = (0.9..1.1).contains(&norm) && numbers.len() == 7;
                is_unit.then(|| Pose::from_position_quaternion((at * MM).into(), [x, y, z, w]))
            }
            PoseForm::Abc => Some(Pose::new(rotation::from_rpy(angles[2], angles[1], angles[0]), at * MM)),
            PoseForm::Wpr => Some(Pose::new(rotation::from_rpy(angles[0], angles[1], angles[2]), at * MM)),
        }
    }

    /// The numbers of a pose, nearest to the earlier numbers.
    pub fn numbers(self, pose: &Pose, near: &[f64]) -> Vec<f64> {
        let at = pose.translation;
        let mm = at / MM;
        let degrees = |angles: [f64; 3]| angles.map(f64::to_degrees);
        match self {
            PoseForm::RotationVector => {
                let turned = nearest_vector(rotation::log(&pose.rotation), near);
                vec![at.x, at.y, at.z, turned.x, turned.y, turned.z]
            }
            PoseForm::Quaternion => {
                let [x, y, z, w] = pose.quaternion_xyzw();
                let found = [w, x, y, z];
                let dot: f64 = found.iter().zip(near.iter().skip(3)).map(|(a, b)| a * b).sum();
                let sign = if dot < 0.0 { -1.0 } else { 1.0 };
                vec![mm.x, mm.y, mm.z, sign * w, sign * x, sign * y, sign * z]
            }
            PoseForm::Abc => {
                let before = [near.get(5), near.get(4), near.get(3)];
                let [c, b, a] = degrees(nearest_angles(rotation::to_rpy(&pose.rotation), before));
                vec![mm.x, mm.y, mm.z, a, b, c]
            }
            PoseForm::Wpr => {
                let before = [near.get(3), near.get(4), near.get(5)];
                let [w, p, r] = degrees(nearest_angles(rotation::to_rpy(&pose.rotation), before));
                vec![mm.x, mm.y, mm.z, w, p, r]
            }
        }
    }
}

/// The rotation vector of the same rotation that is nearest to the numbers behind the position.
fn nearest_vector(vector: Vector3<f64>, near: &[f64]) -> Vector3<f64> {
    let &[_, _, _, x, y, z] = near else { return vector };
    let before = Vector3::new(x, y, z);
    let angle = vector.norm();
    if angle < 1e-9 {
        // A whole turn about any axis is no rotation.
        let turns = (before.norm() / TAU).round();
        return if turns == 0.0 { vector } else { before.normalize() * turns * TAU + vector };
    }
    let axis = vector / angle;
    let turns = ((before.dot(&axis) - angle) / TAU).round();
    axis * (angle + turns * TAU)
}

/// Roll, pitch, yaw of the same rotation (rad) that are nearest to these (degrees).
fn nearest_angles(found: [f64; 3], near: [Option<&f64>; 3]) -> [f64; 3] {
    let before = near.map(|it| it.copied().unwrap_or(0.0).to_radians());
    let turned = |angles: [f64; 3]| {
        let mut out = angles;
        for (it, before) in out.iter_mut().zip(before) {
            *it += ((before - *it) / TAU).round() * TAU;
        }
        out
    };
    let far = |angles: &[f64; 3]| angles.iter().zip(before).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let other = turned([found[0] + PI, PI - found[1], found[2] + PI]);
    let one = turned(found);
    if far(&other) < far(&one) { other } else { one }
}
