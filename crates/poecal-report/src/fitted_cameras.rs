//! Numbers of cameras and boards that were fitted with the robot, in words.

use super::table::number;
use poecal_model::camera::PictureNumber;
use poecal_results::calibration_file::CalibrationFile;

/// Most numbers that are named one by one.
const FEW: usize = 12;

/// A sentence for each camera and body whose numbers were fitted, by its name.
pub(crate) fn found_words(file: &CalibrationFile) -> Vec<String> {
    let all = file.pictures.as_ref().map_or(&[][..], |pictures| &pictures.found);
    let groups = all.chunk_by(|a, b| of_what(a) == of_what(b));
    groups.filter_map(|group| Some(format!("{}: {}", of_what(group.first()?).join(" of "), words(group)))).collect()
}

/// Kind and name of a number's subject.
fn of_what(entry: &PictureNumber) -> Vec<&str> {
    entry.name.splitn(3, '.').take(2).collect()
}

fn words(group: &[PictureNumber]) -> String {
    if group.len() > FEW {
        let moved = |entry: &PictureNumber| entry.found - entry.given;
        let points = group.len() / 3;
        let squares: f64 = group.iter().map(|it| moved(it).powi(2)).sum();
        let largest = group.chunks(3).map(|it| it.iter().map(|it| moved(it).powi(2)).sum::<f64>().sqrt());
        return format!(
            "{points} points, moved by {} mm (RMS), at most {} mm",
            number((squares / points as f64).sqrt()),
            number(largest.fold(0.0, f64::max))
        );
    }
    let one = |it: &PictureNumber| {
        let own = it.name.rsplit('.').next().unwrap_or_default();
        let digits = if it.unit == "px" { 1 } else { 4 };
        let unit = if it.unit.is_empty() { String::new() } else { format!(" {}", it.unit) };
        format!("{own} {:.digits$} -> {:.digits$} ± {:.digits$}{unit}", it.given, it.found, 2.0 * it.deviation)
    };
    group.iter().map(one).collect::<Vec<_>>().join(", ")
}
