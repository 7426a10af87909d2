//! The page of a plan.

use maud::{Markup, PreEscaped, html};
use nalgebra::Vector3;

use super::head;
use super::html::{HtmlTable, decimal, facts, fold_table, plots, section};
use super::sides::{SideView, pictures};
use crate::plan::{CURVE_HEAD, PlanReport};
use crate::plot::{ArmSeries, AxisMark, AxisScale, CELLS, LinePlot, PlotAxis, PlotLine, StripPlot, StripRow};
use poecal_model::robot::{ReadingKind, Robot};
use poecal_numerics::text::visible_markup;
use poecal_plan::plan::{CurvePoint, DeviceView, Plan as Found, PlanOptions, RowPurpose, skeleton};
use poecal_results::model::Model;
use poecal_results::output::PagePieces;
use poecal_results::record::Record;

/// Points of the rim of a device's cone.
const RIM: usize = 24;
/// Arms that a picture draws at most; for all other configurations the target alone.
const ARMS: usize = 8;

/// The page of a plan, complete in itself and without a script. It shows the robot in some configurations and the targets of all, the device's field
/// of view, errors by number, and the sampled part of each joint's range.
#[must_use]
pub fn plan_page(model: &Model, options: &PlanOptions, found: &Found, told: &PlanReport) -> PagePieces {
    let robot = &model.robot;
    let title = format!("Plan of a session of {}", robot.name);
    let head = head(&title, &Record::default(), env!("CARGO_PKG_VERSION"));
    let body = html! {
        a.skip href="#main" { "Skip to the plan" }
        main #main {
            header {
                h1 { (title) }
                p.made { "made by poecal " (env!("CARGO_PKG_VERSION")) }
            }
            section.first {
                div {
                    p.gain { (told.answer()) }
                    (facts(&told.facts().iter().map(|(name, words)| (*name, html! { (words) })).collect::<Vec<_>>()))
                }
            }
            (section("arms", "The robot and its targets", &arms(robot, options, found)))
            (section("number", "How many configurations", &curve(found, told)))
            (section("joints", "How each joint is sampled", &joints(robot, found)))
            (section("rows", "The list", &rows(robot, found)))
        }
    };
    vec![visible_markup(head).into(), visible_markup(body).into(), "\n</body>\n</html>\n".into()]
}

fn arms(robot: &Robot, options: &PlanOptions, found: &Found) -> Markup {
    let rows = found.rows.iter().filter(|row| !row.returns);
    let skeletons: Vec<(RowPurpose, Skeleton)> = rows.map(|row| (row.part, skeleton(robot, &row.readings))).collect();
    let chosen = spread_out_rows(&skeletons);
    let caption = format!(
        "Dots: the target in all {} configurations. Lines: the robot in {} of them that are far apart, between the frames of its joints. Only \
         configurations are checked, never the way between them.",
        skeletons.len(),
        chosen.len()
    );
    plots(&pictures(|view| draw_arms(view, options, (&skeletons, &chosen))), caption)
}

/// Lines of a robot in one configuration.
type Skeleton = Vec<[Vector3<f64>; 2]>;

/// A few configurations with distant targets: each has the largest distance from all before.
fn spread_out_rows(skeletons: &[(RowPurpose, Skeleton)]) -> Vec<usize> {
    let ends: Vec<(usize, Vector3<f64>)> =
        skeletons.iter().enumerate().filter_map(|(k, (_, lines))| Some((k, lines.last()?[1]))).collect();
    let mut chosen: Vec<(usize, Vector3<f64>)> = ends.first().copied().into_iter().collect();
    while chosen.len() < ARMS.min(ends.len()) {
        let far = |at: &Vector3<f64>| chosen.iter().map(|(_, other)| (at - other).norm()).fold(f64::INFINITY, f64::min);
        let next = ends.iter().max_by(|a, b| far(&a.1).total_cmp(&far(&b.1))).copied();
        // If all others coincide with those before, no further one is distant.
        match next.filter(|(_, at)| far(at) > 0.0) {
            Some(next) => chosen.push(next),
            None => break,
        }
    }
    chosen.into_iter().map(|(k, _)| k).collect()
}

fn draw_arms(
    view: &SideView,
    options: &PlanOptions,
    (skeletons, chosen): (&[(RowPurpose, Skeleton)], &[usize]),
) -> Vec<ArmSeries> {
    let flat = |at: &Vector3<f64>| view.project(at);
    let lines = |[a, b]: &[Vector3<f64>; 2]| [flat(a), flat(b)];
    let of = |part: RowPurpose, name: &str, style: usize| {
        let own = || skeletons.iter().enumerate().filter(|(_, it)| it.0 == part);
        let ends = own().filter_map(|(_, it)| it.1.last()).map(|line| flat(&line[1])).collect();
        let arms = own().filter(|(k, _)| chosen.contains(k));
        let lines = arms.flat_map(|(_, it)| &it.1).map(lines).collect();
        ArmSeries { name: name.to_owned(), style, lines, is_thin: true, points: ends, ..ArmSeries::default() }
    };
    let mut arms = vec![of(RowPurpose::Judge, "to judge by", 1), of(RowPurpose::Fit, "to fit", 0)];
    arms.retain(|it| !it.points.is_empty());
    if let Some(sight) = &options.conditions.sight {
        let place = vec![flat(&sight.place)];
        arms.push(ArmSeries {
            name: "device".to_owned(),
            style: 2,
            lines: cone(sight, &flat),
            is_thin: true,
            points: place,
            ..ArmSeries::default()
        });
    }
    let boxes: Vec<[[f64; 2]; 2]> =
        options.conditions.keep_out.iter().flat_map(|corners| outline(view, corners)).collect();
    if !boxes.is_empty() {
        arms.push(ArmSeries {
            name: "keep out".to_owned(),
            style: 3,
            lines: boxes,
            is_thin: true,
            ..ArmSeries::default()
        });
    }
    arms
}

/// The device's cone: its rim half-way to its aim, and lines to it.
fn cone(sight: &DeviceView, flat: &impl Fn(&Vector3<f64>) -> [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    let Some((at, half)) = sight.cone else { return Vec::new() };
    let axis = 0.5 * (at - sight.place);
    let middle = sight.place + axis;
    let least = axis.map(f64::abs).imin();
    let across = axis.cross(&Vector3::from_fn(|k, _| if k == least { 1.0 } else { 0.0 }));
    let (Some(u), radius) = (across.try_normalize(1e-12), axis.norm() * half.tan()) else {
        return Vec::new();
    };
    let v = axis.cross(&u).try_normalize(1e-12).unwrap_or(u);
    let rim = |k: usize| {
        let (s, c) = (std::f64::consts::TAU * k as f64 / RIM as f64).sin_cos();
        middle + radius * (u * c + v * s)
    };
    let around = (0..RIM).map(|k| [flat(&rim(k)), flat(&rim(k + 1))]);
    let sides = (0..RIM).step_by(RIM / 4).map(|k| [flat(&sight.place), flat(&rim(k))]);
    around.chain(sides).collect()
}

/// The four sides of a box.
fn outline(view: &SideView, corners: &[[f64; 3]; 2]) -> Vec<[[f64; 2]; 2]> {
    let [low, high] = corners.map(|corner| view.project(&corner.into()));
    let around = [low, [high[0], low[1]], high, [low[0], high[1]]];
    (0..4).map(|k| [around[k], around[(k + 1) % 4]]).collect()
}

fn curve(found: &Found, told: &PlanReport) -> Markup {
    let points = |of: fn(&CurvePoint) -> f64| -> Vec<[f64; 2]> {
        found.curve.iter().map(|point| [point.count as f64, 1e3 * of(point)]).collect()
    };
    let line = |name: &str, style, of| PlotLine { name: name.to_owned(), style, points: points(of) };
    let plot = LinePlot {
        title: "Expected error by number of configurations".to_owned(),
        description: "Expected error (RMS over the workspace) of planned lists of other lengths".to_owned(),
        x: PlotAxis::new("configurations to fit", AxisScale::Linear).with_values(&[0.0]),
        y: PlotAxis::new("expected error, mm", AxisScale::Log),
        lines: vec![
            line("calibrated", 0, |it| it.expected.calibrated_m()),
            line("corrected", 1, |it| it.expected.corrected_m()),
        ],
        mark: Some(AxisMark { at: told.planned_count() as f64, label: "planned".to_owned() }),
    };
    let mut table =
        HtmlTable::new("Expected errors, mm; removable: the part that more rows would remove", 0, &CURVE_HEAD);
    for point in &found.curve {
        let it = &point.expected;
        let errors = [it.calibrated_m(), it.undetermined_m, it.corrected_m(), it.corrected_undetermined_m];
        let errors = errors.map(|error| decimal(1e3 * error, 4));
        table.cells(std::iter::once(point.count.to_string()).chain(errors));
    }
    html! {
        p { (told.advice()) }
        (plots(&[PreEscaped(plot.svg())], "More configurations remove a part of the error; the rest is robot error that such a model does not describe."))
        (fold_table("The same as numbers", &table))
    }
}

fn joints(robot: &Robot, found: &Found) -> Markup {
    let names = robot.reading_names();
    let own = || found.rows.iter().filter(|row| row.part == RowPurpose::Fit && !row.returns);
    let strip = |(at, name): (usize, &String)| {
        let kind = robot.reading_kind(name);
        let values = || own().filter_map(|row| row.readings.get(at).copied());
        let limits = robot.joints.iter().find(|joint| joint.reading.name == *name).and_then(|it| it.limits);
        let (low, high) = limits.map_or_else(
            || (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)),
            |limits| (limits.lower, limits.upper),
        );
        let mut counts = [0; CELLS];
        for value in values() {
            let share = ((value - low) / (high - low).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            if let Some(count) = counts.get_mut(((share * CELLS as f64) as usize).min(CELLS - 1)) {
                *count += 1;
            }
        }
        let end = |value: f64| format!("{} {}", decimal(kind.in_shown_unit(value), 0), kind.suffix()).trim().to_owned();
        StripRow { name: name.clone(), ends: [end(low), end(high)], counts }
    };
    let plot = StripPlot {
        title: "Configurations to fit, between the limits of each joint".to_owned(),
        description: "How many configurations have a joint in each twentieth of its range".to_owned(),
        strips: names.iter().enumerate().map(strip).collect(),
    };
    plots(&[PreEscaped(plot.svg())], "The darker, the more configurations are in that part of the range.")
}

fn rows(robot: &Robot, found: &Found) -> Markup {
    let names = robot.reading_names();
    let kinds: Vec<ReadingKind> = names.iter().map(|name| robot.reading_kind(name)).collect();
    let heads = names.iter().zip(&kinds).map(|(name, kind)| format!("{name}, {}", kind.suffix()));
    let heads: Vec<String> = ["row".to_owned(), "for".to_owned()].into_iter().chain(heads).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let mut table = HtmlTable::new("The rows in their order", 2, &heads);
    for (at, row) in found.rows.iter().enumerate() {
        let part = match (row.returns, row.part) {
            (true, _) => "return to the first",
            (false, RowPurpose::Fit) => "fit",
            (false, RowPurpose::Judge) => "judge",
        };
        let cells = row.readings.iter().zip(&kinds).map(|(value, kind)| decimal(kind.in_shown_unit(*value), 2));
        table.cells([(at + 1).to_string(), part.to_owned()].into_iter().chain(cells));
    }
    html! { (table) }
}
