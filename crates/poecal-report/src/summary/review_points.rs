//! Points of a calibration that need attention.

use std::collections::BTreeSet;

use super::super::table::number;
use super::names;
use poecal_calibrate::{EventKind, Level, Loss};
use poecal_fit::analysis::{Cause, Direction};
use poecal_results::calibration_file::{CalibrationFile, IdentifiabilityEntry, OutlierEntry};

/// Suspected rows that are named.
const WORST: usize = 3;
/// Characters of a direction's description that is printed unchanged.
const SHORT: usize = 200;
/// Words of the warning about suspected rows, which are reported by their figures instead.
const SUSPECTS: &str = "`outliers` in calibration.json";

/// Words on fitted outliers that the terminal prints, but no page.
pub(crate) const SEE_ROBUST: &str = ", see --robust";

/// Source of a point in `calibration.json`, with its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointSource {
    Suspicion(usize),
    Diagnosis(usize),
    Warning(usize),
    Reason,
    Suspects,
    Joint(usize),
    HardlyKnown,
}

/// Something to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ReviewPoint {
    pub(crate) text: String,
    pub(crate) place: PointSource,
}

/// Points that need attention, the gravest first. The verdict's first reason is printed beside the verdict.
pub(crate) fn look_at(file: &CalibrationFile) -> Vec<ReviewPoint> {
    let stated = file.verdict.as_ref().map_or(&[][..], |verdict| &verdict.reasons);
    // Rows that a repair left out are reported with it.
    let is_told = file.repairs.iter().any(|it| it.kind == EventKind::Rows);
    let suspects = file.robust.suspected.training + file.robust.suspected.held_out;
    let point = |place: PointSource, text: &str| ReviewPoint { text: text.to_owned(), place };
    let is_new = |text: &str| !stated.iter().any(|reason| reason == text);

    let suspicions = file.suspicions.iter().enumerate();
    let mut points: Vec<ReviewPoint> =
        suspicions.map(|(k, found)| point(PointSource::Suspicion(k), &found.statement)).collect();
    let found = file.diagnosis.iter().enumerate().filter(|(_, found)| is_new(&found.statement));
    points.extend(found.map(|(k, found)| point(PointSource::Diagnosis(k), &found.statement)));
    let warnings = file.warnings.iter().enumerate().filter(|(_, text)| is_new(text));
    let warnings = warnings.filter(|(_, text)| suspects == 0 || !text.contains(SUSPECTS));
    points.extend(warnings.map(|(k, text)| point(PointSource::Warning(k), text)));
    points.extend(reasons(file).iter().skip(1).map(|text| point(PointSource::Reason, text)));
    if suspects > 0 && !is_told {
        points.push(point(PointSource::Suspects, &suspects_words(file)));
    }
    for (k, joint) in file.corrections.iter().enumerate() {
        if let Some(words) = &joint.suspicious {
            points.push(point(PointSource::Joint(k), &format!("{}: {words}", joint.joint)));
        }
    }
    let known = &file.identifiability;
    if known.rank > 0 || known.parameters == 0 {
        points.extend(hardly_known(known));
    }
    let mut told = BTreeSet::new();
    points.retain(|point| told.insert(point.text.clone()));
    points
}

/// Unknowns that are not determined, or weakly, each counted in one sentence: those of the same joints for the same cause together.
fn hardly_known(known: &IdentifiabilityEntry) -> Vec<ReviewPoint> {
    // The direction that is reported, its words, and the unknowns of each degree.
    let mut groups: Vec<(&Direction, String, [usize; 2])> = Vec::new();
    let open = known.unidentifiable.iter().map(|it| (it, 0));
    for (direction, degree) in open.chain(known.weak.iter().map(|it| (it, 1))) {
        let words = direction_words(["undetermined", "weakly determined"][degree], direction);
        let is_same = |(first, own, [open, _]): &(&Direction, String, [usize; 2])| {
            let beside = *open > 0 && (first.cause, &first.joints) == (direction.cause, &direction.joints);
            *own == words || degree == 1 && beside
        };
        match groups.iter_mut().find(|group| is_same(group)) {
            Some((.., counts)) => counts[degree] += direction.directions,
            None => {
                let mut counts = [0; 2];
                counts[degree] = direction.directions;
                groups.push((direction, words, counts));
            }
        }
    }
    let point = |(_, words, counts): &(&Direction, String, [usize; 2])| {
        let count = match *counts {
            [0, 1] | [1, 0] => String::new(),
            [0, count] | [count, 0] => format!(" ({})", unknowns_words(count)),
            [open, weak] => format!(" ({}, {weak} more weakly)", unknowns_words(open)),
        };
        ReviewPoint { text: format!("{words}{count}"), place: PointSource::HardlyKnown }
    };
    groups.iter().map(point).collect()
}

/// `1 unknown`, `2 unknowns`.
pub(crate) fn unknowns_words(count: usize) -> String {
    format!("{count} unknown{}", if count == 1 { "" } else { "s" })
}

/// Reasons against a better verdict, in the verdict's words; joints that moved by little are named together.
pub(crate) fn reasons(file: &CalibrationFile) -> Vec<String> {
    let Some(verdict) = file.verdict.as_ref().filter(|verdict| verdict.level != Level::Good) else {
        return Vec::new();
    };
    let moved = |reason: &str| {
        let joints = file.coverage.iter().filter_map(|it| Some((&it.joint, reason.strip_prefix(&*it.joint)?)));
        let mut shares = joints.filter_map(|(joint, rest)| {
            let (share, _) = rest.strip_prefix(" was moved through ")?.split_once(" %")?;
            Some(format!("{joint} {share} %"))
        });
        shares.next()
    };
    let little: Vec<String> = verdict.reasons.iter().filter_map(|reason| moved(reason)).collect();
    if little.len() < 2 {
        return verdict.reasons.clone();
    }
    let little: Vec<&str> = little.iter().map(String::as_str).collect();
    let together = format!("joints moved through a part of their range only: {}", names(&little));
    let mut together = Some(together);
    let told = verdict.reasons.iter().filter_map(|reason| match moved(reason) {
        Some(_) => together.take(),
        None => Some(reason.clone()),
    });
    told.collect()
}

/// Number of suspected rows, the consequence for the fit, and the worst of them.
fn suspects_words(file: &CalibrationFile) -> String {
    let robust = &file.robust;
    let all = file.accuracy.training.count + file.accuracy.held_out.as_ref().map_or(0, |set| set.count);
    let count = robust.suspected.training + robust.suspected.held_out;
    let rows = if all == 1 { "row" } else { "rows" };
    let are = if count == 1 { "is an outlier" } else { "are outliers" };
    let counted = match robust.loss {
        _ if robust.suspected.training == 0 => "",
        Some(Loss::Tukey) => " with almost no weight",
        Some(Loss::Huber | Loss::Cauchy) => " with less weight",
        None => " with full weight",
    };
    let is_plain = robust.suspected.training > 0 && robust.loss.is_none();
    let see = if is_plain { SEE_ROBUST } else { "" };
    let sets = format!("{} fitted{counted}{see}, {} held out", robust.suspected.training, robust.suspected.held_out);
    let worst: Vec<String> =
        file.outliers.iter().take(WORST).scan("", |last, outlier| Some(name_row(outlier, last))).collect();
    let worst = if worst.is_empty() { String::new() } else { format!("; worst {}", worst.join(", ")) };
    format!("{count} of {all} {rows} {are} ({sets}){worst}")
}

/// A row by file and line, the file only if it differs from the one before.
fn name_row<'a>(outlier: &'a OutlierEntry, last: &mut &'a str) -> String {
    let place =
        if *last == outlier.file { outlier.row.to_string() } else { format!("{}:{}", outlier.file, outlier.row) };
    *last = &outlier.file;
    match outlier.residual.leading_value() {
        Some((quantity, residual)) => format!("{place} by {} {}", number(residual), quantity.unit().symbol()),
        None => place,
    }
}

/// The robot's undetermined or weakly determined direction; in few words if there are many joints to name.
fn direction_words(degree: &str, direction: &Direction) -> String {
    let is_short = direction.description.chars().count() <= SHORT && direction.joints.len() <= super::MOST;
    if is_short || direction.joints.is_empty() {
        return format!("{degree}: {}", direction.description);
    }
    let joints: Vec<&str> = direction.joints.iter().map(String::as_str).collect();
    format!("{degree}: {}: {}", names(&joints), cause_words(direction.cause))
}

fn cause_words(cause: Cause) -> &'static str {
    match cause {
        Cause::OwnAxis => "no measurement depends on a motion along or about their own axes",
        Cause::BaseFrame => "the base frame is a matter of choice",
        Cause::JointOffsets => "their offsets cannot be separated from their axes",
        Cause::NoOrientation => "no orientation was measured",
        Cause::Unseen => "no way from an instrument to its target passes them",
        Cause::StoodStill => "did not move",
        Cause::TooFew => "too few measurements",
        Cause::PointOnAxis => "the target is on the axis",
        Cause::OneOrientation => "the tool kept one orientation",
        Cause::OneTurningDirection => "the tool turned about one direction only",
        Cause::MovedTogether => "moved in a fixed relation only",
        Cause::SmallMotion => "moved by little",
        Cause::DependentMotion => "moved in combinations that hide their axes",
        Cause::NoLength => "size unknown: nothing measured has a length",
        Cause::SeenOnce => "a target was measured once",
        Cause::Other => "these configurations hardly determine their axes",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_fit::analysis::Observability;

    #[test]
    fn each_unknown_is_counted_in_one_sentence() {
        let direction = |joint: &str, cause, directions| Direction {
            description: format!("{joint} is odd"),
            joints: vec![joint.to_owned()],
            cause,
            directions,
        };
        let known = IdentifiabilityEntry {
            parameters: 30,
            rank: 27,
            effective_unknowns: None,
            condition: None,
            unidentifiable: vec![direction("a", Cause::StoodStill, 2), direction("b", Cause::TooFew, 1)],
            weak: vec![
                direction("a", Cause::StoodStill, 1),
                direction("c", Cause::PointOnAxis, 1),
                direction("c", Cause::PointOnAxis, 1),
                direction("d", Cause::Other, 1),
            ],
            structural: Vec::new(),
            observability: Observability::default(),
        };
        let told: Vec<String> = hardly_known(&known).into_iter().map(|point| point.text).collect();
        let expected = [
            "undetermined: a is odd (2 unknowns, 1 more weakly)",
            "undetermined: b is odd",
            "weakly determined: c is odd (2 unknowns)",
            "weakly determined: d is odd",
        ];
        assert_eq!(told, expected);
        assert_eq!(known.weakly_determined(), 4);
    }
}
