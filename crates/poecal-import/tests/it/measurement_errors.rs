//! Bad measurement files: the message of each is one sentence with its place, *found* and *expected*.

use poecal_import::{FitWhere, ReadOptions, read, read_joints};
use poecal_testing::files::Folder;
use poecal_testing::sessions::lifting_robot;

/// Bytes of `points.csv`, and the whole message.
const FILES: &[(&[u8], &str)] = &[
    (b"", "points.csv: found no line with text, expected a header and rows"),
    (b"# only a comment\n\n", "points.csv: found no line with text, expected a header and rows"),
    (b"a,lift,b,x,y,z\n", "points.csv:1: found a header and no rows, expected at least one measurement"),
    (
        b"0,0,0,1,2,3\n",
        "points.csv:1: found a table without names of columns, with 6 numbers in a row, expected 3 joint readings, with a time or a name before them, or x, y, z of a point, with its name before them: put a line above that names the columns, or number them in a mapping (--columns), like `position = { columns = [1, 2, 3] }`",
    ),
    (b"a,lift,b,x,y,z\n0,0,0,1,2\n", "points.csv:2:10: found 5 cells, expected 6 as in the header (line 1); add the missing cells (they may be empty), or put `#` in front of a line that is no row"),
    (
        b"a,lift,b,x,y,z\n0,0,0,1,2,3,4\n",
        "points.csv:2:13: found 7 cells, expected 6 as in the header (line 1); numbers with a decimal comma need another separator, such as `;`, or quotes",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,\"1,2,3\n",
        "points.csv:2:7: found a quote that is not closed on its line, expected a closing `\"`",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,\"1\"0,2,3\n",
        "points.csv:2:10: found text after a closing quote, expected a separator",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,1,2,\xe4\n",
        "points.csv:2:11: found `ä` in column `z`, expected a finite number; put `#` in front of a line that is no row",
    ),
    (b"\xff\xfea\0,\0\x00\xd8", "points.csv:1: found half a character, expected UTF-16 text as before, or UTF-8"),
    (
        b"a\0,\0b\0\n\0-\0,\0-\0\n\0",
        "points.csv:1: found no column `lift`, expected one for joint `lift`; the columns are a, b: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"\0a\0,\0b\0\n0",
        "points.csv:2: found an odd number of bytes, expected UTF-16 text as before, or UTF-8",
    ),
    (
        b"a,lift,b,x,y,z,note\n0,0,0,1,2,3,\0\n",
        "points.csv:2:13: found a NUL byte, expected text; save the file as `CSV UTF-8`",
    ),
    (
        b"a,lift,B,x,y,z\n0,0,0,1,2,3\n",
        "points.csv:1: found no column `b`, expected one for joint `b`; the nearest name found is `B`: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,x,y,z,temperature\n0,0,1,2,3,20\n",
        "points.csv:1: found no column `b`, expected one for joint `b`; the columns are a, lift, x, y, z, temperature: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,x,y\n0,0,0,1,2\n",
        "points.csv:1: found no column `z`, expected one for the position z; the columns are a, lift, b, x, y: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,X,y,z\n0,0,0,1,2,3\n",
        "points.csv:1: found no column `x`, expected one for the position x; the nearest name found is `X`: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,x,y,z,a[deg]\n0,0,0,1,2,3,4\n",
        "points.csv:1:16: found a second column `a`, expected one; rename or remove one of them",
    ),
    (
        b"id,a,lift,b,x,y,z,id\n0,0,0,0,1,2,3,4\n",
        "points.csv:1:19: found a second column `id`, expected one; rename or remove one of them",
    ),
    (
        b"a,lift,b,x[ft],y,z\n0,0,0,1,2,3\n",
        "points.csv:1:10: found the unit `ft` for the position x, expected a length (m, cm, mm, um, nm, in)",
    ),
    (
        b"a,lift,b,x[MM],y,z\n0,0,0,1,2,3\n",
        "points.csv:1:10: found the unit `MM` for the position x, expected a length (m, cm, mm, um, nm, in); did you mean `mm`?",
    ),
    (
        b"a[mm],lift,b,x,y,z\n0,0,0,1,2,3\n",
        "points.csv:1:1: found the unit `mm` for joint `a`, expected an angle (rad, mrad, deg, arcmin, arcsec, ticks)",
    ),
    (
        b"a,lift[deg],b,x,y,z\n0,0,0,1,2,3\n",
        "points.csv:1:3: found the unit `deg` for joint `lift`, expected a length (m, cm, mm, um, nm, in)",
    ),
    (
        b"a,lift,b,x,y,z,sigma_position[rad]\n0,0,0,1,2,3,1\n",
        "points.csv:1:16: found the unit `rad` for `sigma_position`, expected a length (m, cm, mm, um, nm, in)",
    ),
    (
        b"a,lift,b,x,y,z,qx[deg],qy,qz,qw\n0,0,0,1,2,3,0,0,0,1\n",
        "points.csv:1:16: found the unit `deg` for the orientation (quaternion x, y, z, w), expected a number without unit (1)",
    ),
    (
        b"a,lift,b,x,y,z,qx,qy,qz\n0,0,0,1,2,3,0,0,0\n",
        "points.csv:1: found no column `qw`, expected one for the orientation (quaternion x, y, z, w); the columns are a, lift, b, x, y, z, qx, qy, qz: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,x,y,z,rx,ry,rz,roll,pitch,yaw\n0,0,0,1,2,3,0,0,0,0,0,0\n",
        "points.csv:1:25: found the orientation columns `rx` and `roll`, expected one form only",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,nan,2,3\n",
        "points.csv:2:7: found `nan` in column `x`, expected a finite number: leave the cell empty where nothing was measured",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,-inf,1,2,3\n",
        "points.csv:2:5: found `-inf` in column `b`, expected a finite number: leave out a row without a reading",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,1e999,2,3\n",
        "points.csv:2:7: found `1e999` in column `x`, expected a finite number",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,1,2,3\n0,0,0,1,-1e200,3\n",
        "points.csv:3:9: found `-1e200` in column `y`, expected at most 1e6 m: correct the number or the column's unit, or leave out the row",
    ),
    (
        b"a,lift,b,x,y,z,sigma_position[mm]\n0,0,0,1,2,3,1e10\n",
        "points.csv:2:13: found `1e10` in column `sigma_position`, expected at most 1e6 m: correct the number or the column's unit, or leave out the row",
    ),
    (
        b"a,lift,b,x,y,z,qx,qy,qz,qw\n0,0,0,1,2,3,0,0,0,1e300\n",
        "points.csv:2:19: found `1e300` in column `qw`, expected at most 1e6: correct the number or the column's unit, or leave out the row",
    ),
    (
        "a,lift,b,x,y,z,note\n0,0,0,1,2,n/a,ä\n".as_bytes(),
        "points.csv:2:11: found `n/a` in column `z`, expected a finite number: leave the cell empty where nothing was measured",
    ),
    (
        "note,a,lift,b,x,y,z\n\"ä,\"\"ö\"\"\",0,0,0,1,2,x\n".as_bytes(),
        "points.csv:2:21: found `x` in column `z`, expected a finite number; put `#` in front of a line that is no row",
    ),
    (
        b"a;lift;b;x;y;z\n0,5;0;0;1;2;3\n\n# later\n0.5;0;0;1;2;3\n",
        "points.csv:5:1: found `0.5` in column `a`, expected a number with a decimal comma as in line 2",
    ),
    (
        b"a;lift;b;x;y;z\n0;0;0;1.234,5;2;3\n",
        "points.csv:2:7: found `1.234,5` in column `x`, expected a number with one decimal sign and no thousands separators",
    ),
    (
        b"a,lift,b,x,y,z\n,0,0,1,2,3\n",
        "points.csv:2:1: found an empty cell in column `a`, expected a joint reading: add it, or leave out the row",
    ),
    (
        b"a,lift,b,x,y,z,rx,ry,rz\n0,0,0,1,,3,0,0,1\n",
        "points.csv:2:9: found an empty cell in column `y`, expected a position: where none was measured, leave all of its cells empty",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,,,\n1,0,0,0,0,0.0\n",
        "points.csv:1: found no position in any row, expected at least one that is neither empty nor zero",
    ),
    (
        b"a,lift,b,x,y,z,rx,ry,rz\n0,0,0,,,,1,0,0\n",
        "points.csv:2:7: found an empty cell in column `x`, expected a position: where none was measured, leave all of its cells empty",
    ),
    (
        b"a_rad,lift_m,b_rad,x_mm,y_mm,z_mm\n0,0,0,1,2,3\n",
        "points.csv:1: found no column `a`, expected one for joint `a`; if `a_rad` is meant, write `a[rad]`: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,x in mm,y in mm,z in mm\n0,0,0,1,2,3\n",
        "points.csv:1: found no column `x`, expected one for the position x; if `x in mm` is meant, write `x[mm]`: rename or add a column, or name the right one in a mapping file (--columns)",
    ),
    (
        b"a,lift,b,x,y,z,x (mm)\n0,0,0,1,2,3,4\n",
        "points.csv:1:16: found a second column `x`, expected one; rename or remove one of them",
    ),
    (
        b"P1,0,0,0,1,2,3\n",
        "points.csv:1: found a table without names of columns, with a name and 6 numbers in a row, expected 3 joint readings, with a time or a name before them, or x, y, z of a point, with its name before them: put a line above that names the columns, or number them in a mapping (--columns), like `position = { columns = [1, 2, 3] }`",
    ),
    (
        b"a|lift|b|x|y|z\n0|0|0|1|2|3\n",
        "points.csv:1: found no column `a`, expected one for joint `a`; the whole line is one column, `a|lift|b|x|y|z`: separate the columns by `,`, `;`, tabs or blanks",
    ),
    (
        b"a,lift,b,x,y,z\n0,0;0;0;1;2;3\n",
        "points.csv:2:14: found 2 cells, expected 6 as in the header (line 1); separated by `;` there are 6: separate header and rows alike",
    ),
    (
        b"sep=|\na|lift|b|x|y|z\n0|0|0|1|2|3\n",
        "points.csv:1:1: found the separator `|`, expected `,`, `;`, a tab or a blank",
    ),
    (b"sep=;\n", "points.csv: found no line with text, expected a header and rows"),
    (
        b"a,lift,b,x,y,z\ndeg,mm,deg,mm,mm\n0,0,0,1,2,3\n",
        "points.csv:2:17: found 5 cells, expected 6 as in the header (line 1); add the missing cells (they may be empty), or put `#` in front of a line that is no row",
    ),
    (
        b"a,lift,b,x,y,z\ndeg,deg,deg,mm,mm,mm\n0,0,0,1,2,3\n",
        "points.csv:2:5: found the unit `deg` for joint `lift`, expected a length (m, cm, mm, um, nm, in)",
    ),
    (
        b"a,lift,b,x,y[m],z\n[deg],[mm],[deg],[mm],[mm],[mm]\n0,0,0,1,2,3\n",
        "points.csv:2:23: found the unit `mm` below `y[m]`, expected `m` as in the header (line 1), or an empty cell",
    ),
    (
        b"a,lift,b,x,y,z\ndeg,mm,deg,mm,,\n0,0,0,1,2,3\n",
        "points.csv:1:12: found no unit below column `y` in the line of units (line 2), expected one for the position y: write `m` there if it is in m",
    ),
    (
        b"a;lift;b;x;y;z\n0;0;0;1 234,5;2;3\n",
        "points.csv:2:7: found `1 234,5` in column `x`, expected a number with one decimal sign and no thousands separators",
    ),
    (
        b"a,lift,b,x,y,z\n#N/A,0,0,1,2,3\n",
        "points.csv:2:1: found `#N/A` in column `a`, expected a finite number: leave out a row without a reading",
    ),
    (
        b"a,lift,b,x,y,z,qx,qy,qz,qw\n0,0,0,1,2,3,0,0,,1\n",
        "points.csv:2:17: found an empty cell in column `qz`, expected an orientation that is complete or absent",
    ),
    (
        b"a,lift,b,x,y,z,qx,qy,qz,qw\n0,0,0,1,2,3,0,0,0.5,0.5\n",
        "points.csv:2:13: found a quaternion of norm 0.7071, expected 1 to within 0.01",
    ),
    (
        b"a,lift,b,x,y,z,sigma_position\n0,0,0,1,2,3,0\n",
        "points.csv:2:13: found `0` in column `sigma_position`, expected a standard deviation above 0",
    ),
    (
        b"a,lift,b,x,y,z,sigma_rotation\n0,0,0,1,2,3,-0.1\n",
        "points.csv:2:13: found `-0.1` in column `sigma_rotation`, expected a standard deviation above 0",
    ),
    (
        b"a,lift,b,x,y,z,set\n0,0,0,1,2,3,train\n",
        "points.csv:2:13: found `train` in column `set`, expected `fit` or `held_out`",
    ),
    (
        b"a,lift,b,x,y,z,target\n0,0,0,1,2,3,smr1\n0,0,0,1,2,3,\n",
        "points.csv:3:13: found no target name, expected one as in points.csv:2; all rows name their target or none does",
    ),
    (
        b"a,lift,b,x,y,z,target\n0,0,0,1,2,3,\n0,0,0,1,2,3,smr1\n",
        "points.csv:3:13: found the target `smr1`, expected no name as in points.csv:2; all rows name their target or none does",
    ),
    (
        b"a,lift,b,x,y,z\n90,0,0,1,2,3\n-45.5,0,0,1,2,3\n",
        "points.csv:2:1: found readings of up to 90 rad, far outside the limits -3.15 to 3.15 rad of joint `a`, expected another unit, most likely deg; write `a[deg]` in the header, or state --units deg",
    ),
    (
        b"a[rad],lift,b,x,y,z\n900,0,0,1,2,3\n-3100,0,0,1,2,3\n",
        "points.csv:3:1: found readings of up to 3100 rad, far outside the limits -3.15 to 3.15 rad of joint `a`, expected another unit, most likely mrad; write `a[mrad]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,120,1,2,3\n0,0,-40,1,2,3\n",
        "points.csv:2:5: found readings of up to 120 rad, too far for joint `b`, expected another unit, most likely deg; write `b[deg]` in the header, or state --units deg",
    ),
    (
        b"a,lift,b,x,y,z\n0,300,0,1,2,3\n0,20,0,1,2,3\n",
        "points.csv:2:3: found readings of up to 300 m, far outside the limits 0 to 0.5 m of joint `lift`, expected another unit, most likely mm; write `lift[mm]` in the header, or state --units mm",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,900,0,0\n1,0,0,100,-900,0\n2,0,0,-800,100,0\n",
        "points.csv:4: found positions up to 905.5 m from their middle, where the robot reaches 1.583 m, expected another unit, most likely mm; write `x[mm],y[mm],z[mm]` in the header, or state --units mm",
    ),
    (
        b"a,lift,b,x[mm],y[mm],z[mm]\n0,0,0,9e5,0,0\n1,0,0,0,-9e5,0\n2,0,0,-8e5,0,0\n",
        "points.csv:3: found positions up to 900000 mm from their middle, where the robot reaches 1583 mm, expected another unit, most likely um; write `x[um],y[um],z[um]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x[mm],y[mm],z[mm]\n0,0,0,1,0,0.3\n1,0,0,0.54,0.84,0.3\n2,0,0,-0.42,0.91,0.3\n3,0,0,-0.99,0.14,0.3\n",
        "points.csv:1:10: found positions that spread over 0.9625 mm where the model moves its tip by 958.9 mm, expected about the same: most likely they are in m, not mm (or the model's lengths are 1000 times too large); write `x[m],y[m],z[m]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x[cm],y[cm],z[cm]\n0,0,0,1000,0,300\n1,0,0,540,840,300\n2,0,0,-420,910,300\n3,0,0,-990,140,300\n",
        "points.csv:1:10: found positions that spread over 962.5 cm where the model moves its tip by 95.89 cm, expected about the same: most likely they are in mm, not cm (or the model's lengths are 10 times too small); write `x[mm],y[mm],z[mm]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x[in],y[in],z[in]\n0,0,0,1000,0,300\n1,0,0,540,840,300\n2,0,0,-420,910,300\n3,0,0,-990,140,300\n",
        "points.csv:5: found positions up to 1683 in from their middle, where the robot reaches 62.33 in, expected another unit, most likely mm; write `x[mm],y[mm],z[mm]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x[mm],y[mm],z[mm]\n0,0,0,39.4,0,11.8\n1,0,0,21.3,33.1,11.8\n2,0,0,-16.5,35.8,11.8\n3,0,0,-39,5.5,11.8\n",
        "points.csv:1:10: found positions that spread over 37.9 mm where the model moves its tip by 958.9 mm, expected about the same: most likely they are in inches, not mm (or the model's lengths are 25.4 times too large); write `x[in],y[in],z[in]` in the header, or the unit in the mapping",
    ),
    (
        b"a,lift,b,x,y,z\n0,0,0,1e-3,0,0\n1,0,0,0.54e-3,0.84e-3,0\n2,0,0,-0.42e-3,0.91e-3,0\n3,0,0,-0.99e-3,0.14e-3,0\n",
        "points.csv:1:10: found positions that spread over 0.0009625 m where the model moves its tip by 0.9589 m, expected about the same: most likely the model's lengths are 1000 times too large; correct its unit, or the unit of the positions",
    ),
    (
        b"a[deg],lift,b[deg],x,y,z\n0,0,0,1,0,0.3\n1,0,0,0.54,0.84,0.3\n2,0,0,-0.42,0.91,0.3\n3,0,0,-0.99,0.14,0.3\n",
        "points.csv:1:1: found joint angles of at most 6.4 deg that move the model's tip by 17.48 mm where the positions spread over 962.5 mm, expected about the same: most likely they are in rad, not deg; write `a[rad]` in the header (and so for each joint), or the unit in the mapping",
    ),
];

fn message(text: &[u8], options: &ReadOptions) -> String {
    let folder = Folder::new();
    let path = folder.write("points.csv", text);
    match read(&[path], &lifting_robot(), options) {
        Ok(_) => "no error".to_owned(),
        Err(error) => folder.without_path(&error.to_string()),
    }
}

#[test]
fn bad_files_are_refused_with_one_sentence() {
    let mut wrong = 0;
    for (text, expected) in FILES {
        let found = message(text, &ReadOptions::default());
        if found != *expected {
            wrong += 1;
            println!("{}\n  expected {expected}\n  found    {found}\n", String::from_utf8_lossy(text));
        }
    }
    assert_eq!(wrong, 0);
}

#[test]
fn files_that_are_none_are_refused() {
    let folder = Folder::new();
    let options = ReadOptions::default();
    let no_paths: [&str; 0] = [];
    let error = |name: &str| read(&[folder.path(name)], &lifting_robot(), &options).unwrap_err().to_string();
    assert_eq!(
        folder.without_path(&error("none.csv")),
        "none.csv: found no such file, expected a measurement file (CSV): check the path"
    );
    assert!(folder.without_path(&error(".")).starts_with(".: found a directory without text files whose names end in"));
    assert_eq!(
        read(&no_paths, &lifting_robot(), &options).unwrap_err().to_string(),
        "found no measurement file, expected at least one"
    );
}

#[test]
fn several_files_must_agree_on_target_names() {
    let folder = Folder::new();
    let paths = [
        folder.write("a.csv", "a,lift,b,x,y,z\n0,0,0,0.1,0.2,0.3\n"),
        folder.write("b.csv", "a,lift,b,x,y,z,target\n0,0,0,0.1,0.2,0.3,smr1\n"),
    ];
    let error = read(&paths, &lifting_robot(), &ReadOptions::default()).unwrap_err();
    assert_eq!(
        folder.without_path(&error.to_string()),
        "b.csv:2:19: found the target `smr1`, expected no name as in a.csv:2; all rows name their target or none does"
    );
}

#[test]
fn the_rows_to_fit_must_exist() {
    let message = |rule: &str| {
        let train_where: FitWhere = rule.parse().unwrap();
        let options = ReadOptions { train_where: Some(train_where), ..ReadOptions::default() };
        message(b"a,lift,b,x,y,z,stage\n0,0,0,0.1,0.2,0.3,one\n", &options)
    };
    assert_eq!(message("stage=one"), "no error");
    assert_eq!(
        message("stage=one,two"),
        "points.csv: found no row with `two` in column `stage`, expected at least one to fit"
    );
    assert_eq!(
        message("stagee=one"),
        "points.csv:1: found no column `stagee`, expected one that states which rows are fitted; \
         the nearest name found is `stage`"
    );
    assert_eq!(
        "stage".parse::<FitWhere>().unwrap_err().to_string(),
        "found `stage` as the rows to fit, expected COLUMN=VALUE[,VALUE]"
    );
}

#[test]
fn joint_tables_are_checked_too() {
    let folder = Folder::new();
    let message = |text: &str| {
        let path = folder.write("joints.csv", text);
        let error = read_joints(path, &lifting_robot(), &ReadOptions::default()).unwrap_err();
        folder.without_path(&error.to_string())
    };
    assert_eq!(
        message("a,lift,bb\n0,0,0\n"),
        "joints.csv:1: found no column `b`, expected one for joint `b`; the nearest name found is `bb`: rename or add a column, or name the right one in a mapping file (--columns)"
    );
    assert_eq!(
        message("a,lift,b\n"),
        "joints.csv:1: found a header and no rows, expected at least one row of joint readings"
    );
    assert_eq!(
        message("a,lift,b\n0,0,0\n1,0,x\n"),
        "joints.csv:3:5: found `x` in column `b`, expected a finite number; put `#` in front of a line that is no row"
    );
    assert_eq!(
        message("a,lift,b\n170,0,0\n-30,0,2\n"),
        "joints.csv:2:1: found readings of up to 170 rad, far outside the limits -3.15 to 3.15 rad of joint `a`, \
         expected another unit, most likely deg; write `a[deg]` in the header, or state --units deg"
    );
}

/// A good file is cut at every byte, and every awkward byte is put at every position.
#[test]
fn no_damage_to_a_file_makes_reading_panic() {
    let good = "# c\r\n\"id\";a[deg];lift;b;x;y;z;qx;qy;qz;qw;\u{b5};set\r\n\
                \"1\";0,5;0;0;1;2;3;0;0;0;1;\u{e9};fit\r\n2;1;0;0;1;2;3;;;;;\"q\";held_out\r\n"
        .as_bytes();
    let folder = Folder::new();
    let (robot, options) = (lifting_robot(), ReadOptions::default());
    let path = folder.path("damaged.csv");
    let attempt = |bytes: &[u8]| {
        folder.write("damaged.csv", bytes);
        let _ = (read(&[&path], &robot, &options), read_joints(&path, &robot, &options));
    };
    for at in 0..good.len() {
        attempt(&good[..at]);
        for byte in [b'"', b';', b',', b'\n', b'\r', b'[', b']', b'-', b'#', 0, 0xff] {
            let mut bytes = good.to_vec();
            bytes[at] = byte;
            attempt(&bytes);
            bytes.insert(at, byte);
            attempt(&bytes);
        }
    }
}
