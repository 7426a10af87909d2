//! Unpacks chunks, and messages or whole files that rosbag2 compresses.

use std::io::{self, BufRead, BufReader, Read};

use lz4_flex::frame::FrameDecoder as Lz4;
use ruzstd::decoding::{FrameDecoder, StreamingDecoder as Zstd};

/// The beginning of a frame of zstd; no message begins so.
pub const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";

/// The bytes of a file; at most `most` if it is compressed as a whole.
///
/// # Errors
/// The compressed file is no zstd.
pub fn stream<'r>(file: impl Read + 'r, is_packed: bool, most: u64) -> io::Result<Box<dyn Read + 'r>> {
    if !is_packed {
        return Ok(Box::new(file));
    }
    let frame = Zstd::new(BufReader::new(file));
    let frame = frame.map_err(|error| io::Error::other(format!("{error}; unpack it by `zstd -d`")))?;
    Ok(Box::new(UnpackedFrames { frame: Some(frame) }.take(most)))
}

/// The bytes of all frames of a file; a file that is cut off ends with its last bytes, like the unpacked file.
struct UnpackedFrames<R: Read> {
    frame: Option<Zstd<BufReader<R>, FrameDecoder>>,
}

impl<R: Read> Read for UnpackedFrames<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while let Some(mut frame) = self.frame.take() {
            let read = frame.read(into);
            if matches!(read, Ok(1..)) || into.is_empty() {
                self.frame = Some(frame);
                return read;
            }
            let mut file = frame.into_inner();
            if !file.fill_buf()?.is_empty() {
                read?;
                self.frame = Zstd::new(file).ok();
            }
        }
        Ok(0)
    }
}

/// Puts the bytes of a message that is compressed by itself into `into`, at most `most`.
///
/// # Errors
/// The damage of the message.
pub fn message(packed: &[u8], most: u64, into: &mut Vec<u8>) -> Result<(), String> {
    into.clear();
    frames(packed, most, into)
}

/// Puts the bytes of a chunk with the compression `how` into `into`, up to one beyond the stated size. An error states the damage.
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
    fn files_are_read_to_their_last_frame_and_as_far_as_they_go() {
        let bytes: Vec<u8> = (0..100_000_u32).flat_map(|it| (it / 7).to_le_bytes()).collect();
        let zstd = ruzstd::encoding::compress_to_vec(&bytes[..], ruzstd::encoding::CompressionLevel::Fastest);
        let read = |packed: &[u8]| {
            let mut into = Vec::new();
            stream(packed, true, u64::MAX).and_then(|mut it| it.read_to_end(&mut into)).map(|_| into)
        };
        let twice = [zstd.clone(), zstd.clone()].concat();
        assert_eq!(read(&twice).unwrap(), [bytes.clone(), bytes.clone()].concat());
        let cut = read(&twice[..zstd.len() * 3 / 2]).unwrap();
        assert!(cut.len() >= bytes.len() && cut.len() < 2 * bytes.len());
        assert_eq!(cut[..bytes.len()], bytes[..]);
        assert!(read(b"no zstd").is_err());
    }

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
        assert!(unpack(&zstd, "brotli", 400_000, &mut into).unwrap_err().contains("the compression `brotli`"));
    }
}
