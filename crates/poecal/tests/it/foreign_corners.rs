//! Corners as other programs write them: each form of one simulated session gives its rows and its calibration, and each mistake its sentence.

use std::fmt::Write as _;

use poecal::calibrate;
use poecal::camera::{CommonError, Corner, Picture};
use poecal::io::measurements::{
    ColumnMap, MeasurementFile, ReadOptions, board_of_file, parse, read, read_boards, read_cameras,
};
use poecal::measurement::Dataset;
use poecal::robot::Robot;
use poecal::simulate::{PictureSimulation, Simulation, elbow};

use crate::common::geometry;
use crate::files::Folder;

const BOARD: &str = "chessboard:6x5:40mm";

/// A session with its corners to 1e-4 px, and readings to 1e-9 rad.
struct Session {
    data: Dataset,
    robot: Robot,
    options: ReadOptions,
}

impl Session {
    fn new() -> Self {
        let session = Simulation {
            count: 20,
            seed: 5,
            error_rotation_rad: 3e-3,
            error_position_m: 1e-3,
            ..Simulation::default()
        };
        let board = read_boards(BOARD).unwrap().remove(0);
        let still = CommonError { shift_m: 0.0, turn_rad: 0.0, ..CommonError::default() };
        let usual = PictureSimulation { common: still, ..PictureSimulation::usual(session, true) };
        let lens = usual.lens;
        let made = usual.before(board.clone(), lens).run(&elbow()).unwrap();
        let options = ReadOptions {
            cameras: made.data.pictures.cameras.clone(),
            boards: vec![board],
            ..ReadOptions::default()
        };
        Session { data: made.data, robot: made.nominal, options }
    }

    /// The same without a stated board.
    fn without_boards(&self) -> ReadOptions {
        ReadOptions { boards: Vec::new(), ..self.options.clone() }
    }

    fn pictures(&self) -> impl Iterator<Item = (usize, &Picture)> {
        self.data.pictures.all.iter().enumerate()
    }

    fn readings(&self, picture: usize) -> Vec<String> {
        self.data.readings(picture).iter().map(|it| format!("{it:.9}")).collect()
    }

    /// A table of all corners.
    fn corners(&self, header: &str, row: impl Fn(usize, &Corner) -> String) -> String {
        let rows = self.pictures().flat_map(|(at, picture)| {
            picture.corners.iter().map(|corner| row(at, corner)).collect::<Vec<_>>()
        });
        rows.fold(format!("{header}\n"), |text, row| text + &row + "\n")
    }

    /// A table of the readings of each picture.
    fn joints(&self, header: &str, name: impl Fn(usize) -> String) -> String {
        let mut text = format!("{header},{}\n", self.data.reading_names().join(","));
        for at in 0..self.data.pictures.all.len() {
            writeln!(text, "{},{}", name(at), self.readings(at).join(",")).unwrap();
        }
        text
    }

    /// The place of a corner on its board, millimetres.
    fn place_mm(&self, corner: &Corner) -> [String; 3] {
        let point = self.options.boards[0].points[corner.point as usize];
        [point.x, point.y, point.z].map(|it| format!("{:.3}", 1e3 * it))
    }

    fn read(&self, files: &[(&str, &str)], options: &ReadOptions) -> Result<MeasurementFile, String> {
        let folder = Folder::new();
        let paths: Vec<_> = files.iter().map(|(name, text)| folder.write(name, text)).collect();
        let file = read(&paths, &self.robot, options);
        file.map(|mut file| {
            for word in &mut file.warnings {
                *word = folder.without_path(word);
            }
            file
        })
        .map_err(|error| folder.without_path(&error.to_string()))
    }

    fn fails(&self, files: &[(&str, &str)], options: &ReadOptions, parts: &[&str]) {
        let error = self.read(files, options).err().unwrap_or_default();
        println!("{error}");
        for part in parts {
            assert!(error.contains(part), "{part}: {error}");
        }
        assert!(!error.contains('\n'));
    }

    /// The files in our own form.
    fn ours(&self) -> [(&'static str, String); 2] {
        let corners = self.corners("image,target,u[px],v[px]", |at, corner| {
            format!("{at:03}.png,corner{},{:.4},{:.4}", corner.point, corner.pixel.x, corner.pixel.y)
        });
        [("joints.csv", self.joints("image", |at| format!("{at:03}.png"))), ("corners.csv", corners)]
    }
}

fn as_texts<'a>(files: &'a [(&'a str, String)]) -> Vec<(&'a str, &'a str)> {
    files.iter().map(|(name, text)| (*name, text.as_str())).collect()
}

/// Largest difference of corners and readings of two files, pixels and radians.
fn apart(one: &MeasurementFile, other: &MeasurementFile) -> (f64, f64) {
    assert_eq!(one.data.len(), other.data.len());
    let (mut px, mut rad): (f64, f64) = (0.0, 0.0);
    for (at, (own, others)) in one.data.pictures.all.iter().zip(&other.data.pictures.all).enumerate() {
        assert_eq!(own.corners.len(), others.corners.len());
        for (own, others) in own.corners.iter().zip(&others.corners) {
            px = px.max((own.pixel - others.pixel).norm());
        }
        for (own, others) in one.data.readings(at).iter().zip(other.data.readings(at)) {
            rad = rad.max((own - others).abs());
        }
    }
    (px, rad)
}

/// Held-out error of its calibration, pixels and mm.
fn judged(session: &Session, file: &MeasurementFile) -> [f64; 2] {
    let found = calibrate(&session.robot, &file.data, &geometry()).unwrap();
    let pixels = found.accuracy.held_out.unwrap().calibrated.pixels.unwrap();
    [pixels.rms_px, pixels.rms_mm]
}

/// Compares a form with ours, and says what was read of it.
fn same(session: &Session, what: &str, found: &MeasurementFile, digits: f64) {
    let ours = session.read(&as_texts(&session.ours()), &session.options).unwrap();
    let (px, rad) = apart(&ours, found);
    let ([own_px, own_mm], [px_rms, mm]) = (judged(session, &ours), judged(session, found));
    println!(
        "{what}: {px:.1e} px and {rad:.1e} rad apart; held out {px_rms:.4} px, {mm:.4} mm, ours {own_px:.4} px, {own_mm:.4} mm"
    );
    for word in &found.warnings {
        println!("  {word}");
    }
    assert!(px <= digits && rad < 1e-9, "{px} px, {rad} rad");
    assert!((own_px - px_rms).abs() < 1e-6 && (own_mm - mm).abs() < 1e-6);
}

fn says(file: &MeasurementFile, part: &str) {
    assert!(file.warnings.iter().any(|it| it.contains(part)), "{part}: {:?}", file.warnings);
}

#[test]
fn tables_of_other_programs_are_the_same_session() {
    let session = Session::new();
    let [u, v] = [|it: &Corner| format!("{:.4}", it.pixel.x), |it: &Corner| format!("{:.4}", it.pixel.y)];
    let joints = session.joints("image", |at| format!("{at:03}.png"));
    let read_as = |header: &str, row: &dyn Fn(usize, &Corner) -> String, options: &ReadOptions| {
        let corners = session.corners(header, row);
        session.read(&[("corners.csv", &corners), ("joints.csv", &joints)], options).unwrap()
    };
    let halcon = |at: usize, it: &Corner| format!("{at:03}.png,{},{},{}", it.point + 1, v(it), u(it));
    let found = read_as("Picture,Mark,Row,Column", &halcon, &session.options);
    says(&found, "took `Column` for u, `Row` for v, `Mark` for target, `Picture` for image");
    says(&found, "as counted from 1: `1` is `corner0`");
    same(&session, "HALCON, from 1", &found, 0.0);
    let columns = &found.understood[0].columns;
    let of = |name: &str| columns.iter().find(|it| it.name == name).and_then(|it| it.column.clone());
    assert_eq!((of("u"), of("v")), (Some("Column".to_owned()), Some("Row".to_owned())));

    for [x, y] in [
        ["x_px", "y_px"],
        ["px", "py"],
        ["u_px", "v_px"],
        ["x[px]", "y[px]"],
        ["Pixel X", "Pixel Y"],
        ["image_x", "image_y"],
    ] {
        for name in ["corner", "corner_id", "id", "index", "point", "marker"] {
            let row = |at: usize, it: &Corner| format!("{at:03}.png,{},{},{}", it.point, u(it), v(it));
            let found = read_as(&format!("filename,{name},{x},{y}"), &row, &session.options);
            let ours = session.read(&as_texts(&session.ours()), &session.options).unwrap();
            assert_eq!(apart(&ours, &found), (0.0, 0.0), "{x} {name}");
            says(&found, &format!("`{x}` for u, `{y}` for v, `{name}` for target, `filename` for image"));
        }
    }

    for (names, factor) in [
        ("X[mm],Y[mm],Z[mm]", 1.0),
        ("obj_x,obj_y,obj_z", 1e-3),
        ("object_x_mm,object_y_mm,object_z_mm", 1.0),
    ] {
        let row = |at: usize, it: &Corner| {
            let place = session.place_mm(it).map(|it| (it.parse::<f64>().unwrap() * factor).to_string());
            format!("{at:03}.png,{},{},{}", place.join(","), u(it), v(it))
        };
        let header = format!("image_id,{names},x_px,y_px");
        let found = read_as(&header, &row, &session.without_boards());
        says(
            &found,
            "took the places of the corners for the board `board` of 20 points, 160.0 x 120.0 x 0.0 mm",
        );
        same(&session, &format!("places on the board, {names}"), &found, 0.0);
        same(&session, "the same beside a stated board", &read_as(&header, &row, &session.options), 0.0);
    }
}

#[test]
fn pictures_with_the_same_number_are_the_same() {
    let session = Session::new();
    let corners = session.corners("image,target,u[px],v[px]", |at, it| {
        format!("image-{at}.png,corner{},{:.4},{:.4}", it.point, it.pixel.x, it.pixel.y)
    });
    for name in [
        |at| format!("configuration_{at}"),
        |at| format!("joints/configuration_{at}.yaml"),
        |at| format!("{at}"),
        |at| format!("IMG_{at:04}.jpg"),
    ] {
        let joints = session.joints("file", name);
        let found =
            session.read(&[("corners.csv", &corners), ("joints.csv", &joints)], &session.options).unwrap();
        says(
            &found,
            "took the pictures whose names end in the same number for the same, 20 of 20: `image-0.png` is",
        );
        same(&session, &name(7), &found, 0.0);
    }
    // Numbers that two pictures have join none.
    let twice = corners.replace("image-3.png", "other-4.png");
    let joints = session.joints("image", |at| format!("configuration_{at}"));
    let found = session.read(&[("corners.csv", &twice), ("joints.csv", &joints)], &session.options).unwrap();
    assert_eq!(found.data.len(), 18);
    says(
        &found,
        "left out the pictures that have corners and no joint readings: 2 (image-4.png, other-4.png)",
    );
    says(
        &found,
        "left out the pictures that have joint readings and no corners: 2 (configuration_3, configuration_4)",
    );
    // Names go before numbers.
    let mixed = session.joints("image", |at| match at {
        0 => "image-1.png".to_owned(),
        1 => "image-0.png".to_owned(),
        _ => format!("image-{at}.png"),
    });
    let found = session.read(&[("corners.csv", &corners), ("joints.csv", &mixed)], &session.options).unwrap();
    assert!(!found.warnings.iter().any(|it| it.contains("same number")));
    assert_eq!(found.data.readings(0)[0], session.readings(1)[0].parse::<f64>().unwrap());
    let strange = session.joints("image", |at| format!("no number {at}!"));
    session.fails(
        &[("corners.csv", &corners), ("joints.csv", &strange)],
        &session.options,
        &["corners.csv: found no picture that has joint readings, as `image-0.png` beside `no number 0!`"],
    );
}

/// A message of robot_calibration in JSON.
fn message(session: &Session, (at, picture): (usize, &Picture), camera: bool) -> String {
    let names: Vec<String> = session.data.reading_names().iter().map(|it| format!("\"{it}\"")).collect();
    let feature = |frame: &str, [x, y]: [String; 2]| {
        format!("{{\"header\":{{\"frame_id\":\"{frame}\"}},\"point\":{{\"x\":{x},\"y\":{y},\"z\":0.0}}}}")
    };
    let own = |corner: &Corner| {
        feature("optical", [format!("{:.4}", corner.pixel.x), format!("{:.4}", corner.pixel.y)])
    };
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
        poecal::camera::Distortion::Brown(k) => format!("{:?}", &k[..5]),
        poecal::camera::Distortion::Fisheye(_) => unreachable!(),
    };
    let info = match camera {
        true => format!(
            "{{\"width\":1920,\"height\":1200,\"distortion_model\":\"plumb_bob\",\"d\":{d},\"k\":{k}}}"
        ),
        false => "{\"width\":0,\"height\":0,\"distortion_model\":\"\",\"d\":[],\"k\":[0,0,0,0,0,0,0,0,0]}"
            .to_owned(),
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
    let all =
        |camera| -> Vec<String> { session.pictures().map(|it| message(&session, it, camera)).collect() };
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
        same(&session, name, &found, 0.0);
    }
    let found = session.read(&[("lines.jsonl", &all(false).join("\n"))], &session.options).unwrap();
    says(&found, "took the board of --markers, by the order of its points, and not those of arm");
    same(&session, "with --camera and --markers", &found, 0.0);
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
        (
            good[..3].join("\n") + "\n" + &good[3].replace(&joint, "\"other\""),
            &["m.jsonl:4:1: found no joint `"],
        ),
        (
            text.replace("\"z\":0.0", "\"z\":0.7"),
            &["of the sensor `eye`, as a 3-D camera sees it, expected pixels"],
        ),
        (text.replacen("\"position\":[0.5,", "\"position\":[", 1), &["found 7 names and 6 positions"]),
        (text.replacen("\"x\":", "\"w\":", 1), &["m.jsonl:1:", "without `x`"]),
        (text.replacen("\"sensor_name\":\"eye\",", "", 1), &["without `sensor_name`"]),
        (text.replacen("[0.5,", "[NaN,", 1), &["m.jsonl:1:"]),
        (text.replacen("1920", "1921", 1), &["found another `camera_info` of `eye`"]),
        (text.replace("\"arm\"", "\"arm\",\"features\":[]},{\"sensor_name\":\"none\""), &[]),
        (
            text.replacen("\"k\":[", "\"k\":[1,", 1),
            &["found 10 numbers of the camera's matrix `K`, expected 9"],
        ),
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
    let dots = |at: usize| {
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
    let alone: Vec<String> = good
        .iter()
        .map(|text| text.split(",{\"sensor_name\":\"arm\"").next().unwrap().to_owned() + "]}")
        .collect();
    session.fails(
        &[("m.json", &alone.join("\n"))],
        &none,
        &["found 20 features of `eye` in pixels and no other sensor"],
    );
    let small = ReadOptions { boards: read_boards("chessboard:5x5:40mm").unwrap(), ..none.clone() };
    session.fails(
        &[("m.json", &alone.join("\n"))],
        &small,
        &["found 20 features of `eye`, expected one board of --markers with as many points, not 1 of 16"],
    );
    let stated = ReadOptions { boards: session.options.boards.clone(), ..none };
    same(
        &session,
        "without the arm, with --markers",
        &session.read(&[("m.json", &alone.join("\n"))], &stated).unwrap(),
        0.0,
    );
}

#[test]
fn mistakes_in_tables_are_named() {
    let session = Session::new();
    let joints = session.joints("image", |at| format!("{at:03}.png"));
    let fails = |header: &str, row: &dyn Fn(usize, &Corner) -> String, parts: &[&str]| {
        let corners = session.corners(header, row);
        session.fails(&[("corners.csv", &corners), ("joints.csv", &joints)], &session.options, parts);
    };
    let numbered = |by: u32| {
        move |at: usize, it: &Corner| {
            format!("{at:03}.png,{},{:.4},{:.4}", it.point + by, it.pixel.x, it.pixel.y)
        }
    };
    fails(
        "image,id,px,py",
        &numbered(2),
        &["corners.csv:", "found the corner `20`, expected one of the board's 20: corner0"],
    );
    fails(
        "image,id,corner_id,row,column,px,py",
        &|at, it| format!("{at:03}.png,0,{},1,2,3,4", it.point),
        &["corners.csv:1:", "found the pixel in column `column` and again in `px`"],
    );
    fails(
        "image,Corner,corner,px,py",
        &|at, it| format!("{at:03}.png,{},1,3,4", it.point),
        &["corners.csv:1:14: found a second column `corner` beside `Corner`"],
    );
    fails("image,px,py", &|at, _| format!("{at:03}.png,3,4"), &["found no column `target`"]);
    fails(
        "image,id,px,py",
        &|at, it| format!("{at:03}.png,{}{},3,4", if it.point == 3 { "corner" } else { "" }, it.point),
        &["found the corner `corner3` beside ones that are numbered, as `0`"],
    );
    fails(
        "image,id,px[mm],py",
        &numbered(0),
        &["corners.csv:1:10: found the unit `mm` of `px`, expected `px` or none"],
    );
    let placed = |by: f64| {
        move |at: usize, it: &Corner| {
            format!(
                "{at:03}.png,{},{},0,{:.4},{:.4}",
                f64::from(it.point % 5) * 40.0 + by,
                it.point / 5 * 40,
                it.pixel.x,
                it.pixel.y
            )
        }
    };
    fails(
        "image,X[mm],Y[mm],Z[mm],px,py",
        &placed(2.0),
        &["corners.csv:2:9: found a corner at (2, 0, 0) mm", "the nearest is `corner0` at (0, 0, 0) mm"],
    );
    fails(
        "image,X,Y,Z,px,py",
        &placed(0.0),
        &["found `40` for a place on the board, 40 m, expected a point of a board"],
    );
    let moved = session.corners("image,point,X[mm],Y[mm],Z[mm],px,py", |at, it| {
        format!("{at:03}.png,p{},{},{},0,1,2", it.point, it.point + at as u32, it.point)
    });
    session.fails(
        &[("corners.csv", &moved), ("joints.csv", &joints)],
        &session.without_boards(),
        &["corners.csv:22:", "found the corner `p0` at (1, 0, 0) mm, expected (0, 0, 0) mm"],
    );
}

#[test]
fn positions_are_no_pixels() {
    let session = Session::new();
    let names = session.data.reading_names().join(",");
    let zeros = session.readings(0).join(",");
    let text = |columns: &str, cells: &str| format!("{names},{columns}\n{zeros},{cells}\n");
    let options = ReadOptions::default();
    for (columns, cells) in
        [("x,y,z,row,column", "0.8,0.1,0.3,1,2"), ("x[mm],y[mm],z[mm],id,file", "800,100,300,1,a")]
    {
        let file = parse(&text(columns, cells), "t.csv", &session.robot, &options).unwrap();
        assert_eq!((file.understood[0].points, file.data.pictures.all.len()), (1, 0), "{columns}");
    }
    // px, py and pz are a vector.
    let error =
        parse(&text("px,py,pz", "0.8,0.1,0.3"), "t.csv", &session.robot, &options).unwrap_err().to_string();
    assert!(error.contains("found no column `x`"), "{error}");
    let folder = Folder::new();
    let map = folder.write("map.toml", "position = { columns = [\"px\", \"py\", \"h\"] }\n");
    let options = ReadOptions { mapping: Some(ColumnMap::read(&map).unwrap()), ..options };
    assert_eq!(
        parse(&text("px,py,h", "0.8,0.1,0.3"), "t.csv", &session.robot, &options).unwrap().understood[0]
            .points,
        1
    );
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
        let mut options = ReadOptions::default();
        options.add_boards(typed).unwrap();
        assert_eq!(options.said, [found.said]);
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
        (
            "target_finder:\n  type: Aruco\n",
            ":2: found `Aruco` for `type`, expected ModifiedCircleGridTargetFinder",
        ),
        (&charuco("  dictionary: 99\n"), "found `99` for `dictionary`"),
        ("a: [", "found broken YAML"),
    ] {
        let path = folder.write("board.yaml", text);
        let error = read_boards(path.to_str().unwrap()).unwrap_err().to_string();
        println!("{}", folder.without_path(&error));
        assert!(error.contains(part) && error.contains("board.yaml"), "{error}");
    }
    let camera = read_cameras(folder.write("cal_data.yaml", CAL_DATA).to_str().unwrap()).unwrap().remove(0);
    assert_eq!((camera.lens.focal_px, camera.lens.centre_px), ([550.0, 551.0], [320.0, 240.0]));
    let half = folder.write("half.yaml", "intrinsics:\n  fx: 550.0\n");
    assert!(
        read_cameras(half.to_str().unwrap())
            .unwrap_err()
            .to_string()
            .contains("without all of fx, fy, cx and cy")
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
    session.fails(
        &[("other.yaml", "a: 1\n")],
        &session.options,
        &["other.yaml: found YAML without `joint_states`"],
    );
}
