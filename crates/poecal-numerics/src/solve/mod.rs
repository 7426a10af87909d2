//! Nonlinear least squares on a manifold. It knows no robots: a problem supplies normal information and applies steps.
//!
//! `levenberg_marquardt.rs` has the iteration. Its parts are normal information or, while `JᵀJ` is frozen, the gradient alone (`reuse.rs` decides
//! which); a damped step by `linalg`, its predicted reduction and gain ratio; second derivatives after a step has revealed curvature; and the last
//! digits by the gradient if an option requests them (`refine.rs`). `scaling.rs` is between it and the problem, idle by default. The words robot,
//! pose and millimetre do not occur in the code here.

mod levenberg_marquardt;
mod normal;
mod options;
mod refine;
mod reuse;
mod scaling;
mod termination;
mod warm_start;

pub use levenberg_marquardt::minimize;
pub use normal::NormalEquations;
pub use options::{Options, Scaling, Summary};
pub use termination::Termination;
pub use warm_start::{WarmStart, minimize_warm};

/// A problem `min ½ Σ e(x)²` whose unknowns are scaled so that one unit of each is comparable (metres, and radians times a length);
/// or else are to be scaled by the solver ([`Scaling::Columns`]).
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::solve;
/// # }
/// use poecal::solve::{LeastSquares, NormalEquations, Options, minimize};
///
/// /// `y = a exp(b x)`, two unknowns.
/// struct BoardGrowth([(f64, f64); 4]);
///
/// impl LeastSquares for BoardGrowth {
///     type State = [f64; 2];
///
///     fn dim(&self) -> usize {
///         2
///     }
///
///     fn normal(&self, &[a, b]: &Self::State) -> NormalEquations {
///         let mut normal = NormalEquations::new(2);
///         for (x, y) in self.0 {
///             let grown = (b * x).exp();
///             // The Jacobian of the prediction, and what was measured less the prediction.
///             normal.add_rows(&[grown, a * x * grown], &[y - a * grown], 0);
///         }
///         normal
///     }
///
///     fn retract(&self, &[a, b]: &Self::State, step: &[f64]) -> Self::State {
///         [a + step[0], b + step[1]]
///     }
/// }
///
/// let seen = [0.0, 1.0, 2.0, 3.0].map(|x: f64| (x, 2.0 * (0.3 * x).exp()));
/// let ([a, b], _, summary) = minimize(&BoardGrowth(seen), [1.0, 0.0], &Options::default());
/// assert!(summary.termination.is_success() && (a - 2.0).abs() < 1e-6 && (b - 0.3).abs() < 1e-6);
/// ```
pub trait LeastSquares {
    /// A point of the manifold.
    type State: Clone;

    /// Number of unknowns of a step.
    fn dim(&self) -> usize;

    /// Residuals and their derivatives, as normal information.
    fn normal(&self, state: &Self::State) -> NormalEquations;

    /// The same information with a `JᵀJ` that may differ by a share that is quadratic in the residuals, if that saves time: for steps.
    fn nearly_normal(&self, state: &Self::State) -> NormalEquations {
        self.normal(state)
    }

    /// The same information without `JᵀJ`, which is left empty: for steps with an older one. `None` if that would save nothing.
    fn gradient(&self, _state: &Self::State) -> Option<NormalEquations> {
        None
    }

    /// `Jᵀ e''(δ, δ)`: the residuals' second derivative along a step, projected (theory.md §6 (31)). Zero if it is unknown: steps are
    /// then straight.
    fn second_order(&self, _state: &Self::State, step: &[f64]) -> Vec<f64> {
        vec![0.0; step.len()]
    }

    /// `-Σ e ∇²f` (upper triangle): the difference of the Hessian and `JᵀJ` (theory.md §6 (31a)); `None` if it is unknown.
    fn curvature(&self, _state: &Self::State) -> Option<Vec<f64>> {
        None
    }

    /// Sets to zero the parts of a step that the retraction drops, to first order: none, unless unknowns are constrained.
    fn project_constraints(&self, _step: &mut [f64]) {}

    /// Mean squared whitened residual that is only rounding: below it there is nothing to fit.
    fn rounding(&self) -> f64 {
        f64::MIN_POSITIVE
    }

    /// The state after a step.
    fn retract(&self, state: &Self::State, step: &[f64]) -> Self::State;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals and their gradients by the unknowns.
    type Rows<const N: usize> = Vec<(f64, [f64; N])>;

    struct Plain<const N: usize>(fn(&[f64; N]) -> Rows<N>);

    impl<const N: usize> LeastSquares for Plain<N> {
        type State = [f64; N];

        fn dim(&self) -> usize {
            N
        }

        fn normal(&self, x: &[f64; N]) -> NormalEquations {
            let mut normal = NormalEquations::new(N);
            for (f, gradient) in (self.0)(x) {
                normal.add_rows(&gradient, &[-f], 0);
            }
            normal
        }

        fn gradient(&self, x: &[f64; N]) -> Option<NormalEquations> {
            Some(NormalEquations { gram: Vec::new(), ..self.normal(x) })
        }

        fn retract(&self, x: &[f64; N], step: &[f64]) -> [f64; N] {
            std::array::from_fn(|k| x[k] + step[k])
        }
    }

    fn rosenbrock(x: &[f64; 2]) -> Rows<2> {
        vec![(10.0 * (x[1] - x[0] * x[0]), [-20.0 * x[0], 10.0]), (1.0 - x[0], [-1.0, 0.0])]
    }

    /// `JᵀJ` is singular at the minimum, 0.
    fn powell_singular(x: &[f64; 4]) -> Rows<4> {
        let (five, ten) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
        let (a, b) = (x[1] - 2.0 * x[2], x[0] - x[3]);
        vec![
            (x[0] + 10.0 * x[1], [1.0, 10.0, 0.0, 0.0]),
            (five * (x[2] - x[3]), [0.0, 0.0, five, -five]),
            (a * a, [0.0, 2.0 * a, -4.0 * a, 0.0]),
            (ten * b * b, [2.0 * ten * b, 0.0, 0.0, -2.0 * ten * b]),
        ]
    }

    /// Options that change the path.
    fn all_options() -> impl Iterator<Item = Options> {
        [Scaling::Given, Scaling::Columns { damping: 1e-3 }].into_iter().flat_map(|scaling| {
            [true, false].map(|reuse| Options { scaling, reuse, decrement: 1e-20, ..Options::default() })
        })
    }

    #[test]
    fn the_end_of_rosenbrocks_valley_is_found() {
        for options in all_options() {
            let (x, _, summary) = minimize(&Plain(rosenbrock), [-1.2, 1.0], &options);
            assert!(summary.termination.is_success(), "{summary:?}");
            assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-12), "{x:?}");
        }
    }

    /// Convergence is linear there: each step halves the distance to the minimum, and its square, the residual, is soon rounding.
    #[test]
    fn powells_singular_minimum_is_approached() {
        for options in all_options() {
            let (x, normal, summary) =
                minimize(&Plain(powell_singular), [3.0, -1.0, 0.0, 1.0], &Options { iterations: 60, ..options });
            assert!(normal.cost < 1e-18 && x.iter().all(|x| x.abs() < 1e-4), "{x:?}, {summary:?}");
        }
    }
}
