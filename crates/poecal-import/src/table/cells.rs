//! Cells of a line.

use std::borrow::Cow;
use std::path::Path;

use serde::Serialize;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::csv_text::plain_cell;

/// Separator of cells.
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
    pub(crate) fn matches(self, c: char) -> bool {
        match self {
            Separator::Comma => c == ',',
            Separator::Semicolon => c == ';',
            Separator::Tab => c == '\t',
            Separator::Whitespace => c.is_whitespace(),
        }
    }

    /// The separator with this character.
    pub(crate) fn from_char(c: char) -> Option<Self> {
        match c {
            ',' => Some(Separator::Comma),
            ';' => Some(Separator::Semicolon),
            '\t' => Some(Separator::Tab),
            ' ' => Some(Separator::Whitespace),
            _ => None,
        }
    }

    /// Name in messages.
    pub(crate) fn symbol(self) -> &'static str {
        match self {
            Separator::Comma => "`,`",
            Separator::Semicolon => "`;`",
            Separator::Tab => "tabs",
            Separator::Whitespace => "blanks",
        }
    }

    /// Its byte, unless it is any run of blanks.
    fn byte(self) -> Option<u8> {
        match self {
            Separator::Comma => Some(b','),
            Separator::Semicolon => Some(b';'),
            Separator::Tab => Some(b'\t'),
            Separator::Whitespace => None,
        }
    }

    /// The first of semicolon, tab and comma that the header has outside quotes, else whitespace.
    pub(crate) fn recognise(header: &str) -> Self {
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

/// One cell: its text without padding and quotes, and its byte offset in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell<'a> {
    /// Text; doubled quotes are still doubled.
    pub(crate) raw: &'a str,
    /// Byte offset of its first character or quote.
    pub offset: usize,
    escaped: bool,
}

impl<'a> Cell<'a> {
    /// An empty cell.
    pub(crate) const EMPTY: Self = Cell { raw: "", offset: 0, escaped: false };

    /// The text without doubled quotes, and without the apostrophe with which our own files protect texts that a spreadsheet would run.
    pub fn text(&self) -> Cow<'a, str> {
        let text = plain_cell(self.raw);
        if self.escaped { Cow::Owned(text.replace("\"\"", "\"")) } else { Cow::Borrowed(text) }
    }
}

/// Column (from 1, in characters) of a byte offset.
pub(crate) fn character_column(line: &str, offset: usize) -> usize {
    line.char_indices().take_while(|(index, _)| *index < offset).count() + 1
}

/// Splits a line into cells.
///
/// A failure returns the byte offset, the text that was found and the expected one.
pub fn split<'a>(
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
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() && separator != Separator::Tab || c == ' ');
        if rest.is_empty() && separator == Separator::Whitespace {
            return Ok(());
        }
        let offset = line.len() - rest.len();
        let (cell, after) = match rest.strip_prefix('"') {
            Some(quoted) => {
                let end = closing_quote(quoted)
                    .ok_or((offset, "found a quote that is not closed on its line, expected a closing `\"`"))?;
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
                return Err((line.len() - after.len(), "found text after a closing quote, expected a separator"));
            }
        }
    }
}

/// Splits a line without quotes.
fn split_plainly<'a>(line: &'a str, separator: u8, cells: &mut Vec<Cell<'a>>) {
    let mut start = 0;
    for end in memchr::memchr_iter(separator, line.as_bytes()).chain([line.len()]) {
        let piece = line.get(start..end).unwrap_or_default();
        // Fast path: surely without padding.
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

/// Byte index of the closing quote of a quoted cell; a doubled quote is text.
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

/// [`split`], with its failure as an error.
pub(crate) fn split_line<'a>(
    path: &Path,
    line: usize,
    text: &'a str,
    separator: Separator,
    cells: &mut Vec<Cell<'a>>,
) -> Result<()> {
    split(text, separator, cells).map_err(|(offset, message)| {
        ErrorKind::Syntax.error(message).at_position(path, line, character_column(text, offset))
    })
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_core::{Rng as _, SeedableRng as _};

    use super::*;
    use poecal_storage::csv_text::{cell, is_number, is_run};

    fn texts(line: &str, separator: Separator) -> Vec<(String, usize)> {
        let mut cells = Vec::new();
        split(line, separator, &mut cells).unwrap();
        cells.iter().map(|cell| (cell.text().into_owned(), cell.offset)).collect()
    }

    fn own_cells(cells: &[(&str, usize)]) -> Vec<(String, usize)> {
        cells.iter().map(|(text, offset)| ((*text).to_owned(), *offset)).collect()
    }

    #[test]
    fn cells_keep_their_place() {
        assert_eq!(texts("a, b ,,d", Separator::Comma), own_cells(&[("a", 0), ("b", 3), ("", 6), ("d", 7)]));
        assert_eq!(texts("a;", Separator::Semicolon), own_cells(&[("a", 0), ("", 2)]));
        assert_eq!(texts("a\t\t b", Separator::Tab), own_cells(&[("a", 0), ("", 2), ("b", 4)]));
        assert_eq!(texts("  1,5 \t 2 ", Separator::Whitespace), own_cells(&[("1,5", 2), ("2", 8)]));
    }

    #[test]
    fn quotes_hold_separators_and_doubled_quotes() {
        assert_eq!(
            texts("\"a,b\" , \"say \"\"hi\"\"\",\"\"", Separator::Comma),
            own_cells(&[("a,b", 0), ("say \"hi\"", 8), ("", 21)])
        );
        let mut cells = Vec::new();
        assert_eq!(split("a,\"b", Separator::Comma, &mut cells).unwrap_err().0, 2);
        assert_eq!(split("\"b\"c,d", Separator::Comma, &mut cells).unwrap_err().0, 3);
    }

    #[test]
    fn the_separator_follows_from_the_header() {
        assert_eq!(Separator::recognise("a;b,c"), Separator::Semicolon);
        assert_eq!(Separator::recognise("\"a;b\",c"), Separator::Comma);
        assert_eq!(Separator::recognise("a\tb c"), Separator::Tab);
        assert_eq!(Separator::recognise("a b"), Separator::Whitespace);
    }

    #[test]
    fn every_text_reads_back_the_same() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let alphabet: Vec<char> = "'=+-@\t\r\n,;\"#ab1.e \u{1b}\u{202e}µ".chars().collect();
        let mut pick = |count: usize| (generator.next_u32() as usize) % count;
        for _ in 0..20_000 {
            let length = pick(6);
            let text: String = (0..length).map(|_| alphabet[pick(alphabet.len())]).collect();
            let written = cell(&text);
            let line = format!("{written},{written}");
            let mut cells = Vec::new();
            split(&line, Separator::Comma, &mut cells).unwrap();
            assert_eq!(cells.len(), 2, "{line}");
            for found in cells {
                assert_eq!(found.text(), text, "{written}");
                assert!(!found.raw.starts_with(is_run) || is_number(found.raw), "{written}");
            }
        }
    }
}
