//! Tables of cameras (CSV).

use std::collections::BTreeMap;
use std::path::Path;

use crate::pictures::lens_checks::{EXPECTED, size_of_pictures};
use crate::table::cells::Cell;
use crate::table::header::Header;
use crate::table::mapping::ColumnMap;
use crate::table::number::Numbers;
use crate::table::text::Blocks;
use crate::table::{Row, Table};
use poecal_model::camera::{Camera, Distortion, LENS_NAMES, Lens};
use poecal_numerics::error::{Error, ErrorKind, Result, first_few};
use poecal_storage::other_keys::{KeysOf, other_keys};
use poecal_storage::yaml::Leaf;

/// The columns of a table of cameras.
struct CameraColumns {
    name: Option<usize>,
    /// Of the numbers of a lens.
    numbers: Vec<Option<usize>>,
    /// Width and height of its pictures.
    size: [Option<usize>; 2],
    model: Option<usize>,
    version: Option<usize>,
    /// Names of all columns.
    names: Vec<String>,
}

/// A camera of a table with its version and its line.
type CameraRow = (Camera, String, usize);

/// The cameras of a table, of the version that is named, and a sentence on columns that were not read.
pub(crate) fn read_table(path: &Path, version: Option<&str>) -> Result<(Vec<Camera>, Vec<String>)> {
    let map = ColumnMap::default();
    let mut table = Table::open(path, Blocks::open(path, "a camera (CSV)")?, &map)?;
    let columns = CameraColumns::find(&table.header)?;
    let mut cameras: Vec<CameraRow> = Vec::new();
    let mut reader = Numbers::new(None);
    let mut others: Vec<Leaf> = Vec::new();
    while let Some(mut rows) = table.next_block()? {
        while let Some(row) = rows.next()? {
            others.extend(columns.others(&row));
            cameras.push(columns.read(&mut reader, &row)?);
        }
    }
    if let Some(version) = version {
        let known: Vec<String> = cameras.iter().map(|it| it.1.clone()).collect();
        cameras.retain(|(_, own, _)| own == version);
        if cameras.is_empty() {
            let message = format!("found the version `{version}`, expected one of {}", first_few(&known));
            return Err(Error::new(ErrorKind::Option, message).in_file(path));
        }
    }
    refuse_twice(&table, columns.name.is_some(), &cameras)?;
    if cameras.is_empty() {
        let message = format!("found a header and no rows, expected {EXPECTED}");
        return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
    }
    let said = other_keys(&others, 0, |_| false, (KeysOf::Pictures, path))?
        .map(|it| format!("{}: {it}", path.display()));
    Ok((cameras.into_iter().map(|(camera, ..)| camera).collect(), said.into_iter().collect()))
}

impl CameraColumns {
    /// The cells of a row that are not read.
    fn others(&self, row: &Row<'_>) -> Vec<Leaf> {
        let CameraColumns { name, numbers, size, model, version, .. } = self;
        let read = numbers.iter().chain(size).chain([name, model, version]).flatten().copied();
        let read: Vec<usize> = read.collect();
        let cells = row.cells.iter().enumerate().filter(|(at, _)| !read.contains(at));
        let leaf = |(at, cell): (usize, &Cell<'_>)| {
            let name = self.names.get(at).filter(|it| !it.is_empty())?;
            Some(Leaf { path: vec![name.clone()], text: cell.text().trim().to_owned(), line: row.line })
        };
        cells.filter_map(leaf).collect()
    }

    /// Finds the columns in a header.
    fn find(header: &Header<'_>) -> Result<Self> {
        let place = |name: &str| header.require(name, "for the camera", |_| false, "");
        let name = match header.find("name")? {
            Some(at) => Some(at),
            None => header.find("camera")?,
        };
        let first = [place("fx")?, place("fy")?, place("cx")?, place("cy")?];
        let mut numbers: Vec<Option<usize>> = first.map(Some).to_vec();
        for own in &LENS_NAMES[4..] {
            numbers.push(header.find(own)?);
        }
        let size = [header.find("width")?, header.find("height")?];
        let (model, version) = (header.find("model")?, header.find("version")?);
        let names = header.cells.iter().map(|cell| cell.name.clone()).collect();
        Ok(CameraColumns { name, numbers, size, model, version, names })
    }

    /// The camera of a row, with its version and its line.
    fn read(&self, reader: &mut Numbers, row: &Row<'_>) -> Result<CameraRow> {
        let mut lens = [0.0; LENS_NAMES.len()];
        for ((number, column), own) in lens.iter_mut().zip(&self.numbers).zip(LENS_NAMES) {
            if let Some(value) = column.map(|at| cell(reader, row, at, own)).transpose()?.flatten() {
                *number = value;
            }
        }
        let size = self.size.map(|column| column.map(|at| cell(reader, row, at, "size")).transpose());
        let [width, height] = size;
        let size_px = match (width?.flatten(), height?.flatten()) {
            (Some(width), Some(height)) => {
                let found = size_of_pictures([width, height]);
                Some(found.map_err(|error| row.error(self.size[0].unwrap_or(0), error.message()))?)
            }
            _ => None,
        };
        let word = |column: Option<usize>| {
            column.and_then(|at| row.cells.get(at)).map(|it| it.text().trim().to_owned())
        };
        let is_fisheye = ["fisheye", "equidistant"]
            .contains(&word(self.model).unwrap_or_default().to_lowercase().as_str());
        let lens = lens_of(&lens, is_fisheye, size_px);
        let own = word(self.version).unwrap_or_default();
        // The only one needs no name.
        let name = self.name.map_or_else(|| "camera".to_owned(), |at| word(Some(at)).unwrap_or_default());
        Ok((Camera::new(name, lens), own, row.line))
    }
}

/// Refuses two cameras of one name.
fn refuse_twice(table: &Table<'_>, is_named: bool, cameras: &[CameraRow]) -> Result<()> {
    let path = table.header.path;
    let mut firsts: BTreeMap<&str, &CameraRow> = BTreeMap::new();
    for row in cameras {
        let (camera, own, line) = row;
        let first = *firsts.entry(&camera.name).or_insert(row);
        if !std::ptr::eq(first, row) {
            let (_, other, first) = first;
            if !is_named && own == other {
                return Err(header_without_names(table));
            }
            let file = path.display();
            let advice = if own == other {
                String::new()
            } else {
                format!(": choose one with --camera {file}#{other} or --camera {file}#{own}")
            };
            let message = format!(
                "found the camera `{}` a second time (line {first} is the first), expected it once{advice}",
                camera.name
            );
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, *line));
        }
    }
    Ok(())
}

/// The error of several cameras without names.
fn header_without_names(table: &Table<'_>) -> Error {
    let missing = table.header.require("name", "for the name of each camera", |_| false, "");
    missing.err().unwrap_or_else(|| Error::new(ErrorKind::Measurement, "found cameras without names"))
}

/// The number of a cell; `None` of an empty one.
fn cell(numbers: &mut Numbers, row: &Row<'_>, at: usize, name: &str) -> Result<Option<f64>> {
    let raw = row.cells.get(at).map_or("", |cell| cell.raw);
    if raw.is_empty() {
        return Ok(None);
    }
    let found = numbers.parse(raw, row.line);
    let found = found
        .map_err(|expected| row.error(at, format!("found `{raw}` for `{name}`, expected {expected}")))?;
    Ok(Some(found))
}

fn lens_of(numbers: &[f64; LENS_NAMES.len()], is_fisheye: bool, size_px: Option<[u32; 2]>) -> Lens {
    let [fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6] = *numbers;
    let distortion = if is_fisheye {
        // A table names them k1 to k4, a list has them in this order.
        Distortion::Fisheye(if p1 == 0.0 && p2 == 0.0 { [k1, k2, k3, k4] } else { [k1, k2, p1, p2] })
    } else {
        Distortion::Brown([k1, k2, p1, p2, k3, k4, k5, k6])
    };
    Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px }
}
