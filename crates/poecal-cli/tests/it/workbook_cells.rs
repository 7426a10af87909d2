//! Cells of workbooks without a number: formulas that nothing computed, and numbers that are shown as dates.

use poecal_model::simulate::SessionKind;

use crate::folder::Folder;
use crate::session::session;
use crate::workbook::workbook;

const COLUMNS: [&str; 9] = ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "x", "y", "z"];

/// The session's rows as a sheet, with a change of one column.
fn write_changed_sheet(folder: &Folder, column: usize, change: impl Fn(usize, &str) -> String) {
    let text = folder.read("measurements.csv");
    let row = |(at, line): (usize, &str)| -> Vec<String> {
        let cells = line.split(',').skip(3).take(COLUMNS.len()).enumerate();
        cells.map(|(k, cell)| if k == column { change(at, cell) } else { cell.to_owned() }).collect()
    };
    let header = COLUMNS.map(str::to_owned).to_vec();
    let sheet: Vec<Vec<String>> = std::iter::once(header).chain(text.lines().skip(1).enumerate().map(row)).collect();
    folder.write("book.xlsx", workbook(&[("data", &sheet)]));
}

#[test]
fn formulas_without_results_are_no_zeros() {
    let folder = session(SessionKind::POINT);
    let before = folder.listing();
    let refused = |expected: &str| {
        let run = folder.run("calibrate robot.urdf book.xlsx --out results");
        println!("{}", run.err.trim_end());
        assert!(
            run.code == 2
                && run.err.contains(expected)
                && run.err.contains("open the workbook in a spreadsheet program"),
            "{}",
            run.err
        );
        assert_eq!(folder.listing().len(), before.len() + 1);
    };
    write_changed_sheet(&folder, 5, |_, cell| format!("={cell}*1|0"));
    refused("sheet `data`: found formulas in the column `joint6` whose results are all 0");
    write_changed_sheet(&folder, 5, |at, cell| if at == 3 { format!("={cell}*1|") } else { cell.to_owned() });
    refused("sheet `data`, cell F5: found the formula `=");
    // Formulas with their results are numbers, and zeros among them too.
    write_changed_sheet(&folder, 5, |_, cell| format!("={cell}*1|{cell}"));
    folder.run_to_success("calibrate robot.urdf book.xlsx --out results");
    write_changed_sheet(&folder, 5, |at, cell| if at == 0 { "=0*1|0".to_owned() } else { format!("={cell}*1|{cell}") });
    folder.run_to_success("check robot.urdf book.xlsx");
}

#[test]
fn numbers_that_are_shown_as_dates_are_no_lengths() {
    let folder = session(SessionKind::POINT);
    write_changed_sheet(&folder, 6, |at, cell| if at == 2 { format!("d{cell}") } else { cell.to_owned() });
    let run = folder.run("check robot.urdf book.xlsx");
    println!("{}", run.err.trim_end());
    assert!(run.code == 2 && run.err.contains("(formatted as a date or time)` in column `x`"), "{}", run.err);
}
