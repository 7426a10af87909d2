//! Workbooks, bags and pictures: bytes whose checksums are corrected, so that the data behind them are reached.

use poecal_detect::{BoardSpec, Detector, GrayPicture};
use poecal_storage::limits::{self, ResourceLimit, ResourceLimits};

use super::recorded::{NAMES, read_files};
use crate::properties::one_line;
use crate::{BETWEEN, LONGEST};

/// Limits for an input of this size.
fn low_limits() -> ResourceLimits {
    [
        (ResourceLimit::Cells, 50_000),
        (ResourceLimit::Unpacked, 4 << 20),
        (ResourceLimit::Bag, 8 << 20),
        (ResourceLimit::Chunk, 1 << 20),
        (ResourceLimit::Topics, 500),
        (ResourceLimit::Poses, 20_000),
        (ResourceLimit::Rows, 5_000),
        (ResourceLimit::Columns, 500),
    ]
    .into_iter()
    .fold(ResourceLimits::default(), |all, (limit, most)| all.with_limit(limit, most))
}

/// Files, of which one may be a companion; their bytes are mended.
fn files(data: &[u8], mend: impl Fn(&[u8]) -> Vec<u8>) -> Vec<Vec<u8>> {
    let between = format!("\n{BETWEEN}{BETWEEN}\n");
    let at = data.windows(between.len()).position(|it| it == between.as_bytes());
    match at {
        Some(at) => vec![mend(&data[..at]), data[at + between.len()..].to_vec()],
        None => vec![mend(data)],
    }
}

fn read(data: &[u8], mend: impl Fn(&[u8]) -> Vec<u8>) -> bool {
    if data.len() > LONGEST {
        return false;
    }
    let files = files(data, mend);
    let named: Vec<(&str, &[u8])> = NAMES.into_iter().zip(files.iter().map(Vec::as_slice)).collect();
    limits::run_with_limits(low_limits(), || read_files(&named))
}

/// A workbook: an old one as it is, or the parts of an archive, each a line with its name and its content; optionally with a table.
pub fn workbooks(data: &[u8]) -> bool {
    read(data, |bytes| {
        let is_text = !bytes.starts_with(b"PK") && !bytes.starts_with(b"\xd0\xcf");
        if is_text { archive(bytes) } else { bytes.to_vec() }
    })
}

/// A bag as it is, optionally with a table.
pub fn bags(data: &[u8]) -> bool {
    read(data, <[u8]>::to_vec)
}

/// Bytes before the first of these, and behind them.
fn split_at_bytes<'a>(bytes: &'a [u8], at: &[u8]) -> (&'a [u8], Option<&'a [u8]>) {
    match bytes.windows(at.len()).position(|it| it == at) {
        Some(place) => (&bytes[..place], Some(&bytes[place + at.len()..])),
        None => (bytes, None),
    }
}

/// An uncompressed archive of parts.
fn archive(parts: &[u8]) -> Vec<u8> {
    let (mut bytes, mut list, mut count) = (Vec::new(), Vec::new(), 0_u16);
    let (between, mut rest) = (format!("\n{BETWEEN}\n"), Some(parts));
    while let Some(all) = rest {
        let part;
        (part, rest) = split_at_bytes(all, between.as_bytes());
        let (name, content) = split_at_bytes(part, b"\n");
        let (name, content) = (&name[..name.len().min(200)], content.unwrap_or_default());
        let start = (bytes.len() as u32).to_le_bytes();
        let size = (content.len() as u32).to_le_bytes();
        let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        head.extend(crc32fast::hash(content).to_le_bytes());
        head.extend([size, size].concat());
        head.extend((name.len() as u16).to_le_bytes());
        head.extend([0, 0]);
        bytes.extend([b"PK\x03\x04", &head[..], name, content].concat());
        list.extend([b"PK\x01\x02\x14\0", &head[..], &[0; 10], &start, name].concat());
        count = count.saturating_add(1);
    }
    let (start, size) = ((bytes.len() as u32).to_le_bytes(), (list.len() as u32).to_le_bytes());
    let count = count.to_le_bytes();
    bytes.extend(list);
    bytes.extend([&b"PK\x05\x06\0\0\0\0"[..], &count, &count, &size, &start, &[0, 0]].concat());
    bytes
}

/// A picture, which is searched for boards of dots and of squares if it is small. Its size is that of its header, and its levels are numbers.
pub fn pictures(data: &[u8]) -> bool {
    /// Most pixels of a picture, and of one that is searched.
    const MOST: [u64; 2] = [1_000_000, 40_000];
    if data.len() > LONGEST {
        return false;
    }
    let bytes = if data.starts_with(b"\x89PNG") { mend_checksums(data) } else { data.to_vec() };
    let GrayPicture { gray, .. } = match GrayPicture::decode_up_to(&bytes, "input".as_ref(), MOST[0]) {
        Ok(picture) => picture,
        Err(refused) => {
            one_line(&refused.error.to_string());
            return false;
        }
    };
    let count = gray.levels().len();
    assert!(count == gray.width() * gray.height() && count as u64 <= MOST[0]);
    assert!(gray.levels().iter().all(|it| (0.0..=255.0).contains(it)));
    if count as u64 <= MOST[1] {
        for words in ["circles:4x3:10mm", "chessboard:5x4:10mm", "charuco:4x3:20mm:15mm:DICT_4X4_50"] {
            let Ok(spec) = words.parse::<BoardSpec>() else { continue };
            let found = Detector::new(&spec).with_most_dots(500).detect(&gray);
            let corners = found.iter().flat_map(|it| &it.corners);
            corners.for_each(|it| assert!(it.u_px.is_finite() && it.v_px.is_finite() && it.sigma_px > 0.0));
        }
    }
    true
}

/// A PNG file with the checksums of its chunks.
fn mend_checksums(data: &[u8]) -> Vec<u8> {
    let (mut bytes, mut at) = (data.to_vec(), 8);
    while let Some(size) = bytes.get(at..at + 4).and_then(|it| <[u8; 4]>::try_from(it).ok()) {
        let end = (at + 8).saturating_add(u32::from_be_bytes(size) as usize);
        let Some(own) = bytes.get(at + 4..end) else { break };
        let checksum = crc32fast::hash(own).to_be_bytes();
        let Some(place) = bytes.get_mut(end..end + 4) else { break };
        place.copy_from_slice(&checksum);
        at = end + 4;
    }
    bytes
}
