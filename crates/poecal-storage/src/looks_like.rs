//! Recognises tables passed as models, and models passed as tables.

use std::path::Path;

use poecal_numerics::error::{Error, ErrorKind, first_few};

/// Expected models.
const MODEL: &str =
    "expected a robot model: URDF, MJCF, SDF, a calibration.json, or TOML that begins with poecal_robot = 1";
/// Column names of DH tables, case ignored, by groups of synonyms.
const DH_COLUMNS: [&str; 12] =
    ["a", "alpha", "d", "theta", "r", "α", "θ", "a_i", "alpha_i", "d_i", "theta_i", "a(i-1)"];
/// Columns that only measurements have.
const MEASURED: [&str; 10] = ["x", "y", "z", "qx", "qy", "qz", "qw", "target", "id", "set"];

/// The error for a model's text that is a table; `None` for others.
pub fn table_for_model(text: &str, path: &Path) -> Option<Error> {
    let (index, line) = text.trim_start_matches('\u{feff}').lines().enumerate().find(|(_, line)| has_content(line))?;
    let cells = cells(line)?;
    let dh = cells.iter().filter(|cell| DH_COLUMNS.contains(&cell.to_lowercase().as_str())).count();
    let measured = cells.iter().filter(|cell| MEASURED.contains(cell)).count();
    let numbers = cells.iter().filter(|cell| cell.parse::<f64>().is_ok()).count();
    let table = "convention = \"standard_dh\" or \"modified_dh\" and an entry of `joint` for each row (docs/file-formats.md, TOML)";
    let message = if dh >= 3 && measured == 0 {
        format!("found a table of DH parameters ({}), {MODEL}: write it with {table}", cells.join(", "))
    } else if numbers == cells.len() && (3..=6).contains(&numbers) {
        format!("found a table of numbers, {MODEL}: a table of DH parameters is written with {table}")
    } else {
        format!(
            "found a table with the columns {}, {MODEL}: did you swap the arguments? The model comes first",
            first_few(&cells)
        )
    };
    Some(ErrorKind::Syntax.error(message).at_line(path, index + 1))
}

/// The kind of a robot model, by its text; `None` for a calibration or another text.
pub fn model(text: &str) -> Option<&'static str> {
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let begins = |word: &str| text.lines().any(|line| line.trim_start().starts_with(word));
    match text.chars().next()? {
        '<' if text.contains("<robot") => Some("a URDF"),
        '<' if text.contains("<mujoco") => Some("a model of MuJoCo (MJCF)"),
        '<' if text.contains("<sdf") => Some("a model of Gazebo (SDF)"),
        _ if begins("poecal_robot") => Some("a robot model (TOML)"),
        _ => None,
    }
}

/// The error for a header that is the beginning of a model.
pub fn model_for_table(line: &str, path: &Path, number: usize) -> Option<Error> {
    let line = line.trim();
    let form = if ["<?xml", "<robot", "<mujoco", "<sdf", "<!--"].iter().any(|start| line.starts_with(start)) {
        "XML, as models are"
    } else if line == "{" || line.starts_with("{\"") || line.starts_with("{ \"") {
        "JSON, as a calibration.json is"
    } else if line.starts_with("poecal_robot") {
        "a robot model in TOML"
    } else {
        return None;
    };
    let message = format!(
        "found {form}, expected a table (CSV) with a header that names the columns: the model is named first, and tables behind it"
    );
    Some(ErrorKind::Syntax.error(message).at_line(path, number))
}

fn has_content(line: &str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with('#')
}

/// The cells of a table's first line, without units; `None` for a line of TOML, XML or JSON.
fn cells(line: &str) -> Option<Vec<&str>> {
    let line = line.trim();
    let key = line.split('=').next().unwrap_or_default();
    let is_key = line.contains('=') && !key.contains([',', ';', '\t']);
    if line.starts_with(['<', '{', '[']) || is_key {
        return None;
    }
    let separator = [';', '\t', ','].into_iter().find(|&separator| line.contains(separator));
    let cells: Vec<&str> = match separator {
        Some(separator) => line.split(separator).collect(),
        None => line.split_whitespace().collect(),
    };
    let cells: Vec<&str> = cells
        .into_iter()
        .map(|cell| cell.trim().trim_matches('"').split('[').next().unwrap_or_default().trim())
        .collect();
    // A few words are not yet a table.
    let fewest = if separator.is_some() { 2 } else { 3 };
    (cells.len() >= fewest).then_some(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(text: &str) -> String {
        table_for_model(text, Path::new("m.csv")).map_or_else(String::new, |error| error.to_string())
    }

    #[test]
    fn a_table_of_dh_parameters_is_told_from_measurements() {
        let toml = "m.csv:1: found a table of DH parameters (a, alpha, d, theta), expected a robot model: URDF, MJCF, SDF, a calibration.json, or \
                    TOML that begins with poecal_robot = 1: write it with convention = \"standard_dh\" or \"modified_dh\" and an entry \
                    of `joint` for each row (docs/file-formats.md, TOML)";
        assert_eq!(model("a,alpha,d,theta\n0,90,400,0\n"), toml);
        assert_eq!(model("a[mm]; alpha[deg]; d[mm]; theta[deg]\n"), toml);
        assert!(model("# DH\ni a alpha d theta\n").starts_with("m.csv:2: found a table of DH parameters (i, a,"));
        assert!(model("25,-90,400,0\n").starts_with("m.csv:1: found a table of numbers, expected a robot model"));
        assert!(model("id,joint1[deg],x[mm],y[mm],z[mm]\n1,2,3,4,5\n").ends_with(
            "found a table with the columns id, joint1, x, y, z, expected a robot model: URDF, MJCF, SDF, a calibration.json, or TOML that begins \
             with poecal_robot = 1: did you swap the arguments? The model comes first"
        ));
    }

    #[test]
    fn what_may_be_a_model_is_none() {
        for text in
            ["", "poecal_robot = 1", "joint = [{ a = 1, b = 2 }]", "[home]", "<robot/>", "{\"a\": 1}", "text", "# only"]
        {
            assert_eq!(model(text), "", "{text}");
        }
    }

    #[test]
    fn a_model_in_the_place_of_a_table_is_named() {
        let of = |line: &str| model_for_table(line, Path::new("r.urdf"), 1).map(|error| error.to_string());
        for line in ["<?xml version=\"1.0\"?>", "<robot name=\"r\">", "{", "poecal_robot = 1"] {
            let message = of(line).unwrap();
            assert!(message.ends_with("the model is named first, and tables behind it"), "{message}");
        }
        assert_eq!(of("joint1,x,y,z"), None);
    }
}
