//! Lenses and boards that the corners of single pictures contradict (theory.md §4, *Pictures*).

use super::optics::{BestStep, Optics};
use crate::steps::calibrated_fit::CalibratedFit;
use crate::trust::information::FitInformation;
use poecal_model::camera::{
    Board, Camera, OTHER_LENS, PictureNumber, PictureUnknown, Pictures, changed_numbers, is_flat_sheet,
};
use poecal_numerics::error::shorten_name;

/// Least share of the squared errors of corners that another lens or board must explain.
const EVIDENT: f64 = 0.1;
/// Standard deviations beyond which a number contradicts its stated value.
const FAR: f64 = 5.0;
/// Least difference of a board's scales along x and y that is reported.
const UNEQUAL: f64 = 2e-3;
/// Least sagitta of a bent board that is reported, as a share of its radius.
const BENT: f64 = 1e-3;
/// Fewest degrees of freedom of the corners of pictures that judge.
const LEAST_FREEDOM: f64 = 30.0;
/// Fewest corners that allow a statement.
const FEWEST: usize = 100;

/// Doubt about a camera or a board that was taken as stated.
pub(crate) struct OpticsDoubt {
    /// Explanation of most of the corners' errors, with advice, a sentence.
    pub(crate) statement: String,
    /// Reason against a good model, if a lens belongs to other pictures.
    pub(crate) against_good: Option<String>,
}

/// Doubt about cameras and boards that were taken as stated: the one cause that explains most of the corners' errors, with advice.
pub(crate) fn optics_doubt(fit: &CalibratedFit<'_>) -> Option<OpticsDoubt> {
    let pictures = &fit.run.data.pictures;
    if pictures.all.iter().map(|it| it.corners.len()).sum::<usize>() < FEWEST {
        return None;
    }
    let held = |it: &PictureUnknown| !fit.run.unknowns.pictures.contains(it);
    let lenses = (0..pictures.cameras.len()).map(PictureUnknown::Lens);
    let boards =
        pictures.boards.iter().enumerate().map(|(at, board)| {
            if is_flat_sheet(board) { PictureUnknown::Board(at) } else { PictureUnknown::Markers(at) }
        });
    let before = remaining_error(fit, (&pictures.cameras, &pictures.boards))?;
    let weights = fit.robust.weights();
    let information = FitInformation::from_fit(&fit.run, &fit.noise_ratios, (&fit.robust, &weights))?;
    let tried = lenses.chain(boards).filter(held).filter_map(|unknown| {
        let optics = Optics::from_here(pictures, &[unknown]);
        let best = optics.best_step(&fit.run, &information)?;
        let (cameras, boards) = optics.after(&best.step);
        let after = remaining_error(fit, (&cameras, &boards))?;
        Some((after, unknown, optics, best))
    });
    let (after, unknown, optics, best) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    if after > (1.0 - EVIDENT) * before {
        return None;
    }
    let [before_px, after_px] = [before, after].map(f64::sqrt);
    let statement = words(pictures, unknown, (&optics, &best), [before_px, after_px])?;
    let is_other = matches!(unknown, PictureUnknown::Lens(_)) && before_px > OTHER_LENS * after_px;
    let against_good = is_other.then(|| {
        format!(
            "the corners of single pictures contradict the stated lens: their RMS reprojection error is {before_px:.2} px by the best pose of their picture, and {after_px:.2} px with another lens"
        )
    });
    Some(OpticsDoubt { statement, against_good })
}

/// Mean squared error of the coordinates of corners beside the best pose of each held-out picture, pixels²: the numbers were fitted without these
/// pictures.
fn remaining_error(fit: &CalibratedFit<'_>, (cameras, boards): (&[Camera], &[Board])) -> Option<f64> {
    let data = &fit.run.data;
    let others =
        Pictures { cameras: cameras.to_vec(), boards: boards.to_vec(), all: Vec::new(), ..data.pictures.clone() };
    let (mut squares, mut freedom) = (0.0, 0.0);
    for picture in &data.pictures.all {
        if fit.run.held_out_rows.binary_search(&picture.row).is_err() || fit.robust.robustness.suspects_row(picture.row)
        {
            continue;
        }
        let pose = picture.directed_measurement(&data.observations[picture.row as usize].measurement.pose());
        let found = others.view(picture)?.sighting(&pose, true)?;
        squares += found.cost_px2;
        freedom += found.freedom;
    }
    (freedom > LEAST_FREEDOM).then_some(squares / freedom)
}

fn words(
    pictures: &Pictures,
    unknown: PictureUnknown,
    (optics, best): (&Optics, &BestStep),
    [before_px, after_px]: [f64; 2],
) -> Option<String> {
    let numbers = optics.numbers_after(best);
    let both = format!(
        "reprojected with an RMS error of {before_px:.2} px by the best pose of their picture, of {after_px:.2} px"
    );
    match unknown {
        PictureUnknown::Lens(camera) => {
            let name = shorten_name(&pictures.cameras.get(camera)?.name);
            Some(format!(
                "the corners are {both} with another lens of the camera `{name}` ({}): calibrate with --free lens",
                changed_numbers(&numbers, FAR)
            ))
        }
        PictureUnknown::Board(board) => shape_words(pictures.boards.get(board)?, &numbers, best, &both),
        PictureUnknown::Markers(board) => {
            let board = pictures.boards.get(board)?;
            let squares: f64 = numbers.iter().map(|it| (it.found - it.given).powi(2)).sum();
            let moved = (squares / board.points.len().max(1) as f64).sqrt();
            let name = shorten_name(&board.name);
            Some(format!(
                "the corners are {both} with points of the body `{name}` that are {moved:.2} mm (RMS) elsewhere: measure them, or calibrate with \
                 --free markers"
            ))
        }
    }
}

/// Contradiction to the stated shape of a board: scales that differ along its sides, and a bend.
fn shape_words(board: &Board, numbers: &[PictureNumber], best: &BestStep, both: &str) -> Option<String> {
    let [x, y, bend_x, bend_y] = numbers else { return None };
    let differs = |it: &PictureNumber| (it.found - it.given).abs() > FAR * it.deviation;
    let covariance = |i: usize, j: usize| best.covariance[(i, j)] * x.prior * y.prior;
    let spread = (covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1)).max(0.0).sqrt();
    let unequal = x.found - y.found;
    let bend_mm = bend_x.found.hypot(bend_y.found);
    let is_unequal = unequal.abs() > FAR * spread && unequal.abs() > UNEQUAL;
    let is_bent = (differs(bend_x) || differs(bend_y)) && bend_mm > 1e3 * BENT * board.radius_m();
    let mut found = Vec::new();
    if is_unequal {
        let (long, short) = if unequal > 0.0 { ("x", "y") } else { ("y", "x") };
        let share = 100.0 * unequal.abs();
        found.push(format!(
            "its lengths along {long} are {share:.2} % larger than those along {short}, against what is stated"
        ));
    }
    if is_bent {
        found.push(format!("it is bent by {bend_mm:.2} mm"));
    }
    let name = shorten_name(&board.name);
    (!found.is_empty()).then(|| {
        format!(
            "the corners are {both} with another shape of the board `{name}`: {}; measure the print, or calibrate with --free board",
            found.join(", and ")
        )
    })
}
