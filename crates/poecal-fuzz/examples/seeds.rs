//! Writes `fuzz/seeds` anew from the project's own examples and from small simulated sessions; what was found stays. Run by hand, when a
//! form of file changes: `cargo run -p poecal-fuzz --example seeds`.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use poecal::calibration::{CalibrationOptions, calibrate};
use poecal::io::calibration_file::{CalibrationFile, Inputs};
use poecal::io::residuals::Residuals;
use poecal::io::robot_toml;
use poecal::measurement::Dataset;
use poecal::robot::Robot;
use poecal::simulate::{Kind, Simulation, elbow, gantry, scara};
use poecal_fuzz::BETWEEN;

const DOCUMENT: &str = include_str!("../../../docs/file-formats.md");
const URDF: &str = include_str!("../../../examples/elbow/robot.urdf");
const TOML: &str = include_str!("../../../examples/elbow/robot.toml");
const POINTS: &str = include_str!("../../../examples/elbow/points.csv");
/// Of an earlier schema: poses and points, suspected and repeated rows.
const EARLIER: &str = include_str!("../../poecal/tests/data/calibration_schema_1.json");
const EARLIER_ROWS: &str = include_str!("../../poecal/tests/data/calibration_schema_1.csv");
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

const RAPID: &str = include_str!("../../poecal/tests/it/programs/rapid/01_simple.mod");
const FANUC: &str = include_str!("../../poecal/tests/it/programs/fanuc/01_simple.ls");
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
    let put = |target: &str, name: &str, text: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(target);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(name), text).unwrap();
        println!("{target}/{name}: {} bytes", text.len());
    };
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
    put("joints", "points", &points);
    put("joints", "ids", "id,joint1,joint2,joint3,joint4\na,0.1,0.2,0.1,1\n\"b,c\",0.2,0.1,0,-1\n");
    for (name, robot, kind, count) in [
        ("scara", scara(), Kind::POSE, 20),
        ("gantry", gantry(), Kind::POINT, 20),
        ("elbow", elbow(), Kind::MIXED, 26),
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
        let residuals = Residuals::of(&made.data, &calibration).text();
        put("calibration", name, &json);
        put("residuals", name, &residuals);
        put("report", name, &both(&json, &residuals));
    }
    put("calibration", "schema_1", EARLIER);
    put("report", "schema_1", &both(EARLIER, EARLIER_ROWS));
    let two = two_targets(&gantry());
    put("pipeline", "two_targets", &both(&robot_toml::write(&gantry()), &two));
    let twelve = POINTS.lines().take(31).map(|line| format!("{line}\n")).collect::<String>();
    put("pipeline", "urdf", &both(URDF, &twelve));
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
    let made = Simulation { count: 30, ..Simulation::default() }.run(robot, Kind::POINT).unwrap();
    let mut text = robot.reading_names().join(",") + ",x,y,z,target\n";
    for (row, seen) in made.data.observations.iter().enumerate() {
        let values: Vec<String> = made.data.readings(row).iter().map(|value| format!("{value:.6}")).collect();
        let [x, y, z]: [f64; 3] = seen.measurement.pose().translation.into();
        let name = ["a", "b"][row % 2];
        writeln!(text, "{},{x:.6},{y:.6},{:.6},{name}", values.join(","), z + 0.01 * (row % 2) as f64)
            .unwrap();
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
/// What it reads; `joint4` says whose joints they are.
const MAPPED: &str = "run;phase;A1;A2;joint4;A4;px;py;pz;a;b;c;s\n1;train;12,5;-40;100;10;512,31;-40,02;130,9;1;2;3;0,1\n\
     2;test;-3;15,25;50;20;540,77;102,4;112,18;4;5;6;0,1\n";
