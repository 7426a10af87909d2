//! Times of messages: those that they state, or those of the log.

/// Nanoseconds of a second.
pub(crate) const SECOND: i64 = 1_000_000_000;

/// When a message was made, nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stamp {
    /// By the message; 0 if it was not set.
    pub(crate) own: i64,
    /// When it was written to the bag.
    pub(crate) log: u64,
}

/// The clock of some messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    is_log: bool,
    /// Number of messages without a time of their own.
    unset: usize,
}

impl Clock {
    /// The clock of messages: that of the log where most of them have no time of their own.
    pub(crate) fn of(stamps: impl Iterator<Item = Stamp>) -> Self {
        let (mut all, mut unset) = (0, 0);
        for stamp in stamps {
            all += 1;
            unset += usize::from(stamp.own == 0);
        }
        Clock { is_log: 2 * unset > all, unset }
    }

    /// The time of a message, nanoseconds; `None` if it has none.
    pub(crate) fn time_ns(self, stamp: Stamp) -> Option<i64> {
        if self.is_log { i64::try_from(stamp.log).ok() } else { Some(stamp.own).filter(|it| *it != 0) }
    }

    /// The warning of messages without times of their own.
    pub(crate) fn warning(self, topic: &str) -> Option<String> {
        let Clock { is_log, unset } = self;
        (unset > 0).then(|| {
            if is_log {
                format!("`{topic}`: took the times of the log, since the stamps of {unset} messages are zero: these are later than what they say by an unknown delay")
            } else {
                format!("`{topic}`: left out {unset} messages with the stamp zero")
            }
        })
    }
}

/// Seconds of a time since one in whole seconds.
pub(crate) fn seconds(time_ns: i64, since_s: i64) -> f64 {
    time_ns.saturating_sub(since_s.saturating_mul(SECOND)) as f64 / 1e9
}
