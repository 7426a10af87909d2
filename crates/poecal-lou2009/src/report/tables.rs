//! The tables of the report. Lengths in millimetres, as in the paper.

use super::document::DocumentTable;
use super::numbers::{format_stated, four_decimals, mm, number, number_or_dash, percent, yes_no};
use crate::{MeasurementKind, PaperFormulation, Reproduction, ScrewRow};

pub(super) fn claims(found: &Reproduction) -> DocumentTable {
    statements(found, true, "Table 1. What the paper says.", "claim")
}

pub(super) fn left_out(found: &Reproduction) -> DocumentTable {
    statements(found, false, "Table 2. What the paper leaves out.", "finding")
}

fn statements(found: &Reproduction, said_by_paper: bool, caption: &str, what: &str) -> DocumentTable {
    let row = |claim: &crate::Claim| {
        let cells = [&claim.claim, &claim.paper, &claim.measured, &claim.criterion];
        cells.into_iter().cloned().chain([yes_no(claim.holds)]).collect()
    };
    DocumentTable {
        caption: caption.to_owned(),
        head: words(&[what, "the paper", "measured", "holds if", "holds"]),
        rows: found.claims.iter().filter(|claim| claim.said_by_paper == said_by_paper).map(row).collect(),
        words: 5,
    }
}

pub(super) fn runs(found: &Reproduction) -> DocumentTable {
    let row = |run: &crate::ElbowRun| {
        vec![
            run.formulation.word().to_owned(),
            run.measurement.word().to_owned(),
            truth_words(run.offsets_in_truth, run.noise).to_owned(),
            yes_no(run.converged),
            run.measurements.to_string(),
            run.iterations.to_string(),
            run.unknowns.to_string(),
            format!("{} of {}", run.rank, run.parameters),
            mm(run.held_out_rms_m),
            number(run.screw_error_max),
            number(run.equivalent_screw_error_max),
            number_or_dash(run.offset_error_max_deg),
        ]
    };
    DocumentTable {
        caption: "Table 3. Runs of plain Gauss-Newton from the nominal screws, with joint offsets in the true robot or noise in the measurements, both or none. Rank is of the paper's own matrix, unknowns are those solved for. The held-out error is the RMS distance to the truth on configurations that were not measured; the screw error is the largest of any coordinate (m for v, no unit for ω), as it stands and with all joint offsets moved into the screws. Rows are the measurements fitted.".to_owned(),
        head: words(&[
            "formulation", "seen", "with", "converged", "rows", "iterations",
            "unknowns", "rank", "held-out, mm", "screw error", "moved", "offset error, deg",
        ]),
        rows: found.runs.iter().map(row).collect(),
        words: 4,
    }
}

/// Difficulties of a run beyond the paper's own.
fn truth_words(offsets: bool, noise: bool) -> &'static str {
    match (offsets, noise) {
        (false, false) => "–",
        (true, false) => "offsets",
        (false, true) => "noise",
        (true, true) => "both",
    }
}

pub(super) fn screws(found: &Reproduction) -> DocumentTable {
    DocumentTable {
        caption: "Table 4. Screws beside Table II: v in mm, ω without unit. The last two columns are the largest differences from the prescribed screw.".to_owned(),
        head: words(&["joint", "screw", "vx", "vy", "vz", "ωx", "ωy", "ωz", "v off, mm", "ω off"]),
        rows: found.screws.iter().flat_map(screw_rows).collect(),
        words: 2,
    }
}

fn screw_rows(row: &ScrewRow) -> Vec<Vec<String>> {
    let screws = [
        ("nominal", &row.nominal),
        ("printed", &row.printed),
        ("prescribed", &row.prescribed),
        ("from poses", &row.from_poses),
        ("from points", &row.from_points),
    ];
    let cells = |(name, screw): (&str, &[f64; 6])| {
        let (v, omega) = screw.split_at(3);
        let (prescribed_v, prescribed_omega) = row.prescribed.split_at(3);
        let mut cells = vec![row.joint.clone(), name.to_owned()];
        cells.extend(v.iter().map(|metres| four_decimals(1e3 * metres)));
        cells.extend(omega.iter().map(|value| four_decimals(*value)));
        cells.push(mm(largest_difference(v, prescribed_v)));
        cells.push(number(largest_difference(omega, prescribed_omega)));
        cells
    };
    screws.into_iter().map(cells).collect()
}

/// Largest difference of two lists; NaN if one of them contains NaN.
pub(super) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences
        .fold(0.0, |largest, difference| if difference > largest || difference.is_nan() { difference } else { largest })
}

pub(super) fn point(found: &Reproduction) -> DocumentTable {
    let point = &found.point;
    let row = |(name, position): (&str, &[f64; 3])| {
        let mut cells = vec![name.to_owned()];
        cells.extend(position.iter().map(|metres| four_decimals(1e3 * metres)));
        cells.push(mm(largest_difference(position, &point.prescribed)));
        cells
    };
    let rows = [("nominal", &point.nominal), ("prescribed", &point.prescribed), ("from points", &point.from_points)];
    DocumentTable {
        caption: "Table 5. The point P_c0 beside Table II, mm. The last column is the largest difference from the prescribed point.".to_owned(),
        head: words(&["point", "x", "y", "z", "off"]),
        rows: rows.into_iter().map(row).collect(),
        words: 1,
    }
}

pub(super) fn offsets(found: &Reproduction) -> DocumentTable {
    let row = |row: &crate::OffsetRow| {
        let numbers = [row.prescribed_deg, row.screw_offsets_deg, row.adjoint_offsets_deg];
        std::iter::once(row.joint.clone()).chain(numbers.map(four_decimals)).collect()
    };
    DocumentTable {
        caption: "Table 6. Joint offsets, deg.".to_owned(),
        head: words(&["joint", "prescribed", "screw-offsets", "adjoint-offsets"]),
        rows: found.offsets.iter().map(row).collect(),
        words: 1,
    }
}

pub(super) fn ranks(found: &Reproduction) -> DocumentTable {
    let row = |spectrum: &crate::MatrixSpectrum| {
        let value = |k: usize| spectrum.singular_values.get(k).copied();
        vec![
            spectrum.matrix.clone(),
            spectrum.at.clone(),
            spectrum.columns.to_string(),
            spectrum.rank.to_string(),
            number_or_dash(spectrum.rank.checked_sub(1).and_then(value)),
            number_or_dash(value(spectrum.rank)),
        ]
    };
    DocumentTable {
        caption: "Table 7. Ranks: singular values above 1e-9 of the largest, and those on both sides of the gap as shares of the largest.".to_owned(),
        head: words(&["matrix", "at", "columns", "rank", "last above the gap", "first below"]),
        rows: found.spectra.iter().map(row).collect(),
        words: 2,
    }
}

pub(super) fn efficiency(found: &Reproduction) -> DocumentTable {
    let row = |row: &crate::Efficiency| {
        vec![
            row.formulation.word().to_owned(),
            row.measurement.word().to_owned(),
            residual(row.measurement, &row.residual),
            row.method.clone(),
            row.trials.to_string(),
            row.converged.to_string(),
            mm(row.held_out_rms_m),
            mm(row.bound_rms_m),
            four_decimals(row.ratio),
            four_decimals(row.ratio_sigma),
        ]
    };
    DocumentTable {
        caption: "Table 8. Accuracy with noise. Error and bound are RMS over the fits that converged; ± is one standard deviation of the ratio by chance. Points have one residual only."
            .to_owned(),
        head: words(&[
            "formulation",
            "seen",
            "residual",
            "method",
            "fits",
            "converged",
            "held-out, mm",
            "bound, mm",
            "ratio",
            "±",
        ]),
        rows: found.efficiency.iter().map(row).collect(),
        words: 4,
    }
}

pub(super) fn basin(found: &Reproduction) -> DocumentTable {
    let sizes = distinct_values(found.basin.iter().map(|row| (row.error_deg, row.error_mm)));
    let fit = |row: &crate::Basin| {
        (row.formulation, row.measurement, residual(row.measurement, &row.residual), row.method.clone())
    };
    let fits = distinct_values(found.basin.iter().map(fit));
    let row = |chosen: &(PaperFormulation, MeasurementKind, String, String)| {
        let here = || found.basin.iter().filter(|row| fit(row) == *chosen);
        let (formulation, seen, residual, method) = chosen;
        let trials = here().map(|row| row.trials).min().unwrap_or_default();
        let mut cells = vec![
            formulation.word().to_owned(),
            seen.word().to_owned(),
            residual.clone(),
            method.clone(),
            trials.to_string(),
        ];
        cells.extend(sizes.iter().map(|size| {
            let share = here().find(|row| (row.error_deg, row.error_mm) == *size).map(|row| row.share);
            share.map_or_else(|| "–".to_owned(), percent)
        }));
        cells
    };
    let mut head = words(&["formulation", "seen", "residual", "method", "starts"]);
    head.extend(sizes.iter().map(|(deg, mm)| format!("{} deg, {} mm", format_stated(*deg), format_stated(*mm))));
    DocumentTable {
        caption: "Table 9. Share of starts that reach the truth, by how far each axis and the tip is off.".to_owned(),
        head,
        rows: fits.iter().map(row).collect(),
        words: 4,
    }
}

/// The residual of poses; points have only one.
fn residual(seen: MeasurementKind, word: &str) -> String {
    match seen {
        MeasurementKind::Poses => word.to_owned(),
        MeasurementKind::Points => "–".to_owned(),
    }
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// The distinct values of a list, in the order of their first occurrence.
pub(super) fn distinct_values<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}
