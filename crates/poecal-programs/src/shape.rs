//! Axes of an arm in a configuration.

use nalgebra::Vector3;
use poecal_arm::Arm;

/// The axes of an arm at a configuration: the point of each axis that is nearest to the tip, and its direction; model's base frame.
pub(crate) fn axes(arm: &Arm, q: &[f64]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let tip = arm.forward_kinematics(q).translation;
    let columns = arm.jacobian(q);
    columns.iter().take(arm.joints()).map(|(v, w)| (tip + w.cross(v) / w.norm_squared().max(1e-12), *w)).collect()
}

/// The point nearest to the last three of six axes: the intersection of the wrist's axes.
pub(crate) fn wrist_centre(axes: &[(Vector3<f64>, Vector3<f64>)]) -> Option<Vector3<f64>> {
    let [_, _, _, a4, a5, a6] = axes else { return None };
    // The point minimises the sum of squared distances from the axes.
    let mut matrix = nalgebra::Matrix3::zeros();
    let mut right = Vector3::zeros();
    for (point, direction) in [a4, a5, a6] {
        let unit = direction.normalize();
        let across = nalgebra::Matrix3::identity() - unit * unit.transpose();
        matrix += across;
        right += across * point;
    }
    let columns = [0, 1, 2].map(|it| Vector3::from(matrix.column(it)));
    let [x, y, z] = columns;
    let determinant = x.dot(&y.cross(&z));
    let by = |a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>| a.dot(&b.cross(c)) / determinant;
    (determinant.abs() > 1e-9).then(|| Vector3::new(by(&right, &y, &z), by(&x, &right, &z), by(&x, &y, &right)))
}
