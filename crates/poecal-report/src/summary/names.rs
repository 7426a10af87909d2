//! The first few of many names.

/// The most that a list of the table names.
pub(crate) const MOST: usize = 5;

/// Some names, the first few of many.
pub(crate) fn names(all: &[&str]) -> String {
    if all.len() <= MOST {
        return all.join(", ");
    }
    format!("{}, … and {} more", all[..MOST - 1].join(", "), all.len() - (MOST - 1))
}
