//! Text of a file.

use std::io::{self, Cursor, Read};
use std::path::Path;

use super::configurations::{self, ConfigurationFolder};
use super::encodings::{is_utf16, not_utf8, of_utf16, of_windows_1252};
use super::lines::Lines;
use super::source_cells::SourceCells;
use poecal_numerics::error::{ErrorKind, Result, position};
use poecal_storage::hashes::HashingReader;
use poecal_storage::limits::ResourceLimit;
use poecal_storage::source::{self, Input, unreadable_error};

/// Approximate number of bytes held at a time.
const BLOCK: usize = 1 << 18;
/// Longest line, bytes.
const LONGEST_LINE: usize = 16 << 20;
/// Smallest number of lines of the first block.
const FIRST_LINES: usize = 64;

/// Source of a text.
enum TextSource {
    File(HashingReader<Input>),
    /// Text made of other files, with the checksum of their bytes.
    Made(Box<dyn Read + Send>, Option<String>),
}

/// A text in blocks of whole lines, so that large files are never held whole.
pub(crate) struct LineBlocks<'a> {
    path: &'a Path,
    /// Description of the file in messages.
    expected: &'a str,
    source: TextSource,
    /// Bytes per read.
    size: usize,
    /// The current block.
    text: String,
    /// The incomplete line after it.
    rest: Vec<u8>,
    /// Line ending; `None` before the first block.
    newline: Option<u8>,
    /// Number of lines before the current block.
    lines: usize,
    /// True if the text begins with a byte order mark.
    is_marked: bool,
    /// The blocks before the current one, if they are asked for.
    passed: Option<String>,
    /// True if bytes beyond ASCII are Windows-1252, and not UTF-8.
    is_windows: Option<bool>,
    /// Positions in the file of the lines of a text that was made of it.
    places: Option<SourceCells>,
    /// Notes and warnings on the file.
    said: FileRemarks,
}

/// Notes and warnings on the interpretation of a file, a sentence each.
#[derive(Clone, Debug, Default)]
pub(crate) struct FileRemarks {
    pub(crate) notes: Vec<String>,
    pub(crate) warnings: Vec<String>,
}

impl<'a> LineBlocks<'a> {
    /// The blocks of a file; `expected` describes it in messages.
    pub(crate) fn open(path: &'a Path, expected: &'a str) -> Result<Self> {
        let source = TextSource::File(HashingReader::new(source::open(path, expected, ResourceLimit::Table)?));
        Ok(LineBlocks::new(path, expected, source, BLOCK))
    }

    /// The blocks of a file, or of the table that the files of a folder make.
    pub(crate) fn open_or_join(path: &'a Path, expected: &'a str) -> Result<Self> {
        if !configurations::is_folder(path) {
            return LineBlocks::open(path, expected);
        }
        let ConfigurationFolder { text, sha256, left } = configurations::read(path)?;
        let mut blocks = LineBlocks::from_made_text(path, expected, Box::new(Cursor::new(text)), Some(sha256));
        blocks.said.warnings.extend(left.iter().map(ToString::to_string));
        Ok(blocks)
    }

    /// The blocks of a text that was made of a file or a folder, with the checksum of its bytes.
    pub(crate) fn from_made_text(
        path: &'a Path,
        expected: &'a str,
        text: Box<dyn Read + Send>,
        sha256: Option<String>,
    ) -> Self {
        LineBlocks::new(path, expected, TextSource::Made(text, sha256), BLOCK)
    }

    /// Adds the positions of its lines, and the notes and warnings.
    pub(crate) fn with_places(self, places: SourceCells, said: FileRemarks) -> Self {
        LineBlocks { places: Some(places), said, ..self }
    }

    /// The blocks of an input that is open.
    pub(crate) fn of_input(path: &'a Path, expected: &'a str, input: Input) -> Self {
        LineBlocks::new(path, expected, TextSource::File(HashingReader::new(input)), BLOCK)
    }

    /// The positions of the lines in the file of which they were made.
    pub(crate) fn places(&self) -> Option<&SourceCells> {
        self.places.as_ref()
    }

    /// Adds a note on the file.
    pub(crate) fn say(&mut self, note: String) {
        self.said.notes.push(note);
    }

    /// Takes the notes and warnings on the file.
    pub(crate) fn take_remarks(&mut self) -> FileRemarks {
        std::mem::take(&mut self.said)
    }

    /// The blocks of a text with the name `path` in messages, of `size` bytes per read.
    #[cfg(test)]
    pub(crate) fn with_block_size(path: &'a Path, text: &[u8], size: usize) -> Self {
        LineBlocks::new(path, "a table (CSV)", TextSource::Made(Box::new(Cursor::new(text.to_vec())), None), size)
    }

    fn new(path: &'a Path, expected: &'a str, source: TextSource, size: usize) -> Self {
        LineBlocks {
            path,
            expected,
            source,
            size,
            text: String::new(),
            rest: Vec::new(),
            newline: None,
            lines: 0,
            is_marked: false,
            passed: None,
            is_windows: None,
            places: None,
            said: FileRemarks::default(),
        }
    }

    /// Reads the next block; false at the end.
    pub(crate) fn advance(&mut self) -> Result<bool> {
        let newline = self.newline.unwrap_or(b'\n');
        self.lines += memchr::memchr_iter(newline, self.text.as_bytes()).count();
        if let Some(passed) = &mut self.passed {
            passed.push_str(&self.text);
        }
        let mut bytes = std::mem::take(&mut self.text).into_bytes();
        bytes.clear();
        bytes.append(&mut self.rest);
        loop {
            let known = bytes.len();
            let size = self.size as u64;
            let more = match &mut self.source {
                TextSource::File(file) => file.take(size).read_to_end(&mut bytes),
                TextSource::Made(text, _) => text.take(size).read_to_end(&mut bytes),
            };
            let more = more.map_err(|error| unreadable_error(self.path, &error, self.expected))?;
            let end = memchr::memrchr(b'\n', bytes.get(known..).unwrap_or_default());
            if let Some(end) = end {
                self.rest.extend(bytes.drain(known + end + 1..));
            }
            let is_text = memchr::memchr(0, bytes.get(known..).unwrap_or_default()).is_none();
            // The first block determines the form of the file.
            let is_enough =
                self.newline.is_some() || memchr::memchr_iter(b'\n', &bytes).take(FIRST_LINES).count() == FIRST_LINES;
            if end.is_some() && is_enough || more == 0 || !is_text {
                break;
            }
            bytes.append(&mut self.rest);
            let last = memchr::memrchr(b'\n', &bytes).map_or(0, |it| it + 1);
            if bytes.len() - last > LONGEST_LINE {
                return Err(ErrorKind::Syntax
                    .error(format!("found a line longer than {} MiB, expected a table (CSV)", LONGEST_LINE >> 20))
                    .at_line(self.path, self.lines + memchr::memchr_iter(b'\n', &bytes).count() + 1));
            }
        }
        let is_first = self.newline.is_none();
        if is_first && is_utf16(&bytes) {
            bytes = self.decode_utf16(bytes)?;
        }
        if is_first {
            self.newline = Some(if memchr::memchr(b'\n', &bytes).is_some() { b'\n' } else { b'\r' });
        }
        // The bytes are valid UTF-8, but no text: more likely UTF-16 without a byte order mark.
        if let Some(at) = memchr::memchr(0, &bytes) {
            return Err(not_utf8(self.path, &bytes, at, self.lines));
        }
        self.text = self.text_of(bytes)?;
        if is_first && self.text.starts_with('\u{feff}') {
            self.text.remove(0);
            self.is_marked = true;
        }
        Ok(!self.text.is_empty())
    }

    /// The text of bytes: UTF-8, or Windows-1252 if the first bytes beyond ASCII are no UTF-8.
    fn text_of(&mut self, bytes: Vec<u8>) -> Result<String> {
        if self.is_windows == Some(true) {
            return of_windows_1252(&bytes).map_err(|at| not_utf8(self.path, &bytes, at, self.lines));
        }
        if self.is_windows.is_none() && !bytes.is_ascii() {
            let is_utf8 = std::str::from_utf8(&bytes);
            self.is_windows = Some(is_utf8.is_err_and(|it| bytes[..it.valid_up_to()].is_ascii()));
            if self.is_windows == Some(true) && of_windows_1252(&bytes).is_ok() {
                let at = bytes.iter().position(|it| !it.is_ascii()).unwrap_or_default();
                let (line, _) = position(&String::from_utf8_lossy(&bytes[..at]), at);
                self.said.notes.push(format!(
                    "the text is Windows-1252, since line {} has the byte 0x{:02X}, which is no UTF-8",
                    self.lines + line,
                    bytes.get(at).copied().unwrap_or_default()
                ));
                return self.text_of(bytes);
            }
        }
        String::from_utf8(bytes)
            .map_err(|error| not_utf8(self.path, error.as_bytes(), error.utf8_error().valid_up_to(), self.lines))
    }

    /// The whole text of UTF-16 as UTF-8; it becomes the source, without its first block, which is returned.
    fn decode_utf16(&mut self, mut bytes: Vec<u8>) -> Result<Vec<u8>> {
        bytes.append(&mut self.rest);
        let most = ResourceLimit::Text.value();
        let more = match &mut self.source {
            TextSource::File(file) => file.take(most).read_to_end(&mut bytes),
            TextSource::Made(text, _) => text.take(most).read_to_end(&mut bytes),
        };
        more.map_err(|error| unreadable_error(self.path, &error, self.expected))?;
        if bytes.len() as u64 > most {
            return Err(ErrorKind::File.error(ResourceLimit::Text.exceeded_error("UTF-16")).in_file(self.path));
        }
        let text = of_utf16(&bytes).map_err(|(line, found)| {
            let message = format!("found {found}, expected UTF-16 text as before, or UTF-8");
            ErrorKind::Syntax.error(message).at_line(self.path, line)
        })?;
        let sha256 = self.sha256();
        self.said.notes.push("the text is UTF-16".to_owned());
        self.source = TextSource::Made(Box::new(io::empty()), sha256);
        Ok(text.into_bytes())
    }

    /// Reads the first block, if it has not been read.
    pub(crate) fn begin(&mut self) -> Result<bool> {
        if self.newline.is_none() { self.advance() } else { Ok(!self.text.is_empty()) }
    }

    /// The current block with all following ones, of a text that is held whole.
    pub(crate) fn rest(&mut self) -> Result<String> {
        self.begin()?;
        let mut all = String::new();
        loop {
            all.push_str(&self.text);
            if all.len() as u64 > ResourceLimit::Text.value() {
                let message = ResourceLimit::Text.exceeded_error("a file of this form");
                return Err(ErrorKind::File.error(message).in_file(self.path));
            }
            if !self.advance()? {
                return Ok(all);
            }
        }
    }

    /// Checksum of the bytes read so far; `None` for a text.
    pub(crate) fn sha256(&self) -> Option<String> {
        match &self.source {
            TextSource::File(file) => Some(file.sha256()),
            TextSource::Made(_, sha256) => sha256.clone(),
        }
    }

    /// Makes the blocks keep the passed text until it is taken.
    pub(crate) fn with_passed_text(self) -> Self {
        LineBlocks { passed: Some(String::new()), ..self }
    }

    /// Takes the text before the current block.
    pub(crate) fn take_passed_text(&mut self) -> String {
        self.passed.take().unwrap_or_default()
    }

    /// The current block.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// True if the text begins with a byte order mark, which no block has.
    pub(crate) fn is_marked(&self) -> bool {
        self.is_marked
    }

    /// Lines of the current block, without the first `skip` of the file.
    pub(crate) fn lines(&self, skip: usize) -> Lines<'_> {
        Lines { rest: Some(&self.text), newline: self.newline.unwrap_or(b'\n'), number: self.lines, skip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines without the first `skip`, and the number of blocks, if `size` bytes are read at a time.
    fn lines(text: &str, skip: usize, size: usize) -> (Vec<(usize, String)>, usize) {
        let mut blocks = LineBlocks::with_block_size(Path::new("x.csv"), text.as_bytes(), size);
        let (mut found, mut count) = (Vec::new(), 0);
        while blocks.advance().unwrap() {
            count += 1;
            found.extend(blocks.lines(skip).map(|(number, line)| (number, line.to_owned())));
        }
        (found, count)
    }

    #[test]
    fn blank_lines_and_comments_count_but_are_passed_over() {
        assert_eq!(
            lines("\u{feff}# note\r\n\r\na\r\n  # b\r\nc", 0, BLOCK).0,
            [(3, "a".to_owned()), (5, "c".to_owned())]
        );
        assert_eq!(lines("title\na", 1, BLOCK).0, [(2, "a".to_owned())]);
        assert_eq!(lines("a\rb", 0, BLOCK).0, [(1, "a".to_owned()), (2, "b".to_owned())]);
        assert_eq!(lines("#N/A,1\n#NAME\n#N/A 1", 0, BLOCK).0, [(1, "#N/A,1".to_owned())]);
    }

    /// The text has comments and blank lines, some before all others, a byte order mark, and characters of several bytes.
    #[test]
    fn lines_are_the_same_however_the_blocks_fall() {
        let line = |k: usize| match k {
            ..40 | 999 => "# µ".to_owned(),
            _ if k.is_multiple_of(7) => " ".repeat(k % 2),
            _ => format!("{k},{}€𝄞", "x".repeat(k % 90)),
        };
        let rows: Vec<String> = (0..3000).map(line).collect();
        let told = |(_, row): &(usize, String)| !row.starts_with('#') && !row.trim().is_empty();
        let expected: Vec<(usize, String)> = (1..).zip(rows.clone()).filter(told).collect();
        for newline in ["\n", "\r\n", "\r"] {
            for text in [rows.join(newline), format!("\u{feff}{}{newline}", rows.join(newline))] {
                for size in [1, 2, 3, 7, 100, 4096, BLOCK] {
                    let (found, count) = lines(&text, 0, size);
                    println!("{newline:?}, {size} bytes at a time: {} lines in {count} blocks", found.len());
                    assert!(found == expected, "{newline:?} {size}");
                    // A block ends with a line, none of more than 200 bytes; without `\n`, it ends with the text.
                    let least = if newline == "\r" { 1 } else { text.len() / (size + 200) };
                    assert!(count >= least, "{newline:?} {size}: {count}");
                }
            }
        }
    }

    #[test]
    fn a_file_that_fails_while_being_read_is_told() {
        /// A reader that breaks off.
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                Err(std::io::Error::other("the cable was pulled"))
            }
        }
        let path = Path::new("x.csv");
        let source = TextSource::File(HashingReader::new(Input::from_reader(Box::new(Broken))));
        let expected = "a measurement file (CSV)";
        let error = LineBlocks::new(path, expected, source, BLOCK).advance().unwrap_err().to_string();
        assert_eq!(error, "x.csv: the file cannot be read (the cable was pulled), expected a measurement file (CSV)");
    }
}
