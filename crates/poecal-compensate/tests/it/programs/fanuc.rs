//! Programs of FANUC as text.

use nalgebra::{Matrix3, Vector3};
use poecal_arm::lie::{Pose, rotation};
use poecal_compensate::{Language, ProgramOptions, StatedFrames};
use poecal_model::robot::Robot;

use super::expected::{Numbers, Reader, check, files, robot};

/// An arm of FANUC's kind: its base is at the height of the second axis, its third and fifth joints turn up.
fn fanuc_robot() -> Robot {
    let axes = [
        ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
        ([0.0, 1.0, 0.0], [50.0, 0.0, 0.0]),
        ([0.0, -1.0, 0.0], [50.0, 0.0, 330.0]),
        ([-1.0, 0.0, 0.0], [50.0, 0.0, 365.0]),
        ([0.0, -1.0, 0.0], [385.0, 0.0, 365.0]),
        ([-1.0, 0.0, 0.0], [385.0, 0.0, 365.0]),
    ];
    let limits = [(-170.0, 170.0), (-100.0, 145.0), (-140.0, 213.0), (-190.0, 190.0), (-125.0, 125.0), (-360.0, 360.0)];
    let turn = Matrix3::new(0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0);
    robot("fanuc", axes, limits, Pose::new(turn, Vector3::new(0.465, 0.0, 0.365)))
}

/// Numbers of the n-th position that begins on a line: those after an equals sign, and after commas in quotes.
fn read(text: &[u8], line: usize, nth: usize, is_joints: bool) -> Numbers {
    let start = text.split_inclusive(|it| *it == b'\n').take(line - 1).map(<[u8]>::len).sum::<usize>();
    let mut at = (start..text.len()).filter(|it| text[*it] == b'{').nth(nth).unwrap();
    let (mut values, mut turns, mut is_quoted) = (Vec::new(), Vec::new(), false);
    while text[at] != b'}' {
        is_quoted ^= text[at] == b'\'';
        let is_turn = is_quoted && text[at] == b',';
        let is_value = text[at] == b'=';
        at += 1;
        if !is_turn && !is_value {
            continue;
        }
        at += text[at..].iter().position(|it| !it.is_ascii_whitespace()).unwrap();
        let length = text[at..].iter().position(|it| !b"+-.0123456789".contains(it)).unwrap();
        let number: f64 = std::str::from_utf8(&text[at..at + length]).unwrap().parse().unwrap();
        if is_turn { &mut turns } else { &mut values }.push((at..at + length, number));
        at += length;
    }
    values.truncate(6);
    if !is_joints {
        values.extend(turns);
    }
    values
}

/// X, Y, Z in millimetres, W, P, R about the fixed axes in degrees.
fn pose(numbers: &[f64]) -> Pose {
    let about = |axis: usize, at: usize| rotation::about(axis, numbers[at].to_radians());
    let turn = about(2, 5) * about(1, 4) * about(0, 3);
    Pose::new(turn, Vector3::new(numbers[0], numbers[1], numbers[2]) * 1e-3)
}

const READER: Reader = Reader {
    read,
    pose,
    says: |numbers, q| {
        [(6, 0), (7, 3), (8, 5)].iter().all(|&(at, joint): &(usize, usize)| {
            let turns = q[joint] / 360.0 - numbers[at];
            (-0.5..=0.5).contains(&turns)
        })
    },
};

#[test]
fn programs_of_fanuc_are_corrected_in_place() {
    let nominal = fanuc_robot();
    let mut given = StatedFrames::default();
    for tool in ["1=12.5,-3,145.25,0,0,0", "2=80,0,110,0,-45,0", "3=-40.5,12,60,10,20,30"] {
        given.add_tool(tool, Language::Fanuc).unwrap();
    }
    for frame in ["1=350,-220,-180,0,0,90", "2=-150,260.5,40,2,-3,15"] {
        given.add_frame(frame, Language::Fanuc).unwrap();
    }
    let options = ProgramOptions { check: true, given, ..ProgramOptions::new(Language::Fanuc) };
    let paths = files("fanuc", &["ls"]);
    let (mut metres, mut radians, mut targets) = (0.0_f64, 0.0_f64, 0);
    for path in &paths {
        let (m, rad, count) = check(path, &nominal, &options, &READER);
        (metres, radians, targets) = (metres.max(m), radians.max(rad), targets + count);
    }
    println!("{} programs, {targets} targets: at most {metres:.1e} m and {radians:.1e} rad are left", paths.len());
    assert_eq!(paths.len(), 20);
    // Half of the last digits, 1e-6 mm and 1e-7 degrees, at less than a metre from the base.
    assert!(metres < 4e-9 && radians < 4e-9);
}
