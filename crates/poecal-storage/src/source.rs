//! Opening of inputs, files and standard input: of limited size ([`ResourceLimit`]), and no archive or workbook.

use std::io::{self, Cursor, Read};
use std::path::Path;

use super::disk::{self, ObjectKind};
use super::document::{self, ByteSource};
use super::limits::{ResourceLimit, amount};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// The path that means standard input.
pub(crate) const STANDARD_INPUT: &str = "-";
/// Number of bytes by which other forms are recognised.
const HEAD: u64 = 16;

/// Description of a bag that cannot be read.
const BAG: &str = if cfg!(feature = "bags") {
    "a ROS 2 bag (.mcap), which is read as a measurement file"
} else {
    "a ROS 2 bag (.mcap); write its messages as tables with `ros2 topic echo --csv`"
};

/// Description of a bag in SQLite.
pub const SQLITE_BAG: &str = "a ROS 2 bag in SQLite (.db3), which the Python package reads (`Measurements.from_files`); `rosbags-convert --src BAG --dst NEW --dst-storage mcap` writes it as MCAP";

/// A form of files that is not read as a text.
struct BinaryForm {
    /// Beginnings of its files; empty if these are not specific.
    starts: &'static [&'static [u8]],
    /// Endings of their names, in small letters, if they begin like other files or like a text.
    ends: &'static [&'static str],
    /// Description of the files, with a remedy.
    words: &'static str,
}

const fn form(starts: &'static [&'static [u8]], ends: &'static [&'static str], words: &'static str) -> BinaryForm {
    BinaryForm { starts, ends, words }
}

/// Forms that are not read as a text.
const FORMS: [BinaryForm; 22] = [
    form(&[b"ISO-10303-21;"], &["step", "stp"], "a STEP file, which has shapes and no joints"),
    form(&[], &["igs", "iges"], "an IGES file, which has shapes and no joints"),
    form(&[], &["stl", "dae", "obj", "ply", "glb", "gltf", "3mf"], "a mesh, which has a shape and no joints"),
    form(
        &[],
        &["sldprt", "sldasm", "catpart", "catproduct", "ipt", "iam", "x_t", "x_b", "dwg", "dxf", "jt"],
        "a drawing of a CAD program, which has shapes and no joints that could be read",
    ),
    form(
        &[b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"II*\0", b"MM\0*"],
        &["png", "jpg", "jpeg", "gif", "tif", "tiff", "bmp", "webp", "heic", "svg"],
        "a picture",
    ),
    form(&[b"%PDF-"], &["pdf"], "a PDF"),
    form(&[], &["docx", "doc", "odt", "pptx"], "a document of an office program; save its table as `CSV UTF-8`"),
    form(&[b"PK\x03\x04"], &[], "a ZIP archive or a workbook such as .xlsx; save the table as `CSV UTF-8`"),
    form(&[b"\xd0\xcf\x11\xe0"], &[], "a workbook of the old .xls form; save the table as `CSV UTF-8`"),
    form(&[b"\x1f\x8b"], &[], "a file compressed by gzip (.gz); unpack it first"),
    form(&[b"\xfd7zXZ"], &[], "a file compressed by xz; unpack it first"),
    form(&[b"\x28\xb5\x2f\xfd"], &[], "a file compressed by zstd; unpack it first"),
    form(&[b"BZh"], &[], "a file compressed by bzip2; unpack it first"),
    form(
        &[b"MATLAB 5.0 MAT-f"],
        &[],
        "a MATLAB file (.mat), whose numbers have no names; write them with `writetable`, or hand them to `Measurements.from_arrays` in Python (`scipy.io.loadmat`)",
    ),
    form(&[b"SQLite format 3\0"], &[], SQLITE_BAG),
    form(
        &[b"#ROSBAG V"],
        &[],
        "a ROS 1 bag, which `rosbags` reads in Python; `rosbags-convert --src BAG --dst NEW --dst-storage mcap` writes it as MCAP",
    ),
    form(&[b"\x89MCAP0\r\n"], &[], BAG),
    form(
        &[b"\x89HDF\r\n\x1a\n"],
        &[],
        "an HDF5 file, or one of MATLAB 7.3; hand its arrays to `Measurements.from_arrays` in Python (`h5py`)",
    ),
    form(&[b"PAR1"], &[], "a Parquet file; hand it to `Measurements.from_dataframe` in Python (`pandas.read_parquet`)"),
    form(
        &[b"\x93NUMPY"],
        &[],
        "an array of NumPy (.npy); hand it to `Measurements.from_arrays` in Python (`numpy.load`)",
    ),
    form(
        &[b"\x02\x50"],
        &["c3d"],
        "motion capture as C3D; export its trajectories as CSV or TSV from Vicon, Motive or Qualisys, or hand them to `Measurements.from_arrays` in Python (`ezc3d`)",
    ),
    form(&[], &["mp4", "avi", "mov", "mkv"], "a film"),
];

impl BinaryForm {
    /// The error of a file of this form.
    fn error(&self, path: &Path, expected: &str) -> Error {
        ErrorKind::File.error(format!("found {}, expected {expected}", self.words)).in_file(path)
    }
}

/// An input. Reading beyond its largest size is an error.
pub struct Input {
    /// The head, which is examined first, and the rest.
    bytes: io::Chain<Cursor<Vec<u8>>, io::Take<ByteSource>>,
    limit: ResourceLimit,
}

/// Opens a file, or standard input for `-`; `expected` describes it in messages.
///
/// # Errors
/// [`ErrorKind::File`] if it is a directory, missing, unreadable, or of a form that is no text.
pub fn open(path: &Path, expected: &str, limit: ResourceLimit) -> Result<Input> {
    let (input, head) = open_any(path, expected, limit)?;
    refuse_other_forms(path, expected, &head)?;
    Ok(input)
}

/// Refuses a file that is no text, by its name or its first bytes.
pub fn refuse_other_forms(path: &Path, expected: &str, head: &[u8]) -> Result<()> {
    refuse_named(path, expected)?;
    let begins = |it: &&BinaryForm| it.starts.iter().any(|start| head.starts_with(start));
    FORMS.iter().find(begins).map_or(Ok(()), |form| Err(form.error(path, expected)))
}

/// Refuses a file that is no text, by its name only: many of these begin like a workbook.
pub fn refuse_named(path: &Path, expected: &str) -> Result<()> {
    let end = path.extension().map(|it| it.to_string_lossy().to_lowercase()).unwrap_or_default();
    let named = FORMS.iter().find(|form| form.ends.contains(&end.as_str()));
    named.map_or(Ok(()), |form| Err(form.error(path, expected)))
}

/// Opens a file of any form, with its first bytes.
pub fn open_any(path: &Path, expected: &str, limit: ResourceLimit) -> Result<(Input, Vec<u8>)> {
    open_with_head(document::open(path, || open_source(path, expected))?, path, expected, limit)
}

/// Opens a file that is too large to be kept, with its first bytes.
pub fn open_streamed(path: &Path, expected: &str, limit: ResourceLimit) -> Result<(Input, Vec<u8>)> {
    let source = document::stream(path, || open_source(path, expected))?;
    open_with_head(source.map_err(|cause| unreadable_error(path, &cause, expected))?, path, expected, limit)
}

/// The bytes of a file, or of standard input.
fn open_source(path: &Path, expected: &str) -> Result<ByteSource> {
    let error = |message: String| ErrorKind::File.error(message).in_file(path);
    let disk = disk::current_disk();
    let opened = if is_standard_input(path) {
        disk.standard_input()
    } else if disk.follow(path).is_ok_and(|found| found.kind == ObjectKind::Folder) {
        return Err(error(format!("found a directory, expected {expected}")));
    } else {
        disk.open(path)
    };
    opened.map_err(|cause| {
        if cause.kind() == io::ErrorKind::NotFound {
            error(format!("found no such file, expected {expected}: check the path"))
        } else {
            unreadable_error(path, &cause, expected)
        }
    })
}

/// An input, with its first bytes.
fn open_with_head(mut rest: ByteSource, path: &Path, expected: &str, limit: ResourceLimit) -> Result<(Input, Vec<u8>)> {
    let mut head = Vec::new();
    rest.by_ref().take(HEAD).read_to_end(&mut head).map_err(|cause| unreadable_error(path, &cause, expected))?;
    // One byte beyond the limit shows that the file is too large.
    let rest = rest.take((limit.value() + 1).saturating_sub(head.len() as u64));
    let input = Input { bytes: Cursor::new(head.clone()).chain(rest), limit };
    Ok((input, head))
}

impl Input {
    /// Reads from `source`, up to the size of the largest table.
    #[must_use]
    pub fn from_reader(source: Box<dyn Read + Send>) -> Self {
        let limit = ResourceLimit::Table;
        Input { bytes: Cursor::default().chain(source.take(limit.value() + 1)), limit }
    }
}

/// Message on an input beyond its limit.
fn too_large(limit: ResourceLimit) -> String {
    let (row, most) = (limit.row(), limit.value());
    format!("it is larger than {}: {}, or allow more by --limit {}=N", amount(most, row.unit), row.advice, row.name)
}

/// True if a path means standard input.
pub fn is_standard_input(path: &Path) -> bool {
    path == Path::new(STANDARD_INPUT)
}

/// The error of a file that cannot be read; `expected` describes the kind of file.
pub fn unreadable_error(path: &Path, error: &io::Error, expected: &str) -> Error {
    ErrorKind::File.error(format!("the file cannot be read ({error}), expected {expected}")).in_file(path)
}

impl Read for Input {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.bytes.read(into)?;
        if self.bytes.get_ref().1.limit() == 0 {
            return Err(io::Error::other(too_large(self.limit)));
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits;

    #[test]
    fn an_input_larger_than_it_may_be_is_an_error_and_no_shorter_input() {
        let path = std::env::temp_dir().join(format!("poecal_source_{}", std::process::id()));
        let text = vec![b'a'; 1 << 10];
        std::fs::write(&path, &text).unwrap();
        let read = |largest| {
            limits::run_with_limits(limits::current_limits().with_limit(ResourceLimit::Text, largest), || {
                let mut bytes = Vec::new();
                open(&path, "a text", ResourceLimit::Text).unwrap().read_to_end(&mut bytes).map(|_| bytes)
            })
        };
        assert_eq!(read(1 << 10).unwrap(), text);
        for largest in [(1 << 10) - 1, 17, 16, 3] {
            let error = read(largest).unwrap_err().to_string();
            assert!(error.starts_with("it is larger than ") && error.ends_with("--limit text=N"), "{error}");
        }
        for BinaryForm { starts, ends, words } in FORMS {
            let expected = format!("found {words}, expected a text");
            for start in starts {
                std::fs::write(&path, [start, &b"rest of it"[..]].concat()).unwrap();
                let Err(error) = open(&path, "a text", ResourceLimit::Text) else { panic!("{start:?}") };
                assert!(error.to_string().ends_with(&expected), "{error}");
            }
            for end in ends {
                let named = path.with_extension(end.to_uppercase());
                std::fs::write(&named, "a text\n").unwrap();
                let refused = open(&named, "a text", ResourceLimit::Text).map(|_| ());
                std::fs::remove_file(&named).unwrap();
                let error = refused.unwrap_err();
                assert!(error.to_string().ends_with(&expected), "{error}");
            }
        }
        std::fs::write(&path, "ab").unwrap();
        assert_eq!(read(1 << 10).unwrap(), b"ab");
        std::fs::remove_file(&path).unwrap();
    }
}
