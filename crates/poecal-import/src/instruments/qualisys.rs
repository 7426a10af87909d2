//! Files that Qualisys Track Manager exported as TSV: bodies (6D) or markers (3D), in millimetres.

use super::bodies::{RecordedBody, RecordedFrame, RecordedFrames, cells};
use super::made_table::{CellValue, FileLine, MadeTable, Refusal};
use super::words::{lines, number};
use super::{FileForm, OpeningContext};
use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::angles::Angles;
use poecal_arm::lie::{Pose, rotation};

pub(crate) const FORM: FileForm = FileForm { title: "an export of Qualisys Track Manager", is_it, table };

/// Largest difference between the matrix and the angles, which have two to five digits, radians.
const AGREE_RAD: f64 = 0.01;
/// Columns of a body with a pose: x, y, z, three angles, the residual and the matrix, column by column.
const POSED: usize = 16;

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    lines(text).next().is_some_and(|it| it.1.starts_with("NO_OF_FRAMES"))
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let value = |key: &str| {
        let mut head = lines(text).take(20).map(|it| cells(it.1, '\t'));
        let found = head.find(|it| it.first() == Some(&key))?;
        Some(found.into_iter().skip(1).filter(|it| !it.is_empty()).collect::<Vec<_>>())
    };
    let frequency = value("FREQUENCY").and_then(|it| number(it.first()?));
    let is_posed = value("DATA_INCLUDED").is_some_and(|it| it.first() == Some(&"6D"));
    let names = value(if is_posed { "BODY_NAMES" } else { "MARKER_NAMES" }).unwrap_or_default();
    if names.is_empty() {
        return Refusal::refuse_whole(
            "found no BODY_NAMES (6D) or MARKER_NAMES (3D) in an export of Qualisys, expected one of them: export it with its header",
        );
    }
    // The header of the columns; exports of markers may have none.
    let is_numbers = |line: &str| cells(line, '\t').first().is_some_and(|it| number(it).is_some());
    let (line, header) = lines(text).take_while(|it| !is_numbers(it.1)).last().ok_or("found no header")?;
    let header = cells(header, '\t');
    let at = |name: &str| header.iter().position(|it| *it == name);
    let (frame, time, expected) = (at("Frame"), at("Time"), header.len());
    // The column of the position of the first body, and the number of columns from there to the next body.
    let place = |of: usize| names.get(of).and_then(|name| at(&format!("{name} X")));
    let (first, step) = if is_posed {
        let Some(first) = place(0) else {
            let name = names.first().copied().unwrap_or_default();
            return FileLine(line)
                .refuse(format!("found no column `{name} X`, expected the position of the first body"));
        };
        (first, place(1).and_then(|it| it.checked_sub(first)).unwrap_or(POSED))
    } else {
        (place(0).or(frame.map(|_| 2)).unwrap_or(0), 3)
    };
    let needed = (first + step * names.len()).min(expected);
    let mut frames = RecordedFrames::from_lines(text, (line, ("mm", 1e-3)), '\t', |cells, count, _| {
        let read = |at: Option<usize>| number(cells.get(at?)?);
        let frame = read(frame).unwrap_or(count as f64 + 1.0);
        if cells.len() < needed {
            return Err(format!("found {} cells, expected {expected} as in the header", cells.len()));
        }
        Ok(read(time).or_else(|| Some((frame - 1.0) / frequency?)))
    })?;
    let body = |(at, name): (usize, &&str)| {
        let start = first + step * at;
        RecordedBody { name: (*name).to_owned(), position: [start, start + 1, start + 2], quaternion: None }
    };
    let mut bodies: Vec<RecordedBody> = names.iter().enumerate().map(body).collect();
    if !is_posed {
        return frames.table(&bodies, "marker", opening);
    }
    add_orientations(&mut frames, &mut bodies, expected)?;
    let mut made = frames.table(&bodies, "body", opening)?;
    made.say("orientations are of the matrix, which agrees with the angles");
    Ok(made)
}

/// Adds the orientations of bodies behind the cells of the frames; the header has `width` cells.
fn add_orientations(frames: &mut RecordedFrames<'_>, bodies: &mut [RecordedBody], width: usize) -> Result<(), Refusal> {
    for it in bodies.iter() {
        let start = it.position[0];
        frames.refuse_words(&it.name, &(start..start + POSED).collect::<Vec<_>>())?;
    }
    for frame in &mut frames.all {
        add_quaternions(frame, bodies, width)?;
    }
    for (at, body) in bodies.iter_mut().enumerate() {
        body.quaternion = Some([0, 1, 2, 3].map(|part| width + 4 * at + part));
    }
    Ok(())
}

/// Adds the quaternion of each body behind the cells of a frame; the header has `width` cells.
fn add_quaternions(frame: &mut RecordedFrame<'_>, bodies: &[RecordedBody], width: usize) -> Result<(), Refusal> {
    let mut more = Vec::with_capacity(4 * bodies.len());
    for body in bodies {
        let pose = frame.numbers(std::array::from_fn::<_, POSED, _>(|at| body.position[0] + at));
        let Some([_, _, _, a, b, c, _, matrix @ ..]) = pose.filter(|it| it[..3] != [0.0; 3]) else {
            more.extend([CellValue::Empty; 4]);
            continue;
        };
        let matrix = Matrix3::from_column_slice(&matrix);
        let by_angles = Angles::XYZ.rotation([a, b, c].map(f64::to_radians));
        let off = rotation::log(&(by_angles.transpose() * matrix)).norm();
        let is_turn = (matrix.transpose() * matrix - Matrix3::identity()).amax() < AGREE_RAD;
        if !is_turn || !off.is_finite() || off >= AGREE_RAD {
            return FileLine(frame.line).refuse(format!(
                "found a matrix Rot of `{}` that differs from Roll, Pitch, Yaw by {:.2} deg, expected the same rotation: export with the \
                 default angles (about x, then y, then z)",
                body.name,
                off.to_degrees()
            ));
        }
        more.extend(Pose::new(matrix, Vector3::zeros()).quaternion_xyzw().map(CellValue::Number));
    }
    frame.cells.resize(width, CellValue::Empty);
    frame.cells.extend(more);
    Ok(())
}
