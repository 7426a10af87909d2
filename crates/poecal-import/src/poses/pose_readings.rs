//! Other interpretations of the numbers of a list of poses, to name the mistake if one of them fits.

use super::pose_columns::{PoseColumns, PoseOwner, list_words};
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::Pose;
use poecal_arm::lie::angles::Angles;
use poecal_fit::hand_eye::ListReading;

/// Other interpretations of the orientations of a list.
pub(crate) fn other_readings(columns: &PoseColumns, poses: &[Pose], numbers: &[Vec<f64>]) -> Vec<ListReading> {
    let read = |form: OrientationForm, factor: f64| -> Option<Vec<Pose>> {
        let rows = numbers.iter().zip(poses);
        rows.map(|(numbers, pose)| {
            let numbers: Vec<f64> = numbers.iter().map(|it| it * factor).collect();
            Some(Pose::new(form.rotation(&numbers).ok()?, pose.translation))
        })
        .collect()
    };
    let reading = |(form, factor, advice): PoseReadingForm| Some(ListReading { advice, poses: read(form, factor)? });
    ways(columns).into_iter().filter_map(reading).collect()
}

/// An interpretation: its form, the factor of its numbers, and the remedy.
type PoseReadingForm = (OrientationForm, f64, String);

/// Other units and conventions of angles; other orders of quaternions and matrices.
fn ways(columns: &PoseColumns) -> Vec<PoseReadingForm> {
    let who = list_words(columns.whose);
    let (form, advice) = match columns.form {
        OrientationForm::QuaternionXyzw => (
            OrientationForm::QuaternionWxyz,
            format!("quaternions of {who} with the real part first: name the columns qw, qx, qy, qz"),
        ),
        OrientationForm::QuaternionWxyz => (
            OrientationForm::QuaternionXyzw,
            format!("quaternions of {who} with the real part last: name the columns qx, qy, qz, qw"),
        ),
        OrientationForm::MatrixByRows => (
            OrientationForm::MatrixByColumns,
            format!(
                "matrices of {who} written column by column: name the columns {}",
                OrientationForm::MatrixByColumns.part_names().join(", ")
            ),
        ),
        OrientationForm::MatrixByColumns => return Vec::new(),
        OrientationForm::Angles(angles) => return ways_of_angles(columns, angles, who),
    };
    vec![(form, 1.0, advice)]
}

fn ways_of_angles(columns: &PoseColumns, angles: Angles, who: &str) -> Vec<PoseReadingForm> {
    let degree = std::f64::consts::PI / 180.0;
    let symbol = columns.orientation.first().map_or("rad", |it| it.unit.symbol());
    let (other, short, factor) =
        if symbol == "deg" { ("radians", "rad", 1.0 / degree) } else { ("degrees", "deg", degree) };
    let unit = format!("angles of {who} in {other}: write `[{short}]` behind the names of these columns");
    let before = match columns.whose {
        PoseOwner::Arm => "",
        PoseOwner::Target => ", each behind `target_`",
    };
    let conventions = [
        (Angles::ZYX, "angles about z, y, x as turned (KUKA)", "A, B, C"),
        (Angles::ROLL_PITCH_YAW, "roll, pitch, yaw about fixed axes (FANUC, URDF)", "roll, pitch, yaw"),
        (Angles::XYZ, "angles about x, y, z as turned (Stäubli)", "intrinsic_x, intrinsic_y, intrinsic_z"),
        (Angles::ZYZ, "angles about z, y, z as turned (Kawasaki)", "O, A, T"),
        (Angles::RotationVector, "rotation vectors (Universal Robots, OpenCV)", "rx, ry, rz"),
    ];
    let conventions = conventions.into_iter().filter(|it| it.0 != angles).map(|(angles, words, names)| {
        let advice = format!(
            "orientations of {who} as {words}: name the columns {names}{before}, with `[{symbol}]` behind each name"
        );
        (OrientationForm::Angles(angles), 1.0, advice)
    });
    std::iter::once((columns.form, factor, unit)).chain(conventions).collect()
}
