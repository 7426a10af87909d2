//! Takes that Motive (OptiTrack) exported as CSV, versions 1.2 to 1.25: by the labels of their head, never by counting lines.

use super::bodies::{Body, Frames};
use super::maker::{Made, Refused};
use super::words::lines;
use super::{Form, Opening};

pub(crate) const FORM: Form = Form { title: "a take of Motive", is_it, table };

/// Units of positions, with their symbols and sizes in metres.
const UNITS: [(&str, (&str, f64)); 3] =
    [("Meters", ("m", 1.0)), ("Centimeters", ("cm", 1e-2)), ("Millimeters", ("mm", 1e-3))];

/// How the names of markers without a label begin.
const UNNAMED: &str = "Unlabeled";

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    lines(text).next().is_some_and(|(_, line)| {
        let line = line.trim_start_matches('"');
        line.starts_with("Format Version") && line.contains("Frame Rate")
    })
}

/// Cells of a line; empty ones at the end count.
fn cells(line: &str) -> Vec<&str> {
    line.split(',').map(|it| it.trim().trim_matches('"')).collect()
}

/// The labels of the columns.
struct Labels<'t> {
    types: Vec<&'t str>,
    names: Vec<&'t str>,
    kinds: Vec<&'t str>,
    axes: Vec<&'t str>,
    /// The line of the axes.
    line: usize,
}

fn table(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let Some((_, head)) = lines(text).next() else { return Refused::whole("found no line") };
    if let Some(other) = [';', '\t'].into_iter().find(|it| !head.contains(',') && head.contains(*it)) {
        let what = if other == ';' { "`;`" } else { "tabs" };
        return Refused::at(
            1,
            format!(
                "found {what} between the cells of a take of Motive, expected commas, which Motive writes: export the take again"
            ),
        );
    }
    let head = cells(head);
    let value = |key: &str| {
        let at = head.iter().position(|it| *it == key)?;
        head.get(at + 1).copied()
    };
    let Some(stated) = value("Length Units") else {
        return Refused::at(
            1,
            "found no `Length Units` in the head of a take of Motive, expected Meters, Centimeters or Millimeters",
        );
    };
    let Some((_, unit)) = UNITS.iter().find(|it| it.0.eq_ignore_ascii_case(stated)) else {
        return Refused::at(
            1,
            format!("found the length unit `{stated}`, expected Meters, Centimeters or Millimeters"),
        );
    };
    let rotation = value("Rotation Type").unwrap_or("Quaternion");
    let labels = Labels::of(text)?;
    let (bodies, unnamed) = labels.bodies(rotation)?;
    let time = labels.axes.iter().position(|it| it.starts_with("Time") && !it.starts_with("TimeCode"));
    let Some(time) = time else {
        return Refused::at(
            labels.line,
            "found no column `Time`, expected the time of each frame in seconds",
        );
    };
    let (rows, times) = take_frames(text, &labels, time)?;
    let are_unnamed = bodies.iter().all(|it| it.name.starts_with(UNNAMED));
    let frames = Frames { rows, times, unnamed, are_unnamed, ..Frames::of(*unit, labels.line) };
    let mut made = frames.table(&bodies, "body or marker", opening)?;
    let stated: Option<usize> = value("Total Exported Frames").and_then(|it| it.parse().ok());
    if let Some(stated) = stated.filter(|it| *it != frames.rows.len()) {
        made.said.push(format!("its head says {stated} frames, and it has {}", frames.rows.len()));
    }
    Ok(made)
}

/// Lines with their cells, and the time of each.
type TimedRows<'t> = (Vec<(usize, Vec<&'t str>)>, Vec<Option<f64>>);

/// Takes the rows of a take, with times of a column.
fn take_frames<'t>(text: &'t str, labels: &Labels<'_>, time: usize) -> Result<TimedRows<'t>, Refused> {
    let width = labels.axes.len();
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    for (line, content) in lines(text).filter(|it| it.0 > labels.line) {
        let found = cells(content);
        let is_longer = found.get(width..).is_some_and(|it| it.iter().any(|it| !it.is_empty()));
        if is_longer || !labels.may_end(found.len()) {
            return Refused::at(
                line,
                format!("found {} cells, expected {width} as in the head", found.len()),
            );
        }
        let Some(at) = found.get(time).and_then(|it| super::words::number(it)) else {
            return Refused::at(
                line,
                format!(
                    "found `{}` as the time of a frame, expected seconds",
                    found.get(time).copied().unwrap_or_default()
                ),
            );
        };
        times.push(Some(at));
        rows.push((line, found));
    }
    Ok((rows, times))
}

impl<'t> Labels<'t> {
    fn of(text: &'t str) -> Result<Self, Refused> {
        let mut found: Vec<Vec<&str>> = Vec::new();
        for (line, content) in lines(text).skip(1).take(12) {
            let cells = cells(content);
            if cells.first() == Some(&"Frame") {
                let is = |words: &'static [&'static str]| {
                    move |row: &&Vec<&'t str>| row.iter().any(|it| words.contains(it))
                };
                let of = |words| found.iter().find(is(words)).cloned();
                let types = of(&["Rigid Body", "Marker", "Rigid Body Marker", "Bone"]);
                let kinds = of(&["Position", "Rotation"]);
                let (Some(types), Some(kinds)) = (types, kinds) else { break };
                // The names are below the types.
                let at = found.iter().position(|it| *it == types).unwrap_or_default();
                let names = found.get(at + 1).cloned().unwrap_or_default();
                return Ok(Labels { types, names, kinds, axes: cells, line });
            }
            found.push(cells);
        }
        Refused::whole(
            "found the head of a take of Motive without the lines that name bodies, Rotation and Position and begin with `Frame`, expected them: export \
             the take with its header",
        )
    }

    /// Whether a row may have so many cells: Motive leaves out those of bodies and markers that it did not see at the end.
    fn may_end(&self, count: usize) -> bool {
        let of = |at: usize| (self.types.get(at), self.names.get(at));
        count >= self.axes.len() || count > 0 && of(count) != of(count - 1)
    }

    /// The column of an axis of what has a name and a type.
    fn column(&self, name: &str, of: &str, kind: &str, axis: &str) -> Option<usize> {
        (0..self.axes.len()).find(|&at| {
            let is = |row: &[&str], word: &str| row.get(at).is_some_and(|it| *it == word);
            is(&self.types, of) && is(&self.names, name) && is(&self.kinds, kind) && is(&self.axes, axis)
        })
    }

    /// Bodies with poses, or without them markers that have names, and those that have none.
    fn bodies(&self, rotation: &str) -> Result<(Vec<Body>, Vec<Body>), Refused> {
        let names = |of: &str| {
            let mut names: Vec<&str> = Vec::new();
            for (kind, name) in self.types.iter().zip(&self.names) {
                if *kind == of && !names.contains(name) {
                    names.push(name);
                }
            }
            names
        };
        let position = |name: &str, of: &str| -> Option<[usize; 3]> {
            let of = |axis| self.column(name, of, "Position", axis);
            Some([of("X")?, of("Y")?, of("Z")?])
        };
        let mut bodies = Vec::new();
        for name in names("Rigid Body") {
            let of = |axis| self.column(name, "Rigid Body", "Rotation", axis);
            let parts = [of("X"), of("Y"), of("Z"), of("W")];
            let Some(position) = position(name, "Rigid Body") else { continue };
            let quaternion = match parts {
                [Some(x), Some(y), Some(z), Some(w)] => Some([x, y, z, w]),
                _ if rotation.eq_ignore_ascii_case("quaternion") => None,
                _ => {
                    return Refused::at(
                        1,
                        format!(
                            "found the rotation type `{rotation}`, expected Quaternion: export the take with quaternions"
                        ),
                    );
                }
            };
            bodies.push(Body { name: name.to_owned(), position, quaternion });
        }
        if !bodies.is_empty() {
            return Ok((bodies, Vec::new()));
        }
        // Those without a label have another number each time they come back.
        let mut unnamed = Vec::new();
        for name in names("Marker") {
            let Some(position) = position(name, "Marker") else { continue };
            let list = if name.starts_with(UNNAMED) { &mut unnamed } else { &mut bodies };
            list.push(Body { name: name.to_owned(), position, quaternion: None });
        }
        if bodies.is_empty() {
            // Those that are there from the beginning on, if their distances make a body of them.
            std::mem::swap(&mut bodies, &mut unnamed);
        }
        if bodies.is_empty() {
            return Refused::at(
                self.line,
                "found neither a rigid body nor a marker with a name, expected one on the robot",
            );
        }
        Ok((bodies, unnamed))
    }
}
