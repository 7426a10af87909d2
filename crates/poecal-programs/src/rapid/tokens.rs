//! Values of RAPID, from their tokens.

use super::super::parsed_program::Number;
use super::super::scan::{LexicalRules, Scanner, Token, TokenKind, cut, signed_number};

/// Syntax of RAPID.
pub(crate) const RULES: LexicalRules =
    LexicalRules { comments: &["!"], quotes: b"\"", letters: b"", is_open_in_brackets: false };

/// The sign for `:=`, which is one token.
pub(crate) const ASSIGN: u8 = b'\x01';

/// The tokens of a file, without line ends and without the header of older files, which is between lines that begin with `%%%`.
pub(crate) fn tokens(text: &[u8]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut is_header = false;
    let mut line_start = 0;
    for token in Scanner::new(text, &RULES) {
        if token.kind == TokenKind::LineEnd {
            if is_header {
                out.truncate(line_start);
            }
            line_start = out.len();
            continue;
        }
        let follows = |sign: u8| out.last().is_some_and(|it| it.is(sign) && it.range.end == token.range.start);
        if token.is(b'=') && follows(b':') {
            if let Some(colon) = out.last_mut() {
                colon.kind = TokenKind::Sign(ASSIGN);
                colon.range.end = token.range.end;
            }
            continue;
        }
        let is_third = token.is(b'%') && follows(b'%') && out.len() == line_start + 2;
        out.push(token);
        if is_third && out.iter().rev().take(3).all(|it| it.is(b'%')) {
            is_header = !is_header;
            out.truncate(line_start);
        }
    }
    out
}

/// A value in the text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum RapidValue {
    Number(Number),
    List(Vec<RapidValue>),
    /// A name alone, in lower case: `TRUE`, or a constant.
    Word(String),
    /// A text in quotes, and true if it is empty.
    Text(bool),
    /// An expression.
    Other,
}

impl RapidValue {
    /// The values of a list with `count` entries.
    pub(crate) fn list(&self, count: usize) -> Option<&[RapidValue]> {
        let RapidValue::List(values) = self else { return None };
        Some(&values[..]).filter(|it| it.len() == count)
    }

    /// The numbers of a list with `count` entries.
    pub(crate) fn numbers(&self, count: usize) -> Option<Vec<Number>> {
        let number = |it: &RapidValue| if let RapidValue::Number(number) = it { Some(number.clone()) } else { None };
        self.list(count)?.iter().map(number).collect()
    }

    /// True if it is this name.
    pub(crate) fn is(&self, word: &str) -> bool {
        matches!(self, RapidValue::Word(it) if it == word)
    }
}

/// Largest depth of brackets that are read: arrays of three dimensions of data of three levels need fewer.
const DEEPEST: usize = 8;

/// The value of these tokens.
pub(crate) fn value(tokens: &[Token], text: &[u8], depth: usize) -> RapidValue {
    if let Some(number) = signed_number(tokens) {
        return RapidValue::Number(number);
    }
    match tokens {
        [only] => match only.kind {
            TokenKind::Word => RapidValue::Word(lower_case(text, only)),
            TokenKind::Text => RapidValue::Text(only.range.len() <= 2),
            TokenKind::Number(..) | TokenKind::Sign(_) | TokenKind::LineEnd => RapidValue::Other,
        },
        [open, inner @ .., close] if open.is(b'[') && close.is(b']') && depth < DEEPEST => match cut(inner, b',') {
            Some(parts) => RapidValue::List(parts.into_iter().map(|it| value(it, text, depth + 1)).collect()),
            None => RapidValue::Other,
        },
        _ => RapidValue::Other,
    }
}

/// A word in lower case.
pub(crate) fn lower_case(text: &[u8], token: &Token) -> String {
    token_text(text, token).to_ascii_lowercase()
}

/// The text of a token.
pub(crate) fn token_text(text: &[u8], token: &Token) -> String {
    String::from_utf8_lossy(text.get(token.range.clone()).unwrap_or_default()).into_owned()
}
