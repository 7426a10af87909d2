//! Takes that Motive (OptiTrack) exported as CSV, versions 1.2 to 1.25: by the labels of their head, never by counting lines.

use super::bodies::{RecordedBody, RecordedFrames, cells};
use super::made_table::{FileLine, MadeTable, Refusal};
use super::words::{lines, number};
use super::{FileForm, OpeningContext};

pub(crate) const FORM: FileForm = FileForm { title: "a take of Motive", is_it, table };

/// Units of positions, with their symbols and sizes in metres.
const UNITS: [(&str, (&str, f64)); 3] =
    [("Meters", ("m", 1.0)), ("Centimeters", ("cm", 1e-2)), ("Millimeters", ("mm", 1e-3))];

/// Beginning of the names of markers without a label.
const UNNAMED: &str = "Unlabeled";

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    lines(text).next().is_some_and(|(_, line)| {
        let line = line.trim_start_matches('"');
        line.starts_with("Format Version") && line.contains("Frame Rate")
    })
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

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let (_, head) = lines(text).next().ok_or("found no line")?;
    if let Some(other) = [';', '\t'].into_iter().find(|it| !head.contains(',') && head.contains(*it)) {
        let what = if other == ';' { "`;`" } else { "tabs" };
        return FileLine(1).refuse(format!(
            "found {what} between the cells of a take of Motive, expected commas, which Motive writes: export the take again"
        ));
    }
    let head = cells(head, ',');
    let value = |key: &str| {
        let at = head.iter().position(|it| *it == key)?;
        head.get(at + 1).copied()
    };
    let Some(stated) = value("Length Units") else {
        return FileLine(1).refuse(
            "found no `Length Units` in the head of a take of Motive, expected Meters, Centimeters or Millimeters",
        );
    };
    let Some((_, unit)) = UNITS.iter().find(|it| it.0.eq_ignore_ascii_case(stated)) else {
        return FileLine(1)
            .refuse(format!("found the length unit `{stated}`, expected Meters, Centimeters or Millimeters"));
    };
    let labels = Labels::from_text(text)?;
    let (bodies, unnamed) = labels.bodies(value("Rotation Type").unwrap_or("Quaternion"))?;
    let is_time = |it: &&str| it.starts_with("Time") && !it.starts_with("TimeCode");
    let Some(time) = labels.axes.iter().position(is_time) else {
        return FileLine(labels.line).refuse("found no column `Time`, expected the time of each frame in seconds");
    };
    let frames = RecordedFrames::from_lines(text, (labels.line, *unit), ',', |cells, _, _| labels.time(cells, time))?;
    let are_unnamed = bodies.iter().all(|it| it.name.starts_with(UNNAMED));
    let frames = RecordedFrames { unnamed, are_unnamed, ..frames };
    let mut made = frames.table(&bodies, "body or marker", opening)?;
    let stated: Option<usize> = value("Total Exported Frames").and_then(|it| it.parse().ok());
    if let Some(stated) = stated.filter(|it| *it != frames.all.len()) {
        made.say(format!("its head states {stated} frames, and it has {}", frames.all.len()));
    }
    Ok(made)
}

impl<'t> Labels<'t> {
    fn from_text(text: &'t str) -> Result<Self, Refusal> {
        let mut found: Vec<Vec<&str>> = Vec::new();
        for (line, content) in lines(text).skip(1).take(12) {
            let axes = cells(content, ',');
            if axes.first() == Some(&"Frame") {
                let with = |words: &[&str]| found.iter().position(|row| row.iter().any(|it| words.contains(it)));
                let types = with(&["Rigid Body", "Marker", "Rigid Body Marker", "Bone"]);
                let (Some(types), Some(kinds)) = (types, with(&["Position", "Rotation"])) else { break };
                // The names are below the types.
                let [types, names, kinds] =
                    [types, types + 1, kinds].map(|at| found.get(at).cloned().unwrap_or_default());
                return Ok(Labels { types, names, kinds, axes, line });
            }
            found.push(axes);
        }
        Refusal::refuse_whole(
            "found the head of a take of Motive without the lines that name bodies, Rotation and Position and begin with `Frame`, expected them: export \
             the take with its header",
        )
    }

    /// The time of a row, seconds.
    fn time(&self, cells: &[&str], column: usize) -> Result<Option<f64>, String> {
        let (found, width) = (cells.len(), self.axes.len());
        let is_longer = cells.get(width..).is_some_and(|it| it.iter().any(|it| !it.is_empty()));
        if is_longer || !self.may_end(found) {
            return Err(format!("found {found} cells, expected {width} as in the head"));
        }
        let text = cells.get(column).copied().unwrap_or_default();
        let none = || format!("found `{text}` as the time of a frame, expected seconds");
        number(text).map(Some).ok_or_else(none)
    }

    /// True if a row may have so many cells: Motive leaves out those at the end for bodies and markers that it did not see.
    fn may_end(&self, count: usize) -> bool {
        let of = |at: usize| (self.types.get(at), self.names.get(at));
        count >= self.axes.len() || count > 0 && of(count) != of(count - 1)
    }

    /// The column of an axis, by the name and the type of its body or marker.
    fn column(&self, name: &str, of: &str, kind: &str, axis: &str) -> Option<usize> {
        (0..self.axes.len()).find(|&at| {
            let is = |row: &[&str], word: &str| row.get(at).is_some_and(|it| *it == word);
            is(&self.types, of) && is(&self.names, name) && is(&self.kinds, kind) && is(&self.axes, axis)
        })
    }

    /// The names of one type, each once.
    fn names(&self, of: &str) -> Vec<&'t str> {
        let mut names: Vec<&str> = Vec::new();
        for (kind, name) in self.types.iter().zip(&self.names) {
            if *kind == of && !names.contains(name) {
                names.push(name);
            }
        }
        names
    }

    /// Bodies with poses; or, if there are none, markers with names and markers without.
    fn bodies(&self, rotation: &str) -> Result<(Vec<RecordedBody>, Vec<RecordedBody>), Refusal> {
        let body = |name: &str, of: &str| -> Option<RecordedBody> {
            let at = |kind, axis| self.column(name, of, kind, axis);
            let position = [at("Position", "X")?, at("Position", "Y")?, at("Position", "Z")?];
            let [x, y, z, w] = ["X", "Y", "Z", "W"].map(|axis| at("Rotation", axis));
            let quaternion = x.zip(y).zip(z.zip(w)).map(|((x, y), (z, w))| [x, y, z, w]);
            Some(RecordedBody { name: name.to_owned(), position, quaternion })
        };
        let of =
            |of: &str| -> Vec<RecordedBody> { self.names(of).into_iter().filter_map(|name| body(name, of)).collect() };
        let bodies = of("Rigid Body");
        if bodies.iter().any(|it| it.quaternion.is_none()) && !rotation.eq_ignore_ascii_case("quaternion") {
            return FileLine(1).refuse(format!(
                "found the rotation type `{rotation}`, expected Quaternion: export the take with quaternions"
            ));
        }
        if !bodies.is_empty() {
            return Ok((bodies, Vec::new()));
        }
        // Markers without a label have another number each time they reappear.
        let markers = of("Marker").into_iter().map(|it| RecordedBody { quaternion: None, ..it });
        let (unnamed, named): (Vec<RecordedBody>, Vec<RecordedBody>) =
            markers.partition(|it| it.name.starts_with(UNNAMED));
        match (named.is_empty(), unnamed.is_empty()) {
            (false, _) => Ok((named, unnamed)),
            // Markers without a label that are present from the beginning, if their distances form a rigid body.
            (true, false) => Ok((unnamed, named)),
            (true, true) => FileLine(self.line)
                .refuse("found neither a rigid body nor a marker with a name, expected one on the robot"),
        }
    }
}
