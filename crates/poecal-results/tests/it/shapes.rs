//! Shapes of a URDF's links, from the text and from the meshes beside it.

use std::fs;
use std::path::Path;

use poecal_calibrate::{CalibrationOptions, calibrate};
use poecal_model::simulate::{SessionKind, Simulation};
use poecal_results::calibration_file::{CalibrationFile, Inputs};
use poecal_results::model::Model;
use poecal_results::shapes::{ShapeForm, Shapes};

/// A binary STL of one triangle.
fn binary(triangle: &[[f32; 3]; 3]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(1_u32.to_le_bytes());
    // Its normal, which nobody reads.
    bytes.extend([0; 12]);
    bytes.extend(triangle.iter().flatten().flat_map(|value| value.to_le_bytes()));
    bytes.extend([0; 2]);
    bytes
}

const TEXT: &str = r#"<robot name="two">
  <link name="base"><visual><geometry><mesh filename="meshes/base.obj"/></geometry></visual></link>
  <link name="upper"><visual><origin xyz="0.2 0 0"/><geometry><mesh filename="package://cell/robot/meshes/arm.STL" scale="0.001 0.001 0.001"/></geometry></visual>
    <visual><geometry><mesh filename="package://elsewhere/arm.stl"/></geometry></visual></link>
  <link name="lower"><visual><geometry><mesh filename="meshes/broken.stl"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/large.stl"/></geometry></visual>
    <visual><geometry><mesh filename="meshes/base.obj"/></geometry></visual></link>
  <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
  <joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0.1"/><axis xyz="0 1 0"/></joint>
</robot>"#;

#[test]
fn meshes_are_found_beside_the_urdf_and_others_are_named() {
    let cell = std::env::temp_dir().join(format!("poecal_shapes_{}", std::process::id())).join("cell");
    let meshes = cell.join("robot/meshes");
    fs::create_dir_all(&meshes).unwrap();
    let triangle = [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];
    fs::write(meshes.join("arm.STL"), binary(&triangle)).unwrap();
    fs::write(meshes.join("base.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(meshes.join("broken.stl"), "solid nothing").unwrap();
    fs::write(meshes.join("large.stl"), binary(&triangle)).unwrap();
    fs::create_dir(meshes.join("folder.stl")).unwrap();
    let path = cell.join("robot/two.urdf");
    fs::write(&path, TEXT).unwrap();
    let model = Model::read(&path, &Default::default()).unwrap();
    let made = Simulation::default().run(&model.robot, SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let file = CalibrationFile::new(&calibration, &made.data, Inputs::of_model(&model));

    let found = Shapes::read(&file, &cell.join("out/calibration.json"));
    let of: Vec<(&str, Option<usize>, ShapeForm)> =
        found.shapes.iter().map(|it| (it.link.as_str(), it.body.joint(), it.form)).collect();
    // The same mesh twice is stored once.
    let expected = [
        ("base", None, ShapeForm::Mesh(0)),
        ("upper", Some(0), ShapeForm::Mesh(1)),
        ("lower", Some(1), ShapeForm::Mesh(0)),
    ];
    assert_eq!(of, expected);
    assert_eq!(found.notes.len(), 3, "{:?}", found.notes);
    assert!(found.notes[0].contains("`package://elsewhere/arm.stl` was not found"), "{:?}", found.notes);
    assert!(found.notes[1].contains("`meshes/broken.stl` is not drawn: found no triangles"), "{:?}", found.notes);
    assert!(
        found.notes[2].contains("`meshes/large.stl` is not drawn: it is 100 m long, the arm 0.4"),
        "{:?}",
        found.notes
    );
    assert_eq!(found.meshes.iter().map(|it| it.triangles).collect::<Vec<_>>(), [1, 1]);
    let longest = found.meshes[1].step * 65535.0;
    assert!((longest - 0.1).abs() < 1e-6, "{longest} m, of 100 by 0.001");
    assert_eq!(found, Shapes::read(&file, &cell.join("out/calibration.json")));
    // Shapes of moving links stay with the frames of their joints.
    let shape = &found.shapes[2];
    let (nominal, calibrated) = (&calibration.nominal.joints[1].frame, &calibration.robot.joints[1].frame);
    let apart = (nominal.inverse() * shape.nominal_pose).distance_and_angle(&(calibrated.inverse() * shape.pose));
    let moved = shape.nominal_pose.distance_and_angle(&shape.pose);
    println!("shapes stand on their joints within {apart:?}, which the calibration moved by {moved:?}");
    // Rounding of frames about 1 m.
    assert!(apart.0 < 1e-12 && apart.1 < 1e-7 && moved.0 > 1e-6, "{apart:?}, {moved:?}");
    assert_eq!((Shapes::from_calibration(&file).shapes.len(), Shapes::from_calibration(&file).notes.len()), (0, 0));

    // Beside the calibration, in the absence of the URDF.
    fs::rename(cell.join("robot"), cell.join("out")).unwrap();
    let again = Shapes::read(&file, &cell.join("out/calibration.json"));
    assert_eq!(again.shapes.len(), 2, "the package's folder has another name now: {:?}", again.notes);
    fs::remove_dir_all(cell.parent().unwrap()).unwrap();
    let none = Shapes::read(&file, Path::new("calibration.json"));
    assert_eq!((none.shapes.len(), none.notes.len()), (0, 1));
    assert!(none.notes[0].starts_with("5 meshes were not found"), "{:?}", none.notes);
}

#[test]
fn a_box_is_drawn_without_any_file() {
    let box_instead = r#"<box size="0.4 0.05 0.05"/>"#;
    let text = TEXT.replace(r#"<mesh filename="package://elsewhere/arm.stl"/>"#, box_instead);
    let model = Model::parse(&text, "two.urdf", &Default::default()).unwrap();
    let made = Simulation::default().run(&model.robot, SessionKind::POSE).unwrap();
    let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
    let mut file = CalibrationFile::new(&calibration, &made.data, Inputs::of_model(&model));
    let found = Shapes::from_calibration(&file).shapes;
    assert_eq!((found.len(), found[0].link.as_str(), found[0].form), (1, "upper", ShapeForm::Box([0.4, 0.05, 0.05])));

    // A robot that is no URDF has no shapes.
    file.inputs.urdf = None;
    assert_eq!(Shapes::read(&file, Path::new("calibration.json")), Shapes::default());
}
