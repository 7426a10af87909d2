//! Axis of a target that is the normal of its face.

use std::borrow::Cow;

use nalgebra::{Matrix3, Vector3};

use crate::state::{Linkage, PackedValues, RowChain, nominal_estimate};
use poecal_arm::lie::Pose;
use poecal_model::measurement::{Dataset, Measurement};
use poecal_model::robot::Robot;
use poecal_numerics::linalg;

/// Finds the axis of each target that was flush on a plane, by the current model: the axis nearest to the plane's normal. It is the pair of
/// directions n (base) and m (target) with the largest `Σ nᵀ R m` over their rows. The plane's z is then up, or along the largest component
/// of n if that is level (theory.md §6 (33a)).
pub fn settle_faces(data: &mut Dataset, robot: &Robot) {
    let Some(sums) = turns_of_faces(data, robot) else { return };
    let normals: Vec<Vector3<f64>> = sums.iter().map(face_normal).collect();
    let targets = data.targets.len();
    for observation in &mut data.observations {
        observation.measurement.set_face_normal(&normals[observation.station * targets + observation.target]);
    }
}

/// The data with faces on planes whose poses are known, by the frames of their stations in the base: a plane's z may be either of its sides.
#[must_use]
pub fn faces_on_known_planes<'a>(data: &'a Dataset, robot: &Robot, base_from_plane: &[Pose]) -> Cow<'a, Dataset> {
    let Some(sums) = turns_of_faces(data, robot) else { return Cow::Borrowed(data) };
    let (mut data, targets) = (data.clone(), data.targets.len());
    for observation in &mut data.observations {
        if let (Some(normal), Some(plane)) =
            (observation.measurement.face_normal(), base_from_plane.get(observation.station))
        {
            let turns: &Matrix3<f64> = &sums[observation.station * targets + observation.target];
            if (turns.transpose() * plane.rotation.column(2)).dot(&normal) < 0.0 {
                observation.measurement.set_face_normal(&-normal);
            }
        }
    }
    Cow::Owned(data)
}

/// Sum of the rotations of the targets that lay flush, in the base, of each station and target; `None` if none did.
fn turns_of_faces(data: &Dataset, robot: &Robot) -> Option<Vec<Matrix3<f64>>> {
    let is_flush = |it: &Measurement| it.face_normal().is_some();
    if !data.observations.iter().any(|row| is_flush(&row.measurement)) {
        return None;
    }
    let mut nominal = nominal_estimate(robot, data);
    nominal.device_from_base = Pose::identity();
    nominal.further_devices.iter_mut().for_each(|device| *device = Pose::identity());
    let (linkage, packed, mut chain) =
        (Linkage::new(&nominal), PackedValues::from_dataset(robot, data), RowChain::default());
    let targets = data.targets.len();
    let mut sums = vec![Matrix3::zeros(); data.station_count() * targets];
    for (row, observation) in data.observations.iter().enumerate() {
        if is_flush(&observation.measurement) {
            chain.evaluate(&linkage, &packed, row, observation);
            sums[observation.station * targets + observation.target] += chain.target.rotation;
        }
    }
    Some(sums)
}

/// Axis, forward or backward, nearest to the m of the largest `nᵀ S m`, with n upward.
fn face_normal(sum: &Matrix3<f64>) -> Vector3<f64> {
    let gram = sum.transpose() * sum;
    let (_, vectors) = linalg::symmetric_eigen(gram.as_slice(), 3);
    let m = Vector3::new(vectors[(0, 2)], vectors[(1, 2)], vectors[(2, 2)]);
    let n = sum * m;
    let up = if n.z.abs() > 0.1 * n.norm() { n.z } else { n[n.iamax()] };
    let k = m.iamax();
    Vector3::ith(k, if (m[k] < 0.0) == (up < 0.0) { 1.0 } else { -1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_arm::lie::Screw;
    use poecal_model::robot::Joint;

    /// The target's x stays up while the joint turns.
    #[test]
    fn the_normal_of_a_face_is_the_axis_that_stays() {
        let turning = Joint::revolute("turntable", Screw::revolute(&Vector3::z(), &Vector3::zeros()));
        let home = Pose::from_xyz_rpy([0.8, 0.0, 0.7], [0.0, -std::f64::consts::FRAC_PI_2, 0.0]);
        let robot = Robot::new("one_axis", vec![turning], home).unwrap();
        let mut data = Dataset::new(robot.reading_names());
        for turned in [0.0, 1.0, 2.0] {
            let touch = Measurement::flush(0.0, &Vector3::z());
            data.push(&[turned], None, touch).unwrap();
        }
        settle_faces(&mut data, &robot);
        for row in &data.observations {
            assert_eq!(row.measurement.face_normal(), Some(Vector3::x()));
        }
    }
}
