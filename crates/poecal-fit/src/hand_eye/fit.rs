//! The fit: a start that is robust against gross errors, noise by its parts, rows without outliers, and the point of the target that is
//! measured best.

use nalgebra::{Matrix3, Vector3};

use super::draw::LinearCongruential;
use super::equations::{
    FramePair, NUMBERS, PosePair, UNKNOWNS, derivatives, errors, in_closed_form, minimize_frames, sight_axes,
};
use super::noise::PoseNoise;
use poecal_arm::lie::{Pose, hat};
use poecal_numerics::distributions::{chi_square_median, f_quantile, median};
use poecal_numerics::linalg::{cholesky, cholesky_solve};

/// Number of starts from a few poses each.
pub(crate) const STARTS: usize = 80;
/// The same number where many sessions are compared.
pub(crate) const FEW_STARTS: usize = 12;
/// Poses of such a start.
const POSES_OF_START: usize = 4;
/// Probability with which a session without outliers loses a row.
const LOST: f64 = 0.01;
/// Initial factor of the bound of outliers, for gross ones.
const SLACK: f64 = 4.0;
/// Rounds of fit, noise and outliers.
const ROUNDS: usize = 30;
/// Probability by chance at which a point of the target counts as measured better than its origin.
const OTHER_POINT: f64 = 0.05;
/// Fewest rows with which such a point is sought.
const ROWS_OF_POINT: usize = 6;

/// A finished fit.
#[derive(Clone, Debug)]
pub(crate) struct HandEyeFit {
    pub(crate) frames: FramePair,
    pub(crate) noise: PoseNoise,
    /// For each row, true if it counts.
    pub(crate) kept: Vec<bool>,
    /// Point of the target, in its frame, whose position and orientation are measured independently of each other.
    pub(crate) point: Vector3<f64>,
    /// Factor of the bound beyond which a row is an outlier: above 1 until the parts of the noise are known.
    slack: f64,
}

impl HandEyeFit {
    /// Fit of all rows. `None` if they do not determine the frames.
    pub(crate) fn from_pairs(pairs: &[PosePair]) -> Option<Self> {
        HandEyeFit::from_start(pairs, start(pairs, STARTS)?)
    }

    /// The same fit from a start.
    pub(crate) fn from_start(pairs: &[PosePair], frames: FramePair) -> Option<Self> {
        let noise = rough_noise(pairs, &frames);
        let mut fit =
            HandEyeFit { frames, noise, kept: vec![true; pairs.len()], point: Vector3::zeros(), slack: SLACK };
        fit.choose(pairs);
        fit.settle(pairs, false)?;
        // Two rounds, since the first point is found with the noise of the origin.
        for _ in 0..2 {
            let about = fit.seen_about(pairs);
            let Some(further) = fit.better_point(&fit.rows(&about)) else { break };
            fit.move_point(further);
            fit.settle(pairs, true)?;
        }
        fit.slack = 1.0;
        fit.settle(pairs, true)?;
        Some(fit)
    }

    /// The same model fitted to other rows, which all count, from these frames and with this noise.
    pub(crate) fn refit(&self, pairs: &[PosePair]) -> Option<FramePair> {
        let about = self.seen_about(pairs);
        let weights = self.noise.weights();
        minimize_frames(&about, self.frames, &weights)
    }

    /// Measured poses of the point, in place of the target's origin.
    pub(crate) fn seen_about(&self, pairs: &[PosePair]) -> Vec<PosePair> {
        let to = Pose::from_translation(self.point);
        pairs.iter().map(|it| PosePair { seen: it.seen * to, ..*it }).collect()
    }

    /// The frames of the target itself.
    pub(crate) fn own_frames(&self) -> FramePair {
        self.of_target(&self.frames)
    }

    /// Frames of the point as those of the target itself.
    pub(crate) fn of_target(&self, frames: &FramePair) -> FramePair {
        FramePair { inner: frames.inner * Pose::from_translation(-self.point), ..*frames }
    }

    fn move_point(&mut self, further: Vector3<f64>) {
        self.point += further;
        self.noise.spent = 3.0;
        self.frames.inner = self.frames.inner * Pose::from_translation(further);
    }

    /// Rows that count.
    pub(crate) fn rows(&self, pairs: &[PosePair]) -> Vec<PosePair> {
        pairs.iter().zip(&self.kept).filter(|(_, kept)| **kept).map(|(pair, _)| *pair).collect()
    }

    /// Rounds of fit, noise and outliers until no row changes.
    fn settle(&mut self, pairs: &[PosePair], parts: bool) -> Option<()> {
        let about = self.seen_about(pairs);
        for round in 0..ROUNDS {
            let rows = self.rows(&about);
            let weights = self.noise.weights();
            self.frames = minimize_frames(&rows, self.frames, &weights)?;
            let before = self.noise.variance.clone();
            self.noise = self.noise.estimate_from(&rows, &self.frames).unwrap_or_else(|| self.noise.clone());
            if parts {
                self.noise = self.noise.apart_where_they_differ(&rows, &self.frames);
            }
            let changed = self.choose(&about);
            let still = before.len() == self.noise.variance.len()
                && before.iter().zip(&self.noise.variance).all(|(a, b)| (a / b).ln().abs() < 1e-6);
            if !changed && still || round + 1 == ROUNDS {
                break;
            }
        }
        let rows = self.rows(&about);
        let weights = self.noise.weights();
        self.frames = minimize_frames(&rows, self.frames, &weights)?;
        Some(())
    }

    /// Chooses the rows that count. True if the choice changed.
    fn choose(&mut self, about: &[PosePair]) -> bool {
        let cut = self.outlier_limit(about.len());
        let distances = self.distances(about);
        let mut kept: Vec<bool> = distances.iter().map(|distance| *distance <= cut).collect();
        // Enough rows stay that a test is possible.
        let fewest = (about.len() / 2 + 1).min(about.len()).max(3);
        if kept.iter().filter(|it| **it).count() < fewest {
            let mut order: Vec<usize> = (0..about.len()).collect();
            order.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]).then(a.cmp(&b)));
            kept.fill(false);
            order.iter().take(fewest).for_each(|&k| kept[k] = true);
        }
        let changed = kept != self.kept;
        self.kept = kept;
        changed
    }

    /// Mean square of a row's errors beyond which it is an outlier.
    fn outlier_limit(&self, rows: usize) -> f64 {
        let freedom = self.noise.freedom.iter().copied().fold(f64::INFINITY, f64::min).min(1e6);
        self.slack * f_quantile(LOST / rows as f64, NUMBERS as f64, freedom)
    }

    /// Mean square of the errors of each row in units of their expected scatter, which is smaller for a fitted row.
    pub(crate) fn distances(&self, about: &[PosePair]) -> Vec<f64> {
        let leverages = self.leverages(about);
        let rows = about.iter().zip(&self.kept).zip(leverages);
        rows.map(|((pair, kept), leverage)| {
            let squares = self.noise.squares(&errors(pair, &self.frames)) / NUMBERS as f64;
            squares / if *kept { (1.0 - leverage).max(0.05) } else { 1.0 + leverage }
        })
        .collect()
    }

    /// Mean variance of the six predicted numbers of each row in units of their noise.
    fn leverages(&self, about: &[PosePair]) -> Vec<f64> {
        let weights = self.noise.weights();
        let rows = self.rows(about);
        let normal = super::equations::normal(rows.iter().map(|it| (it, weights)), &self.frames);
        let Some(known) = normal.covariance() else { return vec![0.0; about.len()] };
        let of = |pair: &PosePair| {
            let numbers = derivatives(pair, &self.frames).into_iter().zip(weights);
            let sum: f64 = numbers.map(|(row, weight)| weight * variance_along(&known, &row)).sum();
            sum / NUMBERS as f64
        };
        about.iter().map(of).collect()
    }

    /// A point of the target, relative to the present one, at which errors of position are independent of those of orientation. `None` if
    /// it is no better than the present one by more than chance.
    fn better_point(&self, rows: &[PosePair]) -> Option<Vector3<f64>> {
        if rows.len() < ROWS_OF_POINT {
            return None;
        }
        let weights = self.noise.weights();
        let (mut gram, mut right, mut before) = ([0.0; 9], [0.0; 3], 0.0);
        let mut columns = Vec::with_capacity(rows.len());
        for pair in rows {
            let found = errors(pair, &self.frames);
            let axes = sight_axes(&pair.seen);
            let turn = axes.transpose() * Vector3::new(found[3], found[4], found[5]);
            // The position of the point has the error shift + turn × (R point).
            let by_point: Matrix3<f64> = axes * hat(&turn) * pair.seen.rotation;
            for i in 0..3 {
                before += weights[i] * found[i] * found[i];
                for a in 0..3 {
                    right[a] -= weights[i] * by_point[(i, a)] * found[i];
                    for b in 0..3 {
                        gram[3 * a + b] += weights[i] * by_point[(i, a)] * by_point[(i, b)];
                    }
                }
            }
            columns.push((by_point, found));
        }
        let damping = 1e-9 * (gram[0] + gram[4] + gram[8]);
        let found = cholesky_solve(&cholesky(&gram, 3, damping)?, &right);
        let point = Vector3::new(found[0], found[1], found[2]);
        let after: f64 = columns
            .iter()
            .map(|(by_point, errors)| {
                let left = Vector3::new(errors[0], errors[1], errors[2]) + by_point * point;
                (0..3).map(|i| weights[i] * left[i] * left[i]).sum::<f64>()
            })
            .sum();
        let freedom = 3.0 * rows.len() as f64 - 0.5 * UNKNOWNS as f64 - 3.0;
        let gained = (before - after) / 3.0 / (after / freedom);
        // No target is larger than its distance from the camera.
        let far = median(rows.iter().map(|it| it.seen.translation.norm())).unwrap_or_default();
        (gained > f_quantile(OTHER_POINT, 3.0, freedom) && point.norm() < far).then_some(point)
    }
}

/// `rᵀ C r`.
pub(crate) fn variance_along(covariance: &[f64], row: &[f64; UNKNOWNS]) -> f64 {
    let rows = covariance.chunks_exact(UNKNOWNS).zip(row);
    rows.map(|(line, a)| a * line.iter().zip(row).map(|(c, b)| c * b).sum::<f64>()).sum()
}

/// Lengths and angles of the errors of a row.
pub(crate) fn sizes(errors: &[f64; NUMBERS]) -> (f64, f64) {
    let of = |at: usize| Vector3::new(errors[at], errors[at + 1], errors[at + 2]).norm();
    (of(0), of(3))
}

/// Medians of lengths and angles of errors.
pub(crate) fn medians(pairs: &[PosePair], frames: &FramePair) -> (f64, f64) {
    let all: Vec<(f64, f64)> = pairs.iter().map(|pair| sizes(&errors(pair, frames))).collect();
    let of = |values: Vec<f64>| median(values.into_iter()).unwrap_or_default();
    (of(all.iter().map(|it| it.0).collect()), of(all.iter().map(|it| it.1).collect()))
}

/// The best start by the median errors of all poses: from all of them, or from a few.
pub(crate) fn start(pairs: &[PosePair], starts: usize) -> Option<FramePair> {
    let all: Vec<&PosePair> = pairs.iter().collect();
    let mut best: Option<(f64, FramePair)> = None;
    let mut consider = |frames: Option<FramePair>| {
        let Some(frames) = frames else { return };
        let (shift, turn) = medians(pairs, &frames);
        let score = shift.max(1e-12).ln() + turn.max(1e-12).ln();
        if score.is_finite() && best.is_none_or(|(least, _)| score < least) {
            best = Some((score, frames));
        }
    };
    consider(in_closed_form(&all));
    let mut draw = LinearCongruential::new(1);
    for _ in 0..if pairs.len() > POSES_OF_START { starts } else { 0 } {
        let few: Vec<&PosePair> =
            draw.distinct_numbers(POSES_OF_START, pairs.len()).into_iter().filter_map(|k| pairs.get(k)).collect();
        consider(in_closed_form(&few));
    }
    best.map(|(_, frames)| frames)
}

/// Noise by the median errors of a start.
fn rough_noise(pairs: &[PosePair], frames: &FramePair) -> PoseNoise {
    let (shift, turn) = medians(pairs, frames);
    let scale = 1.0 / chi_square_median(3).sqrt();
    // Four poses have no redundancy.
    let few = (1.0 + 4.0 / pairs.len() as f64).min(2.0);
    PoseNoise::from_standard_deviations(few * scale * shift, few * scale * turn)
}
