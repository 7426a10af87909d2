//! The report's text around its tables and figures.

use super::document::{Block, Document};
use super::numbers::{mm, number};
use super::tables::largest_difference;
use super::{comparison, figures, tables};
use crate::parameters::Formulation;
use crate::reproduce::{Reproduction, Run, ScrewRow, Seen};

const REFERENCE: &str = "lou2009: Y. Lou, T. Chen, Y. Wu, Z. Li, S. Jiang. Improved and modified geometric formulation of POE based kinematic calibration of serial robots. IEEE/RSJ International Conference on Intelligent Robots and Systems (IROS), 2009.";
const WHAT: &str = "This report repeats the experiment of lou2009 and sets what was measured beside what the paper says. The robot is the elbow manipulator of the paper's Tables I and II. Every number comes from the run that wrote this report, and stands in `results.json` too.";
const FORMULATIONS: &str = "There are four formulations. `adjoint` moves each screw as a rigid body and has no joint offsets: it is the paper's improved formulation (poses) and its modified one (points). `screw` takes the six coordinates of a screw as free numbers and makes them a screw again after each iteration. `screw-offsets` adds joint offsets to that: it is the original formulation, of Okamura and Park. `adjoint-offsets` adds joint offsets to `adjoint`, to show what they add.";

pub(super) fn document(found: &Reproduction) -> Document {
    let mut blocks = vec![
        text(WHAT),
        text(REFERENCE),
        text("The same files are made by:"),
        Block::Code(found.command.clone()),
        text(&setting(found)),
        text(FORMULATIONS),
        heading("What the paper says, and what was measured"),
        text(&holding(found)),
        Block::Table(tables::claims(found)),
        heading("Convergence"),
        text(&convergence(found)),
        Block::Figure(figures::residuals(found)),
        Block::Figure(figures::screw_errors(found)),
        Block::Table(tables::runs(found)),
    ];
    blocks.extend(identified(found));
    blocks.extend([
        heading("Ranks"),
        text("A matrix without full rank has columns that do nothing, or that do together what others do: these parameters cannot be told apart by any measurement of this kind."),
        Block::Table(tables::ranks(found)),
        Block::Figure(figures::spectra(found)),
        heading("Accuracy with noise"),
        text("Each formulation was fitted to many noisy sets of measurements, with the residual at the tool and with the paper's logarithm in the base frame. The bound is that of Cramér and Rao."),
        Block::Figure(figures::efficiency(found)),
        Block::Table(tables::efficiency(found)),
        heading("Convergence from afar"),
        text("Here the axes of the start are off by a random turn and shift of the stated size. A start counts if the fit ends at the truth: held-out error below 1 µm, without noise."),
        Block::Figure(figures::basin(found)),
        Block::Table(tables::basin(found)),
        heading("Where the original is as good, and where it is not"),
    ]);
    blocks.extend(comparison::sentences(found).iter().map(|sentence| text(sentence)));
    Document { title: "Reproduction of lou2009".to_owned(), blocks }
}

fn identified(found: &Reproduction) -> [Block; 8] {
    [
        heading("Identified against prescribed"),
        text(&screws(found)),
        Block::Figure(figures::deviations(found)),
        Block::Table(tables::screws(found)),
        Block::Table(tables::point(found)),
        text(&offsets(found)),
        Block::Figure(figures::offsets(found)),
        Block::Table(tables::offsets(found)),
    ]
}

fn text(words: &str) -> Block {
    Block::Text(words.to_owned())
}

fn heading(words: &str) -> Block {
    Block::Heading(words.to_owned())
}

fn setting(found: &Reproduction) -> String {
    format!(
        "Made by poecal {}, seed {}. Noise, where there is any, has a standard deviation of {} mm in each component of position and {} deg in each component of rotation.",
        found.version,
        found.seed,
        mm(found.noise_position_m),
        number(found.noise_rotation_rad.to_degrees())
    )
}

fn holding(found: &Reproduction) -> String {
    let holds = found.claims.iter().filter(|claim| claim.holds).count();
    format!(
        "{holds} of {} statements hold as they are made. Where one does not, the measured column says what does.",
        found.claims.len()
    )
}

/// How many iterations each formulation took.
fn convergence(found: &Reproduction) -> String {
    let start = "Plain Gauss-Newton, as in the paper, from the nominal screws; no noise, no joint offsets in the truth.";
    let words = |run: &Run| {
        let end = if run.converged { "" } else { ", not converged" };
        format!("`{}` {}{end}", run.formulation.word(), run.iterations)
    };
    let sentences = [Seen::Poses, Seen::Points].map(|seen| {
        let runs =
            found.runs.iter().filter(|run| run.measurement == seen && !run.offsets_in_truth && !run.noise);
        let words: Vec<String> = runs.map(words).collect();
        let words = if words.is_empty() { "none".to_owned() } else { words.join("; ") };
        format!("Iterations from {}: {words}.", seen.word())
    });
    format!("{start} {}", sentences.join(" "))
}

/// The largest difference of a part of the screws from prescribed.
fn furthest(found: &Reproduction, of: fn(&ScrewRow) -> &[f64; 6], part: std::ops::Range<usize>) -> f64 {
    let (values, prescribed): (Vec<f64>, Vec<f64>) = found
        .screws
        .iter()
        .flat_map(|row| of(row).iter().zip(&row.prescribed).skip(part.start).take(part.len()))
        .unzip();
    largest_difference(&values, &prescribed)
}

fn screws(found: &Reproduction) -> String {
    let both = |of: fn(&ScrewRow) -> &[f64; 6]| {
        format!("{} mm in v and {} in ω", mm(furthest(found, of, 0..3)), number(furthest(found, of, 3..6)))
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
    let held_out = |formulation: Formulation| {
        let run = found.runs.iter().find(|run| {
            run.formulation == formulation
                && run.measurement == Seen::Poses
                && run.offsets_in_truth
                && !run.noise
        });
        run.map_or(String::new(), |run| {
            format!(
                " Its error of prediction on configurations that were not measured is {} mm.",
                mm(run.held_out_rms_m)
            )
        })
    };
    format!(
        "In this part the true robot has joint offsets too. From poses without noise, `screw-offsets` misses them by up to {screw} deg.{} `adjoint-offsets` misses them by up to {adjoint} deg.{}",
        held_out(Formulation::ScrewOffsets),
        held_out(Formulation::AdjointOffsets)
    )
}
