//! The table that *Auto ID* of DELMIA reads, without header and separated by tabs. Columns are the name, x, y, z in millimetres, roll, pitch, yaw
//! in degrees, and the joints in degrees.

use super::made_table::{CellValue, FileLine, MadeTable, Refusal, TableColumn, place};
use super::words::{cells, lines, number};
use super::{FileForm, OpeningContext};
use crate::Separator;

pub(crate) const FORM: FileForm = FileForm { title: "a table of Auto ID (DELMIA)", is_it, table };

/// Numbers before the joints.
const POSE: usize = 6;

fn is_it(text: &str, opening: &OpeningContext<'_>) -> bool {
    let count = opening.robot.joint_reading_names().len();
    let is_row = |line: &str| {
        let found = cells(line, Separator::Tab);
        found.len() == 1 + POSE + count
            && found.first().is_some_and(|it| number(it).is_none())
            && found.iter().skip(1).all(|it| number(it).is_some())
    };
    let mut some = lines(text).take(3).peekable();
    some.peek().is_some() && some.all(|it| is_row(it.1))
}

fn table(text: &str, opening: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let angles = ["roll", "pitch", "yaw"].map(|it| TableColumn::from(it).in_unit("deg"));
    let pose = std::iter::once(TableColumn::from("id")).chain(place("mm")).chain(angles);
    let mut made = MadeTable::new(1, pose.chain(opening.joint_columns("deg")));
    for (line, content) in lines(text) {
        let found = cells(content, Separator::Tab);
        let (count, expected) = (found.len(), made.width());
        if count != expected {
            return FileLine(line).refuse(format!(
                "found {count} cells, expected {expected}: a name, x, y, z, roll, pitch, yaw and the joints"
            ));
        }
        made.row(line, found.into_iter().map(CellValue::Text));
    }
    made.say(format!("{} poses in mm, with roll, pitch, yaw in deg; joints in deg", made.rows()));
    Ok(made)
}
