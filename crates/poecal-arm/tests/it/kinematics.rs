//! Forward kinematics.

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_arm::{Arm, MOST_JOINTS};

use crate::numbers::Numbers;

#[test]
fn forward_kinematics_is_the_product_of_exponentials() {
    let mut numbers = Numbers(1);
    let mut worst = 0.0_f64;
    for joints in 1..=MOST_JOINTS {
        let screws: Vec<Screw> = (0..joints)
            .map(|joint| match joint % 3 {
                2 => Screw::prismatic(&numbers.vector()),
                _ => Screw::revolute(&numbers.vector(), &numbers.vector()),
            })
            .collect();
        let home = Pose::from_translation(numbers.vector());
        let arm = Arm::new(&screws, &home).unwrap();
        for _ in 0..20 {
            let q: Vec<f64> = (0..joints).map(|_| 4.0 * numbers.next_number()).collect();
            let product = screws.iter().zip(&q).fold(Pose::identity(), |pose, (screw, q)| pose * screw.exp(*q));
            let (found, known) = (arm.forward_kinematics(&q), product * home);
            worst = worst.max((found.translation - known.translation).norm());
            worst = worst.max((found.rotation - known.rotation).norm());
        }
    }
    println!("largest difference from the product of exponentials {worst:.1e}");
    // Some fifty products of numbers up to 40.
    assert!(worst < 1e-13);
}

#[test]
fn an_arm_has_joints_and_finite_numbers() {
    let home = Pose::identity();
    let axis = Screw::revolute(&Vector3::z(), &Vector3::zeros());
    assert!(Arm::new(&[], &home).is_none() && Arm::new(&[axis; MOST_JOINTS + 1], &home).is_none());
    assert!(Arm::new(&[Screw::revolute(&Vector3::zeros(), &Vector3::zeros())], &home).is_none());
    assert!(Arm::new(&[axis], &Pose::from_translation(Vector3::new(f64::NAN, 0.0, 0.0))).is_none());
}
