//! The nearest configuration.

use poecal_arm::AllBranches;

use crate::calibrated::{KINDS, arm};
use crate::numbers::Numbers;

#[test]
fn the_nearest_configuration_is_reached_from_within_0_3_rad() {
    for kind in KINDS {
        let arm = arm(kind, 0.005, 1e-3);
        let all = AllBranches::new(&arm).unwrap();
        let mut numbers = Numbers(3);
        let (mut worst, mut count, mut missed) = (0.0_f64, 0, 0);
        for _ in 0..3000 {
            let q = numbers.six_numbers(3.1);
            if arm.smallest_singular_value(&q) < 0.01 {
                continue;
            }
            let target = arm.forward_kinematics(&q);
            let mut near = q.map(|it| it + 0.3 * numbers.next_number());
            let mut iterated = near;
            missed += usize::from(arm.solve_nearest(&target, &mut iterated) > 1e-10);
            worst = worst.max(all.solve_nearest(&target, &mut near));
            count += 1;
        }
        println!(
            "{kind}: {count} targets, of which the iteration alone misses {missed}; largest remainder {worst:.1e}"
        );
        assert!(worst < 1e-10 && count > 2000, "{kind}");
    }
}
