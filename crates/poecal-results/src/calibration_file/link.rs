//! Uncertainty of points on a link that were not measured themselves, such as a tip: they move with the axis of the joint that moves the link.

use nalgebra::{DMatrix, Matrix3, Vector3};

use poecal_arm::lie::Twist;
use poecal_fit::gauge::screw_motions;
use poecal_fit::parameters::{Parameter, TargetFrame};
use poecal_fit::problem::Layout;
use poecal_fit::state::Estimate;

/// Turns the axes of three of the `n` unknowns of a covariance, row by row: `x' = R x`.
pub(crate) fn turn(covariance: &mut [f64], n: usize, places: &[usize], rotation: &Matrix3<f64>) {
    let &[x, y, z] = places else { return };
    let mut turn = |at: [usize; 3]| {
        let turned = rotation * Vector3::from(at.map(|at| covariance[at]));
        at.iter().zip(turned.iter()).for_each(|(&at, value)| covariance[at] = *value);
    };
    (0..n).for_each(|k| turn([x, y, z].map(|row| row * n + k)));
    (0..n).for_each(|k| turn([x, y, z].map(|column| k * n + column)));
}

/// A layout with the motions of some targets among its unknowns, and these as functions of the unknowns of another layout: theory.md §9, below (40).
pub(crate) struct LinkPoints {
    pub(crate) layout: Layout,
    /// The unknowns of this layout as a linear function of those of the other, in metres.
    by_known: DMatrix<f64>,
}

impl LinkPoints {
    /// Layout for targets that were not measured, each with the joint that moves its link. `None` without any, or if their axes are not among the
    /// unknowns.
    pub(crate) fn new(estimate: &Estimate, known: &Layout, points: &[(usize, usize)]) -> Option<Self> {
        let axis_of = |joint: usize| {
            let is_own = |parameter: &Parameter| parameter.screw_axis().is_some_and(|it| it.joint == joint);
            known.parameters().find(|(parameter, _)| is_own(parameter)).map(|(_, places)| places)
        };
        let points: Vec<_> =
            points.iter().filter_map(|&(target, joint)| Some((target, joint, axis_of(joint)?))).collect();
        if points.is_empty() {
            return None;
        }
        let mut free: Vec<Parameter> = known.parameters().map(|(parameter, _)| *parameter).collect();
        free.extend(points.iter().map(|(target, ..)| Parameter::TargetFrame(TargetFrame::new(*target))));
        let layout = Layout::new(free, known.length_m());
        let mut by_known = DMatrix::zeros(layout.dim(), known.dim());
        let count = known.parameters().count();
        for ((_, old), (_, new)) in known.parameters().zip(layout.parameters()) {
            for (&(from, _), &(to, _)) in old.iter().zip(new) {
                by_known[(to, from)] = 1.0;
            }
        }
        let motions = screw_motions(estimate, known);
        for ((target, joint, places), (_, own)) in points.iter().zip(layout.parameters().skip(count)) {
            let place = estimate.base_from_target[*target];
            for &(from, _) in *places {
                let moved = Twist::from_vector(&motions[from][*joint]);
                let shift = place.rotation.transpose() * (moved.v + moved.w.cross(&place.translation));
                let turn = place.rotation.transpose() * moved.w;
                for (part, &(to, scale)) in shift.iter().chain(turn.iter()).zip(own) {
                    by_known[(to, from)] = part * scale;
                }
            }
        }
        Some(LinkPoints { layout, by_known })
    }

    /// The covariance of its unknowns, row by row.
    pub(crate) fn covariance(&self, of_known: &[f64]) -> Vec<f64> {
        let n = self.by_known.ncols();
        let all = &self.by_known * DMatrix::from_row_slice(n, n, of_known) * self.by_known.transpose();
        // Symmetric but for rounding.
        (0..all.nrows() * all.nrows())
            .map(|at| {
                let (i, j) = (at / all.nrows(), at % all.nrows());
                0.5 * (all[(i, j)] + all[(j, i)])
            })
            .collect()
    }
}
