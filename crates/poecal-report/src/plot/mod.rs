//! Small static plots as SVG text: the same input gives the same bytes.
//!
//! Colours stand in the elements as for light paper, and each element has a class, so that a page's style sheet can replace them.
//! A series has its own marker and dash beside its colour. The legend stands above the axes, never on the data. Values that an
//! axis cannot show are drawn hollow at its edge (zero on a logarithmic axis, infinity) or left out (not a number), and a note
//! below the plot says so.
//!
//! No robots and no calibrations here: it gets numbers, titles and axes.

mod arms;
mod axis;
mod dots;
mod frame;
mod graph;
mod heat;
mod join_plot;
mod line;
mod ranges;
mod smooth;
mod strips;
mod svg;

pub use arms::{ArmPlot, ArmSeries};
pub use axis::{AxisScale, PlotAxis};
pub use dots::{DotPlot, Dots};
pub use graph::{DotSeries, Graph, PlotShape, VerticalAxis};
pub use heat::{HeatCell, HeatMap};
pub use join_plot::{JoinPlot, JoinedEntry, JoinedList};
pub use line::{Band, LinePlot, PlotLine};
pub use ranges::{RangePlot, RangeRow};
pub use smooth::{SmoothCurve, normal_quantile, quantile};
pub use strips::{CELLS, StripPlot, StripRow};

/// A plot and the name of its file, without the extension.
pub struct NamedPlot {
    pub name: String,
    pub title: String,
    pub svg: String,
}

/// A place on the horizontal axis that is marked by a line, and what it is.
pub struct AxisMark {
    pub at: f64,
    pub label: String,
}
