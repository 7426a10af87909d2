//! The text of a file in blocks, and the lines of a block.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, ErrorKind, Result};
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

/// Bytes of a block, about.
const BLOCK: usize = 1 << 18;

/// Whole lines of a text.
pub(super) struct Block {
    text: String,
    newline: u8,
    /// Lines before the first.
    lines: usize,
}

impl Block {
    /// The lines but for the first `skip` of the whole text.
    pub(super) fn lines(&self, skip: usize) -> Lines<'_> {
        Lines { rest: Some(&self.text), newline: self.newline, number: self.lines, skip }
    }
}

/// A text in blocks, so that a large file is never held whole.
pub(super) struct Blocks<'a> {
    path: &'a Path,
    source: Box<dyn Read + 'a>,
    returned: Option<Block>,
    /// What has been read beyond the last block.
    rest: Vec<u8>,
    /// What ends a line; none before the first block.
    newline: Option<u8>,
    /// Lines of the blocks so far.
    lines: usize,
}

impl<'a> Blocks<'a> {
    /// The blocks of a file; `expected` says what it should be.
    pub(super) fn open(path: &'a Path, expected: &str) -> Result<Self> {
        Ok(Blocks::new(path, open(path, expected)?))
    }

    /// The blocks of any text; `path` is for the messages only.
    pub(super) fn new(path: &'a Path, source: impl Read + 'a) -> Self {
        let source = Box::new(source);
        Blocks { path, source, returned: None, rest: Vec::new(), newline: None, lines: 0 }
    }

    /// Gives a block back, to be the next.
    pub(super) fn put_back(&mut self, block: Block) {
        self.returned = Some(block);
    }

    /// The next block; none at the end.
    pub(super) fn next(&mut self) -> Result<Option<Block>> {
        if let Some(block) = self.returned.take() {
            return Ok(Some(block));
        }
        let bytes = self.whole_lines()?;
        if bytes.is_empty() {
            return Ok(None);
        }
        let is_first = self.newline.is_none();
        let found = || if memchr::memchr(b'\n', &bytes).is_some() { b'\n' } else { b'\r' };
        let newline = *self.newline.get_or_insert_with(found);
        let lines = self.lines;
        self.lines += memchr::memchr_iter(newline, &bytes).count();
        let mut text = String::from_utf8(bytes).map_err(|error| {
            not_utf8(self.path, error.as_bytes(), error.utf8_error().valid_up_to(), lines)
        })?;
        if is_first && text.starts_with('\u{feff}') {
            text.remove(0);
        }
        Ok(Some(Block { text, newline, lines }))
    }

    /// Reads on to the end of a line, or of the text; nothing at the end.
    fn whole_lines(&mut self) -> Result<Vec<u8>> {
        let mut bytes = std::mem::take(&mut self.rest);
        loop {
            let known = bytes.len();
            let more = self.source.by_ref().take(BLOCK as u64).read_to_end(&mut bytes);
            let more = more.map_err(|error| unreadable(self.path, &error, "a table (CSV)"))?;
            let end = memchr::memrchr(b'\n', bytes.get(known..).unwrap_or_default());
            if let Some(end) = end {
                self.rest.extend(bytes.drain(known + end + 1..));
            }
            if end.is_some() || more == 0 {
                return Ok(bytes);
            }
        }
    }
}

/// The error of bytes that are no text, of which there are `lines` lines before these.
fn not_utf8(path: &Path, bytes: &[u8], valid: usize, lines: usize) -> Error {
    if lines == 0 && (bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])) {
        let message = "found UTF-16 text, expected UTF-8; save the file as `CSV UTF-8`";
        return Error::new(ErrorKind::Syntax, message).in_file(path);
    }
    let before = String::from_utf8_lossy(bytes.get(..valid).unwrap_or_default());
    let found = bytes.get(valid).copied().unwrap_or_default();
    let (line, column) = position(&before, before.len());
    let message = format!("found the byte 0x{found:02X}, expected UTF-8 text; save the file as `CSV UTF-8`");
    Error::new(ErrorKind::Syntax, message).at(path, lines + line, column)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, skip: usize) -> Vec<(usize, String)> {
        let mut blocks = Blocks::new(Path::new("x.csv"), text.as_bytes());
        let mut found = Vec::new();
        while let Some(block) = blocks.next().unwrap() {
            found.extend(block.lines(skip).map(|(number, line)| (number, line.to_owned())));
        }
        found
    }

    #[test]
    fn blank_lines_and_comments_count_but_are_passed_over() {
        assert_eq!(
            lines("\u{feff}# note\r\n\r\na\r\n  # b\r\nc", 0),
            [(3, "a".to_owned()), (5, "c".to_owned())]
        );
        assert_eq!(lines("title\na", 1), [(2, "a".to_owned())]);
        assert_eq!(lines("a\rb", 0), [(1, "a".to_owned()), (2, "b".to_owned())]);
    }

    #[test]
    fn lines_are_the_same_however_the_blocks_fall() {
        for newline in ["\n", "\r\n", "\r"] {
            for last in ["", newline] {
                let row = |k: usize| format!("{k},{}µ", "x".repeat(k % 300));
                let rows: Vec<String> = (1..5000).map(row).collect();
                let found = lines(&(rows.join(newline) + last), 0);
                println!(
                    "{} lines in {} blocks",
                    found.len(),
                    found.iter().map(|(_, row)| row.len()).sum::<usize>() / BLOCK + 1
                );
                assert!(found.into_iter().eq((1..).zip(rows)));
            }
        }
        let text = "a,b\n".repeat(BLOCK) + "\u{fffd}";
        let bytes = &text.as_bytes()[..text.len() - 1];
        let mut blocks = Blocks::new(Path::new("x.csv"), bytes);
        let error = (0..).find_map(|_| blocks.next().err()).unwrap();
        assert!(
            error.to_string().starts_with(&format!("x.csv:{}:1: found the byte 0xEF", BLOCK + 1)),
            "{error}"
        );
    }
}
