//! Errors that follow the position of one joint, as caused by its transmission or load.

use nalgebra::Vector3;

use super::view::FitView;
use crate::analysis::{ranges, residual_variance};
use crate::state::{Linkage, RowChain, rms_m, sample_rows};
use poecal_model::measurement::NUMBERS;
use poecal_model::robot::JointKind;
use poecal_numerics::linalg;
use poecal_numerics::solve::NormalEquations;

/// Largest number of rows of the search: more are sampled.
const SAMPLE: usize = 4000;
/// Number of shape functions of a joint's position.
const SHAPES: usize = 5;
/// Smallest reported share of the squared errors that follow a joint's position.
const SHARE: f64 = 0.1;
/// Errors below this are rounding, metres.
const ROUNDING_M: f64 = 1e-9;
/// Quantile of χ² with five degrees of freedom that is exceeded once in 10,000, in units of the variance of the residuals.
const CHANCE: f64 = 25.7;

/// Errors that follow a joint's position, as errors of that position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPattern {
    /// Share of the squared whitened position errors.
    pub share: f64,
    /// Root mean square of the joint's error, radians or metres.
    pub rms: f64,
}

/// Normal equations of the amplitudes of one joint's shapes.
#[derive(Clone)]
struct ShapeSums {
    gram: [f64; SHAPES * SHAPES],
    gradient: [f64; SHAPES],
    /// `Σ f fᵀ` without the lever arm, for the joint's error in its own unit.
    shapes: [f64; SHAPES * SHAPES],
}

/// The joint (its index) whose position explains most of the squared errors, if that is significant: theory.md §9 (44).
#[must_use]
pub fn strongest_pattern(view: &FitView<'_>, normal: &NormalEquations) -> Option<(usize, JointPattern)> {
    let rows = sample_rows(view.rows, SAMPLE);
    let joints = view.session.robot.joints.len();
    let ranges = ranges(&view.session, view.rows);
    let empty = ShapeSums { gram: [0.0; SHAPES * SHAPES], gradient: [0.0; SHAPES], shapes: [0.0; SHAPES * SHAPES] };
    let mut sums = vec![empty; joints];
    let errors = view.session.errors(&rows, view.estimate);
    let rms_m = rms_m(&errors);
    let mut squares = 0.0;
    let linkage = Linkage::new(view.estimate);
    let mut chain = RowChain::default();
    for (&row, error) in rows.iter().zip(errors) {
        let observation = view.session.observation(row);
        let Some(quantity) = error.leading_quantity() else { continue };
        let sigma = view.session.noise_of(observation, view.noise)[quantity];
        chain.evaluate(&linkage, view.session.packed, row as usize, observation);
        let mut sensitivity = [[0.0; 6]; NUMBERS];
        observation.measurement.sensitivity(&chain.target, &mut sensitivity);
        let error = error.lead() / sigma;
        squares += error.norm_squared();
        for joint in &chain.joints {
            let sign = if joint.backward { -1.0 } else { 1.0 };
            let (moved, turned) = match joint.kind {
                JointKind::Revolute => (joint.z.cross(&(chain.target.translation - joint.origin)), joint.z),
                JointKind::Prismatic => (joint.z, Vector3::zeros()),
            };
            // Component of the motion that the first quantity measures.
            let mut motion = Vector3::zeros();
            let channels = observation.measurement.channels();
            for (k, component) in channels.components(quantity) {
                let [a, b, c, p, q, r] = sensitivity[k];
                motion[component] = Vector3::new(a, b, c).dot(&moved) + Vector3::new(p, q, r).dot(&turned);
            }
            let shapes = shapes(joint.kind, sign * joint.value, ranges[joint.joint]);
            sums[joint.joint].add(&shapes, &(motion * sign / sigma), &error);
        }
    }
    // Residuals of exact data are rounding, which may follow any shape.
    if rms_m < ROUNDING_M {
        return None;
    }
    let variance = residual_variance(normal);
    let found = sums.iter().enumerate().filter_map(|(joint, sums)| {
        let (explained, rms) = sums.explained_squares(rows.len())?;
        let pattern = JointPattern { share: explained / squares, rms };
        (explained > CHANCE * variance && pattern.share > SHARE).then_some((joint, pattern))
    });
    found.max_by(|a, b| a.1.share.total_cmp(&b.1.share))
}

/// The shapes f(θ) of theory.md §9 (44), with the scale relative to the sampled range. Revolute: θ, cos θ, sin θ, cos 2θ, sin 2θ.
/// Prismatic: orthogonal polynomials of degree 1 to 3.
fn shapes(kind: JointKind, value: f64, (least, most): (f64, f64)) -> [f64; SHAPES] {
    let half = (0.5 * (most - least)).max(f64::MIN_POSITIVE);
    let t = (value - 0.5 * (least + most)) / half;
    match kind {
        JointKind::Revolute => {
            let (sine, cosine) = value.sin_cos();
            let (sine_2, cosine_2) = (2.0 * value).sin_cos();
            [t, cosine, sine, cosine_2, sine_2]
        }
        JointKind::Prismatic => [t, t * t - 1.0 / 3.0, t * t * t - 0.6 * t, 0.0, 0.0],
    }
}

impl ShapeSums {
    fn add(&mut self, shapes: &[f64; SHAPES], motion: &Vector3<f64>, error: &Vector3<f64>) {
        let (lever, along) = (motion.norm_squared(), motion.dot(error));
        for (i, a) in shapes.iter().enumerate() {
            self.gradient[i] += a * along;
            for (j, b) in shapes.iter().enumerate() {
                self.gram[i * SHAPES + j] += a * b * lever;
                self.shapes[i * SHAPES + j] += a * b;
            }
        }
    }

    /// Squares that the best amplitudes explain, `R_j` of theory.md §9 (44), and the root mean square of that error of the joint.
    fn explained_squares(&self, rows: usize) -> Option<(f64, f64)> {
        let scale = (0..SHAPES).map(|i| self.gram[i * SHAPES + i]).fold(0.0, f64::max);
        let factor = linalg::cholesky(&self.gram, SHAPES, 1e-9 * scale)?;
        let amplitudes = linalg::cholesky_solve(&factor, &self.gradient);
        let explained: f64 = amplitudes.iter().zip(&self.gradient).map(|(a, g)| a * g).sum();
        let mean_square: f64 =
            (0..SHAPES * SHAPES).map(|k| self.shapes[k] * amplitudes[k / SHAPES] * amplitudes[k % SHAPES]).sum::<f64>()
                / rows.max(1) as f64;
        Some((explained, mean_square.max(0.0).sqrt()))
    }
}
