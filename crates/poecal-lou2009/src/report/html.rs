//! A report as one HTML page: its style and its plots are in it, and it loads nothing.

use std::fmt::Write as _;

use super::document::{Block, Document, Figure, Table};
use poecal::report::plot::escape;

const STYLE: &str = include_str!("report.css");

pub(super) fn html(document: &Document) -> String {
    let title = escape(&document.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
    );
    for block in &document.blocks {
        // Writing to a String cannot fail.
        let _ = match block {
            Block::Heading(text) => writeln!(out, "<h2>{}</h2>", escape(text)),
            Block::Text(text) => writeln!(out, "<p>{}</p>", with_code(text)),
            Block::Code(text) => writeln!(out, "<pre><code>{}</code></pre>", escape(text)),
            Block::Table(table) => {
                write_table(&mut out, table);
                Ok(())
            }
            Block::Figure(figure) => {
                write_figure(&mut out, figure);
                Ok(())
            }
        };
    }
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

/// Text in which words between backticks are code.
fn with_code(text: &str) -> String {
    let pieces = text.split('`').map(escape).enumerate();
    pieces.map(|(k, piece)| if k % 2 == 1 { format!("<code>{piece}</code>") } else { piece }).collect()
}

fn write_table(out: &mut String, table: &Table) {
    // The box scrolls on narrow screens, and is reached by the keyboard.
    let caption = escape(&table.caption);
    // Sentences in columns are too wide for a narrow screen: there each row becomes a block of labelled cells.
    let sentences = table.rows.iter().flatten().any(|cell| is_long(cell));
    let class = if sentences { " class=\"sentences\"" } else { "" };
    let _ = writeln!(
        out,
        "<p class=\"caption\">{caption}</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table{class}>"
    );
    out.push_str("<thead><tr>");
    for (k, name) in table.head.iter().enumerate() {
        let class = if k < table.words { "" } else { " class=\"number\"" };
        let _ = write!(out, "<th{class}>{}</th>", escape(name));
    }
    out.push_str("</tr>\n</thead>\n<tbody>\n");
    for cells in &table.rows {
        out.push_str("<tr>");
        for (k, (cell, name)) in cells.iter().zip(&table.head).enumerate() {
            let class = match (k < table.words, is_long(cell)) {
                (true, true) => " class=\"long\"",
                (true, false) => "",
                (false, _) => " class=\"number\"",
            };
            let label = if sentences { format!(" data-label=\"{}\"", escape(name)) } else { String::new() };
            let _ = write!(out, "<td{class}{label}>{}</td>", escape(cell));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table></div>\n");
}

/// Whether a cell holds a sentence, which needs room.
fn is_long(cell: &str) -> bool {
    cell.chars().count() > 30
}

fn write_figure(out: &mut String, figure: &Figure) {
    out.push_str("<figure>\n<div class=\"plots\">\n");
    for plot in &figure.plots {
        out.push_str(&plot.svg);
    }
    let _ = writeln!(out, "</div>\n<figcaption>{}</figcaption>\n</figure>", escape(&figure.caption));
}
