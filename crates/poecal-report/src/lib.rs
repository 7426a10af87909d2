//! Results as text for people: the HTML report, certificates, tables of the program, and their JSON.
//!
//! A part of [poecal](https://docs.rs/poecal), for the other parts, the program and the package: its interface follows their needs and promises
//! nothing by itself.
//!
//! No number here that is not in the result, except sums over the rows of `residuals.csv`. `page` makes HTML by maud, which escapes it, and
//! [`visible_markup`](poecal_numerics::text::visible_markup) is applied to the whole. Its style and script are built from `web/src` into
//! `page/assets`. [`plot`] takes numbers, titles and axes, and returns SVG, without robots and calibrations.
//!
//! Not here: files (`poecal-results` writes the texts), and computation except for charts: smoothed curves, and the motion of measured targets with
//! the joints.

#![forbid(unsafe_code)]

mod acceptance;
mod check;
mod comparison;
mod fitted_cameras;
mod fleet;
mod fleet_prior;
mod hand_eye;
mod identify;
mod iso9283;
mod judgement;
mod offsets;
mod outliers;
mod page;
mod plan;
#[doc(hidden)]
pub mod plot;
mod row_report;
mod shade;
mod sight;
mod summary;
#[doc(hidden)]
pub mod table;
mod tcp;
mod track;
mod track_entries;

pub use check::{Check, SetCounts};
pub use comparison::ComparisonReport;
pub use fleet::{FleetLine, LineFigure, PriorUse};
pub use fleet_prior::fleet_prior;
pub use hand_eye::{hand_eye, hand_eye_answer};
pub use identify::Identify;
pub use iso9283::{TestPlan, iso9283, iso9283_answer};
pub use judgement::{describe_judgement, judgement};
pub use offsets::Offsets;
pub use page::{
    CertificateExtras, calibration_page, calibration_page_with, certificate_page, fleet_page, plan_page,
    test_certificate_page, test_page, validation_page, visit_page,
};
pub use plan::PlanReport;
pub use row_report::RowReport;
pub use summary::{Detail, ShortTable, short_summary, summary};
pub use tcp::{tool_tip, tool_tip_answer};
pub use track::{TrackReport, WitnessPlan, describe_recalibrated};

use serde::Serialize;

use poecal_numerics::error::Result;
use poecal_storage::json_text;

/// A result as JSON, with a line break at its end.
///
/// # Errors
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if it cannot be written as JSON.
pub fn json(result: &impl Serialize) -> Result<String> {
    json_text(result, "result")
}
