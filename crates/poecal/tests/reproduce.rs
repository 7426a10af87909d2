//! What the reproduction of lou2009 must show, and that it shows the same every time.

#![allow(clippy::unwrap_used)]

use poecal::parameters::Formulation;
use poecal::reproduce::{Options, Reproduction, Run, Seen, lou2009};

const FEW: Options = Options { trials: 60, starts: 20, seed: 1 };

fn exact(found: &Reproduction, formulation: Formulation, seen: Seen, offsets: bool) -> &Run {
    found
        .runs
        .iter()
        .find(|run| {
            (run.formulation, run.measurement, run.offsets_in_truth, run.noise)
                == (formulation, seen, offsets, false)
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
    let poses = exact(&found, Formulation::Adjoint, Seen::Poses, false);
    let points = exact(&found, Formulation::Adjoint, Seen::Points, false);
    assert!(poses.iterations <= 5 && points.iterations <= 7);
    assert!(poses.screw_error_max < 1e-9 && points.screw_error_max < 1e-9);
    assert_eq!((poses.rank, poses.parameters), (30, 42));
    assert_eq!((points.rank, points.parameters), (27, 39));
    let original = exact(&found, Formulation::ScrewOffsets, Seen::Poses, true);
    assert_eq!((original.rank, original.parameters), (42, 48));
    assert!(original.offset_error_max_deg.unwrap() > 1.0);
    let worst = (0..3).map(|k| (found.point.from_points[k] - found.point.prescribed[k]).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-9);
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
    let ratio = |formulation: Formulation, seen: Seen, residual: &str| {
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
    for seen in [Seen::Poses, Seen::Points] {
        // Chance: 30 unknowns in 60 trials, a relative standard deviation of the RMS of 1 / √(2 · 30 · 60) = 1.7 %, times three.
        assert!((ratio(Formulation::Adjoint, seen, "tool") - 1.0).abs() < 0.05);
        assert!(ratio(Formulation::Screw, seen, "tool") > 1.1);
    }
    assert!(ratio(Formulation::Adjoint, Seen::Poses, "spatial") > 1.5);
}

#[test]
fn claims_say_what_was_measured() {
    let found = lou2009(&FEW).unwrap();
    for claim in &found.claims {
        println!("[{}] {} | {}", if claim.holds { "holds" } else { "fails" }, claim.claim, claim.measured);
        assert!(!claim.measured.contains("NaN") && !claim.measured.contains("inf"));
    }
    assert_eq!(found.claims.len(), 16);
    let holding = found.claims.iter().filter(|claim| claim.holds).count();
    assert_eq!(holding, 10);
}

#[test]
fn reproduction_is_the_same_every_time_and_whatever_the_threads() {
    let once = lou2009(&FEW).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let again = pool.install(|| lou2009(&FEW)).unwrap();
    assert_eq!(format!("{once:?}"), format!("{again:?}"));
}
