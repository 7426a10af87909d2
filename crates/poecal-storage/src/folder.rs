//! Members of a folder that is searched: regular files and folders in it. Reading a pipe would block, and a link could lead anywhere.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use super::disk::{self, ObjectKind};
use super::limits::ResourceLimit;

/// A member of a folder that is not taken.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SkippedEntry {
    /// Its path; in a name that is not UTF-8, invalid bytes are replaced by signs.
    pub path: PathBuf,
    /// The reason, as a noun.
    pub reason: &'static str,
}

impl fmt::Display for SkippedEntry {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: left out, since it is {}", self.path.display(), self.reason)
    }
}

/// The names in a folder, and those that are not UTF-8.
///
/// # Errors
/// Those of the system, and more names than [`ResourceLimit::Files`].
pub fn names(folder: &Path) -> io::Result<(Vec<String>, Vec<SkippedEntry>)> {
    let all = disk::current_disk().names(folder)?;
    let most = ResourceLimit::Files.value();
    if all.len() as u64 > most {
        return Err(io::Error::other(ResourceLimit::Files.sentence(&format!("{} files", all.len()))));
    }
    let (mut found, mut left) = (Vec::with_capacity(all.len()), Vec::new());
    for name in all {
        match name.into_string() {
            Ok(name) => found.push(name),
            Err(name) => {
                let path = folder.join(name.to_string_lossy().as_ref());
                left.push(SkippedEntry { path, reason: "a name that is no UTF-8" });
            }
        }
    }
    Ok((found, left))
}

/// Kind of a member of a folder, a file or a folder; links may only lead to others below `root`.
///
/// # Errors
/// The reason why it is neither.
pub fn kind(root: &Path, path: &Path) -> Result<ObjectKind, SkippedEntry> {
    let disk = disk::current_disk();
    let left = |reason| SkippedEntry { path: path.to_owned(), reason };
    let unknown = |_| left("nothing that can be looked at");
    let own = disk.look(path).map_err(unknown)?;
    let found = if own.kind == ObjectKind::Link {
        let actual = disk.canonical_path(path).map_err(|_| left("a link that leads nowhere"))?;
        let home = disk.canonical_path(root).map_err(unknown)?;
        if !actual.starts_with(&home) {
            return Err(left("a link that leads out of the folder"));
        }
        disk.follow(path).map_err(unknown)?
    } else {
        own
    };
    match found.kind {
        kind @ (ObjectKind::File | ObjectKind::Folder) => Ok(kind),
        ObjectKind::Link | ObjectKind::Other => Err(left("a pipe, a socket or a device")),
    }
}

/// The regular files of a folder with a wanted name, and members with such a name that are none.
///
/// # Errors
/// Those of [`names`].
pub fn files(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> io::Result<(Vec<String>, Vec<SkippedEntry>)> {
    let (names, mut left) = names(folder)?;
    let mut found = Vec::new();
    for name in names.into_iter().filter(|name| is_wanted(name)) {
        match kind(folder, &folder.join(&name)) {
            Ok(ObjectKind::File) => found.push(name),
            Ok(_) => {}
            Err(other) => left.push(other),
        }
    }
    Ok((found, left))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::limits;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    use std::os::unix::fs::symlink;

    #[test]
    fn only_regular_files_of_a_folder_are_taken() {
        let home = std::env::temp_dir().join(format!("poecal_folder_{}", std::process::id()));
        let (folder, outside) = (home.join("inbox"), home.join("outside.csv"));
        std::fs::create_dir_all(folder.join("sub.csv")).unwrap();
        for path in [&outside, &folder.join("a.csv"), &folder.join("a.txt")] {
            std::fs::write(path, "x").unwrap();
        }
        std::fs::write(folder.join(OsStr::from_bytes(b"b\xff.csv")), "x").unwrap();
        symlink("a.csv", folder.join("within.csv")).unwrap();
        symlink(&outside, folder.join("out.csv")).unwrap();
        symlink("nothing", folder.join("nowhere.csv")).unwrap();
        let socket = std::os::unix::net::UnixListener::bind(folder.join("pipe.csv")).unwrap();
        let (found, left) = files(&folder, |name| name.ends_with(".csv")).unwrap();
        let few = limits::current_limits().with_limit(ResourceLimit::Files, 3);
        let refused = limits::run_with_limits(few, || files(&folder, |_| true)).unwrap_err().to_string();
        drop(socket);
        std::fs::remove_dir_all(&home).unwrap();
        assert_eq!(found, ["a.csv", "within.csv"]);
        let told: Vec<(String, &str)> =
            left.iter().map(|it| (it.path.file_name().unwrap().to_string_lossy().into_owned(), it.reason)).collect();
        assert_eq!(
            told,
            [
                ("b\u{fffd}.csv".to_owned(), "a name that is no UTF-8"),
                ("nowhere.csv".to_owned(), "a link that leads nowhere"),
                ("out.csv".to_owned(), "a link that leads out of the folder"),
                ("pipe.csv".to_owned(), "a pipe, a socket or a device"),
            ]
        );
        assert!(refused.starts_with("found 8 files, expected at most 3 files (limit `files`)"), "{refused}");
    }
}
