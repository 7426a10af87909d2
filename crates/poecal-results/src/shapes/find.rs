//! Search for the files that a URDF names.

use std::path::{Path, PathBuf};

use poecal_storage::disk::{self, ObjectKind};

/// Folders beside files, each with its ancestors.
pub(crate) struct Folders {
    ways: Vec<Vec<PathBuf>>,
}

impl Folders {
    /// Folders of some files, which need not exist.
    pub(crate) fn from_files(files: &[&Path]) -> Self {
        let mut ways: Vec<Vec<PathBuf>> = Vec::new();
        for file in files {
            let Some(way) = way(file.parent().unwrap_or(Path::new(""))) else { continue };
            if !ways.contains(&way) {
                ways.push(way);
            }
        }
        Folders { ways }
    }

    /// The file of a name. `package://NAME/…` is searched in each folder upwards that is the package or contains it; other names beside the URDF.
    pub(crate) fn find(&self, name: &str) -> Option<PathBuf> {
        let packaged = ["package://", "model://"].iter().find_map(|scheme| name.strip_prefix(scheme));
        if let Some(rest) = packaged {
            return self.find_in_package(rest);
        }
        let plain = name.strip_prefix("file://").unwrap_or(name);
        if plain.contains("://") {
            return None;
        }
        // A path from the root replaces the folder.
        self.ways.iter().filter_map(|way| way.first()).map(|folder| folder.join(plain)).find(|path| is_file(path))
    }

    fn find_in_package(&self, rest: &str) -> Option<PathBuf> {
        let (package, inner) = rest.split_once('/')?;
        let places = self.ways.iter().flatten().flat_map(|folder| {
            let own = folder.file_name().is_some_and(|name| name == package).then(|| folder.join(inner));
            own.into_iter().chain([folder.join(package).join(inner)])
        });
        places.into_iter().find(|path| is_file(path))
    }
}

/// A folder and its ancestors, from the root's names; the folder itself need not exist.
fn way(folder: &Path) -> Option<Vec<PathBuf>> {
    let disk = disk::current_disk();
    let named = |folder: &Path| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_path_buf() };
    let actual = disk.canonical_path(&named(folder)).ok().or_else(|| {
        let above = disk.canonical_path(&named(folder.parent()?)).ok()?;
        Some(above.join(folder.file_name()?))
    })?;
    Some(actual.ancestors().map(Path::to_path_buf).collect())
}

fn is_file(path: &Path) -> bool {
    disk::current_disk().follow(path).is_ok_and(|found| found.kind == ObjectKind::File)
}
