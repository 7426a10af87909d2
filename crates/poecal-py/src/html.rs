//! Small tables for notebooks.

use poecal::text::visible_lines;

/// A piece of HTML. Every text is escaped.
pub(crate) struct Html {
    text: String,
    in_table: bool,
}

impl Html {
    pub(crate) fn new() -> Self {
        Html { text: "<div>".to_owned(), in_table: false }
    }

    pub(crate) fn paragraph(&mut self, words: &str) {
        self.close();
        self.text.push_str(&format!("<p>{}</p>", escape(words)));
    }

    pub(crate) fn lines(&mut self, lines: &str) {
        self.close();
        self.text.push_str(&format!("<pre>{}</pre>", escape(lines)));
    }

    /// Begins a table.
    pub(crate) fn head(&mut self, cells: &[&str]) {
        self.close();
        self.in_table = true;
        self.text.push_str("<table>");
        self.cells("th", cells);
    }

    pub(crate) fn row(&mut self, cells: &[&str]) {
        self.cells("td", cells);
    }

    pub(crate) fn finish(mut self) -> String {
        self.close();
        self.text + "</div>"
    }

    fn cells(&mut self, tag: &str, cells: &[&str]) {
        self.text.push_str("<tr>");
        for cell in cells {
            self.text.push_str(&format!("<{tag}>{}</{tag}>", escape(cell)));
        }
        self.text.push_str("</tr>");
    }

    fn close(&mut self) {
        if self.in_table {
            self.text.push_str("</table>");
            self.in_table = false;
        }
    }
}

/// A text without characters that mean something in HTML, or act instead of being seen.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible_lines(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#x27;"),
            c => out.push(c),
        }
    }
    out
}
