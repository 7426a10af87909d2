//! Bags of ROS 2 in MCAP: joint readings and measurements, by the times in the messages.

mod bag_files;
mod bodies;
mod cdr;
mod choice;
mod clock;
mod joints;
mod messages;
#[cfg(test)]
mod tests;
mod topics;

use std::io;
use std::path::Path;

use self::clock::SECOND;
use self::topics::{Topic, Topics};
use super::{BAG, MadeTable, OpeningContext, Recording};
use crate::ConvertedBag;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::containers::mcap::{self, Damage};
use poecal_storage::containers::unpack;
use poecal_storage::disk::is_file;
use poecal_storage::hashes::HashingReader;
use poecal_storage::limits::{ResourceLimit, amount};
use poecal_storage::source;

pub(crate) use self::bag_files::is_bag;

const EXPECTED: &str = "a ROS 2 bag (MCAP)";

/// Reads a bag.
pub(crate) fn read(path: &Path, opening: &OpeningContext<'_>) -> Result<Recording> {
    let joints = opening.robot.joint_reading_names();
    let mut topics = Topics::new(&joints);
    let (parts, left) = bag_files::files_of_bag(path)?;
    let mut warned: Vec<String> = left.iter().map(ToString::to_string).collect();
    let mut hashing = HashingReader::new(Box::new(io::empty()) as Box<dyn io::Read>);
    let mut unpacked = 0_u64;
    for part in &parts {
        let unreadable = |error: io::Error| source::unreadable_error(part, &error, EXPECTED);
        // A bag that can be read only once is held in memory.
        let (mut input, head) = match is_file(part) {
            true => source::open_streamed(part, EXPECTED, ResourceLimit::Bag)?,
            false => source::open_any(part, EXPECTED, ResourceLimit::Bag)?,
        };
        let (is_packed, most) = (head.starts_with(unpack::ZSTD), ResourceLimit::Bag.value() + 1);
        let mut whole = unpack::stream(&mut input, is_packed, most).map_err(unreadable)?;
        let stated = mcap::stated_size(&mut whole).map_err(unreadable)?;
        unpacked = unpacked.saturating_add(stated);
        refuse_large(unpacked, path)?;
        let (input, head) = source::open_streamed(part, EXPECTED, ResourceLimit::Bag)?;
        if stated == 0 && (is_packed || !head.starts_with(mcap::MAGIC)) {
            let packed = if is_packed { "compressed " } else { "" };
            let message = format!("found a {packed}file that is no MCAP, expected {EXPECTED}");
            return Err(ErrorKind::File.error(message).in_file(part));
        }
        hashing = hashing.continue_with(Box::new(input));
        let name = part.file_name().map(Path::new).filter(|_| parts.len() > 1);
        let whole = unpack::stream(&mut hashing, is_packed, most).map_err(unreadable)?;
        warned.extend(take(whole, &mut topics, part, name)?);
        // The checksum covers all bytes.
        io::copy(&mut hashing, &mut io::sink()).map_err(unreadable)?;
    }
    if topics.unknown > 0 {
        warned.push(format!("left out {} messages of topics that it does not describe", topics.unknown));
    }
    Ok(recording(&topics, opening, &hashing.sha256(), warned))
}

/// Reads a bag whose messages are in memory.
pub(crate) fn read_given(given: &ConvertedBag, opening: &OpeningContext<'_>) -> Result<Recording> {
    let joints = opening.robot.joint_reading_names();
    let mut topics = Topics::new(&joints);
    let stated = mcap::stated_size(&mut given.mcap.as_ref());
    refuse_large(stated.map_err(|error| source::unreadable_error(&given.path, &error, EXPECTED))?, &given.path)?;
    let warned = take(&mut given.mcap.as_ref(), &mut topics, &given.path, None)?;
    Ok(recording(&topics, opening, &given.sha256, warned))
}

/// Takes the messages of a file and returns its defects, named as this part. Too many topics, frames or poses are one of them.
fn take(mut input: impl io::Read, topics: &mut Topics<'_>, path: &Path, name: Option<&Path>) -> Result<Vec<String>> {
    topics.begin_file();
    let damage = mcap::read(&mut input, topics);
    let damage = damage.map_err(|error| source::unreadable_error(path, &error, EXPECTED))?;
    match &topics.refused {
        Some(sentence) => Err(ErrorKind::Measurement.error(sentence.clone()).in_file(path)),
        None => {
            let mut found = warnings(&damage, name, topics);
            if let Some((count, why)) = topics.damaged.take() {
                found.push(format!("left out {count} compressed messages that are damaged: found {why}"));
            }
            Ok(found)
        }
    }
}

/// Refuses a bag with more bytes than the limit after unpacking.
fn refuse_large(unpacked: u64, path: &Path) -> Result<()> {
    let size = amount(unpacked, ResourceLimit::Bag.row().unit);
    let found = ResourceLimit::Bag.refuse(unpacked, format_args!("a bag that states {size} unpacked"));
    found.map_err(|error| error.in_file(path))
}

/// The tables of the topics.
fn recording(topics: &Topics<'_>, opening: &OpeningContext<'_>, sha256: &str, warned: Vec<String>) -> Recording {
    let joints = choice::joints(topics, opening.options);
    let measured = choice::find_measured(topics, opening.options);
    let first_ns =
        [joints.as_ref().ok().and_then(|it| it.1.first_ns()), measured.as_ref().ok().and_then(|it| it.body.first_ns())];
    // The same whole second for both, so that the lag of their clocks is kept.
    let since_s = first_ns.into_iter().flatten().min().unwrap_or_default().div_euclid(SECOND);
    let own = |made: MadeTable| made.of_file(BAG, Some(sha256.to_owned()));
    let columns = opening.joint_columns("rad");
    let asked = opening.options.topics.iter();
    let mut found = Recording {
        joints: joints.map(|(topic, readings)| own(readings.table(&topic.name, columns, since_s))),
        measured: measured.map(|it| own(it.table(since_s))),
        contents: topics.words(),
        has_topic: asked
            .map(|name| topics.all.iter().filter(|it| it.is_called(name)).map(Topic::is_read).max())
            .collect(),
        names_bodies: topics.all.iter().any(Topic::names_bodies),
    };
    if let Some(made) = found.joints.as_mut().ok().or(found.measured.as_mut().ok()) {
        made.said.insert(0, topics.words());
        made.warned.splice(0..0, warned);
    } else {
        found.contents.extend(warned.iter().map(|it| format!("; {it}")));
    }
    found
}

/// Defects of a part, a sentence each.
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
