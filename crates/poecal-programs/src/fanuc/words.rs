//! Tokens of a part of a program, and whole numbers.

use std::ops::Range;

use crate::scan::{LexicalRules, Scanner, Token, signed_number};

/// Syntax of the language. The position of a comment marks it, and a quote is also a letter of comments and names.
pub(crate) const RULES: LexicalRules =
    LexicalRules { comments: &[], quotes: b"", letters: b"", is_open_in_brackets: false };

/// The tokens of a part of a program that begins on a line.
pub(crate) fn tokens(text: &[u8], part: Range<usize>, line: usize) -> impl Iterator<Item = Token> {
    let start = part.start;
    Scanner::new(text.get(part).unwrap_or_default(), &RULES).map(move |mut token| {
        token.range = token.range.start + start..token.range.end + start;
        token.line += line - 1;
        token
    })
}

/// A number without a sign and without decimals, and nothing else.
pub(crate) fn whole_number(tokens: &[Token]) -> Option<u32> {
    let number = signed_number(tokens).filter(|it| it.decimals == 0 && (0.0..1e6).contains(&it.value))?;
    Some(number.value as u32)
}
