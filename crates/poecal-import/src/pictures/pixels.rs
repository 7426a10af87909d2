//! Files of corners that cameras saw: a row for each corner, with `u` and `v` in pixels. The readings of the joints are in each row, or in another
//! file by picture (docs/file-formats.md, "Pixels").

use std::path::Path;

use super::corner_columns::{self, CornerColumns};
use super::gathering::{BoardSighting, PictureGathering};
use super::picture_files::{NO_CAMERA, PictureConfiguration};
use crate::read::MeasurementReader;
use crate::table::cursor::Cursor;
use crate::table::header::Header;
use crate::table::inputs::ValueRange;
use crate::table::layout::ColumnLayout;
use crate::table::number::NumberReader;
use crate::table::{FileRow, FileTable};
use nalgebra::Vector2;
use poecal_model::camera::Corner;
use poecal_numerics::error::{ErrorKind, Result, first_few};

/// Largest pixel coordinate.
const LARGEST_PX: f64 = 1e6;

impl MeasurementReader<'_> {
    /// Reads a file of readings by picture, whose corners are in another one.
    pub(crate) fn readings_of_pictures(&mut self, path: &Path, mut table: FileTable<'_>) -> Result<()> {
        let mut layout = ColumnLayout::pictures(&table.header, self.robot, self.options, self.map)?;
        let image = corner_columns::picture(&table.header, self.found.data.reading_names())?;
        let missing = || table.header.require("image", "for the name of the picture", |_| false, "");
        let image = image.map_or_else(missing, Ok)?;
        let column = table.header.text(image).to_owned();
        layout.ignored.retain(|(name, _)| *name != column);
        let mut inputs = Cursor::new(layout, self.robot, self.map.decimal);
        table.each_row(|row| {
            let taken = self.take_configuration(row, &mut inputs)?;
            let name = row.word(Some(image));
            if name.is_empty() {
                let message = format!("found an empty cell in column `{column}`, expected the name of a picture");
                return Err(row.error(image, message));
            }
            if let Some(PictureConfiguration { place: (path, line), .. }) = self.taken.get(&name) {
                let message = format!(
                    "found the picture `{name}` a second time ({}:{line} is the first), expected it once",
                    path.display()
                );
                return Err(row.error(image, message));
            }
            self.taken.insert(name, taken);
            Ok(())
        })?;
        self.warn(path, (column != "image").then(|| format!("took `{column}` for image")));
        self.warn_of_ignored(path, &inputs.layout);
        self.warn(path, inputs.layout.joint_words());
        self.found.data.controller.clone_from(&inputs.layout.controller);
        self.found.warnings.extend(inputs.joint_warnings(&table.header)?);
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        Ok(())
    }

    /// Reads a file of corners.
    pub(crate) fn corners(&mut self, path: &Path, mut table: FileTable<'_>) -> Result<()> {
        let joints = self.found.data.reading_names().to_vec();
        let has_boards = !self.boards.is_empty();
        let columns = CornerColumns::new(&table.header, &joints, (self.map, has_boards))?;
        let Some(columns) = columns else { return Ok(()) };
        self.refuse_without_cameras(&table.header, &columns)?;
        let has_joints = self.taken.is_empty() || joints.iter().all(|name| table.header.count(name) > 0);
        let mut layout = self.layout_of_corners(&table.header, &columns, has_joints)?;
        if !has_joints {
            layout.controller.clone_from(&self.found.data.controller);
        }
        let mut numbers = NumberReader::new(self.map.decimal);
        let mut inputs = Cursor::new(layout, self.robot, self.map.decimal);
        let is_named = columns.names_pictures(&table.header);
        let (mut gathering, mut seen) = (PictureGathering::default(), [ValueRange::default(); 3]);
        let rows = table.some_rows("at least one corner", |row| {
            let image = Some(row.word(columns.image)).filter(|name| !name.is_empty());
            let taken = match (has_joints, &image) {
                (true, _) => Some(self.take_configuration(row, &mut inputs)?),
                (false, Some(_)) => None,
                (false, None) => {
                    let message = "found an empty cell in the column of the picture, expected the name of a picture";
                    return Err(row.error(columns.image.unwrap_or(0), message));
                }
            };
            let Some(corner) = corner(row, &columns, &mut numbers)? else { return Ok(()) };
            let numbers = [Some(corner.pixel.x), Some(corner.pixel.y), corner.sigma_px];
            for (range, number) in seen.iter_mut().zip(numbers) {
                number.into_iter().for_each(|number| range.include(number));
            }
            self.gather(row, &columns, &mut gathering, (image, taken, is_named), corner)
        })?;
        self.warn(path, columns.words(&table.header));
        self.warn(path, gathering.settle_numbers(path, &self.boards)?);
        if !has_joints {
            self.warn(path, gathering.join(path, (&self.taken, self.taken_as))?);
        }
        self.warn(path, self.board_of_file(&columns, has_boards));
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        self.found.warnings.extend(inputs.joint_warnings(&table.header)?);
        self.found.data.files.push(path.to_path_buf());
        let first = self.found.data.len();
        self.take_pictures(path, gathering.pictures)?;
        let own = columns.describe_columns(&table.header, &seen);
        self.understand_pictures(&table, &inputs, (first, rows, own))
    }

    /// The columns of the joints beside those of the corners, and the ignored columns.
    fn layout_of_corners(
        &self,
        header: &Header<'_>,
        columns: &CornerColumns,
        has_joints: bool,
    ) -> Result<ColumnLayout> {
        let mut layout = if has_joints {
            ColumnLayout::pictures(header, self.robot, self.options, self.map)?
        } else {
            let cells = header.cells.iter().filter(|cell| !cell.text.is_empty());
            ColumnLayout::from_ignored(cells.map(|cell| (cell.text.clone(), None)).collect())
        };
        if !has_joints && columns.image.is_none() {
            header.require("image", "for the name of the picture", |_| false, "")?;
        }
        // A column that counts corners is no id of their picture.
        if let Some(id) = layout.id.filter(|id| columns.place.is_some() || columns.all().iter().any(|(_, at)| at == id))
        {
            layout.ignored.extend(header.cells.get(id).map(|cell| (cell.text.clone(), None)));
            layout.id = None;
        }
        let own: Vec<&str> = columns.all().into_iter().map(|(_, at)| header.text(at)).collect();
        layout.ignored.retain(|(name, _)| !own.contains(&name.as_str()));
        Ok(layout)
    }

    fn refuse_without_cameras(&self, header: &Header<'_>, columns: &CornerColumns) -> Result<()> {
        let missing = if self.cameras.is_empty() {
            NO_CAMERA
        } else if self.boards.is_empty() && columns.place.is_none() {
            "found corners in pixels and no board, expected --markers with its points: a CSV file, or chessboard:10x7:27mm"
        } else {
            return Ok(());
        };
        Err(header.error(ErrorKind::Measurement, columns.u, missing))
    }

    /// The configuration of a row.
    fn take_configuration(&mut self, row: &FileRow<'_>, inputs: &mut Cursor<'_>) -> Result<PictureConfiguration> {
        Ok(PictureConfiguration {
            readings: inputs.read_joints(row)?.to_vec(),
            set: self.set(row, &inputs.layout)?,
            id: row.word(inputs.layout.id),
            place: (row.path.to_path_buf(), row.line),
        })
    }

    /// Adds a corner to its picture.
    fn gather(
        &mut self,
        row: &FileRow<'_>,
        columns: &CornerColumns,
        gathering: &mut PictureGathering,
        (image, taken, is_named): (Option<String>, Option<PictureConfiguration>, bool),
        mut corner: Corner,
    ) -> Result<()> {
        let camera = self.camera(row, columns.camera)?;
        let board = self.board(row, columns)?;
        corner.point = self.point(row, columns, (board, gathering))?;
        // A column that may have another meaning than the picture does not join configurations.
        let own = taken.as_ref().filter(|_| image.is_none() || !is_named).map(|taken| &taken.readings);
        let id = taken.as_ref().map_or("", |taken| taken.id.as_str());
        let key = format!("{} {id} {own:?}", image.as_deref().unwrap_or_default());
        let PictureGathering { pictures, known, .. } = gathering;
        let at = *known.entry((key, camera, board)).or_insert_with(|| {
            let (taken, image) = (taken.clone(), image.clone());
            pictures.push(BoardSighting { taken, image, camera, board, corners: Vec::new() });
            pictures.len() - 1
        });
        let Some(picture) = pictures.get_mut(at) else { return Ok(()) };
        if let (Some(first), Some(taken)) = (&picture.taken, &taken)
            && (first.readings != taken.readings || first.set != taken.set)
        {
            let what = if first.set == taken.set { "joint readings" } else { "set" };
            let message = format!(
                "found another {what} of picture `{}` than in line {}, expected the same for all corners of a picture",
                image.unwrap_or_default(),
                first.place.1
            );
            return Err(row.error(columns.corner(), message));
        }
        if let Some(other) = picture.corners.iter().find(|it| it.point == corner.point) {
            let message = format!(
                "found the corner `{}` a second time in one picture (line {} is the first), expected it once",
                row.word(Some(columns.corner())),
                other.line
            );
            return Err(row.error(columns.corner(), message));
        }
        picture.corners.push(corner);
        Ok(())
    }

    /// Index of the row's camera among those that are known.
    fn camera(&mut self, row: &FileRow<'_>, column: Option<usize>) -> Result<usize> {
        let (cameras, name) = (&self.cameras, row.word(column));
        if let Some(at) = cameras.iter().position(|it| it.name == name) {
            return Ok(at);
        }
        let refuse = |found: &str, end: &str| {
            let names: Vec<&str> = cameras.iter().map(|it| it.name.as_str()).collect();
            let message = format!("found {found}, expected one of {}{end}", first_few(&names));
            Err(row.error(column.unwrap_or(0), message))
        };
        if let [only] = cameras.as_slice()
            && (name.is_empty() || only.is_guessed)
        {
            return Ok(0);
        }
        if name.is_empty() {
            return refuse("no name of a camera", " in a column `camera`");
        }
        // Two cameras are alike if the name of one is a word of the other: `left` for `left_eye`.
        let is_like = |own: &str| {
            let word = |whole: &str, part: &str| whole.split(['_', '-', ' ', '/']).any(|it| it == part);
            word(&name, own) || word(own, &name)
        };
        let mut like = cameras.iter().enumerate().filter(|(_, it)| is_like(&it.name));
        let (Some((at, camera)), None) = (like.next(), like.next()) else {
            return refuse(&format!("the camera `{name}`"), "");
        };
        let sentence = format!("took the camera `{}` for `{name}`", camera.name);
        if !self.found.warnings.contains(&sentence) {
            self.found.warnings.push(sentence);
        }
        Ok(at)
    }
}

/// The corner of a row; `None` if it was not seen.
fn corner(row: &FileRow<'_>, columns: &CornerColumns, numbers: &mut NumberReader) -> Result<Option<Corner>> {
    let mut number = |column: usize, name: &str| {
        let raw = row.raw_text(column);
        if raw.is_empty() {
            return Ok(None);
        }
        match row.number(column, numbers, format_args!(" in column `{name}`"))? {
            value if value.abs() > LARGEST_PX => {
                let message = format!("found `{raw}` in column `{name}`, expected a pixel below 1e6");
                Err(row.error(column, message))
            }
            value => Ok(Some(value)),
        }
    };
    let (u, v) = (number(columns.u, "u")?, number(columns.v, "v")?);
    let sigma_px = columns.sigma.map(|column| number(column, "sigma")).transpose()?.flatten();
    if let (Some(column), Some(value)) = (columns.sigma, sigma_px.filter(|value| *value <= 0.0)) {
        let message = format!("found `{value}` in column `sigma`, expected a standard deviation above 0");
        return Err(row.error(column, message));
    }
    let half = |column: usize, name: &str| {
        let message = format!("found an empty cell in column `{name}`, expected both of u and v, or none");
        Err(row.error(column, message))
    };
    let pixel = match (u, v) {
        (Some(u), Some(v)) => Vector2::new(u, v),
        (None, None) => return Ok(None),
        (Some(_), None) => return half(columns.v, "v"),
        (None, Some(_)) => return half(columns.u, "u"),
    };
    let line = u32::try_from(row.line).unwrap_or(u32::MAX);
    Ok(Some(Corner { point: 0, pixel, sigma_px, weight: 1.0, line }))
}
