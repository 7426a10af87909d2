//! Bodies that the messages of a topic say the poses of.

use std::collections::HashMap;

use super::super::bodies::moved_m;
use super::super::maker::{Made, Value};
use super::clock::{Clock, Stamp, seconds};
use super::messages::{Kind, Pose};

/// Where a body was at a time.
#[derive(Clone, Copy, Debug)]
struct Seen {
    stamp: Stamp,
    position: [f64; 3],
    quaternion: [f64; 4],
}

/// A body: a frame, or what a topic is about.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// The frame in which it is.
    pub(crate) parent: String,
    /// Its frame; empty if messages do not name it.
    pub(crate) child: String,
    seen: Vec<Seen>,
}

/// All bodies of a topic.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    kind: Kind,
    pub(crate) all: Vec<Body>,
    /// Places of bodies by their frames.
    places: HashMap<(String, String), usize>,
    /// Number of poses of all.
    pub(crate) held: usize,
}

impl Bodies {
    /// None, of messages of a kind.
    pub(crate) fn new(kind: Kind) -> Self {
        Bodies { kind, all: Vec::new(), places: HashMap::new(), held: 0 }
    }

    /// Whether these are transforms of any frames, such as the robot's own.
    pub(crate) fn are_frames(&self) -> bool {
        self.kind == Kind::Transforms
    }

    /// Whether they have orientations.
    pub(crate) fn are_posed(&self) -> bool {
        self.kind.is_posed()
    }

    /// Takes a pose.
    pub(crate) fn take(&mut self, pose: &Pose<'_>, log_ns: u64) {
        let frames = (pose.parent.to_owned(), pose.child.to_owned());
        let at = *self.places.entry(frames).or_insert_with_key(|(parent, child)| {
            let (parent, child) = (parent.clone(), child.clone());
            self.all.push(Body { parent, child, seen: Vec::new() });
            self.all.len() - 1
        });
        self.held += 1;
        if let Some(body) = self.all.get_mut(at) {
            body.take(pose, log_ns);
        }
    }
}

impl Body {
    fn take(&mut self, pose: &Pose<'_>, log_ns: u64) {
        let Pose { stamp_ns, position, quaternion, .. } = *pose;
        self.seen.push(Seen { stamp: Stamp { own: stamp_ns, log: log_ns }, position, quaternion });
    }

    /// How far it moved, metres.
    pub(crate) fn moved_m(&self) -> f64 {
        moved_m(&self.seen.iter().filter(|it| it.is_place()).map(|it| it.position).collect::<Vec<_>>())
    }

    /// The clock of its messages.
    fn clock(&self) -> Clock {
        Clock::of(self.seen.iter().map(|it| it.stamp))
    }

    /// The first time, nanoseconds.
    pub(crate) fn first_ns(&self) -> Option<i64> {
        let clock = self.clock();
        self.seen.iter().filter_map(|it| clock.time_ns(it.stamp)).min()
    }

    /// Its name in messages.
    pub(crate) fn words(&self, topic: &str) -> String {
        if self.child.is_empty() { format!("`{topic}`") } else { format!("`{}` of `{topic}`", self.child) }
    }

    /// Its table, with or without orientations, and with times since a whole second.
    pub(crate) fn table(&self, topic: &str, is_posed: bool, since_s: i64) -> Made {
        const COLUMNS: [&str; 8] = ["time[s]", "x[m]", "y[m]", "z[m]", "qx", "qy", "qz", "qw"];
        let clock = self.clock();
        let mut rows: Vec<(i64, usize, &Seen)> = (1..)
            .zip(&self.seen)
            .filter_map(|(number, it)| Some((clock.time_ns(it.stamp)?, number, it)))
            .collect();
        rows.sort_by_key(|it| it.0);
        let mut made = Made::new(1, COLUMNS.into_iter().take(if is_posed { 8 } else { 4 }));
        for (time_ns, number, seen) in rows {
            let is_seen = seen.is_place() && (!is_posed || seen.is_turned());
            let quaternion = seen.quaternion.iter().filter(|_| is_posed);
            let numbers = seen.position.iter().chain(quaternion);
            let cells = numbers.map(|it| if is_seen { Value::Number(*it) } else { Value::Empty });
            made.row(number, [Value::Number(seconds(time_ns, since_s))].into_iter().chain(cells));
        }
        let parts = ["stamp", "position.x", "position.y", "position.z"].into_iter();
        let parts = parts.chain(["orientation.x", "orientation.y", "orientation.z", "orientation.w"]);
        made.sources = (COLUMNS.into_iter().zip(parts))
            .map(|(column, part)| (column.to_owned(), format!("{part} of {}", self.words(topic))))
            .collect();
        let what = if is_posed { "poses" } else { "points" };
        made.said.push(format!(
            "{} {what} of {} in the frame `{}`, m; lines are its messages",
            made.rows(),
            self.words(topic),
            self.parent
        ));
        made.warned.extend(clock.warning(topic));
        made
    }
}

impl Seen {
    /// Whether it says where something is.
    fn is_place(&self) -> bool {
        self.position.iter().all(|it| it.is_finite()) && self.position != [0.0; 3]
    }

    /// Whether it says how something is turned.
    fn is_turned(&self) -> bool {
        self.quaternion.iter().all(|it| it.is_finite()) && self.quaternion != [0.0; 4]
    }
}
