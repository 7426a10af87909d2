//! `poecal hand-eye` and `poecal tcp`: every form of poses results in the same frames, and mistakes are named.

use std::fs;

use poecal_arm::lie::{Pose, rotation};

use crate::folder::Folder;
use crate::session::calibration;

/// Poses of the flange and of the target, from numbers without noise except for one thousandth of a degree.
pub(crate) fn session(count: usize) -> Vec<(Pose, Pose)> {
    let camera = Pose::from_xyz_rpy([0.04, -0.06, 0.09], [0.05, -0.1, 1.5]);
    let board = Pose::from_xyz_rpy([0.7, 0.1, 0.02], [0.02, 0.03, 0.4]);
    (0..count)
        .map(|k| {
            let at = k as f64;
            let turn = [3.0 + 0.4 * (1.7 * at).sin(), 0.4 * (2.9 * at).cos(), 0.5 * (0.8 * at).sin()];
            let seen =
                Pose::from_xyz_rpy([0.05 * (3.1 * at).sin(), 0.04 * at.cos(), 0.4 + 0.05 * (2.3 * at).sin()], turn);
            let arm = board * seen.inverse() * camera.inverse();
            let off = [(9.1 * at).sin(), (7.7 * at).sin(), (5.3 * at).sin()].map(|it| 2e-5 * it);
            (arm, seen * Pose::from_xyz_rpy([0.0; 3], off))
        })
        .collect()
}

pub(crate) fn abc(pose: &Pose) -> [f64; 3] {
    let [c, b, a] = rotation::to_rpy(&pose.rotation).map(f64::to_degrees);
    [a, b, c]
}

fn text(numbers: impl IntoIterator<Item = f64>) -> String {
    numbers.into_iter().map(|it| format!("{it}")).collect::<Vec<_>>().join(",")
}

pub(crate) fn place(pose: &Pose, factor: f64) -> Vec<f64> {
    pose.translation.iter().map(|it| factor * it).collect()
}

pub(crate) fn rvec(pose: &Pose) -> Vec<f64> {
    rotation::log(&pose.rotation).iter().copied().collect()
}

/// OpenCV's columns.
pub(crate) const SEEN: &str = "rvec_x,rvec_y,rvec_z,tvec_x[mm],tvec_y[mm],tvec_z[mm]";

pub(crate) fn camera_numbers(pose: &Pose) -> Vec<f64> {
    [rvec(pose), place(pose, 1e3)].concat()
}

pub(crate) fn table(folder: &Folder, name: &str, header: &str, rows: impl IntoIterator<Item = Vec<f64>>) {
    let rows: Vec<String> = rows.into_iter().map(text).collect();
    fs::write(folder.path(name), format!("{header}\n{}\n", rows.join("\n"))).unwrap();
}

/// Position of the camera, and its bound.
pub(crate) fn camera(json: &str) -> (Vec<f64>, f64) {
    let all: serde_json::Value = serde_json::from_str(json).unwrap();
    let frame = &all["camera_frame"];
    let numbers =
        |key: &str| -> Vec<f64> { frame[key].as_array().unwrap().iter().map(|it| it.as_f64().unwrap()).collect() };
    ([numbers("position_m"), numbers("quaternion_xyzw")].concat(), frame["bound95_mm"].as_f64().unwrap())
}

#[test]
fn every_form_of_poses_gives_the_same_camera() {
    let folder = Folder::new();
    let rows = session(12);
    let all =
        |form: &dyn Fn(&Pose, &Pose) -> Vec<f64>| rows.iter().map(|(arm, board)| form(arm, board)).collect::<Vec<_>>();
    let quaternion = |pose: &Pose| pose.quaternion_xyzw().to_vec();
    table(
        &folder,
        "kuka.csv",
        &format!("X,Y,Z,A,B,C,{SEEN}"),
        all(&|arm, board| [place(arm, 1e3), abc(arm).to_vec(), camera_numbers(board)].concat()),
    );
    table(
        &folder,
        "fanuc.csv",
        &format!("X,Y,Z,W,P,R,{SEEN}"),
        all(&|arm, board| {
            let [a, b, c] = abc(arm);
            [place(arm, 1e3), vec![c, b, a], camera_numbers(board)].concat()
        }),
    );
    table(
        &folder,
        "ur.csv",
        &format!("x,y,z,rx,ry,rz,{SEEN}"),
        all(&|arm, board| [place(arm, 1.0), rvec(arm), camera_numbers(board)].concat()),
    );
    table(
        &folder,
        "abb.csv",
        &format!("x,y,z,q1,q2,q3,q4,{SEEN}"),
        all(&|arm, board| {
            let [x, y, z, w] = arm.quaternion_xyzw();
            [place(arm, 1e3), vec![w, x, y, z], camera_numbers(board)].concat()
        }),
    );
    let ros = "flange.position.x,flange.position.y,flange.position.z,flange.orientation.x,flange.orientation.y,flange.orientation.z,flange.orientation.w";
    let marker = "marker_x,marker_y,marker_z,marker_qx,marker_qy,marker_qz,marker_qw";
    table(
        &folder,
        "ros.csv",
        &format!("{ros},{marker}"),
        all(&|arm, board| [place(arm, 1.0), quaternion(arm), place(board, 1.0), quaternion(board)].concat()),
    );
    let matrix: Vec<String> = (0..16).map(|k| format!("robot_m{}{}", k / 4, k % 4)).collect();
    table(
        &folder,
        "matrix.csv",
        &format!("{},{SEEN}", matrix.join(",")),
        all(&|arm, board| {
            let row = |i: usize| [arm.rotation[(i, 0)], arm.rotation[(i, 1)], arm.rotation[(i, 2)], arm.translation[i]];
            [row(0).to_vec(), row(1).to_vec(), row(2).to_vec(), vec![0.0, 0.0, 0.0, 1.0], camera_numbers(board)]
                .concat()
        }),
    );
    let first = camera(&folder.run_to_success("hand-eye kuka.csv --camera in-hand --json")).0;
    assert!(
        (first[0] - 0.04).abs() < 1e-4 && (first[1] + 0.06).abs() < 1e-4 && (first[2] - 0.09).abs() < 1e-4,
        "{first:?}"
    );
    for name in ["fanuc", "ur", "abb", "ros", "matrix"] {
        let found = camera(&folder.run_to_success(&format!("hand-eye {name}.csv --camera in-hand --json"))).0;
        assert!(first.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-9), "{name}: {first:?} {found:?}");
    }
}

/// From exact poses a calibration that holds the arm locates the camera as hand-eye does, and exports it in the same forms.
#[test]
fn a_calibration_exports_the_transform_that_hand_eye_finds() {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.run_to_success("simulate robot.urdf --kind pose --errors 0deg,0mm --noise 0mm,0deg --count 30 --out cell");
    folder.run_to_success("hand-eye cell/measurements.csv --robot robot.urdf --camera beside --out eye --frame-names base_link,tool,device,measured");
    folder.run_to_success("calibrate robot.urdf cell/measurements.csv --fix joints --report none");
    folder.run_to_success("export poecal-out/calibration.json --format tf --out tf.txt");
    let (own, theirs) = (folder.read("tf.txt"), folder.read("eye/transforms.txt"));
    let heads = |text: &str| -> Vec<String> {
        let mut all: Vec<_> = text.lines().filter(|line| line.starts_with('#')).map(str::to_owned).collect();
        all.sort();
        all
    };
    assert_eq!(heads(&own).len(), 14, "{own}");
    let matrices = |text: &str, of: &str| -> Vec<f64> {
        let (_, rest) = text.split_once(&format!("# {of}: 4 x 4 matrix, metres\n")).unwrap();
        let matrix: Vec<Vec<f64>> = serde_json::from_str(rest.split_once("\n#").unwrap().0).unwrap();
        matrix.concat()
    };
    let base = calibration(&folder, "poecal-out").robot;
    let of = format!("{} from device", base.base_link);
    let apart = matrices(&own, &of)
        .iter()
        .zip(matrices(&theirs, "base_link from device"))
        .fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    println!("{apart:e} m");
    // Rounding of fits of 30 poses.
    assert!(apart < 1e-12, "{apart:e}");
    let run = folder.run("export robot.urdf --format tf --out no.txt");
    assert!(run.code == 2 && run.err.contains("expected a calibration.json"), "{}", run.err);
}

#[test]
fn two_files_are_joined_by_names_and_results_are_written_once() {
    let folder = Folder::new();
    let rows = session(12);
    let arm: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(k, (arm, _))| format!("shot{k}.png,{},{}", text(place(arm, 1e3)), text(abc(arm))))
        .collect();
    fs::write(folder.path("arm.csv"), format!("image,X,Y,Z,A,B,C\n{}\n", arm.join("\n"))).unwrap();
    let board: Vec<String> = rows
        .iter()
        .enumerate()
        .rev()
        .map(|(k, (_, board))| format!("{k:04},{}", text(camera_numbers(board))))
        .collect();
    fs::write(folder.path("board.csv"), format!("image,{SEEN}\n{}\n", board.join("\n"))).unwrap();
    let said = folder
        .run_to_success("hand-eye arm.csv board.csv --camera in-hand --out out --frame-names base,flange,eye,board");
    assert!(said.contains("12 of 12 fitted") && said.contains("eye in flange: (4"), "{said}");
    for name in [
        "hand_eye.json",
        "transforms.txt",
        "easy_handeye2.calib",
        "static_transform.launch.py",
        "opencv.yml",
        "rows.csv",
    ] {
        assert!(!folder.read(&format!("out/{name}")).is_empty(), "{name}");
    }
    let again = folder.run("hand-eye arm.csv board.csv --camera in-hand --out out");
    assert_eq!((again.code, again.err.contains("--force")), (2, true), "{}", again.err);
    folder.run_to_success("hand-eye arm.csv board.csv --camera in-hand --out out --force");
}

#[test]
fn mistakes_are_refused_in_one_line_and_nothing_is_written() {
    let folder = Folder::new();
    let rows = session(14);
    let kuka = format!("X,Y,Z,A,B,C,{SEEN}");
    let write = |name: &str, header: &str, form: &dyn Fn(usize) -> Vec<f64>| {
        table(&folder, name, header, (0..rows.len()).map(form));
    };
    let usual = |k: usize| [place(&rows[k].0, 1e3), abc(&rows[k].0).to_vec(), camera_numbers(&rows[k].1)].concat();
    write("radians.csv", &kuka, &|k| {
        [place(&rows[k].0, 1e3), abc(&rows[k].0).map(f64::to_radians).to_vec(), camera_numbers(&rows[k].1)].concat()
    });
    write("order.csv", &kuka, &|k| {
        [place(&rows[k].0, 1e3), abc(&rows[k].0).to_vec(), camera_numbers(&rows[13 - k].1)].concat()
    });
    write("metres.csv", &kuka.replace("X,Y,Z", "X[m],Y[m],Z[m]"), &usual);
    write("degrees.csv", &kuka.replace("A,B,C", "A[rad],B[rad],C[rad]"), &usual);
    write("names.csv", "a1,b1,c1", &|_| vec![0.0; 3]);
    table(&folder, "three.csv", &kuka, (0..3).map(usual));
    write("left.csv", &kuka, &|k| {
        // The sign of y, in any column.
        let mut arm = rows[k].0;
        arm.translation.y *= -1.0;
        for other in [0, 2] {
            arm.rotation[(1, other)] *= -1.0;
            arm.rotation[(other, 1)] *= -1.0;
        }
        [place(&arm, 1e3), abc(&arm).to_vec(), camera_numbers(&rows[k].1)].concat()
    });
    let before = folder.listing();
    for (name, expected) in [
        ("radians", "angles of the arm in radians"),
        ("order", "in reverse order"),
        ("metres", "if they are millimetres"),
        ("degrees", "if the column is in degrees"),
        ("names", "found no poses of the arm"),
        ("three", "found 3 different poses"),
        ("left", "left-handed"),
    ] {
        let run = folder.run(&format!("hand-eye {name}.csv --camera in-hand --out out --quiet"));
        assert_eq!((run.code, run.err.lines().count(), run.out.as_str()), (2, 1, ""), "{name}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{name}: {}", run.err);
    }
    assert!(folder.listing() == before);
}

#[test]
fn tips_of_tools_are_found_with_their_direction_and_wrong_touches() {
    let folder = Folder::new();
    folder.run_to_success("init --tcp --out touches");
    assert!(folder.read("touches/touches.csv").contains("point,tip"));
    folder.run_to_success("init --hand-eye beside --out poses");
    let (end, shaft, pin) = ([0.012, -0.003, 0.152], [0.012, -0.003, 0.092], [0.6, 0.1, 0.05]);
    let mut lines = vec!["X,Y,Z,A,B,C,tip".to_owned()];
    for (name, tip) in [("end", end), ("shaft", shaft)] {
        for k in 0..7 {
            let at = f64::from(k);
            let turned = Pose::from_xyz_rpy([0.0; 3], [3.1 + 0.4 * (1.7 * at).sin(), 0.4 * (2.9 * at).cos(), 0.9 * at]);
            let back = Pose::from_xyz_rpy(tip.map(|it: f64| -it), [0.0; 3]);
            let mut arm = Pose::from_xyz_rpy(pin, [0.0; 3]) * turned * back;
            arm.translation.x += 1e-5 * (5.0 * at).sin() + if name == "end" && k == 4 { 0.003 } else { 0.0 };
            lines.push(format!("{},{},{name}", text(place(&arm, 1e3)), text(abc(&arm))));
        }
    }
    fs::write(folder.path("touches.csv"), lines.join("\n")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&folder.run_to_success("tcp touches.csv --json")).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!((number(&found["tips"][0]["position_m"][2]) - 0.152).abs() < 5e-5, "{found}");
    assert!(number(&found["axis"]["direction"][2]) > 0.9999, "{found}");
    assert_eq!(found["outliers"], serde_json::json!(["line 6"]));
    assert!(found["tool"]["matrix"].is_array(), "{found}");
    // A single tip determines no direction, and no touch a mass: neither is printed.
    let one: Vec<&str> =
        lines.iter().filter(|it| !it.ends_with("shaft")).filter_map(|it| it.rsplit_once(',')).map(|it| it.0).collect();
    fs::write(folder.path("one.csv"), one.join("\n")).unwrap();
    let said = folder.run_to_success("tcp one.csv --out tip");
    assert!(said.contains("good: tip within") || said.contains("bounds: tip within"), "{said}");
    let texts = [said, folder.read("tip/transforms.txt"), folder.read("tip/tcp.json")].concat();
    for never in ["A 0", "tooldata", "[1,[0,0,1]", "\"matrix\"", "quaternion"] {
        assert!(!texts.contains(never), "{never}: {texts}");
    }
    for always in ["keep your A, B, C", "tPoecal.tframe.trans := [12.0", "get_tcp_offset()"] {
        assert!(texts.contains(always), "{always}: {texts}");
    }
    let two: Vec<&String> = lines.iter().take(3).collect();
    fs::write(folder.path("two.csv"), two.iter().map(|it| it.as_str()).collect::<Vec<_>>().join("\n")).unwrap();
    let run = folder.run("tcp two.csv --quiet");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("found 2 touches"), "{}", run.err);
}

/// Pixels of a board's 5 x 4 inner corners, 30 mm apart, by a camera of 800 pixels; `turned` names the last corner first.
fn corners(image: &str, seen: &Pose, turned: bool) -> Vec<String> {
    (0..20)
        .map(|k| {
            let at = f64::from(k);
            let point = Pose::from_xyz_rpy([0.03 * (at % 5.0), 0.03 * (at / 5.0).floor(), 0.0], [0.0; 3]);
            let it = (*seen * point).translation;
            let name = if turned { 19 - k } else { k };
            let (u, v) = (800.0 * it.x / it.z + 359.5, 800.0 * it.y / it.z + 339.5);
            let off = [
                0.02 * (7.3 * at + seen.translation.x * 1e3).sin(),
                0.02 * (5.1 * at + seen.translation.y * 1e3).cos(),
            ];
            format!("{image},corner{name},{},{}", u + off[0], v + off[1])
        })
        .collect()
}

#[test]
fn corners_of_pictures_give_the_same_camera_whichever_corner_is_named_first() {
    let folder = Folder::new();
    let rows = session(16);
    let arm: Vec<String> = rows
        .iter()
        .enumerate()
        .map(|(k, (arm, _))| format!("{k}.png,{},{}", text(place(arm, 1e3)), text(abc(arm))))
        .collect();
    fs::write(folder.path("arm.csv"), format!("image,X,Y,Z,A,B,C\n{}\n", arm.join("\n"))).unwrap();
    fs::write(
        folder.path("nameless.csv"),
        format!(
            "X,Y,Z,A,B,C\n{}\n",
            arm.iter().filter_map(|it| it.split_once(',')).map(|it| it.1).collect::<Vec<_>>().join("\n")
        ),
    )
    .unwrap();
    fs::write(folder.path("lens.csv"), "name,fx,fy,cx,cy,width,height\neye,800,800,359.5,339.5,720,640\n").unwrap();
    let all = |turned: &dyn Fn(usize) -> bool| -> String {
        let lines = rows.iter().enumerate().flat_map(|(k, (_, board))| corners(&format!("{k}.png"), board, turned(k)));
        format!("image,target,u[px],v[px]\n{}\n", lines.collect::<Vec<_>>().join("\n"))
    };
    fs::write(folder.path("corners.csv"), all(&|_| false)).unwrap();
    fs::write(folder.path("turned.csv"), all(&|k| k % 5 == 2)).unwrap();
    table(
        &folder,
        "poses.csv",
        &format!("X,Y,Z,A,B,C,{SEEN}"),
        rows.iter().map(|(arm, board)| [place(arm, 1e3), abc(arm).to_vec(), camera_numbers(board)].concat()),
    );
    let run = "--camera in-hand --lens lens.csv --markers chessboard:6x5:30mm --json";
    let plain: serde_json::Value =
        serde_json::from_str(&folder.run_to_success(&format!("hand-eye arm.csv corners.csv {run}"))).unwrap();
    let of = |found: &serde_json::Value, k: usize| found["camera_frame"]["position_m"][k].as_f64().unwrap();
    for (k, truth) in [0.04, -0.06, 0.09].into_iter().enumerate() {
        let bound = plain["camera_frame"]["bound95_mm"].as_f64().unwrap();
        assert!((of(&plain, k) - truth).abs() < 1.5e-3 * bound, "{plain}");
        assert!(bound < 1.0, "{bound}");
    }
    let turned: serde_json::Value = serde_json::from_str(
        &folder.run_to_success(&format!("hand-eye corners.csv arm.csv {run}").replace("corners.csv", "turned.csv")),
    )
    .unwrap();
    for k in 0..3 {
        assert!((of(&plain, k) - of(&turned, k)).abs() < 1e-6, "{plain} {turned}");
    }
    assert_eq!(turned["findings"][0]["kind"], "other_pose", "{turned}");
    let unknown: serde_json::Value = serde_json::from_str(&folder.run_to_success(
        &format!("hand-eye arm.csv corners.csv {run} --out found").replace("lens.csv", "unknown:720x600"),
    ))
    .unwrap();
    let numbers = unknown["lens"]["numbers"].as_array().unwrap();
    let value = |number: &serde_json::Value, key: &str| number[key].as_f64().unwrap();
    for (number, truth) in numbers.iter().zip([800.0, 800.0, 359.5, 339.5, 0.0, 0.0, 0.0, 0.0]) {
        let (off, sigma) = (value(number, "value") - truth, value(number, "sigma"));
        // One of eight is beyond 4 deviations once in 2,000.
        assert!(off.abs() < 4.0 * sigma && sigma > 0.0, "{number}");
    }
    let bound = |found: &serde_json::Value| found["camera_frame"]["bound95_mm"].as_f64().unwrap();
    assert!(bound(&unknown) > bound(&plain), "{unknown}");
    for (k, truth) in [0.04, -0.06, 0.09].into_iter().enumerate() {
        assert!((of(&unknown, k) - truth).abs() < 1.5e-3 * bound(&unknown), "{unknown}");
    }
    let said = folder.run_to_success(
        "hand-eye arm.csv corners.csv --camera in-hand --lens unknown:720x600 --markers chessboard:6x5:30mm",
    );
    assert!(said.contains("\nlens          fx ") && said.contains(": camera within "), "{said}");
    // The fitted lens can be stated, and results in the same camera.
    fs::copy(folder.path("found/lens.csv"), folder.path("again.csv")).unwrap();
    let again: serde_json::Value = serde_json::from_str(
        &folder.run_to_success(&format!("hand-eye arm.csv corners.csv {run}").replace("lens.csv", "again.csv")),
    )
    .unwrap();
    for k in 0..3 {
        assert!((of(&again, k) - of(&unknown, k)).abs() < 1e-3 * bound(&unknown), "{again} {unknown}");
    }
    for (words, expected) in [
        (
            "hand-eye arm.csv corners.csv --camera beside --lens lens.csv --markers chessboard:6x5:30mm --out wrong",
            "run with --camera in-hand",
        ),
        ("hand-eye arm.csv corners.csv --camera in-hand --markers chessboard:6x5:30mm", "expected --lens FILE"),
        ("hand-eye arm.csv corners.csv --camera in-hand --lens lens.csv", "expected --markers"),
        (
            "hand-eye nameless.csv corners.csv --camera in-hand --lens lens.csv --markers chessboard:6x5:30mm",
            "a column `image`",
        ),
        (
            "hand-eye arm.csv corners.csv --camera in-hand --lens lens.csv --markers chessboard:6x5:30mm --target target-from-camera",
            "found --target beside corners",
        ),
        ("hand-eye poses.csv --camera in-hand --lens lens.csv", "no corners in pixels"),
        (
            "hand-eye corners.csv turned.csv --camera in-hand --lens lens.csv --markers chessboard:6x5:30mm",
            "in both files",
        ),
    ] {
        let run = folder.run(&format!("{words} --quiet"));
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{words}: {}{}", run.out, run.err);
        assert!(run.err.contains(expected), "{words}: {}", run.err);
    }
}

#[test]
fn joint_readings_stand_for_the_arms_poses_and_say_whether_to_fit_the_arm() {
    let folder = Folder::new();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let robot = format!("{examples}/elbow/robot.urdf");
    let found: serde_json::Value = serde_json::from_str(&folder.run_to_success(&format!(
        "hand-eye {examples}/howto/camera.csv --units mm --camera in-hand --robot {robot} --out out --json"
    )))
    .unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let (held, fitted) = (number(&found["arm"]["held"]["rms_mm"]), number(&found["arm"]["fitted"]["rms_mm"]));
    println!("other poses: {held:.3} mm with the arm as it is, {fitted:.3} mm with it fitted");
    assert!(fitted < 0.5 * held, "{found}");
    assert_eq!(found["camera_frame"]["parent"], "tool");
    // The advice, as it is printed.
    let command = found["arm"]["command"].as_str().unwrap();
    let command = command.strip_prefix("poecal ").unwrap();
    let said = folder.run_to_success(&format!("{command} --out fitted"));
    assert!(said.contains("held out"), "{said}");
    let run = folder.run(&format!("hand-eye {examples}/howto/hand_eye.csv --camera in-hand --tip-link tool --quiet"));
    assert_eq!((run.code, run.err.contains("no model")), (2, true), "{}", run.err);
}
