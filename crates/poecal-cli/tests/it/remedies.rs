//! Remedies in messages of `hand-eye`, `tcp` and of joined files: each is taken from its sentence and followed.

use poecal_arm::lie::Pose;
use poecal_model::simulate::SessionKind;

use crate::folder::{Folder, Run};
use crate::hand_eye::{SEEN, abc, camera, camera_numbers, place, rvec, session, table};

/// A message on one line.
fn words(run: &Run) -> String {
    (run.out.clone() + &run.err).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Part of a message between two pieces of it.
fn text_between<'t>(text: &'t str, before: &str, behind: &str) -> &'t str {
    let (_, rest) = text.split_once(before).unwrap_or_else(|| panic!("no `{before}` in {text}"));
    rest.split_once(behind).unwrap_or_else(|| panic!("no `{behind}` behind `{before}` in {text}")).0
}

const TRUE_CAMERA: [f64; 3] = [0.04, -0.06, 0.09];

fn is_found(folder: &Folder, words: &str) {
    let (found, _) = camera(&folder.run_to_success(words));
    let off = found.iter().zip(TRUE_CAMERA).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    // Poses without noise except for a thousandth of a degree, 0.4 m away.
    assert!(off < 1e-4, "{words}: {found:?}");
}

/// Angles of the arm in each form, degrees.
fn angles(form: usize, pose: &Pose) -> Vec<f64> {
    let r = &pose.rotation;
    let turned = |it: [f64; 3]| it.map(f64::to_degrees).to_vec();
    match form {
        0 => abc(pose).to_vec(),
        1 => turned(poecal_arm::lie::rotation::to_rpy(r)),
        2 => turned(poecal_arm::lie::rotation::to_rpy(&r.transpose()).map(|it| -it)),
        3 => turned([r[(1, 2)].atan2(r[(0, 2)]), r[(2, 2)].acos(), r[(2, 1)].atan2(-r[(2, 0)])]),
        _ => rvec(pose).into_iter().map(f64::to_degrees).collect(),
    }
}

#[test]
fn every_form_of_angles_that_is_named_has_names_of_columns() {
    let folder = Folder::new();
    let rows = session(20);
    for form in 0..5 {
        let header = if form == 4 { "A[deg],B[deg],C[deg]" } else { "rx[deg],ry[deg],rz[deg]" };
        let write = |header: &str| {
            let all =
                rows.iter().map(|(arm, board)| [place(arm, 1e3), angles(form, arm), camera_numbers(board)].concat());
            table(&folder, "poses.csv", &format!("x[mm],y[mm],z[mm],{header},{SEEN}"), all);
        };
        write(header);
        let run = folder.run("hand-eye poses.csv --camera in-hand --json");
        println!("{}", run.err.trim_end());
        assert_eq!(run.code, 2, "{form}: {}{}", run.out, run.err);
        let names = text_between(&run.err, "name the columns ", ", with `[deg]` behind each name").to_owned();
        write(&names.split(", ").map(|name| format!("{name}[deg]")).collect::<Vec<_>>().join(","));
        is_found(&folder, "hand-eye poses.csv --camera in-hand --json");
    }
    // Names of makers that need no message.
    for (form, header) in [(0, "U,V,W"), (3, "A,E,R"), (2, "intrinsic_x,intrinsic_y,intrinsic_z")] {
        let all = rows.iter().map(|(arm, board)| [place(arm, 1e3), angles(form, arm), camera_numbers(board)].concat());
        table(&folder, "poses.csv", &format!("X,Y,Z,{header},{SEEN}"), all);
        is_found(&folder, "hand-eye poses.csv --camera in-hand --json");
    }
}

#[test]
fn units_of_rotation_vectors_are_stated_as_the_message_says() {
    let folder = Folder::new();
    let rows = session(20);
    let all = rows.iter().map(|(arm, board)| [place(arm, 1e3), angles(4, arm), camera_numbers(board)].concat());
    table(&folder, "poses.csv", &format!("X,Y,Z,RX,RY,RZ,{SEEN}"), all);
    let run = folder.run("hand-eye poses.csv --camera in-hand --units mm --json");
    assert!(run.code == 2 && run.err.contains("write `[deg]` behind its name, or --units deg"), "{}", run.err);
    is_found(&folder, "hand-eye poses.csv --camera in-hand --units mm,deg --json");
    // OpenCV's are radians, in spite of any stated unit.
    let degrees = |board: &Pose| [rvec(board).into_iter().map(f64::to_degrees).collect(), place(board, 1e3)].concat();
    let all = rows.iter().map(|(arm, board)| [place(arm, 1e3), abc(arm).to_vec(), degrees(board)].concat());
    table(&folder, "poses.csv", "X,Y,Z,A,B,C,rvec_x,rvec_y,rvec_z,tvec_x,tvec_y,tvec_z", all);
    let run = folder.run("hand-eye poses.csv --camera in-hand --units mm,deg --json");
    assert!(
        run.code == 2 && run.err.contains("write `[deg]` behind its name") && !run.err.contains("--units"),
        "{}",
        run.err
    );
    let text = folder.read("poses.csv").replacen("rvec_x,rvec_y,rvec_z", "rvec_x[deg],rvec_y[deg],rvec_z[deg]", 1);
    folder.write("poses.csv", text);
    is_found(&folder, "hand-eye poses.csv --camera in-hand --units mm --json");
}

#[test]
fn the_scale_of_a_board_is_that_of_the_sentence_from_a_tenth_to_ten_times() {
    let folder = Folder::new();
    let rows = session(20);
    let write = |times: f64| {
        let all = rows
            .iter()
            .map(|(arm, board)| [place(arm, 1e3), abc(arm).to_vec(), rvec(board), place(board, 1e3 * times)].concat());
        table(&folder, "poses.csv", &format!("X,Y,Z,A,B,C,{SEEN}"), all);
    };
    for (times, part) in [
        (0.1, "are 0.100 times the arm's"),
        (0.25, "are 0.250 times"),
        (0.5, "are 0.500 times"),
        (0.8, "are 20.0 % shorter"),
        (1.25, "are 25.0 % longer"),
        (1.5, "are 50.0 % longer"),
        (2.0, "are 2.000 times"),
        (4.0, "are 4.000 times"),
        (10.0, "are 10.000 times"),
    ] {
        write(times);
        let run = folder.run("hand-eye poses.csv --camera in-hand");
        let said = words(&run);
        println!("{}", text_between(&said, "verdict", "camera "));
        assert!(run.code == 1 && said.contains(&format!("the camera's lengths {part}")), "{times}: {said}");
        let by: f64 = text_between(&said, "(divided by ", " it fits)").parse().unwrap();
        write(times / by);
        folder.run_to_success("hand-eye poses.csv --camera in-hand");
    }
}

#[test]
fn a_mapping_of_what_was_measured_leaves_lists_of_joints_as_they_are() {
    let folder = crate::session::session(SessionKind::POINT);
    let text = folder.read("measurements.csv");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').skip(3).take(9).map(|it| it.parse().unwrap()).collect())
        .collect();
    let degrees = |row: &[f64]| row[..6].iter().map(|it| format!("{:.6}", it.to_degrees())).collect::<Vec<_>>();
    let lines = |of: &dyn Fn(usize, &[f64]) -> String| -> String {
        rows.iter().enumerate().map(|(at, row)| of(at + 1, row) + "\n").collect()
    };
    // A tracker's table without names: nominal and measured positions, with others between and behind.
    let tracker = |factor: f64| {
        lines(&|at, row| {
            let place: Vec<String> = row[6..9].iter().map(|it| format!("{:.7}", factor * it)).collect();
            format!("Motion{at} 1 2 3 4 5 6 {} 7 8 9 0.1 0.2", place.join(" "))
        })
    };
    folder.write("tracker.txt", tracker(1e3));
    folder.write("metres.txt", tracker(1.0));
    folder.write(
        "targets.txt",
        lines(&|at, row| format!("LOCAL VAR jointtarget p{at} = j:{{{},0}}{{EJ 0,0,0,0,0,0}}", degrees(row).join(","))),
    );
    folder.write("bare.csv", lines(&|_, row| degrees(row).join(",")));
    folder.write(
        "log.csv",
        "time,joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg],a,b,c\n".to_owned()
            + &lines(&|at, row| format!("{at},{},{:.4},{:.4},{:.4}", degrees(row).join(","), at as f64, 2.0, 3.0)),
    );
    for joints in ["targets.txt", "bare.csv", "log.csv"] {
        let run = folder.run(&format!("calibrate robot.urdf {joints} tracker.txt --out results"));
        let said = words(&run);
        assert!(run.code == 2 && said.contains("number them in a mapping (--columns)"), "{joints}: {said}");
        let like = text_between(&said, "like `position = { columns = ", " }`");
        assert_eq!(like, "[1, 2, 3]");
        for (name, unit) in [("tracker.txt", "mm"), ("metres.txt", "m")] {
            folder.write("map.toml", format!("position = {{ columns = [8, 9, 10], unit = \"{unit}\" }}\n"));
            let out = folder.run_to_success(&format!(
                "calibrate robot.urdf {joints} {name} --columns map.toml --out results --force"
            ));
            assert!(out.starts_with("verdict       good"), "{joints} {name}: {out}");
        }
    }
}

#[test]
fn no_tool_is_printed_that_is_not_to_be_used() {
    let folder = Folder::new();
    // The tip's own poses: the remedy is to record those of the flange.
    let (tip, pin) =
        (Pose::from_xyz_rpy([0.01, -0.02, 0.15], [0.0; 3]), Pose::from_xyz_rpy([0.5, 0.1, 0.05], [0.0; 3]));
    let at_pin: Vec<Pose> = (0..8)
        .map(|k| {
            let k = f64::from(k);
            let turn = [3.1 + 0.4 * (1.7 * k).sin(), 0.4 * (2.9 * k).cos(), 0.9 * k];
            let off = [(5.0 * k).sin(), (7.0 * k).sin(), (3.0 * k).sin()].map(|it| 2e-4 * it);
            pin * Pose::from_xyz_rpy(off, turn)
        })
        .collect();
    let write = |poses: &[Pose]| {
        table(
            &folder,
            "touches.csv",
            "X,Y,Z,A,B,C",
            poses.iter().map(|it| [place(it, 1e3), abc(it).to_vec()].concat()),
        );
    };
    write(&at_pin);
    let run = folder.run("tcp touches.csv --out tip");
    let said = words(&run);
    assert!(run.code == 1 && said.contains("these are poses of the tip"), "{said}");
    let texts = [said, folder.read("tip/transforms.txt"), folder.read("tip/tcp.json")].concat();
    for never in ["set_tcp", "KUKA ", "tframe", "UTOOL"] {
        assert!(!texts.contains(never), "{never}: {texts}");
    }
    let flange: Vec<Pose> = at_pin.iter().map(|it| *it * tip.inverse()).collect();
    write(&flange);
    let said = folder.run_to_success("tcp touches.csv");
    assert!(said.starts_with("verdict       good") && said.contains("set_tcp"), "{said}");
}
