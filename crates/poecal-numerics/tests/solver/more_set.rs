//! All 35 problems of Moré, Garbow and Hillstrom from their standard starts, and the minima of the paper.

use crate::more_problems::*;
use crate::more_variable::*;
use crate::plain::{Evaluation, Plain, jacobian_error, solve};

/// The paper prints six digits of sums of squares that are not zero.
const PRINTED: f64 = 1e-5;
/// Sum of squares below which it counts as zero: only rounding of the residuals remains. Minima at which the Jacobian is singular are
/// approached linearly, and end about here.
const ZERO: f64 = 1e-20;
/// Truncation and rounding of sixth-order differences.
const JACOBIAN: f64 = 1e-6;

/// A problem with its standard start and its sum of squares: the global minimum first, then known local ones.
pub(crate) struct Problem {
    pub(crate) name: &'static str,
    pub(crate) function: fn(&[f64]) -> Evaluation,
    pub(crate) start: Vec<f64>,
    minima: &'static [f64],
}

fn problem(
    name: &'static str,
    function: fn(&[f64]) -> Evaluation,
    start: impl Into<Vec<f64>>,
    minima: &'static [f64],
) -> Problem {
    Problem { name, function, start: start.into(), minima }
}

fn fixed_problems() -> Vec<Problem> {
    vec![
        problem("1 Rosenbrock", rosenbrock, [-1.2, 1.0], &[0.0]),
        // The local minimum is in the paper.
        problem("2 Freudenstein-Roth", freudenstein_roth, [0.5, -2.0], &[0.0, 48.9842]),
        problem("3 Powell badly scaled", powell_badly_scaled, [0.0, 1.0], &[0.0]),
        problem("4 Brown badly scaled", brown_badly_scaled, [1.0, 1.0], &[0.0]),
        problem("5 Beale", beale, [1.0, 1.0], &[0.0]),
        problem("6 Jennrich-Sampson", jennrich_sampson, [0.3, 0.4], &[124.362]),
        problem("7 helical valley", helical_valley, [-1.0, 0.0, 0.0], &[0.0]),
        problem("8 Bard", bard, [1.0, 1.0, 1.0], &[8.21487e-3]),
        problem("9 Gaussian", gaussian, [0.4, 1.0, 0.0], &[1.12793e-8]),
        problem("10 Meyer", meyer, [0.02, 4000.0, 250.0], &[87.9458]),
        problem("11 Gulf", gulf, [5.0, 2.5, 0.15], &[0.0]),
        problem("12 Box 3D", box_three, [0.0, 10.0, 20.0], &[0.0]),
        problem("13 Powell singular", powell_singular, [3.0, -1.0, 0.0, 1.0], &[0.0]),
        problem("14 Wood", wood, [-3.0, -1.0, -3.0, -1.0], &[0.0]),
        problem("15 Kowalik-Osborne", kowalik_osborne, [0.25, 0.39, 0.415, 0.39], &[3.07505e-4]),
        problem("16 Brown-Dennis", brown_dennis, [25.0, 5.0, -5.0, -1.0], &[85822.2]),
        problem("17 Osborne 1", osborne_1, [0.5, 1.5, -1.0, 0.01, 0.02], &[5.46489e-5]),
        // Both are in the paper.
        problem("18 Biggs EXP6", biggs_exp6, [1.0, 2.0, 1.0, 1.0, 1.0, 1.0], &[0.0, 5.65565e-3]),
        problem("19 Osborne 2", osborne_2, [1.3, 0.65, 0.65, 0.7, 0.6, 3.0, 5.0, 7.0, 2.0, 4.5, 5.5], &[4.01377e-2]),
    ]
}

fn variable() -> Vec<Problem> {
    let count = |n: usize| (1..=n).map(|k| k as f64);
    let grid = |n: usize| count(n).map(move |k| k / (n as f64 + 1.0));
    let on_boundary = || grid(10).map(|t| t * (t - 1.0)).collect::<Vec<f64>>();
    vec![
        problem("20 Watson, n = 6", watson, [0.0; 6], &[2.28767e-3]),
        problem("20 Watson, n = 9", watson, [0.0; 9], &[1.39976e-6]),
        problem("20 Watson, n = 12", watson, [0.0; 12], &[4.72238e-10]),
        problem("21 extended Rosenbrock", extended_rosenbrock, [-1.2, 1.0].repeat(5), &[0.0]),
        problem("22 extended Powell", extended_powell, [3.0, -1.0, 0.0, 1.0].repeat(3), &[0.0]),
        problem("23 penalty I, n = 4", penalty_1, count(4).collect::<Vec<f64>>(), &[2.24997e-5]),
        problem("23 penalty I, n = 10", penalty_1, count(10).collect::<Vec<f64>>(), &[7.08765e-5]),
        problem("24 penalty II, n = 4", penalty_2, [0.5; 4], &[9.37629e-6]),
        problem("24 penalty II, n = 10", penalty_2, [0.5; 10], &[2.93660e-4]),
        problem(
            "25 variably dimensioned",
            variably_dimensioned,
            count(10).map(|k| 1.0 - k / 10.0).collect::<Vec<f64>>(),
            &[0.0],
        ),
        // The local minimum is not in the paper, but in the literature since (2.79506e-5).
        problem("26 trigonometric", trigonometric, [0.1; 10], &[0.0, 2.79506e-5]),
        // The local minimum 1 at (0, …, 0, n + 1) is in the paper.
        problem("27 Brown almost linear", brown_almost_linear, [0.5; 10], &[0.0, 1.0]),
        problem("28 discrete boundary value", discrete_boundary_value, on_boundary(), &[0.0]),
        problem("29 discrete integral equation", discrete_integral_equation, on_boundary(), &[0.0]),
        problem("30 Broyden tridiagonal", broyden_tridiagonal, [-1.0; 10], &[0.0]),
        problem("31 Broyden banded", broyden_banded, [-1.0; 10], &[0.0]),
        // m - n, m (m - 1) / (2 (2m + 1)) and (m² + 3m - 6) / (2 (2m - 3)), with ten residuals and five unknowns.
        problem("32 linear, full rank", linear_full_rank, [1.0; 5], &[5.0]),
        problem("33 linear, rank 1", linear_rank_1, [1.0; 5], &[90.0 / 42.0]),
        problem("34 linear, rank 1, zeros", linear_rank_1_with_zeros, [1.0; 5], &[124.0 / 34.0]),
        problem("35 Chebyquad, n = 7", chebyquad, grid(7).collect::<Vec<f64>>(), &[0.0]),
        problem("35 Chebyquad, n = 8", chebyquad, grid(8).collect::<Vec<f64>>(), &[3.51687e-3]),
        problem("35 Chebyquad, n = 9", chebyquad, grid(9).collect::<Vec<f64>>(), &[0.0]),
        // 4.77271e-3 is a local minimum that the paper does not list.
        problem("35 Chebyquad, n = 10", chebyquad, grid(10).collect::<Vec<f64>>(), &[6.50395e-3, 4.77271e-3]),
    ]
}

pub(crate) fn all() -> impl Iterator<Item = Problem> {
    fixed_problems().into_iter().chain(variable())
}

/// True if a sum of squares is a minimum as printed; and the number of digits that agree.
fn agreement(sum: f64, minimum: f64) -> (bool, f64) {
    if minimum == 0.0 {
        return (sum < ZERO, if sum > 0.0 { -sum.log10() } else { f64::INFINITY });
    }
    let apart = (sum / minimum - 1.0).abs();
    (apart < PRINTED, -apart.log10())
}

fn published_sums_are_reached(reuse: bool) {
    let mut short = Vec::new();
    println!("problem                        iterations  evaluations  JᵀJ  sum of squares  published  digits  end");
    for problem in all() {
        let found = solve(problem.start.len(), &problem.start, problem.function, reuse);
        let reached = problem.minima.iter().find(|&&minimum| agreement(found.sum, minimum).0);
        let minimum = *reached.unwrap_or(&problem.minima[0]);
        println!(
            "{:<30} {:>10} {:>12} {:>4} {:>15.8e} {minimum:>10.5e} {:>7.1}  {}{}",
            problem.name,
            found.summary.iterations,
            found.evaluations,
            found.products,
            found.sum,
            agreement(found.sum, minimum).1,
            found.summary.termination.word(),
            if minimum == problem.minima[0] { "" } else { ", local minimum" },
        );
        if reached.is_none() || !found.summary.termination.is_success() {
            short.push(format!("{}: {:e}", problem.name, found.sum));
        }
    }
    assert!(short.is_empty(), "{short:#?}");
}

#[test]
fn published_sums_are_reached_from_standard_starts() {
    published_sums_are_reached(true);
}

#[test]
fn published_sums_are_reached_without_reuse() {
    published_sums_are_reached(false);
}

#[test]
fn there_are_35_problems() {
    let mut numbers: Vec<u32> = all().filter_map(|problem| problem.name.split(' ').next()?.parse().ok()).collect();
    numbers.dedup();
    assert_eq!(numbers, (1..=35).collect::<Vec<u32>>());
}

#[test]
fn jacobians_are_those_of_differences() {
    for problem in all() {
        // The points are the start, and one near it, where nothing cancels by symmetry.
        let beside: Vec<f64> = problem.start.iter().zip(1..).map(|(x, k)| 1.01 * x + 0.01 / f64::from(k)).collect();
        for at in [&problem.start, &beside] {
            let error = jacobian_error(at, problem.function);
            println!("{:<30} {error:.1e}", problem.name);
            assert!(error < JACOBIAN, "{}: {error:e}", problem.name);
        }
    }
}

/// `JᵀJ` alone converges linearly where residuals at the minimum are large; the full Hessian converges quadratically.
#[test]
fn the_full_hessian_makes_large_residuals_converge_fast() {
    let problem = all().find(|problem| problem.name == "16 Brown-Dennis").unwrap();
    let without = Plain::new(4, problem.function).solve(&problem.start, true);
    let with = Plain::new(4, problem.function).with_curvature().solve(&problem.start, true);
    let iterations = [&without, &with].map(|found| found.summary.iterations);
    println!(
        "iterations {} without, {} with; sums {:.12e}, {:.12e}",
        iterations[0], iterations[1], without.sum, with.sum
    );
    assert!(with.summary.termination.is_success() && agreement(with.sum, 85822.2).0);
    assert!(5 * iterations[1] < iterations[0]);
}
