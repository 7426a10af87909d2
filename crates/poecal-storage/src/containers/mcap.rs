//! Records of MCAP: a file is read as a stream, a chunk at a time.

use std::io::{self, BufReader, Read};

use super::fields::ByteFields;
use super::unpack::unpack;
use crate::limits::{ResourceLimit, amount};

/// Bytes at the beginning of a file.
pub const MAGIC: &[u8] = &[0x89, b'M', b'C', b'A', b'P', 0x30, b'\r', b'\n'];
/// Length of the longest name, bytes: names of topics and types are held.
pub const LONGEST_NAME: usize = 4096;
/// Number of bytes that are read at a time.
const STEP: usize = 1 << 18;
/// Bytes of a record before its content: its kind, and its length.
const HEAD: usize = 9;

/// Kinds of records, <https://mcap.dev/spec#opcodes>.
pub mod op {
    /// The last record: the position of the summary.
    pub const FOOTER: u8 = 0x02;
    /// A type of messages.
    pub const SCHEMA: u8 = 0x03;
    /// A topic.
    pub const CHANNEL: u8 = 0x04;
    /// A message.
    pub const MESSAGE: u8 = 0x05;
    /// Records, possibly compressed.
    pub const CHUNK: u8 = 0x06;
    /// The end of the messages.
    pub const DATA_END: u8 = 0x0F;
}

/// Takes the records of a file.
pub trait RecordSink {
    /// A type of messages by its number.
    fn schema(&mut self, id: u16, name: &str);
    /// A topic by its number, with that of its type and its encoding.
    fn channel(&mut self, id: u16, schema: u16, name: &str, encoding: &str);
    /// A message of a topic, with its time in the log, nanoseconds.
    fn message(&mut self, channel: u16, log_ns: u64, data: &[u8]);
    /// True if no more records are accepted.
    fn is_full(&self) -> bool;
}

/// Reason why a file ends.
const CUT: &str = "it is cut off";

/// Damage of a file.
#[derive(Clone, Debug, Default)]
pub struct Damage {
    /// Position of a premature end, or from which nothing can be read, and the reason.
    pub end: Option<(u64, String)>,
    /// The first chunks that were left out: their positions, the reasons, and the times of their messages.
    pub chunks: Vec<(u64, String, (u64, u64))>,
    /// Number of further damaged chunks.
    pub others: usize,
}

/// Largest number of damaged chunks that are listed.
const NAMED: usize = 5;

impl Damage {
    /// Records a chunk that is left out.
    fn add(&mut self, at: u64, why: String, times: (u64, u64)) {
        if self.chunks.len() < NAMED {
            self.chunks.push((at, why, times));
        } else {
            self.others += 1;
        }
    }
}

/// Unpacked size of the records of a file in bytes, as their heads state it, or up to the first record beyond the limit. Nothing is unpacked here;
/// later a chunk must not exceed its stated size.
pub fn stated_size(input: &mut impl Read) -> io::Result<u64> {
    let mut input = BufReader::with_capacity(STEP, input);
    let mut data = Vec::new();
    let mut sum = 0_u64;
    if !fill(&mut input, MAGIC.len(), &mut data)? || data != MAGIC {
        return Ok(0);
    }
    while fill(&mut input, HEAD, &mut data)? {
        let mut head = ByteFields(&data);
        let (Some(opcode), Some(mut rest)) = (head.u8(), head.u64()) else { break };
        if matches!(opcode, op::DATA_END | op::FOOTER) {
            break;
        }
        let mut unpacked = rest;
        // Two times, then the size.
        if opcode == op::CHUNK && rest >= 24 {
            if !fill(&mut input, 24, &mut data)? {
                break;
            }
            rest -= 24;
            unpacked = ByteFields(data.get(16..).unwrap_or_default()).u64().unwrap_or_default();
        }
        sum = sum.saturating_add(unpacked);
        // Such a file is refused: the rest may take minutes to unpack.
        if sum > ResourceLimit::Bag.value() || io::copy(&mut input.by_ref().take(rest), &mut io::sink())? < rest {
            break;
        }
    }
    Ok(sum)
}

/// Reads a file up to the end of its messages, or up to the damage.
pub fn read(input: &mut impl Read, taker: &mut impl RecordSink) -> io::Result<Damage> {
    let mut input = BufReader::with_capacity(STEP, input);
    let (mut damage, mut data, mut unpacked) = (Damage::default(), Vec::new(), Vec::new());
    let mut at = MAGIC.len() as u64;
    let is_whole = fill(&mut input, MAGIC.len(), &mut data)?;
    if !is_whole || data != MAGIC {
        damage.end = Some((at, if is_whole { "Bad magic number" } else { CUT }.to_owned()));
        return Ok(damage);
    }
    while !taker.is_full() {
        let mut times = (0, 0);
        let taken = match next(&mut input, &mut data)? {
            Err(why) => {
                damage.end = Some((at, why));
                break;
            }
            Ok(op::DATA_END | op::FOOTER) => break,
            // Chunks are unpacked here: one that is damaged is left out as a whole.
            Ok(op::CHUNK) => chunk(&data, &mut unpacked, taker, &mut times),
            Ok(opcode) => record(opcode, &data, taker),
        };
        if let Err(why) = taken {
            damage.add(at, why, times);
        }
        at = at.saturating_add((HEAD + data.len()) as u64);
    }
    Ok(damage)
}

/// Reads the next record: returns its kind, and puts its content into `data`. The inner error is the reason why there is none.
fn next(input: &mut impl Read, data: &mut Vec<u8>) -> io::Result<Result<u8, String>> {
    if !fill(input, HEAD, data)? {
        return Ok(Err(CUT.to_owned()));
    }
    let mut head = ByteFields(data);
    let (Some(opcode), Some(stated)) = (head.u8(), head.u64()) else { return Ok(Err(CUT.to_owned())) };
    let Some(size) = usize::try_from(stated).ok().filter(|_| stated <= ResourceLimit::Chunk.value()) else {
        return Ok(Err(too_large("a record", stated)));
    };
    if !fill(input, size, data)? {
        return Ok(Err(CUT.to_owned()));
    }
    // The smallest sizes of these records.
    let least = match opcode {
        op::DATA_END => 4,
        op::FOOTER => 20,
        _ => 0,
    };
    Ok(if size < least { Err("Record parse failed".to_owned()) } else { Ok(opcode) })
}

/// Message on a record or chunk beyond the limit.
fn too_large(what: &str, bytes: u64) -> String {
    ResourceLimit::Chunk.sentence(&format!("{what} of {}", amount(bytes, ResourceLimit::Chunk.row().unit)))
}

/// Reads `size` bytes, and takes memory for no more than exist; false if there are fewer.
fn fill(input: &mut impl Read, size: usize, into: &mut Vec<u8>) -> io::Result<bool> {
    into.clear();
    into.reserve(size.min(STEP));
    Ok(input.take(size as u64).read_to_end(into)? == size)
}

/// Takes the records of a chunk, and puts the times of its messages into `times`. The error is the reason why it is left out.
fn chunk(
    data: &[u8],
    unpacked: &mut Vec<u8>,
    taker: &mut impl RecordSink,
    times: &mut (u64, u64),
) -> Result<(), String> {
    let mut fields = ByteFields(data);
    let head = |fields: &mut ByteFields<'_>| Some(((fields.u64()?, fields.u64()?), fields.u64()?, fields.u32()?));
    let (stated, size, crc) = head(&mut fields).ok_or(SHORT)?;
    *times = stated;
    let how = text(&mut fields).ok_or(SHORT)?;
    let mut records = fields.counted_bytes().ok_or(SHORT)?;
    if !how.is_empty() {
        if size > ResourceLimit::Chunk.value() {
            return Err(too_large("a chunk", size));
        }
        unpack(records, how, size, unpacked)?;
        records = unpacked;
    }
    if records.len() as u64 != size {
        return Err(format!("{} bytes, expected {size}", records.len()));
    }
    if crc != 0 && crc32fast::hash(records) != crc {
        return Err("another checksum than stated".to_owned());
    }
    let mut rest = ByteFields(records);
    while !rest.0.is_empty() && !taker.is_full() {
        let (opcode, own) = rest.u8().zip(rest.counted_bytes()).ok_or(SHORT)?;
        record(opcode, own, taker)?;
    }
    Ok(())
}

/// Takes a record that is no chunk.
fn record(opcode: u8, data: &[u8], taker: &mut impl RecordSink) -> Result<(), String> {
    let mut fields = ByteFields(data);
    let mut take = || -> Option<()> {
        match opcode {
            op::SCHEMA => taker.schema(fields.u16()?, name(&mut fields)?),
            op::CHANNEL => {
                let (id, schema) = (fields.u16()?, fields.u16()?);
                taker.channel(id, schema, name(&mut fields)?, name(&mut fields)?);
            }
            op::MESSAGE => {
                let (channel, _, log_ns, _) = (fields.u16()?, fields.u32()?, fields.u64()?, fields.u64()?);
                taker.message(channel, log_ns, fields.0);
            }
            _ => {}
        }
        Some(())
    };
    Ok(take().ok_or(SHORT)?)
}

/// Message on a record that ends too soon.
const SHORT: &str = "a record that is shorter than what it holds";

/// A text.
fn text<'b>(fields: &mut ByteFields<'b>) -> Option<&'b str> {
    let size = fields.index()?;
    std::str::from_utf8(fields.bytes(size)?).ok()
}

/// A text that is held.
fn name<'b>(fields: &mut ByteFields<'b>) -> Option<&'b str> {
    text(fields).filter(|it| it.len() <= LONGEST_NAME)
}
