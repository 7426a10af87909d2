//! Files to measurements.

use std::path::Path;

use rayon::prelude::*;

use super::blocks::{Block, Blocks};
use super::inputs::InputReader;
use super::layout::Layout;
use super::mapping::ColumnMap;
use super::number::Numbers;
use super::part::{Found, Part};
use super::table::Table;
use super::understanding::{self, FileUnderstanding};
use super::{MeasurementFile, ReadOptions, scale, spread};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

/// Reads measurement files, joined in their order.
///
/// # Errors
/// A file that cannot be read ([`ErrorKind::File`]), is no table ([`ErrorKind::Syntax`]), has a wrong or missing unit
/// ([`ErrorKind::Unit`]), or whose columns or cells are not what they should be ([`ErrorKind::Measurement`]); a
/// [`ReadOptions::fit_where`] that fits no file ([`ErrorKind::Option`]).
pub fn read(paths: &[impl AsRef<Path>], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    if paths.is_empty() {
        return Err(Error::new(ErrorKind::Option, "found no measurement file, expected at least one"));
    }
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    for path in paths {
        let path = path.as_ref();
        reader.file(path, Blocks::open(path, "a measurement file (CSV)")?)?;
    }
    reader.finish()
}

/// Reads the text of a measurement file; `path` is for the messages only.
///
/// ```
/// use poecal::io::measurements::{ReadOptions, parse};
/// let robot = poecal::simulate::scara();
/// let text = "joint1,joint2,joint3,joint4,x,y,z\n0,0.1,0.1,0,0.6,0.05,0.1\n";
/// let file = parse(text, "a table", &robot, &ReadOptions::default())?;
/// assert_eq!(file.data.readings(0), [0.0, 0.1, 0.1, 0.0]);
/// # Ok::<(), poecal::Error>(())
/// ```
///
/// # Errors
/// As [`read()`].
pub fn parse(
    text: &str,
    path: impl AsRef<Path>,
    robot: &Robot,
    options: &ReadOptions,
) -> Result<MeasurementFile> {
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    reader.file(path.as_ref(), Blocks::new(path.as_ref(), text.as_bytes()))?;
    reader.finish()
}

struct Reader<'a> {
    robot: &'a Robot,
    options: &'a ReadOptions,
    map: &'a ColumnMap,
    found: Found,
    understood: Vec<FileUnderstanding>,
    warnings: Vec<String>,
}

impl<'a> Reader<'a> {
    fn new(robot: &'a Robot, options: &'a ReadOptions, no_map: &'a ColumnMap) -> Self {
        Reader {
            robot,
            options,
            map: options.mapping.as_ref().unwrap_or(no_map),
            found: Found::new(robot),
            understood: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn file<'p>(&mut self, path: &'p Path, mut blocks: Blocks<'p>) -> Result<()> {
        let table = Table::open(path, &mut blocks, self.map)?;
        let layout = Layout::new(&table.header, self.robot, self.options, self.map)?;
        let mut found = std::mem::replace(&mut self.found, Found::new(self.robot));
        let first = found.data.len();
        found.data.files.push(path.to_path_buf());
        if layout.id.is_some() {
            found.data.ids.resize(first, String::new());
        }
        let inputs = InputReader::new(&layout.inputs, Numbers::new(self.map.decimal));
        let file = u32::try_from(self.understood.len()).unwrap_or(u32::MAX);
        let mut whole = Part::new(self.robot, &layout, file, inputs, found);
        read_blocks(&mut whole, &table, &mut blocks)?;
        let Part { found, inputs, watch, rows, .. } = whole;
        self.found = found;
        let data = &mut self.found.data;
        if rows == 0 {
            let message = "found a header and no rows, expected at least one measurement";
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
        }
        self.warnings.extend(watch.finish(path, &layout)?);
        let new_rows = data.observations.get(first..).unwrap_or_default();
        scale::check_positions(
            path,
            self.robot,
            &layout,
            scale::unlimited_slides(self.robot, &watch),
            new_rows,
        )?;
        spread::check(path, &table.header, self.robot, &layout, data, first)?;
        let poses = new_rows.iter().filter(|row| row.measurement.sees_orientation()).count();
        let points = new_rows.len() - poses;
        if !data.ids.is_empty() {
            data.ids.resize(data.len(), String::new());
        }
        self.warn_of_ignored(path, &layout);
        self.understood.push(FileUnderstanding {
            path: path.to_path_buf(),
            rows,
            points,
            poses,
            separator: table.separator,
            decimal_sign: inputs.numbers.sign(),
            columns: understanding::columns(&table.header, &layout, &inputs.ranges),
            orientation: understanding::orientation(&layout),
            pose: understanding::pose_word(layout.pose),
            ignored: layout.ignored.into_iter().map(|(name, _)| name).collect(),
        });
        Ok(())
    }

    fn warn_of_ignored(&mut self, path: &Path, layout: &Layout) {
        if layout.ignored.is_empty() {
            return;
        }
        let columns = layout.ignored.iter().map(|(name, meant)| match meant {
            Some(meant) => format!("`{name}` (did you mean `{meant}`?)"),
            None => format!("`{name}`"),
        });
        let columns: Vec<String> = columns.collect();
        self.warnings.push(format!("{}: left alone the columns {}", path.display(), columns.join(", ")));
    }

    fn finish(self) -> Result<MeasurementFile> {
        let of_map = self.map.set.as_ref().map(|set| (&set.column, &set.fit));
        let rule = self.options.fit_where.as_ref().map(|rule| (&rule.column, &rule.values)).or(of_map);
        if let Some((column, values)) = rule
            && !self.options.ignore_sets
            && let Some((_, value)) =
                values.iter().enumerate().find(|(index, _)| self.found.fit_values.get(*index) != Some(&true))
        {
            let message =
                format!("found no row with `{value}` in column `{column}`, expected at least one to fit");
            let error = Error::new(ErrorKind::Option, message);
            return Err(match self.found.data.files.as_slice() {
                [only] => error.in_file(only),
                _ => error,
            });
        }
        Ok(MeasurementFile { data: self.found.data, understood: self.understood, warnings: self.warnings })
    }
}

/// Reads the blocks of a file: each thread one at a time, as soon as none depends on the one before.
fn read_blocks(whole: &mut Part<'_>, table: &Table<'_>, blocks: &mut Blocks<'_>) -> Result<()> {
    while let Some(first) = blocks.next()? {
        if !whole.is_settled() {
            whole.join(whole.read_next(table.rows(&first))?);
            continue;
        }
        let more = (1..rayon::current_num_threads()).map_while(|_| blocks.next().transpose());
        let together: Vec<Result<Block>> = std::iter::once(Ok(first)).chain(more).collect();
        let parts: Vec<Result<Part<'_>>> =
            together.into_par_iter().map(|block| whole.read_next(table.rows(&block?))).collect();
        parts.into_iter().try_for_each(|part| part.map(|part| whole.join(part)))?;
    }
    Ok(())
}
