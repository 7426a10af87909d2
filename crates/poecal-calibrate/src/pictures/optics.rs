//! Lenses, boards and markers that are fitted together with the robot (theory.md §4, *Pictures* (17d)).

use nalgebra::{DMatrix, DVector, Matrix2xX};

use crate::corrections::{solve_factored, whitened_rows};
use crate::robust::RobustFit;
use crate::run::CalibrationRun;
use crate::trust::information::{FitInformation, factor_of};
use poecal_fit::problem::Problem;
use poecal_fit::start::predicted_pose;
use poecal_fit::state::Estimate;
use poecal_model::camera::{
    Board, Camera, PictureInformation, PictureNumber, PictureUnknown, PictureUnknowns, Pictures, Projection,
    motion_by_inverse,
};
use poecal_model::measurement::Dataset;
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Largest step of a number, standard deviations of its prior.
const FARTHEST: f64 = 3.0;

/// Unknown numbers of cameras and boards in a fit, and their distances from the stated values.
#[derive(Clone)]
pub(crate) struct Optics {
    unknowns: PictureUnknowns,
    step: DVector<f64>,
    deviations: Vec<f64>,
}

/// Information of the numbers: coupled with the robot's unknowns, alone with its prior, and its gradient.
struct Coupling {
    mixed: DMatrix<f64>,
    gram: DMatrix<f64>,
    pull: DVector<f64>,
}

/// A step of the numbers with its explained squares (in squared standard deviations), their covariance, and the step of the robot's unknowns without
/// it and by it.
pub(crate) struct BestStep {
    pub(crate) step: DVector<f64>,
    gain: f64,
    pub(crate) covariance: DMatrix<f64>,
    still: DVector<f64>,
    pub(crate) follow: DMatrix<f64>,
}

impl BestStep {
    /// Standard deviations of the numbers.
    fn deviations(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|it| it.max(0.0).sqrt()).collect()
    }
}

impl Optics {
    /// Optics of a session with pictures, from the stated values.
    pub(crate) fn from_run(run: &CalibrationRun<'_>) -> Option<Self> {
        let pictures = &run.data.pictures;
        let has_any = !pictures.is_empty() && !run.unknowns.pictures.is_empty();
        has_any.then(|| Optics::from_here(pictures, &run.unknowns.pictures))
    }

    /// Optics of these unknowns, from the present cameras and boards.
    pub(crate) fn from_here(pictures: &Pictures, unknowns: &[PictureUnknown]) -> Self {
        let unknowns = PictureUnknowns::new(&pictures.cameras, &pictures.boards, unknowns);
        let count = unknowns.count();
        Optics { unknowns, step: DVector::zeros(count), deviations: vec![1.0; count] }
    }

    /// The fitted numbers.
    pub(crate) fn numbers(&self) -> Vec<PictureNumber> {
        self.unknowns.numbers(&self.step, &self.deviations)
    }

    /// Cameras and boards after a step.
    pub(crate) fn after(&self, step: &DVector<f64>) -> (Vec<Camera>, Vec<Board>) {
        self.unknowns.apply_step(step)
    }

    /// The numbers after a step, with their standard deviations.
    pub(crate) fn numbers_after(&self, best: &BestStep) -> Vec<PictureNumber> {
        self.unknowns.numbers(&best.step, &best.deviations())
    }

    /// Effective number of numbers that the pictures determine rather than the prior.
    pub(crate) fn determined_count(&self) -> f64 {
        self.deviations.iter().map(|it| 1.0 - it * it).sum::<f64>().max(0.0)
    }

    /// Rows of pictures among some, as functions of the robot's unknowns and of these numbers.
    fn coupling(&self, data: &Dataset, problem: &Problem<'_>, estimate: &Estimate) -> Coupling {
        let pictures = &data.pictures;
        let rows: Vec<u32> =
            problem.rows().iter().copied().filter(|row| pictures.index_of_row(*row).is_some()).collect();
        let (starts, jacobian, residuals) = whitened_rows(problem, estimate, &rows);
        let errors = problem.session().errors(&rows, estimate);
        let count = self.unknowns.count();
        let mut own = PictureInformation::zero(count);
        let mut by_numbers = DMatrix::zeros(residuals.len(), count);
        for (at, (row, error)) in rows.iter().zip(&errors).enumerate() {
            let Some(picture) = pictures.index_of_row(*row).and_then(|at| pictures.all.get(at)) else { continue };
            let Some(view) = pictures.view(picture) else { continue };
            let Some(whitening) = data.whitening_of_picture(*row) else { continue };
            let measured = data.observations[*row as usize].measurement.pose();
            if view.is_odd(&picture.directed_measurement(&measured)) {
                continue;
            }
            // The information is evaluated at the prediction: there the size of the robot and the size of the board are one direction, to the last
            // digit.
            let pose = picture.directed_measurement(&predicted_pose(&measured, error));
            let information = view.information(&pose);
            let of = (picture.camera, picture.board);
            let mut follow = self.unknowns.add(of, &view, (&pose, &information), &mut own);
            if picture.of_camera {
                follow = motion_by_inverse(&pose.inverse()) * follow;
            }
            // The measured pose moves with the numbers, so the residuals decrease by this motion.
            let weight = problem.weight(*row).sqrt();
            by_numbers.rows_mut(starts[at], 6).copy_from(&(whitening * follow * -weight));
        }
        let gram = by_numbers.transpose() * &by_numbers + own.gram + DMatrix::identity(count, count);
        let pull = by_numbers.tr_mul(&residuals) + own.pull - &self.step;
        Coupling { mixed: jacobian.transpose() * by_numbers, gram, pull }
    }

    /// The best step of the numbers from the optimum of a fit, with their standard deviations and the resulting step of the robot's unknowns.
    pub(crate) fn best_step(&self, run: &CalibrationRun<'_>, information: &FitInformation<'_>) -> Option<BestStep> {
        let Coupling { mixed, gram, pull } = self.coupling(&run.data, &information.problem, information.estimate);
        let follow = information.solve(&mixed);
        let pull = pull - follow.tr_mul(information.gradient());
        let factor = factor_of(&(gram - mixed.transpose() * &follow))?;
        let count = self.unknowns.count();
        let inverse = DMatrix::from_row_slice(count, count, &linalg::inverse(&factor));
        let step = &inverse * &pull;
        let gain = step.dot(&pull).max(0.0);
        Some(BestStep { step, gain, covariance: inverse, still: information.step(), follow })
    }

    /// Derivative of a pixel of a camera by the numbers, in standard deviations of their prior.
    pub(crate) fn by_lens(&self, camera: usize, found: &Projection) -> Matrix2xX<f64> {
        self.unknowns.by_lens(camera, found)
    }

    /// The data with the next numbers, from the optimum of a fit with the present ones, and the estimate adapted to them. `None` if they change by
    /// less than `least` standard deviations.
    pub(crate) fn advance(
        &mut self,
        run: &CalibrationRun<'_>,
        (information, fit): (&FitInformation<'_>, &RobustFit),
        least: f64,
    ) -> Option<(Dataset, Estimate)> {
        let best = self.best_step(run, information)?;
        let deviations = best.deviations();
        let BestStep { mut step, gain, still, follow, .. } = best;
        self.deviations = deviations;
        step *= (FARTHEST / step.amax().max(FARTHEST)).min(1.0);
        if gain < least * least {
            return None;
        }
        let of_robot = still - follow * &step;
        let estimate = fit.fitted.layout.retract(&fit.fitted.estimate, of_robot.as_slice());
        self.step += step;
        let mut data = run.data.clone().into_owned();
        let (cameras, boards) = self.unknowns.apply_step(&self.step);
        data.pictures = Pictures { cameras, boards, ..data.pictures };
        Some((data, estimate))
    }

    /// Subtracts the information shared with the numbers from the information of the robot's unknowns.
    pub(crate) fn loosen(
        &self,
        data: &Dataset,
        problem: &Problem<'_>,
        estimate: &Estimate,
        normal: &mut NormalEquations,
    ) {
        let Coupling { mixed, gram, .. } = self.coupling(data, problem, estimate);
        let Some(factor) = factor_of(&gram) else { return };
        let explained = &mixed * solve_factored(&factor, &mixed.transpose());
        let n = normal.dim();
        for i in 0..n {
            for j in i..n {
                normal.gram[i * n + j] -= explained[(i, j)];
            }
        }
    }
}
