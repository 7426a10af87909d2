//! Reports: of a reproduction of lou2009, as Markdown, HTML and plots from the same findings; and of the effect of gross errors.

mod breakdown;
mod claims;
mod comparison;
mod document;
mod figures;
mod html;
mod markdown;
mod numbers;
mod sections;
mod tables;

pub use breakdown::{breakdown_files, breakdown_table};
pub use claims::claims;

use crate::Reproduction;
use poecal_numerics::error::Result;
use poecal_report::json;

/// The files of a reproduction's report, each with its name: `report.html` (complete in itself), `report.md`, the plots that it
/// shows (`figure-….svg`), and `results.json` (all findings).
///
/// # Errors
/// [`ErrorKind::Export`](poecal_numerics::error::ErrorKind::Export) if the findings cannot be written as JSON.
pub fn reproduction_files(found: &Reproduction) -> Result<Vec<(String, String)>> {
    let document = sections::document(found);
    let mut files = vec![
        ("report.html".to_owned(), html::html(&document)),
        ("report.md".to_owned(), markdown::markdown(&document)),
        ("results.json".to_owned(), json(found)?),
    ];
    files.extend(document.into_plots().map(|plot| (format!("{}.svg", plot.name), plot.svg)));
    Ok(files)
}
