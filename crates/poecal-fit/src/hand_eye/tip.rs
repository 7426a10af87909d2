//! The tip of a tool that touches a fixed point in many orientations: `R p + t = c`, linear in the tip and in the points.

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::bounds::{FrameEstimate, length_within};
use super::findings::{Finding, FindingKind, list_rows};
use super::readings::refuse_arm_lengths;
use super::tip_errors;
use super::touches::{FEWEST, TouchFit, TouchLayout, Touches};
use super::types::{HandEyeLevel, HandEyeRowError};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::{Error, ErrorKind, Result};

/// A tip of the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchedTip {
    /// Name; empty if no column names it.
    pub name: String,
    /// Position in the flange's frame, with its bounds; not turned.
    pub placed: FrameEstimate,
}

/// The tool as determined by its touches.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchedTool {
    /// Tips, in the order of the rows.
    pub tips: Vec<TouchedTip>,
    /// With two tips or more: the direction from the second to the first, in the flange's frame, and the angle within which it is with 95 %
    /// probability, radians.
    pub axis: Option<(Vector3<f64>, f64)>,
    /// Frame of the tool: origin at the first tip; z along the axis, if it is known.
    pub frame: Pose,
    /// Root mean square distance of the tip from its point, metres.
    pub rms_m: f64,
    /// Standard deviation of each component of a touch, metres.
    pub sigma_m: f64,
    /// Rows with their errors.
    pub rows: Vec<HandEyeRowError>,
    /// Touches that contradict the others.
    pub outliers: Vec<usize>,
    /// Usability of the result.
    pub level: HandEyeLevel,
    /// Reasons of the level, a sentence each.
    pub reasons: Vec<String>,
    /// Findings.
    pub findings: Vec<Finding>,
}

/// Share of the tilt, as root mean square change of a unit vector, below which the tip is not determined along it.
const UNTILTED: f64 = 0.03;
/// Share of the tilt that is enough: tilts of 20 deg.
const TILTED: f64 = 0.25;
/// Bound of a tip, and root mean square distance of touches, metres, above which the result is not usable.
const USELESS: f64 = 0.02;
/// Bound of a tip, metres, up to which it is good: an arm guided by hand touches to 0.2 to 1 mm.
const WIDE: f64 = 3e-3;
/// Distance of a tip from the flange, metres, below which the flange itself touched.
const AT_FLANGE: f64 = 2e-3;
/// Root mean square distance, metres, above which other readings are tried.
const SUSPICIOUS: f64 = 5e-3;

/// Estimates the tip (or tips) of a tool from touches of fixed points of unknown position. `name` returns the name of a row in messages.
///
/// # Errors
/// [`ErrorKind::Problem`] if touches are too few, if the flange was not tilted, or if the poses are in other units or conventions.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_fit::hand_eye::{Touches, tool_tip};
/// use poecal_arm::lie::Pose;
/// let (tip, point) = (Vector3::new(0.01, 0.0, 0.15), Vector3::new(0.5, 0.1, 0.0));
/// let poses: Vec<Pose> = [[3.1, 0.0, 0.0], [2.7, 0.2, 1.0], [3.0, -0.5, 2.0], [3.4, 0.3, 3.0]].into_iter().map(|rpy| {
///     let turned = Pose::from_xyz_rpy([0.0; 3], rpy);
///     Pose::new(turned.rotation, point - turned.rotation * tip)
/// }).collect();
/// let found = tool_tip(&Touches { flange: poses.into(), ..Touches::default() }, &|row| format!("row {}", row + 1))?;
/// assert!((found.tips[0].placed.pose.translation - tip).norm() < 1e-9);
/// # Ok::<(), poecal_numerics::error::Error>(())
/// ```
pub fn tool_tip(touches: &Touches, name: &dyn Fn(usize) -> String) -> Result<TouchedTool> {
    let count = touches.flange.poses.len();
    if count < FEWEST {
        return ErrorKind::Problem.refuse(format!(
            "found {count} touches, expected {FEWEST} or more, and 6 to 10 for a good result: touch the same point with the flange tilted to other sides"
        ));
    }
    refuse_arm_lengths(&touches.flange.poses)?;
    let layout = TouchLayout::from_touches(touches);
    layout.refuse_few(touches)?;
    let poses = &touches.flange.poses;
    let (weak, spread) = layout.least_tilted(poses, &vec![true; poses.len()]);
    let solved = layout.robustly(poses).filter(|_| spread > UNTILTED);
    let Some(fit) = solved else { return Err(untilted_error(&weak, spread)) };
    if fit.rms(poses, &layout) > SUSPICIOUS
        && let Some(error) = other_reading(touches, &layout, &fit)
    {
        return Err(error);
    }
    let Some(covariance) = tip_errors::covariance(poses, &layout, &fit, &weak) else {
        return Err(untilted_error(&weak, spread));
    };
    let mut tool = assemble_tool(poses, &layout, &fit, &covariance);
    judge(&mut tool, (weak, spread), largest_turn(poses), name);
    Ok(tool)
}

fn untilted_error(weak: &Vector3<f64>, spread: f64) -> Error {
    ErrorKind::Problem.error(format!(
        "found orientations that tilt the direction ({:.2} {:.2} {:.2} of the flange) by {:.1} deg only, expected 20 deg and more: the tip along it is not \
         determined; touch the point with the flange tilted about two axes across it",
        weak.x,
        weak.y,
        weak.z,
        spread.to_degrees()
    ))
}

/// Another reading of the poses that fits evidently better, with as many touches, which determine as much of the tip.
fn other_reading(touches: &Touches, layout: &TouchLayout, found: &TouchFit) -> Option<Error> {
    let inverted: Vec<Pose> = touches.flange.poses.iter().map(Pose::inverse).collect();
    let inverted =
        ("poses inverted (flange from base): export base from flange, the pose of the flange in the base", inverted);
    let counted = |kept: &[bool]| kept.iter().filter(|it| **it).count();
    let others = touches.flange.others.iter().map(|it| (it.advice.as_str(), it.poses.clone()));
    let fits = others.chain([inverted]).filter_map(|(advice, poses)| {
        let fit = layout.robustly(&poses)?;
        let is_as_sure =
            counted(&fit.kept) >= counted(&found.kept) && layout.least_tilted(&poses, &fit.kept).1 > UNTILTED;
        is_as_sure.then(|| (fit.rms(&poses, layout), advice))
    });
    let (rms, advice) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let as_read = found.rms(&touches.flange.poses, layout);
    (rms < 0.2 * as_read).then(|| {
        ErrorKind::Problem.error(format!(
            "found touches that are {:.0} mm apart (RMS), expected one point; they fit within {:.1} mm with {advice}",
            1e3 * as_read,
            1e3 * rms
        ))
    })
}

/// Largest angle between two orientations, radians.
fn largest_turn(poses: &[Pose]) -> f64 {
    let first = poses.first().map_or_else(Matrix3::identity, |it| it.rotation);
    poses.iter().map(|it| rotation::log(&(first.transpose() * it.rotation)).norm()).fold(0.0, f64::max)
}

/// Tool of a fit, not judged yet.
fn assemble_tool(poses: &[Pose], layout: &TouchLayout, fit: &TouchFit, covariance: &DMatrix<f64>) -> TouchedTool {
    let at = |tip: usize| Vector3::new(fit.unknowns[3 * tip], fit.unknowns[3 * tip + 1], fit.unknowns[3 * tip + 2]);
    let block = |i: usize, j: usize| covariance.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
    let bound = |covariance: &Matrix3<f64>| length_within(covariance, &[(covariance.trace(), fit.freedom)]);
    let tips: Vec<TouchedTip> = layout
        .tips
        .iter()
        .enumerate()
        .map(|(k, name)| {
            let covariance = block(k, k);
            let placed = FrameEstimate {
                pose: Pose::from_translation(at(k)),
                bound95_m: bound(&covariance),
                sigma_m: covariance.diagonal().map(|it| it.max(0.0).sqrt()),
                ..FrameEstimate::default()
            };
            TouchedTip { name: name.clone(), placed }
        })
        .collect();
    let axis = (tips.len() > 1).then(|| {
        let along = at(0) - at(1);
        let direction = along.try_normalize(1e-9).unwrap_or_else(Vector3::z);
        let across = Matrix3::identity() - direction * direction.transpose();
        let between = block(0, 0) + block(1, 1) - block(0, 1) - block(1, 0);
        (direction, (bound(&(across * between * across)) / along.norm().max(1e-9)).atan())
    });
    let turn = axis.map_or_else(Matrix3::identity, |(direction, _)| rotation::shortest_arc(&Vector3::z(), &direction));
    let misses = layout.misses(poses, &fit.unknowns);
    let rows: Vec<HandEyeRowError> = misses
        .iter()
        .zip(&fit.kept)
        .map(|(miss, kept)| HandEyeRowError { shift_m: miss.norm(), turn_rad: 0.0, is_fitted: *kept })
        .collect();
    let outliers: Vec<usize> = (0..rows.len()).filter(|&row| !rows[row].is_fitted).collect();
    TouchedTool {
        frame: Pose::new(turn, at(0)),
        tips,
        axis,
        rms_m: fit.rms(poses, layout),
        sigma_m: fit.sigma_m,
        rows,
        outliers,
        level: HandEyeLevel::Good,
        reasons: Vec::new(),
        findings: Vec::new(),
    }
}

impl TouchedTip {
    /// True if there is no tool: the poses are those of the tip itself.
    fn is_at_flange(&self) -> bool {
        self.placed.pose.translation.norm() < self.placed.bound95_m.clamp(AT_FLANGE, USELESS)
    }

    /// Reason why the tip is too uncertain to be used, if it is.
    fn describe_uselessness(&self) -> Option<String> {
        let FrameEstimate { bound95_m: bound, pose, .. } = self.placed;
        let length = pose.translation.norm();
        (bound > USELESS.min(length)).then(|| {
            let name = if self.name.is_empty() { String::new() } else { format!(" `{}`", self.name) };
            format!(
                "the tip{name} is known to {:.1} mm only (95 %), more than {}: touch the point in more orientations, tilted by 20 deg and more to \
                 several sides",
                1e3 * bound,
                if bound > length { "it is away from the flange".to_owned() } else { format!("{:.0} mm", 1e3 * USELESS) }
            )
        })
    }
}

/// Sets level and reasons. The arguments are the direction that tilted least, its tilt, and the largest rotation.
fn judge(tool: &mut TouchedTool, (weak, spread): (Vector3<f64>, f64), turned: f64, name: &dyn Fn(usize) -> String) {
    let (fitted, outliers) = (tool.rows.len() - tool.outliers.len(), tool.outliers.len());
    let (mut against, mut reasons) = (Vec::new(), Vec::new());
    if tool.rms_m > USELESS {
        against.push(format!(
            "the touches are {:.0} mm apart (RMS): no one point was touched, or the poses are of another frame than the flange; check that the controller's \
             tool is zero (flange) in what was recorded",
            1e3 * tool.rms_m
        ));
    } else if tool.tips.iter().any(TouchedTip::is_at_flange) {
        against.push(format!(
            "the positions are one point within {:.1} mm (RMS) while the orientations turn by {:.0} deg: these are poses of the tip, whose tool was active \
             in the controller, and not of the flange; record again with the tool zero (flange), or keep the controller's tool, which these touches \
             confirm",
            1e3 * tool.rms_m,
            turned.to_degrees()
        ));
    } else {
        against.extend(tool.tips.iter().filter_map(TouchedTip::describe_uselessness));
    }
    if 2 * outliers >= fitted {
        against.push(format!("{outliers} of {} touches contradict the others", fitted + outliers));
    }
    if outliers > 0 {
        let statement = format!(
            "{} contradict{} the others and {} left out: touch the point anew there",
            list_rows(&tool.outliers, name),
            if outliers == 1 { "s" } else { "" },
            if outliers == 1 { "is" } else { "are" }
        );
        tool.findings.push(Finding::new(FindingKind::Outliers, statement, tool.outliers.clone()));
    }
    if fitted < 5 {
        reasons.push(format!("{fitted} touches show little of their own errors: take 6 or more"));
    }
    let bound = tool.tips.iter().map(|it| it.placed.bound95_m).fold(0.0, f64::max);
    if bound > WIDE {
        reasons.push(format!(
            "the tip is known to {:.1} mm (95 %; good: up to {:.0} mm): touch the point in more orientations, tilted by 20 deg and more to several sides",
            1e3 * bound,
            1e3 * WIDE
        ));
    }
    if spread < TILTED {
        let statement = format!(
            "the direction ({:.2} {:.2} {:.2} of the flange) was tilted by {:.0} deg only (RMS), so that the tip is known worst along it: tilt it by 20 deg \
             and more to several sides",
            weak.x,
            weak.y,
            weak.z,
            spread.min(1.0).asin().to_degrees()
        );
        reasons.push(statement.clone());
        tool.findings.push(Finding::new(FindingKind::MissingMoves, statement, Vec::new()));
    }
    (tool.level, tool.reasons) = HandEyeLevel::from_reasons(against, reasons);
}
