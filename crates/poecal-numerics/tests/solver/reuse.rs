//! Reuse of `JᵀJ` changes the cost of a minimisation, and not its result.

use crate::plain::{Evaluation, Plain, to_the_last_digits};
use crate::{more_set, nist};
use poecal_numerics::solve::{LeastSquares, NormalEquations, Options, WarmStart, minimize, minimize_warm};

/// Both results are where rounding of the gradient hides the optimum: some 1e-11 of each unknown in these problems, of condition numbers
/// up to 1e4.
const SAME: f64 = 1e-8;

/// Largest difference of two solutions, as a share of each unknown.
fn relative_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / a.abs().max(1e-6)).fold(0.0, f64::max)
}

fn compare(name: &str, start: &[f64], function: impl Fn(&[f64]) -> Evaluation) {
    let with = crate::plain::solve(start.len(), start, &function, true);
    let without = crate::plain::solve(start.len(), start, &function, false);
    let apart = relative_difference(&with.x, &without.x);
    println!(
        "{name:<30} with reuse {} JᵀJ in {} evaluations, without {} in {}, apart by {apart:.1e}",
        with.products, with.evaluations, without.products, without.evaluations
    );
    assert!(apart < SAME, "{name}: {:?}, {:?}", with.x, without.x);
}

#[test]
fn ends_are_the_same_with_reuse_and_without() {
    for regression in nist::all() {
        compare(regression.name, &regression.starts[1], |b| regression.residuals(b));
    }
    // The problems have full rank at their minimum, and no other minimum nearby.
    let some = ["1 ", "5 ", "7 ", "8 ", "9 ", "14 ", "15 ", "16 ", "17 ", "19 ", "21 ", "25 ", "30 ", "31 ", "32 "];
    for problem in more_set::all().filter(|problem| some.iter().any(|start| problem.name.starts_with(start))) {
        compare(problem.name, &problem.start, problem.function);
    }
}

/// Close to the optimum most steps need no `JᵀJ` of their own.
#[test]
fn reuse_spares_products() {
    let (mut with, mut without) = (0, 0);
    for regression in nist::all() {
        with += regression.solve(&regression.starts[1], true).products;
        without += regression.solve(&regression.starts[1], false).products;
    }
    println!("JᵀJ built {with} times with reuse, {without} times without");
    assert!(with < without);
}

/// The tolerances are the defaults; the fit goes from a known optimum to that of other data.
#[test]
fn a_warm_start_ends_where_a_minimisation_does() {
    let times: Vec<f64> = (0..20).map(f64::from).collect();
    let curve = |shift: f64| {
        let times = times.clone();
        move |x: &[f64]| -> Evaluation {
            let f = times.iter().map(|t| {
                let measured = 3.0 * (-0.2 * t).exp() + 0.01 * (7.0 * t + shift).sin();
                x[0] * (-x[1] * t).exp() - measured
            });
            let jacobian = times.iter().flat_map(|t| [(-x[1] * t).exp(), -t * x[0] * (-x[1] * t).exp()]);
            (f.collect(), jacobian.collect())
        }
    };
    let first = Plain::new(2, curve(0.0));
    let (optimum, _, _) = minimize(&first, vec![2.0, 0.1], &Options::default());
    let normal: NormalEquations = first.normal(&optimum);
    let warm = WarmStart::new(optimum, normal);
    for reuse in [true, false] {
        let other = Plain::new(2, curve(1.0));
        let (found, _, summary) = minimize_warm(&other, &warm, &Options { reuse, ..Options::default() });
        let (exact, _, _) = minimize(&other, warm.state().clone(), &to_the_last_digits(false));
        let apart = relative_difference(&found, &exact);
        println!("reuse {reuse}: {} iterations, apart from the optimum by {apart:.1e}", summary.iterations);
        // A decrement of 1e-7 of the mean square is 4e-4 of a standard deviation, which is a part in a thousand here.
        assert!(apart < 1e-6 && summary.termination.is_success());
    }
}
