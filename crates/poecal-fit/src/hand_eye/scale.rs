//! Lengths of the camera compared with those of the arm: a board whose size is stated wrongly, or another focal length.

use super::equations::{NUMBERS, PosePair, UNKNOWNS, derivatives, errors, normal, sight_axes};
use super::fit::{HandEyeFit, variance_along};
use poecal_arm::lie::Pose;
use poecal_numerics::distributions::f_quantile;

/// Noise of orientations, radians, that exceeds that of any camera.
pub(crate) const NO_CAMERA: f64 = 0.1;
/// Smallest difference of scales that is reported.
const OTHER_SCALE: f64 = 3e-3;
/// Probability by chance at which scales differ.
const CHANCE: f64 = 1e-4;
/// Largest scale that is searched if poses do not fit.
const FARTHEST: f64 = 20.0;
/// Largest number of rounds in which a gross scale is estimated, and the change at which it has converged.
const ROUNDS: usize = 8;
const FOUND: f64 = 1e-3;
/// Factor by which the errors of positions are smaller with a gross scale that explains them.
const EXPLAINS: f64 = 0.2;

/// Relative excess of the camera's lengths, with its information; `None` if it is not determined.
fn share(rows: &[PosePair], fit: &HandEyeFit) -> Option<(f64, f64)> {
    let weights = fit.noise.weights();
    let known = normal(rows.iter().map(|it| (it, weights)), &fit.frames).covariance()?;
    let (mut size, mut along, mut mixed) = (0.0, 0.0, [0.0; UNKNOWNS]);
    for pair in rows {
        // The point's part, which is of the same scale, is left out.
        let seen = sight_axes(&pair.seen) * pair.seen.translation;
        let numbers = [seen.x, seen.y, seen.z];
        let derivatives = derivatives(pair, &fit.frames);
        for (k, error) in errors(pair, &fit.frames).iter().take(NUMBERS / 2).enumerate() {
            size += weights[k] * numbers[k] * numbers[k];
            along += weights[k] * numbers[k] * error;
            mixed.iter_mut().zip(derivatives[k]).for_each(|(sum, it)| *sum += weights[k] * numbers[k] * it);
        }
    }
    let left = size - variance_along(&known, &mixed);
    (left > 1e-9 * size).then_some((along / left, left))
}

/// Ratio of the camera's lengths to the arm's, if it is significant: from all rows, from those that count, and from whether they fit
/// together.
pub(crate) fn length_scale((rows, kept): (&[PosePair], &[PosePair]), fit: &HandEyeFit, fits: bool) -> Option<f64> {
    if fits { find_scale(kept, fit) } else { explain_scale(rows, fit) }
}

/// The ratio if it differs from 1 by more than chance, from the rows that count.
fn find_scale(kept: &[PosePair], fit: &HandEyeFit) -> Option<f64> {
    let (share, information) = share(kept, fit)?;
    let freedom = fit.noise.freedom.first().copied().unwrap_or(1.0).clamp(1.0, 1e6);
    let is_evident = share * share * information > f_quantile(CHANCE, 1.0, freedom);
    (is_evident && share.abs() > OTHER_SCALE && share < 1.0).then(|| 1.0 / (1.0 - share))
}

/// The ratio of poses that do not fit together, if it is the cause: lengths that are many times too long or too short.
fn explain_scale(rows: &[PosePair], fit: &HandEyeFit) -> Option<f64> {
    let mut times = 1.0;
    for _ in 0..ROUNDS {
        let scaled = shorten_rows(rows, times);
        let now = HandEyeFit::from_pairs(&scaled)?;
        let (share, _) = share(&now.seen_about(&scaled), &now)?;
        if share.abs() < FOUND {
            let places = |fit: &HandEyeFit| fit.noise.sigma(0).max(fit.noise.sigma(2));
            let turns = now.noise.sigma(3).max(now.noise.sigma(5));
            let is_explained = times * places(&now) < EXPLAINS * places(fit) && turns < NO_CAMERA;
            return is_explained.then_some(times);
        }
        times /= (1.0 - share).clamp(1.0 / FARTHEST, FARTHEST);
        if !(1.0 / FARTHEST..FARTHEST).contains(&times) {
            return None;
        }
    }
    None
}

/// Rows whose positions are divided by a factor.
fn shorten_rows(rows: &[PosePair], times: f64) -> Vec<PosePair> {
    let of = |pair: &PosePair| {
        let seen = Pose::new(pair.seen.rotation, pair.seen.translation / times);
        PosePair { seen, ..*pair }
    };
    rows.iter().map(of).collect()
}

/// True if the ratio of lengths is so far from 1 that all resulting positions are wrong.
pub(crate) fn is_gross(times: f64) -> bool {
    !(2.0 / 3.0..=1.505).contains(&times)
}

/// Description of another scale, with a remedy.
pub(crate) fn words(times: f64) -> String {
    let size = if !is_gross(times) {
        let share = 100.0 * (times - 1.0);
        format!("{:.1} % {} than the arm's", share.abs(), if share > 0.0 { "longer" } else { "shorter" })
    } else {
        format!("{times:.3} times the arm's")
    };
    format!(
        "the camera's lengths are {size}: check the size of the board's squares or markers (divided by {times:.4} it fits), and the camera's focal length"
    )
}
