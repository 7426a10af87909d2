//! Each operation with existing names, and with obstructed ones.

use std::io::{ErrorKind, Read as _, Write as _};
use std::path::Path;

use poecal_storage::disk::{Disk as _, ObjectKind};
use poecal_wasm::MemoryDisk;

fn disk() -> MemoryDisk {
    let disk = MemoryDisk::new(b"input".to_vec());
    for (path, text) in [("a/one", "1"), ("a/two", "2"), ("a/in/three", "3"), ("a.b", "beside"), ("b/four", "4")] {
        disk.put(Path::new(path), text.into()).unwrap();
    }
    disk
}

fn text(disk: &MemoryDisk, path: &str) -> String {
    let mut text = String::new();
    disk.open(Path::new(path)).unwrap().read_to_string(&mut text).unwrap();
    text
}

fn kind<T>(done: std::io::Result<T>) -> Option<ErrorKind> {
    done.err().map(|error| error.kind())
}

#[test]
fn names_are_found_as_on_a_system() {
    let disk = disk();
    assert_eq!(disk.names(Path::new("a")).unwrap(), ["in", "one", "two"]);
    assert_eq!(disk.names(Path::new(".")).unwrap(), ["a", "a.b", "b"]);
    assert_eq!(disk.look(Path::new("./a/../a/in")).unwrap().kind, ObjectKind::Folder);
    assert_eq!(kind(disk.look(Path::new("c"))), Some(ErrorKind::NotFound));
    assert_eq!(kind(disk.look(Path::new("a/one/x"))), Some(ErrorKind::NotADirectory));
    assert_eq!(kind(disk.open(Path::new("a"))), Some(ErrorKind::IsADirectory));
    assert_eq!(kind(disk.names(Path::new("a/one"))), Some(ErrorKind::NotADirectory));
    assert_eq!(disk.canonical_path(Path::new("/../b/./four")).unwrap(), Path::new("/b/four"));
}

#[test]
fn nothing_in_the_way_is_replaced() {
    let disk = disk();
    assert_eq!(kind(disk.create(Path::new("a/one"))), Some(ErrorKind::AlreadyExists));
    assert_eq!(kind(disk.create_folder(Path::new("a"))), Some(ErrorKind::AlreadyExists));
    assert_eq!(kind(disk.rename_new(Path::new("a/one"), Path::new("a/two"))), Some(ErrorKind::AlreadyExists));
    assert_eq!(kind(disk.link(Path::new("a/one"), Path::new("a/two"))), Some(ErrorKind::AlreadyExists));
    assert_eq!(kind(disk.put(Path::new("a/one"), Vec::new())), Some(ErrorKind::AlreadyExists));
    assert_eq!(kind(disk.put(Path::new("a/one/more"), Vec::new())), Some(ErrorKind::NotADirectory));
    assert_eq!(kind(disk.create(Path::new("c/new"))), Some(ErrorKind::NotFound));
    assert_eq!(kind(disk.remove_folder(Path::new("a"))), Some(ErrorKind::DirectoryNotEmpty));
    assert_eq!(kind(disk.remove_folder(Path::new("/"))), Some(ErrorKind::ResourceBusy));
    assert_eq!(kind(disk.remove_file(Path::new("a"))), Some(ErrorKind::IsADirectory));
    assert_eq!(kind(disk.rename_new(Path::new("a"), Path::new("a/in/a"))), Some(ErrorKind::InvalidInput));
    assert_eq!(kind(disk.rename(Path::new("a/one"), Path::new("b"))), Some(ErrorKind::IsADirectory));
    assert_eq!((text(&disk, "a/one"), text(&disk, "a/two")), ("1".to_owned(), "2".to_owned()));
    assert_eq!(disk.changes(), Default::default());
}

#[test]
fn folders_move_and_are_exchanged_with_all_below() {
    let disk = disk();
    disk.rename_new(Path::new("a"), Path::new("b/moved")).unwrap();
    assert_eq!(text(&disk, "b/moved/in/three"), "3");
    assert_eq!(text(&disk, "a.b"), "beside");
    disk.create_folder(Path::new("c")).unwrap();
    disk.exchange(Path::new("b"), Path::new("c")).unwrap();
    assert_eq!(disk.names(Path::new("b")).unwrap(), [""; 0]);
    assert_eq!(text(&disk, "c/moved/in/three"), "3");
    assert_eq!(kind(disk.exchange(Path::new("c"), Path::new("c/moved"))), Some(ErrorKind::InvalidInput));
    let (written, gone) = disk.changes();
    assert_eq!(written.keys().collect::<Vec<_>>(), ["c/four", "c/moved/in/three", "c/moved/one", "c/moved/two"]);
    assert_eq!(gone, ["a/in/three", "a/one", "a/two", "b/four"]);
}

#[test]
fn files_are_written_read_and_locked() {
    let disk = disk();
    let mut out = disk.create(Path::new("new")).unwrap();
    out.write_all(b"some ").unwrap();
    // A reader has the content at the time of opening.
    let mut early = disk.open(Path::new("new")).unwrap();
    out.write_all(b"text").unwrap();
    out.sync().unwrap();
    let mut read = String::new();
    early.read_to_string(&mut read).unwrap();
    assert_eq!((read.as_str(), text(&disk, "new").as_str()), ("some ", "some text"));
    disk.rename(Path::new("new"), Path::new("a/one")).unwrap();
    assert_eq!(text(&disk, "a/one"), "some text");
    let lock = disk.lock(Path::new("lock")).unwrap();
    assert!(lock.is_some() && disk.lock(Path::new("lock")).unwrap().is_none());
    drop(lock);
    assert!(disk.lock(Path::new("lock")).unwrap().is_some());
    let mut input = String::new();
    disk.standard_input().unwrap().read_to_string(&mut input).unwrap();
    assert_eq!(input, "input");
    assert_eq!(kind(disk.standard_input()), Some(ErrorKind::ResourceBusy));
}
