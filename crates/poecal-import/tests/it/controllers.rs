//! Lists of joint readings of controllers, ROS and theses, and Vicon's exports: the rows of a plain table in each form.

use nalgebra::Vector3;
use poecal_arm::lie::{Screw, rotation};
use poecal_import::{ColumnMap, Join, MeasurementFile, ReadOptions, read, read_joints};
use poecal_model::measurement::Dataset;
use poecal_model::robot::{Joint, Robot};
use poecal_model::simulate::{SessionKind, Simulation, elbow};
use poecal_testing::files::Folder;

fn session() -> Dataset {
    Simulation { count: 9, ..Simulation::default() }.run(&elbow(), SessionKind::POSE).unwrap().data
}

/// Readings in degrees with five digits.
fn degrees(data: &Dataset, row: usize) -> Vec<String> {
    data.readings(row).iter().map(|it| format!("{:.5}", it.to_degrees())).collect()
}

fn readings(name: &str, text: &str) -> Result<Vec<f64>, String> {
    let folder = Folder::new();
    let path = folder.write(name, text);
    let found = read_joints(&path, &elbow(), &ReadOptions::default());
    found.map(|it| it.readings).map_err(|error| folder.without_path(&error.to_string()))
}

fn are_readings(name: &str, found: &[f64], data: &Dataset) {
    let expected: Vec<f64> =
        (0..data.len()).flat_map(|row| degrees(data, row)).map(|it| it.parse::<f64>().unwrap().to_radians()).collect();
    assert_eq!(found.len(), expected.len(), "{name}");
    for (own, expected) in found.iter().zip(&expected) {
        assert!((own - expected).abs() < 1e-9, "{name}: {own} {expected}");
    }
}

#[test]
fn lists_of_controllers_have_the_readings_of_a_plain_table() {
    let data = session();
    let each = |of: &dyn Fn(usize, &[String]) -> String| -> String {
        (0..data.len()).map(|row| of(row + 1, &degrees(&data, row))).collect()
    };
    let fanuc = each(&|k, it| {
        let [a, b, c, d, e, f] = it else { panic!() };
        format!(
            "    [1,{k}] =   'P{k}'   Group: 1\n  J1 = {a:>9} deg   J2 = {b:>9} deg   J3 = {c:>9} deg \n  J4 = {d:>9} deg   J5 = {e:>9} deg   J6 = {f:>9} deg \n  EXT1:     0.000 mm  \n\n"
        )
    });
    let fanuc = format!(
        "<HTML>\n<PRE>\n[*POSREG*]$POSREG  Storage: SHADOW  Access: RW  : ARRAY[2,100] OF Position Reg\n{fanuc}    [1,90] =   '' Uninitialized\n    [1,91] =   'CART' \n  Group: 1   \
         Config: N U T, 0, 0, 0\n  X:  2066.881   Y: -1269.113   Z: -1122.291\n  W:  -179.786   P:     -.649   R:   -58.819\n    [2,1] =   'OTHER'   Group: 2\n  \
         J1 =     5.000 deg\n"
    );
    let attributes = |it: &[String], letter: char| -> String {
        (1..).zip(it).map(|(at, value)| format!(" {letter}{at}=\"{value}\"")).collect()
    };
    let staubli = each(&|k, it| format!("      <Value key=\"{}\"{} />\n", k - 1, attributes(it, 'j')));
    let staubli = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\" ?>\n<Database xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xmlns=\"http://www.staubli.com/robotics/VAL3/Data/2\">\n  <Datas>\n    <Data name=\"jPark\" access=\"public\" xsi:type=\"array\" type=\"jointRx\" size=\"1\">\n      \
         <Value key=\"0\" j3=\"90\" />\n    </Data>\n    <Data name=\"jMeas\" access=\"public\" xsi:type=\"array\" type=\"jointRx\" size=\"9\">\n{staubli}    </Data>\n    \
         <Data name=\"nTraj\" access=\"public\" xsi:type=\"array\" type=\"num\" size=\"1\">\n      <Value key=\"0\" value=\"3\" />\n    </Data>\n  </Datas>\n</Database>\n"
    );
    let kuka = each(&|k, it| {
        format!(
            "<Rob Type=\"KUKA\"><RIst X=\"1.0\" Y=\"2.0\" Z=\"3.0\" A=\"4.0\" B=\"5.0\" C=\"6.0\"/><AIPos{}/><EIPos E1=\"0.0\" E2=\"0.0\"/><Delay D=\"0\"/><IPOC>{}</IPOC></Rob>\n",
            attributes(it, 'A'),
            4_208_163_634_u64 + 12 * k as u64
        )
    });
    let letters = "S[deg],L[deg],U[deg],R[deg],B[deg],T[deg]\n".to_owned() + &each(&|_, it| it.join(",") + "\n");
    let header = |name: &dyn Fn(usize) -> String| (1..=6).map(name).collect::<Vec<_>>().join(";") + "\n";
    let rows = each(&|_, it| it.join(";") + "\n");
    for (name, text) in [
        ("posreg.va", fanuc),
        ("app.dtx", staubli),
        ("rsi.xml", kuka),
        ("letters.csv", letters),
        ("greek.csv", header(&|k| format!("θ{k} (°)")) + &rows),
        ("chinese.csv", header(&|k| format!("关节{k}（度）")) + &rows),
        ("german.csv", header(&|k| format!("Achse {k} [°]")) + &rows),
        ("thesis.csv", header(&|k| format!("q_{k} / deg")) + &rows),
        ("rws.csv", header(&|k| format!("rax_{k}[deg]")) + &rows),
    ] {
        are_readings(name, &readings(name, &text).unwrap_or_else(|error| panic!("{error}")), &data);
    }
    // The names of each line, in another order than the model's.
    let names = elbow().joint_reading_names();
    let echo: String = (0..data.len())
        .map(|row| {
            let reversed = |it: Vec<String>| it.into_iter().rev().collect::<Vec<_>>().join(",");
            let positions = data.readings(row).iter().map(|it| format!("{it:?}")).collect();
            format!(
                "{},5000000,base_link,{},{},0,0,0,0,0,0,,\n",
                1_700_000_000 + row,
                reversed(names.clone()),
                reversed(positions)
            )
        })
        .collect();
    let found = readings("echo.csv", &echo).unwrap();
    assert_eq!(found, data.all_readings());
    for (name, text, part) in [
        (
            "posreg.va",
            "[*POSREG*]$POSREG  Storage: CMOS  Access: RW  : ARRAY[1,2] OF Position Reg\n    [1,1] =   '' Uninitialized\n",
            "found no joint readings",
        ),
        (
            "rsi.xml",
            "<Rob Type=\"KUKA\"><AIPos A1=\"1\" A2=\"2\"/><IPOC>4</IPOC></Rob>\n",
            "rsi.xml:1: found the axes A1, A2, which are not one to one the joints `joint1`",
        ),
        (
            "rsi.xml",
            "<Rob Type=\"KUKA\"><AIPos A1=\"1\" A4294967297=\"2\"/><IPOC>4</IPOC></Rob>\n",
            "rsi.xml:1: found the axes A1, which are not one to one the joints `joint1`",
        ),
        ("echo.csv", &format!("{echo}1,2,,other,0.5\n"), "found no joint `"),
        ("echo.csv", &format!("{echo}1,2,,a,b,0.5,0.5,1\n"), "found 3 numbers behind the names of 2 joints"),
    ] {
        let error = readings(name, text).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
}

/// The robot with a rail before its first joint, or behind its last one.
fn on_a_rail(is_before: bool) -> Robot {
    let mut robot = elbow();
    let at = if is_before { 0 } else { robot.joints.len() };
    robot.joints.insert(at, Joint::prismatic("rail", Screw::prismatic(&Vector3::x())));
    robot
}

#[test]
fn external_axes_are_the_slides_wherever_they_stand() {
    let fanuc = "[*POSREG*]$POSREG  Storage\n [1,1] =   'P'   Group: 1\n J1 = 1.0 deg J2 = 2.0 deg J3 = 3.0 deg\n J4 = 4.0 deg J5 = 5.0 deg J6 = 6.0 deg\n EXT1: 100.0 mm\n";
    let kuka = "<Rob Type=\"KUKA\"><EIPos E2=\"0\" E1=\"100\"/><AIPos A6=\"6\" A2=\"2\" A3=\"3\" A4=\"4\" A5=\"5\" A1=\"1\"/><IPOC>4</IPOC></Rob>\n";
    let folder = Folder::new();
    let found = |robot: &Robot, name: &str, text: &str| {
        let found = read_joints(folder.write(name, text), robot, &ReadOptions::default());
        found.map(|it| it.readings).map_err(|error| folder.without_path(&error.to_string()))
    };
    for (name, text) in [("posreg.va", fanuc), ("rsi.xml", kuka)] {
        for is_before in [true, false] {
            let mut expected: Vec<f64> = (1..=6).map(|it| f64::from(it).to_radians()).collect();
            expected.insert(if is_before { 0 } else { 6 }, 0.1);
            let own = found(&on_a_rail(is_before), name, text).unwrap();
            assert!(own.iter().zip(&expected).all(|it| (it.0 - it.1).abs() < 1e-12), "{name}: {own:?}");
        }
        let error = found(&elbow(), name, text).unwrap_err();
        assert!(error.contains("which are not one to one the joints `joint1`"), "{error}");
    }
    // A mapping assigns the axes by their names in the file if they do not match the joints one to one. Here the rail comes first as the arm's own
    // axis.
    let swapped = fanuc.replace("EXT1: 100.0 mm", "EXT1: 100.0 mm EXT2: 7.0 deg");
    let columns: String = (1..=6).map(|at| format!("joint{at} = \"J{at}\"\n")).collect();
    let mapping = ColumnMap::parse(&format!("[joints]\nrail = \"EXT1\"\n{columns}"), "columns.toml").unwrap();
    let options = ReadOptions { mapping: Some(mapping), ..ReadOptions::default() };
    let own = read_joints(folder.write("posreg.va", &swapped), &on_a_rail(true), &options).unwrap().readings;
    let expected = [0.1, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|it: f64| if it < 0.5 { it } else { it.to_radians() });
    assert!(own.iter().zip(expected).all(|it| (it.0 - it.1).abs() < 1e-12), "{own:?}");
    let turned = fanuc.replace("100.0 mm", "100.0 deg");
    let error = found(&on_a_rail(true), "posreg.va", &turned).unwrap_err();
    assert!(error.contains("EXT1 (deg), which are not one to one the joints `rail` (slides)"), "{error}");
}

#[test]
fn lists_that_are_cut_off_are_refused() {
    let fanuc = "[*POSREG*]$POSREG  Storage\n [1,1] =   'P'   Group: 1\n J1 = 1.0 deg J2 = 2.0 deg J3 = 3.0 deg\n J4 = 4.0 deg J5 = 5.0 deg J6 = 6";
    let staubli = |values: &str| {
        format!(
            "<Database xmlns=\"http://www.staubli.com/robotics/VAL3/Data/2\">\n<Data name=\"a\" type=\"jointRx\">\n{values}"
        )
    };
    let whole =
        staubli("<Value key=\"0\" j1=\"1\" j2=\"2\" j3=\"3\" j4=\"4\" j6=\"6\" />\n<Value key=\"1\" j5=\"5\" />\n");
    assert_eq!(readings("a.dtx", &whole).unwrap()[4], 0.0);
    for (name, text, part) in [
        ("p.va", fanuc.to_owned(), "p.va:4: found J6 of `P` without its unit"),
        ("a.dtx", staubli("<Value key=\"0\" j1=\"1\" j2=\"2"), "a.dtx:3: found a `Value` without its `>`"),
        ("a.dtx", whole.replace("j5", "k5"), "found no angle j5 in any value of `a`"),
    ] {
        let error = readings(name, &text).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn counts_of_an_encoder_are_named_with_their_factor() {
    let data = session();
    let rows: String = (0..data.len())
        .map(|row| {
            let turn = |it: &f64| it.to_degrees() - 360.0 * (it.to_degrees() / 360.0).round();
            let counts = data.readings(row).iter().map(|it| format!("{:.0}", 2048.0 + turn(it) * 4095.0 / 360.0));
            counts.collect::<Vec<_>>().join(",") + "\n"
        })
        .collect();
    let error = readings("counts.csv", &format!("{}\n{rows}", elbow().joint_reading_names().join(","))).unwrap_err();
    println!("{error}");
    for part in
        ["counts of an encoder, 4096 a turn with the zero at 2048", "= 0.087890625 }, unit = \"deg\", offset = -180 }`"]
    {
        assert!(error.contains(part), "{error}");
    }
}

fn join_files(joints: &str, seen: &str) -> MeasurementFile {
    let folder = Folder::new();
    let paths = [folder.write("joints.csv", joints), folder.write("vicon.csv", seen)];
    let options = ReadOptions { join: Some(Join::Rows), ..ReadOptions::default() };
    read(&paths, &elbow(), &options).unwrap_or_else(|error| panic!("{}", folder.without_path(&error.to_string())))
}

#[test]
fn segments_and_trajectories_of_vicon_are_those_of_a_plain_table() {
    let data = session();
    let joints = format!("{}\n", elbow().joint_reading_names().join("[deg],") + "[deg]")
        + &(0..data.len()).map(|row| degrees(&data, row).join(",") + "\n").collect::<String>();
    let poses: Vec<_> = data.observations.iter().map(|it| it.measurement.pose()).collect();
    let mut segments = "Segments\r\n100\r\n,,Tool:Tool,,,,,,Base:Base,,,,,\r\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ,RX,RY,RZ,TX,TY,TZ\r\n,,rad,rad,rad,mm,mm,mm,rad,rad,rad,mm,mm,mm\r\n".to_owned();
    let mut markers =
        "Trajectories\n100\n,,Tool:M1,,,Tool:M2,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n".to_owned();
    let cells = |numbers: &[f64]| numbers.iter().map(|it| format!("{it:?}")).collect::<Vec<_>>().join(",");
    for (row, pose) in (1..).zip(&poses) {
        let turn = rotation::log(&pose.rotation);
        let place = pose.translation * 1e3;
        segments += &format!("{row},0,{},{},0,0,0,10,20,30\r\n", cells(turn.as_slice()), cells(place.as_slice()));
        let other = (pose.translation + pose.rotation * Vector3::new(0.1, 0.0, 0.0)) * 1e3;
        markers += &format!("{row},0,{},{}\n", cells(place.as_slice()), cells(other.as_slice()));
    }
    // Another part of the export follows, behind a line without cells.
    segments += "\r\nDevices\r\n1000\r\n,,Force\r\nFrame,Sub Frame,Fx\r\n,,N\r\n1,0,3.5\r\n";
    let found = join_files(&joints, &segments);
    println!("{:?}", found.notes);
    assert_eq!(found.data.len(), poses.len());
    for (own, expected) in found.data.observations.iter().zip(&poses) {
        let own = own.measurement.pose();
        let off = (own.translation - expected.translation).norm() + (own.rotation - expected.rotation).norm();
        assert!(off < 1e-9, "{off}");
    }
    let both = join_files(&joints, &format!("{segments}\r\n{markers}"));
    assert!(both.notes.iter().any(|it| it.contains("read Segments, left out Trajectories")), "{:?}", both.notes);
    let folder = Folder::new();
    let mixed = markers.replace("mm,mm,mm,mm\n", "mm,mm,mm,mm/s\n");
    let paths = [folder.write("joints.csv", &joints), folder.write("vicon.csv", &mixed)];
    let options = ReadOptions { join: Some(Join::Rows), ..ReadOptions::default() };
    let error = read(&paths, &elbow(), &options).unwrap_err().to_string();
    assert!(error.contains("vicon.csv:5: found the units `mm`, `mm/s` of positions"), "{error}");
    let found = join_files(&joints, &markers);
    assert_eq!((found.data.len(), found.data.targets.len()), (2 * poses.len(), 2));
    let own = found.data.observations[0].measurement.pose().translation;
    assert!((own - poses[0].translation).norm() < 1e-9);
}
