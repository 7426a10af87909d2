//! Which topics of a bag are read: the only ones that can be meant, or those that were asked for.

use super::super::super::ReadOptions;
use super::super::bodies::which_move;
use super::super::maker::Made;
use super::super::recording::Missing;
use super::bodies::{Bodies, Body};
use super::joints::Readings;
use super::topics::{Content, Topic, Topics};
use poecal_numerics::error::first_few;

/// Most candidates that are named.
const NAMED: usize = 12;

/// The body that was measured.
#[derive(Clone, Debug)]
pub(crate) struct Measured<'t> {
    topic: &'t Topic,
    is_posed: bool,
    pub(crate) body: &'t Body,
    /// Others, in words.
    left: Vec<String>,
}

impl Measured<'_> {
    /// Its table, with times since a whole second.
    pub(crate) fn table(&self, since_s: i64) -> Made {
        let mut made = self.body.table(&self.topic.name, self.is_posed, since_s);
        if !self.left.is_empty() {
            made.said.push(format!("left out {}", first_few(&self.left)));
        }
        made
    }
}

/// Why nothing is taken.
fn missing<T>(why: String) -> Result<T, Missing> {
    Err(Missing { why, is_nothing: false })
}

/// Why nothing is taken, since there is nothing.
fn nothing<T>(what: &str, topics: &Topics<'_>) -> Result<T, Missing> {
    let why = format!(
        "found {what} in the bag, expected a topic of it, or another file that has it: it has {}",
        topics.words()
    );
    Err(Missing { why, is_nothing: true })
}

/// Of topics those that were asked for, if some were.
fn wanted<'t, T>(all: Vec<(&'t Topic, T)>, options: &ReadOptions) -> Vec<(&'t Topic, T)> {
    let is_asked = |topic: &Topic| options.topics.iter().any(|name| topic.is_called(name));
    let some = all.iter().any(|it| is_asked(it.0));
    all.into_iter().filter(|it| !some || is_asked(it.0)).collect()
}

/// Refuses a topic with a message that cannot be read.
fn whole(topic: &Topic) -> Result<(), Missing> {
    let Some((number, found)) = &topic.broken else { return Ok(()) };
    missing(format!("message {number} of `{}`: found {found}, expected {}", topic.name, topic.title))
}

/// The joint readings.
pub(crate) fn joints<'t>(
    topics: &'t Topics<'_>,
    options: &ReadOptions,
) -> Result<(&'t Topic, &'t Readings), Missing> {
    let of = |topic: &'t Topic| {
        let Content::Joints(readings) = &topic.content else { return None };
        (topic.count > 0).then_some((topic, readings))
    };
    let all = wanted(topics.all.iter().filter_map(of).collect(), options);
    let having: Vec<_> = all.iter().filter(|it| it.1.is_whole()).copied().collect();
    match having.as_slice() {
        [one] => whole(one.0).map(|()| *one),
        [] if all.is_empty() => nothing("no joint readings (sensor_msgs/msg/JointState)", topics),
        [] => {
            all.iter().try_for_each(|it| whole(it.0))?;
            let words = |it: &(&Topic, &Readings)| format!("`{}` with {}", it.0.name, it.1.missing());
            let found: Vec<String> = all.iter().take(NAMED).map(words).collect();
            let expected = "the joints of the robot under their names in the model";
            missing(format!("found {}, expected {expected}", found.join("; ")))
        }
        several => {
            let words: Vec<String> = several.iter().take(NAMED).map(|it| it.0.words()).collect();
            missing(format!(
                "found {} topics with joint readings of the robot, {}, expected one: name it by --topic",
                several.len(),
                words.join(", ")
            ))
        }
    }
}

/// What was measured.
pub(crate) fn measured<'t>(topics: &'t Topics<'_>, options: &ReadOptions) -> Result<Measured<'t>, Missing> {
    let of = |topic: &'t Topic| {
        let Content::Bodies(bodies) = &topic.content else { return None };
        (topic.count > 0).then_some((topic, bodies))
    };
    let all: Vec<(&Topic, &Bodies)> = wanted(topics.all.iter().filter_map(of).collect(), options);
    if all.is_empty() {
        return nothing(
            "nothing measured (PoseStamped, PointStamped, TransformStamped or TFMessage)",
            topics,
        );
    }
    let own = |it: &(&'t Topic, &'t Bodies)| -> Vec<Measured<'t>> {
        let (topic, bodies) = *it;
        let is_posed = bodies.are_posed();
        bodies.all.iter().map(|body| Measured { topic, is_posed, body, left: Vec::new() }).collect()
    };
    let found: Vec<Measured<'_>> = all.iter().flat_map(own).collect();
    let pool = narrow(&found, &all, options)?;
    let moved: Vec<f64> = pool.iter().map(|it| it.body.moved_m()).collect();
    let moving: Vec<Measured<'_>> =
        pool.iter().zip(which_move(&moved)).filter(|it| it.1).map(|it| it.0.clone()).collect();
    let one = match (moving.as_slice(), pool.as_slice()) {
        ([one], _) | ([], [one]) => one.clone(),
        ([], []) => {
            all.iter().try_for_each(|it| whole(it.0))?;
            return missing(format!("found no pose in {}, expected some", topics.words()));
        }
        ([], _) => {
            return missing(format!(
                "found {} that all stand, expected one that moves with the robot",
                name_some(&pool)
            ));
        }
        (several, _) => return refuse_several(several),
    };
    whole(one.topic)?;
    let is_other = |it: &&Measured<'_>| !std::ptr::eq(it.body, one.body);
    let left = found.iter().filter(is_other).map(|it| it.body.words(&it.topic.name)).collect();
    Ok(Measured { left, ..one })
}

/// Some of what was measured, in words.
fn name_some(some: &[Measured<'_>]) -> String {
    let words: Vec<String> = some.iter().take(NAMED).map(|it| it.body.words(&it.topic.name)).collect();
    let more = some.len().saturating_sub(NAMED);
    format!("{}{}", words.join(", "), if more > 0 { format!(" and {more} more") } else { String::new() })
}

/// Of all that was measured what can be meant: the frame that was asked for, or what is no frame of the robot's own.
fn narrow<'t>(
    found: &[Measured<'t>],
    all: &[(&Topic, &Bodies)],
    options: &ReadOptions,
) -> Result<Vec<Measured<'t>>, Missing> {
    let mut pool = found.to_vec();
    let has_names = found.iter().any(|it| !it.body.child.is_empty());
    if let Some(name) = options.body.as_ref().filter(|_| has_names) {
        pool.retain(|it| it.body.child == *name);
        if pool.is_empty() {
            return missing(format!("found no frame `{name}`, expected one of {}", name_some(found)));
        }
    } else if all.iter().any(|it| !it.1.are_frames()) {
        // Transforms are those of the robot's own links, too.
        let is_frame =
            |it: &Measured<'_>| all.iter().any(|of| std::ptr::eq(of.0, it.topic) && of.1.are_frames());
        pool.retain(|it| !is_frame(it));
    }
    Ok(pool)
}

/// Refuses several things that move.
fn refuse_several<T>(several: &[Measured<'_>]) -> Result<T, Missing> {
    let mut lists: Vec<&Topic> = Vec::new();
    for it in several {
        if !lists.iter().any(|known| std::ptr::eq(*known, it.topic)) {
            lists.push(it.topic);
        }
    }
    if let [topic] = lists.as_slice() {
        return missing(format!(
            "found {} frames that move in {}: {}, expected one: name the one on the robot by --body",
            several.len(),
            topic.words(),
            name_some(several)
        ));
    }
    let words: Vec<String> = lists.iter().take(NAMED).map(|it| it.words()).collect();
    missing(format!(
        "found {} topics with poses of what moves, {}, expected one: name it by --topic",
        lists.len(),
        words.join(", ")
    ))
}
