//! Ratio of the errors of the registered or nominal model to those of another model on the same rows: theory.md §9 (50).

use crate::{Calibration, Improvement, Improvements};
use poecal_fit::state::RowError;
use poecal_model::measurement::{Dataset, MeasuredQuantities};
use poecal_numerics::distributions::f_quantile;

/// Probability that the factor lies outside its bounds.
const RISK: f64 = 0.05;

/// Improvements on the held-out rows; `None` without any.
pub(crate) fn improvements(calibration: &Calibration, data: &Dataset) -> Option<Improvements> {
    let rows = &calibration.held_out_rows;
    let packed = calibration.packed_values(data);
    let session = calibration.session(data, &packed);
    if rows.is_empty() {
        return None;
    }
    let before = session.errors(rows, &calibration.models.registered);
    let of = |after: &[RowError]| paired_improvement(data, rows, [&before, after]);
    let after = session.errors(rows, &calibration.models.calibrated);
    let corrected = calibration.correction.as_ref().map(|found| of(&found.errors(data, rows)));
    Some(Improvements { calibrated: of(&after), corrected })
}

/// Improvement by (50) of each quantity, from errors of the same rows by two models, before and after; `rows` ascend.
pub(crate) fn paired_improvement(
    data: &Dataset,
    rows: &[u32],
    [before, after]: [&[RowError]; 2],
) -> MeasuredQuantities<Improvement> {
    let groups = data.configurations(rows);
    MeasuredQuantities::from_fn(|quantity| {
        let sums = groups.iter().map(|group| {
            let own = group.iter().filter_map(|row| rows.binary_search(row).ok());
            own.fold([0.0, 0.0], |[a, b], at| {
                let square =
                    |errors: &[RowError]| errors.get(at).and_then(|it| it.length(quantity)).map_or(0.0, |it| it * it);
                [a + square(before), b + square(after)]
            })
        });
        improvement(&sums.collect::<Vec<_>>(), before.iter().any(|it| !it.part(quantity).is_empty()))
    })
}

/// Improvement by (50) from sums of squares before and after, by configuration.
pub(crate) fn improvement(sums: &[[f64; 2]], is_measured: bool) -> Option<Improvement> {
    let [before, after] = sums.iter().fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
    let groups = sums.len() as f64;
    if !is_measured || groups < 2.0 || before <= 0.0 || after <= 0.0 {
        return None;
    }
    let share = |[a, b]: &[f64; 2]| 0.5 * (a / before - b / after);
    let variance = groups / (groups - 1.0) * sums.iter().map(|sum| share(sum).powi(2)).sum::<f64>();
    let factor = (before / after).sqrt();
    let spread = (f_quantile(RISK, 1.0, groups - 1.0) * variance).sqrt().exp();
    Some(Improvement { factor, from: factor / spread, to: factor * spread })
}

#[cfg(test)]
mod tests {
    use super::improvement;

    #[test]
    fn what_is_three_times_smaller_everywhere_is_so_for_certain() {
        let sums: Vec<[f64; 2]> = (1..20).map(|k| [9.0 * f64::from(k), f64::from(k)]).collect();
        let found = improvement(&sums, true).unwrap();
        // Tolerance for rounding.
        assert!((found.factor - 3.0).abs() < 1e-12 && (found.to - found.from).abs() < 1e-12, "{found:?}");
        assert_eq!(improvement(&sums[..1], true), None);
    }

    /// Two models whose errors are independent: the interval holds the true factor in 95 % of the cases.
    #[test]
    fn the_interval_holds_the_factor() {
        use rand_core::{Rng, SeedableRng};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut square = |size: f64| {
            let uniform = (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
            // Exponential: a sum of two normal squares.
            -size * (1.0 - uniform).ln()
        };
        for count in [12, 40, 200] {
            let mut inside = 0;
            for _ in 0..2000 {
                let sums: Vec<[f64; 2]> = (0..count).map(|_| [square(16.0), square(1.0)]).collect();
                let found = improvement(&sums, true).unwrap();
                inside += usize::from((found.from..=found.to).contains(&4.0));
            }
            let share = inside as f64 / 2000.0;
            println!("{count} configurations: {share:.3} inside");
            // The scatter of few configurations is poorly determined; three standard errors of the trials are 0.015.
            assert!((if count < 20 { 0.89 } else { 0.93 }..0.98).contains(&share));
        }
    }
}
