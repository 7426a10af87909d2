//! Method and files of the calibration, and the command that repeats it.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::devices::found_words;
use super::html::{HtmlTable, count, facts, figure, fold_table, path, plots, quote_text, section};
use super::{figures, joins};
use crate::summary::terms;
use poecal_calibrate::DeviceFrameKnowledge;
use poecal_import::InputEntry;
use poecal_model::measurement::Quantity;
use poecal_numerics::solve::Termination;
use poecal_results::calibration_file::CalibrationFile;

/// Length of the trace above which its table is not listed.
const LISTED: usize = 60;

pub(crate) fn sections(file: &CalibrationFile) -> Markup {
    let content = html! {
        p {
            "The joints' axes are screws in the product of exponentials. Each is corrected as a rigid body, by four numbers for a revolute \
             joint and two for a prismatic one; this parameterisation has no singularity and needs no initial guess. The tool is fitted \
             too, and the device frame unless it was known. The documentation of poecal explains the figures and has the formulas."
        }
        (held_and_found(file))
        (inputs(file))
    };
    section("method", "Method and inputs", &content)
}

/// Details of the fit.
pub(crate) fn for_the_metrologist(file: &CalibrationFile) -> Markup {
    html! {
        h3 { "Fit" }
        (solver(file))
        @if !file.solver.trace.is_empty() { (convergence(file)) }
        (offsets(file))
    }
}

/// Held unknowns, terms of joint values, and the pose of the device.
fn held_and_found(file: &CalibrationFile) -> Markup {
    let device = match file.measurement_frame.known {
        DeviceFrameKnowledge::Unknown => found_words(file),
        DeviceFrameKnowledge::Base => ("Device frame", html! { "measured in the robot's base frame" }),
    };
    let held = file.blocks.as_ref().map_or(&[][..], |blocks| &blocks.held);
    let held = html! {
        @for (k, name) in held.iter().enumerate() {
            @if k > 0 { ", " } (quote_text(name, format_args!("blocks.held.{k}")))
        }
    };
    let terms = html! {
        @for (k, (name, value)) in terms(file).enumerate() { @if k > 0 { ", " } (name) " " (value) }
    };
    let all = [("Held as in the model", held), ("Terms of joint values", terms), device];
    let all: Vec<_> = all.into_iter().filter(|(_, content)| !content.0.is_empty()).collect();
    facts(&all)
}

fn solver(file: &CalibrationFile) -> Markup {
    let solver = &file.solver;
    let end = match solver.termination {
        Termination::Optimum | Termination::StepVanished | Termination::NoProgress => "converged",
        Termination::IterationLimit => "did not converge: the limit of iterations was reached",
        Termination::NotFinite => "did not converge: residuals are not finite",
    };
    let has_poses = file.accuracy.training.calibrated.get(Quantity::Rotation).is_some();
    let unknowns = html! {
        (quote_text(&solver.formulation, "solver.formulation")) " formulation"
        @if has_poses { ", " (quote_text(&solver.pose_residual, "solver.pose_residual")) " residuals of poses" }
    };
    let steps = html! {
        (method_words(&solver.method)) ", " (count(solver.iterations, "solver.iterations")) " iterations, " (end)
        @if solver.restarts > 0 { ", " (count(solver.restarts, "solver.restarts")) " further starts" }
    };
    let version = html! {
        "poecal " (quote_text(&file.poecal_version, "poecal_version")) ", form " (quote_text(&file.schema, "schema"))
    };
    let loss = html! { (file.robust.loss.map_or("least squares", |loss| loss.word())) };
    facts(&[("Unknowns", unknowns), ("Steps", steps), ("Loss", loss), ("Version", version)])
}

/// Joint offsets, if the formulation contains them.
fn offsets(file: &CalibrationFile) -> Markup {
    let Some(offsets) = &file.solver.joint_offsets else { return Markup::default() };
    let mut table = HtmlTable::new(
        "Joint offsets of this formulation; in the calibrated model they are part of the axes",
        1,
        &["joint", "offset"],
    );
    for (k, offset) in offsets.iter().enumerate() {
        let figure = |value, name| figure(value, format_args!("solver.joint_offsets.{k}.{name}"));
        let words = match (offset.offset_deg, offset.offset_mm) {
            (Some(value), _) => html! { (figure(value, "offset_deg")) "°" },
            (None, Some(value)) => html! { (figure(value, "offset_mm")) " mm" },
            (None, None) => Markup::default(),
        };
        table.row(&[&quote_text(&offset.joint, format_args!("solver.joint_offsets.{k}.joint")), &words]);
    }
    html! { (table) }
}

/// The default method by its name.
fn method_words(method: &str) -> &str {
    match method {
        "levenberg-marquardt" => "damped least squares (Levenberg and Marquardt)",
        other => other,
    }
}

fn convergence(file: &CalibrationFile) -> Markup {
    let trace = &file.solver.trace;
    let mut table = HtmlTable::new("Mean square of the whitened residual by iteration", 1, &["iteration", "value"]);
    for (k, value) in trace.iter().enumerate().take(LISTED) {
        table.row(&[&k, &figure(*value, format_args!("solver.trace.{k}"))]);
    }
    let words = if trace.len() > LISTED { "The first iterations as numbers" } else { "The iterations as numbers" };
    html! {
        (plots(&[figures::convergence(file)], "Each line is a fit with weights and rows of its own, so that values of different lines do not compare. At 1 the residuals are as large as the noise that they are weighted by."))
        (fold_table(words, &table))
    }
}

/// A checksum with positions for line breaks: after each eight digits.
fn group_digits(hash: &str) -> Markup {
    let is_hash = hash.len() == 64 && hash.bytes().all(|it| it.is_ascii_hexdigit());
    let parts: Vec<&str> =
        if is_hash { (0..8).filter_map(|k| hash.get(8 * k..8 * k + 8)).collect() } else { vec![hash] };
    html! { @for (k, part) in parts.iter().enumerate() { @if k > 0 { wbr; } (part) } }
}

/// Files with their checksums: one with its key and description, the measurements with the used part of each, and mappings.
pub(crate) fn files(
    first: Option<(&String, &str, &str)>,
    measurements: &[String],
    sha256: &BTreeMap<String, String>,
    (entries, mappings): (&[InputEntry], &[&String]),
) -> HtmlTable {
    let has_entries = !entries.is_empty();
    let head: &[&str] =
        if has_entries { &["file", "what", "taken", "rows", "SHA-256"] } else { &["file", "what", "SHA-256"] };
    let mut table = HtmlTable::new("Files that were read", head.len(), head);
    let mut add = |name: &String, shown: Markup, what: &str, of: Option<(&InputEntry, usize)>| {
        let hash = sha256.get(name).map_or("not recorded", String::as_str);
        let hash = html! { code.hash { (group_digits(hash)) } };
        match of {
            Some((entry, at)) => {
                let rows = count(entry.rows, format_args!("inputs.files.{at}.rows"));
                table.row(&[&shown, &what, &joins::describe_taken(entry, at), &rows, &hash]);
            }
            None if has_entries => table.row(&[&shown, &what, &"", &"", &hash]),
            None => table.row(&[&shown, &what, &hash]),
        }
    };
    if let Some((first, key, what)) = first {
        add(first, path(first, key), what, None);
    }
    for (k, name) in measurements.iter().enumerate() {
        let shown = || path(name, format_args!("inputs.measurements.{k}"));
        let own: Vec<(&InputEntry, usize)> = entries.iter().zip(0..).filter(|(entry, _)| entry.file == *name).collect();
        for (entry, at) in &own {
            add(name, shown(), entry.form.as_deref().unwrap_or("a table"), Some((entry, *at)));
        }
        if own.is_empty() {
            add(name, shown(), "measurements", None);
        }
    }
    for name in mappings {
        add(name, html! { (name) }, "mapping", None);
    }
    table
}

fn inputs(file: &CalibrationFile) -> Markup {
    let inputs = &file.inputs;
    let is_further = |name: &&String| **name != inputs.model && !inputs.measurements.contains(name);
    let further: Vec<&String> = inputs.sha256.keys().filter(is_further).collect();
    let own = (&inputs.model, "inputs.model", "model");
    let table = files(Some(own), &inputs.measurements, &inputs.sha256, (&inputs.files, &further));
    html! {
        h3 { "Inputs" }
        (table)
        (joins::sections(&inputs.joins))
        @if let Some(command) = &inputs.command {
            h3 { "How to make it again" }
            p { "In the same folder, with files of these checksums and this version, the command writes the same bytes:" }
            pre tabindex="0" { code { (quote_text(command, "inputs.command")) } }
        } @else {
            p.note { "The calibration was not made by the program, or by an earlier version, so no command is recorded." }
        }
    }
}
