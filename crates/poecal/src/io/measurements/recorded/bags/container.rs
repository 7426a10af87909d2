//! Records of MCAP: a file is read as a stream, a chunk at a time.

use std::io::{self, Read};

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::topics::Topics;
use super::unpack::{LARGEST, unpack};

/// Bytes that files begin with.
pub(super) const MAGIC: &[u8] = mcap::MAGIC;
/// Bytes that are read at a time.
const STEP: usize = 1 << 18;
/// Bytes of a record before what it holds: its kind, and its length.
const HEAD: usize = 9;

/// Why a file ends.
const CUT: &str = "it is cut off";

/// What is wrong with a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Damage {
    /// Where it ends before its end, or from where on nothing can be read, and why.
    pub(super) end: Option<(u64, String)>,
    /// Chunks that were left out: where each begins, why, and the times of its messages.
    pub(super) chunks: Vec<(u64, String, (u64, u64))>,
}

/// Reads a file up to the end of its messages, or as far as that goes.
pub(super) fn read(input: &mut impl Read, topics: &mut Topics<'_>) -> io::Result<Damage> {
    // Chunks are unpacked here: one that is damaged is left out as a whole.
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_skip_end_magic(true)
        .with_record_length_limit(LARGEST);
    let mut reader = LinearReader::new_with_options(options);
    let (mut damage, mut unpacked) = (Damage::default(), Vec::new());
    let mut at = MAGIC.len() as u64;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(_)) => {
                let count = read_some(input, reader.insert(STEP))?;
                reader.notify_read(count);
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                match opcode {
                    op::DATA_END | op::FOOTER => return Ok(damage),
                    op::CHUNK => {
                        if let Err((why, times)) = chunk(data, &mut unpacked, topics) {
                            damage.chunks.push((at, why, times));
                        }
                    }
                    _ => {
                        if let Err(why) = record(opcode, data, topics) {
                            damage.chunks.push((at, why, (0, 0)));
                        }
                    }
                }
                at = at.saturating_add((HEAD + data.len()) as u64);
            }
            Err(error) => {
                let is_cut = matches!(error, McapError::UnexpectedEof);
                damage.end = Some((at, if is_cut { CUT.to_owned() } else { error.to_string() }));
                return Ok(damage);
            }
        }
    }
    // It ends behind a whole record, and not by the one that says so.
    damage.end = Some((at, CUT.to_owned()));
    Ok(damage)
}

/// Reads once; 0 at the end.
fn read_some(input: &mut impl Read, into: &mut [u8]) -> io::Result<usize> {
    loop {
        match input.read(into) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

/// Takes the records of a chunk, or says why not, with the times of its messages.
fn chunk(data: &[u8], unpacked: &mut Vec<u8>, topics: &mut Topics<'_>) -> Result<(), (String, (u64, u64))> {
    let mut fields = Fields(data);
    let head = |fields: &mut Fields<'_>| {
        let times = (fields.u64()?, fields.u64()?);
        Some((times, fields.u64()?, fields.u32()?))
    };
    let Some((times, size, crc)) = head(&mut fields) else { return Err((SHORT.to_owned(), (0, 0))) };
    let with_times = |why: String| (why, times);
    let short = || with_times(SHORT.to_owned());
    let how = fields.text().ok_or_else(short)?;
    let packed = fields.u64().and_then(|size| fields.bytes(usize::try_from(size).ok()?)).ok_or_else(short)?;
    let mut records = packed;
    if !how.is_empty() {
        unpack(packed, how, unpacked).map_err(with_times)?;
        records = unpacked;
    }
    if records.len() as u64 != size {
        return Err(with_times(format!("{} bytes, expected {size}", records.len())));
    }
    if crc != 0 && crc32fast::hash(records) != crc {
        return Err(with_times("another checksum than stated".to_owned()));
    }
    let mut rest = Fields(records);
    while !rest.0.is_empty() {
        let (Some(opcode), Some(size)) = (rest.u8(), rest.u64()) else { return Err(short()) };
        let own = usize::try_from(size).ok().and_then(|size| rest.bytes(size)).ok_or_else(short)?;
        record(opcode, own, topics).map_err(with_times)?;
    }
    Ok(())
}

/// Takes a record that is no chunk.
fn record(opcode: u8, data: &[u8], topics: &mut Topics<'_>) -> Result<(), String> {
    let mut fields = Fields(data);
    let mut take = || -> Option<()> {
        match opcode {
            op::SCHEMA => topics.schema(fields.u16()?, fields.text()?),
            op::CHANNEL => {
                let (id, schema) = (fields.u16()?, fields.u16()?);
                topics.channel(id, schema, fields.text()?, fields.text()?);
            }
            op::MESSAGE => {
                let (channel, _, log_ns, _) = (fields.u16()?, fields.u32()?, fields.u64()?, fields.u64()?);
                topics.message(channel, log_ns, fields.0);
            }
            _ => {}
        }
        Some(())
    };
    take().ok_or_else(|| SHORT.to_owned())
}

/// What is found in place of a record that ends too soon.
const SHORT: &str = "a record that is shorter than what it holds";

/// Fields of a record.
struct Fields<'b>(&'b [u8]);

impl<'b> Fields<'b> {
    fn bytes(&mut self, count: usize) -> Option<&'b [u8]> {
        let (found, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(found)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<&'b str> {
        let size = self.u32()? as usize;
        std::str::from_utf8(self.bytes(size)?).ok()
    }
}
