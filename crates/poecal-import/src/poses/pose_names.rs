//! Rows of two files that are of the same picture.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::table::picture_names::Partners;
use poecal_numerics::error::{ErrorKind, Result};

/// The names of the rows of a file, and their lines.
pub(crate) struct Named<'a> {
    pub(crate) path: &'a Path,
    pub(crate) names: &'a [String],
    pub(crate) lines: &'a [usize],
}

impl<'a> Named<'a> {
    /// The row of each name.
    ///
    /// # Errors
    /// [`ErrorKind::Measurement`] if a name comes twice, with its line.
    pub(crate) fn rows(&self) -> Result<BTreeMap<&'a String, usize>> {
        let mut rows = BTreeMap::new();
        for (row, name) in self.names.iter().enumerate() {
            if rows.insert(name, row).is_some() {
                return Err(ErrorKind::Measurement
                    .error(format!(
                        "found the name `{name}` a second time, expected each pose once: rename it"
                    ))
                    .at_line(self.path, self.lines.get(row).copied().unwrap_or(1)));
            }
        }
        Ok(rows)
    }
}

/// Rows of the same name, or whose names end in the same number, in the order of the first file.
pub(crate) fn by_name(
    first: &Named<'_>,
    second: &Named<'_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, usize)>> {
    let (one, other) = (first.rows()?, second.rows()?);
    let names = |rows: &BTreeMap<_, usize>| rows.keys().copied().collect::<BTreeSet<&String>>();
    let partners = Partners::new(&names(&one), names(&other));
    let row_of = |name: &String| other.get(partners.of(name)?).copied();
    let rows: Vec<(usize, usize)> =
        first.names.iter().enumerate().filter_map(|(row, name)| Some((row, row_of(name)?))).collect();
    if rows.is_empty() {
        return Err(ErrorKind::Measurement
            .error(format!(
                "found no name that is in {} too, expected the same names in both files, or ones that end in the same number, each once",
                second.path.display()
            ))
            .in_file(first.path));
    }
    if let Some((name, other)) = partners.first {
        warnings.push(format!(
            "took the poses whose names end in the same number for the same, {} of {}: `{name}` is `{other}`",
            partners.alike.len(),
            rows.len()
        ));
    }
    let alone = one.len() + other.len() - 2 * rows.len();
    if alone > 0 {
        warnings.push(format!(
            "{alone} poses are in one of the two files only, and left out; {} are in both",
            rows.len()
        ));
    }
    Ok(rows)
}
