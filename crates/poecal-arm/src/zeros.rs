//! Zeros of an arm's joints with which its tip is nearest to that of another arm.

use nalgebra::Vector3;

use crate::arm::Arm;
use crate::arm_state::MOST_JOINTS;
use crate::newton::TipResidual;
use crate::small_systems;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// Number of configurations by which zeros are fitted.
pub(crate) const CONFIGURATIONS: u32 = 48;

/// Range of a joint without limits: half a turn to each side, or this translation (m).
const SLIDE: f64 = 0.5;

/// One of the configurations, within an arm's limits.
pub(crate) fn configuration(arm: &Arm, row: u32) -> [f64; MOST_JOINTS] {
    core::array::from_fn(|joint| {
        let Some(&(low, high)) = arm.limits().get(joint) else { return 0.0 };
        let wide = if arm.screws()[joint].is_prismatic() { SLIDE } else { core::f64::consts::PI };
        let (low, high) = (low.max(-wide).min(wide), high.min(wide).max(-wide));
        low + (high - low) * radical_inverse(row + 1, PRIMES[joint])
    })
}

/// Zeros of the actual arm's joints, by least squares (Levenberg-Marquardt); all 0 if these do not converge.
pub(crate) fn zeros(nominal: &Arm, actual: &Arm) -> [f64; MOST_JOINTS] {
    let n = actual.joints();
    let reach = actual.reach_m();
    let unit = |joint: usize| if actual.screws()[joint].is_prismatic() { reach } else { 1.0 };
    // Sums of all configurations at some zeros: the normal equations, and the squares.
    let at = |zeros: &[f64; MOST_JOINTS]| {
        let (mut a, mut b, mut squares) = ([[0.0; MOST_JOINTS]; MOST_JOINTS], [0.0; MOST_JOINTS], 0.0);
        for row in 0..CONFIGURATIONS {
            let meant = configuration(nominal, row);
            let q: [f64; MOST_JOINTS] = core::array::from_fn(|joint| meant[joint] + zeros[joint]);
            let placed = actual.placement(&q[..n]);
            let left = TipResidual::new(&placed.tip, &nominal.forward_kinematics(&meant[..n]));
            let (p, w) = (left.position / reach, left.rotation);
            squares += p.norm_squared() + w.norm_squared();
            let columns: [(Vector3<f64>, Vector3<f64>); MOST_JOINTS] = core::array::from_fn(|joint| {
                if joint >= n {
                    return (Vector3::zeros(), Vector3::zeros());
                }
                let (v, w) = placed.column(joint);
                (v * (unit(joint) / reach), w * unit(joint))
            });
            for i in 0..n {
                for j in 0..n {
                    a[i][j] += columns[i].0.dot(&columns[j].0) + columns[i].1.dot(&columns[j].1);
                }
                b[i] += columns[i].0.dot(&p) + columns[i].1.dot(&w);
            }
        }
        (a, b, squares)
    };
    let mut zeros = [0.0; MOST_JOINTS];
    let (mut a, mut b, mut squares) = at(&zeros);
    let mut damping = 1e-9;
    for _ in 0..50 {
        let (mut damped, mut step) = (a, b);
        for (joint, row) in damped.iter_mut().enumerate().take(n) {
            row[joint] += damping * f64::from(CONFIGURATIONS);
        }
        if small_systems::solve_symmetric(&mut damped, &mut step, n).is_none() {
            return [0.0; MOST_JOINTS];
        }
        let longest = step.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        let next: [f64; MOST_JOINTS] =
            core::array::from_fn(|joint| if joint < n { zeros[joint] + step[joint] * unit(joint) } else { 0.0 });
        let there = at(&next);
        if there.2 < squares {
            zeros = next;
            (a, b, squares) = there;
            damping = (damping * 0.1).max(1e-12);
        } else {
            damping = (damping * 10.0).max(1e-9);
        }
        if longest < 1e-12 || damping > 1e3 {
            break;
        }
    }
    zeros
}

const PRIMES: [u32; MOST_JOINTS] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

/// Radical inverse: the digits of a number behind the point, the last one first (halton1960).
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut out, mut digit) = (0.0, 1.0 / f64::from(base));
    while number > 0 {
        out += f64::from(number % base) * digit;
        number /= base;
        digit /= f64::from(base);
    }
    out
}
