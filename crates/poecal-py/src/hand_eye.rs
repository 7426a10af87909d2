//! `hand_eye` and `tcp`: a camera, or the tip of a tool, from poses of the flange.

use poecal_arm::lie::Pose;
use poecal_cli::words::{self, WordList};
use poecal_fit::hand_eye::{self as solved, HandEyeOptions, Touches};
use poecal_import::{FlangePoses, PosePairs};
use poecal_report as report;
use poecal_results::hand_eye::{FrameNames, HandEyeResult};
use poecal_results::tcp::ToolResult;
use pyo3::prelude::*;

use crate::arguments as arg;
use crate::arrays::{NumberArray, pose_of};
use crate::errors::{argument, raise};
use crate::findings::Findings;
use crate::words::one_of;

/// Poses of an array of shape (m, 4, 4).
fn stack_poses(value: &Bound<'_, PyAny>, name: &str, count: Option<usize>) -> PyResult<Vec<Pose>> {
    let many = count.map_or("m".to_owned(), |count| count.to_string());
    let expected = format!("shape ({many}, 4, 4): a pose in each row, metres");
    let numbers = NumberArray::finite_of(value, name, &[count, Some(4), Some(4)], &expected)?;
    let rows = numbers.values.chunks_exact(16).enumerate();
    rows.map(|(row, numbers)| pose_of(numbers).map_err(|message| argument(name, format!("row {row}: {message}"))))
        .collect()
}

/// Names of rows, one for each.
fn texts(value: Option<Vec<String>>, name: &str, count: usize) -> PyResult<Vec<String>> {
    let value = value.unwrap_or_default();
    if !value.is_empty() && value.len() != count {
        return Err(argument(name, format!("found {}, expected {count}: one for each pose", value.len())));
    }
    Ok(value)
}

/// Names of the rows of arrays in messages.
fn row_names(names: Vec<String>, count: usize) -> Vec<String> {
    if names.is_empty() { (0..count).map(|row| format!("row {row}")).collect() } else { names }
}

/// Meaning of a word for an inversion.
fn inversion_from_word(name: &str, word: Option<&str>, words: WordList<bool>) -> PyResult<Option<bool>> {
    word.map(|word| one_of(name, word, words)).transpose()
}

/// Pose of a camera on the flange or beside the robot, from poses of the flange and of a board that it saw.
///
/// The result has bounds of 95 %. Mistakes in the poses are named, wrong poses left out.
///
/// Parameters
/// ----------
/// base_from_flange
///     Poses of the arm's flange, shape (m, 4, 4), metres; for joint readings `robot.forward_kinematics(joints)`.
/// camera_from_target
///     Poses of the board or marker as the camera saw it there, shape (m, 4, 4), metres.
/// camera
///     Position of the camera: "in-hand" or "beside".
/// flange, target
///     Sense of the poses: "base-from-flange" or "flange-from-base", "camera-from-target" or "target-from-camera". By default it is recognised, and
///     reported under "findings".
/// names
///     Names of the rows in messages.
/// frame_names
///     Names of base, flange, camera and target in the result.
///
/// Returns
/// -------
/// HandEye
///     The frame of the camera, "camera_frame", and of the board, "target_frame", each with "matrix", "bound95_mm" and "bound95_deg"; the "verdict",
///     the held-out errors, and "findings": all entries of `hand_eye.json`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a Python function")]
#[pyo3(signature = (base_from_flange, camera_from_target, *, camera, flange=None, target=None, names=None, frame_names=None))]
pub(crate) fn hand_eye(
    py: Python<'_>,
    base_from_flange: &Bound<'_, PyAny>,
    camera_from_target: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = arg::camera)] camera: &str,
    #[pyo3(from_py_with = arg::flange)] flange: Option<&str>,
    #[pyo3(from_py_with = arg::target)] target: Option<&str>,
    #[pyo3(from_py_with = arg::names)] names: Option<Vec<String>>,
    #[pyo3(from_py_with = arg::frame_names)] frame_names: Option<Vec<String>>,
) -> PyResult<Findings> {
    let arm = stack_poses(base_from_flange, "base_from_flange", None)?;
    let seen = stack_poses(camera_from_target, "camera_from_target", Some(arm.len()))?;
    let options = HandEyeOptions {
        camera: one_of("camera", camera, words::HAND_EYE_CAMERA)?,
        flange_inverted: inversion_from_word("flange", flange, words::FLANGE_POSES)?,
        target_inverted: inversion_from_word("target", target, words::TARGET_POSES)?,
    };
    let names = row_names(texts(names, "names", arm.len())?, arm.len());
    let frames = match frame_names {
        None => FrameNames::default(),
        Some(frames) => frames
            .join(",")
            .parse()
            .map_err(|error: poecal_numerics::error::Error| argument("frame_names", error.message()))?,
    };
    let poses = PosePairs { flange: arm.into(), target: seen.into(), names, ..PosePairs::default() };
    let name = |row: usize| poses.names.get(row).cloned().unwrap_or_default();
    let found = py.detach(|| solved::hand_eye(&poses.flange, &poses.target, &options, &name)).map_err(raise)?;
    let result = HandEyeResult { found: &found, poses: &poses, names: &frames, command: "", arm: None };
    let json = result.to_text().map_err(raise)?;
    let answer = report::hand_eye_answer(&result);
    let told = Findings::of_json("HandEye", report::hand_eye(&result), answer, json);
    Ok(told.with_warnings(&sentences(&found.findings)))
}

/// The tip of a tool from poses of the flange in which it touched a fixed point.
///
/// The result has bounds of 95 %. Wrong touches are named and left out.
///
/// Parameters
/// ----------
/// base_from_flange
///     Poses of the arm's flange at the touches, shape (m, 4, 4), metres.
/// points
///     The touched point of each touch, if there are several.
/// tips
///     The touching tip of each touch, of two tips along the tool, for the tool's direction.
/// names
///     Names of the rows in messages.
///
/// Returns
/// -------
/// ToolTip
///     The "tips", with "position_m" and "bound95_mm", the "axis" of two, and the "verdict": all entries of `tcp.json`.
#[pyfunction]
#[pyo3(signature = (base_from_flange, *, points=None, tips=None, names=None))]
pub(crate) fn tcp(
    py: Python<'_>,
    base_from_flange: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = arg::points)] points: Option<Vec<String>>,
    #[pyo3(from_py_with = arg::tips)] tips: Option<Vec<String>>,
    #[pyo3(from_py_with = arg::names)] names: Option<Vec<String>>,
) -> PyResult<Findings> {
    let arm = stack_poses(base_from_flange, "base_from_flange", None)?;
    let count = arm.len();
    let poses = FlangePoses {
        touches: Touches {
            flange: arm.into(),
            points: texts(points, "points", count)?,
            tips: texts(tips, "tips", count)?,
        },
        names: row_names(texts(names, "names", count)?, count),
        ..FlangePoses::default()
    };
    let name = |row: usize| poses.names.get(row).cloned().unwrap_or_default();
    let found = py.detach(|| solved::tool_tip(&poses.touches, &name)).map_err(raise)?;
    let result = ToolResult { found: &found, poses: &poses, command: "" };
    let json = result.to_text().map_err(raise)?;
    let answer = report::tool_tip_answer(&found);
    let told = Findings::of_json("ToolTip", report::tool_tip(&result), answer, json);
    Ok(told.with_warnings(&sentences(&found.findings)))
}

fn sentences(findings: &[solved::Finding]) -> Vec<String> {
    findings.iter().map(|it| it.statement.clone()).collect()
}
