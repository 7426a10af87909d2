//! Text cells of CSV output, protected from execution by a spreadsheet and read back unchanged.

use std::borrow::Cow;

/// Prefix of a text that a spreadsheet would run.
const MARK: char = '\'';

/// True if a cell with this beginning would be run or misread.
pub fn is_run(c: char) -> bool {
    matches!(c, '=' | '+' | '-' | '@' | '\t' | '\r' | '\n')
}

/// A text as a cell. A text that a spreadsheet would run, or that begins with an apostrophe, receives a leading apostrophe, unless it is a number.
/// Quotes are added if necessary.
pub fn cell(text: &str) -> Cow<'_, str> {
    if is_plain(text) {
        return text.into();
    }
    let is_marked = text.starts_with(MARK) || text.starts_with(is_run) && !is_number(text);
    let padded = text.starts_with(char::is_whitespace) || text.ends_with(char::is_whitespace);
    // A line that begins with # would be a comment.
    if padded || text.starts_with('#') || text.contains([',', ';', '"', '\n', '\r', '\t']) {
        let mark = if is_marked { "'" } else { "" };
        return format!("\"{mark}{}\"", text.replace('"', "\"\"")).into();
    }
    if is_marked { format!("{MARK}{text}").into() } else { text.into() }
}

/// True if a text is surely an unchanged cell: digits with a point, letters.
fn is_plain(text: &str) -> bool {
    let body = text.strip_prefix('-').unwrap_or(text);
    let mut points = 0;
    let is_number = !body.is_empty()
        && body.bytes().all(|it| {
            points += usize::from(it == b'.');
            it.is_ascii_digit() || it == b'.'
        });
    is_number && points < 2 && body != "." || text.bytes().all(|it| it.is_ascii_alphanumeric())
}

/// The text of a cell, without the apostrophe of [`cell`].
pub fn plain_cell(text: &str) -> &str {
    match text.strip_prefix(MARK) {
        Some(rest) if rest.starts_with(|c| c == MARK || is_run(c)) => rest,
        _ => text,
    }
}

/// True if a text is a number with a sign and nothing else.
pub fn is_number(text: &str) -> bool {
    let characters = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    text.chars().all(characters) && text.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_spreadsheet_would_run_is_marked() {
        let cases = [
            ("=1+1", "'=1+1"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("-2+3", "'-2+3"),
            ("+cmd", "'+cmd"),
            ("-5", "-5"),
            ("+1.5e3", "+1.5e3"),
            ("-inf", "'-inf"),
            ("'x", "''x"),
            ("x'", "x'"),
            ("\tx", "\"'\tx\""),
            ("=a,b", "\"'=a,b\""),
            ("say \"hi\"", "\"say \"\"hi\"\"\""),
            ("#1", "\"#1\""),
            ("a b", "a b"),
            (" a", "\" a\""),
            ("", ""),
        ];
        for (text, expected) in cases {
            assert_eq!(cell(text), expected);
        }
        // An apostrophe in a foreign file stays.
        assert_eq!((plain_cell("'abc"), plain_cell("'"), plain_cell("5'")), ("'abc", "'", "5'"));
    }
}
