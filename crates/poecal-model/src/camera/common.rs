//! Shared error of the corners of one picture: the error of the configuration (theory.md §4, *Pictures*).

use nalgebra::{Matrix6, Vector6};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use poecal_arm::lie::{Pose, hat};
use poecal_numerics::linalg;

/// Standard deviations of the shared error of the corners of a picture, each component: errors of the arm beyond its model, its repeatability, and
/// other motions of a whole board in its picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommonError {
    /// Shift, metres.
    pub shift_m: f64,
    /// Turn, rad.
    pub turn_rad: f64,
    /// Centre of the turn.
    pub about: Centre,
    /// Factor by which the corners move the pose that they determine more than by their own noise. It is above 1 if their errors have a common
    /// cause, such as another lens or board.
    pub corners: f64,
}

/// Centre of the turn of the shared error of a picture's corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Centre {
    /// The board: the centre for an arm that holds it, or for corners with a common error.
    #[default]
    Board,
    /// The camera: the centre for an arm that holds it.
    Camera,
}

impl Default for CommonError {
    /// Initial values: 1 mm and 1 mrad.
    fn default() -> Self {
        CommonError { shift_m: 1e-3, turn_rad: 1e-3, about: Centre::Board, corners: 1.0 }
    }
}

/// Share of the largest eigenvalue below which a direction is not determined by the corners.
const UNDETERMINED: f64 = 1e-12;

impl CommonError {
    /// Corners without a shared error.
    pub const NONE: CommonError = CommonError { shift_m: 0.0, turn_rad: 0.0, about: Centre::Board, corners: 1.0 };
    /// Smallest standard deviation that is sought, m and rad.
    pub const FINEST: f64 = 1e-6;

    /// `W = (c²H⁻¹ + Q)^{-1/2}`, the whitening of the pose of a picture. Its corners have the information H (1/m², 1/rad²), their noise the
    /// factor c, and their shared error the covariance Q. Directions that the corners do not determine have no weight. The matrix is symmetric
    /// if a radian counts `length_m`.
    #[must_use]
    pub fn whitening(&self, information: &Matrix6<f64>, length_m: f64) -> Matrix6<f64> {
        let root = root_of(information, length_m) / self.corners;
        let turn_m = self.turn_rad * length_m;
        let own = Vector6::new(self.shift_m, self.shift_m, self.shift_m, turn_m, turn_m, turn_m);
        // (H⁻¹ + Q)⁻¹ = L (1 + LᵀQL)⁻¹ Lᵀ with H = L Lᵀ.
        let spread = Matrix6::from_diagonal(&own.component_mul(&own));
        let inner = Matrix6::identity() + root * spread * root;
        let Some(factor) = linalg::cholesky_6(inner) else { return Matrix6::zeros() };
        let whole = root * factor.solve(&root);
        let mut whitening = power(&whole, |value| value.sqrt());
        whitening.fixed_columns_mut::<3>(3).scale_mut(length_m);
        whitening
    }

    /// Maximum-likelihood estimate, beginning from this one. Each pose has the expected squares of its deviation from the true one (m, rad) and
    /// the information of its corners; a fit has used `unknowns` degrees of freedom beside. Returns `-2 log L` with it.
    #[must_use]
    pub fn estimate_likely(&self, seen: &[(Matrix6<f64>, Matrix6<f64>)], unknowns: f64, length_m: f64) -> (Self, f64) {
        let roots: Vec<(Matrix6<f64>, Matrix6<f64>)> = seen
            .iter()
            .map(|(information, squares)| {
                let mut scaled = *squares;
                scaled.fixed_rows_mut::<3>(3).scale_mut(length_m);
                scaled.fixed_columns_mut::<3>(3).scale_mut(length_m);
                let root = root_of(information, length_m);
                (root, root * scaled * root)
            })
            .collect();
        let numbers = 6.0 * seen.len() as f64;
        // Residuals are smaller than errors by the degrees of freedom of the unknowns.
        let taken = numbers / (numbers - unknowns).max(6.0);
        let surprise = |logs: &[f64; 3]| {
            let [a, b, c] = logs.map(|it| it.exp().powi(2));
            let spread = Matrix6::from_diagonal(&Vector6::new(a, a, a, b, b, b)) / c;
            let of = |(root, whitened): &(Matrix6<f64>, Matrix6<f64>)| {
                let inner = Matrix6::identity() + root * spread * root;
                let Some(factor) = linalg::cholesky_6(inner) else { return f64::INFINITY };
                let logs: f64 = (0..6).map(|k| factor.l_dirty()[(k, k)].ln()).sum();
                2.0 * logs + 6.0 * c.ln() + taken * bounded_loss(factor.solve(whitened).trace() / c)
            };
            roots.iter().map(of).sum::<f64>()
        };
        let [shift, turn] = [self.shift_m, self.turn_rad * length_m].map(|it| it.max(Self::FINEST).ln());
        let alone = minimize_logarithms(&surprise, [shift, turn, 0.0], 2);
        let start = if self.corners > 1.0 { [shift, turn, self.corners.ln()] } else { alone.0 };
        let with_corners = minimize_logarithms(&surprise, start, 3);
        let (at, best) = if with_corners.1 + EVIDENT < alone.1 { with_corners } else { alone };
        let [shift_m, turn_m, corners] = at.map(f64::exp);
        (CommonError { shift_m, turn_rad: turn_m / length_m, corners, ..*self }, best)
    }
}

/// Minimum of a function of the first `free` of three logarithms: coordinate by coordinate, with steps that halve, and no derivative to get wrong.
fn minimize_logarithms(of: &impl Fn(&[f64; 3]) -> f64, start: [f64; 3], free: usize) -> ([f64; 3], f64) {
    let (mut at, mut step, mut best) = (start, 1.0, of(&start));
    while step > 1e-2 {
        let mut moved = false;
        for k in 0..free {
            let [from, to] = if k < 2 { [CommonError::FINEST, LARGEST] } else { [1.0, MOST_TIMES] };
            for sign in [step, -step] {
                let mut other = at;
                other[k] = (other[k] + sign).clamp(from.ln(), to.ln());
                let found = of(&other);
                if found < best - 1e-9 {
                    (best, at, moved) = (found, other, true);
                }
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    (at, best)
}

/// Largest standard deviation that is sought, metres.
const LARGEST: f64 = 0.1;
/// Largest factor of the noise of corners that is sought.
const MOST_TIMES: f64 = 100.0;
/// Twice the logarithm of a likelihood ratio that one more number reaches by chance in one of 1,000.
const EVIDENT: f64 = 10.83;

/// Loss of the squares of six numbers, bounded so that a picture of another configuration has little effect: logarithmic beyond 5 standard
/// deviations of each.
fn bounded_loss(square: f64) -> f64 {
    const FAR: f64 = 6.0 * 25.0;
    if square <= FAR { square } else { FAR * (1.0 + (square / FAR).ln()) }
}

/// Symmetric root of an information in which a radian counts a length, without directions that are not determined.
fn root_of(information: &Matrix6<f64>, length_m: f64) -> Matrix6<f64> {
    let mut scaled = *information;
    for k in 3..6 {
        scaled.row_mut(k).scale_mut(1.0 / length_m);
        scaled.column_mut(k).scale_mut(1.0 / length_m);
    }
    power(&scaled, |value| value.sqrt())
}

/// A symmetric matrix with a function of its eigenvalues in their place; 0 for eigenvalues that are rounding beside the largest.
fn power(matrix: &Matrix6<f64>, function: impl Fn(f64) -> f64) -> Matrix6<f64> {
    let (values, vectors) = linalg::symmetric_eigen(matrix.as_slice(), 6);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let mut found = Matrix6::zeros();
    for (k, value) in values.iter().enumerate().filter(|(_, value)| **value > UNDETERMINED * largest) {
        let vector = Vector6::from_fn(|row, _| vectors[(row, k)]);
        found += vector * vector.transpose() * function(*value);
    }
    found
}

/// Motion of a pose whose inverse moves by `(δ', ω')`: `ω = -R ω'`, `δ = -R δ' + p × R ω'` (theory.md §4, *Pictures*).
#[must_use]
pub fn motion_by_inverse(pose: &Pose) -> Matrix6<f64> {
    let mut back = Matrix6::zeros();
    back.fixed_view_mut::<3, 3>(0, 0).copy_from(&-pose.rotation);
    back.fixed_view_mut::<3, 3>(3, 3).copy_from(&-pose.rotation);
    back.fixed_view_mut::<3, 3>(0, 3).copy_from(&(hat(&pose.translation) * pose.rotation));
    back
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::move_pose;
    use nalgebra::Vector3;

    #[test]
    fn the_inverse_moves_as_its_information_says() {
        let pose = Pose::from_xyz_rpy([0.1, -0.2, 0.7], [0.3, 2.0, -0.4]);
        let step = Vector6::new(1e-6, -2e-6, 3e-6, 2e-6, 1e-6, -1e-6);
        let other = move_pose(&pose, &step).inverse();
        let turn = poecal_arm::lie::rotation::log(&(other.rotation * pose.inverse().rotation.transpose()));
        let shift: Vector3<f64> = other.translation - pose.inverse().translation;
        let back = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        // A quadratic form keeps its value: vᵀHv = v'ᵀH'v'.
        let mut information = Matrix6::from_diagonal(&Vector6::new(4.0, 1.0, 2.0, 3.0, 5.0, 7.0));
        information[(0, 4)] = 0.5;
        information[(4, 0)] = 0.5;
        let before = (step.transpose() * information * step)[0];
        let by_inverse = motion_by_inverse(&pose);
        let after = (back.transpose() * by_inverse.transpose() * information * by_inverse * back)[0];
        println!("relative difference {:.1e}", (after - before).abs() / before);
        // Second order of steps of 1e-6.
        assert!((after - before).abs() < 1e-5 * before);
    }

    #[test]
    fn the_common_error_is_found_among_the_noise_of_corners() {
        use rand_core::{Rng, SeedableRng};
        const SESSIONS: u64 = 8;
        for corners in [1.0, 4.0] {
            let truth = CommonError { shift_m: 0.4e-3, turn_rad: 0.8e-3, about: Centre::Board, corners };
            let length_m = 0.3;
            let sigmas = [1e-4, 2e-4, 8e-4, 1e-3, 2e-3, 4e-4];
            let information = Matrix6::from_diagonal(&Vector6::from(sigmas.map(|it: f64| it.powi(-2))));
            let (mut shift, mut turn, mut times, mut variance) = (0.0, 0.0, 0.0, 0.0);
            for seed in 0..SESSIONS {
                let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
                let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
                let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                let seen: Vec<_> = (0..300)
                    .map(|_| {
                        let own = |k: usize| if k < 3 { truth.shift_m } else { truth.turn_rad };
                        let off = Vector6::from_fn(|k, _| corners * normal() * sigmas[k] + normal() * own(k));
                        (information, off * off.transpose())
                    })
                    .collect();
                let (found, _) = CommonError::default().estimate_likely(&seen, 0.0, length_m);
                shift += (found.shift_m / truth.shift_m).ln() / SESSIONS as f64;
                turn += (found.turn_rad / truth.turn_rad).ln() / SESSIONS as f64;
                times += (found.corners / corners).ln() / SESSIONS as f64;
                let whitening = truth.whitening(&information, length_m);
                let squares = seen.iter().map(|(_, it)| (whitening * it * whitening.transpose()).trace()).sum::<f64>();
                variance += squares / (6.0 * seen.len() as f64) / SESSIONS as f64;
            }
            println!(
                "shift {:.3}, turn {:.3}, corners {:.3} of the truth, variance {variance:.3}",
                shift.exp(),
                turn.exp(),
                times.exp()
            );
            // One session determines shift and turn to 3 and 5 %, eight to 1 and 2 %; the error is three times as large if the corners hide
            // them.
            assert!(shift.abs() < 0.04 * corners && turn.abs() < 0.06 * corners, "{shift} {turn}");
            assert!(times.abs() < 0.02 && (corners > 1.0 || times == 0.0), "{times}");
            assert!((variance - 1.0).abs() < 0.03);
        }
    }
}
