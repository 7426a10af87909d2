//! Bags of ROS 2 in MCAP: joint readings and what was measured, by the times that messages state.

mod bodies;
mod cdr;
mod choice;
mod clock;
mod container;
mod joints;
mod messages;
mod parts;
#[cfg(test)]
mod tests;
mod topics;
mod unpack;

use std::io;
use std::path::{Path, PathBuf};

use self::clock::SECOND;
use self::container::Damage;
use self::topics::{Topic, Topics};
use super::recording::{OwnTable, Recording};
use super::{BAG, Opening};
use crate::GivenBag;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::disk::is_file;
use poecal_storage::hashes::Hashing;
use poecal_storage::limits::{Limit, amount};
use poecal_storage::source;

pub(crate) use self::parts::is_bag;

const EXPECTED: &str = "a ROS 2 bag (MCAP)";

/// Reads a bag.
pub(crate) fn read(path: &Path, opening: &Opening<'_>) -> Result<Recording> {
    let joints = opening.robot.joint_reading_names();
    let mut topics = Topics::new(&joints);
    let (parts, left) = parts::of(path)?;
    let mut warned: Vec<String> = left.iter().map(ToString::to_string).collect();
    let mut hashing = Hashing::new(Box::new(io::empty()) as Box<dyn io::Read>);
    let mut unpacked = 0_u64;
    for part in &parts {
        // What can be read once is held.
        let (mut input, _) = match is_file(part) {
            true => source::open_streamed(part, EXPECTED, Limit::Bag)?,
            false => source::open_any(part, EXPECTED, Limit::Bag)?,
        };
        let stated = container::stated_size(&mut input);
        let stated = stated.map_err(|error| source::unreadable(part, &error, EXPECTED))?;
        unpacked = unpacked.saturating_add(stated);
        refuse_large(unpacked).map_err(|error| error.in_file(path))?;
        let (input, head) = source::open_streamed(part, EXPECTED, Limit::Bag)?;
        if !head.starts_with(container::MAGIC) {
            let message = format!("found a file that is no MCAP, expected {EXPECTED}");
            return Err(ErrorKind::File.error(message).in_file(part));
        }
        hashing = hashing.over(Box::new(input));
        topics.begin_file();
        let mut through = || {
            let damage = container::read(&mut hashing, &mut topics)?;
            if topics.refused.is_some() {
                return Ok(damage);
            }
            // The checksum is of all bytes.
            io::copy(&mut hashing, &mut io::sink())?;
            Ok(damage)
        };
        let damage = through().map_err(|error| source::unreadable(part, &error, EXPECTED))?;
        refuse_many(&topics).map_err(|error| error.in_file(part))?;
        let name = if parts.len() > 1 { part.file_name().map(PathBuf::from) } else { None };
        warned.extend(warnings(&damage, name.as_deref(), &topics));
    }
    if topics.unknown > 0 {
        warned.push(format!("left out {} messages of topics that it does not describe", topics.unknown));
    }
    Ok(recording(&topics, opening, &hashing.sha256(), warned))
}

/// Reads a bag whose messages are at hand.
pub(crate) fn read_given(given: &GivenBag, opening: &Opening<'_>) -> Result<Recording> {
    let joints = opening.robot.joint_reading_names();
    let mut topics = Topics::new(&joints);
    topics.begin_file();
    let unreadable = |error: io::Error| source::unreadable(&given.path, &error, EXPECTED);
    let stated = container::stated_size(&mut given.mcap.as_ref()).map_err(unreadable)?;
    refuse_large(stated).map_err(|error| error.in_file(&given.path))?;
    let damage = container::read(&mut given.mcap.as_ref(), &mut topics).map_err(unreadable)?;
    refuse_many(&topics).map_err(|error| error.in_file(&given.path))?;
    let warned = warnings(&damage, None, &topics);
    Ok(recording(&topics, opening, &given.sha256, warned))
}

/// Refuses a bag of more bytes than there may be after it is unpacked.
fn refuse_large(unpacked: u64) -> Result<()> {
    let size = amount(unpacked, Limit::Bag.row().unit);
    Limit::Bag.refuse(unpacked, format_args!("a bag that states {size} unpacked"))
}

/// Refuses a bag with more topics, frames or poses than there may be.
fn refuse_many(topics: &Topics<'_>) -> Result<()> {
    topics.refused.as_ref().map_or(Ok(()), |sentence| Err(ErrorKind::Measurement.error(sentence.clone())))
}

/// The tables of the topics.
fn recording(topics: &Topics<'_>, opening: &Opening<'_>, sha256: &str, warned: Vec<String>) -> Recording {
    let chosen = (choice::joints(topics, opening.options), choice::measured(topics, opening.options));
    let first = [
        chosen.0.as_ref().ok().and_then(|it| it.1.first_ns()),
        chosen.1.as_ref().ok().and_then(|it| it.body.first_ns()),
    ];
    // The same for both, so that the lag of their clocks is kept.
    let since_s = first.into_iter().flatten().min().unwrap_or_default().div_euclid(SECOND);
    let own = |made| OwnTable { made, sha256: Some(sha256.to_owned()), title: BAG };
    let columns = opening.joint_columns("rad");
    let joints = chosen.0.map(|(topic, readings)| own(readings.table(&topic.name, &columns, since_s)));
    let measured = chosen.1.map(|it| own(it.table(since_s)));
    let asked = opening.options.topics.iter();
    let mut found = Recording {
        joints,
        measured,
        contents: topics.words(),
        has_topic: asked
            .map(|name| topics.all.iter().filter(|it| it.is_called(name)).map(Topic::is_read).max())
            .collect(),
        names_bodies: topics.all.iter().any(Topic::names_bodies),
    };
    let first = if found.joints.is_ok() { &mut found.joints } else { &mut found.measured };
    if let Ok(table) = first {
        table.made.said.insert(0, topics.words());
        table.made.warned.splice(0..0, warned);
    } else {
        for it in warned {
            found.contents.push_str("; ");
            found.contents.push_str(&it);
        }
    }
    found
}

/// What is wrong with a part, a sentence each.
fn warnings(damage: &Damage, part: Option<&Path>, topics: &Topics<'_>) -> Vec<String> {
    let name = part.map_or(String::new(), |it| format!("`{}`: ", it.display()));
    let mut found = Vec::new();
    let (first, last) = topics.span_ns.unwrap_or_default();
    for (at, why, (begin, end)) in &damage.chunks {
        let is_known = first <= *begin && begin <= end && *end <= last;
        let times = if is_known {
            let (begin, end) = (topics.since_first_s(*begin), topics.since_first_s(*end));
            format!(", {begin:.3} s to {end:.3} s after the first message")
        } else {
            String::new()
        };
        found.push(format!("{name}left out what is damaged from byte {at} on{times}: found {why}"));
    }
    if damage.others > 0 {
        found.push(format!("{name}left out {} more damaged places", damage.others));
    }
    if let Some((at, why)) = &damage.end {
        found.push(format!(
            "{name}read it up to the last whole chunk, byte {at}, {:.3} s after the first message: {why}",
            topics.since_first_s(last)
        ));
    }
    found
}
