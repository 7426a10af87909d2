//! The claims of a paper as text of lines up to 80 characters.

use super::table::line;
use crate::reproduce::Reproduction;

/// Claim by claim: whether it holds, and what was measured.
#[must_use]
pub fn claims(found: &Reproduction) -> String {
    let mut out = String::new();
    for claim in &found.claims {
        line(&mut out, if claim.holds { "holds" } else { "not so" }, &claim.claim);
        line(&mut out, "", &claim.measured);
        out.push('\n');
    }
    let holding = found.claims.iter().filter(|claim| claim.holds).count();
    line(&mut out, "claims", &format!("{holding} of {} hold as they are made", found.claims.len()));
    out
}
