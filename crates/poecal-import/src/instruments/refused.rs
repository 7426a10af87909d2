//! Texts of known forms that have nothing that could be read here, with what to write instead.

use super::words::{lines, number};

/// Lines by which a form is recognised.
const FIRST: usize = 12;

/// Why a text is not read, by its beginning.
pub(crate) fn found(text: &str) -> Option<&'static str> {
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
    is_tuple(text).then_some(
        "found a tuple of HALCON (numbers without names, as of poses), expected a table with a header that names the columns: write the poses as \
         x,y,z and angles in a table, with the joint readings of each row",
    )
}

/// Whether a text is a tuple of HALCON: the number of elements, then a type and a value in each line.
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
    use super::found;

    #[test]
    fn known_forms_without_readings_are_named() {
        for (text, words) in [
            ("/JOB\n//NAME A\n", "pulses"),
            ("Timestamp,X_RIst,Y_RIst\n", "RSI"),
            ("014\n2 -7.06e-02\n2 1.0\n1 4\n2 0.5\n", "HALCON"),
        ] {
            assert!(found(text).is_some_and(|it| it.contains(words)), "{text}");
        }
        for text in ["", "14\n", "joint1,x\n1,2\n", "3\n1 2\n3 4\n5 6\n"] {
            assert_eq!(found(text), None, "{text}");
        }
    }
}
