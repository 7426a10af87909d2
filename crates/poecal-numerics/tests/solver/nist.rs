//! NIST's Statistical Reference Datasets for nonlinear regression: parameters and residual sums of squares certified to eleven digits.

use crate::nist_models::{MODELS, Model};
use crate::plain::{Evaluation, Found, jacobian_error, solve};
use std::path::Path;

/// Least number of digits of every parameter from every start; NIST's own page requires 4 or 5 of a good program.
const DIGITS: f64 = 6.0;
/// Least number of digits from the second start, which is closer.
const DIGITS_CLOSE: f64 = 8.0;
/// Certificates have eleven digits: agreement beyond that has no meaning.
const CERTIFIED: f64 = 11.0;
/// Digits of the residual sum of squares. Its error is quadratic in that of the parameters, but sums of small residuals of large
/// data have rounding of their own.
const SUM_DIGITS: f64 = 8.0;
/// The residual sum of Lanczos1, 1.4e-25, is rounding of its data of 14 digits and of the machine's exponentials.
const LANCZOS1_SUM: f64 = 1e-20;
/// Truncation and rounding of sixth-order differences on curves as sharp as these.
const JACOBIAN: f64 = 1e-6;

/// A regression: its data and its certificate.
pub(crate) struct Regression {
    pub(crate) name: &'static str,
    model: Model,
    y: Vec<f64>,
    x: Vec<Vec<f64>>,
    pub(crate) starts: [Vec<f64>; 2],
    certified: Vec<f64>,
    sum: f64,
}

impl Regression {
    pub(crate) fn read(name: &'static str, model: Model) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../poecal-testing/data/nist/{name}.dat"));
        let text = std::fs::read_to_string(path).unwrap();
        let numbers =
            |line: &str| -> Vec<f64> { line.split_whitespace().map_while(|word| word.parse().ok()).collect() };
        let (mut starts, mut certified) = ([Vec::new(), Vec::new()], Vec::new());
        for line in text.lines().filter(|line| line.trim_start().starts_with('b')) {
            let Some((_, row)) = line.split_once('=') else { continue };
            if let [first, second, value, _deviation] = numbers(row)[..] {
                starts[0].push(first);
                starts[1].push(second);
                certified.push(value);
            }
        }
        let sum = text.lines().find_map(|line| line.strip_prefix("Residual Sum of Squares:")).unwrap();
        let (_, data) = text.rsplit_once("Data:").unwrap();
        let rows: Vec<Vec<f64>> = data.lines().skip(1).map(numbers).filter(|row| !row.is_empty()).collect();
        let observations = text.lines().find_map(|line| line.strip_prefix("Number of Observations:"));
        assert_eq!(observations.map(|count| count.trim().parse()), Some(Ok(rows.len())), "{name}");
        // Nelson's response is the logarithm of the measured one.
        let y = rows.iter().map(|row| if name == "Nelson" { row[0].ln() } else { row[0] }).collect();
        let x = rows.iter().map(|row| row[1..].to_vec()).collect();
        Regression { name, model, y, x, starts, certified, sum: sum.trim().parse().unwrap() }
    }

    pub(crate) fn residuals(&self, b: &[f64]) -> Evaluation {
        let (mut f, mut jacobian) = (Vec::new(), Vec::new());
        for (y, x) in self.y.iter().zip(&self.x) {
            let (value, gradient) = (self.model)(b, x);
            f.push(value - y);
            jacobian.extend(gradient);
        }
        (f, jacobian)
    }

    pub(crate) fn solve(&self, start: &[f64], reuse: bool) -> Found {
        solve(start.len(), start, |b| self.residuals(b), reuse)
    }

    /// Least log relative error of all parameters.
    fn digits(&self, b: &[f64]) -> f64 {
        b.iter().zip(&self.certified).map(|(b, certified)| digits(*b, *certified)).fold(CERTIFIED, f64::min)
    }
}

/// Log relative error: the number of digits that agree; 0 if a number is not finite.
fn digits(value: f64, certified: f64) -> f64 {
    let apart = ((value - certified) / certified).abs();
    if apart.is_nan() { 0.0 } else { (-apart.log10()).clamp(0.0, CERTIFIED) }
}

pub(crate) fn all() -> impl Iterator<Item = Regression> {
    MODELS.iter().map(|&(name, model)| Regression::read(name, model))
}

fn certificates_are_reached(reuse: bool) {
    let mut short = Vec::new();
    println!("regression  start  iterations  evaluations  JᵀJ  digits  of the sum  end");
    for regression in all() {
        for (k, start) in regression.starts.iter().enumerate() {
            let found = regression.solve(start, reuse);
            let reached = regression.digits(&found.x);
            let sum = digits(found.sum, regression.sum);
            println!(
                "{:<10} {:>6} {:>11} {:>12} {:>4} {reached:>7.1} {sum:>11.1}  {}",
                regression.name,
                k + 1,
                found.summary.iterations,
                found.evaluations,
                found.products,
                found.summary.termination.word()
            );
            let asked = [DIGITS, DIGITS_CLOSE][k];
            let is_sum_right = if regression.name == "Lanczos1" { found.sum < LANCZOS1_SUM } else { sum >= SUM_DIGITS };
            if !(reached >= asked && is_sum_right && found.summary.termination.is_success()) {
                short.push(format!("{} from start {}: {reached:.1} digits", regression.name, k + 1));
            }
        }
    }
    assert!(short.is_empty(), "{short:#?}");
}

#[test]
fn certificates_are_reached_from_both_starts() {
    certificates_are_reached(true);
}

#[test]
fn certificates_are_reached_without_reuse() {
    certificates_are_reached(false);
}

#[test]
fn jacobians_of_the_models_are_those_of_differences() {
    for regression in all() {
        let [first, second] = &regression.starts;
        for at in [first, second, &regression.certified] {
            let error = jacobian_error(at, |b| regression.residuals(b));
            println!("{:<10} {error:.1e}", regression.name);
            assert!(error < JACOBIAN, "{}: {error:e}", regression.name);
        }
    }
}
