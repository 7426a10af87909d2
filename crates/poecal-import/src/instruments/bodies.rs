//! Bodies with poses, or markers, that a recorder observed at each time.

use nalgebra::Vector3;

use super::OpeningContext;
use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn, place, quaternion};
use super::marker_words;
use super::words::{lines, quote_names};
use poecal_fit::start::{FEWEST_MARKERS, MarkerPositions, RenamedMarkers};
use poecal_numerics::error::{first_few, shorten_name};

/// A body or a marker that moved less than this, metres, is at rest.
const MOVED_M: f64 = 0.02;
/// A body that moved less than this share of the largest motion is at rest too: its noise is in another unit than stated.
const MOVED: f64 = 0.05;
/// Share of the frames at either end of a coordinate that do not count as motion, such as those of a mistaken body.
const STRAYED: f64 = 0.01;

/// True for each item that moves, by their distances of motion, metres.
pub(crate) fn which_move(moved_m: &[f64]) -> Vec<bool> {
    let farthest = moved_m.iter().copied().fold(0.0, f64::max);
    moved_m.iter().map(|it| *it > MOVED_M.max(MOVED * farthest)).collect()
}

/// Distance that something moved: the widest range of its coordinates, without some stray frames.
pub(crate) fn moved_m(places: &[[f64; 3]]) -> f64 {
    let wide = |at: usize| {
        let mut own: Vec<f64> = places.iter().map(|it| it[at]).collect();
        own.sort_by(f64::total_cmp);
        let cut = (STRAYED * own.len() as f64) as usize;
        own.get(own.len().saturating_sub(cut + 1)).zip(own.get(cut)).map_or(0.0, |(high, low)| high - low)
    };
    (0..3).map(wide).fold(0.0, f64::max)
}

/// One body, or one marker.
#[derive(Clone, Debug, Default)]
pub(crate) struct RecordedBody {
    pub(crate) name: String,
    /// Columns of x, y, z.
    pub(crate) position: [usize; 3],
    /// Columns of qx, qy, qz, qw.
    pub(crate) quaternion: Option<[usize; 4]>,
}

impl RecordedBody {
    /// Its columns.
    fn columns(&self) -> Vec<usize> {
        self.position.into_iter().chain(self.quaternion.into_iter().flatten()).collect()
    }
}

/// Observations at one time.
pub(crate) struct RecordedFrame<'t> {
    pub(crate) line: usize,
    /// Seconds.
    pub(crate) time: Option<f64>,
    pub(crate) cells: Vec<CellValue<'t>>,
}

/// Frames of a recorder.
pub(crate) struct RecordedFrames<'t> {
    pub(crate) all: Vec<RecordedFrame<'t>>,
    /// Unit of positions, with its size in metres.
    pub(crate) unit: (&'static str, f64),
    /// The line that names the columns.
    pub(crate) header: usize,
    /// Markers without a name, whose columns may hold those of other markers.
    pub(crate) unnamed: Vec<RecordedBody>,
    /// True if no marker has a name.
    pub(crate) are_unnamed: bool,
}

impl<'t> RecordedFrames<'t> {
    /// The frames in the lines below the header. `time` returns the time of a frame, or the defect of its line. Its arguments are the cells of the
    /// line, and the number and the time of the frame before.
    pub(crate) fn from_lines(
        text: &'t str,
        (header, unit): (usize, (&'static str, f64)),
        separator: char,
        mut time: impl FnMut(&[&str], usize, Option<f64>) -> Result<Option<f64>, String>,
    ) -> Result<Self, Refusal> {
        let mut all: Vec<RecordedFrame<'t>> = Vec::new();
        for (line, content) in lines(text).filter(|it| it.0 > header) {
            let cells = cells(content, separator);
            let time = time(&cells, all.len(), all.last().and_then(|it| it.time));
            let time = time.or_else(|message| FileLine(line).refuse(message))?;
            all.push(RecordedFrame { line, time, cells: cells.into_iter().map(CellValue::Text).collect() });
        }
        Ok(RecordedFrames { all, unit, header, unnamed: Vec::new(), are_unnamed: false })
    }

    /// The table of the body that moves; if several move, of the requested one.
    pub(crate) fn table(
        &self,
        bodies: &[RecordedBody],
        what: &str,
        opening: &OpeningContext<'_>,
    ) -> Result<MadeTable, Refusal> {
        if self.all.is_empty() {
            return FileLine(self.header).refuse("found the names of columns and no frame, expected at least one");
        }
        let taken = self.take_bodies(bodies, what, opening)?;
        let places: Vec<&RecordedBody> = taken.iter().copied().chain(&self.unnamed).collect();
        for it in &places {
            self.refuse_words(&it.name, &it.columns())?;
        }
        let has_several = taken.len() > 1;
        let is_posed = taken.iter().any(|it| it.quaternion.is_some());
        let renamed = if is_posed { None } else { self.find_renamed(&taken, &places) };
        let given = self.name_bodies(&taken, renamed.as_ref())?;
        let names: Vec<String> = given.iter().map(|it| format!("`{}`", it.1.name)).collect();
        let all_names = first_few(&names);
        let column = |it: TableColumn| it.made_of(|name| format!("{name} of {all_names}"));
        let columns = std::iter::once(TableColumn::from("time").in_unit("s"))
            .chain(has_several.then(|| TableColumn::from("target")))
            .chain(place(self.unit.0).map(column))
            .chain(quaternion().map(column).filter(|_| is_posed));
        let mut made = MadeTable::new(self.header, columns);
        for (number, frame) in self.all.iter().enumerate() {
            for &(at, named) in &given {
                let place = renamed.as_ref().map_or(Some(at), |it| it.place_of(number, at));
                let place = place.and_then(|at| places.get(at).copied());
                let is_seen = place.is_some_and(|it| frame.position(it).is_some());
                let name = has_several.then_some(CellValue::Text(&named.name));
                let parts = place.unwrap_or(named).columns().into_iter();
                let parts = parts.map(|at| if is_seen { frame.cell(at) } else { CellValue::Empty });
                let time = frame.time.map_or(CellValue::Empty, CellValue::Number);
                made.row(frame.line, std::iter::once(time).chain(name).chain(parts));
            }
        }
        made.say(format!("{} frames of {}, {}", self.all.len(), names.join(", "), self.unit.0));
        let is_taken = |it: &RecordedBody| taken.iter().any(|taken| std::ptr::eq(*taken, it));
        let left = quote_names(bodies.iter().filter(|it| !is_taken(it)).map(|it| it.name.as_str()));
        if !left.is_empty() {
            made.say(format!("left out {left}"));
        }
        if let Some(renamed) = renamed {
            let names: Vec<&str> = taken.iter().map(|it| it.name.as_str()).collect();
            let lines: Vec<usize> = self.all.iter().map(|it| it.line).collect();
            let is_seen = |frame: usize, column: usize| {
                let place = taken.get(column).zip(self.all.get(frame));
                place.is_some_and(|(body, frame)| frame.position(body).is_some())
            };
            let (said, warned) = marker_words::words(&renamed, &names, &lines, is_seen);
            made.said.extend(said);
            made.warned.extend(warned);
        }
        Ok(made)
    }

    /// The bodies that are taken, with their numbers. Without names, they are the markers that form a rigid body.
    fn name_bodies<'b>(
        &self,
        taken: &[&'b RecordedBody],
        renamed: Option<&RenamedMarkers>,
    ) -> Result<Vec<(usize, &'b RecordedBody)>, Refusal> {
        let all = taken.iter().copied().enumerate();
        match renamed {
            _ if !self.are_unnamed => Ok(all.collect()),
            Some(renamed) => Ok(all.filter(|it| renamed.markers.contains(&it.0)).collect()),
            None => FileLine(self.header).refuse("found no marker with a name, and no three that keep their distances, expected a rigid body, or markers with names, on the robot"),
        }
    }

    /// Exchanges of names that the distances between markers show; `taken` are the first of `places`. `None` if there are none.
    fn find_renamed(&self, taken: &[&RecordedBody], places: &[&RecordedBody]) -> Option<RenamedMarkers> {
        if taken.len() < FEWEST_MARKERS {
            return None;
        }
        let place =
            |frame: &RecordedFrame<'_>, body: &RecordedBody| Some(Vector3::from(frame.position(body)?) * self.unit.1);
        let of = |frame: &RecordedFrame<'_>| -> MarkerPositions { places.iter().map(|it| place(frame, it)).collect() };
        let frames: Vec<MarkerPositions> = self.all.iter().map(of).collect();
        let columns: Vec<usize> = (0..taken.len()).collect();
        let others: Vec<usize> = (if self.are_unnamed { 0 } else { taken.len() }..places.len()).collect();
        RenamedMarkers::from_frames(&frames, &columns, &others)
    }

    /// The bodies to take.
    fn take_bodies<'b>(
        &self,
        bodies: &'b [RecordedBody],
        what: &str,
        opening: &OpeningContext<'_>,
    ) -> Result<Vec<&'b RecordedBody>, Refusal> {
        let names = |some: &[&RecordedBody]| quote_names(some.iter().map(|it| it.name.as_str()));
        let all: Vec<&RecordedBody> = bodies.iter().collect();
        if let Some(wanted) = &opening.options.body {
            let found: Vec<&RecordedBody> = bodies.iter().filter(|it| it.name == *wanted).collect();
            if found.is_empty() {
                let expected = names(&all);
                return Refusal::refuse_whole(format!("found no {what} `{wanted}`, expected one of {expected}"));
            }
            return Ok(found);
        }
        let moving = |some: &[&'b RecordedBody]| -> Vec<&'b RecordedBody> {
            let moved: Vec<f64> = some.iter().map(|it| self.moved_m(it)).collect();
            some.iter().zip(which_move(&moved)).filter(|it| it.1).map(|it| *it.0).collect()
        };
        let posed: Vec<&RecordedBody> = bodies.iter().filter(|it| it.quaternion.is_some()).collect();
        let taken = match (moving(&posed).as_slice(), posed.as_slice()) {
            ([one], _) | ([], [one]) => vec![*one],
            ([], []) => moving(&all),
            ([], _) => {
                let posed = names(&posed);
                return Refusal::refuse_whole(format!(
                    "found {posed} that all stand, expected one that moves with the robot: name it by --body"
                ));
            }
            (several, _) => {
                return Refusal::refuse_whole(format!(
                    "found {} bodies that move, {}, expected one: name the one on the robot by --body",
                    several.len(),
                    names(several)
                ));
            }
        };
        if taken.is_empty() {
            return Refusal::refuse_whole(format!("found no {what} that moves, expected one on the robot"));
        }
        Ok(taken)
    }

    /// Distance that a body moved, metres.
    fn moved_m(&self, body: &RecordedBody) -> f64 {
        moved_m(&self.all.iter().filter_map(|it| it.position(body)).collect::<Vec<_>>()) * self.unit.1
    }

    /// Refuses a cell of a body that is neither empty nor a number: it is no lost frame.
    pub(crate) fn refuse_words(&self, body: &str, columns: &[usize]) -> Result<(), Refusal> {
        for frame in &self.all {
            for cell in columns.iter().map(|at| frame.cell(*at)) {
                if let CellValue::Text(word) = cell
                    && !word.is_empty()
                    && cell.number().is_none()
                {
                    let (word, body) = (shorten_name(word), shorten_name(body));
                    return FileLine(frame.line).refuse(format!(
                        "found `{word}` in a column of `{body}`, expected a number: leave the cell empty where the body was not seen"
                    ));
                }
            }
        }
        Ok(())
    }
}

impl<'t> RecordedFrame<'t> {
    /// A cell, empty behind the end of the line.
    fn cell(&self, at: usize) -> CellValue<'t> {
        self.cells.get(at).copied().unwrap_or(CellValue::Empty)
    }

    /// Numbers in columns; `None` if one is none.
    pub(crate) fn numbers<const N: usize>(&self, columns: [usize; N]) -> Option<[f64; N]> {
        let mut found = [0.0; N];
        for (found, at) in found.iter_mut().zip(columns) {
            *found = self.cell(at).number()?;
        }
        Some(found)
    }

    /// Position of a body; `None` if it was not seen: cells that are empty, or all zero.
    fn position(&self, body: &RecordedBody) -> Option<[f64; 3]> {
        self.numbers(body.position).filter(|it| *it != [0.0; 3])
    }
}

/// Cells of a line without quotes; empty ones at the end count.
pub(crate) fn cells(line: &str, separator: char) -> Vec<&str> {
    line.split(separator).map(|it| it.trim().trim_matches('"')).collect()
}
