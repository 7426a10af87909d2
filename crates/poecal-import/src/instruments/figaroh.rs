//! Tables of FIGAROH: positions of markers as `x1`, `y1`, `z1`, … in metres beside columns with the names of joints.

use super::maker::{Made, Refused, Value};
use super::words::{cells, lines};
use super::{Form, Opening};
use crate::Separator;

pub(crate) const FORM: Form = Form { title: "a table with numbered markers (FIGAROH)", is_it, table };

/// Columns of markers 1, 2, ….
fn markers(names: &[&str]) -> Vec<[usize; 3]> {
    let at = |name: String| names.iter().position(|it| *it == name);
    let of = |number: usize| {
        let [x, y, z] = ["x", "y", "z"].map(|axis| at(format!("{axis}{number}")));
        Some([x?, y?, z?])
    };
    (1..).map_while(of).collect()
}

fn header(text: &str) -> Option<(usize, Separator, Vec<&str>)> {
    let (line, content) = lines(text).find(|it| !it.1.trim_start().starts_with('#'))?;
    let by = Separator::recognised(content);
    (by != Separator::Whitespace).then(|| (line, by, cells(content, by)))
}

fn is_it(text: &str, opening: &Opening<'_>) -> bool {
    let Some((_, _, names)) = header(text) else { return false };
    let joints = opening.robot.joint_reading_names();
    !names.contains(&"x")
        && !markers(&names).is_empty()
        && joints.iter().all(|it| names.contains(&it.as_str()) && !["x1", "y1", "z1"].contains(&it.as_str()))
}

fn table(text: &str, _: &Opening<'_>) -> Result<Made, Refused> {
    let Some((head, by, names)) = header(text) else { return Refused::whole("found no header") };
    let markers = markers(&names);
    let has_several = markers.len() > 1;
    let others: Vec<usize> =
        (0..names.len()).filter(|at| !markers.iter().any(|it| it.contains(at))).collect();
    let mut columns: Vec<&str> = if has_several { vec!["target"] } else { Vec::new() };
    columns.extend(["x[m]", "y[m]", "z[m]"]);
    columns.extend(others.iter().filter_map(|at| names.get(*at)));
    let mut made = Made::new(head, columns);
    for (line, content) in lines(text).filter(|it| it.0 > head) {
        let found = cells(content, by);
        let of = |at: &usize| Value::Text(found.get(*at).copied().unwrap_or_default());
        for (number, marker) in (1_u32..).zip(&markers) {
            let target = has_several.then_some(Value::Number(f64::from(number)));
            made.row(line, target.into_iter().chain(marker.iter().chain(&others).map(of)));
        }
    }
    made.said.push(format!(
        "{} in metres",
        if has_several { format!("{} markers", markers.len()) } else { "one marker".to_owned() }
    ));
    Ok(made)
}
