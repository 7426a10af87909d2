//! Which names of pictures of two files are of the same picture.

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

/// Of names with a number at their end the one of each number, if no other has it.
fn by_number<'a>(names: impl Iterator<Item = &'a String>) -> BTreeMap<u64, Option<&'a String>> {
    let mut found: BTreeMap<u64, Option<&String>> = BTreeMap::new();
    for name in names {
        let Some(number) = number_at_end(name) else { continue };
        found.entry(number).and_modify(|one| *one = None).or_insert(Some(name));
    }
    found
}

/// Which names of another file are of the same pictures.
pub(crate) struct Partners<'a> {
    others: BTreeSet<&'a String>,
    /// Names that are not the same, and end in the same number.
    pub(crate) alike: BTreeMap<&'a String, &'a String>,
    /// The first of these, by its number.
    first: Option<(&'a String, &'a String)>,
}

impl<'a> Partners<'a> {
    pub(crate) fn new(own: &BTreeSet<&'a String>, others: BTreeSet<&'a String>) -> Self {
        let pairs = same_numbers(own, &others);
        let first = pairs.first().copied();
        Partners { others, alike: pairs.into_iter().collect(), first }
    }

    /// What was taken for the same by its number, of so many, in words.
    pub(crate) fn words(&self, what: &str, all: usize) -> Option<String> {
        let ((name, other), some) = (self.first?, self.alike.len());
        Some(format!(
            "took the {what} whose names end in the same number for the same, {some} of {all}: `{name}` is `{other}`"
        ))
    }

    /// The other file's name of a picture: the same, or that with the same number.
    pub(crate) fn partner(&self, name: &String) -> Option<&'a String> {
        self.others.get(name).or_else(|| self.alike.get(name)).copied()
    }
}

/// Of names that the other file does not have, those that end in the same number as one of its names, each once in its file.
fn same_numbers<'a>(
    own: &BTreeSet<&'a String>,
    others: &BTreeSet<&'a String>,
) -> Vec<(&'a String, &'a String)> {
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
