//! Joint readings of a topic.

use super::super::maker::{Made, Value};
use super::clock::{Clock, Stamp, seconds};
use super::messages::JointState;
use poecal_numerics::error::first_few;

/// Most names that are kept for messages to the user.
const NAMES_KEPT: usize = 100;

/// The readings of a robot's joints in the messages of a topic.
#[derive(Clone, Debug)]
pub(crate) struct Readings {
    joints: Vec<String>,
    /// Time and number of each message that has all joints.
    rows: Vec<(Stamp, usize)>,
    /// Their readings, one message after the other.
    values: Vec<f64>,
    messages: usize,
    /// Number of messages with readings that are no numbers.
    infinite: usize,
    /// Names of joints in the messages.
    names: Vec<String>,
}

impl Readings {
    /// None, of these joints.
    pub(crate) fn new(joints: &[String]) -> Self {
        Readings {
            joints: joints.to_vec(),
            rows: Vec::new(),
            values: Vec::new(),
            messages: 0,
            infinite: 0,
            names: Vec::new(),
        }
    }

    /// Takes a message; one that lacks a joint has readings of others alone.
    pub(crate) fn take(&mut self, message: &JointState<'_>, log_ns: u64) {
        self.messages += 1;
        let before = self.values.len();
        for joint in &self.joints {
            let at = message.names.iter().position(|it| it == joint);
            self.values.extend(at.and_then(|at| message.positions.get(at)));
        }
        let own = self.values.get(before..).unwrap_or_default();
        let is_whole = own.len() == self.joints.len();
        let is_finite = own.iter().all(|it| it.is_finite());
        if is_whole && is_finite {
            self.rows.push((Stamp { own: message.stamp_ns, log: log_ns }, self.messages));
            if self.rows.len() > 1 {
                return;
            }
        } else {
            self.values.truncate(before);
            self.infinite += usize::from(is_whole);
        }
        for name in &message.names {
            if self.names.len() < NAMES_KEPT && !self.names.iter().any(|it| it == name) {
                self.names.push((*name).to_owned());
            }
        }
    }

    /// Number of readings that are held.
    pub(crate) fn held(&self) -> usize {
        self.rows.len()
    }

    /// Whether some message has all joints.
    pub(crate) fn is_whole(&self) -> bool {
        !self.rows.is_empty()
    }

    /// What is missing, in words.
    pub(crate) fn missing(&self) -> String {
        let missing: Vec<String> =
            self.joints.iter().filter(|it| !self.names.contains(it)).map(|it| format!("`{it}`")).collect();
        let names: Vec<String> = self.names.iter().map(|it| format!("`{it}`")).collect();
        match (missing.is_empty(), names.is_empty()) {
            (_, true) => "messages without joints".to_owned(),
            (true, _) if self.infinite > 0 => "readings that are no numbers".to_owned(),
            (true, _) => "no message with all joints of the robot at once".to_owned(),
            (false, false) => {
                format!("the joints {}, and not {}", first_few(&names), first_few(&missing))
            }
        }
    }

    /// The clock of the messages.
    pub(crate) fn clock(&self) -> Clock {
        Clock::of(self.rows.iter().map(|it| it.0))
    }

    /// The first time, nanoseconds.
    pub(crate) fn first_ns(&self) -> Option<i64> {
        let clock = self.clock();
        self.rows.iter().filter_map(|it| clock.time_ns(it.0)).min()
    }

    /// The table with these columns, and times since a whole second.
    pub(crate) fn table(&self, topic: &str, columns: &[String], since_s: i64) -> Made {
        let clock = self.clock();
        let width = self.joints.len().max(1);
        let mut rows: Vec<(i64, usize, &[f64])> = (self.rows.iter().zip(self.values.chunks(width)))
            .filter_map(|((stamp, number), values)| Some((clock.time_ns(*stamp)?, *number, values)))
            .collect();
        rows.sort_by_key(|it| it.0);
        let mut made = Made::new(1, ["time[s]"].into_iter().chain(columns.iter().map(String::as_str)));
        for (time_ns, number, values) in rows {
            let time = Value::Number(seconds(time_ns, since_s));
            made.row(number, [time].into_iter().chain(values.iter().copied().map(Value::Number)));
        }
        made.sources = (columns.iter().zip(&self.joints))
            .map(|(column, joint)| (column.clone(), format!("position of `{joint}` in {topic}")))
            .collect();
        made.said
            .push(format!("{} joint readings of `{topic}`, rad and m; lines are its messages", made.rows()));
        let others = self.messages - self.rows.len() - self.infinite;
        if others > 0 {
            made.said.push(format!("left out {others} messages of other joints"));
        }
        if self.infinite > 0 {
            let count = self.infinite;
            made.warned
                .push(format!("`{topic}`: left out {count} messages with readings that are no numbers"));
        }
        made.warned.extend(clock.warning(topic));
        made
    }
}
