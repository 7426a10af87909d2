//! Rewrites `fuzz/seeds` from the project's own examples and from small simulated sessions; found inputs stay. Run by hand, when a form of file
//! changes: `cargo run -p poecal-fuzz --example seeds`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_formats::robot_toml;
use poecal_fuzz::BETWEEN;
use poecal_import::read_boards;
use poecal_model::camera::{Corner, Lens, Picture};
use poecal_model::measurement::Dataset;
use poecal_model::robot::Robot;
use poecal_model::simulate::{PictureSimulation, SessionKind, Simulation, elbow, gantry, scara};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::residuals::Residuals;

const DOCUMENT: &str = include_str!("../../../docs/file-formats.md");
const URDF: &str = include_str!("../../../examples/elbow/robot.urdf");
const TOML: &str = include_str!("../../../examples/elbow/robot.toml");
const POINTS: &str = include_str!("../../../examples/elbow/points.csv");
/// A calibration of an earlier schema: poses and points, suspected and repeated rows.
const CALIBRATED: &str = include_str!("../../poecal-testing/data/calibration.json");
const CALIBRATED_ROWS: &str = include_str!("../../poecal-testing/data/calibration_rows.csv");
const UR10_MAP: &str = include_str!("../../../validation/ur10_raw_columns.toml");
/// A follower, a fixed joint within the chain, a comment, entities.
const MIMIC: &str = r#"<?xml version="1.0"?>
<!-- a gripper's finger -->
<robot name="a &amp; b">
  <link name="base"><visual><geometry><mesh filename="base.stl"/></geometry></visual></link>
  <link name="turn"/><link name="plate"/><link name="left"/><link name="right"/>
  <joint name="j1" type="continuous"><parent link="base"/><child link="turn"/><origin rpy="0 0.1 0"/></joint>
  <joint name="fixed" type="fixed"><parent link="turn"/><child link="plate"/><origin xyz="0.1 0 0.2"/></joint>
  <joint name="j2" type="prismatic"><parent link="plate"/><child link="left"/><axis xyz="0 1 0"/><limit lower="0" upper="0.05"/></joint>
  <joint name="j3" type="revolute"><parent link="left"/><child link="right"/><axis xyz="0 0.6 0.8"/><limit lower="-1" upper="1"/>
    <mimic joint="j1" multiplier="-0.5" offset="0.1"/></joint>
</robot>
"#;

const WORKBOOK: &[u8] = include_bytes!("../../../examples/howto/joints.xlsx");
const WORKBOOK_POINTS: &[u8] = include_bytes!("../../../examples/howto/points.txt");
const RAPID: &str = include_str!("../../poecal-compensate/tests/it/programs/rapid/01_simple.mod");
const FANUC: &str = include_str!("../../poecal-compensate/tests/it/programs/fanuc/01_simple.ls");
const URSCRIPT: &str = "def a():\n  set_tcp(p[0, 0, 0.1, 0, 0, 0])\n  movej([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], a=1.4) # start\n  \
    movel(p[0.5, 0.1, 0.4, 0, 3.14, 0], v=0.1)\n  f = p[0.1, 0, 0, 0, 0, 0]\n  movel(pose_trans(f, p[0.4, 0.1, 0.4, 0, 3.14, 0]))\nend\n";
const KRL: &str = "DEF a()\n  $TOOL={X 0,Y 0,Z 100,A 0,B 0,C 0}\n  $BASE={FRAME: X 0,Y 0,Z 0,A 0,B 0,C 0}\n  PTP {A1 10,A2 20,A3 30,A4 40,A5 50,A6 60} ; start\n  \
    LIN {X 500,Y 100,Z 400,A 0,B 90,C 0}\n  PTP {POS: X 500,Y 0,Z 400,A 0,B 90,C 0,S 2,T 10}\nEND\n";

const MJCF: &str = include_str!("../../../tests/python/models/arm.xml");
const SDF: &str = include_str!("../../../tests/python/models/arm.sdf");
const CONF: &str = "[DH]
a = [0, -0.6127, -0.57155, 0, 0, 0]
d = [0.1807, 0, 0, 0.17415, 0.11985, 0.11655]
alpha = [1.5707963, 0, 0, 1.5707963, -1.5707963, 0] # rad
[mounting]
delta_theta = [1e-4, -0.1, 0.67, -0.57, 1e-4, 1e-5]
delta_a = [3e-5, 0.32, 2e-2, 2e-5, 7e-5, 0]
delta_d = [5e-4, 11.2, -92.5, 81.3, 1e-4, 1e-4]
delta_alpha = [-3e-4, 2e-3, 1e-3, -2e-5, 5e-4, 0]
calibration_status = 2
";

fn main() {
    let put = |target: &str, name: &str, text: &str| put_bytes(target, name, text.as_bytes());
    let both = |a: &str, b: &str| format!("{a}\n{BETWEEN}\n{b}");
    let (xml, models) = (blocks("Robot models", "xml"), blocks("Robot models", "toml"));
    for (name, text) in [("elbow", URDF), ("slide", xml[0]), ("mimic", MIMIC)] {
        put("urdf", name, text);
    }
    let driver = |at: f64| format!("{{x: 0.1, y: {at}, z: 0, roll: 0.1, pitch: 0, yaw: 0}}");
    let links = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];
    let origins: Vec<String> = links.iter().map(|link| format!("  {link}: {}", driver(0.2))).collect();
    put("foreign", "mjcf", MJCF);
    put("foreign", "sdf", SDF);
    put("foreign", "yaml", &format!("kinematics:\n{}\n  hash: calib_1\n", origins.join("\n")));
    put("foreign", "conf", CONF);
    for (language, program) in [("rapid", RAPID), ("fanuc", FANUC), ("urscript", URSCRIPT), ("krl", KRL)] {
        put("programs", language, &format!("{language}\n{program}"));
    }
    put("robot_toml", "elbow", TOML);
    put("robot_toml", "gantry", &robot_toml::write(&gantry()));
    models.iter().enumerate().for_each(|(index, text)| put("robot_toml", &format!("form{index}"), text));
    let maps = blocks("Measurements", "toml");
    maps.iter().enumerate().for_each(|(index, text)| put("mapping", &format!("form{index}"), text));
    put("mapping", "ur10", UR10_MAP);
    put("mapping", "targets", TARGETS_MAP);
    put("mapping", "other", OTHER_MAP);
    put("settings", "form", blocks("Settings", "toml")[0]);
    put(
        "settings",
        "all",
        "poecal_settings = 1\nmodel = 'a b.urdf'\nmeasurements = [\"a.csv\", 'b.csv']\nheld_out = 0.30\nforce = true\n",
    );

    let points = POINTS.lines().take(9).map(|line| format!("{line}\n")).collect::<String>();
    put("measurements", "points", &points);
    put(
        "measurements",
        "semicolons",
        "\u{feff}# c\r\n\"id\";joint1[deg];joint2[deg];joint3[mm];joint4;x[mm];y[mm];z[mm];target;set\r\n1;12,5;-40;100;0;512,3;-40;130,5;\"a \"\"b\"\"\";fit\r\n2;3;15,25;50;1;540,7;102;112;b;held_out\r\n",
    );
    put("measurements", "mapped", &both(MAPPED, OTHER_MAP));
    for (name, text) in CAMERAS {
        put("cameras", name, text);
    }
    for (name, text) in BOARDS {
        put("boards", name, text);
    }
    let all = messages();
    put("messages", "lines", &all.join("\n"));
    // Blocks, also without the lens.
    put("messages", "blocks", &format!("---\n{}", all.iter().map(|it| block(it)).collect::<Vec<_>>().join("\n---\n")));
    for (name, text) in recorded_files() {
        put_bytes("recorded", &name, &text);
    }
    for (target, name, bytes) in binary().into_iter().chain(lists()) {
        put_bytes(target, name, &bytes);
    }
    put("joints", "points", &points);
    put("joints", "ids", "id,joint1,joint2,joint3,joint4\na,0.1,0.2,0.1,1\n\"b,c\",0.2,0.1,0,-1\n");
    for (name, robot, kind, count) in [
        ("scara", scara(), SessionKind::POSE, 20),
        ("gantry", gantry(), SessionKind::POINT, 20),
        ("elbow", elbow(), SessionKind::MIXED, 26),
    ] {
        let made = Simulation { count, ..Simulation::default() }.run(&robot, kind).unwrap();
        let table = table(&made.data);
        put("pipeline", name, &both(&robot_toml::write(&robot), &table));
        if name != "gantry" {
            put("measurements", name, &table);
        }
        if name == "elbow" {
            continue;
        }
        let calibration = calibrate(&robot, &made.data, &CalibrationOptions::default()).unwrap();
        let json = CalibrationFile::new(&calibration, &made.data, Inputs::default()).to_text().unwrap();
        let residuals = Residuals::from_calibration(&made.data, &calibration).text();
        put("calibration", name, &json);
        put("residuals", name, &residuals);
        put("report", name, &both(&json, &residuals));
    }
    put("calibration", "mixed", CALIBRATED);
    put("report", "mixed", &both(CALIBRATED, CALIBRATED_ROWS));
    let two = two_targets(&gantry());
    put("pipeline", "two_targets", &both(&robot_toml::write(&gantry()), &two));
    let twelve = POINTS.lines().take(31).map(|line| format!("{line}\n")).collect::<String>();
    put("pipeline", "urdf", &both(URDF, &twelve));
}

fn put_bytes(target: &str, name: &str, bytes: &[u8]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(target);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), bytes).unwrap();
    println!("{target}/{name}: {} bytes", bytes.len());
}

/// Rows of an elbow: readings (deg) and points (mm), with their columns.
fn rows() -> Vec<Vec<String>> {
    let made = Simulation { count: 4, ..Simulation::default() }.run(&elbow(), SessionKind::POINT).unwrap().data;
    let header = made.reading_names().iter().map(|it| format!("{it}[deg]"));
    let header = header.chain(["x[mm]", "y[mm]", "z[mm]"].map(str::to_owned)).collect();
    let row = |at: usize| {
        let readings = made.readings(at).iter().map(|it| format!("{:.5}", it.to_degrees()));
        let point = made.observations[at].measurement.pose().translation;
        readings.chain(point.iter().map(|it| format!("{:.5}", it * 1e3))).collect()
    };
    std::iter::once(header).chain((0..made.len()).map(row)).collect()
}

/// Workbooks, as parts of archives and of the old form; bags; pictures.
fn binary() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let rows = rows();
    let parts = |all: &[(&str, String)]| {
        let all: Vec<String> = all.iter().map(|(name, content)| format!("{name}\n{content}")).collect();
        all.join(&format!("\n{BETWEEN}\n")).into_bytes()
    };
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let each = |row: &dyn Fn(usize, &[String]) -> String| {
        rows.iter().enumerate().map(|(at, cells)| row(at, cells)).collect::<String>()
    };
    let row = |at: usize, cells: &[String]| {
        let cell = |(column, text): (char, &String)| match is_number(text) {
            true => format!("<c r=\"{column}{}\"><v>{text}</v></c>", at + 1),
            false => format!("<c r=\"{column}{}\" t=\"inlineStr\"><is><t>{text}</t></is></c>", at + 1),
        };
        format!(
            "<row r=\"{}\">{}</row>",
            at + 1,
            ('A'..).zip(cells).filter(|it| !it.1.is_empty()).map(cell).collect::<String>()
        )
    };
    let sheet = each(&row);
    let heads = ["Joint angles (deg),,,,,,Measured (mm),,", "1,2,3,4,5,6,X,Y,Z"];
    let heads = heads.map(|it| it.split(',').map(str::to_owned).collect::<Vec<_>>());
    let under_groups: String = heads.iter().chain(&rows[1..]).enumerate().map(|(at, cells)| row(at, cells)).collect();
    let office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let link = |kind: &str, to: &str| {
        format!(
            "<Relationships xmlns=\"{package}\"><Relationship Id=\"rId1\" Type=\"{office}/{kind}\" Target=\"{to}\"/></Relationships>"
        )
    };
    let workbook = |sheet: &str| {
        parts(&[
            (
                "xl/worksheets/sheet1.xml",
                format!(
                    "<worksheet xmlns=\"{main}\"><dimension ref=\"A1:I5\"/><sheetData>{sheet}</sheetData></worksheet>"
                ),
            ),
            (
                "xl/workbook.xml",
                format!(
                    "<workbook xmlns=\"{main}\" xmlns:r=\"{office}\"><sheets><sheet name=\"A\" sheetId=\"1\" r:id=\"rId1\"/></sheets></workbook>"
                ),
            ),
            ("xl/_rels/workbook.xml.rels", link("worksheet", "worksheets/sheet1.xml")),
            ("_rels/.rels", link("officeDocument", "xl/workbook.xml")),
        ])
    };
    let (xlsx, two_heads) = (workbook(&sheet), workbook(&under_groups));
    let table = each(&|_, cells| {
        let cell = |text: &String| match is_number(text) {
            true => format!(
                "<table:table-cell office:value-type=\"float\" office:value=\"{text}\"><text:p>{text}</text:p></table:table-cell>"
            ),
            false => {
                format!("<table:table-cell office:value-type=\"string\"><text:p>{text}</text:p></table:table-cell>")
            }
        };
        let cells: String = cells.iter().map(cell).collect();
        format!("<table:table-row>{cells}<table:table-cell table:number-columns-repeated=\"9\"/></table:table-row>")
    });
    let ods = parts(&[
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet".to_owned()),
        ("META-INF/manifest.xml", "<manifest:manifest/>".to_owned()),
        (
            "content.xml",
            format!(
                "<office:document-content><office:body><office:spreadsheet><table:table table:name=\"A\">{table}</table:table></office:spreadsheet></office:body></office:document-content>"
            ),
        ),
    ]);
    let joints = |at: usize| {
        let mut cdr = Cdr::new(at);
        cdr.list(&(1..=6).map(|joint| format!("joint{joint}")).collect::<Vec<_>>());
        let own = rows[at + 1].iter().take(6);
        cdr.numbers(&own.map(|it| it.parse::<f64>().unwrap().to_radians()).collect::<Vec<_>>());
        cdr
    };
    let points: String = rows.iter().map(|row| row[6..].join(",") + "\n").collect();
    let between = format!("\n{BETWEEN}{BETWEEN}\n");
    let bag = [bag("sensor_msgs/msg/JointState", &joints), between.into_bytes(), points.into_bytes()].concat();
    let gray = |width: usize, height: usize| {
        let level = |at: usize| if (at % width / 5 + at / width / 5).is_multiple_of(2) { 30.0 } else { 220.0 };
        poecal_detect::Gray::new(width, height, (0..width * height).map(level).collect()).unwrap()
    };
    vec![
        ("workbooks", "xlsx", xlsx),
        ("workbooks", "two_heads", two_heads),
        ("workbooks", "ods", ods),
        ("workbooks", "xls", old_workbook(&rows)),
        ("bags", "joints", bag),
        ("pictures", "png", poecal_detect::preview(&gray(60, 40), &[]).unwrap()),
        ("pictures", "jpeg", include_bytes!("../../poecal-detect/tests/it/pictures/gray.jpg").to_vec()),
        ("pictures", "progressive", include_bytes!("../../poecal-detect/tests/it/pictures/progressive.jpg").to_vec()),
    ]
}

/// An old workbook (.xls) of these rows.
fn old_workbook(rows: &[Vec<String>]) -> Vec<u8> {
    let record = |kind: u16, data: &[u8]| [&kind.to_le_bytes(), &(data.len() as u16).to_le_bytes(), data].concat();
    let begin = record(0x0809, &[0, 6, 5, 0]);
    let globals = |start: u32| {
        let name = [&start.to_le_bytes()[..], &[0, 0, 1, 0], b"A"].concat();
        [begin.clone(), record(0x00E0, &[0; 4]), record(0x0085, &name), record(0x000A, &[])].concat()
    };
    let mut stream = [globals(globals(0).len() as u32), begin.clone()].concat();
    for (row, cells) in (0_u16..).zip(rows) {
        for (column, text) in (0_u16..).zip(cells) {
            let place = [row.to_le_bytes(), column.to_le_bytes(), [0, 0]].concat();
            stream.extend(match text.parse::<f64>() {
                Ok(number) => record(0x0203, &[place, number.to_le_bytes().to_vec()].concat()),
                Err(_) => {
                    let size = (text.len() as u16).to_le_bytes();
                    record(0x0204, &[place, size.to_vec(), vec![0], text.as_bytes().to_vec()].concat())
                }
            });
        }
    }
    stream.extend(record(0x000A, &[]));
    poecal_testing::old_workbook::container(&stream)
}

/// Lists of poses, a ledger and a history.
fn lists() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let first = |text: &str, count: usize| text.lines().take(count).map(|line| format!("{line}\n")).collect::<String>();
    let sample = |text: &str| text.repeat(3).into_bytes();
    let row = |serial: &str, exit: u8| {
        format!(
            "{{\"schema\":\"poecal-fleet-1\",\"time\":\"2026-01-01T00:00:00Z\",\"serial\":\"{serial}\",\"date\":\"2026-01-01\",\"type\":\"\",\"file\":\"a.csv\",\"results\":\"r\",\"inputs\":[{{\"file\":\"a.csv\",\"sha256\":\"00\"}}],\"poecal_version\":\"0.1.0\",\"exit\":{exit},\"reason\":null,\"verdict\":\"good\",\"accepted\":null,\"rows\":30,\"error_rms\":0.1,\"error_of\":\"held_out\",\"noise\":0.05,\"corrections\":[{{\"joint\":\"j1\",\"offset\":0.1,\"sigma_offset\":0.01,\"unit\":\"deg\",\"tilt_deg\":0.1,\"sigma_tilt_deg\":0.01,\"shift_mm\":0.1,\"sigma_shift_mm\":null}}],\"terms\":[{{\"joint\":\"j1\",\"group\":\"sag\",\"amplitude\":1.0,\"sigma\":0.1,\"found\":true}}]}}\n"
        )
    };
    let check = "{\"time\":\"2026-01-01T00:00:00Z\",\"schema\":\"SCHEMA\",\"count\":3,\"verdict\":{},\"inputs\":{\"calibration\":\"c.json\",\"sha256\":{\"c.json\":\"00\"}}}\n";
    let histories = ["poecal-validation-1", "poecal-track-1"].map(|it| check.replace("SCHEMA", it)).concat();
    vec![
        ("hand_eye", "pairs", first(include_str!("../../../examples/howto/hand_eye.csv"), 9).into_bytes()),
        ("hand_eye", "moveit", sample("- effector_wrt_world: [0, -1, 0, 0.4, 1, 0, 0, -0.1, 0, 0, 1, 0.5, 0, 0, 0, 1]\n  object_wrt_sensor: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0.4, 0, 0, 0, 1]\n")),
        ("hand_eye", "easy", sample("- robot:\n    rotation: {w: 1.0, x: 0.0, y: 0.0, z: 0.0}\n    translation: {x: 0.4, y: 0.1, z: 0.5}\n  tracking:\n    rotation: {w: 0.0, x: 1.0, y: 0.0, z: 0.0}\n    translation: {x: 0.0, y: 0.1, z: 0.4}\n")),
        ("hand_eye", "franka", format!("{},rvec_x,rvec_y,rvec_z,tvec_x,tvec_y,tvec_z\n0,1,0,0,-1,0,0,0,0,0,1,0,0.4,-0.1,0.5,1,0.1,0.2,0.3,0,0,0.4\n", (0..16).map(|at| format!("O_T_EE[{at}]")).collect::<Vec<_>>().join(",")).into_bytes()),
        ("tcp", "touches", first(include_str!("../../../examples/howto/touches.csv"), 9).into_bytes()),
        ("ledgers", "two", [row("SN1", 0), row("SN2", 1), row("SN1", 2)].concat().into_bytes()),
        ("histories", "two", histories.into_bytes()),
    ]
}

/// A line of a file by its number, the readings and the position.
type Line<'a> = &'a dyn Fn(usize, &[f64], [f64; 3]) -> String;

/// Four configurations of an elbow (degrees), and points of its tip (mm), in the forms of instruments, controllers and recorders: each with a file of
/// the other kind.
fn recorded_files() -> Vec<(String, Vec<u8>)> {
    let robot = elbow();
    let made = Simulation { count: 4, ..Simulation::default() }.run(&robot, SessionKind::POINT).unwrap().data;
    let numbers = |values: &[f64], factor: f64, by: &str| {
        values.iter().map(|it| format!("{:.5}", it * factor)).collect::<Vec<_>>().join(by)
    };
    let degrees = 1_f64.to_degrees();
    let each = |of: Line<'_>| -> String {
        let row =
            |at: usize| of(at + 1, made.readings(at), made.observations[at].measurement.pose().translation.into());
        (0..made.len()).map(row).collect()
    };
    let own_joints =
        format!("{}\n", made.reading_names().join("[deg],")) + &each(&|_, it, _| numbers(it, degrees, ",") + "\n");
    let own_points = "x[mm],y[mm],z[mm]\n".to_owned() + &each(&|_, _, it| numbers(&it, 1e3, ",") + "\n");
    let motive = "Format Version,1.24,Take Name,A,Export Frame Rate,100.0,Rotation Type,Quaternion,Length Units,Millimeters\n\n,Type,Marker,Marker,Marker\n\
         ,Name,A,A,A\n,ID,1,1,1\n,,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n"
        .to_owned();
    let qualisys = "NO_OF_FRAMES\t4\nNO_OF_MARKERS\t1\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\tA\nFrame\tTime\tA X\tA Y\tA Z\n".to_owned();
    let attributes = |it: &[f64], letter: char| -> String {
        (1..).zip(it).map(|(at, it)| format!(" {letter}{at}=\"{:.3}\"", it * degrees)).collect()
    };
    let vicon = "Trajectories\n100\n,,A:A,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n".to_owned();
    let segments = "Segments\n100\n,,A:A,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,rad,rad,rad,mm,mm,mm\n".to_owned();
    let joints = [
        (
            "rapid",
            each(&|k, it, _| {
                format!(
                    "CONST jointtarget P{k}:=[[{}],[9E9,9E9,9E9,9E9,9E9,9E9]];\n",
                    numbers(it, degrees, ",")
                )
            }),
        ),
        (
            "rokae",
            each(&|k, it, _| {
                format!(
                    "LOCAL VAR jointtarget j{k} = j:{{{},0}}{{EJ 0,0,0,0,0,0}}\n",
                    numbers(it, degrees, ",")
                )
            }),
        ),
        (
            "script",
            format!("def a():\n{}end\n", each(&|_, it, _| format!("  movej([{}])\n", numbers(it, 1.0, ",")))),
        ),
        (
            "log",
            format!(
                "timestamp {} {}\n",
                (0..6).map(|k| format!("target_q_{k}")).collect::<Vec<_>>().join(" "),
                (0..6).map(|k| format!("actual_q_{k}")).collect::<Vec<_>>().join(" ")
            ) + &each(&|k, it, _| format!("{k}.5 {0} {0}\n", numbers(it, degrees, " "))),
        ),
        ("bare", each(&|_, it, _| numbers(it, degrees, " ") + "\n")),
        (
            "fanuc_registers",
            "[*POSREG*]$POSREG  Storage: CMOS  Access: RW  : ARRAY[1,9] OF Position Reg\n    [1,8] =   '' Uninitialized\n".to_owned()
                + &each(&|k, it, _| {
                    let axes: Vec<String> = (1..).zip(it).map(|(at, it)| format!("J{at} = {:.3} deg", it * degrees)).collect();
                    format!("    [1,{k}] =   'P{k}'   Group: 1\n  {}\n  {}\n", axes[..3].join("   "), axes[3..].join("   "))
                }),
        ),
        (
            "staubli",
            format!(
                "<?xml version=\"1.0\" ?>\n<Database xmlns=\"http://www.staubli.com/robotics/VAL3/Data/2\">\n<Datas>\n<Data name=\"j\" type=\"jointRx\" size=\"4\">\n{}</Data>\n</Datas>\n</Database>\n",
                each(&|k, it, _| format!("<Value key=\"{}\"{} />\n", k - 1, attributes(it, 'j')))
            ),
        ),
        (
            "rsi",
            each(&|k, it, _| {
                format!("<Rob Type=\"KUKA\"><AIPos{}/><EIPos E1=\"0.0\"/><IPOC>{}</IPOC></Rob>\n", attributes(it, 'A'), 12 * k)
            }),
        ),
        (
            "echo",
            each(&|k, it, _| format!("{k},500,base,{},{}\n", made.reading_names().join(","), numbers(it, 1.0, ","))),
        ),
        ("letters", "S[deg],L[deg],U[deg],R[deg],B[deg],T[deg]\n".to_owned() + &each(&|_, it, _| numbers(it, degrees, ",") + "\n")),
    ];
    let measured = [
        (
            "spatial_analyzer",
            "// SpatialAnalyzer SA 2024.2\n// Points Relative to Coordinate Frame 'A::WORLD'\n// AXES = CARTESIAN: X,  Y,  Z (mm)\n".to_owned()
                + &each(&|k, _, it| format!("Robot,  P{k},  {}\n", numbers(&it, 1e3, ",  "))),
        ),
        (
            "leica",
            "X  [mm],Y  [mm],Z  [mm],U(95)  [mm],Image RMS  [\u{b5}m],Temperature  [\u{b0}C],Time Stamp,Delete\n".to_owned()
                + &each(&|_, _, it| format!("{},0.18,0.24,22.6,'11.10.2022 10:00:00.000,\n", numbers(&it, 1e3, ","))),
        ),
        ("motive", motive + &each(&|k, _, it| format!("{k},0.0{k},{}\n", numbers(&it, 1e3, ",")))),
        ("vicon", vicon + &each(&|k, _, it| format!("{k},0,{}\n", numbers(&it, 1e3, ",")))),
        ("segments", segments + &each(&|k, _, it| format!("{k},0,0.1,0.2,0.3,{}\n", numbers(&it, 1e3, ",")))),
        ("qualisys", qualisys + &each(&|k, _, it| format!("{k}\t0.0{k}\t{}\n", numbers(&it, 1e3, "\t")))),
    ];
    let both = |one: &[u8], other: &[u8]| [one, format!("\n{BETWEEN}\n").as_bytes(), other].concat();
    let mut all: Vec<(String, Vec<u8>)> = Vec::new();
    all.extend(joints.iter().map(|(name, text)| ((*name).to_owned(), both(text.as_bytes(), own_points.as_bytes()))));
    all.extend(measured.iter().map(|(name, text)| ((*name).to_owned(), both(own_joints.as_bytes(), text.as_bytes()))));
    all.push(("workbook".to_owned(), both(WORKBOOK, WORKBOOK_POINTS)));
    let joint_state = |at: usize| {
        let mut cdr = Cdr::new(at);
        cdr.list(made.reading_names());
        cdr.numbers(made.readings(at));
        cdr
    };
    let point = |at: usize| {
        let mut cdr = Cdr::new(at);
        let place: [f64; 3] = made.observations[at].measurement.pose().translation.into();
        place.iter().for_each(|it| cdr.put(&it.to_le_bytes()));
        cdr
    };
    all.push(("bag".to_owned(), both(&bag("sensor_msgs/msg/JointState", &joint_state), own_points.as_bytes())));
    // Compressed by message, as one uncompressed block of zstd.
    let packed = |at: usize| {
        let content = [vec![0, 1, 0, 0], joint_state(at).0].concat();
        let size = content.len() as u32;
        let block = &((size << 3) | 1).to_le_bytes()[..3];
        [&b"\x28\xb5\x2f\xfd\xa0"[..], &size.to_le_bytes(), block, &content].concat()
    };
    all.push(("bag_packed".to_owned(), both(&bag_of("sensor_msgs/msg/JointState", &packed), own_points.as_bytes())));
    all.push(("bag_of_points".to_owned(), both(own_joints.as_bytes(), &bag("geometry_msgs/msg/PointStamped", &point))));
    all
}

/// A message of ROS 2: values aligned relative to the end of the header.
struct Cdr(Vec<u8>);

impl Cdr {
    fn new(second: usize) -> Self {
        let mut cdr = Cdr(Vec::new());
        cdr.put(&(second as u32 + 1).to_le_bytes());
        cdr.put(&0_u32.to_le_bytes());
        cdr.text("a");
        cdr
    }

    fn put(&mut self, bytes: &[u8]) {
        self.0.resize(self.0.len().next_multiple_of(bytes.len()), 0);
        self.0.extend_from_slice(bytes);
    }

    fn text(&mut self, text: &str) {
        self.put(&(text.len() as u32 + 1).to_le_bytes());
        self.0.extend_from_slice(text.as_bytes());
        self.0.push(0);
    }

    fn list(&mut self, names: &[String]) {
        self.put(&(names.len() as u32).to_le_bytes());
        names.iter().for_each(|it| self.text(it));
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.put(&(numbers.len() as u32).to_le_bytes());
        numbers.iter().for_each(|it| self.put(&it.to_le_bytes()));
        // No velocities and no efforts.
        self.put(&0_u32.to_le_bytes());
        self.put(&0_u32.to_le_bytes());
    }
}

/// A bag (MCAP) of four messages of a type.
fn bag(kind: &str, message: &dyn Fn(usize) -> Cdr) -> Vec<u8> {
    bag_of(kind, &|at| [vec![0, 1, 0, 0], message(at).0].concat())
}

/// A bag of messages in their stored form.
fn bag_of(kind: &str, message: &dyn Fn(usize) -> Vec<u8>) -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let record = |kind: u8, content: &[u8]| [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat();
    let number = |number: u16| number.to_le_bytes().to_vec();
    let mut out = b"\x89MCAP0\r\n".to_vec();
    out.extend(record(1, &[text("ros2"), text("")].concat()));
    out.extend(record(3, &[number(1), text(kind), text("ros2msg"), text("")].concat()));
    out.extend(record(4, &[number(1), number(1), text("/a"), text("cdr"), text("")].concat()));
    for at in 0..4 {
        let time = ((at as u64 + 1) * 1_000_000_000).to_le_bytes();
        let head = [number(1), vec![0; 4], time.to_vec(), time.to_vec()].concat();
        out.extend(record(5, &[head, message(at)].concat()));
    }
    out.extend(record(15, &[0; 4]));
    out.extend(record(2, &[0; 20]));
    out.extend(b"\x89MCAP0\r\n");
    out
}

/// A section's blocks of one language, in order.
fn blocks(section: &str, language: &str) -> Vec<&'static str> {
    let title = format!("{section}\n");
    let section = DOCUMENT.split("\n## ").find(|section| section.starts_with(&title)).unwrap();
    let fence = format!("```{language}\n");
    section.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

/// The data as a table: poses by quaternions.
fn table(data: &Dataset) -> String {
    let mut text = data.reading_names().join(",") + ",x,y,z,qx,qy,qz,qw\n";
    for (row, seen) in data.observations.iter().enumerate() {
        for reading in data.readings(row) {
            write!(text, "{reading:.6},").unwrap();
        }
        let pose = seen.measurement.pose();
        let [x, y, z]: [f64; 3] = pose.translation.into();
        write!(text, "{x:.6},{y:.6},{z:.6}").unwrap();
        if seen.measurement.sees_orientation() {
            let [a, b, c, d] = pose.quaternion_xyzw();
            writeln!(text, ",{a:.8},{b:.8},{c:.8},{d:.8}").unwrap();
        } else {
            text.push_str(",,,,\n");
        }
    }
    text
}

/// Points of two tools, in turn.
fn two_targets(robot: &Robot) -> String {
    let made = Simulation { count: 30, ..Simulation::default() }.run(robot, SessionKind::POINT).unwrap();
    let mut text = robot.reading_names().join(",") + ",x,y,z,target\n";
    for (row, seen) in made.data.observations.iter().enumerate() {
        let values: Vec<String> = made.data.readings(row).iter().map(|value| format!("{value:.6}")).collect();
        let [x, y, z]: [f64; 3] = seen.measurement.pose().translation.into();
        let name = ["a", "b"][row % 2];
        writeln!(text, "{},{x:.6},{y:.6},{:.6},{name}", values.join(","), z + 0.01 * (row % 2) as f64).unwrap();
    }
    text
}

/// One file of two targets in a row.
const TARGETS_MAP: &str = "[[targets]]\nname = \"smr1\"\nsigma_rotation = { value = 0.01, unit = \"deg\" }\nposition = { columns = [\"smr1_x\", \"smr1_y\", \"smr1_z\"], unit = \"m\" }\n\n\
     [[targets]]\nname = \"smr2\"\nposition = { columns = [\"smr2_x\", \"smr2_y\", \"smr2_z\"] }\n";
/// Every key that the others leave out.
const OTHER_MAP: &str = "separator = \";\"\ndecimal = \",\"\npose = \"target_from_device\"\nid = \"run\"\ntarget_name = \"ball\"\n\
     set = { column = \"phase\", fit = [\"train\"] }\nsigma_position = { column = \"s\", unit = \"mm\" }\n\n[units]\nlength = \"mm\"\nangle = \"deg\"\n\n\
     [joints]\njoint1 = \"A1\"\njoint2 = { column = \"A2\", unit = \"deg\" }\njoint3 = { value = 20, unit = \"mm\" }\njoint4 = \"A4\"\n\n\
     [position]\ncolumns = [\"px\", \"py\", \"pz\"]\n\n[orientation]\nform = \"intrinsic_zyx\"\ncolumns = [\"a\", \"b\", \"c\"]\n";
/// A file that it reads; `joint4` identifies the robot's joints.
const MAPPED: &str = "run;phase;A1;A2;joint4;A4;px;py;pz;a;b;c;s\n1;train;12,5;-40;100;10;512,31;-40,02;130,9;1;2;3;0,1\n\
     2;test;-3;15,25;50;20;540,77;102,4;112,18;4;5;6;0,1\n";

const CAMERAS: [(&str, &str); 13] = [
    (
        "opencv",
        "yaml\n%YAML:1.0\n---\nimage_width: 1920\nimage_height: 1200\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
         data: [ 1.4e+03, 0., 960.5, 0., 1400., 600.25, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   \
         data: [ -0.1, 0.02, 1e-4, -2e-4, 0. ]\n",
    ),
    (
        "ros",
        "yaml\nimage_width: 640\nimage_height: 480\ncamera_name: wrist\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [600, 0, 320, 0, 601, 240, 0, 0, 1]\n\
         distortion_model: rational_polynomial\ndistortion_coefficients:\n  rows: 1\n  cols: 8\n  data: [0.1, 0.01, 0, 0, 0, 0.2, 0.01, 0]\n",
    ),
    (
        "message",
        "yaml\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nd: [0.1, 0, 0, 0, 0]\nk: [600.0, 0.0, 320.0, 0.0, 601.0, 240.0, 0.0, 0.0, 1.0]\n",
    ),
    (
        "kalibr",
        "yaml\ncam0:\n  camera_model: pinhole\n  intrinsics: [461.6, 460.1, 362.7, 246.9]\n  distortion_model: equidistant\n  \
         distortion_coeffs: [-0.01, 0.02, -0.03, 0.01]\n  resolution: [752, 480]\ncam1:\n  camera_model: pinhole\n  intrinsics: [461, 460, 362, 246]\n  \
         distortion_model: radtan\n  distortion_coeffs: [-0.27, 0.06, 1e-4, 1e-5]\n  resolution: [752, 480]\n",
    ),
    (
        "opencv_xml",
        "xml\n<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n<image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n  \
         <rows>3</rows>\n  <data>\n    600. 0. 320. 0. 601. 240. 0. 0. 1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\">\n  \
         <data>\n    -0.1 0.02 0. 0. 0.</data></distortion_coefficients>\n</opencv_storage>\n",
    ),
    (
        "realsense",
        "json\n{\"color\": {\"width\": 640, \"height\": 480, \"ppx\": 320.5, \"ppy\": 240, \"fx\": 600, \"fy\": 601, \"model\": \"distortion.brown_conrady\", \"coeffs\": \
         [0.1, 0, 0, 0, 0]}, \"depth\": {\"fx\": 400, \"fy\": 401, \"cx\": 320, \"cy\": 240, \"distortion\": {\"k1\": 0.1}}}\n",
    ),
    (
        "oak",
        "json\n{\"cameraData\": [[2, {\"cameraType\": 1, \"width\": 640, \"height\": 480, \"intrinsicMatrix\": [[600,0,320],[0,601,240],[0,0,1]], \
         \"distortionCoeff\": [-0.1,0,0,0,0,0,0,0,0,0,0,0,0,0]}]]}\n",
    ),
    (
        "mrcal",
        "yaml\n# mrcal\n{\n    'lensmodel':  'LENSMODEL_OPENCV5',\n    'intrinsics': [ 600, 601, 320, 240, -0.1, 0, 0, 0, 0,],\n    'imagersize': [ 640, 480,],\n}\n",
    ),
    (
        "halcon",
        "dat\nParGroup: Cam_Par;\n  \"Internal camera parameters\";\n\nFocus:foc: 0.008;\n  DOUBLE:0.0:;\n\nKappa:kappa: -900;\n\nSx:sx: 5.5e-06;\nSy:sy: 5.5e-06;\nCx:cx: 320;\nCy:cy: \
         240;\nImageWidth:imgw: 640;\nImageHeight:imgh: 480;\n",
    ),
    ("industrial", "yaml\nintrinsics:\n  fx: 550.0\n  fy: 551.0\n  cx: 320.0\n  cy: 240.0\n"),
    (
        "visp",
        "xml\n<?xml version=\"1.0\"?>\n<root>\n  <camera>\n    <name>hand</name>\n    <image_width>640</image_width>\n    <image_height>480</image_height>\n    \
         <model>\n      <type>perspectiveProjWithDistortion</type>\n      <px>600.5</px>\n      <py>601.5</py>\n      <u0>320.1</u0>\n      <v0>240.2</v0>\n      \
         <kud>0.12</kud>\n      <kdu>-0.11</kdu>\n    </model>\n  </camera>\n</root>\n",
    ),
    (
        "table",
        "csv\nname,fx,fy,cx,cy,k1,k2,p1,p2,k3,width,height\nleft,1400,1401,960,600,-0.1,0.01,1e-4,0,0,1920,1200\nright,1400,1401,960,600,,,,,,,\n",
    ),
    (
        "versions",
        "csv\n# two lenses\ncamera;version;model;fx;fy;cx;cy;k1;k2;k3;k4\na;1;fisheye;500,5;501;320;240;0,1;0;0;0\nb;2;;500;501;320;240;0;0;0;0\n",
    ),
];

const BOARDS: [(&str, &str); 8] = [
    (
        "aprilgrid",
        "yaml\ntarget_type: 'aprilgrid' # tags\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\ncodeOffset: 0\n",
    ),
    (
        "checkerboard",
        "yaml\ntarget_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\ncolSpacingMeters: 0.06\n",
    ),
    (
        "circlegrid",
        "yaml\ntarget_type: circlegrid\ntargetCols: 4\ntargetRows: 11\nspacingMeters: 0.02\nasymmetricGrid: true\n",
    ),
    (
        "industrial",
        "yaml\ntarget_finder:\n  type: ModifiedCircleGridTargetFinder\n  rows: 10\n  cols: 12\n  spacing: 0.0254 # m\n",
    ),
    (
        "charuco",
        "yaml\ntarget_finder:\n  type: CharucoGridTargetFinder\n  rows: 7\n  cols: 5\n  chessboard_dim: 0.036\n  aruco_marker_dim: 0.018\n  dictionary: 10\n",
    ),
    (
        "opencv",
        "xml\n<?xml version=\"1.0\"?>\n<opencv_storage><Settings>\n<BoardSize_Width>9</BoardSize_Width>\n<BoardSize_Height>6</BoardSize_Height>\n\
         <Square_Size>25</Square_Size>\n<Marker_Size>18</Marker_Size>\n<ArUco_Dict_Name>DICT_4X4_50</ArUco_Dict_Name>\n\
         <Calibrate_Pattern>\"CHARUCOBOARD\"</Calibrate_Pattern>\n</Settings></opencv_storage>\n",
    ),
    ("points", "csv\nboard,target,x[mm],y[mm],z[mm]\ncube,a,0,0,0\ncube,b,30,0,0\ncube,7,30,30.5,1\nother,a,0,0,0\n"),
    ("corners", "csv\ncorner;x_mm;y_mm;z_mm\n0;0;0;0\n1;27,5;0;0\n2;0;27,5;0\n"),
];

/// Messages of robot_calibration in JSON: pictures of a board before a camera, and positions of its corners by an arm.
fn messages() -> Vec<String> {
    let session = Simulation { count: 6, seed: 5, ..Simulation::default() };
    let usual = PictureSimulation::with_usual_camera(session, true);
    let board = read_boards("chessboard:6x5:40mm").unwrap().remove(0);
    let lens = Lens::pinhole([1400.0, 1400.0], [1920.0, 1200.0]);
    let made = usual.with_board_and_lens(board.clone(), lens).run(&elbow()).unwrap();
    let list = |all: Vec<String>| all.join(", ");
    let point = |frame: &str, [x, y]: [f64; 2]| {
        format!(
            "{{\"header\": {{\"frame_id\": \"{frame}\"}}, \"point\": {{\"x\": {x:.4}, \"y\": {y:.4}, \"z\": 0.0}}}}"
        )
    };
    let message = |(at, picture): (usize, &Picture)| {
        let names = list(made.data.reading_names().iter().map(|it| format!("\"{it}\"")).collect());
        let readings = list(made.data.readings(at).iter().map(|it| format!("{it:.6}")).collect());
        let seen = list(picture.corners.iter().map(|it| point("optical", [it.pixel.x, it.pixel.y])).collect());
        let place = |it: &Corner| {
            let point_m = board.points[it.point as usize];
            point("checkerboard", [point_m.x, point_m.y])
        };
        let own = list(picture.corners.iter().map(place).collect());
        format!(
            "{{\"joint_states\": {{\"name\": [\"head_pan\", {names}], \"position\": [0.5, {readings}]}}, \"observations\": [\
             {{\"sensor_name\": \"eye\", \"features\": [{seen}], \"ext_camera_info\": {{\"camera_info\": {{\"width\": 3840, \"height\": 2400, \
             \"distortion_model\": \"plumb_bob\", \"d\": [0.0, 0.0, 0.0, 0.0, 0.0], \"k\": [1400.0, 0, 1920.0, 0, 1400.0, 1200.0, 0, 0, 1]}}}}}}, \
             {{\"sensor_name\": \"arm\", \"features\": [{own}]}}]}}"
        )
    };
    made.data.pictures.all.iter().enumerate().map(message).collect()
}

/// A message with its outer keys on lines of their own, without the lens and the arm.
fn block(message: &str) -> String {
    let (states, rest) = message.split_once(", \"observations\": ").unwrap();
    let states = states.strip_prefix("{\"joint_states\": ").unwrap();
    let (seen, _) = rest.split_once(", \"ext_camera_info\"").unwrap();
    format!("joint_states: {states}\nobservations:\n  {seen}}}]")
}
