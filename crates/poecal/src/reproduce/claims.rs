//! The statements of lou2009, and what it leaves out, against the runs.

use super::runs::{self, Ended};
use super::session::Session;
use super::{Basin, Claim, Efficiency, LENGTH_M, Reproduction, Seen, literal, tables};
use crate::estimate::{Chain, Estimate, Linkage};
use crate::lie::Pose;
use crate::parameters::Formulation;
use crate::solve::Method;

/// Difference from Table II below which a coordinate counts as recovered (metres; 1 for directions).
const RECOVERED: f64 = 1e-9;
/// Ratio to the bound up to which a method counts as efficient; chance makes some 2 % of it in 1,000 trials.
const EFFICIENT: f64 = 1.05;

/// What the claims are judged by.
pub(super) struct Evidence<'a> {
    pub(super) runs: &'a [Ended],
    pub(super) found: &'a Reproduction,
    pub(super) seed: u64,
}

impl Evidence<'_> {
    /// A noise-free run.
    fn run(&self, formulation: Formulation, seen: Seen, offsets: bool) -> Option<&Ended> {
        self.runs.iter().find(|ended| {
            let plan = ended.plan;
            (plan.formulation, plan.seen, plan.offsets_in_truth, plan.noise)
                == (formulation, seen, offsets, false)
        })
    }

    fn efficiency(
        &self,
        formulation: Formulation,
        seen: Seen,
        residual: &str,
        method: Method,
    ) -> Option<&Efficiency> {
        self.found.efficiency.iter().find(|it| {
            it.formulation == formulation
                && it.measurement == seen
                && it.residual == residual
                && it.method == method.word()
        })
    }

    fn basins(&self, formulation: Formulation, seen: Seen, method: Method) -> Vec<&Basin> {
        let of = |it: &&Basin| {
            it.formulation == formulation && it.measurement == seen && it.method == method.word()
        };
        self.found.basin.iter().filter(of).collect()
    }
}

fn claim(claim: &str, paper: &str, measured: String, holds: bool) -> Claim {
    Claim { claim: claim.to_owned(), paper: paper.to_owned(), measured, holds }
}

/// All claims, in the order of the paper; then what it leaves out.
pub(super) fn claims(evidence: &Evidence<'_>) -> Vec<Claim> {
    let parts: [fn(&Evidence<'_>) -> Option<Claim>; 16] = [
        original_without_offsets,
        original_parameters_with_offsets,
        original_prediction_with_offsets,
        equivalence,
        proposition,
        offsets_can_be_left_out,
        constraints,
        normalisation,
        poses_iterations,
        points_iterations,
        table,
        convergence,
        redundancy,
        point_on_axis,
        lever_arm,
        rounding,
    ];
    parts.iter().filter_map(|part| part(evidence)).collect()
}

fn original_without_offsets(evidence: &Evidence<'_>) -> Option<Claim> {
    let poses = &evidence.run(Formulation::Screw, Seen::Poses, false)?.run;
    let points = &evidence.run(Formulation::Screw, Seen::Points, false)?.run;
    Some(claim(
        "The original formulation works where there are no joint offsets.",
        "Section III.A: \"it works well with joint offset-free assumption\".",
        format!(
            "Noise-free, screws as free numbers: poses {} iterations, screws within {:.1e}, held-out error {:.1e} m; points {} \
             iterations, {:.1e}, {:.1e} m.",
            poses.iterations,
            poses.screw_error_max,
            poses.held_out_rms_m,
            points.iterations,
            points.screw_error_max,
            points.held_out_rms_m
        ),
        poses.converged && poses.screw_error_max < RECOVERED,
    ))
}

fn original_parameters_with_offsets(evidence: &Evidence<'_>) -> Option<Claim> {
    let run = &evidence.run(Formulation::ScrewOffsets, Seen::Poses, true)?.run;
    let offset = run.offset_error_max_deg?;
    Some(claim(
        "With joint offsets, the original formulation does not return the prescribed errors.",
        "Section I: \"the calibration result is not consistent with prescribed errors\".",
        format!(
            "Offsets are missed by up to {offset:.2} deg and screws by up to {:.1} mm (or {:.3} of a unit vector).",
            run.screw_error_max * 1e3,
            run.screw_error_max
        ),
        offset > 0.5,
    ))
}

fn original_prediction_with_offsets(evidence: &Evidence<'_>) -> Option<Claim> {
    let run = &evidence.run(Formulation::ScrewOffsets, Seen::Poses, true)?.run;
    Some(claim(
        "With joint offsets, the original calibration fails.",
        "Abstract: it \"always fails with the existence of joint offset errors\".",
        format!(
            "It does not fail to fit: after {} iterations it predicts poses that it never saw to {:.1e} m. Only the split into offsets \
             and screws is arbitrary; with the offsets moved into the screws by (14) and (15), these are right to {:.1e}.",
            run.iterations, run.held_out_rms_m, run.equivalent_screw_error_max
        ),
        !(run.converged && run.held_out_rms_m < RECOVERED),
    ))
}

/// Equations (11) to (15): the robot with offsets and its equivalent without.
fn equivalence(evidence: &Evidence<'_>) -> Option<Claim> {
    let truth = runs::truth(true);
    let session = Session::new(&tables::nominal(), truth.clone(), Seen::Poses, runs::POSES, evidence.seed);
    let (with, without) = (Linkage::new(&truth), Linkage::new(&truth.without_offsets()));
    let (mut a, mut b) = (Chain::default(), Chain::default());
    let mut largest = 0.0_f64;
    for row in 0..session.unseen.rows() {
        a.evaluate(&with, &session.unseen, row, 0);
        b.evaluate(&without, &session.unseen, row, 0);
        let difference = a.target.inverse() * b.target;
        largest = largest.max((difference.rotation - Pose::identity().rotation).amax());
        largest = largest.max(difference.translation.amax());
    }
    Some(claim(
        "A robot with joint offsets equals one without whose screws and home pose are moved.",
        "Equations (11) to (15).",
        format!(
            "Exactly, for offsets of {} deg: the two differ by at most {largest:.1e} (m, or elements of the rotation) in {} \
             configurations.",
            tables::PRESCRIBED_OFFSETS_DEG.map(|offset| format!("{offset}")).join(", "),
            session.unseen.rows()
        ),
        largest < 1e-12,
    ))
}

fn proposition(evidence: &Evidence<'_>) -> Option<Claim> {
    let run = &evidence.run(Formulation::ScrewOffsets, Seen::Poses, true)?.run;
    let points = &evidence.run(Formulation::ScrewOffsets, Seen::Points, true)?.run;
    Some(claim(
        "Joint offsets are not identifiable beside the screws.",
        "Proposition 1.",
        format!(
            "The matrix of (9) has rank {} of {} columns: six offsets, six columns, no rank. For points it is {} of {}.",
            run.rank, run.parameters, points.rank, points.parameters
        ),
        run.rank + 6 == run.parameters,
    ))
}

fn offsets_can_be_left_out(evidence: &Evidence<'_>) -> Option<Claim> {
    let poses = &evidence.run(Formulation::Adjoint, Seen::Poses, true)?.run;
    let points = &evidence.run(Formulation::Adjoint, Seen::Points, true)?.run;
    Some(claim(
        "Joint offsets need not be considered at all.",
        "Section III.A and VI: \"they can be ignored without any danger\".",
        format!(
            "A robot with offsets, calibrated without any: held-out error {:.1e} m from poses, {:.1e} m from points. Its screws are those \
             of the equivalent robot (within {:.1e}), not the mechanical ones (up to {:.1} mm off), which matters to who wants to \
             correct the encoders.",
            poses.held_out_rms_m,
            points.held_out_rms_m,
            poses.equivalent_screw_error_max,
            poses.screw_error_max * 1e3
        ),
        poses.held_out_rms_m < RECOVERED && points.held_out_rms_m < RECOVERED,
    ))
}

fn constraints(evidence: &Evidence<'_>) -> Option<Claim> {
    let adjoint = evidence.runs.iter().filter(|ended| !ended.plan.formulation.has_free_screws());
    let largest = adjoint.map(|ended| ended.violation).fold(0.0, f64::max);
    Some(claim(
        "The adjoint error eliminates the screw constraints.",
        "Section III.B: \"still satisfies joint screw constraints of the same type\".",
        format!(
            "In all adjoint runs, at every iteration and without any normalisation, the unit length of ω and v·ω = 0 hold within \
             {largest:.1e}."
        ),
        largest < 1e-12,
    ))
}

fn normalisation(evidence: &Evidence<'_>) -> Option<Claim> {
    let ratio = |formulation, seen| {
        evidence.efficiency(formulation, seen, "tool", Method::GaussNewton).map(|it| it.ratio)
    };
    let (poses, points) = (ratio(Formulation::Screw, Seen::Poses)?, ratio(Formulation::Screw, Seen::Points)?);
    let (adjoint, adjoint_points) =
        (ratio(Formulation::Adjoint, Seen::Poses)?, ratio(Formulation::Adjoint, Seen::Points)?);
    Some(claim(
        "Normalising screws after each iteration is plausible but not rigorous.",
        "Section III.B: \"though practically plausible, is not mathematically rigorous\".",
        format!(
            "With noise it comes to rest beside the least-squares optimum: held-out error {poses:.3} times the Cramér-Rao bound from poses \
             and {points:.3} times from points, where the adjoint form has {adjoint:.3} and {adjoint_points:.3}. Without noise both end \
             at the truth."
        ),
        poses > adjoint,
    ))
}

fn poses_iterations(evidence: &Evidence<'_>) -> Option<Claim> {
    let run = &evidence.run(Formulation::Adjoint, Seen::Poses, false)?.run;
    Some(claim(
        "From poses, the parameters are identified within 6 iterations.",
        "Section V: \"After 6 iterations, the kinematic parameters are successfully identified\".",
        format!(
            "{} iterations from {} poses to a residual of {:.1e} m.",
            run.iterations,
            run.measurements,
            run.trace.last()?.residual_rms_m
        ),
        run.converged && run.iterations <= 6,
    ))
}

fn points_iterations(evidence: &Evidence<'_>) -> Option<Claim> {
    let poses = &evidence.run(Formulation::Adjoint, Seen::Poses, false)?.run;
    let points = &evidence.run(Formulation::Adjoint, Seen::Points, false)?.run;
    Some(claim(
        "From points it takes 10 iterations, nearly twice as many.",
        "Section V: \"10 iterations are required to achieve the same accuracy\".",
        format!(
            "{} iterations from {} points, against {} from poses: identified, and the number does not double.",
            points.iterations, points.measurements, poses.iterations
        ),
        points.converged && points.iterations >= 10,
    ))
}

fn table(evidence: &Evidence<'_>) -> Option<Claim> {
    let poses = &evidence.run(Formulation::Adjoint, Seen::Poses, false)?.run;
    let points = &evidence.run(Formulation::Adjoint, Seen::Points, false)?;
    let prescribed = tables::prescribed().home.translation;
    let point = (points.estimate.base_from_target[0].translation - prescribed).amax();
    Some(claim(
        "The screws and the point of Table II are recovered.",
        "Table II.",
        format!(
            "Noise-free: screws from poses within {:.1e}, from points within {:.1e} (m, or of a unit vector), the point within {point:.1e} m \
             (against Table II made screws again).",
            poses.screw_error_max, points.run.screw_error_max
        ),
        poses.screw_error_max < RECOVERED && points.run.screw_error_max < RECOVERED && point < RECOVERED,
    ))
}

fn convergence(evidence: &Evidence<'_>) -> Option<Claim> {
    let words = |method, seen| -> Option<(String, f64)> {
        let basins = evidence.basins(Formulation::Adjoint, seen, method);
        let shares: Vec<String> = basins
            .iter()
            .map(|it| format!("{:.1} % from {} deg and {} mm", 100.0 * it.share, it.error_deg, it.error_mm))
            .collect();
        Some((shares.join(", "), basins.first()?.share))
    };
    let (poses, near_poses) = words(Method::GaussNewton, Seen::Poses)?;
    let (points, near_points) = words(Method::GaussNewton, Seen::Points)?;
    let (damped, _) = words(Method::LevenbergMarquardt, Seen::Points)?;
    Some(claim(
        "Iterated least squares converges robustly.",
        "Section VI: \"the speed of convergence is impressive, due to the robustness of sequential linear least-square algorithm\".",
        format!(
            "Starts from which it reaches the truth: poses {poses}; points {points}. With Levenberg-Marquardt, points {damped}."
        ),
        near_poses > 0.99 && near_points > 0.99,
    ))
}

fn redundancy(evidence: &Evidence<'_>) -> Option<Claim> {
    let poses = &evidence.run(Formulation::Adjoint, Seen::Poses, false)?.run;
    let points = &evidence.run(Formulation::Adjoint, Seen::Points, false)?.run;
    Some(claim(
        "The components of η are unknowns that least squares can solve for.",
        "(18) and (26) take six for each joint; nothing is said of their rank.",
        format!(
            "A motion about and along the own axis does nothing: rank {} of {} columns for poses and {} of {} for points, so that the \
             normal equations are singular. In the minimal basis {} and {} unknowns are left, all determined.",
            poses.rank, poses.parameters, points.rank, points.parameters, poses.unknowns, points.unknowns
        ),
        poses.rank == poses.parameters && points.rank == points.parameters,
    ))
}

fn point_on_axis(evidence: &Evidence<'_>) -> Option<Claim> {
    let session =
        Session::new(&tables::nominal(), runs::truth(false), Seen::Points, runs::POINTS, evidence.seed);
    let rank = |estimate: &Estimate| {
        literal::singular_values(&runs::matrix(&session, estimate, Formulation::Adjoint)).1
    };
    let start = rank(&session.start());
    let end = rank(&evidence.run(Formulation::Adjoint, Seen::Points, false)?.estimate);
    Some(claim(
        "The rank of the point simulation is the same at its start as at its end.",
        "Nothing is said; Table II puts the nominal point on nominal axis 6.",
        format!(
            "Rank {start} at the nominal robot and {end} at the identified one: while the point lies on axis 6, tilting that axis and \
             shifting it move the point alike. A method that fixed the rank at the start would stall."
        ),
        start == end,
    ))
}

fn lever_arm(evidence: &Evidence<'_>) -> Option<Claim> {
    let of = |residual| evidence.efficiency(Formulation::Adjoint, Seen::Poses, residual, Method::GaussNewton);
    let (spatial, tool) = (of("spatial")?, of("tool")?);
    Some(claim(
        "The spatial logarithm is a fair measure of a pose error.",
        "After (7): y is the coordinate vector of df·f⁻¹, a twist at the base.",
        format!(
            "It counts rotation noise as position noise times the distance from the base. With {:.2} mm and {:.3} deg of noise its \
             held-out error is {:.2} times the Cramér-Rao bound; position and rotation at the tool, weighted by the same noise, give \
             {:.3}.",
            evidence.found.noise_position_m * 1e3,
            evidence.found.noise_rotation_rad.to_degrees(),
            spatial.ratio,
            tool.ratio
        ),
        spatial.ratio < EFFICIENT,
    ))
}

fn rounding(_: &Evidence<'_>) -> Option<Claim> {
    let rounding = tables::rounding();
    Some(claim(
        "The identified screws of Table II, as printed, are screws.",
        "Table II, four decimals.",
        format!(
            "v·ω is off zero by up to {:.4} mm and the length of ω off one by up to {:.1e}; the experiment uses them projected. (A radian \
             counts as {LENGTH_M} m in ranks.)",
            rounding.pitch_mm, rounding.length
        ),
        rounding.pitch_mm < 1e-6,
    ))
}
