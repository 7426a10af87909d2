//! Tables I and II of lou2009: the elbow of its simulations, nominal and as prescribed.

use nalgebra::{Vector3, Vector6};

use poecal_arm::lie::{Pose, Screw, Twist};
use poecal_model::robot::Robot;
use poecal_model::simulate;

/// Table II, right: the identified screws `(v; ω)` as printed, with four decimals and v in millimetres.
pub const PRINTED_SCREWS_MM: [[f64; 6]; 6] = [
    [0.0222, -0.0144, 0.0009, 0.0194, -0.0317, 0.9993],
    [0.1764, 2.8933, 151.2188, 0.0504, 0.9985, -0.0192],
    [583.8102, 14.9619, -154.0245, 0.0307, -0.9993, 0.0195],
    [60.3165, -690.8776, 1.7673, -0.9958, -0.0870, -0.0290],
    [-733.2256, -29.1784, 798.2115, -0.0143, 0.9996, 0.0234],
    [-17.1142, -702.2271, -0.9022, -0.9984, 0.0244, -0.0517],
];

/// Table II: the identified point `P_c0`, millimetres.
pub const PRESCRIBED_POINT_MM: [f64; 3] = [839.01, -5.03, 724.974];

/// Joint offsets of the experiment with offsets in the truth, degrees. The paper prescribes some and does not print them; these are this project's
/// own, of a size typical for mounting an encoder.
pub const PRESCRIBED_OFFSETS_DEG: [f64; 6] = [4.0, -3.0, 2.0, 6.0, -4.0, 5.0];

/// The identified screws of Table II as printed, as twists in metres. Because of rounding they are no screws: see [`rounding`].
#[must_use]
pub fn printed_screws() -> [Twist; 6] {
    PRINTED_SCREWS_MM.map(|row| {
        let twist = Twist::from_vector(&Vector6::from(row));
        Twist::new(twist.v / 1000.0, twist.w)
    })
}

/// The robot before calibration: screws and point of Table II, left, and ranges of Table I. Its home pose has no rotation, and its
/// translation is the point `P_c0`.
#[must_use]
pub fn nominal_robot() -> Robot {
    simulate::elbow()
}

/// The robot to be identified: the printed screws, each made a screw as by [`Screw::project`] (theory.md §5 (22c)), and the printed point as home
/// pose without rotation.
#[must_use]
pub fn prescribed_robot() -> Robot {
    // The axis along ω through its point nearest to the origin.
    let screws = printed_screws().map(|it| Screw::revolute(&it.w, &(it.w.cross(&it.v) / it.w.norm_squared())));
    let mut robot = nominal_robot().with_screws(&screws);
    robot.home = Pose::from_translation(Vector3::from(PRESCRIBED_POINT_MM) / 1000.0);
    robot
}

/// Violation of the constraints of a revolute screw by the printed screws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrintedRounding {
    /// Largest `|v·ω|`, millimetres.
    pub pitch_mm: f64,
    /// Largest `||ω| - 1|`.
    pub length: f64,
}

/// Violation of the screw constraints in Table II due to four decimals.
#[must_use]
pub fn rounding() -> PrintedRounding {
    let largest = |miss: fn(&Twist) -> f64| printed_screws().iter().map(miss).fold(0.0, f64::max);
    PrintedRounding {
        pitch_mm: largest(|screw| 1000.0 * screw.v.dot(&screw.w).abs()),
        length: largest(|screw| (screw.w.norm() - 1.0).abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table I: range of each joint, degrees.
    const RANGES_DEG: [[f64; 2]; 6] =
        [[-180.0, 180.0], [-105.0, 175.0], [-235.0, 85.0], [-180.0, 180.0], [-40.0, 220.0], [-360.0, 360.0]];

    /// Table II, left: the nominal screws `(v; ω)`, v in millimetres. Those of [`simulate::elbow`].
    const NOMINAL_SCREWS_MM: [[f64; 6]; 6] = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 150.0, 0.0, 1.0, 0.0],
        [570.0, 0.0, -150.0, 0.0, -1.0, 0.0],
        [0.0, -720.0, 0.0, -1.0, 0.0, 0.0],
        [-720.0, 0.0, 784.0, 0.0, 1.0, 0.0],
        [0.0, -720.0, 0.0, -1.0, 0.0, 0.0],
    ];

    /// Table II: the nominal point `P_c0`, millimetres.
    const NOMINAL_POINT_MM: [f64; 3] = [834.0, 0.0, 720.0];

    #[test]
    fn table_is_the_simulated_elbow() {
        let robot = nominal_robot();
        for ((joint, screw), range) in robot.joints.iter().zip(NOMINAL_SCREWS_MM).zip(RANGES_DEG) {
            let (v, w) = (joint.screw.v() * 1000.0, joint.screw.w());
            let difference = Vector6::from(screw) - Twist::new(v, w).to_vector();
            assert!(difference.norm() < 1e-12, "{}: {difference}", joint.name);
            let limits = joint.limits.unwrap();
            assert_eq!([limits.lower, limits.upper], range.map(f64::to_radians), "{}", joint.name);
        }
        assert!((robot.home.translation * 1000.0 - Vector3::from(NOMINAL_POINT_MM)).norm() < 1e-12);
    }

    #[test]
    fn prescribed_screws_are_the_printed_ones_but_for_rounding() {
        let robot = prescribed_robot();
        let rounding = rounding();
        println!("|v·ω| up to {:.4} mm, ||ω| - 1| up to {:.1e}", rounding.pitch_mm, rounding.length);
        assert!((rounding.pitch_mm - 0.0319).abs() < 1e-4 && (rounding.length - 4.4e-5).abs() < 1e-6);
        assert_eq!(robot.joints.len(), PRINTED_SCREWS_MM.len());
        for (joint, printed) in robot.joints.iter().zip(printed_screws()) {
            let projected = Screw::project(&printed).unwrap().twist().to_vector();
            assert!((joint.screw.twist().to_vector() - projected).amax() < 1e-15, "{}", joint.name);
            // Rounding of |ω| is a share of v too, which is up to 1.1 m.
            assert!((joint.screw.v() - printed.v).norm() < 1e-4, "{}", joint.name);
            assert!((joint.screw.w() - printed.w).norm() < 1e-4, "{}", joint.name);
        }
    }
}
