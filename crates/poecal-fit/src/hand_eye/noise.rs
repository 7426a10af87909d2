//! Noise of the camera's poses by its parts, from the residuals: across and along the line of sight, of tilts and of the rotation about it.

use super::equations::{FrameEquations, FramePair, NUMBERS, PosePair, UNKNOWNS, derivatives, errors};
use poecal_numerics::distributions::f_quantile;
use poecal_numerics::linalg::{cholesky, inverse};

/// Smallest standard deviation, metres and radians: that of numbers without noise.
const LEAST: f64 = 1e-10;
/// Rounds of the estimate.
const ROUNDS: usize = 50;
/// Probability by chance at which two parts of a noise count as different.
const DIFFERENT: f64 = 0.01;

/// Standard deviations of the six numbers of a pose. Parts without a significant difference are one.
#[derive(Clone, Debug)]
pub(crate) struct PoseNoise {
    /// Part to which each number belongs.
    pub(crate) part_of: [usize; NUMBERS],
    /// Variance of each part.
    pub(crate) variance: Vec<f64>,
    /// Degrees of freedom of each variance.
    pub(crate) freedom: Vec<f64>,
    /// Degrees of freedom of positions that the point of the target has used.
    pub(crate) spent: f64,
}

/// Positions and orientations, each isotropic.
const ALIKE: [usize; NUMBERS] = [0, 0, 0, 1, 1, 1];

impl PoseNoise {
    /// Noise of stated standard deviations.
    pub(crate) fn from_standard_deviations(sigma_m: f64, sigma_rad: f64) -> Self {
        let variance = [sigma_m, sigma_rad].map(|it| it.max(LEAST).powi(2)).to_vec();
        PoseNoise { part_of: ALIKE, variance, freedom: vec![f64::INFINITY; 2], spent: 0.0 }
    }

    /// Weights of the six numbers.
    pub(crate) fn weights(&self) -> [f64; NUMBERS] {
        self.part_of.map(|part| self.variance.get(part).map_or(0.0, |it| 1.0 / it))
    }

    /// Standard deviation of a number.
    pub(crate) fn sigma(&self, number: usize) -> f64 {
        let part = self.part_of.get(number).copied().unwrap_or_default();
        self.variance.get(part).copied().unwrap_or_default().sqrt()
    }

    /// Sum of squares of errors in units of the noise.
    pub(crate) fn squares(&self, errors: &[f64; NUMBERS]) -> f64 {
        errors.iter().zip(self.weights()).map(|(error, weight)| error * error * weight).sum()
    }

    /// The same parts from the residuals of rows about their fit (forstner1979): each the mean square over its degrees of freedom, which
    /// are its numbers less its share of the unknowns. `None` if the rows do not determine the unknowns, or a part has no degrees of
    /// freedom.
    pub(crate) fn estimate_from(&self, pairs: &[PosePair], frames: &FramePair) -> Option<PoseNoise> {
        let parts = NoiseParts::from_pairs(self.part_of, self.variance.len(), pairs, frames);
        let mut noise = self.clone();
        for _ in 0..ROUNDS {
            let known = parts.covariance(&noise.variance)?;
            let mut change: f64 = 0.0;
            for (part, normal) in parts.normals.iter().enumerate() {
                let variance = noise.variance[part];
                let places = self.part_of.iter().take(3).filter(|it| **it == part).count() as f64 / 3.0;
                let told = product_trace(&known, &normal.gram) / variance;
                let freedom = parts.counts[part] - told - self.spent * places;
                if freedom < 0.5 {
                    return None;
                }
                let next = (parts.squares[part] / freedom).max(LEAST * LEAST);
                change = change.max((next / variance).ln().abs());
                (noise.variance[part], noise.freedom[part]) = (next, freedom);
            }
            if change < 1e-9 {
                break;
            }
        }
        Some(noise)
    }

    /// The same noise with parts of their own for directions along the line of sight, where they differ by more than chance.
    pub(crate) fn apart_where_they_differ(&self, pairs: &[PosePair], frames: &FramePair) -> PoseNoise {
        let mut noise = self.clone();
        for (numbers, single) in [([0, 1, 2], 2), ([3, 4, 5], 5)] {
            let part = noise.part_of[numbers[0]];
            if numbers.iter().any(|&k| noise.part_of[k] != part) {
                continue;
            }
            let mut apart = noise.clone();
            apart.part_of[single] = apart.variance.len();
            apart.variance.push(apart.variance[part]);
            apart.freedom.push(0.0);
            let Some(apart) = apart.estimate_from(pairs, frames) else { continue };
            let last = apart.variance.len() - 1;
            let (mut a, mut b) =
                ((apart.variance[part], apart.freedom[part]), (apart.variance[last], apart.freedom[last]));
            if a.0 < b.0 {
                std::mem::swap(&mut a, &mut b);
            }
            if b.1 > 2.0 && a.0 / b.0 > f_quantile(0.5 * DIFFERENT, a.1, b.1) {
                noise = apart;
            }
        }
        noise
    }
}

/// Normal equations, sum of squares and number of residuals of each part.
struct NoiseParts {
    normals: Vec<FrameEquations>,
    squares: Vec<f64>,
    counts: Vec<f64>,
}

impl NoiseParts {
    fn from_pairs(part_of: [usize; NUMBERS], parts: usize, pairs: &[PosePair], frames: &FramePair) -> Self {
        let mut all = NoiseParts {
            normals: vec![FrameEquations::zero(); parts],
            squares: vec![0.0; parts],
            counts: vec![0.0; parts],
        };
        for pair in pairs {
            let errors = errors(pair, frames);
            for ((row, error), part) in derivatives(pair, frames).iter().zip(errors).zip(part_of) {
                all.normals[part].add(row, error, 1.0);
                all.squares[part] += error * error;
                all.counts[part] += 1.0;
            }
        }
        all
    }

    /// Covariance of the unknowns for these variances.
    fn covariance(&self, variances: &[f64]) -> Option<Vec<f64>> {
        let mut gram = vec![0.0; UNKNOWNS * UNKNOWNS];
        for (normal, variance) in self.normals.iter().zip(variances) {
            gram.iter_mut().zip(&normal.gram).for_each(|(sum, it)| *sum += it / variance);
        }
        Some(inverse(&cholesky(&gram, UNKNOWNS, 0.0)?))
    }
}

/// `tr(A B)` of two symmetric matrices, both stored in full.
fn product_trace(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Covariance of the unknowns, and the part of it that each part of the noise causes, with the degrees of freedom of that part.
pub(crate) struct FrameCovariance {
    pub(crate) covariance: Vec<f64>,
    pub(crate) by_part: Vec<(Vec<f64>, f64)>,
}

impl FrameCovariance {
    /// Covariance by rows about their fit.
    pub(crate) fn from_pairs(noise: &PoseNoise, pairs: &[PosePair], frames: &FramePair) -> Option<Self> {
        let parts = NoiseParts::from_pairs(noise.part_of, noise.variance.len(), pairs, frames);
        let mut covariance = parts.covariance(&noise.variance)?;
        let wider = follows(noise, pairs, frames);
        let by_part = parts.normals.iter().zip(&noise.variance).zip(&noise.freedom);
        let by_part = by_part.map(|((normal, variance), freedom)| {
            let share = product(&product(&covariance, &normal.gram), &covariance);
            (share.iter().map(|it| wider * it / variance).collect(), freedom / wider)
        });
        let by_part = by_part.collect();
        covariance.iter_mut().for_each(|it| *it *= wider);
        Some(FrameCovariance { covariance, by_part })
    }

    /// The same covariance for noise whose variance is larger by a factor.
    pub(crate) fn enlarge(mut self, factor: f64) -> Self {
        let parts = self.by_part.iter_mut().map(|(part, _)| part);
        parts.chain([&mut self.covariance]).flatten().for_each(|it| *it *= factor);
        self
    }

    /// The same covariance with a further part, which is known with these degrees of freedom.
    pub(crate) fn with_part(mut self, part: Vec<f64>, freedom: f64) -> Self {
        self.covariance.iter_mut().zip(&part).for_each(|(sum, it)| *sum += it);
        self.by_part.push((part, freedom));
        self
    }
}

/// Fewest rows in which serial correlation of errors is tested.
const ROWS_IN_ORDER: usize = 20;

/// Factor by which variances grow because errors of consecutive rows are correlated, as those of an arm along its path are. It is 1 if
/// they are not correlated by more than chance.
fn follows(noise: &PoseNoise, pairs: &[PosePair], frames: &FramePair) -> f64 {
    if pairs.len() < ROWS_IN_ORDER {
        return 1.0;
    }
    let weights = noise.weights();
    let rows: Vec<[f64; NUMBERS]> = pairs
        .iter()
        .map(|pair| {
            let mut errors = errors(pair, frames);
            errors.iter_mut().zip(weights).for_each(|(error, weight)| *error *= weight.sqrt());
            errors
        })
        .collect();
    let product = |a: &[f64; NUMBERS], b: &[f64; NUMBERS]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let squares: f64 = rows.iter().map(|row| product(row, row)).sum();
    let next: f64 = rows.iter().zip(rows.iter().skip(1)).map(|(row, next)| product(row, next)).sum();
    let alike = (next / squares.max(f64::MIN_POSITIVE)).min(0.95);
    let chance = 2.0 / ((NUMBERS * pairs.len()) as f64).sqrt();
    if alike > chance { (1.0 + alike) / (1.0 - alike) } else { 1.0 }
}

/// Product of two square matrices of the unknowns.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let cell = |at: usize| {
        let (i, j) = (at / UNKNOWNS, at % UNKNOWNS);
        (0..UNKNOWNS).map(|k| a[i * UNKNOWNS + k] * b[k * UNKNOWNS + j]).sum()
    };
    (0..UNKNOWNS * UNKNOWNS).map(cell).collect()
}
