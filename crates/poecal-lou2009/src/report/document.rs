//! A report as blocks, so that Markdown and HTML have the same content.

use poecal_report::plot::NamedPlot;

/// A report.
pub(super) struct ReportDocument {
    pub(super) title: String,
    pub(super) blocks: Vec<ReportBlock>,
}

/// A part of a report.
pub(super) enum ReportBlock {
    Heading(String),
    /// A paragraph; words between backticks are code.
    Text(String),
    /// Typed or printed text.
    Code(String),
    Table(DocumentTable),
    Figure(PlotFigure),
}

/// A table; its rows are as long as its head.
pub(super) struct DocumentTable {
    pub(super) caption: String,
    pub(super) head: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Number of columns, from the left, with words; the others hold numbers.
    pub(super) words: usize,
}

/// Plots with a caption.
pub(super) struct PlotFigure {
    pub(super) caption: String,
    pub(super) plots: Vec<NamedPlot>,
}

impl ReportDocument {
    pub(super) fn into_plots(self) -> impl Iterator<Item = NamedPlot> {
        self.blocks.into_iter().flat_map(|block| match block {
            ReportBlock::Figure(figure) => figure.plots,
            ReportBlock::Heading(_) | ReportBlock::Text(_) | ReportBlock::Code(_) | ReportBlock::Table(_) => Vec::new(),
        })
    }
}
