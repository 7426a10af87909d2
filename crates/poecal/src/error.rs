//! The one error type: a sentence that says where, what was found, what was expected and what to do.

use std::fmt;
use std::path::{Path, PathBuf};

/// What went wrong, as a word that does not change between versions.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// A file could not be read or written.
    File,
    /// The text is not of the form it should be (XML, TOML, JSON, CSV).
    Syntax,
    /// A robot model that is well formed but cannot be used.
    Model,
    /// A measurement file that is well formed but cannot be used.
    Measurement,
    /// A unit that is not known, or does not fit its quantity.
    Unit,
    /// An option that is out of range or contradicts another.
    Option,
    /// Too few or unsuitable measurements for what is asked.
    Problem,
    /// Written files did not reproduce the fitted model.
    Export,
    /// The solver could not produce a usable result.
    Solver,
}

/// Where in a file: line and column count from 1, a column in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(self.path.display().to_string()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
            if let Some(column) = self.column {
                write!(f, ":{column}")?;
            }
        }
        Ok(())
    }
}

/// An error that reads as one sentence.
///
/// ```
/// use poecal::{Error, ErrorKind};
/// let error = Error::new(ErrorKind::Unit, "found unit `inch`, expected a length (m, cm, mm, um)").at("points.csv", 1, 14);
/// assert_eq!(error.to_string(), "points.csv:1:14: found unit `inch`, expected a length (m, cm, mm, um)");
/// assert_eq!(error.kind(), ErrorKind::Unit);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(Box<Inner>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Inner {
    kind: ErrorKind,
    place: Option<Place>,
    message: String,
}

impl Error {
    /// An error without a place; `message` says what was found, what was expected and what to do. Control characters of a text that it
    /// quotes are written out, so that it is one line and moves no terminal's cursor.
    ///
    /// ```
    /// use poecal::{Error, ErrorKind};
    /// assert_eq!(Error::new(ErrorKind::Syntax, "found `a\tb\n`").message(), r"found `a\tb\n`");
    /// ```
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Error(Box::new(Inner { kind, place: None, message: one_line(message.into()) }))
    }

    /// The same error at a line and column (both from 1) of a file.
    #[must_use]
    pub fn at(mut self, path: impl AsRef<Path>, line: usize, column: usize) -> Self {
        self.0.place =
            Some(Place { path: path.as_ref().to_path_buf(), line: Some(line), column: Some(column) });
        self
    }

    /// The same error at a line (from 1) of a file.
    #[must_use]
    pub fn at_line(mut self, path: impl AsRef<Path>, line: usize) -> Self {
        self.0.place = Some(Place { path: path.as_ref().to_path_buf(), line: Some(line), column: None });
        self
    }

    /// The same error in a file, if it has no place yet.
    #[must_use]
    pub fn in_file(mut self, path: impl AsRef<Path>) -> Self {
        if self.0.place.is_none() {
            self.0.place = Some(Place { path: path.as_ref().to_path_buf(), line: None, column: None });
        }
        self
    }

    /// The same error, if it has a place, at the same line and column of another file.
    pub(crate) fn with_path(mut self, path: &Path) -> Self {
        if let Some(place) = &mut self.0.place {
            place.path = path.to_path_buf();
        }
        self
    }

    /// The kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Where it happened, when it happened in a file.
    #[must_use]
    pub fn place(&self) -> Option<&Place> {
        self.0.place.as_ref()
    }

    /// The sentence without the place.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.0.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.0.message)
    }
}

impl std::error::Error for Error {}

/// The text with its control characters, and whatever else ends a line, written out (`\n`, `\u{1b}`).
pub(crate) fn one_line(text: String) -> String {
    let breaks = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    if !text.contains(breaks) {
        return text;
    }
    let mut line = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if breaks(c) { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

/// Names that a message lists at most.
const NAMES_LISTED: usize = 12;

/// Result of the library's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// The candidate nearest to `word` by edit distance, for "did you mean"; none if each differs by more than half of the word.
///
/// ```
/// assert_eq!(poecal::nearest("jiont1", ["joint1", "joint2", "x"]), Some("joint1"));
/// assert_eq!(poecal::nearest("jiont1", ["x", "temperature"]), None);
/// ```
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let furthest = (word.chars().count() / 2).max(1);
    let distances = candidates.into_iter().map(|candidate| (edit_distance(word, candidate), candidate));
    let (_, near) =
        distances.filter(|(distance, _)| *distance <= furthest).min_by_key(|(distance, _)| *distance)?;
    Some(near)
}

/// What a message says of the names that `word` could have been: the nearest, or else the first few.
pub(crate) fn nearest_or_all(word: &str, candidates: &[&str]) -> String {
    match nearest(word, candidates.iter().copied()) {
        Some(near) => format!("the nearest is `{near}`"),
        None if candidates.is_empty() => "but there is none".to_owned(),
        None => format!("there are {}", first_few(candidates)),
    }
}

/// The names, or the first of many.
pub(crate) fn first_few(names: &[&str]) -> String {
    match names.get(..NAMES_LISTED) {
        Some(first) if names.len() > NAMES_LISTED => format!("{}, …", first.join(", ")),
        _ => names.join(", "),
    }
}

/// Damerau's edit distance: insertions, deletions, substitutions and swaps of neighbours, case ignored.
pub(crate) fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    // rows[i][j]: distance between the first i characters of a and the first j of b.
    let mut rows: Vec<Vec<usize>> = (0..=a.len()).map(|i| (i..=i + b.len()).collect()).collect();
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let substitution = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = substitution.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_whatever_it_quotes() {
        let error = Error::new(ErrorKind::Syntax, "found `a\r\n\u{1b}[2J\u{2028}\tµ`").at("a\nb.csv", 1, 2);
        assert_eq!(error.to_string(), r"a\nb.csv:1:2: found `a\r\n\u{1b}[2J\u{2028}\tµ`");
    }
}
