//! What a recorder saw at each time: bodies with poses, or markers.

use nalgebra::Vector3;

use super::Opening;
use super::maker::{Made, Refused, Value};
use super::rigid::{self, Places, Renamed};
use super::words::{number, quoted};
use poecal_numerics::error::{first_few, shown};

/// A body or a marker that moved less than this, metres, stands.
const MOVED_M: f64 = 0.02;
/// One that moved less than this share of what moved farthest stands too: its noise is in another unit than is stated.
const MOVED: f64 = 0.05;
/// Share of the frames at either end of a coordinate that do not say how far something moved, as of a body that was taken for another.
const STRAYED: f64 = 0.01;

/// Of things that moved so far, metres, whether each moves.
pub(crate) fn which_move(moved_m: &[f64]) -> Vec<bool> {
    let farthest = moved_m.iter().copied().fold(0.0, f64::max);
    moved_m.iter().map(|it| *it > MOVED_M.max(MOVED * farthest)).collect()
}

/// How far something moved: the widest of its coordinates, but for some frames that strayed.
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
pub(crate) struct Body {
    pub(crate) name: String,
    /// Columns of x, y, z.
    pub(crate) position: [usize; 3],
    /// Columns of qx, qy, qz, qw.
    pub(crate) quaternion: Option<[usize; 4]>,
}

/// Frames of a recorder: cells by line.
pub(crate) struct Frames<'t> {
    pub(crate) rows: Vec<(usize, Vec<&'t str>)>,
    /// Time of each row, seconds.
    pub(crate) times: Vec<Option<f64>>,
    /// Unit of positions, with its size in metres.
    pub(crate) unit: (&'static str, f64),
    /// The line that names the columns.
    pub(crate) header: usize,
    /// Markers without a name, whose places may be those of others.
    pub(crate) unnamed: Vec<Body>,
    /// Whether no marker has a name.
    pub(crate) are_unnamed: bool,
}

impl<'t> Frames<'t> {
    /// No frames yet.
    pub(crate) fn of(unit: (&'static str, f64), header: usize) -> Self {
        Frames { rows: Vec::new(), times: Vec::new(), unit, header, unnamed: Vec::new(), are_unnamed: false }
    }

    /// The table of the body that moves; of several, of the one that was asked for.
    pub(crate) fn table(&self, bodies: &[Body], what: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
        if self.rows.is_empty() {
            return Refused::at(
                self.header,
                "found the names of columns and no frame, expected at least one",
            );
        }
        let (taken, left) = self.taken(bodies, what, opening)?;
        for it in taken.iter().copied().chain(&self.unnamed) {
            let columns: Vec<usize> =
                it.position.iter().chain(it.quaternion.iter().flatten()).copied().collect();
            self.refuse_words(&it.name, &columns)?;
        }
        let has_several = taken.len() > 1;
        let is_posed = taken.iter().any(|it| it.quaternion.is_some());
        let unit = self.unit.0;
        let columns = columns_of_bodies(has_several, is_posed, unit);
        let mut made = Made::new(self.header, columns.iter().map(String::as_str));
        let renamed = if is_posed { None } else { self.renamed(&taken) };
        let places: Vec<&Body> = taken.iter().copied().chain(&self.unnamed).collect();
        let given: Vec<(usize, &Body)> = taken.iter().copied().enumerate().collect();
        let given = self.named(given, renamed.as_ref())?;
        for (frame, ((line, cells), time)) in self.rows.iter().zip(&self.times).enumerate() {
            for &(at, named) in &given {
                let of = |at: usize| Value::Text(cells.get(at).copied().unwrap_or_default());
                let place = renamed.as_ref().map_or(Some(at), |it| it.place_of(frame, at));
                let place = place.and_then(|at| places.get(at).copied());
                let is_seen = place.is_some_and(|it| self.position(cells, it).is_some());
                let body = place.unwrap_or(named);
                let mut row = vec![time.map_or(Value::Empty, Value::Number)];
                if has_several {
                    row.push(Value::Text(&named.name));
                }
                let parts = body.position.iter().chain(body.quaternion.iter().flatten());
                row.extend(parts.map(|&at| if is_seen { of(at) } else { Value::Empty }));
                made.row(*line, row);
            }
        }
        let names: Vec<String> = given.iter().map(|it| format!("`{}`", it.1.name)).collect();
        made.sources = (columns.iter().skip(if has_several { 2 } else { 1 }))
            .map(|it| {
                (it.clone(), format!("{} of {}", it.split('[').next().unwrap_or_default(), first_few(&names)))
            })
            .collect();
        let count = self.rows.len();
        made.said.push(format!("{count} frames of {}, {unit}", names.join(", ")));
        if !left.is_empty() {
            made.said.push(format!("left out {}", quoted(left)));
        }
        if let Some(renamed) = renamed {
            self.say_renamed(&mut made, &renamed, &taken);
        }
        Ok(made)
    }

    /// Of markers without names those that make a body.
    fn named<'b>(
        &self,
        given: Vec<(usize, &'b Body)>,
        renamed: Option<&Renamed>,
    ) -> Result<Vec<(usize, &'b Body)>, Refused> {
        Ok(match (renamed, self.are_unnamed) {
            (_, false) => given,
            (Some(renamed), true) => given.into_iter().filter(|it| renamed.markers.contains(&it.0)).collect(),
            (None, true) => {
                return Refused::at(
                    self.header,
                    "found no marker with a name, and no three that keep their distances, expected a rigid body, or markers with names, on the robot",
                );
            }
        })
    }

    /// Says which markers changed their names.
    fn say_renamed(&self, made: &mut Made, renamed: &Renamed, taken: &[&Body]) {
        let names: Vec<&str> = taken.iter().map(|it| it.name.as_str()).collect();
        let lines: Vec<usize> = self.rows.iter().map(|it| it.0).collect();
        let is_seen = |frame: usize, column: usize| {
            let place = taken.get(column).zip(self.rows.get(frame));
            place.is_some_and(|(body, row)| self.position(&row.1, body).is_some())
        };
        let (said, warned) = renamed.words(&names, &lines, is_seen);
        made.said.extend(said);
        made.warned.extend(warned);
    }

    /// What the distances between markers show of their names; `None` if they show nothing.
    fn renamed(&self, taken: &[&Body]) -> Option<Renamed> {
        if taken.len() < rigid::FEWEST {
            return None;
        }
        let all: Vec<&Body> = taken.iter().copied().chain(&self.unnamed).collect();
        let places = |(_, cells): &(usize, Vec<&str>)| -> Places {
            let place = |it: &&Body| self.position(cells, it).map(|it| Vector3::from(it) * self.unit.1);
            all.iter().map(place).collect()
        };
        let frames: Vec<Places> = self.rows.iter().map(places).collect();
        let columns: Vec<usize> = (0..taken.len()).collect();
        let others: Vec<usize> = (if self.are_unnamed { 0 } else { taken.len() }..all.len()).collect();
        Renamed::of(&frames, &columns, &others)
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
            let moved: Vec<f64> = some.iter().map(|it| self.moved_m(it)).collect();
            some.iter().zip(which_move(&moved)).filter(|it| it.1).map(|it| *it.0).collect()
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
        let places: Vec<[f64; 3]> =
            self.rows.iter().filter_map(|(_, cells)| self.position(cells, body)).collect();
        moved_m(&places) * self.unit.1
    }

    /// Refuses a cell of a body that is neither empty nor a number: it is no lost frame.
    pub(crate) fn refuse_words(&self, body: &str, columns: &[usize]) -> Result<(), Refused> {
        for (line, cells) in &self.rows {
            let own = columns.iter().filter_map(|at| cells.get(*at));
            if let Some(word) = own.copied().find(|it| !it.is_empty() && number(it).is_none()) {
                return Refused::at(
                    *line,
                    format!(
                        "found `{}` in a column of `{}`, expected a number: leave the cell empty where it was not seen",
                        shown(word),
                        shown(body)
                    ),
                );
            }
        }
        Ok(())
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

/// The columns of the table of bodies.
fn columns_of_bodies(has_several: bool, is_posed: bool, unit: &str) -> Vec<String> {
    let mut columns = vec!["time[s]".to_owned()];
    if has_several {
        columns.push("target".to_owned());
    }
    columns.extend(["x", "y", "z"].map(|it| format!("{it}[{unit}]")));
    if is_posed {
        columns.extend(["qx", "qy", "qz", "qw"].map(str::to_owned));
    }
    columns
}
