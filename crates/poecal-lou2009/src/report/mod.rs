//! Reports: of a reproduction of lou2009, Markdown, HTML and plots from the same findings; of what gross errors do.

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
use poecal::error::Result;
use poecal::report::json;

/// The files of a reproduction's report, each with its name: `report.html` (complete in itself), `report.md`, the plots that it
/// shows (`figure-….svg`), and `results.json` (all findings).
///
/// ```
/// use poecal_lou2009::report::reproduction_files;
/// use poecal_lou2009::{PointRow, Reproduction};
/// let point = PointRow { nominal: [0.0; 3], prescribed: [0.0; 3], from_points: [0.0; 3] };
/// let findings = Reproduction {
///     version: "0.1.0".into(), command: "poecal reproduce lou2009 --out out".into(), seed: 1,
///     noise_position_m: 5e-5, noise_rotation_rad: 1e-4, length_m: 0.5, point,
///     runs: vec![], claims: vec![], screws: vec![], offsets: vec![], spectra: vec![], efficiency: vec![], basin: vec![],
/// };
/// let files = reproduction_files(&findings)?;
/// assert!(files.iter().any(|(name, text)| name == "report.md" && text.contains("poecal reproduce lou2009 --out out")));
/// # Ok::<(), poecal::Error>(())
/// ```
///
/// # Errors
/// [`ErrorKind::Export`](poecal::ErrorKind::Export) if the findings cannot be written as JSON.
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
