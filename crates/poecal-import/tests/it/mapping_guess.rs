//! The mapping that poecal guesses for a file of another program, and the choices instead.

use poecal_import::{ColumnGuess, ColumnMap, ReadOptions, guess_columns, read};
use poecal_model::measurement::Dataset;
use poecal_numerics::error::ErrorKind;

use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// Joints a and b in degrees, the lift in millimetres, a pose by angles in degrees; commanded beside measured values.
const FOREIGN: &str = "no;goal x;goal y;goal z;axis one;axis two;axis three;meas_x;meas_y;meas_z;meas_rx;meas_ry;meas_rz\n\
                       1;1;2;3;90,5;250;-12;1500,5;-20;30;10;20;170\n2;1;2;3;10,5;125;15;1400,5;-25;35;15;25;-170\n";
/// The same table in our form.
const OWN: &str = "a[deg],lift[mm],b[deg],x[mm],y[mm],z[mm],p,q,r\n90.5,250,-12,1500.5,-20,30,10,20,170\n10.5,125,15,1400.5,-25,35,15,25,-170\n";
const OWN_ANGLES: &str = "[orientation]\nform = \"intrinsic_zyx\"\ncolumns = [\"p\", \"q\", \"r\"]\nunit = \"deg\"\n";

fn guess(text: &str, chosen: &[(&str, &str)]) -> poecal_numerics::error::Result<ColumnGuess> {
    let folder = Folder::new();
    let path = folder.write("points.csv", text);
    let chosen: Vec<(String, String)> =
        chosen.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    guess_columns(path, &lifting_robot(), &chosen)
}

fn rows(text: &str, map: &str) -> Dataset {
    let folder = Folder::new();
    let path = folder.write("points.csv", text);
    let mapping = Some(ColumnMap::parse(map, "map.toml").unwrap());
    let options = ReadOptions { mapping, ..ReadOptions::default() };
    read(&[path], &lifting_robot(), &options).unwrap().data
}

fn assert_same(one: &Dataset, other: &Dataset) {
    assert_eq!(one.len(), other.len());
    for row in 0..one.len() {
        assert_eq!(one.readings(row), other.readings(row), "row {row}");
        assert_eq!(one.observations[row].measurement, other.observations[row].measurement, "row {row}");
    }
}

#[test]
fn a_foreign_table_is_guessed_and_read_like_its_own() {
    let found = guess(FOREIGN, &[("orientation", "intrinsic_zyx")]).unwrap();
    assert_eq!(found.missing, [""; 0]);
    assert_eq!(found.ignored, ["no", "goal x", "goal y", "goal z"]);
    assert_same(&rows(FOREIGN, &found.mapping), &rows(OWN, OWN_ANGLES));
    let chosen = |key: &str| found.fields.iter().find(|it| it.key == key).map(|it| it.chosen.as_str());
    let units = ["unit.angle", "unit.length", "unit.position", "unit.orientation"].map(chosen);
    assert_eq!(units, [Some("deg"), Some("mm"), Some("mm"), Some("deg")]);
    assert_eq!(found.columns[4].cells, ["90,5", "10,5"]);
}

#[test]
fn a_choice_takes_the_place_of_what_was_guessed() {
    let first = guess(FOREIGN, &[]).unwrap();
    assert!(first.mapping.contains("form = \"intrinsic_xyz\""), "{}", first.mapping);
    let choices = [
        ("x", "goal x"),
        ("id", "no"),
        ("a", ""),
        ("orientation", "quaternion_xyzw"),
        ("orientation", ""),
        ("unit.position", "in"),
        ("unit.length", ""),
    ];
    let other = guess(FOREIGN, &choices).unwrap();
    assert_eq!(other.missing, ["a"]);
    let expected = "# How the columns of points.csv are read, by the option --columns.\nid = \"no\"\n\n[joints]\n# a = found no column\nlift = \"axis two\"\n\
                    b = { column = \"axis three\", unit = \"deg\" }\n\n[position]\ncolumns = [\"goal x\", \"meas_y\", \"meas_z\"]\nunit = \"in\"\n";
    assert_eq!(other.mapping, expected);
}

#[test]
fn names_of_ours_that_are_not_wanted_are_ignored() {
    let text = "a[deg],lift[mm],b[deg],x[mm],y[mm],z[mm],qx,qy,qz,qw,target\n1,2,3,4,5,6,0,0,0,1,tcp\n";
    let as_it_is = guess(text, &[]).unwrap();
    assert_same(&rows(text, &as_it_is.mapping), &rows(text, ""));
    let points = guess(text, &[("orientation", ""), ("target", "")]).unwrap();
    assert!(points.mapping.contains("ignore = [\"qx\", \"qy\", \"qz\", \"qw\", \"target\"]"), "{}", points.mapping);
    let data = rows(text, &points.mapping);
    assert!(!data.observations[0].measurement.sees_orientation());
    assert_eq!(data.targets, [None]);
}

#[test]
fn columns_that_share_a_name_are_told_apart_by_their_numbers() {
    let text = "axis 1,axis 2,axis 3,pos,pos,pos,x,y\n1,2,3,100,200,300,1,2\n";
    let found = guess(text, &[("x", "column 4"), ("y", "column 5"), ("z", "column 6")]).unwrap();
    assert_eq!(found.missing, [""; 0]);
    let data = rows(text, &found.mapping);
    assert_eq!(data.observations[0].measurement.pose().translation.as_slice(), [0.1, 0.2, 0.3]);
}

#[test]
fn wrong_choices_and_files_that_have_none_get_one_sentence() {
    let refused = |chosen: &[(&str, &str)]| {
        let error = guess(FOREIGN, chosen).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Option);
        error.to_string()
    };
    assert!(
        refused(&[("x", "meas_q")])
            .starts_with("--column: found no column `meas_q` for `x`, expected one of the file, the nearest is `meas_")
    );
    assert!(refused(&[("w", "meas_x")]).starts_with("--column: found `w`, expected what a column is for"));
    assert!(refused(&[("orientation", "euler")]).starts_with("--column: found the orientation form `euler`, expected"));
    assert!(refused(&[("unit.position", "deg")]).starts_with("--column: found the unit `deg`"));
    assert!(refused(&[("pose", "inverse")]).contains("expected device_from_target or target_from_device"));
    let motive = "Format Version,1.23,Take Name,a,Capture Frame Rate,100\n\n,Type,Rigid Body\n";
    assert!(guess(motive, &[]).is_err());
}
