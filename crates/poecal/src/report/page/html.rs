//! The page as text: every name that comes from a file is escaped, and every figure names the key of `calibration.json` that it is.

use std::fmt::Write as _;

use crate::report::fixed::Fixed;
use crate::report::plot::escape;
use crate::report::table::number;

/// A figure as people read it, with the place in `calibration.json` that it comes from.
pub(super) fn figure(value: f64, key: &str) -> String {
    scaled(value, key, 1.0)
}

/// A figure that the file holds in another unit: what is shown is `factor` times what the file says.
pub(super) fn scaled(value: f64, key: &str, factor: f64) -> String {
    let shown = value * factor;
    let sign = if shown < 0.0 { "−" } else { "" };
    let text = if shown.is_finite() { format!("{sign}{}", number(shown.abs())) } else { "–".to_owned() };
    let scale = if factor == 1.0 { String::new() } else { format!(" data-factor=\"{factor}\"") };
    format!("<span data-key=\"{}\"{scale}>{text}</span>", escape(key))
}

/// A whole number from `calibration.json`.
pub(super) fn count(value: usize, key: &str) -> String {
    format!("<span data-key=\"{}\">{value}</span>", escape(key))
}

/// Text from `calibration.json`, as it stands there; words between backticks are code.
pub(super) fn quoted(text: &str, key: &str) -> String {
    let pieces = text.split('`').map(escape).enumerate();
    let pieces: String =
        pieces.map(|(k, piece)| if k % 2 == 1 { format!("<code>{piece}</code>") } else { piece }).collect();
    format!("<span data-key=\"{}\">{pieces}</span>", escape(key))
}

/// A path from `calibration.json`, which may be broken after its folders.
pub(super) fn path(text: &str, key: &str) -> String {
    let pieces: Vec<String> = text.split_inclusive(['/', '\\']).map(escape).collect();
    format!("<span data-key=\"{}\">{}</span>", escape(key), pieces.join("<wbr>"))
}

/// A value with decimals and a true minus; what rounds to zero has none.
pub(super) fn decimal(value: f64, decimals: usize) -> String {
    let text = Fixed(value, decimals).to_string();
    if text.trim_matches(['-', '0', '.']).is_empty() {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

/// A table. Cells are HTML.
pub(super) struct Table {
    pub(super) caption: String,
    pub(super) head: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// How many columns, from the left, hold words; the others hold numbers.
    pub(super) words: usize,
}

impl Table {
    pub(super) fn new(caption: &str, words: usize, head: &[&str]) -> Self {
        let head = head.iter().map(|name| escape(name)).collect();
        Table { caption: escape(caption), head, rows: Vec::new(), words }
    }

    fn html(&self) -> String {
        // The box scrolls on narrow screens, and is reached by the keyboard.
        let caption = &self.caption;
        let mut out = format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table>\n<caption>{caption}</caption>\n<thead><tr>"
        );
        let class = |k: usize| if k < self.words { " class=\"word\"" } else { " class=\"number\"" };
        // Writing to a String cannot fail.
        for (k, name) in self.head.iter().enumerate() {
            let _ = write!(out, "<th scope=\"col\"{}>{name}</th>", class(k));
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        for cells in &self.rows {
            out.push_str("<tr>");
            for (k, cell) in cells.iter().enumerate() {
                let _ = match k {
                    0 => write!(out, "<th scope=\"row\">{cell}</th>"),
                    _ if cell.starts_with("<td") => write!(out, "{cell}"),
                    _ => write!(out, "<td{}>{cell}</td>", class(k)),
                };
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</tbody></table></div>\n");
        out
    }
}

/// A page in the making.
pub(super) struct Html {
    out: String,
}

impl Html {
    pub(super) fn new() -> Self {
        // Room for most pages without moving.
        Html { out: String::with_capacity(100_000) }
    }

    /// HTML as it stands.
    pub(super) fn raw(&mut self, html: &str) {
        self.out.push_str(html);
        self.out.push('\n');
    }

    /// Begins a section with its heading.
    pub(super) fn section(&mut self, id: &str, title: &str) {
        self.raw(&format!(
            "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{title}</h2>"
        ));
    }

    pub(super) fn end_section(&mut self) {
        self.raw("</section>");
    }

    pub(super) fn heading(&mut self, title: &str) {
        self.raw(&format!("<h3>{title}</h3>"));
    }

    /// A paragraph of HTML.
    pub(super) fn text(&mut self, html: &str) {
        self.raw(&format!("<p>{html}</p>"));
    }

    pub(super) fn note(&mut self, html: &str) {
        self.raw(&format!("<p class=\"note\">{html}</p>"));
    }

    /// A list of HTML items; nothing if there are none.
    pub(super) fn list(&mut self, items: &[String]) {
        if items.is_empty() {
            return;
        }
        let items: Vec<String> = items.iter().map(|item| format!("<li>{item}</li>")).collect();
        self.raw(&format!("<ul>\n{}\n</ul>", items.join("\n")));
    }

    /// Names with what they are.
    pub(super) fn facts(&mut self, facts: &[(&str, String)]) {
        let facts: Vec<String> =
            facts.iter().map(|(name, html)| format!("<div><dt>{name}</dt><dd>{html}</dd></div>")).collect();
        self.raw(&format!("<dl class=\"facts\">\n{}\n</dl>", facts.join("\n")));
    }

    pub(super) fn table(&mut self, table: &Table) {
        self.out.push_str(&table.html());
    }

    /// A table that is opened on demand, and printed in any case.
    pub(super) fn folded_table(&mut self, summary: &str, table: &Table) {
        self.raw(&format!("<details>\n<summary>{}</summary>\n{}</details>", escape(summary), table.html()));
    }

    /// Plots side by side, with a caption.
    pub(super) fn plots(&mut self, plots: &[String], caption: &str) {
        let plots = plots.concat();
        self.raw(&format!(
            "<figure>\n<div class=\"plots\">\n{plots}</div>\n<figcaption>{caption}</figcaption>\n</figure>"
        ));
    }

    /// A place that the script fills with a chart.
    pub(super) fn chart(&mut self, name: &str, title: &str, caption: &str) {
        self.raw(&format!(
            "<figure class=\"chart\" data-chart=\"{name}\">\n<h3>{title}</h3>\n<div class=\"drawing\"></div>\n<figcaption>{caption}</figcaption>\n</figure>"
        ));
    }

    pub(super) fn finish(self) -> String {
        self.out
    }
}
