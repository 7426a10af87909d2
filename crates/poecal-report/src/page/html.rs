//! Elements of the page: figures, each with its key of `calibration.json`, tables, pictures. maud escapes every text.

use maud::{Markup, PreEscaped, Render, html};

use crate::table::number;

/// A figure as people read it, with its source in `calibration.json`.
pub(crate) fn figure(value: f64, key: impl Render) -> Markup {
    scaled_figure(value, key, 1.0)
}

/// A figure that the file holds in another unit: the displayed value is `factor` times that of the file.
pub(crate) fn scaled_figure(value: f64, key: impl Render, factor: f64) -> Markup {
    let shown = value * factor;
    let sign = if shown < 0.0 { "−" } else { "" };
    let scale = (factor != 1.0).then_some(factor);
    html! {
        span data-key=(key) data-factor=[scale] {
            @if shown.is_finite() { (sign) (number(shown.abs())) } @else { "–" }
        }
    }
}

/// A figure, or these words in its absence.
pub(crate) fn figure_or(value: Option<f64>, key: impl Render, words: &str) -> Markup {
    value.map_or_else(|| words.render(), |value| figure(value, key))
}

/// A whole number from `calibration.json`.
pub(crate) fn count(value: usize, key: impl Render) -> Markup {
    html! { span data-key=(key) { (value) } }
}

/// Text from `calibration.json`, unchanged; words between backticks are code.
pub(crate) fn quote_text(text: &str, key: impl Render) -> Markup {
    html! { span data-key=(key) { (code_markup(text)) } }
}

/// Text in which words between backticks are code.
pub(crate) fn code_markup(text: &str) -> Markup {
    html! {
        @for (k, piece) in text.split('`').enumerate() {
            @if k % 2 == 1 { code { (piece) } } @else { (piece) }
        }
    }
}

/// A path from `calibration.json`, which may be broken after its folders.
pub(crate) fn path(text: &str, key: impl Render) -> Markup {
    let mut folders: Vec<&str> = text.split_inclusive(['/', '\\']).collect();
    let name = folders.pop().unwrap_or_default();
    html! { span data-key=(key) { @for folder in folders { (folder) wbr; } (name) } }
}

/// Words with a capital letter.
pub(crate) fn capital(words: &str) -> String {
    let (first, rest) = words.split_at(words.len().min(1));
    format!("{}{rest}", first.to_uppercase())
}

/// A value with decimals and a true minus; a value that rounds to zero has none.
pub(crate) fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.trim_matches(['-', '0', '.']).is_empty() {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

/// A table.
pub(crate) struct HtmlTable {
    caption: String,
    head: Vec<String>,
    rows: String,
    /// Number of columns, from the left, that hold words; the others hold numbers.
    words: usize,
}

impl HtmlTable {
    pub(crate) fn new(caption: &str, words: usize, head: &[&str]) -> Self {
        let head = head.iter().map(|name| (*name).to_owned()).collect();
        HtmlTable { caption: caption.to_owned(), head, rows: String::new(), words }
    }

    fn class(&self, column: usize) -> &'static str {
        if column < self.words { "word" } else { "number" }
    }

    /// A row of cells of several kinds.
    pub(crate) fn row(&mut self, cells: &[&dyn Render]) {
        self.cells(cells);
    }

    /// A row of cells of one kind.
    pub(crate) fn cells(&mut self, cells: impl IntoIterator<Item = impl Render>) {
        let row = html! {
            tr {
                @for (k, cell) in cells.into_iter().enumerate() {
                    @if k == 0 { th scope="row" { (cell) } } @else { td class=(self.class(k)) { (cell) } }
                }
            }
        };
        self.push_marked(&row);
    }

    /// A row of cells that are marked up already.
    pub(crate) fn push_marked(&mut self, row: &Markup) {
        row.render_to(&mut self.rows);
        self.rows.push('\n');
    }
}

impl Render for HtmlTable {
    fn render(&self) -> Markup {
        // The box scrolls on narrow screens, and is reached by the keyboard.
        html! {
            div.scroll tabindex="0" role="region" aria-label=(self.caption) {
                table {
                    caption { (self.caption) }
                    thead { tr { @for (k, name) in self.head.iter().enumerate() { th scope="col" class=(self.class(k)) { (name) } } } }
                    tbody { (PreEscaped(&self.rows)) }
                }
            }
        }
    }
}

/// A section with its heading.
pub(crate) fn section(id: &str, title: &str, content: &Markup) -> Markup {
    let title_id = format!("{id}-title");
    html! { section id=(id) aria-labelledby=(title_id) { h2 id=(title_id) { (title) } (content) } "\n" }
}

/// A list; empty if it has no items.
pub(crate) fn list(items: &[Markup]) -> Markup {
    html! { @if !items.is_empty() { ul { @for item in items { li { (item) } } } } }
}

/// Names with their descriptions.
pub(crate) fn facts(facts: &[(&str, Markup)]) -> Markup {
    html! { dl.facts { @for (name, fact) in facts { div { dt { (name) } dd { (fact) } } } } }
}

/// A table that is opened on demand, and printed in any case.
pub(crate) fn fold_table(summary: &str, table: &HtmlTable) -> Markup {
    html! { details { summary { (summary) } (table) } }
}

/// Plots side by side, with a caption.
pub(crate) fn plots(plots: &[Markup], caption: impl Render) -> Markup {
    html! { @if !plots.is_empty() { figure { div.plots { @for plot in plots { (plot) } } figcaption { (caption) } } } }
}
