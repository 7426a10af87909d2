//! Bags written by the tests, and the rows that are read from them.

use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::messages::tests::Writer as Cdr;
use super::topics::Topics;
use crate::{MeasurementFile, ReadOptions, read};
use poecal_arm::lie::rotation;
use poecal_model::robot::Robot;
use poecal_model::simulate::elbow;
use poecal_storage::containers::mcap::{self, MAGIC, RecordSink as _, op};
use poecal_storage::limits::{self, ResourceLimit};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

const JOINTS: &str = "sensor_msgs/msg/JointState";
const POSE: &str = "geometry_msgs/msg/PoseStamped";
const POINT: &str = "geometry_msgs/msg/PointStamped";
const FRAMES: &str = "tf2_msgs/msg/TFMessage";
/// The first stamp, and the lag of the poses' clock, nanoseconds.
const FIRST_NS: u64 = 1_700_000_000_400_000_000;
const LAG_NS: u64 = 137_500_000;
/// Time of a static interval and of a motion, milliseconds.
const STAND_MS: u64 = 500;
const MOTION_MS: u64 = 400;
const STANDS: u64 = 14;

/// A message: topic, type, time in the log, and its bytes.
type Message = (&'static str, &'static str, u64, Vec<u8>);

/// A folder that is removed after the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("poecal_bags_{name}_{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Opcodes of records that are not read.
const HEADER: u8 = 0x01;
const MESSAGE_INDEX: u8 = 0x07;
/// Size of records, bytes, at which a chunk is full.
const CHUNK: usize = 20_000;

/// A text with its length.
fn text(text: &str) -> Vec<u8> {
    [&u32::try_from(text.len()).unwrap().to_le_bytes(), text.as_bytes()].concat()
}

/// A record made of parts.
fn record(opcode: u8, parts: &[&[u8]]) -> Vec<u8> {
    let size: usize = parts.iter().map(|it| it.len()).sum();
    [&[opcode], &(size as u64).to_le_bytes()[..], &parts.concat()].concat()
}

/// A chunk of records, not packed, and its index.
fn chunk(records: &[u8], [first, last]: [u64; 2]) -> Vec<u8> {
    let size = (records.len() as u64).to_le_bytes();
    let times = [first.to_le_bytes(), last.to_le_bytes()].concat();
    let checksum = crc32fast::hash(records).to_le_bytes();
    let own = record(op::CHUNK, &[&times, &size, &checksum, &text(""), &size, records]);
    [own, record(MESSAGE_INDEX, &[&[0; 6]])].concat()
}

/// The bytes of a bag: types and topics are in the chunk of their first message.
fn bag(messages: &[Message]) -> Vec<u8> {
    let mut out = [MAGIC, &record(HEADER, &[&text("ros2"), &text("tests")])].concat();
    let (mut types, mut topics): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    let (mut records, mut times) = (Vec::new(), [u64::MAX, 0]);
    for (sequence, (topic, name, log_time, data)) in (0_u32..).zip(messages) {
        let place = |all: &mut Vec<&'static str>, own: &'static str| {
            let found = all.iter().position(|it| *it == own);
            let at = found.unwrap_or(all.len());
            all.extend(found.is_none().then_some(own));
            (u16::try_from(at).unwrap(), found.is_none())
        };
        let (schema, is_new) = place(&mut types, name);
        // Types count from one.
        let schema = (schema + 1).to_le_bytes();
        if is_new {
            records.extend(record(op::SCHEMA, &[&schema, &text(name), &text("ros2msg"), &text("")]));
        }
        let (channel, is_new) = place(&mut topics, topic);
        let channel = channel.to_le_bytes();
        if is_new {
            records.extend(record(op::CHANNEL, &[&channel, &schema, &text(topic), &text("cdr"), &[0; 4]]));
        }
        let (sequence, time) = (sequence.to_le_bytes(), log_time.to_le_bytes());
        records.extend(record(op::MESSAGE, &[&channel, &sequence, &time, &time, data]));
        times = [times[0].min(*log_time), times[1].max(*log_time)];
        if records.len() > CHUNK {
            out.extend(chunk(&records, times));
            (records, times) = (Vec::new(), [u64::MAX, 0]);
        }
    }
    if !records.is_empty() {
        out.extend(chunk(&records, times));
    }
    out.extend(record(op::DATA_END, &[&[0; 4]]));
    out.extend(record(op::FOOTER, &[&[0; 20]]));
    out.extend(MAGIC);
    out
}

/// A pseudo-random number from -1 to 1 for a seed.
fn draw(seed: u64) -> f64 {
    let mixed = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((mixed ^ (mixed >> 32)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The configuration at a time of a motion between static intervals.
fn configuration(at_ms: f64) -> Vec<f64> {
    let stand = (at_ms / (STAND_MS + MOTION_MS) as f64).floor().clamp(0.0, (STANDS - 1) as f64);
    let moved = (at_ms - stand * (STAND_MS + MOTION_MS) as f64 - STAND_MS as f64) / MOTION_MS as f64;
    let of = |stand: f64, joint: u64| 0.6 * draw(100 * stand as u64 + joint);
    let at = |joint| {
        let (from, to) = (of(stand, joint), of(stand + 1.0, joint));
        from + (to - from) * moved.clamp(0.0, 1.0)
    };
    (0..6).map(at).collect()
}

/// Position and quaternion of the tip, with some noise.
fn pose(robot: &Robot, at_ms: f64) -> [f64; 7] {
    let tip = robot.forward_kinematics(&configuration(at_ms));
    let noise = |axis: u64| 1e-4 * draw(10 * at_ms as u64 + axis);
    let (place, turn) = (tip.translation, rotation::to_quaternion_xyzw(&tip.rotation));
    [place.x + noise(0), place.y + noise(1), place.z + noise(2), turn.x, turn.y, turn.z, turn.w]
}

/// Messages of joints, a gripper among them, and of poses, in the order of the log.
fn session(robot: &Robot) -> Vec<Message> {
    let end_ms = STANDS * (STAND_MS + MOTION_MS);
    let names = robot.joint_reading_names();
    let mut messages = Vec::new();
    for at_ms in (0..end_ms).step_by(10) {
        let stamp_ns = FIRST_NS + at_ms * 1_000_000;
        let late = |most: f64| stamp_ns + ((1.0 + draw(at_ms)) * most * 1e6) as u64;
        if at_ms % 20 == 0 {
            let own = configuration(at_ms as f64);
            let mut joints: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(own).collect();
            joints.reverse();
            joints.insert(2, ("gripper", 0.01));
            messages.push(("/joint_states", JOINTS, late(1.0), Cdr::joints(stamp_ns, &joints)));
        }
        let data = Cdr::pose(stamp_ns + LAG_NS, &pose(robot, at_ms as f64));
        messages.push(("/tool/pose", POSE, late(20.0), data));
    }
    messages.sort_by_key(|it| it.2);
    messages
}

/// The same session as two tables, with times since the same whole second.
fn tables(robot: &Robot) -> (String, String) {
    let names = robot.joint_reading_names();
    let columns: Vec<String> = names.iter().map(|it| format!("{it}[rad]")).collect();
    let (mut joints, mut seen) =
        (format!("time[s],{}\n", columns.join(",")), "time[s],x[m],y[m],z[m],qx,qy,qz,qw\n".to_owned());
    let cells = |numbers: &[f64]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
    for at_ms in (0..STANDS * (STAND_MS + MOTION_MS)).step_by(10) {
        let seconds = |ns: u64| (ns - 1_700_000_000_000_000_000) as f64 / 1e9;
        let stamp_ns = FIRST_NS + at_ms * 1_000_000;
        if at_ms % 20 == 0 {
            writeln!(joints, "{},{}", seconds(stamp_ns), cells(&configuration(at_ms as f64))).unwrap();
        }
        writeln!(seen, "{},{}", seconds(stamp_ns + LAG_NS), cells(&pose(robot, at_ms as f64))).unwrap();
    }
    (joints, seen)
}

fn read_all(paths: &[&Path], options: &ReadOptions) -> Result<MeasurementFile, String> {
    read(paths, &elbow(), options).map_err(|error| error.to_string())
}

/// True if two files have the same rows.
fn are_same(one: &MeasurementFile, other: &MeasurementFile) -> bool {
    let measured = |it: &MeasurementFile| it.data.observations.iter().map(|it| it.measurement).collect::<Vec<_>>();
    one.data.all_readings() == other.data.all_readings() && measured(one) == measured(other)
}

#[test]
fn both_parts_of_a_bag_are_the_same_rows_as_two_tables() {
    let (robot, folder, options) = (elbow(), Folder::new("same"), ReadOptions::default());
    let (joints, seen) = tables(&robot);
    let (joints, seen) = (folder.write("joints.csv", joints), folder.write("seen.csv", seen));
    let expected = read_all(&[&joints, &seen], &options).unwrap();
    assert_eq!(expected.data.len() as u64, STANDS);
    let messages = session(&robot);
    let whole = folder.write("whole.mcap", bag(&messages));
    let (first, second) = messages.split_at(messages.len() / 2);
    // The parts in the order of their numbers, each with channels of its own.
    let second: Vec<Message> =
        [("/other", "std_msgs/msg/String", second[0].2, vec![0, 1, 0, 0])].into_iter().chain(second.to_vec()).collect();
    folder.write("parts/run_10.mcap", bag(&second));
    let part = folder.write("parts/run_9.mcap", bag(first));
    let of = |topic: &str| messages.iter().filter(|it| it.0 == topic).cloned().collect::<Vec<_>>();
    let only_joints = folder.write("joints.mcap", bag(&of("/joint_states")));
    let only_poses = folder.write("poses.mcap", bag(&of("/tool/pose")));
    let parts = part.parent().unwrap();
    for paths in [
        vec![whole.as_path()],
        vec![parts],
        vec![&only_joints, &only_poses],
        vec![&only_poses, &joints],
        vec![&only_joints, &seen],
    ] {
        let found = read_all(&paths, &options).unwrap();
        assert!(are_same(&found, &expected), "{paths:?}: {:?}", found.warnings);
        let said = found.notes.join("\n");
        assert!(said.contains("at a lag of 0.13") || said.contains("at a lag of 0.14"), "{said}");
    }
    let found = read_all(&[&whole], &options).unwrap();
    assert!(
        found.notes[0].contains("`/tool/pose` (geometry_msgs/msg/PoseStamped, 1260 messages, "),
        "{:?}",
        found.notes
    );
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let alone = read_all(&[&only_poses], &options).unwrap_err();
    assert!(alone.contains("found no joint readings (sensor_msgs/msg/JointState) in the bag"), "{alone}");
}

#[test]
fn bags_that_rosbag2_compressed_by_message_or_by_file_are_the_same_rows() {
    let (robot, folder, options) = (elbow(), Folder::new("packed"), ReadOptions::default());
    let messages = session(&robot);
    let expected = read_all(&[&folder.write("plain.mcap", bag(&messages))], &options).unwrap();
    let packed = |bytes: &[u8]| compress_to_vec(bytes, CompressionLevel::Uncompressed);
    let each: Vec<Message> = messages.iter().map(|it| (it.0, it.1, it.2, packed(&it.3))).collect();
    let by_message = folder.write("message/bag_0.mcap", bag(&each));
    let (first, second) = messages.split_at(messages.len() / 2);
    folder.write("file/bag_1.mcap.zstd", packed(&bag(second)));
    let by_file = folder.write("file/bag_0.mcap.zstd", packed(&bag(first)));
    for path in [by_message.as_path(), by_message.parent().unwrap(), by_file.parent().unwrap()] {
        let found = read_all(&[path], &options).unwrap();
        assert!(are_same(&found, &expected), "{}: {:?}", path.display(), found.warnings);
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
    // Damaged, cut, and beyond a limit.
    let mut broken = each.clone();
    broken[5].3.truncate(9);
    let found = read_all(&[&folder.write("cut.mcap", bag(&broken))], &options).unwrap();
    assert!(found.warnings.iter().any(|it| it.contains("that are damaged")), "{:?}", found.warnings);
    let cut = packed(&bag(&messages));
    let cut = folder.write("cut.mcap.zstd", &cut[..cut.len() / 2]);
    assert!(read_all(&[&cut], &options).is_err());
    let zeros = compress_to_vec(&[0_u8; 200_000][..], CompressionLevel::Fastest);
    let large = bag(&[("/joint_states", JOINTS, FIRST_NS, zeros)]);
    assert!(large.len() < 20_000, "{}", large.len());
    let large = folder.write("large.mcap", large);
    limits::run_with_limits(limits::current_limits().with_limit(ResourceLimit::Bag, 100_000), || {
        let error = read_all(&[&large], &options).unwrap_err();
        assert!(error.contains("the messages of a bag") && error.contains("limit"), "{error}");
    });
}

#[test]
fn several_topics_are_refused_unless_one_is_named() {
    let (robot, folder) = (elbow(), Folder::new("several"));
    let mut messages = session(&robot);
    let expected = read_all(&[&folder.write("one.mcap", bag(&messages))], &ReadOptions::default()).unwrap();
    let again: Vec<Message> = messages
        .iter()
        .map(|it| (if it.0 == "/tool/pose" { "/again" } else { "/wanted" }, it.1, it.2, it.3.clone()))
        .collect();
    // A body at rest, frames, another robot and messages of one joint are no candidates.
    let stamp = FIRST_NS;
    for at in 0..5 {
        let log = stamp + at * 1_000_000_000;
        messages.push(("/base/pose", POSE, log, Cdr::pose(log, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])));
        let frame = [at as f64, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        messages.push(("/tf", FRAMES, log, Cdr::transforms(log, &[("link1", frame), ("link2", frame)])));
        messages.push(("/mobile", JOINTS, log, Cdr::joints(log, &[("wheel", 0.0)])));
        messages.push(("/joint_states", JOINTS, log + 1, Cdr::joints(log, &[("gripper", 0.0)])));
    }
    messages.sort_by_key(|it| it.2);
    let path = folder.write("more.mcap", bag(&messages));
    assert!(are_same(&read_all(&[&path], &ReadOptions::default()).unwrap(), &expected));
    messages.extend(again);
    let path = folder.write("both.mcap", bag(&messages));
    let error = read_all(&[&path], &ReadOptions::default()).unwrap_err();
    assert!(error.contains("found 2 topics with joint readings of the robot, `/joint_states` (sensor_msgs"), "{error}");
    assert!(error.ends_with("expected one: name it by --topic"), "{error}");
    let with = |topics: &[&str]| ReadOptions {
        topics: topics.iter().map(|it| (*it).to_owned()).collect(),
        ..ReadOptions::default()
    };
    let error = read_all(&[&path], &with(&["/joint_states"])).unwrap_err();
    assert!(error.contains("found 2 topics with poses of what moves, `/tool/pose` (geometry_msgs"), "{error}");
    let found = read_all(&[&path], &with(&["wanted", "/again"])).unwrap();
    assert!(are_same(&found, &expected));
    let error = read_all(&[&path], &with(&["/joint_state"])).unwrap_err();
    assert!(error.contains("found no topic `/joint_state`, expected one of `/base/pose` (geometry_msgs"), "{error}");
    let frames = ReadOptions { body: Some("link3".to_owned()), ..with(&["/joint_states"]) };
    let error = read_all(&[&path], &frames).unwrap_err();
    assert!(error.contains("found no frame `link3`, expected one of"), "{error}");
    // Other topics cannot be meant.
    let none = vec![("/chatter", "std_msgs/msg/String", 5, vec![0, 1, 0, 0])];
    let error = read_all(&[&folder.write("none.mcap", bag(&none))], &ReadOptions::default()).unwrap_err();
    let expected = "found neither joint readings nor measurements, expected both: it has `/chatter` (std_msgs/msg/String, 1 message)";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn messages_that_cannot_be_read_are_named() {
    let (robot, folder) = (elbow(), Folder::new("malformed"));
    let mut messages = session(&robot);
    let third = messages.iter_mut().filter(|it| it.0 == "/joint_states").nth(2).unwrap();
    third.3.truncate(60);
    let error = read_all(&[&folder.write("a.mcap", bag(&messages))], &ReadOptions::default()).unwrap_err();
    assert!(error.contains("message 3 of `/joint_states`: found "), "{error}");
    // Without joints of this robot.
    let other: Vec<Message> = vec![("/joint_states", JOINTS, 1, Cdr::joints(1, &[("wheel", 0.0)]))];
    let error = read_all(&[&folder.write("b.mcap", bag(&other))], &ReadOptions::default()).unwrap_err();
    assert!(error.contains("found `/joint_states` with the joints `wheel`, and not `joint1`"), "{error}");
}

#[test]
fn stamps_that_are_zero_are_warned_of() {
    let (robot, folder) = (elbow(), Folder::new("zero"));
    let mut messages = session(&robot);
    for (topic, name, log, data) in &mut messages {
        if *topic == "/tool/pose" {
            (*name, *data) = (POINT, Cdr::pose(0, &pose(&robot, ((*log - FIRST_NS) / 1_000_000) as f64)[..3]));
        }
    }
    let found = read_all(&[&folder.write("a.mcap", bag(&messages))], &ReadOptions::default()).unwrap();
    assert!(found.warnings.iter().any(|it| it.contains("took the times of the log")), "{:?}", found.warnings);
}

#[test]
fn a_bag_that_is_cut_or_damaged_is_read_as_far_as_it_goes() {
    let (robot, folder, options) = (elbow(), Folder::new("cut"), ReadOptions::default());
    let whole = bag(&session(&robot));
    let cut = &whole[..whole.len() * 7 / 10];
    let found = read_all(&[&folder.write("cut.mcap", cut)], &options).unwrap();
    let is_cut = |it: &String| {
        it.contains("read it up to the last whole chunk") && it.contains("s after the first message: it is cut off")
    };
    assert!(found.warnings.iter().any(is_cut), "{:?}", found.warnings);
    assert!((7..STANDS as usize).contains(&found.data.len()), "{}", found.data.len());
    // One byte of a message within a chunk is changed.
    let mut damaged = whole.clone();
    let at = memchr::memmem::rfind(&damaged[..whole.len() / 2], b"gripper").unwrap();
    damaged[at] ^= 0x10;
    let found = read_all(&[&folder.write("damaged.mcap", &damaged)], &options).unwrap();
    let warned = found.warnings.join("\n");
    assert!(warned.contains("left out what is damaged from byte"), "{warned}");
    assert!(warned.contains("found another checksum than stated"), "{warned}");
}

#[test]
fn no_bytes_end_in_a_panic() {
    let robot = elbow();
    let names = robot.joint_reading_names();
    let mut messages = session(&robot);
    messages.truncate(120);
    let whole = bag(&messages);
    let try_bytes = |bytes: &[u8]| {
        let mut topics = Topics::new(&names);
        let damage = mcap::read(&mut Cursor::new(bytes), &mut topics).unwrap();
        let read: u64 = topics.all.iter().map(|it| it.count).sum();
        assert!(read <= 120);
        (damage.end.is_some() || !damage.chunks.is_empty(), read)
    };
    assert_eq!(try_bytes(&whole), (false, 120));
    for size in (0..whole.len()).step_by(97) {
        let (is_said, read) = try_bytes(&whole[..size]);
        assert!(is_said || read == 120, "{size}");
    }
    for (number, at) in (0..whole.len()).step_by(13).enumerate() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (number % 8);
        try_bytes(&bytes);
        bytes[at] = 0xFF;
        try_bytes(&bytes);
    }
}

#[test]
fn what_ends_a_file_is_said() {
    let header = record(HEADER, &[&text("ros2"), &text("tests")]);
    let begun = [MAGIC, &header].concat();
    let behind = begun.len() as u64;
    let large = [&[0x80][..], &(1_u64 << 40).to_le_bytes()].concat();
    let cut = "it is cut off";
    for (bytes, expected) in [
        (b"no magic".to_vec(), Some((8, "Bad magic number"))),
        (MAGIC[..5].to_vec(), Some((8, cut))),
        (MAGIC.to_vec(), Some((8, cut))),
        (begun.clone(), Some((behind, cut))),
        ([&begun[..], &header[..4]].concat(), Some((behind, cut))),
        ([&begun[..], &header[..12]].concat(), Some((behind, cut))),
        (
            [&begun[..], &large].concat(),
            Some((
                behind,
                "found a record of 1024 GiB, expected at most 128 MiB (limit `chunk`): write the bag again with smaller chunks, or allow more by --limit chunk=N",
            )),
        ),
        ([&begun[..], &record(op::DATA_END, &[&[0; 3]])].concat(), Some((behind, "Record parse failed"))),
        ([&begun[..], &record(op::FOOTER, &[&[0; 19]])].concat(), Some((behind, "Record parse failed"))),
        ([&begun[..], &record(op::DATA_END, &[&[0; 4]])].concat(), None),
        ([&begun[..], &record(op::FOOTER, &[&[0; 20]])].concat(), None),
    ] {
        let mut topics = Topics::new(&[]);
        let damage = mcap::read(&mut Cursor::new(bytes), &mut topics).unwrap();
        assert_eq!(damage.end, expected.map(|(at, why)| (at, why.to_owned())));
    }
}

#[test]
fn a_bag_beyond_a_limit_is_refused_by_its_name() {
    let (robot, folder) = (elbow(), Folder::new("limits"));
    let path = folder.write("a.mcap", bag(&session(&robot)));
    for (limit, most, part) in [
        (ResourceLimit::Bag, 1000, "it is larger than 1,000 bytes"),
        (ResourceLimit::Topics, 1, "found more than 1 topics in a bag"),
        (ResourceLimit::Poses, 10, "found more than 10 poses in the messages of a bag"),
    ] {
        let limits = limits::current_limits().with_limit(limit, most);
        let error = limits::run_with_limits(limits, || read_all(&[&path], &ReadOptions::default())).unwrap_err();
        assert!(error.contains(part) && error.contains(&format!("--limit {}=N", limit.row().name)), "{error}");
    }
    // The parts of a bag count as one towards the limit.
    let whole = bag(&session(&robot));
    let parts = folder.0.join("parts");
    (0..2).for_each(|at| drop(folder.write(&format!("parts/b_{at}.mcap"), &whole)));
    let limits = limits::current_limits().with_limit(ResourceLimit::Bag, whole.len() as u64);
    let error = limits::run_with_limits(limits, || read_all(&[&parts], &ReadOptions::default())).unwrap_err();
    assert!(error.contains("found a bag that states") && error.contains("--limit bag=N"), "{error}");
    // A chunk beyond the limit is left out like a damaged one.
    let limits = limits::current_limits().with_limit(ResourceLimit::Chunk, 100);
    let error = limits::run_with_limits(limits, || read_all(&[&path], &ReadOptions::default())).unwrap_err();
    assert!(error.contains("(limit `chunk`)"), "{error}");
}

/// Topics and frames are found by their names at once: a linear search of so many took minutes.
#[test]
fn very_many_topics_and_frames_take_no_time() {
    let mut topics = Topics::new(&[]);
    let start = std::time::Instant::now();
    for at in 0..60_000_u32 {
        topics.channel((at % 60_000) as u16, 0, &format!("/topic{at}"), "cdr");
    }
    assert_eq!((topics.all.len(), topics.refused.clone()), (60_000, None));
    let frames: Vec<String> = (0..60_000).map(|at| format!("frame{at}")).collect();
    topics.schema(1, FRAMES);
    topics.channel(1, 1, "/tf", "cdr");
    for part in frames.chunks(1000) {
        let pose = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let all: Vec<(&str, [f64; 7])> = part.iter().map(|name| (name.as_str(), pose)).collect();
        topics.message(1, 5, &Cdr::transforms(5, &all));
    }
    // A linear search for each would take a minute.
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert_eq!(topics.refused, None);
}
