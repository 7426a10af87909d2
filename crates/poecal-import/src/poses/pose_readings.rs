//! How else the numbers of a list of poses could be read, to name the mistake where another reading fits.

use nalgebra::Vector3;

use super::pose_columns::{PoseColumns, Whose, list_words};
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::Pose;
use poecal_arm::lie::angles::Angles;
use poecal_fit::hand_eye::Reading;

/// A reading: its form, the factor of its numbers, and the advice.
type Way = (OrientationForm, f64, String);

/// How else the orientations of a list could be read.
pub(crate) fn others(
    columns: &PoseColumns,
    positions: &[Vector3<f64>],
    numbers: &[Vec<f64>],
) -> Vec<Reading> {
    let read = |form: OrientationForm, factor: f64| -> Option<Vec<Pose>> {
        let rows = numbers.iter().zip(positions);
        rows.map(|(numbers, place)| {
            let numbers: Vec<f64> = numbers.iter().map(|it| it * factor).collect();
            Some(Pose::new(form.rotation(&numbers).ok()?, *place))
        })
        .collect()
    };
    ways(columns)
        .into_iter()
        .filter_map(|(form, factor, advice)| Some(Reading { advice, poses: read(form, factor)? }))
        .collect()
}

/// Other units and conventions of angles; other orders of quaternions and matrices.
fn ways(columns: &PoseColumns) -> Vec<Way> {
    let who = list_words(columns.whose);
    let one = |form: OrientationForm, advice: String| vec![(form, 1.0, advice)];
    match columns.form {
        OrientationForm::QuaternionXyzw => one(
            OrientationForm::QuaternionWxyz,
            format!("quaternions of {who} with the real part first: name the columns qw, qx, qy, qz"),
        ),
        OrientationForm::QuaternionWxyz => one(
            OrientationForm::QuaternionXyzw,
            format!("quaternions of {who} with the real part last: name the columns qx, qy, qz, qw"),
        ),
        OrientationForm::MatrixByRows => one(
            OrientationForm::MatrixByColumns,
            format!(
                "matrices of {who} written column by column: name the columns r11, r21, r31, r12, r22, r32, r13, r23, r33"
            ),
        ),
        OrientationForm::MatrixByColumns => Vec::new(),
        OrientationForm::Angles(_) => ways_of_angles(columns, who),
    }
}

fn ways_of_angles(columns: &PoseColumns, who: &str) -> Vec<Way> {
    let degree = std::f64::consts::PI / 180.0;
    let symbol = columns.orientation.first().map_or("rad", |it| it.unit.symbol());
    let (other, short, factor) =
        if symbol == "deg" { ("radians", "rad", 1.0 / degree) } else { ("degrees", "deg", degree) };
    let unit = format!("angles of {who} in {other}: write `[{short}]` behind the names of these columns");
    let forms = [
        (Angles::ZYX, "angles about z, y, x as turned (KUKA)", "A, B, C"),
        (Angles::ROLL_PITCH_YAW, "roll, pitch, yaw about fixed axes (FANUC, URDF)", "roll, pitch, yaw"),
        (Angles::XYZ, "angles about x, y, z as turned (Stäubli)", "intrinsic_x, intrinsic_y, intrinsic_z"),
        (Angles::ZYZ, "angles about z, y, z as turned (Kawasaki)", "O, A, T"),
        (Angles::RotationVector, "rotation vectors (Universal Robots, OpenCV)", "rx, ry, rz"),
    ];
    let conventions = forms.map(|it| (OrientationForm::Angles(it.0), it.1, it.2)).into_iter();
    let conventions = conventions.filter(|it| it.0 != columns.form).map(|(form, words, names)| {
        let before = match columns.whose {
            Whose::Arm => "",
            Whose::Target => ", each behind `target_`",
        };
        let advice = format!(
            "orientations of {who} as {words}: name the columns {names}{before}, with `[{symbol}]` behind each name"
        );
        (form, 1.0, advice)
    });
    std::iter::once((columns.form, factor, unit)).chain(conventions).collect()
}
