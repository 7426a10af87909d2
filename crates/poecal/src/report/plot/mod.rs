//! Small static plots as SVG text: the same input gives the same bytes.
//!
//! Colours stand in the elements as for light paper, and each element has a class, so that a page's style sheet can replace them.
//! A series has its own marker and dash beside its colour. The legend stands above the axes, never on the data. Values that an
//! axis cannot show are drawn hollow at its edge (zero on a logarithmic axis, infinity) or left out (not a number), and a note
//! below the plot says so.

mod axis;
mod dots;
mod frame;
mod line;
mod ranges;
mod svg;

pub(super) use axis::{Axis, Scale};
pub(super) use dots::{DotPlot, Dots};
pub(super) use line::{Line, LinePlot};
pub(super) use ranges::{RangePlot, RangeRow};
pub(super) use svg::escape;

/// A plot and the name of its file, without the extension.
pub(super) struct NamedPlot {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) svg: String,
}

/// A place on the horizontal axis that is marked by a line, and what it is.
pub(super) struct Mark {
    pub(super) at: f64,
    pub(super) label: String,
}
