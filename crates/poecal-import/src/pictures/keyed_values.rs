//! Values of a file of cameras or boards, by their keys.

use std::path::Path;

use super::lens_checks::EXPECTED;
use poecal_model::camera::size_of_pictures;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::other_keys::{KeyOwner, other_keys};
use poecal_storage::xml::parsed;
use poecal_storage::yaml::YamlLeaf;

/// True if keys are indices of lists.
pub(crate) fn are_places(keys: &[String]) -> bool {
    keys.iter().all(|key| !key.is_empty() && key.bytes().all(|it| it.is_ascii_digit()))
}

/// The words of an XML text below the names of their elements, without that of the root. Several words in an element have an index each.
pub(crate) fn of_xml(text: &str, path: &Path, expected: &str) -> Result<Vec<YamlLeaf>> {
    let document = parsed(text, path, expected)?;
    // Elements are in the order of the text, so that newlines are counted from one to the next.
    let (mut line, mut at) = (1, 0);
    let mut found = Vec::new();
    for node in document.descendants().filter(|node| node.is_element()) {
        let start = node.range().start;
        line += text.get(at..start).unwrap_or_default().matches('\n').count();
        at = start;
        let Some(own) = node.text().filter(|_| !node.children().any(|it| it.is_element())) else { continue };
        let mut keys: Vec<String> =
            node.ancestors().filter(|it| it.is_element()).map(|it| it.tag_name().name().to_owned()).collect();
        keys.pop();
        keys.reverse();
        let leaf = |path, text: &str| YamlLeaf { path, text: text.to_owned(), line };
        let words: Vec<&str> = own.split_whitespace().collect();
        if words.len() > 1 && words.iter().all(|it| it.parse::<f64>().is_ok()) {
            let word = |(at, word): (usize, &&str)| leaf(keys.iter().cloned().chain([at.to_string()]).collect(), word);
            found.extend(words.iter().enumerate().map(word));
        } else {
            found.push(leaf(keys, own.trim().trim_matches('"').trim()));
        }
    }
    Ok(found)
}

/// The numbers and words of a file with the keys that lead to them.
pub(crate) struct KeyedValues<'a> {
    pub(crate) leaves: Vec<YamlLeaf>,
    pub(crate) path: &'a Path,
}

impl KeyedValues<'_> {
    /// The values below these keys.
    pub(crate) fn keys_below(&self, keys: &[String]) -> Self {
        let own = |leaf: &YamlLeaf| {
            let path = leaf.path.strip_prefix(keys)?.to_vec();
            Some(YamlLeaf { path, ..leaf.clone() })
        };
        KeyedValues { leaves: self.leaves.iter().filter_map(own).collect(), path: self.path }
    }

    /// The word at the first of these keys that the file has; blanks separate the keys.
    pub(crate) fn word(&self, keys: &str) -> Option<&str> {
        let own = |leaf: &&YamlLeaf| matches!(leaf.path.as_slice(), [key] if keys.split(' ').any(|it| it == key));
        self.leaves.iter().find(own).map(|leaf| leaf.text.as_str())
    }

    /// The number at the first of these keys, which blanks separate; case does not matter.
    pub(crate) fn number_called(&self, keys: &str) -> Result<Option<f64>> {
        let is = |leaf: &&YamlLeaf, key: &str| {
            leaf.path.len() == 1 && leaf.path.iter().all(|it| it.eq_ignore_ascii_case(key))
        };
        let own = |key: &str| Some((self.leaves.iter().find(|leaf| is(leaf, key))?, key.to_owned()));
        keys.split(' ').find_map(own).map(|(leaf, key)| self.number_of(leaf, &key)).transpose()
    }

    /// The number at these keys, which dots join.
    pub(crate) fn number(&self, keys: &str) -> Result<Option<f64>> {
        let own = |leaf: &&YamlLeaf| leaf.path.iter().eq(keys.split('.'));
        self.leaves.iter().find(own).map(|leaf| self.number_of(leaf, keys)).transpose()
    }

    /// The numbers of the first list that exists; dots join the keys of a list, and blanks separate the lists.
    pub(crate) fn list(&self, lists: &str) -> Result<Vec<f64>> {
        for keys in lists.split(' ') {
            // Numbers in nested lists count too.
            let own = |leaf: &&YamlLeaf| {
                let (list, places) = leaf.path.split_at(keys.split('.').count().min(leaf.path.len()));
                !places.is_empty() && are_places(places) && list.iter().eq(keys.split('.'))
            };
            let found = self.leaves.iter().filter(own).map(|leaf| self.number_of(leaf, keys));
            let found: Vec<f64> = found.collect::<Result<_>>()?;
            if !found.is_empty() {
                return Ok(found);
            }
        }
        Ok(Vec::new())
    }

    fn number_of(&self, leaf: &YamlLeaf, keys: &str) -> Result<f64> {
        let number = leaf.text.parse().ok().filter(|it: &f64| it.is_finite());
        number.ok_or_else(|| {
            let message = format!("found `{}` in `{keys}`, expected a number", leaf.text);
            ErrorKind::Syntax.error(message).at_line(self.path, leaf.line)
        })
    }

    /// The unread keys at depth `at`, among the leaves that are `own`, in words; [`other_keys`] decides which are refused. Blanks separate the
    /// known keys. The first part counts if dots join several. A star at the end matches any end, unless the key contains `flip`.
    pub(crate) fn describe_other_keys(
        &self,
        of: KeyOwner,
        (at, own): (usize, impl Fn(&YamlLeaf) -> bool),
        known: &[&str],
    ) -> Result<Option<String>> {
        let own: Vec<YamlLeaf> = self.leaves.iter().filter(|leaf| own(leaf)).cloned().collect();
        let known = || known.iter().flat_map(|keys| keys.split(' ')).filter_map(|keys| keys.split('.').next());
        let is_it = |known: &str, key: &str| match known.strip_suffix('*') {
            Some(start) => key.starts_with(start) && !key.contains("flip"),
            None => known.eq_ignore_ascii_case(key),
        };
        other_keys(&own, at, |key| known().any(|known| is_it(known, key)), (of, self.path))
    }
}

/// Refuses a file of cameras.
pub(crate) fn refuse<T>(path: &Path, message: impl Into<String>) -> Result<T> {
    Err(ErrorKind::Measurement.error(message).in_file(path))
}

/// The size of pictures as a list of two numbers.
pub(crate) fn listed_size(stated: &KeyedValues<'_>, key: &str) -> Result<Option<[u32; 2]>> {
    let size = <[f64; 2]>::try_from(stated.list(key)?).ok();
    let size_px = size_of_pictures(size.map_or([None; 2], |it| it.map(Some)));
    size_px.map_err(|error| error.in_file(stated.path))
}

/// The numbers of a key, which must be `N`.
pub(crate) fn exact_numbers<const N: usize>(numbers: Vec<f64>, key: &str, path: &Path) -> Result<[f64; N]> {
    numbers.try_into().or_else(|numbers: Vec<f64>| {
        refuse(path, format!("found {} numbers of `{key}`, expected {N}: {EXPECTED}", numbers.len()))
    })
}
