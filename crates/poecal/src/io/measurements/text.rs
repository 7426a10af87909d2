//! The text of a file, its lines and the cells of a line.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, ErrorKind, Result};
use crate::io::hashes::Hashing;
use crate::io::source_text::position;

/// The whole text of a file; `expected` says what it should be.
pub(super) fn read_text(path: &Path, expected: &str) -> Result<String> {
    let mut bytes = Vec::new();
    open(path, expected)?.read_to_end(&mut bytes).map_err(|error| unreadable(path, &error, expected))?;
    String::from_utf8(bytes)
        .map_err(|error| not_utf8(path, error.as_bytes(), error.utf8_error().valid_up_to(), 0))
}

fn open(path: &Path, expected: &str) -> Result<File> {
    let file_error = |found: &str| {
        Error::new(ErrorKind::File, format!("found {found}, expected {expected}; check the name"))
            .in_file(path)
    };
    if path.is_dir() {
        return Err(file_error("a directory"));
    }
    File::open(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => file_error("no file of this name"),
        _ => unreadable(path, &error, expected),
    })
}

fn unreadable(path: &Path, error: &io::Error, expected: &str) -> Error {
    Error::new(ErrorKind::File, format!("cannot be read ({error}), expected {expected}")).in_file(path)
}

/// Bytes of a file that are held at a time, about.
const BLOCK: usize = 1 << 18;

/// Where a text comes from.
enum Source<'a> {
    File(Hashing<File>),
    Text(&'a [u8]),
}

/// A text in blocks of whole lines, so that a large file is never held whole.
pub(super) struct Blocks<'a> {
    path: &'a Path,
    /// What the file should be.
    expected: &'a str,
    source: Source<'a>,
    /// Bytes that are read at a time.
    size: usize,
    /// The block at hand.
    text: String,
    /// What follows it and has been read: no whole line.
    rest: Vec<u8>,
    /// What ends a line; none before the first block.
    newline: Option<u8>,
    /// Lines before the block at hand.
    lines: usize,
}

impl<'a> Blocks<'a> {
    /// The blocks of a file; `expected` says what it should be.
    pub(super) fn open(path: &'a Path, expected: &'a str) -> Result<Self> {
        let source = Source::File(Hashing::new(open(path, expected)?));
        Ok(Blocks { expected, ..Blocks::of(path, source, BLOCK) })
    }

    /// The blocks of a text; `path` is for the messages only.
    pub(super) fn new(path: &'a Path, text: &'a [u8]) -> Self {
        Blocks::sized(path, text, BLOCK)
    }

    /// The same, of which so many bytes are read at a time.
    pub(super) fn sized(path: &'a Path, text: &'a [u8], size: usize) -> Self {
        Blocks::of(path, Source::Text(text), size)
    }

    fn of(path: &'a Path, source: Source<'a>, size: usize) -> Self {
        let (expected, text, rest) = ("a table (CSV)", String::new(), Vec::new());
        Blocks { path, expected, source, size, text, rest, newline: None, lines: 0 }
    }

    /// Reads the next block; false at the end.
    pub(super) fn advance(&mut self) -> Result<bool> {
        let newline = self.newline.unwrap_or(b'\n');
        self.lines += memchr::memchr_iter(newline, self.text.as_bytes()).count();
        let mut bytes = std::mem::take(&mut self.text).into_bytes();
        bytes.clear();
        bytes.append(&mut self.rest);
        loop {
            let known = bytes.len();
            let size = self.size as u64;
            let more = match &mut self.source {
                Source::File(file) => file.take(size).read_to_end(&mut bytes),
                Source::Text(text) => text.take(size).read_to_end(&mut bytes),
            };
            let more = more.map_err(|error| unreadable(self.path, &error, self.expected))?;
            let end = memchr::memrchr(b'\n', bytes.get(known..).unwrap_or_default());
            if let Some(end) = end {
                self.rest.extend(bytes.drain(known + end + 1..));
            }
            if end.is_some() || more == 0 {
                break;
            }
        }
        let is_first = self.newline.is_none();
        if is_first {
            self.newline = Some(if memchr::memchr(b'\n', &bytes).is_some() { b'\n' } else { b'\r' });
        }
        // UTF-8 too, but no text: rather UTF-16 without its mark.
        if let Some(at) = memchr::memchr(0, &bytes) {
            return Err(not_utf8(self.path, &bytes, at, self.lines));
        }
        let text = String::from_utf8(bytes);
        self.text = text.map_err(|error| {
            not_utf8(self.path, error.as_bytes(), error.utf8_error().valid_up_to(), self.lines)
        })?;
        if is_first && self.text.starts_with('\u{feff}') {
            self.text.remove(0);
        }
        Ok(!self.text.is_empty())
    }

    /// The checksum of the file as far as it has been read; a text has none.
    pub(super) fn sha256(&self) -> Option<String> {
        match &self.source {
            Source::File(file) => Some(file.sha256()),
            Source::Text(_) => None,
        }
    }

    /// The lines of the block at hand, but for the first `skip` of the file.
    pub(super) fn lines(&self, skip: usize) -> Lines<'_> {
        Lines { rest: Some(&self.text), newline: self.newline.unwrap_or(b'\n'), number: self.lines, skip }
    }
}

/// The error of bytes that are no text, of which there are `lines` lines before these.
fn not_utf8(path: &Path, bytes: &[u8], valid: usize, lines: usize) -> Error {
    if lines == 0 && (bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])) {
        let message = "found UTF-16 text, expected UTF-8; save the file as `CSV UTF-8`";
        return Error::new(ErrorKind::Syntax, message).in_file(path);
    }
    let before = String::from_utf8_lossy(bytes.get(..valid).unwrap_or_default());
    let found = match bytes.get(valid) {
        None | Some(0) => "a NUL byte".to_owned(),
        Some(found) => format!("the byte 0x{found:02X}"),
    };
    let (line, column) = position(&before, before.len());
    let message = format!("found {found}, expected UTF-8 text; save the file as `CSV UTF-8`");
    Error::new(ErrorKind::Syntax, message).at(path, lines + line, column)
}

/// What stands between two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// Any run of blanks and tabs.
    Whitespace,
}

impl Separator {
    fn matches(self, c: char) -> bool {
        match self {
            Separator::Comma => c == ',',
            Separator::Semicolon => c == ';',
            Separator::Tab => c == '\t',
            Separator::Whitespace => c.is_whitespace(),
        }
    }

    /// As a byte, unless it is any run of blanks.
    fn byte(self) -> Option<u8> {
        match self {
            Separator::Comma => Some(b','),
            Separator::Semicolon => Some(b';'),
            Separator::Tab => Some(b'\t'),
            Separator::Whitespace => None,
        }
    }

    /// The first of semicolon, tab and comma that the header has outside quotes, else whitespace.
    pub(super) fn recognised(header: &str) -> Self {
        let unquoted = |separator: &Separator| {
            let mut quoted = false;
            header.chars().any(|c| {
                quoted ^= c == '"';
                !quoted && separator.matches(c)
            })
        };
        [Separator::Semicolon, Separator::Tab, Separator::Comma]
            .into_iter()
            .find(unquoted)
            .unwrap_or(Separator::Whitespace)
    }
}

/// Lines with their number (from 1) that are neither blank nor a comment (`#`).
pub(super) struct Lines<'a> {
    rest: Option<&'a str>,
    newline: u8,
    number: usize,
    skip: usize,
}

impl<'a> Lines<'a> {
    /// The next line, whatever it holds.
    fn line(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        let end = memchr::memchr(self.newline, rest.as_bytes());
        self.rest = end.and_then(|end| rest.get(end + 1..));
        Some(end.and_then(|end| rest.get(..end)).unwrap_or(rest))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let line = self.line()?;
            self.number += 1;
            let line = line.strip_suffix('\r').unwrap_or(line);
            let content = line.trim_start();
            if self.number > self.skip && !content.is_empty() && !content.starts_with('#') {
                return Some((self.number, line));
            }
        }
    }
}

/// One cell: its text without padding and quotes, and where it starts in the line (bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell<'a> {
    /// Text, in which a quote may still be doubled.
    pub(super) raw: &'a str,
    /// Byte offset of its first character, the quote if it has one.
    pub(super) offset: usize,
    escaped: bool,
}

impl<'a> Cell<'a> {
    /// The text as meant.
    pub(super) fn text(&self) -> Cow<'a, str> {
        if self.escaped { Cow::Owned(self.raw.replace("\"\"", "\"")) } else { Cow::Borrowed(self.raw) }
    }
}

/// Column (from 1, in characters) of a byte offset.
pub(super) fn character_column(line: &str, offset: usize) -> usize {
    line.char_indices().take_while(|(index, _)| *index < offset).count() + 1
}

/// Splits a line into cells.
///
/// On failure returns the byte offset and what was found and expected.
pub(super) fn split<'a>(
    line: &'a str,
    separator: Separator,
    cells: &mut Vec<Cell<'a>>,
) -> std::result::Result<(), (usize, &'static str)> {
    cells.clear();
    if let Some(separator) = separator.byte()
        && memchr::memchr(b'"', line.as_bytes()).is_none()
    {
        split_plainly(line, separator, cells);
        return Ok(());
    }
    let mut rest = line;
    loop {
        rest =
            rest.trim_start_matches(|c: char| c.is_whitespace() && separator != Separator::Tab || c == ' ');
        if rest.is_empty() && separator == Separator::Whitespace {
            return Ok(());
        }
        let offset = line.len() - rest.len();
        let (cell, after) = match rest.strip_prefix('"') {
            Some(quoted) => {
                let end = closing_quote(quoted).ok_or((
                    offset,
                    "found a quote that is not closed on its line, expected a closing `\"`",
                ))?;
                let (raw, after) = quoted.split_at(end);
                (Cell { raw, offset, escaped: raw.contains('"') }, after.strip_prefix('"').unwrap_or(after))
            }
            None => {
                let (raw, after) = rest.split_at(rest.find(|c| separator.matches(c)).unwrap_or(rest.len()));
                (Cell { raw: raw.trim_end(), offset, escaped: false }, after)
            }
        };
        cells.push(cell);
        let after = after.trim_start_matches(|c: char| c.is_whitespace() && !separator.matches(c));
        let mut characters = after.chars();
        match characters.next() {
            None => return Ok(()),
            Some(c) if separator.matches(c) => rest = characters.as_str(),
            Some(_) => {
                return Err((
                    line.len() - after.len(),
                    "found text after a closing quote, expected a separator",
                ));
            }
        }
    }
}

/// Splits a line without quotes.
fn split_plainly<'a>(line: &'a str, separator: u8, cells: &mut Vec<Cell<'a>>) {
    let mut start = 0;
    for end in memchr::memchr_iter(separator, line.as_bytes()).chain([line.len()]) {
        let piece = line.get(start..end).unwrap_or_default();
        // What surely has no padding.
        if let [first, .., last] | [first @ last] = piece.as_bytes()
            && first.is_ascii_graphic()
            && last.is_ascii_graphic()
        {
            cells.push(Cell { raw: piece, offset: start, escaped: false });
        } else {
            let trimmed = match separator {
                b'\t' => piece.trim_start_matches(' '),
                _ => piece.trim_start(),
            };
            let offset = start + piece.len() - trimmed.len();
            cells.push(Cell { raw: trimmed.trim_end(), offset, escaped: false });
        }
        start = end + 1;
    }
}

/// Byte index of the quote that ends a quoted cell; a doubled quote is part of the text.
fn closing_quote(text: &str) -> Option<usize> {
    let mut from = 0;
    loop {
        let at = from + text.get(from..)?.find('"')?;
        if !text.get(at + 1..)?.starts_with('"') {
            return Some(at);
        }
        from = at + 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(line: &str, separator: Separator) -> Vec<(String, usize)> {
        let mut cells = Vec::new();
        split(line, separator, &mut cells).unwrap();
        cells.iter().map(|cell| (cell.text().into_owned(), cell.offset)).collect()
    }

    fn owned(cells: &[(&str, usize)]) -> Vec<(String, usize)> {
        cells.iter().map(|(text, offset)| ((*text).to_owned(), *offset)).collect()
    }

    #[test]
    fn cells_keep_their_place() {
        assert_eq!(texts("a, b ,,d", Separator::Comma), owned(&[("a", 0), ("b", 3), ("", 6), ("d", 7)]));
        assert_eq!(texts("a;", Separator::Semicolon), owned(&[("a", 0), ("", 2)]));
        assert_eq!(texts("a\t\t b", Separator::Tab), owned(&[("a", 0), ("", 2), ("b", 4)]));
        assert_eq!(texts("  1,5 \t 2 ", Separator::Whitespace), owned(&[("1,5", 2), ("2", 8)]));
    }

    #[test]
    fn quotes_hold_separators_and_doubled_quotes() {
        assert_eq!(
            texts("\"a,b\" , \"say \"\"hi\"\"\",\"\"", Separator::Comma),
            owned(&[("a,b", 0), ("say \"hi\"", 8), ("", 21)])
        );
        let mut cells = Vec::new();
        assert_eq!(split("a,\"b", Separator::Comma, &mut cells).unwrap_err().0, 2);
        assert_eq!(split("\"b\"c,d", Separator::Comma, &mut cells).unwrap_err().0, 3);
    }

    #[test]
    fn the_separator_follows_from_the_header() {
        assert_eq!(Separator::recognised("a;b,c"), Separator::Semicolon);
        assert_eq!(Separator::recognised("\"a;b\",c"), Separator::Comma);
        assert_eq!(Separator::recognised("a\tb c"), Separator::Tab);
        assert_eq!(Separator::recognised("a b"), Separator::Whitespace);
    }

    #[test]
    fn a_file_that_fails_while_being_read_is_told() {
        let path = std::env::temp_dir().join(format!("poecal_text_{}", std::process::id()));
        // One that may be written only.
        let source = Source::File(Hashing::new(File::create(&path).unwrap()));
        let expected = "a measurement file (CSV)";
        let error =
            Blocks { expected, ..Blocks::of(&path, source, BLOCK) }.advance().unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(
            error.contains(": cannot be read (") && error.ends_with("), expected a measurement file (CSV)"),
            "{error}"
        );
    }
}
