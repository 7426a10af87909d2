//! Programs in files, each beside a file with the expected outcome of its targets.
//!
//! A line of that file is a corrected target, with its intended configuration (degrees), its tool and its frame (millimetres, quaternion with the
//! real part first), or an unchanged one, with the reason:
//!
//! ```text
//! pose | LINE | NAME | JOINTS | TOOL | FRAME
//! joints | LINE | NAME | JOINTS
//! listed | LINE | NAME | REASON
//! ```
//!
//! The written program is read by the readers of these tests alone, and its configuration is found from the nominal robot.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, Screw, rotation};
use poecal_compensate::{Inverse, ProgramOptions, compensate_program};
use poecal_model::robot::{Joint, JointLimits, JointTerm, Robot, Term, TermKind};

/// Numbers of a target that the test has read: their bytes and values.
pub(super) type Numbers = Vec<(Range<usize>, f64)>;

/// Reader of a language's targets.
pub(super) struct Reader {
    /// Numbers of the target with this name that begins on a line, the n-th of that line.
    pub(super) read: fn(text: &[u8], line: usize, nth: usize, is_joints: bool) -> Numbers,
    /// The pose of its numbers.
    pub(super) pose: fn(&[f64]) -> Pose,
    /// True if the words of its configuration are those of a configuration (degrees).
    pub(super) says: fn(numbers: &[f64], q: &[f64]) -> bool,
}

/// Expected outcome of a target.
enum Row {
    Pose { q: Vec<f64>, tool: Pose, frame: Pose },
    Joints { q: Vec<f64> },
    Listed { reason: String },
}

/// A robot of six joints by directions and points of its axes (mm), its limits (degrees), and its tip at zero.
pub(super) fn robot(name: &str, axes: [([f64; 3], [f64; 3]); 6], limits: [(f64, f64); 6], home: Pose) -> Robot {
    let joints = axes.iter().zip(limits).enumerate().map(|(index, ((direction, point), (lower, upper)))| {
        let point = Vector3::from(*point) * 1e-3;
        let mut joint =
            Joint::revolute(&format!("joint{}", index + 1), Screw::revolute(&Vector3::from(*direction), &point));
        joint.frame.translation = point;
        joint.limits = Some(JointLimits { lower: f64::to_radians(lower), upper: f64::to_radians(upper) });
        joint
    });
    Robot::new(name, joints.collect(), home).unwrap()
}

/// The actual robot: axes off by tenths of a millimetre and some 0.5 mrad, encoders by up to 3 mrad, gears by waves.
pub(super) fn make_actual(nominal: &Robot) -> Robot {
    let mut out = nominal.clone();
    for (index, joint) in out.joints.iter_mut().enumerate() {
        let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
        let turn = Vector3::new(3e-4, -2e-4 * sign, 4e-4 * sign);
        let shift = Vector3::new(2e-4 * sign, 1e-4, -3e-4);
        let point = joint.frame.translation;
        let moved = Pose::from_translation(point + shift)
            * Pose::new(rotation::exp(&turn), Vector3::zeros())
            * Pose::from_translation(-point);
        joint.screw = joint.screw.transform(&moved);
        let offset = [0.002, -0.0015, 0.003, -0.001, 0.0025, -0.002][index];
        out.terms.push(JointTerm { joint: index, term: Term::OFFSET, coefficient: offset });
        let kind = if index % 2 == 0 { TermKind::Cosine } else { TermKind::Sine };
        out.terms.push(JointTerm { joint: index, term: kind.with_number(1), coefficient: 2e-4 * sign });
    }
    out.home = out.home * Pose::new(rotation::exp(&Vector3::new(1e-3, -5e-4, 2e-4)), Vector3::new(1e-4, 2e-4, -3e-4));
    out
}

/// A pose in millimetres and a quaternion with the real part first.
pub(super) fn pose_of(numbers: &[f64]) -> Pose {
    let [x, y, z, w, i, j, k] = numbers[..7].try_into().unwrap();
    Pose::from_position_quaternion([x * 1e-3, y * 1e-3, z * 1e-3], [i, j, k, w])
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|it| it.parse().unwrap()).collect()
}

fn rows(text: &str) -> Vec<(usize, String, Row)> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(" | ").collect();
        let row = match cells[0] {
            "pose" => Row::Pose {
                q: numbers(cells[3]),
                tool: pose_of(&numbers(cells[4])),
                frame: pose_of(&numbers(cells[5])),
            },
            "joints" => Row::Joints { q: numbers(cells[3]) },
            "listed" => Row::Listed { reason: cells[3].to_owned() },
            other => panic!("{other}"),
        };
        (cells[1].parse().unwrap(), cells[2].to_owned(), row)
    };
    text.lines().map(row).collect()
}

/// Numbers anywhere in a text, except words with digits.
fn all_numbers(text: &[u8]) -> Vec<Range<usize>> {
    let is_digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
    let is_word = |at: usize| text.get(at).is_some_and(|it| it.is_ascii_alphanumeric() || *it == b'_' || *it >= 0x80);
    let mut out = Vec::new();
    let mut at = 0;
    while at < text.len() {
        if is_word(at) && !is_digit(at) {
            while is_word(at) {
                at += 1;
            }
            continue;
        }
        let sign = usize::from(matches!(text[at], b'-' | b'+'));
        let point = usize::from(text.get(at + sign) == Some(&b'.'));
        if !is_digit(at + sign + point) {
            at += 1;
            continue;
        }
        let start = at;
        at += sign;
        while is_digit(at) || text.get(at) == Some(&b'.') {
            at += 1;
        }
        let exponent = 1 + usize::from(matches!(text.get(at + 1), Some(b'-' | b'+')));
        if matches!(text.get(at), Some(b'e' | b'E')) && is_digit(at + exponent) {
            at += exponent;
            while is_digit(at) {
                at += 1;
            }
        }
        out.push(start..at);
    }
    out
}

/// A text cut at its numbers.
fn split_at_numbers(text: &[u8], cuts: &[Range<usize>]) -> Vec<Vec<u8>> {
    let mut at = 0;
    let mut out = Vec::new();
    for cut in cuts {
        out.push(text[at..cut.start].to_vec());
        at = cut.end;
    }
    out.push(text[at..].to_vec());
    out
}

/// The files of a folder with these extensions, in order.
pub(super) fn files(folder: &str, ends: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/programs").join(folder);
    let mut out: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|it| it.unwrap().path()).collect();
    out.retain(|it| it.extension().is_some_and(|it| ends.iter().any(|end| *end == it)));
    out.sort();
    out
}

/// Compensates a program and compares all of it with the expectation; returns the largest remainders (m, rad), and the corrected targets.
pub(super) fn check(path: &Path, nominal: &Robot, options: &ProgramOptions, reader: &Reader) -> (f64, f64, usize) {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let text = std::fs::read(path).unwrap();
    let expected = rows(&std::fs::read_to_string(path.with_extension("expected")).unwrap());
    let actual = make_actual(nominal);
    let (out, summary) = compensate_program(&text, (nominal, &actual), &[], options).unwrap();
    let found: Vec<String> =
        summary.changes.listed.iter().map(|it| format!("{} | {} | {}", it.line, it.name, it.reason)).collect();
    let mut listed: Vec<String> = expected
        .iter()
        .filter_map(|(line, name, row)| match row {
            Row::Listed { reason } => Some((*line, name, reason)),
            Row::Pose { .. } | Row::Joints { .. } => None,
        })
        .map(|(line, name, reason)| format!("{line} | {name} | {reason}"))
        .collect();
    let sorted = |list: &mut Vec<String>| list.sort();
    sorted(&mut listed);
    let mut found_sorted = found;
    sorted(&mut found_sorted);
    assert_eq!(found_sorted, listed, "{name}: what is left as it is");
    let inverse = Inverse::new(nominal, &[]).unwrap();
    let (mut metres, mut radians, mut count) = (0.0_f64, 0.0_f64, 0);
    let mut changed: Vec<Range<usize>> = Vec::new();
    let mut on_line: (usize, usize) = (0, 0);
    for (line, target, row) in &expected {
        let is_joints = matches!(row, Row::Joints { .. });
        if matches!(row, Row::Listed { .. }) {
            continue;
        }
        on_line = if on_line.0 == *line { (*line, on_line.1 + 1) } else { (*line, 0) };
        count += 1;
        let before = (reader.read)(&text, *line, on_line.1, is_joints);
        let after = (reader.read)(&out, *line, on_line.1, is_joints);
        changed.extend(before.iter().map(|it| it.0.clone()));
        let values = |numbers: &Numbers| -> Vec<f64> { numbers.iter().map(|it| it.1).collect() };
        let (before, after) = (values(&before), values(&after));
        let (meant, q) = match row {
            Row::Pose { q, tool, frame } => {
                let q: Vec<f64> = q.iter().map(|it| it.to_radians()).collect();
                let tip = |numbers: &[f64]| *frame * (reader.pose)(numbers) * tool.inverse();
                let meant = tip(&before);
                // One decimal of a millimetre, six of a quaternion or three of a degree, at two metres.
                let apart = pose_difference(&nominal.forward_kinematics(&q), &meant);
                assert!(apart.0 < 1e-4 && apart.1 < 4e-5, "{name} {target}: not what the file says: {apart:?}");
                let told = tip(&after);
                let commanded = inverse.solve_nearest(&told, &q, false).unwrap_or_else(|| panic!("{name} {target}"));
                let degrees: Vec<f64> = commanded.iter().map(|it| it.to_degrees()).collect();
                // Targets whose words are not followed are unchanged.
                let stated: Vec<f64> = q.iter().map(|it| it.to_degrees()).collect();
                assert!(
                    !(reader.says)(&before, &stated) || (reader.says)(&after, &degrees),
                    "{name} {target}: {after:?} at {degrees:?}"
                );
                assert!(
                    commanded.iter().zip(&q).all(|(a, b)| (a - b).abs() < 0.05),
                    "{name} {target}: {commanded:?} for {q:?}"
                );
                (meant, commanded)
            }
            Row::Joints { q } => {
                assert!(q.iter().zip(&before).all(|(a, b)| (a - b).abs() < 1e-9), "{name} {target}");
                let q: Vec<f64> = q.iter().map(|it| it.to_radians()).collect();
                (nominal.forward_kinematics(&q), after.iter().map(|it| it.to_radians()).collect())
            }
            Row::Listed { .. } => continue,
        };
        let left = pose_difference(&actual.forward_kinematics(&q), &meant);
        let off = pose_difference(&nominal.forward_kinematics(&q), &meant);
        assert!(off.0 > 1e-4 || off.1 > 1e-4, "{name} {target}: not corrected at all");
        metres = metres.max(left.0);
        radians = radians.max(left.1);
    }
    // Beside the numbers of corrected targets, nothing differs.
    let (old, new) = (all_numbers(&text), all_numbers(&out));
    assert_eq!(split_at_numbers(&text, &old), split_at_numbers(&out, &new), "{name}: other bytes");
    for (old, new) in old.iter().zip(&new) {
        if !changed.iter().any(|it| it.start <= old.start && old.end <= it.end) {
            assert_eq!(text[old.clone()], out[new.clone()], "{name}: a number that is none of a target at {old:?}");
        }
    }
    assert_eq!(summary.corrected, count, "{name}");
    (metres, radians, count)
}

/// Distance and angle of two poses.
fn pose_difference(one: &Pose, other: &Pose) -> (f64, f64) {
    let turn = rotation::log(&(one.rotation.transpose() * other.rotation));
    ((one.translation - other.translation).norm(), turn.norm())
}
