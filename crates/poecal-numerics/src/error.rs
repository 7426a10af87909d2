//! The one error type: a sentence with place, found, expected and remedy.

use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};

use crate::text::escape_invisible;

/// Kind of an error, as a word that does not change between versions.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::error::ErrorKind;
/// # }
/// use poecal::ErrorKind;
/// let error = ErrorKind::Unit.error("found unit `inch`, expected a length (m, cm, mm, um)");
/// assert_eq!(error.kind(), ErrorKind::Unit);
/// ```
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// A file could not be read or written.
    File,
    /// The text is not of the expected form (XML, TOML, JSON, CSV).
    Syntax,
    /// A robot model that is well formed but cannot be used.
    Model,
    /// A measurement file that is well formed but cannot be used.
    Measurement,
    /// A unit that is unknown, or does not fit its quantity.
    Unit,
    /// An option that is out of range or contradicts another.
    Option,
    /// Too few or unsuitable measurements for the request.
    Problem,
    /// Written files did not reproduce the fitted model.
    Export,
    /// The solver could not produce a usable result.
    Solver,
}

impl ErrorKind {
    /// [`Error::new`] of this kind.
    pub fn error(self, message: impl Into<String>) -> Error {
        Error::new(self, message)
    }

    /// The same error as a result.
    ///
    /// # Errors
    /// Always.
    pub fn refuse<T>(self, message: impl Into<String>) -> Result<T> {
        Err(Error::new(self, message))
    }
}

/// Place in a file: line and column count from 1, a column in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePosition {
    /// The file, as the user named it.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&escape_invisible(&self.path.display().to_string()))?;
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
/// # mod poecal {
/// #     pub use poecal_numerics::error::{Error, ErrorKind};
/// # }
/// use poecal::{Error, ErrorKind};
/// let error = Error::new(ErrorKind::Unit, "found unit `inch`, expected a length (m, cm, mm, um)").at_position("points.csv", 1, 14);
/// assert_eq!(error.to_string(), "points.csv:1:14: found unit `inch`, expected a length (m, cm, mm, um)");
/// assert_eq!(error.kind(), ErrorKind::Unit);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(Box<ErrorData>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct ErrorData {
    kind: ErrorKind,
    place: Option<FilePosition>,
    message: String,
    choices: Option<Choices>,
    missing: Option<MissingColumn>,
}

/// Content of a column that a file lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingColumn {
    /// Readings of a joint.
    Joint,
    /// A coordinate of a position.
    Position,
    /// Other content.
    Other,
}

/// Possible values of an option, if nothing else decides.
///
/// ```
/// # mod poecal {
/// #     pub use poecal_numerics::error::ErrorKind;
/// # }
/// use poecal::ErrorKind;
/// let two = ErrorKind::Model.error("found two ends").with_choices("--tip-link", vec!["b".to_owned(), "c".to_owned()]);
/// let choices = two.choices().ok_or("no choices")?;
/// assert_eq!((choices.option, choices.of.join(" ")), ("--tip-link", "b c".to_owned()));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Choices {
    /// Option, as it is typed.
    pub option: &'static str,
    /// Possible values.
    pub of: Vec<String>,
}

impl Error {
    /// An error without a place; `message` has found, expected and remedy. Control characters of a text that it quotes are written
    /// out, so that it is one line and moves no terminal's cursor.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        let message = with_names_shown(message.into());
        Error(Box::new(ErrorData {
            kind,
            place: None,
            message: escape_invisible(&message).into_owned(),
            choices: None,
            missing: None,
        }))
    }

    /// The same error at a line and column (both from 1) of a file.
    #[must_use]
    pub fn at_position(mut self, path: impl AsRef<Path>, line: usize, column: usize) -> Self {
        self.0.place = Some(FilePosition { path: path.as_ref().to_path_buf(), line: Some(line), column: Some(column) });
        self
    }

    /// The same error at a byte offset of a file's text.
    pub fn at_offset(self, path: &Path, text: &str, offset: usize) -> Self {
        let (line, column) = position(text, offset);
        self.at_position(path, line, column)
    }

    /// The same error at a line (from 1) of a file.
    #[must_use]
    pub fn at_line(mut self, path: impl AsRef<Path>, line: usize) -> Self {
        self.0.place = Some(FilePosition { path: path.as_ref().to_path_buf(), line: Some(line), column: None });
        self
    }

    /// The same error in a file, if it has no place yet.
    #[must_use]
    pub fn in_file(mut self, path: impl AsRef<Path>) -> Self {
        if self.0.place.is_none() {
            self.0.place = Some(FilePosition { path: path.as_ref().to_path_buf(), line: None, column: None });
        }
        self
    }

    /// The same error, if it has a place, without a line.
    pub fn without_line(mut self) -> Self {
        if let Some(place) = &mut self.0.place {
            (place.line, place.column) = (None, None);
        }
        self
    }

    /// The same error, if it has a place, at the same line and column of another file.
    pub fn with_path(mut self, path: &Path) -> Self {
        if let Some(place) = &mut self.0.place {
            place.path = path.to_path_buf();
        }
        self
    }

    /// The same error, with an addition.
    pub fn with_more(mut self, more: &str) -> Self {
        self.0.message.push_str("; ");
        self.0.message.push_str(&escape_invisible(more));
        self
    }

    /// The same error, with possible values of an option.
    pub fn with_choices(mut self, option: &'static str, of: Vec<String>) -> Self {
        self.0.choices = Some(Choices { option, of });
        self
    }

    /// The same error, with the content of a missing column.
    pub fn of_missing(mut self, column: MissingColumn) -> Self {
        self.0.missing = Some(column);
        self
    }

    /// The same error, with the content of its column, if one is missing.
    pub fn if_missing(self, column: MissingColumn) -> Self {
        if self.missing_column().is_some() { self.of_missing(column) } else { self }
    }

    /// Content of a missing column, if one is missing.
    #[must_use]
    pub fn missing_column(&self) -> Option<MissingColumn> {
        self.0.missing
    }

    /// Possible values, if a choice is missing.
    #[must_use]
    pub fn choices(&self) -> Option<&Choices> {
        self.0.choices.as_ref()
    }

    /// Kind of error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Place of the error, if it is in a file.
    #[must_use]
    pub fn place(&self) -> Option<&FilePosition> {
        self.0.place.as_ref()
    }

    /// Sentence without the place.
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

/// Line and column (from 1, the column in characters) of a byte offset.
pub fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before.get(line_start..).unwrap_or("").trim_start_matches('\u{feff}').chars().count() + 1)
}

/// Largest number of names in a message.
const NAMES_LISTED: usize = 12;
/// Number of letters of a name that are shown, if it has more than [`LONG_NAME`].
const NAME_SHOWN: usize = 60;
/// Largest number of letters of a name that is shown whole.
const LONG_NAME: usize = 120;
/// Largest number of letters of names that are compared: nobody mistypes longer ones, and the work grows with the square.
const LONGEST_COMPARED: usize = 64;

/// Result of the library's fallible functions.
///
/// ```
/// let refused: poecal_numerics::error::Result<()> = poecal_numerics::error::ErrorKind::Option.refuse("found `--count 0`, expected 1 or more");
/// assert!(refused.is_err());
/// ```
pub type Result<T> = std::result::Result<T, Error>;

/// Candidate nearest to `word` by edit distance, for "did you mean"; `None` if each differs by more than half of the word.
pub fn nearest_word<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = letters(word)?;
    let furthest = (letters / 2).max(1);
    let distances = candidates.into_iter().filter_map(|candidate| {
        let distance = distance_within(word, candidate, furthest)?;
        Some((distance, candidate))
    });
    Some(distances.min_by_key(|(distance, _)| *distance)?.1)
}

/// Words of a message about the names that `word` could have been: the nearest, or else the first few.
pub fn nearest_or_all(word: &str, candidates: &[&str]) -> String {
    match nearest_word(word, candidates.iter().copied()) {
        Some(near) => format!("the nearest is `{near}`"),
        None if candidates.is_empty() => "but there is none".to_owned(),
        None => format!("there are {}", first_few(candidates)),
    }
}

/// The names, or the first of many, each as [`shorten_name`].
pub fn first_few<T: AsRef<str>>(names: &[T]) -> String {
    let first: Vec<Cow<'_, str>> = names.iter().take(NAMES_LISTED).map(|name| shorten_name(name.as_ref())).collect();
    format!("{}{}", first.join(", "), if names.len() > NAMES_LISTED { ", …" } else { "" })
}

/// A name as in messages and tables: only the beginning if it is very long.
pub fn shorten_name(name: &str) -> Cow<'_, str> {
    match (name.char_indices().nth(NAME_SHOWN), name.char_indices().nth(LONG_NAME)) {
        (Some((end, _)), Some(_)) => Cow::Owned(format!("{}…", name.get(..end).unwrap_or_default())),
        _ => Cow::Borrowed(name),
    }
}

/// A message with each name in backticks as [`shorten_name`]: a file may choose any names.
fn with_names_shown(message: String) -> String {
    if message.len() <= LONG_NAME {
        return message;
    }
    let parts: Vec<Cow<'_, str>> = message.split('`').map(shown_unless_a_sentence).collect();
    parts.join("`")
}

/// Words between two names stay unchanged; they have spaces, and are not as long as a name in a file may be.
fn shown_unless_a_sentence(part: &str) -> Cow<'_, str> {
    const LONGEST_SENTENCE: usize = 4000;
    if part.contains(' ') && part.len() <= LONGEST_SENTENCE { Cow::Borrowed(part) } else { shorten_name(part) }
}

/// Number of letters of a word that is short enough to be compared.
fn letters(word: &str) -> Option<usize> {
    // A letter has four bytes at most: for a longer word not even the letters are counted.
    let count = (word.len() <= 4 * LONGEST_COMPARED).then(|| word.chars().count());
    count.filter(|count| *count <= LONGEST_COMPARED)
}

/// Damerau's edit distance (insertions, deletions, substitutions and swaps of neighbours, case ignored) if it is at most `furthest`.
pub fn distance_within(a: &str, b: &str, furthest: usize) -> Option<usize> {
    let (a_letters, b_letters) = (letters(a)?, letters(b)?);
    // Small letters may be more than large ones, by one in three at most.
    if a_letters.abs_diff(b_letters) > furthest + LONGEST_COMPARED / 4 {
        return None;
    }
    let distance = strsim::osa_distance(&a.to_lowercase(), &b.to_lowercase());
    (distance <= furthest).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_a_million_letters_are_neither_compared_nor_shown() {
        let long = "j".repeat(1_000_000);
        let longer = format!("{long}k");
        assert_eq!(nearest_word(&long, [longer.as_str(), "joint1"]), None);
        assert_eq!(nearest_word("joint2", [longer.as_str(), "joint1"]), Some("joint1"));
        let start = format!("{}…", "j".repeat(60));
        assert_eq!(first_few(&[&long, "joint1"]), format!("{start}, joint1"));
        let error = Error::new(ErrorKind::Model, format!("found `{long}`, expected `{longer}`"));
        assert_eq!(error.message(), format!("found `{start}`, expected `{start}`"));
        let spaced = Error::new(ErrorKind::Model, format!("found `{}`", "a ".repeat(500_000)));
        assert!(spaced.message().len() < 200, "{}", spaced.message().len());
    }

    #[test]
    fn what_a_message_says_is_not_cut() {
        let sentence = "found `joint` in the file, expected a number of some kind; ".repeat(20);
        assert_eq!(Error::new(ErrorKind::Model, sentence.clone()).message(), sentence);
        assert_eq!(shorten_name(&"é".repeat(120)), "é".repeat(120));
        assert_eq!(shorten_name(&"é".repeat(121)), format!("{}…", "é".repeat(60)));
    }

    #[test]
    fn swaps_of_neighbours_count_once() {
        for (a, b, distance) in
            [("jiont1", "joint1", 1), ("", "ab", 2), ("X", "x", 0), ("ca", "abc", 3), ("kitten", "sitting", 3)]
        {
            assert_eq!(distance_within(a, b, 9), Some(distance), "{a} {b}");
        }
        assert_eq!(distance_within("kitten", "sitting", 2), None);
    }

    #[test]
    fn an_error_is_one_line_whatever_it_quotes() {
        let error = Error::new(ErrorKind::Syntax, "found `a\r\n\u{1b}[2J\u{2028}\tµ`").at_position("a\nb.csv", 1, 2);
        assert_eq!(error.to_string(), r"a\u{a}b.csv:1:2: found `a\u{d}\u{a}\u{1b}[2J\u{2028}\u{9}µ`");
    }

    #[test]
    fn a_word_too_far_from_all_has_no_nearest() {
        assert_eq!(nearest_word("jiont1", ["joint1", "joint2", "x"]), Some("joint1"));
        assert_eq!(nearest_word("jiont1", ["x", "temperature"]), None);
    }

    #[test]
    fn positions_count_characters_from_one() {
        assert_eq!(position("ab\r\nµm x", 0), (1, 1));
        assert_eq!(position("ab\r\nµm x", 7), (2, 3));
        assert_eq!(position("\u{feff}ab", 4), (1, 2));
        assert_eq!(position("ab", 99), (1, 3));
    }
}
