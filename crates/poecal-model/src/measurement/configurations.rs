//! Rows measured in the same configuration.

use super::{Dataset, Quantity};
use poecal_numerics::threads;

/// An odd number whose bits look random: the golden ratio's.
const MIXER: u64 = 0x9e37_79b9_7f4a_7c15;

/// Largest difference of readings (radians, metres) of one configuration: the robot's error is the same there, in spite of the encoders'
/// jitter.
const SAME: f64 = 1e-3;
/// Rows above which only identical readings are of one configuration.
pub const MANY: usize = 100_000;
/// Number of rows that one thread compares together.
const CHUNK: usize = 4096;

impl Dataset {
    /// Subject of a row: rows of one configuration with equal subjects repeat each other. For a position or an orientation it is the target. For
    /// others, such as a distance or a height, it is also the station, since each measures another part of the target's error.
    #[must_use]
    pub fn subject(&self, row: u32) -> (usize, Option<usize>) {
        let Some(seen) = self.observations.get(row as usize) else { return (0, None) };
        let is_of_pose = [Quantity::Position, Quantity::Rotation].iter().any(|it| seen.measurement.has(*it));
        (seen.target, Some(seen.station).filter(|_| !is_of_pose))
    }

    /// Configurations of two rows or more among these, groups and their rows in the order of the data. Readings of one configuration differ
    /// by no more than 0.001 rad or 1 mm.
    pub fn group_configurations(&self, rows: &[u32]) -> Vec<Vec<u32>> {
        if rows.len() > MANY { self.group_repeated(rows) } else { self.group_similar(rows, SAME, 2, |_| 0) }
    }

    /// These rows by configuration, as [`Dataset::group_configurations`], with configurations of one row. For some hundred thousand rows at most.
    pub fn configurations(&self, rows: &[u32]) -> Vec<Vec<u32>> {
        let mut groups = self.group_configurations(rows);
        let mut grouped: Vec<u32> = groups.iter().flatten().copied().collect();
        grouped.sort_unstable();
        groups.extend(rows.iter().filter(|row| grouped.binary_search(row).is_err()).map(|&row| vec![row]));
        groups.sort_unstable();
        groups
    }

    /// Groups of `least` rows or more of one class among these whose readings differ from those of the group's first row by no more than
    /// `same`.
    pub fn group_similar<C: Copy + Ord + Send + Sync>(
        &self,
        rows: &[u32],
        same: f64,
        least: usize,
        class: impl Fn(u32) -> C,
    ) -> Vec<Vec<u32>> {
        let readings = |row: u32| self.of_joints(row);
        // Rows of equal readings are neighbours in the order of any weighted sum. With these weights other rows seldom are, and hardly
        // ever in that of two such sums.
        let weight = |k: usize| 1.0 + 0.618_033_988_749_895 * (k as f64).sqrt();
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let keys = |row: u32| {
            readings(row).iter().enumerate().fold((0.0, 0.0), |(sum, other), (k, value)| {
                let value = weight(k) * value;
                (sum + value, other + sign(k) * value)
            })
        };
        let window = same * (0..self.reading_names().len()).map(weight).sum::<f64>();
        let mut order: Vec<(C, (f64, f64), u32)> = rows.iter().map(|&row| (class(row), keys(row), row)).collect();
        threads::sort_by(&mut order, |a, b| a.0.cmp(&b.0).then(a.1.0.total_cmp(&b.1.0)).then(a.2.cmp(&b.2)));
        let is_same = |a: u32, b: u32| readings(a).iter().zip(readings(b)).all(|(a, b)| (a - b).abs() <= same);
        // Both sums of rows that are alike differ by no more than the window, but for rounding.
        let wide = window * (1.0 + 1e-6);
        // Indices of the rows like that at `first`, which is the first.
        let like = |first: usize| {
            let (class, (key, other), row) = order[first];
            let rest = order.get(first + 1..).unwrap_or_default();
            let near = rest.iter().take_while(move |it| it.0 == class && it.1.0 - key <= window);
            let near = (first + 1..).zip(near).filter(move |(_, it)| (it.1.1 - other).abs() <= wide);
            let others = near.filter(move |(_, it)| is_same(row, it.2)).map(|(place, _)| place);
            std::iter::once(first).chain(others)
        };
        // Hardly any row has enough of them, unless robots were sent back on purpose.
        let firsts = threads::map_parts(order.len().div_ceil(CHUNK), |chunk| {
            let places = chunk * CHUNK..order.len().min((chunk + 1) * CHUNK);
            places.filter(|&first| like(first).nth(least - 1).is_some()).collect::<Vec<_>>()
        });
        let mut taken = vec![false; order.len()];
        let mut groups = Vec::new();
        for first in firsts.into_iter().flatten() {
            if taken[first] {
                continue;
            }
            let members: Vec<usize> = like(first).filter(|&place| !taken[place]).collect();
            if members.len() >= least {
                members.iter().for_each(|&place| taken[place] = true);
                let mut rows: Vec<u32> = members.iter().map(|&place| order[place].2).collect();
                rows.sort_unstable();
                groups.push(rows);
            }
        }
        groups.sort_unstable();
        groups
    }

    /// Groups of two rows or more among these with identical readings, groups and their rows in the order of the data.
    pub fn group_repeated(&self, rows: &[u32]) -> Vec<Vec<u32>> {
        let bits = |row: u32| self.of_joints(row).iter().map(|value| value.to_bits());
        // A hash: only rows with equal hashes are compared.
        let mixed = |row: u32| bits(row).fold(0, |sum: u64, bits| (sum ^ bits).wrapping_mul(MIXER).rotate_left(29));
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
    use crate::measurement::{Measurement, Observation};
    use nalgebra::Vector3;

    #[test]
    fn rows_that_jitter_are_of_one_configuration() {
        let mut data = Dataset::new(vec!["a".to_owned(), "b".to_owned()]);
        for readings in [[0.3, 1.0], [0.0, 1.0], [0.3004, 0.9997], [0.3, 1.002], [-0.0009, 1.0]] {
            let seen = Measurement::point(Vector3::zeros());
            data.push(&readings, None, seen).unwrap();
        }
        assert_eq!(data.configurations(&data.all_rows()), [vec![0, 2], vec![1, 4], vec![3]]);
        assert_eq!(data.configurations(&[4, 2, 3]), [vec![2], vec![3], vec![4]]);
    }

    #[test]
    fn distances_from_two_stations_are_no_repeats() {
        let mut data = Dataset::new(vec!["a".to_owned()]);
        for seen in [Measurement::point(Vector3::zeros()), Measurement::distance(1.0)] {
            for station in 0..2 {
                let row = Observation { station, ..Observation::new(0, seen) };
                data.push_observation(&[0.0], row).unwrap();
            }
        }
        assert_eq!(data.subject(0), data.subject(1));
        assert_ne!(data.subject(2), data.subject(3));
    }

    #[test]
    fn rows_of_the_same_readings_are_found() {
        let mut data = Dataset::new(vec!["a".to_owned(), "b".to_owned()]);
        for readings in [[3.0, 1.0], [0.0, 1.0], [0.5, 0.5], [0.0, 1.0], [3.0, 1.0], [1.0, 0.0], [0.0, 1.0]] {
            let seen = Measurement::point(Vector3::zeros());
            data.push(&readings, None, seen).unwrap();
        }
        assert_eq!(data.group_repeated(&data.all_rows()), [vec![0, 4], vec![1, 3, 6]]);
        assert_eq!(data.group_repeated(&[6, 5, 1, 0]), [vec![1, 6]]);
    }
}
