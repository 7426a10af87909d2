//! Matching of the names of pictures in two files.

use std::collections::{BTreeMap, BTreeSet};

/// The number at the end of a picture's name, without its folder and the ending of a file.
pub(crate) fn number_at_end(name: &str) -> Option<u64> {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = match file.rsplit_once('.') {
        Some((stem, end)) if end.contains(|it: char| it.is_ascii_alphabetic()) => stem,
        _ => file,
    };
    let start = stem.trim_end_matches(|it: char| it.is_ascii_digit());
    stem.get(start.len()..)?.parse().ok()
}

/// The name for each number at the end; `None` if several names have the number.
fn by_number<'a>(names: impl Iterator<Item = &'a String>) -> BTreeMap<u64, Option<&'a String>> {
    let mut found: BTreeMap<u64, Option<&String>> = BTreeMap::new();
    for name in names {
        let Some(number) = number_at_end(name) else { continue };
        found.entry(number).and_modify(|one| *one = None).or_insert(Some(name));
    }
    found
}

/// Names of another file that belong to the same pictures.
pub(crate) struct PicturePartners<'a> {
    others: BTreeSet<&'a String>,
    /// Names that differ, and end in the same number.
    pub(crate) alike: BTreeMap<&'a String, &'a String>,
    /// The first of these pairs.
    first: Option<(&'a String, &'a String)>,
}

impl<'a> PicturePartners<'a> {
    pub(crate) fn new(own: &BTreeSet<&'a String>, others: BTreeSet<&'a String>) -> Self {
        let pairs = same_numbers(own, &others);
        let first = pairs.first().copied();
        PicturePartners { others, alike: pairs.into_iter().collect(), first }
    }

    /// The pictures that were matched by number, of `all`, in words.
    pub(crate) fn words(&self, what: &str, all: usize) -> Option<String> {
        let ((name, other), some) = (self.first?, self.alike.len());
        Some(format!(
            "took the {what} whose names end in the same number for the same, {some} of {all}: `{name}` is `{other}`"
        ))
    }

    /// The other file's name of a picture: the same, or the one with the same number.
    pub(crate) fn partner(&self, name: &String) -> Option<&'a String> {
        self.others.get(name).or_else(|| self.alike.get(name)).copied()
    }
}

/// Pairs of names without an equal in the other file that end in the same number, each once in its file.
fn same_numbers<'a>(own: &BTreeSet<&'a String>, others: &BTreeSet<&'a String>) -> Vec<(&'a String, &'a String)> {
    let (numbers, other_numbers) = (by_number(own.iter().copied()), by_number(others.iter().copied()));
    let pair = |(number, name): (u64, Option<&'a String>)| {
        let name = name.filter(|name| !others.contains(name))?;
        let other = other_numbers.get(&number).copied().flatten().filter(|other| !own.contains(other))?;
        Some((name, other))
    };
    numbers.into_iter().filter_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_in_a_number_whatever_their_folder_and_ending() {
        for (name, number) in [
            ("image-12.png", Some(12)),
            ("configuration_12", Some(12)),
            ("joints/configuration_12.yaml", Some(12)),
            ("12", Some(12)),
            (r"C:\seen\IMG_0012.JPG", Some(12)),
            ("image-12a.png", None),
            ("left.png", None),
            ("", None),
            ("99999999999999999999999", None),
        ] {
            assert_eq!(number_at_end(name), number, "{name}");
        }
    }
}
