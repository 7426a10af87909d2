//! `poecal detect`: the corners of a board in pictures, as a table for `poecal calibrate`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use poecal_detect::{
    BoardSpec, DetectedBoard, Detector, Gray, GrayPicture, PictureError, PictureOrientation, RejectionReason, preview,
};
use poecal_import::board_of_file;
use poecal_numerics::error::{Error, ErrorKind, Result};
use poecal_results::output::{ExistingFiles, ReservedFile};
use poecal_storage::csv_text::cell;
use poecal_storage::disk::{self, ObjectKind};
use poecal_storage::folder;
use poecal_storage::limits::{self, ResourceLimit};
use rayon::prelude::*;

use super::board::board;
use crate::DONE;
use crate::args::Detect;
use crate::console::Console;

/// Endings of the names of pictures in folders.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];
/// Pictures in which another board is searched.
const TRIED: usize = 3;
/// Pictures that a sentence names at most.
const NAMED: usize = 6;

/// A picture with its detected corners.
struct DetectedPicture {
    /// Its name in the table: that of its file.
    name: String,
    path: PathBuf,
    size_px: [usize; 2],
    turned: PictureOrientation,
    found: std::result::Result<DetectedBoard, RejectionReason>,
    /// Its levels if they are needed again.
    gray: Option<Gray>,
}

pub(crate) fn detect(arguments: &Detect, console: &Console) -> Result<u8> {
    if let Some(spec) = &arguments.print {
        return board(arguments, spec, console);
    }
    let stated = arguments.board.as_deref().unwrap_or_default();
    let of_file = board_of_file(stated)?;
    let words = of_file.as_ref().map_or(stated, |board| &board.words);
    let spec: BoardSpec = words.parse().map_err(|error| option_error(&error))?;
    if let Some(board) = &of_file {
        console.remark(&board.said);
    }
    let paths = pictures(&arguments.pictures, console)?;
    let board = of_file.as_ref().map(|_| Path::new(stated));
    let inputs: Vec<&Path> = paths.iter().map(PathBuf::as_path).chain(board).collect();
    let place = arguments.place.reserve(&inputs, console)?;
    let names = names(&paths)?;
    let previews = previews(arguments, &names, (&inputs, console))?;
    let detector = Detector::new(&spec).with_most_dots(ResourceLimit::Dots.most_held());
    // Pictures are read by other threads.
    let limits = limits::current_limits();
    let keeps = !previews.is_empty();
    let all: Vec<DetectedPicture> = paths
        .par_iter()
        .zip(&names)
        .map(|(path, name)| limits::run_with_limits(limits, || detect_in_file(&detector, path, name, keeps)))
        .collect::<Result<_>>()?;
    refuse_sizes(&all)?;
    warn(&all, console);
    let corners: usize = all.iter().filter_map(|it| it.found.as_ref().ok()).map(|it| it.corners.len()).sum();
    if corners == 0 {
        return Err(no_board_error(&detector, &all));
    }
    for (place, one) in previews.into_iter().zip(&all) {
        let Some(gray) = &one.gray else { continue };
        let found = one.found.as_ref().map_or(&[][..], |found| &found.corners);
        place.write_bytes(&preview(gray, found).map_err(|error| option_error(&error))?)?;
    }
    console.deliver(table(&spec, &all), place)?;
    conclude(&spec, &all, corners, (arguments, console));
    Ok(DONE)
}

fn option_error(error: &impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Option, error.to_string())
}

/// The files that were named, and the pictures of folders in the order of their names.
fn pictures(named: &[PathBuf], console: &Console) -> Result<Vec<PathBuf>> {
    let disk = disk::current_disk();
    let mut found = Vec::new();
    for path in named {
        let is_folder = disk.follow(path).is_ok_and(|object| object.kind == ObjectKind::Folder);
        if !is_folder {
            found.push(path.clone());
            continue;
        }
        let unread = |error: std::io::Error| {
            Error::new(ErrorKind::File, format!("cannot be read ({error}), expected a folder of pictures"))
                .in_file(path)
        };
        let (names, left) = folder::files(path, is_picture).map_err(unread)?;
        left.iter().for_each(|other| console.warning(other));
        let mut own: Vec<PathBuf> = names.into_iter().map(|name| path.join(name)).collect();
        if own.is_empty() {
            let message = "found no picture in this folder, expected files that end in .png, .jpg or .jpeg";
            return Err(Error::new(ErrorKind::File, message).in_file(path));
        }
        own.sort_by_cached_key(|path| natural_sort_key(&name_of(path)));
        found.extend(own);
    }
    Ok(found)
}

fn is_picture(name: &str) -> bool {
    let ending = Path::new(name).extension().and_then(|it| it.to_str()).map(str::to_ascii_lowercase);
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|it| it.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A name by which 10 comes after 9: its digits with zeros before them.
fn natural_sort_key(name: &str) -> String {
    let mut found = String::new();
    let mut digits = String::new();
    for letter in name.chars() {
        if letter.is_ascii_digit() {
            digits.push(letter);
            continue;
        }
        let _ = write!(found, "{digits:0>20}");
        digits.clear();
        found.push(letter);
    }
    let _ = write!(found, "{digits:0>20}");
    found
}

/// The names of pictures, by which they are joined with the readings of the joints: each once.
fn names(paths: &[PathBuf]) -> Result<Vec<String>> {
    let mut known: BTreeMap<String, &PathBuf> = BTreeMap::new();
    for path in paths {
        let name = name_of(path);
        if let Some(other) = known.insert(name.clone(), path) {
            let message = format!(
                "found two pictures with the name `{name}`, the other is {}, expected each name once: pictures are joined with the joints by it",
                other.display()
            );
            return Err(Error::new(ErrorKind::Option, message).in_file(path));
        }
    }
    Ok(paths.iter().map(|path| name_of(path)).collect())
}

/// Places of the previews, empty without previews.
fn previews(
    arguments: &Detect,
    names: &[String],
    (inputs, console): (&[&Path], &Console),
) -> Result<Vec<ReservedFile>> {
    let Some(folder) = &arguments.preview else { return Ok(Vec::new()) };
    let disk = disk::current_disk();
    if disk.follow(folder).is_err() {
        let unmade = |error| Error::new(ErrorKind::File, format!("cannot be made: {error}")).in_file(folder);
        disk.create_folder(folder).map_err(unmade)?;
    }
    let existing = ExistingFiles::from_switch(arguments.place.force);
    let place = |name: &String| {
        let path = folder.join(name).with_extension("png");
        ReservedFile::reserve(&path, existing, inputs, &mut console.warner())
    };
    names.iter().map(place).collect()
}

fn detect_in_file(detector: &Detector, path: &Path, name: &str, keeps: bool) -> Result<DetectedPicture> {
    let unread = |message: String| Error::new(ErrorKind::File, message).in_file(path);
    let mut bytes = Vec::new();
    let file = disk::current_disk().open(path).map_err(|error| unread(format!("cannot be read: {error}")))?;
    let read = file.take(ResourceLimit::Picture.value() + 1).read_to_end(&mut bytes);
    read.map_err(|error| unread(format!("cannot be read: {error}")))?;
    if bytes.len() as u64 > ResourceLimit::Picture.value() {
        return Err(unread(ResourceLimit::Picture.exceeded_error("one picture")));
    }
    let decoded = GrayPicture::decode_up_to(&bytes, path, ResourceLimit::Pixels.value());
    let GrayPicture { gray, turned } = decoded.map_err(|PictureError { error, too_large }| match too_large {
        Some([width, height]) => {
            unread(ResourceLimit::Pixels.sentence(&format!("a picture of {width} x {height} pixels")))
        }
        None => option_error(&error),
    })?;
    drop(bytes);
    let found = detector.detect(&gray);
    let size_px = [gray.width(), gray.height()];
    let gray = (keeps || found.is_err()).then_some(gray);
    Ok(DetectedPicture { name: name.to_owned(), path: path.to_owned(), size_px, turned, found, gray })
}

/// Pictures of one camera have one size.
fn refuse_sizes(all: &[DetectedPicture]) -> Result<()> {
    let Some(first) = all.first() else { return Ok(()) };
    let Some(other) = all.iter().find(|it| it.size_px != first.size_px) else { return Ok(()) };
    let ([a, b], [c, d]) = (first.size_px, other.size_px);
    let message = format!(
        "found a picture of {c} x {d} pixels beside {} of {a} x {b}, expected one size of all pictures of a camera: detect those of each camera alone",
        first.path.display()
    );
    Err(Error::new(ErrorKind::Option, message).in_file(&other.path))
}

fn first_few(names: &[String]) -> String {
    let more = names.len().saturating_sub(NAMED);
    let mut text = names.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    if more > 0 {
        let _ = write!(text, " and {more} more");
    }
    text
}

/// Reports the pictures that were turned, and those that are left out with the reason.
fn warn(all: &[DetectedPicture], console: &Console) {
    let turned: Vec<String> =
        all.iter().filter(|it| it.turned.is_turned()).map(|it| format!("{} ({})", it.name, it.turned)).collect();
    if !turned.is_empty() {
        console.warning(format!(
            "turned {} as their files state (EXIF): {}; the lens must be that of pictures which are turned so",
            pluralize(turned.len(), "picture"),
            first_few(&turned)
        ));
    }
    let without: Vec<String> =
        all.iter().filter_map(|it| Some(format!("{} ({})", it.name, it.found.as_ref().err()?))).collect();
    if !without.is_empty() && without.len() < all.len() {
        console.warning(format!("left out {} of {} pictures: {}", without.len(), all.len(), first_few(&without)));
    }
}

fn pluralize(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}

/// Error for a board in no picture: the reason, and another board that was found.
fn no_board_error(detector: &Detector, all: &[DetectedPicture]) -> Error {
    let tried: Vec<&Gray> = all.iter().filter_map(|it| it.gray.as_ref()).take(TRIED).collect();
    let why: Vec<String> =
        all.iter().filter_map(|it| Some(format!("{}: {}", it.name, it.found.as_ref().err()?))).collect();
    let help = match detector.suggest(&tried) {
        Some(other) => {
            format!("but {} shows in {}: take --board {}", other.spec, pluralize(other.pictures, "picture"), other.spec)
        }
        None => format!("nor {}: check the board, and look at the pictures", tried_too(detector.spec())),
    };
    let message = format!(
        "found the board {} in none of {} ({}), {help}",
        detector.spec(),
        pluralize(all.len(), "picture"),
        first_few(&why)
    );
    Error::new(ErrorKind::Option, message)
}

/// Alternatives that are tried in place of a board.
fn tried_too(spec: &BoardSpec) -> &'static str {
    if matches!(spec, BoardSpec::Circles(_)) {
        "one with columns and rows exchanged, of the other kind, or with one dot more or fewer each way"
    } else if matches!(spec, BoardSpec::Tags(_)) {
        "tags of other families"
    } else if matches!(spec, BoardSpec::AprilGrid(_)) {
        "one with columns and rows exchanged, or with tags of other families"
    } else {
        "one with columns and rows exchanged, of the other pattern or with other markers"
    }
}

/// Name of the points of a board.
fn points(spec: &BoardSpec) -> &'static str {
    if matches!(spec, BoardSpec::Circles(_)) { "dots" } else { "corners" }
}

/// The corners as `poecal calibrate` reads them.
fn table(spec: &BoardSpec, all: &[DetectedPicture]) -> String {
    let size = all.first().map_or([0, 0], |it| it.size_px);
    let mut text = format!(
        "# {} of {spec} in pictures of {} x {} pixels\nimage,target,u[px],v[px],sigma[px]\n",
        points(spec),
        size[0],
        size[1]
    );
    for one in all {
        let Ok(found) = &one.found else { continue };
        let image = cell(&one.name);
        for corner in &found.corners {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{image},{},{:.4},{:.4},{:.4}",
                corner.name(),
                corner.u_px,
                corner.v_px,
                corner.sigma_px
            );
        }
    }
    text
}

/// Prints a summary and the next step.
fn conclude(spec: &BoardSpec, all: &[DetectedPicture], corners: usize, (arguments, console): (&Detect, &Console)) {
    let found: Vec<&DetectedBoard> = all.iter().filter_map(|it| it.found.as_ref().ok()).collect();
    let mut sigmas: Vec<f64> = found.iter().flat_map(|it| &it.corners).map(|it| it.sigma_px).collect();
    sigmas.sort_by(f64::total_cmp);
    let sigma = sigmas.get(sigmas.len() / 2).copied().unwrap_or(0.0);
    console.remark(format!(
        "found {corners} {} in {} of {}, to {sigma:.2} px in the median",
        points(spec),
        found.len(),
        pluralize(all.len(), "picture")
    ));
    if found.iter().any(|it| it.turnable) {
        console.remark(if matches!(spec, BoardSpec::Circles(_)) {
            "this board looks the same turned: its first dot is the one nearest to the upper left of each picture; an asymmetric grid with an odd \
             number of rows has no such ambiguity"
        } else {
            "this board looks the same turned by half a turn: its first corner is the one nearest to the upper left of each picture; a board of \
             which one side counts an even and the other an odd number of squares has no such ambiguity"
        });
    }
    if let Some(out) = &arguments.place.out {
        let [width, height] = all.first().map_or([0, 0], |it| it.size_px);
        console.remark(format!(
            "next: poecal calibrate MODEL JOINTS.csv {} --markers {spec} --camera CAMERA.yaml (or --camera unknown:{width}x{height})",
            out.display()
        ));
    }
}
