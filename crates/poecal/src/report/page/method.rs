//! How the calibration was made, of which files, and how to make it again.

use super::figures;
use super::html::{Html, Table, count, figure, path, quoted};
use crate::io::calibration_file::{CalibrationFile, FrameWord, StationEntry};
use crate::report::plot::escape;
use crate::solve::Termination;

/// A number of the trace beyond which its table would only be long.
const LISTED: usize = 60;

pub(super) fn sections(page: &mut Html, file: &CalibrationFile) {
    page.section("method", "Method and inputs");
    page.text(
        "The joints' axes are screws in the product of exponentials; each is moved as a rigid body, by four numbers of a joint that turns and \
         two of one that slides, without a singularity and without a first guess. The tool is fitted with them, and where the measuring \
         device stands, unless that was known. What the figures mean is said in <code>docs/report.md</code>, how they are computed in \
         <code>docs/theory.md</code>, both with the program.",
    );
    solver(page, file);
    convergence(page, file);
    inputs(page, file);
    page.end_section();
}

fn solver(page: &mut Html, file: &CalibrationFile) {
    let solver = &file.solver;
    let end = match solver.termination {
        Termination::Optimum | Termination::StepVanished | Termination::NoProgress => "ended at the optimum",
        Termination::IterationLimit => "did not converge: the limit of iterations was reached",
        Termination::NotFinite => "did not converge: residuals are not finite",
    };
    let restarts = match solver.restarts {
        0 => String::new(),
        restarts => format!(", {} further starts tried", count(restarts, "solver.restarts")),
    };
    let device = match file.measurement_frame.known {
        FrameWord::Unknown if file.stations.len() > 1 => {
            let name = |(index, station): (usize, &StationEntry)| {
                let name = station.instrument.as_deref()?;
                Some(quoted(name, &format!("stations.{index}.instrument")))
            };
            let names: Vec<String> = file.stations.iter().enumerate().filter_map(name).collect();
            format!("found with the robot, one for each of the instruments {}", names.join(", "))
        }
        FrameWord::Unknown => "found with the robot".to_owned(),
        FrameWord::Base => "measured in the robot's base frame".to_owned(),
    };
    let loss = file.robust.loss.map_or("least squares", |loss| loss.word());
    page.facts(&[
        (
            "Unknowns",
            format!(
                "{} formulation, {} residuals of poses",
                quoted(&solver.formulation, "solver.formulation"),
                quoted(&solver.pose_residual, "solver.pose_residual")
            ),
        ),
        (
            "Steps",
            format!(
                "{}, {} iterations, {end}{restarts}",
                escape(&solver.method),
                count(solver.iterations, "solver.iterations")
            ),
        ),
        ("Loss", escape(loss)),
        ("Device frame", device),
        (
            "Version",
            format!(
                "poecal {}, form {}",
                quoted(&file.poecal_version, "poecal_version"),
                quoted(&file.schema, "schema")
            ),
        ),
    ]);
}

fn convergence(page: &mut Html, file: &CalibrationFile) {
    let trace = &file.solver.trace;
    if trace.is_empty() {
        return;
    }
    page.plots(&[figures::convergence(file)], "At 1 the residuals are as large as the noise that they are weighted by. A step up is a round that begins anew, with other weights or on more rows.");
    let mut table =
        Table::new("Mean square of the whitened residual by iteration", 1, &["iteration", "value"]);
    for (k, value) in trace.iter().enumerate().take(LISTED) {
        table.rows.push(vec![k.to_string(), figure(*value, &format!("solver.trace.{k}"))]);
    }
    let words =
        if trace.len() > LISTED { "The first iterations as numbers" } else { "The iterations as numbers" };
    page.folded_table(words, &table);
}

fn inputs(page: &mut Html, file: &CalibrationFile) {
    let inputs = &file.inputs;
    let mut table = Table::new("Files that were read", 3, &["file", "what", "SHA-256"]);
    let model = (&inputs.model, "model", "inputs.model".to_owned());
    let measurements = inputs
        .measurements
        .iter()
        .enumerate()
        .map(|(k, name)| (name, "measurements", format!("inputs.measurements.{k}")));
    let mut named: Vec<(&String, &str, String)> = std::iter::once(model).chain(measurements).collect();
    named.extend(
        inputs
            .sha256
            .keys()
            .filter(|name| **name != inputs.model && !inputs.measurements.contains(name))
            .map(|name| (name, "mapping", String::new())),
    );
    for (name, what, key) in named {
        let hash = inputs.sha256.get(name).map_or("not recorded", String::as_str);
        let shown = if key.is_empty() { escape(name) } else { path(name, &key) };
        table.rows.push(vec![
            shown,
            what.to_owned(),
            format!("<code class=\"hash\">{}</code>", escape(hash)),
        ]);
    }
    page.heading("Inputs");
    page.table(&table);
    page.heading("To make it again");
    match &inputs.command {
        Some(command) => {
            let command = quoted(command, "inputs.command");
            page.raw(&format!("<pre tabindex=\"0\"><code>{command}</code></pre>"));
            page.note("In the folder where it was run, with the files of these checksums and this version, it gives the same bytes.");
        }
        None => page.note("The calibration was not made by the program, or by an earlier version, so no command is recorded."),
    }
}
