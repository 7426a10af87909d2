//! Requirements on the reproduction of lou2009, and its determinism.

use poecal_lou2009::{ElbowRun, MeasurementKind, PaperFormulation, Reproduction, ReproductionOptions, lou2009};
use poecal_testing::largest::larger_or_nan;

const FEW: ReproductionOptions = ReproductionOptions { trials: 60, starts: 20, seed: 1 };

fn find_exact_run(
    found: &Reproduction,
    formulation: PaperFormulation,
    seen: MeasurementKind,
    offsets: bool,
) -> &ElbowRun {
    found
        .runs
        .iter()
        .find(|run| {
            (run.formulation, run.measurement, run.offsets_in_truth, run.noise) == (formulation, seen, offsets, false)
        })
        .unwrap()
}

#[test]
fn figures_of_the_paper() {
    let found = lou2009(&FEW).unwrap();
    for run in found.runs.iter().filter(|run| !run.noise) {
        println!(
            "{:15} {:6} offsets {:5}: {} iterations, rank {} of {}, held out {:.1e} m, screws {:.1e}, equivalent {:.1e}, offsets {:.2?} deg",
            run.formulation.word(),
            run.measurement.word(),
            run.offsets_in_truth,
            run.iterations,
            run.rank,
            run.parameters,
            run.held_out_rms_m,
            run.screw_error_max,
            run.equivalent_screw_error_max,
            run.offset_error_max_deg
        );
        assert!(run.converged && run.held_out_rms_m < 1e-9 && run.equivalent_screw_error_max < 1e-9);
    }
    let poses = find_exact_run(&found, PaperFormulation::Adjoint, MeasurementKind::Poses, false);
    let points = find_exact_run(&found, PaperFormulation::Adjoint, MeasurementKind::Points, false);
    assert!(poses.iterations <= 5 && points.iterations <= 7);
    assert!(poses.screw_error_max < 1e-9 && points.screw_error_max < 1e-9);
    assert_eq!((poses.rank, poses.parameters), (30, 42));
    assert_eq!((points.rank, points.parameters), (27, 39));
    let original = find_exact_run(&found, PaperFormulation::ScrewOffsets, MeasurementKind::Poses, true);
    assert_eq!((original.rank, original.parameters), (42, 48));
    assert!(original.offset_error_max_deg.unwrap() > 1.0);
    let worst = (0..3).map(|k| (found.point.from_points[k] - found.point.prescribed[k]).abs());
    assert!(worst.fold(0.0, larger_or_nan) < 1e-9);
    for row in &found.screws {
        for k in 0..6 {
            assert!((row.from_poses[k] - row.prescribed[k]).abs() < 1e-9);
            assert!((row.from_points[k] - row.prescribed[k]).abs() < 1e-9);
        }
    }
}

#[test]
fn adjoint_form_is_efficient_and_the_original_is_not() {
    let found = lou2009(&FEW).unwrap();
    let ratio = |formulation: PaperFormulation, seen: MeasurementKind, residual: &str| {
        let of = found.efficiency.iter().find(|it| {
            it.formulation == formulation
                && it.measurement == seen
                && it.residual == residual
                && it.method == "gauss-newton"
        });
        of.unwrap().ratio
    };
    for it in &found.efficiency {
        println!(
            "{:15} {:6} {:7} {:19} {:.3} of the bound, {} of {}",
            it.formulation.word(),
            it.measurement.word(),
            it.residual,
            it.method,
            it.ratio,
            it.converged,
            it.trials
        );
    }
    for seen in [MeasurementKind::Poses, MeasurementKind::Points] {
        // Chance: 30 unknowns in 60 trials, a relative standard deviation of the RMS of 1 / √(2 · 30 · 60) = 1.7 %, times three.
        assert!((ratio(PaperFormulation::Adjoint, seen, "tool") - 1.0).abs() < 0.05);
        assert!(ratio(PaperFormulation::Screw, seen, "tool") > 1.1);
    }
    assert!(ratio(PaperFormulation::Adjoint, MeasurementKind::Poses, "spatial") > 1.5);
}

#[test]
fn claims_hold_or_do_not_as_they_should() {
    let found = lou2009(&FEW).unwrap();
    for claim in &found.claims {
        println!("[{}] {} | {} | {}", claim.holds, claim.claim, claim.criterion, claim.measured);
        assert!(!claim.measured.contains("NaN") && !claim.measured.contains("inf"));
        assert!(!claim.criterion.is_empty() && !claim.paper.is_empty());
    }
    let list = |said_by_paper: bool| -> Vec<(&str, bool)> {
        let of = found.claims.iter().filter(|claim| claim.said_by_paper == said_by_paper);
        of.map(|claim| (claim.claim.as_str(), claim.holds)).collect()
    };
    assert_eq!(
        list(true),
        [
            ("The original formulation works where there are no joint offsets.", true),
            ("With joint offsets, the original formulation does not return the prescribed errors.", true),
            ("With joint offsets, the original calibration fails.", false),
            ("A robot with joint offsets equals one without whose screws and home pose are moved.", true),
            ("Joint offsets are not identifiable beside the screws.", true),
            ("Joint offsets need not be considered at all.", true),
            ("The adjoint error eliminates the screw constraints.", true),
            ("Normalising screws after each iteration is plausible but not rigorous.", true),
            ("From poses, the parameters are identified within 6 iterations.", true),
            ("From points, the parameters are identified within 10 iterations.", true),
            ("Points take nearly twice as many iterations as poses.", false),
            ("The screws and the point of Table II are recovered.", true),
            ("Iterated least squares converges robustly.", true),
        ]
    );
    assert_eq!(
        list(false),
        [
            ("The components of η are redundant.", true),
            ("The nominal point lies on axis 6, so the first Jacobian has rank 25.", true),
            ("The spatial logarithm costs accuracy.", true),
            ("Table II's screws, as printed, are not quite screws.", true),
        ]
    );
}

/// The numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    let word = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).parse().ok();
    text.split([' ', ':']).filter_map(word).collect()
}

#[test]
fn claims_tell_the_numbers_of_the_runs() {
    let found = lou2009(&FEW).unwrap();
    let told = |start: &str| -> Vec<f64> {
        let claim = found.claims.iter().find(|claim| claim.claim.starts_with(start)).unwrap();
        println!("{}", claim.measured);
        numbers(&claim.measured)
    };
    // As many digits as in the text.
    let has = |told: &[f64], value: f64, digits: f64| {
        let near = |number: &f64| (number - value).abs() <= 0.51 * digits;
        assert!(told.iter().any(near), "{value} is not in {told:?}");
    };
    let original = find_exact_run(&found, PaperFormulation::ScrewOffsets, MeasurementKind::Poses, true);
    let numbers = told("With joint offsets, the original formulation");
    has(&numbers, original.offset_error_max_deg.unwrap(), 0.01);
    has(&numbers, 1e3 * original.screw_error_max_v_m, 0.1);
    has(&numbers, original.screw_error_max_omega, 1e-4);
    let adjoint = find_exact_run(&found, PaperFormulation::Adjoint, MeasurementKind::Poses, true);
    let numbers = told("Joint offsets need not");
    has(&numbers, 1e3 * adjoint.screw_error_max_v_m, 0.1);
    has(&numbers, adjoint.screw_error_max_omega, 1e-4);
    let free = found.runs.iter().filter(|run| run.formulation.has_free_screws());
    let (pitch, length) = free.fold((0.0_f64, 0.0_f64), |(pitch, length), run| {
        (pitch.max(run.constraint_miss_pitch_m), length.max(run.constraint_miss_length))
    });
    // Free screws violate their constraints by the part that the paper normalises away; a claim that cannot fail would not show it.
    assert!(pitch > 1e-4 && length > 1e-4, "{pitch} {length}");
    let numbers = told("The adjoint error eliminates");
    has(&numbers, 1e3 * pitch, 0.01);
    has(&numbers, length, 1e-4);
    let numbers = told("Joint offsets are not identifiable");
    assert_eq!(numbers[1..3], [original.rank as f64, original.parameters as f64], "{numbers:?}");
}

#[test]
fn lengths_and_directions_are_told_apart() {
    // Estimates of the tables, with joint offsets neither in the truth nor in the formulation.
    let found = lou2009(&FEW).unwrap();
    for (seen, of) in [
        (MeasurementKind::Poses, (|row| &row.from_poses) as fn(&poecal_lou2009::ScrewRow) -> &[f64; 6]),
        (MeasurementKind::Points, |row| &row.from_points),
    ] {
        let run = find_exact_run(&found, PaperFormulation::Adjoint, seen, false);
        let largest = |part: std::ops::Range<usize>| {
            let rows = found.screws.iter();
            rows.flat_map(|row| part.clone().map(|k| (of(row)[k] - row.prescribed[k]).abs())).fold(0.0, larger_or_nan)
        };
        // The run takes the true screws from their frames, the table as they are: rounding of a number of up to 1 m.
        assert!((run.screw_error_max_v_m - largest(0..3)).abs() < 1e-15);
        assert!((run.screw_error_max_omega - largest(3..6)).abs() < 1e-15);
    }
    // With offsets in the truth, the adjoint form ends at the equivalent robot, which equations (14) and (15) determine without any fit.
    let prescribed = poecal_lou2009::tables::prescribed_robot();
    let offsets = poecal_lou2009::tables::PRESCRIBED_OFFSETS_DEG.map(f64::to_radians);
    let equivalent = poecal_model::offsets::into_screws(&prescribed, &offsets).unwrap();
    let pairs = || prescribed.joints.iter().zip(&equivalent.joints);
    let v = pairs().map(|(a, b)| (a.screw.v() - b.screw.v()).amax()).fold(0.0, larger_or_nan);
    let omega = pairs().map(|(a, b)| (a.screw.w() - b.screw.w()).amax()).fold(0.0, larger_or_nan);
    println!("equivalent robot: v off by {:.2} mm, ω by {omega:.4}", 1e3 * v);
    assert!((v - 0.0775).abs() < 1e-4 && (omega - 0.1687).abs() < 1e-4);
    for run in found
        .runs
        .iter()
        .filter(|run| run.formulation == PaperFormulation::Adjoint && run.offsets_in_truth && !run.noise)
    {
        assert!((run.screw_error_max_v_m - v).abs() < 1e-12 && (run.screw_error_max_omega - omega).abs() < 1e-12);
        assert_eq!(run.screw_error_max, run.screw_error_max_v_m.max(run.screw_error_max_omega));
    }
}

#[test]
fn too_few_trials_tell_nothing() {
    let found = lou2009(&ReproductionOptions { trials: 1, starts: 4, seed: 5 }).unwrap();
    let files = poecal_lou2009::report::reproduction_files(&found).unwrap();
    let (_, text) = files.iter().find(|(name, _)| name == "report.md").unwrap();
    assert!(text.contains("there are too few trials to decide"));
    let claim = found.claims.iter().find(|claim| claim.claim.starts_with("Normalising")).unwrap();
    assert!(!claim.holds && claim.measured.contains("do not show"), "{}", claim.measured);
}

#[test]
fn another_seed_changes_everything_random() {
    let few = |seed| lou2009(&ReproductionOptions { trials: 2, starts: 1, seed }).unwrap();
    let (a, b) = (few(1), few(2));
    for (a, b) in a.runs.iter().zip(&b.runs) {
        assert_ne!(a.trace[0].residual_rms_m, b.trace[0].residual_rms_m);
    }
    for (a, b) in a.efficiency.iter().zip(&b.efficiency) {
        assert!(a.held_out_rms_m != b.held_out_rms_m && a.bound_rms_m != b.bound_rms_m);
    }
}

#[test]
fn reproduction_is_the_same_every_time_and_whatever_the_threads() {
    let once = lou2009(&FEW).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let again = pool.install(|| lou2009(&FEW)).unwrap();
    assert_eq!(format!("{once:?}"), format!("{again:?}"));
}
