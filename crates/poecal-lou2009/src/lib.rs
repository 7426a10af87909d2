//! Additions to the library for lou2009: its formulations ([`to_formulation`]), its experiment with each of them and the outcome of its claims
//! ([`lou2009`]), and an experiment on the effect of gross errors on a calibration ([`breakdown()`]). It uses public items of the library; the
//! library does not depend on it.
//!
//! For the program's `reproduce`, the package and readers of the paper; its interface is not stable. Not here: a solver other than plain
//! Gauss-Newton, and Jacobians that the solver of the library uses.

mod basin;
mod breakdown;
mod claims;
mod constraints;
mod efficiency;
mod findings;
mod formulation;
mod free_screw;
mod gauss_newton;
pub mod literal;
pub mod report;
mod runs;
mod seeds;
mod session;
mod spatial;
pub mod tables;

pub use breakdown::{Breakdown, BreakdownEntry, breakdown};
pub use findings::{
    Basin, Claim, Efficiency, ElbowRun, Iteration, MatrixSpectrum, MeasurementKind, OffsetRow, PointRow, Reproduction,
    ScrewRow,
};

pub use formulation::{Method, PaperFormulation, PaperResidual, to_formulation};
pub use free_screw::FreeScrew;
pub use gauss_newton::gauss_newton;
pub use spatial::SpatialResidual;

use claims::{ClaimEvidence, claims};
use runs::FinishedRun;

use poecal_arm::lie::Screw;
use poecal_model::measurement::{Noise, Quantity};
use poecal_model::robot::Term;
use poecal_numerics::error::{ErrorKind, Result};

/// Metres per radian in ranks and steps: some third of the elbow's reach.
const LENGTH_M: f64 = 0.5;

/// Noise of a good laser tracker with a six-degree-of-freedom probe.
const NOISE: Noise = Noise::new(5e-5, 1.745_329_251_994_329_6e-4);

/// Extent of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReproductionOptions {
    /// Noisy sessions for each formulation.
    pub trials: usize,
    /// Random starts for each formulation and size of error.
    pub starts: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for ReproductionOptions {
    fn default() -> Self {
        ReproductionOptions { trials: 1000, starts: 100, seed: 1 }
    }
}

/// Repeats the experiment of lou2009: the elbow of its Tables I and II identified from poses and from points with every formulation, with and without
/// joint offsets and noise; its claims; and the comparison of the formulations over many trials.
///
/// # Errors
/// [`ErrorKind::Option`] without a trial or a start; [`ErrorKind::Problem`] if a claim lacks its evidence.
pub fn lou2009(options: &ReproductionOptions) -> Result<Reproduction> {
    if options.trials == 0 || options.starts == 0 {
        return ErrorKind::Option
            .refuse("found no trial or no start to compare formulations by, expected at least 1 of each");
    }
    let ended = runs::runs(options.seed)?;
    let mut found = Reproduction {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: format!(
            "poecal reproduce lou2009 --trials {} --starts {} --seed {} --out DIR",
            options.trials, options.starts, options.seed
        ),
        seed: options.seed,
        noise_position_m: NOISE[Quantity::Position],
        noise_rotation_rad: NOISE[Quantity::Rotation],
        length_m: LENGTH_M,
        runs: ended.iter().map(|ended| ended.run.clone()).collect(),
        claims: Vec::new(),
        screws: screws(&ended),
        point: point(&ended),
        offsets: offsets(&ended),
        spectra: spectra(&ended, options.seed),
        efficiency: efficiency::efficiency(options.trials, options.seed)?,
        basin: basin::basin(options.starts, options.seed)?,
    };
    found.claims = claims(&ClaimEvidence { runs: &ended, found: &found, seed: options.seed })?;
    Ok(found)
}

/// A noise-free run.
fn find_exact_run(
    ended: &[FinishedRun],
    formulation: PaperFormulation,
    seen: MeasurementKind,
    offsets: bool,
) -> Option<&FinishedRun> {
    ended.iter().find(|it| it.run.is_exact(formulation, seen, offsets))
}

fn coordinates(screw: &Screw) -> [f64; 6] {
    screw.twist().to_vector().into()
}

fn screws(ended: &[FinishedRun]) -> Vec<ScrewRow> {
    let (nominal, prescribed) = (tables::nominal_robot(), tables::prescribed_robot());
    let identified = |seen, joint: usize| {
        find_exact_run(ended, PaperFormulation::Adjoint, seen, false)
            .map_or([f64::NAN; 6], |run| coordinates(&run.estimate.screws()[joint]))
    };
    let printed = tables::printed_screws();
    nominal
        .joints
        .iter()
        .zip(&prescribed.joints)
        .zip(printed)
        .enumerate()
        .map(|(k, ((joint, truth), printed))| ScrewRow {
            joint: joint.name.clone(),
            nominal: coordinates(&joint.screw),
            printed: printed.to_vector().into(),
            prescribed: coordinates(&truth.screw),
            from_poses: identified(MeasurementKind::Poses, k),
            from_points: identified(MeasurementKind::Points, k),
        })
        .collect()
}

fn point(ended: &[FinishedRun]) -> PointRow {
    PointRow {
        nominal: tables::nominal_robot().home.translation.into(),
        prescribed: tables::prescribed_robot().home.translation.into(),
        from_points: find_exact_run(ended, PaperFormulation::Adjoint, MeasurementKind::Points, false)
            .map_or([f64::NAN; 3], |run| run.estimate.base_from_target[0].translation.into()),
    }
}

fn offsets(ended: &[FinishedRun]) -> Vec<OffsetRow> {
    let identified = |formulation, joint: usize| {
        find_exact_run(ended, formulation, MeasurementKind::Poses, true)
            .map_or(f64::NAN, |run| run.estimate.coefficient(joint, Term::OFFSET).to_degrees())
    };
    tables::nominal_robot()
        .joints
        .iter()
        .zip(tables::PRESCRIBED_OFFSETS_DEG)
        .enumerate()
        .map(|(k, (joint, prescribed_deg))| OffsetRow {
            joint: joint.name.clone(),
            prescribed_deg,
            screw_offsets_deg: identified(PaperFormulation::ScrewOffsets, k),
            adjoint_offsets_deg: identified(PaperFormulation::AdjointOffsets, k),
        })
        .collect()
}

/// The paper's matrices of all formulations, at the nominal and at the identified robot.
fn spectra(ended: &[FinishedRun], seed: u64) -> Vec<MatrixSpectrum> {
    let mut spectra = Vec::new();
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        let session = runs::session(false, seen, seed);
        for formulation in PaperFormulation::ALL {
            let Some(identified) = find_exact_run(ended, formulation, seen, false) else { continue };
            for (at, estimate) in [("nominal", &session.start()), ("identified", &identified.estimate)] {
                let matrix = runs::matrix(&session, estimate, formulation);
                let (values, rank) = literal::singular_values(&matrix);
                let largest = values.first().copied().unwrap_or(1.0);
                spectra.push(MatrixSpectrum {
                    matrix: format!("{}, {}", formulation.word(), seen.word()),
                    at: at.to_owned(),
                    columns: matrix.ncols(),
                    rank,
                    singular_values: values.iter().map(|value| value / largest).collect(),
                });
            }
        }
    }
    spectra
}
