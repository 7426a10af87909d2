//! Lines and cells of texts in other forms.

/// A finite number of a cell, with a decimal point or, where there is no other, a decimal comma.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    let is_plain = text.bytes().all(|it| it.is_ascii_digit() || b"+-.eE,".contains(&it));
    if !is_plain || text.is_empty() {
        return None;
    }
    let is_comma = text.contains(',') && !text.contains('.');
    let found = if is_comma { text.replacen(',', ".", 1).parse() } else { text.parse() };
    found.ok().filter(|it: &f64| it.is_finite())
}

/// Cells of a line, without blanks around them and without quotes; empty ones at the end are left out.
pub(super) fn cells(line: &str, separator: char) -> Vec<&str> {
    let mut found: Vec<&str> = line
        .split(separator)
        .map(|it| {
            let it = it.trim();
            it.strip_prefix('"').and_then(|it| it.strip_suffix('"')).unwrap_or(it)
        })
        .collect();
    while found.last().is_some_and(|it| it.is_empty()) {
        found.pop();
    }
    found
}

/// Lines with text, with their numbers from 1.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty())
}

/// Separator of a line of a table: the first of semicolon, tab and comma that it has, else blanks.
pub(super) fn separator(line: &str) -> char {
    [';', '\t', ','].into_iter().find(|it| line.contains(*it)).unwrap_or(' ')
}

/// Cells of a line, by its separator or by blanks.
pub(super) fn split(line: &str, by: char) -> Vec<&str> {
    if by == ' ' { line.split_whitespace().collect() } else { cells(line, by) }
}
