//! Corners in the forms of other programs: each form of one simulated session has its rows and its calibration, and each mistake its sentence.

use std::fmt::Write as _;

use poecal_calibrate::calibrate;
use poecal_import::{ColumnMap, MeasurementFile, ReadOptions, parse, read, read_boards};
use poecal_model::camera::{CommonError, Corner, Picture};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_model::simulate::{PictureSimulation, Simulation, elbow};

use poecal_testing::files::Folder;
use poecal_testing::sessions::geometry;

const BOARD: &str = "chessboard:6x5:40mm";

/// A session with its corners to 1e-4 px, and readings to 1e-9 rad.
pub(crate) struct Session {
    pub(crate) data: Dataset,
    pub(crate) robot: Robot,
    pub(crate) options: ReadOptions,
}

impl Session {
    pub(crate) fn new() -> Self {
        let session = Simulation {
            count: 20,
            seed: 5,
            error_rotation_rad: 3e-3,
            error_position_m: 1e-3,
            ..Simulation::default()
        };
        let board = read_boards(BOARD).unwrap().remove(0);
        let still = CommonError { shift_m: 0.0, turn_rad: 0.0, ..CommonError::default() };
        let usual = PictureSimulation { common: still, ..PictureSimulation::with_usual_camera(session, true) };
        let lens = usual.lens;
        let made = usual.with_board_and_lens(board.clone(), lens).run(&elbow()).unwrap();
        let options =
            ReadOptions { cameras: made.data.pictures.cameras.clone(), boards: vec![board], ..ReadOptions::default() };
        Session { data: made.data, robot: made.nominal, options }
    }

    /// The options without a stated board.
    fn without_boards(&self) -> ReadOptions {
        ReadOptions { boards: Vec::new(), ..self.options.clone() }
    }

    pub(crate) fn pictures(&self) -> impl Iterator<Item = (usize, &Picture)> {
        self.data.pictures.all.iter().enumerate()
    }

    pub(crate) fn readings(&self, picture: usize) -> Vec<String> {
        self.data.readings(picture).iter().map(|it| format!("{it:.9}")).collect()
    }

    /// A table of all corners.
    pub(crate) fn corners(&self, header: &str, row: impl Fn(usize, &Corner) -> String) -> String {
        let rows = self
            .pictures()
            .flat_map(|(at, picture)| picture.corners.iter().map(|corner| row(at, corner)).collect::<Vec<_>>());
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

    /// The position of a corner on its board, millimetres.
    pub(crate) fn place_mm(&self, corner: &Corner) -> [String; 3] {
        let point = self.options.boards[0].points[corner.point as usize];
        [point.x, point.y, point.z].map(|it| format!("{:.3}", 1e3 * it))
    }

    pub(crate) fn read(&self, files: &[(&str, &str)], options: &ReadOptions) -> Result<MeasurementFile, String> {
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

    pub(crate) fn fails(&self, files: &[(&str, &str)], options: &ReadOptions, parts: &[&str]) {
        let error = self.read(files, options).err().unwrap_or_default();
        println!("{error}");
        for part in parts {
            assert!(error.contains(part), "{part}: {error}");
        }
        assert!(!error.contains('\n'));
    }

    /// The files in our own form.
    pub(crate) fn own_files(&self) -> [(&'static str, String); 2] {
        let corners = self.corners("image,target,u[px],v[px]", |at, corner| {
            format!("{at:03}.png,corner{},{:.4},{:.4}", corner.point, corner.pixel.x, corner.pixel.y)
        });
        [("joints.csv", self.joints("image", |at| format!("{at:03}.png"))), ("corners.csv", corners)]
    }
}

pub(crate) fn as_texts<'a>(files: &'a [(&'a str, String)]) -> Vec<(&'a str, &'a str)> {
    files.iter().map(|(name, text)| (*name, text.as_str())).collect()
}

/// Largest difference of corners and readings of two files, pixels and radians.
fn largest_differences(one: &MeasurementFile, other: &MeasurementFile) -> (f64, f64) {
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
fn judge_session(session: &Session, file: &MeasurementFile) -> [f64; 2] {
    let found = calibrate(&session.robot, &file.data, &geometry()).unwrap();
    let pixels = found.accuracy.held_out.unwrap().calibrated.pixels.unwrap();
    [pixels.rms_px, pixels.rms_mm]
}

/// Compares a form with ours, and prints the result.
pub(crate) fn assert_same(session: &Session, what: &str, found: &MeasurementFile, digits: f64) {
    let ours = session.read(&as_texts(&session.own_files()), &session.options).unwrap();
    let (px, rad) = largest_differences(&ours, found);
    let ([own_px, own_mm], [px_rms, mm]) = (judge_session(session, &ours), judge_session(session, found));
    println!(
        "{what}: {px:.1e} px and {rad:.1e} rad apart; held out {px_rms:.4} px, {mm:.4} mm, ours {own_px:.4} px, {own_mm:.4} mm"
    );
    for word in &found.warnings {
        println!("  {word}");
    }
    assert!(px <= digits && rad < 1e-9, "{px} px, {rad} rad");
    assert!((own_px - px_rms).abs() < 1e-6 && (own_mm - mm).abs() < 1e-6);
}

pub(crate) fn says(file: &MeasurementFile, part: &str) {
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
    says(&found, "took the numbers of corners for the points of the board, as counted from 1: `1` is `corner0`");
    assert_same(&session, "HALCON, from 1", &found, 0.0);
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
            let ours = session.read(&as_texts(&session.own_files()), &session.options).unwrap();
            assert_eq!(largest_differences(&ours, &found), (0.0, 0.0), "{x} {name}");
            says(&found, &format!("`{x}` for u, `{y}` for v, `{name}` for target, `filename` for image"));
        }
    }

    for (names, factor) in
        [("X[mm],Y[mm],Z[mm]", 1.0), ("obj_x,obj_y,obj_z", 1e-3), ("object_x_mm,object_y_mm,object_z_mm", 1.0)]
    {
        let row = |at: usize, it: &Corner| {
            let place = session.place_mm(it).map(|it| (it.parse::<f64>().unwrap() * factor).to_string());
            format!("{at:03}.png,{},{},{}", place.join(","), u(it), v(it))
        };
        let header = format!("image_id,{names},x_px,y_px");
        let found = read_as(&header, &row, &session.without_boards());
        says(&found, "took the places of the corners for the board `board` of 20 points, 160.0 x 120.0 x 0.0 mm");
        assert_same(&session, &format!("places on the board, {names}"), &found, 0.0);
        assert_same(&session, "the same beside a stated board", &read_as(&header, &row, &session.options), 0.0);
    }
}

/// Joints in each row, beside columns that count rows or name something else.
#[test]
fn rows_with_joints_need_no_other_file() {
    let session = Session::new();
    let names = session.data.reading_names().join(",");
    for (header, cell) in [("index,frame", "base"), ("id,File", "all.png")] {
        let count = std::cell::Cell::new(0);
        let corners = session.corners(&format!("{header},X[mm],Y[mm],Z[mm],row,col,{names}"), |at, it| {
            let (place, readings) = (session.place_mm(it).join(","), session.readings(at).join(","));
            count.set(count.get() + 1);
            format!("{},{cell},{place},{:.4},{:.4},{readings}", count.get(), it.pixel.y, it.pixel.x)
        });
        let found = session.read(&[("corners.csv", &corners)], &session.without_boards()).unwrap();
        says(&found, "ignored the columns `i");
        assert_same(&session, header, &found, 0.0);
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
        let found = session.read(&[("corners.csv", &corners), ("joints.csv", &joints)], &session.options).unwrap();
        says(&found, "took the pictures whose names end in the same number for the same, 20 of 20: `image-0.png` is");
        assert_same(&session, &name(7), &found, 0.0);
    }
    // Numbers that two pictures share join none.
    let twice = corners.replace("image-3.png", "other-4.png");
    let joints = session.joints("image", |at| format!("configuration_{at}"));
    let found = session.read(&[("corners.csv", &twice), ("joints.csv", &joints)], &session.options).unwrap();
    assert_eq!(found.data.len(), 18);
    says(&found, "left out the pictures that have corners and no joint readings: 2 (image-4.png, other-4.png)");
    says(&found, "left out the pictures that have joint readings and no corners: 2 (configuration_3, configuration_4)");
    // Names precede numbers.
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

#[test]
fn mistakes_in_tables_are_named() {
    let session = Session::new();
    let joints = session.joints("image", |at| format!("{at:03}.png"));
    let fails = |header: &str, row: &dyn Fn(usize, &Corner) -> String, parts: &[&str]| {
        let corners = session.corners(header, row);
        session.fails(&[("corners.csv", &corners), ("joints.csv", &joints)], &session.options, parts);
    };
    let numbered = |by: u32| {
        move |at: usize, it: &Corner| format!("{at:03}.png,{},{:.4},{:.4}", it.point + by, it.pixel.x, it.pixel.y)
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
    for (columns, cells) in [("x,y,z,row,column", "0.8,0.1,0.3,1,2"), ("x[mm],y[mm],z[mm],id,file", "800,100,300,1,a")]
    {
        let file = parse(&text(columns, cells), "t.csv", &session.robot, &options).unwrap();
        assert_eq!((file.understood[0].points, file.data.pictures.all.len()), (1, 0), "{columns}");
    }
    // The columns px, py and pz are a vector.
    let error = parse(&text("px,py,pz", "0.8,0.1,0.3"), "t.csv", &session.robot, &options).unwrap_err().to_string();
    assert!(error.contains("found no column `x`"), "{error}");
    let folder = Folder::new();
    let map = folder.write("map.toml", "position = { columns = [\"px\", \"py\", \"h\"] }\n");
    let options = ReadOptions { mapping: Some(ColumnMap::read(&map).unwrap()), ..options };
    assert_eq!(
        parse(&text("px,py,h", "0.8,0.1,0.3"), "t.csv", &session.robot, &options).unwrap().understood[0].points,
        1
    );
}
