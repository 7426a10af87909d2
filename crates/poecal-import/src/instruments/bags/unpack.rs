//! Unpacks chunks.

use std::io::Read;

use lz4_flex::frame::FrameDecoder as Lz4;
use ruzstd::decoding::StreamingDecoder as Zstd;

/// Puts the bytes of a chunk that is packed in this way into `into`, up to one beyond the size that it states; an error says what was found.
pub(crate) fn unpack(packed: &[u8], how: &str, stated: u64, into: &mut Vec<u8>) -> Result<(), String> {
    into.clear();
    let most = stated.saturating_add(1);
    let read = match how {
        "lz4" => Lz4::new(packed).take(most).read_to_end(into).map_err(|error| error.to_string()),
        "zstd" => frames(packed, most, into),
        other => Err(format!("the compression `{other}`, expected zstd, lz4 or none")),
    };
    if into.len() as u64 > stated {
        return Err(format!("more than {stated} bytes, expected as many"));
    }
    read.map(|_| ())
}

/// All frames of zstd.
fn frames(mut packed: &[u8], most: u64, into: &mut Vec<u8>) -> Result<usize, String> {
    while !packed.is_empty() && (into.len() as u64) < most {
        let mut frame = Zstd::new(packed).map_err(|error| error.to_string())?;
        let rest = most - into.len() as u64;
        frame.by_ref().take(rest).read_to_end(into).map_err(|error| error.to_string())?;
        packed = frame.into_inner();
    }
    Ok(into.len())
}
