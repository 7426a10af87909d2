//! Texts that are not UTF-8 from programs of instruments: UTF-16, and Windows-1252 with Latin-1.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, position};

/// Characters of the bytes from 0x80 to 0x9F; bytes without a character have `\0`.
const WINDOWS: [char; 32] = [
    '€', '\0', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\0', 'Ž', '\0', '\0', '‘', '’', '“', '”', '•',
    '–', '—', '˜', '™', 'š', '›', 'œ', '\0', 'ž', 'Ÿ',
];

/// True if bytes are the beginning of UTF-16: with a byte order mark, or every other byte of the first two characters is zero.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0xff, 0xfe])
        || bytes.starts_with(&[0xfe, 0xff])
        || matches!(bytes, [0, 1..=255, 0, 1..=255, ..] | [1..=255, 0, 1..=255, 0, ..])
}

/// The text of UTF-16; else the line and the defect.
pub(crate) fn of_utf16(bytes: &[u8]) -> Result<String, (usize, &'static str)> {
    let is_big = bytes.starts_with(&[0xfe, 0xff]) || bytes.first() == Some(&0);
    let marked = bytes.strip_prefix(&[0xff, 0xfe]).or_else(|| bytes.strip_prefix(&[0xfe, 0xff]));
    let (pairs, odd) = marked.unwrap_or(bytes).as_chunks::<2>();
    let units = pairs.iter().map(|it| if is_big { u16::from_be_bytes(*it) } else { u16::from_le_bytes(*it) });
    let mut text = String::with_capacity(pairs.len());
    let line = |text: &str| 1 + text.matches('\n').count();
    for character in char::decode_utf16(units) {
        match character {
            Ok('\0') => return Err((line(&text), "a NUL character")),
            Ok(character) => text.push(character),
            Err(_) => return Err((line(&text), "half a character")),
        }
    }
    if odd.is_empty() { Ok(text) } else { Err((line(&text), "an odd number of bytes")) }
}

/// The text of Windows-1252, which contains Latin-1 except control characters; else the index of a byte that is no character.
pub(crate) fn of_windows_1252(bytes: &[u8]) -> Result<String, usize> {
    let mut text = String::with_capacity(bytes.len() + bytes.len() / 8);
    for (at, &byte) in bytes.iter().enumerate() {
        let character = match byte {
            0x80..=0x9f => WINDOWS.get(usize::from(byte) - 0x80).copied().unwrap_or('\0'),
            _ => char::from(byte),
        };
        if character == '\0' {
            return Err(at);
        }
        text.push(character);
    }
    Ok(text)
}

/// The error for bytes that are no text, after this number of lines.
pub(crate) fn not_utf8(path: &Path, bytes: &[u8], valid: usize, lines: usize) -> Error {
    let before = String::from_utf8_lossy(bytes.get(..valid).unwrap_or_default());
    let found = match bytes.get(valid) {
        None | Some(0) => "a NUL byte".to_owned(),
        Some(found) => format!("the byte 0x{found:02X}"),
    };
    let (line, column) = position(&before, before.len());
    ErrorKind::Syntax.error(format!("found {found}, expected text; save the file as `CSV UTF-8`")).at_position(
        path,
        lines + line,
        column,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_windows_and_utf16_are_read() {
        assert_eq!(of_windows_1252(b"\xb5m \xb0 \x80 \x93x\x94"), Ok("µm ° € “x”".to_owned()));
        assert_eq!(of_windows_1252(b"ab\x81"), Err(2));
        for is_big in [false, true] {
            for is_marked in [false, true] {
                let text = "a;b\nµ;𝄞\n";
                let marked = if is_marked { format!("\u{feff}{text}") } else { text.to_owned() };
                let units = marked.encode_utf16();
                let bytes: Vec<u8> =
                    units.flat_map(|it| if is_big { it.to_be_bytes() } else { it.to_le_bytes() }).collect();
                assert!(is_utf16(&bytes));
                assert_eq!(of_utf16(&bytes).as_deref(), Ok(text), "{is_big} {is_marked}");
                assert_eq!(of_utf16(&bytes[..bytes.len() - 1]), Err((2, "an odd number of bytes")));
            }
        }
        assert!(!is_utf16(b"a,b\n"));
        assert!(!is_utf16(b""));
    }
}
