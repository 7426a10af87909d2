//! Robot makers' columns of orientations without a unique meaning.

use crate::table::conventions::{AMBIGUOUS, CONVENTIONS};
use crate::table::header::Header;
use crate::table::header_cells::HeaderCell;
use crate::table::inputs::InputSource;
use crate::table::layout::ColumnLayout;
use crate::table::mapping::ColumnMap;
use crate::table::orientation::OrientationForm;
use poecal_arm::lie::angles::{Angles, MAKERS};
use poecal_numerics::named_unit::UnitSource;

/// Remedy for columns that may hold an orientation and are not read as one.
pub(crate) fn warning(header: &Header<'_>, layout: &ColumnLayout, map: &ColumnMap) -> Option<String> {
    let [target] = layout.targets.as_slice() else { return None };
    match &target.orientation {
        None => describe_unread_columns(header, layout),
        Some((OrientationForm::ROTATION_VECTOR, columns)) if map.orientation.is_none() => {
            describe_reversed_columns(header, layout, columns)
        }
        Some(_) => None,
    }
}

/// Note on the interpretation of a maker's columns.
pub(crate) fn note(layout: &ColumnLayout) -> Option<String> {
    let [target] = layout.targets.as_slice() else { return None };
    let (convention, inputs) = (target.convention?, &target.orientation.as_ref()?.1);
    let of = |input: &usize| layout.inputs.get(*input);
    let names: Vec<&str> = inputs.iter().filter_map(of).map(|it| it.label.as_str()).collect();
    let place = target.position.iter().flatten().take(1);
    let usual = place.chain(inputs.first()).filter_map(of).filter(|it| it.unit_from == UnitSource::Maker);
    let usual: Vec<&str> = usual.map(|it| it.unit.symbol()).filter(|it| *it != "1").collect();
    let units = match usual.as_slice() {
        [] => String::new(),
        some => format!(", in {}, since no unit is stated: --units states another", some.join(" and ")),
    };
    let ignored: Vec<String> = names.iter().map(|it| format!("\"{it}\"")).collect();
    Some(format!(
        "took the columns {} for {}{units}; `ignore = [{}]` in a mapping leaves them out",
        names.join(", "),
        convention.words,
        ignored.join(", ")
    ))
}

/// Columns of makers that the layout does not use.
fn describe_unread_columns(header: &Header<'_>, layout: &ColumnLayout) -> Option<String> {
    let left_alone = |name: &str| {
        let mut cells = header.cells.iter().filter(|cell| cell.name.eq_ignore_ascii_case(name));
        cells.find(|cell| layout.ignored.iter().any(|(text, _)| *text == cell.text))
    };
    let all = |names: &[&str]| names.iter().map(|name| left_alone(name)).collect::<Option<Vec<_>>>();
    let mapping = |form: &str, cells: &[&HeaderCell]| {
        let is_stated = cells.len() > 3 || cells.iter().all(|cell| cell.unit.is_some());
        let columns: Vec<&str> = cells.iter().map(|cell| cell.name.as_str()).collect();
        (columns.join(", "), orientation_mapping(form, &columns, if is_stated { "" } else { ", unit = \"deg\"" }))
    };
    let known = CONVENTIONS.iter().filter(|it| it.is_unique()).find_map(|it| {
        // Joints may be named q1 to q6.
        let is_more = it.columns.len() > 3 && left_alone("q5").is_some();
        let form = it.form.mapping_text();
        all(it.columns).filter(|_| !is_more).map(|cells| (mapping(&form, &cells), it.words.clone()))
    });
    let ((columns, mapping), words) = known.or_else(|| {
        let own = MAKERS.iter().filter(|it| it.names == AMBIGUOUS);
        let forms: Vec<String> = own.map(|it| format!("{} of {}", it.angles, it.maker)).collect();
        Some((mapping(&Angles::RotationVector.to_string(), &all(&AMBIGUOUS)?), forms.join(", ")))
    })?;
    Some(format!(
        "the columns {columns} may be {words}; they are ignored and the rows read as points: a mapping (--columns) with {mapping} reads them as poses"
    ))
}

/// Columns of a rotation vector in the order of rotations about z, y, x.
fn describe_reversed_columns(header: &Header<'_>, layout: &ColumnLayout, columns: &[usize]) -> Option<String> {
    let place = |&input: &usize| match layout.inputs.get(input)?.source {
        InputSource::Column(column) => Some(column),
        InputSource::Constant(_) => None,
    };
    let places: Vec<usize> = columns.iter().filter_map(place).collect();
    if !matches!(places.as_slice(), [x, y, z] if z < y && y < x) {
        return None;
    }
    let names: Vec<&str> =
        places.iter().rev().filter_map(|&place| header.cells.get(place)).map(|cell| cell.name.as_str()).collect();
    Some(format!(
        "the columns {} are read as a rotation vector, and stand in the order of turns about z, then the new y, then the new x: if \
         they are these, a mapping (--columns) with {} has them read so",
        names.join(", "),
        orientation_mapping("intrinsic_zyx", &names, "")
    ))
}

/// An orientation in a mapping.
fn orientation_mapping(form: &str, columns: &[&str], unit: &str) -> String {
    let columns: Vec<String> = columns.iter().map(|name| format!("\"{name}\"")).collect();
    format!("`orientation = {{ form = \"{form}\", columns = [{}]{unit} }}`", columns.join(", "))
}

#[cfg(test)]
mod tests {
    use crate::{MeasurementFile, ReadOptions, parse};
    use nalgebra::Vector3;
    use poecal_arm::lie::rotation;
    use poecal_model::simulate::scara;

    fn read(header: &str, turns: &[&str]) -> poecal_numerics::error::Result<MeasurementFile> {
        let row = |turn: &&str| format!("0,0.1,0.1,0,0.6,0.05,0.1,{turn}\n");
        let rows: String = turns.iter().map(row).collect();
        let text = format!("joint1,joint2,joint3,joint4,x,y,z,{header}\n{rows}");
        parse(&text, "t.csv", &scara(), &ReadOptions::default())
    }

    #[test]
    fn degrees_that_are_read_as_radians_are_told() {
        let error = |header, turns| read(header, turns).unwrap_err().to_string();
        assert_eq!(
            error("rx,ry,rz", &["0,1,0.5", "90,-120,30"]),
            "t.csv:3:26: found rotation vectors as long as 153.0 rad in the columns rx, ry, rz (1 of 2 rows are beyond 6.3 rad), expected \
             radians: the unit is likely deg, which the header states as `rx[deg]`, `ry[deg]`, `rz[deg]` and a mapping as `unit = \"deg\"`"
        );
        assert!(error("rx[rad],ry[rad],rz[rad]", &["0,5,5"]).contains("as long as 7.1 rad"));
        assert!(
            error("roll,pitch,yaw", &["0,0,-178.5"])
                .contains("angles of an orientation up to 178.5 rad in the columns roll,")
        );
        // Few rows, another unit, a full turn, and an angle beyond a turn.
        let sound: Vec<&str> = ["0,1,0.5"; 19].into_iter().chain(["0,0,90"]).collect();
        assert!(read("rx,ry,rz", &sound).is_ok());
        for (header, turn) in [
            ("rx[deg],ry[deg],rz[deg]", "90,-120,30"),
            ("rx,ry,rz", "0,0,6.2832"),
            ("roll,pitch,yaw", "0,0,9.5"),
            ("rx,ry,rz", ",,"),
        ] {
            assert!(read(header, &[turn]).is_ok(), "{header} {turn}");
        }
    }

    #[test]
    fn columns_that_makers_mean_in_several_ways_are_named_with_their_mapping() {
        let told = |header, turn| {
            let file = read(header, &[turn]).unwrap();
            file.warnings.iter().find(|warning| warning.contains("--columns")).cloned().unwrap_or_default()
        };
        assert_eq!(
            told("Rx,Ry,Rz", "1,0,0"),
            "t.csv: the columns Rx, Ry, Rz may be roll_pitch_yaw of Yaskawa, rotation_vector of Universal Robots, intrinsic_xyz of Stäubli; they are \
             ignored and the rows read as points: a mapping (--columns) with `orientation = { form = \"rotation_vector\", columns = [\"Rx\", \"Ry\", \
             \"Rz\"], unit = \"deg\" }` reads them as poses"
        );
        assert_eq!(
            told("rz,ry,rx", "0.1,0.2,0.3"),
            "t.csv: the columns rz, ry, rx are read as a rotation vector, and stand in the order of turns about z, then the new y, then the \
             new x: if they are these, a mapping (--columns) with `orientation = { form = \"intrinsic_zyx\", columns = [\"rz\", \"ry\", \
             \"rx\"] }` has them read so"
        );
        // Beside a position in other letters, one with a unit, or with words: points, as before.
        assert!(told("A,B,C", "10,20,30").contains(
            "the columns A, B, C may be KUKA's A, B, C; they are ignored and the rows read as points: a mapping (--columns) with \
             `orientation = { form = \"intrinsic_zyx\", columns = [\"A\", \"B\", \"C\"], unit = \"deg\" }` reads them as poses"
        ));
        assert!(told("q1,q2,q3,q4", "1,0,0,0").contains("form = \"quaternion_wxyz\""));
        for (header, turn) in [("rx,ry,rz", "0.1,0.2,0.3"), ("A,B", "1,2"), ("q1,q2,q3,q4,q5,q6", "1,2,3,4,5,6")] {
            assert_eq!(told(header, turn), "", "{header}");
        }
    }

    /// Lengths are in millimetres and angles in degrees, as in `hand-eye` for the same columns.
    #[test]
    fn columns_of_a_maker_mean_what_it_means_by_them() {
        let row = "0,0.1,0.1,0,600,50,100";
        let read = |header: &str, turn: &str| {
            let text = format!("joint1,joint2,joint3,joint4,{header}\n{row},{turn}\n");
            parse(&text, "t.csv", &scara(), &ReadOptions::default()).unwrap()
        };
        let turned = |roll: f64, pitch: f64, yaw: f64| {
            rotation::from_rpy(roll.to_radians(), pitch.to_radians(), yaw.to_radians())
        };
        for (header, turn, expected, note) in [
            ("X,Y,Z,A,B,C", "10,20,30", turned(30.0, 20.0, 10.0), "A, B, C for KUKA's A, B, C, in mm and deg, since"),
            ("X,Y,Z,W,P,R", "10,20,30", turned(10.0, 20.0, 30.0), "W, P, R for FANUC's W, P, R, in mm and deg, since"),
            ("X[mm],Y[mm],Z[mm],A[deg],B[deg],C[deg]", "10,20,30", turned(30.0, 20.0, 10.0), "KUKA's A, B, C"),
            ("X,Y,Z,q1,q2,q3,q4", "0,1,0,0", turned(180.0, 0.0, 0.0), "ABB's quaternion, q1 real, in mm, since"),
        ] {
            let file = read(header, turn);
            let pose = file.data.observations[0].measurement.pose();
            assert!((pose.rotation - expected).amax() < 1e-15, "{header}");
            assert!((pose.translation - Vector3::new(0.6, 0.05, 0.1)).amax() < 1e-15, "{header}");
            assert!(file.notes.iter().any(|it| it.contains(note)), "{:?}", file.notes);
        }
        // The cells are words, a unit of the position alone, or numbers that are no quaternion.
        for (header, turn) in [
            ("X,Y,Z,A,B,C", "ok,20,30"),
            ("X[mm],Y[mm],Z[mm],A,B,C", "10,20,30"),
            ("X[mm],Y[mm],Z[mm],q1,q2,q3,q4", "21,22,23,24"),
        ] {
            let text =
                format!("joint1,joint2,joint3,joint4,{}\n{row},{turn}\n", header.replace("X,Y,Z", "X[mm],Y[mm],Z[mm]"));
            let file = parse(&text, "t.csv", &scara(), &ReadOptions::default()).unwrap();
            assert!(file.data.observations[0].measurement.orientation().is_none(), "{header}");
            assert!(file.warnings.iter().any(|it| it.contains("the rows read as points")), "{:?}", file.warnings);
        }
        let noisy = "joint1,joint2,joint3,joint4,X,Y,Z,A,B,C,sigma_position\n0,0.1,0.1,0,600,50,100,10,20,30,0.05\n";
        let file = parse(noisy, "t.csv", &scara(), &ReadOptions::default()).unwrap();
        let sigma = file.understood[0].columns.iter().find(|it| it.name == "sigma_position").unwrap();
        assert_eq!(sigma.unit, Some("mm"));
        let mut options = ReadOptions::default();
        options.state_units("m").unwrap();
        let text = "joint1,joint2,joint3,joint4,X,Y,Z,A,B,C\n0,0.1,0.1,0,0.6,0.05,0.1,10,20,30\n";
        let file = parse(text, "t.csv", &scara(), &options).unwrap();
        assert!(file.notes.iter().any(|it| it.contains("KUKA's A, B, C, in deg, since")), "{:?}", file.notes);
    }
}
