//! The table of measurements that RoboDK's script for calibration writes: joints in degrees, poses of the target, and the tool. Poses are in
//! millimetres, with intrinsic xyz angles in radians.

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, place, quaternion};
use super::words::{HeadLine, lines, number};
use super::{FileForm, OpeningContext};
use crate::Separator;
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};

pub(crate) const FORM: FileForm = FileForm { title: "measurements of RoboDK", is_it, table };

/// Columns of a pose.
const POSE: [&str; 6] = ["X", "Y", "Z", "rX", "rY", "rZ"];

fn head(text: &str) -> Option<HeadLine<'_>> {
    lines(text).next().map(|line| HeadLine::from_line(line, Separator::Comma))
}

fn is_it(text: &str, _: &OpeningContext<'_>) -> bool {
    head(text).is_some_and(|it| it.has(&["J1"]) && it.has(&POSE))
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let head = head(text).ok_or("found no header")?;
    let count = opening.robot.joint_reading_names().len();
    let joints: Vec<usize> = (1..).map_while(|number| head.column_of(&format!("J{number}"))).collect();
    if joints.len() != count {
        let found = joints.len();
        return FileLine(head.line)
            .refuse(format!("found {found} columns J1, J2, …, expected {count} as the model has joints"));
    }
    let pose: Vec<usize> = POSE.into_iter().filter_map(|it| head.column_of(it)).collect();
    let columns = opening.joint_columns("deg").chain(place("mm")).chain(quaternion());
    let mut made = MadeTable::new(head.line, columns);
    for (line, found) in head.rows(text) {
        let values: Vec<f64> = pose.iter().map_while(|at| number(found.get(*at)?)).collect();
        let [_, _, _, a, b, c] = values[..] else {
            return FileLine(line).refuse("found a row without X, Y, Z, rX, rY and rZ as numbers, expected them");
        };
        if [a, b, c].iter().any(|it| it.abs() > 7.0) {
            return FileLine(line).refuse("found an angle beyond 7, expected radians, as RoboDK's script writes them");
        }
        let turn = |axis: Vector3<f64>, angle: f64| rotation::exp(&(axis * angle));
        let turned = turn(Vector3::x(), a) * turn(Vector3::y(), b) * turn(Vector3::z(), c);
        let turned = Pose::new(turned, Vector3::zeros()).quaternion_xyzw();
        let texts = joints.iter().chain(pose.iter().take(3)).map(|at| CellValue::cell_at(&found, *at));
        made.row(line, texts.chain(turned.into_iter().map(CellValue::Number)));
    }
    made.say(format!("{} poses, joints in deg, positions in mm, angles about x, y, z in rad", made.rows()));
    if head.column_of("TCP X").is_some() {
        made.say("the tool (TCP) is found anew");
    }
    Ok(made)
}
