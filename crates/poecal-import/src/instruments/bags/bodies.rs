//! Bodies whose poses are in the messages of a topic.

use std::collections::HashMap;

use super::super::bodies::moved_m;
use super::super::made_table::{CellValue, MadeTable, TableColumn, place, quaternion};
use super::clock::{MessageTime, TimedMessages};
use super::messages::{MessageKind, PoseField};

/// Observed position of a body.
#[derive(Clone, Copy, Debug, Default)]
struct ObservedBody {
    position: [f64; 3],
    quaternion: [f64; 4],
}

/// A body: a frame, or the subject of a topic.
#[derive(Clone, Debug)]
pub(crate) struct TopicBody {
    /// The frame in which its poses are expressed.
    parent: String,
    /// Its frame; empty if messages do not name it.
    pub(crate) child: String,
    seen: TimedMessages<ObservedBody>,
}

/// All bodies of a topic.
#[derive(Clone, Debug)]
pub(crate) struct TopicBodies {
    pub(crate) kind: MessageKind,
    pub(crate) all: Vec<TopicBody>,
    /// Indices of bodies by their frames.
    places: HashMap<(String, String), usize>,
    /// Number of poses of all bodies.
    pub(crate) held: usize,
}

impl TopicBodies {
    /// No bodies yet, for messages of this kind.
    pub(crate) fn new(kind: MessageKind) -> Self {
        TopicBodies { kind, all: Vec::new(), places: HashMap::new(), held: 0 }
    }

    /// True if these are transforms of any frames, such as the robot's own.
    pub(crate) fn are_frames(&self) -> bool {
        self.kind == MessageKind::Transforms
    }

    /// True if they have orientations.
    pub(crate) fn are_posed(&self) -> bool {
        self.kind.is_posed()
    }

    /// Takes a pose.
    pub(crate) fn take(&mut self, pose: &PoseField<'_>, log_ns: u64) {
        let PoseField { stamp_ns, position, quaternion, .. } = *pose;
        let frames = (pose.parent.to_owned(), pose.child.to_owned());
        let at = *self.places.entry(frames).or_insert_with_key(|(parent, child)| {
            let (parent, child) = (parent.clone(), child.clone());
            self.all.push(TopicBody { parent, child, seen: TimedMessages::default() });
            self.all.len() - 1
        });
        self.held += 1;
        if let Some(body) = self.all.get_mut(at) {
            body.seen.0.push((MessageTime { own: stamp_ns, log: log_ns }, ObservedBody { position, quaternion }));
        }
    }
}

/// True if these numbers were set: all are finite, and not all are zero.
fn is_stated(numbers: &[f64]) -> bool {
    numbers.iter().all(|it| it.is_finite()) && numbers.iter().any(|it| *it != 0.0)
}

impl TopicBody {
    /// Distance that it moved, metres.
    pub(crate) fn moved_m(&self) -> f64 {
        let positions = self.seen.0.iter().map(|it| it.1.position);
        moved_m(&positions.filter(|it| is_stated(it)).collect::<Vec<_>>())
    }

    /// The first time, nanoseconds.
    pub(crate) fn first_ns(&self) -> Option<i64> {
        self.seen.first_ns()
    }

    /// Its name in messages.
    pub(crate) fn words(&self, topic: &str) -> String {
        if self.child.is_empty() { format!("`{topic}`") } else { format!("`{}` of `{topic}`", self.child) }
    }

    /// Its table, with or without orientations, and with times since a whole second.
    pub(crate) fn table(&self, topic: &str, is_posed: bool, since_s: i64) -> MadeTable {
        let words = self.words(topic);
        let time = TableColumn::from("time").in_unit("s").made_of(|_| format!("stamp of {words}"));
        let position = place("m").map(|it| it.made_of(|name| format!("position.{name} of {words}")));
        let part = |name: &str| format!("orientation.{} of {words}", name.trim_start_matches('q'));
        let turned = quaternion().map(|it| it.made_of(part));
        let columns = std::iter::once(time).chain(position).chain(turned.filter(|_| is_posed));
        let mut made = MadeTable::new(1, columns);
        for (time, at, ObservedBody { position, quaternion }) in self.seen.sorted(since_s) {
            let is_seen = is_stated(position) && (!is_posed || is_stated(quaternion));
            let numbers = position.iter().chain(quaternion.iter().filter(|_| is_posed));
            let cells = numbers.map(|it| if is_seen { CellValue::Number(*it) } else { CellValue::Empty });
            made.row(at + 1, std::iter::once(CellValue::Number(time)).chain(cells));
        }
        let what = if is_posed { "poses" } else { "points" };
        made.say(format!(
            "{} {what} of {words} in the frame `{}`, m; lines are its messages",
            made.rows(),
            self.parent
        ));
        made.warned.extend(self.seen.clock().warning(topic));
        made
    }
}
