//! Parts that make the page a certificate: the record of the session, the decision on limits, and the lines for signatures.

use std::collections::BTreeMap;

use maud::{Markup, PreEscaped, html};

use super::html::{HtmlTable, count, facts, figure, quote_text};
use super::short_name as shorter;
use crate::acceptance::{counts, format_limit};
use poecal_calibrate::{Acceptance, AcceptedLimit, Decision};
use poecal_results::record::Record;

/// Letters of a checksum that tell files apart.
const SHORT: usize = 16;

/// Record of the session; empty if nothing was stated.
pub(crate) fn record_markup(record: &Record) -> Markup {
    let entries = record.entries();
    let entry = |&(key, label, text): &(&'static str, &'static str, &str)| {
        (label, quote_text(text, format_args!("record.{key}")))
    };
    let entries: Vec<(&str, Markup)> = entries.iter().map(entry).collect();
    html! { @if !entries.is_empty() { section.record aria-label="Session" { (facts(&entries)) } } }
}

/// Decision on each limit, with the figure that was found.
pub(crate) fn limits(found: &Acceptance) -> Markup {
    decided(found.decision, found.limits.len(), &limits_table(found))
}

/// The decision on so many limits, above its table.
pub(crate) fn decided(decision: Decision, count: usize, table: &Markup) -> Markup {
    html! {
        section class={ "verdict " (decision.word()) } aria-labelledby="acceptance-title" {
            h2 #acceptance-title { span.sign aria-hidden="true" {} (decision_title(decision, count)) }
            (table)
        }
    }
}

/// Each limit with what was found, and the rule.
pub(crate) fn limits_table(found: &Acceptance) -> Markup {
    let columns: Vec<(String, [Markup; 6])> = found.limits.iter().enumerate().map(column).collect();
    let heads: Vec<&str> = std::iter::once("").chain(columns.iter().map(|(name, _)| name.as_str())).collect();
    let mut table = HtmlTable::new("Errors and their limits", 1, &heads);
    for (at, label) in ["decision", "limit", "found", "lower bound", "upper bound", "rows"].into_iter().enumerate() {
        let cells = columns.iter().map(|(_, cells)| cells[at].clone());
        table.cells(std::iter::once(html! { (label) }).chain(cells));
    }
    html! {
        (table)
        p.note {
            "Errors of the " b { (found.model.word()) } " model, measured minus predicted, by " (found.by.words())
            ". The bounds are one-sided, each with 95\u{a0}% confidence. PASS: the upper bound is within the limit. FAIL: the lower bound is above it. \
             NOT SHOWN: the limit is between them; measure more configurations."
        }
    }
}

/// The decision in a title.
pub(crate) fn title_of(found: &Acceptance) -> &'static str {
    decision_title(found.decision, found.limits.len())
}

/// A decision on so many limits in a title.
pub(crate) fn decision_title(decision: Decision, count: usize) -> &'static str {
    match (decision, count) {
        (Decision::Pass, 1) => "PASS: the limit is kept",
        (Decision::Pass, _) => "PASS: every limit is kept",
        (Decision::Fail, 1) => "FAIL: the limit is exceeded",
        (Decision::Fail, _) => "FAIL: a limit is exceeded",
        (Decision::NotShown, _) => "NOT SHOWN: the rows show neither that the limits are kept nor that they are not",
    }
}

/// A limit's name, and its cells.
fn column((k, limit): (usize, &AcceptedLimit)) -> (String, [Markup; 6]) {
    let key = |name: &str| format!("acceptance.limits.{k}.{name}");
    let unit = if limit.unit == "deg" { "°" } else { " mm" };
    let most = html! { span data-key=(key("limit")) { (format_limit(limit.limit)) } (unit) };
    let found = html! { b { (figure(limit.found, key("found"))) (unit) } };
    let from = html! { (figure(limit.from, key("from"))) (unit) };
    let to = html! { @if let Some(to) = limit.to { (figure(to, key("to"))) (unit) } @else { "too few rows" } };
    let rows = if limit.rows == limit.configurations {
        count(limit.rows, key("rows"))
    } else {
        html! { (counts(limit)) }
    };
    let decision = html! { b class={ "decision " (limit.decision.word()) } { (limit.decision.words()) } };
    (format!("{} {}", limit.quantity, limit.statistic.words()), [decision, most, found, from, to, rows])
}

/// Block for signatures: the title, the decision on limits, the files with their checksums, and lines for two hands.
pub(crate) fn hands(
    of: (&'static str, Markup),
    record: &Record,
    acceptance: Option<&'static str>,
    (names, sha256): (&[&String], &BTreeMap<String, String>),
    (role, version): (&str, &str),
) -> Markup {
    let all_names: Vec<String> = names.iter().map(|name| (*name).clone()).collect();
    let short = |name: &&String| {
        let hash = sha256.get(*name)?;
        Some(html! { (shorter(&all_names, name)) " " code { (hash.get(..SHORT).unwrap_or(hash)) "…" } })
    };
    let files: Vec<Markup> = names.iter().filter_map(short).collect();
    let mut all = vec![of];
    all.extend(record.certificate.as_ref().map(|number| ("Certificate", html! { (number) })));
    all.extend(acceptance.map(|title| ("Acceptance", html! { (title) })));
    all.push(("Made by", html! { "poecal " (version) }));
    if !files.is_empty() {
        all.push(("SHA-256 of", html! { @for (k, file) in files.iter().enumerate() { @if k > 0 { br; } (file) } }));
    }
    let hand = |role: &str, name: &str| {
        html! {
            div { b { (role) } span { "Name" i { (name) } } span { "Date" i {} } span { "Signature" i {} } }
        }
    };
    html! {
        section.signature aria-label="Signatures" {
            h2 { "Signatures" }
            (facts(&all))
            div.hands {
                (hand(role, record.operator.as_deref().unwrap_or("")))
                (hand("Approved by", ""))
            }
        }
    }
}

/// Head and foot of printed pages, where the browser has them.
pub(crate) fn pages(title: &str, record: &Record, version: &str) -> Markup {
    let number = record.certificate.as_ref().map(|number| format!(" · {number}"));
    let title = format!("{title}{}", number.unwrap_or_default());
    let right = format!("poecal {version}");
    html! {
        style {
            (PreEscaped(format!(
                "@page {{ @top-left {{ content: \"{}\"; }} @top-right {{ content: \"{}\"; }} @bottom-right {{ content: counter(page) \" / \" counter(pages); }} }}",
                in_style(&title), in_style(&right)
            )))
        }
    }
}

/// Text within quotes of a style: all but letters, digits and blanks as numbers, so that nothing in it can end the quotes or the style.
fn in_style(text: &str) -> String {
    let shown = poecal_numerics::text::escape_invisible(text);
    let letter = |c: char| match c {
        ' ' => " ".to_owned(),
        c if c.is_ascii_alphanumeric() => c.to_string(),
        // The blank ends the number.
        c => format!("\\{:x} ", u32::from(c)),
    };
    shown.chars().take(LONGEST).map(letter).collect()
}

/// Letters of a page's head.
const LONGEST: usize = 70;

#[cfg(test)]
mod tests {
    use super::in_style;

    #[test]
    fn nothing_ends_the_quotes_of_a_style() {
        assert_eq!(in_style("a\"}</style>\n"), "a\\22 \\7d \\3c \\2f style\\3e \\5c u\\7b a\\7d ");
        assert_eq!(in_style(&"x".repeat(100)).len(), 70);
    }
}
