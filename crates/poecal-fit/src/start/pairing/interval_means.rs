//! Means of static intervals, without rows that are far from the others, as after a disturbed beam.

use nalgebra::Vector3;

use super::words::mm;
use poecal_numerics::distributions::{median, median_point};

/// Multiple of the usual distance from the middle beyond which a row does not belong to its static interval.
const FAR: f64 = 10.0;
/// Multiple of the usual scatter beyond which a static interval is named.
const WIDE: f64 = 8.0;
/// Scatter of a static interval that is never named, metres.
const NARROW_M: f64 = 1e-4;

/// Values near their median, by their usual distance from it and a change that counts as none.
pub(crate) fn kept_values(values: &[f64], floor: f64) -> Vec<f64> {
    let Some(middle) = median(values.iter().copied()) else { return Vec::new() };
    let usual = median(values.iter().map(|it| (it - middle).abs())).unwrap_or_default();
    values.iter().copied().filter(|it| (it - middle).abs() <= FAR * usual + floor).collect()
}

/// For each position, true if it is near the middle of all, by the same rule.
pub(crate) fn flag_near_middle(places: &[Vector3<f64>], floor_m: f64) -> Vec<bool> {
    let middle = median_point(places);
    let usual = median(places.iter().map(|it| (it - middle).norm())).unwrap_or_default();
    places.iter().map(|it| (it - middle).norm() <= FAR * usual + floor_m).collect()
}

/// Scatter of the rows of a static interval about their mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct IntervalScatter {
    squares: f64,
    count: usize,
    /// Rows that were left out, and the largest distance of one from the mean, metres.
    left_out: usize,
    farthest_m: f64,
}

impl IntervalScatter {
    /// Adds positions about their mean, of which some were kept.
    pub(crate) fn add(&mut self, places: &[Vector3<f64>], is_kept: &[bool], mean: &Vector3<f64>) {
        for (place, is_kept) in places.iter().zip(is_kept) {
            let off = (place - mean).norm();
            if *is_kept {
                (self.squares, self.count) = (self.squares + off * off, self.count + 1);
            } else {
                (self.left_out, self.farthest_m) = (self.left_out + 1, self.farthest_m.max(off));
            }
        }
    }

    fn root_m(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }

    /// Root mean square of all, metres.
    pub(crate) fn of_all(all: &[IntervalScatter]) -> f64 {
        let sum = |it: IntervalScatter, other: &IntervalScatter| IntervalScatter {
            squares: it.squares + other.squares,
            count: it.count + other.count,
            ..it
        };
        all.iter().fold(IntervalScatter::default(), sum).root_m()
    }

    /// Warnings about static intervals with rows that were left out, and about those with far more scatter than the others; `lines` names
    /// some of them.
    pub(crate) fn warnings(all: &[IntervalScatter], lines: impl Fn(&[usize]) -> String) -> Vec<String> {
        let usual = median(all.iter().map(IntervalScatter::root_m)).unwrap_or_default();
        let of = |is: &dyn Fn(&IntervalScatter) -> bool| -> Vec<usize> {
            (0..).zip(all).filter(|it| is(it.1)).map(|it| it.0).collect()
        };
        let mut said = Vec::new();
        let disturbed = of(&|it| it.left_out > 0 && it.farthest_m > NARROW_M.max(WIDE * usual));
        if !disturbed.is_empty() {
            let own = || disturbed.iter().filter_map(|at| all.get(*at));
            let count: usize = own().map(|it| it.left_out).sum();
            let farthest = own().map(|it| it.farthest_m).fold(0.0, f64::max);
            said.push(format!(
                "left out {count} row{} up to {} from the others of the same stand: {} at {}",
                if count == 1 { "" } else { "s" },
                mm(farthest),
                if disturbed.len() == 1 { "one that begins" } else { "some that begin" },
                lines(&disturbed)
            ));
        }
        let wide = of(&|it| it.root_m() > NARROW_M.max(WIDE * usual));
        if !wide.is_empty() {
            let most = wide.iter().filter_map(|at| all.get(*at)).map(IntervalScatter::root_m).fold(0.0, f64::max);
            said.push(format!(
                "the rows of {} at {} scatter by up to {}, those of the others by {} (median)",
                if wide.len() == 1 { "the stand that begins" } else { "the stands that begin" },
                lines(&wide),
                mm(most),
                mm(usual)
            ));
        }
        said
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disturbed_row_is_none_of_its_stand() {
        let noise = |k: usize| ((k as f64 * 0.618_033_988_7).fract() - 0.5) * 1e-4;
        let mut places: Vec<Vector3<f64>> =
            (0..100).map(|k| Vector3::new(noise(k), noise(k + 7), noise(k + 31))).collect();
        assert_eq!(flag_near_middle(&places, 3e-5), [true; 100]);
        places[40].x = 0.6;
        let is_kept = flag_near_middle(&places, 3e-5);
        assert_eq!(is_kept.iter().filter(|it| !**it).count(), 1);
        assert!(!is_kept[40]);
        let mut spread = IntervalScatter::default();
        spread.add(&places, &is_kept, &Vector3::zeros());
        let calm = IntervalScatter { squares: spread.squares, count: 99, ..IntervalScatter::default() };
        let said = IntervalScatter::warnings(&[calm, spread, calm], |some| format!("{some:?}"));
        assert_eq!(said, ["left out 1 row up to 600.000 mm from the others of the same stand: one that begins at [1]"]);
        assert!(IntervalScatter::of_all(&[calm, spread]) < 1e-4);
        // Readings of an encoder whose last digit changes.
        let toggles: Vec<f64> = (0..50).map(|k| if k % 5 == 0 { 1e-3 } else { 0.0 }).collect();
        assert_eq!(kept_values(&toggles, 1e-3).len(), 50);
        assert_eq!(kept_values(&[0.0, 1e-6, 0.0, 0.5, 1e-6], 5e-5).len(), 4);
    }
}
