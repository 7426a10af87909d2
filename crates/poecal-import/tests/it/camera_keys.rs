//! Keys of files of cameras that change the meaning of their numbers: applied, refused or named. Pictures of another size than the lens states.

use poecal_import::{CameraFile, ReadOptions, read_cameras};
use poecal_model::camera::{Camera, Lens};
use poecal_testing::files::Folder;

use crate::foreign_corners::{Session, as_texts};

/// A camera_info of ROS that ends with this text.
fn camera_info(end: &str) -> String {
    format!(
        "header:\n  frame_id: eye\nheight: 1200\nwidth: 1600\ndistortion_model: plumb_bob\nD: [-0.1, 0.0, 0.0, 0.0, 0.0]\n\
         K: [1250.0, 0.0, 801.0, 0.0, 1240.0, 610.0, 0.0, 0.0, 1.0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n{end}"
    )
}

fn region(numbers: [u32; 6]) -> String {
    let [x, y, width, height, by_x, by_y] = numbers;
    format!(
        "binning_x: {by_x}\nbinning_y: {by_y}\nroi:\n  x_offset: {x}\n  y_offset: {y}\n  height: {height}\n  width: {width}\n  do_rectify: false\n"
    )
}

fn cameras(name: &str, text: &str) -> Result<CameraFile, String> {
    let folder = Folder::new();
    let path = folder.write(name, text);
    let found = read_cameras(path.to_str().unwrap());
    found.map_err(|error| folder.without_path(&error.to_string())).map(|mut it| {
        it.said.iter_mut().for_each(|said| *said = folder.without_path(said));
        it
    })
}

#[test]
fn region_and_binning_of_a_sensor_make_the_lens_of_its_pictures() {
    let whole = cameras("whole.yaml", &camera_info("")).unwrap();
    for same in [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 1], [0, 0, 1600, 1200, 1, 1]] {
        assert_eq!(cameras("whole.yaml", &camera_info(&region(same))).unwrap(), whole, "{same:?}");
    }
    let found = cameras("part.yaml", &camera_info(&region([100, 40, 1200, 1000, 2, 3]))).unwrap();
    println!("{:?}", found.said);
    let lens = found.cameras[0].lens;
    assert_eq!((lens.focal_px, lens.centre_px), ([625.0, 1240.0 / 3.0], [350.5, 190.0]));
    assert_eq!((lens.size_px, lens.distortion), (Some([600, 333]), whole.cameras[0].lens.distortion));
    assert!(found.said[0].contains("by the region `roi` from (100, 40) on and the binning 2 × 3: fx 625.00"));
    for (numbers, part) in [
        (
            [500, 0, 1200, 1000, 1, 1],
            "1200 × 1000 pixels from (500, 0) on, expected one inside the sensor of 1600 × 1200",
        ),
        ([0, 0, 1200, 0, 1, 1], "found a region `roi` of 1200 × 0 pixels"),
    ] {
        let error = cameras("part.yaml", &camera_info(&region(numbers))).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    let error = cameras("part.yaml", &camera_info("binning_x: -2\n")).unwrap_err();
    assert!(error.contains("found -2 for `binning_x`, expected a count of pixels"), "{error}");
}

#[test]
fn keys_that_scale_or_shift_are_refused_and_others_named() {
    let csv = |name: &str, value: &str| {
        format!("name,fx,fy,cx,cy,width,height,{name}\neye,1250,1240,801,610,1600,1200,{value}\n")
    };
    for (name, text) in [
        ("omni.yaml", camera_info("xi: 0.8\n")),
        ("crop.yaml", camera_info("crop_offset_x: 12\n")),
        ("scaled.yaml", camera_info("image_scale: 0.5\n")),
        ("turned.yaml", camera_info("options:\n  flip_horizontally: true\n")),
        ("crop.csv", csv("crop_x", "40")),
        ("skew.csv", csv("skew", "2.5")),
        (
            "kalibr.yaml",
            "cam0:\n  camera_model: pinhole\n  intrinsics: [1250, 1240, 801, 610]\n  distortion_coeffs: []\n  distortion_model: none\n  \
             resolution: [1600, 1200]\n  downsampling: 2\n"
                .to_owned(),
        ),
    ] {
        let error = cameras(name, &text).unwrap_err();
        println!("{error}");
        assert!(error.contains("which this program does not apply") && error.contains(':'), "{error}");
    }
    for (name, text) in [
        (
            "neutral.yaml",
            camera_info("image_scale: 1.0\ncrop_x: 0\nflip: false\ncalibration_time: today\nrms_error: 0.3\n"),
        ),
        ("neutral.csv", csv("crop_x", "0")),
    ] {
        let found = cameras(name, &text).unwrap();
        assert!(found.said.iter().all(|it| !it.contains("flip") && !it.contains("time")), "{:?}", found.said);
    }
    // The pose of the camera is no rotation of its pictures.
    let mounted = "rotation: [0, 0, 0.7, 0.7]\ngrayscale: true\n";
    let found = cameras("mounted.yaml", &camera_info(mounted)).unwrap();
    assert_eq!(found.said, ["mounted.yaml: did not read `rotation`"]);
    assert!(cameras("turned.yaml", &camera_info("rotation: 180\n")).is_err());
    let found = cameras("more.yaml", &camera_info("gain: 3\nexposure: 20\n")).unwrap();
    assert_eq!(found.said, ["more.yaml: did not read `gain`, `exposure`"]);
    let visp = "<root><camera><name>eye</name><image_width>1600</image_width><image_height>1200</image_height><model>\
                <type>ProjWithKannalaBrandtDistortion</type><px>1250</px><py>1240</py><u0>801</u0><v0>610</v0><k1>0.1</k1></model></camera></root>";
    let error = cameras("visp.xml", visp).unwrap_err();
    assert!(error.contains("found the model `ProjWithKannalaBrandtDistortion`"), "{error}");
}

#[test]
fn corners_outside_the_pictures_of_the_lens_are_refused_with_how_the_sizes_are_related() {
    let session = Session::new();
    let files = session.own_files();
    let files = as_texts(&files);
    let with = |size_px: [u32; 2]| {
        let camera = &session.options.cameras[0];
        let lens = Lens { size_px: Some(size_px), ..camera.lens };
        ReadOptions { cameras: vec![Camera::new(camera.name.clone(), lens)], ..session.options.clone() }
    };
    assert!(session.read(&files, &with([1920, 1200])).is_ok());
    session.fails(&files, &with([960, 600]), &["outside the 960 × 600 pixels", "2 times as large in both directions"]);
    session.fails(&files, &with([1920, 700]), &["outside the 1920 × 700 pixels", "cropped pictures"]);
    session.fails(&files, &with([1200, 1920]), &["outside the 1200 × 1920 pixels", "width and height are exchanged"]);
    let found = session.read(&files, &with([3840, 2400])).unwrap();
    let is_quarter = |it: &String| it.contains("those of pictures of a half of the size");
    println!("{:?}", found.warnings);
    assert!(found.warnings.iter().any(is_quarter));
    let found = session.read(&files, &with([1920, 1200])).unwrap();
    assert!(!found.warnings.iter().any(|it| it.contains("of the size")), "{:?}", found.warnings);
}
