//! What a file of cameras or boards states, by its keys.

use std::path::Path;

use poecal_numerics::error::{ErrorKind, Result};
use poecal_storage::other_keys::{KeysOf, other_keys};
use poecal_storage::yaml::Leaf;

/// The numbers and words of a file with the keys that lead to them.
pub(crate) struct Stated<'a> {
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) path: &'a Path,
}

impl Stated<'_> {
    /// The same of what stands below a key.
    pub(crate) fn below(&self, key: &str) -> Self {
        let own = |leaf: &Leaf| {
            let path = leaf.path.strip_prefix(&[key.to_owned()])?.to_vec();
            Some(Leaf { path, ..leaf.clone() })
        };
        Stated { leaves: self.leaves.iter().filter_map(own).collect(), path: self.path }
    }

    /// The first word of the file that one of these keys has; blanks are between them.
    pub(crate) fn word(&self, keys: &str) -> Option<&str> {
        let own = |leaf: &&Leaf| matches!(leaf.path.as_slice(), [key] if keys.split(' ').any(|it| it == key));
        self.leaves.iter().find(own).map(|leaf| leaf.text.as_str())
    }

    /// The number that keys lead to, with dots between them.
    pub(crate) fn number(&self, keys: &str) -> Result<Option<f64>> {
        let own = |leaf: &&Leaf| leaf.path.iter().eq(keys.split('.'));
        self.leaves.iter().find(own).map(|leaf| self.number_of(leaf, keys)).transpose()
    }

    /// The numbers of the first list that is there of those to which keys lead, with dots between them and blanks between the lists.
    pub(crate) fn list(&self, lists: &str) -> Result<Vec<f64>> {
        for keys in lists.split(' ') {
            let own = |leaf: &&Leaf| {
                let list = leaf.path.split_last().filter(|it| it.0.bytes().all(|byte| byte.is_ascii_digit()));
                list.is_some_and(|(_, list)| list.iter().eq(keys.split('.')))
            };
            let found = self.leaves.iter().filter(own).map(|leaf| self.number_of(leaf, keys));
            let found: Vec<f64> = found.collect::<Result<_>>()?;
            if !found.is_empty() {
                return Ok(found);
            }
        }
        Ok(Vec::new())
    }

    fn number_of(&self, leaf: &Leaf, keys: &str) -> Result<f64> {
        let number = leaf.text.parse().ok().filter(|it: &f64| it.is_finite());
        number.ok_or_else(|| {
            let message = format!("found `{}` in `{keys}`, expected a number", leaf.text);
            ErrorKind::Syntax.error(message).at_line(self.path, leaf.line)
        })
    }

    /// The keys at the place `at` that were not read, of the leaves that are `own`, in words; [`other_keys`] says which are refused. Known are lists of
    /// keys with blanks between them: of one with dots the first part, and all that begin with one with a star, unless they flip something.
    pub(crate) fn others(
        &self,
        of: KeysOf,
        (at, own): (usize, impl Fn(&Leaf) -> bool),
        known: &[&str],
    ) -> Result<Option<String>> {
        let own: Vec<Leaf> = self.leaves.iter().filter(|leaf| own(leaf)).cloned().collect();
        let known =
            || known.iter().flat_map(|keys| keys.split(' ')).filter_map(|keys| keys.split('.').next());
        let is_it = |known: &str, key: &str| match known.strip_suffix('*') {
            Some(start) => key.starts_with(start) && !key.contains("flip"),
            None => known.eq_ignore_ascii_case(key),
        };
        other_keys(&own, at, |key| known().any(|known| is_it(known, key)), (of, self.path))
    }
}
