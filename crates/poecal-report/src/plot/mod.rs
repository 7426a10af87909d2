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
mod joined;
mod line;
mod ranges;
mod smooth;
mod strips;
mod svg;

pub use arms::{ArmPlot, Arms};
pub use axis::{Axis, Scale};
pub use dots::{DotPlot, Dots};
pub use graph::{Graph, Shape, Side, Spots};
pub use heat::{HeatCell, HeatMap};
pub use joined::{Entry, JoinPlot, List};
pub use line::{Band, Line, LinePlot};
pub use ranges::{RangePlot, RangeRow};
pub use smooth::{Curve, normal_quantile, quantile};
pub use strips::{CELLS, Strip, StripPlot};

/// A plot and the name of its file, without the extension.
pub struct NamedPlot {
    pub name: String,
    pub title: String,
    pub svg: String,
}

/// A place on the horizontal axis that is marked by a line, and what it is.
pub struct Mark {
    pub at: f64,
    pub label: String,
}
