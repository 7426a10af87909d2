//! All branches compared with a search from many starts.

use std::f64::consts::PI;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw};
use poecal_arm::trig::wrap_angle;
use poecal_arm::{AllBranches, Arm};

use crate::calibrated::{KINDS, arm};
use crate::numbers::Numbers;
use poecal_testing::trials::trials;

/// Number of targets of each arm, weekly.
const TARGETS: usize = 120;
const STARTS: usize = 150;

fn is_same(one: &[f64; 6], other: &[f64; 6]) -> bool {
    one.iter().zip(other).all(|(one, other)| wrap_angle(one - other).abs() < 1e-6)
}

/// Branches that a search and the solver know together, those of the solver, and the same numbers where the arm is far from singular;
/// and the largest remainder (m, rad).
fn compare_branches(arm: &Arm, numbers: &mut Numbers) -> ([usize; 4], f64) {
    let all = AllBranches::new(arm).unwrap();
    let (mut counts, mut worst) = ([0; 4], 0.0_f64);
    for _ in trials(TARGETS).seeds() {
        let q = numbers.six_numbers(PI);
        let target = arm.forward_kinematics(&q);
        let found = all.branches_at(&target);
        let mut known = found.as_slice().to_vec();
        for branch in found.as_slice() {
            let there = arm.forward_kinematics(branch);
            worst = worst.max((there.translation - target.translation).norm());
            worst = worst.max((there.rotation - target.rotation).norm());
        }
        for start in 0..STARTS {
            let mut at = if start == 0 { q } else { numbers.six_numbers(PI) };
            if arm.solve_nearest(&target, &mut at) < 1e-11 && !known.iter().any(|it| is_same(it, &at)) {
                known.push(at.map(wrap_angle));
            }
        }
        for (at, branch) in known.iter().enumerate() {
            let is_found = usize::from(at < found.as_slice().len());
            counts[0] += 1;
            counts[1] += is_found;
            if arm.smallest_singular_value(branch) > 0.01 {
                counts[2] += 1;
                counts[3] += is_found;
            }
        }
    }
    (counts, worst)
}

#[test]
fn every_branch_that_a_search_finds_is_found() {
    let (mut sum, mut largest) = ([0; 4], 0.0_f64);
    for kind in KINDS {
        for (angle, length) in [(0.0, 0.0), (0.005, 1e-3), (0.0175, 5e-3)] {
            let (counts, worst) = compare_branches(&arm(kind, angle, length), &mut Numbers(5));
            let [known, found, far, found_far] = counts;
            println!(
                "{kind}, axes off by {angle} rad and {length} m: {found} of {known} branches, far from singular {found_far} of {far}; \
                 largest remainder {worst:.1e}"
            );
            sum.iter_mut().zip(counts).for_each(|(sum, it)| *sum += it);
            largest = largest.max(worst);
        }
    }
    assert!(largest < 1e-10);
    // Near a meeting of two branches, one of them may be lost; far from there, one in 10,000 at most.
    assert!(sum[1] as f64 >= 0.9995 * sum[0] as f64, "{sum:?}");
    assert!(sum[3] as f64 >= 0.9999 * sum[2] as f64, "{sum:?}");
}

#[test]
fn what_is_out_of_reach_has_no_branch() {
    let far = Pose::from_translation(Vector3::new(9.0, 0.0, 0.0));
    for kind in KINDS {
        assert!(AllBranches::new(&arm(kind, 0.005, 1e-3)).unwrap().branches_at(&far).as_slice().is_empty());
    }
}

#[test]
fn all_branches_are_of_six_axes() {
    let axis = Screw::revolute(&Vector3::z(), &Vector3::zeros());
    assert!(AllBranches::new(&Arm::new(&[axis; 7], &Pose::identity()).unwrap()).is_none());
    let slide = Screw::prismatic(&Vector3::z());
    assert!(AllBranches::new(&Arm::new(&[axis, axis, axis, axis, axis, slide], &Pose::identity()).unwrap()).is_none());
    // Six equal axes: there is no solution, and no panic.
    let flat = AllBranches::new(&Arm::new(&[axis; 6], &Pose::identity()).unwrap()).unwrap();
    let _ = flat.branches_at(&Pose::identity());
}
