//! The report's text around its tables and figures.

use super::document::{ReportBlock, ReportDocument};
use super::numbers::{format_stated, mm, number};
use super::tables::largest_difference;
use super::{comparison, figures, tables};
use crate::{ElbowRun, MeasurementKind, PaperFormulation, Reproduction, ScrewRow};

const REFERENCE: &str = "lou2009: Y. Lou, T. Chen, Y. Wu, Z. Li, S. Jiang. Improved and modified geometric formulation of POE based kinematic calibration of serial robots. IEEE/RSJ International Conference on Intelligent Robots and Systems (IROS), 2009.";
const WHAT: &str = "This report repeats the experiment of lou2009 and sets what was measured beside what the paper says. The robot is the elbow manipulator of the paper's Tables I and II. Every number comes from the run that wrote this report, and stands in `results.json` too.";
const FORMULATIONS: &str = "There are four formulations. `adjoint` moves each screw as a rigid body and has no joint offsets: it is the paper's improved formulation (poses) and its modified one (points). `screw` takes the six coordinates of a screw as free numbers and makes them a screw again after each iteration. `screw-offsets` adds joint offsets to that: it is the original formulation, of Okamura and Park. `adjoint-offsets` adds joint offsets to `adjoint`, to show what they add.";

const OWN: &str = "The paper does not say how many measurements its simulations have, in which configurations, how an iteration ends the calibration, or how large the joint offsets and the noise were. These are this project's own: random configurations within Table I's ranges, the noise, the offsets, and the rule to stop by. Without noise a run ends when a step or the residual is nothing but rounding, with noise when a step promises nothing beyond the noise. So the paper's numbers of iterations are bounds here, not numbers to meet.";
const RANKS: &str = "A matrix without full rank has columns that do nothing, or that do together what others do: these parameters cannot be separated by any measurement of this kind.";
const STARTS: &str = "Here the truth is random and every fit starts at the nominal elbow. Each axis and the tip of the truth is turned and shifted off the nominal one in random directions, by exactly the stated angle and distance. A start counts if the fit ends at the truth: held-out error below 1 µm, without noise. With points, the start is exactly the singular place of Table II, the point on axis 6, where the matrix has rank 25 and not 27. With poses, Gauss-Newton has the paper's residual and Levenberg-Marquardt that at the tool, so the two differ in both.";

pub(super) fn document(found: &Reproduction) -> ReportDocument {
    let mut blocks = vec![
        text(WHAT),
        text(&own_findings(found)),
        text(REFERENCE),
        text("The same files are made by:"),
        ReportBlock::Code(found.command.clone()),
        text(&setting(found)),
        text(FORMULATIONS),
        heading_block("What the paper says"),
        text(&describe_holding(found)),
        ReportBlock::Table(tables::claims(found)),
        heading_block("What the paper leaves out"),
        text(&left_out(found)),
        ReportBlock::Table(tables::left_out(found)),
        heading_block("Convergence"),
        text(&convergence(found)),
        ReportBlock::Figure(figures::residuals(found)),
        ReportBlock::Figure(figures::screw_errors(found)),
        ReportBlock::Table(tables::runs(found)),
    ];
    blocks.extend(identified_blocks(found));
    blocks.extend([
        heading_block("Ranks"),
        text(&format!("{RANKS} A radian counts as {} m in them.", format_stated(found.length_m))),
        ReportBlock::Table(tables::ranks(found)),
        ReportBlock::Figure(figures::spectra(found)),
        heading_block("Accuracy with noise"),
        text(&accuracy(found)),
        ReportBlock::Figure(figures::efficiency(found)),
        ReportBlock::Table(tables::efficiency(found)),
        heading_block("Convergence from afar"),
        text(STARTS),
        ReportBlock::Figure(figures::basin(found)),
        ReportBlock::Table(tables::basin(found)),
        heading_block("Where the original is as good, and where it is not"),
    ]);
    blocks.extend(comparison::sentences(found).iter().map(|sentence| text(sentence)));
    ReportDocument { title: "Reproduction of lou2009".to_owned(), blocks }
}

/// Parts of the experiment that the paper does not state.
fn own_findings(found: &Reproduction) -> String {
    let count = |seen| found.runs.iter().find(|run| run.measurement == seen).map(|run| run.measurements);
    let offsets: Vec<String> = found.offsets.iter().map(|row| format_stated(row.prescribed_deg)).collect();
    match (count(MeasurementKind::Poses), count(MeasurementKind::Points)) {
        (Some(poses), Some(points)) => format!(
            "{OWN} There are {poses} poses or {points} points, and joint offsets, where there are any, of {} deg.",
            offsets.join(", ")
        ),
        _ => OWN.to_owned(),
    }
}

fn accuracy(found: &Reproduction) -> String {
    let start = "Each formulation was fitted to many noisy sets of measurements, with the residual at the tool and with the paper's logarithm in the base frame. The bound is that of Cramér and Rao.";
    let lost = found.efficiency.iter().filter(|row| row.converged < row.trials).map(|row| {
        format!(
            "{} of {} of `{}` from {} ({} residual, {})",
            row.trials - row.converged,
            row.trials,
            row.formulation.word(),
            row.measurement.word(),
            row.residual,
            row.method
        )
    });
    let lost: Vec<String> = lost.collect();
    if lost.is_empty() {
        return format!("{start} Every fit ended.");
    }
    format!(
        "{start} These fits did not end within the limit of iterations and are left out of the errors: {}.",
        lost.join("; ")
    )
}

fn identified_blocks(found: &Reproduction) -> [ReportBlock; 8] {
    [
        heading_block("Identified against prescribed"),
        text(&screws(found)),
        ReportBlock::Figure(figures::deviations(found)),
        ReportBlock::Table(tables::screws(found)),
        ReportBlock::Table(tables::point(found)),
        text(&offsets(found)),
        ReportBlock::Figure(figures::offsets(found)),
        ReportBlock::Table(tables::offsets(found)),
    ]
}

fn text(words: &str) -> ReportBlock {
    ReportBlock::Text(words.to_owned())
}

fn heading_block(words: &str) -> ReportBlock {
    ReportBlock::Heading(words.to_owned())
}

fn setting(found: &Reproduction) -> String {
    format!(
        "Made by poecal {}, seed {}. Noise, where there is any, has a standard deviation of {} mm in each component of position and {} deg in each component of rotation.",
        found.version,
        found.seed,
        format_stated(1e3 * found.noise_position_m),
        format_stated(found.noise_rotation_rad.to_degrees())
    )
}

fn describe_holding(found: &Reproduction) -> String {
    let (holding, all) = found.count_holding(true);
    format!(
        "{holding} of {all} statements hold as they are made; the table says by which criterion. Where one does not, the measured column says what does."
    )
}

fn left_out(found: &Reproduction) -> String {
    let (holding, all) = found.count_holding(false);
    format!(
        "Findings that the paper does not mention, and that its statements are not counted by: {holding} of {all} hold in this run."
    )
}

/// Number of iterations of each formulation.
fn convergence(found: &Reproduction) -> String {
    let start =
        "Plain Gauss-Newton, as in the paper, from the nominal screws; no noise, no joint offsets in the truth.";
    let words = |run: &ElbowRun| {
        let end = if run.converged { "" } else { ", not converged" };
        format!("`{}` {}{end}", run.formulation.word(), run.iterations)
    };
    let sentences = [MeasurementKind::Poses, MeasurementKind::Points].map(|seen| {
        let runs = found.runs.iter().filter(|run| run.measurement == seen && !run.offsets_in_truth && !run.noise);
        let words: Vec<String> = runs.map(words).collect();
        let words = if words.is_empty() { "none".to_owned() } else { words.join("; ") };
        format!("Iterations from {}: {words}.", seen.word())
    });
    format!("{start} {}", sentences.join(" "))
}

/// The largest difference of a part of the screws from prescribed.
fn largest_screw_difference(found: &Reproduction, of: fn(&ScrewRow) -> &[f64; 6], part: std::ops::Range<usize>) -> f64 {
    let (values, prescribed): (Vec<f64>, Vec<f64>) = found
        .screws
        .iter()
        .flat_map(|row| of(row).iter().zip(&row.prescribed).skip(part.start).take(part.len()))
        .unzip();
    largest_difference(&values, &prescribed)
}

fn screws(found: &Reproduction) -> String {
    let both = |of: fn(&ScrewRow) -> &[f64; 6]| {
        format!(
            "{} mm in v and {} in ω",
            mm(largest_screw_difference(found, of, 0..3)),
            number(largest_screw_difference(found, of, 3..6))
        )
    };
    format!(
        "Table II is printed with four digits, so its screws are not quite screws. The prescribed robot has the nearest true ones; these differ from the printed ones by at most {}. The screws identified by `adjoint` without noise differ from the prescribed ones by at most {} from poses, and by at most {} from points. The nominal ones differ by up to {}.",
        both(|row| &row.printed),
        both(|row| &row.from_poses),
        both(|row| &row.from_points),
        both(|row| &row.nominal)
    )
}

fn offsets(found: &Reproduction) -> String {
    let prescribed: Vec<f64> = found.offsets.iter().map(|row| row.prescribed_deg).collect();
    let off = |identified: Vec<f64>| number(largest_difference(&identified, &prescribed));
    let screw = off(found.offsets.iter().map(|row| row.screw_offsets_deg).collect());
    let adjoint = off(found.offsets.iter().map(|row| row.adjoint_offsets_deg).collect());
    let held_out = |formulation: PaperFormulation| {
        found.exact_run(formulation, MeasurementKind::Poses, true).map_or(String::new(), |run| {
            format!(
                " Its error of prediction on configurations that were not measured is {} mm.",
                mm(run.held_out_rms_m)
            )
        })
    };
    format!(
        "In this part the true robot has joint offsets too. From poses without noise, `screw-offsets` misses them by up to {screw} deg.{} `adjoint-offsets` misses them by up to {adjoint} deg.{}",
        held_out(PaperFormulation::ScrewOffsets),
        held_out(PaperFormulation::AdjointOffsets)
    )
}
