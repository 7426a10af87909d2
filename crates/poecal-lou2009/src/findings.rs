//! Results of a reproduction of lou2009: every number of its reports and plots.

use crate::{Method, PaperFormulation, PaperResidual};
use serde::Serialize;

/// Kind of a run's measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasurementKind {
    /// Position and orientation of the tool frame (lou2009, first simulation).
    Poses,
    /// Position of one tool point (second simulation).
    Points,
}

impl MeasurementKind {
    /// The word used in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            MeasurementKind::Poses => "poses",
            MeasurementKind::Points => "points",
        }
    }
}

/// One calibration of the elbow from its nominal screws by plain Gauss-Newton, as in the paper.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElbowRun {
    /// Parameterisation of errors.
    pub formulation: PaperFormulation,
    /// Kind of the measurements.
    pub measurement: MeasurementKind,
    /// True if the true robot has joint offsets beside its screw errors.
    pub offsets_in_truth: bool,
    /// True if the measurements are noisy.
    pub noise: bool,
    /// Number of measurements fitted.
    pub measurements: usize,
    /// Iterations until the step or the residual was only rounding (noise-free), or the step promised no gain beyond the noise. The paper states no
    /// rule.
    pub iterations: usize,
    /// True if it ended there, at the truth (noise-free: held-out error below 1 nm).
    pub converged: bool,
    /// Columns of the paper's own matrix for this formulation.
    pub parameters: usize,
    /// Its rank at the identified robot.
    pub rank: usize,
    /// Unknowns of the solver: the minimal basis, for the adjoint formulations.
    pub unknowns: usize,
    /// RMS distance from prediction to truth on configurations that were not measured, metres.
    pub held_out_rms_m: f64,
    /// Largest difference of a screw's coordinate from the prescribed one (metres for v, 1 for ω). It is no error of prediction, and is large if the
    /// formulation does not separate screws from offsets.
    pub screw_error_max: f64,
    /// Its part of v, metres.
    pub screw_error_max_v_m: f64,
    /// Its part of ω, no unit.
    pub screw_error_max_omega: f64,
    /// As [`screw_error_max`](Self::screw_error_max), with all offsets moved into the screws (lou2009 14 and 15), in the truth and in the identified
    /// robot: the determined part.
    pub equivalent_screw_error_max: f64,
    /// Its part of v, metres.
    pub equivalent_screw_error_max_v_m: f64,
    /// Its part of ω, no unit.
    pub equivalent_screw_error_max_omega: f64,
    /// Largest `|v·ω|` over the iterations, metres: of `ξ + dξ` before it is normalised (free screws), or of the screws that `ξ ← Ad(e^η) ξ` makes
    /// from the nominal ones without any normalisation (adjoint).
    pub constraint_miss_pitch_m: f64,
    /// Largest `||ω| - 1|` of the same.
    pub constraint_miss_length: f64,
    /// Largest difference of an identified joint offset from the prescribed one, degrees; null without offsets in the formulation.
    pub offset_error_max_deg: Option<f64>,
    /// States by iteration, the start first.
    pub trace: Vec<Iteration>,
}

impl ElbowRun {
    /// True if it is the run without noise of a formulation.
    pub(crate) fn is_exact(&self, formulation: PaperFormulation, seen: MeasurementKind, offsets: bool) -> bool {
        (self.formulation, self.measurement, self.offsets_in_truth, self.noise) == (formulation, seen, offsets, false)
    }
}

/// The state of a run after an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Iteration {
    /// RMS distance from prediction to measurement, metres.
    pub residual_rms_m: f64,
    /// As [`ElbowRun::screw_error_max`].
    pub screw_error_max: f64,
}

/// A joint's screw compared with Table II: `(v; ω)` in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScrewRow {
    /// Joint name.
    pub joint: String,
    /// Table II, left.
    pub nominal: [f64; 6],
    /// Table II, right, as printed.
    pub printed: [f64; 6],
    /// Table II, right, projected to a screw: the prescribed truth.
    pub prescribed: [f64; 6],
    /// Identified from poses, noise-free.
    pub from_poses: [f64; 6],
    /// Identified from points, noise-free.
    pub from_points: [f64; 6],
}

/// The point `P_c0` compared with Table II, metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointRow {
    /// Table II, left.
    pub nominal: [f64; 3],
    /// Table II, right: the prescribed truth.
    pub prescribed: [f64; 3],
    /// Identified from points, noise-free.
    pub from_points: [f64; 3],
}

/// A joint offset: prescribed, and as two formulations identified it (noise-free).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OffsetRow {
    /// Joint name.
    pub joint: String,
    /// Prescribed, degrees.
    pub prescribed_deg: f64,
    /// By `screw-offsets` from poses, degrees.
    pub screw_offsets_deg: f64,
    /// By `adjoint-offsets` from poses, degrees.
    pub adjoint_offsets_deg: f64,
}

/// Singular values of one of the paper's matrices, radians counted by [`Reproduction::length_m`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MatrixSpectrum {
    /// Name of the matrix.
    pub matrix: String,
    /// Robot of its evaluation: `nominal` or `identified`.
    pub at: String,
    /// Number of its columns.
    pub columns: usize,
    /// Singular values above 1e-9 of the largest.
    pub rank: usize,
    /// All of them, the largest first, as shares of the largest.
    pub singular_values: Vec<f64>,
}

/// Many noisy fits of one formulation against the Cramér-Rao bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Efficiency {
    /// Parameterisation of errors.
    pub formulation: PaperFormulation,
    /// Kind of the measurements.
    pub measurement: MeasurementKind,
    /// `tool` (at the tool, whitened) or `spatial` (the paper's logarithm, whitened alike); points have `tool` only.
    pub residual: String,
    /// `gauss-newton` or `levenberg-marquardt`.
    pub method: String,
    /// Number of fits.
    pub trials: usize,
    /// Fits that ended at an optimum.
    pub converged: usize,
    /// RMS held-out position error of those, metres; NaN if there are none.
    pub held_out_rms_m: f64,
    /// RMS that the Cramér-Rao bound allows, metres.
    pub bound_rms_m: f64,
    /// Ratio of the two: 1 is the best that any unbiased estimator can do.
    pub ratio: f64,
    /// Random standard deviation of the ratio, from the scatter of the fits, but at least `ratio / √(2 · unknowns · fits)`.
    pub ratio_sigma: f64,
}

/// Standard deviations beyond which a difference is not chance.
const BEYOND_CHANCE: f64 = 3.0;

impl Efficiency {
    /// True if this ratio is larger than another by more than chance explains: three standard deviations.
    #[must_use]
    pub fn exceeds(&self, other: &Efficiency) -> bool {
        self.ratio - other.ratio > BEYOND_CHANCE * self.ratio_sigma.hypot(other.ratio_sigma)
    }

    /// The ratio with its standard deviation, in words.
    pub(crate) fn ratio_words(&self) -> String {
        format!("{:.3} ± {:.3}", self.ratio, self.ratio_sigma)
    }
}

/// The share of random starts from which a formulation reaches the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Basin {
    /// Parameterisation of errors.
    pub formulation: PaperFormulation,
    /// Kind of the measurements.
    pub measurement: MeasurementKind,
    /// `tool` or `spatial`, as in [`Efficiency`].
    pub residual: String,
    /// `gauss-newton` or `levenberg-marquardt`.
    pub method: String,
    /// Angle between the nominal start and the truth for each axis and the tip, degrees.
    pub error_deg: f64,
    /// Distance between them, millimetres.
    pub error_mm: f64,
    /// Number of starts.
    pub trials: usize,
    /// Share that reached the truth (held-out error below 1 µm, noise-free).
    pub share: f64,
}

impl Basin {
    /// True if this share is larger than another by more than chance explains: three standard deviations.
    #[must_use]
    pub fn exceeds(&self, other: &Basin) -> bool {
        // The uncertainty of a share of 0 or 1 is about one start.
        let sigma = |it: &Basin| {
            let starts = it.trials as f64;
            (it.share * (1.0 - it.share) / starts).sqrt().max(1.0 / starts)
        };
        self.share - other.share > BEYOND_CHANCE * sigma(self).hypot(sigma(other))
    }
}

/// A statement of the paper, or a finding that it leaves out, compared with measurements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The statement.
    pub claim: String,
    /// Text of the paper, with its location; for a finding, the nearest text.
    pub paper: String,
    /// Evidence of the runs, with the numbers.
    pub measured: String,
    /// Condition under which the statement holds.
    pub criterion: String,
    /// True if the condition is met.
    pub holds: bool,
    /// True if the paper makes the statement; otherwise it is a finding that the paper leaves out.
    pub said_by_paper: bool,
}

/// All findings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reproduction {
    /// Version of the program.
    pub version: String,
    /// Command that writes the same files.
    pub command: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Standard deviation of each position component in runs with noise, metres.
    pub noise_position_m: f64,
    /// Standard deviation of each rotation component in runs with noise, radians.
    pub noise_rotation_rad: f64,
    /// Metres per radian in ranks.
    pub length_m: f64,
    /// The calibrations.
    pub runs: Vec<ElbowRun>,
    /// Claim by claim.
    pub claims: Vec<Claim>,
    /// The screws compared with Table II.
    pub screws: Vec<ScrewRow>,
    /// The point compared with Table II.
    pub point: PointRow,
    /// Offsets, prescribed and identified.
    pub offsets: Vec<OffsetRow>,
    /// Ranks.
    pub spectra: Vec<MatrixSpectrum>,
    /// Accuracy with noise.
    pub efficiency: Vec<Efficiency>,
    /// Convergence from distant starts.
    pub basin: Vec<Basin>,
}

impl Reproduction {
    /// The run of a formulation without noise.
    pub(crate) fn exact_run(
        &self,
        formulation: PaperFormulation,
        seen: MeasurementKind,
        offsets: bool,
    ) -> Option<&ElbowRun> {
        self.runs.iter().find(|run| run.is_exact(formulation, seen, offsets))
    }

    /// Number of statements that hold, and their total number: of the paper's, or of the findings that it leaves out.
    #[must_use]
    pub fn count_holding(&self, said_by_paper: bool) -> (usize, usize) {
        let claims = || self.claims.iter().filter(|claim| claim.said_by_paper == said_by_paper);
        (claims().filter(|claim| claim.holds).count(), claims().count())
    }

    /// The fits of a formulation with noise by plain Gauss-Newton.
    pub(crate) fn noisy_fits(
        &self,
        formulation: PaperFormulation,
        seen: MeasurementKind,
        residual: PaperResidual,
    ) -> Option<&Efficiency> {
        self.efficiency.iter().find(|it| {
            (it.formulation, it.measurement, it.residual.as_str(), it.method.as_str())
                == (formulation, seen, residual.word(), Method::GaussNewton.word())
        })
    }

    /// The distant starts of a formulation, the nearest first.
    pub(crate) fn basins(
        &self,
        formulation: PaperFormulation,
        seen: MeasurementKind,
        method: Method,
    ) -> impl Iterator<Item = &Basin> {
        self.basin.iter().filter(move |it| {
            (it.formulation, it.measurement, it.method.as_str()) == (formulation, seen, method.word())
        })
    }
}
