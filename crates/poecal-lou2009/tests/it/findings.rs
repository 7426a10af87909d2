//! Made-up findings of a reproduction: of the right shape, with numbers from formulas. They are not measured.

use poecal_lou2009::{
    Basin, Claim, Efficiency, ElbowRun, Iteration, MatrixSpectrum, MeasurementKind, OffsetRow, PaperFormulation,
    PointRow, Reproduction, ScrewRow,
};

const SEEN: [MeasurementKind; 2] = [MeasurementKind::Poses, MeasurementKind::Points];

/// Findings with entries of every kind.
pub(crate) fn findings() -> Reproduction {
    Reproduction {
        version: "0.0.0".to_owned(),
        command: "poecal reproduce lou2009 --out \"made & up\"".to_owned(),
        seed: 7,
        noise_position_m: 5e-5,
        noise_rotation_rad: 1e-4,
        length_m: 0.5,
        runs: runs(),
        claims: claims(),
        screws: (1..=6).map(screw).collect(),
        point: PointRow {
            nominal: [0.9, 0.0, 0.72],
            prescribed: [0.9021, -0.0013, 0.7217],
            from_points: [0.9021 + 1e-12, -0.0013, 0.7217 - 3e-13],
        },
        offsets: (1..=6).map(offset).collect(),
        spectra: spectra(),
        efficiency: efficiency(),
        basin: basin(),
    }
}

fn runs() -> Vec<ElbowRun> {
    let mut runs = Vec::new();
    for (k, formulation) in PaperFormulation::ALL.into_iter().enumerate() {
        for measurement in SEEN {
            for (offsets_in_truth, noise) in [(false, false), (true, false), (false, true), (true, true)] {
                let iterations = 4 + k + usize::from(measurement == MeasurementKind::Points);
                let found = |j: usize| 3e-2 * 10_f64.powi(-(1_i32 << j.min(5))) / (1.0 + k as f64);
                let floor = if noise { 9e-5 } else { 2e-16 * (1.0 + k as f64) };
                let stuck = if offsets_in_truth { 0.06 } else { floor };
                let trace = (0..=iterations).map(|j| Iteration {
                    residual_rms_m: (if j == 0 { 0.03 } else { found(j) }).max(floor),
                    screw_error_max: (if j == 0 { 0.08 } else { found(j) }).max(stuck),
                });
                runs.push(ElbowRun {
                    formulation,
                    measurement,
                    offsets_in_truth,
                    noise,
                    measurements: 20,
                    iterations,
                    converged: k != 2 || measurement == MeasurementKind::Poses,
                    parameters: [42, 42, 48, 48][k],
                    rank: [30, 42, 42, 42][k],
                    unknowns: [30, 42, 48, 48][k],
                    held_out_rms_m: floor,
                    screw_error_max: stuck,
                    screw_error_max_v_m: stuck,
                    screw_error_max_omega: 0.5 * stuck,
                    equivalent_screw_error_max: floor,
                    equivalent_screw_error_max_v_m: floor,
                    equivalent_screw_error_max_omega: 0.5 * floor,
                    constraint_miss_pitch_m: if formulation.has_free_screws() { 3e-3 } else { 2e-17 },
                    constraint_miss_length: if formulation.has_free_screws() { 4e-3 } else { 2e-16 },
                    offset_error_max_deg: formulation.has_offsets().then_some(3.25 + k as f64),
                    trace: trace.collect(),
                });
            }
        }
    }
    runs
}

fn claims() -> Vec<Claim> {
    let claim = |claim: &str, paper: &str, measured: &str, holds| Claim {
        claim: claim.to_owned(),
        paper: paper.to_owned(),
        measured: measured.to_owned(),
        criterion: format!("It is as measured: {holds}."),
        holds,
        said_by_paper: claim != "The components of η are redundant.",
    };
    vec![
        claim(
            "The improved formulation converges fast.",
            "section IV: 6 iterations from poses",
            "4 iterations to 2.0e-13 mm from 20 poses",
            true,
        ),
        claim(
            "The modified formulation converges.",
            "section IV: 10 iterations from points",
            "5 iterations to 1.0e-12 mm",
            true,
        ),
        claim(
            "Joint offsets make the calibration fail.",
            "section IV, with joint offsets in the truth",
            "The prediction is right to 4.5e-13 mm; it is the offsets that are not identifiable: they are off by 6.25 deg",
            false,
        ),
        claim("Offsets add no rank (Proposition 1).", "rank 42 of 48 columns", "rank 42 of 48, gap of 1.3e11", true),
        claim("The components of η are redundant.", "nothing is said", "rank 30 of 42", true),
        claim("Text | with <markup> & \"quotes\" stays *text*.", "nowhere", "as it is", true),
    ]
}

fn screw(joint: usize) -> ScrewRow {
    let k = joint as f64;
    let axis = joint % 3;
    let mut nominal = [0.1 * k, -0.05 * k, 0.72 - 0.1 * k, 0.0, 0.0, 0.0];
    nominal[3 + axis] = 1.0;
    let moved = |screw: [f64; 6], size: f64| {
        let mut moved = screw;
        for (j, value) in moved.iter_mut().enumerate() {
            *value += size * ((7 * joint + 3 * j) as f64).sin();
        }
        moved
    };
    let prescribed = moved(nominal, 0.02);
    ScrewRow {
        joint: format!("joint{joint}"),
        nominal,
        printed: prescribed.map(|value| (1e4 * value).round() / 1e4),
        prescribed,
        from_poses: moved(prescribed, 3e-13),
        // One coordinate is met exactly: a logarithmic axis cannot show it.
        from_points: if joint == 4 { prescribed } else { moved(prescribed, 4e-12) },
    }
}

fn offset(joint: usize) -> OffsetRow {
    let k = joint as f64;
    OffsetRow {
        joint: format!("joint{joint}"),
        prescribed_deg: 0.5 * k * (-1_f64).powi(joint as i32),
        screw_offsets_deg: 4.0 * (k * k).sin(),
        adjoint_offsets_deg: 2.5 * (2.0 * k).cos(),
    }
}

fn spectra() -> Vec<MatrixSpectrum> {
    let cases = [
        ("screw-offsets, poses", "identified", 48, 42),
        ("adjoint-offsets, poses", "identified", 48, 30),
        ("adjoint, poses", "identified", 42, 30),
        ("adjoint, points", "identified", 39, 27),
        ("adjoint, points", "nominal", 39, 25),
        ("adjoint, minimal basis, points", "identified", 27, 27),
    ];
    let spectrum = |(matrix, at, columns, rank): (&str, &str, usize, usize)| MatrixSpectrum {
        matrix: matrix.to_owned(),
        at: at.to_owned(),
        columns,
        rank,
        singular_values: (0..columns)
            .map(|k| match k {
                k if k < rank => 10_f64.powf(-2.7 * k as f64 / rank as f64),
                k if k + 1 == columns => 0.0,
                k => 10_f64.powf(-15.3 - 0.1 * k as f64),
            })
            .collect(),
    };
    cases.into_iter().map(spectrum).collect()
}

fn efficiency() -> Vec<Efficiency> {
    let mut rows = Vec::new();
    for (k, formulation) in PaperFormulation::ALL.into_iter().enumerate() {
        for measurement in SEEN {
            for (residual, method) in
                [("tool", "gauss-newton"), ("spatial", "gauss-newton"), ("tool", "levenberg-marquardt")]
            {
                let ratio = 1.0 + 0.013 * k as f64 + if residual == "spatial" { 0.6 } else { 0.002 };
                rows.push(Efficiency {
                    formulation,
                    measurement,
                    residual: residual.to_owned(),
                    method: method.to_owned(),
                    trials: 1000,
                    converged: 1000 - 13 * k,
                    held_out_rms_m: 6.1e-5 * ratio,
                    bound_rms_m: 6.1e-5,
                    ratio,
                    ratio_sigma: 0.004,
                });
            }
        }
    }
    rows
}

fn basin() -> Vec<Basin> {
    let mut rows = Vec::new();
    for (k, formulation) in PaperFormulation::ALL.into_iter().enumerate() {
        for measurement in SEEN {
            for (method, extra) in [("gauss-newton", 0.0), ("levenberg-marquardt", 0.3)] {
                for error_deg in [1.0, 5.0, 10.0, 20.0] {
                    let lost: f64 = (0.0025 * error_deg * error_deg * (1.0 + 0.3 * k as f64) - extra).max(0.0);
                    rows.push(Basin {
                        formulation,
                        measurement,
                        residual: if extra > 0.0 { "tool" } else { "spatial" }.to_owned(),
                        method: method.to_owned(),
                        error_deg,
                        error_mm: 2.0 * error_deg,
                        trials: 100,
                        share: (1.0 - lost).max(0.0),
                    });
                }
            }
        }
    }
    rows
}
