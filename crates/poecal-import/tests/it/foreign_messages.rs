//! Messages of robot_calibration, and boards and lenses in files of other programs.

use poecal_import::{ReadOptions, board_of_file, parse, read_boards, read_cameras};
use poecal_model::camera::{Corner, Distortion, Picture};

use crate::foreign_corners::{Session, assert_same, says};
use poecal_testing::files::Folder;

/// A message of robot_calibration in JSON.
fn message(session: &Session, (at, picture): (usize, &Picture), camera: bool) -> String {
    let names: Vec<String> = session.data.reading_names().iter().map(|it| format!("\"{it}\"")).collect();
    let feature = |frame: &str, [x, y]: [String; 2]| {
        format!("{{\"header\":{{\"frame_id\":\"{frame}\"}},\"point\":{{\"x\":{x},\"y\":{y},\"z\":0.0}}}}")
    };
    let own =
        |corner: &Corner| feature("optical", [format!("{:.4}", corner.pixel.x), format!("{:.4}", corner.pixel.y)]);
    let point = |corner: &Corner| {
        let [x, y, _] = session.place_mm(corner).map(|it| format!("{:?}", 1e-3 * it.parse::<f64>().unwrap()));
        feature("checkerboard", [x, y])
    };
    let lens = session.options.cameras[0].lens;
    let k = format!(
        "[{:?},0,{:?},0,{:?},{:?},0,0,1]",
        lens.focal_px[0], lens.centre_px[0], lens.focal_px[1], lens.centre_px[1]
    );
    let d = match lens.distortion {
        Distortion::Brown(k) => format!("{:?}", &k[..5]),
        Distortion::Fisheye(_) => unreachable!(),
    };
    let info = match camera {
        true => format!("{{\"width\":1920,\"height\":1200,\"distortion_model\":\"plumb_bob\",\"d\":{d},\"k\":{k}}}"),
        false => "{\"width\":0,\"height\":0,\"distortion_model\":\"\",\"d\":[],\"k\":[0,0,0,0,0,0,0,0,0]}".to_owned(),
    };
    let list = |all: Vec<String>| all.join(",");
    format!(
        "{{\"joint_states\":{{\"name\":[\"head_pan\",{}],\"position\":[0.5,{}]}},\"observations\":[\
         {{\"sensor_name\":\"eye\",\"features\":[{}],\"ext_camera_info\":{{\"camera_info\":{info}}}}},\
         {{\"sensor_name\":\"arm\",\"features\":[{}]}}]}}",
        names.join(","),
        session.readings(at).join(","),
        list(picture.corners.iter().map(own).collect()),
        list(picture.corners.iter().map(point).collect()),
    )
}

#[test]
fn messages_of_robot_calibration_are_the_same_session() {
    let session = Session::new();
    let all = |camera| -> Vec<String> { session.pictures().map(|it| message(&session, it, camera)).collect() };
    // JSON is YAML too.
    let forms = [
        ("lines.jsonl", all(true).join("\n")),
        ("list.json", format!("[{}]", all(true).join(",\n"))),
        ("echo.yaml", all(true).join("\n---\n") + "\n---\n"),
        ("echo.txt", format!("---\n{}", block_form(&all(true).join("\n---\n")))),
    ];
    for (name, text) in &forms {
        let found = session.read(&[(name, text)], &ReadOptions::default()).unwrap();
        says(&found, "took ext_camera_info for the lens of eye (1920 x 1200 px)");
        says(&found, "took the board `checkerboard` (20 points of the sensor arm)");
        says(&found, "ignored the joints head_pan");
        assert_eq!(found.data.pictures.cameras[0].name, "eye");
        assert_same(&session, name, &found, 0.0);
    }
    let found = session.read(&[("lines.jsonl", &all(false).join("\n"))], &session.options).unwrap();
    says(&found, "took the stated board, by the order of its points, and not those of arm");
    assert_same(&session, "with --camera and --markers", &found, 0.0);
}

/// The flow form of YAML with its outer keys on lines of their own.
fn block_form(text: &str) -> String {
    let message = |text: &str| {
        let inner = text.trim().strip_prefix('{').and_then(|it| it.strip_suffix('}')).unwrap();
        let (states, observations) = inner.split_once(",\"observations\":").unwrap();
        let states = states.strip_prefix("\"joint_states\":").unwrap();
        format!("joint_states: {states}\nobservations:\n  {observations}")
    };
    text.split("\n---\n").map(message).collect::<Vec<_>>().join("\n---\n")
}

#[test]
fn mistakes_in_messages_are_named() {
    let session = Session::new();
    let none = ReadOptions::default();
    let good: Vec<String> = session.pictures().map(|it| message(&session, it, true)).collect();
    let text = good.join("\n");
    let joint = format!("\"{}\"", session.data.reading_names()[1]);
    for (changed, parts) in [
        (
            text.replacen(&joint, "\"other\"", 1),
            &["m.jsonl:1:1: found no joint `", "in `joint_states` (head_pan, "][..],
        ),
        (good[..3].join("\n") + "\n" + &good[3].replace(&joint, "\"other\""), &["m.jsonl:4:1: found no joint `"]),
        (text.replace("\"z\":0.0", "\"z\":0.7"), &["of the sensor `eye`, as a 3-D camera sees it, expected pixels"]),
        (text.replacen("\"position\":[0.5,", "\"position\":[", 1), &["found 7 names and 6 positions"]),
        (text.replacen("\"x\":", "\"w\":", 1), &["m.jsonl:1:", "without `x`"]),
        (text.replacen("\"sensor_name\":\"eye\",", "", 1), &["without `sensor_name`"]),
        (text.replacen("[0.5,", "[NaN,", 1), &["m.jsonl:1:"]),
        (text.replacen("1920", "1921", 1), &["found another `camera_info` of `eye`"]),
        (text.replace("\"arm\"", "\"arm\",\"features\":[]},{\"sensor_name\":\"none\""), &[]),
        (text.replacen("\"k\":[", "\"k\":[1,", 1), &["found 10 numbers of the camera's matrix `K`, expected 9"]),
        ("[\"joint_states\"]".to_owned(), &["found `joint_states`, expected messages of robot_calibration"]),
        ("{\"joint_states\":1".to_owned(), &["m.jsonl:1:", "expected messages of robot_calibration"]),
    ] {
        if parts.is_empty() {
            assert!(session.read(&[("m.jsonl", &changed)], &none).is_ok());
        } else {
            session.fails(&[("m.jsonl", &changed)], &none, parts);
        }
    }
    // A 3-D camera whose lens is not stated, and no board.
    let dots =
        |at: usize| {
            format!("{{\"sensor_name\":\"depth\",\"features\":[{}]}},", (0..5).map(|k| {
        format!("{{\"header\":{{\"frame_id\":\"optical\"}},\"point\":{{\"x\":0.{k}{at},\"y\":0.1,\"z\":0.9}}}}")
    }).collect::<Vec<_>>().join(","))
        };
    let deep: Vec<String> = good
        .iter()
        .enumerate()
        .map(|(at, text)| text.replacen("\"observations\":[", &format!("\"observations\":[{}", dots(at)), 1))
        .collect();
    session.fails(
        &[("m.json", &deep.join("\n"))],
        &none,
        &["of the sensor `depth` in metres that move in its frame `optical`"],
    );
    let alone: Vec<String> =
        good.iter().map(|text| text.split(",{\"sensor_name\":\"arm\"").next().unwrap().to_owned() + "]}").collect();
    session.fails(
        &[("m.json", &alone.join("\n"))],
        &none,
        &["found 20 features of `eye` in pixels and no other sensor"],
    );
    let small = ReadOptions { boards: read_boards("chessboard:5x5:40mm").unwrap(), ..none.clone() };
    session.fails(
        &[("m.json", &alone.join("\n"))],
        &small,
        &["found 20 features of `eye`, expected the 16 points of the board"],
    );
    let stated = ReadOptions { boards: session.options.boards.clone(), ..none };
    assert_same(
        &session,
        "without the arm, with --markers",
        &session.read(&[("m.json", &alone.join("\n"))], &stated).unwrap(),
        0.0,
    );
}

/// Files damaged at regular intervals are refused or read, and no damage makes the program panic.
#[test]
fn damaged_messages_are_told_in_one_line() {
    let session = Session::new();
    let good: Vec<String> = session.pictures().take(2).map(|it| message(&session, it, true)).collect();
    let (mut read, mut errors) = (0, 0);
    for text in [good.join("\n"), block_form(&good.join("\n---\n"))] {
        for at in (0..text.len()).step_by(41) {
            for with in ["", "}", "]", "\n", ": ", "\"", "-", "x", "...", "1e9", "\u{0}"] {
                let changed = format!("{}{with}{}", &text[..at], &text[at + 1..]);
                for changed in [changed.as_str(), &changed[..at]] {
                    match parse(changed, "m.yaml", &session.robot, &ReadOptions::default()) {
                        Ok(_) => read += 1,
                        Err(error) => {
                            errors += 1;
                            assert!(!error.to_string().contains('\n'), "{error}");
                        }
                    }
                }
            }
        }
    }
    println!("{read} read, {errors} refused");
    assert!(errors > 100);
}

const CAL_DATA: &str = "data:\n  - pose: poses/0.yaml\n    image: images/0.png\ntarget_finder:\n  type: ModifiedCircleGridTargetFinder\n  rows: 10\n  cols: 12\n  \
                        spacing: 0.0254 # m\nintrinsics:\n  fx: 550.0\n  fy: 551.0\n  cx: 320.0\n  cy: 240.0\n";

#[test]
fn boards_and_lenses_of_other_programs_are_read() {
    let folder = Folder::new();
    let charuco = |dictionary: &str| {
        format!(
            "target_finder:\n  type: CharucoGridTargetFinder\n  rows: 7\n  cols: 5\n  chessboard_dim: 0.036\n  aruco_marker_dim: 0.018\n{dictionary}"
        )
    };
    let opencv = |pattern: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<opencv_storage><Settings>\n<BoardSize_Width>9</BoardSize_Width>\n<BoardSize_Height>6</BoardSize_Height>\n<Square_Size>25</Square_Size>\n<Calibrate_Pattern>\"{pattern}\"</Calibrate_Pattern>\n</Settings></opencv_storage>\n"
        )
    };
    for (name, text, words) in [
        ("cal_data.yaml", CAL_DATA.to_owned(), "circles:12x10:25.4mm"),
        ("charuco.yaml", charuco("  dictionary: DICT_5X5_100\n"), "charuco:5x7:36mm:18mm:DICT_5X5_100"),
        ("charuco.yaml", charuco("  dictionary: 10\n"), "charuco:5x7:36mm:18mm:DICT_6X6_250"),
        ("charuco.yaml", charuco(""), "charuco:5x7:36mm:18mm:DICT_6X6_250"),
        ("april.yaml", "target_type: 'aprilgrid' # tags\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n".to_owned(), "aprilgrid:6x5:88mm:0.3"),
        ("checker.yaml", "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n".to_owned(), "chessboard:7x8:60mm"),
        ("dots.yml", "target_type: circlegrid\ntargetCols: 6\ntargetRows: 7\nspacingMeters: 0.02\nasymmetricGrid: False\n".to_owned(), "circles:6x7:20mm"),
        ("dots.yml", "target_type: circlegrid\ntargetCols: 4\ntargetRows: 11\nspacingMeters: 0.02\nasymmetricGrid: true\n".to_owned(), "circles:4x11:20mm:asymmetric"),
        ("settings.xml", opencv("CHESSBOARD"), "chessboard:10x7:25mm"),
        ("settings.xml", opencv("ASYMMETRIC_CIRCLES_GRID"), "circles:9x6:25mm:asymmetric"),
        ("settings.yml", "%YAML:1.0\n---\nSettings:\n   BoardSize_Width: 9\n   BoardSize_Height: 6\n   Square_Size: 0.025\n   Calibrate_Pattern: \"CIRCLES_GRID\"\n".to_owned(), "circles:9x6:25mm"),
    ] {
        let path = folder.write(name, &text);
        let typed = path.to_str().unwrap();
        let found = board_of_file(typed).unwrap().unwrap();
        println!("{}", folder.without_path(&found.said));
        assert_eq!(found.words, words);
        assert_eq!(read_boards(typed).unwrap(), read_boards(words).unwrap());
        assert!(!found.said.contains("did not read"), "{}", found.said);
        let mut options = ReadOptions::default();
        options.add_boards(typed).unwrap();
        assert_eq!(options.said, [found.said]);
    }
    let april = "target_type: aprilgrid\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n";
    let settings = opencv("CHESSBOARD");
    for (name, text, end) in [
        ("other.yaml", format!("{april}material: glass\nthickness: 3\n"), "; did not read `material`, `thickness`"),
        ("neutral.yaml", format!("{april}print_scale: 1.0\nserial: 4\n"), "(Kalibr)"),
        ("other.yaml", charuco("  paint: red\n"), "; did not read `paint`"),
        (
            "other.xml",
            settings.replace("</Settings>", "<Input_FlipAroundHorizontalAxis>0</Input_FlipAroundHorizontalAxis><Show_It>1</Show_It><Frame>2</Frame></Settings>"),
            "; did not read `Frame`",
        ),
    ] {
        let found = board_of_file(folder.write(name, &text).to_str().unwrap()).unwrap().unwrap();
        assert!(found.said.ends_with(end), "{}", found.said);
    }
    for (name, text, key) in [
        ("scaled.yaml", format!("{april}print_scale: 0.98\n"), ":6: found `0.98` for `print_scale`"),
        ("scaled.yaml", charuco("  scale_factor: 2\n"), "for `target_finder.scale_factor`"),
        (
            "flipped.xml",
            settings.replace("</Settings>", "<Input_FlipAroundHorizontalAxis>1</Input_FlipAroundHorizontalAxis></Settings>"),
            "found `1` for `Settings.Input_FlipAroundHorizontalAxis`",
        ),
        (
            "flipped.yml",
            "Settings:\n  BoardSize_Width: 9\n  BoardSize_Height: 6\n  Square_Size: 25\n  Calibrate_Pattern: CHESSBOARD\n  Input_FlipAroundHorizontalAxis: 1\n".to_owned(),
            "found `1` for `Settings.Input_FlipAroundHorizontalAxis`",
        ),
    ] {
        let error = board_of_file(folder.write(name, &text).to_str().unwrap()).unwrap_err().to_string();
        assert!(error.contains(key) && error.contains("expected the board as it is printed"), "{error}");
    }
    for (text, part) in [
        ("a: 1\n", "found no board, expected a board: YAML of Kalibr"),
        ("target_type: aprilgrid\ntagCols: 6\n", "found no `tagRows`, expected it"),
        ("target_type: aprilgrid\ntagCols: six\n", ":2: found `six` for `tagCols`, expected a count"),
        (
            "target_type: assembly\n",
            ":1: found `assembly` for `target_type`, expected aprilgrid, checkerboard or circlegrid",
        ),
        (
            "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: 0.05\n",
            ":5: found `0.05` for `colSpacingMeters`, expected the same",
        ),
        ("target_type: aprilgrid\ncodeOffset: 10\n", "found `10` for `codeOffset`, expected 0"),
        (
            "target_type: checkerboard\ntargetCols: 1\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n",
            "found a board of 2 × 8 squares",
        ),
        ("target_finder:\n  type: Aruco\n", ":2: found `Aruco` for `type`, expected ModifiedCircleGridTargetFinder"),
        (&charuco("  dictionary: 99\n"), "found `99` for `dictionary`"),
        ("a: [", "found broken YAML"),
    ] {
        let path = folder.write("board.yaml", text);
        let error = read_boards(path.to_str().unwrap()).unwrap_err().to_string();
        println!("{}", folder.without_path(&error));
        assert!(error.contains(part) && error.contains("board.yaml"), "{error}");
    }
    let path = folder.write("cal_data.yaml", CAL_DATA);
    let camera = read_cameras(path.to_str().unwrap()).unwrap().cameras.remove(0);
    assert_eq!((camera.lens.focal_px, camera.lens.centre_px), ([550.0, 551.0], [320.0, 240.0]));
    let half = folder.write("half.yaml", "intrinsics:\n  fx: 550.0\n");
    assert!(
        read_cameras(half.to_str().unwrap()).unwrap_err().to_string().contains("found 0 numbers of `camera_matrix`")
    );
}

#[test]
fn pictures_with_poses_are_refused_with_what_is_missing() {
    let session = Session::new();
    session.fails(
        &[("cal_data.yaml", CAL_DATA)],
        &session.options,
        &["cal_data.yaml: found pictures with poses", "expected the joint readings of each picture"],
    );
    session.fails(&[("other.yaml", "a: 1\n")], &session.options, &["other.yaml: found YAML without `joint_states`"]);
}
