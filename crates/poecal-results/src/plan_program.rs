//! A planned list as a program of joint motions, with a stop at each row.

use std::fmt::Write as _;
use std::path::Path;

use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::error::{ErrorKind, Result};
use poecal_plan::plan::PlannedRow;

/// Speed of the fastest joint of a program for Universal Robots, radians per second; others have a tenth of their maximum, or 100 mm/s.
pub const SPEED_RAD_S: f64 = 0.3;
/// Most axes of a program.
const AXES: usize = 6;

/// Writes the rows as a program of the language that its file's extension states (`.script`, `.mod`, `.src`, `.ls`). Its slow joint motions end each
/// with a stop, at which a person measures and continues. Angles are those of the model, with its zeros and signs.
///
/// # Errors
/// [`ErrorKind::Option`] for a name of another ending, and for robots of other than up to six turning joints.
pub fn plan_program(path: &Path, robot: &Robot, rows: &[PlannedRow]) -> Result<String> {
    let names = robot.reading_names();
    let turns = |name: &String| robot.reading_kind(name) == ReadingKind::Angle;
    if names.len() > AXES || !names.iter().all(turns) {
        return ErrorKind::Option.refuse(format!(
            "found the readings {}, expected up to {AXES} turning joints for a program: use the table of the list",
            names.join(", ")
        ));
    }
    let name: String = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().chars().filter(char::is_ascii_alphanumeric).collect())
        .unwrap_or_default();
    let name = if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("plan{name}") };
    let rows: Vec<ProgramRow> = rows.iter().enumerate().map(|(at, row)| ProgramRow::new(at + 1, row)).collect();
    let ending = path.extension().map(|it| it.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("script") => Ok(script(&name, &rows)),
        Some("mod") => Ok(rapid(&name, &rows)),
        Some("src") => Ok(krl(&name, &rows)),
        Some("ls") => Ok(ls(&name, &rows)),
        _ => ErrorKind::Option.refuse(format!(
            "found the program `{}`, expected a name that ends in .script (Universal Robots), .mod (ABB), .src (KUKA) or .ls (FANUC)",
            path.display()
        )),
    }
}

/// A row of a program.
struct ProgramRow {
    number: usize,
    angles_rad: Vec<f64>,
}

impl ProgramRow {
    fn new(number: usize, row: &PlannedRow) -> Self {
        ProgramRow { number, angles_rad: row.readings.clone() }
    }

    /// Its angles in degrees, 0 for missing ones.
    fn degrees(&self) -> Vec<f64> {
        let mut degrees: Vec<f64> = self.angles_rad.iter().map(|it| it.to_degrees()).collect();
        degrees.resize(AXES, 0.0);
        degrees
    }
}

/// Lines above every program.
const ABOVE: [&str; 3] = [
    "Written by poecal plan. ONLY CONFIGURATIONS ARE CHECKED, NEVER THE WAY BETWEEN THEM:",
    "go through it slowly, in single steps, before anything is fixed to the flange.",
    "Angles are those of the model: see that they are the controller's.",
];

fn join_values(values: &[f64], digits: usize) -> String {
    values.iter().map(|value| format!("{value:.digits$}")).collect::<Vec<_>>().join(",")
}

// Writing to a String cannot fail in any of them.

fn script(name: &str, rows: &[ProgramRow]) -> String {
    let mut out = format!("def {name}():\n");
    ABOVE.iter().for_each(|line| out.push_str(&format!("  # {line}\n")));
    for row in rows {
        let _ = writeln!(out, "  movej([{}], a=0.5, v={SPEED_RAD_S})", join_values(&row.angles_rad, 6));
        let _ =
            writeln!(out, "  popup(\"row {}: measure, then continue\", title=\"poecal\", blocking=True)", row.number);
    }
    out + "end\n"
}

fn rapid(name: &str, rows: &[ProgramRow]) -> String {
    let mut out = format!("MODULE {name}\n");
    ABOVE.iter().for_each(|line| out.push_str(&format!("  ! {line}\n")));
    for row in rows {
        let _ = writeln!(
            out,
            "  CONST jointtarget row{}:=[[{}],[9E9,9E9,9E9,9E9,9E9,9E9]];",
            row.number,
            join_values(&row.degrees(), 4)
        );
    }
    let _ = writeln!(out, "  PROC {name}_rows()");
    for row in rows {
        let _ = writeln!(out, "    MoveAbsJ row{}\\NoEOffs,v100,fine,tool0;", row.number);
        let _ = writeln!(out, "    TPWrite \"row {}: measure, then start\";\n    Stop;", row.number);
    }
    out + "  ENDPROC\nENDMODULE\n"
}

fn krl(name: &str, rows: &[ProgramRow]) -> String {
    let mut out = format!("DEF {name}()\n");
    ABOVE.iter().for_each(|line| out.push_str(&format!("; {line}\n")));
    out.push_str("BAS(#INITMOV,0)\nBAS(#VEL_PTP,10)\n");
    for row in rows {
        let axes: Vec<String> =
            row.degrees().iter().enumerate().map(|(at, it)| format!("A{} {it:.4}", at + 1)).collect();
        let _ = writeln!(out, "; row {}: measure, then start\nPTP {{{}}}\nHALT", row.number, axes.join(","));
    }
    out + "END\n"
}

fn ls(name: &str, rows: &[ProgramRow]) -> String {
    let mut out = format!("/PROG  {}\n/ATTR\n/MN\n", name.to_ascii_uppercase());
    let mut line = 0;
    let mut add = |out: &mut String, text: &str| {
        line += 1;
        let _ = writeln!(out, "{line:4}:  {text} ;");
    };
    ABOVE.iter().for_each(|text| add(&mut out, &format!("!{text}")));
    for row in rows {
        add(&mut out, &format!("J P[{}] 10% FINE", row.number));
        add(&mut out, &format!("MESSAGE[row {}]", row.number));
        add(&mut out, "PAUSE");
    }
    out.push_str("/POS\n");
    for row in rows {
        let axes: Vec<String> =
            row.degrees().iter().enumerate().map(|(at, it)| format!("J{}= {it:.4} deg", at + 1)).collect();
        let _ = writeln!(out, "P[{}]{{\n   GP1:\n  UF : 0, UT : 1,\n  {}\n}};", row.number, axes.join(", "));
    }
    out + "/END\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::{elbow, scara};
    use poecal_plan::plan::RowPurpose;

    #[test]
    fn each_language_has_a_motion_and_a_stop_for_each_row() {
        let row = |value: f64| PlannedRow {
            readings: vec![value; 6],
            part: RowPurpose::Fit,
            returns: false,
            candidate: None,
        };
        let rows = [row(0.5), row(-0.25)];
        let of = |name: &str| plan_program(Path::new(name), &elbow(), &rows).unwrap();
        for (name, motion, stop) in [
            ("a.script", "movej(", "popup("),
            ("a.mod", "MoveAbsJ ", "Stop;"),
            ("a.src", "PTP {", "HALT"),
            ("a.ls", "J P[", "PAUSE ;"),
        ] {
            let text = of(name);
            assert_eq!([motion, stop].map(|word| text.matches(word).count()), [2, 2], "{text}");
        }
        assert!(of("a.src").contains("A1 28.6479,A2 28.6479"));
        assert!(plan_program(Path::new("a.txt"), &elbow(), &rows).is_err());
        assert!(plan_program(Path::new("a.mod"), &scara(), &rows).is_err());
    }
}
