//! Choice of the topics of a bag to be read: the only possible ones, or those that the user asked for.

use super::super::bodies::which_move;
use super::super::made_table::MadeTable;
use super::super::recording::MissingTable;
use super::bodies::{TopicBodies, TopicBody};
use super::joints::TopicReadings;
use super::topics::{Topic, TopicContent, Topics};
use crate::ReadOptions;
use poecal_numerics::error::first_few;

/// Largest number of candidates in a message.
const NAMED: usize = 12;

/// The body that was measured.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredBody<'t> {
    topic: &'t Topic,
    bodies: &'t TopicBodies,
    pub(crate) body: &'t TopicBody,
    /// Other bodies, in words.
    left: Vec<String>,
}

impl MeasuredBody<'_> {
    /// Its table, with times since a whole second.
    pub(crate) fn table(&self, since_s: i64) -> MadeTable {
        let mut made = self.body.table(&self.topic.name, self.bodies.are_posed(), since_s);
        if !self.left.is_empty() {
            made.say(format!("left out {}", first_few(&self.left)));
        }
        made
    }
}

/// The reason why nothing is taken, as an error.
fn refuse_missing<T>(why: String) -> Result<T, MissingTable> {
    Err(MissingTable { why, is_nothing: false })
}

/// Some candidates, in words.
fn words<T>(some: &[T], of: impl Fn(&T) -> String) -> String {
    some.iter().take(NAMED).map(of).collect::<Vec<_>>().join(", ")
}

/// The candidate bodies in words, with the number of the others.
fn bodies(some: &[MeasuredBody<'_>]) -> String {
    let more = match some.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    words(some, |it| it.body.words(&it.topic.name)) + &more
}

/// The topics with content of a kind, each with its content; if the user asked for topics, only these. An error states that `what` is missing.
fn wanted_topics<'t, T>(
    topics: &'t Topics<'_>,
    options: &ReadOptions,
    what: &str,
    of: impl Fn(&'t TopicContent) -> Option<&'t T>,
) -> Result<Vec<(&'t Topic, &'t T)>, MissingTable> {
    let held = topics.all.iter().filter(|it| it.count > 0);
    let mut all: Vec<(&Topic, &T)> = held.filter_map(|it| Some((it, of(&it.content)?))).collect();
    if all.is_empty() {
        let why = format!(
            "found {what} in the bag, expected a topic of it, or another file that has it: it has {}",
            topics.words()
        );
        return Err(MissingTable { why, is_nothing: true });
    }
    let is_asked = |it: &(&Topic, &T)| options.topics.iter().any(|name| it.0.is_called(name));
    if all.iter().any(is_asked) {
        all.retain(is_asked);
    }
    Ok(all)
}

/// Refuses a topic with a message that cannot be read.
fn refuse_unreadable(topic: &Topic) -> Result<(), MissingTable> {
    let Some((number, found)) = &topic.broken else { return Ok(()) };
    refuse_missing(format!("message {number} of `{}`: found {found}, expected {}", topic.name, topic.title))
}

/// The joint readings.
pub(crate) fn joints<'t>(
    topics: &'t Topics<'_>,
    options: &ReadOptions,
) -> Result<(&'t Topic, &'t TopicReadings), MissingTable> {
    let what = "no joint readings (sensor_msgs/msg/JointState)";
    let all = wanted_topics(topics, options, what, TopicContent::readings)?;
    let having: Vec<_> = all.iter().filter(|it| it.1.held_count() > 0).copied().collect();
    match having.as_slice() {
        [one] => refuse_unreadable(one.0).map(|()| *one),
        [] => {
            all.iter().try_for_each(|it| refuse_unreadable(it.0))?;
            let words = |it: &(&Topic, &TopicReadings)| format!("`{}` with {}", it.0.name, it.1.describe_missing());
            let found: Vec<String> = all.iter().take(NAMED).map(words).collect();
            let expected = "the joints of the robot under their names in the model";
            refuse_missing(format!("found {}, expected {expected}", found.join("; ")))
        }
        several => refuse_missing(format!(
            "found {} topics with joint readings of the robot, {}, expected one: name it by --topic",
            several.len(),
            words(several, |it| it.0.words())
        )),
    }
}

/// The measured body.
pub(crate) fn find_measured<'t>(
    topics: &'t Topics<'_>,
    options: &ReadOptions,
) -> Result<MeasuredBody<'t>, MissingTable> {
    let what = "nothing measured (PoseStamped, PointStamped, TransformStamped or TFMessage)";
    let all = wanted_topics(topics, options, what, TopicContent::bodies)?;
    let own = |it: &(&'t Topic, &'t TopicBodies)| {
        let (topic, bodies) = *it;
        bodies.all.iter().map(move |body| MeasuredBody { topic, bodies, body, left: Vec::new() })
    };
    let found: Vec<MeasuredBody<'_>> = all.iter().flat_map(own).collect();
    let pool = narrow(&found, &all, options)?;
    let moved: Vec<f64> = pool.iter().map(|it| it.body.moved_m()).collect();
    let moving: Vec<MeasuredBody<'_>> =
        pool.iter().zip(which_move(&moved)).filter(|it| it.1).map(|it| it.0.clone()).collect();
    let one = match (moving.as_slice(), pool.as_slice()) {
        ([one], _) | ([], [one]) => one.clone(),
        ([], []) => {
            all.iter().try_for_each(|it| refuse_unreadable(it.0))?;
            return refuse_missing(format!("found no pose in {}, expected some", topics.words()));
        }
        ([], _) => {
            let found = bodies(&pool);
            return refuse_missing(format!("found {found} that all stand, expected one that moves with the robot"));
        }
        (several, _) => return refuse_several(several),
    };
    refuse_unreadable(one.topic)?;
    let is_other = |it: &&MeasuredBody<'_>| !std::ptr::eq(it.body, one.body);
    let left = found.iter().filter(is_other).map(|it| it.body.words(&it.topic.name)).collect();
    Ok(MeasuredBody { left, ..one })
}

/// Candidates among the measured bodies: the requested frame, or else bodies that are no frames of the robot itself.
fn narrow<'t>(
    found: &[MeasuredBody<'t>],
    all: &[(&Topic, &TopicBodies)],
    options: &ReadOptions,
) -> Result<Vec<MeasuredBody<'t>>, MissingTable> {
    let mut pool = found.to_vec();
    let has_names = found.iter().any(|it| !it.body.child.is_empty());
    if let Some(name) = options.body.as_ref().filter(|_| has_names) {
        pool.retain(|it| it.body.child == *name);
        if pool.is_empty() {
            return refuse_missing(format!("found no frame `{name}`, expected one of {}", bodies(found)));
        }
    } else if all.iter().any(|it| !it.1.are_frames()) {
        // Transforms are those of the robot's own links, too.
        pool.retain(|it| !it.bodies.are_frames());
    }
    Ok(pool)
}

/// Refuses several things that move.
fn refuse_several<T>(several: &[MeasuredBody<'_>]) -> Result<T, MissingTable> {
    let mut lists: Vec<&Topic> = several.iter().map(|it| it.topic).collect();
    lists.dedup_by(|one, other| std::ptr::eq(*one, *other));
    refuse_missing(match lists.as_slice() {
        [topic] => format!(
            "found {} frames that move in {}: {}, expected one: name the one on the robot by --body",
            several.len(),
            topic.words(),
            bodies(several)
        ),
        _ => format!(
            "found {} topics with poses of what moves, {}, expected one: name it by --topic",
            lists.len(),
            words(&lists, |it| it.words())
        ),
    })
}
