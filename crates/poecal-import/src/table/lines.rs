//! Lines of a text.

/// Lines with their number (from 1) that are neither blank nor a comment (`#`).
#[derive(Clone)]
pub(crate) struct Lines<'a> {
    pub(super) rest: Option<&'a str>,
    pub(super) newline: u8,
    pub(super) number: usize,
    pub(super) skip: usize,
}

impl<'a> Lines<'a> {
    /// The next line, including comments and blank ones.
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
            if self.number > self.skip && !content.is_empty() && !is_comment(content) {
                return Some((self.number, line));
            }
        }
    }
}

/// Error values of spreadsheets; other lines that begin with `#` are comments.
const SPREADSHEET_ERRORS: [&str; 7] = ["#N/A", "#NV", "#VALUE!", "#WERT!", "#REF!", "#DIV/0!", "#NAME?"];

/// True if a line is blank or a comment.
fn is_comment(content: &str) -> bool {
    let is_cell = |error: &str| {
        let rest = content.strip_prefix(error);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with([',', ';', '\t']))
    };
    content.starts_with('#') && !SPREADSHEET_ERRORS.into_iter().any(is_cell)
}
