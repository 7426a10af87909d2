//! A report as Markdown, with its plots in files beside it.

use super::document::{DocumentTable, ReportBlock, ReportDocument};
use poecal_report::plot::NamedPlot;

pub(super) fn markdown(document: &ReportDocument) -> String {
    let mut out = format!("# {}\n", plain_text(&document.title));
    for block in &document.blocks {
        out.push('\n');
        out += &match block {
            ReportBlock::Heading(text) => format!("## {}\n", plain_text(text)),
            ReportBlock::Text(text) => format!("{}\n", with_code(text)),
            ReportBlock::Code(text) => text.lines().map(|line| format!("    {line}\n")).collect(),
            ReportBlock::Table(table) => of_table(table),
            ReportBlock::Figure(figure) => {
                let plot = |it: &NamedPlot| format!("![{}]({}.svg)\n", plain_text(&it.title), it.name);
                let plots: String = figure.plots.iter().map(plot).collect();
                format!("{plots}\n{}\n", plain_text(&figure.caption))
            }
        };
    }
    out
}

fn of_table(table: &DocumentTable) -> String {
    let mut out = format!("{}\n\n", plain_text(&table.caption));
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    out.push_str(&row(table.head.iter().map(|cell| plain_text(cell)).collect()));
    let rule = |k: usize| if k < table.words { "---" } else { "---:" }.to_owned();
    out.push_str(&row((0..table.head.len()).map(rule).collect()));
    for cells in &table.rows {
        out.push_str(&row(cells.iter().map(|cell| plain_text(cell)).collect()));
    }
    out
}

/// Text in which words between backticks are code, which needs no escapes.
fn with_code(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    pieces.map(|(k, piece)| if k % 2 == 1 { format!("`{piece}`") } else { plain_text(piece) }).collect()
}

/// Text on one line in which nothing is markup.
fn plain_text(text: &str) -> String {
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
    use super::plain_text;

    #[test]
    fn markup_in_text_stays_text() {
        assert_eq!(plain_text("a|b <i>\nP_c0*"), "a\\|b \\<i> P_c0\\*");
    }
}
