//! Additions of `--verbose`: the robot, the rows, all errors of the fit, the sources of all figures.

use std::collections::BTreeMap;

use super::super::identify::coverage_table;
use super::super::outliers;
use super::super::table::{self, accuracy_table, joints_words, leading_words, line, lines, number};
use super::{delivered_name, uncertainty};
use poecal_calibrate::{FormulationWords, NoiseSource};
use poecal_model::camera::Centre;
use poecal_numerics::error::shorten_name;
use poecal_numerics::solve::Termination;
use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::{CalibrationFile, CommonEntry, PicturesEntry};

pub(crate) fn all(out: &mut String, file: &CalibrationFile) {
    line(out, "robot", &robot_words(file));
    line(out, "measurements", &rows_words(file));
    line(out, "noise", &noise_words(file));
    if let Some(pictures) = &file.pictures {
        line(out, "pictures", &pictures_words(pictures));
    }
    out.push('\n');
    let training = file.robust.without_suspected.training.as_ref().unwrap_or(&file.accuracy.training);
    let held_out = file.robust.without_suspected.held_out.as_ref().or(file.accuracy.held_out.as_ref());
    out.push_str(&accuracy_table(training, held_out));
    if file.robust.suspected.training + file.robust.suspected.held_out > 0 {
        out.push_str("  (without suspected rows)\n");
    }
    out.push('\n');
    outliers::describe_suspects(out, file);
    line(out, "solver", &solver_words(file));
    if let Some(words) = formulation_words(file) {
        line(out, "formulation", &words);
    }
    if let Some(condition) = file.identifiability.condition {
        line(out, "condition", &format!("{condition:.3e} over the determined unknowns"));
    }
    trust(out, file);
    describe_corrected(out, file);
    if !file.coverage.is_empty() {
        coverage_table(out, file.coverage.iter().zip(file.joints.iter().map(|joint| joint.kind)));
        out.push('\n');
    }
}

fn robot_words(file: &CalibrationFile) -> String {
    let [name, base, tip] =
        [&file.robot.name, &file.robot.base_link, &file.robot.tip_link].map(|name| shorten_name(name));
    format!("{name}: {}, from {base} to {tip}", joints_words(file.joints.iter().map(|it| it.kind)))
}

fn rows_words(file: &CalibrationFile) -> String {
    let held_out = file.accuracy.held_out.as_ref().map_or(0, |set| set.count);
    let fitted = file.accuracy.training.count;
    let targets = match file.targets.len() {
        0 | 1 => String::new(),
        count => format!(" of {count} targets"),
    };
    format!("{} rows{targets}: {fitted} fitted, {held_out} held out", fitted + held_out)
}

/// Noise of pictures in words.
fn pictures_words(pictures: &PicturesEntry) -> String {
    let CommonEntry { shift_mm, turn_deg, about, corners } = pictures.common;
    let about = match about {
        Centre::Board => "the board",
        Centre::Camera => "the camera",
    };
    let shape = if corners > 1.0 {
        format!(
            ", which move the board by {} times more than that, as a lens or board of another shape does",
            number(corners)
        )
    } else {
        String::new()
    };
    format!(
        "{} with {} corners to {} px{shape}; in each, all are off together by {} mm and {} deg about {about} (standard deviations of a component)",
        pictures.count,
        pictures.corners,
        number(pictures.sigma_px),
        number(shift_mm),
        number(turn_deg)
    )
}

fn noise_words(file: &CalibrationFile) -> String {
    let source = match file.noise.source {
        NoiseSource::Rows => return "as each row states it".to_owned(),
        NoiseSource::Exact => return "none: the residual is rounding error only".to_owned(),
        NoiseSource::Given => "as stated",
        NoiseSource::Estimated => "estimated from the fit",
    };
    format!("{}, {source}", table::noise_words(&file.noise.sigma))
}

fn solver_words(file: &CalibrationFile) -> String {
    let solver = &file.solver;
    let end = match solver.termination {
        Termination::Optimum | Termination::StepVanished | Termination::NoProgress => "converged",
        Termination::IterationLimit => "NOT converged: the limit of iterations was reached",
        Termination::NotFinite => "NOT converged: residuals are not finite",
    };
    let restarts = match solver.restarts {
        0 => String::new(),
        1 => ", 1 further start".to_owned(),
        count => format!(", {count} further starts"),
    };
    let tolerance = solver.chosen_tolerance.map_or_else(String::new, |it| {
        format!("; tolerance {} deg, {} mm by cross-validation", number(it.angle_deg), number(it.length_mm))
    });
    format!("{} iterations, {end}{restarts}{tolerance}", solver.iterations)
}

/// Formulation of the problem, if it is not the default, and its consequences.
fn formulation_words(file: &CalibrationFile) -> Option<String> {
    let solver = &file.solver;
    let poses = file.accuracy.training.calibrated.rotation_deg().is_some();
    let usual = FormulationWords::default();
    let usual_residual = !poses || solver.pose_residual == usual.pose_residual;
    if usual_residual && (&*solver.formulation, &*solver.method) == (usual.formulation, usual.method) {
        return None;
    }
    let shown = [&solver.formulation, &solver.pose_residual, &solver.method].map(|word| escape_invisible(word));
    let [formulation, pose_residual, method] = &shown;
    let residual = if poses { format!(" {pose_residual} residual of poses,") } else { String::new() };
    let mut words = format!("{formulation},{residual} {method}");
    if let Some(note) = &solver.note {
        words.push_str(&format!("; {}", escape_invisible(note)));
    }
    Some(words)
}

/// Limits of use of the corrections' offsets.
const NOT_ENTERED: &str = "not for entering into a controller: `poecal offsets` finds the offsets that are";

/// Most effects that are listed.
const SHOWN: usize = 6;

/// Evidence for each group of terms, and their effects.
fn describe_corrected(out: &mut String, file: &CalibrationFile) {
    let Some(found) = &file.corrected else { return };
    let left_out =
        |sizes: &BTreeMap<String, f64>| found.tried.iter().find(|it| it.sizes == *sizes).map(|it| it.left_out);
    if let Some(chosen) = left_out(&found.sizes) {
        let without = found.sizes.iter().filter(|(_, size)| **size > 0.0).filter_map(|(group, _)| {
            let mut sizes = found.sizes.clone();
            // The sizes of gravity are chosen together.
            let together = ["sag", "tilt"];
            for (other, size) in &mut sizes {
                let is_same = together.contains(&group.as_str()) && together.contains(&other.as_str());
                if other == group || is_same {
                    *size = 0.0;
                }
            }
            let label = if together.contains(&group.as_str()) { "sag and tilt" } else { group };
            Some((label, left_out(&sizes)?))
        });
        let mut without: Vec<(&str, f64)> = without.collect();
        without.dedup_by(|a, b| a.0 == b.0);
        let words: Vec<String> = without.iter().map(|(group, it)| format!("without {group} {it:.3}")).collect();
        if !words.is_empty() {
            let words = words.join(", ");
            line(out, "left out", &format!("error over that of geometry alone: {chosen:.3}; {words}"));
        }
    }
    let told = found.effects.iter().filter(|it| it.found).take(SHOWN);
    lines(out, "joints do", told.map(|it| format!("{} ({} mm at the target, RMS)", it.words, number(it.effect_mm))));
    lines(out, "ambiguous", &found.indistinguishable);
}

/// Expected errors, cross-validation, and the effect of each joint's correction.
fn trust(out: &mut String, file: &CalibrationFile) {
    if let Some((expected, _)) = uncertainty(file) {
        let words = format!(
            "{} mm (RMS) at the measured configurations, {} mm anywhere within the limits, by the {} model",
            number(expected.measured.sigma_position_mm),
            number(expected.range.sigma_position_mm),
            delivered_name(file)
        );
        line(out, "expected", &words);
    }
    if let Some(found) = &file.cross_validation {
        let worst = found.blocked.iter().max_by(|a, b| a.rms.lead().total_cmp(&b.rms.lead()));
        let worst = worst.map_or_else(String::new, |worst| {
            format!("; worst block: {}, {}", worst.left_out, leading_words(&worst.rms))
        });
        let outside = found.outside.as_ref().map_or_else(String::new, |it| {
            let (rows, all) = (it.rows, found.random.rows);
            format!(" ({rows} of {all} beyond the range of the others: {})", leading_words(&it.rms))
        });
        let words = format!("{} (RMS) on random rows{outside}{worst}", leading_words(&found.random.rms));
        line(out, "predicted", &format!("in cross-validation by calibrated models {words}"));
    }
    let mut joints: Vec<_> = file.corrections.iter().collect();
    joints.sort_by(|a, b| b.left_nominal_rms_mm.total_cmp(&a.left_nominal_rms_mm));
    let joints: Vec<String> =
        joints.iter().map(|it| format!("{} {} mm", it.joint, number(it.left_nominal_rms_mm))).collect();
    if !joints.is_empty() {
        line(out, "per joint", &format!("error (RMS) with this axis alone left nominal: {}", joints.join(", ")));
    }
    let changes = file.corrections.iter().filter_map(|it| {
        let change = it.change.as_ref()?;
        Some(format!("{}: {}", escape_invisible(&it.joint), escape_invisible(&change.words)))
    });
    let changes: Vec<String> = changes.collect();
    let controller = (!changes.is_empty()).then(|| NOT_ENTERED.to_owned());
    lines(out, "corrections", changes.into_iter().chain(controller));
}
