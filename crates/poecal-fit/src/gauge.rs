//! One choice among the robots that predict the same (gauge). The base frame of the nominal model is kept, and the screws
//! deviate from nominal as little as the data allow. Predictions do not change (theory.md §8 (37) and (38)).

use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};

use crate::parameters::Parameter;
use crate::problem::Layout;
use crate::state::Estimate;
use poecal_arm::lie::{Pose, Screw, Twist, by_turn, by_twist, hat, rotation};
use poecal_model::robot::{Joint, JointKind, Robot, Term};
use poecal_numerics::linalg;

/// Weight of a target's deviation beside that of the screws: it decides only directions that the screws leave undetermined.
const TARGET_WEIGHT: f64 = 1e-3;
/// Share of the largest eigenvalue below which a direction is exactly null: rounding of normal equations.
const NULL: f64 = 1e-13;

/// The base motion that brings an estimate's screws nearest to the nominal robot's, rotations counted with `length_m`; apply it
/// with [`Estimate::rebase`]. `nominal_targets` decide directions that the screws leave undetermined: theory.md §8 (38).
#[must_use]
pub fn base_motion(estimate: &Estimate, robot: &Robot, nominal_targets: &[Pose], length_m: f64) -> Pose {
    let mut motion = Pose::identity();
    for _ in 0..50 {
        let moved = estimate.rebase(&motion);
        let mut gram = Matrix6::zeros();
        let mut gradient = Vector6::zeros();
        let mut add = |derivative: Matrix3x6<f64>, residual: Vector3<f64>| {
            gram += derivative.transpose() * derivative;
            gradient -= derivative.transpose() * residual;
        };
        for (screw, joint) in moved.screws().iter().zip(&robot.joints) {
            for (deviation, derivative) in deviations(screw, joint, length_m) {
                add(derivative, deviation);
            }
        }
        for (pose, nominal) in moved.base_from_target.iter().zip(nominal_targets) {
            let shift = by_twist(&pose.translation) * TARGET_WEIGHT;
            add(shift, (pose.translation - nominal.translation) * TARGET_WEIGHT);
            let turn = rotation::log(&(pose.rotation * nominal.rotation.transpose()));
            add(by_turn(&nalgebra::Matrix3::identity(), TARGET_WEIGHT * length_m), turn * (TARGET_WEIGHT * length_m));
        }
        let upper: Vec<f64> = (0..36).map(|k| gram[(k / 6, k % 6)]).collect();
        let Some(factor) = linalg::cholesky(&upper, 6, 1e-12 * gram.trace()) else { break };
        let step = linalg::cholesky_solve(&factor, gradient.as_slice());
        let step = Vector6::from_column_slice(&step);
        motion = (Pose::exp(&Twist::from_vector(&step)) * motion).orthonormalized();
        if step.norm() < 1e-13 {
            break;
        }
    }
    motion
}

/// Deviation of a screw from nominal: tilt (an arc at `length_m`) and shift relative to the nominal joint's origin (an axis only). Each
/// has its derivative by a spatial motion of the screw (theory.md §8 (38)).
fn deviations(screw: &Screw, nominal: &Joint, length_m: f64) -> [(Vector3<f64>, Matrix3x6<f64>); 2] {
    let direction = screw.direction();
    let tilt = (direction - nominal.screw.direction()) * length_m;
    let tilting = by_turn(&-hat(&direction), length_m);
    if screw.is_prismatic() {
        return [(tilt, tilting), (Vector3::zeros(), Matrix3x6::zeros())];
    }
    let origin = &nominal.frame.translation;
    let at = screw.nearest_point(origin);
    let across = nalgebra::Matrix3::identity() - direction * direction.transpose();
    [(tilt, tilting), (at - origin, across * by_twist(&at))]
}

/// The step within the null space of `gram` that brings the screws nearest to nominal, theory.md §8, below (38); `None` without a null
/// space. With `base_free` it is the best step together with that of the base ([`base_motion`]).
#[must_use]
pub fn null_step(
    estimate: &Estimate,
    robot: &Robot,
    layout: &Layout,
    gram: &[f64],
    length_m: f64,
    base_free: bool,
) -> Option<Vec<f64>> {
    let n = layout.dim();
    // The matrix is positive definite even when shifted by more than that: there is no null space, and no eigenvalue is needed.
    let trace: f64 = (0..n).map(|k| gram[k * n + k]).sum();
    if linalg::cholesky(gram, n, -2.0 * NULL * trace).is_some() {
        return None;
    }
    let (values, vectors) = linalg::symmetric_eigen(gram, n);
    let largest = values.last().copied().unwrap_or(0.0);
    let null = values.iter().take_while(|&&value| value <= NULL * largest).count();
    if null == 0 {
        return None;
    }
    let screws = estimate.screws();
    let deviations: Vec<_> =
        screws.iter().zip(&robot.joints).map(|(screw, joint)| deviations(screw, joint, length_m)).collect();
    let now = deviations.iter().flatten().flat_map(|(deviation, _)| deviation.iter().copied());
    let now: Vec<f64> = now.collect();
    // Change of the deviations by motions of the screws.
    let effect = |motions: &[Vector6<f64>]| -> Vec<f64> {
        let changes = deviations
            .iter()
            .zip(motions)
            .flat_map(|(of_screw, motion)| of_screw.iter().map(move |(_, derivative)| derivative * motion));
        changes.flat_map(|change| [change.x, change.y, change.z]).collect()
    };
    let mut effects: Vec<Vec<f64>> = Vec::new();
    for direction in vectors.column_iter().take(null) {
        let (motions, targets) = motions(estimate, layout, direction.iter().copied().collect());
        let mut change = effect(&motions);
        change.extend(targets.iter().map(|change| TARGET_WEIGHT * change));
        effects.push(change);
    }
    if base_free {
        for unit in Matrix6::<f64>::identity().column_iter() {
            effects.push(effect(&vec![unit.into_owned(); screws.len()]));
        }
    }
    let coefficients = linalg::combination(&effects, &now)?;
    Some((0..n).map(|k| (0..null).map(|i| vectors[(k, i)] * coefficients[i]).sum()).collect())
}

/// The spatial motion of each screw in a step, and the step with the screws' part left out.
fn motions(estimate: &Estimate, layout: &Layout, step: Vec<f64>) -> (Vec<Vector6<f64>>, Vec<f64>) {
    let mut motions = vec![Vector6::zeros(); estimate.base_from_axis.len()];
    let mut rest = step;
    for (parameter, places) in layout.parameters() {
        let Some(axis) = parameter.screw_axis() else { continue };
        let own: Vec<f64> = places.iter().map(|&(place, scale)| rest[place] / scale).collect();
        let local = match axis.kind {
            JointKind::Revolute => Twist::new(Vector3::new(own[0], own[1], 0.0), Vector3::new(own[2], own[3], 0.0)),
            JointKind::Prismatic => Twist::new(Vector3::zeros(), Vector3::new(own[0], own[1], 0.0)),
        };
        motions[axis.joint] = estimate.base_from_axis[axis.joint].transform(&local).to_vector();
        places.iter().for_each(|&(place, _)| rest[place] = 0.0);
    }
    (motions, rest)
}

/// Spatial motion of each screw by each scaled unknown, of a serial chain; the offset of a joint moves all screws beyond it.
#[must_use]
pub fn screw_motions(estimate: &Estimate, layout: &Layout) -> Vec<Vec<Vector6<f64>>> {
    let n = layout.dim();
    let unit = |k: usize| (0..n).map(|it| if it == k { 1.0 } else { 0.0 }).collect();
    let mut moved: Vec<_> = (0..n).map(|k| motions(estimate, layout, unit(k)).0).collect();
    let screws = estimate.screws();
    for (parameter, places) in layout.parameters() {
        let (Parameter::ValueTerm(term), [(place, scale)]) = (parameter, places) else { continue };
        if term.term == Term::OFFSET {
            let by_offset = screws[term.joint].twist().to_vector() / *scale;
            moved[*place].iter_mut().skip(term.joint + 1).for_each(|motion| *motion += by_offset);
        }
    }
    moved
}

/// Deviation of a screw from nominal, with its derivatives by the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct ScrewDeviation {
    /// Angle between the directions, radians.
    pub tilt_rad: f64,
    /// Distance of the axis from the nominal joint's origin, metres; zero for a prismatic joint.
    pub shift_m: f64,
    /// Derivatives of the tilt (a vector, radians) by each scaled unknown: three rows.
    pub tilt_by_step: [Vec<f64>; 3],
    /// Derivatives of the shift (a vector, metres).
    pub shift_by_step: [Vec<f64>; 3],
}

/// Deviation of each screw from nominal in the gauge of [`base_motion`] (if `base_free`), to first order (docs/theory.md §8 (38)).
#[must_use]
pub fn screw_deviations(
    estimate: &Estimate,
    robot: &Robot,
    layout: &Layout,
    length_m: f64,
    base_free: bool,
) -> Vec<ScrewDeviation> {
    let n = layout.dim();
    let screws = estimate.screws();
    let each: Vec<_> =
        screws.iter().zip(&robot.joints).map(|(screw, joint)| deviations(screw, joint, length_m)).collect();
    let mut gram = Matrix6::zeros();
    for (_, derivative) in each.iter().flatten() {
        gram += derivative.transpose() * derivative;
    }
    let upper: Vec<f64> = (0..36).map(|k| gram[(k / 6, k % 6)]).collect();
    let base = if base_free { linalg::cholesky(&upper, 6, 1e-12 * gram.trace()) } else { None };
    // Motions of the screws by each unknown, less the motion of the base that follows.
    let effects: Vec<Vec<Vector6<f64>>> = (0..n)
        .map(|k| {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let (mut moved, _) = motions(estimate, layout, unit);
            if let Some(factor) = &base {
                let mut pull = Vector6::zeros();
                for (of_screw, motion) in each.iter().zip(&moved) {
                    for (_, derivative) in of_screw {
                        pull += derivative.transpose() * (derivative * motion);
                    }
                }
                let follows = Vector6::from_column_slice(&linalg::cholesky_solve(factor, pull.as_slice()));
                moved.iter_mut().for_each(|motion| *motion -= follows);
            }
            moved
        })
        .collect();
    each.iter()
        .zip(&screws)
        .zip(&robot.joints)
        .enumerate()
        .map(|(index, ((of_screw, screw), joint))| {
            let [(_, tilting), (shift, shifting)] = of_screw;
            let rows = |derivative: &Matrix3x6<f64>, scale: f64| -> [Vec<f64>; 3] {
                std::array::from_fn(|row| {
                    effects.iter().map(|effect| (derivative * effect[index])[row] / scale).collect()
                })
            };
            let (a, b) = (screw.direction(), joint.screw.direction());
            ScrewDeviation {
                tilt_rad: a.cross(&b).norm().atan2(a.dot(&b)),
                shift_m: shift.norm(),
                tilt_by_step: rows(tilting, length_m),
                shift_by_step: rows(shifting, 1.0),
            }
        })
        .collect()
}
