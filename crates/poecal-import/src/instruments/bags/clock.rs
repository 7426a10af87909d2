//! Times of messages: those that they state, or those of the log.

/// Nanoseconds of a second.
pub(crate) const SECOND: i64 = 1_000_000_000;

/// Time of a message, nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MessageTime {
    /// Time in the message; 0 if it was not set.
    pub(crate) own: i64,
    /// Time of its entry in the bag.
    pub(crate) log: u64,
}

/// Contents of messages, each with its time.
#[derive(Clone, Debug, Default)]
pub(crate) struct TimedMessages<T>(pub(crate) Vec<(MessageTime, T)>);

impl<T> TimedMessages<T> {
    /// The clock of the messages: that of the log if most of them have no time of their own.
    pub(crate) fn clock(&self) -> MessageClock {
        let unset = self.0.iter().filter(|it| it.0.own == 0).count();
        MessageClock { is_log: 2 * unset > self.0.len(), unset }
    }

    /// The times of the messages that have one, nanoseconds.
    fn times(&self) -> impl Iterator<Item = (i64, usize, &T)> {
        let clock = self.clock();
        let all = self.0.iter().enumerate();
        all.filter_map(move |(at, (stamp, it))| Some((clock.time_ns(*stamp)?, at, it)))
    }

    /// The first time, nanoseconds.
    pub(crate) fn first_ns(&self) -> Option<i64> {
        self.times().map(|it| it.0).min()
    }

    /// The messages in the order of their times, in seconds since a whole second, each with its index among all.
    pub(crate) fn sorted(&self, since_s: i64) -> Vec<(f64, usize, &T)> {
        let mut all: Vec<(i64, usize, &T)> = self.times().collect();
        all.sort_by_key(|it| it.0);
        let since_ns = since_s.saturating_mul(SECOND);
        all.into_iter().map(|(ns, at, it)| (ns.saturating_sub(since_ns) as f64 / 1e9, at, it)).collect()
    }
}

/// The clock of some messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MessageClock {
    is_log: bool,
    /// Number of messages without a time of their own.
    unset: usize,
}

impl MessageClock {
    /// The time of a message, nanoseconds; `None` if it has none.
    fn time_ns(self, stamp: MessageTime) -> Option<i64> {
        if self.is_log { i64::try_from(stamp.log).ok() } else { Some(stamp.own).filter(|it| *it != 0) }
    }

    /// The warning of messages without times of their own.
    pub(crate) fn warning(self, topic: &str) -> Option<String> {
        let MessageClock { is_log, unset } = self;
        let words = if is_log {
            format!(
                "took the times of the log, since the stamps of {unset} messages are zero: these are later than the measurements by an unknown delay"
            )
        } else {
            format!("left out {unset} messages with the stamp zero")
        };
        (unset > 0).then(|| format!("`{topic}`: {words}"))
    }
}
