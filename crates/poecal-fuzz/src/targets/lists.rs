//! Lists of poses, ledgers and histories.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use poecal_fit::hand_eye::{CameraMounting, HandEyeOptions, hand_eye as calibrated, tool_tip};
use poecal_import::{PoseSource, PoseUnits, ReadOptions, read_flange_poses, read_pose_pairs};
use poecal_report::FleetLine;
use poecal_results::fleet::{LedgerRow, read_ledgers};
use poecal_results::validation::History;

use crate::one_file::with_files;
use crate::properties::{PATH, check_result, one_line, parts, text};

/// Most rows that are used in computations.
const MOST_ROWS: usize = 40;

fn row_name(row: usize) -> String {
    format!("row {}", row + 1)
}

/// Poses of an arm and of a target, in one file or in two, as tables or as YAML: the numbers of both are equal, and a detected camera has a pose.
pub fn hand_eye(data: &[u8]) -> bool {
    let Some([one, other]) = parts::<2>(data) else { return false };
    let ending = if one.starts_with(['-', '{', '[']) { "yaml" } else { "csv" };
    let names = [format!("{PATH}.{ending}"), format!("{PATH}.2")];
    let all: Vec<(&str, &[u8])> = names.iter().map(String::as_str).zip([one.as_bytes(), other.as_bytes()]).collect();
    let files = if other.is_empty() { &all[..1] } else { &all[..] };
    let paths: Vec<PathBuf> = files.iter().map(|it| it.0.into()).collect();
    let options = ReadOptions::default();
    let source = PoseSource { units: PoseUnits::default(), robot: None, pictures: &options };
    let read = with_files(files, || read_pose_pairs(&paths, &source));
    let poses = match read {
        Ok(poses) => poses,
        Err(error) => {
            one_line(&error.to_string());
            return false;
        }
    };
    poses.understood.iter().chain(&poses.warnings).for_each(|words| one_line(words));
    assert_eq!(poses.flange.poses.len(), poses.target.poses.len());
    if poses.flange.poses.len() > MOST_ROWS {
        return true;
    }
    match calibrated(&poses.flange, &poses.target, &HandEyeOptions::new(CameraMounting::InHand), &row_name) {
        Ok(found) => {
            assert!(format!("{found:?}").len() > 10 && !format!("{found:?}").contains("NaN"), "{found:?}")
        }
        Err(error) => one_line(&error.to_string()),
    }
    true
}

/// Poses of an arm in which a tip touched points.
pub fn tcp(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let path = format!("{PATH}.csv");
    let read =
        with_files(&[(&path, text.as_bytes())], || read_flange_poses(Path::new(&path), PoseUnits::default(), None));
    let Some(poses) = check_result(read, &text) else { return false };
    poses.understood.iter().chain(&poses.warnings).for_each(|words| one_line(words));
    if poses.touches.flange.poses.len() <= MOST_ROWS
        && let Err(error) = tool_tip(&poses.touches, &row_name)
    {
        one_line(&error.to_string());
    }
    true
}

/// A ledger: its rows, and the line that they make as words and as a table.
pub fn ledgers(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let path = format!("{PATH}.jsonl");
    let read = || with_files(&[(&path, text.as_bytes())], || read_ledgers(&[PathBuf::from(&path)]));
    let Some(rows) = check_result(read(), &text) else { return false };
    let written = |rows: &[LedgerRow]| serde_json::to_string(rows).unwrap_or_default();
    assert_eq!(read().map(|again| written(&again)).unwrap_or_default(), written(&rows));
    let count = rows.len();
    if let Ok(line) = FleetLine::from_rows(rows, None, &BTreeMap::new()) {
        assert!(line.text().starts_with("robots"));
        assert!(line.csv().lines().count() > count);
    }
    true
}

/// A history: read twice the same.
pub fn histories(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let path = format!("{PATH}.jsonl");
    let read = || with_files(&[(&path, text.as_bytes())], || History::read(Path::new(&path)));
    let Some(history) = check_result(read(), &text) else { return false };
    assert!(read().is_ok_and(|again| again == history));
    true
}
