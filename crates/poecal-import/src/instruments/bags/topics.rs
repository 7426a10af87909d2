//! Topics of a bag: their types, their numbers of messages, and the contents of those that are read.

use std::collections::HashMap;

use super::bodies::TopicBodies;
use super::joints::TopicReadings;
use super::messages::{MessageKind, joint_state, poses};
use poecal_numerics::error::shorten_name;
use poecal_storage::containers::mcap::RecordSink;
use poecal_storage::containers::unpack;
use poecal_storage::limits::ResourceLimit;

/// Largest number of topics in a list.
const LISTED: usize = 30;

/// Contents of the messages of a topic, as far as they are read.
#[derive(Clone, Debug, Default)]
pub(crate) enum TopicContent {
    Joints(TopicReadings),
    Bodies(TopicBodies),
    /// Messages of another type.
    #[default]
    Other,
}

impl TopicContent {
    pub(crate) fn readings(&self) -> Option<&TopicReadings> {
        if let TopicContent::Joints(readings) = self { Some(readings) } else { None }
    }

    pub(crate) fn bodies(&self) -> Option<&TopicBodies> {
        if let TopicContent::Bodies(bodies) = self { Some(bodies) } else { None }
    }

    /// Number of readings or poses that are held.
    fn held_count(&self) -> usize {
        self.readings().map_or(0, TopicReadings::held_count) + self.bodies().map_or(0, |it| it.held)
    }
}

/// A topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct Topic {
    pub(crate) name: String,
    /// Name of the type of its messages, with their encoding if that is not CDR.
    pub(crate) title: String,
    pub(crate) count: u64,
    /// Times of its first and last message in the log, nanoseconds.
    span_ns: (u64, u64),
    pub(crate) content: TopicContent,
    /// The first message that cannot be read: its number and what was found.
    pub(crate) broken: Option<(u64, String)>,
}

impl Topic {
    /// Messages a second.
    fn rate(&self) -> Option<f64> {
        let span_s = self.span_ns.1.saturating_sub(self.span_ns.0) as f64 / 1e9;
        (self.count > 1 && span_s > 0.0).then(|| (self.count - 1) as f64 / span_s)
    }

    /// The topic in words.
    pub(crate) fn words(&self) -> String {
        let messages = if self.count == 1 { "message" } else { "messages" };
        let rate = self.rate().map_or(String::new(), |rate| format!(", {rate:.1} Hz"));
        format!("`{}` ({}, {} {messages}{rate})", shorten_name(&self.name), shorten_name(&self.title), self.count)
    }

    /// True if this is its name, with or without the leading slash.
    pub(crate) fn is_called(&self, name: &str) -> bool {
        self.name == name || self.name.strip_prefix('/') == Some(name)
    }

    /// True if it has messages of a type that is read.
    pub(crate) fn is_read(&self) -> bool {
        self.count > 0 && !matches!(self.content, TopicContent::Other)
    }

    /// True if its messages name the bodies that they are about.
    pub(crate) fn names_bodies(&self) -> bool {
        self.content.bodies().is_some_and(|it| it.all.iter().any(|it| !it.child.is_empty()))
    }

    /// Takes a message.
    fn take(&mut self, log_ns: u64, message: &[u8]) {
        self.span_ns = match self.count {
            0 => (log_ns, log_ns),
            _ => (self.span_ns.0.min(log_ns), self.span_ns.1.max(log_ns)),
        };
        self.count += 1;
        let taken = match &mut self.content {
            _ if self.broken.is_some() => return,
            TopicContent::Joints(readings) => joint_state(message).map(|it| readings.take(&it, log_ns)),
            TopicContent::Bodies(bodies) => {
                poses(bodies.kind, message).map(|all| all.iter().for_each(|it| bodies.take(it, log_ns)))
            }
            TopicContent::Other => Ok(()),
        };
        if let Err(found) = taken {
            self.broken = Some((self.count, found));
        }
    }
}

/// All topics of a bag.
#[derive(Debug, Default)]
pub(crate) struct Topics<'a> {
    /// Names of the robot's joints.
    joints: &'a [String],
    /// Names of the types in the present file.
    schemas: HashMap<u16, String>,
    /// Topics of the channels of the present file.
    channels: HashMap<u16, usize>,
    pub(crate) all: Vec<Topic>,
    /// Indices of topics by name and title.
    places: HashMap<(String, String), usize>,
    /// The limit that is exceeded, in a sentence: nothing is taken from then on.
    pub(crate) refused: Option<String>,
    /// First and last time in the log, nanoseconds.
    pub(crate) span_ns: Option<(u64, u64)>,
    /// Number of readings and poses that are held.
    held: usize,
    /// Bytes of the messages that were unpacked one by one.
    unpacked: u64,
    /// Number of damaged compressed messages of a file, and the finding at the first one.
    pub(crate) damaged: Option<(u64, String)>,
    /// Number of messages of channels that are not described.
    pub(crate) unknown: u64,
}

impl<'a> Topics<'a> {
    /// No topics yet, for a robot with these joints.
    pub(crate) fn new(joints: &'a [String]) -> Self {
        Topics { joints, ..Topics::default() }
    }

    /// Begins another file, which has numbers of its own.
    pub(crate) fn begin_file(&mut self) {
        self.schemas.clear();
        self.channels.clear();
    }

    /// Seconds of a time in the log since the first message.
    pub(crate) fn since_first_s(&self, log_ns: u64) -> f64 {
        log_ns.saturating_sub(self.span_ns.map_or(0, |it| it.0)) as f64 / 1e9
    }

    /// All topics in words.
    pub(crate) fn words(&self) -> String {
        let words: Vec<String> = self.all.iter().take(LISTED).map(Topic::words).collect();
        match self.all.len().saturating_sub(LISTED) {
            _ if words.is_empty() => "no topic".to_owned(),
            0 => words.join(", "),
            more => format!("{} and {more} more", words.join(", ")),
        }
    }
}

impl RecordSink for Topics<'_> {
    fn schema(&mut self, id: u16, name: &str) {
        self.schemas.insert(id, name.to_owned());
    }

    fn channel(&mut self, id: u16, schema: u16, name: &str, encoding: &str) {
        let of = self.schemas.get(&schema).map_or("no type", String::as_str);
        let is_cdr = encoding == "cdr";
        let title = if is_cdr { of.to_owned() } else { format!("{of} in {encoding}") };
        let key = (name.to_owned(), title.clone());
        let known = self.places.get(&key).copied();
        if known.is_none() && self.all.len() >= ResourceLimit::Topics.most_held() {
            self.refused = Some(ResourceLimit::Topics.exceeded_error("a bag"));
            return;
        }
        let at = known.unwrap_or_else(|| {
            self.places.insert(key, self.all.len());
            let content = match MessageKind::from_type_name(of).filter(|_| is_cdr) {
                Some(MessageKind::Joints) => TopicContent::Joints(TopicReadings::new(self.joints)),
                Some(kind) => TopicContent::Bodies(TopicBodies::new(kind)),
                None => TopicContent::Other,
            };
            self.all.push(Topic { name: name.to_owned(), title, content, ..Topic::default() });
            self.all.len() - 1
        });
        self.channels.insert(id, at);
    }

    fn message(&mut self, channel: u16, log_ns: u64, message: &[u8]) {
        let (first, last) = self.span_ns.unwrap_or((log_ns, log_ns));
        self.span_ns = Some((first.min(log_ns), last.max(log_ns)));
        match self.channels.get(&channel).and_then(|at| self.all.get_mut(*at)) {
            Some(topic) => {
                let before = topic.content.held_count();
                let mut whole = Vec::new();
                // Compressed by rosbag2 one by one.
                if message.starts_with(unpack::ZSTD) && !matches!(topic.content, TopicContent::Other) {
                    let left = ResourceLimit::Bag.value().saturating_sub(self.unpacked);
                    let most = left.min(ResourceLimit::Chunk.value().saturating_add(1));
                    match unpack::message(message, most, &mut whole) {
                        _ if whole.len() as u64 > ResourceLimit::Chunk.value() => {
                            self.refused = Some(ResourceLimit::Chunk.exceeded_error("a message of a bag"));
                        }
                        Ok(()) => topic.take(log_ns, &whole),
                        Err(found) => self.damaged.get_or_insert((0, found)).0 += 1,
                    }
                    self.unpacked += whole.len() as u64;
                    if whole.len() as u64 >= left {
                        self.refused = Some(ResourceLimit::Bag.exceeded_error("the messages of a bag"));
                    }
                } else {
                    topic.take(log_ns, message);
                }
                self.held += topic.content.held_count() - before;
                if topic.content.bodies().map_or(0, |it| it.all.len()) > ResourceLimit::Topics.most_held() {
                    self.refused = Some(ResourceLimit::Topics.exceeded_error("one topic"));
                } else if self.held > ResourceLimit::Poses.most_held() {
                    self.refused = Some(ResourceLimit::Poses.exceeded_error("the messages of a bag"));
                }
            }
            None => self.unknown += 1,
        }
    }

    fn is_full(&self) -> bool {
        self.refused.is_some()
    }
}
