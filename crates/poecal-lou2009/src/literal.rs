//! The Jacobians of lou2009 as printed, with the errata of docs/theory.md §10 applied and no shortcut: every exponential, left Jacobian and bracket
//! is as in the paper. The solver uses the telescoping form, theory.md §3 (12), instead; this module verifies it, and determines the ranks of the
//! paper's own matrices.

use nalgebra::{DMatrix, Matrix3x6, Matrix6, Vector3, Vector6};

use super::MeasurementKind;
use crate::PaperFormulation;
use poecal_arm::lie::{Pose, Screw, Twist, hat};
use poecal_model::robot::Robot;

/// Adjoint errors of a robot: `ξ_i = Ad_exp(η_i) ξ_i^n` and `M = exp(Υ) M^n` (lou2009 (16) to (18); theory.md §3 (10)).
#[derive(Clone, Debug, PartialEq)]
pub struct AdjointErrors {
    /// `η_i` of each joint, base frame, metres and radians.
    pub eta: Vec<Twist>,
    /// `Υ` of the home pose, base frame, metres and radians.
    pub upsilon: Twist,
}

impl AdjointErrors {
    /// No errors.
    #[must_use]
    pub fn zero(robot: &Robot) -> Self {
        AdjointErrors { eta: vec![Twist::zero(); robot.joints.len()], upsilon: Twist::zero() }
    }

    /// The robot with these errors; an axis without `η` stays.
    #[must_use]
    pub fn apply(&self, nominal: &Robot) -> Robot {
        let mut screws: Vec<Screw> = nominal.joints.iter().map(|joint| joint.screw).collect();
        for (screw, eta) in screws.iter_mut().zip(&self.eta) {
            *screw = screw.transform(&Pose::exp(eta));
        }
        let mut robot = nominal.with_screws(&screws);
        robot.home = Pose::exp(&self.upsilon) * nominal.home;
        robot
    }
}

/// The parts of the paper's matrix `A` at one configuration, in the base frame (theory.md §3 (8)).
#[derive(Clone, Debug, PartialEq)]
pub struct PaperMatrix {
    /// `r_k`, lou2009 (8d): the screws as moved by the joints before.
    pub offset_columns: Vec<Vector6<f64>>,
    /// `Q_k`, lou2009 (8e): effect of a change of the six numbers of screw k.
    pub screw_blocks: Vec<Matrix6<f64>>,
    /// `Q_M`, lou2009 (8f), of `Υ = log M`.
    pub home_block: Matrix6<f64>,
    /// `exp(ξ₁θ₁) … exp(ξₙθₙ)`, whose rotation is `R_f` of lou2009 (25).
    pub motion: Pose,
}

impl PaperMatrix {
    /// The parts for a robot and its joint values (radians, metres; one a joint).
    #[must_use]
    pub fn new(robot: &Robot, values: &[f64]) -> Self {
        let mut before = Pose::identity();
        let (mut offset_columns, mut screw_blocks) = (Vec::new(), Vec::new());
        for (joint, &value) in robot.joints.iter().zip(values) {
            let xi = joint.screw.twist();
            let turned = Twist::new(xi.v * value, xi.w * value);
            offset_columns.push(before.adjoint() * xi.to_vector());
            screw_blocks.push(before.adjoint() * turned.left_jacobian() * value);
            before = before * Pose::exp(&turned);
        }
        let home_block = before.adjoint() * robot.home.log().left_jacobian();
        PaperMatrix { offset_columns, screw_blocks, home_block, motion: before }
    }
}

/// `dξ/dη` of lou2009 (18) for a nominal screw at error `η`: `-adjoint_matrix(Ad_exp(η) ξ^n) ∫ Ad_exp(η s) ds`
/// (theory.md §3 (10a)).
#[must_use]
pub fn screw_by_adjoint_error(nominal: &Screw, eta: &Twist) -> Matrix6<f64> {
    -nominal.transform(&Pose::exp(eta)).twist().adjoint_matrix() * eta.left_jacobian()
}

/// `[I  -P̂]` of lou2009 (23): motion of the point `P` by a twist of the base frame (metres; theory.md §3 (12a)).
#[must_use]
pub fn point_rows(point: &Vector3<f64>) -> Matrix3x6<f64> {
    let mut rows = Matrix3x6::identity();
    rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(point));
    rows
}

/// The paper's matrix for one configuration of joint values (radians, metres), in the base frame and right-trivialised (theory.md §3 (8), (10b) and
/// (12a)). Columns in the order of lou2009 (7): joint offsets (if any), joints from base to tip, then `Υ` or the point `P_c0`, which is the origin of
/// the home pose.
///
/// | formulation | poses, 6 rows | points, 3 rows |
/// |---|---|---|
/// | `screw` | (9) without `r`, 6n + 6 | `[I -P̂]` of that, 6n + 3 |
/// | `screw-offsets` | (9), 7n + 6 | 7n + 3 |
/// | `adjoint` | (9) with (18), 6n + 6 | (26), 6n + 3 |
/// | `adjoint-offsets` | 7n + 6 | 7n + 3 |
///
/// The free screw of a prismatic joint has 3 columns instead of 6: its ω is zero, "and thus left out of the calibration".
#[must_use]
pub fn jacobian(robot: &Robot, values: &[f64], formulation: PaperFormulation, seen: MeasurementKind) -> DMatrix<f64> {
    if !formulation.has_free_screws() {
        return adjoint_jacobian(robot, &AdjointErrors::zero(robot), values, formulation.has_offsets(), seen);
    }
    let literal = PaperMatrix::new(robot, values);
    let mut columns: Vec<Vector6<f64>> = Vec::new();
    for (joint, block) in robot.joints.iter().zip(&literal.screw_blocks) {
        let free = if joint.screw.is_prismatic() { 3 } else { 6 };
        columns.extend(block.column_iter().take(free).map(|column| column.into_owned()));
    }
    assemble(robot, &literal, &literal.home_block, &columns, formulation.has_offsets(), seen)
}

/// The matrix of the adjoint formulation about non-zero errors: (9) with (18), and (26) for points, by `dη_i` and `dΥ` of `M = exp(Υ) M^n`.
#[must_use]
pub fn adjoint_jacobian(
    nominal: &Robot,
    errors: &AdjointErrors,
    values: &[f64],
    offsets: bool,
    seen: MeasurementKind,
) -> DMatrix<f64> {
    let robot = errors.apply(nominal);
    let literal = PaperMatrix::new(&robot, values);
    let mut columns: Vec<Vector6<f64>> = Vec::new();
    for ((joint, eta), block) in nominal.joints.iter().zip(&errors.eta).zip(&literal.screw_blocks) {
        let by_eta = block * screw_by_adjoint_error(&joint.screw, eta);
        columns.extend(by_eta.column_iter().map(|column| column.into_owned()));
    }
    let by_upsilon = literal.motion.adjoint() * errors.upsilon.left_jacobian();
    assemble(&robot, &literal, &by_upsilon, &columns, offsets, seen)
}

/// Assembles the columns side by side: offsets, joints, and those of the tool.
fn assemble(
    robot: &Robot,
    literal: &PaperMatrix,
    home: &Matrix6<f64>,
    joints: &[Vector6<f64>],
    offsets: bool,
    seen: MeasurementKind,
) -> DMatrix<f64> {
    let mut twists = if offsets { literal.offset_columns.clone() } else { Vec::new() };
    twists.extend(joints);
    match seen {
        MeasurementKind::Poses => {
            twists.extend(home.column_iter().map(|column| column.into_owned()));
            let columns: Vec<f64> = twists.iter().flatten().copied().collect();
            DMatrix::from_vec(6, twists.len(), columns)
        }
        MeasurementKind::Points => {
            let rows = point_rows(&literal.motion.act(&robot.home.translation));
            let mut columns: Vec<Vector3<f64>> = twists.iter().map(|twist| rows * twist).collect();
            columns.extend(literal.motion.rotation.column_iter().map(|column| column.into_owned()));
            let columns: Vec<f64> = columns.iter().flatten().copied().collect();
            DMatrix::from_vec(3, columns.len() / 3, columns)
        }
    }
}

/// The matrices of several configurations one below the other, lou2009 (10), with radians counted as `length_m` metres in rows and columns, so that
/// singular values compare. A length of 1 leaves the numbers unchanged.
#[must_use]
pub fn stack_matrices(
    robot: &Robot,
    configurations: &[Vec<f64>],
    formulation: PaperFormulation,
    seen: MeasurementKind,
    length_m: f64,
) -> DMatrix<f64> {
    let scales = column_scales(robot, formulation, seen, length_m);
    let each = if seen == MeasurementKind::Poses { 6 } else { 3 };
    let mut all = DMatrix::zeros(each * configurations.len(), scales.len());
    for (k, values) in configurations.iter().enumerate() {
        all.rows_mut(each * k, each).copy_from(&jacobian(robot, values, formulation, seen));
        if seen == MeasurementKind::Poses {
            all.rows_mut(each * k + 3, 3).scale_mut(length_m);
        }
    }
    for (mut column, scale) in all.column_iter_mut().zip(scales) {
        column.scale_mut(scale);
    }
    all
}

/// Inverse metres per unit of each column's unknown: 1 for a length, `1 / length_m` for an angle or a direction.
fn column_scales(robot: &Robot, formulation: PaperFormulation, seen: MeasurementKind, length_m: f64) -> Vec<f64> {
    let turn = 1.0 / length_m;
    let twist = [1.0, 1.0, 1.0, turn, turn, turn];
    let mut scales = Vec::new();
    if formulation.has_offsets() {
        scales.extend(robot.joints.iter().map(|joint| if joint.screw.is_prismatic() { 1.0 } else { turn }));
    }
    for joint in &robot.joints {
        if formulation.has_free_screws() && joint.screw.is_prismatic() {
            scales.extend([turn; 3]);
        } else {
            scales.extend(twist);
        }
    }
    scales.extend(if seen == MeasurementKind::Poses { &twist[..] } else { &twist[..3] });
    scales
}

/// Share of the largest singular value above which a direction counts to the rank of a noise-free matrix.
pub const RANK_SHARE: f64 = 1e-9;

/// Singular values of a matrix of finite numbers, the largest first, and the number of those above [`RANK_SHARE`] of the largest. Expected ranks:
/// theory.md §7 (35) and (35a).
#[must_use]
pub fn singular_values(matrix: &DMatrix<f64>) -> (Vec<f64>, usize) {
    if matrix.is_empty() {
        return (Vec::new(), 0);
    }
    let mut values: Vec<f64> = matrix.singular_values().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    let floor = RANK_SHARE * values.first().copied().unwrap_or(0.0);
    let rank = values.iter().filter(|&&value| value > floor).count();
    (values, rank)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables;

    #[test]
    fn a_robot_without_errors_stays() {
        let nominal = tables::nominal_robot();
        let same = AdjointErrors::zero(&nominal).apply(&nominal);
        for (same, joint) in same.joints.iter().zip(&nominal.joints) {
            assert!((same.screw.twist().to_vector() - joint.screw.twist().to_vector()).norm() < 1e-15);
        }
    }

    #[test]
    fn a_motion_along_an_axis_does_not_move_it() {
        let screw = tables::nominal_robot().joints[0].screw;
        let moved = screw_by_adjoint_error(&screw, &Twist::zero()) * screw.twist().to_vector();
        assert!(moved.norm() < 1e-15);
    }

    #[test]
    fn equal_columns_have_rank_1() {
        let (values, rank) = singular_values(&DMatrix::from_row_slice(2, 2, &[3.0, 3.0, 4.0, 4.0]));
        assert!((values[0] - 50.0_f64.sqrt()).abs() < 1e-14 && rank == 1);
    }
}
