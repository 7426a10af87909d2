//! Files that Qualisys Track Manager exported as TSV: bodies (6D) or markers (3D), in millimetres.

use super::bodies::{Body, Frames};
use super::maker::{Made, Refused};
use super::words::{lines, number};
use super::{Form, Opening};
use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, rotation};

pub(crate) const FORM: Form = Form { title: "an export of Qualisys Track Manager", is_it, table };

/// Largest difference of the matrix and the angles, which have two to five digits, radians.
const AGREE_RAD: f64 = 0.01;

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    lines(text).next().is_some_and(|it| it.1.starts_with("NO_OF_FRAMES"))
}

/// What is in the columns of a row.
#[derive(Clone, Copy)]
struct Columns {
    frame: Option<usize>,
    time: Option<usize>,
    line: usize,
}

fn cells(line: &str) -> Vec<&str> {
    line.split('\t').map(str::trim).collect()
}

fn table(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let value = |key: &str| {
        let line = lines(text).take(20).find(|it| cells(it.1).first() == Some(&key))?;
        Some(cells(line.1).into_iter().skip(1).filter(|it| !it.is_empty()).collect::<Vec<_>>())
    };
    let frequency = value("FREQUENCY").and_then(|it| number(it.first()?));
    let is_posed = value("DATA_INCLUDED").is_some_and(|it| it.first() == Some(&"6D"));
    let names = value(if is_posed { "BODY_NAMES" } else { "MARKER_NAMES" }).unwrap_or_default();
    if names.is_empty() {
        return Refused::whole(
            "found no BODY_NAMES (6D) or MARKER_NAMES (3D) in an export of Qualisys, expected one of them: export it with its header",
        );
    }
    // The header of the columns; exports of markers may have none.
    let is_numbers = |line: &str| number(cells(line).first().copied().unwrap_or_default()).is_some();
    let head = lines(text).take_while(|it| !is_numbers(it.1)).last();
    let Some((line, header)) = head else { return Refused::whole("found no header") };
    let header = cells(header);
    let at = |name: &str| header.iter().position(|it| *it == name);
    let columns = Columns { frame: at("Frame"), time: at("Time"), line };
    let (first, step) = first_place(&header, &columns, &names, is_posed)?;
    let mut frames = Frames::of(("mm", 1e-3), line);
    let needed = (first + step * names.len()).min(header.len());
    take_frames(&mut frames, text, &columns, (needed, header.len()), frequency)?;
    let bodies: Vec<Body> = (names.iter().enumerate())
        .map(|(at, name)| {
            let start = first + step * at;
            Body { name: (*name).to_owned(), position: [start, start + 1, start + 2], quaternion: None }
        })
        .collect();
    if !is_posed {
        return frames.table(&bodies, "marker", opening);
    }
    make_posed(&frames, bodies, header.len(), opening)
}

/// The table of bodies with poses: each has x, y, z, three angles, the residual and the matrix, column by column.
fn make_posed(
    frames: &Frames<'_>,
    bodies: Vec<Body>,
    width: usize,
    opening: &Opening<'_>,
) -> Result<Made, Refused> {
    for it in &bodies {
        let start = it.position[0];
        frames.refuse_words(&it.name, &(start..start + 16).collect::<Vec<_>>())?;
    }
    let texts = frames.turned(&bodies)?;
    let rows: Vec<(usize, Vec<&str>)> = (frames.rows.iter().zip(&texts))
        .map(|((line, cells), more)| {
            let mut all: Vec<&str> = cells.iter().take(width).copied().collect();
            all.resize(width, "");
            all.extend(more.iter().map(String::as_str));
            (*line, all)
        })
        .collect();
    let bodies: Vec<Body> = (bodies.into_iter().enumerate())
        .map(|(at, body)| {
            let start = width + 4 * at;
            Body { quaternion: Some([start, start + 1, start + 2, start + 3]), ..body }
        })
        .collect();
    let posed = Frames { rows, times: frames.times.clone(), ..Frames::of(frames.unit, frames.header) };
    let mut made = posed.table(&bodies, "body", opening)?;
    made.said.push("orientations are of the matrix, which agrees with the angles".to_owned());
    Ok(made)
}

/// Where the place of the first body is, and how many columns later that of the next.
fn first_place(
    header: &[&str],
    columns: &Columns,
    names: &[&str],
    is_posed: bool,
) -> Result<(usize, usize), Refused> {
    let at = |name: &str| header.iter().position(|it| *it == name);
    let (first, step) = match (is_posed, names.first()) {
        (true, Some(name)) => {
            let first = at(&format!("{name} X"));
            let step = names.get(1).and_then(|it| Some(at(&format!("{it} X"))? - first?)).unwrap_or(16);
            (first, step)
        }
        (false, Some(name)) => (at(&format!("{name} X")).or(columns.frame.map(|_| 2)).or(Some(0)), 3),
        (_, None) => (None, 0),
    };
    let Some(first) = first else {
        return Refused::at(
            columns.line,
            format!(
                "found no column `{} X`, expected the position of the first body",
                names.first().copied().unwrap_or_default()
            ),
        );
    };
    Ok((first, step))
}

/// Takes the rows of a file, of which each must have so many cells; messages name the number of the header.
fn take_frames<'t>(
    frames: &mut Frames<'t>,
    text: &'t str,
    columns: &Columns,
    (needed, expected): (usize, usize),
    frequency: Option<f64>,
) -> Result<(), Refused> {
    for (number_of, (line, content)) in lines(text).filter(|it| it.0 > columns.line).enumerate() {
        let found = cells(content);
        let read = |at: Option<usize>| at.and_then(|at| number(found.get(at)?));
        let frame = read(columns.frame).unwrap_or(number_of as f64 + 1.0);
        let time = read(columns.time).or_else(|| Some((frame - 1.0) / frequency?));
        if found.len() < needed {
            return Refused::at(
                line,
                format!("found {} cells, expected {} as in the header", found.len(), expected),
            );
        }
        frames.times.push(time);
        frames.rows.push((line, found));
    }
    Ok(())
}

impl Frames<'_> {
    /// The quaternion of each body in each row, four texts a body.
    fn turned(&self, bodies: &[Body]) -> Result<Vec<Vec<String>>, Refused> {
        let mut all = Vec::with_capacity(self.rows.len());
        for (line, cells) in &self.rows {
            let mut texts = Vec::with_capacity(4 * bodies.len());
            for body in bodies {
                let start = body.position[0];
                let values: Vec<f64> = (start..start + 16).map_while(|at| number(cells.get(at)?)).collect();
                let is_lost = values.iter().take(3).all(|it| *it == 0.0);
                let [_, _, _, roll, pitch, yaw, _, m0, m1, m2, m3, m4, m5, m6, m7, m8] = values[..] else {
                    texts.extend(std::iter::repeat_n(String::new(), 4));
                    continue;
                };
                if is_lost {
                    texts.extend(std::iter::repeat_n(String::new(), 4));
                    continue;
                }
                let matrix = Matrix3::from_columns(&[
                    Vector3::new(m0, m1, m2),
                    Vector3::new(m3, m4, m5),
                    Vector3::new(m6, m7, m8),
                ]);
                let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_radians);
                let by_angles = rotation::exp(&(Vector3::x() * roll))
                    * rotation::exp(&(Vector3::y() * pitch))
                    * rotation::exp(&(Vector3::z() * yaw));
                let off = rotation::log(&(by_angles.transpose() * matrix)).norm();
                let is_turn = (matrix.transpose() * matrix - Matrix3::identity()).amax() < AGREE_RAD;
                if !is_turn || !off.is_finite() || off >= AGREE_RAD {
                    return Refused::at(
                        *line,
                        format!(
                            "found a matrix Rot of `{}` that differs from Roll, Pitch, Yaw by {:.2} deg, expected the same rotation: export with the \
                             default angles (about x, then y, then z)",
                            body.name,
                            off.to_degrees()
                        ),
                    );
                }
                let quaternion = Pose::new(matrix, Vector3::zeros()).quaternion_xyzw();
                texts.extend(quaternion.iter().map(|it| format!("{it:?}")));
            }
            all.push(texts);
        }
        Ok(all)
    }
}
