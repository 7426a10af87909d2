//! Rotation of the flange, and its number of axes.

use nalgebra::Vector3;

use super::types::FlangeTurns;
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{ErrorKind, Result};

/// Standard deviation of turns about the second axis, radians, below which there is one axis only.
const ONE_AXIS: f64 = 8e-3;

/// Rotation of the flange about its own axes.
pub(crate) fn turns(flange: &[Pose], counted: &[usize]) -> FlangeTurns {
    let middle = crate::start::mean_rotation(counted.iter().map(|&row| flange[row].rotation));
    let turned: Vec<Vector3<f64>> =
        counted.iter().map(|&row| rotation::log(&(middle.transpose() * flange[row].rotation))).collect();
    let mean = turned.iter().sum::<Vector3<f64>>() / turned.len().max(1) as f64;
    let mut upper = [0.0; 9];
    for turn in &turned {
        let off = turn - mean;
        for i in 0..3 {
            for j in 0..3 {
                upper[3 * i + j] += off[i] * off[j] / turned.len() as f64;
            }
        }
    }
    let (values, vectors) = poecal_numerics::linalg::symmetric_eigen(&upper, 3);
    FlangeTurns {
        spread_rad: [2, 1, 0].map(|k| values[k].max(0.0).sqrt()),
        directions: [2, 1, 0].map(|k| Vector3::new(vectors[(0, k)], vectors[(1, k)], vectors[(2, k)])),
    }
}

/// Refuses turns about one axis.
pub(crate) fn refuse_one_axis(turns: &FlangeTurns) -> Result<()> {
    let [most, second, _] = turns.spread_rad;
    let axis = turns.directions[0];
    if second >= ONE_AXIS {
        return Ok(());
    }
    if most < ONE_AXIS {
        return ErrorKind::Problem.refuse(
            "found poses of the arm that do not turn, expected turns about two axes or more: by shifts alone only the orientation of the camera can be \
             found; turn the flange by 20 deg and more about different axes",
        );
    }
    ErrorKind::Problem.refuse(format!(
        "found poses of the arm that turn about one axis only ({:.2} {:.2} {:.2} of the flange), expected two or more: the place of the camera along \
         that axis is not determined; turn the flange by 20 deg and more about a second axis across it",
        axis.x, axis.y, axis.z
    ))
}
