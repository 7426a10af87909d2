//! Rank judged against the noise, and what the data leave open, in words with joint names (theory.md §7 (36)).

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::causes::{Degree, explain};
use super::excitation::Excitation;
use super::observability::Observability;
use crate::estimate::{Estimate, Packed};
use crate::linalg;
use crate::measurement::{Dataset, Noise};
use crate::parameters::Parameter;
use crate::problem::Layout;
use crate::robot::{JointKind, Robot};
use crate::solve::Normal;

/// Singular values below this share of the largest are rounding of the normal equations.
const ROUNDING: f64 = 3e-7;
/// A direction is told by the data if its standard deviation is below this share of the length that a radian counts (about 2°,
/// or some 10 to 20 mm on an arm of ordinary size): a robot's drawing is known better than that.
pub(crate) const PLAUSIBLE: f64 = 0.03;
/// A direction is weak if its standard deviation is above this share of that length (some 1 to 2 mm, or 0.2°): about what a robot's
/// drawing is known to, so that a calibration adds little there.
pub(super) const WEAK: f64 = 0.003;
/// An unknown is determined if no more than this share of it (as a cosine) lies in directions that are open: with those uncertain by
/// what is plausible, it is less than the tenth of a millimetre on an arm of ordinary size.
const OPEN_SHARE: f64 = 0.01;

/// Why something is not told. The words stand in `calibration.json` and do not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Structure: along and about its own axis a joint may be moved without effect.
    OwnAxis,
    /// Structure: the device's frame is unknown, so the base frame is a choice.
    BaseFrame,
    /// Structure: zeros of joints cannot be told from screws.
    JointOffsets,
    /// Structure: only positions were measured.
    NoOrientation,
    /// A joint did not move, or its reading only jittered.
    StoodStill,
    /// Fewer measured numbers than unknowns.
    TooFew,
    /// Of a target seen as a point, and lying on the axis of a joint.
    PointOnAxis,
    /// The tool kept one orientation.
    OneOrientation,
    /// The tool turned about one direction only.
    OneTurningDirection,
    /// Joints moved in a fixed relation only.
    MovedTogether,
    /// A joint moved by little.
    SmallMotion,
    /// Joints moved in combinations that hide something, though no simpler cause is seen.
    DependentMotion,
    /// A target was seen once, so that nothing checks it.
    SeenOnce,
    /// None of these.
    #[default]
    Other,
}

impl Cause {
    /// Whether other combinations of the same joint values would have told it.
    pub(super) fn is_combination(self) -> bool {
        matches!(
            self,
            Cause::OneOrientation
                | Cause::OneTurningDirection
                | Cause::MovedTogether
                | Cause::DependentMotion
        )
    }
}

/// Something that the measurements do not tell, or hardly.
///
/// ```
/// # use poecal::{CalibrationOptions, Kind, Simulation, calibrate, simulate::elbow};
/// # let made = Simulation { count: 40, ..Simulation::default() }.run(&elbow(), Kind::Point)?;
/// # let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let structural = &calibration.identifiability.structural;
/// // Points of a tracker that stands anywhere do not tell the base frame: a choice that changes no prediction.
/// assert!(structural.iter().any(|direction| direction.description.contains("base")));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Direction {
    /// What it is, in words.
    pub description: String,
    /// The joints concerned.
    pub joints: Vec<String>,
    /// Why.
    #[serde(default)]
    pub cause: Cause,
    /// How many independent directions of the unknowns it accounts for.
    #[serde(default = "one")]
    pub directions: usize,
}

fn one() -> usize {
    1
}

/// Eigenvalues and eigenvectors of the scaled, whitened information `N`, and which of them count: what an uncertainty is computed
/// from. Steps are in metres; a radian counts as the length in the layout.
///
/// ```
/// use nalgebra::DMatrix;
/// use poecal::analysis::Spectrum;
/// let found = Spectrum { values: vec![0.0, 4.0], vectors: DMatrix::identity(2, 2), open: 1, variance: 1.0 };
/// assert_eq!(found.determined(), [false, true]);
/// assert_eq!(found.variance_along(&[0.0, 1.0]), Some(0.25));
/// assert_eq!(found.variance_along(&[1.0, 1.0]), None);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Eigenvalues, the smallest first, 1/m².
    pub values: Vec<f64>,
    /// Their eigenvectors, a column each, in the order of a step ([`Layout`]).
    pub vectors: DMatrix<f64>,
    /// The first so many are open: below what noise and rounding allow to tell.
    pub open: usize,
    /// Variance of a whitened residual, as found or as given.
    pub variance: f64,
}

impl Spectrum {
    /// Decomposes the information (upper triangle, row-major) of `n` unknowns with the rank judged by the noise; `length_m` is how many
    /// metres a radian counts.
    #[must_use]
    pub fn new(gram: &[f64], n: usize, variance: f64, length_m: f64) -> Self {
        if !gram.iter().all(|value| value.is_finite()) {
            // Numbers that overflowed tell nothing.
            return Spectrum { values: vec![0.0; n], vectors: DMatrix::identity(n, n), open: n, variance };
        }
        let (values, vectors) = linalg::symmetric_eigen(gram, n);
        let least = rounding(&values).max(variance / (PLAUSIBLE * length_m).powi(2));
        let open = values.iter().take_while(|&&value| value <= least || value <= 0.0).count();
        Spectrum { values, vectors, open, variance }
    }

    /// The directions that are open, a column each.
    #[must_use]
    pub fn open_space(&self) -> DMatrix<f64> {
        self.vectors.columns(0, self.open).into_owned()
    }

    /// Standard deviation along an eigenvector, metres; infinite where the eigenvalue is not above zero.
    #[must_use]
    pub fn sigma_m(&self, k: usize) -> f64 {
        match self.values.get(k) {
            Some(&value) if value > 0.0 => (self.variance / value).sqrt(),
            _ => f64::INFINITY,
        }
    }

    /// For each unknown in the order of a step, whether the measurements determine it by itself.
    #[must_use]
    pub fn determined(&self) -> Vec<bool> {
        let n = self.vectors.nrows();
        (0..n)
            .map(|row| {
                let unit: Vec<f64> = (0..n).map(|k| if k == row { 1.0 } else { 0.0 }).collect();
                self.variance_along(&unit).is_some()
            })
            .collect()
    }

    /// Variance of a linear function of the unknowns (its derivative in the order of a step), or `None` if the measurements leave it
    /// open.
    #[must_use]
    pub fn variance_along(&self, derivative: &[f64]) -> Option<f64> {
        let length: f64 = derivative.iter().map(|d| d * d).sum();
        let (mut open, mut variance) = (0.0, 0.0);
        for (k, (&value, vector)) in self.values.iter().zip(self.vectors.column_iter()).enumerate() {
            let along: f64 = vector.iter().zip(derivative).map(|(v, d)| v * d).sum();
            if k < self.open {
                open += along * along;
            } else {
                variance += along * along / value * self.variance;
            }
        }
        (open <= OPEN_SHARE * OPEN_SHARE * length).then_some(variance)
    }
}

/// Eigenvalues below this are rounding.
fn rounding(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or(0.0).max(0.0) * ROUNDING * ROUNDING
}

/// What the measurements determine.
///
/// ```
/// # use poecal::calibration::{CalibrationOptions, calibrate};
/// # use poecal::simulate::{Kind, Simulation, elbow};
/// let made = Simulation { count: 60, ..Simulation::default() }.run(&elbow(), Kind::Point)?;
/// let found = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?.identifiability;
/// assert_eq!((found.rank, found.parameters), (27, 27));
/// assert!(found.unidentifiable.is_empty() && found.spectrum.determined().iter().all(|&known| known));
/// # Ok::<(), poecal::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// Unknowns in the minimal basis: 4 a revolute joint, 2 a prismatic one, 6 a target frame, 3 a target point.
    pub parameters: usize,
    /// Directions among them that the data determine against the noise.
    pub rank: usize,
    /// How many unknowns the measurements tell beside what is believed of the drawing, `Σ_k λ_k / (λ_k + 1)` with λ_k the information
    /// of measurements over that of the belief: a share of each, without a cliff.
    pub told: f64,
    /// Largest singular value of the scaled Jacobian over the smallest that counts to the rank.
    pub condition: f64,
    /// What these configurations leave open.
    pub unidentifiable: Vec<Direction>,
    /// What they tell, but hardly better than a drawing does.
    pub weak: Vec<Direction>,
    /// What no measurement of this kind could tell: it is a choice, is not among the parameters, and changes no prediction.
    pub structural: Vec<Direction>,
    /// The observability indices of the configurations.
    pub observability: Observability,
    /// The information itself.
    pub spectrum: Spectrum,
}

/// What was measured and what is unknown: all that an analysis looks at.
///
/// An example is [`super::identify`].
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The robot, for its names and kinds.
    pub robot: &'a Robot,
    /// The measurements.
    pub data: &'a Dataset,
    /// Their joint values.
    pub packed: &'a Packed,
    /// The rows that count.
    pub rows: &'a [u32],
    /// The estimate at which the information was taken.
    pub estimate: &'a Estimate,
    /// The unknowns.
    pub layout: &'a Layout,
    /// The noise by which rows are whitened that state none.
    pub noise: Noise,
    /// How many metres a radian counts.
    pub length_m: f64,
    /// Whether the device stands anywhere.
    pub device_free: bool,
}

/// The variance of whitened residuals that a fit leaves, its unknowns taken off: 1 if the noise is what it was taken to be.
#[must_use]
pub fn residual_variance(normal: &Normal) -> f64 {
    let residuals = normal.residuals as f64;
    normal.mean_square() * residuals / (residuals - normal.dim() as f64).max(1.0)
}

/// How many unknowns some of the residuals tell: `tr N⁻¹ N_part`, theory.md §6 (34).
#[must_use]
pub fn unknowns_told(normal: &Normal, part: &Normal) -> f64 {
    let n = normal.dim();
    let largest = (0..n).map(|i| normal.gram[i * n + i]).fold(0.0, f64::max);
    let Some(factor) =
        linalg::cholesky(&normal.gram, n, (ROUNDING * ROUNDING * largest).max(f64::MIN_POSITIVE))
    else {
        return 0.0;
    };
    linalg::trace_of_quotient(&factor, &part.gram, n)
}

/// Judges the information (upper triangle of `N`, row-major) of a setup, with residuals of this variance: theory.md §7 (36).
#[must_use]
pub fn identifiability(setup: &Setup<'_>, gram: &[f64], variance: f64) -> Identifiability {
    let n = setup.layout.dim();
    let spectrum = Spectrum::new(gram, n, variance, setup.length_m);
    let values = &spectrum.values;
    let largest = values.last().copied().unwrap_or(0.0);
    let condition = values.get(spectrum.open).map_or(f64::INFINITY, |&value| (largest / value).sqrt());
    let singular: Vec<f64> = {
        let least = rounding(values);
        values.iter().rev().map(|&value| if value > least { value.sqrt() } else { 0.0 }).collect()
    };
    let excitation = Excitation::new(setup);
    let weak = (spectrum.open..n).take_while(|&k| spectrum.sigma_m(k) > WEAK * setup.length_m).count();
    let unidentifiable = explain(setup, &excitation, &spectrum, Degree::Open);
    let mut hardly = explain(setup, &excitation, &spectrum, Degree::Weak(weak));
    hardly.extend(excitation.seen_once(setup));
    Identifiability {
        parameters: n,
        rank: n - spectrum.open,
        told: (n - spectrum.open) as f64,
        condition,
        unidentifiable,
        weak: hardly,
        structural: structural(setup),
        observability: Observability::new(&singular, setup.rows.len()),
        spectrum,
    }
}

/// The kernel that is known before anything is measured: theory.md §7 (35).
fn structural(setup: &Setup<'_>) -> Vec<Direction> {
    let joints = &setup.robot.joints;
    let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
    let sliding = joints.iter().filter(|joint| joint.kind == JointKind::Prismatic).count();
    let turning = joints.len() - sliding;
    let mut found = Vec::new();
    let mut add = |cause, directions, joints: &[String], description: &str| {
        if directions > 0 {
            let (description, joints) = (description.to_owned(), joints.to_vec());
            found.push(Direction { description, joints, cause, directions });
        }
    };
    let own = match (turning, sliding) {
        (_, 0) => "turning and shifting a joint along its own axis does nothing: left out",
        (0, _) => "shifting a slide, and turning it about its own direction, does nothing: left out",
        _ => {
            "turning and shifting a joint along its own axis does nothing, nor does shifting a slide anywhere: left out"
        }
    };
    add(Cause::OwnAxis, 2 * turning + 4 * sliding, &names, own);
    if setup.device_free {
        let base =
            "base frame: moving it under all axes is the same as moving the device: kept as in the model";
        add(Cause::BaseFrame, 6, &[], base);
    }
    let zeros = "zeros of the joints: what they do, later axes and the tool can do as well: kept as read";
    add(Cause::JointOffsets, joints.len(), &names, zeros);
    let points = setup.layout.parameters().filter(|(it, _)| matches!(it, Parameter::TargetPlace(_))).count();
    let no_orientation = "orientation of the tool: no orientation was measured";
    add(Cause::NoOrientation, 3 * points, &[], no_orientation);
    found
}
