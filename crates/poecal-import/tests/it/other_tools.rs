//! Cameras and samples of hand-eye programs in the forms of other tools: one lens, and one list of poses, in every form.

use std::fmt::Write as _;
use std::path::PathBuf;

use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};
use poecal_import::{CameraFile, PosePairs, PoseSource, PoseUnits, ReadOptions, read_cameras, read_pose_pairs};
use poecal_model::camera::{Distortion, Lens};
use poecal_testing::files::Folder;

fn cameras(name: &str, text: &str) -> Result<CameraFile, String> {
    let folder = Folder::new();
    let path = folder.write(name, text);
    read_cameras(path.to_str().unwrap()).map_err(|error| folder.without_path(&error.to_string()))
}

const OPENCV: &str = "image_width: 1920\nimage_height: 1200\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1400., 0., 959.5, 0., \
                      1410., 599.5, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.12, 0.03, 1e-4, \
                      -2e-4, 0. ]\n";

fn lens() -> Lens {
    let distortion = Distortion::Brown([-0.12, 0.03, 1e-4, -2e-4, 0.0, 0.0, 0.0, 0.0]);
    Lens { focal_px: [1400.0, 1410.0], centre_px: [959.5, 599.5], distortion, size_px: Some([1920, 1200]) }
}

#[test]
fn a_lens_is_the_same_in_every_form() {
    let message = "height: 1200\nwidth: 1920\ndistortion_model: plumb_bob\nd: [-0.12, 0.03, 0.0001, -0.0002, 0.0]\n\
                   k: [1400.0, 0.0, 959.5, 0.0, 1410.0, 599.5, 0.0, 0.0, 1.0]\nbinning_x: 0\n";
    for (name, text) in [
        ("opencv4.yaml", format!("%YAML:1.0\n---\n{OPENCV}")),
        ("opencv5.yml", format!("%YAML 1.2\n---\n{OPENCV}")),
        ("marked.yml", format!("\u{feff}%YAML 1.2\n---\n{OPENCV}")),
        (
            "opencv.xml",
            "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>1920</image_width>\n<image_height>1200</image_height>\n<camera_matrix \
             type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n    1400. 0. 959.5 0. 1410. 599.5 0. 0. \
             1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\">\n  <rows>1</rows>\n  <cols>5</cols>\n  <dt>d</dt>\n  \
             <data>\n    -0.12 0.03 1e-4 -2e-4 0.</data></distortion_coefficients>\n</opencv_storage>\n"
                .to_owned(),
        ),
        (
            "storage.json",
            "{\"image_width\": 1920, \"image_height\": 1200, \"camera_matrix\": {\"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\", \"data\": \
             [1400.0, 0.0, 959.5, 0.0, 1410.0, 599.5, 0.0, 0.0, 1.0]}, \"dist_coeffs\": {\"type_id\": \"opencv-matrix\", \"rows\": 1, \"cols\": 5, \
             \"dt\": \"d\", \"data\": [-0.12, 0.03, 1e-4, -2e-4, 0]}}"
                .to_owned(),
        ),
        (
            "lists.yaml",
            "width: 1920\nheight: 1200\ncamera_matrix:\n- - 1400.0\n  - 0.0\n  - 959.5\n- - 0.0\n  - 1410.0\n  - 599.5\n- - 0.0\n  - 0.0\n  - 1.0\n\
             dist_coeff:\n- - -0.12\n  - 0.03\n  - 0.0001\n  - -0.0002\n  - 0.0\n"
                .to_owned(),
        ),
        ("echo.yaml", format!("{message}---\n{message}---\n")),
        (
            "realsense.json",
            "{\"color\": {\"width\": 1920, \"height\": 1200, \"ppx\": 959.5, \"ppy\": 599.5, \"fx\": 1400.0, \"fy\": 1410.0, \"model\": \
             \"distortion.brown_conrady\", \"coeffs\": [-0.12, 0.03, 0.0001, -0.0002, 0.0]}}"
                .to_owned(),
        ),
        (
            "oak.json",
            "{\"batchName\": \"\", \"cameraData\": [[2, {\"cameraType\": 0, \"width\": 1920, \"height\": 1200, \"intrinsicMatrix\": [[1400.0,0,959.5],\
             [0,1410.0,599.5],[0,0,1]], \"distortionCoeff\": [-0.12,0.03,0.0001,-0.0002,0,0,0,0,0,0,0,0,0,0], \"extrinsics\": {\"toCameraSocket\": -1}}]]}"
                .to_owned(),
        ),
        (
            "zivid.yml",
            "CameraIntrinsics:\n  CameraMatrix:\n    CX: 959.5\n    CY: 599.5\n    FX: 1400\n    FY: 1410\n  Distortion:\n    K1: -0.12\n    K2: 0.03\n    \
             K3: 0\n    P1: 0.0001\n    P2: -0.0002\n"
                .to_owned(),
        ),
        (
            "mrcal.cameramodel",
            "# generated with mrcal\n{\n    'lensmodel':  'LENSMODEL_OPENCV5',\n\n    # fx,fy,cx,cy,distortion0,...\n    'intrinsics': [ 1400, 1410, \
             959.5, 599.5, -0.12, 0.03, 1e-4, -2e-4, 0,],\n\n    'rt_cam_ref': [ 0, 0, 0, 0, 0, 0,],\n    'imagersize': [ 1920, 1200,],\n\n    \
             'optimization_inputs': b'P)h>@6aWAK2ml36Ls*{}(#&;[0001v004T}'\n}\n"
                .to_owned(),
        ),
        (
            "device.json",
            "{\"model\": \"D435\", \"color\": {\"width\": 1920, \"height\": 1200, \"ppx\": 959.5, \"ppy\": 599.5, \"fx\": 1400.0, \"fy\": 1410.0, \
             \"distortion_model\": \"inverse_brown_conrady\", \"coeffs\": [-0.12, 0.03, 0.0001, -0.0002, 0.0]}, \"depth_scale\": 0.001, \"crop\": false}"
                .to_owned(),
        ),
    ] {
        let found = cameras(name, &text).unwrap_or_else(|error| panic!("{name}: {error}"));
        println!("{name}: {:?}", found.said);
        assert_eq!(found.cameras.len(), 1, "{name}");
        let expected = Lens { size_px: found.cameras[0].lens.size_px.and(lens().size_px), ..lens() };
        assert_eq!(found.cameras[0].lens, expected, "{name}");
    }
    // Open3D's matrix is column by column.
    let found = cameras(
        "open3d.json",
        "{\"width\": 1920, \"height\": 1200, \"intrinsic_matrix\": [1400, 0, 0, 0, 1410, 0, 959.5, 599.5, 1]}",
    )
    .unwrap();
    assert_eq!(found.cameras[0].lens, Lens { distortion: Distortion::Brown([0.0; 8]), ..lens() });
    let two = "{\"left\": {\"fx\": 1400, \"fy\": 1410, \"ppx\": 1, \"ppy\": 2}, \"right\": {\"fx\": 1400, \"fy\": 1410, \"ppx\": 1, \"ppy\": 2}}";
    let names: Vec<String> = cameras("two.json", two).unwrap().cameras.into_iter().map(|it| it.name).collect();
    assert_eq!(names, ["left", "right"]);
}

/// A camera of HALCON with this parameter.
fn halcon(parameter: &str) -> String {
    let line = |key: &str, value: &str| {
        format!("{key}:{}: {value};\n  DOUBLE:0.0:;\n  \"{key} of the camera\";\n\n", key.to_lowercase())
    };
    let numbers = [("Focus", "8.2e-3"), ("Sx", "5.5e-6"), ("Sy", "5.5e-6"), ("Cx", "959.5"), ("Cy", "599.5")];
    let numbers: String = numbers.map(|(key, value)| line(key, value)).concat();
    format!(
        "# INTERNAL CAMERA PARAMETERS\n\nParGroup: Cam_Par;\n  \"Internal camera parameters\";\n\n{numbers}{parameter}ImageWidth:imgw: 1920;\n  INT:1:32768;\n\nImageHeight:imgh: 1200;\n"
    )
}

#[test]
fn the_division_model_of_halcon_is_exact_to_a_thousandth_of_a_pixel() {
    let pinhole = cameras("camera.dat", &halcon("Kappa:kappa: 0;\n")).unwrap();
    assert_eq!(pinhole.cameras[0].lens.distortion, Distortion::Brown([-0.0, 0.0, 0.0, 0.0, -0.0, -0.0, 0.0, -0.0]));
    for kappa in [-1600.0_f64, 900.0, -40.0] {
        let found = cameras("camera.dat", &halcon(&format!("Kappa:kappa: {kappa:?};\n  DOUBLE::;\n\n"))).unwrap();
        let lens = found.cameras[0].lens;
        let focal = 8.2e-3 / 5.5e-6;
        let mut worst = 0.0_f64;
        for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.6, 0.38), (0.63, 0.4)] {
            // Lengths on the sensor are metres.
            let [u, v] = [x * 8.2e-3, y * 8.2e-3];
            let bent = 2.0 / (1.0 + (1.0 - 4.0 * kappa * (u * u + v * v)).sqrt());
            let pixel = lens.pixel(&Vector3::new(x, y, 1.0)).unwrap();
            let expected = [u * bent / 5.5e-6 + 959.5, v * bent / 5.5e-6 + 599.5];
            worst = worst.max((pixel.x - expected[0]).hypot(pixel.y - expected[1]));
        }
        println!("Kappa {kappa}: {worst:.1e} px of {focal:.0}");
        assert!(worst < 1e-3, "{kappa}: {worst}");
    }
}

#[test]
fn lenses_of_other_models_are_named() {
    let oak =
        "{\"fx\": 700, \"fy\": 700, \"cx\": 300, \"cy\": 200, \"dist\": [0.1, 0, 0, 0, 0, 0, 0, 0, 0.01, 0, 0, 0]}";
    for (name, text, part) in [
        (
            "realsense.json",
            "{\"fx\": 600, \"fy\": 600, \"ppx\": 320, \"ppy\": 240, \"model\": \"distortion.modified_brown_conrady\", \"coeffs\": [-0.05, 0.06, 0, 0, 0]}",
            "found the distortion `distortion.modified_brown_conrady` with 5 coefficients, expected plumb_bob, radtan",
        ),
        ("prism.json", oak, "expected none of a thin prism"),
        (
            "mrcal.cameramodel",
            "{ 'lensmodel': 'LENSMODEL_CAHVOR', 'intrinsics': [ 1, 2 ] }",
            "`LENSMODEL_CAHVOR` of mrcal, expected LENSMODEL_OPENCV8",
        ),
        (
            "short.cameramodel",
            "{ 'lensmodel': 'LENSMODEL_OPENCV8', 'intrinsics': [ 700, 700, 320, 240, 0.1, 0.2, 0, 0, 0 ] }",
            "found 9 numbers of `intrinsics`, expected 12 of LENSMODEL_OPENCV8",
        ),
        (
            "halved.json",
            "{\"cameras\": {\"scale\": 0.5, \"left\": {\"fx\": 600, \"fy\": 600, \"cx\": 320, \"cy\": 240}}}",
            "found `0.5` for `cameras.scale`, which this program does not apply",
        ),
        (
            "apart.json",
            "{\"left\": {\"fx\": 600, \"fy\": 600, \"cx\": 320, \"cy\": 240}, \"right\": {\"fx\": 600, \"fy\": 600, \"cx\": 320, \"cy\": 240}, \
             \"bent\": {\"dist_left\": [0.1, 0, 0, 0, 0], \"dist_right\": [0.1, 0, 0, 0, 0]}}",
            "found the distortion `bent.dist_left.0` away from its lens",
        ),
        (
            "kalibr.yaml",
            "cam0:\n  camera_model: ds\n  distortion_coeffs: []\n  distortion_model: none\n  intrinsics: [-0.01, 0.9, 420.0, 419.0, 303.0, 245.0]\n",
            "found the camera model `ds` of `cam0`, expected `pinhole`",
        ),
        ("skew.json", "{\"K\": [[600, 2, 320], [0, 600, 240], [0, 0, 1]]}", "found a skew of 2"),
        ("none.json", "{\"a\": [1, 2]}", "found 0 numbers of `camera_matrix`, expected 9"),
        ("empty.yaml", "---\n---\n", "expected a camera"),
    ] {
        let error = cameras(name, text).unwrap_err();
        println!("{error}");
        assert!(error.contains(part), "{error}");
    }
    // Without coefficients other than zero, a model of another name is a pinhole.
    let straight = "{\"fx\": 600, \"fy\": 600, \"ppx\": 320, \"ppy\": 240, \"model\": \"modified_brown_conrady\", \"coeffs\": [0, 0, 0, 0, 0]}";
    assert!(cameras("straight.json", straight).is_ok());
    let poly = halcon("Poly1:poly1: -1.2e3;\n  DOUBLE::;\n\n");
    let error = cameras("camera.dat", &poly).unwrap_err();
    assert!(
        error.contains(
            "found -1200 for `Poly1` of HALCON's camera, expected an area scan camera with the division model"
        ),
        "{error}"
    );
    for (parameter, part) in [
        ("", "without one of Focus, Kappa"),
        ("Kappa:kappa: -1200,5;\n", "found `-1200,5` for `Kappa`, expected one number"),
        ("Kappa:kappa: -12 (1/m2);\n", "found `-12 (1/m2)` for `Kappa`, expected one number"),
        ("Kappa:kappa: -12; Sx:sx: 5e-6;\n", "for `Kappa`, expected one number"),
        ("Kappa:kappa: -12;\nKappa:kappa: -13;\n", "found `Kappa` a second time"),
    ] {
        let error = cameras("camera.dat", &halcon(parameter)).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    let differing = format!("%YAML:1.0\n---\n{OPENCV}---\n{}", OPENCV.replace("1410.", "1411."));
    assert!(cameras("two.yaml", &differing).unwrap_err().contains("found another camera in document 2"));
}

/// Poses of a flange and of a target.
fn poses() -> Vec<(Pose, Pose)> {
    let pose = |at: f64| {
        Pose::from_xyz_rpy([0.4 + 0.1 * at.sin(), -0.1 * at, 0.5], [3.0 + 0.3 * at.cos(), 0.2 * at, 0.4 * at.sin()])
    };
    (0..5_u8).map(|k| (pose(f64::from(k)), pose(f64::from(k) + 0.5))).collect()
}

fn sixteen_numbers(pose: &Pose) -> Vec<f64> {
    let matrix = pose.rotation.insert_column(3, 0.0);
    let row = |at: usize| [matrix[(at, 0)], matrix[(at, 1)], matrix[(at, 2)], pose.translation[at]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].concat()
}

fn list_numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|it| format!("{it:?}")).collect::<Vec<_>>().join(", ")
}

fn transform(pose: &Pose) -> String {
    let ([x, y, z, w], at) = (pose.quaternion_xyzw(), pose.translation);
    format!(
        "    rotation: {{w: {w:?}, x: {x:?}, y: {y:?}, z: {z:?}}}\n    translation: {{x: {:?}, y: {:?}, z: {:?}}}\n",
        at.x, at.y, at.z
    )
}

fn read(paths: &[PathBuf]) -> Result<PosePairs, String> {
    let options = ReadOptions::default();
    let source = PoseSource { units: PoseUnits::default(), robot: None, pictures: &options };
    read_pose_pairs(paths, &source).map_err(|error| error.to_string())
}

fn are_poses(name: &str, found: &PosePairs) {
    println!("{name}: {:?} {:?}", found.understood, found.warnings);
    assert_eq!(found.flange.poses.len(), poses().len(), "{name}");
    for ((arm, seen), (own_arm, own_seen)) in poses().iter().zip(found.flange.poses.iter().zip(&found.target.poses)) {
        for (expected, own) in [(arm, own_arm), (seen, own_seen)] {
            let off = (expected.rotation - own.rotation).amax().max((expected.translation - own.translation).amax());
            assert!(off < 1e-9, "{name}: {off}");
        }
    }
}

#[test]
fn samples_of_other_programs_are_the_same_poses() {
    let folder = Folder::new();
    let all = poses();
    let mut texts: Vec<(&str, String)> = Vec::new();
    let of = |row: &dyn Fn(&Pose, &Pose) -> String| all.iter().map(|(arm, seen)| row(arm, seen)).collect::<String>();
    let item = |numbers: &[f64]| numbers.iter().map(|it| format!("    - {it:?}\n")).collect::<String>();
    texts.push((
        "moveit.yaml",
        of(&|arm, seen| {
            format!(
                "- effector_wrt_world:\n{}  object_wrt_sensor:\n{}",
                item(&sixteen_numbers(arm)),
                item(&sixteen_numbers(seen))
            )
        }),
    ));
    texts.push((
        "easy.yaml",
        "samples:\n".to_owned()
            + &of(&|arm, seen| format!("- robot:\n{}  tracking:\n{}", transform(arm), transform(seen))),
    ));
    let json = |pose: &Pose| {
        let rows: Vec<String> = sixteen_numbers(pose).chunks(4).map(|row| format!("[{}]", list_numbers(row))).collect();
        format!("[{}]", rows.join(","))
    };
    let matrices = |of: &dyn Fn(&(Pose, Pose)) -> String| all.iter().map(of).collect::<Vec<_>>().join(",\n");
    texts.push((
        "script.json",
        format!(
            "{{\"robot_poses\": [{}], \"target_poses\": [{}]}}",
            matrices(&|it| json(&it.0)),
            matrices(&|it| json(&it.1))
        ),
    ));
    let names = |stem: &str| (0..16).map(|at| stem.replace('#', &at.to_string())).collect::<Vec<_>>().join(",");
    let rvec = |pose: &Pose| {
        [rotation::log(&pose.rotation), pose.translation].iter().flat_map(|it| it.iter().copied()).collect::<Vec<f64>>()
    };
    let seen = "rvec_x,rvec_y,rvec_z,tvec_x,tvec_y,tvec_z";
    let by_columns =
        |pose: &Pose| -> Vec<f64> { (0..16).map(|at| sixteen_numbers(pose)[4 * (at % 4) + at / 4]).collect() };
    for (name, stem, is_by_columns) in
        [("rows.csv", "T#", false), ("franka.csv", "O_T_EE[#]", true), ("columns.csv", "pose_#", true)]
    {
        let numbers = |pose: &Pose| if is_by_columns { by_columns(pose) } else { sixteen_numbers(pose) };
        texts.push((
            name,
            format!("{},{seen}\n", names(stem))
                + &of(&|arm, seen| format!("{}\n", list_numbers(&[numbers(arm), rvec(seen)].concat()))),
        ));
    }
    // The name is easy_handeye2's, and libfranka's frames of the tool are beside the pose.
    texts.push(("arm.samples", texts[1].1.clone()));
    let numbers = |pose: &Pose| list_numbers(&by_columns(pose));
    let tool = list_numbers(&sixteen_numbers(&Pose::from_xyz_rpy([0.0, 0.0, 0.1], [0.0, 0.0, -0.8])));
    texts.push((
        "states.json",
        format!(
            "[{}]",
            matrices(&|(arm, seen)| format!(
                "{{\"O_T_EE\": [{}], \"F_T_EE\": [{tool}], \"O_T_EE_d\": [{tool}], \"target\": [{}]}}",
                numbers(arm),
                numbers(seen)
            ))
        ),
    ));
    // One entry has no target, and one no arm: as many of both, and no pairs.
    let lame = format!(
        "[{}]",
        matrices(&|it| {
            let (arm, seen) = (format!("\"robot\": {}", json(&it.0)), format!("\"target\": {}", json(&it.1)));
            match all.iter().position(|other| other == it) {
                Some(1) => format!("{{{arm}}}"),
                Some(3) => format!("{{{seen}}}"),
                _ => format!("{{{arm}, {seen}}}"),
            }
        })
    );
    let error = read(&[folder.write("lame.json", &lame)]).unwrap_err();
    assert!(error.contains("found 4 poses of the arm, 4 of the target"), "{error}");
    for (name, text) in texts {
        let found = read(&[folder.write(name, &text)]).unwrap_or_else(|error| panic!("{name}: {error}"));
        are_poses(name, &found);
    }
}

#[test]
fn a_pose_in_each_file_of_a_folder() {
    let (visp, zivid, seen) = (Folder::new(), Folder::new(), Folder::new());
    for (at, (arm, target)) in (1..).zip(&poses()) {
        let vector = |pose: &Pose| {
            let turn = rotation::log(&pose.rotation);
            let rows: Vec<String> =
                pose.translation.iter().chain(turn.iter()).map(|it| format!("  - [{it:?}]\n")).collect();
            format!("rows: 6\ncols: 1\ndata:\n{}", rows.concat())
        };
        visp.write(&format!("pose_rPe_{at}.yaml"), vector(arm));
        visp.write(&format!("pose_cPo_{at}.yaml"), vector(target));
        let mut text = "__version__:\n  serializer: 1\n  data: 1\nFloatMatrix:\n  Data: [\n".to_owned();
        for (row, numbers) in sixteen_numbers(arm).chunks(4).enumerate() {
            let mm: Vec<f64> =
                numbers.iter().enumerate().map(|(at, it)| if at == 3 && row < 3 { 1e3 * it } else { *it }).collect();
            writeln!(text, "    [{}],", list_numbers(&mm)).unwrap();
        }
        zivid.write(&format!("pos{at:02}.yaml"), text + "  ]\n");
        zivid.write(&format!("img{at:02}.zdf"), "not read");
        let rows: String =
            sixteen_numbers(target).chunks(4).map(|row| list_numbers(row).replace(',', "") + "\n").collect();
        seen.write(&format!("target_{at}.txt"), rows);
    }
    are_poses("visp", &read(&[visp.root_path().to_owned()]).unwrap());
    are_poses("zivid", &read(&[zivid.root_path().to_owned(), seen.root_path().to_owned()]).unwrap());
    visp.write("pose_rPe_9.yaml", "rows: 6\ncols: 1\ndata: [0, 0, 0, 0, 0, 0]\n");
    let error = read(&[visp.root_path().to_owned()]).unwrap_err();
    assert!(
        error.contains("found 6 poses of the arm, 5 of the target and 0 of which nothing says whose they are"),
        "{error}"
    );
    seen.write("target_9.txt", "1 2 3\n");
    let error = read(&[zivid.root_path().to_owned(), seen.root_path().to_owned()]).unwrap_err();
    assert!(error.contains("target_9.txt: found 0 poses, expected one in each file of the folder"), "{error}");
}
