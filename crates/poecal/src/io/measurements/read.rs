//! Reads measurement files.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::builder::TargetLayout;
use super::inputs::InputReader;
use super::kinds::KindColumns;
use super::layout::{ColumnLayout, SetRule};
use super::lost::{self, LostBeams};
use super::mapping::ColumnMap;
use super::naming::Names;
use super::number::Numbers;
use super::row::{component_noise, measurement};
use super::scale::{self, JointWatch};
use super::socket_distance::Sockets;
use super::spread;
use super::table::{Row, Table, refuse_more_rows};
use super::text::Blocks;
use super::turns::{self, TurnWatch};
use super::understanding::{self, FileUnderstanding};
use super::{FitWhere, Frames, MeasurementFile, ReadOptions};
use crate::error::{Error, ErrorKind, Result, shown};
use crate::measurement::{Dataset, Measurement, NoiseShape, Observation, Quantity, Set, Source, Stated};
use crate::robot::{Controller, Robot, check_name};
use crate::start::settle_faces;
use crate::text::visible;

/// Reads measurement files, joined in their order.
///
/// # Errors
/// A file that cannot be read ([`ErrorKind::File`]), is no table ([`ErrorKind::Syntax`]), has a wrong or missing unit
/// ([`ErrorKind::Unit`]), or has wrong columns or cells ([`ErrorKind::Measurement`]); a [`ReadOptions::fit_where`] that fits no file
/// ([`ErrorKind::Option`]).
pub fn read(paths: &[impl AsRef<Path>], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
    read_all(&paths, robot, options)
}

/// Compiled once, and not for each kind of path.
fn read_all(paths: &[&Path], robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    if paths.is_empty() {
        return Err(Error::new(ErrorKind::Option, "found no measurement file, expected at least one"));
    }
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    for path in paths {
        let blocks = Blocks::open(path, "a measurement file (CSV)")?;
        reader.file(path, blocks).map_err(|error| beside(error, path, paths, reader.map))?;
    }
    reader.finish()
}

/// An error of a column that is in another of the files: tables that stand side by side, and not one below the other.
fn beside(error: Error, path: &Path, paths: &[&Path], map: &ColumnMap) -> Error {
    let missing = error.message().strip_prefix("found no column `").and_then(|rest| rest.split_once('`'));
    let Some((name, _)) = missing else { return error };
    let has = |other: &&&Path| {
        let blocks = Blocks::open(other, "a measurement file (CSV)");
        let table = blocks
            .and_then(|blocks| Table::open(other, blocks, map).map(|table| table.header.count(name) > 0));
        **other != path && table.unwrap_or(false)
    };
    let Some(other) = paths.iter().find(has) else { return error };
    let message = format!(
        "found no column `{name}`, expected it beside the others: {} has it, so the two are parts of one table; join them row by row into one file \
         (`paste -d, {} {}`)",
        other.display(),
        path.display(),
        other.display()
    );
    let moved = Error::new(error.kind(), message);
    match error.place().and_then(|place| place.line) {
        Some(line) => moved.at_line(path, line),
        None => moved.in_file(path),
    }
}

/// Reads the text of a measurement file; `path` is for the messages only.
///
/// # Errors
/// As [`read()`].
pub fn parse(
    text: &str,
    path: impl AsRef<Path>,
    robot: &Robot,
    options: &ReadOptions,
) -> Result<MeasurementFile> {
    parse_at(text, path.as_ref(), robot, options)
}

/// Compiled once, and not for each kind of path.
fn parse_at(text: &str, path: &Path, robot: &Robot, options: &ReadOptions) -> Result<MeasurementFile> {
    let no_map = ColumnMap::default();
    let mut reader = Reader::new(robot, options, &no_map);
    reader.file(path, Blocks::new(path, text.as_bytes()))?;
    reader.finish()
}

/// What rows are of that have some components of a position.
const COMPONENTS: &str = "single components";

/// The warning of rows that have some components of a position beside rows that have all.
fn incomplete(path: &Path, rows: &[Observation]) -> Option<String> {
    let is_part = |row: &&Observation| row.measurement.is_part_of_position();
    let lines: Vec<usize> = rows.iter().filter(is_part).map(|row| row.source.line as usize).collect();
    let has_whole = rows.iter().any(|row| row.measurement.is_place() && !row.measurement.sees_orientation());
    let first = lines.get(..lines.len().min(lost::NAMED_LINES))?;
    (has_whole && !lines.is_empty()).then(|| {
        format!(
            "{}: took {} ({}) as positions of which only some components were measured; --strict refuses empty cells",
            path.display(),
            counted(lines.len()),
            lost::named_lines(lines.len(), first)
        )
    })
}

fn counted(rows: usize) -> String {
    if rows == 1 { "one row".to_owned() } else { format!("{rows} rows") }
}

/// Most ignored columns in a warning.
const IGNORED_NAMED: usize = 30;

struct Reader<'a> {
    robot: &'a Robot,
    options: &'a ReadOptions,
    map: &'a ColumnMap,
    targets: Names,
    stations: Names,
    /// What each named place is, and where it was named first.
    places: BTreeMap<String, (&'static str, PathBuf, usize)>,
    /// Pairs of rows: the first one's configuration until the second is read, and its line.
    begun: BTreeMap<String, (Option<u32>, usize)>,
    /// The sockets of each place.
    sockets: Sockets,
    /// Which of the values that mark a row to fit were seen.
    fit_values_seen: Vec<bool>,
    found: MeasurementFile,
}

impl<'a> Reader<'a> {
    fn new(robot: &'a Robot, options: &'a ReadOptions, no_map: &'a ColumnMap) -> Self {
        Reader {
            robot,
            options,
            map: options.mapping.as_ref().unwrap_or(no_map),
            targets: Names::default(),
            stations: Names::default(),
            places: BTreeMap::new(),
            begun: BTreeMap::new(),
            sockets: Sockets::new(),
            fit_values_seen: Vec::new(),
            found: MeasurementFile {
                data: Dataset::new(robot.reading_names()).with_factors(robot.factors.len()),
                ..MeasurementFile::default()
            },
        }
    }

    fn file<'p>(&mut self, path: &'p Path, blocks: Blocks<'p>) -> Result<()> {
        let mut table = Table::open(path, blocks, self.map)?;
        let layout = ColumnLayout::new(&table.header, self.robot, self.options, self.map)?;
        if let Some(column) = layout.instrument.filter(|_| self.options.frames == Frames::PerFile) {
            let message = "found a column that names the instrument beside --frames per-file, expected one of the two: leave the option \
                           out, or the column";
            return Err(table.header.error(ErrorKind::Measurement, column, message));
        }
        let mut inputs = InputReader::new(
            &layout.inputs,
            self.found.data.reading_names().len(),
            Numbers::new(self.map.decimal),
        );
        let mut watch = JointWatch::new(self.robot);
        let mut turns = TurnWatch::default();
        let first = self.found.data.len();
        self.found.data.files.push(path.to_path_buf());
        if layout.id.is_some() {
            self.found.data.ids.resize(first, String::new());
        }
        let (mut rows, mut lost) = (0, LostBeams::default());
        while let Some(mut some) = table.next_block()? {
            while let Some(row) = some.next()? {
                rows += 1;
                inputs.read(&row)?;
                watch.unwind(&row, &mut inputs);
                inputs.take_readings(&row)?;
                if self.begins_pair(&row, &layout, &inputs)? {
                    continue;
                }
                if lost.take_out(&row, &layout.targets, &mut inputs, self.options.strict)? {
                    continue;
                }
                inputs.include_in_ranges();
                watch.observe(&row, &inputs);
                turns.observe(&row, &layout, &inputs);
                self.row(&row, &layout, &inputs)?;
                refuse_more_rows(self.found.data.len(), &row)?;
            }
        }
        if let Some((name, (_, line))) = self.begun.iter().find(|(_, (index, _))| index.is_some()) {
            let message = format!(
                "found one row of the pair `{name}`, expected two: the instrument's configuration, then the target's with what was measured"
            );
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, *line));
        }
        self.begun.clear();
        self.found.sha256.extend(table.sha256().map(|sha256| (path.display().to_string(), sha256)));
        if rows == 0 {
            let message = "found a header and no rows, expected at least one measurement";
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
        }
        if self.found.data.len() == first {
            let message =
                "found no position in any row, expected at least one that is neither empty nor zero";
            return Err(Error::new(ErrorKind::Measurement, message).at_line(path, table.header.line));
        }
        self.found.warnings.extend(lost.warning(path));
        self.found
            .warnings
            .extend(incomplete(path, self.found.data.observations.get(first..).unwrap_or_default()));
        self.found.warnings.extend(watch.finish(path, &layout, &inputs.ranges)?);
        turns.finish(path)?;
        let new_rows = self.found.data.observations.get(first..).unwrap_or_default();
        let slides_m = watch.unlimited_slides_m(&inputs.ranges);
        scale::check_positions(path, self.robot, &layout, slides_m, new_rows)?;
        scale::check_ranges(path, self.robot, slides_m, new_rows)?;
        spread::check(path, &table.header, self.robot, &layout, &self.found.data, first)?;
        let (mut points, mut poses, mut others) = (0, 0, BTreeMap::new());
        for row in new_rows {
            let seen = &row.measurement;
            if seen.is_place() {
                *(if seen.sees_orientation() { &mut poses } else { &mut points }) += 1;
            } else {
                let is_part = seen.is_part_of_position();
                let name = if is_part { COMPONENTS } else { seen.function().leading().name() };
                *others.entry(name).or_default() += 1;
            }
        }
        if !self.found.data.ids.is_empty() {
            self.found.data.ids.resize(self.found.data.len(), String::new());
        }
        self.warn_of_ignored(path, &layout);
        self.found
            .warnings
            .extend(layout.joint_words().into_iter().map(|words| format!("{}: {words}", path.display())));
        self.take_controller(path, &layout)?;
        let turns = turns::warning(&table.header, &layout, self.map);
        self.found.warnings.extend(turns.map(|warning| format!("{}: {warning}", path.display())));
        self.found.understood.push(FileUnderstanding {
            path: path.to_path_buf(),
            rows,
            points,
            poses,
            others,
            lost,
            separator: table.separator,
            separator_line: table.separator_line,
            units_line: table.header.units_line,
            decimal_sign: inputs.numbers.sign(),
            columns: understanding::columns(&table.header, &layout, &inputs.ranges),
            orientation: understanding::orientation(&layout),
            pose: understanding::pose_word(layout.pose),
            ignored: layout.ignored.into_iter().map(|(name, _)| name).collect(),
        });
        Ok(())
    }

    /// How the files' readings are made of columns, which must be the same in all.
    fn take_controller(&mut self, path: &Path, layout: &ColumnLayout) -> Result<()> {
        let words = |it: &Option<Controller>| it.as_ref().map(|it| (it.third_axis, it.words()));
        let is_first = self.found.understood.is_empty();
        if !is_first && words(&self.found.data.controller) != words(&layout.controller) {
            let shown =
                |it: &Option<Controller>| it.as_ref().map_or("one by one".to_owned(), Controller::words);
            let message = format!(
                "found joint readings of columns {} after a file with {}, expected the same in all files",
                shown(&layout.controller),
                shown(&self.found.data.controller)
            );
            return Err(Error::new(ErrorKind::Measurement, message).in_file(path));
        }
        self.found.data.controller.clone_from(&layout.controller);
        Ok(())
    }

    fn warn_of_ignored(&mut self, path: &Path, layout: &ColumnLayout) {
        if layout.ignored.is_empty() {
            return;
        }
        let columns = layout.ignored.iter().take(IGNORED_NAMED).map(|(name, meant)| match meant {
            Some(meant) => format!("`{}` (did you mean `{meant}`?)", shown(name)),
            None => format!("`{}`", shown(name)),
        });
        let columns: Vec<String> = columns.collect();
        let more = match layout.ignored.len() - columns.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let columns = columns.join(", ");
        self.found.warnings.push(format!("{}: ignored the columns {columns}{more}", path.display()));
    }

    fn row(&mut self, row: &Row<'_>, layout: &ColumnLayout, inputs: &InputReader<'_>) -> Result<()> {
        let set = self.set(row, layout)?;
        for target in &layout.targets {
            let may_be_missing = layout.targets.len() > 1;
            let how = (may_be_missing, self.options.strict);
            if let Some(measurement) = measurement(row, target, layout.pose, inputs, how)? {
                let mut stated = Stated::default();
                stated.set(Quantity::Position, inputs.sigma(row, target.sigma_position)?);
                stated.set(Quantity::Rotation, inputs.sigma(row, target.sigma_rotation)?);
                let shape =
                    component_noise(row, target, inputs, &measurement)?.and_then(NoiseShape::by_component);
                if let (Some(_), Some(input)) = (&shape, target.sigma_position) {
                    let message = "found `sigma_position` beside standard deviations of the components, expected one of the two";
                    return Err(row.error(inputs.column(input), message));
                }
                self.observation(row, layout, (target, set, None), (measurement, stated), inputs)?;
                if let Some(shape) = shape {
                    self.found.data.state_noise(self.found.data.len() - 1, shape);
                }
            }
            let has_position = lost::has_position(target, inputs);
            for kind in &target.kinds {
                if let Some((measurement, stated)) =
                    kind.measurement(row, inputs, (has_position, self.options.contact))?
                {
                    self.observation(row, layout, (target, set, Some(kind)), (measurement, stated), inputs)?;
                }
            }
        }
        Ok(())
    }

    /// Whether a row is the first one of a pair, the configuration from which the second is seen.
    fn begins_pair(
        &mut self,
        row: &Row<'_>,
        layout: &ColumnLayout,
        inputs: &InputReader<'_>,
    ) -> Result<bool> {
        let Some((column, name)) = layout.pair.and_then(|at| Some((at, row.cells.get(at)?.text()))) else {
            return Ok(false);
        };
        if name.is_empty() || self.begun.get(name.as_ref()).is_some_and(|(index, _)| index.is_some()) {
            return Ok(false);
        }
        if let Some((_, line)) = self.begun.get(name.as_ref()) {
            let message =
                format!("found a third row of the pair `{name}` (line {line} is the first), expected two");
            return Err(row.error(column, message));
        }
        let further = self.found.data.push_further(inputs.readings());
        let further = further.map_err(|error| row.error(column, error.message()))?;
        self.begun.insert(name.into_owned(), (Some(further), row.line));
        Ok(true)
    }

    /// Adds a measurement of a row.
    fn observation(
        &mut self,
        row: &Row<'_>,
        layout: &ColumnLayout,
        (target, set, kind): (&TargetLayout, Option<Set>, Option<&KindColumns>),
        (measurement, stated): (Measurement, Stated),
        inputs: &InputReader<'_>,
    ) -> Result<()> {
        let target = self.target(row, layout, target)?;
        let pair = layout.pair.and_then(|at| row.cells.get(at)).map(|cell| cell.text());
        let from = pair.and_then(|pair| self.begun.get_mut(pair.as_ref())?.0.take());
        let observation = Observation {
            station: self.station(row, layout, kind, from.map(|_| target))?,
            from,
            stated,
            set,
            source: Source {
                file: u32::try_from(self.found.understood.len()).unwrap_or(u32::MAX),
                line: u32::try_from(row.line).unwrap_or(u32::MAX),
            },
            ..Observation::new(target, measurement)
        };
        self.found
            .data
            .push_observation(inputs.readings(), observation)
            .map_err(|error| row.error(0, error.message()))?;
        if let Some(cell) = layout.id.and_then(|id| row.cells.get(id)) {
            self.found.data.ids.push(cell.text().into_owned());
        }
        Ok(())
    }

    /// The stated set of a row.
    fn set(&mut self, row: &Row<'_>, layout: &ColumnLayout) -> Result<Option<Set>> {
        let text = |index: usize| row.cells.get(index).map(|cell| cell.text()).unwrap_or_default();
        match &layout.set {
            SetRule::Unstated => Ok(None),
            SetRule::Words(index) => match text(*index).as_ref() {
                "" => Ok(None),
                "fit" => Ok(Some(Set::Fit)),
                "held_out" => Ok(Some(Set::HeldOut)),
                other => Err(row
                    .error(*index, format!("found `{other}` in column `set`, expected `fit` or `held_out`"))),
            },
            SetRule::Where(index, rule) => {
                self.fit_values_seen.resize(rule.values.len(), false);
                let Some(value) = rule.matching(&text(*index)) else { return Ok(Some(Set::HeldOut)) };
                if let Some(seen) = self.fit_values_seen.get_mut(value) {
                    *seen = true;
                }
                Ok(Some(Set::Fit))
            }
        }
    }

    /// Index of the row's target. Either all rows name their target or none does.
    fn target(&mut self, row: &Row<'_>, layout: &ColumnLayout, target: &TargetLayout) -> Result<usize> {
        let cell = layout.target_column.and_then(|column| row.cells.get(column)).map(|cell| cell.text());
        let name = cell.as_deref().or(target.name.as_deref()).filter(|name| !name.is_empty());
        let column = layout.target_column;
        let index = self.targets.index(row, column, "target", name)?;
        if index == self.found.data.targets.len() {
            check_name(name.unwrap_or_default(), "target")
                .map_err(|error| row.error(column.unwrap_or(0), error.message()))?;
            self.found.data.targets.push(name.map(str::to_owned));
        }
        Ok(index)
    }

    /// Index of the row's station: of its instrument, or of the place from which it was measured. Either all rows that are measured alike name
    /// theirs or none does.
    fn station(
        &mut self,
        row: &Row<'_>,
        layout: &ColumnLayout,
        kind: Option<&KindColumns>,
        shared: Option<usize>,
    ) -> Result<usize> {
        let text = |column: usize| row.cells.get(column).map(|cell| cell.text()).filter(|it| !it.is_empty());
        let own = kind.and_then(|kind| kind.place_name(row));
        let instrument = layout.instrument.and_then(text);
        if let (Some(kind), Some(own), Some(other)) = (kind, &own, &instrument)
            && own != other
        {
            let (what, columns) = kind.place();
            let message = format!(
                "found the {what} `{own}` beside the instrument `{other}`, expected one of the two: leave one cell empty"
            );
            return Err(row.error(columns.last().copied().unwrap_or(0), message));
        }
        let place = kind.map(KindColumns::place).filter(|(_, columns)| !columns.is_empty());
        let (what, column) = match (&own, place, layout.instrument) {
            (Some(_), Some((what, columns)), _) => (what, columns.last().copied()),
            (None, Some((what, columns)), Some(_)) if instrument.is_none() => (what, columns.last().copied()),
            (_, _, Some(column)) => ("instrument", Some(column)),
            (None, Some((what, columns)), None) => (what, columns.last().copied()),
            (_, None, None) => ("instrument", None),
        };
        let pair = shared.filter(|_| own.is_none() && instrument.is_none()).map(|target| {
            let target = self.found.data.targets.get(target).cloned().flatten();
            Cow::Owned(target.map_or_else(|| "pair".to_owned(), |target| format!("pair/{target}")))
        });
        let (what, column) = if pair.is_some() { ("pair", layout.pair) } else { (what, column) };
        let name = match (own.or(pair), self.options.frames) {
            (Some(own), _) => Some(own),
            (None, Frames::PerFile) => Some(Cow::Owned(row.path.display().to_string())),
            (None, Frames::Common) => instrument,
        };
        let name = name.as_deref();
        if let Some(name) = name {
            self.refuse_other_place(row, column, what, name)?;
        }
        let index = self.stations.index(row, column, what, name)?;
        let known = &mut self.found.data.stations;
        if index >= known.len() && (name.is_some() || index > 0) {
            if let Some(name) = name.filter(|_| self.options.frames == Frames::Common) {
                check_name(&name.replace('/', "_"), what)
                    .map_err(|error| row.error(column.unwrap_or(0), error.message()))?;
            }
            // An unnamed instrument before the first name.
            known.resize(index, None);
            known.push(name.map(str::to_owned));
            if what == "socket" {
                let (place, socket) =
                    name.and_then(|name| name.rsplit_once('/')).unwrap_or(("", name.unwrap_or_default()));
                self.sockets.entry(place.to_owned()).or_default().push((socket.to_owned(), index));
            }
        }
        Ok(index)
    }

    /// Refuses a name that places of two kinds share. An anchor may be an instrument that measures positions too.
    fn refuse_other_place(
        &mut self,
        row: &Row<'_>,
        column: Option<usize>,
        what: &'static str,
        name: &str,
    ) -> Result<()> {
        let place = |what: &'static str| if what == "anchor" { "instrument" } else { what };
        let (known, path, line) =
            self.places.entry(name.to_owned()).or_insert_with(|| (what, row.path.to_path_buf(), row.line));
        if place(known) == place(what) {
            return Ok(());
        }
        let message = format!(
            "found the {what} `{name}`, which is the name of the {known} in {}:{line}, expected another name",
            path.display()
        );
        Err(row.error(column.unwrap_or(0), message))
    }

    fn finish(self) -> Result<MeasurementFile> {
        let rule = self.options.fit_where.as_ref().or(self.map.set.as_ref());
        if let Some(FitWhere { column, values }) = rule
            && !self.options.ignore_sets
            && let Some((value, _)) = values.iter().zip(&self.fit_values_seen).find(|(_, seen)| !**seen)
        {
            let message =
                format!("found no row with `{value}` in column `{column}`, expected at least one to fit");
            let error = Error::new(ErrorKind::Option, message);
            return Err(match self.found.data.files.as_slice() {
                [only] => error.in_file(only),
                _ => error,
            });
        }
        let mut found = self.found;
        if let Some(distances) = &self.options.socket_distances {
            found.data.lengths = distances.lengths(&self.sockets)?;
        }
        for noise in &self.options.instrument_noise {
            noise.state(&mut found.data)?;
        }
        settle_faces(&mut found.data, self.robot);
        found.warnings.iter_mut().for_each(|warning| *warning = visible(warning).into_owned());
        Ok(found)
    }
}
