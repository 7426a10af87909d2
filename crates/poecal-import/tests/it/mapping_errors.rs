//! Bad mapping files: the message of each is one sentence with its place, *found* and *expected*.

use poecal_import::{ColumnMap, ReadOptions, read};
use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// Text of `map.toml`, and the whole message when a good file is read with it.
const MAPPINGS: &[(&str, &str)] = &[
    ("separator = \"|\"", "map.toml:1:13: found the separator `|`, expected `,`, `;`, `tab` or `whitespace`"),
    ("\u{feff}separator = \"|\"", "map.toml:1:13: found the separator `|`, expected `,`, `;`, `tab` or `whitespace`"),
    ("decimal = \"'\"", "map.toml:1:11: found the decimal sign `'`, expected `.` or `,`"),
    (
        "\n\nseparater = \";\"",
        "map.toml:3:1: unknown field `separater`, expected one of `separator`, `decimal`, `skip_lines`, `pose`, `ignore`, `id`, `target`, `target_name`, `instrument`, `set`, `third_axis`, `units`, `joints`, `position`, `orientation`, `sigma_position`, `sigma_rotation`, `targets`, `mount`",
    ),
    (
        "[position]\nunit = \"furlong\"",
        "map.toml:2:8: found the unit `furlong`, expected a length (m, cm, mm, um, nm, in)",
    ),
    ("[position]\ncolumns = [\"x\", \"y\"]", "map.toml:2:11: invalid length 2, expected an array of length 3"),
    (
        "[joints]\na = { unit = \"grad\" }",
        "map.toml:2:14: found the unit `grad`, expected one of m, cm, mm, um, nm, in, rad, mrad, deg, arcmin, arcsec, ticks",
    ),
    (
        "[joints]\na = { unit = \"mm\" }",
        "map.toml: found the unit `mm` for joint `a`, expected an angle (rad, mrad, deg, arcmin, arcsec, ticks)",
    ),
    (
        "[joints]\na = { colum = \"x\" }",
        "map.toml:2:7: unknown field `colum`, expected one of `column`, `columns`, `value`, `offset`, `unit`",
    ),
    (
        "[joints]\na = 3.5",
        "map.toml:2:5: invalid type: floating point `3.5`, expected the name or the number of a column, or a table with `column`, `columns` or `value`, and `offset` and `unit`",
    ),
    (
        "[joints]\na = { column = \"a\", value = 0.0 }",
        "map.toml:2:5: found both `column` and `value`, expected one of them",
    ),
    (
        "[joints]\na = { columns = { a = 1 }, value = 0.0 }",
        "map.toml:2:5: found both `columns` and `value`, expected one of them",
    ),
    (
        "[joints]\na = { columns = {} }",
        "map.toml:2:5: found no column in `columns`, expected columns with their factors, like { J2 = -1, J3 = 1 }",
    ),
    (
        "[joints]\na = { columns = { a = 1, b = 0 } }",
        "map.toml:2:5: found the factor 0 of column `b`, expected a number other than 0, like 1 or -1",
    ),
    (
        "[joints]\na = { columns = { a = 1, bb = 1 } }",
        "points.csv:1: found no column `bb`, expected one for joint `a`; the columns are id, a, lift, b, x, y, z",
    ),
    (
        "[joints]\na = { columns = { a = 1 }, unit = \"mm\" }",
        "map.toml: found the unit `mm` for joint `a`, expected an angle (rad, mrad, deg, arcmin, arcsec, ticks)",
    ),
    (
        "sigma_position = { columns = { x = 1 } }",
        "map.toml: found `columns` for `sigma_position`, expected one column: only joints are sums of columns",
    ),
    ("[joints]\njoint1 = \"a\"", "map.toml: found the joint `joint1`, expected one of a, lift, b"),
    (
        "[joints]\na = \"aa\"",
        "points.csv:1: found no column `aa`, expected one for joint `a`; the columns are id, a, lift, b, x, y, z",
    ),
    (
        "[joints]\na = \"x\"",
        "points.csv:1:13: found one column for both `a` and `x`, expected a column for each; name them in a mapping file (--columns)",
    ),
    (
        "[orientation]\nform = \"intrinsic_xxy\"\ncolumns = [\"x\", \"y\", \"z\"]",
        "map.toml:2:8: found the orientation form `intrinsic_xxy`, expected quaternion_xyzw, quaternion_wxyz, rotation_vector, rotation_matrix, rotation_matrix_by_columns, roll_pitch_yaw, or intrinsic_ or extrinsic_ and three axes such as intrinsic_xyz",
    ),
    (
        "[orientation]\nform = \"quaternion_wxyz\"\ncolumns = [\"x\", \"y\", \"z\"]",
        "map.toml:1:1: found 3 `columns`, expected 4 (quaternion w, x, y, z)",
    ),
    (
        "[orientation]\nform = \"intrinsic_xyz\"",
        "map.toml:1:1: found 0 `columns`, expected 3 (intrinsic Euler angles about x, y, z)",
    ),
    (
        "target = \"marker\"",
        "points.csv:1: found no column `marker`, expected one for the target's name; the columns are id, a, lift, b, x, y, z",
    ),
    (
        "target = \"id\"\ntarget_name = \"smr1\"",
        "map.toml: found both `target` and `target_name`, expected one of them",
    ),
    (
        "[[targets]]\nname = \"s\"\nposition = {}\n[[targets]]\nname = \"s\"\nposition = {}",
        "map.toml: found two targets named `s`, expected unique names",
    ),
    (
        "[position]\n[[targets]]\nname = \"s\"\nposition = {}",
        "map.toml: found both `position` and `[[targets]]`, expected `position` in each target only",
    ),
    ("[[targets]]\nposition = {}", "map.toml:1:1: missing field `name`"),
    (
        "pose = \"target_from_device\"",
        "points.csv:2:9: found a position without orientation, expected both, because the mapping says that poses are target_from_device",
    ),
    (
        "direction = \"target_from_device\"",
        "map.toml:1:1: found the key `direction`, expected `pose = \"target_from_device\"` (or \"device_from_target\") for the way that the file's poses point",
    ),
    (
        "pose = \"inverted\"",
        "map.toml:1:8: unknown variant `inverted`, expected `device_from_target` or `target_from_device`",
    ),
    (
        "set = { column = \"phase\", fit = [\"1\"] }",
        "points.csv:1: found no column `phase`, expected one that states which rows are fitted; the columns are id, a, lift, b, x, y, z",
    ),
    (
        "set = { column = \"id\", fit = [] }",
        "map.toml: found no value in `fit`, expected the values that mark a row to fit",
    ),
    (
        "set = { column = \"id\", fit = [\"8\"] }",
        "points.csv: found no row with `8` in column `id`, expected at least one to fit",
    ),
    (
        "id = \"name\"",
        "points.csv:1: found no column `name`, expected one for the row's id; the columns are id, a, lift, b, x, y, z",
    ),
    ("joints = { b = { value = 1e30 } }", "map.toml: found the value 1e30 for joint `b`, expected at most 1e6 rad"),
    ("skip_lines = -1", "map.toml:1:14: invalid value: integer `-1`, expected usize"),
    ("a = ", "map.toml:1:5: string values must be quoted, expected literal string"),
];

#[test]
fn bad_mappings_are_refused_with_one_sentence() {
    let mut wrong = 0;
    for (text, expected) in MAPPINGS {
        let folder = Folder::new();
        let path = folder.write("points.csv", "id,a,lift,b,x,y,z\n1,0,0,0,0.1,0.2,0.3\n");
        let map = folder.write("map.toml", text);
        let result = ColumnMap::read(&map).and_then(|map| {
            read(&[path], &lifting_robot(), &ReadOptions { mapping: Some(map), ..ReadOptions::default() })
        });
        let found = match result {
            Ok(_) => "no error".to_owned(),
            Err(error) => folder.without_path(&error.to_string()),
        };
        if found != *expected {
            wrong += 1;
            println!("{text}\n  expected {expected}\n  found    {found}\n");
        }
    }
    assert_eq!(wrong, 0);
}

#[test]
fn a_mapping_that_is_not_there_is_refused() {
    let folder = Folder::new();
    assert_eq!(
        folder.without_path(&ColumnMap::read(folder.path("none.toml")).unwrap_err().to_string()),
        "none.toml: found no such file, expected a column mapping (TOML, or LeRobot's JSON): check the path"
    );
}
