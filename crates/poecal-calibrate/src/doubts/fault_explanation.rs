//! The joint that alone explains most of the axes' deviations from nominal: by its zero, or by the tilt or shift of its axis. Base and tool are free
//! if they are a choice, so that the result does not depend on how the screws are written (theory.md §9, *Suspicious joints*).

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3, Vector6};

use poecal_fit::gauge::screw_motions;
use poecal_fit::uncertainty::{FitView, Uncertainty};
use poecal_model::robot::{Joint, JointKind};
use poecal_numerics::linalg;

/// Largest deviation of a faulty axis, and of a faulty zero, as a multiple of the usual deviation (prior standard deviations).
const OFF_AXIS: f64 = 5.0;
const OFF_ZERO: f64 = 10.0;
/// Usual deviations that are tried, from the root mean square of all downward, and the ratio of each to the next.
const TRIED: usize = 9;
const RATIO: f64 = 1.4;
/// Ratios of the usual shift to the usual tilt (as an arc at the length); for many axes, which take longer, 1 alone.
const SHIFTS: [f64; 5] = [1.0, 0.25, 0.5, 2.0, 4.0];
/// Prior standard deviation of this ratio, octaves.
const OCTAVES: f64 = 0.8;
const MANY: usize = 64;
/// Eigenvalues below this share of the largest are null.
const NULL: f64 = 1e-10;

/// Possibly faulty part of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JointPart {
    Zero,
    Tilt,
    Shift,
}

/// One part of one joint as the explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaultExplanation {
    pub(crate) joint: usize,
    pub(crate) part: JointPart,
    /// Twice the logarithm of how much more probable the deviations are with it than without.
    pub(crate) evidence: f64,
    /// Size of the fault, radians or metres.
    pub(crate) size: f64,
    /// Usual deviation of the other axes in each direction, radians.
    pub(crate) usual_rad: f64,
}

/// Deviations of all axes from nominal in directions across them (metres, angles times a length), and the motions that change them.
struct AxisDeviations {
    deviations: DVector<f64>,
    /// Index and joint of the first of each joint's tilts, and of its shifts.
    tilts: Vec<(usize, usize)>,
    shifts: Vec<(usize, usize)>,
    is_shift: Vec<bool>,
    by_base: DMatrix<f64>,
    /// Effect of each joint's zero, in metres of arc for a turning joint.
    by_zero: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

/// Two directions across a third.
fn perpendicular_pair(direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = direction.iamin();
    let first = direction.cross(&Vector3::ith(least, 1.0)).normalize();
    [first, direction.cross(&first)]
}

impl AxisDeviations {
    fn new(view: &FitView<'_>, uncertainty: &Uncertainty) -> Self {
        let (session, estimate) = (&view.session, view.estimate);
        let (joints, length_m) = (&session.robot.joints, session.length_m);
        let screws = estimate.screws();
        let (mut deviations, mut rows, mut owners) = (Vec::new(), Vec::new(), Vec::new());
        let (mut tilts, mut shifts) = (Vec::new(), Vec::new());
        for (index, (screw, joint)) in screws.iter().zip(joints).enumerate() {
            let direction = screw.direction();
            let Joint { screw: nominal, frame, .. } = joint;
            tilts.push((deviations.len(), index));
            for way in perpendicular_pair(&direction) {
                deviations.push(length_m * (direction - nominal.direction()).dot(&way));
                let turn = direction.cross(&way) * length_m;
                rows.push(Vector6::new(0.0, 0.0, 0.0, turn.x, turn.y, turn.z));
                owners.push(index);
            }
            if joint.kind == JointKind::Prismatic {
                continue;
            }
            let at = screw.nearest_point(&frame.translation);
            let off = at - nominal.nearest_point(&at);
            shifts.push((deviations.len(), index));
            for way in perpendicular_pair(&direction) {
                let turn = at.cross(&way);
                deviations.push(off.dot(&way));
                rows.push(Vector6::new(way.x, way.y, way.z, turn.x, turn.y, turn.z));
                owners.push(index);
            }
        }
        let size = rows.len();
        let follows = |joint: usize, of: usize| {
            std::iter::successors(estimate.tree.joint_before(joint), |it| estimate.tree.joint_before(*it))
                .any(|before| before == of)
        };
        let by_zero = DMatrix::from_fn(size, joints.len(), |row, of| {
            let unit = if joints[of].kind == JointKind::Revolute { 1.0 / length_m } else { 1.0 };
            if follows(owners[row], of) { rows[row].dot(&screws[of].twist().to_vector()) * unit } else { 0.0 }
        });
        let columns = if session.base_free() { 6 } else { 0 };
        let by_base = DMatrix::from_fn(size, columns, |row, k| rows[row][k] * if k < 3 { 1.0 } else { 1.0 / length_m });
        let motions = screw_motions(estimate, &uncertainty.layout);
        let n = uncertainty.layout.dim();
        let by_steps = DMatrix::from_fn(size, n, |row, k| rows[row].dot(&motions[k][owners[row]]));
        let covariance = &by_steps * DMatrix::from_row_slice(n, n, &uncertainty.covariance) * by_steps.transpose();
        let mut is_shift = vec![false; size];
        shifts.iter().for_each(|&(at, _)| is_shift[at..at + 2].fill(true));
        AxisDeviations {
            deviations: DVector::from_vec(deviations),
            tilts,
            shifts,
            is_shift,
            by_base,
            by_zero,
            covariance,
        }
    }

    /// Weights of the deviations with all motions of the base projected out, and -2 times the logarithm of their density up to a constant, if each
    /// deviates by the usual amount.
    fn weights(&self, usual_m: f64, shifts: f64) -> Option<(DMatrix<f64>, f64)> {
        let mut spread = &self.by_zero * self.by_zero.transpose();
        for (at, own) in self.is_shift.iter().enumerate() {
            spread[(at, at)] += if *own { shifts * shifts } else { 1.0 };
        }
        let all = &self.covariance + spread * usual_m.powi(2);
        let (inverse, mut density) = inverse(&all)?;
        let moved = &inverse * &self.by_base;
        let base = self.by_base.transpose() * &moved;
        let (values, vectors) = eigen(&base);
        let largest = values.last().copied().unwrap_or(0.0);
        let mut weights = inverse;
        for (value, vector) in values.iter().zip(vectors.column_iter()).filter(|(value, _)| **value > NULL * largest) {
            let along = &moved * vector;
            weights -= &along * along.transpose() / *value;
            density += value.ln();
        }
        density += (self.deviations.transpose() * &weights * &self.deviations)[(0, 0)];
        Some((weights, density))
    }

    /// The columns of a part of a joint.
    fn parts(&self) -> Vec<(usize, JointPart, Vec<DVector<f64>>)> {
        let size = self.deviations.len();
        let unit = |at: usize| DVector::from_fn(size, |row, _| if row == at { 1.0 } else { 0.0 });
        let zeros = (0..self.by_zero.ncols())
            .map(|joint| (joint, JointPart::Zero, vec![self.by_zero.column(joint).into_owned()]));
        let tilts = self.tilts.iter().map(|&(at, joint)| (joint, JointPart::Tilt, vec![unit(at), unit(at + 1)]));
        let shifts = self.shifts.iter().map(|&(at, joint)| (joint, JointPart::Shift, vec![unit(at), unit(at + 1)]));
        zeros.chain(tilts).chain(shifts).collect()
    }
}

/// The inverse of a symmetric positive matrix, and the logarithm of its determinant.
fn inverse(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, f64)> {
    let (values, vectors) = eigen(matrix);
    if values.iter().any(|value| !(*value > 0.0 && value.is_finite())) {
        return None;
    }
    let scaled = DMatrix::from_fn(vectors.nrows(), vectors.ncols(), |i, k| vectors[(i, k)] / values[k]);
    Some((scaled * vectors.transpose(), values.iter().map(|value| value.ln()).sum()))
}

fn eigen(matrix: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let n = matrix.nrows();
    let upper: Vec<f64> = (0..n * n).map(|k| matrix[(k / n, k % n)]).collect();
    linalg::symmetric_eigen(&upper, n)
}

/// Each part of each joint as the only faulty one, the most probable first. Deviations are normal: those of all axes and zeros with a usual amount,
/// which is estimated from them, and with the covariance of the fit; that of the part with several times as much.
pub(crate) fn blame(view: &FitView<'_>, uncertainty: &Uncertainty) -> Vec<FaultExplanation> {
    let axes = AxisDeviations::new(view, uncertainty);
    let length_m = view.session.length_m;
    let parts = axes.parts();
    let size = axes.deviations.len().max(1) as f64;
    let largest_m = (axes.deviations.norm_squared() / size).sqrt();
    if !(largest_m > 0.0 && largest_m.is_finite()) {
        return Vec::new();
    }
    let mut without = f64::INFINITY;
    let mut best: Vec<Option<FaultExplanation>> = vec![None; parts.len()];
    let ratios = if axes.deviations.len() > MANY { &SHIFTS[..1] } else { &SHIFTS[..] };
    let tried = (0..TRIED).flat_map(|step| ratios.iter().map(move |shifts| (RATIO.powi(-(step as i32)), *shifts)));
    for (share, shifts) in tried {
        let usual_m = largest_m * share;
        let Some((weights, density)) = axes.weights(usual_m, shifts) else { continue };
        let density = density + (shifts.log2() / OCTAVES).powi(2);
        without = without.min(density);
        let weighed = &weights * &axes.deviations;
        for ((joint, part, columns), best) in parts.iter().zip(&mut best) {
            let off_m = usual_m
                * match part {
                    JointPart::Zero => OFF_ZERO,
                    JointPart::Tilt => OFF_AXIS,
                    JointPart::Shift => OFF_AXIS * shifts,
                };
            let entry = |i: usize, k: usize| match (columns.get(i), columns.get(k)) {
                (Some(a), Some(b)) => off_m.powi(2) * (a.transpose() * &weights * b)[(0, 0)],
                _ => 0.0,
            };
            let matrix = Matrix2::identity() + Matrix2::from_fn(entry);
            let pull = Vector2::from_fn(|k, _| columns.get(k).map_or(0.0, |it| off_m * it.dot(&weighed)));
            let determinant = matrix.m11 * matrix.m22 - matrix.m12 * matrix.m21;
            let found =
                Vector2::new(matrix.m22 * pull.x - matrix.m12 * pull.y, matrix.m11 * pull.y - matrix.m21 * pull.x)
                    / determinant;
            let with = density + determinant.ln() - pull.dot(&found);
            if best.is_none_or(|best| with < -best.evidence) {
                let size_m = off_m * found.norm();
                let is_angle = *part != JointPart::Shift && !(*part == JointPart::Zero && slides(view, *joint));
                let size = if is_angle { size_m / length_m } else { size_m };
                let usual_rad = usual_m / length_m;
                *best = Some(FaultExplanation { joint: *joint, part: *part, evidence: -with, size, usual_rad });
            }
        }
    }
    let mut found: Vec<FaultExplanation> =
        best.into_iter().flatten().map(|it| FaultExplanation { evidence: it.evidence + without, ..it }).collect();
    found.retain(|it| it.evidence.is_finite());
    found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    found
}

fn slides(view: &FitView<'_>, joint: usize) -> bool {
    view.session.robot.joints.get(joint).is_some_and(|it| it.kind == JointKind::Prismatic)
}
