//! Unpacks chunks, and the messages or the whole files that rosbag2 compresses.

use std::io::{self, Read};

use lz4_flex::frame::FrameDecoder as Lz4;
use ruzstd::decoding::StreamingDecoder as Zstd;

/// The beginning of a frame of zstd; no message has it.
pub const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";

/// The bytes of a file; up to so many of one that is compressed as a whole.
///
/// # Errors
/// A compressed file that is no zstd.
pub fn stream<'r>(file: impl Read + 'r, is_packed: bool, most: u64) -> io::Result<Box<dyn Read + 'r>> {
    if !is_packed {
        return Ok(Box::new(file));
    }
    let unpacked = Zstd::new(file).map(|it| Box::new(it.take(most)) as Box<dyn Read + 'r>);
    unpacked.map_err(|error| io::Error::other(format!("{error}; unpack it by `zstd -d`")))
}

/// Puts the bytes of a message that is compressed by itself into `into`, up to so many.
///
/// # Errors
/// The damage that was found.
pub fn message(packed: &[u8], most: u64, into: &mut Vec<u8>) -> Result<(), String> {
    into.clear();
    frames(packed, most, into)
}

/// Puts the bytes of a chunk that is packed in this way into `into`, up to one beyond the size that it states; an error says what was found.
pub(super) fn unpack(packed: &[u8], how: &str, stated: u64, into: &mut Vec<u8>) -> Result<(), String> {
    into.clear();
    let most = stated.saturating_add(1);
    let read = match how {
        "lz4" => Lz4::new(packed).take(most).read_to_end(into).map(drop).map_err(|it| it.to_string()),
        "zstd" => frames(packed, most, into),
        other => Err(format!("the compression `{other}`, expected zstd, lz4 or none")),
    };
    if into.len() as u64 > stated {
        return Err(format!("more than {stated} bytes, expected as many"));
    }
    read
}

/// All frames of zstd.
fn frames(mut packed: &[u8], most: u64, into: &mut Vec<u8>) -> Result<(), String> {
    while !packed.is_empty() && (into.len() as u64) < most {
        let mut frame = Zstd::new(packed).map_err(|error| error.to_string())?;
        let read = frame.by_ref().take(most - into.len() as u64).read_to_end(into);
        read.map_err(|error| error.to_string())?;
        packed = frame.into_inner();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_unpacked_and_damaged_ones_are_errors() {
        let bytes: Vec<u8> = (0..100_000_u32).flat_map(|it| (it / 7).to_le_bytes()).collect();
        let zstd = ruzstd::encoding::compress_to_vec(&bytes[..], ruzstd::encoding::CompressionLevel::Fastest);
        let mut lz4 = lz4_flex::frame::FrameEncoder::new(Vec::new());
        std::io::Write::write_all(&mut lz4, &bytes).unwrap();
        let lz4 = lz4.finish().unwrap();
        let mut into = Vec::new();
        // Two frames are one after the other.
        unpack(&[zstd.clone(), zstd.clone()].concat(), "zstd", 2 * bytes.len() as u64, &mut into).unwrap();
        assert_eq!(into, [bytes.clone(), bytes.clone()].concat());
        for (packed, how) in [(&zstd, "zstd"), (&lz4, "lz4")] {
            unpack(packed, how, bytes.len() as u64, &mut into).unwrap();
            assert_eq!(into, bytes);
            for at in (0..packed.len()).step_by(packed.len() / 200 + 1) {
                let _ = unpack(&packed[..at], how, 400_000, &mut into);
                let mut flipped = packed.clone();
                flipped[at] ^= 0x41;
                let _ = unpack(&flipped, how, 400_000, &mut into);
            }
        }
        assert!(
            unpack(&zstd, "brotli", 400_000, &mut into).unwrap_err().contains("the compression `brotli`")
        );
    }
}
