//! Colours and line widths of reports on a terminal. The words are the library's.

use std::path::Path;

use anstyle::{AnsiColor, Style};
use poecal_calibrate::Level;
use poecal_numerics::text::escape_invisible;
use poecal_report::table::{INDENT as LABELS, WIDTH, break_text, lines};

/// Style of the word before an error.
pub(crate) const ERROR: Style = AnsiColor::Red.on_default().bold();
/// Style of the word before a warning.
pub(crate) const WARNING: Style = AnsiColor::Yellow.on_default().bold();
const GOOD: Style = AnsiColor::Green.on_default().bold();
const LABEL: Style = Style::new().bold();

/// Labels of warnings for the reader.
const LOOK: [&str; 4] = ["look at", "outliers", "warnings", "diagnosis"];
/// First words of each verdict.
const VERDICTS: [(Level, Style); 5] = [
    (Level::Good, GOOD),
    (Level::InsideSampledRange, WARNING),
    (Level::MeasuredConfigurations, WARNING),
    (Level::Located, WARNING),
    (Level::DoNotUse, ERROR),
];

/// A path on one line, without control characters.
pub(crate) fn printable_path(path: &Path) -> String {
    escape_invisible(&path.display().to_string()).into_owned()
}

/// A labelled paragraph as in reports, in lines of 80 characters unless words are longer.
pub(crate) fn label_paragraph(label: &str, text: &str) -> String {
    let mut out = String::new();
    lines(&mut out, label, text.lines());
    out
}

/// Sentence on the files that were written to a folder.
pub(crate) fn describe_written_files(folder: &Path, files: &[String]) -> String {
    label_paragraph("written", &format!("{}\n{}", printable_path(folder), files.join(", ")))
}

/// Lines with colours, broken behind commas if they are wider than a terminal.
pub(crate) fn wrap_list(text: &str, width: usize) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        if visible_width(line.trim_end()) <= width || !line.contains(", ") {
            out.push_str(line);
            continue;
        }
        let mut used = 0;
        for part in line.split_inclusive(", ") {
            let own = visible_width(part.trim_end());
            if used > 0 && used + own > width {
                out.truncate(out.trim_end().len());
                out.push_str("\n   ");
                used = 3;
            }
            out.push_str(part);
            used += visible_width(part);
        }
    }
    out
}

/// Number of visible characters of a text, without the codes of colours.
fn visible_width(text: &str) -> usize {
    let (mut width, mut is_code) = (0, false);
    for letter in text.chars() {
        match (is_code, letter) {
            (false, '\x1b') => is_code = true,
            (false, _) => width += 1,
            (true, 'm') => is_code = false,
            (true, _) => {}
        }
    }
    width
}

/// A message in lines of a width; the first begins after `before` characters, the others are indented by two.
pub(crate) fn wrap_message(message: &str, before: usize, width: usize) -> String {
    break_text(message, before, 2, width)
}

/// A report with paragraphs for a narrow terminal. Tables are unchanged: broken lines would be unreadable.
pub(crate) fn narrow_report(text: &str, width: usize) -> String {
    if width >= WIDTH || width <= 2 * LABELS {
        return text.to_owned();
    }
    let lines = text.lines().map(|line| {
        let prose = line.get(LABELS..).is_some_and(|text| !text.starts_with(' ') && !text.contains("  "));
        let continued = line.get(..LABELS).is_some_and(|start| start.trim().is_empty());
        if prose && (continued || label(line).is_some()) {
            break_text(line, 0, LABELS, width) + "\n"
        } else {
            format!("{line}\n")
        }
    });
    lines.collect()
}

/// A report with coloured labels and verdict.
pub(crate) fn paint_report(text: &str) -> String {
    text.split_inclusive('\n').map(painted_line).collect()
}

fn painted_line(line: &str) -> String {
    let Some((label, rest)) = label(line) else { return line.to_owned() };
    let style = if LOOK.contains(&label) { WARNING } else { LABEL };
    let gap = rest.len() - rest.trim_start().len();
    let (gap, rest) = rest.split_at(gap);
    let mut verdicts = VERDICTS.iter().filter(|_| label == "verdict");
    let found = verdicts.find_map(|(level, style)| Some((level.words(), style, rest.strip_prefix(level.words())?)));
    let rest = match found {
        Some((words, style, rest)) => format!("{style}{words}{style:#}{rest}"),
        None => rest.to_owned(),
    };
    format!("{style}{label}{style:#}{gap}{rest}")
}

/// The label of a line, and the rest of it.
fn label(line: &str) -> Option<(&str, &str)> {
    let (label, rest) = line.split_at_checked(LABELS)?;
    let words = label.trim_end();
    let is_label = label.ends_with(' ')
        && words.starts_with(|c: char| c.is_ascii_lowercase())
        && words.chars().all(|c| c.is_ascii_lowercase() || c == ' ' || c == ',');
    is_label.then(|| (words, line.get(words.len()..).unwrap_or(rest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_and_verdicts_stand_out_and_nothing_is_lost() {
        let report = "robot         elbow\nposition, mm        nominal\n  mean    1\n\nsampled range 71 %\nverdict       do not use: why\n              more\noutliers      1 row\nheld-out error by share\n";
        let painted = paint_report(report);
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), report);
        assert!(painted.starts_with("\u{1b}[1mrobot\u{1b}[0m         elbow\n"), "{painted:?}");
        assert!(painted.contains("\u{1b}[1mposition, mm\u{1b}[0m  "), "{painted:?}");
        assert!(painted.contains("\u{1b}[1msampled range\u{1b}[0m 71"), "{painted:?}");
        assert!(painted.contains("\u{1b}[1m\u{1b}[31mdo not use\u{1b}[0m: why"), "{painted:?}");
        assert!(painted.contains("\u{1b}[1m\u{1b}[33moutliers\u{1b}[0m"), "{painted:?}");
        assert!(painted.ends_with("\nheld-out error by share\n"), "{painted:?}");
    }

    #[test]
    fn paragraphs_fit_a_narrow_terminal_and_tables_stay() {
        let report = "noise         0.05 mm each component, from the fit\nposition, mm                  nominal    registered    calibrated\n  mean 1\n";
        let narrow = narrow_report(report, 40);
        let paragraph = "noise         0.05 mm each component,\n              from the fit\n";
        assert_eq!(narrow, report.replacen("noise         0.05 mm each component, from the fit\n", paragraph, 1));
        assert_eq!(narrow_report(report, 80), report);
    }

    #[test]
    fn lines_break_at_blanks_only() {
        assert_eq!(wrap_message("ab cd efghijkl m", 4, 10), "ab cd\n  efghijkl\n  m");
        let text = label_paragraph("written", &format!("folder\n{}", ["figure.svg"; 9].join(", ")));
        assert!(text.starts_with("written       folder\n              figure.svg, ") && text.ends_with("figure.svg\n"));
        assert!(text.lines().all(|line| line.len() <= 80), "{text}");
    }
}
