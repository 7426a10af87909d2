//! Tables of FIGAROH: positions of markers as `x1`, `y1`, `z1`, … in metres beside columns with the names of joints.

use super::made_table::{CellValue, MadeTable, Refusal, TableColumn, place};
use super::words::{HeadLine, lines};
use super::{FileForm, OpeningContext};
use crate::Separator;

pub(crate) const FORM: FileForm = FileForm { title: "a table with numbered markers (FIGAROH)", is_it, table };

/// The header, and the columns of markers 1, 2, ….
fn head(text: &str) -> Option<(HeadLine<'_>, Vec<[usize; 3]>)> {
    let line = lines(text).find(|it| !it.1.trim_start().starts_with('#'))?;
    if Separator::recognise(line.1) == Separator::Whitespace {
        return None;
    }
    let head = HeadLine::recognise(line);
    let of = |number: usize| {
        let [x, y, z] = ["x", "y", "z"].map(|axis| head.column_of(&format!("{axis}{number}")));
        Some([x?, y?, z?])
    };
    let markers = (1..).map_while(of).collect();
    Some((head, markers))
}

fn is_it(text: &str, opening: &OpeningContext<'_>) -> bool {
    let Some((head, markers)) = head(text) else { return false };
    let joints = opening.robot.joint_reading_names();
    let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
    !head.names.contains(&"x")
        && !markers.is_empty()
        && head.has(&joints)
        && !["x1", "y1", "z1"].iter().any(|it| joints.contains(it))
}

fn table(text: &str, _: &OpeningContext<'_>) -> Result<MadeTable, Refusal> {
    let (head, markers) = head(text).ok_or("found no header")?;
    let has_several = markers.len() > 1;
    let (places, names) = (0..head.names.len(), head.names.iter());
    let (others, names): (Vec<usize>, Vec<&str>) =
        places.zip(names).filter(|it| !markers.iter().any(|marker| marker.contains(&it.0))).unzip();
    let target = has_several.then(|| TableColumn::from("target"));
    let mut made =
        MadeTable::new(head.line, target.into_iter().chain(place("m")).chain(names.into_iter().map(TableColumn::from)));
    for (line, found) in head.rows(text) {
        for (number, marker) in (1_u32..).zip(&markers) {
            let target = has_several.then_some(CellValue::Number(f64::from(number)));
            let cells = marker.iter().chain(&others).map(|at| CellValue::cell_at(&found, *at));
            made.row(line, target.into_iter().chain(cells));
        }
    }
    let count = if has_several { format!("{} markers", markers.len()) } else { "one marker".to_owned() };
    made.say(format!("{count} in metres"));
    Ok(made)
}
