//! An unknown lens, estimated together with the frames: from the corners of the pictures, whose poses are free, and from the arm, which
//! measures the camera's motion.
//!
//! The pictures by themselves determine focal lengths from the perspective of tilted boards, which is weak for small tilts. The arm adds to the same
//! equations. The poses `seen` follow the lens (`LensState::follow`), so a lens is better if the poses fit the frames better. The covariance of both
//! is joint: that of the frames at a known lens, and that of the lens by which they follow.

use nalgebra::{DMatrix, DVector, Matrix6, Matrix6xX};

use super::equations::{PosePair, UNKNOWNS, derivatives, errors, sight_axes};
use super::fit::HandEyeFit;
use super::other_lens::other_lens;
use super::readings::PoseList;
use super::unknown_lens::{FoundLens, UnknownLens};
use poecal_arm::lie::{Pose, hat};
use poecal_model::camera::{LensSearch, LensState, PictureNumber, Pictures};
use poecal_numerics::distributions::f_quantile;
use poecal_numerics::linalg;

/// Largest number of rounds of lens and frames.
const ROUNDS: usize = 12;
/// Least gain of a round, squared standard deviations.
const LEAST: f64 = 1e-6;
/// Probability by chance at which pictures and arm count as of different lenses.
const CHANCE: f64 = 1e-3;
/// Information of the arm in units of that of the pictures, below which it does not determine a direction.
const SAYS: f64 = 1e-3;

/// A lens that is estimated with the frames, and its part in their covariance.
pub(crate) struct LensCoupling {
    pub(crate) found: FoundLens,
    /// Covariance of the frames by that of the lens, and its degrees of freedom.
    pub(crate) covariance: Vec<f64>,
    pub(crate) freedom: f64,
    /// Factor by which the variance of the poses exceeds its estimate, since the lens was fitted to them.
    pub(crate) larger: f64,
}

impl PoseList {
    /// Poses of the board in pictures of one camera and one board, with all others that their corners allow. A lens that is a first guess is
    /// estimated from the corners.
    ///
    /// # Errors
    /// A message, if the pictures do not determine an unknown lens.
    pub fn of_pictures(pictures: &Pictures) -> Result<Self, String> {
        let is_guessed = |at: usize| pictures.cameras.get(at).is_some_and(|it| it.is_guessed);
        if pictures.all.iter().any(|it| is_guessed(it.camera)) {
            return of_unknown_lens(pictures);
        }
        let half_turn = |at: usize| pictures.boards.get(at).and_then(|board| board.half_turn());
        let (mut poses, mut other_poses) = (Vec::new(), Vec::new());
        for picture in &pictures.all {
            let Some(best) = picture.poses.first() else { continue };
            poses.push(*best);
            let half_turn = half_turn(picture.board);
            let turned = half_turn.iter().flat_map(|turn| picture.poses.iter().map(move |it| *it * *turn));
            other_poses.push(picture.poses.iter().skip(1).copied().chain(turned).collect());
        }
        Ok(PoseList { other_poses, lens_doubt: other_lens(pictures), ..poses.into() })
    }
}

/// The poses with the lens that the pictures determine.
fn of_unknown_lens(pictures: &Pictures) -> Result<PoseList, String> {
    let refuse = || {
        "found pictures that do not determine the unknown lens, expected boards that are tilted by 20 to 45 degrees: add such pictures, or state the \
         lens"
            .to_owned()
    };
    let (search, start) = LensSearch::from_pictures(pictures).ok_or_else(refuse)?;
    let mut state = search.lens_alone(&start).ok_or_else(refuse)?;
    // A flat board has two poses; with another lens the other one may be better.
    for _ in 0..2 {
        for at in 0..state.pictures.all.len() {
            let pictures = &state.pictures;
            let found = pictures.all.get(at).and_then(|it| pictures.view(it)).map(|view| view.poses());
            if let (Some(picture), Some(Ok(found))) = (state.pictures.all.get_mut(at), found) {
                picture.poses = found;
            }
        }
        let best: Option<Vec<Pose>> = state.pictures.all.iter().map(|it| it.poses.first().copied()).collect();
        let same = search.step_by(&state, &best.ok_or_else(refuse)?, &DVector::zeros(state.step.len()));
        state = search.lens_alone(&same).ok_or_else(refuse)?;
    }
    let search = search.with_spread_of(&state);
    let same = search.step_by(&state, &state.poses, &DVector::zeros(state.step.len()));
    let state = search.lens_alone(&same).ok_or_else(refuse)?;
    let mut known = state.pictures.clone();
    known.cameras.iter_mut().for_each(|it| it.is_guessed = false);
    let list = PoseList::of_pictures(&known)?;
    Ok(PoseList { lens: Some(UnknownLens { search, state }), lens_doubt: None, ..list })
}

/// A fit with its lens: the poses measured through it, and the joint uncertainty.
pub(crate) struct FitWithLens {
    pub(crate) target: Vec<Pose>,
    pub(crate) fit: HandEyeFit,
    pub(crate) joint: Option<LensCoupling>,
}

impl FitWithLens {
    /// A fit of poses whose lens is known.
    pub(crate) fn from_known_lens(target: Vec<Pose>, fit: HandEyeFit) -> Self {
        FitWithLens { target, fit, joint: None }
    }
}

/// A fit of the frames, with the rows that count (as measured about its point) and their numbers in the list.
pub(crate) type LensFit = (HandEyeFit, Vec<(usize, PosePair)>);
/// Fits the frames to poses of the target, from an earlier fit if there is one.
pub(crate) type FrameFitter<'a> = dyn Fn(&[Pose], Option<&HandEyeFit>) -> Option<LensFit> + 'a;

/// Refits frames and lens together, from poses of the target by the lens of the pictures alone.
pub(crate) fn refit_with_lens(lens: &UnknownLens, target: &[Pose], fitted: &FrameFitter<'_>) -> Option<FitWithLens> {
    let UnknownLens { search, state: alone } = lens;
    let chosen = lens.choose_poses(target);
    let starts: Vec<Pose> = chosen.iter().map(|it| it.0).collect();
    let along = |state: &LensState| -> Vec<Pose> {
        state.poses.iter().zip(&chosen).map(|(pose, (_, turn))| *pose * *turn).collect()
    };
    let mut state = search.step_by(alone, &starts, &DVector::zeros(alone.step.len()));
    let (mut fit, mut rows) = fitted(&along(&state), None)?;
    let mut first: Option<f64> = None;
    let mut normal = LensEquations::from_rows(&state, &fit, &rows)?;
    for _ in 0..ROUNDS {
        let (by, gain) = normal.step()?;
        if first.is_none() {
            first = Some(normal.lens_distance(&state, &fit)?);
        }
        if gain < LEAST {
            break;
        }
        state = search.step_by(&state, &state.poses, &by);
        (fit, rows) = fitted(&along(&state), Some(&fit))?;
        normal = LensEquations::from_rows(&state, &fit, &rows)?;
    }
    let apart = first.unwrap_or(1.0);
    let inverse = |matrix: &DMatrix<f64>| -> Option<DMatrix<f64>> {
        let n = matrix.nrows();
        let factor = linalg::cholesky(matrix.as_slice(), n, 0.0)?;
        Some(DMatrix::from_row_slice(n, n, &linalg::inverse(&factor)))
    };
    // Degrees of freedom that the lens has taken from the noise of the poses, of which at least half are left.
    let taken = (inverse(&normal.information)? * &normal.of_arm).trace();
    let freedom: f64 = fit.noise.freedom.iter().sum();
    let larger = (freedom / (freedom - taken).max(0.5 * freedom)).max(1.0);
    let information = &state.information + &normal.of_arm / larger;
    let of_lens = inverse(&information)? * (apart * apart);
    let deviations =
        |covariance: &DMatrix<f64>| -> Vec<f64> { covariance.diagonal().iter().map(|it| it.max(0.0).sqrt()).collect() };
    let covariance = &normal.follow * &of_lens * normal.follow.transpose();
    let numbers = |state: &LensState, covariance: &DMatrix<f64>| -> Vec<PictureNumber> {
        let all = search.numbers(state, &deviations(covariance));
        all.into_iter().filter(|it| !it.name.contains(".scale_")).collect()
    };
    let found = FoundLens {
        lens: state.lens()?,
        numbers: numbers(&state, &of_lens),
        alone: numbers(alone, &inverse(&alone.information)?),
        known_bound95_m: 0.0,
        apart,
    };
    let freedom = if apart > 1.0 { (state.step.len() as f64).min(alone.freedom) } else { alone.freedom };
    let covariance = covariance.transpose().as_slice().to_vec();
    Some(FitWithLens { target: along(&state), fit, joint: Some(LensCoupling { found, covariance, freedom, larger }) })
}

/// Normal equations of the lens, by pictures and arm, at the best frames.
struct LensEquations {
    /// Information of pictures and arm on the lens.
    information: DMatrix<f64>,
    /// Part of the arm in the information, and its gradient.
    of_arm: DMatrix<f64>,
    arm_pull: DVector<f64>,
    pull: DVector<f64>,
    /// Derivatives of the frames by the lens, one row for each unknown.
    follow: DMatrix<f64>,
}

impl LensEquations {
    fn from_rows(state: &LensState, fit: &HandEyeFit, rows: &[(usize, PosePair)]) -> Option<Self> {
        let count = state.step.len();
        let weights = fit.noise.weights();
        let (mut frames, mut mixed) = (DMatrix::zeros(UNKNOWNS, UNKNOWNS), DMatrix::zeros(UNKNOWNS, count));
        let (mut of_arm, mut arm_pull) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (row, pair) in rows {
            let by_lens = in_sight(pair, state.poses.get(*row)?, state.follow.get(*row)?);
            let off = errors(pair, &fit.frames);
            let by_frames = derivatives(pair, &fit.frames);
            let numbers = by_frames.iter().zip(by_lens.row_iter()).zip(off).zip(weights);
            for (((by_frames, by_lens), off), weight) in numbers {
                let (by_frames, by_lens) = (DVector::from_row_slice(by_frames), by_lens.transpose());
                frames += &by_frames * by_frames.transpose() * weight;
                mixed += &by_frames * by_lens.transpose() * weight;
                of_arm += &by_lens * by_lens.transpose() * weight;
                arm_pull -= &by_lens * (weight * off);
            }
        }
        let factor = linalg::cholesky(frames.as_slice(), UNKNOWNS, 0.0)?;
        let inverse = DMatrix::from_row_slice(UNKNOWNS, UNKNOWNS, &linalg::inverse(&factor));
        let follow = inverse * &mixed;
        let of_arm = of_arm - mixed.transpose() * &follow;
        let information = &state.information + &of_arm;
        let pull = &state.pull + &arm_pull;
        Some(LensEquations { information, of_arm, arm_pull, pull, follow })
    }

    /// Best step of the lens, with its gain in squared standard deviations.
    fn step(&self) -> Option<(DVector<f64>, f64)> {
        let by = linalg::solve_symmetric(self.information.clone(), &self.pull)?;
        let gain = by.dot(&self.pull);
        Some((by, gain))
    }

    /// Difference of the arm's lens from that of the pictures, at the latter, in units of its noise; 1 if noise explains it. The arm's gradient has
    /// the variance `K + K G⁻¹ K`, with its own information K and that of the pictures G. Only directions that the arm determines count.
    fn lens_distance(&self, state: &LensState, fit: &HandEyeFit) -> Option<f64> {
        let count = state.step.len();
        // The units are those in which the pictures' information is 1: G = L Lᵀ.
        let whitened = linalg::whiten_columns(state.information.clone(), &self.of_arm)?;
        let twice = linalg::whiten_columns(state.information.clone(), &whitened.transpose())?;
        let pull = DMatrix::from_column_slice(count, 1, self.arm_pull.as_slice());
        let pull = linalg::whiten_columns(state.information.clone(), &pull)?;
        let (values, vectors) = linalg::symmetric_eigen(twice.as_slice(), count);
        let (mut squares, mut directions) = (0.0, 0.0);
        for (k, &says) in values.iter().enumerate().filter(|(_, value)| **value > SAYS) {
            let along = vectors.column(k).dot(&pull.column(0));
            squares += along * along / (says + says * says);
            directions += 1.0;
        }
        let freedom = fit.noise.freedom.iter().copied().fold(f64::INFINITY, f64::min).clamp(1.0, 1e6);
        let is_apart = directions > 0.0 && squares / directions > f_quantile(CHANCE, directions, freedom);
        Some(if is_apart { (squares / directions).sqrt() } else { 1.0 })
    }
}

/// Derivatives of the six numbers of a row by the lens: shift of the measured point, and turn, in the axes of the line of sight. `follow`
/// is that of the board's origin.
fn in_sight(pair: &PosePair, board: &Pose, follow: &Matrix6xX<f64>) -> Matrix6xX<f64> {
    let axes = sight_axes(&pair.seen);
    let arm = pair.seen.translation - board.translation;
    let mut to = Matrix6::zeros();
    to.fixed_view_mut::<3, 3>(0, 0).copy_from(&axes);
    to.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-axes * hat(&arm)));
    to.fixed_view_mut::<3, 3>(3, 3).copy_from(&axes);
    to * follow
}
