//! Inputs that are opened once: the bytes that were read are kept for each later question about the same path.
//!
//! So a pipe answers like a file, and all answers are from the same bytes while a log grows. This applies within [`reading`] only. Elsewhere, and
//! for [streamed](super::source::open_streamed) inputs, nothing is kept. Most questions concern the beginning of a file, so at most 64 MiB of it
//! are kept. Of many files few stay open: the others are opened again.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::disk;
use poecal_numerics::error::Result;

/// Number of bytes that are read from an input at a time.
const BLOCK: usize = 1 << 16;
/// Largest number of bytes of a file that are kept.
const MOST_KEPT: usize = 64 << 20;
/// Largest number of files that stay open.
const MOST_OPEN: usize = 64;

thread_local! {
    /// The open inputs of this thread, within [`reading`].
    static OPEN: RefCell<Option<BTreeMap<PathBuf, InputDocument>>> = const { RefCell::new(None) };
}

/// Runs `work`, during which this thread opens each input once.
pub fn reading<T>(work: impl FnOnce() -> T) -> T {
    if OPEN.with_borrow(Option::is_some) {
        return work();
    }
    let _end = InputGuard;
    OPEN.set(Some(BTreeMap::new()));
    work()
}

/// Runs `work` like [`reading`], with an input of this name and text, which is on no disk.
pub fn reading_text<T>(name: &Path, text: &str, work: impl FnOnce() -> T) -> T {
    reading(|| {
        let before = keep(name, Some(InputDocument::new(Box::new(Cursor::new(text.as_bytes().to_vec())), None)));
        let done = work();
        keep(name, before);
        done
    })
}

/// Keeps this as the input of a path, or nothing; returns the previous input.
fn keep(path: &Path, document: Option<InputDocument>) -> Option<InputDocument> {
    OPEN.with_borrow_mut(|all| match document {
        Some(document) => all.as_mut()?.insert(path.to_path_buf(), document),
        None => all.as_mut()?.remove(path),
    })
}

/// True if a path is that of an input that is kept: no folder.
pub fn is_kept(path: &Path) -> bool {
    OPEN.with_borrow(|all| all.as_ref().is_some_and(|all| all.contains_key(path)))
}

/// Forgets all inputs, also after a panic.
struct InputGuard;

impl Drop for InputGuard {
    fn drop(&mut self) {
        OPEN.set(None);
    }
}

/// Forgets all inputs: for code that changes files that may be inputs.
pub fn forget() {
    OPEN.with_borrow_mut(|open| open.iter_mut().for_each(BTreeMap::clear));
}

/// A reader of an input from its beginning: from the kept bytes, then from the source that `open` opens.
pub(crate) fn open(path: &Path, open: impl FnOnce() -> Result<ByteSource>) -> Result<ByteSource> {
    let kept = OPEN.with_borrow(|all| all.as_ref().map(|all| all.get(path).cloned()));
    Ok(match kept {
        None => open()?,
        Some(Some(document)) => Box::new(DocumentReader::Kept(document)),
        Some(None) => {
            close_most();
            let document = InputDocument::new(open()?, disk::is_file(path).then(|| path.to_path_buf()));
            keep(path, Some(document.clone()));
            Box::new(DocumentReader::Kept(document))
        }
    })
}

/// Closes the files that are kept, if there are many.
fn close_most() {
    OPEN.with_borrow(|all| {
        let all = all.iter().flatten().map(|it| it.1);
        if all.clone().count() >= MOST_OPEN {
            all.for_each(|document| document.kept_input().close());
        }
    });
}

/// A reader of an input from its beginning, if it is kept.
pub(crate) fn reopen(path: &Path) -> Option<ByteSource> {
    OPEN.with_borrow(|all| Some(Box::new(DocumentReader::Kept(all.as_ref()?.get(path)?.clone())) as ByteSource))
}

/// A reader of an input whose bytes are no longer kept: bytes that were read before are read again.
pub(crate) fn stream(path: &Path, open: impl FnOnce() -> Result<ByteSource>) -> Result<io::Result<ByteSource>> {
    match OPEN.with_borrow_mut(|all| all.as_mut()?.remove(path)) {
        None => open().map(Ok),
        Some(document) => Ok(document.into_stream()),
    }
}

/// Bytes that are still to be read.
pub(crate) type ByteSource = Box<dyn Read + Send>;

/// The bytes that were read from an input, and the rest of it.
struct BufferedInput {
    bytes: Vec<u8>,
    /// `None` for a file that was closed.
    rest: Option<ByteSource>,
    /// The path of a file, which can be opened again.
    path: Option<PathBuf>,
}

impl BufferedInput {
    fn close(&mut self) {
        if self.path.is_some() {
            self.rest = None;
        }
    }

    /// The rest, opened again if it was closed.
    fn take_rest(&mut self) -> io::Result<ByteSource> {
        let Some(path) = self.path.as_ref().filter(|_| self.rest.is_none()) else {
            return Ok(self.rest.take().unwrap_or_else(|| Box::new(io::empty())));
        };
        let mut again = disk::current_disk().open(path)?;
        io::copy(&mut again.by_ref().take(self.bytes.len() as u64), &mut io::sink())?;
        Ok(again)
    }
}

/// An input, read from its beginning.
#[derive(Clone)]
struct InputDocument {
    kept: Arc<Mutex<BufferedInput>>,
    at: usize,
}

impl InputDocument {
    fn new(rest: ByteSource, path: Option<PathBuf>) -> Self {
        InputDocument { kept: Arc::new(Mutex::new(BufferedInput { bytes: Vec::new(), rest: Some(rest), path })), at: 0 }
    }

    fn kept_input(&self) -> MutexGuard<'_, BufferedInput> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn into_stream(self) -> io::Result<ByteSource> {
        match Arc::try_unwrap(self.kept) {
            Ok(kept) => {
                let mut kept = kept.into_inner().unwrap_or_else(PoisonError::into_inner);
                let rest = kept.take_rest()?;
                Ok(Box::new(Cursor::new(kept.bytes).chain(rest)))
            }
            // Another reader uses it at the moment.
            Err(kept) => Ok(Box::new(DocumentReader::Kept(InputDocument { kept, at: 0 }))),
        }
    }
}

/// A reader of an input: of the kept bytes, or of the rest of a file, which is not kept.
enum DocumentReader {
    Kept(InputDocument),
    Rest(ByteSource),
}

impl Read for DocumentReader {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let document = match self {
            DocumentReader::Rest(rest) => return rest.read(into),
            DocumentReader::Kept(document) => document,
        };
        let mut kept = document.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if document.at == kept.bytes.len() {
            let mut rest = kept.take_rest()?;
            if kept.path.is_some() && kept.bytes.len() >= MOST_KEPT {
                drop(kept);
                let count = rest.read(into)?;
                *self = DocumentReader::Rest(rest);
                return Ok(count);
            }
            let read = rest.by_ref().take(BLOCK.max(into.len()) as u64).read_to_end(&mut kept.bytes);
            // At its end it is closed, and not opened again; after an error it may fail again.
            match read {
                Ok(0) => kept.path = None,
                _ => kept.rest = Some(rest),
            }
            read?;
        }
        let count = kept.bytes.get(document.at..).unwrap_or_default().read(into)?;
        document.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A source that counts how often it was opened, and the bytes that were read.
    fn text_of(path: &str, opened: &mut usize, text: &'static [u8]) -> String {
        let mut read = String::new();
        let mut source = open(Path::new(path), || {
            *opened += 1;
            Ok(Box::new(text))
        })
        .unwrap();
        source.read_to_string(&mut read).unwrap();
        read
    }

    #[test]
    fn an_input_is_opened_once_and_read_by_all_from_its_beginning() {
        let mut opened = 0;
        reading(|| {
            let mut begun = open(Path::new("a"), || Ok(Box::new(&b"0123456789"[..]))).unwrap();
            let mut head = [0; 3];
            begun.read_exact(&mut head).unwrap();
            assert_eq!(text_of("a", &mut opened, b"another"), "0123456789");
            let mut rest = String::new();
            begun.read_to_string(&mut rest).unwrap();
            assert_eq!((&head, rest.as_str()), (b"012", "3456789"));
            assert_eq!(text_of("b", &mut opened, b"b"), "b");
            // Nested work belongs to the outer work.
            reading(|| assert_eq!(text_of("b", &mut opened, b"c"), "b"));
            assert_eq!(opened, 1);
            forget();
            assert_eq!(text_of("a", &mut opened, b"another"), "another");
        });
        assert_eq!(text_of("a", &mut opened, b"1"), "1");
        assert_eq!(text_of("a", &mut opened, b"2"), "2");
        assert_eq!(opened, 4);
    }

    #[test]
    fn a_stream_has_what_was_read_before_and_is_not_kept() {
        let mut opened = 0;
        reading(|| {
            assert_eq!(text_of("a", &mut opened, b"begun"), "begun");
            let mut read = String::new();
            stream(Path::new("a"), || unreachable!()).unwrap().unwrap().read_to_string(&mut read).unwrap();
            assert_eq!(read, "begun");
            assert_eq!(text_of("a", &mut opened, b"again"), "again");
        });
    }

    /// More files than stay open, each longer than one block: first their beginnings are read, then the rest.
    #[test]
    fn files_that_were_closed_are_opened_again_where_they_were_left() {
        let folder = std::env::temp_dir().join(format!("poecal_documents_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let text = |k: usize| format!("{k:06}").repeat(BLOCK / 4).into_bytes();
        let paths: Vec<PathBuf> = (0..MOST_OPEN + 6).map(|k| folder.join(k.to_string())).collect();
        paths.iter().enumerate().for_each(|(k, path)| std::fs::write(path, text(k)).unwrap());
        let source = |path: &PathBuf| open(path, || Ok(disk::current_disk().open(path).unwrap())).unwrap();
        reading(|| {
            let mut begun: Vec<ByteSource> = paths.iter().map(source).collect();
            let mut head = [0; 10];
            begun.iter_mut().for_each(|it| it.read_exact(&mut head).unwrap());
            for (k, (path, begun)) in paths.iter().zip(&mut begun).enumerate() {
                let (mut rest, mut whole) = (Vec::new(), Vec::new());
                begun.read_to_end(&mut rest).unwrap();
                source(path).read_to_end(&mut whole).unwrap();
                assert!(whole == text(k) && rest == whole[10..], "{k}");
            }
        });
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_fails_while_it_is_read_fails_for_all() {
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
                Err(io::Error::other("the cable was pulled"))
            }
        }
        reading(|| {
            for _ in 0..2 {
                let source = open(Path::new("a"), || Ok(Box::new(b"begun".chain(Broken)))).unwrap();
                let read = io::read_to_string(source);
                assert_eq!(read.unwrap_err().to_string(), "the cable was pulled");
            }
        });
    }
}
