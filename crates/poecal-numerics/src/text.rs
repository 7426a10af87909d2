//! Text from files and other external sources, made safe for display: nothing in it can act on a terminal, reorder a line, or hide.

use std::borrow::Cow;
use std::fmt::Write as _;

use serde::Serialize;

/// Lines of a file that are counted, of which messages name the first ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NamedLines {
    /// Number of lines.
    pub count: usize,
    /// The first ones.
    pub first_lines: Vec<usize>,
}

/// Largest number of lines that are named.
const NAMED_LINES: usize = 5;

impl NamedLines {
    /// Adds a line.
    pub fn add(&mut self, line: usize) {
        self.count += 1;
        if self.first_lines.len() < NAMED_LINES && self.first_lines.last() != Some(&line) {
            self.first_lines.push(line);
        }
    }

    /// First lines in words.
    #[must_use]
    pub fn words(&self) -> String {
        let lines: Vec<String> = self.first_lines.iter().map(usize::to_string).collect();
        let word = if lines.len() == 1 { "line" } else { "lines" };
        let more = if self.count > NAMED_LINES { ", …" } else { "" };
        format!("{word} {}{more}", lines.join(", "))
    }
}

impl FromIterator<usize> for NamedLines {
    fn from_iter<I: IntoIterator<Item = usize>>(lines: I) -> Self {
        let mut found = NamedLines::default();
        lines.into_iter().for_each(|line| found.add(line));
        found
    }
}

/// The text with every character that would act instead of being visible written as its number. These are control characters, line
/// breaks among them, marks of writing direction, and characters without width.
#[must_use]
pub fn escape_invisible(text: &str) -> Cow<'_, str> {
    made_visible(text, acts)
}

/// The same for a text that has lines of its own, which stay.
#[must_use]
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    made_visible(text, |c| c != '\n' && acts(c))
}

/// The same for HTML or SVG, where breaks of lines and tabs are blanks. It is applied to the whole, so that no part can be forgotten.
#[must_use]
pub fn visible_markup(text: impl Into<String>) -> String {
    let text = text.into();
    let shown = match made_visible(&text, |c| !matches!(c, '\n' | '\t' | '\r') && acts(c)) {
        Cow::Borrowed(_) => None,
        Cow::Owned(shown) => Some(shown),
    };
    shown.unwrap_or(text)
}

/// Number of bytes of a text that are searched together.
const PIECE: usize = 256;

fn made_visible(text: &str, hides: impl Fn(char) -> bool) -> Cow<'_, str> {
    // Most pieces are plain, which a test of many bytes at a time proves.
    let hides_breaks = hides('\n');
    let is_plain = |byte: u8| (b' '..=b'~').contains(&byte) || byte == b'\n' && !hides_breaks;
    let has_hidden = |start: usize| {
        let end = text.ceil_char_boundary((start + PIECE).min(text.len()));
        let piece = &text[text.floor_char_boundary(start)..end];
        !piece.bytes().fold(true, |plain, byte| plain & is_plain(byte)) && piece.contains(&hides)
    };
    if !(0..text.len()).step_by(PIECE).any(has_hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if hides(c) {
            // Writing to a String cannot fail.
            let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// True if a character acts instead of being visible.
pub fn acts(c: char) -> bool {
    // Most text is plain.
    if (' '..='~').contains(&c) {
        return false;
    }
    c.is_control()
        || matches!(c,
            // Soft hyphen, combining joiner, fillers, and vowel separators without width.
            '\u{ad}' | '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' | '\u{3164}' | '\u{ffa0}'
            // Marks of direction.
            | '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{206f}'
            // Characters without width, and breaks of lines and paragraphs.
            | '\u{200b}'..='\u{200d}' | '\u{2028}' | '\u{2029}' | '\u{2060}'..='\u{2065}' | '\u{feff}'
            // Annotations, non-characters, and tags.
            | '\u{fff0}'..='\u{fffb}' | '\u{fffe}' | '\u{ffff}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_is_written_as_its_number() {
        let acting =
            ['\0', '\t', '\n', '\r', '\u{1b}', '\u{7f}', '\u{9b}', '\u{61c}', '\u{200b}', '\u{200f}', '\u{202e}'];
        for c in acting.into_iter().chain(['\u{2028}', '\u{2066}', '\u{2069}', '\u{feff}', '\u{ad}', '\u{e0041}']) {
            let text = format!("a{c}b");
            assert_eq!(escape_invisible(&text), format!("a\\u{{{:x}}}b", u32::from(c)));
        }
        for plain in ["", "a b", "Ärger", "关节", "مفصل", "θ₁ é ° µ €", "a\\b", "🤖"] {
            assert!(matches!(escape_invisible(plain), Cow::Borrowed(_)), "{plain}");
        }
        assert_eq!(visible_lines("a\nb\u{85}"), "a\nb\\u{85}");
    }

    #[test]
    fn no_character_gets_through_that_acts() {
        let all: String = (0..=u32::from(char::MAX)).filter_map(char::from_u32).collect();
        let shown = escape_invisible(&all);
        assert!(!shown.chars().any(acts));
        assert_eq!(escape_invisible(&shown), shown);
    }

    #[test]
    fn markup_keeps_its_lines_and_tabs() {
        assert_eq!(visible_markup("<b>\ta\u{202e}</b>\r\n"), "<b>\ta\\u{202e}</b>\r\n");
    }
}
