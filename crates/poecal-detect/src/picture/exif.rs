//! Orientation of a picture, by its EXIF data.

/// Tag of the orientation, and its type: a number of 16 bits.
const ORIENTATION: u16 = 0x112;
const SHORT: u16 = 3;
/// Bytes of an entry.
const ENTRY: usize = 12;

/// The orientation, 1 to 8, in EXIF data that begin with the header of TIFF.
pub(crate) fn orientation(exif: &[u8]) -> Option<u8> {
    let is_little = match exif.get(..4)? {
        b"II*\0" => true,
        b"MM\0*" => false,
        _ => return None,
    };
    let short = |bytes: &[u8], at: usize| {
        let own = bytes.get(at..at + 2)?.try_into().ok()?;
        Some(if is_little { u16::from_le_bytes(own) } else { u16::from_be_bytes(own) })
    };
    let long = |bytes: &[u8], at: usize| {
        let own = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(if is_little { u32::from_le_bytes(own) } else { u32::from_be_bytes(own) })
    };
    // Only the first list of entries concerns the picture; others concern its thumbnail.
    let list = exif.get(usize::try_from(long(exif, 4)?).ok()?..)?;
    let count = usize::from(short(list, 0)?);
    let is_it =
        |entry: &&[u8]| (short(entry, 0), short(entry, 2), long(entry, 4)) == (Some(ORIENTATION), Some(SHORT), Some(1));
    let entry = list.get(2..)?.chunks_exact(ENTRY).take(count).find(is_it)?;
    u8::try_from(short(entry, 8)?).ok().filter(|it| (1..=8).contains(it))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of one entry, behind another, in either order of bytes.
    fn write_entry(is_little: bool, [tag, kind, count, value]: [u16; 4]) -> Vec<u8> {
        let short = |it: u16| if is_little { it.to_le_bytes() } else { it.to_be_bytes() };
        let long = |it: u16| if is_little { [short(it), [0; 2]] } else { [[0; 2], short(it)] }.concat();
        let entry = |[tag, kind, count, value]: [u16; 4]| {
            [&short(tag)[..], &short(kind), &long(count), &short(value), &[0; 2]].concat()
        };
        let mark: &[u8] = if is_little { b"II*\0" } else { b"MM\0*" };
        let entries = [entry([0x100, 4, 1, 6]), entry([tag, kind, count, value])].concat();
        [mark, &long(10), &[0; 2], &short(2), &entries].concat()
    }

    #[test]
    fn the_orientation_is_found_in_either_order_of_bytes() {
        for is_little in [false, true] {
            for value in 0..300 {
                let expected = if (1..=8).contains(&value) { Some(value as u8) } else { None };
                assert_eq!(orientation(&write_entry(is_little, [0x112, 3, 1, value])), expected);
            }
            // Other tags, types and counts.
            for other in [[0x113, 3, 1, 6], [0x112, 4, 1, 6], [0x112, 3, 2, 6]] {
                assert_eq!(orientation(&write_entry(is_little, other)), None);
            }
            let whole = write_entry(is_little, [0x112, 3, 1, 6]);
            for size in 0..whole.len() {
                assert_eq!(orientation(&whole[..size]), None, "{size}");
            }
        }
        assert_eq!(orientation(b"Exif\0\0MM\0*"), None);
        assert_eq!(orientation(b"II*\0\xff\xff\xff\xff"), None);
    }
}
