//! Files of corners as cameras saw them: a row a corner, `u` and `v` in pixels, with the readings of the joints in each row, or in another file
//! that has them by picture (docs/file-formats.md, "Pixels").

use std::collections::BTreeMap;
use std::path::Path;

use super::header::Header;
use super::inputs::InputReader;
use super::layout::ColumnLayout;
use super::number::Numbers;
use super::picture_files::{NO_CAMERA, Taken};
use super::read::Reader;
use super::scale::JointWatch;
use super::table::{Row, Table, refuse_more_rows};
use crate::camera::Corner;
use crate::error::{Error, ErrorKind, Result, first_few};
use nalgebra::Vector2;

/// Largest pixel coordinate.
const LARGEST_PX: f64 = 1e6;

/// Columns of a file of corners.
struct CornerColumns {
    u: usize,
    v: usize,
    sigma: Option<usize>,
    target: usize,
    camera: Option<usize>,
    board: Option<usize>,
    image: Option<usize>,
}

impl CornerColumns {
    fn new(header: &Header<'_>, pixels_px: [&str; 2]) -> Result<Self> {
        let [u, v] = pixels_px.map(|name| header.require(name, "for the pixel", |_| false, ""));
        let found = CornerColumns {
            u: u?,
            v: v?,
            sigma: header.find("sigma")?,
            target: header.require("target", "for the name of the corner", |_| false, "")?,
            camera: header.find("camera")?,
            board: header.find("board")?,
            image: header.find("image")?,
        };
        for column in [Some(found.u), Some(found.v), found.sigma].into_iter().flatten() {
            header.only_unit(column, "px")?;
        }
        Ok(found)
    }

    fn all(&self) -> impl Iterator<Item = usize> {
        let more = [self.sigma, self.camera, self.board, self.image];
        [self.u, self.v, self.target].into_iter().chain(more.into_iter().flatten())
    }
}

/// A board in a picture, as its corners were read.
pub(super) struct Gathered {
    pub(super) taken: Taken,
    pub(super) image: Option<String>,
    pub(super) camera: usize,
    pub(super) board: usize,
    pub(super) corners: Vec<Corner>,
}

/// Pictures of a file, in the order in which they begin.
#[derive(Default)]
struct Gathering {
    pictures: Vec<Gathered>,
    known: BTreeMap<(String, usize, usize), usize>,
}

impl Reader<'_> {
    /// Reads a file of readings by picture, whose corners are in another one.
    pub(super) fn readings_of_pictures(&mut self, path: &Path, mut table: Table<'_>) -> Result<()> {
        let layout = ColumnLayout::pictures(&table.header, self.robot, self.options, self.map)?;
        let image = table.header.require("image", "for the name of the picture", |_| false, "")?;
        let numbers = Numbers::new(self.map.decimal);
        let mut inputs = InputReader::new(&layout.inputs, layout.inputs.len(), numbers);
        let mut watch = JointWatch::new(self.robot);
        while let Some(mut rows) = table.next_block()? {
            while let Some(row) = rows.next()? {
                let taken = self.taken(&row, &layout, &mut inputs, &mut watch)?;
                let name = text(&row, Some(image)).unwrap_or_default();
                if name.is_empty() {
                    return Err(row.error(
                        image,
                        "found an empty cell in column `image`, expected the name of a picture",
                    ));
                }
                if let Some(first) = self.taken.get(&name) {
                    let message = format!(
                        "found the picture `{name}` a second time ({}:{} is the first), expected it once",
                        first.place.0.display(),
                        first.place.1
                    );
                    return Err(row.error(image, message));
                }
                self.taken.insert(name, taken);
            }
        }
        self.found.warnings.extend(watch.finish(path, &layout, &inputs.ranges)?);
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        Ok(())
    }

    /// Reads a file of corners.
    pub(super) fn corners(&mut self, path: &Path, mut table: Table<'_>) -> Result<()> {
        self.refuse_without_cameras(&table.header)?;
        let columns = CornerColumns::new(&table.header, ["u", "v"])?;
        let has_joints = {
            let names = self.found.data.reading_names();
            self.taken.is_empty() || names.iter().all(|name| table.header.count(name) > 0)
        };
        let mut layout = match has_joints {
            true => ColumnLayout::pictures(&table.header, self.robot, self.options, self.map)?,
            false => ColumnLayout::default(),
        };
        if !has_joints && columns.image.is_none() {
            table.header.require("image", "for the name of the picture", |_| false, "")?;
        }
        let own: Vec<String> =
            columns.all().filter_map(|at| table.header.cells.get(at)).map(|cell| cell.text.clone()).collect();
        layout.ignored.retain(|(name, _)| !own.contains(name));
        let mut numbers = Numbers::new(self.map.decimal);
        let mut inputs =
            InputReader::new(&layout.inputs, layout.inputs.len(), Numbers::new(self.map.decimal));
        let mut watch = JointWatch::new(self.robot);
        let (mut gathering, mut rows, mut unknown) = (Gathering::default(), 0, BTreeMap::new());
        while let Some(mut some) = table.next_block()? {
            while let Some(row) = some.next()? {
                rows += 1;
                refuse_more_rows(rows, &row)?;
                let image = text(&row, columns.image).filter(|name| !name.is_empty());
                let taken = match (&image, has_joints) {
                    (_, true) => self.taken(&row, &layout, &mut inputs, &mut watch)?,
                    (Some(name), false) => match self.taken.get(name) {
                        Some(taken) => taken.clone(),
                        None => {
                            unknown.entry(name.clone()).or_insert(row.line);
                            continue;
                        }
                    },
                    (None, false) => {
                        let at = columns.image.unwrap_or(0);
                        return Err(row.error(
                            at,
                            "found an empty cell in column `image`, expected the name of a picture",
                        ));
                    }
                };
                if let Some(corner) = self.corner(&row, &columns, &mut numbers)? {
                    self.gather(&row, &columns, &mut gathering, (image, taken), corner)?;
                }
            }
        }
        if rows == 0 {
            let message = "found a header and no rows, expected at least one corner";
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
        }
        self.warn_of_unpaired(path, has_joints, &gathering, &unknown);
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        self.found.warnings.extend(watch.finish(path, &layout, &inputs.ranges)?);
        self.found.data.files.push(path.to_path_buf());
        let first = self.found.data.len();
        self.take_pictures(path, gathering.pictures)?;
        self.understand_pictures(&table, &layout, &inputs, (first, rows))
    }

    /// Names the pictures of which one file has the joints and the other has the corners, but not both.
    fn warn_of_unpaired(
        &mut self,
        path: &Path,
        has_joints: bool,
        gathering: &Gathering,
        unknown: &BTreeMap<String, usize>,
    ) {
        if has_joints {
            return;
        }
        let named = |names: Vec<&String>| format!("{} ({})", names.len(), first_few(&names));
        if !unknown.is_empty() {
            let names = named(unknown.keys().collect());
            self.found.warnings.push(format!(
                "{}: left out the pictures that have corners and no joint readings: {names}",
                path.display()
            ));
        }
        let has_corners = |name: &String| gathering.pictures.iter().any(|it| it.image.as_ref() == Some(name));
        let without: Vec<&String> = self.taken.keys().filter(|name| !has_corners(name)).collect();
        if !without.is_empty() {
            let names = named(without);
            self.found.warnings.push(format!(
                "{}: left out the pictures that have joint readings and no corners: {names}",
                path.display()
            ));
        }
    }

    fn refuse_without_cameras(&self, header: &Header<'_>) -> Result<()> {
        let at = header.find("u")?.unwrap_or(0);
        let missing = if self.options.cameras.is_empty() {
            NO_CAMERA
        } else if self.options.boards.is_empty() {
            "found corners in pixels and no board, expected --markers with its points: a CSV file, or chessboard:10x7:27mm"
        } else {
            return Ok(());
        };
        Err(header.error(ErrorKind::Measurement, at, missing))
    }

    /// The configuration of a row.
    fn taken(
        &mut self,
        row: &Row<'_>,
        layout: &ColumnLayout,
        inputs: &mut InputReader<'_>,
        watch: &mut JointWatch<'_>,
    ) -> Result<Taken> {
        inputs.read(row)?;
        watch.unwind(row, inputs);
        inputs.take_readings(row)?;
        inputs.include_in_ranges();
        watch.observe(row, inputs);
        Ok(Taken {
            readings: inputs.readings().to_vec(),
            set: self.set(row, layout)?,
            id: text(row, layout.id).unwrap_or_default(),
            place: (row.path.to_path_buf(), row.line),
        })
    }

    /// The corner of a row; `None` where it was not seen.
    fn corner(
        &self,
        row: &Row<'_>,
        columns: &CornerColumns,
        numbers: &mut Numbers,
    ) -> Result<Option<Corner>> {
        let mut number = |column: usize, name: &str| match row.cells.get(column).map_or("", |cell| cell.raw) {
            "" => Ok(None),
            raw => {
                let value = numbers.parse(raw, row.line).map_err(|expected| {
                    row.error(column, format!("found `{raw}` in column `{name}`, expected {expected}"))
                })?;
                if value.abs() > LARGEST_PX {
                    let message = format!("found `{raw}` in column `{name}`, expected a pixel below 1e6");
                    return Err(row.error(column, message));
                }
                Ok(Some(value))
            }
        };
        let (u, v) = (number(columns.u, "u")?, number(columns.v, "v")?);
        let sigma_px = columns.sigma.map(|column| number(column, "sigma")).transpose()?.flatten();
        if let (Some(column), Some(value)) = (columns.sigma, sigma_px.filter(|value| *value <= 0.0)) {
            let message = format!("found `{value}` in column `sigma`, expected a standard deviation above 0");
            return Err(row.error(column, message));
        }
        let pixel = match (u, v) {
            (Some(u), Some(v)) => Vector2::new(u, v),
            (None, None) => return Ok(None),
            (Some(_), None) => {
                return Err(row.error(
                    columns.v,
                    "found an empty cell in column `v`, expected both of u and v, or none",
                ));
            }
            (None, Some(_)) => {
                return Err(row.error(
                    columns.u,
                    "found an empty cell in column `u`, expected both of u and v, or none",
                ));
            }
        };
        Ok(Some(Corner {
            point: 0,
            pixel,
            sigma_px,
            weight: 1.0,
            line: u32::try_from(row.line).unwrap_or(u32::MAX),
        }))
    }

    /// Puts a corner to its picture.
    fn gather(
        &mut self,
        row: &Row<'_>,
        columns: &CornerColumns,
        gathering: &mut Gathering,
        (image, taken): (Option<String>, Taken),
        mut corner: Corner,
    ) -> Result<()> {
        let camera = self.camera(row, columns.camera)?;
        let board = self.board(row, (columns.board, columns.target))?;
        corner.point = self.point(row, columns.target, board)?;
        let own = image.is_none().then_some(&taken.readings);
        let key = format!("{} {} {own:?}", image.as_deref().unwrap_or_default(), taken.id);
        let Gathering { pictures, known } = gathering;
        let at = *known.entry((key, camera, board)).or_insert_with(|| {
            pictures.push(Gathered {
                taken: taken.clone(),
                image: image.clone(),
                camera,
                board,
                corners: Vec::new(),
            });
            pictures.len() - 1
        });
        let Some(picture) = pictures.get_mut(at) else { return Ok(()) };
        let first = &picture.taken;
        if first.readings != taken.readings || first.set != taken.set {
            let what = if first.set == taken.set { "joint readings" } else { "set" };
            let message = format!(
                "found another {what} of picture `{}` than in line {}, expected the same for all corners of a picture",
                image.unwrap_or_default(),
                first.place.1
            );
            return Err(row.error(columns.target, message));
        }
        if let Some(other) = picture.corners.iter().find(|it| it.point == corner.point) {
            let message = format!(
                "found the corner `{}` a second time in one picture (line {} is the first), expected it once",
                text(row, Some(columns.target)).unwrap_or_default(),
                other.line
            );
            return Err(row.error(columns.target, message));
        }
        picture.corners.push(corner);
        Ok(())
    }

    /// Index of the row's camera among those that are known.
    fn camera(&mut self, row: &Row<'_>, column: Option<usize>) -> Result<usize> {
        let cameras = &self.options.cameras;
        let name = text(row, column).unwrap_or_default();
        if let Some(at) = cameras.iter().position(|it| it.name == name) {
            return Ok(at);
        }
        let is_nameless = cameras.len() == 1 && cameras.iter().all(|it| it.is_guessed);
        if column.is_none() || name.is_empty() || is_nameless {
            if cameras.len() == 1 {
                return Ok(0);
            }
            let names: Vec<&str> = cameras.iter().map(|it| it.name.as_str()).collect();
            let message = format!(
                "found no name of a camera, expected one of {} in a column `camera`",
                first_few(&names)
            );
            return Err(row.error(column.unwrap_or(0), message));
        }
        // One of which the name is a word of the other: `left` for `left_eye`.
        let is_like = |own: &str| {
            let word = |whole: &str, part: &str| whole.split(['_', '-', ' ', '/']).any(|it| it == part);
            word(&name, own) || word(own, &name)
        };
        let like: Vec<usize> = (0..cameras.len()).filter(|&at| is_like(&cameras[at].name)).collect();
        let [at] = like.as_slice() else {
            let names: Vec<&str> = cameras.iter().map(|it| it.name.as_str()).collect();
            let message = format!("found the camera `{name}`, expected one of {}", first_few(&names));
            return Err(row.error(column.unwrap_or(0), message));
        };
        self.say_once(format!("took the camera `{}` for `{name}`", cameras[*at].name));
        Ok(*at)
    }

    fn say_once(&mut self, sentence: String) {
        if !self.found.warnings.contains(&sentence) {
            self.found.warnings.push(sentence);
        }
    }
}

/// Text of a cell.
pub(super) fn text(row: &Row<'_>, column: Option<usize>) -> Option<String> {
    Some(row.cells.get(column?)?.text().trim().to_owned())
}
