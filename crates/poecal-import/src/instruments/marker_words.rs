//! Messages on markers of one body whose names were exchanged or lost.

use std::collections::BTreeMap;

use super::words::quote_names;
use crate::join::join_words::number_lines;
use poecal_fit::start::RenamedMarkers;

/// Notes and warnings on renamed markers. `lines` are those of the frames.
pub(crate) fn words(
    found: &RenamedMarkers,
    names: &[&str],
    lines: &[usize],
    is_seen: impl Fn(usize, usize) -> bool,
) -> (Vec<String>, Vec<String>) {
    let name = |column: &usize| names.get(*column).copied().unwrap_or_default();
    let mut exchanged: BTreeMap<Vec<usize>, Vec<String>> = BTreeMap::new();
    let (mut unnamed, mut lost) = (0, Vec::new());
    for (frame, of) in &found.frames {
        let line = lines.get(*frame).map_or_else(String::new, ToString::to_string);
        let moved = of.iter().filter_map(|(marker, at)| Some((*marker, (*at)?))).filter(|it| it.0 != it.1);
        let (own, others): (Vec<_>, Vec<_>) = moved.partition(|it| found.markers.contains(&it.1));
        unnamed += others.len();
        let is_left = |(marker, at): (&usize, &Option<usize>)| {
            at.is_none() && is_seen(*frame, *marker) && !of.values().any(|it| *it == Some(*marker))
        };
        if of.iter().any(is_left) {
            lost.push(line.clone());
        }
        if !own.is_empty() {
            exchanged.entry(own.iter().map(|it| it.0).collect()).or_default().push(line);
        }
    }
    let at = |lines: &[String]| match lines.len() {
        1 => format!("one frame ({})", number_lines(lines)),
        count => format!("{count} frames ({})", number_lines(lines)),
    };
    let exchanges = exchanged.iter().map(|(markers, lines)| {
            let (names, at) = (quote_names(markers.iter().map(name)), at(lines));
            format!("exchanged the names of {names} in {at}, where their distances to the other markers are those of each other: check the labels there")
        });
    let mut warned: Vec<String> = exchanges.collect();
    if !lost.is_empty() {
        warned.push(format!(
            "left out markers in {}, since their distances are those of no marker of the body",
            at(&lost)
        ));
    }
    let said = (unnamed > 0).then(|| {
        format!("found {unnamed} places of its markers among those without a name, by the distances between them")
    });
    (said.into_iter().collect(), warned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_exchanged_or_left_out_is_named_with_its_line() {
        let exchanged = BTreeMap::from([(0, Some(1)), (1, Some(0)), (2, Some(2))]);
        let frames = BTreeMap::from([(50, exchanged), (60, (0..3).map(|it| (it, None)).collect())]);
        let found = RenamedMarkers { frames, markers: vec![0, 1, 2] };
        let (said, warned) = words(&found, &["A", "B", "C"], &(8..208).collect::<Vec<_>>(), |_, _| true);
        assert!(said.is_empty());
        assert!(warned[0].starts_with("exchanged the names of `A`, `B` in one frame (line 58), where"), "{warned:?}");
        assert!(warned[1].starts_with("left out markers in one frame (line 68), since"), "{warned:?}");
    }
}
