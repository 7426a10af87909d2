//! Lists of unequal length, and messages on rows that fit badly or not at all.

use std::collections::{BTreeMap, BTreeSet};

use super::join_pairs::{JoinedReadings, Pairing, SOME_WRONG};
use super::join_words::mm;
use super::missing_intervals::MissingIntervals;
use crate::Join;
use poecal_fit::input_doubts::joined_rows;
use poecal_fit::start::{Agreement, AlignedPairs, RowPair};
use poecal_numerics::error::Result;

/// Ratio of the numbers of rows beyond which the longer one is a recording, not a list.
const LONGER: usize = 3;
/// Largest error of a pair that is never reported as wrong, metres.
const LEAST_WRONG_M: f64 = 1e-3;

impl Pairing<'_> {
    /// Lists of unequal length, by the errors of the nominal robot.
    pub(crate) fn by_alignment(&self) -> Result<JoinedReadings> {
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        if joints > LONGER * shots
            && let MissingIntervals::Recorded { why, .. } = &self.joints.no_stands
        {
            return self.refuse(format!(
                "found {shots} measured configurations, and {joints} rows of joint readings that follow each other as in a recording, with {why}, \
                 expected the time of each row in seconds, by which the stands of the robot are found"
            ));
        }
        if shots > LONGER * joints
            && let Some(MissingIntervals::Recorded { why, .. }) = self.no_stands
        {
            return self.refuse(format!(
                "found {joints} rows of joint readings, and {shots} measurements that follow each other as in a recording, with {why}, expected the \
                 time of each row in seconds, by which the stands of the robot are found"
            ));
        }
        self.join_aligned(self.rows.align_lists())
    }

    /// Joins such lists by the alignment that was found.
    pub(crate) fn join_aligned(&self, found: Option<AlignedPairs>) -> Result<JoinedReadings> {
        let (joints, shots) = (self.rows.joint_rows(), self.rows.shots().len());
        let counts = format!("found {shots} measured configurations and {joints} rows of joint readings");
        let Some(found) = found else {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): nothing shows which belong together"
            ));
        };
        let AlignedPairs { pairs, repeated, unread, unclear, missed_m, .. } = &found;
        if 2 * pairs.len() < shots.min(joints) {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): only {} of them fit the nominal robot in this order",
                pairs.len()
            ));
        }
        if !matches!(self.rows.agreement(pairs), Some(Agreement::Right { .. })) {
            return self.refuse(format!(
                "{counts}, expected as many, or names in both (a column `id`): no order fits evidently better than others"
            ));
        }
        let mut warnings: Vec<String> = self.refuse_doubtful(*missed_m, pairs, "in their order")?.into_iter().collect();
        let (own, path) = (self.joints.path.display(), self.path.display());
        if !repeated.is_empty() {
            warnings.push(self.describe_repeated(repeated));
        }
        if !unread.is_empty() {
            warnings.push(self.left_out(unread, ["fits", "fit"], "no joint readings"));
        }
        if !unclear.is_empty() {
            let what = "two neighbouring rows of joint readings";
            warnings.push(self.left_out(unclear, ["fits", "fit"], what));
        }
        let note = format!(
            "{own} and {path} were joined in their order, since they have {joints} and {shots} rows: {} configurations; the nominal robot misses them by \
             {} (median)",
            pairs.len(),
            mm(*missed_m)
        );
        let entry = self.entry(Join::Rows, pairs, Some(*missed_m));
        let unmeasured = found.unmeasured.clone();
        Ok(JoinedReadings { entry, readings: self.readings(pairs), unmeasured, notes: vec![note], warnings })
    }

    /// The warning of an error that is larger than usual and has an explanation.
    ///
    /// # Errors
    /// The error is larger than that of any robot, and has no explanation.
    pub(crate) fn refuse_doubtful(&self, missed_m: f64, pairs: &[RowPair], how: &str) -> Result<Option<String>> {
        let joined = || self.rows.session_of(pairs);
        match joined_rows::warning(self.robot, missed_m, joined, how) {
            Ok(warning) => {
                let files = format!("{}, {}", self.joints.path.display(), self.path.display());
                Ok(warning.map(|it| format!("{files}: {it}")))
            }
            Err(message) => self.refuse(message),
        }
    }

    /// The warning of pairs that fit far worse than the others, if there are a few.
    pub(crate) fn wrong_pairs(&self, pairs: &[RowPair]) -> Option<String> {
        let (mut wrong, usual_m) = self.rows.find_wrong_pairs(pairs);
        wrong.retain(|it| it.1 > LEAST_WRONG_M);
        if wrong.is_empty() || wrong.len() as f64 > SOME_WRONG * pairs.len() as f64 {
            return None;
        }
        let own: Vec<RowPair> = wrong.iter().filter_map(|it| pairs.get(it.0)).copied().collect();
        let farthest = wrong.iter().map(|it| it.1).fold(0.0, f64::max);
        let shots: Vec<usize> = own.iter().map(|it| it.1).collect();
        let joints: Vec<usize> = own.iter().map(|it| it.0).collect();
        Some(format!(
            "{}: {} fit{} the joint readings of {} far worse than others do theirs, the nominal robot misses {} by up to {}, the others by {} (median): \
             look at the name and the numbers",
            self.path.display(),
            self.shot_lines(&shots),
            if own.len() == 1 { "s" } else { "" },
            self.joint_lines(&joints),
            if own.len() == 1 { "it" } else { "them" },
            mm(farthest),
            mm(usual_m)
        ))
    }

    /// Rows of joint readings without a measurement.
    pub(crate) fn unmeasured_rows(&self, pairs: &[RowPair]) -> Vec<usize> {
        let joints: BTreeSet<usize> = pairs.iter().map(|it| it.0).collect();
        (0..self.rows.joint_rows()).filter(|it| !joints.contains(it)).collect()
    }

    /// Rows of joint readings at which a target was measured more than once.
    pub(crate) fn repeated_rows(&self, pairs: &[RowPair]) -> Vec<usize> {
        let (mut first, mut repeated) = (BTreeMap::new(), BTreeSet::new());
        for (joint, shot) in pairs {
            for &row in self.rows.shots().get(*shot).into_iter().flatten() {
                let Some(it) = self.data.observations.get(row as usize) else { continue };
                let what = it.measurement.function().leading_quantity().name();
                if first.entry((*joint, it.station, it.target, what)).or_insert(*shot) != shot {
                    repeated.insert(*joint);
                }
            }
        }
        repeated.into_iter().collect()
    }

    /// Messages on joint readings with several measurements, and on measurements without partner.
    pub(crate) fn without_partner(&self, pairs: &[RowPair]) -> Vec<String> {
        let repeated = self.repeated_rows(pairs);
        let shots: BTreeSet<usize> = pairs.iter().map(|it| it.1).collect();
        let unread = (0..self.rows.shots().len()).filter(|it| !shots.contains(it)).collect::<Vec<_>>();
        let mut said = Vec::new();
        if !repeated.is_empty() {
            said.push(self.describe_repeated(&repeated));
        }
        if !unread.is_empty() {
            said.push(self.left_out(&unread, ["has", "have"], "no joint readings"));
        }
        said
    }

    fn describe_repeated(&self, joints: &[usize]) -> String {
        format!("{}: more than once was measured at {}", self.joints.path.display(), self.joint_lines(joints))
    }

    fn left_out(&self, shots: &[usize], verbs: [&str; 2], what: &str) -> String {
        let verb = if shots.len() == 1 { verbs[0] } else { verbs[1] };
        format!("{}: left out {}, which {verb} {what}", self.path.display(), self.shot_lines(shots))
    }
}
