//! Many fits of one problem: other measurements in the same configurations.

use super::Problem;
use crate::state::Estimate;
use poecal_model::measurement::Measurement;
use poecal_numerics::solve::{LeastSquares, NormalEquations, Options, Summary, WarmStart, minimize_warm};
use poecal_numerics::threads;

/// Fits that one thread makes in turn, with one copy of the problem.
const TOGETHER: usize = 25;

/// A problem at its optimum, for repeated fits to other measurements in the same configurations (Monte Carlo, bootstrap). All fits share
/// the packed rows and the factorised `JᵀJ` of the first optimum, so that most of them need residuals and gradients alone. A fit that
/// does not converge fast computes `JᵀJ` as usual, and reaches the same optimum (theory.md §6, *Few passes*).
#[derive(Clone, Debug)]
pub struct Refit<'a> {
    problem: Problem<'a>,
    start: WarmStart<Estimate>,
    options: Options,
}

impl<'a> Refit<'a> {
    /// Prepares fits of a problem, from its optimum or a state close by.
    #[must_use]
    pub fn new(problem: Problem<'a>, optimum: Estimate, options: Options) -> Self {
        let normal = problem.normal(&optimum);
        Refit { problem, start: WarmStart::new(optimum, normal), options }
    }

    /// Fits other measurements, one for each row of the data and of the same kind. The returned `JᵀJ` may be frozen, as in
    /// [`poecal_numerics::solve::minimize`].
    pub fn fit(&mut self, measured: &[Measurement]) -> (Estimate, NormalEquations, Summary) {
        self.problem.set_measurements(measured);
        minimize_warm(&self.problem, &self.start, &self.options)
    }

    /// [`Refit::fit`] of each trial by all threads; returns what `kept` extracts from each, in the order of the trials.
    pub fn fit_all<T: Send>(
        &self,
        trials: &[Vec<Measurement>],
        kept: impl Fn(Estimate, NormalEquations, Summary) -> T + Sync,
    ) -> Vec<T> {
        threads::concat_chunks(trials, TOGETHER, |_, trials| {
            let mut refit = self.clone();
            let fit = |measured: &Vec<Measurement>| {
                let (estimate, normal, summary) = refit.fit(measured);
                kept(estimate, normal, summary)
            };
            trials.iter().map(fit).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Parameter, TargetPlace};
    use crate::state::{PackedValues, Session};
    use nalgebra::Vector3;
    use poecal_arm::lie::{Pose, Screw};
    use poecal_model::measurement::{Dataset, Noise};
    use poecal_model::robot::{Joint, Robot};

    #[test]
    fn fits_of_all_trials_are_what_each_is_alone() {
        let joint = Joint::revolute("a", Screw::revolute(&Vector3::y(), &Vector3::x()));
        let home = Pose::from_translation(Vector3::new(0.3, 0.2, 0.1));
        let robot = Robot::new("r", vec![joint], home).unwrap();
        let place = Vector3::new(0.01, 0.0, 0.0);
        let seen = |reading, place| {
            let position = robot.forward_kinematics(&[reading]).act(&place);
            Measurement::point(position)
        };
        let mut data = Dataset::new(robot.reading_names());
        for reading in [0.0, 1.0, 2.0] {
            data.push(&[reading], None, seen(reading, place)).unwrap();
        }
        let packed = PackedValues::new(&robot, data.all_readings(), 1);
        let free = vec![Parameter::TargetPlace(TargetPlace { target: 0 })];
        let session = Session::new(&robot, &data, &packed, false);
        let problem = Problem::new(session, vec![0, 1, 2], free, Noise::new(1e-4, 1e-4));
        let start = Estimate::new(&robot, vec![robot.home], Pose::identity());

        let mut refit = Refit::new(problem, start, Options::default());
        let others = [0.0, 1.0, 2.0].map(|reading| seen(reading, 2.0 * place));
        let (found, _, _) = refit.fit(&others);
        assert!((found.base_from_target[0].translation.x - 0.32).abs() < 1e-12);
        assert_eq!(refit.fit_all(&[others.to_vec()], |found, _, _| found), [found]);
    }
}
