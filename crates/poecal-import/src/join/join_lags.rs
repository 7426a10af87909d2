//! Static intervals of two recordings with clocks of their own, and the lag at which they are the same.

use super::join_pairs::{JoinedReadings, Pairing};
use super::join_words::{mm, several_lags};
use crate::Join;
use poecal_fit::input_doubts::joined_rows::{is_doubtful, reason};
use poecal_fit::start::{EVIDENT, FEWEST_PAIRS, LaggedPairs, MotionRecording};
use poecal_numerics::error::Result;

/// Largest error of a lag that was found by static intervals, seconds.
const NEAR_STANDS_S: f64 = 0.3;

impl Pairing<'_> {
    /// The join at the best of the lags at which static intervals of two streams agree, of which there are `joints` and `shots`.
    pub(crate) fn by_lag(&self, found: &[LaggedPairs], (joints, shots): (usize, usize)) -> Result<JoinedReadings> {
        let stated = if self.lag.is_some() { " near the stated one" } else { "" };
        let Some(best) = found.first() else {
            return self.refuse(format!(
                "found {joints} stands of the robot and {shots} of the measurements, and no lag of the clocks{stated} at which {FEWEST_PAIRS} of them or more are the same, expected a recording of the same motion"
            ));
        };
        let alike: Vec<&LaggedPairs> = found.iter().filter(|it| it.missed_m < EVIDENT * best.missed_m).collect();
        // The lag at which most static intervals agree explains why none fits.
        let most = found.iter().max_by_key(|it| it.pairs.len()).unwrap_or(best);
        let is_one = alike.len() == 1 && 2 * most.pairs.len() <= 3 * best.pairs.len();
        if is_doubtful(self.robot, best.missed_m) && !is_one {
            return self.refuse(format!(
                "found measurements that fit the joint readings at no lag of the clocks{stated}: the nominal robot misses them by {} (median) or more, and by {} at {:.2} s, where {} stands are the same, expected recordings of the same motion of the same robot: {}",
                mm(best.missed_m),
                mm(most.missed_m),
                most.lag_s,
                most.pairs.len(),
                reason(self.robot, &self.rows.session_of(&most.pairs))
            ));
        }
        if alike.len() > 1 {
            let listed: Vec<String> =
                alike.iter().map(|it| format!("{:.2} s ({})", it.lag_s, mm(it.missed_m))).collect();
            return self.refuse(several_lags(&listed, best.lag_s));
        }
        let mut joined = self.judge_order(&best.pairs, Join::Time, self.lag.is_some())?;
        let between = self.lag_between(best.lag_s);
        joined.entry.lag_s = between.or(Some(best.lag_s));
        joined.notes.push(format!(
            "{}: {} stands of {} and of {} are the same, at a lag of {} s of its clock",
            self.path.display(),
            best.pairs.len(),
            joints,
            shots,
            between.map_or_else(|| format!("{:.3}", best.lag_s), |it| format!("{it:.4}"))
        ));
        Ok(joined)
    }

    /// The lag near that of the static intervals at which the measurements between them fit too, seconds; the static intervals alone do not need
    /// it.
    fn lag_between(&self, near_s: f64) -> Option<f64> {
        let (joints, (data, times)) = (self.joints.stream.as_ref()?, self.stream?);
        let motion = MotionRecording::new(self.robot, joints, data, times).ok()?;
        motion.find_lag(Some((near_s, NEAR_STANDS_S))).ok().map(|it| it.clock.lag_s)
    }
}
