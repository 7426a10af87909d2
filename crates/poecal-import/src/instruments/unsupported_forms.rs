//! Texts of known forms that contain nothing to be read here, with a remedy.

use super::words::{lines, number};

/// Number of lines by which a form is recognised.
const FIRST: usize = 12;

/// The beginnings of texts of a kind, for XML any of the first lines, and the reason why they are not read.
const KINDS: [(&str, &str); 2] = [
    (
        "PathFileType",
        "found markers of motion capture as TRC, whose head has names in one line and axes in another, expected a table: export them as CSV of Motive or Vicon \
         or TSV of Qualisys, or write the head as one line, as time[s],x[mm],y[mm],z[mm]",
    ),
    (
        "<LandXML",
        "found points of a survey as LandXML, expected a table: export them as text with a header, as name,x[m],y[m],z[m]",
    ),
];

/// The reason why a text is not read, by its beginning.
pub(crate) fn find_refusal(text: &str) -> Option<&'static str> {
    let first = lines(text).next()?.1.trim();
    if first == "/JOB" || first.starts_with("/JOB ") {
        return Some(
            "found a job of Yaskawa (JBI), whose positions are pulses, and nothing that says how many make a degree, expected joint readings: write the \
             configurations as angles into a table with a column for each joint",
        );
    }
    if first.contains("_RIst") || first.contains("RIst,") {
        return Some(
            "found a log of KUKA's sensor interface (RSI) with poses and no joint readings, expected joint readings, or what an instrument \
             measured: record the axes (AIPos) too, and name the instrument's file beside",
        );
    }
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let word = first.trim_start_matches('*');
    if word.starts_with("11") && digits(word) == 6 && matches!(word.as_bytes().get(6), Some(b'+' | b'-')) {
        return Some(
            "found measurements of a total station as GSI, expected a table: write the points by the station's own format manager as text with a header, \
             as name,x[m],y[m],z[m]",
        );
    }
    let begins = |start: &str| lines(text).take(FIRST).any(|it| it.1.trim_start().starts_with(start));
    let named = KINDS.iter().find(|it| if it.0.starts_with('<') { begins(it.0) } else { first.starts_with(it.0) });
    if let Some((_, words)) = named {
        return Some(words);
    }
    is_tuple(text).then_some(
        "found a tuple of HALCON (numbers without names, as of poses), expected a table with a header that names the columns: write the poses as \
         x,y,z and angles in a table, with the joint readings of each row",
    )
}

/// True if a text is a tuple of HALCON: the number of elements, then a type and a value in each line.
fn is_tuple(text: &str) -> bool {
    let mut all = lines(text).map(|it| it.1.split_whitespace().collect::<Vec<_>>());
    let is_count = |it: &[&str]| matches!(it, [count] if count.parse::<usize>().is_ok());
    let is_element = |it: &[&str]| matches!(it, ["1" | "2" | "4" | "8", value] if number(value).is_some());
    all.next().is_some_and(|it| is_count(&it)) && {
        let some: Vec<Vec<&str>> = all.take(FIRST).collect();
        some.len() >= 3 && some.iter().all(|it| is_element(it))
    }
}

#[cfg(test)]
mod tests {
    use super::find_refusal;

    #[test]
    fn known_forms_without_readings_are_named() {
        for (text, words) in [
            ("/JOB\n//NAME A\n", "pulses"),
            ("Timestamp,X_RIst,Y_RIst\n", "RSI"),
            ("PathFileType\t4\t(X/Y/Z)\tmarkers.trc\nDataRate\tCameraRate\n", "TRC"),
            ("<?xml version=\"1.0\"?>\n<LandXML version=\"1.2\">\n", "LandXML"),
            ("*110001+00000000000000P1 81..00+0000000001234567\n", "GSI"),
            ("110002+000000P2 21.102+17920860 22.102+07567500\n", "GSI"),
            ("014\n2 -7.06e-02\n2 1.0\n1 4\n2 0.5\n", "HALCON"),
        ] {
            assert!(find_refusal(text).is_some_and(|it| it.contains(words)), "{text}");
        }
        for text in ["", "14\n", "110001,2,3\n", "joint1,x\n1,2\n", "3\n1 2\n3 4\n5 6\n"] {
            assert_eq!(find_refusal(text), None, "{text}");
        }
    }
}
