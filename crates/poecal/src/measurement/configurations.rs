//! Rows that were taken in the same configuration.

use super::Dataset;
use crate::threads;

/// An odd number whose bits look random: the golden ratio's.
const MIXER: u64 = 0x9e37_79b9_7f4a_7c15;

impl Dataset {
    /// The rows among these whose readings are the same to the last bit, each group and its rows in the order of their numbers;
    /// configurations of one row are left out.
    pub(crate) fn repeated(&self, rows: &[u32]) -> Vec<Vec<u32>> {
        let bits = |row: u32| self.readings(row as usize).iter().map(|value| value.to_bits());
        // What is the same has the same mixture, and little else has: only rows that share one need be compared.
        let mixed =
            |row: u32| bits(row).fold(0, |sum: u64, bits| (sum ^ bits).wrapping_mul(MIXER).rotate_left(29));
        let mut mixtures: Vec<(u64, u32)> = rows.iter().map(|&row| (mixed(row), row)).collect();
        threads::sort_by(&mut mixtures, Ord::cmp);
        let mut groups = Vec::new();
        for alike in mixtures.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
            let mut alike: Vec<u32> = alike.iter().map(|&(_, row)| row).collect();
            alike.sort_by(|&a, &b| bits(a).cmp(bits(b)));
            let same = alike.chunk_by(|&a, &b| bits(a).eq(bits(b)));
            groups.extend(same.filter(|same| same.len() > 1).map(<[u32]>::to_vec));
        }
        groups.sort_unstable();
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::{Measurement, PointMeasurement};
    use nalgebra::Vector3;

    #[test]
    fn rows_of_the_same_readings_are_found() {
        let mut data = Dataset::new(vec!["a".to_owned(), "b".to_owned()]);
        for readings in [[3.0, 1.0], [0.0, 1.0], [0.5, 0.5], [0.0, 1.0], [3.0, 1.0], [1.0, 0.0], [0.0, 1.0]] {
            let seen = Measurement::Point(PointMeasurement { position: Vector3::zeros() });
            data.push(&readings, None, seen).unwrap();
        }
        assert_eq!(data.repeated(&data.all_rows()), [vec![0, 4], vec![1, 3, 6]]);
        assert_eq!(data.repeated(&[6, 5, 1, 0]), [vec![1, 6]]);
    }
}
