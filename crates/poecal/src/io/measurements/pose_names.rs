//! Rows of two files that have the same name.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{ErrorKind, Result};

/// The names of the rows of a file, and their lines.
pub(super) struct Named<'a> {
    pub(super) path: &'a Path,
    pub(super) names: &'a [String],
    pub(super) lines: &'a [usize],
}

/// Rows of the same name, or whose names end in the same number.
pub(super) fn by_name(
    first: &Named<'_>,
    second: &Named<'_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<(usize, usize)>> {
    let (one, other) = (first.names, second.names);
    let number = |name: &String| -> String {
        let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let stem = stem.split('.').next().unwrap_or(stem);
        let digits: String = stem
            .chars()
            .rev()
            .take_while(char::is_ascii_digit)
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .collect();
        let plain = digits.trim_start_matches('0');
        if digits.is_empty() {
            name.clone()
        } else if plain.is_empty() {
            "0".to_owned()
        } else {
            plain.to_owned()
        }
    };
    let exact = one.iter().any(|name| other.contains(name));
    let key = |name: &String| if exact { name.clone() } else { number(name) };
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (row, name) in other.iter().enumerate() {
        if places.insert(key(name), row).is_some() {
            return Err(ErrorKind::Measurement
                .error(format!("found the name `{name}` a second time, expected each pose once: rename it"))
                .at_line(second.path, second.lines.get(row).copied().unwrap_or(1)));
        }
    }
    let rows: Vec<(usize, usize)> =
        one.iter().enumerate().filter_map(|(row, name)| Some((row, *places.get(&key(name))?))).collect();
    if rows.is_empty() {
        return Err(ErrorKind::Measurement
            .error(format!("found no name that is in {} too, expected the same names in both files: join them by one column", second.path.display()))
            .in_file(first.path));
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
