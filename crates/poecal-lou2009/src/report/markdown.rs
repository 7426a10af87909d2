//! A report as Markdown, with its plots in files beside it.

use std::fmt::Write as _;

use super::document::{Block, Document, DocumentTable};

pub(super) fn markdown(document: &Document) -> String {
    let mut out = format!("# {}\n", plain(&document.title));
    for block in &document.blocks {
        out.push('\n');
        // Writing to a String cannot fail.
        let _ = match block {
            Block::Heading(text) => writeln!(out, "## {}", plain(text)),
            Block::Text(text) => writeln!(out, "{}", with_code(text)),
            Block::Code(text) => writeln!(
                out,
                "{}",
                text.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
            ),
            Block::Table(table) => {
                write_table(&mut out, table);
                Ok(())
            }
            Block::Figure(figure) => {
                for plot in &figure.plots {
                    let _ = writeln!(out, "![{}]({}.svg)", plain(&plot.title), plot.name);
                }
                writeln!(out, "\n{}", plain(&figure.caption))
            }
        };
    }
    out
}

fn write_table(out: &mut String, table: &DocumentTable) {
    let _ = writeln!(out, "{}\n", plain(&table.caption));
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    out.push_str(&row(table.head.iter().map(|cell| plain(cell)).collect()));
    let rule = |k: usize| if k < table.words { "---" } else { "---:" }.to_owned();
    out.push_str(&row((0..table.head.len()).map(rule).collect()));
    for cells in &table.rows {
        out.push_str(&row(cells.iter().map(|cell| plain(cell)).collect()));
    }
}

/// Text in which words between backticks are code, which needs no escapes.
fn with_code(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    pieces.map(|(k, piece)| if k % 2 == 1 { format!("`{piece}`") } else { plain(piece) }).collect()
}

/// Text on one line in which nothing is markup.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '|' | '<' | '*' | '`' | '[' | ']' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn markup_in_text_stays_text() {
        assert_eq!(plain("a|b <i>\nP_c0*"), "a\\|b \\<i> P_c0\\*");
    }
}
