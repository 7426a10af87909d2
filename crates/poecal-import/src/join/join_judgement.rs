//! Agreement of the nominal robot with pairs of joint readings and measurements, and the messages on it.

use std::collections::BTreeSet;

use super::join_pairs::{JoinedReadings, Pairing};
use super::join_words::{advice, count_configurations, mm, words};
use crate::Join;
use poecal_fit::input_doubts::joined_rows;
use poecal_fit::start::{Agreement, RowOrder, RowPair};
use poecal_numerics::error::Result;

impl Pairing<'_> {
    /// Pairs of one order, if the nominal robot agrees with them and with no other order; `is_stated` if the user confirmed them.
    pub(crate) fn judge_order(&self, pairs: &[RowPair], how: Join, is_stated: bool) -> Result<JoinedReadings> {
        let (joints, path) = (self.joints.path.display(), self.path.display());
        let (by_name, _) = join_names(how);
        let found = self.rows.agreement(pairs);
        let mut warnings = self.warn_of_order(found, pairs, how, is_stated)?;
        self.refuse_exchanged(pairs)?;
        if let Some(Agreement::Right { missed_m } | Agreement::Alike { missed_m, .. }) = found {
            warnings.extend(self.refuse_doubtful(missed_m, pairs, by_name)?);
        }
        let missed = match found {
            Some(Agreement::Right { missed_m }) => {
                format!(
                    "; the nominal robot misses them by {} (median), and by more than twice that in any other order",
                    mm(missed_m)
                )
            }
            _ => String::new(),
        };
        let note = format!("{joints} and {path} were joined {by_name}: {}{missed}", count_configurations(pairs.len()));
        warnings.extend(found.and_then(|_| self.wrong_pairs(pairs)));
        warnings.extend(self.without_partner(pairs));
        let entry = self.entry(how, pairs, found.as_ref().map(Agreement::missed_m));
        let unmeasured = self.unmeasured_rows(pairs);
        Ok(JoinedReadings { entry, readings: self.readings(pairs), unmeasured, notes: vec![note], warnings })
    }

    /// Warns of pairs of one order without or with little evidence; refuses those that another order fits better.
    fn warn_of_order(
        &self,
        found: Option<Agreement>,
        pairs: &[RowPair],
        how: Join,
        is_stated: bool,
    ) -> Result<Vec<String>> {
        let (joints, path) = (self.joints.path.display(), self.path.display());
        let (by_name, _) = join_names(how);
        let mut warnings = Vec::new();
        match found {
            Some(
                Agreement::Other { missed_m, order, other_m } | Agreement::Alike { missed_m, order, other_m },
            ) if !is_stated && joined_rows::is_doubtful(self.robot, missed_m.min(other_m)) => {
                return self.refuse(format!(
                    "found measurements that do not fit the joint readings: the nominal robot misses them by {} (median) if they are joined {by_name}, and by {} {}: {}",
                    mm(missed_m),
                    mm(other_m),
                    words(order),
                    joined_rows::reason(self.robot, &self.rows.session_of(pairs))
                ));
            }
            Some(Agreement::Other { missed_m, order, other_m }) => {
                return self.refuse(format!(
                    "found measurements that the nominal robot misses by {} (median) if they are joined {by_name}, and by {} {}, expected no other \
                     order to fit better: {}",
                    mm(missed_m),
                    mm(other_m),
                    words(order),
                    advice(order)
                ));
            }
            Some(Agreement::Alike { missed_m, order, other_m }) => {
                warnings.push(self.warn_of_alike((missed_m, order, other_m), how, is_stated)?);
            }
            Some(Agreement::None { missed_m }) => {
                warnings.push(self.warn_of_chance(missed_m, pairs, how, is_stated)?);
            }
            None if how == Join::Rows && !is_stated => {
                return self.refuse(format!(
                    "found {}, with which nothing shows whether the rows belong together, expected more, names in both (a column `id`), or \
                     --join rows",
                    count_configurations(pairs.len())
                ));
            }
            None => warnings.push(format!(
                "{joints}, {path}: nothing shows whether the rows belong together: too few, or of a kind that one frame does not place"
            )),
            Some(Agreement::Right { .. }) => {}
        }
        Ok(warnings)
    }

    /// Warns of pairs that another order fits as well; refuses them if the order is not stated.
    fn warn_of_alike(
        &self,
        (missed_m, order, other_m): (f64, RowOrder, f64),
        how: Join,
        is_stated: bool,
    ) -> Result<String> {
        let (joints, path) = (self.joints.path.display(), self.path.display());
        let (by_name, option) = join_names(how);
        let message = format!(
            "the nominal robot misses the measurements by {} (median) if they are joined {by_name}, and by {} {}, which is no evident difference",
            mm(missed_m),
            mm(other_m),
            words(order)
        );
        if !is_stated {
            let names = if how == Join::Name { "" } else { ", or add a column `id` to both files" };
            return self.refuse(format!(
                "found files that can be joined in two ways: {message}; state the order by --join {option}{names}"
            ));
        }
        Ok(format!("{joints}, {path}: {message}"))
    }

    /// Warns of pairs that fit no better than by chance; refuses them if the order is not stated.
    fn warn_of_chance(&self, missed_m: f64, pairs: &[RowPair], how: Join, is_stated: bool) -> Result<String> {
        let (joints, path) = (self.joints.path.display(), self.path.display());
        let (by_name, _) = join_names(how);
        let message = format!(
            "the nominal robot misses the measurements by {} (median) if they are joined {by_name}, no less than by chance: {}",
            mm(missed_m),
            joined_rows::reason(self.robot, &self.rows.session_of(pairs))
        );
        // The errors of a robot that moves little are small in any order.
        if !is_stated || joined_rows::is_doubtful(self.robot, missed_m) {
            return self.refuse(format!("found measurements that do not fit the joint readings: {message}"));
        }
        Ok(format!("{joints}, {path}: {message}"))
    }

    /// Refuses rows that fit each other's readings.
    fn refuse_exchanged(&self, pairs: &[RowPair]) -> Result<()> {
        let exchanged = self.rows.find_exchanged_pairs(pairs);
        let Some((one, other)) = exchanged.first() else { return Ok(()) };
        let (Some(one), Some(other)) = (pairs.get(*one), pairs.get(*other)) else { return Ok(()) };
        let all: BTreeSet<usize> = exchanged.iter().filter_map(|it| Some(pairs.get(it.0)?.1)).collect();
        self.refuse(format!(
            "found the measurements of {} in another order than their joint readings, as {} that fits the readings of {}, expected the same order: \
             exchange them",
            self.shot_lines(&all.into_iter().collect::<Vec<_>>()),
            self.shot_lines(&[one.1]),
            self.joint_lines(&[other.0])
        ))
    }
}

/// Names of a join: in words, and its option.
fn join_names(how: Join) -> (&'static str, &'static str) {
    match how {
        Join::Name => ("by name", "name"),
        Join::Rows => ("row by row", "rows"),
        Join::Time => ("at the times of their stands", "time"),
        Join::Motion => ("in motion", "motion"),
    }
}
