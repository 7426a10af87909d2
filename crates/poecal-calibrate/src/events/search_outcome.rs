//! Results of a session's search, and sentences about them.

use std::collections::BTreeSet;

use super::event_reports::{Event, EventKind};
use super::hypotheses::MovedPart;
use super::limits::RepairLimits;
use super::names::{DEVICE, family, next_of};
use super::search::SearchStep;
use crate::steps::calibrated_fit::CalibratedFit;
use poecal_model::measurement::Dataset;
use poecal_model::robot::{MEASURED, Robot};

/// Share of the residuals that remains after a step, above which its repair cannot gain as much.
const LITTLE: f64 = 0.8;
/// Files and lines that a sentence lists.
const LISTED: usize = 3;
/// Ratio of the gain of the second-best explanation to that of the best, above which both are named.
const NEARLY: f64 = 0.9;

/// Result of a session's search.
pub(crate) enum SearchOutcome {
    Wrong(Vec<u32>),
    Step(SearchStep),
}

impl SearchOutcome {
    /// True if all its rows are suspected as outliers anyway.
    pub(crate) fn is_suspected(&self, best: &CalibratedFit<'_>) -> bool {
        matches!(self, SearchOutcome::Wrong(rows) if rows.iter().all(|row| best.robust.robustness.suspects_row(*row)))
    }

    /// True if the event explains much of the residuals.
    pub(crate) fn matters(&self) -> bool {
        match self {
            SearchOutcome::Wrong(_) => true,
            SearchOutcome::Step(step) => step.leaves <= LITTLE,
        }
    }
}

/// An event, with its sentence if it is repaired and if it is only suspected.
pub(crate) struct EventSentences(Event, String);

impl EventSentences {
    pub(crate) fn repaired_event(self, [before, after]: [f64; 2], residuals: Vec<[f64; 3]>) -> Event {
        Event { error_before_mm: Some(before), error_after_mm: Some(after), residuals, ..self.0 }
    }

    /// Adds the statement that the event is too large for a repair.
    pub(crate) fn with_limit(self, limit: &str) -> Self {
        EventSentences(self.0, format!("{}; it is {limit}: look for a mistake in the input, or raise it", self.1))
    }

    /// The exceeded limit in words; `radian_m` metres count for a radian. `None` for a device that had another position for another file.
    pub(crate) fn exceeded_limit(&self, limits: &RepairLimits, data: &Dataset, radian_m: f64) -> Option<String> {
        let Event { kind, size_mm, size_deg, from_row, .. } = &self.0;
        let first = u32::try_from(*from_row).ok()?.checked_sub(1)?;
        if *kind == EventKind::Device && files_apart(data, first).is_some() {
            return None;
        }
        let size = (1e-3 * size_mm.unwrap_or(0.0), size_deg.unwrap_or(0.0).to_radians());
        limits.exceeded_limit(*kind, size, radian_m)
    }

    pub(crate) fn suspected_event(self, before: f64, after: Option<f64>) -> Event {
        let EventSentences(event, statement) = self;
        Event { statement, error_before_mm: Some(before), error_after_mm: after, ..event }
    }
}

/// Description of the event.
pub(crate) fn event(happened: &SearchOutcome, data: &Dataset, robot: &Robot) -> EventSentences {
    let step = match happened {
        SearchOutcome::Wrong(rows) => return wrong_words(data, rows),
        SearchOutcome::Step(step) => step,
    };
    let number = step.first as usize + 1;
    let has = |turns: bool| step.turns.contains(&turns);
    let length = |turns: bool| {
        let own = step.size.iter().zip(&step.turns).filter(|(_, it)| **it == turns);
        own.map(|(value, _)| value * value).sum::<f64>().sqrt()
    };
    let size_mm = has(false).then(|| 1e3 * length(false));
    let size_deg = has(true).then(|| length(true).to_degrees());
    let EventStatement { kind, name, is, taken } = statement(step, &far_words(size_mm, size_deg), data, robot);
    let remedy = if kind == EventKind::Drift {
        "wait until it has settled, and measure again".to_owned()
    } else {
        let after = data.len() + 1 - number;
        format!("measure the {} rows before it again, or the {after} from it on", number - 1)
    };
    let event = Event {
        kind,
        name,
        from_row: number,
        from: data.place(step.first),
        rows: Vec::new(),
        size_mm,
        size_deg,
        error_before_mm: None,
        error_after_mm: None,
        statement: format!("{is}: {taken}"),
        residuals: Vec::new(),
    };
    EventSentences(event, format!("{is}: {remedy}"))
}

/// Subject of a step in words: the event, and its interpretation in a repair.
struct EventStatement {
    kind: EventKind,
    name: String,
    is: String,
    taken: String,
}

fn statement(step: &SearchStep, far: &str, data: &Dataset, robot: &Robot) -> EventStatement {
    let from = data.place(step.first);
    let or =
        other_words(step, robot, data).map_or_else(String::new, |or| format!(" ({or} explains it nearly as well)"));
    let named = |names: &[Option<String>], at: usize| names.get(at).cloned().flatten().unwrap_or_default();
    let other = |name: &str, usual, names: &[Option<String>]| {
        next_of(if name.is_empty() { usual } else { name }, names.iter().flatten())
    };
    let (kind, name, is, taken) = match step.moved {
        MovedPart::Device(station) => {
            let name = named(&data.stations, station);
            let is = match files_apart(data, step.first) {
                Some((before, after)) if name.is_empty() => format!(
                    "the files {before} and {after} do not share one device frame, as --device-frames per-file says: the measuring device is {far} \
                         from where it was{or}"
                ),
                _ => format!("from {from} on the measuring device{} is {far} from where it was{or}", quote_name(&name)),
            };
            let taken = format!("taken as set up anew there, `{}`", other(&name, DEVICE, &data.stations));
            (EventKind::Device, name, is, taken)
        }
        MovedPart::Target(target) => {
            let name = named(&data.targets, target);
            let bases: BTreeSet<&str> =
                data.targets.iter().map(|it| family(it.as_deref().unwrap_or(MEASURED)).0).collect();
            let (kind, what) =
                if bases.len() > 1 { (EventKind::Nest, "nest of target") } else { (EventKind::Target, "target") };
            let own = quote_name(&name);
            let is = format!("from {from} on the {what}{own} is {far} from where it was on the arm{or}");
            let taken = format!("taken as another target, `{}`", other(&name, MEASURED, &data.targets));
            (kind, name, is, taken)
        }
        MovedPart::Tool => {
            let is = format!("from {from} on the tool with all targets is {far} from where it was on the arm{or}");
            (EventKind::Target, String::new(), is, "taken as other targets from there on".to_owned())
        }
        MovedPart::Zero(joint) => {
            let name = robot.joints.get(joint).map(|joint| joint.name.clone()).unwrap_or_default();
            let is = format!("from {from} on the zero of joint `{name}` is {far} from where it was{or}");
            (EventKind::Zero, name, is, "readings before it are taken as those after it".to_owned())
        }
        MovedPart::Drift(station) => {
            let name = named(&data.stations, station);
            let own = quote_name(&name);
            let is = format!("the measuring device{own} drifts by {far} from the first row to the last{or}");
            (EventKind::Drift, name, is, "measurements are taken as without the drift".to_owned())
        }
    };
    EventStatement { kind, name, is, taken }
}

/// The files before and after a row with which one begins.
fn files_apart(data: &Dataset, first: u32) -> Option<(String, String)> {
    let file = |row: u32| {
        let at = data.observations.get(row as usize)?.source.file as usize;
        Some((at, data.files.get(at)?.display().to_string()))
    };
    let (before, after) = (file(first.checked_sub(1)?)?, file(first)?);
    (before.0 != after.0).then_some((before.1, after.1))
}

fn wrong_words(data: &Dataset, rows: &[u32]) -> EventSentences {
    let configurations = data.configurations(rows);
    let places: Vec<String> =
        configurations.iter().filter_map(|it| it.first()).take(LISTED).map(|row| data.place(*row)).collect();
    let more = configurations.len().saturating_sub(LISTED);
    let and = if more > 0 { format!(" and {more} more") } else { String::new() };
    let (is, it) = if configurations.len() == 1 {
        ("1 configuration is wrong as a whole".to_owned(), "it")
    } else {
        (format!("{} configurations are wrong as a whole", configurations.len()), "them")
    };
    let is = format!("{is} ({}{and}), as if read before the arm had settled", places.join(", "));
    let event = Event {
        kind: EventKind::Rows,
        name: String::new(),
        from_row: rows.first().map_or(0, |row| *row as usize + 1),
        from: rows.first().map(|row| data.place(*row)).unwrap_or_default(),
        rows: rows.iter().map(|row| *row as usize + 1).collect(),
        size_mm: None,
        size_deg: None,
        error_before_mm: None,
        error_after_mm: None,
        statement: format!("{is}: left out; measure {it} again"),
        residuals: Vec::new(),
    };
    EventSentences(event, format!("{is}: measure {it} again, or leave {it} out"))
}

/// Another explanation of a step that is nearly as good.
fn other_words(step: &SearchStep, robot: &Robot, data: &Dataset) -> Option<String> {
    let (moved, less) = step.other?;
    if less > (1.0 - NEARLY) * step.gain {
        return None;
    }
    let target = |at: usize| data.targets.get(at).cloned().flatten().unwrap_or_default();
    Some(match moved {
        MovedPart::Device(_) => "the measuring device".to_owned(),
        MovedPart::Target(at) => format!("the target{}", quote_name(&target(at))),
        MovedPart::Tool => "the tool".to_owned(),
        MovedPart::Zero(joint) => format!("the zero of `{}`", robot.joints.get(joint)?.name),
        MovedPart::Drift(_) => "a drift".to_owned(),
    })
}

fn quote_name(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!(" `{name}`") }
}

fn far_words(mm: Option<f64>, deg: Option<f64>) -> String {
    match (mm, deg) {
        (Some(mm), Some(deg)) => format!("{mm:.2} mm and {deg:.3} deg"),
        (Some(mm), None) => format!("{mm:.2} mm"),
        (None, Some(deg)) => format!("{deg:.3} deg"),
        (None, None) => String::new(),
    }
}
