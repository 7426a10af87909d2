//! Exports of Vicon (Nexus, Tracker) as CSV: segments with rotation vectors, or trajectories of markers, below a head of five lines.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};

use super::bodies::{RecordedBody, RecordedFrames, cells};
use super::made_table::{CellValue, FileLine, MadeTable, Refusal};
use super::words::{lines, number, quote_names};
use super::{FileForm, OpeningContext};

pub(crate) const FORM: FileForm = FileForm { title: "an export of Vicon", is_it, table };

/// Names of parts of an export that are read, first those with poses.
const PARTS: [&str; 3] = ["Segments", "Objects", "Trajectories"];
/// Units of positions, with their sizes in metres.
const UNITS: [(&str, f64); 3] = [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)];

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    head(text).is_some()
}

fn is_part(line: &str, part: &str) -> bool {
    line.trim_start_matches('\u{feff}').split(',').next().is_some_and(|it| it.trim() == part)
}

/// The first line of the part that is read, and the line behind its last.
fn part(text: &str) -> Option<(usize, usize)> {
    let all: Vec<&str> = text.lines().collect();
    let first = PARTS.iter().find_map(|part| all.iter().position(|line| is_part(line, part)))?;
    let is_blank = |line: &&str| line.split(',').all(|it| it.trim().is_empty());
    let last = all.iter().skip(first).position(is_blank).map_or(all.len(), |it| first + it);
    Some((first + 1, last + 1))
}

/// The lines of a head.
struct ViconHead<'t> {
    rate_hz: f64,
    names: Vec<&'t str>,
    columns: Vec<&'t str>,
    units: Vec<&'t str>,
    /// The line of the columns' names, and the one behind the last frame.
    line: usize,
    end: usize,
}

fn head(text: &str) -> Option<ViconHead<'_>> {
    let (first, end) = part(text)?;
    let mut own = lines(text).filter(|it| it.0 > first).map(|it| (it.0, cells(it.1, ',')));
    let rate_hz = number(own.next()?.1.first()?)?;
    let (names, (line, columns), units) = (own.next()?.1, own.next()?, own.next()?.1);
    let is_head = columns.first() == Some(&"Frame") && columns.len() > 4 && rate_hz > 0.0;
    is_head.then_some(ViconHead { rate_hz, names, columns, units, line, end })
}

impl ViconHead<'_> {
    /// The one unit of all these columns.
    fn unit(&self, columns: impl Iterator<Item = usize>, of: &str) -> Result<Option<&str>, Refusal> {
        let unit = |at: usize| self.units.get(at).copied().unwrap_or_default();
        let units: BTreeSet<&str> = columns.map(unit).collect();
        if units.len() > 1 {
            let units = quote_names(units);
            return FileLine(self.line + 1)
                .refuse(format!("found the units {units} of {of}, expected the same for all"));
        }
        Ok(units.first().copied())
    }

    /// Bodies or markers: each begins at the column with its name.
    fn bodies(&self) -> Vec<(RecordedBody, Option<Vec<usize>>)> {
        let starts: Vec<usize> =
            (0..self.columns.len()).filter(|at| self.names.get(*at).is_some_and(|it| !it.is_empty())).collect();
        let ends = starts.iter().skip(1).copied().chain([self.columns.len()]);
        let body = |(start, end): (usize, usize)| {
            let at = |names: &[&str]| -> Option<Vec<usize>> {
                let at = |name: &&str| (start..end).find(|at| self.columns.get(*at) == Some(name));
                names.iter().map(at).collect()
            };
            let place = at(&["TX", "TY", "TZ"]).or_else(|| at(&["X", "Y", "Z"]))?;
            let [x, y, z] = place.try_into().ok()?;
            let quaternion = at(&["RX", "RY", "RZ", "RW"]).and_then(|it| it.try_into().ok());
            let turn = at(&["RX", "RY", "RZ"]).filter(|_| quaternion.is_none());
            let name = self.names.get(start).copied().unwrap_or_default().to_owned();
            Some((RecordedBody { name, position: [x, y, z], quaternion }, turn))
        };
        starts.iter().copied().zip(ends).filter_map(body).collect()
    }
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let head = head(text).ok_or("found no head of Vicon")?;
    let found = head.bodies();
    if found.is_empty() {
        return FileLine(head.line).refuse(
            "found no columns TX, TY, TZ or X, Y, Z below the names of Vicon's segments or markers, expected them",
        );
    }
    let length = head.unit(found.iter().flat_map(|it| it.0.position), "positions")?.unwrap_or_default();
    let Some(unit) = UNITS.into_iter().find(|it| it.0 == length) else {
        return FileLine(head.line + 1).refuse(format!("found the unit `{length}` of positions, expected mm, cm or m"));
    };
    let angle = head.unit(found.iter().filter_map(|it| it.1.as_ref()).flatten().copied(), "rotations")?;
    let to_rad = match angle {
        None | Some("rad") => 1.0,
        Some("deg") => 1.0_f64.to_radians(),
        Some(other) => {
            return FileLine(head.line + 1)
                .refuse(format!("found the unit `{other}` of rotations, expected rad or deg"));
        }
    };
    let (expected, rate_hz) = (head.columns.len(), head.rate_hz);
    let own: usize = text.split_inclusive('\n').take(head.end - 1).map(str::len).sum();
    let mut frames =
        RecordedFrames::from_lines(text.get(..own).unwrap_or(text), (head.line + 1, unit), ',', |cells, count, _| {
            if cells.len() > expected {
                return Err(format!("found {} cells, expected {expected} as in the head", cells.len()));
            }
            let frame = cells.first().copied().and_then(number).unwrap_or(count as f64 + 1.0);
            Ok(Some((frame - 1.0) / rate_hz))
        })?;
    let mut bodies: Vec<RecordedBody> = Vec::with_capacity(found.len());
    let mut width = expected;
    for (mut body, turn) in found {
        if let Some(columns) = turn.and_then(|it| <[usize; 3]>::try_from(it).ok()) {
            frames.refuse_words(&body.name, &columns)?;
            for frame in &mut frames.all {
                let vector = frame.numbers(columns).map(|it| Vector3::from(it) * to_rad);
                frame.cells.resize(width, CellValue::Empty);
                let turned = vector.map(|it| Pose::new(rotation::exp(&it), Vector3::zeros()).quaternion_xyzw());
                frame.cells.extend(turned.map_or([CellValue::Empty; 4], |it| it.map(CellValue::Number)));
            }
            body.quaternion = Some([0, 1, 2, 3].map(|part| width + part));
            width += 4;
        }
        bodies.push(body);
    }
    let mut made = frames.table(&bodies, "segment or marker", opening)?;
    let has = |part: &&&str| text.lines().any(|line| is_part(line, part));
    let parts: Vec<&str> = PARTS.iter().filter(has).copied().collect();
    if let [read, left @ ..] = parts.as_slice()
        && !left.is_empty()
    {
        made.say(format!("read {read}, left out {}", left.join(", ")));
    }
    if let Some(angle) = angle {
        made.say(format!("rotations as rotation vectors (helical) in {angle}"));
    }
    Ok(made)
}
