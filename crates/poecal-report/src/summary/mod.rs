//! The table of a calibration in 80 columns: the verdict, points of attention, the errors, the unknowns. All else on demand.

mod details;
mod errors;
mod names;
mod review_points;
mod short_table;

pub(crate) use errors::{LeadingRows, ModelRow, cross_validated, has_terms, judged_on, none_held_out, why_larger};
pub(crate) use names::{MOST, names};
pub(crate) use review_points::{PointSource, ReviewPoint, SEE_ROBUST, look_at, reasons, unknowns_words};
pub use short_table::ShortTable;

use super::acceptance;
use super::table::{format_triple, line, lines, number};
use poecal_calibrate::{Event, Level, TermGroup};
use poecal_fit::analysis::Cause;
use poecal_numerics::error::shorten_name as name_shown;
use poecal_results::calibration_file::{
    CalibrationFile, ClockEntry, CorrectedEntry, IdentifiabilityEntry, UncertaintyEntry,
};

/// Angle of gravity from -z of the base below which it is not reported, radians.
const UPRIGHT: f64 = 1e-4;

/// Level of detail of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// The answer in eleven lines: more only if limits are accepted.
    #[default]
    Short,
    /// Everything, with lists of full length.
    Full,
}

/// The result of a calibration, as text of lines up to 80 characters: the verdict first.
///
/// ```
/// use poecal_calibrate::{CalibrationOptions, calibrate};
/// use poecal_results::calibration_file::{CalibrationFile, Inputs};
/// use poecal_report::{Detail, summary};
/// use poecal_model::simulate::{SessionKind, Simulation, elbow};
/// let made = Simulation { count: 100, ..Simulation::default() }.run(&elbow(), SessionKind::POINT)?;
/// let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default())?;
/// let file = CalibrationFile::new(&calibration, &made.data, Inputs::default());
/// let short = summary(&file, Detail::Short);
/// assert!(short.starts_with("verdict       good\nbefore        ") && short.contains(" mm anywhere inside the sampled range"));
/// assert!(summary(&file, Detail::Full).contains("solver"));
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
#[must_use]
pub fn summary(file: &CalibrationFile, detail: Detail) -> String {
    if detail == Detail::Short {
        return short_summary(file, 0).table;
    }
    let mut out = String::new();
    top(&mut out, file);
    lines(&mut out, "look at", look_at(file).iter().map(|point| &point.text));
    rest(&mut out, file);
    out.push('\n');
    errors::table(&mut out, file);
    out.push('\n');
    details::all(&mut out, file);
    if out.contains('±') {
        line(&mut out, "±", "one standard deviation");
    }
    out
}

/// The short table with its next step, after `said` printed lines.
#[must_use]
pub fn short_summary(file: &CalibrationFile, said: usize) -> ShortTable {
    short_table::short_table(file, said)
}

/// The verdict, the errors, their domain, limits.
fn top(out: &mut String, file: &CalibrationFile) {
    verdict(out, file);
    errors::figures(out, file);
    if let Some(acceptance) = &file.acceptance {
        acceptance::lines(out, acceptance);
    }
}

/// The unknowns that the rows determine, and the findings on targets, joints and clocks.
fn rest(out: &mut String, file: &CalibrationFile) {
    describe_determined(out, file);
    file.clocks.iter().for_each(|clock| line(out, "clock", &clock_words(clock)));
}

/// Expected error of the delivered model.
pub(crate) struct Expectation {
    /// Error in configurations like those that were measured, millimetres (RMS).
    pub(crate) error_mm: f64,
    /// The distance that 95 % of the errors do not exceed.
    pub(crate) bound_mm: f64,
    /// Error anywhere inside the sampled range.
    pub(crate) inside_mm: Option<f64>,
    /// Distance of the nominal model's predictions from the delivered one's there.
    pub(crate) nominal_mm: Option<f64>,
    /// Error anywhere within the limits, with its key, if the verdict is good.
    pub(crate) anywhere: Option<(f64, String)>,
}

/// Expected error according to the verdict; `None` if no use is advised or no error is known.
pub(crate) fn expected_summary(file: &CalibrationFile) -> Option<Expectation> {
    let verdict = file.verdict.as_ref().filter(|it| it.level != Level::DoNotUse)?;
    let (own, key) = uncertainty(file)?;
    Some(Expectation {
        error_mm: verdict.expected_error_mm.unwrap_or(own.measured.sigma_position_mm),
        bound_mm: verdict.bound95_mm.unwrap_or(own.measured.bound95_position_mm),
        inside_mm: verdict.sampled_range_error_mm,
        nominal_mm: verdict.nominal_error_mm,
        anywhere: (verdict.level == Level::Good)
            .then(|| (own.range.sigma_position_mm, format!("{key}.range.sigma_position_mm"))),
    })
}

/// The delivered model.
pub(crate) fn delivered_name(file: &CalibrationFile) -> &'static str {
    if has_terms(file) { "corrected" } else { "calibrated" }
}

/// Uncertainty of the delivered model, and its key.
pub(crate) fn uncertainty(file: &CalibrationFile) -> Option<(&UncertaintyEntry, &'static str)> {
    let corrected = file.corrected.as_deref().filter(|it| it.has_terms());
    match corrected.and_then(|it| it.uncertainty.as_ref()) {
        Some(own) => Some((own, "corrected.uncertainty")),
        None => Some((file.uncertainty.as_ref()?, "uncertainty")),
    }
}

fn verdict(out: &mut String, file: &CalibrationFile) {
    let Some(verdict) = &file.verdict else {
        line(out, "verdict", "none: the calibration was written by an earlier version");
        return;
    };
    let level = verdict.level.words();
    match reasons(file).into_iter().next() {
        Some(reason) if verdict.level == Level::DoNotUse => line(out, "verdict", &format!("{level}: {reason}")),
        _ => line(out, "verdict", level),
    }
    if let Some(confirmed) = &verdict.confirmed {
        line(out, "confirmed", confirmed);
    }
    lines(out, "repaired", file.repairs.iter().map(repaired_words));
}

/// A repair and its gain.
pub(crate) fn repaired_words(found: &Event) -> String {
    let gain = found.error_before_mm.zip(found.error_after_mm);
    let gain = gain
        .map(|(before, after)| format!("; cross-validation {} mm (RMS) instead of {}", number(after), number(before)));
    format!("{}{}", found.statement, gain.unwrap_or_default())
}

/// Lag and drift of an instrument's clock, with their standard deviations.
fn clock_words(clock: &ClockEntry) -> String {
    let ClockEntry { lag_s, sigma_lag_ms, drift_ppm, sigma_drift_ppm, .. } = clock;
    let sigma = |of: &Option<f64>, unit: &str| {
        // Two digits.
        let digits = |it: f64| [10.0, 1.0, 0.1].into_iter().filter(|limit| it < *limit).count();
        of.map_or(String::new(), |it| format!(" ± {it:.*}{unit}", digits(it)))
    };
    let name = clock.instrument.as_deref().map_or(String::new(), |it| format!("{}: ", name_shown(it)));
    format!(
        "{name}lag {lag_s:.5} s{} in the middle, drift {drift_ppm:.1}{} ppm",
        sigma(sigma_lag_ms, " ms"),
        sigma(sigma_drift_ppm, "")
    )
}

/// Number of determined unknowns, and of weakly determined ones.
pub(crate) fn determined_words(found: &IdentifiabilityEntry) -> String {
    let weak = match found.weakly_determined() {
        0 => String::new(),
        weak => format!(" ({weak} weakly)"),
    };
    format!("{} of {}{weak}", found.rank, unknowns_words(found.parameters))
}

/// Unknowns that the rows determine, and those that they do not.
fn describe_determined(out: &mut String, file: &CalibrationFile) {
    let found = &file.identifiability;
    let fitted = file.accuracy.training.count;
    let all = fitted + file.accuracy.held_out.as_ref().map_or(0, |set| set.count);
    line(out, "determined", &format!("{}, from {fitted} of {all} rows", determined_words(found)));
    let mut undetermined = Vec::new();
    if found.rank == 0 && found.parameters > 0 {
        undetermined.push("everything: the residual is as large as the effect of the unknowns".to_owned());
    } else if found.rank < found.parameters {
        let mut joints: Vec<&str> = Vec::new();
        for name in found.unidentifiable.iter().flat_map(|direction| &direction.joints) {
            if !joints.contains(&name.as_str()) {
                joints.push(name);
            }
        }
        let open = found.parameters - found.rank;
        let of = if joints.is_empty() { String::new() } else { format!(" of {}", names(&joints)) };
        undetermined.push(format!("{}{of}", unknowns_words(open)));
        let zeros = found.unidentifiable.iter().filter(|it| it.cause == Cause::JointOffsets);
        undetermined.extend(zeros.map(|it| it.description.clone()));
    }
    let structural = found.structural.iter().filter(|it| it.cause == Cause::NoOrientation);
    undetermined.extend(structural.map(|direction| direction.description.clone()));
    lines(out, "undetermined", undetermined);
    lines(out, "target", targets(file));
    if file.move_tip {
        line(out, "tip", "the point that was measured, by --move-tip");
    }
    if let Some(blocks) = &file.blocks {
        lines(out, "held", (!blocks.held.is_empty()).then(|| blocks.held.join(", ")));
    }
    lines(out, "terms", terms(file).map(|(name, value)| format!("{name} {value}")));
    if let Some(found) = &file.corrected {
        line(out, "corrected", &corrected_words(found));
        let has_terms = found.sizes.values().any(|size| *size > 0.0);
        let direction = found.robot.gravity.as_ref().map(|gravity| gravity.direction).filter(|_| has_terms);
        if let Some([x, y, z]) = direction.filter(|[_, _, z]| (-z).clamp(-1.0, 1.0).acos() > UPRIGHT) {
            let off = number((-z).clamp(-1.0, 1.0).acos().to_degrees());
            line(out, "gravity", &format!("along {x:.3}, {y:.3}, {z:.3} of the base, {off} deg from -z"));
        }
    } else if file
        .blocks
        .as_ref()
        .is_some_and(|it| it.held.iter().any(|name| file.has_joint(name.strip_suffix(".axis").unwrap_or(name))))
    {
        line(out, "corrected", "not fitted: beside axes that are held, only groups of terms that are named");
    }
}

/// Position of each target on the link of the tip, the first few of many.
fn targets(file: &CalibrationFile) -> Vec<String> {
    let link = if file.robot.tip_link.is_empty() { "the tip" } else { &file.robot.tip_link };
    let on_tip = file.targets.iter().filter(|(_, target)| target.on.is_none());
    let told = on_tip.map(|(name, target)| {
        let place = format_triple(target.position_m, 1e3, 2);
        format!("{}: at {place} mm in the frame of {}", name_shown(name), name_shown(link))
    });
    let mut told: Vec<String> = told.collect();
    if told.len() > MOST {
        let rest = told.len() - (MOST - 1);
        told.truncate(MOST - 1);
        told.push(format!("… and {rest} more, in calibration.json"));
    }
    told
}

/// Groups of terms of the corrected model, and the evidence for them.
fn corrected_words(found: &CorrectedEntry) -> String {
    let used = TermGroup::ALL.into_iter().filter_map(|group| {
        let size = *found.sizes.get(group.name())?;
        let shown = format!("{:.4}", 1e3 * size);
        let shown = shown.trim_end_matches('0').trim_end_matches('.');
        (size > 0.0).then(|| format!("{} {shown} {}", group.name(), group.row().symbols[1]))
    });
    let used = used.collect::<Vec<_>>().join(", ");
    let chosen = found.tried.iter().find(|it| it.sizes == found.sizes);
    match (used.is_empty(), chosen) {
        (true, _) => format!("as calibrated: {}", found.reason.words()),
        (false, None) => format!("by {used}: {}", found.reason.words()),
        (false, Some(chosen)) => format!(
            "by {used}: {:.2} of the error of geometry alone on rows of other parts of the range",
            chosen.left_out
        ),
    }
}

/// The terms of joint values with their coefficients, as text.
pub(crate) fn terms(file: &CalibrationFile) -> impl Iterator<Item = (String, String)> {
    file.joints.iter().flat_map(|joint| {
        joint.terms.iter().map(|(term, &coefficient)| {
            let unit = joint.kind.unit_of(*term);
            let sign = if coefficient < 0.0 { "-" } else { "" };
            let name = format!("{}.{term}", joint.name);
            let value = format!("{sign}{}", number(unit.in_shown_unit(coefficient.abs())));
            // The prior alone determines as much as half its own width.
            let (spread, open) = match file.sigma(&name) {
                Some(sigma) if sigma > 0.5 * joint.kind.deviation_of(*term) => (String::new(), " (not determined)"),
                Some(sigma) => (format!(" ± {}", number(unit.in_shown_unit(sigma))), ""),
                None if file.is_open(&name) => (String::new(), " (not determined)"),
                None => (String::new(), ""),
            };
            let symbol = if unit.symbol().is_empty() { String::new() } else { format!(" {}", unit.symbol()) };
            (name, format!("{value}{spread}{symbol}{open}"))
        })
    })
}
