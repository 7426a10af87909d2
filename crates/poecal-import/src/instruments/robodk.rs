//! The table of measurements that RoboDK's script for calibration writes: joints in degrees, poses of the target in millimetres with angles about
//! x, then the new y, then the newest z, in radians, and the tool.

use super::maker::{Made, Refused, Value};
use super::words::{cells, lines, number};
use super::{Form, Opening};
use crate::Separator;
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};

pub(crate) const FORM: Form = Form { title: "measurements of RoboDK", is_it, table };

fn names(text: &str) -> Option<(usize, Vec<&str>)> {
    lines(text).next().map(|(line, it)| (line, cells(it, Separator::Comma)))
}

fn is_it(text: &str, _: &Opening<'_>) -> bool {
    let Some((_, names)) = names(text) else { return false };
    ["J1", "X", "Y", "Z", "rX", "rY", "rZ"].iter().all(|it| names.contains(it))
}

fn table(text: &str, opening: &Opening<'_>) -> Result<Made, Refused> {
    let Some((head, names)) = names(text) else { return Refused::whole("found no header") };
    let at = |name: &str| names.iter().position(|it| *it == name);
    let count = opening.robot.joint_reading_names().len();
    let joints: Vec<usize> = (1..).map_while(|number| at(&format!("J{number}"))).collect();
    if joints.len() != count {
        return Refused::at(
            head,
            format!("found {} columns J1, J2, …, expected {count} as the model has joints", joints.len()),
        );
    }
    let pose: Vec<usize> = ["X", "Y", "Z", "rX", "rY", "rZ"].into_iter().filter_map(at).collect();
    let columns: Vec<String> = opening
        .joint_columns("deg")
        .into_iter()
        .chain(["x[mm]", "y[mm]", "z[mm]", "qx", "qy", "qz", "qw"].map(str::to_owned))
        .collect();
    let mut made = Made::new(head, columns.iter().map(String::as_str));
    for (line, content) in lines(text).skip(1) {
        let found = cells(content, Separator::Comma);
        let text_of = |at: &usize| found.get(*at).copied().unwrap_or_default();
        let values: Vec<f64> = pose.iter().map_while(|at| number(text_of(at))).collect();
        let [_, _, _, a, b, c] = values[..] else {
            return Refused::at(line, "found a row without X, Y, Z, rX, rY and rZ as numbers, expected them");
        };
        let turn = |axis: Vector3<f64>, angle: f64| rotation::exp(&(axis * angle));
        if [a, b, c].iter().any(|it| it.abs() > 7.0) {
            return Refused::at(
                line,
                "found an angle beyond 7, expected radians, as RoboDK's script writes them",
            );
        }
        let turned = turn(Vector3::x(), a) * turn(Vector3::y(), b) * turn(Vector3::z(), c);
        let quaternion = Pose::new(turned, Vector3::zeros()).quaternion_xyzw();
        let texts = joints.iter().chain(pose.iter().take(3)).map(|at| Value::Text(text_of(at)));
        made.row(line, texts.chain(quaternion.into_iter().map(Value::Number)));
    }
    made.said
        .push(format!("{} poses, joints in deg, positions in mm, angles about x, y, z in rad", made.rows()));
    if at("TCP X").is_some() {
        made.said.push("the tool (TCP) is found anew".to_owned());
    }
    Ok(made)
}
