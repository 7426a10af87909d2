//! Statistics of the pictures of a camera: tilts and turns of the board, and the extent of its corners in the image.

use nalgebra::{Vector2, Vector3};

use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::linalg;

/// Largest number of poses of one board that are compared with each other.
const COMPARED: usize = 48;
/// Shares of the corners between which they are in the image.
const ENDS: [f64; 2] = [0.02, 0.98];

/// Poses of the boards that a camera saw, and positions of their corners in its image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraViews {
    /// Poses of each board in the camera's frame.
    pub poses: Vec<Vec<Pose>>,
    /// Pixels of all corners.
    pub pixels: Vec<Vector2<f64>>,
}

impl CameraViews {
    /// Largest angle between the normal of a board (its z) and the optical axis, rad; zero without boards.
    #[must_use]
    pub fn largest_tilt(&self) -> f64 {
        let tilt = |pose: &Pose| {
            let normal = pose.rotation.column(2);
            normal.xy().norm().atan2(normal.z.abs())
        };
        self.poses.iter().flatten().map(tilt).fold(0.0, f64::max)
    }

    /// Turns of the boards from picture to picture, rad, root mean square over all pairs: about the axis of most turning, and about all axes
    /// perpendicular to it.
    #[must_use]
    pub fn turns(&self) -> [f64; 2] {
        let turns: Vec<Vector3<f64>> = self.poses.iter().flat_map(|poses| turns(poses)).collect();
        let [most, second, third] = linalg::principal_spread(&turns);
        [most, second.hypot(third)]
    }

    /// Extent of the corners in the image, pixels along `u` and `v`: all but the outermost 2 % at each end.
    #[must_use]
    pub fn extent_px(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let mut values: Vec<f64> = self.pixels.iter().map(|pixel| pixel[axis]).collect();
            values.sort_unstable_by(f64::total_cmp);
            let last = values.len().saturating_sub(1) as f64;
            ENDS.map(|share| values.get((share * last).round() as usize).copied().unwrap_or(0.0))
        })
    }
}

/// Turns between all pairs of some poses, in their parent frame.
fn turns(poses: &[Pose]) -> Vec<Vector3<f64>> {
    let step = poses.len().div_ceil(COMPARED).max(1);
    let some: Vec<&Pose> = poses.iter().step_by(step).collect();
    let pair = |(at, a): (usize, &&Pose)| {
        let a = a.rotation;
        let others = some.iter().enumerate().filter(move |(other, _)| *other != at);
        others.map(move |(_, b)| rotation::log(&(b.rotation * a.transpose()))).collect::<Vec<_>>()
    };
    some.iter().enumerate().flat_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_about_one_axis_are_about_no_other() {
        let about = |axis: Vector3<f64>, angle: f64| Pose::new(rotation::exp(&(axis * angle)), Vector3::zeros());
        let fixed = about(Vector3::new(0.2, -0.5, 0.3), 1.0);
        let axis = Vector3::new(0.6, 0.0, 0.8);
        let poses: Vec<Pose> = (0..20).map(|k| about(axis, 0.1 * f64::from(k)) * fixed).collect();
        let [most, other] = CameraViews { poses: vec![poses.clone()], ..CameraViews::default() }.turns();
        // Differences of evenly spaced angles: √(2 · variance), over pairs that are two pictures.
        let expected = 0.1 * (2.0 * (20.0_f64 * 20.0 - 1.0) / 12.0 * 20.0 / 19.0).sqrt();
        println!("turns {most:.6} of {expected:.6}, {other:.1e} about others");
        // The root of an eigenvalue that is rounding alone.
        assert!((most - expected).abs() < 1e-12 && other < 1e-7);
        let mut both = poses;
        both.push(about(Vector3::x(), 0.7) * fixed);
        assert!(CameraViews { poses: vec![both], ..CameraViews::default() }.turns()[1] > 0.1);
        assert_eq!(CameraViews::default().turns(), [0.0, 0.0]);
    }
}
