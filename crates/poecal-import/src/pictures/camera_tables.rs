//! Tables of cameras (CSV).

use std::collections::BTreeMap;
use std::path::Path;

use crate::pictures::lens_checks::EXPECTED;
use crate::table::header::Header;
use crate::table::mapping::ColumnMap;
use crate::table::number::NumberReader;
use crate::table::text::LineBlocks;
use crate::table::{FileRow, FileTable};
use poecal_model::camera::{Camera, Distortion, LENS_NAMES, Lens, size_of_pictures};
use poecal_numerics::error::{ErrorKind, Result, first_few};
use poecal_storage::other_keys::{KeyOwner, other_keys};
use poecal_storage::yaml::YamlLeaf;

/// The columns of a table of cameras.
struct CameraColumns {
    name: Option<usize>,
    /// Columns of the numbers of a lens.
    numbers: [Option<usize>; LENS_NAMES.len()],
    /// Columns of width and height of its pictures.
    size: [Option<usize>; 2],
    model: Option<usize>,
    version: Option<usize>,
    /// Columns that are not read, with their names.
    others: Vec<(usize, String)>,
}

/// A camera of a table with its version and its line.
type CameraRow = (Camera, String, usize);

/// The cameras of a table, of the named version, and a sentence on columns that were not read.
pub(crate) fn read_table(path: &Path, version: Option<&str>) -> Result<(Vec<Camera>, Vec<String>)> {
    let map = ColumnMap::default();
    let mut table = FileTable::open(path, LineBlocks::open(path, "a camera (CSV)")?, &map)?;
    let columns = CameraColumns::find(&table.header)?;
    let (mut cameras, mut others) = (Vec::new(), Vec::new());
    let mut numbers = NumberReader::new(None);
    table.some_rows(EXPECTED, |row| {
        others.extend(columns.others.iter().map(|(at, name)| YamlLeaf {
            path: vec![name.clone()],
            text: row.word(Some(*at)),
            line: row.line,
        }));
        cameras.push(columns.read(&mut numbers, row)?);
        Ok(())
    })?;
    if let Some(version) = version {
        let known: Vec<String> = cameras.iter().map(|it: &CameraRow| it.1.clone()).collect();
        cameras.retain(|(_, own, _)| own == version);
        if cameras.is_empty() {
            let message = format!("found the version `{version}`, expected one of {}", first_few(&known));
            return Err(ErrorKind::Option.error(message).in_file(path));
        }
    }
    refuse_twice(&table.header, columns.name.is_some(), &cameras)?;
    let said = other_keys(&others, 0, |_| false, (KeyOwner::Pictures, path))?;
    Ok((cameras.into_iter().map(|(camera, ..)| camera).collect(), said.into_iter().collect()))
}

impl CameraColumns {
    /// Finds the columns in a header.
    fn find(header: &Header<'_>) -> Result<Self> {
        let name = header.find("name")?.map_or_else(|| header.find("camera"), |at| Ok(Some(at)))?;
        let mut numbers = [None; LENS_NAMES.len()];
        for (at, (column, own)) in numbers.iter_mut().zip(LENS_NAMES).enumerate() {
            let is_required = at < 4;
            *column = if is_required {
                Some(header.require(own, "for the camera", |_| false, "")?)
            } else {
                header.find(own)?
            };
        }
        let size = [header.find("width")?, header.find("height")?];
        let (model, version) = (header.find("model")?, header.find("version")?);
        let read: Vec<usize> =
            numbers.iter().chain(&size).chain([&name, &model, &version]).copied().flatten().collect();
        let others = header.cells.iter().map(|cell| cell.name.clone()).enumerate();
        let others = others.filter(|(at, name)| !read.contains(at) && !name.is_empty()).collect();
        Ok(CameraColumns { name, numbers, size, model, version, others })
    }

    /// The camera of a row, with its version and its line.
    fn read(&self, reader: &mut NumberReader, row: &FileRow<'_>) -> Result<CameraRow> {
        let mut number = |column: &Option<usize>, name: &str| {
            let Some(at) = column.filter(|at| !row.raw_text(*at).is_empty()) else { return Ok(None) };
            row.number(at, reader, format_args!(" for `{name}`")).map(Some)
        };
        let mut numbers = [0.0; LENS_NAMES.len()];
        for ((value, column), own) in numbers.iter_mut().zip(&self.numbers).zip(LENS_NAMES) {
            *value = number(column, own)?.unwrap_or(0.0);
        }
        let size = [number(&self.size[0], "size")?, number(&self.size[1], "size")?];
        let size_px = size_of_pictures(size).map_err(|error| row.error(self.size[0].unwrap_or(0), error.message()))?;
        let is_fisheye = ["fisheye", "equidistant"].contains(&row.word(self.model).to_lowercase().as_str());
        // A single camera needs no name.
        let name = self.name.map_or_else(|| "camera".to_owned(), |at| row.word(Some(at)));
        Ok((Camera::new(name, lens_of(numbers, is_fisheye, size_px)), row.word(self.version), row.line))
    }
}

/// Refuses two cameras of one name.
fn refuse_twice(header: &Header<'_>, is_named: bool, cameras: &[CameraRow]) -> Result<()> {
    let mut firsts: BTreeMap<&str, &CameraRow> = BTreeMap::new();
    for row in cameras {
        let Some((_, other, first)) = firsts.insert(&row.0.name, row) else { continue };
        let (camera, own, line) = row;
        if !is_named && own == other {
            header.require("name", "for the name of each camera", |_| false, "")?;
        }
        let file = header.path.display();
        let advice = if own == other {
            String::new()
        } else {
            format!(": choose one with --camera {file}#{other} or --camera {file}#{own}")
        };
        let message = format!(
            "found the camera `{}` a second time (line {first} is the first), expected it once{advice}",
            camera.name
        );
        return Err(ErrorKind::Measurement.error(message).at_line(header.path, *line));
    }
    Ok(())
}

fn lens_of(numbers: [f64; LENS_NAMES.len()], is_fisheye: bool, size_px: Option<[u32; 2]>) -> Lens {
    let [fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6] = numbers;
    let distortion = if is_fisheye {
        // A table names them k1 to k4; a list has them in this order.
        Distortion::Fisheye(if p1 == 0.0 && p2 == 0.0 { [k1, k2, k3, k4] } else { [k1, k2, p1, p2] })
    } else {
        Distortion::Brown([k1, k2, p1, p2, k3, k4, k5, k6])
    };
    Lens { focal_px: [fx, fy], centre_px: [cx, cy], distortion, size_px }
}
