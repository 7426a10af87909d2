//! Rows of one configuration: a common error is the robot's until shown otherwise.

use nalgebra::Vector3;

use poecal_fit::state::{Estimate, RowError, Session};
use poecal_model::measurement::Dataset;

/// Factor on the bound of normal noise above which a row is suspected: errors of real robots have heavier tails than noise.
pub(crate) const TAILS: f64 = 2.0;
/// A row has the error of its configuration if it differs from the others' mean by less than this share of its own length.
const SHARE: f64 = 0.5;
/// The same factor for configurations with a common error: elastic gears and links cause smaller errors.
const COMMON_TAILS: f64 = 8.0;

/// Configurations measured several times, or with several targets.
pub(crate) struct RepeatedConfigurations {
    /// Configurations of two rows or more.
    groups: Vec<Vec<u32>>,
    /// Mean number of fitted rows per configuration and subject ([`Dataset::subject`]).
    pub(crate) repeats: f64,
}

impl RepeatedConfigurations {
    /// Groups the data, and counts the fitted rows.
    pub(crate) fn new(data: &Dataset, fitted: &[u32]) -> Self {
        // With several rows of a subject in one configuration the first counts.
        let over_again: usize = data
            .group_configurations(fitted)
            .into_iter()
            .map(|mut rows| {
                let count = rows.len();
                rows.sort_by_key(|&row| data.subject(row));
                rows.dedup_by_key(|row| data.subject(*row));
                count - rows.len()
            })
            .sum();
        let distinct = fitted.len() - over_again;
        let groups = data.group_configurations(&data.all_rows());
        RepeatedConfigurations { groups, repeats: fitted.len() as f64 / distinct.max(1) as f64 }
    }

    /// Share of each row's length that counts: less if the other rows of its configuration have the same error.
    pub(crate) fn shares(&self, session: &Session<'_>, estimate: &Estimate) -> Vec<f64> {
        let mut shares = vec![1.0; session.data.len()];
        let rows: Vec<u32> = self.groups.concat();
        if rows.is_empty() {
            return shares;
        }
        let errors = session.errors(&rows, estimate);
        let mut rest = &errors[..];
        for group in &self.groups {
            let (own, others) = rest.split_at(group.len());
            rest = others;
            let leading =
                |error: &RowError| error.leading_quantity().map(|quantity| (quantity, error.vector(quantity)));
            for (&row, error) in group.iter().zip(own) {
                let Some((quantity, error)) = leading(error) else { continue };
                let alike = own.iter().filter_map(leading).filter(|(other, _)| *other == quantity);
                let (sum, count) = alike.fold((Vector3::zeros(), 0), |(sum, count), (_, it)| (sum + it, count + 1));
                if count < 2 {
                    continue;
                }
                let others = (sum - error) / f64::from(count - 1);
                if (error - others).norm() < SHARE * error.norm() {
                    shares[row as usize] = TAILS / COMMON_TAILS;
                }
            }
        }
        shares
    }
}
