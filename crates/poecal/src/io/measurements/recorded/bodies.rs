//! What a recorder saw at each time: bodies with poses, or markers.

use super::Opening;
use super::maker::{Made, Refused, Value};
use super::words::{number, quoted};

/// A body or a marker that moved less than this, metres, stands.
pub(super) const MOVED_M: f64 = 0.02;

/// Where something was: of each coordinate the smallest and the largest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent([(f64, f64); 3]);

impl Extent {
    /// Of nothing.
    pub(super) const NONE: Self = Extent([(f64::INFINITY, f64::NEG_INFINITY); 3]);

    /// Adds a place.
    pub(super) fn include(&mut self, place: [f64; 3]) {
        for (range, value) in self.0.iter_mut().zip(place) {
            *range = (range.0.min(value), range.1.max(value));
        }
    }

    /// The widest of its coordinates; 0 of nothing.
    pub(super) fn widest(&self) -> f64 {
        self.0.iter().map(|it| it.1 - it.0).filter(|it| it.is_finite()).fold(0.0, f64::max)
    }
}

/// One body, or one marker.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    pub(super) name: String,
    /// Columns of x, y, z.
    pub(super) position: [usize; 3],
    /// Columns of qx, qy, qz, qw.
    pub(super) quaternion: Option<[usize; 4]>,
}

/// Frames of a recorder: cells by line.
pub(super) struct Frames<'t> {
    pub(super) rows: Vec<(usize, Vec<&'t str>)>,
    /// Time of each row, seconds.
    pub(super) times: Vec<Option<f64>>,
    /// Unit of positions, with its size in metres.
    pub(super) unit: (&'static str, f64),
    /// The line that names the columns.
    pub(super) header: usize,
}

impl Frames<'_> {
    /// The table of the body that moves; of several, of the one that was asked for.
    pub(super) fn table(&self, bodies: &[Body], what: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
        let (taken, left) = self.taken(bodies, what, opening)?;
        let has_several = taken.len() > 1;
        let is_posed = taken.iter().any(|it| it.quaternion.is_some());
        let unit = self.unit.0;
        let mut columns = vec!["time[s]".to_owned()];
        if has_several {
            columns.push("target".to_owned());
        }
        columns.extend(["x", "y", "z"].map(|it| format!("{it}[{unit}]")));
        if is_posed {
            columns.extend(["qx", "qy", "qz", "qw"].map(str::to_owned));
        }
        let mut made = Made::new(self.header, columns.iter().map(String::as_str));
        for ((line, cells), time) in self.rows.iter().zip(&self.times) {
            for body in &taken {
                let of = |at: usize| Value::Text(cells.get(at).copied().unwrap_or_default());
                let is_seen = self.position(cells, body).is_some();
                let mut row = vec![time.map_or(Value::Empty, Value::Number)];
                if has_several {
                    row.push(Value::Text(&body.name));
                }
                let parts = body.position.iter().chain(body.quaternion.iter().flatten());
                row.extend(parts.map(|&at| if is_seen { of(at) } else { Value::Empty }));
                made.row(*line, row);
            }
        }
        let names: Vec<String> = taken.iter().map(|it| format!("`{}`", it.name)).collect();
        let count = self.rows.len();
        made.said.push(format!("{count} frames of {}, {unit}", names.join(", ")));
        if !left.is_empty() {
            made.said.push(format!("left out {}", quoted(left)));
        }
        Ok(made)
    }

    /// The bodies to take, and the names of the others.
    fn taken<'b>(
        &self,
        bodies: &'b [Body],
        what: &str,
        opening: &Opening<'_>,
    ) -> Result<(Vec<&'b Body>, Vec<&'b str>), Refused> {
        let names = |some: &[&Body]| quoted(some.iter().map(|it| it.name.as_str()));
        let all: Vec<&Body> = bodies.iter().collect();
        let posed: Vec<&Body> = all.iter().filter(|it| it.quaternion.is_some()).copied().collect();
        if let Some(wanted) = &opening.options.body {
            let found: Vec<&Body> = all.iter().filter(|it| it.name == *wanted).copied().collect();
            if found.is_empty() {
                return Refused::whole(format!(
                    "found no {what} `{wanted}`, expected one of {}",
                    names(&all)
                ));
            }
            return Ok((found, others(bodies, |it| it.name == *wanted)));
        }
        let moving = |some: &[&'b Body]| -> Vec<&'b Body> {
            some.iter().filter(|it| self.moved_m(it) > MOVED_M).copied().collect()
        };
        let of_poses = moving(&posed);
        let taken = match of_poses.as_slice() {
            [one] => vec![*one],
            [] if posed.len() == 1 => posed,
            [] if posed.is_empty() => moving(&all),
            [] => {
                return Refused::whole(format!(
                    "found {} that all stand, expected one that moves with the robot: name it by --body",
                    names(&posed)
                ));
            }
            several => {
                return Refused::whole(format!(
                    "found {} bodies that move, {}, expected one: name the one on the robot by --body",
                    several.len(),
                    names(several)
                ));
            }
        };
        if taken.is_empty() {
            return Refused::whole(format!("found no {what} that moves, expected one on the robot"));
        }
        let is_taken = |it: &Body| taken.iter().any(|taken| std::ptr::eq(*taken, it));
        let left = others(bodies, is_taken);
        Ok((taken, left))
    }

    /// How far a body moved, metres.
    fn moved_m(&self, body: &Body) -> f64 {
        let mut extent = Extent::NONE;
        let places = self.rows.iter().filter_map(|(_, cells)| self.position(cells, body));
        places.for_each(|it| extent.include(it));
        extent.widest() * self.unit.1
    }

    /// Where a body is in a frame; `None` where it was not seen: cells that are empty, or all zero.
    fn position(&self, cells: &[&str], body: &Body) -> Option<[f64; 3]> {
        let mut found = [0.0; 3];
        for (found, at) in found.iter_mut().zip(body.position) {
            *found = cells.get(at).and_then(|it| number(it))?;
        }
        (found != [0.0; 3]).then_some(found)
    }
}

/// Names of the bodies that are not taken.
fn others(bodies: &[Body], is_taken: impl Fn(&Body) -> bool) -> Vec<&str> {
    bodies.iter().filter(|it| !is_taken(it)).map(|it| it.name.as_str()).collect()
}
