//! Limits of files: each refuses with its name, before the work, and `--limit` moves it.

use std::fmt::Write as _;
use std::fs;

use crate::folder::Folder;
use crate::session::ROBOT;
use crate::workbook::workbook;

/// A robot, and a session of it as a table, a workbook and a program.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.run_to_success("simulate robot.urdf --kind point --count 30 --out made");
    let text = folder.read("made/measurements.csv");
    let rows: Vec<Vec<String>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    folder.write("points.csv", text);
    fs::write(folder.path("points.xlsx"), workbook(&[("Rows", &rows)])).unwrap();
    // Beside the columns of the table, and far below it.
    let mut far = rows;
    far.resize(9_000, Vec::new());
    far.push([vec![String::new(); 20], vec!["1".to_owned()]].concat());
    fs::write(folder.path("far.xlsx"), workbook(&[("Rows", &far)])).unwrap();
    folder.run_to_success("export robot.urdf --format toml --out robot.toml");
    folder
}

#[test]
fn a_file_beyond_a_limit_is_refused_by_its_name() {
    let folder = folder();
    for (limit, words, part) in [
        ("text=500", "check robot.urdf points.csv", "it is larger than 500 bytes"),
        ("settings=100", "check robot.toml points.csv", "found more than 100 bytes in a model in TOML"),
        ("table=1KiB", "check robot.urdf points.csv", "it is larger than 1 KiB"),
        ("rows=29", "check robot.urdf points.csv", "found more than 29 rows in one file"),
        ("columns=5", "check robot.urdf points.csv", " columns, expected at most 5 columns"),
        ("elements=20", "check robot.urdf points.csv", "found more than 20 elements in an XML file"),
        ("nesting=1", "check robot.urdf points.csv", "found more than 1 levels in each other"),
        ("workbook=1KiB", "check robot.urdf points.xlsx", "found more than 1 KiB in a workbook"),
        ("unpacked=1KiB", "check robot.urdf points.xlsx", "found more than 1 KiB in the parts of this workbook"),
        ("cells=9000", "check robot.urdf far.xlsx", "found a sheet of 9001 rows and 21 columns"),
    ] {
        let name = limit.split('=').next().unwrap();
        let before = folder.listing();
        let run = folder.run(&format!("{words} --limit {limit}"));
        println!("{}", run.err.trim_end());
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{limit}: {}{}", run.out, run.err);
        assert!(run.err.contains(part), "{limit}: {}", run.err);
        // The depth of brackets is bounded by the stack.
        let is_told = run.err.contains(&format!("--limit {name}=N")) || name == "nesting";
        assert!(is_told && run.err.lines().count() == 1, "{limit}: {}", run.err);
        assert_eq!(folder.listing(), before);
        assert_eq!(folder.run(words).code, 0, "{words}");
    }
    // A line that no form could have.
    folder.write("wide.csv", format!("a,b,c\n{}\n", ",".repeat(99)));
    let run = folder.run("check robot.urdf wide.csv --limit columns=5");
    assert!(run.code == 2 && run.err.contains("wide.csv:2: found 100 columns, expected at most 5"), "{}", run.err);
    // More is read on request.
    let lower = "check robot.urdf points.csv --limit rows=29";
    assert_eq!(folder.run(&format!("{lower} --limit rows=30")).code, 0);
    for (typed, part) in [
        ("rowss=3", "--limit: found the limit `rowss`, expected one of text, program"),
        ("rows", "--limit: found `rows`, expected a name and a number"),
        ("rows=0", "--limit: found `rows=0`, expected a number from 1 to"),
    ] {
        let run = folder.run(&format!("check robot.urdf points.csv --limit {typed}"));
        assert!(run.code == 2 && run.err.contains(part), "{}", run.err);
    }
    // `compare` has a limit of the change too.
    folder.run("calibrate robot.urdf points.csv --out out");
    let compare = "compare out/calibration.json out/calibration.json";
    assert_eq!(folder.run(&format!("{compare} --limit 0.5mm --limit text=1GiB")).code, 0);
    let run = folder.run(&format!("{compare} --limit 0.5mm --limit text=500"));
    assert!(run.code == 2 && run.err.contains("--limit text=N"), "{}", run.err);
    // Settings come from elsewhere.
    folder.write(
        "poecal.toml",
        "poecal_settings = 1\nmodel = \"robot.urdf\"\nmeasurements = [\"points.csv\"]\nlimit = [\"rows=3\"]\n",
    );
    let run = folder.run("check --settings poecal.toml");
    assert!(run.code == 2 && run.err.contains("limit"), "{}", run.err);
}

/// A table with one cell far off took memory for all between: the sheet of a spreadsheet has 17,179,869,184 cells.
#[test]
fn a_stray_cell_is_one_sentence() {
    let folder = folder();
    let mut bytes = fs::read(folder.path("points.xlsx")).unwrap();
    // The archive is not packed: the last row is moved as far as rows go, under a name of the same length.
    let cell = bytes.windows(7).position(|it| it == b"r=\"A31\"").unwrap();
    bytes[cell..cell + 7].copy_from_slice(b"r=\"ZZ9\"");
    fs::write(folder.path("stray.xlsx"), &bytes).unwrap();
    let run = folder.run("check robot.urdf stray.xlsx --limit cells=10000");
    assert_eq!(run.code, 2, "{}{}", run.out, run.err);
    assert!(run.err.contains("limit `cells`"), "{}", run.err);
}

/// Expressions that are nested take time and stack by their depth.
#[test]
fn nested_expressions_are_refused_in_every_language() {
    let folder = folder();
    let folder = &folder;
    folder.run("calibrate robot.urdf points.csv --out out");
    for (name, begin, open, close, end) in [
        ("p.script", "def a():\n  movel(", "pose_trans(p[0,0,0,0,0,0],", ")", ")\nend\n"),
        ("p.src", "DEF a()\n PTP ", "(", ")", "\nEND\n"),
        ("p.mod", "MODULE a\nCONST num b:=", "[", "]", ";\nENDMODULE\n"),
        ("p.ls", "/PROG A\n/MN\n 1: R[1]=", "(", ")", " ;\n/END\n"),
    ] {
        for depth in [199, 20_000] {
            let text = format!("{begin}{}1{}{end}", open.repeat(depth), close.repeat(depth));
            folder.write(name, text);
            let start = std::time::Instant::now();
            let run = folder.run(&format!("compensate out/calibration.json {name} --out corrected --force"));
            println!(
                "{name}, {depth}: {:.2} s, {}",
                start.elapsed().as_secs_f64(),
                run.err.lines().last().unwrap_or_default()
            );
            assert!(run.code <= 2, "{name}: {}", run.err);
            let is_refused = run.err.contains("found more than 200 levels in brackets in each other");
            assert_eq!(is_refused && run.code == 2, depth > 200, "{name}, {depth}: {}", run.err);
            // With the square of the depth it was minutes.
            assert!(start.elapsed().as_secs() < 20, "{name}");
        }
    }
    let (open, close) = ("<link name='a'>".repeat(300), "</link>".repeat(300));
    folder.write("deep.urdf", format!("<robot name='a'>\n{open}{close}</robot>"));
    let run = folder.run("check deep.urdf");
    assert!(run.code == 2 && run.err.contains("deep.urdf:2:"), "{}", run.err);
    assert!(run.err.contains("found more than 200 levels in each other"), "{}", run.err);
}

/// Keys of one mapping, and columns, are found without a search through all of them.
#[test]
fn many_keys_and_columns_take_no_time() {
    let folder = folder();
    let mut yaml = String::from("camera_info:\n");
    (0..60_000).for_each(|at| writeln!(yaml, "  key{at}: 1").unwrap());
    folder.write("many.yaml", yaml);
    let mut header = (0..16_000).map(|at| format!("c{at}.name{at}")).collect::<Vec<_>>().join(",");
    header.push('\n');
    folder.write("many.csv", format!("{header}{}\n", vec!["x"; 16_000].join(",")));
    for words in
        ["check robot.urdf many.yaml", "check robot.urdf many.csv", "check robot.urdf points.csv --camera many.yaml"]
    {
        let start = std::time::Instant::now();
        let run = folder.run(words);
        println!("{words}: {:.2} s, {}", start.elapsed().as_secs_f64(), run.err.trim_end());
        assert!(run.code == 2 && start.elapsed().as_secs() < 20, "{words}: {}", run.err);
    }
}

/// Pictures: the head is asked before memory is taken.
#[cfg(any(unix, windows))]
#[test]
fn pictures_beyond_a_limit_are_refused() {
    let folder = Folder::new();
    let gray = |width: usize, height: usize, level: &dyn Fn(usize, usize) -> f32| {
        let levels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| level(x, y));
        poecal_detect::Gray::new(width, height, levels.collect()).unwrap()
    };
    let save = |name: &str, gray: &poecal_detect::Gray| {
        fs::write(folder.path(name), poecal_detect::preview(gray, &[]).unwrap()).unwrap();
    };
    save("a.png", &gray(300, 200, &|_, _| 128.0));
    // A mesh: dots of a pitch of 12 pixels.
    let mesh = |x: usize, y: usize| {
        let (dx, dy) = ((x % 12) as f32 - 5.5, (y % 12) as f32 - 5.5);
        (40.0 * ((dx * dx + dy * dy).sqrt() - 3.5) + 128.0).clamp(30.0, 220.0)
    };
    save("mesh.png", &gray(480, 360, &mesh));
    for (limit, board, name, part) in [
        (
            "pixels=59999",
            "chessboard:10x7:27mm",
            "a.png",
            "found a picture of 300 x 200 pixels, expected at most 59,999 pixels",
        ),
        ("picture=100", "chessboard:10x7:27mm", "a.png", "found more than 100 bytes in one picture"),
        ("dots=300", "circles:7x5:20mm", "mesh.png", "too many dots: more than 300 parts look like one"),
    ] {
        let run = folder.run(&format!("detect {name} --board {board} --limit {limit} --out corners.csv"));
        assert!(run.code == 2 && run.err.contains(part), "{limit}: {}{}", run.out, run.err);
    }
    let most = poecal_storage::limits::ResourceLimit::Pixels.row().usual;
    assert_eq!(
        (most, poecal_storage::limits::ResourceLimit::Dots.row().usual as usize),
        (poecal_detect::MOST_PIXELS, poecal_detect::MOST_DOTS)
    );
}

/// A camera has pictures of some size.
#[test]
fn a_camera_without_a_size_is_refused() {
    let folder = folder();
    for (name, text) in [
        ("a.csv", "name,fx,fy,cx,cy,width,height\nc,800,800,400,300,SIZE,600\n"),
        (
            "a.yaml",
            "image_width: SIZE\nimage_height: 600\ncamera_matrix:\n  data: [800, 0, 400, 0, 800, 300, 0, 0, 1]\n",
        ),
        (
            "b.yaml",
            "cam0:\n  camera_model: pinhole\n  intrinsics: [800, 800, 400, 300]\n  distortion_model: none\n  distortion_coeffs: []\n  resolution: [SIZE, 600]\n",
        ),
        (
            "a.xml",
            "<root><camera><name>c</name><image_width>SIZE</image_width><image_height>600</image_height><model><px>800</px><py>800</py><u0>400</u0><v0>300</v0></model></camera></root>",
        ),
    ] {
        for size in ["0", "-1", "800.5"] {
            folder.write(name, text.replace("SIZE", size));
            let run = folder.run(&format!("check robot.urdf points.csv --camera {name}"));
            let part = format!("found pictures of {size} × 600 pixels");
            assert!(run.code == 2 && run.err.contains(&part), "{name} {size}: {}", run.err);
        }
        folder.write(name, text.replace("SIZE", "800"));
        let run = folder.run(&format!("check robot.urdf points.csv --camera {name}"));
        assert!(!run.err.contains("found pictures of"), "{name}: {}", run.err);
    }
}
