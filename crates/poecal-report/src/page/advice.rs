//! Sentences that name options of the program: in plain words for readers of the page, and whole for users of the program.

use std::borrow::Cow;

use maud::{Markup, Render, html};

use super::html::quote_text;

/// A sentence from `calibration.json` with its statements about options folded.
pub(crate) fn sentence_markup(text: &str, key: impl Render) -> Markup {
    fold_sentence(text, &quote_text(text, key))
}

/// The same for words that are composed of several of its sentences.
pub(crate) fn told_words(text: &str) -> Markup {
    fold_sentence(text, &quoted_words(text))
}

fn fold_sentence(text: &str, whole: &Markup) -> Markup {
    match without_options(text) {
        Cow::Borrowed(_) => html! { (whole) },
        Cow::Owned(plain) => html! {
            (quoted_words(&plain))
            details.runs { summary { "For whoever runs poecal" } (whole) }
        },
    }
}

/// Words with code between backticks.
fn quoted_words(text: &str) -> Markup {
    html! { @for (k, piece) in text.split('`').enumerate() { @if k % 2 == 1 { code { (piece) } } @else { (piece) } } }
}

/// A sentence without the brackets and the last clauses that name options.
fn without_options(text: &str) -> Cow<'_, str> {
    if option_at(text).is_none() {
        return Cow::Borrowed(text);
    }
    let mut plain = text.to_owned();
    while let Some((open, close)) = bracket_with_option(&plain) {
        plain.replace_range(open..=close, "");
    }
    if let Some(at) = option_at(&plain) {
        let before = &plain[..at];
        let clause = ["; ", ": ", ", "].into_iter().filter_map(|end| before.rfind(end)).max();
        plain.truncate(clause.unwrap_or(0));
    }
    let plain = plain.trim();
    if plain.is_empty() { Cow::Borrowed(text) } else { Cow::Owned(plain.to_owned()) }
}

/// Start of an option: two hyphens and a letter, preceded by no word character.
fn option_at(text: &str) -> Option<usize> {
    text.match_indices("--").map(|(at, _)| at).find(|&at| {
        let before = text[..at].chars().next_back();
        let after = text[at + 2..].chars().next();
        before.is_none_or(|c| !c.is_alphanumeric() && c != '-') && after.is_some_and(|c| c.is_ascii_lowercase())
    })
}

/// A bracket with the blank before it that names an option and contains no further bracket.
fn bracket_with_option(text: &str) -> Option<(usize, usize)> {
    let at = option_at(text)?;
    let places = text.match_indices("--").map(|(place, _)| place).filter(|&place| place >= at);
    places.into_iter().find_map(|place| {
        let open = text[..place].rfind('(').filter(|&open| !text[open..place].contains(')'))?;
        let close = place + text[place..].find(')')?;
        (!text[open + 1..close].contains('(')).then(|| (text[..open].trim_end().len(), close))
    })
}

#[cfg(test)]
mod tests {
    use super::without_options;

    #[test]
    fn options_are_left_out_with_their_clause() {
        for (text, plain) in [
            ("nothing to run", "nothing to run"),
            (
                "the device was moved between a and b; give each file its own with --device-frames per-file",
                "the device was moved between a and b",
            ),
            (
                "no length (--socket-distance), or a height; hold axes (--fix joints) to find offsets",
                "no length, or a height; hold axes to find offsets",
            ),
            ("a zero is 90 deg off (`--free zero` finds it)", "a zero is 90 deg off"),
            ("--device-frame base is wrong", "--device-frame base is wrong"),
            ("a--b, and -- alone", "a--b, and -- alone"),
        ] {
            assert_eq!(without_options(text), plain);
        }
    }
}
