//! The claims of a paper as text of lines up to 80 characters.

use crate::Reproduction;
use poecal_report::table::line;

/// Statements of the paper, and findings that it leaves out: for each its location, its outcome, and the measurement.
#[must_use]
pub fn claims(found: &Reproduction) -> String {
    let mut out = String::new();
    for (said_by_paper, title) in [(true, "What the paper says"), (false, "What the paper leaves out")] {
        out.push_str(title);
        out.push_str("\n\n");
        for claim in found.claims.iter().filter(|claim| claim.said_by_paper == said_by_paper) {
            line(&mut out, if claim.holds { "holds" } else { "not so" }, &claim.claim);
            line(&mut out, "  paper", &claim.paper);
            line(&mut out, "  measured", &claim.measured);
            line(&mut out, "  holds if", &claim.criterion);
            out.push('\n');
        }
        if said_by_paper {
            let (holding, all) = found.count_holding(true);
            line(&mut out, "claims", &format!("{holding} of {all} hold as they are made"));
            out.push('\n');
        }
    }
    out
}
