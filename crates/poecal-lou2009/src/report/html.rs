//! A report as one HTML page: it contains its style and its plots, and loads nothing. maud escapes every text.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::document::{DocumentTable, PlotFigure, ReportBlock, ReportDocument};
use poecal_numerics::text::visible_markup;

const STYLE: &str = include_str!("report.css");

pub(super) fn html(document: &ReportDocument) -> String {
    visible_markup(html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (document.title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main { h1 { (document.title) } @for block in &document.blocks { (of_block(block)) "\n" } } }
        }
        "\n"
    })
}

fn of_block(block: &ReportBlock) -> Markup {
    match block {
        ReportBlock::Heading(text) => html! { h2 { (text) } },
        ReportBlock::Text(text) => html! {
            p {
                @for (k, piece) in text.split('`').enumerate() {
                    @if k % 2 == 1 { code { (piece) } } @else { (piece) }
                }
            }
        },
        ReportBlock::Code(text) => html! { pre { code { (text) } } },
        ReportBlock::Table(table) => of_table(table),
        ReportBlock::Figure(figure) => of_figure(figure),
    }
}

fn of_table(table: &DocumentTable) -> Markup {
    // Sentences in columns are too wide for a narrow screen: there each row becomes a block of labelled cells.
    let sentences = table.rows.iter().flatten().any(|cell| is_long(cell));
    let class = |k: usize, long: bool| match (k < table.words, long) {
        (true, true) => Some("long"),
        (true, false) => None,
        (false, _) => Some("number"),
    };
    // The box scrolls on narrow screens, and is accessible by the keyboard.
    html! {
        p.caption { (table.caption) }
        div.scroll tabindex="0" role="region" aria-label=(table.caption) {
            table class=[sentences.then_some("sentences")] {
                thead { tr { @for (k, name) in table.head.iter().enumerate() { th class=[class(k, false)] { (name) } } } }
                tbody {
                    @for cells in &table.rows {
                        tr {
                            @for (k, (cell, name)) in cells.iter().zip(&table.head).enumerate() {
                                td class=[class(k, is_long(cell))] data-label=[sentences.then_some(name)] { (cell) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// True if a cell contains a sentence, which needs space.
fn is_long(cell: &str) -> bool {
    cell.chars().count() > 30
}

fn of_figure(figure: &PlotFigure) -> Markup {
    // The plots' own writer has escaped all their texts.
    html! {
        figure {
            div.plots { @for plot in &figure.plots { (PreEscaped(&plot.svg)) } }
            figcaption { (figure.caption) }
        }
    }
}
