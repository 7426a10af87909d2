//! Joint readings of a topic.

use super::super::made_table::{CellValue, MadeTable, TableColumn};
use super::super::words::quote_names;
use super::clock::{MessageTime, TimedMessages};
use super::messages::JointState;

/// Largest number of names that are kept for messages to the user.
const NAMES_KEPT: usize = 100;

/// The readings of a robot's joints in the messages of a topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct TopicReadings {
    joints: Vec<String>,
    /// The number of each message that has all joints.
    rows: TimedMessages<usize>,
    /// Their readings, one message after the other.
    values: Vec<f64>,
    messages: usize,
    /// Number of messages with readings that are no numbers.
    infinite: usize,
    /// Names of joints in the messages.
    names: Vec<String>,
}

impl TopicReadings {
    /// No readings yet, of these joints.
    pub(crate) fn new(joints: &[String]) -> Self {
        TopicReadings { joints: joints.to_vec(), ..TopicReadings::default() }
    }

    /// Takes a message; a message that lacks a joint holds readings of other joints only.
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
            self.rows.0.push((MessageTime { own: message.stamp_ns, log: log_ns }, self.messages));
            if self.held_count() > 1 {
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
    pub(crate) fn held_count(&self) -> usize {
        self.rows.0.len()
    }

    /// The missing joints, in words.
    pub(crate) fn describe_missing(&self) -> String {
        let missing = quote_names(self.joints.iter().filter(|it| !self.names.contains(it)));
        match (missing.is_empty(), self.names.is_empty()) {
            (_, true) => "messages without joints".to_owned(),
            (true, _) if self.infinite > 0 => "readings that are no numbers".to_owned(),
            (true, _) => "no message with all joints of the robot at once".to_owned(),
            (false, false) => format!("the joints {}, and not {missing}", quote_names(&self.names)),
        }
    }

    /// The first time, nanoseconds.
    pub(crate) fn first_ns(&self) -> Option<i64> {
        self.rows.first_ns()
    }

    /// The table with these columns, and times since a whole second.
    pub(crate) fn table(&self, topic: &str, columns: impl Iterator<Item = TableColumn>, since_s: i64) -> MadeTable {
        let columns = columns.zip(&self.joints);
        let columns = columns.map(|(column, joint)| column.made_of(|_| format!("position of `{joint}` in {topic}")));
        let mut made = MadeTable::new(1, std::iter::once(TableColumn::from("time").in_unit("s")).chain(columns));
        let width = self.joints.len();
        for (time, at, number) in self.rows.sorted(since_s) {
            let values = self.values.get(at * width..(at + 1) * width).unwrap_or_default();
            made.row(*number, std::iter::once(&time).chain(values).copied().map(CellValue::Number));
        }
        made.say(format!("{} joint readings of `{topic}`, rad and m; lines are its messages", made.rows()));
        let others = self.messages - self.held_count() - self.infinite;
        if others > 0 {
            made.say(format!("left out {others} messages of other joints"));
        }
        if self.infinite > 0 {
            let count = self.infinite;
            made.warn(format!("`{topic}`: left out {count} messages with readings that are no numbers"));
        }
        made.warned.extend(self.rows.clock().warning(topic));
        made
    }
}
