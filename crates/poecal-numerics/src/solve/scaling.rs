//! Unknowns of any units, measured by their columns of the Jacobian (more1978).

use super::{LeastSquares, NormalEquations, Scaling};

/// Smallest ratio of a column's reference norm to the one before. References that follow at once let a step go far along an unknown
/// whose column vanishes. References that never fall (more1978) hold back permanently an unknown whose column was large at a far
/// start.
const SLOWEST: f64 = 0.7;

/// A problem as input of the search: with its original unknowns, or with each divided by its unit.
///
/// Units are powers of two, so that scaling rounds nothing.
pub(crate) struct ScaledProblem<'a, P> {
    problem: &'a P,
    /// Unit of each unknown; empty if unknowns stay unscaled.
    units: Vec<ColumnScale>,
}

#[derive(Clone, Copy)]
struct ColumnScale {
    /// Reference norm of the column of the unscaled unknown; zero as long as the column was.
    norm: f64,
    /// The unit, in that of the unscaled unknown.
    size: f64,
}

impl<'a, P: LeastSquares> ScaledProblem<'a, P> {
    pub(crate) fn new(problem: &'a P, scaling: Scaling) -> Self {
        let count = match scaling {
            Scaling::Given => 0,
            Scaling::Columns { .. } => problem.dim(),
        };
        ScaledProblem { problem, units: vec![ColumnScale { norm: 0.0, size: 1.0 }; count] }
    }

    /// Chooses new units at a state with this normal information, which is in the units so far and is changed to the new ones. In these
    /// each column's norm is about 1, or less if it has fallen faster than its reference.
    pub(crate) fn adapt(&mut self, normal: &mut NormalEquations) {
        let n = self.units.len();
        let mut ratios = vec![1.0; n];
        for (k, (unit, ratio)) in self.units.iter_mut().zip(&mut ratios).enumerate() {
            let norm = (normal.gram[k * n + k].sqrt() / unit.size).max(SLOWEST * unit.norm);
            let size = (-norm.log2().round()).exp2();
            if norm > 0.0 && size.is_normal() {
                *ratio = size / unit.size;
                *unit = ColumnScale { norm, size };
            }
        }
        scale(normal, &ratios);
    }

    /// Normal information of the unscaled unknowns.
    pub(crate) fn restore(&self, normal: &mut NormalEquations) {
        let ratios: Vec<f64> = self.units.iter().map(|unit| 1.0 / unit.size).collect();
        scale(normal, &ratios);
    }

    fn scale_normal(&self, mut normal: NormalEquations) -> NormalEquations {
        let ratios: Vec<f64> = self.units.iter().map(|unit| unit.size).collect();
        scale(&mut normal, &ratios);
        normal
    }

    /// A step in unscaled unknowns.
    fn unscale_step(&self, step: &[f64]) -> Vec<f64> {
        step.iter().zip(&self.units).map(|(part, unit)| part * unit.size).collect()
    }
}

/// Multiplies each column of the Jacobian; without ratios, none.
fn scale(normal: &mut NormalEquations, ratios: &[f64]) {
    for (g, ratio) in normal.gradient.iter_mut().zip(ratios) {
        *g *= ratio;
    }
    scale_gram(&mut normal.gram, ratios);
}

fn scale_gram(gram: &mut [f64], ratios: &[f64]) {
    for (row, ratio) in gram.chunks_exact_mut(ratios.len().max(1)).zip(ratios) {
        for (product, other) in row.iter_mut().zip(ratios) {
            *product *= ratio * other;
        }
    }
}

impl<P: LeastSquares> LeastSquares for ScaledProblem<'_, P> {
    type State = P::State;

    fn dim(&self) -> usize {
        self.problem.dim()
    }

    fn normal(&self, state: &P::State) -> NormalEquations {
        self.scale_normal(self.problem.normal(state))
    }

    fn nearly_normal(&self, state: &P::State) -> NormalEquations {
        self.scale_normal(self.problem.nearly_normal(state))
    }

    fn gradient(&self, state: &P::State) -> Option<NormalEquations> {
        self.problem.gradient(state).map(|normal| self.scale_normal(normal))
    }

    fn second_order(&self, state: &P::State, step: &[f64]) -> Vec<f64> {
        if self.units.is_empty() {
            return self.problem.second_order(state, step);
        }
        self.unscale_step(&self.problem.second_order(state, &self.unscale_step(step)))
    }

    fn curvature(&self, state: &P::State) -> Option<Vec<f64>> {
        let ratios: Vec<f64> = self.units.iter().map(|unit| unit.size).collect();
        let mut curvature = self.problem.curvature(state)?;
        scale_gram(&mut curvature, &ratios);
        Some(curvature)
    }

    fn project_constraints(&self, step: &mut [f64]) {
        for (part, unit) in step.iter_mut().zip(&self.units) {
            *part *= unit.size;
        }
        self.problem.project_constraints(step);
        for (part, unit) in step.iter_mut().zip(&self.units) {
            *part /= unit.size;
        }
    }

    fn rounding(&self) -> f64 {
        self.problem.rounding()
    }

    fn retract(&self, state: &P::State, step: &[f64]) -> P::State {
        if self.units.is_empty() {
            return self.problem.retract(state, step);
        }
        self.problem.retract(state, &self.unscale_step(step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unknowns of very different units, `(x, y)` with residuals `1e5 x - 3` and `1e-7 y - 2`.
    struct Apart;

    impl LeastSquares for Apart {
        type State = [f64; 2];

        fn dim(&self) -> usize {
            2
        }

        fn normal(&self, [x, y]: &[f64; 2]) -> NormalEquations {
            let mut normal = NormalEquations::new(2);
            normal.add_rows(&[1e5, 0.0, 0.0, 1e-7], &[3.0 - 1e5 * x, 2.0 - 1e-7 * y], 0);
            normal
        }

        fn retract(&self, state: &[f64; 2], step: &[f64]) -> [f64; 2] {
            [state[0] + step[0], state[1] + step[1]]
        }
    }

    #[test]
    fn columns_come_to_about_one_and_back_to_the_same_bits() {
        let mut scaled = ScaledProblem::new(&Apart, Scaling::Columns { damping: 1e-3 });
        let mut normal = scaled.nearly_normal(&[0.0, 0.0]);
        scaled.adapt(&mut normal);
        assert!([0, 3].iter().all(|&k| (0.5..=2.0).contains(&normal.gram[k])), "{:?}", normal.gram);
        assert_eq!(normal, scaled.nearly_normal(&[0.0, 0.0]));
        let step = [normal.gradient[0] / normal.gram[0], normal.gradient[1] / normal.gram[3]];
        let [x, y] = scaled.retract(&[0.0, 0.0], &step);
        assert!((x / 3e-5 - 1.0).abs() < 1e-15 && (y / 2e7 - 1.0).abs() < 1e-15, "{x:e} {y:e}");
        scaled.restore(&mut normal);
        assert_eq!(normal, Apart.normal(&[0.0, 0.0]));
    }

    #[test]
    fn unknowns_as_they_are_given_are_left_alone() {
        let mut scaled = ScaledProblem::new(&Apart, Scaling::Given);
        let mut normal = scaled.nearly_normal(&[0.0, 0.0]);
        scaled.adapt(&mut normal);
        assert_eq!(normal, Apart.normal(&[0.0, 0.0]));
    }
}
