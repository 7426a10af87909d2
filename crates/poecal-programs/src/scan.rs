//! Words, numbers and signs of a program, with their bytes.

use std::ops::Range;

use super::number::Number;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::limits::ResourceLimit;

/// Syntax of a language.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LexicalRules {
    /// Beginnings of a comment, which ends with the line.
    pub(crate) comments: &'static [&'static str],
    /// Signs around texts, which end with the line at the latest.
    pub(crate) quotes: &'static [u8],
    /// Signs that words may contain beside letters, digits and `_`; they may also begin with them.
    pub(crate) letters: &'static [u8],
    /// True if an open bracket continues the statement in the next line.
    pub(crate) is_open_in_brackets: bool,
}

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TokenKind {
    /// A name or a keyword.
    Word,
    /// A number without its sign: value and number of decimals.
    Number(f64, usize),
    /// A text in quotes.
    Text,
    /// Any other sign.
    Sign(u8),
    /// The end of a line.
    LineEnd,
}

/// A piece of a program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Token {
    /// Kind of the token.
    pub(crate) kind: TokenKind,
    /// Its bytes.
    pub(crate) range: Range<usize>,
    /// Its line, from 1.
    pub(crate) line: usize,
}

impl Token {
    /// True if it is this sign.
    pub(crate) fn is(&self, sign: u8) -> bool {
        self.kind == TokenKind::Sign(sign)
    }

    /// True if it is an opening bracket.
    fn opens(&self) -> bool {
        matches!(self.kind, TokenKind::Sign(b'(' | b'[' | b'{'))
    }

    /// True if it is a closing bracket.
    fn closes(&self) -> bool {
        matches!(self.kind, TokenKind::Sign(b')' | b']' | b'}'))
    }

    /// Its bytes as text.
    pub(crate) fn text<'t>(&self, text: &'t [u8]) -> &'t str {
        text.get(self.range.clone()).and_then(|it| std::str::from_utf8(it).ok()).unwrap_or("")
    }

    /// True if it is this word; case does not matter.
    pub(crate) fn is_word(&self, text: &[u8], word: &str) -> bool {
        self.kind == TokenKind::Word && self.text(text).eq_ignore_ascii_case(word)
    }
}

/// The tokens of a program, one by one.
#[derive(Clone, Debug)]
pub(crate) struct Scanner<'t> {
    text: &'t [u8],
    rules: &'t LexicalRules,
    at: usize,
    line: usize,
    depth: usize,
}

impl<'t> Scanner<'t> {
    pub(crate) fn new(text: &'t [u8], rules: &'t LexicalRules) -> Self {
        let at = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner { text, rules, at, line: 1, depth: 0 }
    }

    /// The tokens up to the next line end, without it; `None` at the end of the text.
    pub(crate) fn statement(&mut self, out: &mut Vec<Token>) -> Option<()> {
        out.clear();
        loop {
            match self.next() {
                None => return (!out.is_empty()).then_some(()),
                Some(token) if token.kind == TokenKind::LineEnd => return Some(()),
                Some(token) => out.push(token),
            }
        }
    }

    fn end_of_line(&self) -> usize {
        let rest = &self.text[self.at..];
        self.at + rest.iter().position(|it| matches!(it, b'\n' | b'\r')).unwrap_or(rest.len())
    }

    fn is_letter(&self, byte: u8) -> bool {
        byte.is_ascii_alphabetic() || byte == b'_' || byte >= 0x80 || self.rules.letters.contains(&byte)
    }
}

impl Iterator for Scanner<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        loop {
            let byte = *self.text.get(self.at)?;
            let start = self.at;
            let token = |kind: TokenKind, end: usize, line: usize| Some(Token { kind, range: start..end, line });
            match byte {
                b'\n' | b'\r' => {
                    let both = self.text[self.at..].starts_with(b"\r\n");
                    self.at += if both { 2 } else { 1 };
                    self.line += 1;
                    if self.depth == 0 || !self.rules.is_open_in_brackets {
                        self.depth = 0;
                        return token(TokenKind::LineEnd, self.at, self.line - 1);
                    }
                }
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                _ if self.rules.comments.iter().any(|it| self.text[start..].starts_with(it.as_bytes())) => {
                    self.at = self.end_of_line();
                }
                _ if self.rules.quotes.contains(&byte) => {
                    let line_end = self.end_of_line();
                    let inside = self.text.get(start + 1..line_end).unwrap_or_default();
                    let closing = inside.iter().position(|it| *it == byte);
                    self.at = closing.map_or(line_end, |it| start + 2 + it);
                    return token(TokenKind::Text, self.at, self.line);
                }
                _ if self.is_letter(byte) => {
                    let rest = &self.text[start..];
                    let length = rest.iter().position(|&it| !self.is_letter(it) && !it.is_ascii_digit());
                    self.at += length.unwrap_or(rest.len());
                    return token(TokenKind::Word, self.at, self.line);
                }
                _ => {
                    if let Some((length, value, decimals)) = number(&self.text[start..]) {
                        self.at += length;
                        return token(TokenKind::Number(value, decimals), self.at, self.line);
                    }
                    self.at += 1;
                    match byte {
                        b'(' | b'[' | b'{' => self.depth += 1,
                        b')' | b']' | b'}' => self.depth = self.depth.saturating_sub(1),
                        _ => {}
                    }
                    return token(TokenKind::Sign(byte), self.at, self.line);
                }
            }
        }
    }
}

/// Refuses brackets nested beyond the limit: each level is read, and its contents once more.
///
/// # Errors
/// [`ErrorKind::Syntax`], with the line.
pub(crate) fn refuse_nested(text: &[u8], rules: &LexicalRules) -> Result<()> {
    let mut depths = [0_usize; 3];
    for token in Scanner::new(text, rules) {
        let TokenKind::Sign(sign) = token.kind else {
            if token.kind == TokenKind::LineEnd {
                depths = [0; 3];
            }
            continue;
        };
        let Some(kind) = [b"()", b"[]", b"{}"].iter().position(|it| it.contains(&sign)) else { continue };
        let depth = &mut depths[kind];
        *depth = if token.opens() { *depth + 1 } else { depth.saturating_sub(1) };
        if *depth > ResourceLimit::Nesting.most_held() {
            let message = ResourceLimit::Nesting.exceeded_error("brackets in each other");
            return Err(ErrorKind::Syntax.error(message).at_line("program", token.line));
        }
    }
    Ok(())
}

/// The number at the beginning of a text: its length, value and number of decimals.
fn number(text: &[u8]) -> Option<(usize, f64, usize)> {
    let digits = |from: usize| text.get(from..).unwrap_or_default().iter().take_while(|it| it.is_ascii_digit()).count();
    let whole = digits(0);
    let mut end = whole;
    let mut decimals = 0;
    if text.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return None;
    }
    if matches!(text.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    let value: f64 = std::str::from_utf8(text.get(..end)?).ok()?.parse().ok()?;
    value.is_finite().then_some((end, value, decimals))
}

/// A number with its sign, and nothing else, in these tokens.
pub(crate) fn signed_number(tokens: &[Token]) -> Option<Number> {
    let (sign, rest) = match tokens {
        [sign, rest @ ..] if sign.is(b'-') => (-1.0, rest),
        [sign, rest @ ..] if sign.is(b'+') => (1.0, rest),
        _ => (1.0, tokens),
    };
    let [Token { kind: TokenKind::Number(value, decimals), range, .. }] = rest else { return None };
    let start = tokens.first()?.range.start;
    Some(Number { range: start..range.end, value: sign * value, decimals: *decimals, scale: 1.0 })
}

/// The tokens outside of brackets, each with its index among all; brackets are not among them.
pub(crate) fn outside_brackets(tokens: &[Token]) -> impl Iterator<Item = (usize, &Token)> {
    let mut depth = 0_usize;
    tokens.iter().enumerate().filter(move |(_, token)| {
        let is_bracket = token.opens() || token.closes();
        depth = if token.opens() { depth + 1 } else { depth.saturating_sub(usize::from(token.closes())) };
        !is_bracket && depth == 0
    })
}

/// Tokens cut at the separators outside of brackets.
fn pieces(tokens: &[Token], separator: u8) -> Vec<&[Token]> {
    let (mut out, mut start) = (Vec::new(), 0);
    for (at, _) in outside_brackets(tokens).filter(|(_, it)| it.is(separator)) {
        out.push(&tokens[start..at]);
        start = at + 1;
    }
    out.push(&tokens[start..]);
    out
}

/// Tokens between brackets, cut at the commas outside of further brackets.
pub(crate) fn parts(tokens: &[Token]) -> Vec<&[Token]> {
    if tokens.is_empty() { Vec::new() } else { pieces(tokens, b',') }
}

/// Tokens between separators outside of brackets; `None` if brackets do not match.
pub(crate) fn cut(tokens: &[Token], separator: u8) -> Option<Vec<&[Token]>> {
    let deeper = |depth: usize, it: &Token| (depth + usize::from(it.opens())).checked_sub(usize::from(it.closes()));
    (tokens.iter().try_fold(0, deeper) == Some(0)).then(|| pieces(tokens, separator))
}

/// True if a word is one of a list, whose words are separated by blanks.
pub(crate) fn is_one_of(words: &str, word: &str) -> bool {
    words.split(' ').any(|it| it == word)
}

/// The tokens in a bracket at the beginning, and those behind it.
pub(crate) fn bracket(tokens: &[Token], open: u8, close: u8) -> Option<(&[Token], &[Token])> {
    if !tokens.first()?.is(open) {
        return None;
    }
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        if token.is(open) {
            depth += 1;
        } else if token.is(close) {
            depth -= 1;
            if depth == 0 {
                return Some((&tokens[1..at], &tokens[at + 1..]));
            }
        }
    }
    None
}

/// The text of tokens, cut after some letters.
pub(crate) fn excerpt(text: &[u8], tokens: &[Token]) -> String {
    let (Some(first), Some(last)) = (tokens.first(), tokens.last()) else { return String::new() };
    let bytes = text.get(first.range.start..last.range.end).unwrap_or_default();
    let all = String::from_utf8_lossy(bytes);
    let line: Vec<&str> = all.split_whitespace().collect();
    let line = line.join(" ");
    if line.chars().count() <= MOST_SHOWN {
        return line;
    }
    let cut: String = line.chars().take(MOST_SHOWN - 1).collect();
    format!("{cut}…")
}

/// Largest number of letters of a target's text in messages.
const MOST_SHOWN: usize = 60;
