//! A page of paper: complete in itself, without a script, on one page of A4.

mod certificate_sheet;
mod tested;
mod visit;

pub(crate) use certificate_sheet::first_page;
pub use certificate_sheet::{CertificateExtras, certificate_page};
pub(crate) use tested::first_page as first_page_of_test;
pub use tested::test_certificate_page;
pub use visit::visit_page;

use std::collections::BTreeMap;

use maud::{Markup, PreEscaped, html};

use super::head;
use poecal_numerics::text::visible_markup;
use poecal_results::output::PagePieces;
use poecal_results::record::Record;

/// Files, limits and sentences of a kind that are listed at most.
pub(crate) const LISTED: usize = 4;
/// The form of the page: A4 with a margin, all in one.
pub(crate) const STYLE: &str = "
.attested { font-size: .82rem; line-height: 1.3; }
.attested .title { font-size: 1.75rem; }
.attested h2, .attested h3 { font-size: 1rem; margin: .7rem 0 .25rem; }
.attested .top { display: flex; justify-content: space-between; gap: 1rem; align-items: flex-start; }
.attested .top img { max-width: 10rem; max-height: 4rem; }
.attested dl { display: grid; grid-template-columns: 1fr 1fr; gap: 0 1.4rem; margin: 0; }
.attested dl div { display: grid; grid-template-columns: 8rem 1fr; border-bottom: 1px solid #d9dde3; padding: .12rem 0; min-height: 1.5em; }
.attested dl div.wide { grid-column: 1 / -1; }
.attested dt { color: #52606d; }
.attested dd { margin: 0; overflow-wrap: anywhere; }
.attested .result { display: grid; grid-template-columns: 1fr 1fr; gap: .3rem 1.4rem; margin: .2rem 0; }
.attested .result b { display: block; font-size: 1.35rem; font-variant-numeric: tabular-nums; }
.attested table { width: 100%; }
.attested :is(th, td) { padding: .1rem .6rem .1rem 0; }
.attested tbody th { white-space: nowrap; }
.attested caption { display: none; }
.attested .scroll { margin: 0; }
.attested .found b { display: block; font-size: 1.2rem; }
.attested p { margin: .2rem 0; max-width: none; }
.attested code { font-size: .7rem; overflow-wrap: anywhere; }
.attested .hands { display: grid; grid-template-columns: 1fr 1fr; gap: 1.5rem; margin-top: .5rem; }
.attested .hands span { display: block; border-bottom: 1px solid #52606d; min-height: 4rem; color: #52606d; font-size: .72rem; }
";
/// Rules for the first page of a report's print.
pub(crate) const BEFORE: &str = "
.attested { display: none; }
@media print { .attested { display: block; break-after: page; border: 0; margin: 0; padding: 0; } }
";
/// Rules for a page of its own.
const ALONE: &str = "
:root { color-scheme: light; }
@page { size: A4; margin: 14mm 15mm; }
main { max-width: 48rem; }
main > .attested { border: 0; margin: 0; padding: 0; }
@media print { main { padding: 0; max-width: none; } }
";

/// Letters of an entry from which on it takes both columns.
const WIDE: usize = 50;

/// The page with its only sheet.
pub(crate) fn page(title: &str, version: &str, sheet: &Markup) -> PagePieces {
    // The page is the whole document: no heads and feet beside it.
    let head = head(title, &Record::default(), version);
    let body = html! {
        style { (PreEscaped(ALONE)) }
        main #main { (sheet) }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

/// Entries of a record under their labels; one that is missing is `instead`, or else a blank line to write on.
pub(crate) fn record_entries(
    record: &Record,
    entries: &[(&'static str, &'static str)],
    instead: impl Fn(&str) -> Option<String>,
) -> Markup {
    let known = record.entries();
    let text = |key: &str| known.iter().find(|it| it.0 == key).map(|it| it.2.to_owned());
    let entry = |&(key, label): &(&'static str, &'static str)| {
        let text = text(key).or_else(|| instead(key)).unwrap_or_default();
        let class = (text.chars().count() >= WIDE).then_some("wide");
        html! { div class=[class] { dt { (label) } dd { (text) } } }
    };
    html! { dl { @for it in entries { (entry(it)) } } }
}

/// The first few files with their checksums.
pub(crate) fn files<'a>(names: impl Iterator<Item = &'a String>, sha256: &BTreeMap<String, String>) -> Markup {
    let hashed: Vec<(&String, &String)> = names.filter_map(|name| Some((name, sha256.get(name)?))).collect();
    html! {
        @for (name, hash) in hashed.iter().take(LISTED) { p { (name.rsplit(['/', '\\']).next().unwrap_or(name)) " " code { (hash) } } }
        @if hashed.len() > LISTED { p { "and " (hashed.len() - LISTED) " more" } }
    }
}

/// Room for two signatures.
pub(crate) fn hands(role: &str) -> Markup {
    html! {
        div.hands {
            @for role in [role, "Approved by"] { span { (role) ": name, date, signature" } }
        }
    }
}
