//! Programs in RAPID.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_compensate::{Inverse, Language, ProgramOptions, compensate_program};
use poecal_model::robot::Robot;

use super::expected::{Numbers, Reader, check, files, make_actual, pose_of, robot};

/// An arm of ABB's kind.
fn abb_robot() -> Robot {
    let axes = [
        ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
        ([0.0, 1.0, 0.0], [320.0, 0.0, 780.0]),
        ([0.0, 1.0, 0.0], [320.0, 0.0, 1860.0]),
        ([1.0, 0.0, 0.0], [320.0, 0.0, 2060.0]),
        ([0.0, 1.0, 0.0], [1462.0, 0.0, 2060.0]),
        ([1.0, 0.0, 0.0], [1462.0, 0.0, 2060.0]),
    ];
    let limits = [(-170.0, 170.0), (-65.0, 85.0), (-180.0, 70.0), (-300.0, 300.0), (-130.0, 130.0), (-360.0, 360.0)];
    let home = Pose::new(rotation::about(1, FRAC_PI_2), Vector3::new(1.662, 0.0, 2.060));
    robot("abb", axes, limits, home)
}

/// Numbers of the n-th target of a line: those in brackets after `[[`, comments left out.
fn read(text: &[u8], line: usize, nth: usize, is_joints: bool) -> Numbers {
    let start = text.split_inclusive(|it| *it == b'\n').take(line - 1).map(<[u8]>::len).sum::<usize>();
    let begins = |at: &usize| {
        let rest = &text[*at..];
        let inside = rest.strip_prefix(b"[[").unwrap_or_default().trim_ascii_start();
        inside.first().is_some_and(|it| it.is_ascii_digit() || matches!(it, b'-' | b'+'))
    };
    let mut at = (start..text.len()).filter(begins).nth(nth).unwrap();
    let mut out = Vec::new();
    let (count, kept) = if is_joints { (12, 6) } else { (17, 11) };
    while out.len() < count {
        if text[at] == b'!' {
            at += text[at..].iter().position(|it| *it == b'\n').unwrap();
        } else if text[at].is_ascii_digit() || matches!(text[at], b'-' | b'+') {
            let length = text[at..].iter().position(|it| b",] \t!\r\n".contains(it)).unwrap();
            let number = std::str::from_utf8(&text[at..at + length]).unwrap();
            out.push((at..at + length, number.parse().unwrap()));
            at += length;
        } else {
            at += 1;
        }
    }
    out.truncate(kept);
    out
}

const READER: Reader = Reader {
    read,
    pose: pose_of,
    says: |numbers, q| {
        [(7, 0), (8, 3), (9, 5)].iter().all(|&(at, joint): &(usize, usize)| {
            let quarter = q[joint] / 90.0 - numbers[at];
            (-1e-6..=1.0 + 1e-6).contains(&quarter)
        })
    },
};

#[test]
fn programs_in_rapid_are_corrected_in_place() {
    let nominal = abb_robot();
    let options = ProgramOptions { check: true, ..ProgramOptions::new(Language::Rapid) };
    let paths = files("rapid", &["mod", "prg", "sys"]);
    let (mut metres, mut radians, mut targets) = (0.0_f64, 0.0_f64, 0);
    for path in &paths {
        let (m, rad, count) = check(path, &nominal, &options, &READER);
        (metres, radians, targets) = (metres.max(m), radians.max(rad), targets + count);
    }
    println!("{} programs, {targets} targets: at most {metres:.1e} m and {radians:.1e} rad are left", paths.len());
    assert_eq!(paths.len(), 20);
    // Half of the last digits, 1e-6 mm and 1e-9 of a quaternion, at two metres from the base.
    assert!(metres < 1e-8 && radians < 4e-9);
}

/// A module of targets alone: the user states the tool and work object of its moves.
#[test]
fn targets_without_moves_have_what_the_user_states() {
    let nominal = abb_robot();
    let text = "MODULE Data\n  CONST robtarget p10:=[[1628.128,-12.5,1705.665],[0.13052562,0,0.99144494,0],\
                [-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nENDMODULE\n";
    let mut options = ProgramOptions::new(Language::Rapid);
    let run = |options: &ProgramOptions| {
        compensate_program(text.as_bytes(), (&nominal, &make_actual(&nominal)), &[], options).unwrap()
    };
    let (out, summary) = run(&options);
    assert_eq!((out.as_slice(), summary.corrected, summary.changes.listed.len()), (text.as_bytes(), 0, 1));
    options.given.add_tool("0,0,100,1,0,0,0", Language::Rapid).unwrap();
    assert_eq!(run(&options).1.corrected, 0);
    options.given.add_frame("-100,0,50,1,0,0,0", Language::Rapid).unwrap();
    let (out, summary) = run(&options);
    println!("{}", String::from_utf8_lossy(&out));
    assert_eq!((summary.corrected, summary.changes.listed.len()), (1, 0), "{:?}", summary.changes.listed);
    let pose = |text: &[u8]| {
        let numbers: Vec<f64> = read(text, 2, 0, false).iter().map(|it| it.1).collect();
        let frame = Pose::from_translation(Vector3::new(-0.1, 0.0, 0.05));
        frame * pose_of(&numbers) * Pose::from_translation(Vector3::new(0.0, 0.0, -0.1))
    };
    let inverse = Inverse::new(&nominal, &[]).unwrap();
    let meant = inverse.solve_nearest(&pose(text.as_bytes()), &[0.0; 6], true).unwrap();
    let commanded = inverse.solve_nearest(&pose(&out), &meant, true).unwrap();
    let left = make_actual(&nominal).forward_kinematics(&commanded).translation - pose(text.as_bytes()).translation;
    assert!(left.norm() < 1e-8, "{left}");
}
